//! Answers to requests about a text, each from a snapshot.

pub(super) mod browse;
pub(super) mod edit;
pub(super) mod look;
mod relaid;
