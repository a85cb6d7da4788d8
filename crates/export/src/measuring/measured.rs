//! What a machine measured at the points of a grid, read from CSV.

use std::cell::Cell;
use std::collections::BTreeSet;

/// What was measured of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredGrid {
    /// Rows and columns: the largest that a line speaks of, with or without values.
    pub counts: [usize; 2],
    /// The points that have values, in the order of their lines.
    pub points: Vec<MeasuredPoint>,
}

/// A point of the grid with what was measured there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// From 0 at the root.
    pub row: usize,
    /// From 0 at the first end of the tooth's length.
    pub column: usize,
    /// What was measured.
    pub measured: Measured,
}

/// What was measured at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// Where the surface is, mm, in the frame of the nominal points.
    Position([f64; 3]),
    /// How far it lies off the nominal point along the normal, mm; plus is material.
    Deviation(f64),
}

/// Why a file of measured points cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeasuredFault {
    /// The table is no CSV.
    #[error("{0}")]
    NoTable(String),
    /// A column is missing.
    #[error("there is no column `{missing}`; needed are row, column, and x, y, z (mm) or deviation_um; there is: {}", titles.join(", "))]
    NoColumn {
        /// What is needed.
        missing: &'static str,
        /// What there is.
        titles: Vec<String>,
    },
    /// A cell is no number.
    #[error("line {line}: `{text}` is no {wanted}")]
    NoNumber {
        /// From 1.
        line: u64,
        /// What stands there.
        text: String,
        /// What should.
        wanted: &'static str,
    },
    /// Decimals with a comma and with a point: one of them may separate thousands.
    #[error(
        "line {line}: `{text}` has another decimal sign than the numbers before it: write all with a comma, or all with a point"
    )]
    TwoDecimalSigns {
        /// From 1.
        line: u64,
        /// What stands there.
        text: String,
    },
    /// Two lines speak of the same point.
    #[error("line {line}: row {row}, column {column} is there already")]
    Twice {
        /// From 1.
        line: u64,
        /// From 1.
        row: usize,
        /// From 1.
        column: usize,
    },
    /// No line with values speaks of the surface.
    #[error("no line is about the grid of `{0}`")]
    Nothing(String),
}

