//! `flank contact` as a user runs it.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text, top, written};

const PAIR: &str = "specs/pairs/bevel_19x62.chain";

/// What a run prints as JSON.
fn document(arguments: &[&str], code: i32) -> Value {
    let run = flank(&[arguments, &["--json"]].concat());
    assert_eq!(run.status.code(), Some(code), "{}", text(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

fn reference() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/contact_edges_a.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("the table")).expect("JSON")
}

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap_or_else(|| panic!("{name} of {of}"))
}

/// The published pair from its spec alone, mounted right and wrong: where contact of the flanks begins and ends, the contact ratio, the
/// middle with its error and parabola, and the transfer are those of a table that was solved independently.
#[test]
fn the_published_pair_is_as_its_table_says() {
    let out = folder("contact");
    let table = reference();
    let wrong = ["--error", "m.P=0.1mm", "--error", "m.S=0.002rad"];
    for (case, errors) in table["cases"].as_array().expect("cases").iter().zip([&[][..], &wrong]) {
        let arguments = [&["contact", PAIR, "--no-picture", "--out", out.to_str().unwrap()][..], errors].concat();
        let found = document(&arguments, 0);
        assert_eq!((&found["schema"], &found["kind"]), (&Value::from("flank.contact/2"), &Value::from("point")));
        assert_eq!(found["mounted"].as_array().expect("errors").len(), errors.len() / 2);
        let degrees = |name: &str| number(case, name).to_degrees();
        assert!((number(&found, "ratio") - number(case, "flank_contact_ratio")).abs() < 1e-9, "{}", found["ratio"]);
        let ends = found["ends"].as_array().expect("two ends");
        for (end, (name, edge)) in ends.iter().zip([("flank_contact_from", "toe"), ("flank_contact_to", "tip")]) {
            // the table has them to 1e-9 rad
            assert!((number(end, "turn") - degrees(name)).abs() < 1e-7, "{end}");
            assert_eq!(end["at"], edge, "{end}");
        }
        let (middle, vertex) = (&found["middle"], &case["vertex"]);
        // the table has its vertex by differences
        assert!((number(middle, "turn") - number(vertex, "thetaP").to_degrees()).abs() < 1e-7, "{middle}");
        assert!((number(middle, "error") - number(vertex, "TE").to_degrees()).abs() < 1e-11, "{middle}");
        let parabola = number(vertex, "d2TE") * 1e6 * (1f64).to_radians().powi(2);
        assert!((number(middle, "parabola") / parabola - 1.0).abs() < 1e-6, "{middle} {parabola}");
        for (member, name) in ["pinion_share", "gear_share"].iter().enumerate() {
            for k in 0..2 {
                let share = middle["on"][member]["shares"][k].as_f64().expect("a share");
                assert!((share - vertex[name][k].as_f64().expect("a share")).abs() < 1e-7, "{middle} {vertex}");
            }
        }
        // either end of a pitch
        let transfer = found["error"]["transfers"][0].as_f64().expect("a transfer");
        let pitches = (transfer - degrees("transfer_thetaP")) * 19.0 / 360.0;
        assert!((pitches - pitches.round()).abs() < 1e-9, "{transfer}");
        // between the rows of the table it is a little more
        let least = number(case, "peak_to_peak_TE_of_rows") * 1e6;
        assert!((least..1.2 * least).contains(&number(&found["error"], "peak_to_peak")), "{}", found["error"]);
        let is_led_by_an_edge = case["rows"].as_array().expect("rows").iter().any(|row| row["kind"] != "flank");
        assert_eq!(!found["edges"].as_array().expect("edges").is_empty(), is_led_by_an_edge);
    }
}

