//! `flank sweep`: studies in parts, with damaged chunks, killed, and on a full disk.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use support::studies::{folder, gathered, rows, study};
use support::{flank, text};

const PINION: &str = "specs/bevel/pinion_19x62.chain";

/// Parts of any number hold each chunk once; the result of a part is that of its chunks.
#[test]
fn chunks_are_shared_out_in_parts() {
    let folder = folder();
    let [whole, parts] = ["whole", "parts"].map(|name| study(&folder, name));
    let cases = ["--vary", "m.radial_distance=97.9mm..98.1mm by 70", "--collect", "at:concave[7,15]"];
    for out in [&whole, &parts] {
        let run = flank(&[&["sweep", "plan", PINION, "--out", out], &cases[..]].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let plan = Path::new(out).join("plan.json");
        let mut document: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(&plan).expect("a plan")).expect("a plan");
        document["chunk"] = 10.into();
        std::fs::write(plan, document.to_string()).expect("a file");
    }
    assert_eq!(flank(&["sweep", "run", &whole]).status.code(), Some(0));
    let done: Vec<u64> = (0..3)
        .map(|part| {
            let run = flank(&["sweep", "run", &parts, "--part", &format!("{part}/3"), "--json"]);
            assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
            let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
            let (done, rows) = (document["done"].as_u64(), document["verdicts"]["done"].as_u64());
            assert_eq!(rows, done.map(|done| 10 * done));
            done.expect("a number")
        })
        .collect();
    assert_eq!(done, [2, 2, 3]);
    assert_eq!(gathered(&whole), gathered(&parts));
    // the same in files, of CSV and of Parquet
    let [csv, parquet] = ["rows.csv", "rows.parquet"].map(|name| study(&folder, name));
    for out in [&csv, &parquet] {
        assert_eq!(flank(&["sweep", "gather", &parts, "--out", out]).status.code(), Some(0));
    }
    assert_eq!(std::fs::read_to_string(csv).expect("rows"), gathered(&whole));
    // what the study is made of is not written over
    for own in ["plan.json", "log", "chunks/rows.csv"] {
        let own = format!("{parts}/{own}");
        let before = std::fs::read(&own).ok();
        let run = flank(&["sweep", "gather", &parts, "--out", &own]);
        assert!(run.status.code() == Some(1) && text(&run.stderr).contains("belongs to the study"), "{own}");
        assert_eq!(std::fs::read(&own).ok(), before, "{own}");
    }
    let bytes = std::fs::read(parquet).expect("rows");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    // the times of all chunks, which rows do not have
    let log = std::fs::read_to_string(Path::new(&parts).join("log")).expect("a log");
    let chunks: Vec<serde_json::Value> = log.lines().map(|line| serde_json::from_str(line).expect("a line")).collect();
    assert!(chunks.len() == 7 && chunks.iter().all(|of| of["cases"] == 10 && of["seconds"].as_f64() > Some(0.0)));
    for wrong in ["3/3", "1", "a/2"] {
        let run = flank(&["sweep", "run", &parts, "--part", wrong]);
        assert_eq!(run.status.code(), Some(2), "{}", text(&run.stderr));
    }
}

