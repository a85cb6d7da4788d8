//! Whole lines of points, computed and tested at once: where they are expected, or where the targets of line and lane give them.

use flank_expr::{InstructionSet, LaneEvaluator, LaneTape};

use crate::equations::solution::Range;
use crate::equations::system::System;
use crate::newton::batch::Lanes;

/// What looks at such lines.
pub(crate) struct Expected<'s> {
    evaluator: LaneEvaluator<'s>,
    instructions: InstructionSet,
    /// Numbers of the unknowns that are not in closed form.
    pub(crate) open: Vec<usize>,
    determinant: usize,
}

impl<'s> Expected<'s> {
    /// `determinant` is the number of that input, the one after unknowns and parameters. `given` are the numbers of the unknowns in
    /// closed form.
    pub(crate) fn new(
        tape: &'s LaneTape,
        instructions: InstructionSet,
        ranges: &[Range],
        determinant: usize,
        given: &[usize],
    ) -> Expected<'s> {
        let mut evaluator = LaneEvaluator::new(tape, instructions);
        let size = ranges.len();
        for (k, range) in ranges.iter().enumerate() {
            evaluator.set_uniform(determinant + 1 + k, range.low);
            evaluator.set_uniform(determinant + 1 + size + k, range.high);
        }
        Expected { evaluator, instructions, open: (0..size).filter(|k| !given.contains(k)).collect(), determinant }
    }

    pub(crate) fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// What is expected of an unknown or, after the unknowns, a parameter.
    #[inline]
    pub(crate) fn input(&mut self, k: usize) -> &mut Lanes {
        self.evaluator.input(k)
    }

    /// The determinants, no numbers where they may vanish.
    #[inline]
    pub(crate) fn determinant(&mut self) -> &mut Lanes {
        self.evaluator.input(self.determinant)
    }

    /// The numbers of the first lanes; whether all are plain roots.
    pub(crate) fn run(&mut self, count: usize, out: &mut [Lanes]) -> bool {
        self.evaluator.run_into(count, out);
        are_plain(self.evaluator.output(out.len()), count)
    }
}

/// What computes such lines.
pub(crate) struct OnLine<'s> {
    evaluator: LaneEvaluator<'s>,
    instructions: InstructionSet,
    size: usize,
    /// The sign of the determinants around there.
    side: f64,
}

impl<'s> OnLine<'s> {
    /// None if equations do not give all unknowns.
    pub(crate) fn new(system: &'s System, ranges: &[Range], instructions: InstructionSet) -> Option<OnLine<'s>> {
        let tape = system.lanes.given.as_ref()?.on_lines.as_ref()?;
        let mut evaluator = LaneEvaluator::new(tape, instructions);
        let size = ranges.len();
        for (k, range) in ranges.iter().enumerate() {
            for (kind, value) in [range.width(), range.low, range.high].into_iter().enumerate() {
                evaluator.set_uniform(size + 2 + kind * size + k, value);
            }
        }
        Some(OnLine { evaluator, instructions, size, side: 0.0 })
    }

    /// What follows from the first target of a line, if it is the same on all of the line, and the second ones are those of another.
    pub(crate) fn prepared(&mut self, line: &[[f64; 2]], other: &[[f64; 2]]) -> Option<Vec<f64>> {
        let first = line.first()?[0];
        let differs = |(target, other): (&[f64; 2], &[f64; 2])| (target[0] != first) | (target[1] != other[1]);
        let is_other = self.instructions.dispatch(
            #[inline(always)]
            || line.iter().zip(other).map(differs).fold(false, |any, differs| any | differs),
        );
        if is_other {
            return None;
        }
        let mut prepared = Vec::new();
        self.evaluator.set_uniform(self.size, first);
        self.evaluator.prepare(&mut prepared);
        Some(prepared)
    }

    /// The second targets, for all lines that follow.
    pub(crate) fn set_second_targets(&mut self, targets: &Lanes) {
        *self.evaluator.input(self.size + 1) = *targets;
    }

    /// A determinant around there, for all lines that follow.
    pub(crate) fn set_determinant(&mut self, determinant: f64) {
        // not anew what depends on the lane alone
        if determinant.signum() != self.side {
            self.side = determinant.signum();
            self.evaluator.input(4 * self.size + 2).fill(self.side);
        }
    }

    /// The numbers of the first lanes of a line by what [`OnLine::prepared`] has found for it; whether all are plain roots.
    pub(crate) fn run(&mut self, prepared: &[f64], count: usize, out: &mut [Lanes]) -> bool {
        self.evaluator.set_prepared(prepared);
        self.evaluator.run_into(count, out);
        are_plain(self.evaluator.output(out.len()), count)
    }
}

/// Whether the first points are plain roots by their verdicts.
#[inline]
fn are_plain(verdicts: &Lanes, count: usize) -> bool {
    verdicts[..count].iter().fold(true, |all, verdict| all & (*verdict <= 0.0))
}
