//! A cutter on its passes on a page.

use serde::Serialize;

use crate::base64::encoded;

/// A cutter on its passes over a surface of the job, in the frame of that surface. Lengths are mm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PageMilling {
    /// Its name.
    pub name: String,
    /// The surface, by its place among the surfaces.
    pub surface: usize,
    /// What touches it.
    pub cutter: String,
    /// The outline of the cutter: lines of points, each with its distance from the axis and its height above the tool's origin.
    pub outline: Vec<Vec<[f64; 2]>>,
    /// The coordinates that passes are counted by and that they run along, then the axes of the machine.
    pub columns: Vec<PageColumn>,
    /// The numbers of the passes that are shown, and of the positions on each, from 1 on.
    pub numbers: [Vec<usize>; 2],
    /// How many there are.
    pub counts: [usize; 2],
    /// The positions, pass by pass in the order in which they are passed.
    pub positions: Vec<PageCut>,
}

/// What a number of a position is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageColumn {
    /// Its name.
    pub name: String,
    /// The unit that it is in.
    pub unit: String,
}

/// A position of a cutter.
#[derive(Debug, Clone, PartialEq)]
pub struct PageCut {
    /// Where it touches.
    pub contact: [f64; 3],
    /// The tool's origin and the unit vector along its axis towards the spindle.
    pub pose: [f64; 6],
    /// A number for each column.
    pub values: Vec<f64>,
}

#[derive(Serialize)]
pub(super) struct MillingOut<'a> {
    name: &'a str,
    surface: usize,
    cutter: &'a str,
    outline: Vec<String>,
    columns: &'a [PageColumn],
    numbers: &'a [Vec<usize>; 2],
    counts: [usize; 2],
    contacts: String,
    poses: String,
    values: String,
}

pub(super) fn out(milling: &PageMilling) -> MillingOut<'_> {
    let positions = &milling.positions;
    MillingOut {
        name: &milling.name,
        surface: milling.surface,
        cutter: &milling.cutter,
        outline: milling.outline.iter().map(|line| encoded(line.iter().flatten().copied())).collect(),
        columns: &milling.columns,
        numbers: &milling.numbers,
        counts: milling.counts,
        contacts: encoded(positions.iter().flat_map(|cut| cut.contact)),
        poses: encoded(positions.iter().flat_map(|cut| cut.pose)),
        values: encoded(positions.iter().flat_map(|cut| cut.values.iter().copied())),
    }
}
