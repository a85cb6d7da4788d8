//! A surface whose settings are open: how far measured points lie off it, and how that changes with each setting.

pub(crate) mod choice;
pub(crate) mod fit;
pub(crate) mod shapes;

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};
use rayon::prelude::*;

use crate::analysis::deviation::FARTHEST;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::scalar::solve;
use crate::surface::bound::BoundSurface;

/// Points that a thread takes at a time.
const TOGETHER: usize = 16;

/// A surface that depends on settings, which are given their values later.
#[derive(Clone, Debug)]
pub struct AdjustableSurface {
    /// Unknowns of the surface and a distance along its normal; the point and the settings are parameters.
    foot: System,
    /// Of the unknowns and the settings: position, normal, and how far the surface moves along it with each setting.
    at_foot: Tape,
    ranges: Vec<Range>,
    settings: usize,
}

/// Where a foot is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NearFoot {
    /// Of the surface.
    pub unknowns: Vec<f64>,
    /// How far the point lies off the surface, mm.
    pub distance: f64,
}

/// Where the surface's normal goes through a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Of the surface.
    pub unknowns: Vec<f64>,
    /// On the surface, mm.
    pub position: [f64; 3],
    /// Of unit length, out of the body.
    pub normal: [f64; 3],
    /// How far the point lies off the surface, mm: positive on the side to which the normal points.
    pub distance: f64,
    /// mm that the surface moves along its normal per unit of each setting.
    pub moved: Vec<f64>,
}

impl Foot {
    pub(super) fn near(&self) -> NearFoot {
        NearFoot { unknowns: self.unknowns.clone(), distance: self.distance }
    }
}

impl AdjustableSurface {
    /// Of a surface in which all parameters have values but these settings, or follow from them. Feet are looked for within its ranges.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a setting nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn new<'g>(surface: &BoundSurface<'g>, settings: &[Expr<'g>]) -> Result<AdjustableSurface, TapeError> {
        let bound = surface.surface();
        let graph = bound.position.0[0].graph();
        let point = ["point x", "point y", "point z"].map(|name| graph.variable(name));
        let distance = graph.variable("distance");
        let reached = bound.position + bound.normal.map(|part| part * distance);
        let residuals = surface.constrained((reached - Vector3(point)).0);
        let unknowns: Vec<Expr<'g>> = bound.unknowns.iter().copied().chain([distance]).collect();
        let parameters: Vec<Expr<'g>> = point.into_iter().chain(settings.iter().copied()).collect();
        let moved = settings.iter().map(|setting| bound.normal.dot(bound.position.derivative(*setting)));
        let outputs: Vec<Expr<'g>> = bound.position.0.into_iter().chain(bound.normal.0).chain(moved).collect();
        let inputs: Vec<Expr<'g>> = bound.unknowns.iter().chain(settings).copied().collect();
        Ok(AdjustableSurface {
            foot: System::one_by_one(&residuals, &unknowns, &parameters)?,
            at_foot: Tape::new(&outputs, &inputs)?,
            ranges: surface.ranges().to_vec(),
            settings: settings.len(),
        })
    }

    /// The foot of each point, mm, of the surface with these settings; `near` says where they are looked for. `None`
    /// where no normal within the ranges goes through the point.
    ///
    /// # Panics
    /// If there are not as many starts as points, or not as many settings as the surface has.
    pub fn feet(&self, settings: &[f64], points: &[[f64; 3]], near: &[NearFoot]) -> Vec<Option<Foot>> {
        assert_eq!((points.len(), settings.len()), (near.len(), self.settings), "a start for each point");
        let tiles = points.par_chunks(TOGETHER).zip(near.par_chunks(TOGETHER));
        let ranges = [&self.ranges[..], &[FARTHEST]].concat();
        let tile = |(points, near): (&[[f64; 3]], &[NearFoot])| -> Vec<Option<Foot>> {
            let mut evaluator = ScalarEvaluator::new(&self.at_foot);
            let pairs = points.iter().zip(near);
            pairs.map(|(point, near)| self.foot_of(settings, (*point, near), (&ranges, &mut evaluator))).collect()
        };
        tiles.flat_map_iter(tile).collect()
    }

    fn foot_of(
        &self,
        settings: &[f64],
        (point, near): ([f64; 3], &NearFoot),
        (ranges, evaluator): (&[Range], &mut ScalarEvaluator<'_>),
    ) -> Option<Foot> {
        let parameters = [&point, settings].concat();
        let start = [&near.unknowns, &[near.distance][..]].concat();
        let solution = solve(&self.foot, ranges, &parameters, &start);
        let (distance, unknowns) = solution.unknowns.split_last().filter(|_| solution.outcome == Outcome::Solved)?;
        let mut out = vec![0.0; 6 + self.settings];
        evaluator.run(&[unknowns, settings].concat(), &mut out);
        let moved = out.split_off(6);
        Some(Foot {
            unknowns: unknowns.to_vec(),
            position: std::array::from_fn(|k| out[k]),
            normal: std::array::from_fn(|k| out[3 + k]),
            distance: *distance,
            moved,
        })
    }
}
