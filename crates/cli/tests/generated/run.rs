//! The program on a spec, and what it tells of each point.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use crate::pose::Vector;

/// A point that was asked for.
#[derive(Clone, Debug)]
pub struct Point {
    pub row: usize,
    pub column: usize,
    pub status: String,
    pub position: Option<Vector>,
    /// mm or radians, where they are told.
    pub unknowns: Vec<f64>,
}

/// What a job gave.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub points: Vec<Point>,
    /// Whether it is told that there are, or may be, other branches than that of its points.
    pub tells_of_branches: bool,
    /// Whether it is told that the tool was not looked at in all its positions.
    pub tells_of_positions: bool,
}

impl Point {
    pub fn is_solved(&self) -> bool {
        self.status == "solved"
    }
}

/// A folder for specs and what is written, with the table that some of them read.
pub fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder for the test");
    std::fs::write(folder.path().join("flank.toml"), "").expect("the test's file");
    let rows: String = (-10..=10).map(|k| format!("{},{}\n", 50 * k, 5 * k)).collect();
    std::fs::write(folder.path().join("rows.csv"), format!("height [mm],row\n{rows}")).expect("the test's file");
    folder
}

/// Solves the jobs of a spec; `Err` is what the program says of a spec that it does not take.
pub fn solved(folder: &Path, spec: &str, jobs: &[&str]) -> Result<Vec<Outcome>, String> {
    std::fs::write(folder.join("case.chain"), spec).expect("the test's file");
    let program = std::env::var("FLANK_GENERATED_PROGRAM").unwrap_or_else(|_| env!("CARGO_BIN_EXE_flank").to_owned());
    let run = Command::new(program)
        .args(["solve", "case.chain", "--json", "--format", "json", "--no-picture", "--out", "."])
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(folder)
        .output()
        .expect("the program runs");
    let told = String::from_utf8_lossy(&run.stderr).into_owned();
    if !matches!(run.status.code(), Some(0 | 3)) {
        return Err(told);
    }
    let mut documents = serde_json::Deserializer::from_slice(&run.stdout).into_iter::<Value>();
    let outcome = |job: &&str| {
        let document = documents.next().expect("a document for each job").expect("JSON");
        let file = std::fs::read(folder.join(format!("{job}.json"))).expect("the job's points");
        let file: Value = serde_json::from_slice(&file).expect("JSON");
        outcome(&file["surfaces"][0], &document["surfaces"][0])
    };
    Ok(jobs.iter().map(outcome).collect())
}

fn outcome(points: &Value, table: &Value) -> Outcome {
    let units: Vec<bool> =
        points["unknowns"].as_array().expect("unknowns").iter().map(|unknown| unknown["unit"] == "deg").collect();
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().map(|list| list.iter().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect()).unwrap_or_default()
    };
    let point = |point: &Value| {
        let unknowns = numbers(&point["unknowns"]);
        Point {
            row: point["i"].as_u64().expect("a row") as usize,
            column: point["j"].as_u64().expect("a column") as usize,
            status: point["status"].as_str().expect("a status").to_owned(),
            position: <[f64; 3]>::try_from(numbers(&point["position"])).ok(),
            unknowns: unknowns.iter().zip(&units).map(|(x, deg)| if *deg { x.to_radians() } else { *x }).collect(),
        }
    };
    let holds_some = |list: &Value| list.as_array().is_some_and(|list| !list.is_empty());
    let branches = &table["branches"];
    Outcome {
        points: points["points"].as_array().expect("points").iter().map(point).collect(),
        tells_of_branches: holds_some(&branches["undecided"]) || holds_some(&branches["elsewhere"]),
        tells_of_positions: table["positions"]["not_looked_at"].is_string(),
    }
}
