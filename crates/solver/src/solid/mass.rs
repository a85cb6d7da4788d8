//! Volume, area, centre and moments of a body by its exact surfaces.
//!
//! The field `ρ ∫ g dθ` about the axis has the divergence g and does not pass through surfaces of revolution. So an integral of g over a
//! tooth space is one over its charts alone (Gauss), and what is left of the blank is the blank's less that of its spaces.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::contact::OutlineSegment;
use crate::solid::blank::Blank;
use crate::solid::body::Body;
use crate::solid::chart::Chart;

/// Nodes of the quadrature along each direction of a chart, and along a segment of the outline.
const NODES: usize = 32;

/// What a body is as a mass of density one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// mm³
    pub volume: f64,
    /// Of its whole surface, mm².
    pub area: f64,
    /// mm
    pub centre: [f64; 3],
    /// The inertia tensor about the centre, mm⁵.
    pub inertia: [[f64; 3]; 3],
}

/// Integrals of 1, x, y, z, xx, yy, zz, xy, xz, yz.
type Moments = [f64; 10];

impl Body {
    /// Volume, area, centre and inertia.
    pub fn mass_properties(&self) -> MassProperties {
        let (space, flanks) = self.of_space();
        let mut sums = self.of_blank();
        for tooth in 0..self.teeth() {
            let turned = turned(&space, f64::from(tooth) * self.pitch());
            sums.iter_mut().zip(turned).for_each(|(sum, part)| *sum -= part);
        }
        let [volume, x, y, z, xx, yy, zz, xy, xz, yz] = sums;
        let centre = [x, y, z].map(|moment| moment / volume);
        let [a, b, c] = centre;
        // second moments about the centre
        let about = |moment: f64, p: f64, q: f64| moment - volume * p * q;
        let (xx, yy, zz) = (about(xx, a, a), about(yy, b, b), about(zz, c, c));
        let (xy, xz, yz) = (about(xy, a, b), about(xz, a, c), about(yz, b, c));
        let inertia = [[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]];
        MassProperties { volume, area: self.turned_area() + f64::from(self.teeth()) * flanks, centre, inertia }
    }

