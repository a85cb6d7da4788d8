//! `flank mill` with `--clamp` and `--certify`: the best clamping is that of many tries, fixtures are kept clear of, and what is proven is so.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text, written};

const SPECS: [&str; 7] = [
    "functions/bevel",
    "machines/cradle",
    "tools/face_mill",
    "functions/blanks_19x62",
    "bevel/pinion_19x62",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const AREA: &str =
    "passes profilewise: 0.45 .. 0.55 by 5\n along lengthwise: 0.2 .. 0.8 by 9\n lead 5 deg\n tilt 70 deg\n";
/// The face of a chuck, square to z, and a machine with a wedge under the work.
const FIXTURES: &str = "
machine with_wedge extends five_axis_table_table {
    param wedge : angle in -60 deg .. 60 deg = 0 deg
    frame clamped in work = rotate_y(wedge)
}
tool chuck {
    surface face(out: length in 5 mm .. 300 mm, turn: angle in -180 deg .. 180 deg) {
        at = [out * cos(turn), out * sin(turn), 0 mm]
        body towards [0, 0, -1]
    }
}
";

fn job(chuck: &str, milling: &str) -> String {
    let library = support::self_contained(&SPECS);
    format!(
        "{library}{FIXTURES}\njob milled extends pinion_19x62 {{\n machine mill = with_wedge(work_z: 60 mm)\n \
         tool ball = ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)\n tool jaws = chuck\n mount ball on mill.cutter\n \
         mount jaws on mill.{chuck}\n mill part of concave with ball.cutting in mill.clamped {{\n{AREA}{milling}\n }}\n}}\n"
    )
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

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

/// The largest rate of a rotary axis over its travel, from what is told of the axes.
fn rotary(found: &Value) -> f64 {
    let axes = found["axes"].as_array().expect("axes").iter().filter(|axis| axis["unit"] == "deg");
    let share = |axis: &Value| {
        let whole = if axis["travel"].is_null() {
            360.0
        } else {
            number(&axis["travel"]["high"]) - number(&axis["travel"]["low"])
        };
        number(&axis["rate_per_mm"]) / whole
    };
    axes.map(share).fold(0.0, f64::max)
}

#[test]
fn the_best_clamping_is_that_of_many_tries() {
    let out = folder("clamp_best");
    let spec = written(&out, "milled.chain", &job("table", ""));
    let found = json(&spec, &out, &["--clamp", "mill.wedge=-40deg..40deg", "--clamp", "work_z=20mm..120mm"]);
    let clamping = &found["clamping"];
    // as the spec says: the same numbers as without the search
    assert!((number(&clamping["before"]["rotary"]) - rotary(&found)).abs() < 1e-15, "{clamping}");
    let settings = clamping["settings"].as_array().expect("settings");
    assert_eq!((&settings[0]["name"], &settings[1]["name"]), (&Value::from("mill.wedge"), &Value::from("mill.work_z")));
    let set = |wedge: f64, height: f64| {
        let [wedge, height] = [format!("mill.wedge={wedge}deg"), format!("mill.work_z={height}mm")];
        let (code, told, errors) = mill(&spec, &out, &["--set", &wedge, "--set", &height, "--json"]);
        assert!(code == 0 || code == 3, "{errors}");
        (code == 0).then(|| rotary(&serde_json::from_str(&told).expect("JSON")))
    };
    let best = set(number(&settings[0]["after"]), number(&settings[1]["after"])).expect("it is possible");
    assert!((best - number(&clamping["after"]["rotary"])).abs() < 1e-12, "{best} {clamping}");
    assert!(best < 0.99 * rotary(&found), "{best} {clamping}");
    for k in 0..=16 {
        let tried = set(-40.0 + 5.0 * f64::from(k), 60.0);
        // the search ends with steps of a ten thousandth of the range
        assert!(tried.is_none_or(|tried| tried > best * (1.0 - 1e-3)), "{k}: {tried:?} {best}");
    }
}

#[test]
fn settings_that_place_nothing_are_told() {
    let out = folder("clamp_refused");
    let spec = written(&out, "milled.chain", &job("table", ""));
    let cases = [
        ("tilt=1deg..2deg", 1, "`mill` has no setting `tilt`; there is: "),
        ("mill.counts_tool_turns=0..1", 1, "`mill` has no setting `mill.counts_tool_turns`"),
        ("mill.wedge=2deg..1deg", 2, "the first value must be below the last one"),
        ("mill.wedge=0deg..70deg", 1, "60 deg"),
        ("mill.work_z=600mm..700mm", 3, "no value of mill.work_z keeps the axes of mill within their travels"),
        ("mill.wedge", 2, "write NAME=FROM..TO"),
    ];
    for (range, code, part) in cases {
        let (found, _, told) = mill(&spec, &out, &["--clamp", range]);
        assert!(found == code && told.contains(part), "{range}: {found} {told}");
    }
}

/// The chuck lies square to the table's axis: the ball is above it by its own lowest point.
#[test]
fn fixtures_are_kept_clear_of() {
    let out = folder("clear_fixture");
    let spec = written(&out, "milled.chain", &job("table", " clear of jaws.face by 1 mm with ball.whole\n"));
    let found = json(&spec, &out, &["--format", "csv"]);
    let kept = &found["clearances"][0];
    assert_eq!(kept["surface"], "jaws.face");
    // the ball over a plane, in each position of the table of cutter locations: the work is 60 mm above the table
    let table = std::fs::read_to_string(out.join("milled.part.csv")).unwrap();
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|own| *own == name).expect("a column");
    let (tip, axis) = (column("tip_z"), column("axis_z"));
    let lowest = lines
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            // the centre of the ball, less its radius; the lower edge of the holder's lower end, which may be either
            let (tip, axis) = (numbers[tip], numbers[axis]);
            let ball = tip + axis - 1.0;
            let holder = tip + (20.0 * axis).min(60.0 * axis) - 8.0 * (1.0 - axis * axis).sqrt();
            60.0 + ball.min(holder)
        })
        .fold(f64::INFINITY, f64::min);
    let least = number(&kept["least"]);
    assert!((least - lowest).abs() < 1e-9, "{least} {lowest}");
    let moved = job("cutter", " clear of jaws.face by 1 mm with ball.whole\n");
    let (code, _, told) = mill(&written(&out, "moved.chain", &moved), &out, &[]);
    assert!(code == 1 && told.contains("error[E0520]: `jaws.face` moves against the work"), "{told}");
}

