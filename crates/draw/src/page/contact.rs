//! A contact of two flanks on a page: where both members stand while they roll, where they touch, and both flanks laid flat.

use flank_export::shape::{Mesh, Side, axial, words};
use flank_export::vector::{across, cross, dot, length, sub, unit};
use flank_export::{Patch, Point};
use serde::Serialize;

use crate::base64::encoded;

/// A flank of which less than this share of its area is left in the axial plane shows nothing there.
const LEAST_SHARE: f64 = 0.04;
/// One of which less than this share lies beside itself there is folded.
const UNFOLDED: f64 = 0.9;

/// Two flanks that roll on each other. Angles are radians, lengths mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PageContact {
    /// Its name.
    pub name: String,
    /// The machine that both members stand on, by its place. What is in its root frame is so in [`PageTouch`].
    pub machine: usize,
    /// The motion that it rolls by, and the unknown, both among the motions.
    pub motions: [usize; 2],
    /// The flanks' members.
    pub members: [PageMember; 2],
    /// What the flanks are to each other: point or line contact; empty where they do not touch.
    pub kind: String,
    /// What is known of the whole contact.
    pub numbers: Vec<PageNumber>,
    /// Why there is nothing to show; empty where there is.
    pub refused: String,
    /// The field of both flanks that has the least gap to the mate, um.
    pub gap: String,
    /// Thickness of the marking compound, um.
    pub film: f64,
    /// The unit of the errors.
    pub error_unit: String,
    /// The positions of the roll that were solved, in their order.
    pub touches: Vec<PageTouch>,
}

/// A member of a contact.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PageMember {
    /// The flank, by its place among the surfaces.
    pub flank: usize,
    /// All surfaces of its tooth space, by their places.
    pub surfaces: Vec<usize>,
    /// The frame that it is mounted on, by its place in the machine.
    pub frame: usize,
    /// From one of its teeth to the next about z; `None` where the number of teeth is not known.
    pub pitch: Option<f64>,
    /// By how many pitches the tooth that touches is turned from the one of the surfaces.
    pub tooth: i32,
}

/// A number with its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageNumber {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit, as it is shown.
    pub unit: String,
}

/// A solved position of a pair of teeth.
#[derive(Debug, Clone, PartialEq)]
pub struct PageTouch {
    /// The roll position.
    pub roll: f64,
    /// The unknown with which the pair of teeth that carries turns.
    pub lag: f64,
    /// The error of the pair of teeth that carries and of this pair, in the unit of the errors.
    pub errors: [f64; 2],
    /// By how much this pair of teeth is apart at its own contact, um: zero where it carries.
    pub apart: f64,
    /// The edges that touch; empty where flank touches flank.
    pub edges: String,
    /// The point and the normal out of the first member, in the root frame.
    pub position: [f64; 3],
    /// See `position`.
    pub normal: [f64; 3],
    /// Half axes of the contact ellipse, the longer first, in the root frame; `None` where there is none.
    pub ellipse: Option<[[f64; 3]; 2]>,
    /// The point in the frame of each member, and the half axes there.
    pub on: [[f64; 3]; 2],
    /// See `on`.
    pub ellipse_on: Option<[[[f64; 3]; 2]; 2]>,
}

#[derive(Serialize)]
pub(super) struct ContactOut<'a> {
    name: &'a str,
    machine: usize,
    motions: [usize; 2],
    members: &'a [PageMember; 2],
    kind: &'a str,
    numbers: &'a [PageNumber],
    refused: &'a str,
    gap: &'a str,
    film: f64,
    error_unit: &'a str,
    count: usize,
    rolls: String,
    lags: String,
    errors: String,
    apart: String,
    edges: Vec<&'a str>,
    positions: String,
    normals: String,
    ellipses: String,
    maps: Vec<MapOut>,
}

/// A flank laid flat.
#[derive(Serialize)]
struct MapOut {
    /// Across and up of each of its points.
    nodes: String,
    /// The names of its sides, each with the points along it.
    sides: Vec<(String, Vec<usize>)>,
    /// Of each position of the roll: the point, then both half axes of the ellipse.
    touches: String,
}

