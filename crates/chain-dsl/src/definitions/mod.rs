//! Machines and tools as they are defined, and instances of them with their parameters' values.

pub(crate) mod circles;
pub(crate) mod closure;
pub(crate) mod implicit_surface;
pub(crate) mod index;
pub(crate) mod instance;
pub(crate) mod items;
pub(crate) mod machine;
pub(crate) mod material_side;
pub(crate) mod nc_word;
pub(crate) mod profile;
pub(crate) mod requirement;
pub(crate) mod tool;
pub(crate) mod transforms;
pub(crate) mod unused;
pub(crate) mod variant;
