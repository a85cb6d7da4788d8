//! All of a cutter's outline on all of a block: flutes that dig in away from the edge, and blocks that lie beside their pass.

use std::path::Path;

use serde_json::Value;

use super::support::{folder, written};
use super::{job, json, mill, text_of};

fn height(value: &Value) -> f64 {
    value["height_um"].as_f64().expect("a height")
}

/// Columns of a table, row by row.
fn columns(file: &Path, names: [&str; 6]) -> Vec<[f64; 6]> {
    let told = text_of(file);
    let mut rows = told.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    let at = names.map(|name| header.iter().position(|title| *title == name).expect("a column"));
    rows.map(|row| at.map(|at| row[at].parse().expect("a number"))).collect()
}

/// The lowest height above `from` at which a line enters a cylinder that stands at one of some poses: looked for in steps of 2 um, then halved.
fn entered(poses: &[[f64; 6]], [radius, length]: [f64; 2], line: &[f64; 6], from: f64) -> f64 {
    const STEP: f64 = 0.002;
    let is_within = |pose: &[f64; 6], h: f64| {
        let y = [0, 1, 2].map(|k| line[k] + h * line[3 + k] - pose[k]);
        let z = y[0] * pose[3] + y[1] * pose[4] + y[2] * pose[5];
        let square = y[0] * y[0] + y[1] * y[1] + y[2] * y[2] - z * z;
        (0.0..=length).contains(&z) && square <= radius * radius
    };
    let mut best: f64 = 0.02;
    for pose in poses {
        let near: f64 = (0..3).map(|k| (line[k] - pose[k]).powi(2)).sum();
        if near > (length + radius).powi(2) {
            continue;
        }
        let mut steps = (0..).map(|k| from + STEP * f64::from(k)).take_while(|h| *h < best + STEP);
        let Some(mut inside) = steps.find(|h| is_within(pose, *h)) else { continue };
        let mut outside = inside - STEP;
        for _ in 0..20 {
            let middle = 0.5 * (inside + outside);
            if is_within(pose, middle) { inside = middle } else { outside = middle }
        }
        best = best.min(inside);
    }
    best
}

/// A flat end mill that lies nearly along a hollow flank touches with its edge, and its flutes dig in farther on. The map is what the solid
/// cylinder leaves in very many positions, and the depth is told.
#[test]
fn flutes_that_dig_in_are_in_the_map() {
    let out = folder("mill_flutes");
    let lean = "passes profilewise: 0.45 .. 0.55 by 3\n along lengthwise: 0.2 .. 0.8 by 241\n lead 89 deg\n";
    let flat = |length: u32| {
        format!("flat_mill(radius: 0.5 mm, reach: 30 mm, cutting_length: {length} mm, holder_radius: 8 mm)")
    };
    let spec = written(&out, "milled.chain", &job("work_z: 60 mm", &flat(8), lean));
    let (code, told, errors) = mill(&spec, &out, &["--rows", "3", "--columns", "9", "--json"]);
    assert!(code == 3 && errors.contains("away from where the cutter touches"), "{code} {errors}");
    let found: Value = serde_json::from_str(&told).expect("JSON");
    let heights = found["map"]["heights_um"].as_array().expect("heights");
    let positions = columns(&out.join("milled.part.csv"), ["tip_x", "tip_y", "tip_z", "axis_x", "axis_y", "axis_z"]);
    // twenty between two, straight: within 0.1 mm that is off by 0.01 um
    let between = |pair: &[[f64; 6]]| {
        let (from, to) = (pair[0], pair[1]);
        (0..20).map(move |k| [0, 1, 2, 3, 4, 5].map(|i| from[i] + 0.05 * f64::from(k) * (to[i] - from[i])))
    };
    let of_pass = |pass: &[[f64; 6]]| pass.windows(2).flat_map(between).chain([pass[240]]).collect::<Vec<_>>();
    let poses: Vec<[f64; 6]> = positions.chunks(241).flat_map(of_pass).collect();
    let lines = columns(&out.join("milled.part.left.csv"), ["x", "y", "z", "nx", "ny", "nz"]);
    assert_eq!([positions.len(), lines.len(), heights.len()], [3 * 241, 27, 27]);
    let mut deepest: f64 = 0.0;
    for (line, left) in lines.iter().zip(heights) {
        let brute = 1e3 * entered(&poses, [0.5, 8.0], line, -0.3);
        let left = left.as_f64().expect("a height");
        // poses are 0.005 mm apart, and the upper end of the flutes comes out of the surface at a slope of 10 % at the most
        assert!((left - brute).abs() < 0.6, "{left} {brute} um at {line:?}");
        deepest = deepest.min(brute);
    }
    assert!(deepest < -10.0, "{deepest} um");
    // short flutes do not
    let spec = written(&out, "short.chain", &job("work_z: 60 mm", &flat(2), lean));
    let found = json(&spec, &out, &["--rows", "3", "--columns", "9"]);
    assert!(height(&found["map"]["left"][1]) > -1e-6, "{found}");
}

/// Where the spindle leans, coarse blocks lie beside their pass within the surface, and are deepest beside it: the plan is as deep as what the
/// program leaves.
#[test]
fn coarse_blocks_are_as_deep_as_planned() {
    let out = folder("mill_coarse");
    let milling = "passes profilewise: 0.5 .. 0.6 by 15\n along lengthwise: 0 .. 0.9 by 6\n lead 5 deg\n tilt 40 deg\n";
    let spec = written(&out, "milled.chain", &job("work_z: 60 mm", super::BALL, milling));
    let planned = json(&spec, &out, &["--nc", "linuxcnc"]);
    let program = out.join("milled.part.ngc");
    let map = ["--rows", "61", "--columns", "51", "--verify", program.to_str().unwrap()];
    let (_, told, errors) = mill(&spec, &out, &[&map[..], &["--json"]].concat());
    assert!(!errors.contains("no deeper than"), "{errors}");
    let read: Value = serde_json::from_str(&told).expect("JSON");
    let (deep, measured) = (height(&planned["blocks"][1]), height(&read["verified"]["left"][1]));
    // half of the last decimal on each of five axes; the work is some 200 mm from the rotary ones
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    assert!(deep < -5.0 && measured > deep - rounding, "{deep} {measured} um");
    // the map has a point within a 50th of a block of its middle, and a fourth of a step beside what is deepest
    assert!(measured < 0.9 * deep, "{deep} {measured} um");
}
