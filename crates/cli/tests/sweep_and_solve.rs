//! The cases of a study are what `flank solve` says of the job with the same values: whatever these decide, and through whatever.

mod support;

use std::path::Path;

use support::{AGAIN, flank, text, written};

/// A rack on a planer that rolls a blank of 30 mm.
fn rolled(tool: &str, job: &str) -> String {
    format!(
        "machine planer {{
    axis C : rotary
    axis Y : linear
    frame bed
    frame ram   in bed = translate(30 mm, Y, 0 mm)
    frame table in bed = rotate_z(C)
}}
{tool}
job gear {{
    machine m = planer
{job}
    motion roll : angle in -40 deg .. 40 deg
    drive m.Y, m.C = 30 mm * roll, roll
}}
"
    )
}

/// The points in a file: surface and place, status, numbers of position and normal.
fn points(file: &Path) -> Vec<(String, String, Vec<f64>)> {
    let table = std::fs::read_to_string(file).expect("points");
    let mut lines = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let column = |name: &str| head.iter().position(|title| *title == name).expect("a column");
    let numbers = ["x", "y", "z", "nx", "ny", "nz"].map(column);
    let [surface, i, j, status] = ["surface", "i", "j", "status"].map(column);
    let point = |cells: Vec<&str>| {
        let place = [surface, i, j].map(|k| cells[k]).join(" ");
        let values = numbers.iter().filter_map(|k| cells[*k].parse().ok()).collect();
        (place, cells[status].to_string(), values)
    };
    lines.map(point).collect()
}

/// Verdict, reason and branch of each case, whose points are those of `flank solve --set` to 1e-9 mm.
fn compared(spec: &str, cases: &[&str]) -> Vec<[String; 3]> {
    let folder = tempfile::tempdir().expect("a folder");
    let [study, out] = ["study", "out"].map(|name| folder.path().join(name).display().to_string());
    let asked = ["sweep", spec, "--collect", "points", "--keep", "points", "--out", &study];
    let run = flank(&[&asked[..], cases].concat());
    assert!(matches!(run.status.code(), Some(0 | 3)), "{cases:?}: {}", text(&run.stderr));
    let gathered = text(&flank(&["sweep", "gather", &study]).stdout);
    let mut rows = gathered.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().expect("a head")[2].to_string();
    let (name, unit) = head.trim_end_matches(']').split_once(" [").unwrap_or((&head, ""));
    let row = |row: Vec<&str>| {
        let set = format!("{name}={} {unit}", row[2]);
        let run = flank(&["solve", spec, "--set", &set, "--no-picture", "--out", &out]);
        let kept = Path::new(&study).join("points").join(format!("{}.csv", row[0]));
        assert_eq!(run.status.code() == Some(1), row[3] == "spec wrong", "{set}: {}", text(&run.stderr));
        if row[3] != "spec wrong" {
            let job = std::fs::read_dir(&out).expect("a folder").filter_map(|file| Some(file.ok()?.path()));
            let solved = job.into_iter().find(|file| file.extension().is_some_and(|ending| ending == "csv"));
            let (kept, solved) = (points(&kept), points(&solved.expect("points")));
            assert_eq!(kept.len(), solved.len(), "{set}");
            for (one, other) in kept.iter().zip(&solved) {
                assert_eq!((&one.0, &one.1, one.2.len()), (&other.0, &other.1, other.2.len()), "{set}");
                let off = one.2.iter().zip(&other.2).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-9, "{set}: {} is {off:e} off", one.0);
            }
        }
        [row[3], row[4], row[5]].map(str::to_string)
    };
    rows.map(row).collect()
}

fn of_text(content: &str, cases: &[&str]) -> Vec<[String; 3]> {
    let folder = tempfile::tempdir().expect("a folder");
    compared(&written(folder.path(), "gear.chain", content), cases)
}

fn branches(rows: &[[String; 3]]) -> Vec<&str> {
    rows.iter().map(|[_, _, branch]| branch.as_str()).collect()
}

/// A sample whose end, and a profile whose joint, is made of a setting that is given a parameter of the job.
#[test]
fn what_a_parameter_decides_through_a_setting_is_that_of_the_case() {
    let tool = "tool rack {
    param tilt : angle = 20 deg
    param helix : angle = 0 deg
    profile tooth {
        flank = line(from: [3 mm, -3 mm * tan(tilt)], to: [-1 mm, 1 mm * tan(tilt)])
        tip = line(from: [-1 mm, 1 mm * tan(tilt)], to: [-1 mm, 3 mm])
    }
    surface skin(s: along tooth, v: length in -10 mm .. 10 mm) {
        let p = tooth(s)
        at = [p[0], p[1] + v * sin(helix), v * cos(helix)]
        body towards [0.1, 1, 0]
    }
}";
    let job = "    param pa : angle = 20 deg
    param slope : angle = 0 deg
    tool r = rack(tilt: pa, helix: slope)
    mount r on m.ram
    surface gear in m.table = envelope(r.skin, over: roll)
    sample gear.flank { SAMPLE by 5, z: -5 mm .. 5 mm by 3 }";
    for sample in ["rho: 29.5 mm .. 30 mm + 2 mm * tan(r.tilt)", "s: r.tooth.flank.from .. r.tooth.flank.to"] {
        let text = rolled(tool, &job.replace("SAMPLE", sample));
        let rows = of_text(&text, &["--vary", "pa=20deg..26deg by 3"]);
        assert_eq!(branches(&rows), ["searched"; 3], "{sample}");
        // nothing but equations hangs on this one
        let rows = of_text(&text, &["--vary", "slope=0deg..2deg by 3"]);
        assert_eq!(branches(&rows), ["searched", "followed", "followed"], "{sample}");
    }
}