/// What an error of an axis does is what mounting the pair so gives, and the mountings that are told bring the contact where they say.
#[test]
fn mounting_errors_do_what_is_told_of_them() {
    let out = folder("contact_mounting");
    let spec = ["contact", PAIR, "--no-picture", "--positions", "20", "--out", out.to_str().unwrap()];
    let told = document(&[&spec[..], &["--sensitivity", "--vhj"]].concat(), 0);
    let middle = |found: &Value, name: &str| number(&found["middle"], name);
    let influences = told["influences"].as_array().expect("influences");
    for influence in influences.iter().filter(|influence| influence["kind"] == "mounting") {
        let (axis, per) = (influence["name"].as_str().expect("a name"), influence["per"].as_str().expect("an error"));
        let [plus, minus] = ["", "-"].map(|sign| {
            let error = format!("{axis}={sign}{}", per.replace(' ', ""));
            document(&[&spec[..], &["--error", &error]].concat(), 0)
        });
        // half the difference of both sides: what is left is of third order in an error that moves the middle by a tenth of a millimetre
        let turn = 0.5 * (middle(&plus, "turn") - middle(&minus, "turn"));
        assert!((turn - number(influence, "turn")).abs() < 1e-3 * turn.abs().max(1e-2), "{influence} {turn}");
        let error = 0.5 * (middle(&plus, "error") - middle(&minus, "error")).to_radians() * 1e6;
        assert!((error - number(influence, "error")).abs() < 1e-3 * error.abs().max(1.0), "{influence} {error}");
    }
    let rows = told["vhj"].as_array().expect("rows");
    assert_eq!(rows.len(), 6, "toe, middle and heel, with the gear as it is and moved");
    // the others take the error or the tools out of their ranges
    let is_within = |row: &&Value| {
        let axes = row["axes"].as_array().expect("axes").len();
        [("toe", 2), ("middle", 2), ("middle", 3), ("heel", 3)]
            .iter()
            .any(|(to, count)| row["to"] == *to && axes == *count)
    };
    for row in rows.iter().filter(is_within) {
        let axes = row["axes"].as_array().expect("axes").iter().zip(row["errors"].as_array().expect("a mounting"));
        let errors = axes.map(|(axis, error)| format!("{}={:?}mm", axis.as_str().unwrap(), error.as_f64().unwrap()));
        let options = errors.flat_map(|error| ["--error".to_string(), error]).collect::<Vec<String>>();
        let found = document(&[&spec[..], &options.iter().map(String::as_str).collect::<Vec<&str>>()].concat(), 0);
        let shares = &found["middle"]["on"][1]["shares"];
        for (k, name) in ["lengthwise", "profilewise"].into_iter().enumerate() {
            assert!((shares[k].as_f64().expect("a share") - number(row, name)).abs() < 1e-7, "{row} {shares}");
        }
        if row["axes"].as_array().expect("axes").len() == 3 {
            let [found, told] = [&found, &told].map(|of| number(&of["middle"], "error").to_radians());
            assert!((found - told).abs() < 1e-8, "{row}: {found} {told}");
        }
    }
}

/// Settings of the bevel pair with their values and units, and the change that influences are told for.
const SETTINGS: [(&str, f64, &str, f64); 5] = [
    ("pinion_cutter.outside_point_radius", 98.691, "mm", 0.01),
    ("p.machine_root_angle", 15.64096727073747, "deg", 1.0 / 60.0),
    ("p.modified_roll_2c", 0.092298, "", 0.092298e-3),
    ("g.ratio_of_roll", 1.023367028989512, "", 1.023367028989512e-3),
    ("gear_cutter.blade_angle", 20.0, "deg", 1.0 / 60.0),
];

/// What is told of settings is what solving again with another value finds.
#[test]
fn settings_do_what_is_told_of_them() {
    let out = folder("contact_settings");
    let spec = ["contact", PAIR, "--no-picture", "--positions", "20", "--out", out.to_str().unwrap()];
    let told = document(&[&spec[..], &["--sensitivity"]].concat(), 0);
    let middle = |found: &Value, name: &str| number(&found["middle"], name);
    for (name, value, unit, step) in SETTINGS {
        let influences = told["influences"].as_array().expect("influences");
        let influence = influences.iter().find(|of| of["name"] == name).expect("a setting that changes the contact");
        let [plus, minus] = [1.0, -1.0].map(|sign| {
            let setting = format!("{name}={:?}{unit}", value + sign * step);
            document(&[&spec[..], &["--set", &setting]].concat(), 0)
        });
        let turn = 0.5 * (middle(&plus, "turn") - middle(&minus, "turn"));
        assert!((turn - number(influence, "turn")).abs() < 1e-3 * turn.abs().max(1e-2), "{influence} {turn}");
        let error = 0.5 * (middle(&plus, "error") - middle(&minus, "error")).to_radians() * 1e6;
        assert!((error - number(influence, "error")).abs() < 1e-3 * error.abs().max(1.0), "{influence} {error}");
        let parabola = 0.5 * (middle(&plus, "parabola") - middle(&minus, "parabola")) / middle(&told, "parabola");
        let share = number(influence, "parabola");
        assert!((parabola - share).abs() < 2e-3 * share.abs().max(1e-2), "{influence} {parabola}");
        let axis = |found: &Value| found["middle"]["ellipse"][0].as_f64().expect("an ellipse");
        let ellipse = 0.5 * (axis(&plus) - axis(&minus)) / axis(&told);
        let share = number(influence, "ellipse");
        assert!((ellipse - share).abs() < 2e-3 * share.abs().max(1e-2), "{influence} {ellipse}");
    }
}

