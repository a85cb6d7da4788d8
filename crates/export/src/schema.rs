//! The schemas of documents, made from the types that are serialised.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::{Map, Value, json};

/// The JSON Schema (2020-12) of the documents that a type serialises to. Its name in documents (`flank.surfaces/3`) is the one that serde
/// has for it, and its tag `schema` is taken for granted. No object has keys that are not named.
pub fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize().with_transform(RecursiveTransform(closed));
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    let name = schema.get("title").and_then(Value::as_str).unwrap_or_default().to_string();
    let id = name.strip_prefix("flank.").unwrap_or(&name).replace('/', ":");
    schema.insert("$id".to_string(), json!(format!("urn:flank:{id}")));
    tag(schema.ensure_object(), &name);
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        // a document within another one says what it is, too
        for (name, definition) in definitions.iter_mut().filter(|(name, _)| name.starts_with("flank.")) {
            definition.as_object_mut().into_iter().for_each(|definition| tag(definition, name));
        }
    }
    schema.to_value()
}

/// What a document says that it is.
fn tag(schema: &mut Map<String, Value>, name: &str) {
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        properties.insert("schema".to_string(), json!({ "const": name }));
    }
    if let Value::Array(required) = schema.entry("required").or_insert_with(|| json!([])) {
        required.insert(0, json!("schema"));
    }
}

/// No object has keys that are not named. The formats are those of Rust's numbers, which JSON does not know.
fn closed(schema: &mut schemars::Schema) {
    schema.remove("format");
    if schema.get("properties").is_some() && schema.get("additionalProperties").is_none() {
        schema.insert("additionalProperties".to_string(), json!(false));
    }
}
