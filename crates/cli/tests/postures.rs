//! Which of the ways in which a machine can stand `flank convert` takes.

mod support;

use serde_json::Value;
use support::{flank, folder, text, written};

const THESIS: [(&str, &str); 3] = [
    ("radial_cutter_position", "97.95367814746567mm"),
    ("root_angle", "75.6638280957449deg"),
    ("angular_cutter_position", "52.801158062429394deg"),
];

/// A job on another machine with all its positions.
fn carried(job: &[&str], out: &std::path::Path) -> Value {
    let run = flank(&[&["convert"], job, &["--json", "--out", out.to_str().expect("a plain path")]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

fn ends(table: &Value, name: &str) -> [f64; 2] {
    let axes = table["axes"].as_array().expect("axes");
    let axis = axes.iter().find(|axis| axis["name"] == name).expect("an axis");
    ["low", "high"].map(|end| axis[end].as_f64().expect("a number"))
}

/// The thesis machine has three axes, and the cutter's turn beside: four unknowns, six components. Displacements alone have a double root
/// where the cutter's plane goes through the machine's centre; mixtures of all components have none.
#[test]
fn settings_of_a_machine_of_few_axes_are_met_exactly() {
    let out = folder("postures-few");
    let settings = THESIS.map(|(name, value)| format!("cradle_tilt.{name}={value}"));
    let settings: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    let job = ["specs/bevel/gear_19x62.chain", "--surface", "concave", "--to", "specs/machines/cradle_tilt.chain"];
    let table = carried(&[&job[..], &settings, &["--positions", "5"]].concat(), &out);
    for position in table["positions"].as_array().expect("positions") {
        let at = |key: &str, k: usize| position[key][k].as_f64().expect("a number");
        // the cradle rolls as on the job's machine, and the bed stands still: to some roundings of what is 100 mm large
        assert!((at("axes", 0) - at("motions", 0)).abs() < 1e-10 && at("axes", 1).abs() < 1e-10, "{position}");
    }
}

/// The roll that goes with fitted settings turns as far as the job's does, without a jump of a turn.
#[test]
fn axes_of_fitted_settings_do_not_jump() {
    let job = ["convert", "specs/bevel/gear_19x62.chain", "--to", "specs/machines/cradle_tilt.chain", "--json"];
    let run = flank(&job);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let positions = found["positions"].as_array().expect("positions");
    for pair in positions.windows(2) {
        let moved = |key: &str| pair[1][key][0].as_f64().unwrap() - pair[0][key][0].as_f64().unwrap();
        assert!((moved("axes") - moved("motions")).abs() < 1e-6, "{pair:?}");
    }
}

/// A wheel on a rocking arm grinds a cam; carried over to slides whose spindle is parallel to the axis of the cam. Spindle and work can turn
/// together without moving the tool, so the spindle stands still, also where the tool shifts along itself by an axis of its own.
#[test]
fn a_spindle_that_is_parallel_to_the_axis_of_the_work_stands_still() {
    const CAM: &str = "machine cam_grinder {
    axis C : rotary
    axis A : rotary
    frame bed
    frame work in bed = rotate_z(C)
    frame rocker in bed = translate_x(120 mm) rotate_z(180 deg - A)
    frame cutter in rocker = translate_x(100 mm)
}
tool wheel {
    surface rim(a: angle in -180 deg .. 180 deg, v: length in -10 mm .. 10 mm) {
        at = [40 mm * cos(a), 40 mm * sin(a), v]
        body inside
    }
}
job cam {
    machine m = cam_grinder
    tool w = wheel
    mount w on m.cutter
    motion turn : angle in -180 deg .. 180 deg
    drive m.C = turn
    drive m.A = 38 deg + 4 deg * (1 - cos(2 * turn))
    surface cam in m.work = envelope(w.rim, over: turn)
    sample cam {
        turn: -170 deg .. 170 deg by 35, v: -5 mm .. 5 mm by 3
        keep a: 8 deg .. 187 deg
    }
}
";
    let out = folder("postures-parallel");
    let job = written(&out, "cam.chain", CAM);
    let onto = |name: &str, axes: &str, more: &str| {
        let machine = format!(
            "machine {name} {{\n    axis X : linear\n    axis Y : linear\n    axis C : rotary\n{axes}    frame bed\n    frame cutter in bed = \
             translate(X, Y, 0 mm){more}\n    frame work in bed = rotate_z(C)\n}}\n"
        );
        let machine = written(&out, &format!("{name}.chain"), &machine);
        carried(&[&job, "--to", &machine, "--positions", "21"], &out)
    };
    let bare = onto("bare", "", "");
    let spindle = onto("spindle", "    axis S : rotary\n", " rotate_z(S)");
    let quill = onto("quill", "    axis Z : linear\n    axis S : rotary\n", " translate_z(Z) rotate_z(S)");
    assert!(bare["resting"].is_null() && spindle["resting"]["name"] == "S" && quill["resting"]["name"] == "S");
    for (k, position) in bare["positions"].as_array().expect("positions").iter().enumerate() {
        let axis = |table: &Value, axis: usize| table["positions"][k]["axes"][axis].as_f64().expect("a number");
        for axes in 0..3 {
            let [own, others @ ..] = [&bare, &spindle, &quill].map(|table| axis(table, axes));
            assert!(others.iter().all(|other| (other - own).abs() < 1e-9), "{position}: {others:?}");
        }
        // as far as the triangle of pivot, arm and wheel has it
        let turn = position["motions"][0].as_f64().expect("a number").to_radians();
        let rocked = (38.0 + 4.0 * (1.0 - (2.0 * turn).cos())).to_radians();
        let apart = (120f64.powi(2) + 100f64.powi(2) - 2.0 * 120.0 * 100.0 * rocked.cos()).sqrt();
        assert!((axis(&bare, 0).hypot(axis(&bare, 1)) - apart).abs() < 1e-9, "{position}");
    }
}

/// A trunnion that turns to one side only just not far enough, a table that ends a turn away, a spindle that hardly turns: each
/// machine reaches all of the motion some other way than the first that comes to mind.
#[test]
fn another_elbow_or_turn_is_taken_where_it_stays_within_the_travels() {
    let out = folder("postures-travels");
    let pinion = "specs/bevel/pinion_19x62.chain";
    let check = |machine: &str, extended: &str, inside: &[(&str, f64, f64)]| {
        let library = support::self_contained(&[machine]);
        let target = written(&out, "target.chain", &format!("{library}{extended}\n"));
        let table = carried(&[pinion, "--to", &target, "--positions", "11"], &out);
        for (name, low, high) in inside {
            let [from, to] = ends(&table, name);
            assert!(*low <= from && to <= *high, "{extended}: {name} from {from} to {to}");
        }
        table
    };
    let trunnion = "machines/five_axis_table_table";
    // A stands at 105.6 or at -105.6 degrees
    for (low, high) in [(-120.0, 105.5), (-105.5, 120.0)] {
        let extended =
            format!("machine tt extends five_axis_table_table {{ axis A : rotary in {low} deg .. {high} deg }}");
        check(trunnion, &extended, &[("A", low, high)]);
    }
    // C turns by 72.6 degrees from 55.4 or 235.4 on, and whole turns more or less
    for (low, high) in [(60.0, 490.0), (-310.0, -229.0), (410.0, 490.0), (-130.0, -50.0)] {
        let extended =
            format!("machine tt extends five_axis_table_table {{ axis C : rotary in {low} deg .. {high} deg }}");
        check(trunnion, &extended, &[("C", low, high)]);
    }
    // the cutter's spindle, which leaves the cutter unchanged, turns by 21.8 degrees
    let table = check(
        "machines/free_form",
        "machine held extends free_form { axis C : rotary in -11 deg .. 11 deg }",
        &[("C", -11.0, 11.0)],
    );
    let proven = &table["polynomials"]["remainders"]["proven"]["C"];
    assert!(proven.as_f64().is_some_and(|bound| bound < 1e-9), "{proven}");
}

/// What polynomials are about does not depend on how many positions there are.
#[test]
fn polynomials_are_about_the_middle_of_the_motion() {
    let out = folder("postures-middle");
    let job = ["specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain", "--positions"];
    let of = |count: &str| carried(&[&job[..], &[count]].concat(), &out)["polynomials"].clone();
    let usual = of("101");
    for count in ["1", "2", "4", "10"] {
        let found = of(count);
        assert_eq!(found["reference"], usual["reference"], "{count}");
        for axis in ["X", "A"] {
            for k in 0..=3 {
                let [a, b] = [&found, &usual].map(|series| series["coefficients"][axis][k].as_f64().unwrap());
                assert!((a - b).abs() < 1e-9, "{count}: {axis} {k}: {a} {b}");
            }
        }
    }
}

/// Travels are printed as they were given.
#[test]
fn travels_are_printed_as_given() {
    let out = folder("postures-text");
    let library = support::self_contained(&["machines/free_form"]);
    let extended = "machine odd extends free_form { axis X : linear in -400.4567 mm .. 400 mm
        axis B : rotary in -10.25 deg .. 120 deg }";
    let target = written(&out, "target.chain", &format!("{library}{extended}\n"));
    let job = ["convert", "specs/bevel/pinion_19x62.chain", "--to", &target, "--out", out.to_str().unwrap()];
    let run = flank(&[&job[..], &["--nc", "linuxcnc", "--time", "5"]].concat());
    let told = text(&run.stdout);
    assert!(told.contains("-400.4567 mm .. 400 mm") && told.contains("-10.25 deg .. 120 deg"), "{told}");
    for (file, travel) in [("csv", "travel -10.25 to 120"), ("ngc", "-10.25 .. 120 deg")] {
        let head = std::fs::read_to_string(out.join(format!("pinion_19x62_on_odd.{file}"))).expect("a file");
        assert!(head.contains(travel), "{head}");
    }
}
