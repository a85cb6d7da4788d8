//! The same relative motion on another machine: its axes, its settings, and what is proven of them.

pub(crate) mod explicit;
pub(crate) mod orientation;
pub(crate) mod poses;
pub(crate) mod postures;
pub(crate) mod settings;
pub(crate) mod symmetry;
pub(crate) mod tube;
