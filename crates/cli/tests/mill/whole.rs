//! All of a block: one that lies beside its pass.

use serde_json::Value;

use super::support::{folder, written};
use super::{job, json, mill};

fn height(value: &Value) -> f64 {
    value["height_um"].as_f64().expect("a height")
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
