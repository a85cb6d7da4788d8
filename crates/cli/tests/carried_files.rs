//! What the files of `flank convert` say of themselves, and when there are none.

mod support;

use std::path::Path;

use support::{flank, folder, text, top, written};

const FREE_FORM: &str = "specs/machines/free_form.chain";

/// Exit code, stdout, stderr.
fn converted(job: &[&str], out: &Path) -> (Option<i32>, String, String) {
    let run = flank(&[&["convert"], job, &["--out", out.to_str().expect("a plain path")]].concat());
    (run.status.code(), text(&run.stdout), text(&run.stderr))
}

fn read(out: &Path, name: &str) -> String {
    // remarks of NC programs are broken into lines
    std::fs::read_to_string(out.join(name)).expect(name).replace(")\n(+", "")
}

/// Heads name tool, work, surfaces and the machine, and two tools of one job have files of their own.
#[test]
fn heads_tell_what_is_carried_whereto() {
    let out = folder("carried-heads");
    let pinion = ["specs/bevel/pinion_19x62.chain", "--to", FREE_FORM];
    let (code, ..) = converted(&[&pinion[..], &["--nc", "linuxcnc", "--time", "9", "--emit", "c,c"]].concat(), &out);
    assert_eq!(code, Some(0));
    for extension in ["csv", "ngc", "c"] {
        let head = read(&out, &format!("pinion_19x62_on_free_form.{extension}"));
        let carried =
            "m.cutter against m.work, as they make concave, concave_fillet, convex, convex_fillet, root, on machine";
        assert!(head.contains(carried), "{extension}: {head}");
    }
    let pair = ["specs/bevel/tilted_pinion.chain", "--to", FREE_FORM];
    for surface in ["concave", "convex"] {
        let (code, told, errors) = converted(&[&pair[..], &["--surface", surface]].concat(), &out);
        assert_eq!(code, Some(0), "{errors}");
        let name = format!("tilted_pinion_{surface}_on_free_form.csv");
        assert!(told.contains(&name), "{told}");
        assert!(read(&out, &name).contains(&format!("as they make {surface}")));
    }
}

/// Of a tool that is an edge no point tells what blocks leave: the head of the program says so of both numbers.
#[test]
fn numbers_that_are_not_known_are_said_to_be() {
    let out = folder("carried-edge");
    let gear = ["specs/bevel/helixform_gear.chain", "--to", FREE_FORM];
    let (code, ..) = converted(&[&gear[..], &["--order", "3", "--nc", "linuxcnc", "--time", "5"]].concat(), &out);
    assert_eq!(code, Some(0));
    let head = read(&out, "helixform_gear_on_free_form.ngc");
    let unknown = "how far straight blocks and rounded positions leave the flank off is not known";
    assert!(head.contains(unknown), "{head}");
    let (code, _, told) = converted(&[&gear[..], &["--tolerance", "1um"]].concat(), &out);
    assert_eq!(code, Some(3));
    assert!(told.contains("this tool is an edge; give the order"), "{told}");
}

/// A control that has no such axis is told before anything is written, also if another one has it.
#[test]
fn a_program_that_cannot_be_leaves_no_files() {
    let out = folder("carried-words").join("none");
    let library = support::self_contained(&["machines/free_form"]);
    let machine = format!("{library}machine odd extends free_form {{ nc Z = Q, address: Q }}\n");
    let machine =
        machine.replace("{ nc Z = Q, address: Q }", "{ }").replace("axis Z ", "axis Q ").replace("Y, Z)", "Y, Q)");
    let target = written(&folder("carried-target"), "odd.chain", &machine);
    let job = ["specs/bevel/pinion_19x62.chain", "--to", &target, "--nc", "siemens,fanuc", "--time", "5"];
    let (code, _, told) = converted(&job, &out);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("Fanuc has no axis address `Q`"), "{told}");
    assert!(!out.exists());
}

/// A value that is set twice is a wrong command line for every command that takes values.
#[test]
fn a_value_is_set_once() {
    for command in [&["solve"][..], &["derive"], &["convert", "--to", FREE_FORM]] {
        let twice = ["specs/bevel/pinion_19x62.chain", "--set", "m.work_offset=1mm", "--set", "m.work_offset=2mm"];
        let run = flank(&[command, &twice].concat());
        assert_eq!(run.status.code(), Some(2), "{command:?}");
        assert!(text(&run.stderr).contains("`--set m.work_offset=…` is given twice"), "{}", text(&run.stderr));
    }
}

/// An edited copy of a machine that the job uses has its name, and the way out is told.
#[test]
fn an_edited_copy_needs_a_name_of_its_own() {
    let out = folder("carried-copy");
    let machine = std::fs::read_to_string(top().join("specs/machines/cradle.chain")).expect("it is shipped");
    let target = written(&out, "edited.chain", &machine);
    let (code, _, told) = converted(&["specs/bevel/pinion_19x62.chain", "--to", &target], &out);
    assert_eq!(code, Some(1));
    assert!(told.contains("E0202") && told.contains("give it another name in one of the files"), "{told}");
}

/// Along two motions there are no files, and that is said.
#[test]
fn two_motions_make_no_file() {
    let out = folder("carried-two").join("none");
    let job = ["specs/hobbing/helical_gear.chain", "--to", "specs/machines/hobbing_6axis.chain", "--positions", "9"];
    let (code, _, told) = converted(&job, &out);
    assert_eq!(code, Some(3));
    assert!(told.contains("--out: the job runs over spindle and feed, each by itself, and files"), "{told}");
    assert!(!out.exists());
}

/// The mirror image of a setting is as near, and of the two the one within the range is told.
#[test]
fn settings_as_near_are_within_their_ranges() {
    let job = [
        "convert",
        "specs/bevel/tilted_pinion.chain",
        "--surface",
        "concave",
        "--to",
        "specs/machines/cradle_tilt.chain",
    ];
    let run = flank(&job);
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(told.contains("were found") && !told.contains("outside its range"), "{told}");
    // nor does the roll jump by turns, where the poses are not met
    let told = text(&run.stdout);
    let roll: Vec<&str> =
        told.lines().find(|line| line.trim().starts_with("roll")).expect("a roll").split_whitespace().collect();
    let [from, to] = [roll[1], roll[3]].map(|end| end.parse::<f64>().expect("degrees"));
    assert!(to - from < 60.0, "{told}");
}

/// One position is no program, and nothing is left of what was asked for beside it.
#[test]
fn a_program_of_one_position_is_refused_before_anything_is_written() {
    let out = folder("convert-one");
    let spec = ["convert", "specs/hobbing/spur_gear.chain", "--to", "specs/machines/hobbing_6axis.chain"];
    let of = |more: &[&str]| {
        flank(&[&spec[..], &["--positions", "1", "--time", "10", "--out", out.to_str().unwrap()], more].concat())
    };
    let run = of(&["--nc", "fanuc"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("--nc needs --positions 2 or more"), "{}", text(&run.stderr));
    assert_eq!(std::fs::read_dir(&out).expect("the test's folder").count(), 0);
    let run = of(&[]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}