/// A chunk that lost rows, has the row of another case, a word that is no verdict or a number that is none does not count, and is told; a run
/// computes it anew. One that is not there at all is another matter.
#[test]
fn a_damaged_chunk_does_not_count_and_is_computed_anew() {
    let folder = folder();
    let out = study(&folder, "a");
    let run = flank(&[
        "sweep",
        PINION,
        "--vary",
        "m.radial_distance=97.9mm..98.1mm by 60",
        "--collect",
        "at:concave[7,15]",
        "--out",
        &out,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let whole = gathered(&out);
    let chunks = Path::new(&out).join("chunks");
    let chunk = std::fs::read_dir(&chunks).expect("chunks").next().expect("a chunk").expect("a chunk").path();
    let kept = std::fs::read_to_string(&chunk).expect("rows");
    let damages: [(&str, String); 7] = [
        ("cut off between rows", kept.lines().take(20).map(|line| format!("{line}\n")).collect()),
        ("cut off in a row", kept[..kept.len() - 9].to_string()),
        ("emptied", String::new()),
        ("no verdict", kept.replacen(",done,", ",dune,", 1)),
        ("no number", kept.replacen(",97.9,", ",97x9,", 1)),
        ("another case", kept.replacen("\n", "\n0", 1)),
        ("a row twice", kept.clone() + kept.lines().last().expect("a row") + "\n"),
    ];
    let asked = |arguments: &[&str]| {
        let run = flank(&[&["sweep"], arguments].concat());
        (run.status.code(), text(&run.stdout), text(&run.stderr))
    };
    for (what, damaged) in damages {
        assert_ne!(damaged, kept, "{what}");
        std::fs::write(&chunk, damaged).expect("a file");
        let (code, json, told) = asked(&["status", &out, "--json"]);
        let document: serde_json::Value = serde_json::from_str(&json).expect("a document");
        assert_eq!((code, &document["done"]), (Some(3), &0.into()), "{what}: {told}");
        assert_eq!(document["damaged"].as_array().map(Vec::len), Some(1), "{what}: {document}");
        assert_eq!(document["verdicts"], serde_json::json!({}), "{what}");
        assert!(
            document["not_done"][0]["message"].as_str().is_some_and(|of| of.starts_with("not counted: 1 of 1 chunk")),
            "{document}"
        );
        let (code, rows, told) = asked(&["gather", &out]);
        assert_eq!((code, rows.lines().count()), (Some(3), 1), "{what}");
        assert!(told.contains("not counted: 1 of 1 chunk of") && !told.contains("not computed"), "{what}: {told}");
        assert_eq!(asked(&["run", &out]).0, Some(0), "{what}");
        assert_eq!(gathered(&out), whole, "{what}");
    }
    std::fs::remove_file(&chunk).expect("it was there");
    assert_eq!(asked(&["status", &out]).0, Some(0));
    let (code, _, told) = asked(&["gather", &out]);
    assert!(code == Some(3) && told.contains("1 of 1 chunk") && told.contains("not computed"), "{told}");
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

/// A disk of so many bytes at a folder; nothing where it cannot be mounted.
#[cfg(target_os = "linux")]
struct Disk(std::path::PathBuf);

#[cfg(target_os = "linux")]
impl Disk {
    fn new(at: std::path::PathBuf, size: &str) -> Option<Disk> {
        std::fs::create_dir_all(&at).expect("a folder");
        let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", size, "none"]).arg(&at).output();
        mounted.is_ok_and(|run| run.status.success()).then_some(Disk(at))
    }

    fn resize(&self, size: &str) {
        let run = Command::new("mount").args(["-o", &format!("remount,{size}")]).arg(&self.0).status();
        assert!(run.expect("it was mounted").success());
    }
}

#[cfg(target_os = "linux")]
impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// What fits stays whole, what does not is told, and the study goes on once there is room.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_loses_no_case() {
    let folder = folder();
    let Some(disk) = Disk::new(folder.path().join("disk"), "size=1m") else {
        eprintln!("skipped 1 test: no disk can be mounted, which takes root");
        return;
    };
    let (full, whole) = (disk.0.join("a").display().to_string(), study(&folder, "whole"));
    let swept = |out: &str| {
        let vary = ["--vary", "m.radial_distance=97.9mm..98.1mm by 8"];
        flank(&[&["sweep", PINION, "--collect", "points", "--keep", "points", "--out", out], &vary[..]].concat())
    };
    let run = swept(&full);
    assert_eq!(run.status.code(), Some(1), "{}{}", text(&run.stdout), text(&run.stderr));
    assert!(text(&run.stderr).contains("the disk is full"), "{}", text(&run.stderr));
    disk.resize("size=32m");
    let run = flank(&["sweep", "run", &full]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(swept(&whole).status.code(), Some(0));
    assert_eq!(gathered(&full), gathered(&whole));
    let kept = |study: &str| -> std::collections::BTreeMap<std::ffi::OsString, Vec<u8>> {
        let files = std::fs::read_dir(Path::new(study).join("points")).expect("points");
        files
            .map(|file| file.expect("a file"))
            .map(|file| (file.file_name(), std::fs::read(file.path()).expect("its bytes")))
            .collect()
    };
    assert!(kept(&full) == kept(&whole) && kept(&full).len() == 8, "{:?}", kept(&full).keys());
}
