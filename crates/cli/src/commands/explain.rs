//! `flank explain`

use flank::{ErrorCode, Explanation, error_codes, error_page};

use crate::arguments::Explain;
use crate::{Ending, document, print};

pub(crate) fn run(arguments: &Explain) -> Ending {
    print(&match (arguments.code, arguments.json) {
        (Some(code), false) => error_page(code).to_string(),
        (Some(code), true) => document::text(&Explanation::of_code(code)),
        (None, false) => list(&error_codes()),
        (None, true) => document::text(&Explanation::of_all()),
    });
    Ending::Done
}

/// One line for each code.
fn list(all: &[ErrorCode]) -> String {
    let lines: String = all.iter().map(|code| format!("{}  {}\n", code.code, code.title)).collect();
    format!("{lines}\n`flank explain {}` prints the page about one of them\n", all[0].code)
}
