//! `flank test`: what it says of failures elsewhere, of new jobs, of files that are no specs, and of what nothing is known of.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use support::{folder, text, top, written};

fn tested(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.arg("test").args(arguments).current_dir(folder).env("CI", "").output().expect("the binary runs")
}

fn gear() -> String {
    std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped")
}

/// What a job inherits stands in another file, which a failure names.
#[test]
fn a_failure_names_the_file_where_its_expectation_stands() {
    let folder = folder("test_from");
    let gear = gear();
    written(&folder, "gear.chain", &gear);
    let job =
        gear.lines().find_map(|line| line.strip_prefix("job ")).expect("a job").split(' ').next().expect("its name");
    written(
        &folder,
        "heir.chain",
        &format!(
            "use \"gear.chain\"\n\njob heir extends {job} {{\n    drive m.Y = 1.001 * reference_radius * roll\n}}\n"
        ),
    );
    let run = tested(&folder, &["heir.chain", "--junit", "out.xml"]);
    let told = text(&run.stdout);
    let line = 1 + gear.lines().position(|line| line.contains("expect flank_plus: abs")).expect("it is expected");
    assert!(told.contains(&format!("heir from gear.chain:{line}:5: flank_plus: abs")), "{told}{}", text(&run.stderr));
    let xml = std::fs::read_to_string(folder.join("out.xml")).expect("it is written");
    assert!(xml.contains(&format!("message=\"gear.chain:{line}:5; off by")), "{xml}");
    let own = text(&tested(&folder, &["gear.chain"]).stdout);
    assert!(!own.contains(" from "), "{own}");
}

/// What is no spec says what it is.
#[test]
fn files_that_are_no_specs_are_told() {
    let folder = folder("test_no_specs");
    let gear = gear();
    let little: Vec<u8> = gear.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = gear.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let marked: Vec<u8> = [0xff, 0xfe].into_iter().chain(little.iter().copied()).collect();
    for (name, bytes) in [("little.chain", little), ("big.chain", big), ("marked.chain", marked)] {
        std::fs::write(folder.join(name), bytes).expect("it is written");
        let told = text(&tested(&folder, &[name]).stderr);
        assert!(told.contains("E0001") && told.contains("it is UTF-16 text: save it as UTF-8"), "{name}: {told}");
    }
    let run = tested(&folder, &["none.chain"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("cannot read `none.chain`: there is no such file"), "{}", text(&run.stderr));
    written(&folder, "empty.chain", "");
    let run = tested(&folder, &["empty.chain"]);
    let told = format!("{}{}", text(&run.stdout), text(&run.stderr));
    assert!(told.contains("nothing is tested") && told.contains("the file declares nothing"), "{told}");
    assert!(!told.contains("hold"), "{told}");
    written(&folder, "gear.chain", &gear);
    let told = text(&tested(&folder, &["gear.chain", "--filter", "first_gaer"]).stderr);
    assert!(told.contains("it is a part of `FILE:NAME`, as in `gear.chain:first_gear`"), "{told}");
}

/// Of positions that no solved point tells nothing holds.
#[test]
fn nothing_holds_where_no_point_is_solved() {
    let folder = folder("test_unsolved");
    let gear = gear();
    let first = &gear[..gear.find("job first_helical_gear").expect("the second job")];
    let shaper = "machine shaper {
    axis Y : linear in -600 mm .. 600 mm
    axis C : rotary
    frame bed
    frame slide in bed = translate(40 mm, Y, 0 mm)
    frame table in bed = rotate_z(C)
}
";
    let start = first.find("    sample ").expect("a sample");
    let far = "    sample flank_plus, flank_minus {
        rho: 445 mm .. 446 mm by 3, z: -5 mm .. 5 mm by 3
        require x: -900 mm .. 900 mm, \"far\"
    }
    expect on shaper within 1 um
    expect travel
}
";
    written(&folder, "far.chain", &format!("{shaper}\n{}{far}", &first[..start]));
    let told = text(&tested(&folder, &["far.chain"]).stdout);
    assert!(told.contains("4 of 4 expectations failed"), "{told}");
    for why in [
        "no point of flank_plus is solved: nothing says where its tool touches",
        "no point of the job is solved: nothing says how far its axes move",
        "found: no point of flank_minus is solved",
    ] {
        assert!(told.contains(why), "{told}");
    }
}

/// What was worked out for the library's values, also what a job inherits of that, is left out where it does not hold; all else stays.
#[test]
fn a_new_job_with_other_values_keeps_what_holds() {
    let folder = folder("test_new_values");
    for (number, (template, set, holds, left_out)) in [
        ("undercut_gear", "teeth=9", 0, "lowest(flank_plus.trim_line, rho) near 4.72560220014383 * module"),
        ("undercut_gear", "module=2 mm", 2, ""),
        ("undercut_gear_body", "teeth=9", 2, "gear.form_diameter near 9.45120440028766 * module"),
        ("milled_gear", "helix_angle=10 deg", 2, "lower_flank near table(\"helical_gear.csv\""),
        ("elliptical_gear", "axis_ratio=0.95", 1, "flank_plus near table(\"elliptical_gear.csv\""),
        ("elliptical_gear_body", "axis_ratio=0.95", 1, "flank_plus near table(\"elliptical_gear.csv\""),
        ("elliptical_gear_body", "face_width=21 mm", 5, ""),
    ]
    .into_iter()
    .enumerate()
    {
        let out = number.to_string();
        let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
        let run = command.args(["new", template, "--name", "my_gear", "--out", &out, "--set", set]);
        let run = run.current_dir(&folder).output().expect("the binary runs");
        let told = text(&run.stdout);
        assert_eq!(told.contains("left out"), !left_out.is_empty(), "{template} {set}: {told}{}", text(&run.stderr));
        assert!(told.contains(left_out), "{template} {set}: {told}");
        let spec = told.split(['\n', ' ', ',']).nth(1).expect("what was written").to_string();
        let run = tested(&folder, &[&spec, "--json"]);
        let document: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        assert_eq!((&document["failed"], &document["passed"]), (&0.into(), &holds.into()), "{template} {set}: {told}");
    }
}
