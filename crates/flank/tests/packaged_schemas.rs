//! The package for Python carries the schemas as a file.

use serde_json::{Value, json};

/// One schema a line, by name.
#[test]
fn the_schemas_of_the_package_are_those_of_the_library() {
    let lines: Vec<String> = flank::schemas()
        .iter()
        .map(|schema| {
            let text: Value = serde_json::from_str(&schema.text).expect("JSON");
            format!("{}: {text}", json!(schema.name))
        })
        .collect();
    let text = format!("{{\n{}\n}}\n", lines.join(",\n"));
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../python/python/flank/schemas.json");
    if std::env::var_os("UPDATE_SCHEMAS").is_some() {
        std::fs::write(file, &text).expect("the file is written");
    }
    let packaged = std::fs::read_to_string(file).unwrap_or_default();
    assert!(packaged == text, "write it anew: UPDATE_SCHEMAS=1 cargo test --test packaged_schemas");
}
