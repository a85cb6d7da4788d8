//! Solved tooth surfaces as files: CSV, JSON, Parquet, STL, OBJ, 3MF, VTK, STEP; bodies as bricks for Abaqus, CalculiX and ParaView; and what axes do over a motion: CSV, JSON, NC programs.
//!
//! A [`Dataset`] is a list of [`Patch`]es, each a grid of [`Point`]s in a named frame. This crate writes it and knows
//! nothing of how the points were solved. Lengths are mm. Angles are handed over in radians and written in degrees.
//! Every file states its conventions: frame, units, the side the normals point to, what rows and columns mean, the
//! program, the spec and its hash, the worst residual, and how many points were solved of those asked for. A point that
//! was not solved is written as such: no file and no picture invents a position for it.
//!
//! ```
//! use flank_export::{Axis, Dataset, Field, Header, Layout, Outcome, Patch, Point, Unit, Unknown, Values, write_csv};
//!
//! let point = |z: f64| Point {
//!     outcome: Outcome::Solved,
//!     position: [30.0, 0.0, z],
//!     normal: [1.0, 0.0, 0.0],
//!     unknowns: vec![std::f64::consts::FRAC_PI_2],
//!     residual: 0.0,
//!     reason: String::new(),
//! };
//! let dataset = Dataset {
//!     header: Header {
//!         program: "flank 0.1.0".into(),
//!         spec: "cylinder.flank".into(),
//!         spec_hash: "5e1f".into(),
//!         job: "cylinder".into(),
//!         conventions: Vec::new(),
//!     },
//!     patches: vec![Patch {
//!         name: "side".into(),
//!         frame: "m.table".into(),
//!         layout: Layout::Round,
//!         rows: Axis { label: "z".into(), count: 2 },
//!         columns: Axis { label: "rho".into(), count: 1 },
//!         unknowns: vec![Unknown { name: "phi".into(), unit: Unit::Degree }],
//!         points: vec![point(-0.0), point(0.1)],
//!         fields: vec![Field {
//!             name: "k1".into(),
//!             unit: "1/mm".into(),
//!             meaning: "larger principal curvature, positive where the body is convex".into(),
//!             values: Values::Scalars([Some(1.0 / 32.0), None].into()),
//!         }],
//!     }],
//! };
//!
//! let mut file = Vec::new();
//! write_csv(&dataset.surfaces(), &mut file)?;
//! let text = String::from_utf8(file)?;
//! let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
//! assert_eq!(rows[0], "surface,i,j,x,y,z,nx,ny,nz,phi,residual,status,k1");
//! assert_eq!(rows[1], "side,0,0,30,0,0,1,0,0,90,0,solved,0.03125");
//! assert_eq!(rows[2], "side,1,0,30,0,0.1,1,0,0,90,0,solved,");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`MeasuringGrid`] holds the same points as measuring machines want them; [`read_measured`] reads what these measured.
//!
//! A [`MotionTable`] holds the positions of a machine's axes; `write_motion_csv`, `write_motion_json` and [`write_nc`] write it.
//!
//! The same dataset gives the same bytes, in every format.

mod files;
mod measuring;
mod motion;
mod points;
mod schema;
pub mod shape;
mod solid;
mod step;
pub mod text;
pub mod vector;

pub use files::atomic_file::{FileSet, make_folder, write_atomically};
pub use files::error::{FileError, FolderError, Malformed, WriteError};
#[cfg(feature = "parquet")]
pub use files::read_rows::{ParquetFault, parquet_as_csv};
pub use files::regions::Target;
#[cfg(feature = "parquet")]
pub use files::rows::{CellKind, ParquetRows};
pub use measuring::{
    FlankEnds, Hand, Measured, MeasuredFault, MeasuredGrid, MeasuredPoint, MeasuringGrid, NominalFlank, NominalPart,
    read_measured, write_grid_csv, write_grid_json,
};
pub use motion::{
    AxisSeries, Dialect, MachineAxis, MotionRow, MotionTable, NcError, PassProgram, ProgramPass, ProgramRapid, Rates,
    Series, TipFrame, TipTurn, WordsOf, write_motion_csv, write_motion_json, write_nc, write_passes,
};
pub use points::bands::{Banded, Surfaces, Taker};
pub use points::conventions::sentences as conventions;
pub use points::csv::write_csv;
pub use points::dataset::{Axis, Dataset, Field, Header, Layout, Outcome, Patch, Point, Unit, Unknown, Values};
pub use points::json::write_json;
pub use points::known::{Kept, Known};
pub use points::obj::write_obj;
#[cfg(feature = "parquet")]
pub use points::parquet::write_parquet;
pub use points::stl::write_stl;
pub use points::tally::Tally;
pub use points::threemf::write_3mf;
pub use points::vtp::write_vtp;
pub use schema::schema_of;
pub use solid::{
    BodyMesh, BrickBody, BrickSet, PlacedFrame, write_body_3mf, write_body_obj, write_body_stl, write_inp, write_vtu,
};
pub use step::{
    Deviation, Face, GearBody, GearRun, GearSide, GearStrip, PlacedBody, TurnedSegment, spline_deviation, write_step,
    write_step_assembly, write_step_body,
};
pub use text::number::{degrees, fixed};

/// The schemas of the JSON documents that this crate writes: surfaces, motion tables, measuring grids.
pub fn schemas() -> [serde_json::Value; 3] {
    [points::json::schema(), motion::json_schema(), measuring::json_schema()]
}
