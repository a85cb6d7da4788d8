//! Volume, area, centre and moments of a body by its exact surfaces.
//!
//! The field `ρ ∫ g dθ` about the axis has the divergence g and does not pass through surfaces of revolution; `∫ g dy` does not pass through the
//! sides of a bar along y. So an integral of g over a tooth space is one over its charts alone (Gauss), and what is left of the blank is the
//! blank's less that of its spaces.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use nalgebra::Vector3;

use crate::contact::OutlineSegment;
use crate::solid::arrangement::Arrangement;
use crate::solid::blank::Blank;
use crate::solid::body::Body;
use crate::solid::chart::Chart;

/// Nodes of the quadrature along each direction of a chart, and along a segment of the outline.
const NODES: usize = 32;
/// From 0 to 1; they are asked for once for each strip of a blank's end.
static NODES_AND_WEIGHTS: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(NODES));

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
        let mut sums = self.of_blank();
        let mut area = self.turned_area();
        for kind in 0..self.distinct() {
            let (space, charts) = self.of_space(kind);
            let copies = if self.distinct() == 1 { self.teeth() } else { 1 };
            area += f64::from(copies) * charts;
            for copy in 0..copies {
                let moved = moved(&space, self.arrangement, f64::from(copy) * self.pitch());
                sums.iter_mut().zip(moved).for_each(|(sum, part)| *sum -= part);
            }
        }
        if !self.arrangement.is_closed() {
            // a bar begins in the middle of its first space: the half before that is open behind its last tooth
            let half = self.of_first_half();
            let behind = moved(&half, self.arrangement, f64::from(self.teeth()) * self.pitch());
            sums.iter_mut().zip(half.iter().zip(behind)).for_each(|(sum, (before, behind))| *sum += before - behind);
        }
        let [volume, x, y, z, xx, yy, zz, xy, xz, yz] = sums;
        let centre = [x, y, z].map(|moment| moment / volume);
        let [a, b, c] = centre;
        // second moments about the centre
        let about = |moment: f64, p: f64, q: f64| moment - volume * p * q;
        let (xx, yy, zz) = (about(xx, a, a), about(yy, b, b), about(zz, c, c));
        let (xy, xz, yz) = (about(xy, a, b), about(xz, a, c), about(yz, b, c));
        let inertia = [[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]];
        MassProperties { volume, area, centre, inertia }
    }

    /// The moments of one space within the blank, and the area of its charts.
    fn of_space(&self, space: usize) -> (Moments, f64) {
        let nodes = &NODES_AND_WEIGHTS[..];
        let shares: Vec<f64> = nodes.iter().map(|(share, _)| *share).collect();
        let [lines, next] = self.tooth_lines(space, &vec![shares.clone(); self.charts().len()], &shares);
        let (mut sums, mut area) = ([0.0; 10], 0.0);
        let mut add = |at: [f64; 3], normal: Vector3<f64>, way: f64| {
            let around = self.arrangement.along(at, normal);
            let [z, rho, _] = self.arrangement.place(at);
            for (sum, part) in sums.iter_mut().zip(integrals_along(self.arrangement, [z, rho, way])) {
                *sum += around * part;
            }
        };
        let walls = self.walls(space);
        let frames: Vec<_> = self.spaces[space].iter().map(|chart| chart.frames(&shares, &shares)).collect();
        for (j, (along, by_along)) in nodes.iter().enumerate() {
            for (k, frames) in frames.iter().enumerate() {
                for (i, (_, by_across)) in nodes.iter().enumerate() {
                    let [at, by_u, by_w] = frames[j * NODES + i];
                    let normal = by_along * by_across * Vector3::from(by_u).cross(&Vector3::from(by_w));
                    area += normal.norm();
                    add(at, normal, lines[j][k * NODES + i][2]);
                }
            }
            // of the edge before the space and of the one behind it
            for (wall, near, sense) in walls
                .iter()
                .flatten()
                .zip([lines[j][0][2], next[j][0][2]])
                .map(|((wall, sense), near)| (wall, near, sense))
            {
                for (across, by_across) in nodes {
                    let [at, by_u, by_w] = wall.frame([*across, *along]);
                    let normal = by_along * by_across * Vector3::from(by_u).cross(&Vector3::from(by_w));
                    add(at, *sense * normal, self.arrangement.near(self.arrangement.place(at)[2], near));
                }
            }
        }
        // the charts' normals point out of the space or into it, all of them
        let sign = sums[0].signum();
        (sums.map(|sum| sign * sum), area)
    }

    /// The moments of what of a bar's first space lies before the plane through its middle.
    fn of_first_half(&self) -> Moments {
        let nodes = &NODES_AND_WEIGHTS[..];
        let [a, b] = self.side();
        let count = self.charts().len();
        let whole = self.charts()[..count / 2].iter().map(|chart| (chart, 1.0));
        let parted = (!count.is_multiple_of(2)).then(|| (&self.charts()[count / 2], 0.5));
        let mut sums = [0.0; 10];
        for (chart, share) in whole.chain(parted) {
            for ((across, by_across), (along, by_along)) in
                nodes.iter().flat_map(|across| nodes.iter().map(move |along| (across, along)))
            {
                let [at, by_u, by_w] = chart.frame([share * across, *along]);
                let normal = share * by_across * by_along * Vector3::from(by_u).cross(&Vector3::from(by_w));
                let [z, rho, y] = self.arrangement.place(at);
                let [to, from] = [y, a + b * z].map(|way| integrals_along(self.arrangement, [z, rho, way]));
                let around = self.arrangement.along(at, normal);
                sums.iter_mut().zip(to.iter().zip(from)).for_each(|(sum, (to, from))| *sum += around * (to - from));
            }
        }
        let sign = sums[0].signum();
        sums.map(|sum| sign * sum)
    }

    /// Where teeth end in an edge: what parts a space from those beside it between the edges and the tip of the blank, and in which sense.
    fn walls(&self, space: usize) -> Option<[(Chart, f64); 2]> {
        let charts = &self.spaces[space];
        let last = &charts[charts.len() - 1];
        let wall = |edge: &[[f64; 3]]| {
            let above = edge.iter().zip(Chart::shares(edge.len())).map(|(point, share)| {
                let [z, rho] = self.blank().tip(share);
                let [.., way] = self.arrangement.place(*point);
                self.arrangement.position([z, rho, way])
            });
            Chart::through(above.chain(edge.iter().copied()).collect(), [2, edge.len()])
        };
        self.has_edge.then(|| [(wall(charts[0].row(0)), 1.0), (wall(last.row(last.counts()[0] - 1)), -1.0)])
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
        let Arrangement::Straight { pitch } = self.arrangement else {
            let across = 0.5 * TAU * of(0, 3);
            return [TAU * of(0, 1), 0.0, 0.0, TAU * of(1, 1), across, across, TAU * of(2, 1), 0.0, 0.0, 0.0];
        };
        // from y = a + b z on, over the length of all teeth
        let length = pitch * f64::from(self.teeth());
        let [a, b] = self.side();
        let middle = a + 0.5 * length;
        let y = |z_power: i32, rho_power: i32| middle * of(z_power, rho_power) + b * of(z_power + 1, rho_power);
        let square = |z_power: i32, rho_power: i32| {
            let constant = middle * middle + length * length / 12.0;
            constant * of(z_power, rho_power)
                + 2.0 * middle * b * of(z_power + 1, rho_power)
                + b * b * of(z_power + 2, rho_power)
        };
        [of(0, 0), of(0, 1), y(0, 0), of(1, 0), of(0, 2), square(0, 0), of(2, 0), y(0, 1), of(1, 1), y(1, 0)]
            .map(|moment| length * moment)
    }

    /// Where a bar is cut off through the middle of its first space: y at z = 0, and how much of it comes with each mm of z.
    pub(crate) fn side(&self) -> [f64; 2] {
        let charts = vec![vec![0.0, 0.5, 1.0]; self.charts().len()];
        let lines = self.lines(&charts, &[0.0, 1.0]);
        let [from, to] = [0, 1].map(|k: usize| lines[k][lines[k].len() / 2]);
        let slope = (to[2] - from[2]) / (to[0] - from[0]);
        [from[2] - slope * from[0], slope]
    }

    /// The area of what is left of the blank's own surface.
    fn turned_area(&self) -> f64 {
        let whole = match self.arrangement {
            Arrangement::Round => TAU,
            Arrangement::Straight { pitch } => pitch * f64::from(self.teeth()),
        };
        let outline: f64 = self.blank().outline.segments().iter().map(|segment| self.strip_area(segment)).sum();
        let copies = f64::from(self.teeth()) / self.distinct() as f64;
        let open: f64 = (0..self.distinct()).map(|space| self.open_area(space)).sum();
        whole * outline - copies * open + self.sides_area()
    }

    /// What a space leaves out of the blank's own surface.
    fn open_area(&self, space: usize) -> f64 {
        let nodes = &NODES_AND_WEIGHTS[..];
        let ends = vec![vec![0.0, 0.5, 1.0]; self.charts().len()];
        let [begin, tip, end] = self.blank().bounds();
        // with edges, no land is left, and the ways from one to the next add up to all of it
        let open: f64 = along(tip)
            .map(|([z, rho], [by_z, by_rho], weight)| {
                let share = Blank::share([begin, tip, end], [z, rho]);
                let line = &self.tooth_lines(space, &ends, &[share])[0][0];
                weight * self.arrangement.arc(rho) * by_z.hypot(by_rho) * (line[line.len() - 1][2] - line[0][2])
            })
            .sum();
        let at_ends: f64 = [(begin, 0.0, begin.to), (end, 1.0, end.from)]
            .into_iter()
            .map(|(segment, share, corner)| {
                self.spaces[space]
                    .iter()
                    .map(|chart| {
                        nodes
                            .iter()
                            .map(|(across, weight)| {
                                let [at, by_u, _] = chart.frame([*across, share]);
                                let [z, rho, _] = self.arrangement.place(at);
                                let way_by_u = self.arrangement.along(at, by_u.into()) / self.arrangement.arc(rho);
                                weight * way_by_u * self.area_below(segment, corner, [z, rho])
                            })
                            .sum::<f64>()
                    })
                    .sum::<f64>()
                    .abs()
            })
            .sum();
        open + at_ends
    }

    /// Where a bar is cut off at both its ends, through the middles of spaces.
    fn sides_area(&self) -> f64 {
        if self.arrangement.is_closed() {
            return 0.0;
        }
        let section = |segment: &OutlineSegment| -> f64 {
            along(segment).map(|([_, rho], [by_z, _], weight)| -weight * by_z * rho).sum()
        };
        let [begin, tip, end] = self.blank().bounds();
        let nodes = &NODES_AND_WEIGHTS[..];
        let shares: Vec<f64> = [0.0].into_iter().chain(nodes.iter().map(|(share, _)| *share)).chain([1.0]).collect();
        let lines = self.lines(&vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &shares);
        let root: Vec<[f64; 2]> = lines.iter().map(|line| line[line.len() / 2]).map(|[z, rho, _]| [z, rho]).collect();
        let chord = |from: [f64; 2], to: [f64; 2]| 0.5 * (to[0] - from[0]) * (from[1] + to[1]);
        let part = |of: &OutlineSegment, from, to| OutlineSegment { name: String::new(), from, to, center: of.center };
        // what lies between the tip and the middle of the space, around which the section runs
        let ground: f64 = root.windows(2).map(|pair| chord(pair[0], pair[1])).sum();
        let space = section(tip)
            + section(&part(end, tip.to, root[root.len() - 1]))
            + ground
            + section(&part(begin, root[0], tip.from));
        let whole: f64 = self.blank().outline.segments().iter().map(section).sum();
        let [_, slope] = self.side();
        2.0 * (whole - space) * (1.0 + slope * slope).sqrt()
    }

    /// The area a radian of what of a segment lies between its corner at the tip and a place.
    fn area_below(&self, segment: &OutlineSegment, corner: [f64; 2], place: [f64; 2]) -> f64 {
        let part = OutlineSegment { name: String::new(), from: corner, to: place, center: segment.center };
        if part.length() == 0.0 { 0.0 } else { self.strip_area(&part) }
    }

    /// The area of what a segment passes over, for a unit of the way along the spaces.
    fn strip_area(&self, segment: &OutlineSegment) -> f64 {
        along(segment)
            .map(|([_, rho], [by_z, by_rho], weight)| weight * self.arrangement.arc(rho) * by_z.hypot(by_rho))
            .sum()
    }
}

