//! `flank import` as a user runs it.

mod support;

use support::{REXS, flank, folder, text, top, written};

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

/// As programs write REXS 1.4 and later: relations first, German names, empty components, coded arrays, attributes that say more
/// than a machine needs.
const WHOLE: &str = r#"<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<model applicationId="Example" applicationVersion="7.1" date="2021-12-14T15:56:10+01:00" version="1.4">
  <relations>
    <!--Flanken-Relation zwischen Rad und linker und rechter Flanke-->
    <relation id="68" type="flank">
      <ref hint="bevel_gear" id="8" role="gear"/>
      <ref hint="bevel_gear_flank" id="246" role="left"/>
      <ref hint="bevel_gear_flank" id="247" role="right"/>
    </relation>
    <relation id="70" order="1" type="manufacturing_step">
      <ref hint="bevel_gear_flank" id="246" role="workpiece"/>
      <ref hint="bevel_gear_tool" id="35" role="tool"/>
      <ref hint="bevel_gear_manufacturing_settings" id="250" role="manufacturing_settings"/>
    </relation>
  </relations>
  <components>
    <component id="8" name="Kegelrad [8]" type="bevel_gear">
      <attribute id="number_of_teeth" unit="none">19</attribute>
    </component>
    <component id="31" name="leer [31]" type="bevel_gear_tool"/>
    <component id="35" name="Außenmesser [35]" type="bevel_gear_tool">
      <attribute id="number_of_blade_groups_bevel_gear_tool" unit="none">13</attribute>
      <attribute id="blade_point_radius" unit="mm">95.95</attribute>
      <attribute id="blade_pressure_angle" unit="°">20.0</attribute>
      <attribute id="tool_edge_radius_bevel_gear_tool" unit="mm">0.2</attribute>
      <attribute id="protuberance_height_bevel_gear_tool" unit="mm">0.0</attribute>
    </component>
    <component id="250" name="Einstelldaten [250]" type="bevel_gear_manufacturing_settings">
      <attribute id="cutter_tilt" unit="deg">0.0</attribute>
      <attribute id="cutter_swivel" unit="deg">0.0</attribute>
      <attribute id="sliding_base" unit="mm">-1.5</attribute>
      <attribute id="radial_distance" unit="mm">97.959</attribute>
      <attribute id="machine_root_angle" unit="deg">16.4</attribute>
      <attribute id="work_offset" unit="mm">0.0</attribute>
      <attribute id="machine_center_to_crossing_point" unit="mm">0.0</attribute>
      <attribute id="center_roll_position" unit="deg">-52.797</attribute>
      <attribute id="horizontal_distance" unit="mm">0.0</attribute>
      <attribute id="ratio_of_roll" unit="none">3.3397</attribute>
      <attribute id="helical_motion_coefficients" unit="none">
        <array code="float64">mpmZmZmZ6T8AAAAAAAD4vw==</array>
      </attribute>
      <attribute id="radial_motion_coefficients" unit="none">
        <array code="float32">AAAAPwAAgL4=</array>
      </attribute>
      <attribute id="angular_motion_coefficients" unit="none"><array><c>0.0</c></array></attribute>
    </component>
  </components>
</model>
"#;

#[test]
fn a_rexs_file_as_programs_write_it_becomes_a_job() {
    let out = folder("whole_rexs");
    let options = ["--signs", "frames", "--coefficients", "taylor", "--outside", "35"];
    let import = |content: &str| {
        let file = written(&out, "whole.rexs", content);
        let run = flank(&[&["import", &file], &options[..]].concat());
        (run.status.code(), text(&run.stdout) + &text(&run.stderr))
    };
    let (code, job) = import(WHOLE);
    assert_eq!(code, Some(0), "{job}");
    for part in [
        "REXS 1.4, bevel_gear_manufacturing_settings 250 (Einstelldaten [250])",
        "cradle_angle: -52.797 deg",
        "sliding_base: -1.5 mm",
        "helical_motion_1: 0.8 mm",
        "helical_motion_2: -1.5 mm",
        "radial_motion_1: 0.5 mm",
        "radial_motion_2: -0.25 mm",
        "// bevel_gear_tool 35 (Außenmesser [35])",
        "//! Not used of bevel_gear_tool 35 (Außenmesser [35]): number_of_blade_groups_bevel_gear_tool, 13.",
    ] {
        assert!(job.contains(part), "{part} in\n{job}");
    }
    for (from, to, wanted) in [
        (
            "mpmZmZmZ6T8AAAAAAAD4vw==",
            "HELIC",
            "`helical_motion_coefficients` is no array of float64 in Base64: `HELIC`",
        ),
        ("code=\"float32\"", "code=\"text\"", "is no array of text in Base64"),
        (">0.0</attribute>\n    </component>", ">0.9</attribute>\n    </component>", "face_mill_relieved has a toprem"),
    ] {
        let (code, told) = import(&WHOLE.replace(from, to));
        assert!(code == Some(1) && told.contains(wanted), "{from}: {told}");
    }
}
