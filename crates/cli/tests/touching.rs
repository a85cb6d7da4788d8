//! What is said of a surface of which no point is found: where it lies, and which axis may move the wrong way.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text, written};

const PLANER: &str = "machine planer {
    axis Y : linear
    axis C : rotary
    frame bed
    frame ram   in bed = translate(36 mm, Y, 0 mm)
    frame table in bed = rotate_z(C)
}
tool rack {
    surface flank(u: length in -3 mm .. 3 mm, v: length in -10 mm .. 10 mm) {
        at = [u * cos(20 deg), -u * sin(20 deg), v]
        body towards [0, 1, 0]
    }
}
job gear {
    machine m = planer
    tool    r = rack
    mount r on m.ram
    motion roll : angle in -30 deg .. 30 deg
    drive m.Y = 36 mm * roll
    drive m.C = roll
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 34.5 mm .. 37.5 mm by 5, z: -5 mm .. 5 mm by 3 }
    expect all solved
    expect flank: rho near 36 mm within 1 cm
}
";

/// What `flank solve` says below the points that are not solved, and `flank test` below what fails.
fn told(folder: &Path, spec: &str) -> [String; 2] {
    let file = written(folder, "spec.chain", spec);
    let solved = flank(&["solve", &file, "--no-picture", "--out", folder.to_str().expect("a plain path")]);
    let tested = flank(&["test", &file]);
    assert_eq!([solved.status.code(), tested.status.code()], [Some(3); 2], "{}", text(&solved.stderr));
    [text(&solved.stderr), text(&tested.stdout)]
}

/// `-1.09 .. -0.91` of the ends of a range.
fn ends(a: f64, b: f64) -> String {
    format!("{:.2} .. {:.2}", a.min(b), a.max(b))
}

/// At roll 0 the normal of the rack at `u` meets the line of centres where the table would have to turn about: there the ram may move
/// 1 + u / (36 mm cos 20 deg) times as fast as the table turns.
#[test]
fn an_axis_that_moves_the_wrong_way_is_named() {
    let folder = folder("sense");
    let ratio = |u: f64| 1.0 + u / (36.0 * 20f64.to_radians().cos());
    for (law, factor, doubt) in [
        ("-roll", -1.0, "an axis may move the wrong way"),
        ("roll / 2", 0.5, "the ratio of the motions, or the place of the tool, may be wrong"),
    ] {
        let ram = ends(factor * ratio(-3.0), factor * ratio(3.0));
        let table = ends(1.0 / (factor * ratio(-3.0)), 1.0 / (factor * ratio(3.0)));
        let wanted = format!(
            "at roll = 0 deg there would be one if m.Y moved {ram} times, or m.C moved {table} times as fast as by its law: {doubt}"
        );
        let spec = PLANER.replace("drive m.C = roll", &format!("drive m.C = {law}"));
        for told in told(&folder, &spec) {
            assert!(told.contains("no contact of r.flank with the work was found within its ranges\n"), "{told}");
            assert_eq!(told.matches(&wanted).count(), 1, "{wanted} in\n{told}");
        }
    }
}

/// A hob that feeds has two equations of meshing: points are looked for with each axis moving the other way.
#[test]
fn an_axis_of_a_hob_that_moves_the_wrong_way_is_named() {
    let folder = folder("hob");
    let parts =
        ["machines/hobbing_6axis", "tools/involute", "tools/hob_zi", "functions/hobbing", "hobbing/helical_gear"];
    let spec = support::self_contained(&parts);
    let law =
        "drive m.C = -hob_hand * hob_starts / teeth * spindle - tan(helix_angle) / reference_radius * feed * 1 rad";
    assert!(spec.contains(law));
    let turned = law.replace("= -hob_hand", "= hob_hand").replace("spindle - tan", "spindle + tan");
    let named = "if m.C moved by the opposite of its law, 5 of 5 points of the sample would be found: an axis may move the wrong way";
    for told in told(&folder, &spec.replace(law, &turned)) {
        assert_eq!(told.matches(named).count(), 2, "{told}");
    }
}

/// The flank of an involute begins at its base circle.
#[test]
fn where_the_surface_lies_is_told() {
    let folder = folder("lies_elsewhere");
    let base = 36.0 * 20f64.to_radians().cos();
    for told in told(&folder, &PLANER.replace("rho: 34.5 mm .. 37.5 mm by 5", "rho: 30 mm .. 33 mm by 5")) {
        let begins = "within its ranges the surface has points at rho ";
        let (_, rest) = told.split_once(begins).unwrap_or_else(|| panic!("{told}"));
        assert!(rest.contains(" mm, the sample asks for 30.0000 .. 33.0000 mm\n"), "{told}");
        let low: f64 = rest.split_whitespace().next().and_then(|low| low.parse().ok()).expect("a number");
        assert!(low > base && low < base + 0.5, "{low} {base}");
        assert!(!told.contains("no contact"), "{told}");
    }
    // where another range of the tool would reach the points, nothing else is blamed
    for told in told(&folder, &PLANER.replace("rho: 34.5 mm .. 37.5 mm by 5", "roll: 25 deg .. 29 deg by 5")) {
        assert!(told.contains("u of r.flank from"), "{told}");
        assert!(!told.contains("no contact") && !told.contains("as fast as"), "{told}");
    }
}

