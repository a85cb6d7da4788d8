//! How deep a cutter goes where a point lies within it: the lowest height at which a line enters it, over its way.
//!
//! At each place of the way that is found by steps along the line, each as long as the distance from what is met: nothing is passed over, however
//! deep the point lies.

use crate::milling::height::NormalLine;
use crate::milling::outline::{Cutter, CutterArc, OutlinePiece, meridian};
use crate::milling::series::PoseSeries;

/// Steps of a search by sections between those.
const SECTIONS: u32 = 40;
/// Steps along a line at the most.
const MOST_STEPS: u32 = 400;
/// From here on Newton's method ends them, mm ...
const NEAR: f64 = 1e-5;
/// ... with a slope between two places so far apart, mm.
const APART: f64 = 1e-6;
/// How far beyond the ends of a straight piece what is met still belongs to it, as a share of its length.
const ON_END: f64 = 1e-9;

/// The lowest height at which a line enters a cutter on a way, and at which share; `None` where it enters it nowhere. So many places of the way
/// are looked at first.
pub(crate) fn deepest(way: &PoseSeries, cutter: &Cutter, line: &NormalLine, places: usize) -> Option<(f64, f64)> {
    let at = |share: f64| entered(&way.at(share), cutter, line).unwrap_or(f64::INFINITY);
    let share = |k: usize| k as f64 / (places - 1) as f64;
    let (first, height) = (0..places).map(|k| (k, at(share(k)))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    if !height.is_finite() {
        return None;
    }
    let mut best = (share(first), height);
    let (mut low, mut high) = (share(first.saturating_sub(1)), share((first + 1).min(places - 1)));
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    for _ in 0..SECTIONS {
        let inner = [high - golden * (high - low), low + golden * (high - low)];
        let heights = inner.map(at);
        for k in [0, 1] {
            if heights[k] < best.1 {
                best = (inner[k], heights[k]);
            }
        }
        // towards the best place where neither is met
        let is_left = if heights[0] == heights[1] { best.0 < inner[0] } else { heights[0] < heights[1] };
        (low, high) = if is_left { (low, inner[1]) } else { (inner[0], high) };
    }
    Some((best.1, best.0))
}

/// The lowest height at which a line enters a cutter that stands still.
fn entered(pose: &[f64; 6], cutter: &Cutter, line: &NormalLine) -> Option<f64> {
    let met = cutter.pieces.iter().filter_map(|piece| Line { pose, line }.meets(piece));
    met.min_by(f64::total_cmp)
}

/// A line as a cutter sees it.
struct Line<'l> {
    pose: &'l [f64; 6],
    line: &'l NormalLine,
}

impl Line<'_> {
    /// The distance from the axis and the height above the tip.
    fn seen(&self, h: f64) -> [f64; 2] {
        meridian(self.pose, [0, 1, 2].map(|k| self.line[k] + h * self.line[3 + k]))
    }

    /// A height below all of the cutter that reaches so far from its tip.
    fn below(&self, reach: f64) -> f64 {
        let square: f64 = (0..3).map(|k| (self.line[k] - self.pose[k]).powi(2)).sum();
        -square.sqrt() - reach
    }

    fn meets(&self, piece: &OutlinePiece) -> Option<f64> {
        match CutterArc::of_piece(piece) {
            Ok(arc) if arc.radius == 0.0 => self.meets_bottom(arc),
            Ok(arc) => {
                let off = |h: f64| {
                    let [rho, z] = self.seen(h);
                    (rho - arc.rho).hypot(z - arc.z) - arc.radius
                };
                let found = first(off, self.below(arc.rho.abs() + arc.radius + arc.z.abs()))?;
                let [rho, z] = self.seen(found);
                arc.has((rho - arc.rho).atan2(arc.z - z)).then_some(found)
            }
            Err([from, to]) => {
                let along = [to[0] - from[0], to[1] - from[1]];
                let length = along[0].hypot(along[1]);
                // the body lies on the left
                let off = |h: f64| {
                    let [rho, z] = self.seen(h);
                    ((rho - from[0]) * along[1] - (z - from[1]) * along[0]) / length
                };
                let found = first(off, self.below(from[0].hypot(from[1]) + length))?;
                let [rho, z] = self.seen(found);
                let share = ((rho - from[0]) * along[0] + (z - from[1]) * along[1]) / (length * length);
                (-ON_END..=1.0 + ON_END).contains(&share).then_some(found)
            }
        }
    }

    /// The plane bottom within an edge.
    fn meets_bottom(&self, edge: CutterArc) -> Option<f64> {
        let faces: f64 = (0..3).map(|k| self.line[3 + k] * self.pose[3 + k]).sum();
        let height = (edge.z - self.seen(0.0)[1]) / faces;
        (faces > 0.0 && height.is_finite() && self.seen(height)[0] <= edge.rho).then_some(height)
    }
}

/// The first height from a start on at which a distance is zero; it changes by no more than the height.
fn first(off: impl Fn(f64) -> f64, start: f64) -> Option<f64> {
    let (mut h, end) = (start, -start);
    for _ in 0..MOST_STEPS {
        let here = off(h);
        if here < 0.0 || h > end {
            return None;
        }
        if here < NEAR {
            break;
        }
        h += here;
    }
    for _ in 0..4 {
        let here = off(h);
        let slope = (off(h + APART) - here) / APART;
        h -= if slope < 0.0 { here / slope } else { 0.0 };
    }
    (off(h).abs() < NEAR).then_some(h)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball() -> Cutter {
        let between = [0.0, std::f64::consts::FRAC_PI_2];
        Cutter { pieces: vec![OutlinePiece::Arc { center: [0.0, 1.0], radius: 1.0, between }] }
    }

    /// A ball of radius 1 whose centre stands so far beside the line and over the point, on a way along y.
    fn over(beside: f64, over: f64) -> Option<(f64, f64)> {
        let way = PoseSeries::sampled(3, |s| [beside, 2.0 * s - 0.7, over - 1.0, 0.0, 0.0, 1.0]);
        deepest(&way, &ball(), &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 33)
    }

    #[test]
    fn a_ball_is_entered_at_its_lower_half_however_deep_it_goes() {
        for (beside, up) in [(0.0, 0.9), (0.3, 0.1), (0.6, -0.8), (0.5, -5.0)] {
            let (height, share) = over(beside, up).expect("it is entered");
            let exact = up - (1.0 - beside * beside).sqrt();
            assert!((height - exact).abs() < 1e-9 && (share - 0.35).abs() < 1e-3, "{height} {exact} {share}");
        }
        assert_eq!(over(1.2, -0.5), None);
    }

    #[test]
    fn a_flat_end_is_entered_through_its_bottom() {
        let edge = OutlinePiece::Arc { center: [2.0, 0.0], radius: 0.0, between: [0.0, std::f64::consts::FRAC_PI_2] };
        let side = OutlinePiece::Line { from: [2.0, 0.0], to: [2.0, 10.0] };
        let cutter = Cutter { pieces: vec![edge, side] };
        let way = PoseSeries::sampled(3, |s| [0.0, 0.0, -4.0 * s, 0.0, 0.0, 1.0]);
        let (height, share) = deepest(&way, &cutter, &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0], 33).expect("it is entered");
        assert!((height + 4.0).abs() < 1e-9 && share > 0.999, "{height} {share}");
        // from the side the cylinder is met
        let (height, _) = deepest(&way, &cutter, &[1.0, 0.5, 0.5, 1.0, 0.0, 0.0], 33).expect("it is entered");
        assert!((height - (-1.0 - 3.75f64.sqrt())).abs() < 1e-9, "{height}");
    }
}
