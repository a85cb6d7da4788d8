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

mod analysis;
mod contact;
mod continuation;
mod conversion;
mod equations;
mod milling;
mod newton;
mod roots;
mod solid;
mod surface;

pub use analysis::adjustment::choice::{
    least_dispensable, linear_rest, most_effective, most_independent, opposed, separated,
};
pub use analysis::adjustment::fit::{AdjustedSurfaces, SettingsAdjustment, WantedPoints};
pub use analysis::adjustment::shapes::Shapes;
pub use analysis::adjustment::{AdjustableSurface, Foot, FootSearch, NearFoot, StartOfFoot};
pub use analysis::alignment::Alignment;
pub use analysis::cutting::{CuttingEdges, ScallopHeight};
pub use analysis::deviation::{Deviation, EaseOff};
pub use analysis::extent::extent;
pub use analysis::geometry::{Contact, Curvature, Metric, PointGeometry, Principal, SurfaceGeometry};
pub use analysis::inspection::{Inspection, beside};
pub use analysis::intersection::{Intersection, Line, Meeting};
pub use analysis::involute::{InvoluteHelicoid, InvoluteReference, TraceEvaluation};
pub use analysis::scatter::{GaussianDraw, Scatter};
pub use analysis::secondary::{Judged, SecondaryCutting, Unseen};
pub use analysis::section::SectionPlane;
pub use analysis::sensitivity::{Displacement, NormalSensitivity, Parameter, total_derivatives};
pub use analysis::trim::{Trim, TrimmedBy};
pub use contact::{
    Carried, ContactChange, ContactNumber, ContactPath, ContactPoint, ContactProblem, ContactProof, ContactState,
    ContactSynthesis, ContactWish, Engagement, FlankCorners, FlankDirections, FlankEdge, Gap, GapProblem, NoContact,
    Outline, OutlineSegment, RollingPair, SynthesizedContact,
};
pub use continuation::follow::solve_grid;
pub use continuation::grid::{Elsewhere, GridReport};
pub use continuation::verdicts::turned;
pub use conversion::explicit::{Explicit, ExplicitProblem, Given, NotExplicit};
pub use conversion::poses::{Missing, PoseError, PoseProblem, Posture, TargetAxis};
pub use conversion::settings::{
    AdjustableMachine, STARTS as SETTING_STARTS, SettingBounds, SettingKind, SettingsFit, SettingsProblem,
    UnknownSetting,
};
pub use conversion::symmetry::{Screw, symmetries, unseen_motion};
pub use conversion::tube::{Tube, Unproven};
pub use equations::solution::{CutBy, Outcome, Range, Solution};
pub use equations::system::System;
pub use equations::tolerance::TOLERANCE;
pub use milling::axes::{MillAxes, NoMillAxes};
pub use milling::clear::{Clear, ClearProof};
pub use milling::cusp::{Cusp, cusp, left_by_block, lowest_beside, peak};
pub use milling::distance::{Nearest, Obstacle, ToolBody};
pub use milling::frame::{SurfaceFrame, SurfaceFrames};
pub use milling::guard::{Guard, SpacePlace, Struck};
pub use milling::height::{Lowest, NormalLine, lowest};
pub use milling::outline::{Cutter, NoOutline, OutlinePiece, StraightSide};
pub use milling::pose::{Bending, CutterPose, Lean, NoPose};
pub use milling::series::{Moving, PoseField, PoseSeries};
pub use milling::side::{LeftOnWay, SideMotion, SidePass, SideStrip, left_on_way, side_directions};
pub use milling::sweep::{LeftOver, SweptCutter};
pub use newton::least_squares::outliers::LinearModel;
pub use newton::least_squares::{
    LeastSquares, LeastSquaresFit, Linearized, RangeEnd, ScaledUnknown, SearchEnd, SingularDirection,
};
pub use newton::scalar::solve;
pub use roots::{Doubt, Isolated, MOST_BOXES, Roots, Undecided, all_roots};
pub use solid::arrangement::Arrangement;
pub use solid::ball::{BallFault, BallGauge};
pub use solid::blank::Blank;
pub use solid::body::{Body, BodyFault};
pub use solid::bricks::counts::BrickCounts;
pub use solid::bricks::quality::BrickQuality;
pub use solid::bricks::shaft::ShaftCounts;
pub use solid::bricks::{BrickFaces, BrickMesh, BrickOrder, BrickSide};
pub use solid::chart::Chart;
pub use solid::closed::ClosedMesh;
pub use solid::gauge::{Chord, Thickness};
pub use solid::mass::MassProperties;
pub use solid::mesh::BodyPart;
pub use solid::parts::SpacePart;
pub use solid::section::Fineness;
pub use solid::sheets::{BodySheet, SheetFace};
pub use solid::span::Span;
pub use surface::bands::Band;
pub use surface::body::is_inside_out;
pub use surface::bound::BoundSurface;
pub use surface::certify::Certifier;
pub use surface::family::SurfaceFamily;
pub use surface::points::{SurfacePoint, SurfacePoints};
pub use surface::{MOST_AT_ONCE, SurfaceProblem};
