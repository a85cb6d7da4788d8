//! What gauges and calipers find on a body, by its exact surfaces.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::solid::arrangement::Polar;
use crate::solid::body::Body;
use crate::solid::chart::Chart;

/// Places across a chart between which its least and its largest depth are looked for.
const LOOKS: usize = 64;
/// Halvings of a search along a flank: as many as a number has binary digits.
const HALVINGS: usize = 60;
/// Steps of Newton's method; from the middle of a flank five are enough.
const MOST_STEPS: usize = 30;
/// The last step, mm and shares, and what it may leave of the equations, mm: where a gauge may slide, no more than polynomials through exact
/// points have of the surfaces' normals.
const LAST_STEP: f64 = 1e-9;
pub(crate) const TOUCHES: f64 = 1e-6;
/// A circle this near to the end of a flank goes through it, mm: above what charts are off, so that both flanks reach the tip.
const ENDS: f64 = 1e-7;
/// Step of the differences that Newton's method takes for slopes, in shares.
const STEP: f64 = 1e-6;
/// The tip of a face gear is this flat: its slope against a plane across the axis.
const FLAT: f64 = 0.1;
/// Singular values below this share of the largest are directions in which a gauge may slide.
const SLIDES: f64 = 1e-5;

/// A tooth on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// Distance of the circle from the axis, mm.
    pub rho: f64,
    /// Its place along the axis, mm.
    pub z: f64,
    /// Along the circle, mm.
    pub arc: f64,
    /// As a tooth caliper measures it; nothing where flanks end before it lies square to them.
    pub chord: Option<Chord>,
}

/// The shortest straight way from one side of a tooth to the other, between flank lines that are as deep half-way along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// mm
    pub length: f64,
    /// From the tip down to its middle, mm.
    pub height: f64,
}

/// Places of two flanks that face each other, half-way along: the chart, the share across it, and how far on that is.
type Facing = [(usize, f64, f64); 2];

/// Where both flanks of a tooth have a depth, half-way along.
struct Tooth {
    /// The chart of either flank, and the share across it.
    flanks: [(usize, f64); 2],
    /// Of the lower one, `[z, rho]`.
    place: [f64; 2],
    /// How far they are apart along the circle, mm.
    arc: f64,
}

/// The shortest way between flank lines.
pub(crate) struct Shortest {
    pub(crate) ends: [Vector3<f64>; 2],
    /// How far along the first line it begins beyond the middle, and the second one before, as a share.
    pub(crate) shift: f64,
}

impl Body {
    /// Whether its teeth stand on a face, along the axis, and not around it: then their depth is measured by z, else by the distance from the
    /// axis.
    pub fn is_face_gear(&self) -> bool {
        let [_, tip, _] = self.blank().bounds();
        self.arrangement.is_closed() && (tip.to[0] - tip.from[0]).abs() < FLAT * (tip.to[1] - tip.from[1]).abs()
    }

    /// How far the edges in which teeth end lie below the tip of the blank, half-way along, mm; nothing where teeth have lands.
    pub fn edge_below_tip(&self) -> Option<f64> {
        let tip = self.blank().tip(0.5);
        let depth = |place: [f64; 2]| self.depth([place[0], place[1], 0.0]);
        self.has_edge().then(|| (self.tip() - depth(tip)).abs())
    }

    /// By what the depth of teeth is measured, of a place `[z, rho, …]`.
    pub(crate) fn depth(&self, place: Polar) -> f64 {
        if self.is_face_gear() { place[0] } else { place[1] }
    }

    /// Whether the depth grows from the root to the tip: of external gears.
    pub fn is_external(&self) -> bool {
        let line = &self.lines(&vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &[0.5])[0];
        self.depth(line[0]) > self.depth(line[line.len() / 2])
    }

    /// The distance from the axis (of a face gear the z, of a rack the x) of the tip and of the deepest point of the space, half-way along, mm;
    /// the extremes of all spaces where these differ.
    pub fn tip_and_root(&self) -> [f64; 2] {
        [self.tip(), self.root()]
    }

