//! Makes `src/parser.c` of `grammar.js`: `cargo run` in this folder. It needs node.

use std::path::Path;

use tree_sitter_generate::{OptLevel, generate_parser_for_grammar, load_grammar_file};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("a folder above")?;
    let grammar = load_grammar_file(&folder.join("grammar.js"), Some("node"))?;
    let (_, parser) = generate_parser_for_grammar(&grammar, Some((0, 1, 0)), OptLevel::default(), &mut Vec::new())?;
    std::fs::write(folder.join("src/parser.c"), parser)?;
    Ok(())
}
