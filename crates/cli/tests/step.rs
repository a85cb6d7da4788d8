//! STEP files as OpenCASCADE reads them, and what `flank solve --step` says of them.

mod support;

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;
use support::{flank, folder, self_contained, text, top, written};

const PINION: [&str; 5] =
    ["functions/bevel", "machines/cradle", "tools/face_mill", "functions/blanks_19x62", "bevel/pinion_19x62"];

/// The Python that `FLANK_READERS` names, where it has `gmsh`, which brings OpenCASCADE; where it has not, the test says that it is skipped.
fn reader() -> Option<String> {
    python_with("gmsh", "gmsh")
}

/// The same with a module of a package.
fn python_with(module: &str, package: &str) -> Option<String> {
    let python = std::env::var("FLANK_READERS").unwrap_or_else(|_| "python3".into());
    let import = format!("import {module}");
    let has_it = Command::new(&python).args(["-c", &import]).output().is_ok_and(|run| run.status.success());
    if !has_it {
        eprintln!(
            "skipped 1 reader of STEP: no `{module}` for {python}; pip install {package}, and FLANK_READERS names its python"
        );
    }
    has_it.then_some(python)
}

/// What a script of `readers` says of files.
fn read_by(python: &str, script: &str, files: &[PathBuf]) -> String {
    let script = top().join("crates/cli/tests/readers").join(script);
    let run = Command::new(python).arg(script).args(files).output().expect("it has just been run");
    assert!(run.status.success(), "{}", text(&run.stderr));
    text(&run.stdout).to_string()
}

