//! Files of tables: where they are looked for, their texts, the numbers in two of their columns.

use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use flank_expr::CurveId;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{FileId, Sources, Span};
use crate::limits::{self, Limit};
use crate::load::files::{Files, read_other};
use crate::load::tidy;
use crate::values::dimension::{self, Dimension};
use crate::values::grids::Grids;
use crate::values::value::article;

/// The column in which flank says how points were solved.
const STATUS: &str = "status";

/// Two columns of a table.
pub(crate) type Rows = Vec<(f64, f64)>;

/// A table by its path, columns and their dimensions.
pub(crate) type Key = (PathBuf, [String; 2], [Dimension; 2]);

/// Where tables are looked for, and those that have been read.
pub(crate) struct Tables {
    from: Arc<dyn Files>,
    /// The project folder of each source file; a text that is not a file has none.
    projects: HashMap<FileId, PathBuf>,
    /// The folder of each source file, as the user knows it and as it really is.
    folders: HashMap<FileId, [PathBuf; 2]>,
    /// The files that have been read with their texts, in the order in which they were first needed.
    texts: Vec<([PathBuf; 2], Rc<str>)>,
    /// Where a file is among them, by its real path.
    known: HashMap<PathBuf, usize>,
    /// Tables that have been read.
    pub(crate) rows: HashMap<Key, Rc<Rows>>,
    /// One table is one curve however often it is named.
    pub(crate) curves: HashMap<Key, CurveId>,
    pub(crate) grids: Grids,
    /// Size of all tables that have been read.
    bytes: usize,
}

impl Tables {
    pub(crate) fn new(from: Arc<dyn Files>, projects: HashMap<FileId, PathBuf>, sources: &Sources) -> Tables {
        let folders = sources.files().filter_map(|(id, file)| {
            Some((id, [file.path.parent()?.to_path_buf(), file.file.as_ref()?.parent()?.to_path_buf()]))
        });
        Tables {
            from,
            projects,
            folders: folders.collect(),
            texts: Vec::new(),
            known: HashMap::new(),
            rows: HashMap::new(),
            curves: HashMap::new(),
            grids: Grids::new(),
            bytes: 0,
        }
    }

    /// Adds the texts that were read to those of the compilation.
    pub(crate) fn tell(&self, sources: &mut Sources) {
        for ([shown, real], text) in &self.texts {
            sources.add_file(shown, real, &**text);
        }
    }

    /// The path of a table named in a file, as the user knows it and as it really is, or why it may not be read.
    pub(crate) fn locate(&self, named: &str, file: FileId) -> Result<[PathBuf; 2], (Code, String)> {
        let Some(project) = self.projects.get(&file) else {
            return Err((Code::UnreadableFile, "a text that is not a file cannot use files".to_string()));
        };
        let [shown, folder] = self.folders.get(&file).cloned().unwrap_or_default();
        let real = self.from.real_path(&folder.join(named)).map_err(|error| {
            (Code::UnreadableFile, format!("cannot read `{named}`: {}", crate::load::reason(&error)))
        })?;
        if Path::new(named).is_absolute() {
            let message = format!(
                "`{named}` is an absolute path, which leads elsewhere on another machine: write it from the folder of this file on"
            );
            return Err((Code::OutsideProject, message));
        }
        if !real.starts_with(project) {
            return Err((
                Code::OutsideProject,
                format!("`{named}` lies outside the project folder {}", project.display()),
            ));
        }
        Ok([tidy(&shown.join(named)), real])
    }

    /// The text of a table, read once; each time counts.
    pub(crate) fn text(&mut self, paths: &[PathBuf; 2]) -> Result<Rc<str>, Reason> {
        let [_, real] = paths;
        if let Some(&known) = self.known.get(real) {
            let text = Rc::clone(&self.texts[known].1);
            self.count(text.len())?;
            return Ok(text);
        }
        let room = limits::TABLE_BYTES.most.saturating_sub(self.bytes);
        let text = read_other(&*self.from, real, room).map_err(|error| match error.kind() {
            ErrorKind::FileTooLarge => Reason::Exceeded(limits::TABLE_BYTES),
            _ => Reason::Wrong(Code::UnreadableFile, crate::load::reason(&error)),
        })?;
        self.count(text.len())?;
        let text: Rc<str> = text.into();
        self.known.insert(real.clone(), self.texts.len());
        self.texts.push((paths.clone(), Rc::clone(&text)));
        Ok(text)
    }

    /// Whether the text of a table has been read.
    pub(crate) fn is_read(&self, [_, real]: &[PathBuf; 2]) -> bool {
        self.known.contains_key(real)
    }

    fn count(&mut self, bytes: usize) -> Result<(), Reason> {
        self.bytes += bytes;
        if self.bytes > limits::TABLE_BYTES.most { Err(Reason::Exceeded(limits::TABLE_BYTES)) } else { Ok(()) }
    }
}

/// Why a table is not read.
pub(crate) enum Reason {
    Exceeded(Limit),
    Wrong(Code, String),
}

pub(crate) fn reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes())
}

impl Reason {
    /// In words, where a file is named.
    pub(crate) fn told(self, place: Span, named: &str) -> Diagnostic {
        match self {
            Reason::Exceeded(limit) => limit.exceeded(place),
            Reason::Wrong(code, reason) => Diagnostic::new(code, place, format!("`{named}`: {reason}")),
        }
    }
}

