//! A surface whose settings are open: how far measured points lie off it, and how that changes with each setting.

pub(crate) mod choice;
pub(crate) mod fit;
pub(crate) mod shapes;

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, LANES, LaneEvaluator, LaneTape, Tape, TapeError};
use rayon::prelude::*;

use crate::analysis::deviation::FARTHEST;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::batch::LaneNewton;
use crate::newton::scalar::{LONGEST_STEP, solve};
use crate::surface::bound::BoundSurface;

/// A surface that depends on settings, which are given their values later: compiled once, as a [`SurfaceFamily`](crate::SurfaceFamily) is.
#[derive(Clone, Debug)]
pub struct AdjustableSurface {
    feet: FootSearch,
}

/// Looks for the feet of points on a surface whose settings have values.
#[derive(Clone, Debug)]
pub struct FootSearch {
    /// Unknowns of the surface and a distance along its normal; the point is a parameter.
    foot: System,
    /// Of the unknowns: position, normal, and how far the surface moves along it with each setting.
    at_foot: LaneTape,
    /// Of the unknowns and the distance.
    ranges: Vec<Range>,
    settings: usize,
}

/// So few points, a fifth of a millisecond, take less time than other threads take to wake.
const FEW: usize = 40 * LANES;

/// What one tile after the other is solved with.
struct Evaluators<'s> {
    newton: LaneNewton<'s>,
    at_foot: LaneEvaluator<'s>,
}

impl<'s> Evaluators<'s> {
    fn new(search: &'s FootSearch) -> Evaluators<'s> {
        Evaluators {
            newton: LaneNewton::new(&search.foot, &search.ranges),
            at_foot: LaneEvaluator::new(&search.at_foot, search.foot.instructions()),
        }
    }
}

/// Where a foot is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NearFoot {
    /// Of the surface.
    pub unknowns: Vec<f64>,
    /// How far the point lies off the surface, mm.
    pub distance: f64,
}

/// What a search for a foot starts from.
pub trait StartOfFoot: Sync {
    /// Of the surface.
    fn unknowns(&self) -> &[f64];
    /// How far the point lies off the surface, mm.
    fn distance(&self) -> f64;
}

impl StartOfFoot for NearFoot {
    fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }

    fn distance(&self) -> f64 {
        self.distance
    }
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

/// That of the same point on a surface that was moved a little.
impl StartOfFoot for Foot {
    fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }

    fn distance(&self) -> f64 {
        self.distance
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
        let moved = settings.iter().map(|setting| bound.normal.dot(bound.position.derivative(*setting)));
        let outputs: Vec<Expr<'g>> = bound.position.0.into_iter().chain(bound.normal.0).chain(moved).collect();
        // their values come with the points
        let open: Vec<(Expr<'g>, f64)> = settings.iter().map(|setting| (*setting, 0.0)).collect();
        graph.with_settings(&open, || {
            let foot = System::new(&residuals, &unknowns, &point)?;
            let at_foot = LaneTape::new(&Tape::new(&outputs, &bound.unknowns)?);
            // what has other values of the settings shares the machine code
            foot.translate();
            at_foot.translate(foot.instructions());
            let ranges = [surface.ranges(), &[FARTHEST]].concat();
            Ok(AdjustableSurface { feet: FootSearch { foot, at_foot, ranges, settings: settings.len() } })
        })
    }

    /// The surface with these values of the settings, in their order.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn at(&self, settings: &[f64]) -> FootSearch {
        let FootSearch { foot, at_foot, ranges, settings: count } = &self.feet;
        assert_eq!(settings.len(), *count, "a value for each setting");
        FootSearch {
            foot: foot.with_settings(settings),
            at_foot: at_foot.with_settings(settings),
            ranges: ranges.clone(),
            settings: *count,
        }
    }
}

