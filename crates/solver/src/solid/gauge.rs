//! What gauges and calipers find on a body, by its exact surfaces.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Vector3};

use crate::solid::body::Body;
use crate::solid::chart::Chart;

/// Halvings of a search along a flank: as many as a number has binary digits.
const HALVINGS: usize = 60;
/// Steps of Newton's method; from the middle of a flank five are enough.
const MOST_STEPS: usize = 30;
/// The last step, mm and shares, and what it may leave of the equations, mm: where a gauge may slide, no more than polynomials through exact
/// points have of the surfaces' normals.
const LAST_STEP: f64 = 1e-9;
const TOUCHES: f64 = 1e-6;
/// Step of the differences that Newton's method takes for slopes, in shares.
const STEP: f64 = 1e-6;
/// Singular values below this share of the largest are directions in which a gauge may slide.
const SLIDES: f64 = 1e-5;

/// A tooth at a distance from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// Distance from the axis, mm.
    pub rho: f64,
    /// Along the circle, mm.
    pub arc: f64,
    /// Straight, as a tooth caliper measures it, mm.
    pub chord: f64,
    /// From the tip down to the middle of the chord, mm.
    pub chord_height: f64,
}

/// The distance of two parallel planes that touch the outer flanks of some teeth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// How many teeth are between them.
    pub teeth: u32,
    /// mm
    pub width: f64,
    /// Where they touch, from the axis, mm.
    pub rho: [f64; 2],
}

/// A ball in a space, touching both flanks in the middle of the teeth's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallGauge {
    /// mm
    pub diameter: f64,
    /// Of the ball's centre, from the axis, mm.
    pub centre_rho: f64,
    /// Over two balls in opposite spaces, or between them in an internal gear, mm.
    pub over_balls: f64,
    /// Where it touches, from the axis, mm.
    pub rho: [f64; 2],
}

impl Body {
    /// Whether the tip is farther from the axis than the root.
    pub fn is_external(&self) -> bool {
        let line = &self.lines(&vec![vec![0.0, 0.5, 1.0]; self.charts.len()], &[0.5])[0];
        line[0][1] > line[line.len() / 2][1]
    }

    /// The distance from the axis of the tip and of the deepest point of the space, half-way along, mm.
    pub fn tip_and_root(&self) -> [f64; 2] {
        let shares: Vec<f64> = (0..=64).map(|k| f64::from(k) / 64.0).collect();
        let line = &self.lines(&vec![shares; self.charts.len()], &[0.5])[0];
        let deeper = |a: f64, b: f64| if self.is_external() { a.min(b) } else { a.max(b) };
        [line[0][1], line.iter().map(|place| place[1]).reduce(deeper).unwrap_or(line[0][1])]
    }

    /// The distance from the axis at which both flanks end towards the root, half-way along, mm.
    pub fn form(&self) -> [f64; 2] {
        let last = self.charts.len() - 1;
        [(0, 1.0), (last, 0.0)].map(|(k, share)| rho(self.charts[k].at([share, 0.5])))
    }

    /// The tooth's thickness at a distance from the axis, half-way along; `None` where a flank does not reach there.
    pub fn thickness(&self, rho: f64) -> Option<Thickness> {
        let last = self.charts.len() - 1;
        let angle = |k: usize| -> Option<f64> {
            let [x, y, _] = self.charts[k].at([self.on_flank(k, rho)?, 0.5]);
            Some(y.atan2(x))
        };
        let angle = self.pitch() - (angle(last)? - angle(0)?).rem_euclid(TAU);
        let tip = self.tip_and_root()[0];
        let chord_height = tip - rho * (0.5 * angle).cos();
        let chord_height = if self.is_external() { chord_height } else { -chord_height };
        Some(Thickness { rho, arc: rho * angle, chord: 2.0 * rho * (0.5 * angle).sin(), chord_height })
    }

