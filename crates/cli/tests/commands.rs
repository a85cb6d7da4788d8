//! The other commands as a user runs them: output, exit codes.

mod support;

use support::{flank, folder, text, top, written};

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
    let entries = |folder: &str| {
        let entries = std::fs::read_dir(top().join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.map(|name| format!("{folder}/{name}")).collect::<Vec<_>>()
    };
    let files: Vec<String> = entries("specs").iter().flat_map(|folder| entries(folder)).collect();
    let files: Vec<String> = files.into_iter().filter(|file| file.ends_with(".chain")).collect();
    assert!(files.len() >= 90, "{}", files.len());
    let arguments: Vec<&str> = std::iter::once("check").chain(files.iter().map(String::as_str)).collect();
    let run = flank(&arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(run.stderr.is_empty(), "{}", text(&run.stderr));
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
    assert_eq!((concave["name"].as_str(), concave["equations"].as_u64()), (Some("concave"), Some(3)));
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
    assert!(told.ends_with("3 errors\nfor more about this error: `flank explain E0201`\n"), "{told}");
    assert_eq!(told.matches("flank explain").count(), 1);
    let right = text(&flank(&["check", "specs/machines/cradle.chain"]).stderr);
    assert!(!right.contains("flank explain"), "{right}");
}

/// Who keeps what is printed must not find half of it and think that all is well.
#[cfg(target_os = "linux")]
#[test]
fn output_that_finds_no_room_is_a_failure() {
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a disk that is always full");
    let spec = "specs/hobbing/spur_gear.chain";
    for arguments in [
        &["derive", spec, "--latex"][..],
        &["check", spec],
        &["schema"],
        &["explain"],
        &["fmt", "-"],
        &["completions", "bash"],
        &["--help"],
        &["solve", "--help"],
        &["--version"],
    ] {
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"))
            .args(arguments)
            .current_dir(top())
            .stdin(std::fs::File::open(top().join(spec)).expect("it is shipped"))
            .stdout(full())
            .output()
            .expect("the binary runs");
        assert_eq!(run.status.code(), Some(1), "{arguments:?}");
        assert_eq!(text(&run.stderr), "error: cannot write to stdout: the disk is full\n", "{arguments:?}");
    }
    // with nowhere to tell what is wrong the exit code still tells that something is
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"));
    let run = run.args(["check", "no_such_file.chain"]).stderr(full()).output().expect("the binary runs");
    assert_eq!(run.status.code(), Some(1));
}

/// A program without stdout has nobody who reads what it prints, which is told on stderr; nothing to print is no failure.
#[cfg(target_os = "linux")]
#[test]
fn a_closed_stdout_is_a_failure() {
    let spec = "specs/hobbing/spur_gear.chain";
    for arguments in [&["derive", spec][..], &["explain"], &["--help"], &["--version"], &["check", "--json", spec]] {
        let run = std::process::Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" >&-", env!("CARGO_BIN_EXE_flank")])
            .args(arguments)
            .current_dir(top())
            .output()
            .expect("a shell runs");
        assert_eq!(run.status.code(), Some(1), "{arguments:?}");
        assert_eq!(text(&run.stderr), "error: cannot write to stdout: it is closed\n", "{arguments:?}");
    }
    // what a caller throws away is not closed, however it opened it
    let null = std::fs::OpenOptions::new().read(true).write(true).open("/dev/null").expect("it is there");
    let run = std::process::Command::new(env!("CARGO_BIN_EXE_flank")).arg("explain").stdout(null).output();
    assert_eq!(run.expect("the binary runs").status.code(), Some(0));
}

/// A reader that goes away, as `head` does, has what it wants: nothing is said, the files are written all the same, and the exit code is
/// the one that shells give to a program that a broken pipe ends.
#[test]
fn a_reader_that_goes_away_ends_what_is_printed() {
    let folder = folder("unread");
    let out = folder.to_str().expect("a plain path");
    let spec = "specs/hobbing/spur_gear.chain";
    let wrong = written(&folder, "wrong.chain", "tool t {\n    param r : lenght\n}\n");
    for (arguments, code) in [
        (&["solve", spec, "--out", out, "--no-picture"][..], 141),
        (&["derive", spec], 141),
        (&["--help"], 141),
        (&["derive", "--json", &wrong], 1),
    ] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"));
        let run = run.args(arguments).current_dir(top()).stdout(writer).output().expect("the binary runs");
        assert_eq!(run.status.code(), Some(code), "{arguments:?}");
        assert!(!text(&run.stderr).contains("stdout"), "{arguments:?}: {}", text(&run.stderr));
    }
    assert!(folder.join("spur_gear.csv").exists());
}

