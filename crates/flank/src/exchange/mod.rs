//! Jobs from elsewhere: from the library, from other programs' files.

pub(crate) mod changes;
mod expectations;
pub(crate) mod import;
pub(crate) mod library;
pub(crate) mod made;
mod parts;
pub(crate) mod templates;
mod xml_cost;
