//! The binary as a user runs it: output, files, exit codes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn flank(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flank")).args(arguments).current_dir(top()).output().expect("the binary runs")
}

/// A folder of its own for each test, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn written(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("the test's file");
    path.to_str().expect("a plain path").to_string()
}

/// Specs of the library as one file that uses no other.
fn self_contained(specs: &[&str]) -> String {
    let read = |name: &&str| std::fs::read_to_string(top().join(format!("specs/{name}.chain"))).expect("it is shipped");
    let all: String = specs.iter().map(read).collect();
    all.lines().filter(|line| !line.starts_with("use ")).map(|line| format!("{line}\n")).collect()
}

#[test]
fn solve_writes_points_and_pictures() {
    let out = folder("solve");
    let run = flank(&[
        "solve",
        "specs/hobbing/helical_gear.chain",
        "--out",
        out.to_str().unwrap(),
        "--format",
        "csv,json,stl",
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in ["lower_flank", "upper_flank", "651", "worst residual", "spindle"] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    assert!(text(&run.stderr).contains("1302 points in"), "{}", text(&run.stderr));
    for extension in ["csv", "json", "stl", "png", "svg"] {
        let path = out.join(format!("helical_gear.{extension}"));
        assert!(std::fs::metadata(&path).is_ok_and(|file| file.len() > 1000), "{}", path.display());
    }
    let csv = std::fs::read_to_string(out.join("helical_gear.csv")).unwrap();
    let head = csv.lines().find(|line| !line.starts_with('#')).unwrap();
    assert_eq!(head, "surface,i,j,x,y,z,nx,ny,nz,xi,tau,spindle,feed,residual,status");
    assert_eq!(csv.lines().filter(|line| line.ends_with(",solved")).count(), 1302);
}

/// Ten teeth are cut under: the singular line is on the base circle, at u = r sin²α / cos α.
#[test]
fn limits_are_listed_and_written() {
    let out = folder("limits");
    let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--set", "teeth=10", "--set", "module=5 mm", "--limits"];
    let more = ["--set", "profile_shift=0", "--set", "r.tip_height=6.25 mm", "--set", "r.tip_radius=1.9 mm", "--json"];
    let run = flank(&[&arguments[..], &more[..], &["--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let lines = table["lines"].as_array().expect("lines");
    let line = |name: &str| lines.iter().find(|line| line["name"] == name).expect("the line is listed");
    assert_eq!(line("flank_plus.singular_line")["solved"], 25);
    assert_eq!(line("fillet_plus.singular_line")["solved"], 0);
    assert_eq!(line("flank_plus.contact_limit")["solved"], 0);
    let u = line("flank_plus.singular_line")["ranges_reached"][2]["low"].as_f64().unwrap();
    let alpha = 20f64.to_radians();
    assert!((u - 25.0 * alpha.sin().powi(2) / alpha.cos()).abs() < 1e-9, "{u}");
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    assert_eq!(csv.lines().filter(|row| row.starts_with("flank_plus.singular_line,")).count(), 25);
    assert!(!csv.contains("contact_limit,"));
}

/// The flank of a spur gear bends as 1/√(R² − r_b²), and the whole tooth along its length not at all.
#[test]
fn geometry_is_listed_and_written() {
    let out = folder("geometry");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--geometry", "--no-picture", "--out", out.to_str().unwrap()];
    let run = flank(&base);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in ["flank_plus", "k1", "1/mm", "sliding_angle", "90.000000  deg", "induced_k1", "metric_e"] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    assert!(!table.contains("-0.000000 ") && !table.contains("NaN"), "{table}");
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        csv.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).expect("a column");
    let number = |row: &[&str], name: &str| -> f64 { row[column(name)].parse().expect("a number") };
    let base_radius = 36.0 * 20f64.to_radians().cos();
    let points: Vec<&Vec<&str>> = rows.iter().filter(|row| row[0] == "flank_plus").collect();
    assert_eq!(points.len(), 275);
    for row in points {
        let involute = 1.0 / (number(row, "x").hypot(number(row, "y")).powi(2) - base_radius.powi(2)).sqrt();
        assert!((number(row, "k1") / involute - 1.0).abs() < 1e-9 && number(row, "k2").abs() < 1e-12);
        assert!((number(row, "d2_z").abs() - 1.0).abs() < 1e-9 && (number(row, "contact_line_z") - 1.0).abs() < 1e-9);
    }
    let json = flank(&[&base[..], &["--json"]].concat());
    let table: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let field = &table["surfaces"][0]["fields"][0];
    assert_eq!(
        (field["name"].as_str(), field["unit"].as_str(), field["undefined"].as_u64()),
        (Some("k1"), Some("1/mm"), Some(0))
    );
}

/// A rack that stands off by 1 mm leaves sin α more material all over its flanks; the face width leaves them where they are.
#[test]
fn sensitivity_is_ranked_written_and_drawn() {
    let out = folder("sensitivity");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--sensitivity", "--out", out.to_str().unwrap()];
    let run = flank(&base);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in [
        "flank_plus moves, over 275 points, with",
        "profile_shift",
        "um/0.001",
        "no influence, ",
        "face_width",
        "by little: teeth",
    ] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        csv.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).expect("a column");
    let [shift, width] = ["d_normal/d_profile_shift", "d_normal/d_face_width"].map(column);
    for row in rows.iter().filter(|row| row[0].starts_with("flank_")) {
        // module 3 mm, told for 0.001
        let moved: f64 = row[shift].parse().expect("a number");
        assert!((moved - 3.0 * 20f64.to_radians().sin()).abs() < 1e-12, "{moved}");
        assert_eq!(row[width], "0");
    }
    for surface in ["flank_plus", "fillet_minus"] {
        for extension in ["png", "svg"] {
            let path = out.join(format!("spur_gear.{surface}.sensitivity.{extension}"));
            assert!(std::fs::metadata(&path).is_ok_and(|file| file.len() > 1000), "{}", path.display());
        }
    }
    let summary = flank(&[&base[..], &["--json", "--no-picture"]].concat());
    let table: serde_json::Value = serde_json::from_slice(&summary.stdout).expect("JSON");
    let sensitivity = &table["surfaces"][0]["sensitivity"];
    let rms = |k: usize| sensitivity["parameters"][k]["rms"].as_f64().expect("a number");
    assert!(rms(0) >= rms(1) && rms(1) > 0.0);
    assert_eq!(sensitivity["counts"], serde_json::json!(["teeth"]));
}

/// Points that the job's own `trim`s and the tool itself take away are counted by what takes them, and asked for in vain.
#[test]
fn what_is_cut_away_is_counted() {
    let out = folder("cut-away");
    let run = flank(&[
        "solve",
        "specs/hobbing/undercut_gear.chain",
        "--json",
        "--no-picture",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(run.status.code(), Some(3));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let outcomes = &table["surfaces"][0]["outcomes"];
    assert_eq!((&outcomes["solved"], &outcomes["cut away"]), (&189.into(), &98.into()), "{outcomes}");
    assert_eq!(table["lines"][0]["name"], "flank_plus.trimmed_by_fillet_plus");
    assert_eq!(table["lines"][0]["solved"], 7);
    let told = text(&run.stderr);
    assert!(told.contains("70: cut away by the tool itself"), "{told}");
    assert!(told.contains("28: cut away by what makes fillet_plus, as `trim` asks for"), "{told}");
    let csv = std::fs::read_to_string(out.join("undercut_gear.csv")).unwrap();
    assert_eq!(csv.lines().filter(|row| row.starts_with("flank_plus,") && row.contains(",cut away,")).count(), 98);
}

/// `cut`: what is left goes out with the points, as a map, and as a summary; where no edge passes, that is said.
#[test]
fn what_single_edges_leave_is_listed_written_and_drawn() {
    let out = folder("cut");
    let spec = std::fs::read_to_string(top().join("tests/machines/planed.chain")).expect("the test's machine");
    let spec = written(&out, "planed.chain", &spec);
    let solve = |set: &str| flank(&["solve", &spec, "--json", "--set", set, "--out", out.to_str().unwrap()]);
    let run = solve("feed=0.5 mm");
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let plane = &table["surfaces"][0];
    assert_eq!(plane["cut"], serde_json::json!({ "by": "strokes", "known": 255, "unreached": 0, "undecided": 0 }));
    let left = &plane["fields"][0];
    assert_eq!((left["name"].as_str(), left["unit"].as_str()), (Some("left"), Some("um")));
    // half a feed beside a stroke: 8 - sqrt(8^2 - 0.25^2) mm
    assert!((left["high"].as_f64().unwrap() - 3.907204).abs() < 1e-6, "{left}");
    let csv = std::fs::read_to_string(out.join("planed.csv")).unwrap();
    let titles = csv.lines().find(|line| !line.starts_with('#')).unwrap();
    assert!(titles.ends_with("left,left_by_stroke"), "{titles}");
    assert!(csv.contains("of `strokes` leave over the surface, along its normal; plus is material"));
    for extension in ["png", "svg"] {
        assert!(out.join(format!("planed.plane.left.{extension}")).exists());
    }
    let run = solve("reach=1 deg");
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(told.contains("not known what is left: 130 of 255 points of plane"), "{told}");
    assert!(told.contains("130: no edge of strokes passes there within its ranges"), "{told}");
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let [a, b] = ["bytes-a", "bytes-b"].map(folder);
    for out in [&a, &b] {
        let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--format", "csv,json,stl", "--out"];
        let run = flank(&[&arguments[..], &[out.to_str().unwrap()]].concat());
        assert_eq!(run.status.code(), Some(0));
    }
    for extension in ["csv", "json", "stl", "png", "svg"] {
        let read = |folder: &Path| std::fs::read(folder.join(format!("spur_gear.{extension}"))).unwrap();
        assert_eq!(read(&a), read(&b), "{extension}");
    }
}

#[test]
fn stdout_is_the_same_each_time() {
    let out = folder("same");
    for further in [&[][..], &["--json"]] {
        let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--no-picture", "--out", out.to_str().unwrap()];
        let [a, b] = [(); 2].map(|()| flank(&[&arguments[..], further].concat()));
        assert_eq!(text(&a.stdout), text(&b.stdout));
        assert!(text(&a.stderr).contains("points in"), "{}", text(&a.stderr));
    }
}

#[test]
fn jobs_without_a_sample_are_passed_over() {
    let folder = folder("idle");
    std::fs::write(folder.join("flank.toml"), "").expect("the test's file");
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).unwrap();
    let idle: String = gear.lines().filter(|line| !line.contains("sample")).map(|line| format!("{line}\n")).collect();
    let idle_job = idle[idle.find("job first_gear").unwrap()..idle.find("/// The tool sits").unwrap()].to_string();
    let both = written(&folder, "both.chain", &format!("{gear}{}", idle_job.replace("first_gear", "idle_gear")));
    let none = written(&folder, "none.chain", &idle);
    let solve =
        |further: &[&str]| flank(&[&["solve", "--no-picture", "--out", folder.to_str().unwrap()], further].concat());

    let run = solve(&[&both]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("job first_gear") && text(&run.stdout).contains("job first_helical_gear"));
    assert!(text(&run.stderr).contains("note: job `idle_gear` asks for no points"), "{}", text(&run.stderr));
    for wrong in [&[both.as_str(), "--job", "idle_gear"][..], &[&none]] {
        let run = solve(wrong);
        assert_eq!(run.status.code(), Some(1), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains("error: job `"), "{}", text(&run.stderr));
        assert!(run.stdout.is_empty());
    }
}

#[test]
fn set_changes_a_parameter_and_a_setting() {
    let out = folder("set");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--json", "--no-picture", "--out", out.to_str().unwrap()];
    let plain = flank(&base);
    let changed = flank(&[&base[..], &["--set", "profile_shift=0.25", "--set", "r.tip_radius=1 mm"]].concat());
    assert_eq!(changed.status.code(), Some(0), "{}", text(&changed.stderr));
    let low = |run: &Output| -> f64 {
        let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        table["surfaces"][1]["ranges_reached"][0]["low"].as_f64().expect("a number")
    };
    // the root circle moves with the profile shift
    assert!((low(&changed) - low(&plain) - 0.05 * 3.0).abs() < 1e-3, "{} {}", low(&plain), low(&changed));
}

#[test]
fn set_of_a_wrong_name_or_value_is_told() {
    for (set, code, words) in [
        ("teeht=30", 1, "did you mean `teeth`?"),
        ("module=3", 1, "give it a unit: `3 mm`"),
        ("module=3 furlong", 1, "is not a unit"),
        ("module=-3 mm", 1, "`module` is -3 mm, outside its range 0.001 mm .. 1000 mm"),
        ("r.pressure_angle=80 deg", 1, "outside its range -45 deg .. 45 deg"),
        ("r.tip_radius=9 mm", 1, "outside its range 0 mm .. 6 mm"),
        ("module", 2, "NAME=VALUE"),
    ] {
        let run = flank(&["derive", "specs/hobbing/spur_gear.chain", "--set", set]);
        assert_eq!(run.status.code(), Some(code), "{set}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains(words), "{set}: {}", text(&run.stderr));
    }
}

#[test]
fn check_says_where_and_why() {
    let folder = folder("check");
    let wrong = written(&folder, "wrong.chain", "tool t {\n    param r : lenght\n}\n");
    let run = flank(&["check", "specs/machines/cradle.chain", &wrong]);
    assert_eq!(run.status.code(), Some(1));
    let told = text(&run.stderr);
    for part in ["E0201", "wrong.chain:2:15", "did you mean `length`?"] {
        assert!(told.contains(part), "{part} in\n{told}");
    }
    assert!(text(&run.stdout).contains("specs/machines/cradle.chain: ok"));
    let run = flank(&["check", "--json", &wrong]);
    let findings: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(findings["files"][0]["findings"][0]["place"]["column"], 15);
}

#[test]
fn every_spec_of_the_library_is_right() {
    let mut files = Vec::new();
    for folder in ["functions", "machines", "tools", "hobbing", "bevel", "double_envelope", "grinding"] {
        for entry in std::fs::read_dir(top().join("specs").join(folder)).unwrap() {
            files.push(format!("specs/{folder}/{}", entry.unwrap().file_name().into_string().unwrap()));
        }
    }
    assert!(files.len() >= 9);
    let arguments: Vec<&str> = std::iter::once("check").chain(files.iter().map(String::as_str)).collect();
    let run = flank(&arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(run.stderr.is_empty(), "{}", text(&run.stderr));
}

#[test]
fn deviation_of_two_flanks_is_told_and_drawn() {
    let out = folder("deviation");
    let spec = "specs/bevel/ease_off_19x62.chain";
    let into = out.to_str().unwrap();
    let of = ["deviation", spec, "pinion.concave", "--from", "conjugate.concave", "--out", into];
    let run = flank(&[&of[..], &["--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told: serde_json::Value = serde_json::from_str(&text(&run.stdout)).unwrap();
    assert_eq!((told["asked"].as_u64(), told["known"].as_u64()), (Some(1125), Some(1125)));
    assert!(told["middle_um"].as_f64().unwrap().abs() < 1e-6);
    for extension in ["csv", "png", "svg"] {
        assert!(out.join(format!("pinion.concave.deviation.{extension}")).exists(), "{extension}");
    }
    let run = flank(&["deviation", spec, "concave", "--from", "conjugate.concave", "--out", into]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("several jobs have a surface `concave`"), "{}", text(&run.stderr));
    let run = flank(&["deviation", spec, "pinion.convex", "--from", "conjugate.concave", "--out", into]);
    assert!(text(&run.stderr).contains("there is no surface `pinion.convex`"), "{}", text(&run.stderr));
    let run = flank(&["deviation", spec, "conjugate.concave", "--from", "pinion.concave", "--out", into]);
    assert!(text(&run.stderr).contains("`concave` is not sampled"), "{}", text(&run.stderr));
}

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

#[test]
fn a_missing_file_is_told() {
    for command in ["check", "solve", "derive", "fmt"] {
        let run = flank(&[command, "specs/no_such_file.chain"]);
        assert_eq!(run.status.code(), Some(1));
        assert!(text(&run.stderr).contains("there is no such file"), "{}", text(&run.stderr));
    }
}

#[test]
fn derive_counts_operations() {
    let run = flank(&["derive", "specs/bevel/pinion_19x62.chain", "--cost", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let concave = &told["jobs"][0]["surfaces"][0];
    assert_eq!((concave["surface"].as_str(), concave["equations"].as_u64()), (Some("concave"), Some(3)));
    let count = |stage: &str, what: &str| concave[stage][what].as_u64().expect("a count");
    let arithmetic = |stage: &str| {
        ["additions", "multiplications", "divisions", "square_roots"].iter().map(|what| count(stage, what)).sum::<u64>()
    };
    // a cradle machine's flank with its Jacobian: what an expert needs by hand
    assert!(arithmetic("per_point") + arithmetic("per_motion_value") <= 160, "{concave}");
    assert!(count("per_point", "sincos") + count("per_motion_value", "sincos") <= 4, "{concave}");
    assert!(arithmetic("per_spec") > 0);
    let table = text(&flank(&["derive", "specs/bevel/pinion_19x62.chain", "--cost"]).stdout);
    assert!(table.contains("per motion value"), "{table}");
}

#[test]
fn derive_prints_every_stage() {
    let run = flank(&["derive", "specs/bevel/pinion_19x62.chain"]);
    assert_eq!(run.status.code(), Some(0));
    let told = text(&run.stdout);
    for part in [
        "m.work <- m.head <- m.swinging_base <- m.base <- m.vertical_slide <- m.bed <- m.cradle",
        "rotate_x(-m.cradle)",
        "product of all",
        "vector part",
        "twist along roll",
        "equation of meshing for roll",
        "shared",
    ] {
        assert!(told.contains(part), "{part}");
    }
    let latex = text(&flank(&["derive", "specs/bevel/pinion_19x62.chain", "--latex"]).stdout);
    assert!(latex.starts_with("\\documentclass") && latex.trim_end().ends_with("\\end{document}"));
    assert_eq!(latex.matches('{').count(), latex.matches('}').count());
    assert_eq!(latex.matches("\\left(").count(), latex.matches("\\right)").count());
}

/// A cutter whose centre is set so far out that it never reaches the blank.
#[test]
fn a_job_without_solution_exits_3_and_writes_statuses() {
    let out = folder("unsolved");
    let arguments = ["solve", "specs/bevel/pinion_19x62.chain", "--set", "m.radial_distance=400 mm", "--out"];
    let run = flank(&[&arguments[..], &[out.to_str().unwrap(), "--geometry", "--sensitivity"]].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    assert!(table.contains("concave: no point is solved, so it cannot be said what moves it"), "{table}");
    assert!(!table.contains("no influence"), "{table}");
    assert!(text(&run.stderr).contains("not solved: 465 of 465 points of concave\n"), "{}", text(&run.stderr));
    let csv = std::fs::read_to_string(out.join("pinion_19x62.csv")).unwrap();
    let flank_rows: Vec<&str> = csv.lines().filter(|line| line.starts_with("concave,")).collect();
    assert_eq!(flank_rows.len(), 465);
    for row in flank_rows {
        // nor are curvatures or sensitivities
        let row = row.trim_end_matches(',');
        let told = [" iterations", ",not converged,no start leads there", ",singular"];
        assert!(
            told.iter().any(|end| row.ends_with(end)) || row.contains(",outside,") && row.ends_with(" mm"),
            "{row}"
        );
        assert!(row.contains(",,,,,,"), "no position is invented: {row}");
    }
}

/// What a status leaves open is told of each point: which unknown by how much, and what cuts away.
#[test]
fn statuses_have_reasons() {
    let out = folder("reasons");
    let solve = |arguments: &[&str]| {
        let run = flank(&[&["solve", "--no-picture", "--out", out.to_str().unwrap()], arguments].concat());
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    };
    let told = |name: &str, reason: &str| {
        let csv = std::fs::read_to_string(out.join(name)).unwrap();
        let mut rows = csv.lines().filter(|line| !line.starts_with('#'));
        let titles: Vec<&str> = rows.next().unwrap().split(',').collect();
        assert_eq!(titles[titles.len() - 2..], ["status", "reason"]);
        assert!(rows.any(|row| row.contains(reason)), "no row has {reason}: {csv}");
    };
    solve(&["specs/hobbing/undercut_gear.chain"]);
    told("undercut_gear.csv", "cut away,\"by the tool itself, beyond the singular line of the envelope (undercut)\"");
    told("undercut_gear.csv", "cut away,\"by what makes fillet_plus, as `trim` asks for\"");
    let spec = self_contained(&["tutorial/first_gear"]);
    let narrow = spec.replace("motion roll : angle in -40 deg .. 40 deg", "motion roll : angle in -5 deg .. 5 deg");
    assert_ne!(spec, narrow);
    solve(&[&written(&out, "narrow.chain", &narrow)]);
    told("first_gear.csv", "outside,roll by ");
}

/// The hob's thread comes by again after a turn: the JSON lists the teeth with what keeps each of them.
#[test]
fn branches_are_listed_as_json() {
    let out = folder("branches");
    let spec = self_contained(&["machines/hobbing_6axis", "tools/involute", "tools/hob_zi", "hobbing/helical_gear"]);
    let unsaid: Vec<&str> = spec.lines().filter(|line| !line.contains("keep ")).collect();
    let spec = written(&out, "unsaid.chain", &(unsaid.join("\n") + "\n"));
    let run = flank(&["solve", &spec, "--json", "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    assert_eq!(table["schema"], "flank.solve/2");
    let found = table["surfaces"][0]["branches"]["found"].as_array().unwrap();
    assert!(found.len() > 1, "{found:?}");
    for branch in found {
        let keep = &branch["keep"];
        let unknowns = branch["unknowns"].as_array().unwrap();
        let of = unknowns.iter().find(|unknown| unknown["name"] == keep["name"]).expect("keep names an unknown");
        let [low, at, high] = [&keep["low"], &of["value"], &keep["high"]].map(|x| x.as_f64().unwrap());
        assert!(low < at && at < high, "{branch}");
        let line =
            format!("ranges of {} hold {} branches", table["surfaces"][0]["name"].as_str().unwrap(), found.len());
        assert!(text(&run.stderr).contains(&line), "{}", text(&run.stderr));
    }
}

/// A pinion on the free-form machine: what is printed, and the same as JSON.
#[test]
fn convert_carries_a_job_over() {
    let out = folder("convert");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain"];
    let arguments = [&spec[..], &["--out", out.to_str().unwrap()]].concat();
    let files = ["--nc", "fanuc,siemens,linuxcnc", "--time", "20", "--emit", "c,rust", "--format", "csv,json"];
    let run = flank(&[&arguments[..], &["--tolerance", "0.1um"], &files].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    for extension in ["csv", "json", "nc", "mpf", "ngc", "c", "rs"] {
        let name = format!("pinion_19x62_on_free_form.{extension}");
        assert!(out.join(&name).is_file() && told.contains(&name), "{name}: {told}");
    }
    assert!(told.contains("the tool does not see a turn about [0.000000, 0.000000, 1.000000]"), "{told}");
    let run = flank(&[&arguments[..], &["--order", "9", "--positions", "21", "--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    assert_eq!(table["schema"], "flank.convert/1");
    assert_eq!(table["positions"].as_array().unwrap().len(), 21);
    let series = &table["polynomials"];
    let h = table["positions"][20]["motions"][0].as_f64().unwrap().to_radians() - series["about"].as_f64().unwrap();
    // the last position by the polynomials: what is left is of order ten
    for (k, axis) in table["axes"].as_array().unwrap().iter().enumerate() {
        let coefficients = series["coefficients"][axis["name"].as_str().unwrap()].as_array().unwrap();
        let value = coefficients.iter().rev().fold(0.0, |sum, c| sum * h + c.as_f64().unwrap());
        let value = if axis["unit"] == "deg" { value.to_degrees() } else { value };
        let found = table["positions"][20]["axes"][k].as_f64().unwrap();
        assert!((value - found).abs() < 1e-8, "{}: {value} instead of {found}", axis["name"]);
    }
    let deviations: Vec<f64> =
        series["deviation_mm_by_order"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert!(deviations.len() == 10 && deviations[9] < 1e-8 && deviations[2] > 1e-3, "{deviations:?}");
}

#[test]
fn convert_tells_what_the_other_machine_cannot_do() {
    let out = folder("convert-not");
    let told = |arguments: &[&str], code: i32| {
        let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--out", out.to_str().unwrap(), "--to"];
        let run = flank(&[&spec, arguments].concat());
        assert_eq!(run.status.code(), Some(code), "{}", text(&run.stderr));
        text(&run.stderr)
    };
    let six = "specs/machines/hobbing_6axis.chain";
    assert!(told(&[six], 1).contains("hobbing_6axis has no frame `work` that stands for m.work"));
    let beyond = told(&[six, "--tool-frame", "hob", "--work-frame", "table"], 3);
    assert!(beyond.contains("101 of 101 positions: axis hobbing_6axis.X has to stand at -"), "{beyond}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "what cannot be reached is no program");
    assert!(told(&["specs/tools/rack.chain"], 1).contains("there is no machine in specs/tools/rack.chain"));
    let run = flank(&["convert", "specs/bevel/tilted_pinion.chain", "--to", "specs/machines/free_form.chain"]);
    assert!(text(&run.stderr).contains("has several tools"), "{}", text(&run.stderr));
}

/// A gear too large for the machine: the radial axis would have to stand at 430 mm.
#[test]
fn an_axis_beyond_its_travel_is_told() {
    let out = folder("travel");
    let arguments = ["solve", "specs/hobbing/helical_gear.chain", "--no-picture", "--set", "teeth=241", "--out"];
    let run = flank(&[&arguments[..], &[out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(told.contains("beyond its travel: axis m.X runs from 428.6"), "{told}");
}

#[test]
fn files_that_cannot_be_written_are_told() {
    let folder = folder("unwritable");
    let blocked = written(&folder, "blocked", "a file, not a folder");
    let run = flank(&["solve", "specs/hobbing/spur_gear.chain", "--out", &blocked]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("blocked"), "{}", text(&run.stderr));
}

#[test]
fn help_has_examples_and_usage_errors_exit_2() {
    for command in [&["--help"][..], &["solve", "--help"], &["check", "--help"], &["derive", "--help"]] {
        let run = flank(command);
        assert_eq!(run.status.code(), Some(0));
        assert!(text(&run.stdout).contains("Examples:"), "{command:?}");
    }
    for wrong in [&[][..], &["sovle"], &["solve"], &["solve", "x.chain", "--format", "docx"]] {
        assert_eq!(flank(wrong).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn a_file_without_a_job_cannot_be_solved() {
    let run = flank(&["solve", "specs/machines/cradle.chain"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("E0507"), "{}", text(&run.stderr));
    let run = flank(&["solve", "specs/hobbing/spur_gear.chain", "--job", "spur"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("there is: `spur_gear`"), "{}", text(&run.stderr));
}

#[test]
fn explain_prints_pages_and_lists_codes() {
    let page = flank(&["explain", "E0301"]);
    assert_eq!(page.status.code(), Some(0), "{}", text(&page.stderr));
    let written = std::fs::read_to_string(top().join("docs/errors/E0301.md")).unwrap();
    assert_eq!(text(&page.stdout), written);
    assert_eq!(text(&flank(&["explain", "e0301"]).stdout), written);
    let list = text(&flank(&["explain"]).stdout);
    assert!(list.contains("E0001  a file cannot be read\n") && list.contains("E0511  "), "{list}");
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_slice(&flank(&[&["explain", "--json"], arguments].concat()).stdout).expect("JSON")
    };
    assert_eq!(json(&["E0301"])["page"], written);
    let all = json(&[]);
    assert_eq!([&all["schema"], &all["codes"][0]["code"]], ["flank.explain/1", "E0001"]);
}

#[test]
fn explain_of_an_unknown_code_is_a_wrong_command_line() {
    for (code, words) in [("E301", "did you mean `E0301`"), ("dimension", "`flank explain` lists all codes")] {
        let run = flank(&["explain", code]);
        assert_eq!(run.status.code(), Some(2), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains(words), "{}", text(&run.stderr));
    }
}

#[test]
fn errors_end_with_where_to_read_more() {
    let folder = folder("more");
    let wrong = written(&folder, "wrong.chain", "tool t {\n    param r : lenght\n    param r : length = 3 deg\n}\n");
    let told = text(&flank(&["check", &wrong]).stderr);
    assert!(told.ends_with("3 errors\n`flank explain E0201` tells more\n"), "{told}");
    assert_eq!(told.matches("flank explain").count(), 1);
    let right = text(&flank(&["check", "specs/machines/cradle.chain"]).stderr);
    assert!(!right.contains("flank explain"), "{right}");
}

/// What a user gets wrong at a hobbing machine, and what is told.
#[test]
fn wrong_settings_of_hobbing_machines_are_told() {
    let out = folder("wrong_settings");
    let out = out.to_str().expect("a plain path");
    for (spec, set, code, told) in [
        ("worm_wheel", "h.left_hand=1", 1, "the hob is of the other hand than the one that the machine turns for"),
        ("crowned_gear", "m.left_hand=1", 1, "the hob is of the other hand than the one that the machine turns for"),
        (
            "beveloid",
            "m.swivel=40 deg",
            1,
            "with this swivel the hob's thread lies across the teeth and mills them away",
        ),
        ("worm_wheel", "starts=6", 1, "plunged radially, a hob of so many starts cuts the ends of the flanks away"),
        ("beveloid", "m.swivel=50 deg", 1, "`swivel` is 50 deg, outside its range -45 deg .. 45 deg"),
        ("crowned_gear", "h.starts=12", 1, "each thread of a hob cuts with several teeth: more gashes than starts"),
        ("crowned_gear", "h.addendum=9 mm", 1, "the hob's teeth are pointed below their tip"),
        ("worm_wheel_tangential", "face_width=40 mm", 3, "infeed outside its range, by up to 11.9"),
        ("beveloid", "teeth=250", 3, "beyond its travel: axis m.X runs from 413.4"),
    ] {
        let file = format!("specs/hobbing/{spec}.chain");
        let run = flank(&["solve", &file, "--set", set, "--no-picture", "--out", out]);
        let said = text(&run.stderr) + &text(&run.stdout);
        assert_eq!(run.status.code(), Some(code), "{spec}, {set}: {said}");
        assert!(said.contains(told), "{spec}, {set}: {said}");
    }
}

/// Two surfaces that are both sampled by a coordinate of the spec's own are held against each other by it.
#[test]
fn a_worm_wheel_lies_off_the_conjugate_one() {
    let out = folder("worm_wheel");
    let surfaces = ["specs/hobbing/worm_wheel.chain", "upper.flank", "--from", "conjugate_upper.flank"];
    let rest = ["--no-picture", "--out", out.to_str().expect("a plain path")];
    let run = flank(&[&["deviation"], &surfaces[..], &rest].concat());
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{told}");
    assert!(told.contains("points       315 of 315") && told.contains("range        -36.448 .. 0.223 um"), "{told}");
}
