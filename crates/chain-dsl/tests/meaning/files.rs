//! Files that use each other, and values from outside.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Code, compile_file, render};
use flank_expr::Graph;

/// A project folder of its own with some files.
fn project(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("meaning").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    for (path, text) in files.iter().chain(&[("flank.toml", "")]) {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder for the test");
        std::fs::write(path, text).expect("a file of the test");
    }
    folder
}

fn codes(file: &Path, set: &[(&str, &str)]) -> Vec<Code> {
    let set: Vec<(String, String)> = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let graph = Graph::new();
    compile_file(&graph, file, &set).diagnostics.iter().map(|finding| finding.code).collect()
}

const LIBRARY: &str = include_str!("library.chain");
const JOB: &str = r#"
use "../library.chain"
job j {
    param height : length = 3 mm
    machine m = lathe(height: height)
    tool b = ball
    mount b on m.slide
    motion turn : angle in 0 deg .. 90 deg
    drive m.C = turn
    drive m.Z = 1 mm/rad * turn
    surface s in m.work = envelope(b.face, over: turn)
}
"#;

#[test]
fn files_are_found_relative_to_the_file_that_uses_them() {
    let folder = project("relative", &[("library.chain", LIBRARY), ("jobs/j.chain", JOB)]);
    assert_eq!(codes(&folder.join("jobs/j.chain"), &[]), []);
}

#[test]
fn a_file_used_twice_is_read_once() {
    let twice = format!("use \"../library.chain\"\nuse \"b.chain\"\n{JOB}");
    let folder = project(
        "twice",
        &[("library.chain", LIBRARY), ("jobs/j.chain", &twice), ("jobs/b.chain", "use \"../library.chain\"")],
    );
    assert_eq!(codes(&folder.join("jobs/j.chain"), &[]), []);
}

#[test]
fn circles_are_errors() {
    let folder = project(
        "circle",
        &[("a.chain", "use \"b.chain\""), ("b.chain", "use \"a.chain\""), ("c.chain", "use \"c.chain\"")],
    );
    assert_eq!(codes(&folder.join("a.chain"), &[]), [Code::CyclicUse]);
    assert_eq!(codes(&folder.join("c.chain"), &[]), [Code::CyclicUse]);
}

#[test]
fn paths_stay_inside_the_project() {
    let climbing = [
        ("a.chain", "use \"../../outside.chain\""),
        ("b.chain", "use \"/etc/hostname\""),
        ("c.chain", "use \"sub/../../x\""),
    ];
    let folder = project("climbing", &climbing);
    for (file, _) in climbing {
        assert_eq!(codes(&folder.join(file), &[]), [Code::OutsideProject], "{file}");
    }
}

#[cfg(unix)]
#[test]
fn links_do_not_lead_outside() {
    let folder = project("link", &[("a.chain", "use \"link.chain\"")]);
    let target = folder.parent().expect("a folder").join("target.chain");
    std::fs::write(&target, LIBRARY).expect("a file of the test");
    std::os::unix::fs::symlink(&target, folder.join("link.chain")).expect("a link");
    assert_eq!(codes(&folder.join("a.chain"), &[]), [Code::OutsideProject]);
}

#[test]
fn unreadable_files_are_told() {
    let folder =
        project("unreadable", &[("a.chain", "use \"missing.chain\""), ("b.chain", "use \"sub\""), ("sub/c.chain", "")]);
    std::fs::write(folder.join("d.chain"), b"machine m { frame \xff }").expect("a file of the test");
    for file in ["a.chain", "b.chain", "d.chain", "missing.chain", "sub"] {
        assert_eq!(codes(&folder.join(file), &[]), [Code::UnreadableFile], "{file}");
    }
    std::fs::write(folder.join("large.chain"), " ".repeat((1 << 20) + 1)).expect("a file of the test");
    assert_eq!(codes(&folder.join("large.chain"), &[]), [Code::LimitExceeded]);
}

#[test]
fn values_from_outside_win() {
    let folder = project("outside", &[("library.chain", LIBRARY), ("jobs/j.chain", JOB)]);
    let file = folder.join("jobs/j.chain");
    let graph = Graph::new();
    let set = [("height".to_string(), "1 inch".to_string()), ("b.radius".to_string(), "2 * 3 mm".to_string())];
    let compilation = compile_file(&graph, &file, &set);
    let value = |name: &str| {
        let parameters = &compilation.jobs[0].parameters;
        parameters.iter().find(|parameter| parameter.name == name).expect("a parameter").value
    };
    assert_eq!([value("height"), value("m.height"), value("b.radius")], [25.4, 25.4, 6.0]);
    assert_eq!(codes(&file, &[("hieght", "3 mm")]), [Code::UnknownName]);
    assert_eq!(codes(&file, &[("height", "3 deg")]), [Code::WrongDimension]);
    assert_eq!(codes(&file, &[("height", "3 *")]), [Code::Syntax]);
    assert_eq!(codes(&file, &[("m.height", "m.height")]), [Code::UnknownName]);
}

#[test]
fn jobs_are_taken_by_name() {
    let two = format!("{JOB}{}", JOB.replace("job j", "job other").replace("use", "//"));
    let folder = project("jobs", &[("library.chain", LIBRARY), ("jobs/j.chain", &two)]);
    let taken = |file: &str, wanted: Option<&str>| {
        let graph = Graph::new();
        let mut compilation = compile_file(&graph, &folder.join(file), &[]);
        assert!(!compilation.has_errors());
        let jobs = compilation.take_jobs(wanted).map_err(|finding| {
            let _ = render(std::slice::from_ref(&finding), &compilation.sources, false);
            (vec![finding.code], finding.help.unwrap_or_default())
        });
        jobs.map(|jobs| jobs.iter().map(|job| job.name.clone()).collect::<Vec<_>>())
    };
    assert_eq!(taken("jobs/j.chain", None), Ok(vec!["j".to_string(), "other".to_string()]));
    assert_eq!(taken("jobs/j.chain", Some("other")), Ok(vec!["other".to_string()]));
    let (codes, help) = taken("jobs/j.chain", Some("othr")).expect_err("no such job");
    assert_eq!(codes, [Code::NoJob]);
    assert_eq!(help, "did you mean `other`?");
    let (codes, _) = taken("library.chain", Some("j")).expect_err("no job");
    assert_eq!(codes, [Code::NoJob]);
}