#[test]
fn a_machine_or_tool_that_is_another_one_again_follows_it() {
    for vary in ["r.helix=15deg..10deg by 2", "m.shift=0mm..0.2mm by 2", "m.bias=0mm..1mm by 2"] {
        assert_eq!(branches(&of_text(AGAIN, &["--vary", vary])), ["searched", "followed"], "{vary}");
    }
    // the second tool makes one of a setting of its own, until the first one is given it
    for vary in ["r.crown=0.03..0.05 by 2", "r.tilt=20deg..21deg by 2"] {
        assert_eq!(branches(&of_text(AGAIN, &["--vary", vary])), ["searched", "searched"], "{vary}");
    }
}

#[test]
fn a_wheel_is_dressed_anew_in_each_case() {
    let cases = ["--scatter", "m.center_distance=uniform(0.1mm)", "--count", "2"];
    compared("specs/grinding/dressed_wheel.chain", &cases);
}

/// `hand` turns the flank of the rack over; at zero it has no side.
#[test]
fn steel_lies_on_the_side_of_the_case() {
    let tool = "tool rack {
    param hand : number in -1 .. 1 = 1
    surface flank(u: length in -3 mm .. 3 mm, v: length in -10 mm .. 10 mm) {
        at = [u * cos(20 deg), -hand * u * sin(20 deg), v]
        body towards [0, hand, 0]
    }
}";
    let job = "    tool r = rack
    mount r on m.ram
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 29 mm .. 31.5 mm by 5, z: -5 mm .. 5 mm by 3 }";
    let rows = of_text(&rolled(tool, job), &["--vary", "r.hand=1..-1 by 3"]);
    assert_eq!(branches(&rows), ["searched", "", "searched"]);
    assert_eq!(rows[1][0], "spec wrong");
    let rows = of_text(&rolled(tool, job), &["--vary", "r.hand=1..0.99 by 2"]);
    assert_eq!(branches(&rows), ["searched", "followed"]);
}

#[test]
fn points_are_kept_where_a_count_gives_the_rows() {
    let tool = "tool rack {
    surface flank(u: length in -3 mm .. 3 mm, v: length in -10 mm .. 10 mm) {
        at = [u * cos(20 deg), -u * sin(20 deg), v]
        body towards [0, 1, 0]
    }
}";
    let job = "    param rows : count in 1 .. 30 = 5
    tool r = rack
    mount r on m.ram
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 29 mm .. 31.5 mm by rows, z: -5 mm .. 5 mm by 3 }";
    let rows = of_text(&rolled(tool, job), &["--vary", "rows=3..6 by 4"]);
    assert!(rows.iter().all(|row| row[0] == "done"), "{rows:?}");
}

/// An end of a range goes as far as a value in a table: one that the text refuses is a row, one beyond its own range is refused.
#[test]
fn ends_that_the_text_refuses_are_rows() {
    let tool = "tool rack {
    param crown : number in -1 .. 1 = 0
    require crown >= 0, \"the tooth is thicker in its middle\"
    surface flank(u: length in -3 mm .. 3 mm, v: length in -10 mm .. 10 mm) {
        at = [u * cos(20 deg), -u * sin(20 deg) + crown * u^2 / 100 mm, v]
        body towards [0, 1, 0]
    }
}";
    let job = "    tool r = rack
    mount r on m.ram
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 29 mm .. 31 mm by 5, z: -5 mm .. 5 mm by 3 }";
    let content = rolled(tool, job);
    let rows = of_text(&content, &["--vary", "r.crown=-0.1..0.1 by 3"]);
    let verdicts: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    assert_eq!(verdicts, ["spec wrong", "done", "done"], "{rows:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let spec = written(folder.path(), "gear.chain", &content);
    let out = folder.path().join("study").display().to_string();
    for (vary, says) in [("r.crown=-2..0 by 3", "E0307"), ("r.crown=0mm..1mm by 2", "E0301")] {
        let run = flank(&["sweep", &spec, "--vary", vary, "--collect", "points", "--out", &out]);
        assert_eq!(run.status.code(), Some(1), "{vary}");
        assert!(text(&run.stderr).contains(says), "{vary}: {}", text(&run.stderr));
    }
}