#[test]
fn clearances_are_proven_between_positions_or_told_not_to_be() {
    let out = folder("clear_certified");
    let clear = |by: f64| job("table", &format!(" clear of convex by {by} mm with ball.whole\n"));
    let spec = written(&out, "milled.chain", &clear(0.1));
    let found = json(&spec, &out, &["--certify"]);
    let kept = &found["clearances"][0];
    assert_eq!((number(&kept["proven"]["proven"]), number(&kept["proven"]["blocks"])), (40.0, 40.0), "{kept}");
    assert!((number(&kept["proven"]["limit"]) - 0.099).abs() < 1e-12, "{kept}");
    let least = number(&kept["least"]);
    // between the positions the ball comes no nearer than a um: that is proven with 4 um to spare
    let spec = written(&out, "close.chain", &clear(least - 0.001));
    let found = json(&spec, &out, &["--certify=4um"]);
    assert_eq!(number(&found["clearances"][0]["proven"]["proven"]), 40.0, "{found}");
    // what is solved at the positions is kept, but not by so much more between them
    let spec = written(&out, "near.chain", &clear(least - 1e-4));
    let (code, _, told) = mill(&spec, &out, &["--certify=1um", "--json"]);
    assert!(code == 0 || told.contains("it is not proven that ball.whole comes nowhere nearer"), "{code} {told}");
    // the ball touches the milled flank
    let touching = job("table", " clear of concave by 0 mm with ball.whole\n");
    let spec = written(&out, "touching.chain", &touching);
    let (code, _, told) = mill(&spec, &out, &["--certify"]);
    assert_eq!(code, 3, "{told}");
    assert!(
        told.contains("it is not proven that ball.whole comes nowhere nearer than -0.0010 mm to concave"),
        "{told}"
    );
}
