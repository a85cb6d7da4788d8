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
        "//! Signs: left-hand-pinion: cutter_tilt, cutter_swivel and center_roll_position times -1, coefficients of motions as they are.",
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

/// The sheet of a published left-hand pinion with all joints moving, signs as printed there.
const SHEET: &str = r#"<model version="1.4"><components>
  <component id="1" type="bevel_gear_manufacturing_settings">
    <attribute id="radial_distance" unit="mm">97.95940290780507</attribute>
    <attribute id="center_roll_position" unit="deg">52.79674678267486</attribute>
    <attribute id="cutter_tilt" unit="deg">2.5</attribute>
    <attribute id="cutter_swivel" unit="deg">-20</attribute>
    <attribute id="work_offset" unit="mm">-1.5</attribute>
    <attribute id="sliding_base" unit="mm">0.8</attribute>
    <attribute id="machine_root_angle" unit="deg">15.64096727073747</attribute>
    <attribute id="machine_center_to_crossing_point" unit="mm">-0.6</attribute>
    <attribute id="ratio_of_roll" unit="none">3.339685914944047</attribute>
    <attribute id="modified_roll_coefficients"><array><c>0.03</c><c>-0.12</c><c>0.5</c><c>-2.0</c></array></attribute>
    <attribute id="helical_motion_coefficients"><array><c>1.2</c><c>-3</c><c>4</c></array></attribute>
    <attribute id="vertical_motion_coefficients"><array><c>0.7</c><c>-2</c></array></attribute>
    <attribute id="radial_motion_coefficients"><array><c>-0.9</c><c>2.5</c><c>-6</c></array></attribute>
    <attribute id="tilt_motion_coefficients"><array><c>0.01</c><c>-0.03</c></array></attribute>
    <attribute id="swivel_motion_coefficients"><array><c>0.02</c><c>0.05</c></array></attribute>
  </component>
  <component id="2" type="bevel_gear_tool">
    <attribute id="blade_point_radius" unit="mm">95.9517390193892</attribute>
    <attribute id="blade_pressure_angle" unit="deg">20</attribute>
    <attribute id="blade_spheric_radius" unit="mm">250</attribute>
    <attribute id="tool_edge_radius_bevel_gear_tool" unit="mm">0.20845</attribute>
  </component>
</components></model>"#;