    /// The moments of one space within the blank, and the area of its charts.
    fn of_space(&self) -> (Moments, f64) {
        let nodes = gauss_legendre(NODES);
        let shares: Vec<f64> = nodes.iter().map(|(share, _)| *share).collect();
        let lines = self.lines(&vec![shares.clone(); self.charts.len()], &shares);
        let (mut sums, mut area) = ([0.0; 10], 0.0);
        let mut add = |[x, y, z]: [f64; 3], normal: Vector3<f64>, angle: f64| {
            let rho = x.hypot(y);
            let around = (normal.y * x - normal.x * y) / rho;
            let (sin, cos) = angle.sin_cos();
            for (sum, part) in sums.iter_mut().zip(around_integrals(rho, z, [angle, sin, cos])) {
                *sum += around * part;
            }
        };
        for (j, (along, by_along)) in nodes.iter().enumerate() {
            for (k, chart) in self.charts.iter().enumerate() {
                for (i, (across, by_across)) in nodes.iter().enumerate() {
                    let [at, by_u, by_w] = chart.frame([*across, *along]);
                    let normal = by_along * by_across * Vector3::from(by_u).cross(&Vector3::from(by_w));
                    area += normal.norm();
                    add(at, normal, lines[j][k * NODES + i][2]);
                }
            }
            if let Some(wall) = self.wall() {
                // of the space before the edge and of the one behind it, which lies a pitch farther on
                let first = lines[j][0][2];
                for (across, by_across) in &nodes {
                    let [at, by_u, by_w] = wall.frame([*across, *along]);
                    let normal = by_along * by_across * Vector3::from(by_u).cross(&Vector3::from(by_w));
                    let near = at[1].atan2(at[0]);
                    let angle = first + (near - first + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                    add(at, normal, angle);
                    add(
                        turned_by(at, self.pitch()),
                        -Vector3::from(turned_by(normal.into(), self.pitch())),
                        angle + self.pitch(),
                    );
                }
            }
        }
        // the charts' normals point out of the space or into it, all of them
        let sign = sums[0].signum();
        (sums.map(|sum| sign * sum), area)
    }

    /// Where teeth end in an edge: what parts a space from the next between the edge and the tip of the blank.
    fn wall(&self) -> Option<Chart> {
        let [_, columns] = self.charts[0].counts();
        let edge = self.charts[0].row(0);
        let above = edge.iter().zip(Chart::shares(columns)).map(|([x, y, _], share)| {
            let [z, rho] = self.blank().tip(share);
            let scale = rho / x.hypot(*y);
            [scale * x, scale * y, z]
        });
        self.has_edge.then(|| Chart::through(above.chain(edge.iter().copied()).collect(), [2, columns]))
    }

    fn of_blank(&self) -> Moments {
        let segments = self.blank().outline.segments();
        let of = |z_power: i32, rho_power: i32| -> f64 {
            segments
                .iter()
                .map(|segment| {
                    along(segment)
                        .map(|([z, rho], [by_z, _], weight)| {
                            -weight * by_z * z.powi(z_power) * rho.powi(rho_power + 1) / f64::from(rho_power + 1)
                        })
                        .sum::<f64>()
                })
                .sum()
        };
        let across = 0.5 * TAU * of(0, 3);
        [TAU * of(0, 1), 0.0, 0.0, TAU * of(1, 1), across, across, TAU * of(2, 1), 0.0, 0.0, 0.0]
    }

    /// The area of what is left of the blank's own surface.
    fn turned_area(&self) -> f64 {
        let whole: f64 = self.blank().outline.segments().iter().map(ring_area).sum();
        let nodes = gauss_legendre(NODES);
        let ends = vec![vec![0.0, 0.5, 1.0]; self.charts.len()];
        let [begin, tip, end] = self.blank().bounds();
        // the tip, open over the space's angle
        let open: f64 = along(tip)
            .map(|([z, rho], [by_z, by_rho], weight)| {
                let share = Blank::share([begin, tip, end], [z, rho]);
                let line = &self.lines(&ends, &[share])[0];
                weight * rho * by_z.hypot(by_rho) * (line[line.len() - 1][2] - line[0][2])
            })
            .sum();
        let at_ends: f64 = [(begin, 0.0, begin.to), (end, 1.0, end.from)]
            .into_iter()
            .map(|(segment, share, corner)| {
                self.charts
                    .iter()
                    .map(|chart| {
                        nodes
                            .iter()
                            .map(|(across, weight)| {
                                let [[x, y, z], by_u, _] = chart.frame([*across, share]);
                                let rho_squared = x * x + y * y;
                                let angle_by_u = (x * by_u[1] - y * by_u[0]) / rho_squared;
                                weight * angle_by_u * self.area_below(segment, corner, [z, rho_squared.sqrt()])
                            })
                            .sum::<f64>()
                    })
                    .sum::<f64>()
                    .abs()
            })
            .sum();
        whole - f64::from(self.teeth()) * (open + at_ends)
    }

    /// The area a radian of what of a segment lies between its corner at the tip and a place.
    fn area_below(&self, segment: &OutlineSegment, corner: [f64; 2], place: [f64; 2]) -> f64 {
        let part = OutlineSegment { name: String::new(), from: corner, to: place, center: segment.center };
        if part.length() == 0.0 { 0.0 } else { ring_area(&part) / TAU }
    }
}

/// `ρ ∫ g dθ` for the g of each moment.
fn around_integrals(rho: f64, z: f64, [angle, sin, cos]: [f64; 3]) -> Moments {
    let (r2, r3) = (rho * rho, rho * rho * rho);
    [
        rho * angle,
        r2 * sin,
        -r2 * cos,
        rho * z * angle,
        r3 * 0.5 * (angle + sin * cos),
        r3 * 0.5 * (angle - sin * cos),
        rho * z * z * angle,
        r3 * 0.5 * sin * sin,
        r2 * z * sin,
        -r2 * z * cos,
    ]
}

fn turned_by([x, y, z]: [f64; 3], by: f64) -> [f64; 3] {
    let (sin, cos) = by.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

/// The moments of the same turned about the axis.
fn turned([one, x, y, z, xx, yy, zz, xy, xz, yz]: &Moments, by: f64) -> Moments {
    let (s, c) = by.sin_cos();
    [
        *one,
        c * x - s * y,
        s * x + c * y,
        *z,
        c * c * xx - 2.0 * s * c * xy + s * s * yy,
        s * s * xx + 2.0 * s * c * xy + c * c * yy,
        *zz,
        s * c * (xx - yy) + (c * c - s * s) * xy,
        c * xz - s * yz,
        s * xz + c * yz,
    ]
}

/// Places along a segment for an integral: `[z, rho]`, their derivatives by the share, and weights.
fn along(segment: &OutlineSegment) -> impl Iterator<Item = ([f64; 2], [f64; 2], f64)> {
    gauss_legendre(NODES).into_iter().map(|(share, weight)| {
        let place = segment.at(share);
        let chord = [0, 1].map(|k| segment.to[k] - segment.from[k]);
        let by_share = match segment.center {
            None => chord,
            Some(center) => {
                let out = [0, 1].map(|k| place[k] - center[k]);
                let turn = segment.length() / out[0].hypot(out[1]);
                let sense =
                    ((segment.from[0] - center[0]) * chord[1] - (segment.from[1] - center[1]) * chord[0]).signum();
                [-out[1] * turn * sense, out[0] * turn * sense]
            }
        };
        (place, by_share, weight)
    })
}

fn ring_area(segment: &OutlineSegment) -> f64 {
    along(segment).map(|([_, rho], [by_z, by_rho], weight)| TAU * weight * rho * by_z.hypot(by_rho)).sum()
}

/// Nodes and weights from 0 to 1, by Newton's method on Legendre's polynomial.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let node = |k: usize| {
        let mut x = (0.5 * TAU * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut before, mut value) = (1.0, x);
            for degree in 2..=count {
                let n = degree as f64;
                (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
            }
            slope = count as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}
