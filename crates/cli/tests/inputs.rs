//! No command writes over what it read, whatever that is called and however it is reached.

mod support;

use std::path::Path;

use support::{flank, folder, self_contained, text, written};

/// The machines and tools of a job stand in a file that is called as what is written.
fn library_stays(name: &str, [library, job]: [&str; 2], command: &str, arguments: &[&str]) {
    let out = folder("inputs_library");
    written(&out, "flank.toml", "");
    let input = written(&out, name, library);
    let job = written(&out, "job.chain", &format!("use \"{name}\"\n{job}"));
    spared(&input, &[&[command, job.as_str()], arguments].concat(), &out);
}

/// The command ends with what it must not do, and its input is as it was.
fn spared(input: &str, arguments: &[&str], out: &Path) {
    let before = std::fs::read(input).expect("the input");
    let at = ["--out", out.to_str().expect("a plain path")];
    let to = if arguments.contains(&"--out") { &[][..] } else { &at };
    let run = flank(&[arguments, to].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{arguments:?}: {told}");
    let name = Path::new(input).file_name().and_then(|name| name.to_str()).expect("a name");
    assert!(told.contains(&format!("{name}` is what this command reads")), "{arguments:?}: {told}");
    assert_eq!(std::fs::read(input).expect("still there"), before, "{arguments:?}");
}

#[test]
fn used_files_are_not_written_over() {
    let library = self_contained(&["machines/hobbing_6axis", "machines/rack_generating", "tools/rack"]);
    let job = self_contained(&["hobbing/spur_gear"]);
    let job = job.replace("by 25", "by 5").replace("by 11", "by 3").replace("by 15", "by 5");
    let plot = ["--what", "machine"];
    let deviation = ["flank_plus", "--reference", "flank_minus", "--no-align", "--no-picture"];
    for (command, name, arguments) in [
        ("solve", "spur_gear.csv", &[][..]),
        ("solve", "spur_gear.vtp", &["--format", "vtp", "--no-picture"]),
        ("solve", "spur_gear.png", &[]),
        ("solve", "spur_gear.step", &["--step", "--no-picture"]),
        ("plot", "spur_gear.machine.svg", &plot),
        ("view", "spur_gear.html", &[]),
        ("report", "spur_gear.report.html", &[]),
        ("measure", "spur_gear.grid.csv", &["--surface", "flank_plus"]),
        ("deviation", "spur_gear.flank_plus.deviation.csv", &deviation),
    ] {
        library_stays(name, [&library, &job], command, arguments);
    }
}

#[test]
fn a_target_machine_and_its_job_are_not_written_over() {
    let out = folder("inputs_convert");
    let machine = self_contained(&["machines/free_form"]);
    let pinion = self_contained(&[
        "functions/bevel",
        "machines/cradle",
        "tools/face_mill",
        "functions/blanks_19x62",
        "bevel/pinion_19x62",
    ]);
    let job = written(&out, "job.chain", &pinion);
    for (name, arguments) in [
        ("pinion_19x62_on_free_form.csv", &[][..]),
        ("pinion_19x62_on_free_form.ngc", &["--nc", "linuxcnc", "--time", "20"]),
        ("pinion_19x62_on_free_form.c", &["--emit", "c"]),
    ] {
        let input = written(&out, name, &machine);
        let convert = ["convert", &job, "--surface", "concave", "--positions", "21", "--to", &input];
        spared(&input, &[&convert, arguments].concat(), &out);
        std::fs::remove_file(input).expect("the test's own");
    }
}

const CURVED: &str = r#"
machine planer {
    axis C : rotary
    frame bed
    frame slide in bed = translate(20 mm, 0 mm, 0 mm)
    frame work in bed = rotate_z(C)
}
tool relieved {
    let relief = curve("points.csv", s: length, depth: length)
    surface face(u: length in 0.5 mm .. 3.5 mm, v: length in -5 mm .. 5 mm) {
        at = [relief(u), u, v]
        body towards [1, 0, 0]
    }
}
job points {
    machine m = planer()
    tool t = relieved
    mount t on m.slide
    drive m.C = 0 deg
    surface face in m.slide = move(t.face)
    sample face { y: 1 mm .. 3 mm by 3, z: -1 mm .. 1 mm by 3 }
}
"#;

/// A job beside its table, with the folder of both as that of the results: what is tried first.
#[test]
fn tables_are_not_written_over() {
    let out = folder("inputs_table");
    let table = written(&out, "points.csv", "s [mm], depth [um]\n0, 0\n1, 10\n2, 40\n4, 160\n");
    let job = written(&out, "job.chain", CURVED);
    spared(&table, &["solve", &job], &out);
    let elsewhere = folder("inputs_table_results");
    let run = flank(&["solve", &job, "--out", elsewhere.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    #[cfg(unix)]
    {
        std::fs::remove_file(elsewhere.join("points.csv")).expect("it is written");
        std::os::unix::fs::symlink(&table, elsewhere.join("points.csv")).expect("a link");
        spared(&table, &["solve", &job], &elsewhere);
    }
}

/// A report goes to a file of any name that ends as a page does, and so may a spec be called.
#[test]
fn a_spec_is_not_written_over() {
    let out = folder("inputs_spec");
    let spec =
        self_contained(&["machines/hobbing_6axis", "machines/rack_generating", "tools/rack", "hobbing/spur_gear"]);
    let spec = written(&out, "spur.html", &spec.replace("by 25", "by 5").replace("by 11", "by 3"));
    spared(&spec, &["report", &spec, "--out", &spec], &out);
}
