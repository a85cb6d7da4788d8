//! `flank derive`

use flank_chain_dsl::{Job, derivation};
use flank_expr::{Graph, Style};
use serde_json::{Value, json};

use crate::arguments::Derive;
use crate::cost::SurfaceCost;
use crate::{Ending, print, spec};

pub(crate) fn run(arguments: &Derive) -> Ending {
    let graph = Graph::new();
    let (_, jobs) = match spec::jobs(&graph, &arguments.which) {
        Ok(found) => found,
        Err(ending) => return ending,
    };
    if arguments.cost {
        return cost(&jobs, arguments.json);
    }
    let style = if arguments.latex { Style::Latex } else { Style::Text };
    for job in &jobs {
        print(&derivation(job, style));
    }
    Ending::Done
}

/// Prints how many operations the points of each sampled surface take.
fn cost(jobs: &[Job<'_>], as_json: bool) -> Ending {
    let mut told: Vec<Value> = Vec::new();
    for job in jobs {
        let costs: Vec<SurfaceCost<'_>> =
            job.surfaces.iter().filter_map(|surface| SurfaceCost::of(job, surface)).collect();
        if costs.is_empty() {
            anstream::eprintln!("error: job `{}` asks for no points: add a `sample` for one of its surfaces", job.name);
            return Ending::Wrong;
        }
        if as_json {
            let surfaces: Vec<Value> = costs.iter().map(SurfaceCost::json).collect();
            told.push(json!({ "job": job.name, "surfaces": surfaces }));
        } else {
            print(&format!("job {}\n", job.name));
            costs.iter().for_each(|cost| print(&format!("\n{}", cost.text())));
        }
    }
    if as_json {
        print(&format!("{:#}\n", json!({ "schema": "flank.cost/1", "jobs": told })));
    }
    Ending::Done
}
