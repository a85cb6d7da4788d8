//! `flank new` as a user runs it.

mod support;

use std::io::Write;
use std::process::{Command, Stdio};

use support::{flank, folder, text, top};

/// The names of all jobs in the files below a folder.
fn jobs_in(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the library").map(|entry| entry.expect("an entry").path());
    let of = |path: std::path::PathBuf| {
        if path.is_dir() {
            return jobs_in(&path);
        }
        let text = std::fs::read_to_string(path).expect("a spec");
        let names = text.lines().filter_map(|line| line.strip_prefix("job ")?.split_whitespace().next());
        names.map(String::from).collect()
    };
    entries.flat_map(of).collect()
}

#[test]
fn every_job_of_the_library_can_be_started_from() {
    let listed = text(&flank(&["new"]).stdout);
    let (offered, others) = listed.split_once("\n\n").expect("several lists");
    let (others, parts) = others.split_once("\n\n").expect("several lists");
    assert!(parts.contains("  hobbing_6axis ") && parts.contains("  hob_zi "), "{parts}");
    let names: Vec<&str> = offered.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    // every job of the library is in one of them
    let together: Vec<&str> =
        others.lines().skip(1).filter_map(|line| line.split_once(": ")).map(|(_, jobs)| jobs).collect();
    let together: Vec<&str> = together.iter().flat_map(|jobs| jobs.split(", ")).collect();
    let mut known: Vec<&str> = names.iter().chain(&together).copied().collect();
    known.sort_unstable();
    let mut jobs = jobs_in(&top().join("specs"));
    jobs.sort_unstable();
    assert_eq!(known, jobs);
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

/// As on every other command, of several values for one parameter the last one counts.
#[test]
fn given_values_are_laid_out() {
    let out = folder("laid_out");
    let path = out.to_str().expect("a plain path");
    let set = ["--set", "normal_module=3.06mm", "--set", "teeth=36+1", "--out", path];
    assert!(flank(&[&["new", "helical_gear"][..], &set].concat()).status.success());
    let file = out.join("hobbing/helical_gear.chain");
    assert!(std::fs::read_to_string(&file).expect("written").contains("= 3.06 mm"));
    let run = flank(&["fmt", "--check", file.to_str().expect("a plain path")]);
    assert!(run.status.success(), "{}", text(&run.stdout));
}

#[test]
fn of_values_for_one_parameter_the_last_counts() {
    let out = folder("new-last");
    let set = ["--set", "teeth=100", "--set", "helix_angle=15 deg", "--set", "teeth=37"];
    let run = flank(&[&["new", "helical_gear", "--out", out.to_str().unwrap()], &set[..]].concat());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let made = std::fs::read_to_string(out.join("hobbing/helical_gear.chain")).expect("written");
    assert!(made.contains("= 37\n") && made.contains("= 15 deg\n"), "{made}");
    assert!(!made.contains("100\n") && !made.contains("370"), "{made}");
}

/// What is no text, or cannot be read, is not taken for absent.
#[test]
fn what_stands_there_stays_whatever_it_is() {
    let out = folder("new-there");
    std::fs::create_dir_all(out.join("hobbing")).unwrap();
    let file = out.join("hobbing/helical_gear.chain");
    let told = |wanted: &str| {
        let run = flank(&["new", "helical_gear", "--out", out.to_str().unwrap()]);
        assert_eq!(run.status.code(), Some(1), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains(wanted), "{}", text(&run.stderr));
    };
    std::fs::write(&file, b"Z\xe4hne").unwrap();
    told("is there already and says something else");
    assert_eq!(std::fs::read(&file).unwrap(), b"Z\xe4hne");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1, "nothing else is written either");
    // a folder by that name cannot be read as a file
    std::fs::remove_file(&file).unwrap();
    std::fs::create_dir(&file).unwrap();
    told("is there already and cannot be read");
}

#[test]
fn questions_are_answered_line_by_line() {
    let out = folder("new-ask");
    let mut run = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["new", "helical_gear", "--interactive", "--set", "normal_module=2 mm", "--out"])
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
    assert!(wrong(&["helical_gaer"], 2).contains("did you mean `helical_gear`?"));
    let beside = wrong(&["conjugate"], 2);
    assert!(
        beside.contains("together with pinion, basic in specs/bevel/ease_off_19x62.chain: copy that file"),
        "{beside}"
    );
    assert!(wrong(&["conjugat"], 2).contains("did you mean `conjugate`?"));
    assert!(wrong(&["xyz"], 2).contains("the library has no job, machine or tool `xyz`; `flank new` lists them"));
    assert!(
        wrong(&["helical_gear", "--set", "tooth=3"], 1).contains("has no parameter `tooth`; it has: `normal_module`")
    );
    assert!(wrong(&["helical_gear", "--set", "teeth=3 mm"], 1).contains("E0"), "the value is checked as in a file");
    assert!(wrong(&["helical_gear", "--set", "teeth=}"], 1).contains("error"));
    assert!(wrong(&["helical_gear", "--name", "my gear"], 2).contains("a letter first"));
    assert!(wrong(&["helical_gear", "--name", "job"], 2).contains("this is a word of the language"));
    for flag in [&["--name", "mine"][..], &["--set", "teeth=3"], &["--interactive"]] {
        assert!(wrong(flag, 2).contains("<TEMPLATE>"), "{flag:?} without a job to start from");
    }
}