    /// Of these the tip.
    pub fn tip(&self) -> f64 {
        let [_, higher] = self.deeper_and_higher();
        let of_space = |charts: &Vec<Chart>| {
            // an edge may lie a little beside the top
            let top = if self.has_edge() { self.extreme_of(charts, higher) } else { None };
            top.unwrap_or_else(|| self.depth(self.arrangement.place(charts[0].at([0.0, 0.5]))))
        };
        self.spaces.iter().map(of_space).reduce(higher).unwrap_or_default()
    }

    /// Of these the deepest point.
    pub fn root(&self) -> f64 {
        let [deeper, _] = self.deeper_and_higher();
        let of_space = |charts: &Vec<Chart>| self.extreme_of(charts, deeper).unwrap_or_default();
        self.spaces.iter().map(of_space).reduce(deeper).unwrap_or_default()
    }

    /// Which of two depths is deeper in a space, and which is higher.
    fn deeper_and_higher(&self) -> [fn(f64, f64) -> f64; 2] {
        if self.is_external() { [f64::min, f64::max] } else { [f64::max, f64::min] }
    }

    fn extreme_of(&self, charts: &[Chart], extreme: fn(f64, f64) -> f64) -> Option<f64> {
        charts.iter().map(|chart| self.extreme(chart, extreme)).reduce(extreme)
    }

    /// The least or the largest depth of a chart, half-way along.
    fn extreme(&self, chart: &Chart, extreme: fn(f64, f64) -> f64) -> f64 {
        let shares: Vec<f64> = (0..=LOOKS).map(|k| k as f64 / LOOKS as f64).collect();
        let depth = |point: [f64; 3]| self.depth(self.arrangement.place(point));
        let depths: Vec<f64> = chart.lattice(&shares, &[0.5]).into_iter().map(depth).collect();
        let most = depths.iter().copied().reduce(extreme).unwrap_or_default();
        let at = depths.iter().position(|depth| *depth == most).unwrap_or_default();
        // between the neighbours of the place found, by thirds
        let (mut low, mut high) = (shares[at.saturating_sub(1)], shares[(at + 1).min(LOOKS)]);
        let at = |share: f64| depth(chart.at([share, 0.5]));
        for _ in 0..HALVINGS {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            let [by_a, by_b] = [at(a), at(b)];
            if extreme(by_a, by_b) == by_a { high = b } else { low = a }
        }
        extreme(most, at(0.5 * (low + high)))
    }

    /// The distance from the axis (of a face gear the z) at which both flanks end towards the root, half-way along, mm.
    pub fn form(&self) -> [f64; 2] {
        let [low, high] = self.flanks();
        [(low, 1.0), (high, 0.0)]
            .map(|(k, share)| self.depth(self.arrangement.place(self.charts()[k].at([share, 0.5]))))
    }

    /// The tooth's thickness at a distance from the axis (of a face gear at a z), half-way along; `None` where a flank does not reach there.
    pub fn thickness(&self, depth: f64) -> Option<Thickness> {
        let Tooth { flanks: [low, high], place: [z, rho], arc } = self.tooth_at(depth)?;
        let chord = self.shortest([(high.0, high.1, 0.0), (low.0, low.1, self.pitch())], arc).map(|way| {
            let [p, q] = way.ends;
            let middle = self.depth(self.arrangement.place((0.5 * (p + q)).into()));
            let tip = self.tip();
            Chord { length: (q - p).norm(), height: if self.is_external() { tip - middle } else { middle - tip } }
        });
        Some(Thickness { rho, z, arc, chord })
    }

    /// Of this what it is along the circle.
    pub fn arc_thickness(&self, depth: f64) -> Option<f64> {
        self.tooth_at(depth).map(|tooth| tooth.arc)
    }

