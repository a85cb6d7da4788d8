//! `flank mill`: programs that it writes are read back, by it and by LinuxCNC's interpreter, and what cannot be milled is told with its
//! place.

#[path = "mill/control.rs"]
mod control;
#[path = "mill/dexels.rs"]
mod dexels;
#[path = "mill/pair.rs"]
mod pair;
#[path = "mill/reached.rs"]
mod reached;
#[path = "mill/retracts.rs"]
mod retracts;
#[path = "mill/spaces.rs"]
mod spaces;
#[path = "mill/special.rs"]
mod special;
mod support;
#[path = "mill/tip.rs"]
mod tip;
#[path = "mill/verified.rs"]
mod verified;
#[path = "mill/whole.rs"]
mod whole;

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use support::{flank, folder, text, written};

/// What the job needs of the library.
const SPECS: [&str; 7] = [
    "functions/bevel",
    "machines/cradle",
    "tools/face_mill",
    "functions/blanks_19x62",
    "bevel/pinion_19x62",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const BALL: &str = "ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)";
const BULL: &str = "bull_mill(radius: 6 mm, corner: 1 mm, reach: 40 mm, holder_radius: 8 mm)";
const AREA: &str = "passes profilewise: 0.45 .. 0.55 by 9\n along lengthwise: 0.2 .. 0.8 by 9\n";

/// A flat end mill without flutes.
const DISC: &str = "tool disc_mill {
 param radius : length = 1 mm
 surface cutting(theta: angle in -180 deg .. 180 deg) {
  at = [radius * cos(theta), radius * sin(theta), 0 mm]
  body towards [-cos(theta), -sin(theta), -1]
 }
}";

/// A job that mills a part of the concave flank of the pinion.
fn job(settings: &str, cutter: &str, milling: &str) -> String {
    let library = support::self_contained(&SPECS);
    format!(
        "{library}\n{DISC}\njob milled extends pinion_19x62 {{\n machine mill = five_axis_table_table({settings})\n tool cutter = {cutter}\n \
         mount cutter on mill.cutter\n mill part of concave with cutter.cutting in mill.work {{\n{milling}\n }}\n}}\n"
    )
}

/// As the library's job leans it.
fn sound() -> String {
    job("work_z: 60 mm", BALL, &format!("{AREA} lead 5 deg\n tilt 70 deg\n"))
}

/// Exit code, what was printed, what was told.
fn mill(spec: &str, out: &Path, arguments: &[&str]) -> (i32, String, String) {
    let out = out.to_str().expect("a plain path");
    let run = flank(&[&["mill", spec, "--out", out][..], arguments].concat());
    (run.status.code().expect("it ends by itself"), text(&run.stdout), text(&run.stderr))
}

fn json(spec: &str, out: &Path, arguments: &[&str]) -> Value {
    let (code, told, errors) = mill(spec, out, &[arguments, &["--json"]].concat());
    assert_eq!(code, 0, "{errors}");
    serde_json::from_str(&told).expect("JSON")
}

fn text_of(file: &Path) -> String {
    std::fs::read_to_string(file).expect("it is written")
}

const CONTROLS: [(&str, &str); 4] = [("linuxcnc", "ngc"), ("siemens", "mpf"), ("fanuc", "nc"), ("heidenhain", "h")];

/// A program of each control leaves what its plan says: on no point more than cusp and block together, nowhere less than blocks cut too
/// deep; words have four decimals of mm and five of degrees.
#[test]
fn programs_of_all_controls_leave_what_was_planned() {
    let out = folder("mill_programs");
    let spec = written(&out, "milled.chain", &sound());
    // half of the last decimal on each of five axes; the work is some 200 mm from the rotary ones
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    for tip in [false, true] {
        let controls = CONTROLS.into_iter().filter(|(control, _)| !(tip && *control == "linuxcnc"));
        for (control, extension) in controls {
            let words: &[&str] = if tip { &["--tcp"] } else { &[] };
            json(&spec, &out, &[&["--nc", control, "--spindle", "9000"], words].concat());
            let program = out.join(format!("milled.part.{extension}"));
            let read = json(&spec, &out, &[&["--verify", program.to_str().unwrap()], words].concat());
            let verified = &read["verified"];
            assert_eq!(verified["untouched"], 0, "{control}: {verified}");
            assert_eq!(verified["tool_centre_control"], tip, "{control}: {verified}");
            let height = |value: &Value| value["height_um"].as_f64().expect("a height");
            let [most, least] = [0, 1].map(|k| height(&verified["left"][k]));
            let cusp = height(&read["cusp"]);
            let [left, deep] = [0, 1].map(|k| height(&read["blocks"][k]));
            assert!(most < cusp + left + rounding, "{control}: {most} um, planned {cusp} and {left}");
            assert!(least > deep.min(0.0) - rounding, "{control}: {least} um, planned {deep}");
            // and the map is not just small: between passes and on blocks something is left
            assert!(most > 0.5 * (cusp + left), "{control}: {most} um, planned {cusp} and {left}");
        }
    }
}