/// A number that cannot be is answered with those that can.
#[test]
fn numbers_of_the_command_line_say_what_they_may_be() {
    let [spur, pinion] = ["specs/hobbing/spur_gear.chain", "specs/bevel/pinion_19x62.chain"];
    let convert = ["convert", pinion, "--to", "specs/machines/free_form.chain"];
    for (arguments, words) in [
        (&["solve", spur, "--step=0um"][..], "a length above zero is needed"),
        (&["solve", spur, "--step=-1um"], "a length above zero is needed"),
        (&["solve", spur, "--step=1"], "write a length with its unit"),
        (&[&convert[..], &["--tolerance", "0um"]].concat(), "a length above zero is needed"),
        (&[&convert[..], &["--positions", "1.5"]].concat(), "write a whole number from 1 to 1000000"),
        (&[&convert[..], &["--time", "-3"]].concat(), "write a number of seconds above zero"),
        (&["solve", spur, "--threads", "0"], "write a whole number from 1 on"),
        (&["view", pinion, "--threads", "many"], "write a whole number from 1 on"),
    ] {
        let run = flank(arguments);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        assert!(text(&run.stderr).contains(words), "{arguments:?}: {}", text(&run.stderr));
    }
}

#[test]
fn a_schema_is_found_with_or_without_its_prefix_and_version() {
    let whole = text(&flank(&["schema", "flank.solve/3"]).stdout);
    assert!(whole.contains("\"title\": \"flank.solve/3\""), "{whole}");
    for name in ["solve", "flank.solve", "solve/3"] {
        assert_eq!(text(&flank(&["schema", name]).stdout), whole, "{name}");
    }
}

/// 2 where the command line is wrong whatever the files say, 1 where what was read has not what is asked of it, for all commands.
#[test]
fn exit_codes_tell_the_command_line_from_what_it_names() {
    const SPUR: &str = "specs/hobbing/spur_gear.chain";
    const MACHINE: &str = "specs/machines/free_form.chain";
    let folder = folder("exit_codes");
    let rexs = written(&folder, "pinion.rexs", support::REXS);
    let wrong = written(&folder, "wrong.chain", "tool t {\n    param r : lenght\n}\n");
    let blocked = format!("{wrong}/here");
    // whether a folder is there does not make the command line right or wrong
    std::fs::create_dir(folder.join("gears.step")).expect("a folder for the test");
    let called_like_a_file = folder.join("gears.step").to_str().expect("a plain path").to_string();
    let usage: &[&[&str]] = &[
        &["sovle"],
        &["solve", SPUR, "--format", "docx"],
        &["solve", SPUR, "--out", "spur.csv"],
        &["check"],
        &["convert", SPUR],
        &["convert", SPUR, "--to", MACHINE, "--nc", "basic", "--time", "3"],
        &["derive", SPUR, "--cost", "--latex"],
        &["plot", SPUR, "--what", "nothing"],
        &["plot", SPUR, "--what", "deviation"],
        &["plot", SPUR, "--reference", "flank_plus"],
        &["plot", SPUR, "--surface", "flank_plus", "--reference", "flank_minus", "--what", "left"],
        &["report", SPUR, "--out", "spur.md", "--format", "html"],
        &["report", SPUR, "--out", "spur.csv"],
        &["report", "nosuch.chain", "--out", "spur.md", "--format", "html"],
        &["deviation", SPUR, "flank_plus"],
        &["fit", SPUR, "flank_plus"],
        &["tolerance", SPUR, "flank_plus", "--limits", "0"],
        &["deviation", "nosuch.chain", "flank_plus"],
        &["convert", "nosuch.chain", "--to", MACHINE, "--fit", "work_offset", "--tolerance", "1um"],
        &["solve", SPUR, "--out", &called_like_a_file],
        &["measure", SPUR, "--rows", "1"],
        &["explain", "E9999"],
        &["import", &rexs, "--signs", "mine", "--outside", "21"],
        &["import", &rexs, "--signs", "frames"],
        &["import", "nosuch.rexs", "--signs", "frames"],
        &["import", &rexs, "--signs", "frames", "--outside", "21", "--name", "job"],
        &["fmt"],
        &["view", SPUR, "--out", "spur.html"],
        &["new", "nosuch"],
        &["new", "spur_gear", "--name", "3d"],
        &["schema", "nosuch"],
        &["completions", "nosuch"],
        &["man", "--out", "flank.md"],
    ];
    let lacking: &[&[&str]] = &[
        &["solve", "nosuch.chain"],
        &["solve", SPUR, "--job", "nosuch"],
        &["solve", SPUR, "--out", &blocked],
        &["check", "nosuch.chain"],
        &["check", &wrong],
        &["convert", SPUR, "--to", "nosuch.chain"],
        &["convert", SPUR, "--to", MACHINE, "--surface", "nosuch"],
        &["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/cradle.chain", "--tolerance", "1um"],
        &["derive", SPUR, "--set", "nosuch=1"],
        &["plot", SPUR, "--surface", "nosuch"],
        &["plot", SPUR, "--what", "left"],
        &["report", &wrong],
        &["deviation", SPUR, "nosuch", "--reference", "flank_plus"],
        &["measure", SPUR, "--surface", "nosuch"],
        &["fit", SPUR, "nosuch", "--measured", "nosuch.csv"],
        &["tolerance", SPUR, "nosuch"],
        &["import", &rexs, "--signs", "frames", "--outside", "nosuch"],
        &["fmt", "nosuch.chain"],
        &["view", MACHINE],
        &["new", "spur_gear", "--set", "nosuch=1", "--out", folder.to_str().unwrap()],
        &["man", "--out", &blocked],
    ];
    for (code, commands) in [(2, usage), (1, lacking)] {
        for command in commands {
            let run = flank(command);
            assert_eq!(run.status.code(), Some(code), "{command:?}: {}", text(&run.stderr));
            let has_own_document = ["check", "fmt"].contains(&command[0]) && code == 1;
            let run = flank(&[command, &["--json"][..]].concat());
            assert_eq!(run.status.code(), Some(code), "{command:?} --json");
            let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("one document");
            assert!(has_own_document || told["exit_code"] == code, "{command:?}: {told}");
        }
    }
}

