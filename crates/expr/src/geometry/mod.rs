//! Rigid motions and surfaces over symbolic scalars.

mod bending;
mod chain;
mod clearance;
mod edge;
mod minors;
mod pose;
mod surface;
mod turned;
mod vector;

pub use chain::{Axis, Chain, Step};
pub use edge::Edge;
pub use minors::{cofactors, determinant};
pub use pose::{Pose, Twist};
pub use surface::Surface;
pub use vector::{Matrix3, Vector3};