/// The map of what passes leave: nowhere more than the highest ridge, which is solved by itself, and nearly that beside it; the same in the
/// file; lower by the stock's height where there is one.
#[test]
fn the_map_of_what_is_left_ends_at_the_highest_ridge() {
    let out = folder("mill_map");
    let spec = written(&out, "milled.chain", &sound());
    let found = json(&spec, &out, &["--rows", "320", "--columns", "81", "--map", "csv,json"]);
    let map = &found["map"];
    let heights: Vec<f64> = map["heights_um"].as_array().unwrap().iter().map(|h| h.as_f64().unwrap()).collect();
    assert_eq!([heights.len(), map["rows"].as_u64().unwrap() as usize], [320 * 81, 320]);
    assert_eq!(map["untouched"], 0);
    let most = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let cusp = found["cusp"]["height_um"].as_f64().unwrap();
    assert_eq!(map["left"][0]["height_um"].as_f64(), Some(most));
    assert_eq!(map["left"][1]["height_um"].as_f64(), Some(least));
    // rounding of positions of some 100 mm
    assert!(most <= cusp + 1e-9, "{most} {cusp}");
    // 40 rows between two passes: a row lies within an 80th of the step from the ridge, whose sides rise by 4 H per step; the highest ridge
    // lies at the end of the passes, where the cutter stops and leaves up to 4 % more than in the column beside it
    assert!(most > cusp * (1.0 - 4.0 / 80.0 - 0.04), "{most} {cusp}");
    assert!(least > -1e-6 && least < 0.01 * cusp, "{least}");
    let csv = std::fs::read_to_string(out.join("milled.part.left.csv")).unwrap();
    let mut rows = csv.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let column =
        |name: &str| header.iter().position(|title| *title == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
    let [left, by] = [column("left"), column("left_by_pass")];
    let rows: Vec<Vec<&str>> = rows.map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 320 * 81);
    for (row, height) in rows.iter().zip(&heights) {
        assert_eq!(row[left].parse::<f64>().unwrap(), *height);
    }
    assert_eq!([rows[0][by], rows[320 * 81 - 1][by]], ["1", "9"]);
    let same: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("milled.part.left.json")).unwrap()).unwrap();
    assert!(same.to_string().contains("left_by_pass"));

    let spec = written(
        &out,
        "milled.chain",
        &job("work_z: 60 mm", BALL, &format!("{AREA} lead 5 deg\n tilt 70 deg\n stock 0.1 mm\n")),
    );
    let stock = json(&spec, &out, &["--rows", "320", "--columns", "81"]);
    let [with, without] = [&stock, &found].map(|of| of["map"]["left"][0]["height_um"].as_f64().unwrap());
    // ridges are a little lower above a flank that is convex across the passes, by 0.1 mm in a radius of some 12 mm
    assert!((with / without - 1.0).abs() < 0.02, "{with} {without}");
}

