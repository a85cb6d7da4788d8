//! `flank check`

use flank::{Checked, check};
use serde_json::json;

use crate::arguments::Check;
use crate::failure::{Failure, findings_in_full};
use crate::{Ending, document, eprint, print, spec};

pub(crate) fn run(arguments: &Check) -> Result<Ending, Failure> {
    let mut files: Vec<Checked> = Vec::new();
    for file in &arguments.files {
        let checked = check(&spec::project(file)?);
        if !arguments.json {
            eprint(&findings_in_full(&checked.findings));
            print(&format!("{}: {}\n", checked.file, if checked.ok { "ok" } else { "wrong" }));
        }
        files.push(checked);
    }
    if arguments.json {
        print(&document::text("flank.check/1", &json!({ "files": files })));
    }
    Ok(if files.iter().all(|checked| checked.ok) { Ending::Done } else { Ending::Wrong })
}