    /// The share across a chart at which it has a distance from the axis, half-way along.
    fn on_flank(&self, k: usize, wanted: f64) -> Option<f64> {
        let at = |share: f64| rho(self.charts[k].at([share, 0.5])) - wanted;
        let (mut low, mut high) = (0.0, 1.0);
        if at(low) == 0.0 {
            return Some(low);
        }
        if at(low) * at(high) > 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(low) * at(middle) > 0.0 { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// The width over so many teeth; `None` where no planes touch the flanks within their ends, and of an internal gear.
    pub fn span(&self, teeth: u32) -> Option<Span> {
        if !self.is_external() || teeth == 0 || teeth >= self.teeth() {
            return None;
        }
        let (near, far) = (&self.charts[self.charts.len() - 1], &self.charts[0]);
        let turned = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(teeth) * self.pitch());
        let residual = |x: &[f64]| {
            let (p, n) = touched(near, [x[0], x[1]]);
            let (q, m) = touched(far, [x[2], x[3]]);
            let (q, m) = (turned * q, turned * m);
            let apart = q - p - x[4] * m;
            let facing = (n + m) * (q - p).norm();
            vec![apart.x, apart.y, apart.z, facing.x, facing.y, facing.z]
        };
        let chord = (turned * touched(far, [0.5; 2]).0 - touched(near, [0.5; 2]).0).norm();
        let x = solved(residual, vec![0.5, 0.5, 0.5, 0.5, chord])?;
        Some(Span { teeth, width: x[4], rho: [rho(near.at([x[0], x[1]])), rho(far.at([x[2], x[3]]))] })
    }

    /// A ball that touches both flanks, its centre half-way along; `None` where none of the size does within their ends.
    pub fn ball(&self, diameter: f64) -> Option<BallGauge> {
        let (low, high) = (&self.charts[0], &self.charts[self.charts.len() - 1]);
        let z = low.at([0.5; 2])[2];
        let starts = [touched(low, [0.5; 2]), touched(high, [0.5; 2])];
        let start = 0.5 * (starts[0].0 + starts[1].0 + 0.5 * diameter * (starts[0].1 + starts[1].1));
        let residual = |x: &[f64]| {
            let centre = Vector3::new(x[4], x[5], z);
            let off = |chart: &Chart, shares: [f64; 2]| {
                let (p, n) = touched(chart, shares);
                p + 0.5 * diameter * n - centre
            };
            let (a, b) = (off(low, [x[0], x[1]]), off(high, [x[2], x[3]]));
            vec![a.x, a.y, a.z, b.x, b.y, b.z]
        };
        let x = solved(residual, vec![0.5, 0.5, 0.5, 0.5, start.x, start.y])?;
        let centre_rho = x[4].hypot(x[5]);
        // of an odd number of spaces none is opposite another
        let across = if self.teeth().is_multiple_of(2) { 1.0 } else { (0.25 * self.pitch()).cos() };
        let side = if self.is_external() { 1.0 } else { -1.0 };
        Some(BallGauge {
            diameter,
            centre_rho,
            over_balls: 2.0 * centre_rho * across + side * diameter,
            rho: [rho(low.at([x[0], x[1]])), rho(high.at([x[2], x[3]]))],
        })
    }
}

fn rho([x, y, _]: [f64; 3]) -> f64 {
    x.hypot(y)
}

/// A point of a chart, and the normal there out of the body.
fn touched(chart: &Chart, shares: [f64; 2]) -> (Vector3<f64>, Vector3<f64>) {
    let [at, by_u, by_w] = chart.frame(shares).map(Vector3::from);
    (at, by_w.cross(&by_u).normalize())
}

/// Newton's method with steps of least length: where a gauge may slide, it stays near. The first four are shares, which stay on their charts.
fn solved(residual: impl Fn(&[f64]) -> Vec<f64>, mut x: Vec<f64>) -> Option<Vec<f64>> {
    for _ in 0..MOST_STEPS {
        let value = residual(&x);
        let mut jacobian = DMatrix::zeros(value.len(), x.len());
        for k in 0..x.len() {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[k] += by;
                residual(&x)
            };
            let (up, down) = (moved(STEP), moved(-STEP));
            for (i, (up, down)) in up.iter().zip(&down).enumerate() {
                jacobian[(i, k)] = (up - down) / (2.0 * STEP);
            }
        }
        if !jacobian.iter().chain(&value).all(|part| part.is_finite()) {
            return None;
        }
        let parts = jacobian.svd(true, true);
        let largest = parts.singular_values.max();
        let step = parts.solve(&DVector::from_vec(value), SLIDES * largest).ok()?;
        let before = x.clone();
        x.iter_mut().zip(step.iter()).for_each(|(x, step)| *x -= step);
        // beyond its borders a chart is no surface
        x[..4].iter_mut().for_each(|share| *share = share.clamp(0.0, 1.0));
        if x.iter().zip(&before).all(|(x, before)| (x - before).abs() < LAST_STEP) {
            return residual(&x).iter().all(|part| part.abs() < TOUCHES).then_some(x);
        }
    }
    None
}