/// A `body` on the wrong side is told with its line, also where some of the points lie outside of the ranges.
#[test]
fn a_body_on_the_wrong_side_is_told_with_its_line() {
    let folder = folder("body_line");
    let spec = PLANER.replace("body towards [0, 1, 0]", "body towards [0, -1, 0]");
    for sample in ["34.5 mm .. 37.5 mm by 5", "34.5 mm .. 40 mm by 5"] {
        for told in told(&folder, &spec.replace("34.5 mm .. 37.5 mm by 5", sample)) {
            let body = "the tool's `body` may lie on the wrong side, line 11 of ";
            assert!(told.contains(body) && told.contains("spec.chain: `body towards [0, -1, 0]`\n"), "{told}");
        }
    }
}

/// An expectation of many characters is shown in part; the document has all of it.
#[test]
fn long_expectations_are_shown_in_part() {
    let folder = folder("long");
    let long = "[x + 0 * sin(roll + 10 deg) * 1 mm, y + 0 * cos(roll + 20 deg) * 1 mm,\n        z + 1 mm * cos(roll) ^ 2 + 1 mm * sin(roll) ^ 2]";
    let spec = PLANER.replace("expect all solved", &format!("expect flank near {long} within 1e-9 mm"));
    let file = written(&folder, "spec.chain", &spec);
    let shown = text(&flank(&["test", &file]).stdout);
    let line = shown.lines().nth(1).expect("a line");
    assert!(line.contains("flank near [x + 0 * sin(roll") && line.ends_with("…] within 1e-9 mm"), "{line}");
    assert!(line.chars().count() < 120, "{line}");
    let document: Value = serde_json::from_slice(&flank(&["test", &file, "--json"]).stdout).expect("JSON");
    let whole = document["specs"][0]["items"][0]["expectations"][0]["expected"].as_str().expect("a text");
    assert!(whole.ends_with("sin(roll) ^ 2] within 1e-9 mm") && !whole.contains('…'), "{whole}");
}

/// A job without a sample is an error with a code and a place, as data too.
#[test]
fn a_job_that_asks_for_no_points_is_told_with_its_place() {
    let folder = folder("no_sample");
    let is_kept = |line: &&str| !line.contains("sample") && !line.contains("expect");
    let spec: String = PLANER.lines().filter(is_kept).map(|line| format!("{line}\n")).collect();
    let file = written(&folder, "spec.chain", &spec);
    for command in [&["solve"][..], &["report"], &["view"], &["measure"], &["derive", "--cost"]] {
        let run = flank(&[command, &[&file]].concat());
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(1), "{told}");
        assert!(
            told.contains("error[E0506]: job `gear` asks for no points") && told.contains("spec.chain:14:5"),
            "{told}"
        );
    }
    let document: Value = serde_json::from_slice(&flank(&["solve", &file, "--json"]).stdout).expect("JSON");
    let finding = &document["findings"][0];
    assert_eq!((&finding["code"], &finding["place"]["line"]), (&"E0506".into(), &14.into()), "{document}");
}

/// An involute turns back at its base circle: there the coordinates do not fix a single point. Nearer to the axis there is none, farther out
/// there is one, whether the tool cuts it away or not.
#[test]
fn points_where_a_surface_turns_back_are_singular() {
    let folder = folder("turns_back");
    for (radius, angle) in [(36.0, 20.0), (20.0, 25.0), (50.3, 14.5), (7.0, 30.0)] {
        let base = format!("{radius} mm * cos({angle} deg)");
        let spec = PLANER
            .replace("36 mm", &format!("{radius} mm"))
            .replace("20 deg", &format!("{angle} deg"))
            .replace("in -3 mm .. 3 mm", "in -20 mm .. 3 mm")
            .replace("in -30 deg .. 30 deg", "in -60 deg .. 30 deg")
            .replace("34.5 mm .. 37.5 mm by 5", &format!("[{base} - 1 um, {base}, {base} + 1 um, {radius} mm]"));
        let file = written(&folder, "spec.chain", &spec);
        let run = flank(&["solve", &file, "--json", "--no-picture", "--out", folder.to_str().expect("a plain path")]);
        let table: Value = serde_json::from_slice(&run.stdout).unwrap_or_else(|_| panic!("{}", text(&run.stderr)));
        let outcomes = &table["surfaces"][0]["outcomes"];
        let counts = ["not_converged", "singular"].map(|outcome| outcomes[outcome].as_u64());
        assert_eq!(counts, [Some(3); 2], "{radius} {angle}: {outcomes}");
    }
}
