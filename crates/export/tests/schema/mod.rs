//! Documents checked against the schemas of what is written.

use serde_json::Value;

/// Faults of a document by the schema of that name: place and rule.
pub(crate) fn faults_of(document: &Value, name: &str) -> Vec<String> {
    let schema = flank_export::schemas().into_iter().find(|schema| schema["title"] == name).expect("it is written");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let fault =
        |fault: jsonschema::ValidationError<'_>| format!("{}: {}", fault.instance_path(), fault.kind().keyword());
    validator.iter_errors(document).map(fault).collect()
}
