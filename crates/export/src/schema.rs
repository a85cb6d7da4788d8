//! The schemas of documents, made from the types that are serialised.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::{Value, json};

/// The JSON Schema (2020-12) of the documents that a type serialises to. Its name in documents (`flank.surfaces/3`) is the one that serde
/// has for it, and its tag `schema` is taken for granted. No object has keys that are not named.
pub fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize().with_transform(RecursiveTransform(closed));
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    let name = schema.get("title").and_then(Value::as_str).unwrap_or_default().to_string();
    let id = name.strip_prefix("flank.").unwrap_or(&name).replace('/', ":");
    schema.insert("$id".to_string(), json!(format!("urn:flank:{id}")));
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        properties.insert("schema".to_string(), json!({ "const": name }));
    }
    let required = schema.ensure_object().entry("required").or_insert_with(|| json!([]));
    if let Value::Array(required) = required {
        required.insert(0, json!("schema"));
    }
    schema.to_value()
}

/// No object has keys that are not named. The formats are those of Rust's numbers, which JSON does not know.
fn closed(schema: &mut schemars::Schema) {
    schema.remove("format");
    if schema.get("properties").is_some() && schema.get("additionalProperties").is_none() {
        schema.insert("additionalProperties".to_string(), json!(false));
    }
}