/// Reads measured points of a surface's grid from a table with a line of titles. What stands between the titles, a comma, a semicolon or a
/// tab, separates the cells; decimals may have a comma where that does not. `row` and `column` count from 1, as in the file of the nominal
/// points; `x, y, z` are mm, `deviation_um` is along the normal and stands for them where there is such a column. Lines that begin with
/// `#` are passed over; lines of other surfaces (`surface`) and parts (`part`), too. A line whose cells for the measured values are empty
/// says that there is such a point, which was not measured.
///
/// # Errors
/// What is wrong with the file, and where.
pub fn read_measured(text: &str, surface: &str) -> Result<MeasuredGrid, MeasuredFault> {
    let separator = separator(text);
    let mut table = csv::ReaderBuilder::new();
    let mut table = table.delimiter(separator).comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let titles = table.headers().map_err(|error| MeasuredFault::NoTable(error.to_string()))?.clone();
    if titles.is_empty() {
        return Err(MeasuredFault::NoTable("it is empty".to_string()));
    }
    if let Some(k) =
        (1..titles.len()).find(|k| !titles[*k].is_empty() && titles.iter().take(*k).any(|title| title == &titles[*k]))
    {
        return Err(MeasuredFault::NoTable(format!("two columns are called `{}`", &titles[k])));
    }
    let place = |name: &str| titles.iter().position(|title| title == name);
    let no_column = |missing| MeasuredFault::NoColumn {
        missing,
        titles: titles.iter().map(|title| format!("`{title}`")).collect(),
    };
    let needed = |name: &'static str| place(name).ok_or_else(|| no_column(name));
    let [row, column] = [needed("row")?, needed("column")?];
    let numbers = match place("deviation_um") {
        Some(deviation) => vec![deviation],
        None if ["x", "y", "z"].into_iter().all(|name| place(name).is_none()) => return Err(no_column("deviation_um")),
        None => ["x", "y", "z"].into_iter().map(needed).collect::<Result<Vec<usize>, MeasuredFault>>()?,
    };
    let mut grid = MeasuredGrid { counts: [0; 2], points: Vec::new() };
    let mut places = BTreeSet::new();
    let decimals = Decimals { may_be_commas: separator != b',', sign: Cell::new(None) };
    for record in table.records() {
        let record = record.map_err(|error| MeasuredFault::NoTable(error.to_string()))?;
        let cell = |k: usize| record.get(k).unwrap_or_default();
        let is_other = |name: &str, own: &str| place(name).is_some_and(|k| cell(k) != own);
        if is_other("surface", surface) || is_other("part", "grid") {
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let fault = |k: usize, wanted| MeasuredFault::NoNumber { line, text: cell(k).to_string(), wanted };
        let index = |k: usize| {
            let index = cell(k).parse::<usize>().ok().filter(|index| (1..=MOST_LINES).contains(index));
            index.map(|index| index - 1).ok_or_else(|| fault(k, "row or column, which count from 1 to at most 10000"))
        };
        let number = |k: usize| match decimals.are_mixed_by(cell(k)) {
            true => Err(MeasuredFault::TwoDecimalSigns { line, text: cell(k).to_string() }),
            false => decimals.number(cell(k)).ok_or_else(|| fault(k, "number")),
        };
        let [row, column] = [index(row)?, index(column)?];
        grid.counts = [grid.counts[0].max(row + 1), grid.counts[1].max(column + 1)];
        if numbers.iter().all(|&k| cell(k).is_empty()) {
            continue;
        }
        let measured = match numbers[..] {
            [x, y, z] => Measured::Position([number(x)?, number(y)?, number(z)?]),
            [deviation, ..] => Measured::Deviation(number(deviation)? / 1e3),
            [] => continue,
        };
        if !places.insert((row, column)) {
            return Err(MeasuredFault::Twice { line, row: row + 1, column: column + 1 });
        }
        grid.points.push(MeasuredPoint { row, column, measured });
    }
    if grid.points.is_empty() { Err(MeasuredFault::Nothing(surface.to_string())) } else { Ok(grid) }
}

/// What stands between the titles.
fn separator(text: &str) -> u8 {
    let lines = text.split(['\n', '\r']);
    let titles = lines.map(str::trim_start).find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default();
    let is_split = |sign: char| titles.split(sign).any(|title| title.trim().trim_matches('"') == "row");
    // without that column it is the one that stands there
    let found = [',', ';', '\t'].into_iter().find(|sign| titles.contains(*sign) && is_split(*sign));
    match found.or_else(|| [';', '\t'].into_iter().find(|sign| titles.contains(*sign))) {
        Some(';') => b';',
        Some('\t') => b'\t',
        _ => b',',
    }
}

/// How the decimals of a table are written.
struct Decimals {
    may_be_commas: bool,
    /// As in the numbers so far.
    sign: Cell<Option<char>>,
}

impl Decimals {
    /// Whether a number has another sign than those before.
    fn are_mixed_by(&self, text: &str) -> bool {
        let Some(sign) = text.chars().find(|c| matches!(c, '.' | ',')).filter(|_| self.may_be_commas) else {
            return false;
        };
        self.sign.replace(Some(sign)).is_some_and(|before| before != sign)
    }

    fn number(&self, text: &str) -> Option<f64> {
        let number = if self.may_be_commas { text.replace(',', ".").parse() } else { text.parse() };
        number.ok().filter(|number: &f64| number.is_finite())
    }
}

/// No grid has more rows or columns.
const MOST_LINES: usize = 10_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_deviations_are_read_by_their_titles() {
        let text = "# from the machine\nsurface,part,row,column,x,y,z,probe\nleft,grid,1,2, 1.5 ,-2,3e1,P1\nright,grid,1,1,0,0,0,P1\n\
                    left,profile,1,1,0,0,0,P1\nleft,grid,2,1,,,,P1\n";
        let found = read_measured(text, "left").expect("a table");
        assert_eq!(
            found.points,
            [MeasuredPoint { row: 0, column: 1, measured: Measured::Position([1.5, -2.0, 30.0]) }]
        );
        let found = read_measured("column,row,deviation_um\n3,1,-4.5\n", "left").expect("a table");
        assert_eq!(found.points, [MeasuredPoint { row: 0, column: 2, measured: Measured::Deviation(-0.0045) }]);
    }

    /// What the cells are separated by is seen from the titles, and a comma that does not separate them is that of decimals.
    #[test]
    fn semicolons_tabs_and_decimal_commas_are_read() {
        let plain = read_measured("row,column,deviation_um\n1,2,-4.5\n2,1,1e1\n", "left").expect("a table");
        for text in [
            "row;column;deviation_um\n1;2;-4.5\n2;1;1e1\n",
            "row;column;deviation_um\n1;2;-4,5\n2;1;1,0e1\n",
            "# a, b\r\n\"row\"\tcolumn\tdeviation_um\r\n1\t2\t\"-4,5\"\r\n2\t1\t10\r\n",
            "column;row;deviation_um;x, y\r2;1;-4,5;\r1;2;10;\r",
        ] {
            assert_eq!(read_measured(text, "left"), Ok(plain.clone()), "{text:?}");
        }
        let told = |text: &str| read_measured(text, "left").expect_err("a fault").to_string();
        assert_eq!(
            told("row;column;x;y;z\n1;1;1,5;2;1.234\n"),
            "line 2: `1.234` has another decimal sign than the numbers before it: write all with a comma, or all with a point"
        );
        assert_eq!(told("row;column;deviation_um\n1;1;1.234,5\n"), "line 2: `1.234,5` is no number");
        assert_eq!(told("row,column,deviation_um\n1,1,\"1,5\"\n"), "line 2: `1,5` is no number");
        assert!(told("Zeile;Spalte;Abw\n1;1;1\n").contains("no column `row`; needed are row, column"));
        assert!(told("Zeile;Spalte;Abw\n1;1;1\n").contains("there is: `Zeile`, `Spalte`, `Abw`"));
        assert!(told("row\tcolumn\tdeviation_mm\n1\t1\t1\n").contains("no column `deviation_um`;"));
    }

    #[test]
    fn lines_without_values_are_part_of_the_grid() {
        let text = "surface,part,row,column,deviation_um\nleft,grid,1,1,2\nleft,grid,3,1,\nleft,grid,1,4,\n\
                    right,grid,9,9,1\nleft,profile,8,8,1\n";
        let found = read_measured(text, "left").expect("a table");
        assert_eq!((found.counts, found.points.len()), ([3, 4], 1));
        let nowhere = read_measured("row,column,deviation_um\n1,1,2\n2,last,\n", "left").expect_err("no column");
        assert_eq!(nowhere.to_string(), "line 3: `last` is no row or column, which count from 1 to at most 10000");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let told = |text: &str| read_measured(text, "left").expect_err("a fault").to_string();
        assert!(told("row,x,y,z\n").contains("no column `column`"));
        assert_eq!(told("# nothing\n"), "it is empty");
        assert!(told("row,column,x,y\n1,1,0,0\n").contains("no column `z`"));
        assert_eq!(
            told("row,column,deviation_um\n1,1,2\n1,two,3\n"),
            "line 3: `two` is no row or column, which count from 1 to at most 10000"
        );
        assert_eq!(
            told("row,column,deviation_um\n0,1,2\n"),
            "line 2: `0` is no row or column, which count from 1 to at most 10000"
        );
        assert_eq!(told("row,column,deviation_um\n1,1,nan\n"), "line 2: `nan` is no number");
        assert_eq!(told("row,column,deviation_um\n1,1,1\n1,1,2\n"), "line 3: row 1, column 1 is there already");
        assert_eq!(told("row,column,x,y,z,x\n1,1,0,0,0,1\n"), "two columns are called `x`");
        assert_eq!(told("row,column,deviation_um\n"), "no line is about the grid of `left`");
        assert!(told("row,column,deviation_um\n1,1\n").contains("found record with 2 fields"));
    }
}