/// Two crowned paddles, written here; their contact is in the middle of both, by hand.
const PADDLES: &str = r#"
machine two_shafts {
    axis first  : rotary
    axis second : rotary
    axis A      : linear
    frame bed
    frame first  in bed = rotate_z(first)
    frame second in bed = translate_x(40 mm + A) rotate_z(second)
    fix A = 0 mm
}
machine bench {
    axis lift : linear
    frame table
    frame part in table = translate_z(lift)
    fix lift = 0 mm
}
tool paddle {
    surface face(u: length in -4 mm .. 4 mm, v: length in -6 mm .. 6 mm) {
        at = [20 mm + u, -1 mm - (u^2 + v^2) / 80 mm, v]
        body towards [0, -1, 0]
    }
}
job paddles {
    machine b = bench
    tool p = paddle
    mount p on b.part
    surface left, right in b.table = move(p.face, p.face)
    sample left, right { u: -4 mm .. 4 mm by 9, v: -6 mm .. 6 mm by 9 }
    machine m = two_shafts
    mount left  on m.first
    mount right on m.second
    motion  turn : angle in -2 deg .. 2 deg
    unknown lag : angle in LAG
    drive m.first  = turn
    drive m.second = 180 deg - turn + lag
    contact driving = left with right, over: turn, for: lag
}
"#;

/// At no turn both faces stand a millimetre below and above the line of the shafts: each turns by half the lag's way to meet.
#[test]
fn paddles_touch_in_the_middle() {
    let out = folder("contact_paddles");
    let spec = written(&out, "paddles.chain", &PADDLES.replace("LAG", "1 deg .. 9 deg"));
    let found = document(&["contact", &spec, "--out", out.to_str().unwrap()], 0);
    assert_eq!(found["kind"], "point");
    // both are spheres of 40 mm to second order, seen from where they touch
    let gap = found["middle"]["gap"].as_array().expect("two curvatures");
    assert!(gap.iter().all(|k| (k.as_f64().expect("1/mm") - 0.05).abs() < 1e-3), "{gap:?}");
    let kinds: Vec<&str> = found["remarks"]
        .as_array()
        .expect("remarks")
        .iter()
        .map(|remark| remark["kind"].as_str().expect("a kind"))
        .collect();
    assert_eq!(kinds, ["no_edges", "no_edges", "one_pair"]);
    assert!(out.join("paddles.driving.png").exists() && out.join("paddles.driving.csv").exists());
}

