//! Measured grids of a pinion's flanks, and fits to them.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{flank, folder, text, written};

pub const PINION: &str = "specs/bevel/pinion_19x62.chain";
pub const CHANGED: [(&str, &str, f64); 3] = [
    ("m.radial_distance", "98.05 mm", 98.05),
    ("m.work_offset", "0.1 mm", 0.1),
    ("m.machine_root_angle", "15.74 deg", 15.74),
];

/// The grid of both flanks of a pinion with other settings, as a machine would measure it.
pub fn gauged(name: &str) -> PathBuf {
    let out = folder(name);
    let set: Vec<String> = CHANGED.iter().map(|(name, value, _)| format!("{name}={value}")).collect();
    let mut arguments =
        vec!["measure", PINION, "--surface", "concave,convex", "--out", out.to_str().expect("a plain path")];
    set.iter().for_each(|value| arguments.extend(["--set", value]));
    assert_eq!(flank(&arguments).status.code(), Some(0));
    out.join("pinion_19x62.grid.csv")
}

pub fn fit(code: i32, arguments: &[&str]) -> (Value, String) {
    let run = flank(&[&["fit"], arguments, &["--json"]].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(code), "{arguments:?}: {told}");
    (serde_json::from_slice(&run.stdout).expect("JSON"), told)
}

pub fn path(of: &Path) -> &str {
    of.to_str().expect("a plain path")
}

/// The lines of the concave flank's grid, each changed: row, column, position, normal.
pub fn rewritten(file: &Path, name: &str, line: impl Fn([usize; 2], [f64; 3], [f64; 3]) -> Option<String>) -> String {
    let content = std::fs::read_to_string(file).expect("written");
    let mut out = "row,column,x,y,z\n".to_string();
    for one in content.lines().filter(|line| line.starts_with("concave,")) {
        let cells: Vec<&str> = one.split(',').collect();
        let number = |k: usize| cells[k].parse::<f64>().expect("a number");
        let place = [3, 4].map(|k: usize| cells[k].parse::<usize>().expect("an index"));
        if cells[2] == "grid" {
            out += &line(place, [5, 6, 7].map(number), [8, 9, 10].map(number)).unwrap_or_default();
        }
    }
    written(file.parent().expect("a folder"), name, &out)
}

pub fn plain([row, column]: [usize; 2], [x, y, z]: [f64; 3]) -> Option<String> {
    Some(format!("{row},{column},{x:?},{y:?},{z:?}\n"))
}

pub fn number(of: &Value) -> f64 {
    of.as_f64().expect("a number")
}

pub fn names(of: &Value) -> Vec<&str> {
    of.as_array().expect("settings").iter().map(|of| of["name"].as_str().expect("a name")).collect()
}

pub const VARIED: &str = "radial_distance,m.machine_root_angle,work_offset";
