//! Files that use each other, and values from outside.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::{
    Buffers, Code, Disk, Request, Severity, compile_file, compile_request, compile_text, compile_with_machine, render,
};
use flank_expr::Graph;

/// A project folder of its own with some files.
pub(crate) fn project(name: &str, files: &[(&str, &str)]) -> PathBuf {
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
fn a_use_of_no_file_says_so() {
    let folder = project("nameless", &[("a.chain", "use \"\"")]);
    let graph = Graph::new();
    let found = compile_file(&graph, &folder.join("a.chain"), &[]).diagnostics;
    let told: Vec<(Code, &str)> = found.iter().map(|finding| (finding.code, finding.message.as_str())).collect();
    assert_eq!(told, [(Code::UnreadableFile, "no file is named here")]);
}

#[test]
fn files_that_are_used_are_counted() {
    let limit = |files: Vec<(String, String)>| {
        let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
        let folder = project("many", &files);
        let graph = Graph::new();
        let told = compile_file(&graph, &folder.join("f0.chain"), &[]).diagnostics;
        assert!(told.iter().all(|finding| finding.code == Code::LimitExceeded), "{told:?}");
        told.first().map_or(String::new(), |finding| finding.message.clone())
    };
    let file = |k: usize, text: String| (format!("f{k}.chain"), text);
    let all = |count: usize| (1..count).map(|k| format!("use \"f{k}.chain\"\n")).collect::<String>();
    let wide = |count: usize, text: &str| {
        (0..count).map(|k| file(k, if k == 0 { all(count) } else { text.to_string() })).collect::<Vec<_>>()
    };
    assert_eq!(limit(wide(256, "")), "");
    assert_eq!(limit(wide(257, "")), "more than 256 files are used");
    let large = "// large\n".repeat(100_000);
    assert_eq!(limit(wide(6, &large)), "");
    assert_eq!(limit(wide(8, &large)), "the files that are used are more than 4 MiB together");
    let line = |count: usize| (0..count).map(|k| file(k, format!("use \"f{}.chain\"", (k + 1) % count))).collect();
    let deep: Vec<(String, String)> = line(40);
    assert_eq!(limit(deep), "files use each other more than 32 deep");
}

/// A device without an end: neither waited for nor read.
#[cfg(unix)]
#[test]
fn only_plain_files_are_read() {
    assert_eq!(codes(Path::new("/dev/zero"), &[]), [Code::UnreadableFile]);
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

const TOOL: &str = r#"
tool relieved {
    let relief = curve("tables/relief.csv", s: length, depth: length)
    let turn = curve("tables/relief.csv", s: length, turn: angle)
    surface flank(s: length in 0 mm .. 4 mm, v: length in -5 mm .. 5 mm) {
        at = [relief(s) + 1 mm / 1 rad * turn(s), s, v]
        body towards [-1, 0, 0]
    }
}
"#;

/// depth = s² / 100 in mm, turn = s in degrees.
const TABLE: &str = "# measured\ns [mm], depth [um], turn\n0, 0, 0\n1, 10, 1\n2, 40, 2\n4, 160, 4\n";

#[test]
fn a_curve_comes_from_two_columns_of_a_table() {
    let job = format!(
        "use \"library.chain\"\n{TOOL} job j {{
            machine m = lathe(height: 3 mm)
            tool t = relieved
            mount t on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 0 mm
            surface s in m.work = envelope(t.flank, over: turn)
        }}"
    );
    let files = [("library.chain", LIBRARY), ("j.chain", job.as_str()), ("tables/relief.csv", TABLE)];
    let folder = project("curve", &files);
    let graph = Graph::new();
    let compilation = compile_file(&graph, &folder.join("j.chain"), &[]);
    assert!(compilation.diagnostics.is_empty(), "{:?}", compilation.diagnostics);
    let surface = &compilation.jobs[0].surfaces[0];
    let x = surface.generation.position().0[0];
    let s = surface.unknowns[0].variable;
    let mut values = vec![f64::NAN; graph.variable_count()];
    values[s.as_variable().expect("a variable").index()] = 3.0;
    let found = graph.evaluate(&[x, x.derivative(s), x.derivative(s).derivative(s)], &values);
    let expected = [0.09 + 3f64.to_radians(), 0.06 + 1f64.to_radians(), 0.02];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
}

