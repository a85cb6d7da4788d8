//! How much of what was asked for was solved.

use std::collections::BTreeMap;

use crate::conventions::one_line;
use crate::dataset::{Outcome, Patch};
use crate::number::shortest;

/// Counts over some points, and the largest residual among those solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tally {
    /// Points asked for.
    pub asked: usize,
    /// Points solved.
    pub solved: usize,
    /// Largest residual of a solved point, by absolute value; `None` where nothing was solved.
    pub worst_residual: Option<f64>,
    /// How many points carry each status word other than `solved`.
    pub unsolved: BTreeMap<&'static str, usize>,
}

impl Tally {
    /// Counts the points of one or more patches.
    pub fn of<'a>(patches: impl IntoIterator<Item = &'a Patch>) -> Self {
        let mut tally = Tally::default();
        for point in patches.into_iter().flat_map(|patch| &patch.points) {
            tally.asked += 1;
            match point.outcome {
                Outcome::Solved => {
                    tally.solved += 1;
                    let residual = point.residual.abs();
                    tally.worst_residual = Some(tally.worst_residual.map_or(residual, |worst| worst.max(residual)));
                }
                Outcome::Unsolved(word) => *tally.unsolved.entry(word).or_default() += 1,
            }
        }
        tally
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
