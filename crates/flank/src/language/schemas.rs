//! The JSON schemas of all documents.
//!
//! Those of results are made from their types. Files that `flank-export` writes piece by piece have no type, and a schema in a file.

use std::collections::BTreeMap;

use include_dir::{Dir, include_dir};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde::Serialize;
use serde_json::{Value, json};

use crate::compare::deviation_result::DeviationResult;
use crate::compare::measure_result::MeasureResult;
use crate::convert::result::{AxisMotion, FoundSettings};
use crate::derive::result::{CostTable, Derivation};
use crate::draw::result::PlotResult;
use crate::exchange::import::Imported;
use crate::exchange::templates::{JobFromTemplate, TemplateList};
use crate::language::check::CheckResult;
use crate::language::errors::Explanation;
use crate::page::result::ViewResult;
use crate::report::result::ReportResult;
use crate::solve::result::SolveResult;

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../schemas");

/// A schema.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Schema {
    /// The name of its documents, such as `flank.solve/3`: what they have in `schema`.
    pub name: String,
    /// What they hold.
    pub about: String,
    /// JSON Schema 2020-12.
    #[serde(skip)]
    pub text: String,
}

/// All schemas of the library, by name.
pub fn schemas() -> Vec<Schema> {
    let of_files = FILES.files().map(|file| {
        let text = file.contents_utf8().expect("schemas are UTF-8, as a test holds");
        let schema: Value = serde_json::from_str(text).expect("schemas are JSON, as a test holds");
        Schema::new(&schema, text.to_string())
    });
    let of_types = [
        schema_of::<CheckResult>(),
        schema_of::<Explanation>(),
        schema_of::<SolveResult>(),
        schema_of::<DeviationResult>(),
        schema_of::<MeasureResult>(),
        schema_of::<AxisMotion>(),
        schema_of::<FoundSettings>(),
        schema_of::<Derivation>(),
        schema_of::<CostTable>(),
        schema_of::<PlotResult>(),
        schema_of::<ViewResult>(),
        schema_of::<ReportResult>(),
        schema_of::<Imported>(),
        schema_of::<JobFromTemplate>(),
        schema_of::<TemplateList>(),
    ];
    let all: BTreeMap<String, Schema> = of_files.chain(of_types).map(|schema| (schema.name.clone(), schema)).collect();
    all.into_values().collect()
}

/// The schema of the documents that a type serialises to. Its name in documents (`flank.solve/3`) is the one that serde has for it, and
/// its tag `schema` is taken for granted.
pub fn schema_of<T: JsonSchema>() -> Schema {
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
    let schema = schema.to_value();
    Schema::new(&schema, format!("{schema:#}\n"))
}

/// No object has keys that are not named. The formats are those of Rust's numbers, which JSON does not know.
fn closed(schema: &mut schemars::Schema) {
    schema.remove("format");
    if schema.get("properties").is_some() && schema.get("additionalProperties").is_none() {
        schema.insert("additionalProperties".to_string(), json!(false));
    }
}

impl Schema {
    fn new(schema: &Value, text: String) -> Schema {
        let word = |key: &str| schema[key].as_str().unwrap_or_default().to_string();
        Schema { name: word("title"), about: word("description"), text }
    }

    /// Whether it is meant by a name, with or without `flank.` and version.
    pub fn is_named(&self, name: &str) -> bool {
        let bare = |name: &str| name.strip_prefix("flank.").unwrap_or(name).to_string();
        let (own, name) = (bare(&self.name), bare(name));
        own == name || own.split('/').next() == Some(&name)
    }
}
