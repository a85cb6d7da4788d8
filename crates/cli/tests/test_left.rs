//! `flank test`: what single edges leave over a surface is expected and kept.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use support::{folder, text, top, written};

fn tested(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.arg("test").args(arguments).current_dir(folder).env("CI", "").output().expect("the binary runs")
}

/// The planed plane of the language's page, with what it is expected to be like.
fn planed(expectations: &str) -> String {
    let page = std::fs::read_to_string(top().join("docs/language.md")).expect("the page");
    let start = page.find("machine planer {\n    axis ram").expect("the block");
    let block = page[start..].split("```").next().expect("its end");
    let end = block.rfind('}').expect("the job's end");
    format!("{}{expectations}}}\n", &block[..end])
}

/// Over a point that is `off` the middle of the nearest stroke a round tool leaves r - sqrt(r² - off²): at 0.15 mm with 8 mm
/// 1.40637 µm, the most of the places that are looked at.
#[test]
fn heights_that_edges_leave_are_expected() {
    let folder = folder("test_left");
    let ridge = "    expect highest(plane, left) near t.radius - sqrt(t.radius^2 - (0.15 mm)^2) within 0.0001 um
    expect plane: left in 0 um .. 1.41 um\n";
    written(&folder, "planed.chain", &planed(ridge));
    let run = tested(&folder, &["planed.chain"]);
    assert!(text(&run.stdout).contains("2 expectations hold"), "{}{}", text(&run.stdout), text(&run.stderr));

    let narrow = planed("    expect plane: left in 0 um .. 1.4 um\n");
    written(&folder, "planed.chain", &narrow);
    let told = text(&tested(&folder, &["planed.chain"]).stdout);
    assert!(told.contains("found: reaches 1.40637 um"), "{told}");

    // an edge of a tenth of a millimetre passes over few of the places; over the others nothing is known, and nothing holds
    written(
        &folder,
        "planed.chain",
        &planed(ridge).replace("a: angle in -60 deg .. 60 deg", "a: angle in -0.5 deg .. 0.5 deg"),
    );
    let told = text(&tested(&folder, &["planed.chain"]).stdout);
    assert!(told.contains("2 of 2 expectations failed"), "{told}");
    assert!(told.contains("have no such value: what is left is unknown at"), "{told}");
    assert!(told.contains("no edge of plane passes there within its ranges"), "{told}");
}

/// The ideal plane is the same with any nose, what its strokes leave is not.
#[test]
fn snapshots_keep_what_edges_leave() {
    let folder = folder("test_left_kept");
    let plain = planed("");
    written(&folder, "planed.chain", &plain);
    assert_eq!(tested(&folder, &["--accept"]).status.code(), Some(0));
    let run = tested(&folder, &[]);
    assert!(text(&run.stdout).contains("as in its snapshot"), "{}", text(&run.stdout));

    written(&folder, "planed.chain", &plain.replace("radius : length = 8 mm", "radius : length = 7.9 mm"));
    let run = tested(&folder, &[]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(
        told.contains("the edges of plane leave 1.42418 um over it instead of 1.40637 um, most changed at"),
        "{told}"
    );

    written(&folder, "planed.chain", &plain.replace("    cut plane by plane\n", ""));
    let told = text(&tested(&folder, &[]).stdout);
    assert!(told.contains("it is not cut by plane any more"), "{told}");
}
