//! Results as documents of JSON.

use serde::Serialize;
use serde_json::{Value, json};

/// A result with the name of its schema.
pub(crate) fn text(schema: &str, result: &impl Serialize) -> String {
    let mut document = serde_json::to_value(result).expect("results have keys that are texts");
    document["schema"] = json!(schema);
    printed(&document)
}

/// A document as it is printed.
pub(crate) fn printed(document: &Value) -> String {
    format!("{document:#}\n")
}