/// Picture, report and page of a job that mills: ridges with the highest in numbers, clearances and axes along a pass, what is left as colours.
#[test]
fn pictures_reports_and_pages_show_what_is_left() {
    let out = folder("mill_shown");
    let milling = format!("{AREA} lead 5 deg\n tilt 70 deg\n clear of convex by 0.1 mm with cutter.whole\n");
    let spec = written(&out, "milled.chain", &job("work_z: 60 mm", BALL, &milling));
    let place = out.to_str().unwrap();
    let run = |arguments: &[&str]| {
        let run = flank(&[arguments, &["--job", "milled", "--out", place]].concat());
        assert!(run.status.success(), "{arguments:?}: {}", text(&run.stderr));
        text(&run.stdout)
    };
    let cusp = json(&spec, &out, &[])["cusp"]["height_um"].as_f64().unwrap();
    run(&["plot", &spec, "--what", "milling", "--format", "svg"]);
    let svg = text_of(&out.join("milled.milling.svg"));
    let highest = format!("{cusp:.3} \u{b5}m");
    for words in [
        "ridges between the passes",
        "cutter across the passes, at the highest ridge",
        "clearance along the pass",
        "rotary axes along the pass",
        "cutter.whole to convex",
        highest.as_str(),
    ] {
        assert!(svg.contains(&format!("aria-label=\"{words}\"")), "{words}");
    }
    let told: Value = serde_json::from_str(&run(&["report", &spec, "--json"])).unwrap();
    assert_eq!(told["millings"][0]["map"]["points"], 465);
    let html = text_of(&out.join("milled.report.html"));
    let setup = &told["millings"][0]["setup"];
    assert_eq!([&setup["cutter"], &setup["machine"][1]], ["ball_mill", "five_axis_table_table"], "{setup}");
    let radius = setup["settings"].as_array().unwrap().iter().find(|one| one["name"] == "radius").expect("a radius");
    assert_eq!((radius["value"].as_f64(), radius["unit"].as_str()), (Some(1.0), Some("mm")));
    for words in [
        "What is left, \u{b5}m, by shares of the milled part",
        "What the axes do",
        "clearance along the pass",
        "Cutter and program",
        "radius 1 mm, reach 20 mm, holder radius 8 mm, holder length 40 mm",
        "9, evenly spread, one way",
        "600 mm/min of the cutter along the surface",
        "not said: --spindle does",
        "none chosen: --nc of",
        "70.000 deg",
    ] {
        assert!(html.contains(words), "{words}");
    }
    run(&["view", &spec]);
    assert!(text_of(&out.join("milled.html")).contains("left by part"));
    let refused =
        |arguments: &[&str]| text(&flank(&[&["plot", &spec, "--job", "milled"][..], arguments].concat()).stderr);
    let told = refused(&["--what", "milling", "--milling", "other"]);
    assert!(told.contains("there is no milling `other`; there is: `part`"), "{told}");
    let told = refused(&["--what", "machine", "--milling", "part"]);
    assert!(told.contains("is of pictures of a milling: add `milling` to"), "{told}");
    let told = text(&flank(&["plot", "specs/bevel/pinion_19x62.chain", "--what", "milling", "--out", place]).stderr);
    assert!(told.contains("no `mill` of it says which surface is milled"), "{told}");
}

/// Bull-nose and barrel cutters, and both ways: each map ends at its highest ridge, and programs leave what is planned.
#[test]
fn other_cutters_leave_what_is_planned() {
    let out = folder("mill_cutters");
    let bull = "bull_mill(radius: 1 mm, corner: 0.5 mm, reach: 20 mm, holder_radius: 8 mm)";
    let barrel = "barrel_mill(radius: 3 mm, barrel_radius: 40 mm, height: 5 mm)";
    let cases = [
        (bull, AREA.to_string() + "lead 12 deg\n tilt 20 deg"),
        (barrel, AREA.replace("0.45 .. 0.55 by 9", "0.3 .. 0.7 by 4") + "lead 2 deg\n tilt 88 deg"),
        (BALL, AREA.to_string() + "lead 5 deg\n tilt 70 deg\n both ways"),
    ];
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    for (cutter, milling) in cases {
        let spec = written(&out, "milled.chain", &job("work_z: 60 mm", cutter, &milling));
        json(&spec, &out, &["--nc", "linuxcnc"]);
        let program = out.join("milled.part.ngc");
        let read = json(&spec, &out, &["--verify", program.to_str().unwrap()]);
        let height = |value: &Value| value["height_um"].as_f64().expect("a height");
        let (cusp, blocks) = (height(&read["cusp"]), height(&read["blocks"][0]));
        let (map, verified) = (&read["map"], &read["verified"]);
        assert_eq!([&map["untouched"], &verified["untouched"]], [0, 0], "{cutter}: {map}");
        assert!(
            height(&map["left"][0]) <= cusp + 1e-9 && height(&map["left"][0]) > 0.4 * cusp,
            "{cutter}: {map} {cusp}"
        );
        assert!(height(&map["left"][1]) > -1e-6, "{cutter}: {map}");
        let left = height(&verified["left"][0]);
        assert!(left < cusp + blocks.max(0.0) + rounding, "{cutter}: {left} um, planned {cusp} and {blocks}");
    }
}

