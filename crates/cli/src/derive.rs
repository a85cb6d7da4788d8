//! `flank derive`

use flank_chain_dsl::derivation;
use flank_expr::{Graph, Style};

use crate::arguments::Derive;
use crate::{Ending, print, spec};

pub(crate) fn run(arguments: &Derive) -> Ending {
    let graph = Graph::new();
    let (_, jobs) = match spec::jobs(&graph, &arguments.which) {
        Ok(found) => found,
        Err(ending) => return ending,
    };
    let style = if arguments.latex { Style::Latex } else { Style::Text };
    for job in &jobs {
        print(&derivation(job, style));
    }
    Ending::Done
}
