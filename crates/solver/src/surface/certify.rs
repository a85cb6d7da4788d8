//! Proofs that a point is where it is said to be.

use flank_expr::{Interval, IntervalEvaluator};

use crate::roots::enclosure::{Enclosure, Proof, around};
use crate::surface::SurfaceProblem;
use crate::surface::points::SurfacePoint;

/// Widenings of the box about a point that are tried; each makes it four times as wide.
const WIDENINGS: u32 = 8;
/// The smallest radius, as a share of an unknown: a few units in the last place.
const LEAST_SHARE: f64 = 1e-15;

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
        let steps = self.enclosure.newton_reach(&point.unknowns)?;
        let least = |p: &f64| LEAST_SHARE * p.abs().max(f64::MIN_POSITIVE / LEAST_SHARE);
        let mut radii: Vec<f64> = steps.iter().zip(&point.unknowns).map(|(step, p)| 2.0 * step + least(p)).collect();
        for _ in 0..WIDENINGS {
            if self.enclosure.proof(&point.unknowns, &radii) == Proof::ExactlyOne {
                return Some(self.spread(point, &radii)).filter(|radius| radius.is_finite());
            }
            radii.iter_mut().for_each(|radius| *radius *= 4.0);
        }
        None
    }

    /// How far the position may be from the computed one while the unknowns stay in their box.
    fn spread(&mut self, point: &SurfacePoint, radii: &[f64]) -> f64 {
        let boxed: Vec<Interval> = point.unknowns.iter().zip(radii).map(|(p, r)| around(*p, *r)).collect();
        self.point.run(&boxed, &mut self.at);
        let off = self.at.iter().zip(point.position).map(|(at, computed)| (*at - Interval::point(computed)).squared());
        off.fold(Interval::point(0.0), |sum, square| sum + square).sqrt().hi
    }
}
