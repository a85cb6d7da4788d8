//! One settled layout for the language.
//!
//! The text becomes a row of tokens that carry the comments around them (`tokens`), and above them a tree of what may be
//! broken where (`tree`, `build`). The printer (`print`) writes lines: `statements` and `expressions` decide where they end,
//! `align` sets equal signs and remarks of neighbouring lines below each other.
//!
//! A comment stays between the two tokens that it was written between, at the end of a line if it was there, on a line of
//! its own otherwise. So none is lost, none changes its place among the others, and none becomes or ceases to be the
//! documentation of a statement. Whatever decides about a line end is found again in the text that was laid out: the layout
//! of a layout is itself.

mod align;
mod build;
mod expressions;
mod print;
mod statements;
mod tokens;
mod tree;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::source::FileId;
use crate::syntax;

/// Longest line, in characters. Only what cannot be broken is longer: a word, a text, a comment.
const WIDTH: usize = 110;

/// Columns by which what belongs to a line is indented below it.
const STEP: usize = 4;

/// A text in the settled layout. It means the same and has the same comments; only white space changes, and commas at the
/// end of a list or of a line in a sample go.
///
/// ```
/// use flank_chain_dsl::{FileId, format};
///
/// let text = "machine m { axis X:linear // radial\n frame bed frame slide in bed=translate_x( X+2mm ) }";
/// let laid_out = "\
/// machine m {
///     axis X : linear  // radial
///     frame bed
///     frame slide in bed = translate_x(X + 2 mm)
/// }
/// ";
/// assert_eq!(format(text, FileId(0)).as_deref(), Ok(laid_out));
/// ```
///
/// # Errors
/// A text that does not parse is not laid out; what is wrong with it is reported.
pub fn format(text: &str, file: FileId) -> Result<String, Vec<Diagnostic>> {
    let parts = syntax::concrete(text, file)?;
    let source = build::source(text, &parts, &syntax::comments(text, file));
    let mut printer = print::Printer::new(&source.tokens);
    printer.file(&source.items);
    let mut lines = printer.finish();
    align::align(&mut lines);
    let laid_out = print::joined(&lines);
    match syntax::too_long(&laid_out, file) {
        Some(diagnostic) => Err(vec![diagnostic]),
        None => Ok(laid_out),
    }
}
