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

mod codes;
mod compile;
mod context;
mod derivation;
mod diagnostic;
mod dimension;
mod evaluate;
mod explain;
mod format;
mod functions;
mod instance;
mod job;
pub mod limits;
mod load;
mod machine;
mod model;
mod nc_word;
mod profile;
mod render;
mod requirement;
mod sample;
mod source;
mod spelling;
mod steel;
pub mod syntax;
mod tables;
mod tool;
mod transforms;
mod unused;

pub use codes::Code;
pub use compile::{Compilation, Request, compile_file, compile_request, compile_text, compile_with_machine};
pub use derivation::{derivation, described, equations};
pub use diagnostic::{Diagnostic, Note, Severity};
pub use dimension::Dimension;
pub use explain::UnknownCode;
pub use format::format;
pub use load::{read_file, read_other_file};
pub use model::{
    Axis, Bounded, Coordinate, Frame, GeneratedSurface, Generation, Giver, Job, LawSource, Limit, Machine, NcWord,
    Parameter, PieceEnds, Process, Sample, SampleEnds, SampleGrid, ToolShape,
};
pub use render::render;
pub use sample::spaced;
pub use source::{FileId, Name, SourceFile, Sources, Span, Spanned};
pub use spelling::closest;