pub(super) fn out<'a>(contact: &'a PageContact, patches: &[Patch]) -> ContactOut<'a> {
    let touches = &contact.touches;
    let map = |member: usize| map(&patches[contact.members[member].flank], member, touches);
    let none = [[f64::NAN; 3]; 2];
    ContactOut {
        name: &contact.name,
        machine: contact.machine,
        motions: contact.motions,
        members: &contact.members,
        kind: &contact.kind,
        numbers: &contact.numbers,
        refused: &contact.refused,
        gap: &contact.gap,
        film: contact.film,
        error_unit: &contact.error_unit,
        count: touches.len(),
        rolls: encoded(touches.iter().map(|touch| touch.roll)),
        lags: encoded(touches.iter().map(|touch| touch.lag)),
        errors: encoded(touches.iter().flat_map(|touch| touch.errors)),
        apart: encoded(touches.iter().map(|touch| touch.apart)),
        edges: touches.iter().map(|touch| touch.edges.as_str()).collect(),
        positions: encoded(touches.iter().flat_map(|touch| touch.position)),
        normals: encoded(touches.iter().flat_map(|touch| touch.normal)),
        ellipses: encoded(touches.iter().flat_map(|touch| touch.ellipse.unwrap_or(none).concat())),
        maps: if touches.is_empty() { Vec::new() } else { vec![map(0), map(1)] },
    }
}

fn map(patch: &Patch, member: usize, touches: &[PageTouch]) -> MapOut {
    let flat = Flat::of_patch(patch);
    let (rows, columns) = (patch.rows.count, patch.columns.count);
    let along = |side: Side| match side {
        Side::FirstRow => (0..columns).collect(),
        Side::LastRow => ((rows - 1) * columns..rows * columns).collect(),
        Side::FirstColumn => (0..rows).map(|row| row * columns).collect(),
        Side::LastColumn => (0..rows).map(|row| row * columns + columns - 1).collect(),
    };
    let mesh = Mesh::of_patch(patch, rows.max(columns));
    let touched = touches.iter().flat_map(|touch| {
        let at = touch.on[member];
        let ellipse = touch.ellipse_on.map(|on| on[member].map(|axis| flat.moved(at, axis)));
        [flat.place(at)].into_iter().chain(ellipse.unwrap_or([[f64::NAN; 2]; 2])).flatten()
    });
    let shown = |point: &Point| if point.is_solved() { flat.place(point.position) } else { [f64::NAN; 2] };
    MapOut {
        nodes: encoded(patch.points.iter().flat_map(shown)),
        sides: words(patch, &mesh).into_iter().map(|(side, word)| (word, along(side))).collect(),
        touches: encoded(touched),
    }
}

/// How a flank is laid flat.
enum Flat {
    /// Turned about its axis into the axial plane.
    Axial,
    /// Seen square to where its middle row begins: along the row and across.
    Tangent { from: [f64; 3], along: [[f64; 3]; 2] },
}

impl Flat {
    fn of_patch(patch: &Patch) -> Flat {
        let columns = patch.columns.count;
        let solved = |row: usize, column: usize| {
            let point = patch.points.get(row * columns + column)?;
            point.is_solved().then_some(point.position)
        };
        let (mut seen, mut folded, mut all) = (0.0, 0.0, 0.0);
        for row in 1..patch.rows.count {
            for column in 1..columns {
                let corners = [(row - 1, column - 1), (row - 1, column), (row, column - 1)];
                let [Some(a), Some(b), Some(c)] = corners.map(|(row, column)| solved(row, column)) else { continue };
                let [u, v] = [b, c].map(|end| sub(end, a));
                all += length(cross(u, v));
                let ([p, q], r) = ([a, b].map(axial), axial(c));
                let area: f64 = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                seen += area;
                folded += area.abs();
            }
        }
        if seen.abs() >= LEAST_SHARE * all && seen.abs() >= UNFOLDED * folded {
            return Flat::Axial;
        }
        let row = patch.rows.count / 2 * columns;
        let mut along = patch.points.iter().skip(row).take(columns).filter(|point| point.is_solved());
        let (Some(near), Some(far)) = (along.next(), along.next_back()) else { return Flat::Axial };
        match unit(across(sub(far.position, near.position), near.normal)) {
            Some(way) => Flat::Tangent { from: near.position, along: [way, cross(near.normal, way)] },
            None => Flat::Axial,
        }
    }

    fn place(&self, position: [f64; 3]) -> [f64; 2] {
        match self {
            Flat::Axial => axial(position),
            Flat::Tangent { from, along } => along.map(|way| dot(sub(position, *from), way)),
        }
    }

    /// Where a short way from a place goes.
    fn moved(&self, at: [f64; 3], by: [f64; 3]) -> [f64; 2] {
        match self {
            Flat::Axial => {
                let [_, radius] = axial(at);
                [by[2], (at[0] * by[0] + at[1] * by[1]) / radius]
            }
            Flat::Tangent { along, .. } => along.map(|way| dot(by, way)),
        }
    }
}