impl FootSearch {
    /// The foot of each point, mm; `near` says where they are looked for. `None` where no normal within the ranges goes through the point.
    ///
    /// # Panics
    /// If there are not as many starts as points.
    pub fn feet(&self, points: &[[f64; 3]], near: &[impl StartOfFoot]) -> Vec<Option<Foot>> {
        assert_eq!(points.len(), near.len(), "a start for each point");
        let part = |(points, near)| self.part(points, near);
        if points.len() <= FEW {
            return part((points, near));
        }
        // whole tiles, and tools once for each thread
        let own = points.len().div_ceil(rayon::current_num_threads()).next_multiple_of(LANES);
        let parts: Vec<Vec<Option<Foot>>> = points.par_chunks(own).zip(near.par_chunks(own)).map(part).collect();
        parts.into_iter().flatten().collect()
    }

    fn part(&self, points: &[[f64; 3]], near: &[impl StartOfFoot]) -> Vec<Option<Foot>> {
        let mut evaluators = Evaluators::new(self);
        let mut feet = Vec::with_capacity(points.len());
        for (points, near) in points.chunks(LANES).zip(near.chunks(LANES)) {
            self.tile(&mut evaluators, (points, near), &mut feet);
        }
        feet
    }

    /// As many points as there are lanes at the most, at once; what needs care is solved alone.
    fn tile(
        &self,
        evaluators: &mut Evaluators<'_>,
        (points, near): (&[[f64; 3]], &[impl StartOfFoot]),
        feet: &mut Vec<Option<Foot>>,
    ) {
        let Evaluators { newton, at_foot } = evaluators;
        // nothing is known of it at these starts
        *newton.determinant() = [f64::NAN; LANES];
        for (lane, (point, near)) in points.iter().zip(near).enumerate() {
            newton.put(lane, near.unknowns().iter().copied().chain([near.distance()]), point);
        }
        newton.run(&[true; LANES][..points.len()], true);
        let roots: [Option<Vec<f64>>; LANES] = std::array::from_fn(|lane| {
            let (point, near) = (points.get(lane)?, near.get(lane)?);
            let is_near = newton.is_root(lane) && newton.moved(lane) <= LONGEST_STEP;
            match is_near && newton.outcome(lane) == Outcome::Solved {
                true => Some((0..self.ranges.len()).map(|k| newton.input(k)[lane]).collect()),
                false => self.root(*point, near),
            }
        });
        self.placed(at_foot, roots, points.len(), feet);
    }

    /// Unknowns and distance.
    fn root(&self, point: [f64; 3], near: &impl StartOfFoot) -> Option<Vec<f64>> {
        let start = [near.unknowns(), &[near.distance()][..]].concat();
        let solution = solve(&self.foot, &self.ranges, &point, &start);
        (solution.outcome == Outcome::Solved).then_some(solution.unknowns)
    }

    fn placed(
        &self,
        evaluator: &mut LaneEvaluator<'_>,
        roots: [Option<Vec<f64>>; LANES],
        count: usize,
        feet: &mut Vec<Option<Foot>>,
    ) {
        let size = self.ranges.len() - 1;
        for (lane, root) in roots[..count].iter().enumerate() {
            // where there is none nothing is read
            let known = root.iter().chain(roots.iter().flatten()).next();
            known.into_iter().for_each(|root| (0..size).for_each(|k| evaluator.input(k)[lane] = root[k]));
        }
        evaluator.run_first(count);
        let output = |k: usize, lane: usize| evaluator.output(k)[lane];
        let foot = |(lane, root): (usize, Option<Vec<f64>>)| {
            let mut unknowns = root?;
            let distance = unknowns.pop()?;
            Some(Foot {
                unknowns,
                position: std::array::from_fn(|k| output(k, lane)),
                normal: std::array::from_fn(|k| output(3 + k, lane)),
                distance,
                moved: (0..self.settings).map(|k| output(6 + k, lane)).collect(),
            })
        };
        feet.extend(roots.into_iter().take(count).enumerate().map(foot));
    }
}