/// The sheet as it is, read with the signs of a left-hand pinion, gives the flank of which there is an independent table.
#[test]
fn the_signs_of_a_left_hand_pinion_give_its_flank() {
    let out = folder("rexs_flank");
    let file = written(&out, "sheet.rexs", SHEET);
    let made = flank(&["new", "pinion_19x62", "--out", out.to_str().unwrap()]);
    assert!(made.status.success(), "for the library beside the job");
    let of = ["import", &file, "--signs", "left-hand-pinion", "--coefficients", "taylor", "--outside", "2"];
    let run = flank(&[&of[..], &["--library", "."]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let sample = "    sample concave.blade {\n        s: 1 mm .. 7 mm by 4, roll: -0.2 rad .. 0.2 rad by 5\n        \
                  keep theta: 80 deg .. 170 deg\n    }\n}\n";
    let job = text(&run.stdout).trim_end().strip_suffix('}').expect("a job").to_string() + sample;
    let job = written(&out, "imported.chain", &job);
    let run = flank(&["solve", &job, "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let numbers = |path: &std::path::Path, columns: [&str; 3]| -> Vec<[f64; 3]> {
        let table = std::fs::read_to_string(path).expect("a table");
        let mut lines = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
        let titles: Vec<&str> = lines.next().expect("titles").collect();
        let places = columns.map(|column| titles.iter().position(|title| *title == column).expect("a column"));
        let row = |cells: Vec<&str>| places.map(|place| cells[place].parse().expect("a number"));
        lines.map(|line| row(line.collect())).collect()
    };
    let found = numbers(&out.join("imported.csv"), ["x", "y", "z"]);
    let table = top().join("tests/reference/universal_19x62_pinion_concave_alljoints.csv");
    // the first five points are the edge's
    let expected = &numbers(&table, ["X", "Y", "Z"])[5..];
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        // the table is good to 1e-9 mm in its condition
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{found:?} instead of {expected:?}");
    }
}

/// A job says the same on every machine: the name of its source, and not where that lies.
#[test]
fn a_job_names_its_source_without_a_folder() {
    let out = folder("rexs_place");
    let file = written(&out, "pinion.rexs", REXS);
    let of = ["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"];
    let job = text(&flank(&of).stdout);
    assert!(job.starts_with("//! From pinion.rexs, REXS 1.4, ") && !job.contains(out.to_str().unwrap()), "{job}");
}

/// Names and units are those of some versions of the format; what others say may mean something else.
#[test]
fn another_version_is_noted() {
    let out = folder("rexs_version");
    for (version, is_known) in
        [("1.3", true), ("1.6", true), ("1.7", false), ("1.10", false), ("1.2", false), ("2.0", false), ("new", false)]
    {
        let file = written(&out, "pinion.rexs", &REXS.replace("version=\"1.4\"", &format!("version=\"{version}\"")));
        let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let note = format!("it states REXS {version}, and names and units are read as those of REXS 1.3 to 1.6");
        assert_eq!(text(&run.stderr).contains(&note), !is_known, "{version}: {}", text(&run.stderr));
        assert_eq!(text(&run.stdout).contains(&note), !is_known, "{version}: {}", text(&run.stdout));
    }
}

/// What a text costs to read is counted before it is read: such files once took minutes.
#[test]
fn what_would_take_long_is_refused_at_once() {
    let out = folder("rexs_cost");
    let many = (0..300_000).map(|k| format!(" a{k}=\"\"")).collect::<String>();
    let name = "n".repeat(1 << 20);
    let long = REXS.replace("name=\"outside\"", &format!("name=\"{name}\"")).replace(
        "<attribute id=\"cutter_tilt\"",
        &("<attribute id=\"more\">1</attribute>".repeat(1000) + "<attribute id=\"cutter_tilt\""),
    );
    for (content, wanted) in [
        (
            REXS.replace(" applicationId", &format!("{many} applicationId")),
            "line 2: an element has more than 64 attributes",
        ),
        ("<model>".to_string() + &"<a>".repeat(300_000), "more than 64 elements stand inside each other"),
        (format!("<model>{}</model>", "<a xmlns:b='c'/>".repeat(300_000)), "more than 16 namespaces are declared"),
        (format!("<model>{}</model>", "<a/>".repeat(1_000_001)), "more than 1000000 elements and texts"),
        (long, ""),
    ] {
        let file = written(&out, "long.rexs", &content);
        let begun = std::time::Instant::now();
        let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(if wanted.is_empty() { 0 } else { 1 }), "{told}");
        assert!(told.contains(wanted), "{told}");
        assert!(run.stdout.len() < 1 << 20, "{} bytes", run.stdout.len());
        assert!(begun.elapsed().as_secs() < 20, "{wanted}: {:?}", begun.elapsed());
    }
}

/// A job has a name of its own, beside the words of the language and what the library defines.
#[test]
fn a_job_is_not_called_as_something_else() {
    let out = folder("rexs_name");
    let file = written(&out, "pinion.rexs", REXS);
    for name in ["job", "mm", "length", "in", "cradle_generator", "face_mill", "edge_inset"] {
        let of = ["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"];
        let run = flank(&[&of[..], &["--name", name]].concat());
        assert_eq!(run.status.code(), Some(2), "{name}: {}", text(&run.stdout));
        assert!(run.stdout.is_empty(), "{name}");
    }
}

/// Whatever a text of the file holds, it stays within its comment.
#[test]
fn texts_of_the_file_write_no_lines() {
    let out = folder("rexs_lines");
    let hostile = "1&#10;job x {&#13;}&#133;";
    let content = REXS
        .replace("version=\"1.4\"", &format!("version=\"{hostile}\""))
        .replace("id=\"12\"", &format!("id=\"12{hostile}\""))
        .replace("name=\"pinion\"", &format!("name=\"{hostile}\""))
        .replace("name=\"outside\"", &format!("name=\"{hostile}\""))
        .replace("id=\"cutter_tilt\" unit=\"deg\"", &format!("id=\"{hostile}\" unit=\"{hostile}\""));
    let file = written(&out, "hostile.rexs", &content);
    let of = ["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"];
    let run = flank(&of);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let job = text(&run.stdout);
    assert!(job.contains("REXS 1 job x { } ,"), "{job}");
    assert!(job.lines().all(|line| !line.starts_with("job x")) && !job.contains(['\r', '\u{85}']), "{job}");
    for (option, value) in [("--name", "a b"), ("--name", "a {}\njob b"), ("--library", "specs\"\nuse \"x")] {
        let run = flank(&[&of[..], &[option, value]].concat());
        assert_eq!(run.status.code(), Some(2), "{option} {value}: {}", text(&run.stdout));
    }
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

#[cfg(unix)]
#[test]
fn what_has_no_end_is_not_read() {
    for (file, why) in support::endless(&folder("import_endless")) {
        let run = flank(&["import", &file, "--signs", "frames", "--outside", "21"]);
        assert_eq!(run.status.code(), Some(1), "{file}");
        let told = text(&run.stderr);
        assert!(told.contains(&format!("error[E0001]: cannot read `{file}`: {why}")), "{told}");
    }
}

/// REXS with a tool of these attributes.
fn with_blade(attributes: &str) -> String {
    let pressure = "<attribute id=\"blade_pressure_angle\"";
    let all = REXS.replace("<attribute id=\"blade_spheric_radius\" unit=\"mm\">2000000</attribute>", "");
    assert!(all != REXS && all.contains(pressure), "{all}");
    all.replace(pressure, &format!("{attributes}{pressure}"))
}

/// The blade of 20 deg and 300 mm radius ends at the height of its profile, 8 mm over the tips: on its circle, whose centre is 300 sin 20 mm
/// beyond them, at asin(sin 20 + 8 / 300) = 21.638 deg. The rounding of 0.20845 mm touches it at 20.028 deg, so that the profile is 8.66772 mm
/// long. A straight blade keeps its height.
#[test]
fn the_height_of_a_curved_blade_is_no_length() {
    let out = folder("rexs_height");
    let height = "<attribute id=\"blade_profile_height\" unit=\"mm\">8</attribute>";
    let job = |name: &str, radius: &str| {
        let radius = format!("<attribute id=\"blade_spheric_radius\" unit=\"mm\">{radius}</attribute>");
        let file = written(&out, name, &with_blade(&format!("{height}{radius}")));
        let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        text(&run.stdout)
    };
    let curved = job("curved.rexs", "300");
    let at = curved.find("blade_length: ").expect("a length") + "blade_length: ".len();
    let length: f64 = curved[at..].split(' ').next().expect("a number").parse().expect("a number");
    assert!((length - 8.667717604405452).abs() < 1e-12, "{length}");
    assert!(job("straight.rexs", "0").contains("blade_height: 8.0 mm"));
    // so flat that it is straight: the rounding of 0.20845 mm over 70 deg, and 8 mm less its height of 0.20845 (1 - sin 20) mm over cos 20
    let flat = job("flat.rexs", "2000000");
    let at = flat.find("blade_length: ").expect("a length") + "blade_length: ".len();
    let length: f64 = flat[at..].split(' ').next().expect("a number").parse().expect("a number");
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let straight = 0.20845 * 70f64.to_radians() + (8.0 - 0.20845 * (1.0 - sine)) / cosine;
    assert!((length - straight).abs() < 1e-4, "{length} {straight}");
}

#[test]
fn what_a_rexs_file_contradicts_is_not_guessed() {
    let out = folder("rexs_twice");
    let twice = REXS
        .replace("</component>", "<attribute id=\"blade_pressure_angle\" unit=\"deg\">25.0</attribute></component>");
    let again = REXS.replacen("</components>", "<component id=\"21\" type=\"bevel_gear_tool\"/></components>", 1);
    let same = REXS
        .replace("</component>", "<attribute id=\"blade_pressure_angle\" unit=\"deg\">20.0</attribute></component>");
    let hollow = with_blade("<attribute id=\"blade_spheric_radius\" unit=\"mm\">-500</attribute>");
    let high = with_blade(
        "<attribute id=\"blade_spheric_radius\" unit=\"mm\">10</attribute><attribute id=\"blade_profile_height\" unit=\"mm\">8</attribute>",
    );
    let bare = REXS.replace("unit=\"mm\">97.9", ">97.9");
    for (name, content, wanted) in [
        ("twice", twice, "`blade_pressure_angle` is there twice, in line "),
        ("again", again, "there are several `bevel_gear_tool` with the id 21, in lines "),
        ("hollow", hollow, "blade_spheric_radius is -500 mm"),
        ("high", high, "does not reach the blade_profile_height 8 mm"),
        ("bare", bare, "`radial_distance` is given without a unit, REXS has it in mm"),
    ] {
        let file = written(&out, name, &content);
        let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
        assert_eq!(run.status.code(), Some(1), "{name}: {}", text(&run.stdout));
        assert!(text(&run.stderr).contains(wanted), "{name}: {}", text(&run.stderr));
    }
    // said twice, and the same
    let file = written(&out, "same", &same);
    let run = flank(&["import", &file, "--signs", "frames", "--coefficients", "taylor", "--outside", "21"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let run = flank(&["import", &file, "--signs", "frames"]);
    assert!(
        text(&run.stderr).contains("--outside for the concave flank, --inside for the convex one"),
        "{}",
        text(&run.stderr)
    );
}
