//! Angles by which a flank turned: the difference of those that both surfaces have at one place.

use flank_solver::{Outcome, SurfacePoint};

use crate::testing::judge::significant;
use crate::testing::snapshot::text::{Kept, KeptSurface};

/// Below, arc minutes, nothing is told.
const LEAST: f64 = 5e-4;
/// How much the normals of a cylindrical gear's flank differ along its lines on cylinders, where modifications turn them: 1.1 deg. Those of
/// a face gear, whose profiles these lines are, differ by its pressure angles.
const MODIFIED: f64 = 0.02;
/// Of the component of a normal around the axis: a surface that faces the axis or an end of the gear is no flank.
const FACING: f64 = 0.1;

/// Pressure angle, and helix or spiral angle, at the kept point in the middle of the sample. The labels are the sample's: others than these have
/// no angle.
///
/// Angles of one place are those of its normal, seen from the axis: neither a flank that turns about its axis nor points that slide along it
/// change them.
///
/// Where a sample goes by radius and height, nothing but the points says which of them runs along the teeth: along the axis on a helicoid, as
/// the flanks of spur and helical gears and of worms are. Others have no angle, such as those of a face gear, whose teeth run along the radius.
pub(super) fn turned(surface: &KeptSurface, now: &[SurfacePoint], labels: &[String; 2]) -> String {
    let by_radius = labels.iter().position(|label| label == "rho");
    let is_helicoid = by_radius.is_some_and(|k| is_helicoid(surface, k));
    let is_solved = |at: &usize| surface.points[*at].is_solved() && now[*at].outcome == Outcome::Solved;
    let Some(at) = nearest_to_middle(surface, is_solved) else { return String::new() };
    let blank = if is_helicoid { Some(Blank::CYLINDER) } else { Blank::between(surface, at) };
    let Some(blank) = blank else { return String::new() };
    let (old, new) = (&surface.points[at], &now[at]);
    let [old, new] = [(&old.position, &old.normal), (&new.position, &new.normal)].map(|of| seen_from_axis(of.0, of.1));
    if [old, new].iter().any(|[_, around, _]| around.abs() < FACING) {
        return String::new();
    }
    let mut out = String::new();
    for label in labels {
        let (what, [before, after]) = match label.as_str() {
            "rho" if is_helicoid => ("pressure angle", [old, new].map(Blank::transverse_pressure_angle)),
            "root -> tip" => ("pressure angle", [old, new].map(|normal| blank.normal_pressure_angle(normal))),
            "z" if is_helicoid => ("helix angle", [old, new].map(|normal| blank.spiral_angle(normal))),
            "toe -> heel" => ("spiral angle", [old, new].map(|normal| blank.spiral_angle(normal))),
            _ => continue,
        };
        // a pressure angle is positive, on whichever side of the surface the steel lies
        let sign = if what == "pressure angle" { before.signum() } else { 1.0 };
        let arcmin = sign * (after - before).to_degrees() * 60.0;
        if arcmin.is_finite() && arcmin.abs() >= LEAST {
            out += &format!(", {what} {}{} arcmin", if arcmin > 0.0 { "+" } else { "" }, significant(arcmin));
        }
    }
    out
}

/// The number of the point in the middle row and column, or of the nearest to it that is so.
fn nearest_to_middle(surface: &KeptSurface, is_one: impl Fn(&usize) -> bool) -> Option<usize> {
    let [rows, columns] = surface.counts;
    let off = |at: &usize| (at / columns).abs_diff(rows / 2) + (at % columns).abs_diff(columns / 2);
    (0..surface.points.len()).filter(is_one).min_by_key(off)
}

/// The normal at a point, by its components along the radius, around the axis and along it.
fn seen_from_axis([x, y, _]: &[f64; 3], [nx, ny, nz]: &[f64; 3]) -> [f64; 3] {
    let radius = x.hypot(*y);
    [(x * nx + y * ny) / radius, (x * ny - y * nx) / radius, *nz]
}

/// How a tooth lies in the section of its blank through the axis: unit vectors along the tooth and across it towards its tip, by radius and height.
#[derive(Clone, Copy)]
struct Blank {
    along: [f64; 2],
    across: [f64; 2],
}

impl Blank {
    const CYLINDER: Blank = Blank { along: [0.0, 1.0], across: [1.0, 0.0] };

    /// Of a sample whose rows lie from root to tip and its columns from toe to heel, along the row of a point.
    fn between(surface: &KeptSurface, at: usize) -> Option<Blank> {
        let [rows, columns] = surface.counts;
        let place = |row: usize, column: usize| {
            let point = Some(&surface.points[row * columns + column]).filter(|point| point.is_solved())?;
            Some([point.position[0].hypot(point.position[1]), point.position[2]])
        };
        let (row, column) = (at / columns, at % columns);
        let way = |from: Option<[f64; 2]>, to: Option<[f64; 2]>| {
            let ([r0, z0], [r1, z1]) = (from?, to?);
            let length = (r1 - r0).hypot(z1 - z0);
            (length > 0.0).then(|| [(r1 - r0) / length, (z1 - z0) / length])
        };
        let [radial, axial] = way(place(row, 0), place(row, columns - 1))?;
        let depth = way(place(0, column), place(rows - 1, column))?;
        let is_to_tip = depth[0] * axial - depth[1] * radial > 0.0;
        let across = if is_to_tip { [axial, -radial] } else { [-axial, radial] };
        Some(Blank { along: [radial, axial], across })
    }

    /// Of the trace of the flank on the cone along the tooth against the plane through the axis: positive right-hand.
    fn spiral_angle(self, [radial, around, axial]: [f64; 3]) -> f64 {
        let along = self.along[0] * radial + self.along[1] * axial;
        (-self.along[1].signum() * along / around).atan()
    }

    /// Of the profile in the plane across the axis against the radius.
    fn transverse_pressure_angle([radial, around, _]: [f64; 3]) -> f64 {
        (radial / around.abs()).atan()
    }

    /// Of the profile in the plane across the trace.
    fn normal_pressure_angle(self, [radial, _, axial]: [f64; 3]) -> f64 {
        (self.across[0] * radial + self.across[1] * axial).asin()
    }
}

/// Whether the normals along each line at one radius are the same, seen from the axis. `by_radius` is 0 where rows are at one radius, 1 where columns are.
fn is_helicoid(surface: &KeptSurface, by_radius: usize) -> bool {
    let [rows, columns] = surface.counts;
    let solved = |at: usize| Some(&surface.points[at]).filter(|point| point.is_solved());
    let line = |k: usize| -> Vec<[f64; 3]> {
        let on_line: Vec<usize> = match by_radius {
            0 => (0..columns).map(|column| k * columns + column).collect(),
            _ => (0..rows).map(|row| row * columns + k).collect(),
        };
        let seen = |point: &Kept| seen_from_axis(&point.position, &point.normal);
        on_line.into_iter().filter_map(solved).map(seen).collect()
    };
    (0..surface.counts[by_radius]).map(line).all(|normals| {
        let differ = |k: usize| {
            let ends = normals.iter().map(|normal| normal[k]);
            let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            high - low
        };
        (0..3).all(|k| differ(k) <= MODIFIED || normals.is_empty())
    })
}
