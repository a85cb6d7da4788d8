//! The language: text in, diagnostics or a checked symbolic model out.
//!
//! ```
//! let graph = flank_expr::Graph::new();
//! let text = "
//!     machine lathe {
//!         axis Z : linear
//!         axis C : rotary
//!         frame bed
//!         frame slide in bed = translate_z(Z)
//!         frame work  in bed = rotate_z(C)
//!     }
//!     tool ball {
//!         param radius : length = 5 mm
//!         surface face(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) {
//!             at = [20 mm - radius * cos(u) * cos(v), radius * cos(u) * sin(v), radius * sin(u)]
//!             body towards [1, 0, 0]
//!         }
//!     }
//!     job thread {
//!         machine m = lathe
//!         tool b = ball
//!         mount b on m.slide
//!         motion turn : angle in 0 deg .. 360 deg
//!         drive m.C = turn
//!         drive m.Z = 4 mm/rev * turn
//!         surface groove in m.work = envelope(b.face, over: turn)
//!         sample groove { u: -50 deg .. 50 deg by 5, turn: 10 deg .. 350 deg by 9 }
//!     }";
//! let compilation = flank_chain_dsl::compile_text(&graph, "thread.chain", text, &[]);
//! assert!(compilation.diagnostics.is_empty());
//! assert_eq!(compilation.jobs[0].surfaces[0].surface.constraints.len(), 1);
//! ```

// what makes a parser of the grammar names it
extern crate alloc;

mod compile;
mod definitions;
mod derivation;
mod diagnostics;
mod format;
mod job;
pub mod limits;
mod load;
mod model;
pub mod syntax;
mod values;

pub use compile::{
    Compilation, MachineExpectations, Request, compile_file, compile_request, compile_text, compile_with_machine,
};
pub use definitions::index::{Entry, Index, KnownValue, NameKind, Symbol, SymbolId, Target, WordKind};
pub use derivation::{derivation, described, equations};
pub use diagnostics::codes::Code;
pub use diagnostics::explain::UnknownCode;
pub use diagnostics::render::render;
pub use diagnostics::source::{FileId, Name, SourceFile, Sources, Span, Spanned};
pub use diagnostics::spelling::closest;
pub use diagnostics::{Cure, Diagnostic, Note, Severity};
pub use format::format;
pub use job::expect::model::{
    ContactNumber, DeviationNumber, Expectation, Expected, ExpectedError, PointColumn, PointSet, PoseDifference,
    PoseTolerance, Quantity, SolidNumber,
};
pub use job::sample::spaced;
pub use load::files::{Buffers, Disk, Files, FolderEntry};
pub use load::{project_folder, read_file, read_other_file, reason as unreadable_reason};
pub use model::{
    Axis, BlockLength, Contact, ContactCondition, ContactQuantity, Coordinate, CutterPiece, Frame, GeneratedSurface,
    Generation, Job, LawSource, Machine, MilledArea, Milling, MillingClearance, MillingObstacle, MountingAxis, NcWord,
    OutlineCurve, OutlineSegment, Parameter, PassSpacing, PieceEnds, PointRequirement, Process, RangedVariable, Sample,
    SampleEnds, SampleGrid, Solid, SolidForm, ToolShape, ValueSource, WantedContact,
};
pub use values::dimension::{Dimension, WrittenUnit, unit_size};
pub use values::lone::lone_value;
pub use values::steel_side::{OpenSide, SteelSide};
