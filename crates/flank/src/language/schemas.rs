//! The JSON schemas of all documents, as they were when the program was built.

use std::collections::BTreeMap;

use include_dir::{Dir, include_dir};
use serde::Serialize;
use serde_json::Value;

static SCHEMAS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../schemas");

/// A schema.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Schema {
    /// The name of its documents, such as `flank.solve/3`.
    pub name: String,
    /// What they hold.
    pub about: String,
    /// JSON Schema 2020-12.
    #[serde(skip)]
    pub text: &'static str,
}

/// All schemas, by name.
pub fn schemas() -> Vec<Schema> {
    let schemas = SCHEMAS.files().map(|file| {
        let text = file.contents_utf8().expect("schemas are UTF-8, as a test holds");
        let schema: Value = serde_json::from_str(text).expect("schemas are JSON, as a test holds");
        let word = |key: &str| schema[key].as_str().unwrap_or_default().to_string();
        (word("title"), Schema { name: word("title"), about: word("description"), text })
    });
    schemas.collect::<BTreeMap<String, Schema>>().into_values().collect()
}

/// The schema of a name, with or without `flank.` and version; of several versions the newest.
pub fn schema(name: &str) -> Option<Schema> {
    let bare = |name: &str| name.strip_prefix("flank.").unwrap_or(name).to_string();
    let is_meant = |known: &Schema| {
        let (known, name) = (bare(&known.name), bare(name));
        known == name || known.split('/').next() == Some(&name)
    };
    schemas().into_iter().rfind(is_meant)
}
