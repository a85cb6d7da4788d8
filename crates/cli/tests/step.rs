//! STEP files as OpenCASCADE reads them, and what `flank solve --step` says of them.

mod support;

use std::process::Command;

use serde_json::Value;
use support::{flank, folder, self_contained, text, top, written};

const PINION: [&str; 5] =
    ["functions/bevel", "machines/cradle", "tools/face_mill", "functions/blanks_19x62", "bevel/pinion_19x62"];

/// Each face against exact points that it was not made of, by a reader of others: `gmsh`, which brings OpenCASCADE. `FLANK_READERS` names
/// the Python that has it.
#[test]
fn opencascade_finds_the_exact_points_on_the_faces() {
    let out = folder("step");
    let python = std::env::var("FLANK_READERS").unwrap_or_else(|_| "python3".into());
    let has_gmsh = Command::new(&python).args(["-c", "import gmsh"]).output().is_ok_and(|run| run.status.success());
    if !has_gmsh {
        eprintln!(
            "skipped 1 of 1 readers of STEP: no `gmsh` for {python}; pip install gmsh, and FLANK_READERS names its python"
        );
        return;
    }
    let spec = self_contained(&PINION);
    let [coarse, other] = [
        written(&out, "pinion.chain", &spec),
        written(
            &out,
            "other.chain",
            &spec.replace("by 15", "by 22").replace("by 31", "by 38").replace("by 5", "by 23"),
        ),
    ];
    let folder = out.to_str().expect("a plain path");
    let run = flank(&["solve", &coarse, "--step", "--out", folder, "--no-picture", "--json"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let solved: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let points = out.join("other");
    assert!(flank(&["solve", &other, "--out", points.to_str().expect("plain"), "--no-picture"]).status.success());
    let run = Command::new(&python)
        .arg(top().join("crates/cli/tests/readers/step.py"))
        .args([out.join("pinion_19x62.step"), points.join("pinion_19x62.csv")])
        .output()
        .expect("it has just been run");
    assert!(run.status.success(), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    let surfaces: Vec<Value> = told.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(surfaces.len(), 5, "{told}");
    for (k, surface) in surfaces.iter().enumerate() {
        assert_eq!(surface["face"], k + 1, "one face for each surface: {told}");
        let distance = surface["distance"].as_f64().expect("a number");
        assert!(distance <= 1e-4, "within 0.1 um as asked for by default: {told}");
        assert!(distance > 1e-12, "the points are not those that the face was made of: {told}");
        // what is said was measured half-way between the points of the face, where a spline is off the most; these points lie elsewhere
        let said = solved["faces"][k]["deviation"].as_f64().expect("a number");
        assert!(distance < 1.2 * said && said < 3.0 * distance, "{said} mm is said of {surface}");
        // a face that is off by 0.1 um over a hundredth of a millimetre would be off by 0.01 rad
        assert!(surface["cosine"].as_f64().expect("a number") > 0.9999, "normals point out of the gear: {told}");
    }
}

#[test]
fn the_head_and_the_report_say_how_far_the_faces_are_off() {
    let out = folder("step-told");
    let folder = out.to_str().expect("a plain path");
    let spec = "specs/hobbing/helical_gear.chain";
    let run = flank(&["solve", spec, "--step=1um", "--out", folder, "--no-picture"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let file = std::fs::read_to_string(out.join("helical_gear.step")).expect("written");
    assert!(text(&run.stdout).contains("helical_gear.step"), "it is among the files");
    let told = text(&run.stderr);
    for line in told.lines().filter_map(|line| line.strip_prefix("note: STEP: ")) {
        assert!(line.contains("off by at most") && file.contains(line), "{line}");
    }
    assert_eq!(told.matches("STEP: ").count(), 2);
    // the same on the page, as data, and in the file that lies beside it
    let beside = out.join("report");
    let to = beside.to_str().expect("a plain path");
    let run = flank(&["report", spec, "--step=1um", "--json", "--out", to]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert_eq!(std::fs::read_to_string(beside.join("helical_gear.step")).expect("written"), file);
    let reported: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let page = std::fs::read_to_string(beside.join("helical_gear.report.html")).expect("written");
    for face in reported["faces"].as_array().expect("a list") {
        let off = format!("{:.2e}", 1e3 * face["deviation"].as_f64().expect("measured"));
        assert!(told.contains(&format!("off by at most {off} um")) && page.contains(&off), "{off}: {told}");
    }
    assert_eq!(reported["faces"].as_array().map(Vec::len), Some(2));
    let again = flank(&["solve", spec, "--step=1um", "--out", folder, "--no-picture"]);
    assert!(again.status.success());
    assert_eq!(std::fs::read_to_string(out.join("helical_gear.step")).expect("written"), file, "the same bytes");
}

#[test]
fn a_face_that_cannot_be_exact_enough_is_told() {
    let out = folder("step-missed");
    let folder = out.to_str().expect("a plain path");
    let spec = "specs/hobbing/helical_gear.chain";
    let run = flank(&["solve", spec, "--step=1e-10um", "--out", folder, "--no-picture"]);
    assert_eq!(run.status.code(), Some(3));
    assert!(text(&run.stderr).contains("face of `lower_flank` is not shown to be within"), "{}", text(&run.stderr));
    let rows = "rho: form_radius + 0.05 * normal_module .. tip_radius by 21";
    let row = self_contained(&[
        "machines/hobbing_6axis",
        "tools/involute",
        "tools/hob_zi",
        "functions/hobbing",
        "hobbing/helical_gear",
    ])
    .replace(rows, "rho: 50 mm");
    let row = written(&out, "row.chain", &row);
    let run = flank(&["solve", &row, "--step", "--out", folder, "--no-picture"]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(
        text(&run.stderr).contains("`lower_flank` has no face for a STEP file: no two rows"),
        "{}",
        text(&run.stderr)
    );
    assert!(!text(&run.stderr).contains("is not shown to be within"), "{}", text(&run.stderr));
    let run = flank(&["solve", spec, "--step=1", "--out", folder]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("write a length with its unit"), "{}", text(&run.stderr));
}
