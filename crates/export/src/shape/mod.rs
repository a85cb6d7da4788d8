//! What a patch looks like as a shape: vectors, its points as a mesh, what the sides of its grid are called.

mod direction;
mod mesh;
mod sides;

pub use mesh::{Edge, Mesh, Node, node};
pub use sides::{Seen, Side, Sides, axial, ends, is_last, is_thread, named_sides, rows_follow_profile, sides, words};
