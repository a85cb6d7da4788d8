//! `flank tolerance`: what it prints, and what it refuses.

mod support;

use support::{AGAIN, flank, text, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const PAIR: &str = "specs/pairs/bevel_19x62.chain";

#[test]
fn tolerances_are_told_with_random_cases() {
    let run = flank(&["tolerance", PAIR, "pinion_concave", "--scatter", "m.E=10um,m.S=1arcmin", "--sweep", "40"]);
    let (out, told) = (text(&run.stdout), text(&run.stderr));
    assert_eq!(run.status.code(), Some(0), "{told}");
    for line in ["drive_side.lengthwise", "drive_side.transmission_error", "40 of 40 random cases solved"] {
        assert!(out.contains(line), "{line}: {out}");
    }
    // mounting does not move a flank by itself
    assert!(
        out.contains("  bias  ") && out.lines().any(|line| line.starts_with("  bias") && line.contains(" 0 ")),
        "{out}"
    );
}

#[test]
fn a_budget_that_is_not_met_ends_with_3() {
    let asked = ["tolerance", PINION, "concave", "--scatter", "machine_root_angle=10arcmin", "--budget", "bias=1um"];
    let run = flank(&asked);
    assert_eq!(run.status.code(), Some(3));
    assert!(text(&run.stderr).contains("not met: bias scatters by"), "{}", text(&run.stderr));
    // far beyond what is linear: the cases say so
    let run = flank(&["tolerance", PINION, "concave", "--scatter", "radial_distance=5mm", "--sweep", "60"]);
    assert!(text(&run.stderr).contains("it is not proportional to them"), "{}", text(&run.stderr));
}

#[test]
fn what_does_not_go_together_is_refused() {
    let refused: [(&[&str], i32, &str); 14] = [
        (&["--scatter", "nosuch=1um"], 1, "has no setting `nosuch`"),
        (&["--scatter", "radial_distance=1arcmin"], 1, "this takes a length above zero"),
        (&["--scatter", "machine_root_angle=5"], 1, "this takes an angle above zero"),
        (&["--scatter", "ratio_of_roll=5um"], 1, "a plain number above zero, or a share of its value"),
        (&["--scatter", "work_offset=1%"], 1, "a share of a value that is zero is nothing"),
        (&["--scatter", "radial_distance=-1um"], 2, "an amount is above zero"),
        (&["--scatter", "radial_distance"], 2, "write NAME=AMOUNT"),
        (&["--scatter", "radial_distance=1um,m.radial_distance=2um"], 2, "twice"),
        (&["--budget", "twist=1um"], 1, "there is no result `twist`; there is: `slope_profilewise`"),
        (&["--budget", "bias=1arcmin"], 1, "this takes a length above zero"),
        (&["--correlation", "radial_distance,radial_distance=0.5"], 2, "two different settings"),
        (&["--correlation", "nosuch,radial_distance=0.5"], 1, "does not scatter"),
        (
            &[
                "--correlation",
                "radial_distance,ratio_of_roll=0.9",
                "--correlation",
                "radial_distance,machine_root_angle=0.9",
                "--correlation",
                "ratio_of_roll,machine_root_angle=-0.9",
            ],
            2,
            "these correlations contradict each other",
        ),
        (
            &[
                "--correlation",
                "radial_distance,ratio_of_roll=0.9",
                "--correlation",
                "ratio_of_roll,radial_distance=-0.9",
            ],
            2,
            "names `m.ratio_of_roll` and `m.radial_distance` twice",
        ),
    ];
    for (more, code, says) in refused {
        let run = flank(&[&["tolerance", PINION, "concave"], more].concat());
        assert_eq!(run.status.code(), Some(code), "{more:?}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains(says), "{more:?}: {}", text(&run.stderr));
    }
}

/// Cases with values that the spec refuses are counted, and a pair that touches along lines has no contact that moves in proportion.
#[test]
fn cases_beyond_a_range_and_lines_of_contact_are_told() {
    let asked =
        ["tolerance", "tests/machines/involute_pair.chain", "pinion", "--scatter", "slope=0.001", "--sweep", "40"];
    let run = flank(&asked);
    let (out, told) = (text(&run.stdout), text(&run.stderr));
    assert_eq!(run.status.code(), Some(3), "{out}{told}");
    let (_, beyond) = out.split_once("40 of 40 random cases solved; in ").unwrap_or_else(|| panic!("{out}"));
    // of a value at the lower end of its range about half lie below it
    let count: usize = beyond.split(' ').next().expect("a number").parse().expect("a number");
    assert!((10..=30).contains(&count) && beyond.contains("a setting lies beyond its range"), "{out}");
    assert!(told.contains("do not touch in a point that could move"), "{told}");
}

/// A spur gear is even along its teeth: what rounding leaves of slope and bias there has no causes, and random cases say nothing of it.
#[test]
fn rounding_is_no_result() {
    let asked = ["tolerance", "specs/hobbing/spur_gear.chain", "flank_plus", "--sweep", "100"];
    let run = flank(&asked);
    let (out, told) = (text(&run.stdout), text(&run.stderr));
    assert!(!told.contains("note:"), "{told}");
    let (_, shares) = out.split_once("shares of the variance").expect("shares");
    for name in ["slope_lengthwise", "crowning_lengthwise", "bias"] {
        let line = shares.lines().find(|line| line.trim_start().starts_with(name)).expect("a line");
        assert_eq!(line.split_whitespace().collect::<Vec<_>>(), [name, "-"]);
    }
    let run = flank(&[&asked[..], &["--json"]].concat());
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).expect("a document");
    for of in document["results"].as_array().expect("results") {
        let sum: f64 = of["shares"].as_array().expect("shares").iter().filter_map(serde_json::Value::as_f64).sum();
        let is_moved = of["standard_deviation"].as_f64() > Some(0.0);
        assert!((sum - if is_moved { 1.0 } else { 0.0 }).abs() < 1e-9, "{of}");
        assert_eq!(
            is_moved,
            !["slope_lengthwise", "crowning_lengthwise", "bias"].contains(&of["name"].as_str().unwrap_or(""))
        );
    }
}

/// The results of a document: name, standard deviation, and that of random cases.
fn results(asked: &[&str]) -> Vec<(String, f64, f64)> {
    let run = flank(&[&["tolerance"], asked, &["--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
    let number = |of: &serde_json::Value| of.as_f64().expect("a number");
    let result = |of: &serde_json::Value| {
        let name = of["name"].as_str().expect("a name").to_string();
        (name, number(&of["standard_deviation"]), number(&of["swept"]["standard_deviation"]))
    };
    document["results"].as_array().expect("results").iter().map(result).collect()
}

/// A tool under a second name scatters with the first, whether that has its settings from its definition or was given them.
#[test]
fn a_second_name_scatters_with_the_first() {
    let folder = support::folder("tolerance_again");
    let spec = written(&folder, "again.chain", AGAIN);
    let asked = [spec.as_str(), "three", "--scatter", "r.tilt=5arcmin,m.shift=10um", "--sweep", "100"];
    let by_definition = results(&asked);
    let given = results(&[&asked[..], &["--set", "r.tilt=20deg", "--set", "m.shift=0mm"]].concat());
    for ((name, linear, swept), known) in by_definition.iter().zip(&given) {
        assert!((linear - known.1).abs() < 1e-9 && (swept - known.2).abs() < 1e-9, "{name}: {linear} and {}", known.1);
    }
    assert!(by_definition.iter().any(|(name, linear, _)| name == "slope_profilewise" && *linear > 1.0));
}

/// A setting that scatters by itself does not follow what it is given: in contacts as on flanks, in linear numbers as in cases.
#[test]
fn what_scatters_by_itself_is_cut_from_its_formula() {
    let pair = "specs/pairs/helical_pair.chain";
    let scatter = "helix_angle=1arcmin,p.swivel=1arcmin,normal_module=1um,h.normal_module=1um";
    let all = results(&[pair, "pinion_flank", "--scatter", scatter, "--sweep", "500"]);
    for name in ["slope_profilewise", "drive_side.lengthwise", "drive_side.profilewise"] {
        let (_, linear, swept) = all.iter().find(|of| of.0 == name).expect("a result");
        // three standard errors of 500 cases
        assert!((swept / linear - 1.0).abs() < 3.0 / 1000_f64.sqrt(), "{name}: {linear} and {swept}");
    }
}

/// A module further on moves the flank of a rack parallel to itself, by pi / 4 of it along the rack, and leaves no slope. A pressure angle
/// that is off by an arcminute turns it about its middle: over the L mm of the flank that are sampled by L tan 1' .
#[test]
fn a_rack_scatters_beside_its_shift() {
    let told = |scatter: &str| -> serde_json::Value {
        let run = flank(&["tolerance", "specs/bodies/rack_body.chain", "flank_minus", "--scatter", scatter, "--json"]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        serde_json::from_slice(&run.stdout).expect("JSON")
    };
    let deviation = |told: &serde_json::Value, name: &str| {
        let all = told["results"].as_array().expect("results").clone();
        let one = all.iter().find(|one| one["name"] == name).expect("a result").clone();
        one["standard_deviation"].as_f64().expect("a number")
    };
    let module = told("r.module=10um");
    assert!(deviation(&module, "slope_profilewise") < 1e-9, "{module}");
    assert!((deviation(&module, "position") - 10.0 * std::f64::consts::FRAC_PI_4).abs() < 1e-9, "{module}");
    let angle = told("r.pressure_angle=1arcmin");
    // from where the tooth's depth of 6.75 mm less 0.9 mm and the rounding of the tip leave the flank
    assert!((deviation(&angle, "slope_profilewise") - 1.828).abs() < 5e-4, "{angle}");
}

/// With the scatter that a budget allows, and with the same correlation, a result scatters by the budget: 1 um.
#[test]
fn a_budget_holds_with_correlations() {
    let asked = |scatter: &str, correlation: &str, budget: &[&str]| -> serde_json::Value {
        let of = ["tolerance", PINION, "concave", "--scatter", scatter, "--correlation", correlation, "--json"];
        let run = flank(&[&of[..], budget].concat());
        serde_json::from_slice(&run.stdout).expect("JSON")
    };
    let deviation = |told: &serde_json::Value, name: &str| {
        let all = told["results"].as_array().expect("results").clone();
        let one = all.iter().find(|one| one["name"] == name).expect("a result").clone();
        one["standard_deviation"].as_f64().expect("a number")
    };
    let allowed = |told: &serde_json::Value| -> String {
        let amount = |cause: &serde_json::Value| {
            let name = cause["name"].as_str().expect("a name").to_string();
            let unit = cause["unit"].as_str().expect("a unit").to_string();
            format!("{name}={:?}{unit}", cause["may_scatter"].as_f64().expect("an amount"))
        };
        told["causes"].as_array().expect("causes").iter().map(amount).collect::<Vec<_>>().join(",")
    };
    let usual = "radial_distance=5um,machine_root_angle=20arcsec,ratio_of_roll=0.01%";
    for by in [-0.9, 0.0, 0.9] {
        let correlation = format!("radial_distance,ratio_of_roll={by}");
        let one = asked(usual, &correlation, &["--budget", "slope_lengthwise=1um"]);
        let back = asked(&allowed(&one), &correlation, &[]);
        assert!((deviation(&back, "slope_lengthwise") - 1.0).abs() < 1e-9, "{by}: {back}");
        // of several that are wanted one is met, and none is exceeded
        let both = asked(usual, &correlation, &["--budget", "slope_lengthwise=1um,slope_profilewise=1um"]);
        let back = asked(&allowed(&both), &correlation, &[]);
        let most = deviation(&back, "slope_lengthwise").max(deviation(&back, "slope_profilewise"));
        assert!(most < 1.0 + 1e-9, "{by}: {most}");
    }
}
