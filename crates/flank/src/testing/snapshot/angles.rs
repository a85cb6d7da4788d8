//! Angles by which a flank turned, from how far its points moved along their normals.

use nalgebra::Vector3;

use crate::testing::judge::significant;
use crate::testing::snapshot::text::{Kept, KeptSurface};

/// Below, arc minutes, nothing is told.
const LEAST: f64 = 5e-4;
/// How much the normals of a cylindrical gear's flank differ along its lines on cylinders, where modifications turn them: 1.1 deg. Those of
/// a face gear, whose profiles these lines are, differ by its pressure angles.
const MODIFIED: f64 = 0.02;

/// Pressure angle along the profile, helix or spiral angle along the tooth, of slopes from the first row to the last and from the first column
/// to the last, mm. The labels are the sample's: others than these have no angle.
///
/// A change of the pressure angle alone leaves lines along the teeth where they are, so that a slope is held against the way across these lines.
///
/// Where a sample goes by radius and height, nothing but the points says which of them runs along the teeth: along the axis on a helicoid, as
/// the flanks of spur and helical gears and of worms are. Others have no angle, such as those of a face gear, whose teeth run along the radius.
pub(super) fn turned(surface: &KeptSurface, labels: &[String; 2], slopes: [f64; 2]) -> String {
    let [rows, columns] = surface.counts;
    let middles: [Vec<&Kept>; 2] = [
        (0..rows).map(|row| &surface.points[row * columns + columns / 2]).collect(),
        (0..columns).map(|column| &surface.points[rows / 2 * columns + column]).collect(),
    ];
    let by_radius = labels.iter().position(|label| label == "rho");
    let is_helicoid = by_radius.is_some_and(|k| is_helicoid(surface, k));
    let mut out = String::new();
    for k in 0..2 {
        let [along, other] = [&middles[k], &middles[1 - k]];
        let (what, length) = match labels[k].as_str() {
            "rho" if is_helicoid => ("pressure angle", way(along, radius, across_cylinders)),
            "root -> tip" => ("pressure angle", (chord(along) - project(chord(along), chord(other))).norm()),
            "z" if is_helicoid => ("helix angle", way(along, height, on_cylinder)),
            "toe -> heel" => ("spiral angle", chord(along).norm()),
            _ => continue,
        };
        let arcmin = slopes[k].atan2(length).to_degrees() * 60.0;
        if arcmin.is_finite() && arcmin.abs() >= LEAST {
            out += &format!(", {what} {}{} arcmin", if arcmin > 0.0 { "+" } else { "" }, significant(arcmin));
        }
    }
    out
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
        let seen = |point: &Kept| {
            let [radial, around] = normal_there(point);
            [radial, around, point.normal[2]]
        };
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

fn chord(points: &[&Kept]) -> Vector3<f64> {
    let at = |point: Option<&&Kept>| point.map_or(Vector3::zeros(), |point| Vector3::from(point.position));
    at(points.last()) - at(points.first())
}

fn project(one: Vector3<f64>, on: Vector3<f64>) -> Vector3<f64> {
    on * (one.dot(&on) / on.norm_squared())
}

/// The length of a way through points on a surface, by its length for a unit of a coordinate.
fn way(points: &[&Kept], coordinate: fn(&Kept) -> f64, rate: fn(&Kept) -> f64) -> f64 {
    let pieces = points.windows(2).map(|two| {
        let [one, next] = [two[0], two[1]];
        (coordinate(next) - coordinate(one)).abs() * (rate(one) + rate(next)) / 2.0
    });
    pieces.sum()
}

fn radius(point: &Kept) -> f64 {
    point.position[0].hypot(point.position[1])
}

fn height(point: &Kept) -> f64 {
    point.position[2]
}

/// Components of the normal along the radius and around the axis.
fn normal_there(point: &Kept) -> [f64; 2] {
    let ([x, y, _], [nx, ny, _]) = (point.position, point.normal);
    [x * nx + y * ny, x * ny - y * nx].map(|component| component / radius(point))
}

/// The way on the surface across its lines on cylinders, for a unit of the radius.
fn across_cylinders(point: &Kept) -> f64 {
    let [radial, _] = normal_there(point);
    1.0 / (1.0 - radial * radial).sqrt()
}

/// The way along the surface's line on a cylinder, for a unit along the axis, by the part of a motion in the cylinder that is along the normal.
fn on_cylinder(point: &Kept) -> f64 {
    let [radial, around] = normal_there(point);
    (1.0 - radial * radial) / around.abs()
}
