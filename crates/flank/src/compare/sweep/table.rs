//! Tables of cases: texts with a head that names what differs, and a line for each case.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use flank_chain_dsl::{Code, Job};

use super::inputs::{KnownInput, StudyInput, Unfit, size_of_unit};
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::spec::Origin;
use crate::project::units;

/// Bytes of a table as a text.
const MOST_BYTES: usize = 1 << 30;
/// What is wrong in a table is listed up to so many.
const LISTED: usize = 20;
/// What files of Parquet begin with.
const MAGIC: [u8; 4] = *b"PAR1";

/// The text of a table, CSV or Parquet.
///
/// # Errors
/// Why it cannot be read.
pub(super) fn read_text(which: &JobSelection, path: &Path) -> Result<String, Failure> {
    let files = which.project.files();
    let found = files.real_path(path).ok().and_then(|real| File::open(real).ok());
    let Some(file) = found.filter(|file| is_parquet(file, path)) else {
        return Origin::default().other_text(files, path, MOST_BYTES);
    };
    flank_export::parquet_as_csv(file, MOST_BYTES)
        .map_err(|fault| Unfit::new(Code::UnreadableFile, format!("cannot read `{}`: {fault}", path.display())).into())
}

fn is_parquet(mut file: &File, path: &Path) -> bool {
    let mut first = [0; 4];
    let is_marked = file.read_exact(&mut first).is_ok() && first == MAGIC;
    is_marked || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"))
}

/// The inputs that a table has a column for, and their values in each case.
///
/// # Errors
/// All that is wrong in the table.
pub(super) fn read(job: &Job<'_>, file: &str, text: &str) -> Result<(Vec<StudyInput>, Vec<Vec<f64>>), Failure> {
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let mut found = Wrong { file, list: Vec::new() };
    let Some((number, line)) = lines.next() else {
        found.add(1, Unfit::new(Code::WrongTable, "the study has no case: the table is empty"));
        return Err(found.failure());
    };
    if let Some(unfit) = other_separator(line) {
        found.add(number, unfit);
        return Err(found.failure());
    }
    let columns = columns(job, &cells(line), number, &mut found);
    let rows: Vec<Vec<f64>> =
        lines.filter_map(|(number, line)| row(&columns, &cells(line), number, &mut found)).collect();
    if rows.is_empty() && found.list.is_empty() {
        found.add(number, Unfit::new(Code::WrongTable, "the study has no case: the table has no row below its head"));
    }
    if found.list.is_empty() {
        return Ok((columns.into_iter().flatten().map(|column| column.input).collect(), rows));
    }
    Err(found.failure())
}

/// What is wrong in a table, in the order of its lines.
struct Wrong<'f> {
    file: &'f str,
    list: Vec<String>,
}

impl Wrong<'_> {
    fn add(&mut self, line: usize, unfit: Unfit) {
        self.list.push(format!("{}:{line}: {unfit}", self.file));
    }

    fn failure(mut self) -> Failure {
        let more = self.list.len().saturating_sub(LISTED);
        self.list.truncate(LISTED);
        self.list.extend((more > 0).then(|| format!("and {more} more")));
        Failure::Input(self.list.join("\n"))
    }
}

/// What is said of a head whose columns no comma separates.
fn other_separator(line: &str) -> Option<Unfit> {
    let is_single = cells(line).len() == 1;
    let found = [(';', "`;`"), ('\t', "tabs")].into_iter().find(|(other, _)| is_single && line.contains(*other));
    found.map(|(_, other)| {
        let message = format!("columns are separated by {other}: write `,` between them, and `.` in numbers");
        Unfit::new(Code::WrongTable, message)
    })
}

