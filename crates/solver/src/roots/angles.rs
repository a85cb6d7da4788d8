//! A system as a search of its roots reads it: each angle that several unknowns turn is an unknown of its own.
//!
//! A hob's thread and its spindle turn one angle. A box of the two says little of their sum's sine before both are small; with the
//! sum as a third unknown, and an equation that is linear in all three, boxes are divided where it matters.

use flank_expr::{Expr, Interval, IntervalEvaluator, Tape, TapeError};

use crate::equations::solution::{Range, Solution};
use crate::equations::system::System;
use crate::roots::enclosure::box_of;
use crate::roots::{Isolated, Roots, Undecided, all_roots};

/// Keeps a box that was made smaller to fit inside another one, rounding errors or not.
const INSIDE: f64 = 1.0 - 1e-9;

/// A system with the angles that several of its unknowns turn as further unknowns.
#[derive(Clone, Debug)]
pub(crate) struct SearchSystem {
    /// Unknowns, then angles; equations, then one for each angle.
    system: System,
    /// The angles as functions of unknowns and parameters.
    angles: Tape,
    /// How far each angle turns with each unknown.
    turns: Vec<Vec<f64>>,
}

impl SearchSystem {
    /// For the roots of `residuals` in `unknowns`, with the `conditions` of [`System::with_conditions`]; `None` if no angle is
    /// turned by several unknowns.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a parameter.
    pub(crate) fn new<'g>(
        residuals: &[Expr<'g>],
        unknowns: &[Expr<'g>],
        parameters: &[Expr<'g>],
        conditions: &[Expr<'g>],
    ) -> Result<Option<SearchSystem>, TapeError> {
        let graph = unknowns[0].graph();
        let mut replaced: Vec<(Expr<'g>, Expr<'g>)> = Vec::new();
        let mut turns = Vec::new();
        for angle in graph.angles_in(residuals) {
            let slopes: Option<Vec<f64>> = unknowns.iter().map(|x| angle.derivative(*x).as_constant()).collect();
            if let Some(slopes) = slopes.filter(|slopes| slopes.iter().filter(|slope| **slope != 0.0).count() > 1) {
                replaced.push((angle, graph.variable(format!("angle {}", turns.len() + 1))));
                turns.push(slopes);
            }
        }
        if replaced.is_empty() {
            return Ok(None);
        }
        let mut equations = graph.substitute(residuals, &replaced);
        equations.extend(replaced.iter().map(|(angle, variable)| *variable - *angle));
        let all: Vec<Expr<'g>> =
            unknowns.iter().copied().chain(replaced.iter().map(|(_, variable)| *variable)).collect();
        let angles: Vec<Expr<'g>> = replaced.iter().map(|(angle, _)| *angle).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(parameters).copied().collect();
        let searched: Vec<Expr<'g>> = all.iter().chain(parameters).copied().collect();
        let system = System::one_by_one(&equations, &all, parameters)?.with_conditions(
            &equations,
            conditions,
            &[],
            &searched,
        )?;
        Ok(Some(SearchSystem { system, angles: Tape::new(&angles, &inputs)?, turns }))
    }

    /// The same with other numbers for the settings of its tapes.
    pub(crate) fn with_settings(&self, values: &[f64]) -> SearchSystem {
        SearchSystem {
            system: self.system.with_settings(values),
            angles: self.angles.with_settings(values),
            turns: self.turns.clone(),
        }
    }

    /// All roots in ranges of the unknowns; see [`all_roots`].
    pub(crate) fn all_roots(&self, ranges: &[Range], parameters: &[f64], most_boxes: u64) -> Roots {
        let mut inputs = box_of(ranges);
        inputs.extend(parameters.iter().copied().map(Interval::point));
        let mut angles = vec![Interval::WHOLE; self.turns.len()];
        IntervalEvaluator::new(&self.angles).run(&inputs, &mut angles);
        let mut all = ranges.to_vec();
        all.extend(angles.iter().map(|angle| Range { low: angle.lo, high: angle.hi }));
        let roots = all_roots(&self.system, &all, parameters, most_boxes);
        let size = ranges.len();
        let without_angles = |mut solution: Solution| {
            solution.unknowns.truncate(size);
            solution
        };
        Roots {
            isolated: roots
                .isolated
                .into_iter()
                .map(|root| Isolated {
                    alone_within: self.without_angles(&root.alone_within, size),
                    solution: without_angles(root.solution),
                })
                .collect(),
            unproven: roots.unproven.into_iter().map(without_angles).collect(),
            undecided: roots
                .undecided
                .into_iter()
                .map(|left| Undecided { ranges: left.ranges[..size].to_vec(), why: left.why })
                .collect(),
            boxes: roots.boxes,
        }
    }

    /// Half the sides of a box of unknowns whose angles stay in the box that is given with them.
    fn without_angles(&self, radii: &[f64], size: usize) -> Vec<f64> {
        let (unknowns, angles) = radii.split_at(size);
        let turned = |slopes: &[f64]| -> f64 { slopes.iter().zip(unknowns).map(|(slope, r)| slope.abs() * r).sum() };
        let share = |(slopes, radius): (&Vec<f64>, &f64)| INSIDE * radius / turned(slopes);
        let share = self.turns.iter().zip(angles).map(share).fold(1.0, f64::min);
        unknowns.iter().map(|radius| share * radius).collect()
    }
}