/// Whatever a surface depends on is among the texts, once each: their hash stands for it.
#[test]
fn tables_are_among_the_texts_that_were_read() {
    // as spreadsheets write it, with a byte order mark that is none of its text
    let table = format!("\u{feff}{TABLE}");
    let folder = project("texts", &[("tools/t.chain", TOOL), ("tools/tables/relief.csv", &table)]);
    let graph = Graph::new();
    let compilation = compile_file(&graph, &folder.join("tools/../tools/t.chain"), &[]);
    let texts: Vec<(PathBuf, &str)> =
        compilation.sources.files().map(|(_, file)| (file.path.clone(), file.text.as_str())).collect();
    let known = [folder.join("tools/../tools/t.chain"), folder.join("tools/tables/relief.csv")];
    assert_eq!(texts, [(known[0].clone(), TOOL), (known[1].clone(), TABLE)]);
}

/// What the command line gives is shown like a file and is none.
#[test]
fn texts_know_their_files() {
    let folder = project("real", &[("tools/t.chain", TOOL), ("tools/tables/relief.csv", TABLE)]);
    let graph = Graph::new();
    let set = [("height".to_string(), "2 mm".to_string())];
    let compilation = compile_file(&graph, &folder.join("tools/../tools/t.chain"), &set);
    let files: Vec<Option<PathBuf>> = compilation.sources.files().map(|(_, source)| source.file.clone()).collect();
    let real = |path: &str| Some(std::fs::canonicalize(folder.join(path)).expect("it is there"));
    assert_eq!(files, [real("tools/t.chain"), None, real("tools/tables/relief.csv")]);
}

/// `link/..` is the folder above the one that the link leads to, not the one that holds the link.
#[cfg(unix)]
#[test]
fn tables_are_found_behind_links_of_folders() {
    let files = [("deep/t.chain", TOOL), ("deep/tables/relief.csv", TABLE), ("deep/sub/j.chain", "use \"../t.chain\"")];
    let folder = project("linked_folder", &files);
    std::os::unix::fs::symlink(folder.join("deep/sub"), folder.join("link")).expect("a link");
    assert_eq!(codes(&folder.join("link/j.chain"), &[]), []);
}

/// Three points on a line in a row, one after the other at these places.
fn splined(points: [&str; 3]) -> String {
    let points: Vec<String> = points.iter().map(|x| format!("[{x} mm, 0 mm]")).collect();
    format!(
        "tool t {{
            profile p {{ s = spline([{}]) }}
            surface f(s: along p, v: length in 0 mm .. 1 mm) {{
                at = [p(s)[0], v, p(s)[1]]
                body towards [0, 0, 1]
            }}
        }}",
        points.join(", ")
    )
}

#[test]
fn splines_that_numbers_cannot_hold_are_told() {
    let check = |points: [&str; 3]| {
        let graph = Graph::new();
        let found = flank_chain_dsl::compile_text(&graph, "t", &splined(points), &[]).diagnostics;
        found.into_iter().map(|finding| (finding.code, finding.message)).collect::<Vec<_>>()
    };
    assert_eq!(check(["0", "1", "2"]), []);
    let told = |message: &str| vec![(Code::BrokenProfile, format!("over the run of this spline, {message}"))];
    assert_eq!(check(["-1e308", "1e308", "2"]), told("point 1 is not finite"));
    assert_eq!(check(["-1e20", "0", "1"]), told("x does not increase at point 2"));
}

