//! Angles by which a flank turned, from how far its points moved along their normals.

use nalgebra::Vector3;

use crate::testing::judge::significant;
use crate::testing::snapshot::text::{Kept, KeptSurface};

/// Below, arc minutes, nothing is told.
const LEAST: f64 = 5e-4;

/// Pressure angle along the profile, helix or spiral angle along the tooth, of slopes from the first row to the last and from the first column
/// to the last, mm. The labels are the sample's: others than these have no angle.
///
/// A change of the pressure angle alone leaves lines along the teeth where they are, so that a slope is held against the way across these lines.
pub(super) fn turned(surface: &KeptSurface, labels: &[String; 2], slopes: [f64; 2]) -> String {
    let [rows, columns] = surface.counts;
    let middles: [Vec<&Kept>; 2] = [
        (0..rows).map(|row| &surface.points[row * columns + columns / 2]).collect(),
        (0..columns).map(|column| &surface.points[rows / 2 * columns + column]).collect(),
    ];
    let mut out = String::new();
    for k in 0..2 {
        let [along, other] = [&middles[k], &middles[1 - k]];
        let (what, length) = match labels[k].as_str() {
            "rho" => ("pressure angle", way(along, radius, across_cylinders)),
            "root -> tip" => ("pressure angle", (chord(along) - project(chord(along), chord(other))).norm()),
            "z" if labels[1 - k] == "rho" => ("helix angle", way(along, height, on_cylinder)),
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
