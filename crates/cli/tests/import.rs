//! `flank import` as a user runs it.

mod support;

use support::{flank, folder, text, top, written};

/// The pinion of the library as a REXS file; `COEFFICIENTS` and further tools are put in by the tests.
const REXS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" applicationId="test" date="2026-01-01T00:00:00+01:00">
  <components>
    <component id="12" type="bevel_gear_manufacturing_settings" name="pinion">
      <attribute id="radial_distance" unit="mm">97.95940290780507</attribute>
      <attribute id="center_roll_position" unit="deg">52.79674678267486</attribute>
      <attribute id="cutter_tilt" unit="deg">2.5</attribute>
      <attribute id="machine_root_angle" unit="deg">15.64096727073747</attribute>
      <attribute id="machine_center_to_crossing_point" unit="mm">-0.001306176586991889</attribute>
      <attribute id="ratio_of_roll" unit="none">3.339685914944047</attribute>
      <attribute id="helical_motion_coefficients" unit="none"><array><c>1.2</c><c>-1.5</c></array></attribute>
    </component>
    <component id="21" type="bevel_gear_tool" name="outside">
      <attribute id="blade_point_radius" unit="mm">95.9517390193892</attribute>
      <attribute id="blade_pressure_angle" unit="deg">20.0</attribute>
      <attribute id="blade_spheric_radius" unit="mm">2000000</attribute>
      <attribute id="tool_edge_radius_bevel_gear_tool" unit="mm">0.20845</attribute>
    </component>
  </components>
</model>
"#;

#[test]
fn a_rexs_file_becomes_a_job() {
    let out = folder("rexs");
    let file = written(&out, "pinion.rexs", REXS);
    let library = top().join("specs").to_str().unwrap().to_string();
    let of = ["import", &file, "--signs", "left-hand-pinion", "--outside", "21", "--library", &library];
    let run = flank(&of);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("`helical_motion_coefficients` is not zero; say what"), "{}", text(&run.stderr));

    let run = flank(&[&of[..], &["--coefficients", "polynomial"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let job = text(&run.stdout);
    for part in [
        "//! Signs: left-hand-pinion: cutter_tilt, cutter_swivel and center_roll_position times -1.",
        "//! helical_motion_coefficients, order 2: -1.5 times 2 is helical_motion_2.",
        "cradle_angle: -52.79674678267486 deg",
        "cutter_tilt: -2.5 deg",
        "helical_motion_1: 1.2 mm",
        "helical_motion_2: -3.0 mm",
        "blade_radius: 2000000.0 mm",
    ] {
        assert!(job.contains(part), "{part} in\n{job}");
    }
    let laid_out = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
    let laid_out = text(&laid_out.stdout);
    assert!(laid_out.contains("cradle_angle: 52.79674678267486 deg") && laid_out.contains("helical_motion_2: -1.5 mm"));
    // in the project's folder, a job that is right
    let here = top().join("target/imported.chain");
    std::fs::write(&here, laid_out.replace("\"specs/", "\"../specs/")).unwrap();
    let run = flank(&["check", "target/imported.chain"]);
    let _ = std::fs::remove_file(&here);
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
}

#[test]
fn what_is_wrong_with_a_rexs_file_is_told() {
    let out = folder("wrong_rexs");
    for (name, content, wanted) in [
        ("text", "no markup".to_string(), "is not XML"),
        ("other", "<drawing/>".to_string(), "is no REXS file: it begins with `drawing`"),
        ("none", "<model version=\"1.4\"/>".to_string(), "no component `bevel_gear_manufacturing_settings`"),
        ("unit", REXS.replace("unit=\"mm\">97.9", "unit=\"inch\">97.9"), "is given in inch, REXS has it in mm"),
        ("number", REXS.replace("3.339685914944047", "fast"), "`ratio_of_roll` is `fast`, which is no number"),
        ("missing", REXS.replace("machine_root_angle", "root"), "has no `machine_root_angle`"),
        ("angle", REXS.replace(">20.0<", ">-20.0<"), "a blade angle counts from the cutter's axis"),
        ("motion", REXS.replace("cutter_tilt", "horizontal_distance"), "`horizontal_distance` is not zero"),
    ] {
        let file = written(&out, name, &content);
        let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
        assert_eq!(run.status.code(), Some(1), "{name}");
        assert!(text(&run.stderr).contains(wanted), "{name}: {}", text(&run.stderr));
    }
    let file = written(&out, "tools", REXS);
    let run = flank(&["import", &file, "--signs", "frames"]);
    assert!(text(&run.stderr).contains("there is: bevel_gear_tool 21 (outside)"), "{}", text(&run.stderr));
}
