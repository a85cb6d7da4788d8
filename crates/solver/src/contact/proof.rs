//! Proofs that two flanks touch where they are said to.

use flank_expr::{Interval, IntervalEvaluator};
use rayon::prelude::*;

use crate::contact::ContactProblem;
use crate::contact::point::{ContactPoint, POSITION};
use crate::roots::enclosure::{Enclosure, around};

/// How near to a computed contact exactly one solution of its equations is proven to lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactProof {
    /// Of the lag, at most.
    pub lag: f64,
    /// Of the point, mm, at most.
    pub position: f64,
}

impl ContactProblem {
    /// What is proven of contacts at their roll positions, with the flanks or edges that touch there: Krawczyk's operator on a box about the
    /// unknowns of both flanks and the lag, rounded outward, of the equations as they are stored. `None` where nothing is proven,
    /// as along a line of contact. On as many threads as there are.
    pub fn proven(&self, points: &[ContactPoint]) -> Vec<Option<ContactProof>> {
        points.par_iter().map(|point| self.proof_of(point)).collect()
    }

    fn proof_of(&self, point: &ContactPoint) -> Option<ContactProof> {
        let (system, parameters) = self.equations(&point.edges, point.roll, &point.first_normal.into())?;
        let unknowns = point.all_unknowns();
        let radii = Enclosure::new(system, &parameters).proven_radii(&unknowns)?;
        let boxed = unknowns.iter().zip(&radii).map(|(p, radius)| around(*p, *radius));
        let inputs: Vec<Interval> = boxed.chain(self.given(point.roll).map(Interval::point)).collect();
        let mut state = vec![Interval::WHOLE; self.state.output_count()];
        IntervalEvaluator::new(&self.state).run(&inputs, &mut state);
        let off = state[POSITION].iter().zip(point.position).map(|(at, x)| (*at - Interval::point(x)).squared());
        let position = off.fold(Interval::point(0.0), |sum, square| sum + square).sqrt().hi;
        position.is_finite().then_some(ContactProof { lag: radii[self.lag_at()], position })
    }
}
