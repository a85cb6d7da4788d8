//! Random generated surfaces with cusps, self-crossings and bifurcations. What a program says of their points is checked against trying
//! the tool at many positions, and against what it says of the same points in other grids, by other coordinates, in wider ranges.

#![allow(unreachable_pub)] // its modules are its own

mod case;
#[cfg(test)]
mod checks;
mod families;
mod judge;
mod machine;
mod newton;
mod oracle;
mod pose;
mod positions;
mod report;
mod told;
mod tool;

pub use report::{Report, Solve, report, summarised};