/// Every machine and tool as it is, and a variant of a machine, which compiles.
#[test]
fn machines_and_tools_are_taken_too() {
    let listed = text(&flank(&["new"]).stdout);
    let parts = listed.split("\n\n").skip(2).flat_map(|list| list.lines().skip(1));
    let names: Vec<&str> = parts.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.len() > 40, "{names:?}");
    let out = folder("new-parts");
    let path = out.to_str().expect("a plain path");
    for name in names {
        let run = flank(&["new", name, "--out", path]);
        assert!(run.status.success(), "{name}: {}", text(&run.stderr));
        let told = text(&run.stdout);
        assert!(told.contains(&format!("{name}(…) in a job that uses ")), "{told}");
    }
    let run = flank(&["new", "hobbing_6axis", "--name", "my_machine", "--out", path, "--json"]);
    let made: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    assert_eq!([&made["name"], &made["kind"]], ["my_machine", "machine"]);
    let file = out.join("machines/my_machine.chain");
    assert!(std::fs::read_to_string(&file).expect("written").contains("machine my_machine extends hobbing_6axis {}"));
    for command in [&["check"][..], &["fmt", "--check"]] {
        let run = flank(&[command, &[file.to_str().expect("a plain path")]].concat());
        assert!(run.status.success(), "{}", text(&run.stderr));
    }
    let refused = |arguments: &[&str]| {
        let run = flank(&[&["new", "--out", path][..], arguments].concat());
        assert_ne!(run.status.code(), Some(0));
        text(&run.stderr)
    };
    assert!(refused(&["hob_zi", "--name", "mine"]).contains("a tool, which no other one extends"));
    assert!(refused(&["hob_zi", "--set", "starts=2"]).contains("gets its values in a job"));
    assert!(refused(&["cradle_tilt", "--name", "cradle_tilt"]).contains("the library's own file"));
    assert!(refused(&["cradle_generator", "--name", "cradle_generator_mirrored"]).contains("--> --name:1:1"));
    assert!(refused(&["hobing_6axis"]).contains("did you mean `hobbing_6axis`?"));
}

/// What is wrong with a value or a name is shown where it was given, and nothing of it in a folder that is gone.
#[test]
fn errors_are_shown_where_they_were_given() {
    let out = folder("new-places");
    let path = out.to_str().expect("a plain path");
    for (given, place) in [
        (["--set", "teeth=3 mm"], "--> --set:1:7"),
        (["--set", "teeth=3 +"], "--> --set:1:9"),
        (["--set", "teeth=2"], "--> --set:1:7"),
        (["--name", "hob_zi"], "--> --name:1:1"),
    ] {
        let run = flank(&[&["new", "helical_gear", "--out", path][..], &given].concat());
        assert_eq!(run.status.code(), Some(1), "{given:?}");
        let told = text(&run.stderr);
        assert!(told.contains(place) && !told.contains(".tmp"), "{given:?}: {told}");
    }
    let run = flank(&["new", "helical_gear", "--out", path, "--set", "teeth=2"]);
    assert!(text(&run.stderr).contains(&format!("{path}/hobbing/helical_gear.chain:")), "{}", text(&run.stderr));
}

/// A folder of its own is a project: its files are found from wherever the program is called.
#[test]
fn a_new_project_works_from_inside() {
    let out = tempfile::tempdir().expect("a folder that is in no project");
    let run = flank(&["new", "helical_gear", "--out", out.path().to_str().expect("a plain path")]);
    assert!(text(&run.stdout).contains("flank.toml"), "{}", text(&run.stdout));
    let check = || {
        let mut run = Command::new(env!("CARGO_BIN_EXE_flank"));
        run.args(["check", "helical_gear.chain"]).current_dir(out.path().join("hobbing")).output().expect("it runs")
    };
    assert_eq!(check().status.code(), Some(0), "{}", text(&check().stderr));
    // a machine that the user has changed stays, and the way out is one
    let machine = out.path().join("machines/hobbing_6axis.chain");
    let mine = std::fs::read_to_string(&machine).expect("written") + "// mine\n";
    std::fs::write(&machine, &mine).expect("it can be");
    let again = flank(&["new", "helical_gear", "--name", "other", "--out", out.path().to_str().expect("a plain path")]);
    assert_eq!(again.status.code(), Some(1));
    let told = text(&again.stderr);
    assert!(told.contains("take another folder") && !told.contains("--name"), "{told}");
    assert_eq!(std::fs::read_to_string(&machine).expect("still there"), mine);
}
