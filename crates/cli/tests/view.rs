//! `flank view` as a user runs it; the page's own solver, in Node, against the program; the page in a browser.

mod support;

use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use support::{flank, folder, self_contained, text, top, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
/// Positions of the page against the program's, mm: both solve to 1e-11.
const TOLERANCE: f64 = 1e-9;

/// The page of a spec's only job, and what is told of it.
fn page(spec: &str, out: &Path) -> (PathBuf, Value) {
    let run = flank(&["view", spec, "--out", out.to_str().expect("a plain path"), "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    (top().join(told["files"][0].as_str().expect("a file")), told)
}

/// The points that `flank solve` writes for a spec.
fn solved(spec: &str, set: &[&str], out: &Path) -> Value {
    let out = out.to_str().expect("a plain path");
    let set = set.iter().flat_map(|one| ["--set", one]);
    let arguments: Vec<&str> = ["solve", spec, "--out", out, "--format", "json", "--no-picture", "--geometry"]
        .into_iter()
        .chain(set)
        .collect();
    let run = flank(&arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let name = Path::new(spec).file_stem().expect("a name").to_str().expect("UTF-8");
    let file = std::fs::read(Path::new(out).join(format!("{name}.json"))).expect("the points");
    serde_json::from_slice(&file).expect("JSON")
}

/// What a script of `tests/page` prints, run by Node; nothing if Node is not installed.
fn node(script: &str, arguments: &[&str], input: &Value) -> Option<Value> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/page").join(script);
    let mut command = Command::new("node");
    command.arg(&script).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = match command.spawn() {
        Err(error) if error.kind() == ErrorKind::NotFound => return None,
        child => child.expect("node starts"),
    };
    let mut stdin = child.stdin.take().expect("its input is a pipe");
    // a script that reads nothing may have gone already
    let _ = stdin.write_all(input.to_string().as_bytes());
    drop(stdin);
    let output = child.wait_with_output().expect("node ends");
    assert!(output.status.success(), "{}", text(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("JSON"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or(Vec::new(), |list| list.iter().map(|x| x.as_f64().expect("a number")).collect())
}

fn off(a: &Value, b: &Value) -> f64 {
    let (a, b) = (numbers(a), numbers(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn one_file_for_each_job() {
    let folder = folder("view");
    let (file, told) = page("specs/hobbing/spur_gear.chain", &folder);
    let bytes = std::fs::metadata(&file).expect("the page").len();
    assert_eq!(told["bytes"].as_u64(), Some(bytes));
    assert_eq!((&told["job"], &told["asked"]), (&json!("spur_gear"), &told["solved"]));
    assert!(bytes < 3_000_000, "{bytes} bytes");
    assert!(std::fs::read_to_string(&file).expect("text").starts_with("<!DOCTYPE html>"));
    let again = flank(&["view", "specs/hobbing/spur_gear.chain", "--out", folder.to_str().unwrap()]);
    assert!(text(&again.stdout).contains("wrote"), "{}", text(&again.stdout));
    assert_eq!(std::fs::metadata(&file).expect("the page").len(), bytes);
}

/// All that are usual; the largest stays below what mail takes.
#[test]
fn pages_of_the_library_are_small() {
    let folder = folder("view_sizes");
    for spec in ["specs/hobbing/helical_gear.chain", PINION, "specs/hobbing/worm_wheel.chain"] {
        let (_, told) = page(spec, &folder);
        assert!(told["bytes"].as_u64().expect("a size") < 3_000_000, "{told}");
    }
}

/// A grid that is too fine for a page: told, and thinned.
#[test]
fn a_fine_grid_is_thinned() {
    let folder = folder("view_fine");
    let spec =
        self_contained(&["machines/hobbing_6axis", "machines/rack_generating", "tools/rack", "hobbing/spur_gear"]);
    let fine = written(&folder, "fine.chain", &spec.replace("by 25", "by 251").replace("by 11", "by 101"));
    let run = flank(&["view", &fine, "--out", folder.to_str().unwrap(), "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("note: the page shows one of"), "{}", text(&run.stderr));
    let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert!(told["bytes"].as_u64().expect("a size") < 3_000_000, "{told}");
}

#[test]
fn what_cannot_be_shown_is_told() {
    let folder = folder("view_errors");
    let out = folder.to_str().unwrap();
    let run = flank(&["view", "specs/bevel/ease_off_19x62.chain", "--job", "pinion", "--out", out]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("asks for no points"), "{}", text(&run.stderr));
    let file = written(&folder, "file", "");
    let run = flank(&["view", "specs/hobbing/spur_gear.chain", "--out", &file]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("cannot make the folder"), "{}", text(&run.stderr));
}

/// Both are solved by Newton on the same equations, once on tapes and once as JavaScript, at points that follow the parameters where the
/// sample depends on them.
#[test]
fn the_page_solves_what_the_program_solves() {
    const HELICAL: &str = "specs/hobbing/helical_gear.chain";
    const BLANK: &str = "specs/bevel/pair_from_blank.chain";
    let folder = folder("view_solver");
    // parameters in mm and radians for the page, with their unit for the program, and how many points are compared at least
    let cases: [(&str, &[&str], &[&str], usize); 6] = [
        (PINION, &[], &[], 1000),
        (PINION, &["m.machine_root_angle=0.2745"], &["m.machine_root_angle=0.2745 rad"], 1000),
        (
            PINION,
            &["m.radial_distance=98.2", "m.ratio_of_roll=3.345"],
            &["m.radial_distance=98.2 mm", "m.ratio_of_roll=3.345"],
            1000,
        ),
        (
            "specs/hobbing/spur_gear.chain",
            &["face_width=21", "profile_shift=0.22"],
            &["face_width=21 mm", "profile_shift=0.22"],
            500,
        ),
        (
            HELICAL,
            &["normal_module=3.03", "helix_angle=0.386"],
            &["normal_module=3.03 mm", "helix_angle=0.386 rad"],
            1000,
        ),
        (
            BLANK,
            &["addendum_factor=1.01", "p.radial_distance=96.5"],
            &["addendum_factor=1.01", "p.radial_distance=96.5 mm"],
            1000,
        ),
    ];
    for (spec, moves, set, least) in cases {
        let (file, _) = page(spec, &folder);
        let file = file.to_str().expect("a plain path");
        let arguments: Vec<&str> = [file].into_iter().chain(moves.iter().copied()).collect();
        let Some(found) = node("solving.mjs", &arguments, &Value::Null) else {
            eprintln!("skipped 1 test: node is not installed");
            return;
        };
        let [compared, bent] = compared(&found, &solved(spec, set, &folder), spec);
        assert!(compared > least, "{compared} points of {spec} with {set:?}");
        assert_eq!(
            bent,
            if moves.is_empty() { 0 } else { compared },
            "what the page solves anew has curvatures: {spec}"
        );
    }
}

/// How many points the page and the program both solve, and for how many of them the page has curvatures; they agree in all.
fn compared(found: &Value, expected: &Value, of: &str) -> [usize; 2] {
    let (mut compared, mut bent) = (0, 0);
    let list = |value: &Value| value.as_array().expect("a list").clone();
    let (of_page, of_program) = (list(found), list(&expected["surfaces"]));
    assert_eq!(of_page.len(), of_program.len(), "surfaces of {of}");
    for (found, expected) in of_page.iter().zip(&of_program) {
        assert_eq!(found["name"], expected["name"]);
        let field = |name| expected["fields"].as_array().and_then(|all| all.iter().position(|one| one["name"] == name));
        let [k1, k2] = ["k1", "k2"].map(|name| field(name).expect("geometry is asked for"));
        let (on_page, solved) = (list(&found["points"]), list(&expected["points"]));
        assert_eq!(on_page.len(), solved.len(), "points of {of}");
        for (found, expected) in on_page.iter().zip(&solved) {
            assert_eq!(found["status"], expected["status"], "{of} {expected}");
            assert!(off(&found["position"], &expected["position"]) < TOLERANCE, "{of} {found} {expected}");
            assert!(off(&found["normal"], &expected["normal"]) < TOLERANCE, "{of} {found} {expected}");
            if !found["curvatures"].is_null() {
                bent += 1;
                let bent = json!([expected["fields"][k1], expected["fields"][k2]]);
                assert!(off(&found["curvatures"], &bent) < TOLERANCE, "{of} {bent}");
            }
            compared += usize::from(!found["position"].is_null());
        }
    }
    [compared, bent]
}

const BEVEL_PAIR: &str = "specs/pairs/bevel_19x62.chain";
const SPUR_PAIR: &str = "specs/pairs/spur_pair.chain";

/// What a page was written with.
fn data(file: &Path) -> Value {
    let html = std::fs::read_to_string(file).expect("the page");
    let begin = "<script type=\"application/json\" id=\"data\">";
    let from = html.find(begin).expect("its data") + begin.len();
    let to = from + html[from..].find("</script>").expect("an end");
    serde_json::from_str(&html[from..to]).expect("JSON")
}

/// Doubles of a page.
fn decoded(text: &Value) -> Vec<f64> {
    let value = |letter: u8| -> u32 {
        u32::from(match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => 0,
        })
    };
    let text = text.as_str().expect("base64").as_bytes();
    let bytes: Vec<u8> = text
        .chunks(4)
        .flat_map(|four| four.iter().fold(0, |bits, letter| bits << 6 | value(*letter)).to_be_bytes()[1..].to_vec())
        .collect();
    bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().expect("eight"))).collect()
}

/// Turn and lag of each position of a contact, and the point on the first flank, as `flank contact` writes them.
fn rolled(spec: &str, name: &str, out: &Path) -> Vec<([f64; 2], Vec<f64>)> {
    let folder = out.to_str().expect("a plain path");
    let run = flank(&["contact", spec, "--out", folder, "--format", "json", "--no-picture"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let file = std::fs::read(out.join(format!("{name}.json"))).expect("the path");
    let file: Value = serde_json::from_slice(&file).expect("JSON");
    let points = file["surfaces"][2]["points"].as_array().expect("the path on the first flank").clone();
    let number = |value: &Value| value.as_f64().expect("a number");
    points.iter().map(|point| ([0, 1].map(|k| number(&point["fields"][k])), numbers(&point["position"]))).collect()
}

/// What turns in the page are the positions of the contact analysis, and the page is the same on one thread and on several.
#[test]
fn a_pair_rolls_through_the_positions_that_were_solved() {
    let folder = folder("view_pair");
    let (file, told) = page(BEVEL_PAIR, &folder);
    assert!(told["bytes"].as_u64().expect("a size") < 3_000_000, "{told}");
    let data = data(&file);
    let contact = &data["contacts"][0];
    let (rolls, touches) = (decoded(&contact["rolls"]), decoded(&contact["maps"][0]["touches"]));
    let (lags, apart) = (decoded(&contact["lags"]), decoded(&contact["apart"]));
    let expected = rolled(BEVEL_PAIR, "bevel_19x62.drive_side", &folder);
    assert_eq!(rolls.len(), expected.len());
    let mut carried = 0;
    for (k, ([turn, lag], position)) in expected.iter().enumerate() {
        assert!((rolls[k].to_degrees() - turn).abs() < 1e-9, "turn {turn}");
        let flat = [position[2], position[0].hypot(position[1])];
        assert!((0..2).all(|i| (touches[6 * k + i] - flat[i]).abs() < 1e-12), "the point on the map at {turn}");
        if apart[k] == 0.0 {
            carried += 1;
            assert!((lags[k].to_degrees() - lag).abs() < 1e-9, "lag at {turn}");
        }
    }
    // of 2.06 pitches of contact of the flanks, and more of edges, one is carried
    assert!((60..=62).contains(&carried), "{carried}");
    let [pinion, gear] = [0, 1].map(|k| contact["members"][k]["pitch"].as_f64().expect("a solid says how many teeth"));
    assert!(
        (pinion - std::f64::consts::TAU / 19.0).abs() < 1e-15 && (gear - std::f64::consts::TAU / 62.0).abs() < 1e-15
    );
    let gap = |surface: &Value| {
        let fields = surface["fields"].as_array().expect("fields").iter();
        fields.filter(|field| field["name"] == contact["gap"]).count()
    };
    assert!(data["surfaces"].as_array().expect("surfaces").iter().all(|surface| gap(surface) == 1));

    let alone = folder.join("alone");
    let run = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["view", BEVEL_PAIR, "--out", alone.to_str().expect("a plain path")])
        .current_dir(top())
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("the binary runs");
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let [one, several] = [alone.join("bevel_19x62.html"), file].map(|file| std::fs::read(file).expect("the page"));
    assert!(one == several, "the page depends on the number of threads");
}

/// The faces of whole gears enclose what their bodies do but for the sag of facets, also those of a worm whose one tooth winds about it.
#[test]
fn whole_gears_are_closed() {
    let spec = "specs/bodies/worm_and_wheel_body.chain";
    let (file, _) = page(spec, &folder("view_bodies"));
    let run = flank(&[
        "solve",
        spec,
        "--solid",
        "gear",
        "--json",
        "--out",
        folder("view_bodies_solids").to_str().expect("a plain path"),
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let solids: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let data = data(&file);
    let bodies = data["bodies"].as_array().expect("bodies");
    assert_eq!(bodies.len(), 2);
    for (body, solid) in bodies.iter().zip(solids["solids"].as_array().expect("solids")) {
        let faces = body["faces"].as_array().expect("faces").iter();
        let tooth: f64 = faces.map(|face| enclosed(&decoded(&face["positions"]), &numbers(&face["counts"]))).sum();
        let (whole, exact) =
            (tooth * body["teeth"].as_f64().expect("teeth"), solid["volume_mm3"].as_f64().expect("a volume"));
        assert!((whole / exact - 1.0).abs() < 0.01, "{} of {exact} mm³: {}", whole, solid["name"]);
    }
}

/// What a grid of points encloses with the origin, mm³.
fn enclosed(positions: &[f64], counts: &[f64]) -> f64 {
    let [rows, columns] = [0, 1].map(|k| counts[k] as usize);
    let point = |i: usize, j: usize| [0, 1, 2].map(|k| positions[3 * (i * columns + j) + k]);
    let volume = |[a, b, c]: [[f64; 3]; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3]);
        (a[0] * x + a[1] * y + a[2] * z) / 6.0
    };
    let cells = (1..rows).flat_map(|i| (1..columns).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [point(i - 1, j - 1), point(i - 1, j), point(i, j), point(i, j - 1)];
        [[a, b, c], [a, c, d]]
    });
    triangles.map(volume).sum()
}

/// Both sides of a spur pair touch along lines: no ellipse, no error; all surfaces of both tooth spaces are members.
#[test]
fn line_contact_and_both_sides() {
    let (file, _) = page(SPUR_PAIR, &folder("view_spur_pair"));
    let data = data(&file);
    let contacts = data["contacts"].as_array().expect("contacts");
    assert_eq!(contacts.len(), 2);
    for contact in contacts {
        assert!(contact["count"].as_u64() > Some(90), "{}", contact["count"]);
        assert_eq!(contact["kind"], json!("line contact"));
        assert!(decoded(&contact["ellipses"]).iter().all(|x| x.is_nan()));
        // as the solid lists them, from one side of the space to the other
        assert_eq!(contact["members"][1]["surfaces"], json!([6, 7, 9, 5, 4]));
    }
}

/// Without solids one pair of flanks is shown; one that is out of reach has a page that says so, and so has the program.
#[test]
fn a_pair_without_solids_and_one_that_never_touches() {
    let folder = folder("view_pair_cases");
    let out = folder.to_str().expect("a plain path");
    let spec = self_contained(&[
        "machines/hobbing_6axis",
        "machines/parallel_pair",
        "machines/rack_generating",
        "tools/rack",
        "functions/hobbing",
        "pairs/spur_pair",
    ]);
    let (solids, samples) =
        (spec.find("    solid pinion").expect("solids"), spec.find("    sample pinion_flank").expect("samples"));
    let bare = format!("{}{}", &spec[..solids], &spec[samples..]);
    // which tooth of the gear the other side would meet, nothing says
    let coast = bare.find("    contact coast_side").expect("the other side");
    let bare = written(&folder, "bare.chain", &format!("{}}}\n", &bare[..coast]));
    let (file, _) = page(&bare, &folder);
    let shown = data(&file);
    assert!(shown["contacts"][0]["count"].as_u64() > Some(0), "{}", shown["contacts"][0]["refused"]);
    assert!(shown["contacts"][0]["members"][0]["pitch"].is_null());
    assert_eq!(shown["contacts"][0]["members"][0]["surfaces"], json!([0, 1, 2, 3, 8]));

    let run = flank(&["view", SPUR_PAIR, "--set", "m.centre_distance=120 mm", "--out", out, "--json"]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("do not reach each other"), "{}", text(&run.stderr));
    let contact = &data(&folder.join("spur_pair.html"))["contacts"][0];
    assert_eq!(contact["count"], json!(0));
    assert!(contact["refused"].as_str().expect("why").contains("do not reach each other"), "{contact}");
}

/// Rolls pairs as in `tests/page/pair.mjs`.
#[test]
fn a_pair_turns_in_the_browser() {
    let folder = folder("view_pair_browser");
    if !browser_is_there() {
        return;
    }
    let drive = |file: &Path, expected: Value| {
        let arguments = [file, folder.as_path()].map(|path| path.to_str().expect("a plain path"));
        node("pair.mjs", &arguments, &expected).expect("node drives the browser")
    };
    let positions = |spec: &str, name: &str| -> Vec<Value> {
        let all = rolled(spec, name, &folder).into_iter();
        all.map(|([turn, lag], _)| json!({ "turn": turn, "lag": lag })).collect()
    };
    let (file, _) = page(BEVEL_PAIR, &folder);
    let at = positions(BEVEL_PAIR, "bevel_19x62.drive_side");
    drive(&file, json!({ "name": "bevel", "motion": "turn", "at": at }));
    let (file, _) = page(SPUR_PAIR, &folder);
    let at = positions(SPUR_PAIR, "spur_pair.drive_side");
    drive(&file, json!({ "name": "spur", "motion": "turn", "at": at, "other": 1 }));
    let out = folder.to_str().expect("a plain path");
    flank(&["view", SPUR_PAIR, "--set", "m.centre_distance=120 mm", "--out", out]);
    let file = folder.join("spur_pair.html");
    drive(&file, json!({ "name": "apart", "motion": "turn", "refused": "do not reach each other" }));
}

/// The cutter of a milling goes where the program's table of cutter locations has it: as in `tests/page/milling.mjs`.
#[test]
fn a_cutter_moves_on_its_passes_in_the_browser() {
    const MILLED: &str = "specs/bevel/milled_pinion.chain";
    let folder = folder("view_milling_browser");
    let (file, told) = page(MILLED, &folder);
    assert!(told["bytes"].as_u64().expect("a size") < 3_000_000, "{told}");
    let out = folder.to_str().expect("a plain path");
    let run = flank(&["mill", MILLED, "finish", "--out", out]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = std::fs::read_to_string(folder.join("milled_pinion.finish.csv")).expect("cutter locations");
    let rows: Vec<Vec<&str>> = table.lines().map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).unwrap_or_else(|| panic!("{name}"));
    let number = |row: &[&str], name: &str| row[column(name)].parse::<f64>().expect("a number");
    let at: Vec<Value> = rows[1..]
        .iter()
        .map(|row| {
            let of = |what: &str| ["x", "y", "z"].map(|axis| number(row, &format!("{what}_{axis}")));
            json!({ "pass": number(row, "pass") as u32, "position": number(row, "position") as u32, "tip": of("tip"), "axis": of("axis") })
        })
        .collect();
    let milling = &data(&file)["millings"][0];
    assert_eq!(milling["counts"], json!([57, 43]));
    // poses and values of some positions, as the table has them
    let (poses, values) = (decoded(&milling["poses"]), decoded(&milling["values"]));
    let [passes, positions] = [0, 1].map(|k| numbers(&milling["numbers"][k]));
    assert_eq!([passes.len(), positions.len(), poses.len(), values.len()], [40, 40, 1600 * 6, 1600 * 7]);
    assert_eq!([passes[0], passes[39], positions[0], positions[39]], [1.0, 57.0, 1.0, 43.0]);
    let all = passes.iter().flat_map(|pass| positions.iter().map(move |position| [*pass, *position]));
    for (k, [pass, position]) in all.enumerate() {
        let row = &rows[((pass - 1.0) * 43.0 + position) as usize];
        assert_eq!([number(row, "pass"), number(row, "position")], [pass, position]);
        assert_eq!([poses[6 * k], poses[6 * k + 5]], [number(row, "tip_x"), number(row, "axis_z")]);
        assert_eq!([values[7 * k], values[7 * k + 6]], [number(row, "profilewise"), number(row, "C_deg")]);
    }
    if !browser_is_there() {
        return;
    }
    let expected = json!({
        "at": at, "counts": [57, 43], "columns": ["profilewise", "lengthwise", "X", "A", "C"], "parameter": "m.radial_distance", "other": "other",
    });
    let arguments = [file.to_str().expect("a plain path"), out];
    node("milling.mjs", &arguments, &expected).expect("node drives the browser");
}

/// Whether the tests can drive a browser; what they skip is told.
fn browser_is_there() -> bool {
    let browser = std::env::var("CHROMIUM").unwrap_or("/usr/bin/chromium".to_string());
    let driver = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/page/node_modules/playwright-core");
    let is_there = Path::new(&browser).exists() && driver.exists();
    if !is_there {
        eprintln!("skipped 1 test: {browser} or {} is not there; .ci/run installs both", driver.display());
    }
    is_there
}

/// Opens, turns, clicks and moves as in `tests/page/browser.mjs`.
#[test]
fn the_page_works_in_a_browser() {
    let folder = folder("view_browser");
    if !browser_is_there() {
        return;
    }
    let (file, _) = page(PINION, &folder);
    let (own, moved) = (solved(PINION, &[], &folder), solved(PINION, &["m.machine_root_angle=15.7 deg"], &folder));
    let (surface, point) = (&own["surfaces"][0], 7 * 31 + 15);
    let at = &surface["points"][point];
    let mut values = json!({
        "x": at["position"][0], "y": at["position"][1], "z": at["position"][2],
        "normal x": at["normal"][0], "normal y": at["normal"][1], "normal z": at["normal"][2],
        "row i (root -> tip)": at["i"], "column j (toe -> heel)": at["j"],
    });
    for (k, unknown) in surface["unknowns"].as_array().unwrap().iter().enumerate() {
        values[unknown["name"].as_str().unwrap()] = at["unknowns"][k].clone();
    }
    for (k, field) in surface["fields"].as_array().unwrap().iter().enumerate() {
        if ["k1", "k2", "sliding_angle", "induced_k1"].contains(&field["name"].as_str().unwrap()) {
            values[field["name"].as_str().unwrap()] = at["fields"][k].clone();
        }
    }
    let expected = json!({
        "teeth": 19, "signed": "d_normal/d_m.ratio_of_roll", "motion": "roll", "surface": surface["name"], "point": point, "values": values,
        "parameter": {
            "name": "m.machine_root_angle", "shown": 15.7,
            "position": moved["surfaces"][0]["points"][point]["position"],
        },
        // -0.0013 mm in the job, and 98 mm of 0 mm .. 10000 mm
        "small": { "name": "m.machine_center_to_crossing_point" },
        "beyond": { "name": "m.radial_distance", "own": 97.95940290780507, "limits": [0, 10_000] },
    });
    let arguments = [file.to_str().expect("a plain path"), folder.to_str().expect("a plain path")];
    let measured = node("browser.mjs", &arguments, &expected).expect("node drives the browser");
    eprintln!("in the browser: {measured}");
    assert!(measured["opened_ms"].as_u64().expect("a time") < 20_000, "{measured}");
}

/// Every machine of a job can be chosen, also one of which nothing is sampled: `tests/page/machines.mjs`.
#[test]
fn all_machines_are_shown_in_the_browser() {
    let folder = folder("view_machines_browser");
    if !browser_is_there() {
        return;
    }
    for spec in ["specs/hobbing/real_hob.chain", "specs/bodies/worm_and_wheel_body.chain"] {
        let (file, _) = page(spec, &folder);
        let arguments = [file.as_path(), folder.as_path()].map(|path| path.to_str().expect("a plain path"));
        let told = node("machines.mjs", &arguments, &Value::Null).expect("node drives the browser");
        eprintln!("in the browser: {told}");
    }
}

/// No table is wider than a sheet of A4: `tests/page/printed.mjs`.
#[test]
fn reports_fit_their_paper_in_a_browser() {
    let folder = folder("view_printed_browser");
    if !browser_is_there() {
        return;
    }
    let long = "flank_with_a_name_that_goes_on_and_on_and_on_until_the_end_of_the_line";
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let long = written(&folder, "long.chain", &gear.replace("flank_plus", long));
    let out = folder.to_str().expect("a plain path");
    for spec in [BEVEL_PAIR, "specs/hobbing/worm_wheel.chain", &long] {
        let run = flank(&["report", spec, "--out", out]);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    }
    let reports = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let reports: Vec<String> = reports
        .filter(|path| path.extension().is_some_and(|end| end == "html"))
        .map(|path| path.display().to_string())
        .collect();
    assert_eq!(reports.len(), 4);
    let arguments: Vec<&str> = [out].into_iter().chain(reports.iter().map(String::as_str)).collect();
    let told = node("printed.mjs", &arguments, &Value::Null).expect("node drives the browser");
    assert!(told["tables"].as_u64() > Some(40) && told["wide"] == json!([]), "{told}");
}

/// Camera, sliders and colouring stay when the spec is saved; a wrong spec greys the last good picture: `tests/page/following.mjs`.
#[test]
fn the_page_that_follows_keeps_what_is_seen_in_a_browser() {
    let folder = folder("view_following_browser");
    if !browser_is_there() {
        return;
    }
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    // a slider has ends
    let text = text.replace("param module : length = 4 mm", "param module : length in 1 mm .. 9 mm = 4 mm");
    let spec = folder.join("gear.chain");
    std::fs::write(&spec, &text).expect("a file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["view", "--serve"])
        .arg(&spec)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut address = String::new();
    BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut address).expect("an address");
    let expected = json!({
        "other": text.replace("param teeth : count = 20", "param teeth : count = 21"),
        "grown": text.replace("param teeth : count = 20", "param teeth : count = 90"),
        "wrong": text.replace("drive m.C = roll", "drive m.C = rol"),
        "code": "E0201",
        "empty": text.replacen("z: -10 mm .. 10 mm", "z: 500 mm .. 510 mm", 2),
        "gone": text.replace("job first_gear", "job renamed_gear"),
        "jobs": ["first_gear", "first_helical_gear"],
        "server": child.id(),
        "folder": folder,
    });
    assert!(["other", "wrong", "empty", "grown", "gone"].iter().all(|other| expected[other] != json!(text)));
    let measured = node("following.mjs", &[address.trim(), spec.to_str().expect("a plain path")], &expected);
    let _ = child.kill();
    let _ = child.wait();
    eprintln!("in the browser: {}", measured.expect("node drives the browser"));
}
