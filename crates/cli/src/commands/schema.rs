//! `flank schema`

use flank::Schema as Shipped;

use crate::arguments::Schema;
use crate::document::{SchemaList, schemas};
use crate::failure::Failure;
use crate::{Ending, document, print};

pub(crate) fn run(arguments: &Schema) -> Result<Ending, Failure> {
    print(&match &arguments.name {
        Some(name) => find(name)?.text,
        None if arguments.json => document::text(&SchemaList { schemas: schemas() }),
        None => list(&schemas()),
    });
    Ok(Ending::Done)
}

/// # Errors
/// Which there are, if there is none of that name.
fn find(name: &str) -> Result<Shipped, Failure> {
    // of several versions the newest
    schemas().into_iter().rfind(|known| known.is_named(name)).ok_or_else(|| {
        let known: Vec<String> = schemas().into_iter().map(|known| known.name).collect();
        Failure::of_usage(format!("there is no schema `{name}`; there is: {}", known.join(", ")))
    })
}

/// One line for each, with the first sentence about it.
fn list(all: &[Shipped]) -> String {
    let width = all.iter().map(|schema| schema.name.len()).max().unwrap_or(0);
    let line = |schema: &Shipped| {
        let first = schema.about.split_inclusive(['.', ':', ';']).next().unwrap_or_default();
        format!("{:width$}  {}\n", schema.name, first.trim_end_matches(['.', ':', ';']))
    };
    format!("{}\n`flank schema NAME` prints one of them\n", all.iter().map(line).collect::<String>())
}
