//! What the program tells of each point.

use serde_json::Value;

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

impl Outcome {
    /// From the documents that `flank solve --format json --json` writes and prints for a job.
    pub fn new([written, printed]: &[Value; 2]) -> Outcome {
        let points = &written["surfaces"][0];
        let table = &printed["surfaces"][0];
        let units: Vec<bool> =
            points["unknowns"].as_array().expect("unknowns").iter().map(|unknown| unknown["unit"] == "deg").collect();
        let numbers = |value: &Value| -> Vec<f64> {
            let list = value.as_array();
            list.map(|list| list.iter().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect()).unwrap_or_default()
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
}
