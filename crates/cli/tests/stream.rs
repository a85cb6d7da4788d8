//! Surfaces of more points than are kept: solved and written band by band.

mod support;

use std::path::Path;

use support::{flank, folder, text};

const JOB: &str = "benches/spiral_bevel.chain";

fn solve(job: &str, sides: [usize; 2], out: &Path, flags: &[&str]) -> std::process::Output {
    let [rows, columns] = [format!("rows={}", sides[0]), format!("columns={}", sides[1])];
    let start =
        ["solve", JOB, "--job", job, "--set", &rows, "--set", &columns, "--out", out.to_str().expect("a plain path")];
    flank(&[&start, flags].concat())
}

/// Kept for what it further computes, a grid has the same points, bit for bit, and is as curved.
#[test]
fn points_are_the_same_whether_they_are_kept_or_not() {
    let csv = |flags: &[&str]| {
        let out = folder(&format!("streamed-{}", flags.len()));
        let done = solve("flank", [257, 256], &out, &[&["--no-picture"], flags].concat());
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        text(&std::fs::read(out.join("flank.csv")).unwrap())
    };
    let rows = |csv: &str, columns: usize| {
        let points = csv.lines().filter(|line| !line.starts_with('#')).skip(1);
        points.map(|line| line.split(',').take(columns).collect::<Vec<_>>().join(",")).collect::<Vec<String>>()
    };
    let bare = csv(&[]);
    // what moves a surface needs all its points together
    let [streamed, kept] = [&["--geometry"][..], &["--geometry", "--sensitivity"]].map(csv);
    assert_eq!(rows(&bare, 14).len(), 257 * 256);
    assert!(rows(&bare, 14) == rows(&streamed, 14) && rows(&bare, 14) == rows(&kept, 14));
    let described = streamed.lines().find(|line| !line.starts_with('#')).expect("a head").split(',').count();
    assert!(described > 14 + 20, "{described} columns");
    assert!(rows(&streamed, described) == rows(&kept, described));
}

#[test]
fn what_needs_all_points_together_is_told() {
    let out = folder("together");
    for (flag, told) in [("--sensitivity", "--sensitivity needs all"), ("--certify", "--certify needs all")] {
        let run = solve("flank", [1025, 1024], &out, &[flag]);
        assert_eq!(run.status.code(), Some(1));
        assert!(text(&run.stderr).contains(told), "{}", text(&run.stderr));
        assert!(text(&run.stderr).contains("ask for 1048576 points or fewer"), "{}", text(&run.stderr));
    }
    assert_eq!(std::fs::read_dir(out).unwrap().count(), 0);
}

/// Of each point that geometry is asked of, its numbers are kept: too many of them are refused before anything is solved.
#[test]
fn too_much_geometry_is_told() {
    let out = folder("much-geometry");
    let run = solve("flank", [3000, 3000], &out, &["--geometry"]);
    assert_eq!(run.status.code(), Some(1));
    let told = text(&run.stderr);
    assert!(told.contains("9000000 points, and --geometry needs something of all of them at once"), "{told}");
    assert!(told.contains("ask for fewer points, or for fewer surfaces at a time, or do without it"), "{told}");
    assert_eq!(std::fs::read_dir(out).unwrap().count(), 0);
}

/// A face goes through as many points as it takes, not through all.
#[test]
fn a_large_grid_has_a_smooth_face() {
    let out = folder("large-face");
    let done = solve("flank", [501, 502], &out, &["--step", "--no-picture", "--format", "stl"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stderr).contains("a face through 101 x 101 points, off by at most"), "{}", text(&done.stderr));
    // 84 bytes of head, 50 a triangle
    let stl = std::fs::metadata(out.join("flank.stl")).expect("it is written").len();
    assert_eq!(stl, 84 + 50 * 2 * 500 * 501);
}

/// A run that is killed while it writes: what stood there before is still there, and nothing else.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_run_leaves_the_old_file() {
    let out = folder("killed");
    let old = out.join("flank.csv");
    std::fs::write(&old, "old").expect("the test's file");
    let arguments = ["--job", "flank", "--set", "rows=1000", "--set", "columns=1000", "--no-picture", "--out"];
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["solve", JOB])
        .args(arguments)
        .arg(&out)
        .current_dir(support::top())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the binary runs");
    // of a file without a name, only the process knows
    let opened = format!("/proc/{}/fd", run.id());
    let begun = || {
        let files = std::fs::read_dir(&opened).into_iter().flatten().filter_map(Result::ok);
        let is_within = |path: &Path| std::fs::read_link(path).is_ok_and(|file| file.starts_with(&out));
        let mut sizes = files.map(|file| file.path()).filter(|path| is_within(path)).map(std::fs::metadata);
        sizes.any(|found| found.is_ok_and(|found| found.len() > 1_000_000))
    };
    while !begun() {
        assert!(run.try_wait().expect("it runs").is_none(), "it ended before it was killed");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    run.kill().expect("it runs");
    run.wait().expect("it ran");
    assert_eq!(std::fs::read_to_string(&old).expect("it is there"), "old");
    assert_eq!(std::fs::read_dir(&out).expect("the folder is there").count(), 1);
}

/// What the disk says half-way is told, and the old file stays.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let out = folder("full");
    std::os::unix::fs::symlink("/dev/full", out.join("flank.csv")).expect("links can be made");
    let done = solve("flank", [300, 300], &out, &["--no-picture"]);
    assert_eq!(done.status.code(), Some(1));
    assert!(text(&done.stderr).contains("the disk is full"), "{}", text(&done.stderr));
}
