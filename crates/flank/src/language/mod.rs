//! The language by itself: what is wrong with a text, how it is laid out, its error codes, what was built
//! from a text, the schemas of documents.

pub(crate) mod check;
pub(crate) mod derive;
pub(crate) mod editor;
pub(crate) mod errors;
pub(crate) mod layout;
pub(crate) mod schemas;