/// Flat and bull-nose end mills leave what is planned, in the map and by programs. Where passes of an edge end, the round edge has not cut what
/// lies beside them: without flutes, which are in front of it, the cut ends there, and how much is missing is told with a place.
#[test]
fn flat_and_bull_nose_end_mills_leave_what_is_planned() {
    let out = folder("mill_flat");
    let flat = "flat_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)";
    let disc = "disc_mill(radius: 1 mm)";
    let bull = "bull_mill(radius: 1 mm, corner: 0.2 mm, reach: 20 mm, holder_radius: 8 mm)";
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    for (cutter, lean) in [
        (flat, "lead 30 deg"),
        (disc, "lead 20 deg\n tilt -5 deg"),
        (flat, "lead 25 deg\n tilt -10 deg"),
        (bull, "lead 20 deg\n tilt -5 deg"),
    ] {
        // blocks are shorter than the cutter is wide, and longer
        for blocks in [9, 40] {
            let area = AREA.replace("0.8 by 9", &format!("0.8 by {blocks}"));
            let spec = written(&out, "milled.chain", &job("work_z: 60 mm", cutter, &(area + lean)));
            json(&spec, &out, &["--nc", "linuxcnc"]);
            let program = out.join("milled.part.ngc");
            let read = json(&spec, &out, &["--verify", program.to_str().unwrap()]);
            let height = |value: &Value| value["height_um"].as_f64().expect("a height");
            let (cusp, most, least) = (height(&read["cusp"]), height(&read["blocks"][0]), height(&read["blocks"][1]));
            let (map, verified) = (&read["map"], &read["verified"]);
            assert_eq!([&map["untouched"], &verified["untouched"]], [0, 0], "{cutter} {lean}: {map}");
            let left = height(&map["left"][0]);
            // the highest ridge is that at an end, where the map has no point
            assert!(left <= cusp + 1e-9 && left > 0.2 * cusp, "{cutter} {lean}: {map} {cusp}");
            assert!(height(&map["left"][1]) > -1e-6, "{cutter} {lean}: {map}");
            let [left, deep] = [0, 1].map(|k| height(&verified["left"][k]));
            assert!(left < cusp + most.max(0.0) + rounding, "{cutter} {lean}: {left} um, planned {cusp} and {most}");
            assert!(deep > least.min(0.0) - rounding, "{cutter} {lean}: {deep} um, planned {least}");
            let told = read["remarks"].to_string();
            assert_eq!(told.contains("the edge of cutter.cutting is round"), cutter == disc, "{told}");
        }
    }
}

/// A flat end mill both ways leans into the feed on each way, and keeps what is planned; the trunnion turns farther than that of the library.
#[test]
fn a_flat_end_mill_goes_both_ways() {
    let out = folder("mill_flat_both");
    let flat = "flat_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)";
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    for lean in ["lead 30 deg", "lead 20 deg\n tilt -5 deg"] {
        let spec = job("work_z: 60 mm", flat, &format!("{AREA} {lean}\n both ways"));
        let wide = "axis A : rotary in -180 deg .. 180 deg";
        let spec = spec.replace("axis A : rotary in -120 deg .. 120 deg", wide);
        assert!(spec.contains(wide));
        let spec = written(&out, "milled.chain", &spec);
        json(&spec, &out, &["--nc", "linuxcnc"]);
        let read = json(&spec, &out, &["--verify", out.join("milled.part.ngc").to_str().unwrap()]);
        let height = |value: &Value| value["height_um"].as_f64().expect("a height");
        let (cusp, most, least) = (height(&read["cusp"]), height(&read["blocks"][0]), height(&read["blocks"][1]));
        let (map, verified) = (&read["map"], &read["verified"]);
        assert_eq!([&map["untouched"], &verified["untouched"]], [0, 0], "{lean}: {map}");
        let left = height(&map["left"][0]);
        // where one pass begins and the next ends a ridge is far higher than at the points of the map
        assert!(left <= cusp + 1e-9 && left > 0.05 * cusp, "{lean}: {map} {cusp}");
        assert!(height(&map["left"][1]) > -1e-6, "{lean}: {map}");
        let [left, deep] = [0, 1].map(|k| height(&verified["left"][k]));
        assert!(left < cusp + most.max(0.0) + rounding, "{lean}: {left} um, planned {cusp} and {most}");
        assert!(deep > least.min(0.0) - rounding, "{lean}: {deep} um, planned {least}");
    }
}

