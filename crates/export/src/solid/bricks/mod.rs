//! Bricks for finite elements.

mod inp;
mod vtu;

pub use inp::write_inp;
pub use vtu::write_vtu;

use crate::points::dataset::Header;
use crate::text::one_line;

/// A body of bricks that share their nodes.
#[derive(Debug, Clone, Copy)]
pub struct BrickBody<'a> {
    /// What it is called.
    pub name: &'a str,
    /// The frame that it is in.
    pub frame: &'a str,
    /// The nodes, mm, each once.
    pub nodes: &'a [[f64; 3]],
    /// Nodes of a brick: 8, or 20 with those in the middle of its edges.
    pub nodes_of_brick: usize,
    /// The nodes of each brick, one after the other, in the order of C3D8 and C3D20.
    pub bricks: &'a [u32],
    /// How many teeth it has; each has as many bricks, which follow those of the tooth before.
    pub teeth: usize,
    /// Parts of its surface that have names.
    pub sets: &'a [BrickSet],
    /// How far faces on the generated surfaces are off these at the most, mm.
    pub deviation: f64,
}

/// A part of the surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrickSet {
    /// Letters, digits and underscores, the first a letter.
    pub name: String,
    /// Faces: each its brick and which face of it, both from 0, in the order of C3D8.
    pub faces: Vec<(u32, u8)>,
    /// The nodes of these faces.
    pub nodes: Vec<u32>,
}

impl BrickBody<'_> {
    fn count(&self) -> usize {
        self.bricks.len() / self.nodes_of_brick
    }
}

/// What a reader must know to use bricks, then the caller's own sentences.
fn sentences(header: &Header, body: &BrickBody<'_>) -> Vec<String> {
    let own = header.conventions.iter().map(|sentence| one_line(sentence));
    let told = [
        "units mm, N, MPa, t".to_string(),
        format!("body {} in frame {}: {} bricks, {} nodes", body.name, body.frame, body.count(), body.nodes.len()),
        format!("faces on generated surfaces lie within {:.2e} mm of these, nodes on them", body.deviation),
    ];
    told.iter().map(|told| one_line(told)).chain(own).collect()
}
