//! `flank explain`

use flank_chain_dsl::{Code, Severity};
use serde_json::{Value, json};

use crate::arguments::Explain;
use crate::{Ending, print};

pub(crate) fn run(arguments: &Explain) -> Ending {
    print(&match (arguments.code, arguments.json) {
        (Some(code), false) => code.page().to_string(),
        (Some(code), true) => as_text(&with(&described(code), "page", code.page())),
        (None, false) => list(),
        (None, true) => as_text(&json!({ "codes": Code::ALL.iter().copied().map(described).collect::<Vec<_>>() })),
    });
    Ending::Done
}

/// One line for each code.
fn list() -> String {
    let line = |code: &Code| format!("{}  {}\n", code.as_str(), code.title());
    let lines: String = Code::ALL.iter().map(line).collect();
    format!("{lines}\n`flank explain {}` prints the page about one of them\n", Code::ALL[0].as_str())
}

fn described(code: Code) -> Value {
    let severity = if code.severity() == Severity::Error { "error" } else { "warning" };
    json!({ "code": code.as_str(), "severity": severity, "title": code.title() })
}

fn with(object: &Value, key: &str, value: &str) -> Value {
    let mut object = object.clone();
    object[key] = json!(value);
    object
}

fn as_text(value: &Value) -> String {
    format!("{:#}\n", with(value, "schema", "flank.explain/1"))
}
