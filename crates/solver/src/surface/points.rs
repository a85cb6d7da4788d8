//! Solved points of a surface, without an allocation for each of them.

use crate::continuation::field::Field;
use crate::equations::solution::Outcome;

/// A point that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The verdict; the other fields describe a point of the surface only if it is [`Outcome::Solved`], or one of the surface that is
    /// no point of the finished work if it is [`Outcome::CutAway`] or [`Outcome::Undecided`].
    pub outcome: Outcome,
    /// The surface's unknowns, mm or radians.
    pub unknowns: Vec<f64>,
    /// Position, mm, in the frame of the surface.
    pub position: [f64; 3],
    /// Unit vector out of the body that owns the surface.
    pub normal: [f64; 3],
    /// The largest residual, mm or mm per radian.
    pub residual: f64,
}

/// Points that were asked for, in the order of their targets.
#[derive(Clone, Debug)]
pub struct SurfacePoints {
    /// With position and normal of each.
    pub(crate) field: Field,
    /// What is told of points that nothing came near.
    pub(crate) middle: Vec<f64>,
}

impl SurfacePoints {
    /// How many.
    pub fn len(&self) -> usize {
        self.field.len()
    }

    /// Whether none was asked for.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many are solved.
    pub fn solved(&self) -> usize {
        self.field.solved()
    }

    /// The verdict; it says what the rest describes, as that of a [`SurfacePoint`] does.
    ///
    /// # Panics
    /// If there is no such point, as for all that follow.
    pub fn outcome(&self, point: usize) -> Outcome {
        self.field.outcome(point).unwrap_or(Outcome::NotConverged { iterations: 0 })
    }

    /// The surface's unknowns, mm or radians.
    pub fn unknowns(&self, point: usize) -> Vec<f64> {
        if self.field.outcome(point).is_some() { self.field.unknowns(point).collect() } else { self.middle.clone() }
    }

    /// Position, mm, in the frame of the surface, then the unit normal out of the body that owns the surface.
    pub fn position_and_normal(&self, point: usize) -> [f64; 6] {
        std::array::from_fn(|k| self.field.extra(point, k))
    }

    /// The principal curvatures, the larger one first, 1/mm, positive where the body that owns the surface is convex. `None` if
    /// the problem was not made with them, if the surface has more than four unknowns, and where the coordinates do not fix
    /// a point: then [`SurfaceGeometry`](crate::SurfaceGeometry) may tell.
    pub fn principal_curvatures(&self, point: usize) -> Option<[f64; 2]> {
        let found = [6, 7].map(|k| self.field.extra(point, k));
        found.iter().all(|curvature| curvature.is_finite()).then_some(found)
    }

    /// The largest residual, mm or mm per radian.
    pub fn residual(&self, point: usize) -> f64 {
        self.field.residual(point)
    }

    /// All of that for all points, in the memory of others that are not needed any more.
    pub fn write_to(&self, points: &mut Vec<SurfacePoint>) {
        points.truncate(self.len());
        for (number, point) in points.iter_mut().enumerate() {
            let mut unknowns = std::mem::take(&mut point.unknowns);
            unknowns.clear();
            match self.field.outcome(number) {
                Some(_) => unknowns.extend(self.field.unknowns(number)),
                None => unknowns.extend(&self.middle),
            }
            *point = self.placed(number, unknowns);
        }
        points.extend((points.len()..self.len()).map(|number| self.point(number)));
    }

    /// All of that for one point.
    pub fn point(&self, point: usize) -> SurfacePoint {
        self.placed(point, self.unknowns(point))
    }

    fn placed(&self, point: usize, unknowns: Vec<f64>) -> SurfacePoint {
        let [x, y, z, nx, ny, nz] = self.position_and_normal(point);
        SurfacePoint {
            outcome: self.outcome(point),
            unknowns,
            position: [x, y, z],
            normal: [nx, ny, nz],
            residual: self.residual(point),
        }
    }
}
