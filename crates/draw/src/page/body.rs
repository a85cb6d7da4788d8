//! The bodies of a page: one tooth of each, which the page turns to all.

use serde::Serialize;

use crate::base64::encoded;

/// The gear of a solid.
#[derive(Debug, Clone, PartialEq)]
pub struct PageBody {
    /// Its name.
    pub name: String,
    /// The machine that it stands on, by its place.
    pub machine: usize,
    /// Its frame, by its place in the machine.
    pub frame_index: usize,
    /// How many teeth, about z.
    pub teeth: u32,
    /// The surfaces of the page that bound one of its spaces, by their places.
    pub surfaces: Vec<usize>,
    /// In the middle of the tooth space: along it, and from root to tip; unit vectors.
    pub directions: [[f64; 3]; 2],
    /// One tooth, from the middle of a space to the middle of the next; none where there is no closed body: the surfaces of a space stand for
    /// it then.
    pub faces: Vec<PageFace>,
}

/// A face of a body as a grid of points.
#[derive(Debug, Clone, PartialEq)]
pub struct PageFace {
    /// The surface of the page that it is a part of, by its place; none of the blank.
    pub surface: Option<usize>,
    /// Rows and columns.
    pub counts: [usize; 2],
    /// Whether it ends at its first row, its last row, its first column and its last column, or goes on beyond.
    pub ends: [bool; 4],
    /// Row by row, mm.
    pub positions: Vec<[f64; 3]>,
    /// Out of the material.
    pub normals: Vec<[f64; 3]>,
}

#[derive(Serialize)]
pub(super) struct BodyOut<'a> {
    name: &'a str,
    machine: usize,
    frame_index: usize,
    teeth: u32,
    surfaces: &'a [usize],
    directions: [[f64; 3]; 2],
    faces: Vec<FaceOut>,
}

#[derive(Serialize)]
struct FaceOut {
    surface: Option<usize>,
    counts: [usize; 2],
    ends: [bool; 4],
    positions: String,
    normals: String,
}

pub(super) fn out(body: &PageBody) -> BodyOut<'_> {
    let face = |face: &PageFace| FaceOut {
        surface: face.surface,
        counts: face.counts,
        ends: face.ends,
        positions: encoded(face.positions.iter().flatten().copied()),
        normals: encoded(face.normals.iter().flatten().copied()),
    };
    BodyOut {
        name: &body.name,
        machine: body.machine,
        frame_index: body.frame_index,
        teeth: body.teeth,
        surfaces: &body.surfaces,
        directions: body.directions,
        faces: body.faces.iter().map(face).collect(),
    }
}
