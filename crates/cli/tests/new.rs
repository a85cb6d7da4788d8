//! `flank new` as a user runs it.

mod support;

use std::io::Write;
use std::process::{Command, Stdio};

use support::{flank, folder, text, top};

#[test]
fn every_job_of_the_library_can_be_started_from() {
    let listed = text(&flank(&["new"]).stdout);
    let names: Vec<&str> = listed.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.len() > 25 && names.contains(&"helical_gear") && names.contains(&"pinion_19x62"), "{listed}");
    let out = folder("new-all");
    let path = out.to_str().expect("a plain path");
    for name in names {
        let run = flank(&["new", name, "--out", path]);
        assert!(run.status.success(), "{name}: {}", text(&run.stderr));
        let told = text(&run.stdout);
        let file = told.split("flank solve ").nth(1).expect("what to do next").trim();
        assert!(flank(&["check", file]).status.success(), "{name}: {file}");
    }
}

#[test]
fn a_new_job_has_its_name_and_values() {
    let out = folder("new");
    let path = out.to_str().expect("a plain path");
    let set = ["--name", "my_gear", "--set", "teeth=37", "--set", "helix_angle=15 deg", "--out", path];
    let run = flank(&[&["new", "helical_gear"][..], &set].concat());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let made = std::fs::read_to_string(out.join("hobbing/my_gear.chain")).expect("written");
    assert!(made.contains("job my_gear {") && made.contains("= 37\n") && made.contains("= 15 deg\n"), "{made}");
    let of_new = flank(&[
        "solve",
        out.join("hobbing/my_gear.chain").to_str().expect("plain"),
        "--json",
        "--no-picture",
        "--out",
        path,
    ]);
    let of_old = ["solve", "specs/hobbing/helical_gear.chain", "--set", "teeth=37", "--set", "helix_angle=15 deg"];
    let of_old = flank(&[&of_old[..], &["--json", "--no-picture", "--out", path]].concat());
    assert!(of_new.status.success() && of_old.status.success());
    let rows = |name: &str| -> Vec<String> {
        let file = std::fs::read_to_string(out.join(name)).expect("written");
        file.lines().filter(|line| !line.starts_with('#')).map(String::from).collect()
    };
    assert_eq!(
        rows("my_gear.csv"),
        rows("helical_gear.csv"),
        "the surface is that of the library's job with these values"
    );
    // again is no fault, but what stands there is not changed
    assert!(flank(&[&["new", "helical_gear"][..], &set].concat()).status.success());
    let run = flank(&["new", "helical_gear", "--name", "my_gear", "--out", path]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("is there already and says something else"), "{}", text(&run.stderr));
    assert_eq!(std::fs::read_to_string(out.join("hobbing/my_gear.chain")).expect("still there"), made);
}

#[test]
fn questions_are_answered_line_by_line() {
    let out = folder("new-ask");
    let mut run = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["new", "helical_gear", "--ask", "--set", "normal_module=2 mm", "--out"])
        .arg(&out)
        .current_dir(top())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    // the pressure angle stays, 41 teeth, the rest stays
    run.stdin.take().expect("a pipe").write_all(b"\n41\n").expect("it reads");
    let run = run.wait_with_output().expect("it ends");
    assert!(run.status.success(), "{}", text(&run.stderr));
    let asked = text(&run.stderr);
    assert!(asked.contains("teeth [31]: ") || asked.contains(" [31]: "), "{asked}");
    assert!(!asked.contains("normal_module"), "what is set is not asked: {asked}");
    let made = std::fs::read_to_string(out.join("hobbing/helical_gear.chain")).expect("written");
    assert!(made.contains("= 2 mm\n") && made.contains("= 41\n") && made.contains("= 20 deg\n"), "{made}");
}

#[test]
fn what_cannot_be_made_is_told_and_writes_nothing() {
    let out = folder("new-wrong");
    let path = out.to_str().expect("a plain path");
    let wrong = |arguments: &[&str], code: i32| {
        let run = flank(&[&["new"][..], arguments, &["--out", path]].concat());
        assert_eq!(run.status.code(), Some(code), "{}", text(&run.stderr));
        assert_eq!(std::fs::read_dir(&out).expect("the folder").count(), 0);
        text(&run.stderr)
    };
    assert!(wrong(&["helical_gaer"], 1).contains("did you mean `helical_gear`?"));
    assert!(
        wrong(&["helical_gear", "--set", "tooth=3"], 1).contains("has no parameter `tooth`; it has: `normal_module`")
    );
    assert!(wrong(&["helical_gear", "--set", "teeth=3 mm"], 1).contains("E0"), "the value is checked as in a file");
    assert!(wrong(&["helical_gear", "--set", "teeth=}"], 1).contains("error"));
    assert!(wrong(&["helical_gear", "--name", "my gear"], 2).contains("a letter first"));
}
