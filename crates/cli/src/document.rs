//! Results as documents of JSON, and the documents of the command line itself.

use flank::{Finding, NotDone, Schema, schema_of};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use crate::spelling::with_flags;

/// A result as it is printed.
pub(crate) fn text(result: &impl Serialize) -> String {
    let mut document = serde_json::to_value(result).expect("results have keys that are texts");
    for messages in ["remarks", "not_done"] {
        document.get_mut(messages).and_then(Value::as_array_mut).into_iter().flatten().for_each(spell);
    }
    format!("{document:#}\n")
}

/// The words of a message with flags for the library's options.
fn spell(message: &mut Value) {
    let spelled = |words: &mut Value| {
        if let Value::String(text) = words {
            *text = with_flags(text);
        }
    };
    spelled(&mut message["message"]);
    message["details"].as_array_mut().into_iter().flatten().for_each(spelled);
}

/// The schemas of all documents that the program prints or writes, by name.
pub(crate) fn schemas() -> Vec<Schema> {
    let mut all = flank::schemas();
    all.extend([
        schema_of::<FailureDocument>(),
        schema_of::<LaidOutFiles>(),
        schema_of::<SchemaList>(),
        schema_of::<CompletionScript>(),
        schema_of::<ManualPages>(),
    ]);
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

/// Why a command failed, printed with --json as the last document. Units and places as in the spec.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.failure/1")]
pub(crate) struct FailureDocument {
    /// 1: what was read is wrong or has not what is asked of it, or a file cannot be read or written; 2: the command line is wrong, whatever the files say; 3: it cannot be solved; 4: the system has not the memory that it takes.
    #[schemars(range(min = 1, max = 4))]
    pub(crate) exit_code: u8,
    /// What is wrong, or how many errors the spec has.
    pub(crate) message: String,
    /// What is wrong with the spec; empty where the reason is another one.
    pub(crate) findings: Vec<Finding>,
    /// What cannot be solved; empty where the reason is another one.
    pub(crate) not_done: Vec<NotDone>,
}

/// What became of specs that were laid out, of `flank fmt`.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.fmt/1")]
pub(crate) struct LaidOutFiles {
    /// In the order in which they were given.
    pub(crate) files: Vec<LaidOutFile>,
}

/// What became of one spec.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct LaidOutFile {
    /// As it was given; - for the standard input.
    pub(crate) file: String,
    /// Whether laying out changes it; null where it cannot be laid out.
    pub(crate) changed: Option<bool>,
    /// The text as laid out, for the standard input; null for files, which are written, and with --check.
    pub(crate) text: Option<String>,
    /// Why it cannot be laid out or written.
    pub(crate) message: Option<String>,
    /// What is wrong with it.
    pub(crate) findings: Vec<Finding>,
}

/// The schemas that the program ships, of `flank schema` without a name.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.schemas/1")]
pub(crate) struct SchemaList {
    /// By name.
    pub(crate) schemas: Vec<Schema>,
}

/// A script that completes arguments in a shell, of `flank completions`.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.completions/1")]
pub(crate) struct CompletionScript {
    /// Its name.
    pub(crate) shell: String,
    /// What it has to read.
    pub(crate) script: String,
}

/// Manual pages, of `flank man`.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.man/1")]
pub(crate) struct ManualPages {
    /// Files written, in their order.
    pub(crate) files: Vec<String>,
}
