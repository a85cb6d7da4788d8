//! Rigid motions and surfaces over symbolic scalars.

mod bending;
mod chain;
mod clearance;
mod edge;
mod pose;
mod surface;
mod vector;

pub use chain::{Axis, Chain, Step};
pub use edge::Edge;
pub use pose::{Pose, Twist};
pub use surface::Surface;
pub use vector::{Matrix3, Vector3};
