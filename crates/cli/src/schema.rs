//! `flank schema`: the JSON schemas of all documents, as they were when the program was built.

use std::collections::BTreeMap;

use include_dir::{Dir, include_dir};
use serde_json::{Value, json};

use crate::arguments::Schema;
use crate::failure::Failure;
use crate::{Ending, print};

static SCHEMAS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../schemas");

pub(crate) fn run(arguments: &Schema) -> Result<Ending, Failure> {
    let all = all();
    print(&match &arguments.name {
        Some(name) => find(&all, name)?.to_string(),
        None if arguments.json => list_as_json(&all),
        None => list(&all),
    });
    Ok(Ending::Done)
}

/// A schema's text with what it says of itself.
struct Shipped {
    text: &'static str,
    about: String,
}

/// All schemas by the names of their documents, such as `flank.solve/3`.
fn all() -> BTreeMap<String, Shipped> {
    let schemas = SCHEMAS.files().map(|file| {
        let text = file.contents_utf8().expect("schemas are UTF-8, as a test holds");
        let schema: Value = serde_json::from_str(text).expect("schemas are JSON, as a test holds");
        let word = |key: &str| schema[key].as_str().unwrap_or_default().to_string();
        (word("title"), Shipped { text, about: word("description") })
    });
    schemas.collect()
}

/// # Errors
/// Which there are, if there is none of that name.
fn find(all: &BTreeMap<String, Shipped>, name: &str) -> Result<&'static str, Failure> {
    let is_meant = |known: &str| {
        let bare = |name: &str| name.strip_prefix("flank.").unwrap_or(name).to_string();
        let (known, name) = (bare(known), bare(name));
        known == name || known.split('/').next() == Some(&name)
    };
    // the newest of several versions comes last
    let found = all.iter().rfind(|(known, _)| is_meant(known));
    found.map(|(_, schema)| schema.text).ok_or_else(|| {
        let known: Vec<&str> = all.keys().map(String::as_str).collect();
        Failure::of_usage(format!("there is no schema `{name}`; there is: {}", known.join(", ")))
    })
}

/// One line for each, with the first sentence about it.
fn list(all: &BTreeMap<String, Shipped>) -> String {
    let width = all.keys().map(String::len).max().unwrap_or(0);
    let line = |(name, schema): (&String, &Shipped)| {
        let first = schema.about.split_inclusive(['.', ':', ';']).next().unwrap_or_default();
        format!("{name:width$}  {}\n", first.trim_end_matches(['.', ':', ';']))
    };
    format!("{}\n`flank schema NAME` prints one of them\n", all.iter().map(line).collect::<String>())
}

fn list_as_json(all: &BTreeMap<String, Shipped>) -> String {
    let entry = |(name, schema): (&String, &Shipped)| json!({ "name": name, "about": schema.about });
    let schemas: Vec<Value> = all.iter().map(entry).collect();
    format!("{:#}\n", json!({ "schema": "flank.schemas/1", "schemas": schemas }))
}
