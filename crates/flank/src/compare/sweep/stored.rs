//! Chunks as they lie in the folder of a study. Disks fill, copies break off, and files are edited: rows count only where they are those of
//! the plan.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use flank_export::CellKind;

use super::plan::{CHUNKS, Plan};
use super::row::VERDICTS;

/// A chunk of a study.
pub(super) struct StoredChunk {
    /// Of its cases; its file is called so.
    pub(super) hash: String,
    pub(super) file: PathBuf,
    pub(super) rows: StoredRows,
}

/// What a file holds of a chunk.
pub(super) enum StoredRows {
    Missing,
    /// A file that does not hold the rows of the plan.
    Damaged,
    /// The whole text, with its head.
    Whole(String),
}

impl Plan {
    /// Reads a chunk.
    pub(super) fn stored(&self, folder: &Path, chunk: usize) -> StoredChunk {
        let cases = self.hashes_of_cases(chunk);
        let hash = self.hash_of_chunk(chunk, &cases);
        let file = folder.join(CHUNKS).join(format!("{hash}.csv"));
        let rows = match std::fs::read_to_string(&file) {
            Ok(text) if self.is_whole(&text, chunk, &cases) => StoredRows::Whole(text),
            Err(reason) if reason.kind() == ErrorKind::NotFound => StoredRows::Missing,
            _ => StoredRows::Damaged,
        };
        StoredChunk { hash, file, rows }
    }

    /// Whether a text has one row for each case of a chunk, in their order.
    fn is_whole(&self, text: &str, chunk: usize, cases: &[String]) -> bool {
        let Some((head, rows)) = text.strip_suffix('\n').and_then(|text| text.split_once('\n')) else { return false };
        let kinds: Vec<CellKind> = self.columns().into_iter().map(|(_, kind)| kind).collect();
        let mut rows = rows.split('\n');
        let has_each = self.numbers(chunk).zip(cases).all(|(number, case)| {
            let is_this = |row: &str| {
                let rest = row.strip_prefix(case.as_str()).and_then(|rest| rest.strip_prefix(','));
                rest.and_then(|rest| rest.split_once(',')).is_some_and(|(own, _)| own == number.to_string())
            };
            rows.next().is_some_and(|row| is_this(row) && self.has_verdict(row) && has_cells(row, &kinds))
        });
        head == self.head() && has_each && rows.next().is_none()
    }

    fn has_verdict(&self, row: &str) -> bool {
        VERDICTS.contains(&self.verdict_of(row))
    }

    /// The verdict in a row.
    pub(super) fn verdict_of<'r>(&self, row: &'r str) -> &'r str {
        row.split(',').nth(2 + self.inputs.len()).unwrap_or_default()
    }

    /// What a row says of its verdict.
    pub(super) fn why_of<'r>(&self, row: &'r str) -> &'r str {
        row.split(',').nth(3 + self.inputs.len()).unwrap_or_default()
    }
}

/// Whether there is a cell for each column, and a number or nothing where there are numbers.
fn has_cells(row: &str, kinds: &[CellKind]) -> bool {
    let mut cells = row.split(',');
    let is_right = |cell: &str, kind: &CellKind| match kind {
        CellKind::Number => cell.is_empty() || cell.parse::<f64>().is_ok(),
        CellKind::Text | CellKind::Count => true,
    };
    kinds.iter().all(|kind| cells.next().is_some_and(|cell| is_right(cell, kind))) && cells.next().is_none()
}
