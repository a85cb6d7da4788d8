//! `flank convert --fit`: the settings of another machine that give the same motion.

mod support;

use support::{flank, text};

/// Which settings of a cradle generator give this pinion's poses: those of its machine sheet.
#[test]
fn settings_of_another_machine_are_found() {
    let target = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/cradle.chain", "--json"];
    let fit = "machine_center_to_crossing_point,sliding_base,work_offset,cutter_tilt,cutter_swivel";
    let run = flank(&[&target[..], &["--fit", fit]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(found["schema"], "flank.settings/1");
    let sheet = [
        ("radial_distance", 97.95940290780507, true),
        ("cradle_angle", -52.79674678267486, true),
        ("machine_root_angle", 15.64096727073747, true),
        ("machine_center_to_crossing_point", -0.001306176586991889, true),
        ("ratio_of_roll", 3.339685914944047, true),
        ("sliding_base", 0.0, true),
        ("work_offset", 0.0, true),
        ("cutter_tilt", 0.0, true),
        // without tilt, where to does not matter
        ("cutter_swivel", 0.0, false),
    ];
    let settings = found["settings"].as_array().expect("settings");
    assert_eq!(settings.len(), sheet.len());
    for (name, value, determined) in sheet {
        let setting = settings.iter().find(|setting| setting["name"] == name).expect(name);
        assert!((setting["value"].as_f64().unwrap() - value).abs() < 1e-8, "{setting}");
        assert_eq!(setting["determined"], determined, "{setting}");
    }
    assert!(found["deviation_um"].as_f64().unwrap() < 1e-6, "{found}");
    // without the machine centre it is as near as can be, and told
    let run = flank(&target);
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(
        told.contains("no values of these settings were found that make all poses on") && told.contains("--fit"),
        "{told}"
    );
    let run = flank(&[&target[..], &["--fit", "cutter_tlit"]].concat());
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("--fit cutter_tlit: there is no such setting"), "{}", text(&run.stderr));
    let run = flank(&[&target[..], &["--fit", "hypoid_offset"]].concat());
    assert!(text(&run.stderr).contains("it does not move the tool against the work"), "{}", text(&run.stderr));
    let free = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain"];
    let run = flank(&[&free[..], &["--fit", "nosuch"]].concat());
    let told = text(&run.stderr);
    assert!(told.contains("there is no such setting; free_form has no setting that can be looked for"), "{told}");
}

/// Settings have no files: what asks for one is refused, and not passed over.
#[test]
fn of_settings_there_are_no_files() {
    let target = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/cradle.chain"];
    let asked = ["--nc", "fanuc", "--time", "20", "--emit", "c", "--format", "json", "--order", "4", "--out", "x"];
    let run = flank(&[&target[..], &["--fit", "sliding_base"], &asked].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(2), "{told}");
    assert!(told.contains("leave out --order, --out, --format, --nc, --time, --emit, and ask"), "{told}");
    // without --fit it is the settings without a value that are looked for
    let run = flank(&[&target[..], &["--tolerance", "1um"]].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("has no value") && told.contains("leave out --tolerance"), "{told}");
}

/// From a single start the settings that make all poses are not found, which is told; from as many as there are otherwise they are.
#[test]
fn settings_are_looked_for_from_as_many_starts_as_asked_for() {
    let settings = "machine_center_to_crossing_point,sliding_base,work_offset,cutter_tilt,cutter_swivel";
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/cradle.chain", "--fit", settings];
    let of_one = flank(&[&spec[..], &["--starts", "1"]].concat());
    assert_eq!(of_one.status.code(), Some(3), "{}", text(&of_one.stdout));
    assert!(text(&of_one.stderr).contains("no values of these settings were found"), "{}", text(&of_one.stderr));
    assert_eq!(flank(&spec).status.code(), Some(0));
}

/// A tilt of 3.5 deg towards 55 deg is one of -3.5 deg towards -125 deg: of the two the first is nearer to the defaults, which are zero.
#[test]
fn of_equal_settings_the_nearest_to_the_defaults_are_found() {
    let fit = "work_offset,sliding_base,machine_center_to_crossing_point,cutter_tilt,cutter_swivel,modified_roll_2c,modified_roll_6d,\
               helical_motion_1,helical_motion_2";
    let spec =
        ["convert", "specs/bevel/tilted_pinion.chain", "--surface", "concave", "--to", "specs/machines/cradle.chain"];
    let run = flank(&[&spec[..], &["--fit", fit, "--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    for (name, value) in [("cutter_tilt", 3.5), ("cutter_swivel", 55.0)] {
        let settings = found["settings"].as_array().expect("settings");
        let setting = settings.iter().find(|setting| setting["name"] == name).expect(name);
        assert!((setting["value"].as_f64().unwrap() - value).abs() < 1e-8, "{setting}");
    }
}
