//! The width over teeth between two parallel planes.

use nalgebra::{Rotation3, Vector3};

use crate::solid::body::Body;
use crate::solid::chart::Chart;
use crate::solid::gauge::{TOUCHES, rho, solved, touched};

/// Places across each flank, half-way along, between which planes are looked for.
const LOOKS: usize = 33;
/// How often the shift along two flanks is worked out from the width, and the width from it: near planes that touch one does not change the other.
const SHIFTS: usize = 3;
/// Places across a chart, and along it, at which steel is looked for beyond a plane.
const ACROSS: usize = 17;
const ALONG: usize = 9;
/// As far towards the root as this share of a flank it has to bend away from a plane.
const BESIDE: f64 = 1.0 / 32.0;
/// Steel as far beyond a plane is none, mm: what the normals of polynomials through exact points are off on the way to it.
const BEYOND: f64 = 10.0 * TOUCHES;

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

/// A place of a flank half-way along.
struct Look {
    at: Vector3<f64>,
    /// Out of the body.
    normal: Vector3<f64>,
    /// How the flank line goes on along the axis: about it, radians to a millimetre, and millimetres to a share.
    twist: f64,
    by_along: f64,
}

impl Look {
    /// At even shares across a chart, turned about the axis.
    fn across(chart: &Chart, turned: Rotation3<f64>) -> Vec<Look> {
        let look = |k: usize| {
            let shares = [k as f64 / (LOOKS - 1) as f64, 0.5];
            let (at, normal) = touched(chart, shares);
            let along = Vector3::from(chart.frame(shares)[2]);
            let twist = (at.x * along.y - at.y * along.x) / (at.x.hypot(at.y).powi(2) * along.z);
            Look { at: turned * at, normal: turned * normal, twist, by_along: along.z }
        };
        (0..LOOKS).map(look).collect()
    }

    /// Position and normal as far on along the axis, where the flank line is a helix.
    fn shifted(&self, by: f64) -> (Vector3<f64>, Vector3<f64>) {
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), self.twist * by);
        (turned * self.at + by * Vector3::z(), turned * self.normal)
    }
}

/// How two flanks lie to each other that planes might touch in two places.
#[derive(Clone, Copy)]
struct Facing {
    /// How far along the axis the first place is shifted, and the second one back, mm.
    shift: f64,
    width: f64,
    /// By which the normals are not opposite, and the way between the places is not along them: parts along the axis of cross products.
    off: [f64; 2],
}

impl Facing {
    fn of(near: &Look, far: &Look) -> Facing {
        let mut facing = Facing { shift: 0.0, width: 0.0, off: [0.0; 2] };
        for _ in 0..SHIFTS {
            let ((p, n), (q, m)) = (near.shifted(facing.shift), far.shifted(-facing.shift));
            let (way, normal) = (q - p, 0.5 * (m - n));
            facing.width = way.dot(&normal);
            facing.off = [n.cross(&m).z, way.cross(&normal).z];
            facing.shift += 0.5 * (way.z - facing.width * normal.z);
        }
        facing
    }
}

