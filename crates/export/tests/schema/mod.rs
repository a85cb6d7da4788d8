//! Documents held against the schemas that the program ships.

use serde_json::Value;

/// Faults of a document by a schema: place and rule.
pub(crate) fn faults_of(document: &Value, schema: &str) -> Vec<String> {
    let schema: Value = serde_json::from_str(schema).expect("the schema is JSON");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let fault =
        |fault: jsonschema::ValidationError<'_>| format!("{}: {}", fault.instance_path(), fault.kind().keyword());
    validator.iter_errors(document).map(fault).collect()
}
