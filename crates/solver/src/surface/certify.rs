//! Proofs that a point is where it is said to be.

use flank_expr::{Interval, IntervalEvaluator};

use crate::roots::enclosure::{Enclosure, around};
use crate::surface::SurfaceProblem;
use crate::surface::points::SurfacePoint;

/// Certifies points of one surface.
///
/// Krawczyk's operator on a box about the computed unknowns proves that exactly one root lies in it; the radius is how far,
/// at most, the surface at that root lies from the computed position. All bounds are rounded outward, of the equations as
/// they are stored: the conversion of the spec's decimals to floats is not part of the proof.
pub struct Certifier<'p> {
    enclosure: Enclosure<'p>,
    point: IntervalEvaluator<'p>,
    at: Vec<Interval>,
}

impl SurfaceProblem {
    /// Something that certifies points of this surface.
    pub fn certifier(&self) -> Certifier<'_> {
        let (system, point) = (self.system(), self.point_tape());
        Certifier {
            enclosure: Enclosure::new(system, &[0.0; 2]),
            point: IntervalEvaluator::new(point),
            at: vec![Interval::WHOLE; point.output_count()],
        }
    }
}

impl Certifier<'_> {
    /// The radius in mm about a point within which the one exact point of the surface with these two targets is proven to
    /// lie; `None` if that cannot be proven.
    pub fn radius(&mut self, target: [f64; 2], point: &SurfacePoint) -> Option<f64> {
        self.enclosure.set_parameters(&target);
        let radii = self.enclosure.proven_radii(&point.unknowns)?;
        Some(self.spread(point, &radii)).filter(|radius| radius.is_finite())
    }

    /// How far the position may be from the computed one while the unknowns stay in their box.
    fn spread(&mut self, point: &SurfacePoint, radii: &[f64]) -> f64 {
        let boxed: Vec<Interval> = point.unknowns.iter().zip(radii).map(|(p, r)| around(*p, *r)).collect();
        self.point.run(&boxed, &mut self.at);
        let off = self.at.iter().zip(point.position).map(|(at, computed)| (*at - Interval::point(computed)).squared());
        off.fold(Interval::point(0.0), |sum, square| sum + square).sqrt().hi
    }
}
