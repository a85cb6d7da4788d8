//! Which charts of a space are its flanks, and what the others are.

use nalgebra::Vector3;

use crate::solid::arrangement::Arrangement;
use crate::solid::body::Body;
use crate::solid::gauge::touched;

/// Cosine between the normals of the ground and of a chart that runs out into it: a flank stands on it by more than 30 degrees, steeper than any
/// pressure angle leaves it.
const RUNS_OUT: f64 = 0.87;
/// Cosine between the normals of the ground and of a chart that is a part of it: no more than a fillet turns at its end.
const GROUND: f64 = 0.966;
/// Shares across a chart at which it is told whether it is ground.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// What a chart is in its space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpacePart {
    /// Between a flank and the tip: a chamfer, a rounding or a relief there.
    Chamfer,
    /// A side of the tooth.
    Flank,
    /// Between a flank and the root.
    Fillet,
    /// The ground of the space, or a half of it.
    Root,
}

impl Body {
    /// What each chart is, in the order of [`Body::charts`].
    pub fn space_parts(&self) -> Vec<SpacePart> {
        let ([low, high], count) = (self.flanks(), self.charts().len());
        let ground = self.normal_at(count / 2, if count.is_multiple_of(2) { 0.0 } else { 0.5 });
        let is_ground = |k: usize| LOOKS.iter().all(|share| self.normal_at(k, *share).dot(&ground) > GROUND);
        let part = |k: usize| match k {
            _ if k == low || k == high => SpacePart::Flank,
            _ if k < low || k > high => SpacePart::Chamfer,
            _ if 2 * k + 1 == count || is_ground(k) => SpacePart::Root,
            _ => SpacePart::Fillet,
        };
        (0..count).map(part).collect()
    }

    /// The charts that are the flanks: on each side the deepest one above the fillet. A fillet runs out into the ground, and may be deeper than
    /// what it leaves of a flank that is cut under; a chamfer above the flank is not. Where all run out so, the one at the tip.
    pub(crate) fn flanks(&self) -> [usize; 2] {
        let last = self.charts().len() - 1;
        let ground = self.normal_at(self.charts().len() / 2, if last.is_multiple_of(2) { 0.5 } else { 0.0 });
        let flank = |side: Vec<usize>, inner: f64| {
            let above = side.iter().filter(|k| self.normal_at(**k, inner).dot(&ground) < RUNS_OUT);
            above.max_by(|a, b| self.height(**a).total_cmp(&self.height(**b))).copied().unwrap_or(side[0])
        };
        [flank((0..=last / 2).collect(), 1.0), flank((last.div_ceil(2)..=last).rev().collect(), 0.0)]
    }

    /// How much of the teeth's depth a chart has, half-way along, mm.
    fn height(&self, k: usize) -> f64 {
        let [from, to] = [0.0, 1.0].map(|share| self.depth(self.arrangement.place(self.charts()[k].at([share, 0.5]))));
        (to - from).abs()
    }

    /// The normal at a share across a chart, half-way along: along the axis, away from it, and around it.
    fn normal_at(&self, k: usize, share: f64) -> Vector3<f64> {
        let (at, normal) = touched(&self.charts()[k], [share, 0.5]);
        let out = match self.arrangement {
            Arrangement::Round => (normal.x * at.x + normal.y * at.y) / at.x.hypot(at.y),
            Arrangement::Straight { .. } => normal.x,
        };
        Vector3::new(normal.z, out, self.arrangement.along(at.into(), normal))
    }
}
