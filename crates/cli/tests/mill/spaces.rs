//! Programs read back in all spaces of the work: a block that is too deep in any of them, with its depth between the points of the map, and passes
//! and spaces that are missing.

use std::path::Path;

use serde_json::Value;

use super::special::{BALL, spur};
use super::support::{folder, written};
use super::{json, mill, sound, text_of};

/// Which milling of a work with 19 teeth.
const TEETH: f64 = 19.0;
/// Half of the last decimal of three words of the tip, with what five decimals of degrees move, um.
const ROUNDED: f64 = 0.15;

/// Exit code, document, and what was told.
fn verified(spec: &str, out: &Path, text: &str, arguments: &[&str]) -> (i32, Value, String) {
    let file = written(out, "changed.mpf", text);
    let (code, told, errors) = mill(spec, out, &[&["--tcp", "--verify", &file, "--json"], arguments].concat());
    (code, serde_json::from_str(&told).unwrap_or_else(|_| panic!("JSON, not {errors}")), errors)
}

/// Lines from where a remark says so to where another does.
fn without(lines: &[String], from: &str, to: &str) -> String {
    let at =
        |what: &str| lines.iter().position(|line| line.trim_end().ends_with(what)).unwrap_or_else(|| panic!("{what}"));
    [&lines[..at(from)], &lines[at(to)..]].concat().join("\n")
}

/// Tip and normal at a position of the plan.
fn position(table: &str, pass: usize, position: usize) -> [[f64; 3]; 2] {
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = rows.next().expect("a header").split(',').collect();
    let row: Vec<f64> = rows
        .nth((pass - 1) * 9 + position - 1)
        .expect("a row")
        .split(',')
        .map(|x| x.parse().expect("a number"))
        .collect();
    let column = |name: &str| row[titles.iter().position(|title| *title == name).expect("a column")];
    [["tip_x", "tip_y", "tip_z"], ["nx", "ny", "nz"]].map(|names| names.map(column))
}

#[test]
fn all_spaces_of_a_program_are_measured() {
    let out = folder("mill_spaces");
    let spec = written(&out, "milled.chain", &sound());
    let (code, _, errors) = mill(&spec, &out, &["--tcp", "--nc", "siemens", "--spaces", "19", "--spindle", "9000"]);
    assert_eq!(code, 0, "{errors}");
    let lines: Vec<String> = text_of(&out.join("milled.part.mpf")).lines().map(str::to_string).collect();
    let (code, found, errors) = verified(&spec, &out, &lines.join("\n"), &[]);
    assert_eq!(code, 0, "{errors}");
    assert_eq!(found["verified"]["spaces"].as_array().map(Vec::len), Some(19), "{}", found["verified"]);

    // one position of space 8 lies deeper along the normal: the ball is there as deep as that, wherever points of the map lie
    let table = text_of(&out.join("milled.part.csv"));
    let [tip, normal] = position(&table, 4, 5);
    let (s, c) = (std::f64::consts::TAU * 7.0 / TEETH).sin_cos();
    let turned = |[x, y, z]: [f64; 3]| [c * x - s * y, s * x + c * y, z];
    let words = |by: f64| {
        let at = turned([0, 1, 2].map(|k| tip[k] - by * normal[k]));
        format!("X{:.4} Y{:.4} Z{:.4}", at[0], at[1], at[2])
    };
    let place = lines.iter().position(|line| line.contains(&words(0.0))).expect("the position is in the program");
    for deep in [0.0173, 0.0058] {
        let mut changed = lines.clone();
        changed[place] = changed[place].replace(&words(0.0), &words(deep));
        let (code, found, errors) = verified(&spec, &out, &changed.join("\n"), &[]);
        assert_eq!(code, 3, "{errors}");
        let least = &found["verified"]["left"][1];
        let depth = -least["height_um"].as_f64().expect("a height");
        assert!((depth - 1e3 * deep).abs() < ROUNDED, "{depth} um for {deep} mm");
        assert!(least["place"].as_str().expect("words").ends_with(" of space 8"), "{least}");
        // both blocks are as deep where they meet
        let of_line = |line: usize| errors.contains(&format!("line {line} of "));
        assert!(of_line(place + 1) || of_line(place + 2), "{errors}");
    }
}

