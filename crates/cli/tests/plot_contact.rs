//! `flank plot` of contacts as a user runs it.

mod support;

use support::{flank, folder, text};

const PAIR: &str = "specs/pairs/bevel_19x62.chain";
const BOTH_SIDES: &str = "specs/pairs/spur_pair.chain";

/// The picture of a kind, as SVG.
fn drawn(name: &str, arguments: &[&str], file: &str) -> String {
    let out = folder(name);
    let run = flank(&[&["plot", "--out", out.to_str().expect("a plain path")][..], arguments].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(std::fs::metadata(out.join(format!("{file}.png"))).is_ok_and(|file| file.len() > 10_000));
    std::fs::read_to_string(out.join(format!("{file}.svg"))).expect("drawn")
}

#[test]
fn each_kind_says_what_the_tester_shows() {
    let arguments = [PAIR, "--what", "pattern,error,gap,path"];
    let pattern = drawn("plot-contact", &arguments, "bevel_19x62.pattern");
    let out = folder("plot-contact-again");
    let others = flank(&[&["plot", "--out", out.to_str().expect("plain")][..], &arguments].concat());
    assert!(others.status.success(), "{}", text(&others.stderr));
    let of = |kind: &str| std::fs::read_to_string(out.join(format!("bevel_19x62.{kind}.svg"))).expect("drawn");
    // the same bytes each time
    assert_eq!(of("pattern"), pattern);
    for word in ["toe", "heel", "root", "tip", "middle", "6.35 \u{b5}m"] {
        assert!(pattern.contains(word), "{word}");
    }
    // the numbers of `flank contact`
    let contact =
        text(&flank(&["contact", PAIR, "--no-picture", "--json", "--out", out.to_str().expect("plain")]).stdout);
    let result: serde_json::Value =
        serde_json::Deserializer::from_str(&contact).into_iter().next().expect("a document").expect("JSON");
    let peak = result["error"]["peak_to_peak"].as_f64().expect("a number");
    assert!(of("error").contains(&format!("peak to peak {peak:.3} \u{b5}rad")), "{peak}");
    let transfer = result["error"]["transfers"][0].as_f64().expect("a number");
    assert!(of("error").contains(&format!("{:.3}", transfer.abs())), "{transfer}");
    assert!(of("gap").contains("white: the edge of the film"));
    assert!(of("path").contains("path of contact of drive_side"));
}

/// Extremes lie between the positions that are drawn: of 12 the largest of a worm pair's errors is 11 % more than what they show.
#[test]
fn the_error_of_the_picture_is_that_of_the_pair() {
    let spec = "specs/pairs/worm_and_wheel.chain";
    let out = folder("plot-contact-worm");
    let to = out.to_str().expect("a plain path");
    let told = flank(&["contact", spec, "--positions", "12", "--no-picture", "--json", "--out", to]);
    let told: serde_json::Value = serde_json::from_slice(&told.stdout).expect("JSON");
    let peak = told["error"]["peak_to_peak"].as_f64().expect("a number");
    assert!(flank(&["plot", spec, "--what", "error", "--out", to]).status.success());
    let drawn = std::fs::read_to_string(out.join("worm_and_wheel.error.svg")).expect("drawn");
    assert!(drawn.contains(&format!("peak to peak {peak:.3} \u{b5}rad")), "{peak}");
}

#[test]
fn drive_and_coast_stand_side_by_side() {
    let both = drawn("plot-contact-both", &[BOTH_SIDES, "--what", "pattern"], "spur_pair.pattern");
    for panel in
        ["drive_side: pinion_flank", "coast_side: pinion_coast", "drive_side: gear_flank", "coast_side: gear_coast"]
    {
        assert!(both.contains(panel), "{panel}");
    }
    let one =
        drawn("plot-contact-one", &[BOTH_SIDES, "--what", "pattern", "--contact", "coast_side"], "spur_pair.pattern");
    assert!(one.contains("coast_side") && !one.contains("drive_side"));
}

#[test]
fn a_wrong_mounting_moves_the_pattern() {
    let right = drawn("plot-contact-right", &[PAIR, "--what", "pattern"], "bevel_19x62.pattern");
    let wrong =
        drawn("plot-contact-wrong", &[PAIR, "--what", "pattern", "--error", "m.E=0.1mm"], "bevel_19x62.pattern");
    assert_ne!(right, wrong);
}

#[test]
fn what_does_not_fit_is_told() {
    let out = folder("plot-contact-unfit");
    let refused = |arguments: &[&str]| {
        let run = flank(&[&["plot", "--out", out.to_str().expect("plain")][..], arguments].concat());
        assert!(!run.status.success());
        text(&run.stderr)
    };
    let none = refused(&["specs/hobbing/spur_gear.chain", "--what", "pattern"]);
    assert!(none.contains("no `contact` of it says which flanks touch"), "{none}");
    let unknown = refused(&[PAIR, "--what", "pattern", "--contact", "coast"]);
    assert!(unknown.contains("there is no contact `coast`; there is: `drive_side`"), "{unknown}");
    let elsewhere = refused(&[PAIR, "--what", "surface", "--compound", "5um"]);
    assert!(elsewhere.contains("pictures of a contact"), "{elsewhere}");
    let axis = refused(&[PAIR, "--what", "error", "--error", "m.X=1mm"]);
    assert!(axis.contains("no such axis"), "{axis}");
}
