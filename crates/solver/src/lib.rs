//! Points of surfaces under constraint: Newton's method on exact Jacobians, start values of its own, a verdict for each
//! point.
//!
//! ```
//! use flank_expr::Graph;
//! use flank_solver::{Outcome, Range, System, solve};
//!
//! let graph = Graph::new();
//! let (x, y, area) = (graph.variable("x"), graph.variable("y"), graph.variable("area"));
//! let system = System::new(&[x * y - area, x - 2.0 * y], &[x, y], &[area]).expect("nothing else is unknown");
//! let ranges = [Range { low: 0.0, high: 10.0 }; 2];
//! let solution = solve(&system, &ranges, &[8.0], &[1.0, 1.0]);
//! assert_eq!(solution.outcome, Outcome::Solved);
//! assert!((solution.unknowns[0] - 4.0).abs() < 1e-12);
//! ```

mod anchor;
mod angles;
mod bands;
mod body;
mod certify;
mod cutting;
mod deviation;
mod elbows;
mod enclosure;
mod explicit;
mod extent;
mod field;
mod geometry;
mod given;
mod grid;
mod inspection;
mod intersection;
mod lanes;
mod lattice;
mod line;
mod newton;
mod orientation;
mod path;
mod points;
mod poses;
mod reach;
mod roots;
mod secondary;
mod sensitivity;
mod settings;
mod solution;
mod solvers;
mod start;
mod step;
mod surface;
mod survey;
mod symmetry;
mod system;
mod trim;
mod tube;
mod verdicts;
mod whole_numbers;

pub use anchor::solve_grid;
pub use bands::Band;
pub use body::is_inside_out;
pub use certify::Certifier;
pub use cutting::{CuttingEdges, Left};
pub use deviation::{Deviation, EaseOff};
pub use explicit::{Explicit, ExplicitProblem, Given, NotExplicit};
pub use extent::extent;
pub use geometry::{Contact, Curvature, Metric, PointGeometry, Principal, SurfaceGeometry};
pub use grid::{Effort, Elsewhere};
pub use inspection::{Inspection, beside};
pub use intersection::{Intersection, Line, Meeting};
pub use newton::{TOLERANCE, solve};
pub use points::SurfacePoints;
pub use poses::{Missing, PoseError, PoseProblem, Posture, TargetAxis};
pub use roots::{Doubt, Isolated, MOST_BOXES, Roots, Undecided, all_roots};
pub use secondary::{Judged, SecondaryCutting, Unseen};
pub use sensitivity::{NormalSensitivity, Parameter};
pub use settings::{Adjustable, SettingKind, SettingsFit, SettingsProblem, Sought, UnknownSetting};
pub use solution::{CutBy, Outcome, Range, Solution};
pub use surface::{MOST_AT_ONCE, SurfacePoint, SurfaceProblem};
pub use symmetry::{Screw, symmetries, unseen_motion};
pub use system::System;
pub use trim::trim;
pub use tube::{Tube, Unproven};