/// Each face against exact points that it was not made of, by a reader of others.
#[test]
fn opencascade_finds_the_exact_points_on_the_faces() {
    let out = folder("step");
    let Some(python) = reader() else { return };
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
    let told = read_by(&python, "step.py", &[out.join("pinion_19x62.step"), points.join("pinion_19x62.csv")]);
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

/// One solid without open edges, with the volume and the centre that flank says, and the sampled points on its faces.
#[test]
fn opencascade_finds_one_closed_body() {
    let out = folder("step-body");
    let Some(python) = reader() else { return };
    let to = out.to_str().expect("a plain path");
    // a bore makes a body of genus 1, for which vertices less edges plus faces are 0
    for name in ["pinion_19x62", "gear_19x62"] {
        let spec = &format!("specs/bevel/{name}.chain");
        let run = flank(&["solve", spec, "--solid", "gear", "--step", "--out", to, "--json"]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let built: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let body = &built["solids"][0];
        assert!(body["step_deviation_mm"].as_f64().expect("measured") <= 1e-4, "{body}");
        assert!(flank(&["solve", spec, "--out", to, "--no-picture"]).status.success());
        let told = read_by(&python, "solid.py", &[out.join(format!("{name}.step")), out.join(format!("{name}.csv"))]);
        let found: Value = serde_json::from_str(&told).expect("JSON");
        let count = |key: &str| found[key].as_i64().expect("a count");
        assert_eq!((count("solids"), count("shapes"), count("open_edges")), (1, 1, 0), "{found}");
        assert_eq!(count("vertices") - count("edges") + count("faces"), 0, "{found}");
        let teeth = body["teeth"].as_i64().expect("a number");
        // of each tooth the tip and five faces of the space; front, bore and back
        assert_eq!(count("faces"), 6 * teeth + 3, "{found}");
        let volume = |of: &Value, key: &str| of[key].as_f64().expect("a number");
        // OpenCASCADE itself integrates to some 1e-7, over finer splines worse
        let off = volume(&found, "volume") / volume(body, "volume_mm3") - 1.0;
        assert!(off.abs() < 3e-7, "{off:e}: {found}");
        for k in 0..3 {
            let [exact, found] = [&body["centre_mm"][k], &found["centre"][k]].map(|x| x.as_f64().expect("a number"));
            assert!((found - exact).abs() < 1e-5, "{found} {exact}");
        }
        assert!(count("points") > 1000 && volume(&found, "distance") < 1e-4, "{found}");
    }
}

/// Racks, and one tooth and one space of straight, helical and spiral ones: each is one solid without open edges, as
/// large as flank says. All teeth of a gear are alike, and so are all spaces: each part has its share of the volume.
#[test]
fn opencascade_finds_one_closed_body_of_each_part() {
    let out = folder("step-parts");
    let Some(python) = reader() else { return };
    let to = out.to_str().expect("a plain path");
    let parts = ["gear", "tooth", "space"];
    let bodies = ["rack_body", "helical_rack_body", "spur_gear_body", "helical_gear_body"];
    let bodies = bodies.into_iter().flat_map(|name| parts.map(|part| ("bodies", name, part)));
    let bevel = ["tooth", "space"].map(|part| ("bevel", "pinion_19x62", part));
    for (folder, name, part) in bodies.chain(bevel) {
        let spec = &format!("specs/{folder}/{name}.chain");
        let run = flank(&["solve", spec, "--solid", part, "--step", "--out", to, "--json"]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let built: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let body = &built["solids"][0];
        let told = read_by(&python, "solid.py", &[out.join(format!("{name}.step"))]);
        let found: Value = serde_json::from_str(&told).expect("JSON");
        let count = |key: &str| found[key].as_i64().expect("a count");
        assert_eq!((count("solids"), count("shapes"), count("open_edges")), (1, 1, 0), "{name} {part}: {found}");
        let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
        let share = if part == "gear" { 1.0 } else { number(body, "teeth") };
        let off = number(&found, "volume") * share / number(body, "volume_mm3") - 1.0;
        // OpenCASCADE itself integrates to some 1e-7
        assert!(off.abs() < 3e-7, "{name} {part} {off:e}: {found}");
    }
}

/// The kernel's own checks, without healing: all of it is valid, and no edge is shorter than 1e-4 mm. As it reads a body it takes for each
/// edge and vertex the tolerance within which the faces beside it meet there: as good as the faces are, and 1e-6 mm for files as fine as a nanometre.
#[test]
fn opencascade_finds_nothing_to_heal() {
    let out = folder("step-strict");
    let Some(python) = python_with("OCP", "cadquery-ocp") else { return };
    let to = out.to_str().expect("a plain path");
    let bodies = [
        ("bevel/pinion_19x62", "gear", "0.1um", 1e-4),
        ("bevel/pinion_19x62", "tooth", "0.001um", 1e-6),
        ("bodies/helical_gear_body", "gear", "0.001um", 1e-6),
        ("bodies/helical_rack_body", "gear", "0.001um", 1e-6),
    ];
    for (name, part, step, tolerance) in bodies {
        let run = flank(&[
            "solve",
            &format!("specs/{name}.chain"),
            "--solid",
            part,
            &format!("--step={step}"),
            "--out",
            to,
            "--json",
        ]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let built: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let job = name.split('/').next_back().expect("a name");
        let told = read_by(&python, "strict.py", &[out.join(format!("{job}.step"))]);
        let found: Value = serde_json::from_str(&told).expect("JSON");
        let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
        assert!(found["valid"] == true && found["solids"] == 1, "{name} {part}: {found}");
        assert!(number(&found, "tolerance") <= tolerance, "{name} {part} {step}: {found}");
        assert!(number(&found, "shortest") > 1e-4, "{name} {part}: {found}");
        let body = &built["solids"][0];
        let share = if part == "gear" { 1.0 } else { number(body, "teeth") };
        let off = number(&found, "volume") * share / number(body, "volume_mm3") - 1.0;
        // OpenCASCADE itself integrates to some 1e-7
        assert!(off.abs() < 3e-7, "{name} {part} {off:e}: {found}");
    }
}

/// Ends of a blank that are spheres, parts of tori, also of such as cross their axis, and the sides of these: as large as flank says.
#[test]
fn opencascade_finds_the_arcs_of_a_blank() {
    let out = folder("step-arcs");
    let to = out.to_str().expect("a plain path");
    let line = "front = line(from: [front, tip_radius], to: [front, reference_radius / 2])";
    let bore = "from: [front, reference_radius / 2]";
    let whole = self_contained(&[
        "machines/hobbing_6axis",
        "machines/rack_generating",
        "tools/rack",
        "hobbing/spur_gear",
        "bodies/spur_gear_body",
    ]);
    assert!(whole.contains(line));
    // where the arc ends along the axis, and its radius: the tip is at 39.6 mm from the axis and 10 mm before the middle, the bore at 18 mm
    let arcs = [
        ("30 mm - sqrt(hypot(39.6 mm, 40 mm)^2 - (18 mm)^2)", "hypot(39.6 mm, 40 mm)", "SPHERICAL_SURFACE", "gear"),
        ("front", "20 mm", "=TOROIDAL_SURFACE", "gear"),
        ("front", "-20 mm", "=TOROIDAL_SURFACE", "gear"),
        ("front", "-20 mm", "=TOROIDAL_SURFACE", "tooth"),
        ("front", "60 mm", "DEGENERATE_TOROIDAL_SURFACE", "gear"),
        ("front", "60 mm", "DEGENERATE_TOROIDAL_SURFACE", "space"),
        ("7.5 mm", "-60 mm", "DEGENERATE_TOROIDAL_SURFACE", "gear"),
    ];
    let python = reader();
    for (k, (end, radius, kind, part)) in arcs.into_iter().enumerate() {
        let arc =
            format!("front = arc(from: [front, tip_radius], to: [{end}, reference_radius / 2], radius: {radius})");
        let spec = whole.replace(line, &arc).replace(bore, &format!("from: [{end}, reference_radius / 2]"));
        let spec = written(&out, &format!("arc{k}.chain"), &spec);
        let run = flank(&["solve", &spec, "--solid", part, "--step", "--out", to, "--json"]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let built: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let file = out.join("spur_gear_body.step");
        let written = std::fs::read_to_string(&file).expect("written");
        assert!(written.contains(kind), "{radius}: a {kind}");
        let Some(python) = &python else { continue };
        let run = Command::new(python)
            .args([top().join("crates/cli/tests/readers/solid.py"), file])
            .output()
            .expect("it has just been run");
        assert!(run.status.success(), "{}", text(&run.stderr));
        let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let count = |key: &str| found[key].as_i64().expect("a count");
        assert_eq!((count("solids"), count("shapes"), count("open_edges")), (1, 1, 0), "{end} {radius}: {found}");
        let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
        let body = &built["solids"][0];
        let share = if part == "gear" { 1.0 } else { number(body, "teeth") };
        let off = number(&found, "volume") * share / number(body, "volume_mm3") - 1.0;
        // OpenCASCADE itself integrates to some 1e-7
        assert!(off.abs() < 3e-7, "{end} {radius} {part} {off:e}: {found}");
    }
}

/// A blank that goes as far as its axis: no face and no circle there, and one solid of genus 0, as large as flank says.
#[test]
fn opencascade_finds_one_closed_body_without_a_bore() {
    let out = folder("step-shaft");
    let to = out.to_str().expect("a plain path");
    let whole = self_contained(&[
        "machines/hobbing_6axis",
        "machines/rack_generating",
        "tools/rack",
        "hobbing/spur_gear",
        "bodies/spur_gear_body",
    ]);
    let spec = written(&out, "shaft.chain", &whole.replace("reference_radius / 2]", "0 mm]"));
    let python = reader();
    for (part, share) in [("gear", 1.0), ("tooth", 24.0), ("space", 24.0)] {
        let run = flank(&["solve", &spec, "--solid", part, "--step", "--out", to, "--json"]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let built: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let file = out.join("spur_gear_body.step");
        let written = std::fs::read_to_string(&file).expect("written");
        let is_empty = |line: &str| {
            ["CIRCLE(", "CYLINDRICAL_SURFACE("].iter().any(|kind| line.contains(kind)) && line.contains(",0.)")
        };
        assert!(!written.lines().any(is_empty), "{part}: no radius of nothing");
        let Some(python) = &python else { continue };
        let run = Command::new(python)
            .args([top().join("crates/cli/tests/readers/solid.py"), file])
            .output()
            .expect("it has just been run");
        assert!(run.status.success(), "{}", text(&run.stderr));
        let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let count = |key: &str| found[key].as_i64().expect("a count");
        assert_eq!((count("solids"), count("shapes"), count("open_edges")), (1, 1, 0), "{part}: {found}");
        assert_eq!(count("vertices") - count("edges") + count("faces"), 2, "{part}: {found}");
        let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
        let off = number(&found, "volume") * share / number(&built["solids"][0], "volume_mm3") - 1.0;
        // OpenCASCADE itself integrates to some 1e-7
        assert!(off.abs() < 3e-7, "{part} {off:e}: {found}");
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

/// A body whose faces are too far off, or of which only a part is asked for, leaves no STEP file.
#[test]
fn no_step_file_of_a_body_is_less_than_was_asked_for() {
    let out = folder("step-body-refused");
    let to = out.to_str().expect("a plain path");
    let spec = "specs/bevel/pinion_19x62.chain";
    let run = flank(&["solve", spec, "--solid", "gear", "--step=1e-9um", "--out", to]);
    assert_eq!(run.status.code(), Some(3));
    assert!(text(&run.stderr).contains("no STEP file of it is written"), "{}", text(&run.stderr));
    assert!(!out.join("pinion_19x62.step").exists());
}
