//! `flank fit`: settings for a wanted ease-off or a wished table.

mod support;

use serde_json::Value;
use support::grids::{fit, names, number, path};
use support::{flank, folder, top, written};

const EASE_OFF: &str = "specs/bevel/ease_off_19x62.chain";

/// No ease-off from another job: its settings. And a flank that lies off by a parabola lies off by these numbers.
#[test]
fn a_wanted_ease_off_is_reached_where_settings_make_it() {
    let project = folder("fit_ease_off");
    std::os::unix::fs::symlink(top().canonicalize().expect("the repository").join("specs"), project.join("specs"))
        .expect("a link");
    let jobs = std::fs::read_to_string(top().join(EASE_OFF)).expect("it is shipped").replace("../", "specs/");
    let off = "job off = basic(m.radial_distance: 98.05 mm, m.machine_root_angle: 15.7 deg, m.ratio_of_roll: 3.345)\n";
    let spec = written(&project, "off.chain", &format!("{jobs}\n{off}"));
    let varied = "radial_distance,machine_root_angle,ratio_of_roll";
    let asked = [&spec, "off.concave", "--from", "basic.concave", "--vary", varied];
    let (told, _) = fit(0, &[&asked[..], &["--ease-off", "bias: 0"]].concat());
    assert!(told["identification"].is_null());
    assert!(number(&told["correction"]["left_um"]) < 1e-6, "{}", told["correction"]);
    let settings = told["correction"]["settings"].as_array().expect("settings");
    for (setting, value) in settings.iter().zip([97.95940290780507, 15.64096727073747, 3.339685914944047]) {
        assert!((number(&setting["new"]) - value).abs() < 1e-8, "{setting}");
    }
    // 20 um of pressure angle: three settings do most of it
    let (told, _) = fit(0, &[&asked[..], &["--ease-off", "slope: 20 profilewise", "--within", "2um"]].concat());
    let reached = &told["ease_off"]["reached"];
    assert!((number(&reached["slopes_um"][0]) - 20.0).abs() < 2.0, "{reached}");
}

/// The inside blades do not touch this flank: nothing is changed for a wish, and why is said.
#[test]
fn a_wish_that_no_setting_moves_is_told() {
    let wish = ["--ease-off", "bias: 20", "--from", "conjugate.concave", "--vary", "c.inside_point_radius"];
    let (told, stderr) = fit(3, &[&[EASE_OFF, "basic.concave"][..], &wish].concat());
    assert!(names(&told["correction"]["settings"]).is_empty(), "{told}");
    assert!(stderr.contains("`c.inside_point_radius` does not move concave"), "{stderr}");
    assert!(stderr.contains("none is changed") && stderr.contains("not met"), "{stderr}");
}

/// Where two settings do the same but for next to nothing, the search for both may come to no end: then no uncertainty is claimed, and it is said.
#[test]
fn a_search_without_an_end_is_told() {
    let spec = "specs/bevel/conjugate_pinion_19x62.chain";
    let out = folder("fit_no_end");
    let set = ["m.radial_distance=97.87579403144188 mm", "m.machine_root_angle=1.3196246722237475 rad"];
    let more = ["m.shaft_angle=1.65743132328724 rad", "c.blade_angle=0.3479835252496473 rad"];
    let mut arguments = vec!["measure", spec, "--surface", "concave", "--out", path(&out)];
    set.iter().chain(&more).for_each(|value| arguments.extend(["--set", value]));
    assert_eq!(flank(&arguments).status.code(), Some(0));
    let file = out.join("conjugate_pinion_19x62.grid.csv");
    let varied = "m.radial_distance,m.machine_root_angle,m.shaft_angle,c.blade_angle";
    let (told, stderr) = fit(0, &[spec, "concave", "--measured", path(&file), "--vary", varied]);
    let found = &told["identification"];
    assert!(number(&found["left_um"]) < 1e-4, "{found}");
    let off = (number(&found["settings"][1]["new"]) - 1.3196246722237475f64.to_degrees()).abs();
    let is_said = stderr.contains("the search came to no end") && found["settings"][1]["uncertain_by"].is_null();
    assert!(off < 1e-7 || is_said, "{found} {stderr}");
}

/// The published settings lie 5 um off the parabola that they were after; these settings come nearer, none on it.
#[test]
fn the_published_ease_off_is_no_parabola() {
    let varied = "radial_distance,cradle_angle,work_offset,sliding_base,machine_center_to_crossing_point,ratio_of_roll,modified_roll_2c,\
                  modified_roll_6d,outside_point_radius,blade_angle,blade_radius";
    let wish = ["--ease-off", "crowning: 50, 25; slope: 0, 0; bias: 0", "--from", "basic.concave", "--within", "0.1um"];
    let (told, stderr) = fit(3, &[&[EASE_OFF, "pinion.concave", "--vary", varied][..], &wish].concat());
    let [before, left] = [number(&told["before_um"]), number(&told["correction"]["left_um"])];
    assert!((before - 4.93).abs() < 0.01 && left < before && left > 1.0, "{before} {left}");
    assert!(
        stderr.contains("not met") && stderr.contains("directions in which the settings move the flank"),
        "{stderr}"
    );
}

