//! The grammar of flank's language as editors have it. Its parser is generated, and written in C.
#![expect(unsafe_code, reason = "a function of the generated parser")]

use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_chain() -> *const ();
}

/// The language, for a parser of tree-sitter.
pub const LANGUAGE: LanguageFn = unsafe { LanguageFn::from_raw(tree_sitter_chain) };
/// What is highlighted, and as what.
pub const HIGHLIGHTS: &str = include_str!("queries/highlights.scm");
/// What can be folded.
pub const FOLDS: &str = include_str!("queries/folds.scm");
