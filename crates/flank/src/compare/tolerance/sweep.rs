//! Random cases that linear tolerances are held against.

use flank_chain_dsl::{Job, Parameter};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{GaussianDraw, Scatter};
use rayon::prelude::*;

use super::causes::{Cause, CausePlace};
use super::ease_off::Flank;
use super::mating::Mating;
use super::result::SweptResult;
use crate::project::failure::Failure;
use crate::project::session::Session;

/// Cases between two looks at whether the work is cancelled.
const TOGETHER: usize = 64;
/// The same cases in every run.
const SEED: u64 = 0;

/// What is solved anew in each case.
pub(super) struct Swept<'a> {
    causes: &'a [Cause],
    flank: &'a Flank,
    contacts: &'a [Mating],
    /// What each cause may be at the least and at the most, as the spec has it.
    ranges: Vec<Option<(f64, f64)>>,
    /// All settings that are no counts, from those that scatter.
    following: Tape,
}

/// By how much each cause is off, in so many cases.
pub(super) fn drawn(scatter: &Scatter, count: u32) -> Vec<Vec<f64>> {
    let mut draw = GaussianDraw::new(SEED);
    (0..count).map(|_| scatter.drawn(&mut draw)).collect()
}

impl<'a> Swept<'a> {
    pub(super) fn new<'g>(
        job: &Job<'g>,
        causes: &'a [Cause],
        (flank, contacts): (&'a Flank, &'a [Mating]),
    ) -> Swept<'a> {
        let open: Vec<Expr<'g>> = causes.iter().filter_map(|of| of.setting(job)).map(|of| of.variable).collect();
        let bindings = job.bindings_beside(&open);
        let value = |of: &Parameter<'g>| {
            bindings.iter().find(|(variable, _)| *variable == of.variable).map_or(of.variable, |(_, value)| *value)
        };
        let all: Vec<Expr<'g>> = job.parameters.iter().filter(|of| !of.is_count).map(value).collect();
        let following = Tape::new(&all, &open).expect("a job without errors leaves nothing unbound");
        let ranges = causes.iter().map(|of| of.setting(job).and_then(|setting| setting.range)).collect();
        Swept { causes, flank, contacts, ranges, following }
    }

    /// In each case the change of each number; `None` where something has no solution.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn cases(&self, drawn: &[Vec<f64>], session: Session<'_>) -> Result<Vec<Option<Vec<f64>>>, Failure> {
        let mut found = Vec::with_capacity(drawn.len());
        for cases in drawn.chunks(TOGETHER) {
            session.check()?;
            found.par_extend(cases.par_iter().map(|off| self.case(off)));
        }
        Ok(found)
    }

    /// Whether a setting has a value that its spec refuses.
    pub(super) fn is_beyond(&self, off: &[f64]) -> bool {
        let mut values = self.causes.iter().zip(off).zip(&self.ranges);
        values.any(|((of, off), range)| range.is_some_and(|(low, high)| !(low..=high).contains(&(of.value + off))))
    }

    fn case(&self, off: &[f64]) -> Option<Vec<f64>> {
        let is_setting = |cause: &&Cause| matches!(cause.at, CausePlace::Setting(_));
        let values: Vec<f64> =
            self.causes.iter().zip(off).filter(|(of, _)| is_setting(of)).map(|(of, off)| of.value + off).collect();
        let mut numbers = self.flank.with(&values)?;
        if self.contacts.is_empty() {
            return Some(numbers);
        }
        let mut settings = vec![0.0; self.following.output_count()];
        ScalarEvaluator::new(&self.following).run(&values, &mut settings);
        let error = |axis: &str| {
            let mut axes = self.causes.iter().zip(off).filter(|(of, _)| !is_setting(of));
            axes.find(|(of, _)| of.name == axis).map_or(0.0, |(_, off)| *off)
        };
        for contact in self.contacts {
            numbers.extend(contact.with(&error, &settings)?);
        }
        Some(numbers)
    }
}

/// What the cases that were solved show of one number; `None` with less than two.
pub(super) fn shown(cases: &[Option<Vec<f64>>], at: usize) -> Option<SweptResult> {
    let all: Vec<f64> = cases.iter().flatten().map(|numbers| numbers[at]).collect();
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    let squares: f64 = all.iter().map(|x| (x - mean).powi(2)).sum();
    (all.len() > 1).then(|| SweptResult {
        mean,
        standard_deviation: (squares / (count - 1.0)).sqrt(),
        lowest: all.iter().copied().fold(f64::INFINITY, f64::min),
        highest: all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    })
}
