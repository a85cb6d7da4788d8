//! `flank solve` as a user runs it: output, files, exit codes.

mod support;

use std::path::Path;
use std::process::Output;

use support::{flank, folder, self_contained, text, top, written};

#[test]
fn solve_writes_points_and_pictures() {
    let out = folder("solve");
    let run = flank(&[
        "solve",
        "specs/hobbing/helical_gear.chain",
        "--out",
        out.to_str().unwrap(),
        "--format",
        "csv,json,stl",
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in ["lower_flank", "upper_flank", "651", "worst residual", "spindle"] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    assert!(text(&run.stderr).contains("1302 points in"), "{}", text(&run.stderr));
    for extension in ["csv", "json", "stl", "png", "svg"] {
        let path = out.join(format!("helical_gear.{extension}"));
        assert!(std::fs::metadata(&path).is_ok_and(|file| file.len() > 1000), "{}", path.display());
    }
    let csv = std::fs::read_to_string(out.join("helical_gear.csv")).unwrap();
    let head = csv.lines().find(|line| !line.starts_with('#')).unwrap();
    assert_eq!(head, "surface,i,j,x,y,z,nx,ny,nz,xi,tau,spindle,feed,residual,status");
    assert_eq!(csv.lines().filter(|line| line.ends_with(",solved")).count(), 1302);
}

/// Columns of the rows of a surface in a CSV file.
fn columns(out: &Path, surface: &str, names: [&str; 3]) -> Vec<[f64; 3]> {
    let csv = std::fs::read_to_string(out.join("helical_gear.csv")).expect("written");
    let mut lines = csv.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let places = names.map(|name| head.iter().position(|column| *column == name).expect("a column"));
    let rows = lines.filter(|row| row[0] == surface && row.ends_with(&["solved"]));
    rows.map(|row| places.map(|at| row[at].parse().expect("a number"))).collect()
}

/// In no order, so that each point is far from the one before.
#[test]
fn points_of_a_table_are_those_of_the_grid() {
    let at = folder("solve-table");
    let spec = self_contained(&[
        "machines/hobbing_6axis",
        "tools/involute",
        "tools/hob_zi",
        "functions/hobbing",
        "hobbing/helical_gear",
    ]);
    let run = |name: &str, text: &str| {
        let out = at.join(name);
        let run =
            flank(&["solve", &written(&at, &format!("{name}.chain"), text), "--out", out.to_str().expect("plain")]);
        (out, run)
    };
    let (grid, solved) = run("grid", &spec);
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let mut points = columns(&grid, "lower_flank", ["x", "y", "z"]);
    assert_eq!(points.len(), 651);
    // 260 and 651 have no common factor
    points = (0..points.len()).map(|k| points[260 * k % 651]).collect();
    let rows = points.iter().map(|[x, y, z]| format!("{z:?},{:?}\n", x.hypot(*y))).collect::<String>();
    written(&at, "gauge.csv", &format!("z [mm],rho [mm]\n{rows}"));
    let from = spec.find("sample lower_flank, upper_flank for").expect("a sample");
    let (head, rest) = spec.split_at(from);
    let rest = rest.lines().enumerate().map(|(k, line)| match k {
        1 => "points: table(\"gauge.csv\", z: length, rho: length)\n".to_string(),
        2 => String::new(),
        _ => format!("{line}\n"),
    });
    let (table, solved) = run("table", &(head.to_string() + &rest.collect::<String>()));
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let found = columns(&table, "lower_flank", ["x", "y", "z"]);
    assert_eq!(found.len(), 651);
    for (found, point) in found.iter().zip(&points) {
        // both solve to rounding; rho of the table is rounded
        assert!((0..3).all(|k| (found[k] - point[k]).abs() < 1e-11), "{found:?} {point:?}");
    }

    let svg = std::fs::read_to_string(table.join("helical_gear.svg")).expect("drawn");
    assert!(!svg.contains("of 1 x 651 points"), "all of them are drawn");
}

/// A table says as much of the points as the spec: another cell is another hash.
#[test]
fn the_hash_of_a_spec_is_also_that_of_its_tables() {
    let at = folder("hash");
    let out = at.to_str().expect("a plain path");
    let spec = written(
        &at,
        "relieved.chain",
        "machine lathe { axis C : rotary frame bed frame work in bed = rotate_z(C) }
        tool pick {
            let relief = curve(\"relief.csv\", s: length, depth: length)
            surface edge(s: length in 0 mm .. 4 mm) { at = [15 mm - relief(s), 0 mm, s] body towards [1, 0, 0] }
        }
        job j {
            machine m = lathe
            tool p = pick
            mount p on m.bed
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            surface s in m.work = sweep(p.edge, over: turn)
            sample s { z: 1 mm .. 3 mm by 2, turn: 10 deg .. 80 deg by 2 }
        }",
    );
    let hash = |depth: &str| {
        written(&at, "relief.csv", &format!("s, depth\n0, 0\n2, {depth}\n4, 0\n"));
        let run = flank(&["solve", &spec, "--no-picture", "--format", "json", "--out", out]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let points = std::fs::read(at.join("j.json")).expect("it is written");
        let points: serde_json::Value = serde_json::from_slice(&points).expect("JSON");
        points["spec_hash"].as_str().expect("a hash").to_string()
    };
    assert_eq!(hash("0.5"), hash("0.5"));
    assert_ne!(hash("0.5"), hash("0.6"));
}

/// Ten teeth are cut under: the singular line is on the base circle, at u = r sin²α / cos α.
#[test]
fn limits_are_listed_and_written() {
    let out = folder("limits");
    let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--set", "teeth=10", "--set", "module=5 mm", "--limits"];
    let more = ["--set", "profile_shift=0", "--set", "r.tip_height=6.25 mm", "--set", "r.tip_radius=1.9 mm", "--json"];
    let run = flank(&[&arguments[..], &more[..], &["--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let lines = table["lines"].as_array().expect("lines");
    let line = |name: &str| lines.iter().find(|line| line["name"] == name).expect("the line is listed");
    assert_eq!(line("flank_plus.singular_line")["solved"], 25);
    assert_eq!(line("fillet_plus.singular_line")["solved"], 0);
    assert_eq!(line("flank_plus.contact_limit")["solved"], 0);
    let u = line("flank_plus.singular_line")["ranges_reached"][2]["low"].as_f64().unwrap();
    let alpha = 20f64.to_radians();
    assert!((u - 25.0 * alpha.sin().powi(2) / alpha.cos()).abs() < 1e-9, "{u}");
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    assert_eq!(csv.lines().filter(|row| row.starts_with("flank_plus.singular_line,")).count(), 25);
    assert!(!csv.contains("contact_limit,"));
}

/// The flank of a spur gear bends as 1/√(R² − r_b²), and the whole tooth along its length not at all.
#[test]
fn geometry_is_listed_and_written() {
    let out = folder("geometry");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--geometry", "--no-picture", "--out", out.to_str().unwrap()];
    let run = flank(&base);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in ["flank_plus", "k1", "1/mm", "sliding_angle", "90.000000  deg", "induced_k1", "metric_e"] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    assert!(!table.contains("-0.000000 ") && !table.contains("NaN"), "{table}");
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        csv.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).expect("a column");
    let number = |row: &[&str], name: &str| -> f64 { row[column(name)].parse().expect("a number") };
    let base_radius = 36.0 * 20f64.to_radians().cos();
    let points: Vec<&Vec<&str>> = rows.iter().filter(|row| row[0] == "flank_plus").collect();
    assert_eq!(points.len(), 275);
    for row in points {
        let involute = 1.0 / (number(row, "x").hypot(number(row, "y")).powi(2) - base_radius.powi(2)).sqrt();
        assert!((number(row, "k1") / involute - 1.0).abs() < 1e-9 && number(row, "k2").abs() < 1e-12);
        assert!((number(row, "d2_z").abs() - 1.0).abs() < 1e-9 && (number(row, "contact_line_z") - 1.0).abs() < 1e-9);
    }
    let json = flank(&[&base[..], &["--json"]].concat());
    let table: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let field = &table["surfaces"][0]["fields"][0];
    assert_eq!(
        (field["name"].as_str(), field["unit"].as_str(), field["undefined"].as_u64()),
        (Some("k1"), Some("1/mm"), Some(0))
    );
}

/// Points that the job's own `trim`s and the tool itself take away are counted by what takes them, and asked for in vain.
#[test]
fn what_is_cut_away_is_counted() {
    let out = folder("cut-away");
    let run = flank(&[
        "solve",
        "specs/hobbing/undercut_gear.chain",
        "--json",
        "--no-picture",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(run.status.code(), Some(3));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let outcomes = &table["surfaces"][0]["outcomes"];
    assert_eq!(outcomes["solved"], 189, "{outcomes}");
    assert_eq!((&outcomes["undercut"], &outcomes["trimmed"]), (&70.into(), &28.into()), "{outcomes}");
    assert_eq!(table["lines"][0]["name"], "flank_plus.trimmed_by_fillet_plus");
    assert_eq!(table["lines"][0]["solved"], 7);
    let told = text(&run.stderr);
    assert!(told.contains("70: cut away by the tool itself"), "{told}");
    assert!(told.contains("28: cut away by what makes fillet_plus, as `trim` asks for"), "{told}");
    let csv = std::fs::read_to_string(out.join("undercut_gear.csv")).unwrap();
    let rows_with =
        |status: &str| csv.lines().filter(|row| row.starts_with("flank_plus,") && row.contains(status)).count();
    assert_eq!([rows_with(",undercut,"), rows_with(",trimmed,")], [70, 28]);
}

/// `cut`: what is left goes out with the points, as a map, and as a summary; where no edge passes, that is said.
#[test]
fn what_single_edges_leave_is_listed_written_and_drawn() {
    let out = folder("cut");
    let spec = std::fs::read_to_string(top().join("tests/machines/planed.chain")).expect("the test's machine");
    let spec = written(&out, "planed.chain", &spec);
    let solve = |set: &str| flank(&["solve", &spec, "--json", "--set", set, "--out", out.to_str().unwrap()]);
    let run = solve("feed=0.5 mm");
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let plane = &table["surfaces"][0];
    assert_eq!(plane["cut"], serde_json::json!({ "by": "strokes", "known": 255, "unreached": 0, "undecided": 0 }));
    let left = &plane["fields"][0];
    assert_eq!((left["name"].as_str(), left["unit"].as_str()), (Some("left"), Some("um")));
    // half a feed beside a stroke: 8 - sqrt(8^2 - 0.25^2) mm
    assert!((left["high"].as_f64().unwrap() - 3.907204).abs() < 1e-6, "{left}");
    let csv = std::fs::read_to_string(out.join("planed.csv")).unwrap();
    let titles = csv.lines().find(|line| !line.starts_with('#')).unwrap();
    assert!(titles.ends_with("left,left_by_stroke"), "{titles}");
    assert!(csv.contains("of `strokes` leave over the surface, along its normal; plus is material"));
    for extension in ["png", "svg"] {
        assert!(out.join(format!("planed.plane.left.{extension}")).exists());
    }
    // the edges are counted
    let run = flank(&["solve", &spec, "--no-picture", "--set", "feed=0.5 mm", "--out", out.to_str().unwrap()]);
    let listed = text(&run.stdout);
    let strokes = listed.lines().find(|line| line.contains("left_by_stroke")).expect("it is listed");
    assert!(!strokes.contains(".0") && strokes.contains(" .. "), "{strokes}");
    let run = solve("reach=1 deg");
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(told.contains("what is left is unknown at 130 of 255 points of plane"), "{told}");
    assert!(told.contains("130: no edge of strokes passes there within its ranges"), "{told}");
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let [a, b] = ["bytes-a", "bytes-b"].map(folder);
    for out in [&a, &b] {
        let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--format", "csv,json,stl", "--out"];
        let run = flank(&[&arguments[..], &[out.to_str().unwrap()]].concat());
        assert_eq!(run.status.code(), Some(0));
    }
    for extension in ["csv", "json", "stl", "png", "svg"] {
        let read = |folder: &Path| std::fs::read(folder.join(format!("spur_gear.{extension}"))).unwrap();
        assert_eq!(read(&a), read(&b), "{extension}");
    }
}

#[test]
fn stdout_is_the_same_each_time() {
    let out = folder("same");
    for further in [&[][..], &["--json"]] {
        let arguments = ["solve", "specs/hobbing/spur_gear.chain", "--no-picture", "--out", out.to_str().unwrap()];
        let [a, b] = [(); 2].map(|()| flank(&[&arguments[..], further].concat()));
        assert_eq!(text(&a.stdout), text(&b.stdout));
        assert!(text(&a.stderr).contains("points in"), "{}", text(&a.stderr));
    }
}

#[test]
fn jobs_without_a_sample_are_passed_over() {
    let folder = folder("idle");
    std::fs::write(folder.join("flank.toml"), "").expect("the test's file");
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).unwrap();
    let idle: String = gear.lines().filter(|line| !line.contains("sample")).map(|line| format!("{line}\n")).collect();
    let idle_job = idle[idle.find("job first_gear").unwrap()..idle.find("/// The tool sits").unwrap()].to_string();
    let both = written(&folder, "both.chain", &format!("{gear}{}", idle_job.replace("first_gear", "idle_gear")));
    let none = written(&folder, "none.chain", &idle);
    let solve =
        |further: &[&str]| flank(&[&["solve", "--no-picture", "--out", folder.to_str().unwrap()], further].concat());

    let run = solve(&[&both]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("job first_gear") && text(&run.stdout).contains("job first_helical_gear"));
    assert!(text(&run.stderr).contains("note: job `idle_gear` asks for no points"), "{}", text(&run.stderr));
    for wrong in [&[both.as_str(), "--job", "idle_gear"][..], &[&none]] {
        let run = solve(wrong);
        assert_eq!(run.status.code(), Some(1), "{}", text(&run.stdout));
        assert!(text(&run.stderr).contains("error[E0506]: job `"), "{}", text(&run.stderr));
        assert!(run.stdout.is_empty());
    }
}

#[test]
fn set_changes_a_parameter_and_a_setting() {
    let out = folder("set");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--json", "--no-picture", "--out", out.to_str().unwrap()];
    let plain = flank(&base);
    let changed = flank(&[&base[..], &["--set", "profile_shift=0.25", "--set", "r.tip_radius=1 mm"]].concat());
    assert_eq!(changed.status.code(), Some(0), "{}", text(&changed.stderr));
    let low = |run: &Output| -> f64 {
        let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        table["surfaces"][1]["ranges_reached"][0]["low"].as_f64().expect("a number")
    };
    // the root circle moves with the profile shift
    assert!((low(&changed) - low(&plain) - 0.05 * 3.0).abs() < 1e-3, "{} {}", low(&plain), low(&changed));
}

/// A cutter whose centre is set so far out that it never reaches the blank.
#[test]
fn a_job_without_solution_exits_3_and_writes_statuses() {
    let out = folder("unsolved");
    let arguments = ["solve", "specs/bevel/pinion_19x62.chain", "--set", "m.radial_distance=400 mm", "--out"];
    let run = flank(&[&arguments[..], &[out.to_str().unwrap(), "--geometry", "--sensitivity"]].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    assert!(table.contains("concave: no point is solved, so what moves it is unknown"), "{table}");
    assert!(!table.contains("no influence"), "{table}");
    assert!(text(&run.stderr).contains("not solved: 465 of 465 points of concave\n"), "{}", text(&run.stderr));
    let csv = std::fs::read_to_string(out.join("pinion_19x62.csv")).unwrap();
    let flank_rows: Vec<&str> = csv.lines().filter(|line| line.starts_with("concave,")).collect();
    assert_eq!(flank_rows.len(), 465);
    for row in flank_rows {
        // nor are curvatures or sensitivities
        let row = row.trim_end_matches(',');
        let told = [" iterations", ",not_converged,no start leads there", ",singular"];
        assert!(
            told.iter().any(|end| row.ends_with(end)) || row.contains(",out_of_range,") && row.ends_with(" mm"),
            "{row}"
        );
        assert!(row.contains(",,,,,,"), "no position is invented: {row}");
    }
}

/// What a status leaves open is told of each point: which unknown by how much, and what cuts away.
#[test]
fn statuses_have_reasons() {
    let out = folder("reasons");
    let solve = |arguments: &[&str]| {
        let run = flank(&[&["solve", "--no-picture", "--out", out.to_str().unwrap()], arguments].concat());
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    };
    let told = |name: &str, reason: &str| {
        let csv = std::fs::read_to_string(out.join(name)).unwrap();
        let mut rows = csv.lines().filter(|line| !line.starts_with('#'));
        let titles: Vec<&str> = rows.next().unwrap().split(',').collect();
        assert_eq!(titles[titles.len() - 2..], ["status", "reason"]);
        assert!(rows.any(|row| row.contains(reason)), "no row has {reason}: {csv}");
    };
    solve(&["specs/hobbing/undercut_gear.chain"]);
    told("undercut_gear.csv", "undercut,\"by the tool itself, beyond the singular line of the envelope (undercut)\"");
    told("undercut_gear.csv", "trimmed,\"by what makes fillet_plus, as `trim` asks for\"");
    let spec = self_contained(&["tutorial/first_gear"]);
    let narrow = spec.replace("motion roll : angle in -40 deg .. 40 deg", "motion roll : angle in -5 deg .. 5 deg");
    assert_ne!(spec, narrow);
    solve(&[&written(&out, "narrow.chain", &narrow)]);
    told("first_gear.csv", "out_of_range,roll by ");
}

/// The hob's thread comes by again after a turn: the JSON lists the teeth with what keeps each of them.
#[test]
fn branches_are_listed_as_json() {
    let out = folder("branches");
    let spec = self_contained(&[
        "machines/hobbing_geared",
        "machines/hobbing_3axis",
        "machines/hobbing_6axis",
        "tools/involute",
        "tools/hob_zi",
        "functions/hobbing",
        "hobbing/helical_gear",
    ]);
    let unsaid: Vec<&str> = spec.lines().filter(|line| !line.contains("keep ")).collect();
    let spec = written(&out, "unsaid.chain", &(unsaid.join("\n") + "\n"));
    let run = flank(&["solve", &spec, "--json", "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    assert_eq!(table["schema"], "flank.solve/3");
    let by = table["instructions"].as_str().unwrap();
    assert!(["avx512", "avx2", "interpreted"].contains(&by), "{by}");
    let found = table["surfaces"][0]["branches"]["found"].as_array().unwrap();
    assert!(found.len() > 1, "{found:?}");
    for branch in found {
        let keep = &branch["keep"];
        let unknowns = branch["unknowns"].as_array().unwrap();
        let of = unknowns.iter().find(|unknown| unknown["name"] == keep["name"]).expect("keep names an unknown");
        let [low, at, high] = [&keep["low"], &of["value"], &keep["high"]].map(|x| x.as_f64().unwrap());
        assert!(low < at && at < high, "{branch}");
        let line =
            format!("ranges of {} hold {} branches", table["surfaces"][0]["name"].as_str().unwrap(), found.len());
        assert!(text(&run.stderr).contains(&line), "{}", text(&run.stderr));
    }
}

/// A gear too large for the machine: the radial axis would have to stand at 430 mm.
#[test]
fn an_axis_beyond_its_travel_is_told() {
    let out = folder("travel");
    let arguments = ["solve", "specs/hobbing/helical_gear.chain", "--no-picture", "--set", "teeth=241", "--out"];
    let run = flank(&[&arguments[..], &[out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stderr);
    assert!(told.contains("beyond its travel: axis m.X runs from 428.6"), "{told}");
}

#[test]
fn files_that_cannot_be_written_are_told() {
    let folder = folder("unwritable");
    let blocked = written(&folder, "blocked", "a file, not a folder");
    let run = flank(&["solve", "specs/hobbing/spur_gear.chain", "--out", &blocked]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("blocked"), "{}", text(&run.stderr));
}

/// What a user gets wrong at a hobbing machine, and what is told.
#[test]
fn a_folder_is_not_named_like_a_file() {
    let folder = folder("named");
    let named = folder.join("pinion.csv");
    let run = flank(&["solve", "specs/hobbing/spur_gear.chain", "--out", named.to_str().expect("a plain path")]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("a folder is wanted, and that looks like a file"), "{}", text(&run.stderr));
    assert!(!named.exists());
}

#[test]
fn wrong_settings_of_hobbing_machines_are_told() {
    let out = folder("wrong_settings");
    let out = out.to_str().expect("a plain path");
    for (spec, set, code, told) in [
        ("worm_wheel", "h.left_hand=1", 1, "the hob is of the other hand than the one that the machine turns for"),
        ("crowned_gear", "m.left_hand=1", 1, "the hob is of the other hand than the one that the machine turns for"),
        (
            "beveloid",
            "m.swivel=40 deg",
            1,
            "with this swivel the hob's thread lies across the teeth and mills them away",
        ),
        ("skived_internal_gear", "cutter_helix_angle=0 deg", 1, "the axes of cutter and gear are parallel"),
        ("worm_wheel", "starts=6", 1, "plunged radially, a hob of so many starts cuts the ends of the flanks away"),
        ("beveloid", "m.swivel=50 deg", 1, "`swivel` is 50 deg, outside its range -45 deg .. 45 deg"),
        ("crowned_gear", "h.starts=12", 1, "each thread of a hob cuts with several teeth: more gashes than starts"),
        ("crowned_gear", "h.addendum=9 mm", 1, "the hob's teeth are pointed below their tip"),
        ("worm_wheel_tangential", "face_width=40 mm", 3, "infeed outside its range, by up to 11.9"),
        ("beveloid", "teeth=250", 3, "beyond its travel: axis m.X runs from 413.6"),
    ] {
        let file = format!("specs/hobbing/{spec}.chain");
        let run = flank(&["solve", &file, "--set", set, "--no-picture", "--out", out]);
        let said = text(&run.stderr) + &text(&run.stdout);
        assert_eq!(run.status.code(), Some(code), "{spec}, {set}: {said}");
        assert!(said.contains(told), "{spec}, {set}: {said}");
    }
}

/// What comes of wrong settings of bevel gears: on all members, in the words of the trade.
#[test]
fn bevel_gears_of_wrong_settings_are_told_as_such() {
    let out = folder("bevel_mistakes");
    let run_of = |file: &str, set: &[&str]| {
        let set = set.iter().flat_map(|value| ["--set", value]);
        let of = ["solve", file, "--no-picture", "--out", out.to_str().unwrap()];
        let run = flank(&of.into_iter().chain(set).collect::<Vec<_>>());
        (run.status.code(), text(&run.stderr))
    };
    let roots = "the tips miss the root of the blank: deeper they cut through, higher they leave stock";
    for (spec, set, wanted) in [
        // the tips cut through, or leave stock
        ("pinion_19x62", &["m.machine_root_angle=14.5 deg"][..], roots),
        ("gear_19x62", &["m.machine_root_angle=77 deg"], roots),
        ("thesis_gear", &["m.root_angle=74 deg"], roots),
        ("formate_gear", &["m.machine_root_angle=64 deg"], roots),
        ("helixform_gear", &["m.machine_root_angle=64 deg"], roots),
        ("duplex_helical_pinion", &["m.helical_motion_1=5.5 mm"], roots),
        ("hypoid_pinion", &["m.machine_root_angle=5 deg"], roots),
        ("tilted_pinion", &["m.sliding_base=-3 mm"], roots),
        ("face_hobbed_pinion", &["m.sliding_base=3.4 mm"], roots),
        // the cutter of one flank reaches the other one
        ("hypoid_pinion", &["n.index=0 deg"], "225: cut away by what makes behind_concave"),
        (
            "tilted_pinion",
            &["c.inside_point_radius=56 mm", "d.inside_point_radius=62.3 mm"],
            "cut away by what makes behind_concave",
        ),
        ("face_hobbed_pinion", &["n.spindle_start=313.7 deg"], "225: cut away by what makes behind_concave"),
        // the other side of the cutter
        (
            "pinion_19x62",
            &["c.theta_from=-170 deg", "c.theta_to=-80 deg"],
            "theta of c.outside.blade from -265.2114 to -238.8374 deg would reach them all; its range is -170.0000 .. -80.0000 deg",
        ),
        ("formate_gear", &["c.theta_from=0 deg", "c.theta_to=90 deg"], "theta of c.outside.blade from"),
    ] {
        let (code, told) = run_of(&format!("specs/bevel/{spec}.chain"), set);
        assert_eq!(code, Some(3), "{spec}, {set:?}: {told}");
        assert!(told.contains(wanted), "{spec}, {set:?}: {told}");
    }
    // what `--set` does not reach: the roll, and which blades cut which flank
    for (spec, from, to, wanted) in [
        (
            "tilted_pinion",
            "in -30 deg .. 30 deg",
            "in -4 deg .. 4 deg",
            "124: roll outside its range, by up to 9.943851 deg, at the toe and the tip",
        ),
        (
            "hypoid_pinion",
            "in -40 deg .. 40 deg",
            "in -40 deg .. 2 deg",
            "roll from -5.2705 to 11.8862 deg would reach them all; its range is -40.0000 .. 2.0000 deg",
        ),
        ("gear_19x62", "in -25 deg .. 25 deg", "in -5 deg .. 25 deg", "roll outside its range"),
        ("face_hobbed_pinion", "roll : angle in -40", "roll : angle in -2", "roll outside its range"),
        (
            "gear_19x62",
            "c.outside.blade",
            "c.inside.blade",
            "this is the opposite flank: outside blades cut the concave",
        ),
        ("formate_gear", "c.inside.blade", "c.outside.blade", "not as required: 225 of 225 points of convex"),
        ("helixform_gear", "c.outside.blade", "c.inside.blade", "this is the opposite flank"),
    ] {
        let path = format!("specs/bevel/{spec}.chain");
        let right = std::fs::read_to_string(top().join(&path)).unwrap();
        assert!(right.contains(from), "{spec} has {from}");
        // beside the specs that it uses
        let wrong = format!("target/wrong_{spec}.chain");
        // a build may put its own files elsewhere
        std::fs::create_dir_all(top().join("target")).unwrap();
        std::fs::write(top().join(&wrong), right.replacen(from, to, 1).replace("\"../", "\"../specs/")).unwrap();
        let (code, told) = run_of(&wrong, &[]);
        let _ = std::fs::remove_file(top().join(&wrong));
        assert_eq!(code, Some(3), "{spec}, {to}: {told}");
        assert!(told.contains(wanted), "{spec}, {to}: {told}");
    }
}

/// Files name what was set by hand in their own job; a value of another job is none of theirs.
#[test]
fn what_is_set_by_hand_is_told_where_it_is() {
    let out = folder("set_by_hand");
    let spec = "specs/bevel/ease_off_19x62.chain";
    let set = ["--set", "m.hypoid_offset=1 um", "--no-picture", "--out", out.to_str().unwrap()];
    let run = flank(&[&["solve", spec], &set[..]].concat());
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    let head = |job: &str| std::fs::read_to_string(out.join(format!("{job}.csv"))).expect("written");
    assert!(head("conjugate").contains("# set by hand: m.hypoid_offset = 1 um\n"));
    assert!(!head("basic").contains("set by hand"));
    let run = flank(&[&["solve", spec, "--job", "basic"], &set[..]].concat());
    assert_eq!(run.status.code(), Some(1));
    let told = text(&run.stderr);
    assert!(told.contains("E0201") && told.contains("job `basic` has no parameter `m.hypoid_offset`"), "{told}");
}

/// Points that are there, but not taken, are not said to be outside the ranges.
#[test]
fn why_a_surface_has_no_point_is_told_in_its_row() {
    let out = folder("none_solved");
    let spec = self_contained(&[
        "machines/hobbing_geared",
        "machines/hobbing_3axis",
        "machines/hobbing_6axis",
        "tools/involute",
        "tools/hob_zi",
        "functions/hobbing",
        "hobbing/helical_gear",
    ]);
    let unsaid: Vec<&str> = spec.lines().filter(|line| !line.contains("keep ")).collect();
    let unsaid = written(&out, "unsaid.chain", &(unsaid.join("\n") + "\n"));
    let solve = |arguments: &[&str]| {
        let run = flank(&[&["solve", "--no-picture", "--out", out.to_str().unwrap()], arguments].concat());
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
        (text(&run.stdout), text(&run.stderr))
    };
    let (table, _) = solve(&[&unsaid]);
    assert!(table.contains("-  none: ambiguous\n") && !table.contains("none within the ranges"), "{table}");
    // without roll the cutter turns about its own parallel: all points lie at one angle of it
    let (_, told) = solve(&["specs/bevel/pinion_19x62.chain", "--set", "m.ratio_of_roll=0"]);
    assert!(told.contains("theta of c.outside.edge at 0.0000 deg would reach them all"), "{told}");
}

/// Surfaces of different bodies do not lie over each other at one origin: each frame has its own mesh.
#[test]
fn each_frame_has_its_own_mesh() {
    let out = folder("meshes_of_frames");
    let spec = "specs/bevel/pair_from_blank.chain";
    let run = flank(&["solve", spec, "--no-picture", "--format", "csv,obj,stl", "--out", out.to_str().unwrap()]);
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    for frame in ["p.work", "g.work"] {
        let mesh = std::fs::read_to_string(out.join(format!("pair_from_blank.{frame}.obj"))).expect("written");
        let frames: Vec<&str> = mesh.lines().filter_map(|line| line.strip_prefix("# frame ")).collect();
        assert!(!frames.is_empty() && frames.iter().all(|known| *known == frame), "{frames:?}");
        assert!(out.join(format!("pair_from_blank.{frame}.stl")).exists());
        assert!(text(&run.stdout).contains(&format!("pair_from_blank.{frame}.stl")));
    }
    assert!(!out.join("pair_from_blank.stl").exists() && out.join("pair_from_blank.csv").exists());
}

/// Each number of the table follows from the points in the file: how many were asked for and solved, the largest residual of these, and how
/// far they reach.
#[test]
fn the_table_says_what_stands_in_the_file() {
    let out = folder("table");
    for (spec, unknowns) in [
        ("specs/hobbing/undercut_gear.chain", ["u", "theta", "v", "phi"]),
        ("specs/bevel/pinion_19x62.chain", ["s", "radius", "theta", "roll"]),
    ] {
        let run = flank(&["solve", spec, "--no-picture", "--out", out.to_str().unwrap()]);
        let table = text(&run.stdout);
        let file = Path::new(spec).with_extension("csv");
        let csv = std::fs::read_to_string(out.join(file.file_name().expect("a file"))).expect("written");
        let mut rows =
            csv.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
        let titles = rows.next().expect("titles");
        let column = |name: &str| titles.iter().position(|title| *title == name).expect("a column");
        let rows: Vec<Vec<&str>> = rows.collect();
        let number = |row: &[&str], name: &str| row[column(name)].parse::<f64>().ok();
        let (head, rest) = table.split_once("ranges reached\n").expect("a table");
        assert!(head.trim_end().ends_with("worst residual"), "{head}");
        let (listed, _) = rest.split_once("\n\n").expect("an end of the table");
        let mut blocks: Vec<String> = Vec::new();
        for line in listed.lines() {
            // a surface takes a line with its name and some that are set in
            match blocks.last_mut().filter(|_| line.starts_with("   ")) {
                Some(block) => block.push_str(line),
                None => blocks.push(line.to_owned()),
            }
        }
        assert!(blocks.len() >= 5, "{table}");
        for block in blocks {
            let words: Vec<&str> = block.split_whitespace().collect();
            let own = |row: &&Vec<&str>| row[0] == words[0];
            let solved = || rows.iter().filter(own).filter(|row| row[column("status")] == "solved");
            let worst = solved().filter_map(|row| number(row, "residual")).fold(0.0, f64::max);
            let counts = [rows.iter().filter(own).count(), solved().count()].map(|count| count.to_string());
            assert_eq!(words[1..4], [&*counts[0], &counts[1], &format!("{worst:.1e}")], "{block}");
            let radius = solved().map(|row| f64::hypot(number(row, "x").expect("x"), number(row, "y").expect("y")));
            let mut shown = vec![("rho", radius.collect::<Vec<f64>>())];
            shown.extend(
                ["z"]
                    .iter()
                    .chain(&unknowns)
                    .map(|name| (*name, solved().filter_map(|row| number(row, name)).collect())),
            );
            for (name, values) in shown.into_iter().filter(|(_, values)| !values.is_empty()) {
                let [low, high] =
                    [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| values.iter().copied().reduce(of));
                let range = format!(" {name} {:.4} .. {:.4} ", low.expect("some"), high.expect("some"));
                assert!(block.contains(&range), "{}: {range} in\n{block}", words[0]);
            }
        }
    }
}

/// The value that is wrong is told, and not that what is made of it has no such names.
#[test]
fn what_a_wrong_value_takes_along_is_not_unknown() {
    for spec in ["specs/hobbing/worm_wheel.chain", "specs/bodies/worm_and_wheel_body.chain"] {
        let run = flank(&["solve", spec, "--set", "h.left_hand=2"]);
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(1), "{told}");
        assert!(told.contains("E0307") && told.contains("`left_hand` is 2, outside its range 0 .. 1"), "{told}");
        assert!(!told.contains("E0201"), "{spec}: {told}");
    }
}