/// Whole programs, also of several spaces, run through LinuxCNC's interpreter: each cutting block arrives, nothing is refused.
#[test]
fn linuxcnc_runs_whole_programs() {
    if Command::new("rs274").arg("-h").output().is_err() {
        eprintln!("skipped 1 test: rs274 of linuxcnc-uspace is not installed");
        return;
    }
    let out = folder("mill_rs274");
    let spec = written(&out, "milled.chain", &sound());
    let tools = written(&out, "tool.tbl", "T1 P1 D2.0 Z0.0 ;cutter\n");
    let variables = written(&out, "v.var", "5161 0\n5220 1\n");
    for spaces in ["1", "3"] {
        json(&spec, &out, &["--nc", "linuxcnc", "--spindle", "9000", "--spaces", spaces]);
        let program = out.join("milled.part.ngc");
        let arguments = ["-g", "-t", &tools, "-v", &variables, program.to_str().unwrap()];
        let run = Command::new("rs274").args(arguments).current_dir(&out).output().expect("it is installed");
        let told = format!("{}{}", text(&run.stdout), text(&run.stderr));
        assert!(run.status.success(), "{told}");
        let blocks = std::fs::read_to_string(&program).unwrap().lines().filter(|line| line.starts_with("G01")).count();
        // nine passes of nine positions, down and up
        assert_eq!(blocks, spaces.parse::<usize>().unwrap() * 9 * 10);
        assert_eq!(told.matches("STRAIGHT_FEED(").count(), blocks, "{told}");
    }
}

/// What cannot be milled: exit code 3, the place and a way out, and no program.
#[test]
fn what_cannot_be_milled_is_told_with_its_place() {
    let out = folder("mill_refused");
    let large = BALL.replace("radius: 1 mm", "radius: 3 mm");
    let lean = |lead: &str, tilt: &str| format!("{AREA} lead {lead} deg\n tilt {tilt} deg\n");
    let heel = format!(
        "{} clear of concave by 0 mm with cutter.whole\n",
        lean("0.5", "0").replace("by 9\n along", "by 60\n along")
    );
    let clear = format!("{} clear of convex by 0.1 mm with cutter.whole\n", lean("5", "70"));
    let fine = lean("5", "70").replace("0.55 by 9", "0.55, scallop 1e-9 um");
    let here = "work_z: 60 mm";
    let near_pole = |tilt: &str| lean("-47", tilt).replace("0.8 by 9", "0.8 by 5");
    let disc = "disc_mill(radius: 1 mm)";
    let cases: [(String, &[&str], &[&str]); 8] = [
        (
            job(here, &large, &clear),
            &[
                "cutter.whole cuts 2.",
                "mm into convex while the cutter is at profilewise",
                "a ball that stays clear of convex has R 1.",
            ],
            &[],
        ),
        (
            job(here, BULL, &heel),
            &[
                "cutter.whole cuts 0.3713 mm into concave while the cutter is at profilewise",
                "lean it more with `lead`",
            ],
            &[],
        ),
        (
            job(here, BALL, &near_pole("7")),
            &[
                "the block at profilewise 0.4750, lengthwise 0.6500 leaves the surface",
                " deg from the pole",
                "lean the cutter away with `lead` or `tilt`",
            ],
            &[],
        ),
        (
            job(here, BALL, &near_pole("7").replace("0.2 .. 0.8 by 5", "0.65 .. 0.8 by 2")),
            &["C of mill turns by ", "the cutter's axis passes the pole, 1."],
            &["--tcp"],
        ),
        (
            job("work_z: 600 mm", BALL, &lean("5", "70")),
            &[
                "mill goes beyond the travel of Y: -7",
                "at profilewise 0.4500, lengthwise 0.8000, its travel is -300.000 mm .. 300.000 mm",
                "clamp the work elsewhere",
            ],
            &[],
        ),
        (
            job(here, BALL, &fine),
            &["part: it would take ", "passes; at most 100000 are made", "allow a higher scallop"],
            &[],
        ),
        (
            job(here, disc, &lean("0", "0")),
            &["the bottom of cutter.cutting lies flat on concave at profilewise 0.4500", "give it a `lead` above zero"],
            &[],
        ),
        (
            job(here, disc, &lean("5", "70")),
            &[
                "the passes beside profilewise 0.4500, lengthwise 0.2375 do not meet",
                "lean the cutter more with `lead` and less with `tilt`: to the side its edge cuts no farther",
            ],
            &[],
        ),
    ];
    for (spec, parts, arguments) in cases {
        let spec = written(&out, "milled.chain", &spec);
        let (code, _, told) = mill(&spec, &out, &[arguments, &["--nc", "fanuc"]].concat());
        assert_eq!(code, 3, "{told}");
        for part in parts {
            assert!(told.contains(part), "{part} in {told}");
        }
        assert!(!out.join("milled.part.nc").exists(), "{told}");
    }
}