#[test]
fn passes_and_spaces_that_are_missing_are_told() {
    let out = folder("mill_missing");
    let spec = written(&out, "milled.chain", &sound());
    let (code, _, errors) = mill(&spec, &out, &["--tcp", "--nc", "siemens", "--spaces", "19", "--spindle", "9000"]);
    assert_eq!(code, 0, "{errors}");
    let lines: Vec<String> = text_of(&out.join("milled.part.mpf")).lines().map(str::to_string).collect();
    let cases = [
        ("space 5 pass 3", "space 5 pass 4", "has no pass 3 of space 5"),
        ("space 1 pass 9", "space 2 pass 1", "has no pass 9:"),
        ("space 6 pass 1", "space 7 pass 1", "does not mill concave of space 6"),
        ("space 1 pass 1", "space 3 pass 1", "does not mill concave of spaces 1, 2"),
    ];
    for (from, to, part) in cases {
        let (code, _, errors) = verified(&spec, &out, &without(&lines, from, to), &[]);
        assert!(code == 3 && errors.contains(part), "{part}: {code} {errors}");
    }
    // the last ones, whether they are asked for by their number or by the work
    let fewer = without(&lines, "space 18 pass 1", "M09");
    for arguments in [&[][..], &["--spaces", "19"]] {
        let (code, _, errors) = verified(&spec, &out, &fewer, arguments);
        assert!(code == 3 && errors.contains("does not mill concave of spaces 18, 19"), "{errors}");
    }
    let (code, _, errors) = verified(&spec, &out, &fewer, &["--spaces", "17"]);
    assert_eq!(code, 0, "{errors}");
}

/// Files that are no programs.
#[test]
fn what_is_no_program_is_told() {
    let out = folder("mill_no_program");
    let spec = written(&out, "milled.chain", &sound());
    mill(&spec, &out, &[]);
    let csv = out.join("milled.part.csv");
    let binary = out.join("binary.nc");
    std::fs::write(&binary, [0_u8, 159, 146, 150, 3, 0, 7, 1, 2]).expect("it is written");
    for (file, part) in [(&csv, "no line of it has a G or M word"), (&binary, "it is no text")] {
        let (code, _, errors) = mill(&spec, &out, &["--verify", file.to_str().expect("a plain path")]);
        assert!(code == 1 && errors.contains("is no NC program: ") && errors.contains(part), "{code} {errors}");
    }
}

/// What a program with other passes than those of the plan leaves at the most is the highest of its own cusps, which its plan has solved, and not
/// what it leaves at some points.
#[test]
fn the_highest_ridge_of_any_program_is_solved() {
    let out = folder("mill_ridges");
    let of = |passes: &str| spur(BALL, "lead 0 deg\n tilt 75 deg").replace("by 13", passes);
    let other = written(&out, "milled.chain", &of("by 10"));
    let planned = json(&other, &out, &["--tcp", "--nc", "siemens"]);
    let text = text_of(&out.join("milled.part.mpf"));
    let cusp = planned["cusp"]["height_um"].as_f64().expect("passes leave cusps");
    for passes in ["by 13", "by 10"] {
        let spec = written(&out, "milled.chain", &of(passes));
        let (_, found, _) = verified(&spec, &out, &text, &[]);
        let most = found["verified"]["left"][0]["height_um"].as_f64().expect("it leaves something");
        assert!((most - cusp).abs() < ROUNDED, "{passes}: {most} {cusp}");
        let at_points = found["verified"]["heights_um"].as_array().expect("a map");
        let at_points = at_points.iter().filter_map(Value::as_f64).fold(f64::NEG_INFINITY, f64::max);
        assert!(at_points < cusp - 2.0 * ROUNDED, "{passes}: {at_points} {cusp}");
    }
}
