//! What many surfaces and many points take: work that grows with their number alone, memory that is stated before it is asked for.

mod support;

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use support::{flank, folder, self_contained, text, top, written};

/// A job in which one rack makes so many flanks, of so many points in each direction.
fn many(surfaces: usize, points: usize) -> String {
    let mut spec = self_contained(&["machines/hobbing_6axis", "machines/rack_generating", "tools/rack"]);
    spec += "
        job many {
            machine m = rack_generating(reference_radius: 36 mm, shift: 0 mm)
            tool r = rack(module: 3 mm, half_width: 20 mm)
            mount r on m.head
            motion phi : angle in -60 deg .. 60 deg
            drive m.C = phi
    ";
    for k in 0..surfaces {
        let _ = writeln!(
            spec,
            "surface s{k} in m.table = envelope(r.flank_plus, over: phi)
             sample s{k} {{ rho: 36 mm .. 38 mm by {points}, z: -10 mm .. 10 mm by {points} }}"
        );
    }
    spec + "}"
}

/// The program with so many KiB of address space.
fn within(kibibytes: usize, arguments: &[&str]) -> Output {
    let limited = format!("ulimit -v {kibibytes} && exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_flank")]).args(arguments);
    // each thread of the pool takes room of its own
    command.env("RAYON_NUM_THREADS", "1").current_dir(top()).output().expect("a shell runs")
}

fn plain(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

/// The rotation that leaves a tool unchanged is found from the points of all its surfaces: 12,150 rows here, whose square would be 1.2 GB.
#[test]
#[cfg(target_os = "linux")]
fn the_page_of_many_surfaces_takes_memory_in_proportion() {
    let out = folder("many_surfaces");
    let spec = written(&out, "many.chain", &many(150, 2));
    let run = within(600 * 1024, &["view", &spec, "--out", plain(&out)]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}

/// In each position of the tool all surfaces are cut: the positions do not grow with them.
#[test]
fn a_section_of_many_surfaces_has_no_more_positions_of_the_tool() {
    let out = folder("many_sections");
    let shown = |surfaces: usize| {
        let spec = written(&out, "many.chain", &many(surfaces, 3));
        let run = flank(&["plot", &spec, "--what", "section", "--out", plain(&out), "--format", "svg", "--json"]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        told["pictures"][0]["shows"].as_str().expect("words").to_string()
    };
    assert_eq!(shown(4), "4 surfaces across the tooth, 12 positions of the tool");
    assert_eq!(shown(40), "40 surfaces across the tooth, 42 positions of the tool");
    let picture = std::fs::read_to_string(out.join("many.section.svg")).expect("the picture");
    assert!(picture.contains("14 of 40 surfaces"), "its caption says where the tool is drawn");
}

/// Each surface may have a million points; what all of them take together is refused before the first is solved.
#[test]
fn what_the_points_of_a_job_would_take_is_told_before_they_are_solved() {
    let out = folder("many_points");
    let spec = written(&out, "many.chain", &many(5, 1100));
    let run = flank(&["solve", &spec, "--geometry", "--out", plain(&out), "--no-picture"]);
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    for part in [
        "6050000 points, and --geometry needs something of all of them at once",
        "about 1.2 GB, and 1.1 GB is the most",
        "ask for fewer",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
}

/// A page and a report show some points of a large surface, say so, and count all of them.
#[test]
fn pages_and_reports_of_large_surfaces_say_what_they_show() {
    let out = folder("large_surface");
    let spec = written(&out, "many.chain", &many(1, 260));
    let view = flank(&["view", &spec, "--out", plain(&out)]);
    assert_eq!(view.status.code(), Some(0), "{}", text(&view.stderr));
    assert!(text(&view.stdout).contains("67600 of 67600 points"), "{}", text(&view.stdout));
    assert!(text(&view.stderr).contains("of the 67600 points that the job samples"), "{}", text(&view.stderr));
    let report = flank(&["report", &spec, "--out", plain(&out), "--format", "md"]);
    assert_eq!(report.status.code(), Some(0), "{}", text(&report.stderr));
    let report = std::fs::read_to_string(out.join("many.report.md")).expect("the report");
    assert!(report.contains("16900 of 67600 of s0 points"), "{report}");
}

/// Of each point that is described its numbers are kept, eight bytes each, and little else: 184 bytes a point, 640 before.
#[test]
#[cfg(target_os = "linux")]
fn geometry_takes_little_memory() {
    let out = folder("geometry_memory");
    let spec = written(&out, "many.chain", &many(1, 600));
    let arguments = ["solve", &spec, "--geometry", "--format", "stl", "--out", plain(&out), "--no-picture"];
    let run = within(220 * 1024, &arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}

/// Surfaces of a few points each are counted together.
#[test]
fn many_surfaces_that_are_kept_are_estimated_together() {
    let out = folder("kept_together");
    let spec = written(&out, "many.chain", &many(150, 250));
    let run = flank(&["solve", &spec, "--out", plain(&out), "--no-picture"]);
    assert_eq!(run.status.code(), Some(1));
    let told = text(&run.stderr);
    assert!(told.contains("9375000 points in many surfaces: that would take about "), "{told}");
}

/// Where the system gives no more memory, words and a code of its own, and no file.
#[test]
#[cfg(target_os = "linux")]
fn no_more_memory_is_told() {
    let out = folder("no_memory");
    let spec = written(&out, "many.chain", &many(1, 1000));
    let files = out.join("files");
    let run = within(120 * 1024, &["solve", &spec, "--out", plain(&files), "--no-picture"]);
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(4), "{told}");
    assert!(told.contains("error: out of memory: the system gave none of "), "{told}");
    assert!(!files.join("many.csv").exists());
    let run = within(120 * 1024, &["solve", &spec, "--out", plain(&files), "--no-picture", "--json"]);
    let failure: Value = serde_json::from_slice(&run.stdout).expect("a document");
    assert_eq!(
        [&failure["schema"], &failure["exit_code"]],
        [&serde_json::json!("flank.failure/1"), &serde_json::json!(4)]
    );
    assert!(failure["message"].as_str().is_some_and(|told| told.starts_with("out of memory: ")), "{failure}");
    let schema = text(&flank(&["schema", "flank.failure/1"]).stdout);
    let schema = serde_json::from_str(&schema).expect("a schema");
    assert!(jsonschema::is_valid(&schema, &failure), "{failure}");
}

/// A name that is wrong is told before anything is solved, here before it is told that there are too many points.
#[test]
fn names_of_a_conversion_are_checked_before_it_solves() {
    let out = folder("conversion_names");
    let spec = written(&out, "many.chain", &many(1, 2000));
    let to = "specs/machines/free_form.chain";
    let run = flank(&["convert", &spec, "--to", to, "--work-frame", "nowhere", "--out", plain(&out)]);
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("has no frame `nowhere`"), "{told}");
}

/// A search for lines has a budget; which lines it neither found nor excluded is said, on the terminal and in the report.
#[test]
fn lines_that_are_not_excluded_are_named() {
    let out = folder("open_lines");
    let spec = "specs/hobbing/crowned_gear_quartic.chain";
    let run = flank(&["solve", spec, "--limits", "--out", plain(&out), "--no-picture"]);
    let told = text(&run.stderr);
    let open = "note: lower_flank.singular_line is not found within the ranges, and not excluded";
    assert!(told.contains(open), "{told}");
}
