//! How much of what was asked for was solved.

use std::collections::BTreeMap;

use crate::points::dataset::{Outcome, Patch, Point};
use crate::text::number::shortest;
use crate::text::one_line;

/// Counts over some points, and the largest residual among those solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tally {
    /// Points asked for.
    pub asked: usize,
    /// Points solved.
    pub solved: usize,
    /// Points with numbers: these, and those that are undercut, trimmed or undecided.
    pub placed: usize,
    /// Largest residual of a solved point, by absolute value; `None` where nothing was solved.
    pub worst_residual: Option<f64>,
    /// How many points carry each status word other than `solved`.
    pub unsolved: BTreeMap<&'static str, usize>,
}

impl Tally {
    /// Counts the points of one or more patches.
    pub fn of_patches<'a>(patches: impl IntoIterator<Item = &'a Patch>) -> Self {
        let mut tally = Tally::default();
        patches.into_iter().flat_map(|patch| &patch.points).for_each(|point| tally.count(point));
        tally
    }

    /// Counts one more point.
    pub(crate) fn count(&mut self, point: &Point) {
        self.asked += 1;
        self.placed += usize::from(point.is_placed());
        match point.outcome {
            Outcome::Solved => {
                self.solved += 1;
                self.saw_residual(point.residual.abs());
            }
            other => *self.unsolved.entry(other.word()).or_default() += 1,
        }
    }

    /// Counts what another tally has counted.
    pub(crate) fn add(&mut self, other: &Tally) {
        self.asked += other.asked;
        self.solved += other.solved;
        self.placed += other.placed;
        other.worst_residual.into_iter().for_each(|residual| self.saw_residual(residual));
        other.unsolved.iter().for_each(|(word, count)| *self.unsolved.entry(word).or_default() += count);
    }

    fn saw_residual(&mut self, residual: f64) {
        self.worst_residual = Some(self.worst_residual.map_or(residual, |worst| worst.max(residual)));
    }

    /// Why points are missing, such as `outside 3, singular 1`; empty where none is.
    #[must_use]
    pub fn reasons(&self) -> String {
        let words: Vec<String> = self.unsolved.iter().map(|(word, count)| format!("{word} {count}")).collect();
        words.join(", ")
    }

    /// How many were solved of how many, why the others were not, and the worst residual; one line.
    pub(crate) fn verdict(&self) -> String {
        let mut text = format!("solved {} of {} asked", self.solved, self.asked);
        if !self.unsolved.is_empty() {
            text += &format!(" ({})", one_line(&self.reasons()));
        }
        match self.worst_residual {
            Some(worst) => text + ", worst residual " + &shortest(worst),
            None => text,
        }
    }
}