/// Programs with words that the machine has not, or that are not followed: the line and the reason.
#[test]
fn programs_that_are_not_followed_are_told_with_their_line() {
    let out = folder("mill_unread");
    let spec = written(&out, "milled.chain", &sound());
    let klartext = |line: &str| format!("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S9000\n{line}\n3 END PGM A MM\n");
    let cases: [(String, &str); 12] = [
        ("%\nG01 X1 B2 F3\n".to_string(), ":2: mill has no word `B`; it has X Y Z A C"),
        ("%\nG01 X1 Y2 F3\n".to_string(), ":2: cuts before each axis has its position"),
        ("G90\nG02 X1 Y2 I3\n".to_string(), ":2: G2 is a circle: only straight blocks are followed"),
        ("G91\n".to_string(), ":1: G91 counts from where the axes stand"),
        ("G01 X#3\n".to_string(), ":1: `X` has a parameter or an expression for a value, which is not read"),
        ("G90\nM30\n".to_string(), ":2: the program has no cutting block"),
        (klartext("2 L X+1 V+2 R0 FMAX"), ":3: mill has no word `V`; it has X Y Z A C"),
        (klartext("2 CC X+1 Y+2"), ":3: `CC X+1 Y+2` is no straight block `L`"),
        (klartext("2 L IX+1 F200"), ":3: `IX+1` counts from where the axis stands"),
        (klartext("2 L X+1 RL F200"), ":3: `RL` compensates the radius"),
        (
            klartext("2 FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS"),
            ":3: FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS is not followed",
        ),
        (klartext("2 L X+Q1 F200"), ":3: `X` has a parameter or an expression for a value, which is not read"),
    ];
    for (program, part) in cases {
        let file = written(&out, "program.nc", &program);
        let (code, _, told) = mill(&spec, &out, &["--verify", &file]);
        assert_eq!(code, 1, "{program}: {told}");
        assert!(told.contains(part), "{part} in {told}");
    }
}

/// Klartext of others: block numbers, decimal commas, M128, rapids, blocks in the machine's coordinates.
#[test]
fn klartext_of_others_is_followed() {
    let out = folder("mill_klartext");
    let spec = written(&out, "milled.chain", &sound());
    json(&spec, &out, &["--nc", "heidenhain", "--tcp"]);
    let own = std::fs::read_to_string(out.join("milled.part.h")).unwrap();
    let renamed = own
        .replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "M128 F1000")
        .replace("FUNCTION RESET TCPM", "M129")
        .replace("L Z+500.0000 R0 FMAX M91", "L Z-1 R0 FMAX M91");
    let comma = |line: &str| if line.starts_with('L') { line.replace('.', ",") } else { line.to_string() };
    let numbered: String = renamed.lines().enumerate().map(|(k, line)| format!("{k} {}\n", comma(line))).collect();
    let theirs = written(&out, "theirs.h", &numbered);
    let own = out.join("milled.part.h");
    let [found, expected] = [theirs.as_str(), own.to_str().unwrap()]
        .map(|file| json(&spec, &out, &["--tcp", "--verify", file])["verified"].clone());
    for part in ["blocks", "left", "untouched", "tool_centre_control"] {
        assert_eq!(found[part], expected[part], "{part}");
    }
}
