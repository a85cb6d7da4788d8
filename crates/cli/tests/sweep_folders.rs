//! `flank sweep`: folders of studies that were copied, interrupted, made by others, or in which nothing is done.

mod support;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use support::{flank, text};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const DISC: &str = "specs/cycloidal/cycloidal_disc.chain";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// A study that is planned, of so many cases.
fn planned(folder: &tempfile::TempDir, collect: &str, cases: &[&str]) -> String {
    let out = folder.path().join("study").display().to_string();
    let run = flank(&[&["sweep", "plan", PINION, "--collect", collect, "--out", &out], cases].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    out
}

const TWO: [&str; 2] = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2"];

fn only_chunk(study: &str) -> PathBuf {
    let mut files = std::fs::read_dir(Path::new(study).join("chunks")).expect("chunks");
    files.next().expect("a chunk").expect("a file").path()
}

/// Git keeps no empty folders.
#[test]
fn folders_that_a_copy_lost_are_made() {
    let folder = folder();
    let study = planned(&folder, "at:concave[0,0]", &TWO);
    for lost in ["open", "chunks"] {
        std::fs::remove_dir(Path::new(&study).join(lost)).expect("it is empty");
    }
    assert_eq!(flank(&["sweep", "status", &study]).status.code(), Some(0));
    let run = flank(&["sweep", "run", &study]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}

#[test]
fn the_plan_of_very_many_cases_is_there_at_once() {
    let folder = folder();
    let start = Instant::now();
    let cases = ["--scatter", "m.radial_distance=normal(10um)", "--count", "100000000"];
    let study = planned(&folder, "at:concave[0,0]", &cases);
    let run = flank(&["sweep", "status", &study]);
    assert!(text(&run.stdout).contains("100000000 cases in "), "{}", text(&run.stdout));
    assert!(start.elapsed() < Duration::from_secs(40), "{:?}", start.elapsed());
}

#[test]
fn a_study_in_which_nothing_is_done_says_so() {
    let folder = folder();
    let swept = |name: &str, table: &str| {
        let (cases, out) = (folder.path().join("cases.csv"), folder.path().join(name));
        std::fs::write(&cases, table).expect("a file");
        let [cases, out] = [cases, out].map(|path| path.display().to_string());
        (flank(&["sweep", DISC, "--cases", &cases, "--collect", "at:side[0,0]", "--out", &out]), out)
    };
    let (run, out) = swept("none", "eccentricity [mm]\n6\n6.1\n");
    for run in [run, flank(&["sweep", "status", &out]), flank(&["sweep", "gather", &out])] {
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(3), "{told}");
        assert!(told.contains("none of 2 cases is done\n  2 spec wrong, the first by E0309"), "{told}");
    }
    // that some fail is what studies are for
    assert_eq!(swept("some", "eccentricity [mm]\n1\n6\n").0.status.code(), Some(0));
}

/// Where each case takes far longer, it is said before, with the reason.
#[test]
fn what_is_compiled_for_each_case_is_told() {
    let folder = folder();
    let out = folder.path().join("study").display().to_string();
    let vary = ["--vary", "c.blade_angle=20deg..20.1deg by 2"];
    let spec = "specs/bevel/tilted_pinion.chain";
    let plan = flank(&[&["sweep", "plan", spec, "--collect", "points", "--out", &out], &vary[..]].concat());
    assert_eq!(plan.status.code(), Some(0), "{}", text(&plan.stderr));
    for run in [plan, flank(&["sweep", "run", &out])] {
        let told = text(&run.stderr);
        assert!(
            told.contains("is compiled from its text")
                && told.contains("`c.blade_angle` decides more than numbers in equations"),
            "{told}"
        );
    }
    let study = planned(&folder_of("once", &folder), "at:concave[0,0]", &TWO);
    assert!(!text(&flank(&["sweep", "run", &study]).stderr).contains("from its text"));
}

/// A folder of its own within another.
fn folder_of(name: &str, folder: &tempfile::TempDir) -> tempfile::TempDir {
    tempfile::Builder::new().prefix(name).tempdir_in(folder.path()).expect("a folder")
}

#[test]
fn rows_are_gathered_as_what_the_name_of_the_file_says() {
    let folder = folder();
    let study = planned(&folder, "at:concave[0,0]", &TWO);
    assert_eq!(flank(&["sweep", "run", &study]).status.code(), Some(0));
    let out = |name: &str| folder.path().join(name).display().to_string();
    let run = flank(&["sweep", "gather", &study, "--out", &out("rows.xlsx")]);
    assert_eq!(run.status.code(), Some(2));
    assert!(
        text(&run.stderr).contains("rows are not written as .xlsx, only as .csv or .parquet"),
        "{}",
        text(&run.stderr)
    );
    assert!(!Path::new(&out("rows.xlsx")).exists());
    for name in ["rows.csv", "rows.CSV", "rows", "rows.parquet"] {
        assert_eq!(flank(&["sweep", "gather", &study, "--out", &out(name)]).status.code(), Some(0), "{name}");
    }
}

/// A case is not to blame for who ends the program while it is worked on, however often.
#[test]
#[cfg(unix)]
fn interruptions_are_no_deaths() {
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};

    let folder = folder();
    let study = planned(&folder, "limits,points", &TWO);
    assert_eq!(flank(&["sweep", "run", &study]).status.code(), Some(0));
    let chunk = only_chunk(&study);
    let known = std::fs::read_to_string(&chunk).expect("rows");
    std::fs::remove_file(&chunk).expect("it is there");
    let journal = Path::new(&study).join("open").join(chunk.file_stem().expect("a hash"));
    // begun so often and never ended: the cases are gone through one by one
    std::fs::write(&journal, "begun\nbegun\nbegun\n").expect("a file");
    for (signal, number) in [("INT", 2), ("TERM", 15), ("INT", 2), ("INT", 2), ("TERM", 15), ("INT", 2)] {
        let before = std::fs::read_to_string(&journal).expect("a journal").len();
        let mut child = Command::new(env!("CARGO_BIN_EXE_flank"))
            .args(["sweep", "run", &study, "--threads", "1"])
            .current_dir(support::top())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program");
        let is_within = || std::fs::read_to_string(&journal).expect("a journal")[before..].contains("enter 0");
        while !is_within() {
            assert!(child.try_wait().expect("it runs").is_none(), "it ended before case 0");
            std::thread::sleep(Duration::from_millis(2));
        }
        let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
        assert!(sent.expect("kill").success());
        // as shells see it, it is the signal that ended it
        assert_eq!(child.wait().expect("it ended").signal(), Some(number));
        let told = std::fs::read_to_string(&journal).expect("a journal");
        assert!(told[before..].contains("stopped 0"), "{told}");
    }
    assert_eq!(flank(&["sweep", "run", &study]).status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(&chunk).expect("rows"), known);
}
