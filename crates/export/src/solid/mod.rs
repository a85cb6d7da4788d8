//! Closed bodies as meshes whose triangles share their corners, and of bricks.

mod bricks;
mod obj;
mod stl;
mod threemf;

pub use bricks::{BrickBody, BrickSet, write_inp, write_vtu};
pub use obj::write_body_obj;
pub use stl::write_body_stl;
pub use threemf::write_body_3mf;

use crate::points::dataset::Header;
use crate::text::one_line;

/// A closed mesh of one body.
#[derive(Debug, Clone, Copy)]
pub struct BodyMesh<'a> {
    /// What it is called.
    pub name: &'a str,
    /// The frame that it is in.
    pub frame: &'a str,
    /// Its corners, mm, each once.
    pub vertices: &'a [[f64; 3]],
    /// Each as three vertices, anticlockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

/// Where the frame of a body stands in another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedFrame {
    /// Its origin, mm.
    pub origin: [f64; 3],
    /// The directions of its x, y and z.
    pub axes: [[f64; 3]; 3],
}

impl Default for PlacedFrame {
    fn default() -> PlacedFrame {
        PlacedFrame { origin: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }
}

/// What a reader must know to use a closed mesh, then the caller's own sentences.
fn sentences(header: &Header) -> Vec<String> {
    let own = header.conventions.iter().map(|sentence| one_line(sentence));
    ["lengths in mm", "triangles face out of the body; it is closed"].map(String::from).into_iter().chain(own).collect()
}