/// Two columns of a text.
pub(crate) fn rows(text: &str, columns: [(&str, Dimension); 2]) -> Result<Rows, Reason> {
    Ok(numbers(text, &columns, &[])?.into_iter().map(|row| (row[0], row[1])).collect())
}

/// Columns of a text with numbers, of those rows whose other columns have the given texts, and which are solved where there is a column
/// `status`; lines that begin with `#` are remarks, the first other line names the columns.
pub(crate) fn numbers(
    text: &str,
    columns: &[(&str, Dimension)],
    texts: &[(&str, &str)],
) -> Result<Vec<Vec<f64>>, Reason> {
    let mut reader = reader(text);
    let wrong = |reason: String| Reason::Wrong(Code::WrongTable, reason);
    let heads = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let remarks = remarks(text);
    let places: Result<Vec<Vec<(usize, f64)>>, String> =
        columns.iter().map(|(name, dimension)| found(&heads, &remarks, name, *dimension)).collect();
    let places = places.map_err(wrong)?;
    let place = |name: &str| heads.iter().position(|head| head == name);
    let mut wanted = Vec::new();
    for (name, text) in texts {
        let index = place(name).ok_or_else(|| wrong(missing(&heads, name)))?;
        wanted.push((index, *text));
    }
    if texts.iter().all(|(name, _)| *name != STATUS) {
        wanted.extend(place(STATUS).map(|index| (index, "solved")));
    }
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        if wanted.iter().any(|(index, text)| record.get(*index) != Some(*text)) {
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let number = |((name, _), columns): (&(&str, Dimension), &Vec<(usize, f64)>)| {
            let cells = columns.iter().map(|(column, size)| (record.get(*column).unwrap_or(""), *size));
            let mut cells = cells.filter(|(cell, _)| !cell.is_empty());
            let (cell, size) = cells.next().unwrap_or(("", 1.0));
            if cells.next().is_some() {
                return Err(wrong(format!("line {line}: two columns are called `{name}` and both have a value")));
            }
            let value = cell.parse::<f64>().ok().map(|value| value * size).filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(format!("line {line}: `{cell}` is not a finite number")))
        };
        points.push(columns.iter().zip(&places).map(number).collect::<Result<Vec<f64>, Reason>>()?);
        if points.len() > limits::TABLE_ROWS.most {
            return Err(Reason::Exceeded(limits::TABLE_ROWS));
        }
    }
    Ok(points)
}

/// The columns with a name, `s` or `s [mm]`, and the size of their units: where none is given, the one that flank remarks for it, or mm and
/// degrees. Of columns of one name each row has a value in one.
fn found(
    heads: &csv::StringRecord,
    remarks: &HashMap<&str, &str>,
    name: &str,
    dimension: Dimension,
) -> Result<Vec<(usize, f64)>, String> {
    let mut columns = Vec::new();
    for (index, head) in heads.iter().enumerate() {
        let (plain, unit) = match head.split_once('[') {
            Some((plain, rest)) => (plain.trim(), Some(rest.trim_end_matches(']').trim())),
            None => (head, None),
        };
        if plain == name || as_name(plain) == name {
            // a component of a vector has the vector's unit
            let vector = plain.strip_suffix(['x', 'y', 'z']).and_then(|rest| rest.strip_suffix('_'));
            let remark = remarks.get(plain).or_else(|| remarks.get(vector?)).copied();
            columns.push((index, size_of_unit(name, unit.or(remark), dimension)?));
        }
    }
    if columns.is_empty() { Err(missing(heads, name)) } else { Ok(columns) }
}

/// What names such as `d_normal/d_m.swivel` are called where only letters and digits may stand.
fn as_name(head: &str) -> String {
    head.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

fn size_of_unit(name: &str, unit: Option<&str>, dimension: Dimension) -> Result<f64, String> {
    let Some(unit) = unit.or(match dimension {
        Dimension::ANGLE => Some("deg"),
        Dimension::LENGTH => Some("mm"),
        _ => None,
    }) else {
        return Ok(1.0);
    };
    // a number is taken as it is
    let is_number = unit == "1" || unit.contains(['/', '^']);
    match dimension::unit_size(unit) {
        Some((size, found)) if found == dimension => Ok(size),
        Some((_, found)) => {
            Err(format!("column `{name}` is {} {found}, not {} {dimension}", article(found), article(dimension)))
        }
        None if is_number && dimension == Dimension::NUMBER => Ok(1.0),
        None if is_number => Err(format!("column `{name}` is in {unit}: read it as a number")),
        None => Err(format!("column `{name}`: `{unit}` is not a unit")),
    }
}

/// The units of columns that flank remarks above a table: ``# field `left` in um: …``.
fn remarks(text: &str) -> HashMap<&str, &str> {
    let lines = text.lines().take_while(|line| line.starts_with('#'));
    lines.filter_map(remark).collect()
}

fn remark(line: &str) -> Option<(&str, &str)> {
    let (name, rest) = line.strip_prefix("# field `")?.split_once("` in ")?;
    Some((name, rest.split_once(':')?.0))
}

fn missing(heads: &csv::StringRecord, name: &str) -> String {
    let known: Vec<&str> = heads.iter().collect();
    let commas = if known.len() == 1 && known[0].contains([';', '\t']) { "; columns are parted by commas" } else { "" };
    format!("there is no column `{name}`; there is: {}{commas}", known.join(", "))
}
