//! Threads that are too many, or that the system does not let start: fewer, a note, and the same results.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use support::{folder, text, top};

const SPEC: &str = "specs/bevel/pinion_19x62.chain";

/// The points of a run with what is put before and behind the program's name.
fn solved(before: &[&str], variable: Option<&str>, more: &[&str], out: &Path) -> (Output, Vec<u8>) {
    let all: Vec<&str> = before.iter().copied().chain([env!("CARGO_BIN_EXE_flank")]).collect();
    let mut command = Command::new(all[0]);
    command.args(&all[1..]).args(["solve", SPEC, "--out", out.to_str().expect("a plain path")]).args(more);
    command.current_dir(top()).env_remove("RAYON_NUM_THREADS");
    if let Some(value) = variable {
        command.env("RAYON_NUM_THREADS", value);
    }
    let run = command.output().expect("the binary runs");
    assert_eq!(run.status.code(), Some(0), "{before:?} {variable:?} {more:?}: {}", text(&run.stderr));
    let points = std::fs::read(out.join("pinion_19x62.csv")).expect("the points");
    (run, points)
}

#[test]
fn as_many_as_are_asked_for_but_not_more_than_work() {
    let out = folder("threads");
    let (run, expected) = solved(&[], None, &[], &out);
    assert!(!text(&run.stderr).contains("thread"), "{}", text(&run.stderr));
    let most = 4 * std::thread::available_parallelism().map_or(1, |count| count.get());
    let too_many = |asked: &str| {
        format!("note: {most} threads work instead of {asked}: more than 4 for each processor bring nothing\n")
    };
    let no_number =
        "note: RAYON_NUM_THREADS is `two`, which is no number of threads: there is one for each processor\n";
    let cases: [(Option<&str>, &[&str], String); 8] = [
        (None, &["--threads", "1"], String::new()),
        (None, &["--threads", "3"], String::new()),
        (Some("1"), &[], String::new()),
        (Some("0"), &[], String::new()),
        (Some("100000"), &[], too_many("100000")),
        (Some("1"), &["--threads", "5000"], too_many("5000")),
        (Some("two"), &[], no_number.to_string()),
        (Some("two"), &["--threads", "2"], String::new()),
    ];
    for (variable, more, note) in cases {
        let (run, points) = solved(&[], variable, more, &out);
        let told = text(&run.stderr);
        assert!(told.starts_with(&note) && told.contains("thread") != note.is_empty(), "{variable:?} {more:?}: {told}");
        assert!(points == expected, "{variable:?} {more:?}");
    }
}

/// A limit on processes, as containers have it. It does not bind the system's owner, who becomes somebody else here.
#[cfg(target_os = "linux")]
#[test]
fn fewer_where_the_system_lets_no_more_start() {
    use std::os::unix::fs::PermissionsExt;
    const NOBODY: &[&str] = &["setpriv", "--reuid", "54321", "--clear-groups"];
    let is_there =
        |program: &str| Command::new(program).arg("--version").output().is_ok_and(|run| run.status.success());
    let user = Command::new("id").arg("-u").output().map(|run| text(&run.stdout)).unwrap_or_default();
    let nobody = if user.trim() == "0" { NOBODY } else { &[] };
    let reads = [nobody, &["test", "-x", env!("CARGO_BIN_EXE_flank")]].concat();
    let can_read = Command::new(reads[0]).args(&reads[1..]).status().is_ok_and(|status| status.success());
    if !is_there("prlimit") || !can_read {
        eprintln!("skipped 1 test: prlimit or setpriv is not installed, or nobody else may read the program");
        return;
    }
    let out = folder("few_threads");
    let (_, expected) = solved(&[], None, &[], &out);
    std::fs::set_permissions(&out, std::fs::Permissions::from_mode(0o777)).expect("it is the test's own");
    std::fs::remove_file(out.join("pinion_19x62.csv")).expect("it is the test's own");
    for processes in 1..=3 {
        let limit = format!("--nproc={processes}");
        let before = [&["prlimit", &limit], nobody].concat();
        let (run, points) = solved(&before, None, &["--threads", "4", "--no-picture"], &out);
        let told = text(&run.stderr);
        assert!(
            told.starts_with("note: ") && told.contains(" instead of 4: the system lets no more start\n"),
            "{told}"
        );
        assert!(points == expected, "{processes} processes");
    }
}