#[test]
fn what_cannot_touch_is_told() {
    let out = folder("contact_wrong");
    let at = out.to_str().unwrap();
    let run = |text: &str| {
        let spec = written(&out, "paddles.chain", text);
        flank(&["contact", &spec, "--out", at, "--no-picture"])
    };
    let told = |run: &std::process::Output| (run.status.code(), text(&run.stderr));
    let (code, message) = told(&run(&PADDLES.replace("LAG", "-9 deg .. -1 deg")));
    assert!(code == Some(3) && message.contains("do not reach each other within the range of `lag`"), "{message}");
    assert!(message.contains("the tooth of the spec alone is tried") && !message.contains("ones beside"), "{message}");
    let facing = PADDLES
        .replace("LAG", "-4 deg .. 4 deg")
        .replace("180 deg - turn", "0 deg - turn")
        .replace("40 mm + A", "0 mm + A");
    let (code, message) = told(&run(&facing));
    assert!(code == Some(3) && message.contains("face the same way where they meet"), "{message}");
    for (arguments, code, words) in [
        (&["--error", "m.B=1mm"][..], 1, "no such axis; it has m.first, m.second, m.A"),
        (&["--error", "m.A=1deg"], 1, "this axis takes a length"),
        (&["--error", "m.A=1"], 2, "write AXIS=VALUE with a unit"),
        (&["--error", "m.A=1mm", "--error", "m.A=2mm"], 2, "names `m.A` twice"),
        (&["nosuch"], 1, "there is no contact `nosuch`; there is: `driving`"),
    ] {
        let spec = written(&out, "paddles.chain", &PADDLES.replace("LAG", "1 deg .. 9 deg"));
        let run = flank(&[&["contact", &spec, "--out", at][..], arguments].concat());
        assert!(run.status.code() == Some(code) && text(&run.stderr).contains(words), "{}", text(&run.stderr));
    }
    let without = flank(&["contact", "specs/hobbing/spur_gear.chain"]);
    let words = "no job says which flanks touch";
    assert!(without.status.code() == Some(1) && text(&without.stderr).contains(words), "{}", text(&without.stderr));
    let solids = r#"
    profile blank {
        tip   = line(from: [6 mm, 23 mm], to: [-6 mm, 23 mm])
        lower = line(from: [-6 mm, 23 mm], to: [-6 mm, 10 mm])
        hub   = line(from: [-6 mm, 10 mm], to: [6 mm, 10 mm])
        upper = line(from: [6 mm, 10 mm], to: [6 mm, 23 mm])
    }
    solid driver in b.table = turned(blank, spaces: 18, of: [left])
    solid driven in b.table = turned(blank, spaces: 18, of: [right])
    machine m = two_shafts"#;
    let with_solids = PADDLES.replace("    machine m = two_shafts", solids);
    let (code, message) = told(&run(&with_solids.replace("LAG", "-2 deg .. 10 deg")));
    assert!(
        code == Some(1) && message.contains("those of driven are 20.000 deg apart; a range of at most 10.000 deg"),
        "{message}"
    );
    let (code, message) = told(&run(&with_solids.replace("LAG", "1 deg .. 9 deg")));
    assert!(code == Some(0) && !message.contains("no `solid`"), "{message}");
    let (code, message) = told(&run(&with_solids.replace("LAG", "-9 deg .. -1 deg")));
    assert!(code == Some(3) && message.contains("and the ones beside it are tried"), "{message}");
    // a blank that ends below the flanks
    let shallow = with_solids.replace("LAG", "1 deg .. 9 deg").replace("23 mm", "15 mm");
    let (code, message) = told(&run(&shallow));
    assert!(code == Some(3) && message.contains("the outline of driver leaves no sampled point of left"), "{message}");
}

/// Each position of the published pair, and of a line contact that ends at its fronts.
#[test]
fn contacts_are_proven_where_they_are_computed() {
    let out = folder("contact_proven");
    for spec in [PAIR, SPUR_PAIR] {
        let told =
            document(&["contact", spec, "drive_side", "--certify", "--no-picture", "--out", out.to_str().unwrap()], 0);
        let proven = &told["proven"];
        assert!(number(proven, "points") > 100.0, "{proven}");
        // rounding of places of 100 mm, amplified by a gap curvature of 1e-3 against the other of 1e-1
        assert!(number(proven, "radius_mm") < 1e-9 && number(proven, "error") < 1e-11, "{spec}: {proven}");
    }
}

