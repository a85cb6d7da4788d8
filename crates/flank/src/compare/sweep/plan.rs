//! The folder of a study: its plan, the texts of its spec, chunks of results.
//!
//! `plan.json`, `spec/` with all texts, `chunks/HASH.csv`, `points/HASH.csv` of each case where points are kept, and `open/HASH` while a
//! chunk is worked on.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::{Compilation, Disk};
use flank_export::{Header, write_atomically};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::cases::CaseValues;
use super::inputs::StudyInput;
use crate::project::Project;
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::spec::Origin;

/// The file of a plan.
pub(super) const PLAN: &str = "plan.json";
/// The folder of its chunks.
pub(super) const CHUNKS: &str = "chunks";
/// The folder of the journals of chunks that are worked on.
pub(super) const OPEN: &str = "open";
/// The folder in which points of cases are kept.
pub(super) const POINTS: &str = "points";
/// The name of the document.
const SCHEMA: &str = "flank.sweep_plan/1";
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Characters of a hash in names and rows: 64 bits of SHA-256 tell a thousand million cases apart.
const HASH_LENGTH: usize = 16;
/// Marks the folder of the texts as that of a project.
const MARK: &str = "flank.toml";

/// All that a study is, but its results: the file `plan.json` of `flank sweep plan`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.sweep_plan/1")]
pub(crate) struct Plan {
    /// Of the program that made it.
    pub(super) version: String,
    /// The spec in the folder `spec`.
    pub(super) spec: String,
    /// Its job.
    pub(super) job: String,
    /// Values that all cases have in common.
    pub(super) set: Vec<(String, String)>,
    /// SHA-256 of all texts.
    pub(super) hash: String,
    /// What differs from case to case.
    pub(super) inputs: Vec<StudyInput>,
    /// The values of these.
    pub(super) cases: CaseValues,
    /// What becomes of each case.
    pub(super) collect: Vec<String>,
    /// The heads of the columns that are collected.
    pub(super) heads: Vec<String>,
    /// Whether the points of all samples are kept, a file for each case.
    pub(super) keep_points: bool,
    /// Seconds that a case may take.
    pub(super) limit: Option<f64>,
    /// Cases in a chunk; the last one may have fewer.
    pub(super) chunk: u64,
}

impl Plan {
    pub(super) fn new(which: &JobSelection, spec: String, hash: String) -> Plan {
        Plan {
            version: VERSION.to_string(),
            spec,
            job: which.job.clone().unwrap_or_default(),
            set: which.set.clone(),
            hash,
            inputs: Vec::new(),
            cases: CaseValues::Table(Vec::new()),
            collect: Vec::new(),
            heads: Vec::new(),
            keep_points: false,
            limit: None,
            chunk: 1,
        }
    }

    /// How many chunks there are.
    pub(super) fn chunks(&self) -> usize {
        self.cases.count().div_ceil(self.chunk) as usize
    }

    /// The numbers of the cases in a chunk.
    pub(super) fn numbers(&self, chunk: usize) -> std::ops::Range<u64> {
        let first = chunk as u64 * self.chunk;
        first..(first + self.chunk).min(self.cases.count())
    }

    pub(super) fn values(&self, number: u64) -> Vec<f64> {
        self.cases.of_case(number, &self.inputs)
    }

