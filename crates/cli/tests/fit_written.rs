//! What `flank fit` writes is read again.

mod support;

use support::{flank, folder, text, top};

/// A crowning is 1 over a length, which the language has no unit for.
#[test]
fn a_curvature_is_written_as_the_language_reads_it() {
    let folder = folder("fit_curvature");
    let out = folder.to_str().expect("a plain path");
    let spec = "specs/hobbing/crowned_gear.chain";
    let run = flank(&["measure", spec, "--set", "crowning=30um", "--out", out]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let measured = folder.join("crowned_gear.grid.csv");
    let measured = measured.to_str().expect("a plain path");
    let written = top().join("specs/hobbing/not_written.chain");
    let written = written.to_str().expect("a plain path");
    let asked = ["upper_flank", "--measured", measured, "--vary", "m.crowning", "--write", written, "--dry"];
    let run = flank(&[&["fit", spec], &asked[..]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("m.crowning: -0.00003"), "{}", text(&run.stdout));
    // 30 um over the square of a length of mm are some 1e-5 1/mm, of which four digits are told
    let told = text(&run.stdout);
    let row = told.lines().rfind(|line| line.trim_start().starts_with("m.crowning  ")).expect("a row");
    let digits = |word: &str| word.trim_start_matches(['-', '0', '.']).chars().filter(char::is_ascii_digit).count();
    assert!(row.split_whitespace().skip(1).take(3).any(|word| digits(word) >= 4), "{row}");
}

/// A step, a scatter and a range of a curvature, as results show its unit, as the language writes it, and as one over another unit.
#[test]
fn a_curvature_is_read_with_its_unit() {
    let spec = "specs/hobbing/crowned_gear.chain";
    let tolerance = |amount: &str| {
        let run = flank(&["tolerance", spec, "upper_flank", "--json", "--scatter", &format!("m.crowning={amount}")]);
        assert_eq!(run.status.code(), Some(0), "{amount}: {}", text(&run.stderr));
        let read: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
        let results = read["results"].as_array().expect("results").iter();
        results.map(|of| of["standard_deviation"].as_f64().expect("a number")).collect::<Vec<f64>>()
    };
    let known = tolerance("2e-6 1/mm");
    assert!(known.iter().any(|of| *of > 0.0), "{known:?}");
    for same in ["2e-6/mm", "2e-6 mm^-1", "2e-5/cm", "5.08e-5 1/inch"] {
        for (a, b) in tolerance(same).iter().zip(&known) {
            // the unit's size is rounded, and so is each number that is told
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{same}: {a} {b}");
        }
    }
    let run = flank(&["tolerance", spec, "upper_flank", "--scatter", "m.crowning=2um"]);
    assert_eq!(run.status.code(), Some(1), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("an amount in 1/mm above zero"), "{}", text(&run.stderr));

    let folder = folder("fit_curvature_read");
    let out = folder.to_str().expect("a plain path");
    for (name, cases) in [
        ("ranges", ["--vary", "m.crowning=-1e-4 1/mm..-5e-5/mm by 2"]),
        ("language", ["--vary", "m.crowning=-1e-4 mm^-1..-5e-5 mm^-1 by 2"]),
        ("scatter", ["--scatter", "m.crowning=normal(2e-6 1/mm)"]),
    ] {
        let study = format!("{out}/{name}");
        let count: &[&str] = if name == "scatter" { &["--count", "2"] } else { &[] };
        let asked = ["sweep", spec, "--collect", "points", "--out", &study];
        let run = flank(&[&asked[..], &cases, count].concat());
        assert_eq!(run.status.code(), Some(0), "{name}: {}", text(&run.stderr));
    }

    let run = flank(&["measure", spec, "--set", "crowning=30um", "--out", out]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let measured = format!("{out}/crowned_gear.grid.csv");
    let asked = ["fit", spec, "upper_flank", "--measured", &measured, "--vary", "m.crowning", "--within", "10um"];
    let rounded = |step: &str| {
        let run = flank(&[&asked[..], &["--json", "--round", &format!("m.crowning={step}")]].concat());
        assert_eq!(run.status.code(), Some(0), "{step}: {}", text(&run.stderr));
        let read: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
        read["correction"]["settings"][0]["new"].as_f64().expect("a number")
    };
    let new = rounded("1e-5 1/mm");
    // a whole number of steps, to the rounding of their product
    assert!((new / 1e-5 - (new / 1e-5).round()).abs() < 1e-9 && new != 0.0, "{new}");
    assert_eq!(new, rounded("1e-5mm^-1"));
}
