//! One surface compared with another, with measured points, and nominal points for measuring machines.

pub(crate) mod deviation;
pub(crate) mod deviation_result;
pub(crate) mod fit;
pub(crate) mod gauged;
pub(crate) mod inspect;
pub(crate) mod map;
pub(crate) mod measure;
pub(crate) mod measure_result;
pub(crate) mod sweep;
pub(crate) mod synthesis;
pub(crate) mod tolerance;
pub(crate) mod trace_result;
pub(crate) mod traces;