/// Involutes of 21 and 34 teeth, module 5 mm, 22 deg, 138 mm apart and 24 mm wide: the line of contact comes and leaves at corners, and lasts for
/// the transverse contact ratio and the overlap. The pair runs without error, and nothing that is wrong with it is proportional.
#[test]
fn lines_of_contact_last_from_corner_to_corner() {
    let out = folder("contact_lines");
    let at = out.to_str().unwrap();
    let [pinion, gear] = [21.0, 34.0].map(|teeth: f64| 2.5 * teeth);
    let base = (22f64).to_radians().cos();
    let way = |tip: f64, radius: f64| (tip * tip - (radius * base).powi(2)).sqrt();
    let working = ((pinion + gear) * base / 138.0).acos();
    let path = way(pinion + 5.25, pinion) + way(gear + 5.0, gear) - 138.0 * working.sin();
    let pitch = std::f64::consts::TAU * pinion * base / 21.0;
    // with a gear as wide as the pinion, and with one beside it: there edges of both cross where the line comes or leaves
    let cases = [0.0, 0.0005, 0.05, 0.3, 0.7].into_iter().flat_map(|slope| [(slope, -12.0, 12.0), (slope, -7.0, 20.0)]);
    for (slope, front, back) in cases {
        let set = format!("slope={slope}");
        let [front_set, back_set] =
            [("gear_front", front), ("gear_back", back)].map(|(name, z)| format!("{name}={z}mm"));
        let spec = "tests/machines/involute_pair.chain";
        let pair = ["contact", spec, "--no-picture", "--sensitivity", "--out", at];
        let values = ["--set", &set, "--set", &front_set, "--set", &back_set];
        let found = document(&[&pair[..], &values].concat(), 0);
        let common = f64::min(back, 12.0) - f64::max(front, -12.0);
        let ratio = (path + common * slope) / pitch;
        assert!((number(&found, "ratio") - ratio).abs() < 1e-9, "{slope}: {} {ratio}", found["ratio"]);
        // urad
        assert!(number(&found["error"], "peak_to_peak") < 1e-6, "{slope}: {}", found["error"]);
        assert_eq!(found["kind"], "line");
        assert_eq!(found["middle"]["ellipse"], Value::Null);
        assert_eq!(found["influences"], Value::Array(Vec::new()), "{slope}");
        let kinds: Vec<&Value> = found["remarks"].as_array().expect("remarks").iter().map(|of| &of["kind"]).collect();
        assert!(kinds.contains(&&Value::from("not_linear")), "{kinds:?}");
        let ends = found["ends"].as_array().expect("two ends");
        assert!(ends.iter().all(|end| end["at"] != Value::Null), "{slope}: {ends:?}");
    }
    let run = flank(&[
        "contact",
        "tests/machines/involute_pair.chain",
        "--error",
        "m.D=2arcmin",
        "--no-picture",
        "--out",
        at,
        "--format",
        "csv",
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = std::fs::read_to_string(out.join("involute_pair.drive_side.csv")).expect("the table");
    assert!(table.contains("# mounted wrong: m.D = 0.03333"), "{}", &table[..500]);
}

const SPUR_PAIR: &str = "specs/pairs/spur_pair.chain";

/// The outline of a solid is where its teeth end: for samples too. The same gear in a blank that is 0.5 mm smaller and as much narrower.
#[test]
fn points_beyond_the_blank_are_trimmed() {
    let out = folder("contact_blank");
    let text = std::fs::read_to_string(top().join(SPUR_PAIR)).expect("the spec");
    for library in [
        "functions/hobbing.chain",
        "machines/parallel_pair.chain",
        "machines/rack_generating.chain",
        "machines/hobbing_6axis.chain",
        "tools/rack.chain",
    ] {
        let copy = out.join(library);
        std::fs::create_dir_all(copy.parent().expect("a folder")).expect("a folder");
        std::fs::copy(top().join("specs").join(library), copy).expect("a copy");
    }
    let text = text.replace("\"../", "\"");
    let smaller = text
        .replace("[back, pinion_tip]", "[back, pinion_tip - 0.5 mm]")
        .replace("[front, pinion_tip]", "[front + 0.5 mm, pinion_tip - 0.5 mm]")
        .replace("[front, pinion_radius / 2]", "[front + 0.5 mm, pinion_radius / 2]");
    let spec = written(&out, "smaller.chain", &smaller);
    let table = ["--no-picture", "--format", "csv", "--out", out.to_str().unwrap()];
    let solved = flank(&[&["solve", &spec, "--job", "spur_pair"][..], &table].concat());
    let told = String::from_utf8_lossy(&solved.stderr).into_owned();
    assert_eq!(solved.status.code(), Some(3), "{told}");
    assert!(told.contains("beyond tip of solid pinion, where its blank ends"), "{told}");
    assert!(told.contains("beyond front of solid pinion, where its blank ends"), "{told}");
    let rows = std::fs::read_to_string(out.join("spur_pair.csv")).expect("the table");
    let mut rows = rows.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect::<Vec<&str>>());
    let names = rows.next().expect("names");
    let place = |name: &str| names.iter().position(|of| *of == name).expect(name);
    let [surface, x, y, z, status] = ["surface", "x", "y", "z", "status"].map(place);
    let mut counts = [0; 2];
    for row in rows.filter(|row| row[surface].starts_with("pinion")) {
        let [x, y, z] = [x, y, z].map(|at| row[at].parse::<f64>().expect("a number"));
        let is_beyond = x.hypot(y) > 39.1 + 1e-9 || z < -9.5 - 1e-9;
        assert_eq!(row[status], if is_beyond { "trimmed" } else { "solved" }, "{x} {y} {z}");
        counts[usize::from(is_beyond)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
}

/// Spur gears without backlash, 0.1 mm farther apart: both sides by the involutes' closed form.
#[test]
fn backlash_is_that_of_involutes() {
    let out = folder("contact_backlash");
    let spec = ["contact", SPUR_PAIR, "drive_side", "--no-picture", "--out", out.to_str().unwrap()];
    let tight = document(&spec, 0);
    assert!(number(&tight["backlash"], "normal").abs() < 1e-9, "{}", tight["backlash"]);
    let apart = document(&[&spec[..], &["--error", "m.A=0.1mm"]].concat(), 0);
    let (distance, angle) = (91.5, 20f64.to_radians());
    let working = (distance * angle.cos() / (distance + 0.1)).acos();
    let involute = |x: f64| x.tan() - x;
    let normal = 2.0 * distance * angle.cos() * (involute(working) - involute(angle));
    assert!((number(&apart["backlash"], "normal") - normal).abs() < 1e-9, "{} {normal}", apart["backlash"]);
    let turn = (normal / (55.5 * angle.cos())).to_degrees();
    assert!((number(&apart["backlash"], "least") - turn).abs() < 1e-9, "{} {turn}", apart["backlash"]);
}

/// The gear's tip over the pinion's fillet: the tip is a point of an involute, the fillet the curve beside a trochoid, both in closed form.
#[test]
fn the_room_between_a_tip_and_a_fillet_is_that_of_closed_form() {
    let out = folder("contact_room");
    let spec = ["contact", SPUR_PAIR, "drive_side", "--no-picture", "--out", out.to_str().unwrap()];
    let told = document(&spec, 0);
    let rooms = told["clearances"].as_array().expect("clearances");
    let room = rooms.iter().find(|room| room["with"] == "pinion_fillet").expect("the pinion's fillet");
    let [turn, least] = ["turn", "least_mm"].map(|name| number(room, name));
    assert_eq!(room["of"], "gear_flank");
    // what is told is of places of the roll a sixtieth of a pitch apart
    let step = 360.0 / 24.0 / 60.0;
    let at = |k: i32| room_over_fillet(turn + f64::from(k) * step);
    assert!((at(0).expect("the tip is over the fillet") - least).abs() < 1e-9, "{least} {:?}", at(0));
    assert!([-2, -1, 1].iter().all(|k| at(*k).is_none_or(|other| other > least)), "{:?}", [-2, -1, 1].map(at));
}

/// Along the fillet's normal, mm, at a turn of the pinion, deg; `None` where the tip stands over no point of the fillet.
fn room_over_fillet(turn: f64) -> Option<f64> {
    let (module, shift, angle) = (3.0, 0.2, 20f64.to_radians());
    let (teeth, radius, distance, tip) = (37.0, 36.0, 91.5, 55.5 + 0.8 * 3.0);
    let turn = turn.to_radians();
    let involute = |x: f64| x.tan() - x;
    // half the angle of the gear's tooth space at its tip
    let thickness = module * (std::f64::consts::FRAC_PI_2 - 2.0 * shift * angle.tan());
    let at_tip = (55.5 * angle.cos() / tip).acos();
    let space = std::f64::consts::PI / teeth - thickness / 111.0 - involute(angle) + involute(at_tip);
    let gear = std::f64::consts::PI - std::f64::consts::PI / teeth - 24.0 / teeth * turn + space;
    // the centre of the rack's rounding below the pitch line and beside its tooth's middle
    let rounding = 0.38 * module;
    let below = 1.25 * module - rounding - shift * module;
    let beside =
        std::f64::consts::PI * module / 4.0 - (1.25 * module - rounding) * angle.tan() - rounding / angle.cos();
    // the point of the fillet and its normal, out of the pinion, where the rounding's normal goes through the pitch point
    let fillet = |theta: f64| {
        let toward = [theta.sin(), -theta.cos()];
        let roll = (-toward[1] / toward[0] * below - beside) / radius;
        let (sine, cosine) = (turn - roll).sin_cos();
        let [x, y] = [radius - below - rounding * toward[0], beside + radius * roll - rounding * toward[1]];
        let turned = |[x, y]: [f64; 2]| [x * cosine - y * sine, x * sine + y * cosine];
        (turned([x, y]), turned(toward))
    };
    let off = |theta: f64| {
        let [x, y] = fillet(theta).0;
        (x - distance).hypot(y) - tip
    };
    let places = 400;
    let at = |k: usize| angle + (0.4999 * std::f64::consts::PI - angle) * k as f64 / places as f64;
    let crossings = (0..places).filter(|k| off(at(*k)) * off(at(k + 1)) <= 0.0).map(|k| {
        let (mut low, mut high) = (at(k), at(k + 1));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if off(low) * off(middle) <= 0.0 { high = middle } else { low = middle }
        }
        let ([x, y], normal) = fillet(0.5 * (low + high));
        let lag = (y.atan2(x - distance) - gear + 7.0 * std::f64::consts::PI).rem_euclid(2.0 * std::f64::consts::PI)
            - std::f64::consts::PI;
        let opening = normal[0] * -y + normal[1] * (x - distance);
        -lag * opening
    });
    crossings.reduce(f64::min)
}

/// A lantern pinion drives the wheel that its pins make: over the sampled part of the flank the pair turns evenly, and nothing touches before the
/// contact. Beyond its first touch the pin comes to the flank's foot once more, at a position that stands alone.
#[test]
fn a_contact_that_stands_alone_hides_no_other() {
    const SPEC: &str = "machine mesh {
    axis lantern : rotary
    axis wheel : rotary
    frame house
    frame lantern in house = translate_x(156 mm) rotate_z(lantern)
    frame wheel in house = rotate_z(wheel)
}
machine bench {
    frame table
    frame place in table = translate_z(0 mm)
}
tool pin {
    surface round(t: angle in -180 deg .. 180 deg, w: length in -6 mm .. 6 mm) {
        at = [-30 mm + 4.4 mm * cos(t), 4.4 mm * sin(t), w]
        body towards [-cos(t), -sin(t), 0]
    }
}
job pair {
    machine g = mesh
    machine b = bench
    machine m = mesh
    tool p = pin
    tool own = p
    mount p on g.lantern
    mount own on b.place
    motion roll : angle in 0.1 deg .. 75 deg
    drive g.lantern, g.wheel = roll, -roll * 10 / 42
    surface flank in g.wheel = envelope(p.round, over: roll)
    surface pin in b.table = move(own.round)
    sample flank { roll: 9 deg .. 50 deg by 34, z: -5 mm .. 5 mm by 3, keep t: 0 deg .. 180 deg }
    sample pin { t: 0 deg .. 180 deg by 61, z: -5 mm .. 5 mm by 3 }
    mount pin on m.lantern
    mount flank on m.wheel
    motion turn : angle in -10 deg .. 65 deg
    unknown lag : angle in -90 deg / 42 .. 90 deg / 42
    drive m.lantern, m.wheel = turn, -turn * 10 / 42 + lag
    contact driving = pin with flank, over: turn, for: lag, every: 36 deg
}
";
    let out = folder("contact_lantern");
    let spec = written(&out, "pair.chain", SPEC);
    let found = document(&["contact", &spec, "--no-picture", "--out", out.to_str().unwrap()], 0);
    assert_eq!(found["not_done"], serde_json::json!([]));
    let ratio = number(&found, "ratio");
    assert!((ratio - 41.0 / 36.0).abs() < 1e-6, "{ratio}");
    assert!(number(&found["error"], "peak_to_peak") < 1e-6, "{}", found["error"]);
}
