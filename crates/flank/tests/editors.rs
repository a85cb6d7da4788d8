//! What editors have of the language without a server is made from the parser's own lists of words.

use std::path::{Path, PathBuf};

use flank::{is_reserved, vocabulary};
use serde_json::{Value, json};

fn editors() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors")
}

/// Longer words first: of two that begin alike, the first that fits is taken.
fn one_of(words: &[&str]) -> String {
    let mut words = words.to_vec();
    words.sort_by_key(|word| (std::cmp::Reverse(word.len()), *word));
    words.dedup();
    words.join("|")
}

/// The grammar that VS Code and forges colour specs by.
fn text_mate() -> Value {
    const NAME: &str = "[\\p{L}_][\\p{L}\\p{N}_]*";
    // letters of other scripts are letters, too: `\\b` would end a word at them
    let word = |words: &str| format!("(?<![\\p{{L}}\\p{{N}}_.])({words})(?![\\p{{L}}\\p{{N}}_])");
    let of = vocabulary();
    let begin: Vec<&str> = [of.in_machine, of.in_tool, of.in_surface, of.in_job].concat();
    let (sure, free): (Vec<&str>, Vec<&str>) = begin.iter().partition(|word| is_reserved(word));
    let units = one_of(of.units);
    let unit = format!("(?:{units})(?:\\^-?\\d+)?");
    let choices_and_words: Vec<&str> = [of.inside, of.choices].concat();
    json!({
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "chain",
        "scopeName": "source.chain",
        "patterns": [
            { "name": "comment.line.documentation.chain", "match": "//[/!].*$" },
            { "name": "comment.line.double-slash.chain", "match": "//.*$" },
            { "name": "string.quoted.double.chain", "begin": "\"", "end": "\"|$" },
            {
                "match": format!("(?<![\\p{{L}}\\p{{N}}_])(\\d+(?:\\.\\d+)?(?:[eE][+-]?\\d+)?)(?:[ \\t]*({unit}(?:[ \\t]*/[ \\t]*{unit})*)(?![\\p{{L}}\\p{{N}}_]))?"),
                "captures": { "1": { "name": "constant.numeric.chain" }, "2": { "name": "keyword.other.unit.chain" } },
            },
            {
                "match": format!("{}[ \\t]+({NAME})", word(&one_of(&of.items.iter().copied().filter(|item| *item != "use").collect::<Vec<_>>()))),
                "captures": { "1": { "name": "storage.type.chain" }, "2": { "name": "entity.name.type.chain" } },
            },
            { "name": "keyword.control.import.chain", "match": word("use") },
            {
                "match": format!("{}[ \\t]+({NAME})", word(&one_of(&["param", "let", "axis", "frame", "motion", "surface"]))),
                "captures": { "1": { "name": "keyword.control.chain" }, "2": { "name": "variable.other.definition.chain" } },
            },
            { "name": "keyword.control.chain", "match": word(&one_of(&sure)) },
            {
                "match": format!("^[ \\t]*({})(?=[ \\t]+[\\p{{L}}_])", one_of(&free)),
                "captures": { "1": { "name": "keyword.control.chain" } },
            },
            { "name": "keyword.operator.word.chain", "match": word(&one_of(of.connecting)) },
            { "name": "support.type.dimension.chain", "match": word(&one_of(of.dimensions)) },
            { "name": "support.function.chain", "match": format!("{}(?=\\()", word(&one_of(&of.functions))) },
            { "name": "entity.name.function.chain", "match": format!("(?<![\\p{{L}}\\p{{N}}_.]){NAME}(?=\\()") },
            { "name": "variable.parameter.chain", "match": format!("{NAME}(?=:(?!:))") },
            { "name": "keyword.other.chain", "match": word(&one_of(&choices_and_words)) },
            { "name": "keyword.operator.chain", "match": "->|<=|>=|==|!=|\\.\\.|[=+*/^<>-]" },
        ],
    })
}

#[test]
fn the_grammar_for_colours_is_made_from_the_words_of_the_parser() {
    let path = editors().join("vscode/syntaxes/chain.tmLanguage.json");
    let made = format!("{:#}\n", text_mate());
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, &made).expect("the grammar");
    }
    let written = std::fs::read_to_string(&path).expect("the grammar; UPDATE_PAGES=1 makes it");
    assert!(made == written, "the words of the language have changed: UPDATE_PAGES=1 makes {}", path.display());
}
