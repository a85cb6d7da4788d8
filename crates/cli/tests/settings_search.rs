//! `flank convert --fit`: the settings of another machine that give the same motion.

mod support;

use support::{flank, folder, text, written};

const SLANTED: &str = "
machine slanted {
    axis X : linear in -300 mm .. 300 mm
    axis A : rotary in -180 deg .. 180 deg
    axis B : rotary in -180 deg .. 180 deg
    param twist : angle in -90 deg .. 90 deg
    axis C : rotary in -180 deg .. 180 deg
    param off : length in -100 mm .. 100 mm
    param drop : length in -100 mm .. 100 mm
    param lift : length in -100 mm .. 100 mm
    param slant : angle in 0 deg .. 80 deg
    param wedge : angle in -60 deg .. 60 deg
    frame bed
    frame knee in bed = translate_x(X) rotate([sin(slant), 0, cos(slant)], A) translate(off, 0 mm, drop)
    frame head in knee = rotate_y(B) translate_z(20 mm)
    frame table in bed = rotate_y(wedge) translate_z(lift) rotate_z(C + twist)
    frame work in table = translate(3 mm, 4 mm, 5 mm)
}
";
const SLANTED_JOB: &str = "
use \"slanted.chain\"
tool bent {
    surface edge(u: length in -3 mm .. 3 mm) {
        at = [0.1 * u^2 / 1 mm, 0.02 * u^3 / 1 mm^2, u]
        body towards [0, 1, 0]
    }
}
job j {
    machine m = slanted(twist: 0 deg, off: 31 mm, drop: -22 mm, lift: 14 mm, slant: 37 deg, wedge: -13 deg)
    tool t = bent
    mount t on m.head
    motion phi : angle in -40 deg .. 40 deg
    drive m.X = 150 mm * phi
    drive m.A = 10 deg + 0.5 * phi
    drive m.B = 30 deg - 0.3 * phi + 0.1 * phi^2 / 1 rad
    drive m.C = -20 deg + 0.3 * phi
    surface s in m.work = sweep(t.edge, over: phi)
    sample s { u: -2 mm .. 2 mm by 5, phi: -30 deg .. 30 deg by 9 }
}
";

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

/// A slanted rotary axis may be shifted along itself, which two offsets of the head, the lift of the table and X make up for, and a twist of the
/// table's axis is an angle of C: none of these settings has one value. What the poses do determine of them is what such shifts leave.
#[test]
fn all_settings_that_change_together_are_told() {
    let out = folder("settings_together");
    written(&out, "slanted.chain", SLANTED);
    let spec = written(&out, "job.chain", SLANTED_JOB);
    let target = out.join("slanted.chain");
    let run = flank(&["convert", &spec, "--to", target.to_str().expect("a plain path"), "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let settings = found["settings"].as_array().expect("settings");
    let names = |determined: bool| -> Vec<&str> {
        let of = settings.iter().filter(|setting| setting["determined"] == determined);
        of.map(|setting| setting["name"].as_str().expect("a name")).collect()
    };
    assert_eq!(names(false), ["twist", "off", "drop", "lift"], "{settings:?}");
    assert_eq!(names(true), ["slant", "wedge"], "{settings:?}");
    let value = |name: &str| settings.iter().find(|of| of["name"] == name).expect(name)["value"].as_f64().unwrap();
    // square to the axis, and along it together with the lift
    let kept = |off: f64, drop: f64, lift: f64| {
        let ((sine, cosine), upright) = (37f64.to_radians().sin_cos(), 13f64.to_radians().cos());
        [off * cosine - drop * sine, (off * sine + drop * cosine) * cosine - lift * upright]
    };
    let (found, own) = (kept(value("off"), value("drop"), value("lift")), kept(31.0, -22.0, 14.0));
    assert!(found.iter().zip(own).all(|(found, own)| (found - own).abs() < 1e-8), "{found:?} {own:?}");
}
