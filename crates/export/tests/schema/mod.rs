//! A checker of the schemas that the crate ships.

use serde_json::Value;

/// Faults of a document by a schema.
pub(crate) fn faults_of(document: &Value, schema: &str) -> Vec<String> {
    let schema: Value = serde_json::from_str(schema).expect("the schema is JSON");
    faults(document, &schema, &schema, "")
}

/// Faults of a value by a schema: the words that our schema uses, all others are faults themselves.
fn faults(value: &Value, schema: &Value, root: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (rule, wanted) in entries(schema) {
        found.extend(match rule.as_str() {
            "$schema" | "$defs" | "title" | "description" => vec![],
            "$ref" => {
                let path = text(wanted).strip_prefix('#').expect("a local reference");
                let definition = root.pointer(path).expect("a definition");
                faults(value, definition, root, place)
            }
            // said of objects only
            "required" if !value.is_object() => vec![],
            "required" => {
                let missing = items(wanted).iter().map(text).filter(|key| value.get(key).is_none());
                missing.map(|key| format!("{place}: no {key}")).collect()
            }
            "additionalProperties" => {
                let extra = entries(value).filter(|(key, _)| schema["properties"].get(key).is_none());
                extra.map(|(key, _)| format!("{place}: extra {key}")).collect()
            }
            "properties" => {
                let below = |(key, schema): (&String, &Value)| match value.get(key) {
                    Some(value) => faults(value, schema, root, &format!("{place}/{key}")),
                    None => vec![],
                };
                entries(wanted).flat_map(below).collect()
            }
            "items" => {
                let below = |(at, item)| faults(item, wanted, root, &format!("{place}/{at}"));
                items(value).iter().enumerate().flat_map(below).collect()
            }
            rule if keeps(value, rule, wanted) => vec![],
            rule => vec![format!("{place}: {rule}")],
        });
    }
    found
}

/// Whether a value keeps a rule about itself alone; an unknown rule is not kept.
fn keeps(value: &Value, rule: &str, wanted: &Value) -> bool {
    let size = || items(value).len() as u64;
    match rule {
        "const" => value == wanted,
        "enum" => items(wanted).contains(value),
        "minimum" => value.as_f64() >= wanted.as_f64(),
        "minItems" => value.is_null() || Some(size()) >= wanted.as_u64(),
        "maxItems" => value.is_null() || Some(size()) <= wanted.as_u64(),
        "type" if wanted.is_array() => items(wanted).iter().any(|name| is_a(value, text(name))),
        "type" => is_a(value, text(wanted)),
        _ => false,
    }
}

fn entries(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

fn items(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

fn is_a(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        _ => false,
    }
}