/// A table of deviations is a wish as a parabola is: of the same numbers the same settings.
#[test]
fn a_wished_table_is_met() {
    let project = folder("fit_table");
    let wish = |i: usize, j: usize| {
        let (v, u) = (i as f64 / 12.0 - 1.0, j as f64 / 22.0 - 1.0);
        -10.0 * u * u + 4.0 * v
    };
    let lines = (0..25).flat_map(|i| (0..45).map(move |j| format!("{},{},{:?}\n", i + 1, j + 1, wish(i, j))));
    let table = written(&project, "wish.csv", &format!("row,column,deviation_um\n{}", lines.collect::<String>()));
    let asked = [
        EASE_OFF,
        "pinion.concave",
        "--from",
        "basic.concave",
        "--vary",
        "radial_distance,ratio_of_roll,blade_angle",
        "--within",
        "50um",
    ];
    let (parabola, _) =
        fit(3, &[&asked[..], &["--ease-off", "crowning: 10 lengthwise; slope: 8 profilewise"]].concat());
    let (told, _) = fit(3, &[&asked[..], &["--ease-off", &table, "--margin", "0,0"]].concat());
    for (of, other) in told["correction"]["settings"]
        .as_array()
        .expect("settings")
        .iter()
        .zip(parabola["correction"]["settings"].as_array().expect("settings"))
    {
        assert!((number(&of["new"]) - number(&other["new"])).abs() < 1e-8, "{of} {other}");
    }
}

/// The ease-off that was published for the 19 x 62 pinion, crownings of 50 and 25 um and no slopes and no bias, from its basic settings: the five
/// numbers are met, over the flank above its rounding. What is left of the points is no parabola, as with the published settings.
#[test]
fn the_published_ease_off_is_met_from_the_basic_settings() {
    let project = folder("fit_published");
    std::os::unix::fs::symlink(top().canonicalize().expect("the repository").join("specs"), project.join("specs"))
        .expect("a link");
    // a blade that is almost straight: its curvature is what changes by little
    let spec = written(
        &project,
        "curved.chain",
        "use \"specs/bevel/ease_off_19x62.chain\"
        use \"specs/functions/blanks_19x62.chain\"
        use \"specs/tools/face_mill.chain\"
        job curved extends basic {
            param blade_curvature : 1 / length in 0.0000001 / 1 mm .. 0.02 / 1 mm = 0.0000005 / 1 mm
            tool c = face_mill(
                outside_point_radius: 95.9517390193892 mm, inside_point_radius: 94.5482609806108 mm,
                blade_angle: 20 deg, blade_radius: 1 / blade_curvature, edge_radius: 0.20845 mm,
                theta_from: 80 deg, theta_to: 135 deg
            )
            sample concave {
                toe_root: toe_root_1(), heel_root: heel_root_1(), toe_tip: toe_tip_1(), heel_tip: heel_tip_1()
                profilewise: 0.3 .. 1 by 11, lengthwise: 0 .. 1 by 15
            }
        }
        job plain = curved()
        job published extends pinion {
            sample concave {
                toe_root: toe_root_1(), heel_root: heel_root_1(), toe_tip: toe_tip_1(), heel_tip: heel_tip_1()
                profilewise: 0.3 .. 1 by 11, lengthwise: 0 .. 1 by 15
            }
        }\n",
    );
    let varied = "radial_distance,cradle_angle,work_offset,machine_center_to_crossing_point,ratio_of_roll,modified_roll_2c,modified_roll_6d,\
                  outside_point_radius,blade_angle,blade_curvature";
    let wish = ["--from", "plain.concave", "--ease-off", "crowning: 50, 25; slope: 0, 0; bias: 0", "--order", "2"];
    let (told, stderr) =
        fit(0, &[&[&spec, "curved.concave", "--vary", varied, "--within", "0.1um"][..], &wish].concat());
    let reached = &told["ease_off"]["reached"];
    let numbers = |of: &Value, name: &str| [number(&of[name][0]), number(&of[name][1])];
    for (name, wanted) in [("slopes_um", [0.0, 0.0]), ("crownings_um", [50.0, 25.0])] {
        let off = numbers(reached, name).iter().zip(wanted).map(|(x, wanted)| (x - wanted).abs()).fold(0.0, f64::max);
        assert!(off < 0.1, "{name}: {reached} {stderr}");
    }
    assert!(number(&reached["bias_um"]).abs() < 0.1, "{reached}");
    // neither lies on the parabola
    let left = number(&told["predicted_um"]);
    assert!(left > 3.0 && left < 6.0, "{left}");
    // the published flank itself, from the basic settings: with all directions that show they make it
    let all = format!("{varied},sliding_base");
    let asked = [&spec, "curved.concave", "--from", "published.concave", "--ease-off", "bias: 0", "--vary", &all];
    let (told, _) = fit(0, &[&asked[..], &["--resolution", "0.001um"]].concat());
    assert!(number(&told["before_um"]) > 10.0 && number(&told["predicted_um"]) < 1e-3, "{}", told["predicted_um"]);
}