/// A folder that is called like a file is one where its name ends like that of a folder.
#[test]
fn a_folder_may_be_called_like_a_file() {
    let out = folder("exit_codes_folder").join("gears.step");
    let out = format!("{}/", out.to_str().expect("a plain path"));
    let run = flank(&["solve", "specs/tutorial/first_gear.chain", "--no-picture", "--out", &out]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(std::path::Path::new(&out).join("first_gear.csv").exists());
}

/// A spec may come from the standard input: it stands in the folder in which the program is called.
#[test]
fn a_spec_is_checked_from_the_standard_input() {
    let folder = folder("check_stdin");
    written(&folder, "flank.toml", "");
    written(&folder, "machine.chain", "machine plain {\n    frame bed\n}\n");
    let check = |spec: &str, arguments: &[&str]| {
        let input = written(&folder, "input", spec);
        let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"));
        let run =
            run.arg("check").args(arguments).current_dir(&folder).stdin(std::fs::File::open(input).expect("written"));
        let run = run.output().expect("the binary runs");
        (run.status.code(), text(&run.stdout), text(&run.stderr))
    };
    let right = "use \"machine.chain\"\nmachine more extends plain {\n    frame table in bed = translate_x(1 mm)\n}\n";
    assert_eq!(check(right, &["-"]), (Some(0), "-: ok\n".to_string(), String::new()));
    let (code, told, why) = check(&right.replace("1 mm", "1 deg"), &["-"]);
    assert!(code == Some(1) && told == "-: wrong\n" && why.contains("--> -:3:38"), "{told}{why}");
    let (code, told, _) = check(right, &["-", "machine.chain", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    assert!(code == Some(0) && told["files"][0]["file"] == "-" && told["files"][1]["ok"] == true, "{told}");
    let (code, _, why) = check(&right.replace("machine.chain", "../other.chain"), &["-"]);
    assert!(code == Some(1) && why.contains("E0003"), "{why}");
}

/// Which files a spec may use does not depend on where the program is called.
#[test]
fn a_project_is_found_from_its_spec() {
    let out = tempfile::tempdir().expect("a folder that is in no project");
    let folder = out.path().join("gears/spur/first");
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    written(&out.path().join("gears"), "machine.chain", "machine plain {\n    frame bed\n}\n");
    let spec = written(&folder, "spec.chain", "use \"../../machine.chain\"\n\nmachine more extends plain {}\n");
    let check = |from: &std::path::Path| {
        let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"));
        let run = run.args(["check", &spec]).current_dir(from).output().expect("the binary runs");
        (run.status.code(), text(&run.stderr).contains("E0003"))
    };
    let folders = [out.path(), &out.path().join("gears"), &folder, std::path::Path::new("/")];
    for from in folders {
        assert_eq!(check(from), (Some(1), true), "{}", from.display());
    }
    written(&out.path().join("gears"), "flank.toml", "");
    for from in folders {
        assert_eq!(check(from), (Some(0), false), "{}", from.display());
    }
}

/// A value from outside changes what its name says, and where that is more than one job, it is told.
#[test]
fn a_value_says_which_jobs_it_changes() {
    let out = folder("set_jobs");
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let (before, job) = spec.split_at(spec.find("job first_gear").expect("its job"));
    let (job, _) = job.split_once("\n}\n").expect("the job ends");
    let second = job.replacen("first_gear", "second_gear", 1);
    let spec = written(&out, "two.chain", &format!("{before}{job}\n}}\n\n{second}\n}}\n"));
    let solve = |more: &[&str]| {
        let run = flank(&[&["solve", &spec, "--no-picture", "--out", out.to_str().unwrap()], more].concat());
        let told = text(&run.stderr);
        let set = ["first_gear", "second_gear"].map(|name| {
            let table = std::fs::read_to_string(out.join(format!("{name}.csv"))).unwrap_or_default();
            let _ = std::fs::remove_file(out.join(format!("{name}.csv")));
            let mut lines = table.lines().filter_map(|line| line.strip_prefix("# set by hand: "));
            lines.next().unwrap_or_default().to_string()
        });
        (run.status.code(), set, told)
    };
    let value = "r.pressure_angle=21 deg";
    let text_of = |name: &str| format!("{name}r.pressure_angle = 21 deg");
    let (code, set, told) = solve(&["--set", value]);
    assert_eq!((code, set), (Some(0), [text_of(""), text_of("")]));
    assert!(told.contains("note: `--set r.pressure_angle` changes 2 jobs: first_gear, second_gear; `--set first_gear.r.pressure_angle=…`"), "{told}");
    let (code, set, told) = solve(&["--set", value, "--job", "second_gear"]);
    assert_eq!((code, set), (Some(0), [String::new(), text_of("")]));
    assert!(!told.contains("note"), "{told}");
    let (code, set, told) = solve(&["--set", &format!("second_gear.{value}")]);
    assert_eq!((code, set), (Some(0), [String::new(), text_of("second_gear.")]));
    assert!(!told.contains("note"), "{told}");
    // the one that names its job goes before the one for all
    let (code, set, told) = solve(&["--set", "r.pressure_angle=22 deg", "--set", &format!("second_gear.{value}")]);
    assert_eq!((code, &set[1]), (Some(0), &text_of("second_gear.")));
    assert!(set[0] == "r.pressure_angle = 22 deg" && !told.contains("note"), "{set:?} {told}");
    // a value that the other job cannot have is no matter where it is not asked for
    let narrow = std::fs::read_to_string(&spec).expect("written");
    let (first, second) = narrow.split_at(narrow.find("job second_gear").expect("the second job"));
    let second = second.replacen("    let", "    require teeth < 25, \"few teeth\"\n    let", 1);
    std::fs::write(&spec, format!("{first}{second}")).expect("the test's file");
    assert_eq!(solve(&["--set", "teeth=30", "--job", "first_gear"]).0, Some(0));
    assert_eq!(solve(&["--set", "teeth=30"]).0, Some(1));
    // of two names for all jobs there is one that changes nothing
    let both = ["--set", "teeth=20", "--set", "first_gear.teeth=21", "--set", "second_gear.teeth=22"];
    let (code, _, told) = solve(&both);
    assert!(
        code == Some(1) && told.contains("`teeth` changes nothing beside `first_gear.teeth`, `second_gear.teeth`"),
        "{told}"
    );
}

#[test]
fn help_says_that_one_job_is_carried_over() {
    let help =
        |command: &str| text(&flank(&[command, "--help"]).stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help("solve").contains("all of them otherwise"));
    assert!(help("derive").contains("all of them otherwise, but with --to one at a time"));
    assert!(!help("convert").contains("all of them otherwise"));
}

/// A name that cannot be is one mistake, not also a job without surfaces.
#[test]
fn a_job_without_a_name_is_one_mistake() {
    let wrong = written(&folder("nameless"), "wrong.chain", "job 3d {\n    param a : length = 1 mm\n}\n");
    let told = text(&flank(&["check", &wrong]).stderr);
    assert!(told.contains("E0101") && !told.contains("makes no surface"), "{told}");
}