/// The inputs of the columns; `None` where a head is wrong.
fn columns(job: &Job<'_>, heads: &[Cow<'_, str>], line: usize, wrong: &mut Wrong<'_>) -> Vec<Option<KnownInput>> {
    let mut columns: Vec<Option<KnownInput>> = Vec::new();
    for (at, head) in heads.iter().enumerate() {
        let known = match column(job, head) {
            Ok(known) if columns.iter().flatten().any(|other| other.input.name == known.input.name) => {
                let message = format!("column `{}` is given twice: leave one out", known.input.name);
                Err(Unfit::new(Code::DuplicateName, message))
            }
            Err(_) if head.is_empty() => {
                let message =
                    format!("column {} has no name; write.csv of R writes one unless row.names = FALSE", at + 1);
                Err(Unfit::new(Code::WrongTable, message))
            }
            other => other,
        };
        columns.push(known.map_err(|unfit| wrong.add(line, unfit)).ok());
    }
    columns
}

/// The values of a line; `None` where their number is wrong. What is no number is not one here either.
fn row(columns: &[Option<KnownInput>], cells: &[Cow<'_, str>], line: usize, wrong: &mut Wrong<'_>) -> Option<Vec<f64>> {
    if cells.len() != columns.len() {
        let [values, heads] = [(cells.len(), "value"), (columns.len(), "column")].map(|(n, of)| units::counted(n, of));
        wrong.add(line, Unfit::new(Code::WrongTable, format!("{values} in {heads}")));
        return None;
    }
    let values = cells.iter().zip(columns).map(|(cell, column)| {
        let value = cell.parse().ok();
        let unfit = match (value, column) {
            (Some(value), Some(column)) => column.refused(value),
            (Some(_), None) => None,
            (None, _) => Some(Unfit::new(Code::NotANumber, format!("`{cell}` is no number"))),
        };
        unfit.into_iter().for_each(|unfit| wrong.add(line, unfit));
        value.unwrap_or(f64::NAN)
    });
    Some(values.collect())
}

/// The cells of a line; commas within quotes separate none.
fn cells(line: &str) -> Vec<Cow<'_, str>> {
    if !line.contains('"') {
        return line.split(',').map(|cell| Cow::Borrowed(cell.trim())).collect();
    }
    let mut is_quoted = false;
    let parts = line.split(|letter| {
        is_quoted ^= letter == '"';
        letter == ',' && !is_quoted
    });
    parts.map(|cell| unquoted(cell.trim())).collect()
}

fn unquoted(cell: &str) -> Cow<'_, str> {
    match cell.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) => Cow::Owned(inner.replace("\"\"", "\"").trim().to_string()),
        None => Cow::Borrowed(cell),
    }
}

/// The name and the unit of a head: `m.radial_distance [mm]`.
fn head(text: &str) -> (&str, Option<&str>) {
    match text.trim().split_once('[') {
        Some((name, rest)) => (name.trim(), Some(rest.trim_end_matches(']').trim())),
        None => (text.trim(), None),
    }
}

/// # Errors
/// That there is no such input, or that its unit is missing or another one.
fn column(job: &Job<'_>, text: &str) -> Result<KnownInput, Unfit> {
    let (name, unit) = head(text);
    let known = KnownInput::named(job, name)?;
    let own = known.input.unit.clone();
    let unfit = |message: String| Err(Unfit::new(Code::WrongDimension, message));
    let unit = match unit {
        None if own.is_empty() => return Ok(known),
        None => return unfit(format!("column `{name}` has no unit: write `{name} [{own}]`")),
        Some(unit) => unit,
    };
    let is_fitting = unit == own || size_of_unit(unit).is_some_and(|(_, dimension)| dimension == known.dimension);
    if !is_fitting {
        let wanted =
            if own.is_empty() { "it is a plain number".to_string() } else { format!("write `{name} [{own}]`") };
        return unfit(format!("column `{name}`: `{unit}` is no unit of it; {wanted}"));
    }
    Ok(KnownInput { input: StudyInput { unit: unit.to_string(), ..known.input }, ..known })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_within_quotes_separate_no_cells() {
        let told: Vec<String> =
            cells("\"width:a,b.turn [deg]\", 3 ,\"say \"\"x\"\"\",").into_iter().map(Cow::into_owned).collect();
        assert_eq!(told, ["width:a,b.turn [deg]", "3", "say \"x\"", ""]);
    }
}
