//! Scalars that share everything: the graph, its simplifications, exact derivatives, and how they print.

pub(crate) mod curve;
pub(crate) mod derivative;
pub(crate) mod expression;
pub(crate) mod graph;
pub(crate) mod hash;
pub(crate) mod implicit;
pub(crate) mod integral;
pub(crate) mod op;
pub(crate) mod print;
pub(crate) mod rules;
pub(crate) mod terms;
pub(crate) mod walk;
