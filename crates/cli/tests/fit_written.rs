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
}

/// Amounts of what is one over a length have such a unit, too: as 1/mm, 1/cm, or as a plain number of 1/mm.
#[test]
fn amounts_of_a_curvature_have_its_unit() {
    let spec = "specs/hobbing/crowned_gear.chain";
    let scattered = |amount: &str| {
        let amount = format!("m.crowning={amount}");
        let run = flank(&["tolerance", spec, "upper_flank", "--scatter", &amount, "--json"]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        document["results"].clone()
    };
    let plain = scattered("1e-6");
    for amount in ["1e-6 1/mm", "1e-6/mm"] {
        assert_eq!(scattered(amount), plain, "{amount}");
    }
    let of = |results: &serde_json::Value| results[3]["standard_deviation"].as_f64().expect("a number");
    // a tenth is not exact
    assert!((of(&scattered("1e-5 1/cm")) / of(&plain) - 1.0).abs() < 1e-14);
    let run = flank(&["tolerance", spec, "upper_flank", "--scatter", "m.crowning=1um"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("an amount in 1/mm above zero"), "{}", text(&run.stderr));
}

/// What is not what was wanted is no spec to go on with.
#[test]
fn a_wish_that_is_not_met_is_not_written() {
    let written = top().join("specs/pairs/not_written.chain");
    let file = written.to_str().expect("a plain path");
    let asked =
        ["fit", "specs/pairs/bevel_19x62.chain", "--want", "centred", "--vary", "p.radial_distance", "--write", file];
    let run = flank(&asked);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let told = text(&run.stdout) + &text(&run.stderr);
    assert!(told.contains("centred is not met") && told.contains("not written, as it is not what is wanted"), "{told}");
    assert!(!written.exists());
    let run = flank(&[&asked[..], &["--dry"]].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("p.radial_distance:"), "{}", text(&run.stdout));
}