    /// Of program, texts, what is collected, and values by the names of the inputs: the same case has the same hash in any study.
    pub(super) fn hash_of_case(&self, values: &[f64]) -> String {
        let mut hash = Sha256::new();
        let mut told = |text: &str| {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text.as_bytes());
        };
        [&self.version, &self.hash, &self.job].into_iter().for_each(|text| told(text));
        self.set.iter().for_each(|(name, value)| {
            told(name);
            told(value);
        });
        self.collect.iter().for_each(|text| told(text));
        let mut order: Vec<usize> = (0..self.inputs.len()).collect();
        order.sort_by_key(|k| &self.inputs[*k].name);
        for k in order {
            told(&self.inputs[k].head());
            told(&values[k].to_bits().to_string());
        }
        shortened(hash)
    }

    /// The hashes of the cases in a chunk.
    pub(super) fn hashes_of_cases(&self, chunk: usize) -> Vec<String> {
        self.numbers(chunk).map(|number| self.hash_of_case(&self.values(number))).collect()
    }

    /// Of the hashes of its cases and of where they begin: rows have numbers, and the same cases may come again further below.
    pub(super) fn hash_of_chunk(&self, chunk: usize, cases: &[String]) -> String {
        let mut hash = Sha256::new();
        hash.update(self.numbers(chunk).start.to_le_bytes());
        cases.iter().for_each(|case| hash.update(case.as_bytes()));
        shortened(hash)
    }

    /// What its cases are made of.
    pub(super) fn selection(&self, folder: &Path) -> JobSelection {
        let project = Project::open(folder.join("spec").join(&self.spec), Arc::new(Disk));
        JobSelection { project, job: Some(self.job.clone()), set: self.set.clone() }
    }

    /// What files of points begin with, but for the inputs.
    pub(super) fn header(&self) -> Header {
        Header {
            program: format!("flank {}", self.version),
            spec: self.spec.clone(),
            spec_hash: format!("sha256:{}", self.hash),
            job: self.job.clone(),
            conventions: self.set.iter().map(|(name, value)| format!("set by hand: {name} = {value}")).collect(),
        }
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(self).map_err(|reason| Failure::Input(reason.to_string()))?;
        write_text(&folder.join(PLAN), &text)
    }

    /// Makes the folders for its results where they are missing: who copies a study may lose those that are empty.
    ///
    /// # Errors
    /// If one cannot be made.
    pub(super) fn make_folders(&self, folder: &Path) -> Result<(), Failure> {
        let all = [CHUNKS, OPEN].into_iter().chain(self.keep_points.then_some(POINTS));
        all.into_iter().try_for_each(|name| Ok(flank_export::make_folder(&folder.join(name))?))
    }

    /// One that this program may add rows to.
    ///
    /// # Errors
    /// If there is no study, or another program has made it.
    pub(super) fn read_own(folder: &Path) -> Result<Plan, Failure> {
        let plan = Plan::read(folder)?;
        if plan.is_own() {
            return Ok(plan);
        }
        Err(Failure::Input(format!(
            "{} was made by flank {}, this is flank {VERSION}: rows of two programs do not go into one study; make a new one",
            folder.display(),
            plan.version
        )))
    }

    /// Whether this program has made it.
    pub(super) fn is_own(&self) -> bool {
        self.version == VERSION
    }

    /// Of any version.
    ///
    /// # Errors
    /// If there is no study that this program knows.
    pub(super) fn read(folder: &Path) -> Result<Plan, Failure> {
        let path = folder.join(PLAN);
        let text = std::fs::read_to_string(&path).map_err(|reason| {
            Failure::Input(format!("{} is no study: {}: {reason}", folder.display(), path.display()))
        })?;
        let wrong = |reason: serde_json::Error| {
            Failure::Input(format!("{} is no plan of a study that this program knows: {reason}", path.display()))
        };
        let document: serde_json::Value = serde_json::from_str(&text).map_err(wrong)?;
        if document["schema"] != SCHEMA {
            let version = document["version"].as_str().unwrap_or_default();
            return Err(Failure::Input(format!(
                "{} was made by flank {version}, whose plans flank {VERSION} does not read",
                folder.display()
            )));
        }
        serde_json::from_value(document).map_err(wrong)
    }
}

fn shortened(hash: Sha256) -> String {
    let all: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    all[..HASH_LENGTH].to_string()
}

pub(super) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(write_atomically(path, |out| Ok(out.write_all(text.as_bytes())?))?)
}

/// Copies all texts of a compilation into the folder of a study, as they lie to each other; the name of the spec there, and the hash of
/// all.
pub(super) fn keep_texts(
    compilation: &Compilation<'_>,
    which: &JobSelection,
    folder: &Path,
) -> Result<(String, String), Failure> {
    let texts: Vec<(PathBuf, String)> = compilation
        .sources
        .files()
        .map(|(_, source)| (source.file.clone().unwrap_or_else(|| source.path.clone()), source.text.clone()))
        .collect();
    let common = common_folder(texts.iter().map(|(path, _)| path.as_path()));
    let inner = |path: &Path| path.strip_prefix(&common).unwrap_or(path).to_path_buf();
    let root = folder.join("spec");
    for (path, text) in &texts {
        let place = root.join(inner(path));
        flank_export::make_folder(place.parent().unwrap_or(&root))?;
        write_text(&place, text)?;
    }
    write_text(&root.join(MARK), "")?;
    // the spec may be a text in memory
    let real = which.project.files().real_path(which.file()).unwrap_or_else(|_| which.file().to_path_buf());
    let main = texts.iter().map(|(path, _)| path).find(|path| **path == real).or(texts.last().map(|(path, _)| path));
    let name = main.map_or(PathBuf::new(), |path| inner(path));
    Ok((crate::project::shown_path(&name), Origin::of_compilation(compilation).hash))
}

/// The innermost folder that all paths lie in.
fn common_folder<'p>(mut paths: impl Iterator<Item = &'p Path>) -> PathBuf {
    let folder = |path: &Path| path.parent().map_or(PathBuf::new(), Path::to_path_buf);
    let first = paths.next().map_or(PathBuf::new(), folder);
    paths.fold(first, |common, path| {
        let other = folder(path);
        let pairs = common.components().zip(other.components());
        pairs.take_while(|(a, b)| a == b).map(|(a, _)| a.as_os_str().to_os_string()).collect()
    })
}
