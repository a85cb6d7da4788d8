//! `flank check`

use flank::{CheckResult, Checked, check, check_with_names};

use crate::arguments::Check;
use crate::failure::{Failure, findings_in_full};
use crate::{Ending, document, eprint, print, spec};

pub(crate) fn run(arguments: &Check) -> Result<Ending, Failure> {
    let mut files: Vec<Checked> = Vec::new();
    for file in &arguments.files {
        let project = spec::project(file)?;
        let checked = if arguments.index { check_with_names(&project) } else { check(&project) };
        if !arguments.json {
            eprint(&findings_in_full(&checked.findings));
            print(&format!("{}: {}\n", checked.file, if checked.ok { "ok" } else { "wrong" }));
        }
        files.push(checked);
    }
    let ending = if files.iter().all(|checked| checked.ok) { Ending::Done } else { Ending::Wrong };
    if arguments.json {
        print(&document::text(&CheckResult { files }));
    }
    Ok(ending)
}