/// `ρ ∫ g dθ`, or `∫ g dy`, for the g of each moment.
fn integrals_along(arrangement: Arrangement, [z, rho, way]: [f64; 3]) -> Moments {
    if !arrangement.is_closed() {
        let (x, y) = (rho, way);
        let (half, third) = (0.5 * y * y, y * y * y / 3.0);
        return [y, x * y, half, z * y, x * x * y, third, z * z * y, x * half, x * z * y, z * half];
    }
    let (r2, r3) = (rho * rho, rho * rho * rho);
    let (sin, cos) = way.sin_cos();
    [
        rho * way,
        r2 * sin,
        -r2 * cos,
        rho * z * way,
        r3 * 0.5 * (way + sin * cos),
        r3 * 0.5 * (way - sin * cos),
        rho * z * z * way,
        r3 * 0.5 * sin * sin,
        r2 * z * sin,
        -r2 * z * cos,
    ]
}

/// The moments of the same farther on along the spaces.
fn moved([one, x, y, z, xx, yy, zz, xy, xz, yz]: &Moments, arrangement: Arrangement, by: f64) -> Moments {
    if !arrangement.is_closed() {
        let square = yy + 2.0 * by * y + by * by * one;
        return [*one, *x, y + by * one, *z, *xx, square, *zz, xy + by * x, *xz, yz + by * z];
    }
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
    NODES_AND_WEIGHTS.iter().map(|&(share, weight)| {
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
