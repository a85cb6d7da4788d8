//! A cutter of revolution that mills a surface along passes: where it stands, what is left between passes and on straight blocks, whether it
//! cuts too deep, and the axes of a machine that take it there.
//!
//! A pose is the tool's origin and its axis towards the spindle, in the frame of the work. A pass is a [`PoseSeries`]: both as polynomials
//! of the share of the way along it.

pub(crate) mod axes;
pub(crate) mod clear;
pub(crate) mod cusp;
pub(crate) mod deep;
pub(crate) mod depth;
pub(crate) mod distance;
pub(crate) mod frame;
pub(crate) mod guard;
pub(crate) mod height;
pub(crate) mod outline;
pub(crate) mod pose;
pub(crate) mod series;
pub(crate) mod side;
pub(crate) mod slice;
pub(crate) mod smooth;
pub(crate) mod sweep;