impl Body {
    /// The width over so many teeth; `None` where no planes touch the flanks within their ends, and of an internal gear.
    pub fn span(&self, teeth: u32) -> Option<Span> {
        let is_round = self.arrangement.is_closed() && self.distinct() == 1;
        if !is_round || !self.is_external() || teeth == 0 || teeth >= self.teeth() {
            return None;
        }
        let [low, high] = self.flanks();
        let (near, far) = (&self.charts()[high], &self.charts()[low]);
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(teeth) * self.pitch());
        let residual = |x: &[f64]| {
            let (p, n) = touched(near, [x[0], x[1]]);
            let (q, m) = touched(far, [x[2], x[3]]);
            let (q, m) = (turned * q, turned * m);
            let apart = q - p - x[4] * m;
            let facing = (n + m) * (q - p).norm();
            vec![apart.x, apart.y, apart.z, facing.x, facing.y, facing.z]
        };
        let chord = (turned * touched(far, [0.5; 2]).0 - touched(near, [0.5; 2]).0).norm();
        let starts = std::iter::once(vec![0.5, 0.5, 0.5, 0.5, chord]).chain(starts([near, far], turned));
        let above: [Vec<&Chart>; 2] =
            [self.charts()[high + 1..].iter().collect(), self.charts()[..low].iter().collect()];
        // where both flanks meet in an edge, planes would touch there
        let touches = |x: &Vec<f64>| {
            x[4] > TOUCHES
                && is_clear(near, [x[0], x[1]], (1.0, above[0].as_slice()))
                && is_clear(far, [x[2], x[3]], (0.0, above[1].as_slice()))
        };
        let found = starts.filter_map(|start| solved(residual, start)).filter(touches);
        // planes that come from outside touch the widest first; those that slide along it have it in many places
        let x = found.reduce(|widest, other| if other[4] > widest[4] + TOUCHES { other } else { widest })?;
        Some(Span { teeth, width: x[4], rho: [rho(near.at([x[0], x[1]])), rho(far.at([x[2], x[3]]))] })
    }
}

/// Where planes may touch two flanks, as [`solved`] begins: in the middle of the cells, a step across each flank, in which the flanks come to face
/// each other.
fn starts([near, far]: [&Chart; 2], turned: Rotation3<f64>) -> impl Iterator<Item = Vec<f64>> {
    let (near, far) = (Look::across(near, Rotation3::identity()), Look::across(far, turned));
    let facings: Vec<Vec<Facing>> =
        near.iter().map(|near| far.iter().map(|far| Facing::of(near, far)).collect()).collect();
    let cells = (0..LOOKS - 1).flat_map(|i| (0..LOOKS - 1).map(move |j| [i, j]));
    cells.filter_map(move |[i, j]| {
        let corners = [facings[i][j], facings[i][j + 1], facings[i + 1][j], facings[i + 1][j + 1]];
        let changes = |k: usize| {
            let off = corners.map(|corner| corner.off[k]);
            off.iter().any(|off| *off <= 0.0) && off.iter().any(|off| *off >= 0.0)
        };
        let Facing { shift, width, .. } = corners[0];
        let middle = |k: usize| (k as f64 + 0.5) / (LOOKS - 1) as f64;
        let along = |look: &Look, shift: f64| (0.5 + shift / look.by_along).clamp(0.0, 1.0);
        (width > 0.0 && changes(0) && changes(1))
            .then(|| vec![middle(i), along(&near[i], shift), middle(j), along(&far[j], -shift), width])
    })
}

/// Whether the steel of a tooth lies on one side of a plane that touches a flank: from a little below the place up to the tip, which is at a share
/// across the flank or beyond the charts above it, and as far along as the flank is high.
fn is_clear(chart: &Chart, [across, along]: [f64; 2], (tip, above): (f64, &[&Chart])) -> bool {
    let (at, normal) = touched(chart, [across, along]);
    let height = (Vector3::from(chart.at([1.0, along])) - Vector3::from(chart.at([0.0, along]))).norm();
    let reach = height / Vector3::from(chart.frame([across, along])[2]).norm();
    let even = |count: usize, [from, to]: [f64; 2]| -> Vec<f64> {
        (0..count).map(|k| (from + (to - from) * k as f64 / (count - 1) as f64).clamp(0.0, 1.0)).collect()
    };
    let lines = even(ALONG, [along - reach, along + reach]);
    let below = if tip > 0.5 { across - BESIDE } else { across + BESIDE };
    let rows = [even(ACROSS, [across, tip]), even(2, [below, across])].concat();
    let is_within = |point: [f64; 3]| normal.dot(&(Vector3::from(point) - at)) <= BEYOND;
    chart.lattice(&rows, &lines).into_iter().all(is_within)
        && above.iter().all(|chart| chart.lattice(&even(ACROSS, [0.0, 1.0]), &lines).into_iter().all(is_within))
}
