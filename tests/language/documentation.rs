//! Every block of the language's documentation means what the page says.

use flank_chain_dsl::{Severity, compile_text, render};
use flank_expr::Graph;
use flank_tests::repository;

struct Block {
    line: usize,
    text: String,
    /// The code that it must give, if it is one of the wrong ones.
    wrong: Option<String>,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut announced = None;
    let mut open: Option<Block> = None;
    for (index, line) in page.lines().enumerate() {
        if let Some(code) = line.strip_prefix("Error ").and_then(|rest| rest.strip_suffix(':')) {
            announced = Some(code.to_string());
        }
        match (&mut open, line.trim()) {
            (None, "```chain") => open = Some(Block { line: index + 1, text: String::new(), wrong: None }),
            (None, "```chain,wrong") => {
                let wrong = Some(announced.take().expect("a wrong block has its error above it"));
                open = Some(Block { line: index + 1, text: String::new(), wrong });
            }
            (Some(_), "```") => blocks.extend(open.take()),
            (Some(block), _) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, _) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

#[test]
fn blocks_compile_one_after_the_other() {
    let page = std::fs::read_to_string(repository("docs/language.md")).expect("the page is there");
    let blocks = blocks(&page);
    assert!(blocks.len() >= 7, "the page has its blocks");
    let mut so_far = String::new();
    for block in blocks {
        let text = format!("{so_far}\n{}", block.text);
        let graph = Graph::new();
        let compilation = compile_text(&graph, "docs/language.md", &text, &[]);
        let told = render(&compilation.diagnostics, &compilation.sources, false);
        let errors: Vec<&str> = compilation
            .diagnostics
            .iter()
            .filter(|finding| finding.severity() == Severity::Error)
            .map(|finding| finding.code.as_str())
            .collect();
        match block.wrong {
            Some(code) => assert_eq!(errors, [code], "block at line {}:\n{told}", block.line),
            None => {
                assert!(compilation.diagnostics.is_empty(), "block at line {}:\n{told}", block.line);
                so_far = text;
            }
        }
    }
}
