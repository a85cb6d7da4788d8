//! Files of one run are there together or not at all, whoever else writes into the folder and whatever ends the run.
#![cfg(unix)]

mod support;

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use support::{flank, folder, text, top};

const SPEC: &str = "specs/hobbing/spur_gear.chain";

/// A run with a file in the middle of its set that somebody else has to read: a pipe in the place of `spur_gear.csv`.
fn waiting(out: &Path) -> (Child, File) {
    let pipe = out.join("spur_gear.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    let run = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["solve", SPEC, "--format", "obj,csv,json", "--set", "face_width=21 mm", "--no-picture"])
        .args(["--out", out.to_str().expect("a plain path")])
        .current_dir(top())
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary runs");
    // opened when the other side is, which is after the first file
    let mut pipe = File::open(&pipe).expect("the test's pipe");
    pipe.read_exact(&mut [0; 10]).expect("the file is on its way");
    (run, pipe)
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// What a file says that it was made of.
fn hash(path: &Path) -> String {
    let text = String::from_utf8_lossy(&fs::read(path).expect("it is there")).into_owned();
    let from = text.find("sha256:").expect("a hash");
    text[from..from + 71].to_string()
}

#[test]
fn two_runs_do_not_mix_their_files() {
    let out = folder("together");
    let (mut run, mut pipe) = waiting(&out);
    let other =
        flank(&["solve", SPEC, "--format", "obj,json", "--no-picture", "--out", out.to_str().expect("a plain path")]);
    assert_eq!(other.status.code(), Some(0), "{}", text(&other.stderr));
    let [mesh, points] = ["spur_gear.obj", "spur_gear.json"].map(|name| out.join(name));
    let first = hash(&mesh);
    assert_eq!(first, hash(&points));
    let mut rest = String::new();
    pipe.read_to_string(&mut rest).expect("text");
    assert!(run.wait().expect("it ends").success());
    assert_ne!(first, hash(&mesh));
    assert_eq!(hash(&mesh), hash(&points));
    assert!(rest.contains(&hash(&mesh)), "the piped file is of the same run");
    assert_eq!(names_in(&out), ["spur_gear.csv", "spur_gear.json", "spur_gear.obj"]);
}

/// Many at once: in the end there are the files of one of them.
#[test]
fn of_many_runs_one_is_left() {
    let out = folder("together_many");
    let one = |k: u32| {
        Command::new(env!("CARGO_BIN_EXE_flank"))
            .args(["solve", SPEC, "--format", "csv,json,obj,vtp", "--set", &format!("face_width={} mm", 20 + k)])
            .args(["--threads", "1", "--no-picture", "--out", out.to_str().expect("a plain path")])
            .current_dir(top())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary runs")
    };
    let runs: Vec<Child> = (0..6).map(one).collect();
    for mut run in runs {
        assert!(run.wait().expect("it ends").success());
    }
    let names = names_in(&out);
    assert_eq!(names, ["csv", "json", "obj", "vtp"].map(|extension| format!("spur_gear.{extension}")));
    let hashes: Vec<String> = names.iter().map(|name| hash(&out.join(name))).collect();
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:?}");
}

#[test]
fn a_killed_run_leaves_what_was_there() {
    let out = folder("together_killed");
    let at = out.to_str().expect("a plain path");
    let arguments = ["solve", SPEC, "--format", "obj,json", "--no-picture", "--out", at];
    assert_eq!(flank(&arguments).status.code(), Some(0));
    let [mesh, points] = ["spur_gear.obj", "spur_gear.json"].map(|name| out.join(name));
    let before = [&mesh, &points].map(|path| fs::read(path).expect("it is there"));
    let (mut run, _pipe) = waiting(&out);
    run.kill().expect("it runs");
    run.wait().expect("it ends");
    assert_eq!([&mesh, &points].map(|path| fs::read(path).expect("it is there")), before);
    if cfg!(target_os = "linux") {
        assert_eq!(names_in(&out), ["spur_gear.csv", "spur_gear.json", "spur_gear.obj"]);
    }
    // killed in the one moment in which a file that replaces another one has a hidden name: the next run removes it
    fs::write(out.join(".flank-4711-0.whole"), "").expect("the test's file");
    assert_eq!(flank(&arguments).status.code(), Some(0));
    assert!(!out.join(".flank-4711-0.whole").exists());
}

/// A run that fails half-way leaves the whole set as it was, not only the file at which it failed.
#[cfg(target_os = "linux")]
#[test]
fn a_file_without_room_leaves_all_as_they_were() {
    let out = folder("together_full");
    std::os::unix::fs::symlink("/dev/full", out.join("spur_gear.json")).expect("links can be made");
    let run =
        flank(&["solve", SPEC, "--format", "csv,json", "--no-picture", "--out", out.to_str().expect("a plain path")]);
    assert_eq!(run.status.code(), Some(1));
    assert_eq!(names_in(&out), ["spur_gear.json"]);
}

/// Whoever holds the folder's lock for long, as `flock` does for a whole command, does not keep the program from its work.
#[test]
fn a_folder_that_is_locked_is_written_to_all_the_same() {
    let out = folder("together_locked");
    let held = File::open(&out).expect("the test's folder");
    held.lock().expect("folders can be locked");
    let run = flank(&["solve", SPEC, "--no-picture", "--out", out.to_str().expect("a plain path")]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(names_in(&out), ["spur_gear.csv"]);
}
