//! `flank sweep`: the rows of a study, how it survives being killed, and what it refuses.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use support::{flank, self_contained, text, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const PAIR: &str = "specs/pairs/bevel_19x62.chain";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn study(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

/// What `flank sweep gather` prints, as rows of cells.
fn rows(study: &str) -> Vec<Vec<String>> {
    let run = flank(&["sweep", "gather", study]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let out = text(&run.stdout);
    out.lines().skip(1).map(|line| line.split(',').map(str::to_string).collect()).collect()
}

fn gathered(study: &str) -> String {
    text(&flank(&["sweep", "gather", study]).stdout).to_string()
}

#[test]
fn rows_are_the_same_on_any_number_of_threads_and_anywhere() {
    let folder = folder();
    let [a, b] = ["a", "b"].map(|name| study(&folder, name));
    let asked = |out: &str, threads: &str| {
        let run = flank(&[
            "sweep",
            PINION,
            "--scatter",
            "m.radial_distance=normal(10um)",
            "--scatter",
            "blade_angle=uniform(1arcmin)",
            "--count",
            "20",
            "--seed",
            "7",
            "--collect",
            "ease_off:concave,points",
            "--out",
            out,
            "--threads",
            threads,
        ]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        assert!(text(&run.stdout).contains("20 cases"), "{}", text(&run.stdout));
    };
    asked(&a, "2");
    asked(&b, "1");
    assert_eq!(gathered(&a), gathered(&b));
    // a study is moved, and still whole
    let moved = study(&folder, "moved");
    std::fs::rename(&b, &moved).expect("the same disk");
    let run = flank(&["sweep", "run", &moved]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(gathered(&a), gathered(&moved));
}

/// A case says what `flank deviation` says of the job with the same values; the numbers of points are those of `flank solve`.
#[test]
fn a_row_says_what_other_commands_say() {
    let folder = folder();
    let (study, out) = (study(&folder, "a"), study(&folder, "out"));
    let text_of_both = self_contained(&[
        "functions/bevel",
        "functions/blanks_19x62",
        "machines/cradle",
        "tools/face_mill",
        "bevel/pinion_19x62",
    ]) + "job other = pinion_19x62(m.radial_distance: 97.9 mm)\n";
    let spec = written(folder.path(), "pinion.chain", &text_of_both);
    let values = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2", "--collect", "ease_off:concave,points"];
    let run = flank(&[&["sweep", &spec, "--job", "pinion_19x62", "--out", &study], &values[..]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let compared = ["deviation", &spec, "other.concave", "--reference", "pinion_19x62.concave"];
    let run = flank(&[&compared[..], &["--json", "--no-picture", "--out", &out]].concat());
    let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
    let row = &rows(&study)[0];
    let number = |k: usize| row[k].parse::<f64>().expect("a number");
    let slope = |k: usize| document["directions"][k]["slope_um"].as_f64().expect("a slope");
    let known =
        [slope(0), slope(1), document["bias_um"].as_f64().expect("a bias"), document["rms_um"].as_f64().expect("rms")];
    for (found, known) in [6, 7, 10, 11].map(number).into_iter().zip(known) {
        // both turn the surface until it meets the middle, to 1e-9 mm
        assert!((found - known).abs() < 1e-5, "{row:?}: {known}");
    }
    assert_eq!((number(15), row[3].as_str(), row[2].as_str()), (1395.0, "done", "97.9"));
}

#[test]
fn contacts_are_collected_with_mounting_errors() {
    let folder = folder();
    let study = study(&folder, "a");
    let table = folder.path().join("cases.csv");
    std::fs::write(&table, "m.E [um],m.S [arcmin]\n0,0\n20,1\n").expect("a file");
    let run = flank(&[
        "sweep",
        PAIR,
        "--cases",
        &table.display().to_string(),
        "--collect",
        "contact:drive_side",
        "--out",
        &study,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let rows = rows(&study);
    let asked = ["contact", PAIR, "drive_side", "--positions", "24", "--json", "--no-picture", "--out"];
    for (row, errors) in rows.iter().zip([&[][..], &["--error", "m.E=20um", "--error", "m.S=1arcmin"]]) {
        let out = folder.path().join("out").display().to_string();
        let run = flank(&[&asked[..], &[&out], errors].concat());
        let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
        let known = document["error"]["peak_to_peak"].as_f64().expect("an error");
        let found: f64 = row[7].parse().expect("a number");
        assert!((found - known).abs() < 1e-6, "{row:?}: {known}");
    }
}

/// Killed twenty times at times that do not depend on the work, the study has each case once and the bytes of an undisturbed one.
#[test]
fn a_study_survives_being_killed() {
    let folder = folder();
    let [whole, killed] = ["whole", "killed"].map(|name| study(&folder, name));
    let plan = |out: &str| {
        let run = flank(&[
            "sweep",
            "plan",
            PINION,
            "--scatter",
            "m.radial_distance=normal(10um)",
            "--count",
            "320",
            "--seed",
            "3",
            "--collect",
            "at:concave[7,15]",
            "--out",
            out,
        ]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    };
    plan(&whole);
    plan(&killed);
    assert_eq!(flank(&["sweep", "run", &whole]).status.code(), Some(0));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for k in 0..20_u64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_flank"))
            .args(["sweep", "run", &killed])
            .current_dir(&root)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program");
        std::thread::sleep(Duration::from_millis(20 + (k * 137) % 400));
        _ = child.kill();
        _ = child.wait();
    }
    assert_eq!(flank(&["sweep", "run", &killed]).status.code(), Some(0));
    assert!(gathered(&whole) == gathered(&killed), "the rows differ");
    assert_eq!(rows(&killed).len(), 320);
}

#[test]
fn what_a_case_lacks_is_a_verdict_and_can_be_tried_again() {
    let folder = folder();
    let [late, wrong] = ["late", "wrong"].map(|name| study(&folder, name));
    let run = flank(&[
        "sweep",
        PINION,
        "--vary",
        "m.radial_distance=97.9mm..98.1mm by 3",
        "--limit",
        "1e-9",
        "--collect",
        "points",
        "--out",
        &late,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(rows(&late).iter().all(|row| row[3] == "limit"), "{}", gathered(&late));
    assert_eq!(flank(&["sweep", "run", &late, "--again", "limit"]).status.code(), Some(0));
    // what the spec requires does not hold: the code says which error
    let table = written(folder.path(), "cases.csv", "eccentricity [mm]\n1\n6\n");
    let run = flank(&[
        "sweep",
        "specs/cycloidal/cycloidal_disc.chain",
        "--cases",
        &table,
        "--collect",
        "at:side[0,0]",
        "--out",
        &wrong,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let verdicts: Vec<[String; 2]> = rows(&wrong).into_iter().map(|row| [row[3].clone(), row[4].clone()]).collect();
    assert_eq!(verdicts, [["done", ""], ["spec wrong", "E0309"]]);
}

#[test]
fn the_whole_table_is_looked_at_before_anything_runs() {
    let folder = folder();
    let (study, table) = (study(&folder, "a"), folder.path().join("cases.csv"));
    let refused = [
        ("m.radial_distance\n98\n", "column `m.radial_distance` has no unit: write `m.radial_distance [mm]`"),
        ("m.radial_distance [deg]\n98\n", "`deg` is no unit of it; write `m.radial_distance [mm]`"),
        ("m.radial [mm]\n98\n", "has no parameter, setting or axis of a contact `m.radial`"),
        ("m.radial_distance [mm]\n98\nx\n50000\n1,2\n", "cases.csv:3: `x` is no number"),
        (
            "m.radial_distance [mm]\n98\nx\n50000\n1,2\n",
            "cases.csv:4: `m.radial_distance` is 50000 mm, outside its range",
        ),
        ("m.radial_distance [mm]\n98\nx\n50000\n1,2\n", "cases.csv:5: 2 values in 1 columns"),
        ("m.radial_distance [mm]\n", "the study has no case"),
    ];
    for (content, known) in refused {
        std::fs::write(&table, content).expect("a file");
        let run =
            flank(&["sweep", PINION, "--cases", &table.display().to_string(), "--collect", "points", "--out", &study]);
        assert_eq!(run.status.code(), Some(1), "{content}");
        assert!(text(&run.stderr).contains(known), "{}", text(&run.stderr));
        assert!(!Path::new(&study).exists(), "{content}");
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = folder();
    let study = study(&folder, "a");
    let vary = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2"];
    let refused: [(&[&str], i32, &str); 9] = [
        (&["--collect", "points"], 2, "say what differs from case to case"),
        (&["--vary", "m.radial_distance=97.9..98.1 by 2", "--collect", "points"], 1, "E0301"),
        (&["--vary", "m.radial_distance=97.9mm by 2", "--collect", "points"], 2, "write NAME=FROM..TO by COUNT"),
        (&[vary[0], vary[1], "--collect", "poinst"], 2, "write points, requirements, limits"),
        (&[vary[0], vary[1], "--collect", "ease_off:nosuch"], 1, "there is no surface `nosuch`"),
        (&[vary[0], vary[1], "--collect", "at:concave[99,0]"], 1, "has rows 0 to 14"),
        (&[vary[0], vary[1], "--collect", "contact:c"], 1, "has no contact `c`; there is: none"),
        (
            &["--scatter", "m.radial_distance=normal(1arcmin)", "--collect", "points"],
            1,
            "this takes a length above zero",
        ),
        (&["--scatter", "m.radial_distance=cauchy(1um)", "--collect", "points"], 2, "write NAME=normal(AMOUNT)"),
    ];
    for (arguments, code, known) in refused {
        let run = flank(&[&["sweep", PINION, "--out", &study], arguments].concat());
        assert_eq!(run.status.code(), Some(code), "{arguments:?}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains(known), "{arguments:?}: {}", text(&run.stderr));
    }
    let asked = |value: &str| {
        let vary = format!("m.radial_distance={value}");
        flank(&["sweep", "plan", PINION, "--vary", &vary, "--collect", "at:concave[0,0]", "--out", &study])
    };
    assert_eq!(asked("97.9mm..98.1mm by 2").status.code(), Some(0));
    // the same study again goes on, another one is refused
    assert_eq!(asked("97.9mm..98.1mm by 2").status.code(), Some(0));
    let other = asked("97.9mm..98.2mm by 2");
    assert_eq!(other.status.code(), Some(1));
    assert!(text(&other.stderr).contains("holds another study"), "{}", text(&other.stderr));
    let incomplete = flank(&["sweep", "gather", &study]);
    assert_eq!(incomplete.status.code(), Some(3));
    assert!(text(&incomplete.stderr).contains("1 of 1 chunk of"), "{}", text(&incomplete.stderr));
    // texts of another spec, a plan of another program
    let spec = Path::new(&study).join("spec/bevel/pinion_19x62.chain");
    let own = std::fs::read_to_string(&spec).expect("its text");
    std::fs::write(&spec, format!("{own}\n// changed\n")).expect("a file");
    let run = flank(&["sweep", "run", &study]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("are not those that the study was planned with"), "{}", text(&run.stderr));
    std::fs::write(&spec, own).expect("a file");
    let plan = Path::new(&study).join("plan.json");
    let changed = std::fs::read_to_string(&plan).expect("a plan").replace(env!("CARGO_PKG_VERSION"), "9.9.9");
    std::fs::write(&plan, changed).expect("a file");
    let run = flank(&["sweep", "run", &study]);
    assert!(text(&run.stderr).contains("was made by flank 9.9.9"), "{}", text(&run.stderr));
    let run = flank(&["sweep", "run", &folder.path().join("nothing").display().to_string()]);
    assert!(text(&run.stderr).contains("is no study"), "{}", text(&run.stderr));
}