#[test]
fn wrong_tables_are_told() {
    let check = |name: &str, tool: &str, table: &str| {
        let folder = project(name, &[("t.chain", tool), ("tables/relief.csv", table)]);
        codes(&folder.join("t.chain"), &[])
    };
    assert_eq!(check("table-right", TOOL, TABLE), []);
    assert_eq!(
        check("table-missing", &TOOL.replace("relief.csv\", s: length, depth", "relif.csv\", s: length, depth"), TABLE),
        [Code::UnreadableFile]
    );
    assert_eq!(
        check("table-outside", &TOOL.replacen("tables/relief.csv", "/etc/hostname", 1), TABLE),
        [Code::OutsideProject]
    );
    assert_eq!(check("table-column", TOOL, &TABLE.replace("depth", "height")), [Code::WrongTable]);
    assert_eq!(check("table-number", TOOL, &TABLE.replace("40", "4o")), [Code::WrongTable]);
    let with_another = TABLE.replace("turn", "turn, depth [um]").replace("0, 0, 0", "0, , 0, 0");
    // each row has one of both
    let each =
        with_another.replace("1, 10, 1", "1, 10, 1,").replace("2, 40, 2", "2, 40, 2,").replace("160, 4", "160, 4,");
    assert_eq!(check("table-each", TOOL, &each), []);
    assert_eq!(check("table-twice", TOOL, &each.replace("40, 2,", "40, 2, 40")), [Code::WrongTable]);
    for (name, cell) in [("nan", "nan"), ("inf", "-inf"), ("overflow", "1e999"), ("of-unit", "1e308")] {
        let table = TABLE.replace("[um]", "[cm]").replace("40", cell);
        assert_eq!(check(&format!("table-{name}"), TOOL, &table), [Code::WrongTable], "{name}");
    }
    let along = "tool t {
        profile p { s = spline(\"tables/relief.csv\", s: length, depth: length) }
        surface f(s: along p, v: length in 0 mm .. 1 mm) { at = [p(s)[0], v, p(s)[1]] body towards [0, 0, 1] }
    }";
    assert_eq!(check("spline-right", along, TABLE), []);
    assert_eq!(check("spline-nan", along, &TABLE.replace("40", "nan")), [Code::WrongTable]);
    assert_eq!(check("table-order", TOOL, &TABLE.replace("2, 40", "1, 40")), [Code::WrongTable; 2]);
    assert_eq!(check("table-unit", TOOL, &TABLE.replace("[um]", "[deg]")), [Code::WrongTable]);
    assert_eq!(
        check("table-dimension", &TOOL.replacen("s: length, depth", "s: lenght, depth", 1), TABLE),
        [Code::UnknownName]
    );
    assert_eq!(check("table-argument", &TOOL.replace("relief(s)", "relief(2 deg)"), TABLE), [Code::WrongDimension]);
    let rows = |count: usize| (0..count).fold(String::from("s, depth, turn\n"), |text, k| text + &format!("{k},1,1\n"));
    assert_eq!(check("table-rows", TOOL, &rows(100_001)), [Code::LimitExceeded; 2]);
    let remark = format!("# {}\n", "-".repeat(10 << 20));
    assert_eq!(check("table-bytes", TOOL, &(remark + TABLE)), [Code::LimitExceeded]);
    assert_eq!(check("table-shape", &TOOL.replacen(", depth: length", "", 1), TABLE), [Code::WrongArguments]);
}

#[test]
fn points_come_from_two_columns_of_a_table() {
    let spec = "machine lathe { axis C : rotary frame bed frame work in bed = rotate_z(C) }
        tool pick {
            surface edge(s: length in 0 mm .. 4 mm) { at = [15 mm - s, 0 mm, s] body towards [1, 0, 0] }
        }
        job j {
            machine m = lathe
            tool p = pick
            mount p on m.bed
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            surface s in m.work = sweep(p.edge, over: turn)
            sample s { points: table(\"gauge.csv\", z: length, turn: angle) }
        }";
    let table = "turn [deg], z [um]\n10, 3000\n45, 1000\n20, 2500\n";
    let check = |name: &str, spec: &str, table: &str| {
        let folder = project(name, &[("t.chain", spec), ("gauge.csv", table)]);
        codes(&folder.join("t.chain"), &[])
    };
    assert_eq!(check("points-right", spec, table), []);
    let folder = project("points-right", &[("t.chain", spec), ("gauge.csv", table)]);
    let graph = Graph::new();
    let compilation = compile_file(&graph, &folder.join("t.chain"), &[]);
    let sample = compilation.jobs[0].surfaces[0].sample.as_ref().expect("a sample");
    assert_eq!(sample.counts, [1, 3]);
    let turns = [10.0f64, 45.0, 20.0].map(f64::to_radians);
    for ((found, z), turn) in sample.targets().iter().zip([3.0, 1.0, 2.5]).zip(turns) {
        assert!((found[0] - z).abs() < 1e-15 && (found[1] - turn).abs() < 1e-15, "{found:?}");
    }
    assert_eq!(check("points-empty", spec, "turn [deg], z [um]\n"), [Code::SampleShape]);
    assert_eq!(check("points-beside", &spec.replace("points:", "z: 3 mm, points:"), table), [Code::SampleShape]);
    assert_eq!(check("points-key", &spec.replace("points:", "z:"), table), [Code::SampleShape]);
    assert_eq!(
        check("points-coordinate", &spec.replace("turn: angle) }", "tern: angle) }"), table),
        [Code::UnknownName]
    );
    assert_eq!(
        check("points-dimension", &spec.replace("turn: angle) }", "turn: length) }"), table),
        [Code::WrongDimension]
    );
    assert_eq!(check("points-column", spec, &table.replace("z [um]", "rho [um]")), [Code::WrongTable]);
    assert_eq!(check("points-unit", spec, &table.replace("[um]", "[deg]")), [Code::WrongTable]);
    assert_eq!(check("points-missing", &spec.replace("gauge.csv", "gage.csv"), table), [Code::UnreadableFile]);
}

#[test]
fn jobs_are_taken_by_name() {
    let two = format!("{JOB}{}", JOB.replace("job j", "job other").replace("use", "//"));
    let folder = project("jobs", &[("library.chain", LIBRARY), ("jobs/j.chain", &two)]);
    let taken = |file: &str, wanted: Option<&str>| {
        let graph = Graph::new();
        let mut compilation = compile_file(&graph, &folder.join(file), &[]);
        assert!(!compilation.has_errors());
        let jobs = compilation.take_jobs(wanted.as_slice()).map_err(|findings| {
            let _ = render(&findings, &compilation.sources, false);
            let help = findings.iter().find_map(|finding| finding.help.clone()).unwrap_or_default();
            (findings.iter().map(|finding| finding.code).collect::<Vec<Code>>(), help)
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

/// All values from outside are looked at, whatever is wrong with the first.
#[test]
fn all_wrong_values_from_outside_are_told() {
    let own = JOB.replace("job j {", "job j {\n    param width : length in 1 mm .. 3 mm = 1 mm");
    let folder = project("set-all", &[("library.chain", LIBRARY), ("jobs/j.chain", &own)]);
    let told = |set: &[(&str, &str)]| -> Vec<String> {
        let set: Vec<(String, String)> =
            set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        let graph = Graph::new();
        let compilation = compile_file(&graph, &folder.join("jobs/j.chain"), &set);
        compilation.diagnostics.iter().map(|finding| format!("{} {}", finding.code.as_str(), finding.message)).collect()
    };
    assert_eq!(
        told(&[("foo", "1"), ("bar", "2")]),
        ["E0201 there is no parameter `foo`", "E0201 there is no parameter `bar`"]
    );
    let codes = |set: &[(&str, &str)]| -> Vec<String> { told(set).iter().map(|told| told[..5].to_string()).collect() };
    assert_eq!(codes(&[("nonsense", "1 mm"), ("width", "2")]), ["E0201", "E0301"]);
    assert_eq!(codes(&[("width", "4 mm"), ("nonsense", "1 mm")]), ["E0307", "E0201"]);
    assert_eq!(codes(&[("width", ")"), ("nonsense", "1 mm")]), ["E0101", "E0201"]);
}

/// A value that only another job takes would change nothing of the one that is asked for.
#[test]
fn a_value_from_outside_belongs_to_a_job_that_is_asked_for() {
    let other = JOB
        .replace("job j {", "job other {\n    param extra : length = 1 mm\n    param more : length = 1 mm")
        .replace("use", "//");
    let folder = project("set", &[("library.chain", LIBRARY), ("jobs/j.chain", &format!("{JOB}{other}"))]);
    let set = ["extra", "more"].map(|name| (name.to_string(), "2 mm".to_string()));
    let told = |wanted: Option<&str>| {
        let graph = Graph::new();
        let mut compilation = compile_file(&graph, &folder.join("jobs/j.chain"), &set);
        assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
        let jobs = compilation.take_jobs(wanted.as_slice()).map_err(|findings| {
            let shown = render(&findings, &compilation.sources, false);
            (findings[0].code, shown)
        });
        jobs.map(|jobs| jobs.len())
    };
    assert_eq!(told(None), Ok(2));
    assert_eq!(told(Some("other")), Ok(1));
    let (code, shown) = told(Some("j")).expect_err("`j` has no such parameter");
    assert_eq!(code, Code::UnknownName);
    for part in [
        "job `j` has no parameter `extra`",
        "job `j` has no parameter `more`",
        "extra=2 mm",
        "job `other` has one, and is not asked for",
    ] {
        assert!(shown.contains(part), "{part} in {shown}");
    }
}

/// Whoever asks for one job does not wait for the others; a text that cannot be read is refused all the same.
#[test]
fn a_job_is_compiled_without_those_that_nobody_asks_for() {
    let wrong = JOB.replace("job j {", "job other {\n    param extra : length = 1 deg").replace("use", "//");
    let folder = project("asked", &[("library.chain", LIBRARY), ("jobs/j.chain", &format!("{JOB}{wrong}"))]);
    let file = folder.join("jobs/j.chain");
    let found = |whole: bool, set: &[(String, String)]| {
        let graph = Graph::new();
        let request = Request { jobs: vec!["j"], set, whole, ..Request::default() };
        let compilation = compile_request(&graph, &file, &request);
        let names: Vec<String> = compilation.jobs.iter().map(|job| job.name.clone()).collect();
        let is_indexed = !compilation.index.entries.is_empty();
        let errors = compilation.diagnostics.iter().filter(|finding| finding.severity() == Severity::Error);
        (names, errors.map(|finding| finding.code).collect::<Vec<Code>>(), is_indexed)
    };
    assert_eq!(found(false, &[]), (vec!["j".to_string()], vec![], false));
    assert_eq!(found(true, &[]), (vec![], vec![Code::WrongDimension], true));
    // a value that `j` does not have may be one of `other`, which has to be looked at then
    let set = [("extra".to_string(), "2 mm".to_string())];
    assert_eq!(found(false, &set).1, [Code::WrongDimension]);
    std::fs::write(&file, format!("{JOB}job broken {{")).expect("the file");
    assert!(!found(false, &[]).1.is_empty(), "a text that does not parse");
}

/// A machine that a job is carried over to has a project of its own, as the job has.
#[test]
fn a_machine_beside_a_job_uses_files_of_its_own_project() {
    let own = project("beside_job", &[("library.chain", LIBRARY), ("jobs/j.chain", JOB)]);
    let machine = "use \"../plain.chain\"\nmachine other extends plain {}\n";
    let plain = "machine plain {\n    axis X : linear\n    frame bed\n    frame slide in bed = translate_x(X)\n}\n";
    let other = project("beside_machine", &[("plain.chain", plain), ("machines/other.chain", machine)]);
    let graph = Graph::new();
    let made =
        compile_with_machine(&graph, &own.join("jobs/j.chain"), &other.join("machines/other.chain"), &[]).diagnostics;
    assert!(made.iter().all(|finding| finding.severity() != Severity::Error), "{made:?}");
}

/// The target of a conversion may be made of what stands in the job's own file, which is then read before it.
#[test]
fn a_machine_beside_a_job_may_use_the_file_of_the_job() {
    let machine = "use \"j.chain\"\nmachine other {\n    axis X : linear\n    frame bed\n    frame slide in bed = translate_x(X)\n}\n";
    let files = [("library.chain", LIBRARY), ("jobs/j.chain", JOB), ("jobs/other.chain", machine)];
    let folder = project("beside_own", &files);
    let graph = Graph::new();
    let mut made = compile_with_machine(&graph, &folder.join("jobs/j.chain"), &folder.join("jobs/other.chain"), &[]);
    assert!(made.diagnostics.iter().all(|finding| finding.severity() != Severity::Error), "{:?}", made.diagnostics);
    assert_eq!(made.machine.as_ref().map(|machine| machine.machines[0].name.as_str()), Some("other"));
    let jobs = made.take_jobs(&["j"]).expect("it is a job of the file that was asked for");
    assert_eq!(jobs.len(), 1);
}

/// A text that comes from elsewhere stands where its file would.
#[test]
fn a_text_is_read_in_the_place_of_its_file() {
    let folder = project("text", &[("library.chain", LIBRARY), ("jobs/j.chain", "job of old")]);
    for name in ["jobs/j.chain", "jobs/new.chain"] {
        let graph = Graph::new();
        let file = folder.join(name);
        let files = Arc::new(Buffers::over(Arc::new(Disk)).with(&file, JOB));
        let compilation = compile_request(&graph, &file, &Request { files, ..Request::default() });
        assert!(compilation.diagnostics.is_empty(), "{name}: {:?}", compilation.diagnostics);
        assert_eq!(compilation.jobs.len(), 1);
    }
}

/// A name from outside means one thing.
#[test]
fn a_name_that_could_be_two_things_is_told() {
    let job = JOB.replace("job j", "job m");
    let folder = project("two_things", &[("library.chain", LIBRARY), ("jobs/j.chain", &job)]);
    let file = folder.join("jobs/j.chain");
    // of job `m`, and of the machine that it calls `m`
    assert_eq!(codes(&file, &[("m.height", "2 mm")]), [Code::DuplicateName]);
    let value = |name: &str, of: &str| {
        let graph = Graph::new();
        let set = [(name.to_string(), "2 mm".to_string())];
        let compilation = compile_request(&graph, &file, &Request { jobs: vec!["m"], set: &set, ..Request::default() });
        let parameters = &compilation.jobs[0].parameters;
        parameters.iter().find(|parameter| parameter.name == of).expect("a parameter").value
    };
    assert_eq!([value("height", "height"), value("height", "m.height")], [2.0, 2.0]);
    assert_eq!([value("m.m.height", "height"), value("m.m.height", "m.height")], [3.0, 2.0]);
}

/// What a file that cannot be read would declare is not said to be missing, what one that was read lacks is.
#[test]
fn names_of_a_file_that_is_not_there_are_not_reported() {
    let used = "use \"gone.chain\"\nmachine n extends cradle { frame bed }\n";
    let job = "job j {\n    machine m = lathe(height: 2 mm)\n    let n = twice(2)\n    tool b = ball\n    mount b on m.slide\n    \
               motion turn : angle in 0 deg .. 90 deg\n    drive m.C = turn\n    \
               surface s in m.work = envelope(b.face, over: turn)\n}\n";
    let folder = project("gone", &[("j.chain", &format!("{used}{job}")), ("k.chain", job)]);
    assert_eq!(codes(&folder.join("j.chain"), &[]), [Code::UnreadableFile]);
    assert_eq!(codes(&folder.join("k.chain"), &[]), [Code::UnknownName; 3]);
    let graph = Graph::new();
    let text = compile_text(&graph, "j", &format!("{used}{job}"), &[]);
    assert_eq!(text.diagnostics.iter().map(|finding| finding.code).collect::<Vec<_>>(), [Code::UnreadableFile]);
}

#[test]
fn a_file_that_declares_nothing_says_so() {
    let folder = project(
        "empty",
        &[("a.chain", ""), ("b.chain", "// machine m { frame bed }\n"), ("c.chain", "use \"a.chain\"")],
    );
    assert_eq!(codes(&folder.join("a.chain"), &[]), [Code::EmptyFile]);
    assert_eq!(codes(&folder.join("b.chain"), &[]), [Code::EmptyFile]);
    assert_eq!(codes(&folder.join("c.chain"), &[]), []);
}

/// Half of a value from outside is none: nothing follows from it.
#[test]
fn a_decimal_comma_from_outside_is_one_finding() {
    let folder = project("comma", &[("library.chain", LIBRARY), ("jobs/j.chain", JOB)]);
    assert_eq!(codes(&folder.join("jobs/j.chain"), &[("height", "2,5 mm")]), [Code::Syntax]);
}

/// Of a gear without teeth nothing can be asked for. That is told where the zero is written, once, and not of each surface.
#[test]
fn a_count_of_zero_is_told_where_it_is_written() {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/tutorial/first_gear.chain");
    let graph = Graph::new();
    let set = [("teeth".to_string(), "0".to_string())];
    let found = compile_file(&graph, &spec, &set).diagnostics;
    let of_samples = found.iter().filter(|finding| finding.code == Code::SampleShape);
    let told: Vec<&str> = of_samples.map(|finding| finding.message.as_str()).collect();
    assert!(!told.is_empty(), "{found:?}");
    assert!(
        told.len() < 3 && told.iter().all(|message| message.starts_with("`teeth` is 0: nothing is left of")),
        "{told:?}"
    );
}

/// The same in the text: what stands before the comma is no value that could lack a unit.
#[test]
fn a_decimal_comma_in_the_text_is_one_finding() {
    let job = JOB.replacen(" mm", ",5 mm", 1);
    assert_ne!(job, JOB);
    let folder = project("comma_in_text", &[("library.chain", LIBRARY), ("jobs/j.chain", &job)]);
    assert_eq!(codes(&folder.join("jobs/j.chain"), &[]), [Code::Syntax]);
}

/// A grid of points: what is wrong of its rows, and of how it is asked for.
#[test]
fn large_tables_are_refused() {
    let found = |rows: String, value: &str| {
        let tool = format!(
            "tool t {{
                let value = {value}
                surface s(u: length in 0 mm .. 1 mm, v: length in 0 mm .. 1 mm) {{
                    at = [u, v, 0 mm]
                    body towards [0, 0, 1]
                }}
            }}"
        );
        let folder = project("large", &[("p.csv", &rows), ("t.chain", &tool)]);
        let graph = Graph::new();
        let findings = compile_file(&graph, &folder.join("t.chain"), &[]).diagnostics;
        findings.iter().map(|finding| format!("{} {}", finding.code.as_str(), finding.message)).collect::<Vec<_>>()
    };
    let rows =
        |count: usize| (0..count).fold("u,v,w\n".to_string(), |rows, k| rows + &format!("{},{},{k}\n", k / 41, k % 41));
    let (curve, grid) = ("curve(\"p.csv\", w: length, v: length)", "grid(\"p.csv\", u: length, v: length, w: length)");
    assert_eq!(found(rows(48 * 41), grid), [""; 0]);
    assert_eq!(found(rows(49 * 41), grid), ["E0004 a grid of more than 2,000 points"]);
    assert_eq!(found(rows(100_001), curve), ["E0004 a table of more than 100,000 rows"]);
    assert_eq!(found(rows(2) + &"\n".repeat(16 << 20), curve), ["E0004 the tables are more than 16 MiB together"]);
}

#[test]
fn a_grid_is_whole_and_does_not_fold() {
    let tool = |call: &str, at: &str| {
        format!(
            "tool t {{
                let point = {call}
                surface s(u: number in 0 .. 2, v: number in 0 .. 1) {{
                    at = {at}
                    body towards [0, 0, 1]
                }}
            }}"
        )
    };
    let all = "grid(\"p.csv\", i: number, j: number, x: length, y: length, z: length)";
    let found = |rows: &str, call: &str, at: &str| {
        let folder = project("grid", &[("p.csv", rows), ("t.chain", &tool(call, at))]);
        let graph = Graph::new();
        let findings = compile_file(&graph, &folder.join("t.chain"), &[]).diagnostics;
        findings.iter().map(|finding| format!("{} {}", finding.code.as_str(), finding.message)).collect::<Vec<_>>()
    };
    let head = "surface,i,j,x,y,z,status\n";
    let row = |i: u32, j: u32, x: f64| format!("a,{i},{j},{x},{j},0.5,solved\n");
    let rows: Vec<String> = (0..6).map(|k| row(k / 2, k % 2, f64::from(k / 2))).collect();
    let whole = format!("{head}{}", rows.concat());
    assert_eq!(found(&whole, all, "point(u, v)"), [""; 0]);
    // rows of another side, and points that are not solved, are not looked at
    let others = format!("{whole}b,0,0,1,1,1,solved\na,0,0,9,9,9,undercut\n");
    let picked = all.replace("i: number", "\"a\", i: number");
    assert_eq!(found(&others, &picked, "point(u, v)"), [""; 0]);
    let wrong = [
        (others, all, "point(u, v)", "E0005 `p.csv`: two rows have `i` = 0 and `j` = 0"),
        (
            format!("{head}{}", rows[1..].concat()),
            all,
            "point(u, v)",
            "E0005 `p.csv`: the grid has a hole: no row, or none that is solved, has `i` = 0 and `j` = 0",
        ),
        (
            whole.replace("a,1,1,1,", "a,1,1,-3,"),
            all,
            "point(u, v)",
            "E0005 `p.csv`: the surface folds, or has no area, beside the point with `i` = 1 and `j` = 1",
        ),
        (
            format!("{head}{}", rows[..2].concat()),
            all,
            "point(u, v)",
            "E0005 `p.csv`: a grid needs at least two values of `i`",
        ),
        (
            whole.clone(),
            "grid(\"p.csv\", \"nope\", i: number, j: number, x: length, y: length, z: length)",
            "point(u, v)",
            "E0005 `p.csv`: no row of it that is solved has `nope` as `surface`",
        ),
        (
            whole.clone(),
            "grid(\"p.csv\", flank: \"a\", i: number, j: number, x: length)",
            "[point(u, v), 0 mm, 0 mm]",
            "E0005 `p.csv`: there is no column `flank`; there is: surface, i, j, x, y, z, status",
        ),
        (
            whole.clone(),
            "grid(\"p.csv\", i: number, j: number)",
            "point(u, v)",
            "E0302 `grid` takes a file and the names and dimensions of its columns: two that count, one or more with values",
        ),
        (whole.clone(), all, "point(u)", "E0302 `point` takes 2 arguments, not 1"),
        (whole, all, "point", "E0301 the point must be a vector of 3, this is a grid"),
    ];
    for (rows, call, at, message) in wrong {
        let found = found(&rows, call, at);
        assert_eq!(found, [message], "{call} at {at}");
    }
}
