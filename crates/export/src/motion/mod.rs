//! What the axes of a machine do over a motion: as tables and as NC programs.

mod csv;
mod dialect;
mod json;
mod nc;
mod passes;
mod table;
mod tip;

pub use self::csv::write_motion_csv;
pub use dialect::Dialect;
pub(crate) use json::schema as json_schema;
pub use json::write_motion_json;
pub use nc::{NcError, write_nc};
pub use passes::{PassProgram, ProgramPass, ProgramRapid, WordsOf, write_passes};
pub use table::{AxisSeries, MachineAxis, MotionRow, MotionTable, Rates, Series};
pub use tip::{TipFrame, TipTurn};
