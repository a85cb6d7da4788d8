//! `flank test`: what it says of failures elsewhere, of files that are no specs, and of what nothing is known of.

mod support;

use std::path::Path;
use std::process::{Command, Output};

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
