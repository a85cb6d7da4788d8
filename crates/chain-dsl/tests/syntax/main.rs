//! The text of the language: what parses to what, and what is said where it does not.

mod cures;
#[path = "../fixtures/mod.rs"]
mod fixtures;
mod limits;
mod mistakes;
mod printed;
mod recovery;
mod rendering;
mod trees;

use flank_chain_dsl::Diagnostic;
use flank_chain_dsl::FileId;
use flank_chain_dsl::syntax::{ast, parse};

/// Texts without a mistake.
const SPECS: [(&str, &str); 4] = [
    ("hobbing", include_str!("specs/hobbing.chain")),
    ("face_mill", include_str!("specs/face_mill.chain")),
    ("gear_concave", include_str!("specs/gear_concave.chain")),
    ("everything", include_str!("specs/everything.chain")),
];

fn read(text: &str) -> (ast::File, Vec<Diagnostic>) {
    parse(text, FileId(0))
}

/// The tree of a text without a mistake.
fn tree(text: &str) -> ast::File {
    let (file, diagnostics) = read(text);
    assert!(diagnostics.is_empty(), "{text}\n{diagnostics:#?}");
    file
}
