//! `flank explain`

use flank::{ErrorCode, error_codes, error_page};
use serde_json::json;

use crate::arguments::Explain;
use crate::{Ending, document, print};

pub(crate) fn run(arguments: &Explain) -> Ending {
    print(&match (arguments.code, arguments.json) {
        (Some(code), false) => error_page(code).to_string(),
        (Some(code), true) => {
            let ErrorCode { code: name, severity, title } = code.into();
            let page = error_page(code);
            document::text(
                "flank.explain/1",
                &json!({ "code": name, "severity": severity, "title": title, "page": page }),
            )
        }
        (None, false) => list(&error_codes()),
        (None, true) => document::text("flank.explain/1", &json!({ "codes": error_codes() })),
    });
    Ending::Done
}

/// One line for each code.
fn list(all: &[ErrorCode]) -> String {
    let lines: String = all.iter().map(|code| format!("{}  {}\n", code.code, code.title)).collect();
    format!("{lines}\n`flank explain {}` prints the page about one of them\n", all[0].code)
}
