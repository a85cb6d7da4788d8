//! The JSON schemas of all documents, made from their types.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use crate::compare::deviation_result::DeviationResult;
use crate::compare::fit::result::FitResult;
use crate::compare::measure_result::MeasureResult;
use crate::compare::sweep::plan::Plan;
use crate::compare::sweep::result::SweepResult;
use crate::compare::synthesis::result::SynthesisResult;
use crate::compare::tolerance::result::ToleranceResult;
use crate::contact::result::ContactResult;
use crate::convert::milling::result::MillResult;
use crate::convert::result::{AxisMotion, FoundSettings};
use crate::draw::result::PlotResult;
use crate::exchange::import::Imported;
use crate::exchange::templates::{FromLibrary, TemplateList};
use crate::language::check::CheckResult;
use crate::language::derive::result::{CostTable, Derivation};
use crate::language::errors::Explanation;
use crate::page::result::ViewResult;
use crate::report::result::ReportResult;
use crate::solve::body::bricks_result::MeshResult;
use crate::solve::body::result::SolidResult;
use crate::solve::result::SolveResult;
use crate::testing::result::TestResult;

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
    let of_files = flank_export::schemas().map(|schema| Schema::new(&schema));
    let of_types = [
        schema_of::<CheckResult>(),
        schema_of::<Explanation>(),
        schema_of::<SolveResult>(),
        schema_of::<SolidResult>(),
        schema_of::<MeshResult>(),
        schema_of::<DeviationResult>(),
        schema_of::<ContactResult>(),
        schema_of::<FitResult>(),
        schema_of::<SynthesisResult>(),
        schema_of::<ToleranceResult>(),
        schema_of::<SweepResult>(),
        schema_of::<Plan>(),
        schema_of::<MeasureResult>(),
        schema_of::<MillResult>(),
        schema_of::<AxisMotion>(),
        schema_of::<FoundSettings>(),
        schema_of::<Derivation>(),
        schema_of::<CostTable>(),
        schema_of::<PlotResult>(),
        schema_of::<ViewResult>(),
        schema_of::<ReportResult>(),
        schema_of::<TestResult>(),
        schema_of::<Imported>(),
        schema_of::<FromLibrary>(),
        schema_of::<TemplateList>(),
    ];
    let all: BTreeMap<String, Schema> =
        of_files.into_iter().chain(of_types).map(|schema| (schema.name.clone(), schema)).collect();
    all.into_values().collect()
}

/// The schema of the documents that a type serialises to. Its name in documents (`flank.solve/3`) is the one that serde has for it, and
/// its tag `schema` is taken for granted.
pub fn schema_of<T: JsonSchema>() -> Schema {
    Schema::new(&flank_export::schema_of::<T>())
}

impl Schema {
    fn new(schema: &Value) -> Schema {
        let word = |key: &str| schema[key].as_str().unwrap_or_default().to_string();
        Schema { name: word("title"), about: word("description"), text: format!("{schema:#}\n") }
    }

    /// Whether it is meant by a name, with or without `flank.` and version.
    pub fn is_named(&self, name: &str) -> bool {
        let bare = |name: &str| name.strip_prefix("flank.").unwrap_or(name).to_string();
        let (own, name) = (bare(&self.name), bare(name));
        own == name || own.split('/').next() == Some(&name)
    }
}
