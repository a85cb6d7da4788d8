//! Rigid motions and surfaces over symbolic scalars.

mod chain;
mod pose;
mod surface;
mod vector;

pub use chain::{Axis, Chain, Step};
pub use pose::{Pose, Twist};
pub use surface::Surface;
pub use vector::{Matrix3, Vector3};