    fn tooth_at(&self, depth: f64) -> Option<Tooth> {
        let share = |k: usize| Some((k, self.on_flank(k, depth)?));
        // flank, or chamfer beside it
        let count = self.charts().len();
        let low = (0..count.div_ceil(2)).find_map(share)?;
        let high = (count / 2..count).rev().find_map(share)?;
        let [[z, rho, from], [_, _, to]] =
            [low, high].map(|(k, share)| self.arrangement.place(self.charts()[k].at([share, 0.5])));
        let way = self.pitch() - (self.arrangement.near(to, from + 0.5 * self.pitch()) - from);
        // flanks that meet in an edge are none apart, but for what charts are off
        let arc = Some(self.arrangement.arc(rho) * way).filter(|arc| arc.abs() > ENDS).unwrap_or_default();
        Some(Tooth { flanks: [low, high], place: [z, rho], arc })
    }

    /// The shortest way across the first space, from the lower flank to the upper one.
    pub(crate) fn across_space(&self, [low, high]: [Option<(usize, f64, f64)>; 2]) -> Option<Shortest> {
        let facing = [low?, high?];
        let [[_, rho, from], [_, _, to]] =
            facing.map(|(k, share, _)| self.arrangement.place(self.charts()[k].at([share, 0.5])));
        let way = self.arrangement.near(to, from + 0.5 * self.pitch()) - from;
        self.shortest(facing, self.arrangement.arc(rho) * way)
    }

    /// The shortest way between the flank lines through two places that are an arc apart, its middle half-way along: square to both. Rows of charts
    /// are flank lines. The first guess is what it would be in a plane.
    fn shortest(&self, facing: Facing, arc: f64) -> Option<Shortest> {
        let line = |(chart, across, on): (usize, f64, f64), along: f64| {
            let [at, _, by_along] = self.charts()[chart].frame([across, along]);
            [self.arrangement.moved(at, on), self.arrangement.turned(by_along, on)].map(Vector3::from)
        };
        let both = |shift: f64| [line(facing[0], 0.5 + shift), line(facing[1], 0.5 - shift)];
        let slope = |shift: f64| {
            let [[p, by_p], [q, by_q]] = both(shift);
            (p - q).dot(&(by_p + by_q))
        };
        let [[middle, by_along], _] = both(0.0);
        let around = self.arrangement.along(middle.into(), by_along);
        let mut shift = (0.5 * around * arc / by_along.norm_squared()).clamp(-0.5, 0.5);
        for _ in 0..MOST_STEPS {
            let step = slope(shift) * 2.0 * STEP / (slope(shift + STEP) - slope(shift - STEP));
            shift = (shift - step).clamp(-0.5, 0.5);
            if step.abs() < LAST_STEP {
                let ends = both(shift).map(|[at, _]| at);
                return (shift.abs() < 0.5).then_some(Shortest { ends, shift });
            }
        }
        None
    }

    /// The share across a chart at which it has a depth, half-way along.
    pub(crate) fn on_flank(&self, k: usize, wanted: f64) -> Option<f64> {
        let at = |share: f64| self.depth(self.arrangement.place(self.charts()[k].at([share, 0.5]))) - wanted;
        let (mut low, mut high) = (0.0, 1.0);
        if let Some(end) = [low, high].into_iter().find(|end| at(*end).abs() <= ENDS) {
            return Some(end);
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
}

pub(crate) fn rho([x, y, _]: [f64; 3]) -> f64 {
    x.hypot(y)
}

/// A point of a chart, and the normal there out of the body.
pub(crate) fn touched(chart: &Chart, shares: [f64; 2]) -> (Vector3<f64>, Vector3<f64>) {
    let [at, by_u, by_w] = chart.frame(shares).map(Vector3::from);
    (at, by_w.cross(&by_u).normalize())
}

/// Newton's method with steps of least length: where a gauge may slide, it stays near. The first four are shares, which stay on their charts.
pub(crate) fn solved(residual: impl Fn(&[f64]) -> Vec<f64>, mut x: Vec<f64>) -> Option<Vec<f64>> {
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
