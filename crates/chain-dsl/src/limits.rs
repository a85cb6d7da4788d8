//! The limits of the language, in one place.

/// Size of one file.
pub const FILE_BYTES: usize = 1 << 20;
/// Depth to which files use each other.
pub const USE_DEPTH: usize = 32;
/// Depth of brackets, conditionals and signs in an expression.
pub const NESTING: usize = 64;
/// Words and signs in one statement.
pub const STATEMENT_TOKENS: usize = 1 << 16;
/// Operations that hang on each other in one expression: the height of its tree, which later stages walk recursively.
pub const OPERATIONS: usize = 256;
/// Mistakes in the syntax of one file before the rest of it is left unread.
pub const MISTAKES: usize = 100;
/// Depth to which functions call each other.
pub const CALL_DEPTH: usize = 64;
/// Steps of evaluating expressions in one compilation.
pub const EVALUATION_STEPS: usize = 2_000_000;
/// Frames of one machine.
pub const FRAMES: usize = 10_000;
/// Size of a table that a curve is read from.
pub const TABLE_BYTES: usize = 1 << 26;
/// Rows of such a table.
pub const TABLE_ROWS: usize = 100_000;
/// Points of one sample.
pub const SAMPLE_POINTS: usize = 20_000_000;
/// Depth to which machines extend each other.
pub const EXTENDS_DEPTH: usize = 64;
