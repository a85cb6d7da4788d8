//! `flank check`

use flank_chain_dsl::Request;
use flank_expr::Graph;
use serde_json::{Value, json};

use crate::arguments::Check;
use crate::failure::{Failure, as_json};
use crate::spec::{compiled, shown, tell};
use crate::{Ending, print};

pub(crate) fn run(arguments: &Check) -> Result<Ending, Failure> {
    let mut ending = Ending::Done;
    let mut files = Vec::new();
    for file in &arguments.files {
        let graph = Graph::new();
        let compilation = compiled(&graph, file, Request::default())?;
        let wrong = compilation.has_errors();
        if wrong {
            ending = Ending::Wrong;
        }
        if arguments.json {
            let findings: Vec<Value> =
                compilation.diagnostics.iter().map(|finding| as_json(finding, &compilation.sources)).collect();
            files.push(json!({ "file": shown(file), "ok": !wrong, "findings": findings }));
        } else {
            tell(&compilation.diagnostics, &compilation.sources);
            print(&format!("{}: {}\n", shown(file), if wrong { "wrong" } else { "ok" }));
        }
    }
    if arguments.json {
        print(&format!("{:#}\n", json!({ "schema": "flank.check/1", "files": files })));
    }
    Ok(ending)
}
