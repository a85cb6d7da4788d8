//! Pairs with a milled flank beside the generated one.

use std::f64::consts::PI;
use std::path::Path;

use serde_json::Value;

use crate::support::{flank, folder, self_contained, text, written};
use crate::text_of;

fn contact(spec: &str, out: &Path, arguments: &[&str]) -> Value {
    let out = out.to_str().expect("a plain path");
    let run = flank(&[&["contact", spec, "--out", out, "--no-picture", "--json"][..], arguments].concat());
    let errors = text(&run.stderr);
    // ridges use up what a pair without backlash has not, and that is told
    let is_tight =
        run.status.code() == Some(3) && errors.matches("  ").count() == errors.matches("  make teeth thinner").count();
    assert!(run.status.success() || is_tight && errors.contains("as finish mills it: the backlash to"), "{errors}");
    // one document for each contact
    let told = text(&run.stdout);
    let mut documents = serde_json::Deserializer::from_str(&told).into_iter::<Value>();
    documents.next().expect("a contact").expect("JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("numbers").iter().map(|x| x.as_f64().expect("a number")).collect()
}

const SPUR: [&str; 8] = [
    "functions/hobbing",
    "machines/parallel_pair",
    "machines/hobbing_6axis",
    "machines/rack_generating",
    "tools/rack",
    "pairs/spur_pair",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const MODULE: f64 = 3.0;
const TEETH: [f64; 2] = [24.0, 37.0];
const SHIFT: [f64; 2] = [0.2, -0.2];
const ALPHA: f64 = PI / 9.0;

fn radius(of: usize) -> f64 {
    0.5 * MODULE * TEETH[of]
}

/// The polar angle of a flank at a radius.
fn flank_angle(of: usize, at: f64) -> f64 {
    let involute = |angle: f64| angle.tan() - angle;
    let half_tooth = (0.5 * PI + 2.0 * SHIFT[of] * ALPHA.tan()) / TEETH[of] + involute(ALPHA);
    PI / TEETH[of] - half_tooth + involute((radius(of) * ALPHA.cos() / at).acos())
}

/// The lag at which the gear's involute goes through a place of the pinion; `None` beyond its teeth.
fn lag([x, y]: [f64; 2], turn: f64) -> Option<f64> {
    let gear_tip = radius(1) + (1.0 + SHIFT[1]) * MODULE;
    let (s, c) = turn.sin_cos();
    let seen = [c * x - s * y - radius(0) - radius(1), s * x + c * y];
    let far = seen[0].hypot(seen[1]);
    let is_on_tooth = far <= gear_tip && far >= radius(1) * ALPHA.cos() * 1.001;
    let turned = seen[1].atan2(seen[0]) - flank_angle(1, far) - (PI - PI / TEETH[1] - TEETH[0] / TEETH[1] * turn);
    is_on_tooth.then(|| (turned + PI).rem_euclid(2.0 * PI) - PI)
}

/// Whether more of the pinion lets the gear lag, at a place with a normal.
fn sign_at(([x, y, _], [nx, ny, _], _): &Place, turn: f64) -> f64 {
    let [on, over] = [0.0, 1e-3].map(|h| lag([x + h * nx, y + h * ny], turn).expect("within reach"));
    (over - on).signum()
}

/// The largest lag of places of the pinion on any of its teeth, less their own `sign`; what is left stands on the places.
fn largest_lag<'p>(places: impl Iterator<Item = &'p Place> + Clone, turn: f64, sign: f64) -> f64 {
    let all = [-2.0, -1.0, 0.0, 1.0, 2.0].into_iter().flat_map(|pair| {
        let turn = turn + pair * 2.0 * PI / TEETH[0];
        places
            .clone()
            .filter_map(move |([x, y, _], [nx, ny, _], left)| Some(sign * lag([x + left * nx, y + left * ny], turn)?))
    });
    // teeth of other pitches are no mates
    all.filter(|lag| lag.abs() < 1e-3).fold(f64::NEG_INFINITY, f64::max)
}

/// Position, normal, and what is left, mm.
type Place = ([f64; 3], [f64; 3], f64);

/// The rows of a table of points that `keep` keeps, by their surface and column.
fn places(file: &Path, keep: impl Fn(&str, &str) -> bool) -> Vec<Place> {
    let told = text_of(file);
    let mut rows = told.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    let at = ["j", "x", "y", "z", "nx", "ny", "nz", "left"]
        .map(|name| header.iter().position(|title| *title == name).expect("a column"));
    rows.filter(|row| keep(row[0], row[at[0]]))
        .map(|row| {
            let [_, x, y, z, nx, ny, nz, left] = at.map(|k| row[k].parse::<f64>().expect("a number"));
            ([x, y, z], [nx, ny, nz], 1e-3 * left)
        })
        .collect()
}

/// A pair without backlash, and stock on one of its flanks: the teeth jam by the stock along the normal, which involutes keep all over the mesh.
#[test]
fn stock_that_uses_up_the_backlash_is_told() {
    let out = folder("milled_stock");
    let library = self_contained(&SPUR);
    let job = "job milled extends spur_pair {\n machine mill = five_axis_table_table(work_z: 60 mm)\n \
               tool ball = ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)\n mount ball on mill.cutter\n \
               mill finish of pinion_flank with ball.cutting in mill.work {\n passes rho: 35 mm .. 39 mm by 40\n \
               along z: -9 mm .. 9 mm by 3\n lead 5 deg\n tilt 70 deg\n stock 0.05 mm\n }\n}\n";
    let spec = written(&out, "milled.chain", &format!("{library}\n{job}"));
    let place = out.to_str().expect("a plain path");
    let words = ["drive_side", "--job", "milled", "--milled", "finish", "--no-picture", "--out", place];
    let run = flank(&[&["contact", &spec][..], &words].concat());
    let errors = text(&run.stderr);
    assert_eq!(run.status.code(), Some(3), "{errors}");
    let (_, told) =
        errors.split_once("the backlash to coast_side is negative, -").unwrap_or_else(|| panic!("{errors}"));
    let amount: f64 = told.split(' ').next().and_then(|word| word.parse().ok()).expect("a number");
    // and by a ridge of 2 um at the most
    assert!((0.0499..0.0525).contains(&amount), "{amount} mm");
}

/// A spur pinion with ridges along its teeth: each ridge is a line beside the involute, and where the mate's involute meets that, its polar
/// angle says in closed form how far the gear is turned.
#[test]
fn ridges_along_a_spur_tooth_turn_the_gear_as_involutes_say() {
    let out = folder("milled_spur");
    let library = self_contained(&SPUR);
    let job = "job milled extends spur_pair {\n machine mill = five_axis_table_table(work_z: 60 mm)\n \
               tool ball = ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)\n mount ball on mill.cutter\n \
               mill finish of pinion_flank with ball.cutting in mill.work {\n passes rho: 35 mm .. 39 mm by 40\n \
               along z: -9 mm .. 9 mm by 3\n lead 5 deg\n tilt 70 deg\n }\n}\n";
    let spec = written(&out, "milled.chain", &format!("{library}\n{job}"));
    let found = contact(&spec, &out, &["drive_side", "--job", "milled", "--milled", "finish"]);
    let milled = &found["milled"];
    let table = out.join("milled.drive_side.finish.csv");
    let ridges = places(&table, |surface, column| surface == "pinion_flank as it is milled" && column == "20");
    assert_eq!(ridges.len(), 79, "passes and the ridges between them");
    for ([x, y, _], _, left) in &ridges {
        let rho = x.hypot(*y);
        assert!((y.atan2(*x) - flank_angle(0, rho)).abs() < 1e-9, "the places lie on the involute");
        assert!(*left > -1e-9, "{left}");
    }
    let (rolls, errors) = (numbers(&milled["rolls"]), numbers(&milled["milled"]));
    assert!(rolls.len() > 60 && rolls.len() == errors.len());
    // how the mate is turned by the highest of all places: ridges hold it back or push it on, which the steel says
    let sign = sign_at(&ridges[40], rolls[0].to_radians());
    let mut most = f64::NEG_INFINITY;
    for (turn, error) in rolls.iter().zip(&errors) {
        let expected = 1e6 * sign * largest_lag(ridges.iter().skip(1).step_by(2), turn.to_radians(), sign);
        // the lag is followed to first order: 0.06 mrad squared on a radius of 50 mm are 0.2 nm, over the lever 5 nrad
        assert!((error - expected).abs() < 0.02, "{turn} deg: {error} urad, expected {expected}");
        most = most.max(sign * error);
    }
    // and it is not nothing: the ridges in microns over the lever of the base circle
    let bound = milled["at_most"].as_f64().unwrap();
    assert!(most > 0.5 * bound && most < bound * (1.0 + 1e-6), "{most} {bound}");
}

/// A pinion that is crowned, more towards its root, and side-milled in one pass, which cannot follow that. What it leaves is in the map of the
/// milling, and the mate's involute over each point of that says in closed form how far the gear is turned.
#[test]
fn a_side_milled_spur_tooth_turns_the_gear_as_its_map_says() {
    let out = folder("side_milled_spur");
    let plain = "at = rack_flank_point(side, u, v, module, pressure_angle)";
    let crowned = format!("{plain} + [0 mm, side * crown * v^2 * (1 + 0.2 * u / module), 0 mm]");
    let first = "param module : length in 0.001 mm .. 1000 mm\n";
    let rack = "tool    r = rack(module: module, half_width: face_width)";
    let both = format!(
        "{}\n tool whole = rack(module: module, half_width: face_width)",
        rack.replace(')', ", crown: 0.0001 / 1 mm)")
    );
    let library = self_contained(&SPUR)
        .replace(plain, &crowned)
        .replace(first, &format!("{first} param crown : 1 / length = 0 / 1 mm\n"))
        .replace(rack, &both)
        .replace("tool    s = r\n", "tool    s = whole\n");
    let cylinder = "conical_mill(half_angle: 0 deg, tip_radius: 1 mm, cutting_length: 40 mm, reach: 50 mm)";
    let job = format!(
        "job milled extends spur_pair {{\n machine mill = five_axis_table_table(work_z: 60 mm)\n \
         tool cylinder = {cylinder}\n mount cylinder on mill.cutter\n \
         mill finish of pinion_flank with cylinder.cutting in mill.work {{\n side z: -9 mm .. 9 mm by 1\n \
         along rho: 34.5 mm .. 39 mm by 9\n }}\n}}\n"
    );
    let spec = written(&out, "milled.chain", &format!("{library}\n{job}"));
    let found = contact(&spec, &out, &["drive_side", "--job", "milled", "--milled", "finish"]);
    let milled = &found["milled"];
    assert!(milled["least_um"].as_f64().unwrap() < -1.0 && milled["ridge_um"].as_f64().unwrap() > 1.0, "{milled}");
    let fine = ["--job", "milled", "--rows", "25", "--columns", "400"];
    let run = flank(&[&["mill", &spec, "finish", "--out", out.to_str().expect("a plain path")][..], &fine].concat());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let mut map = places(&out.join("milled.finish.left.csv"), |_, _| true);
    assert_eq!(map.len(), 25 * 400);
    let (rolls, errors) = (numbers(&milled["rolls"]), numbers(&milled["milled"]));
    let sign = sign_at(&map[map.len() / 2], rolls[0].to_radians());
    // beside the milled part the flank is as generated; in its middle, where it is not crowned, an involute
    let beside =
        (0..=5000).map(|k| 34.5 - 0.0002 * f64::from(k)).chain((0..=3000).map(|k| 39.0 + 0.0002 * f64::from(k)));
    map.extend(beside.map(|rho| {
        let (s, c) = flank_angle(0, rho).sin_cos();
        ([rho * c, rho * s, 0.0], [0.0; 3], 0.0)
    }));
    let mut held = [false; 2];
    for (turn, error) in rolls.iter().zip(&errors) {
        let expected = 1e6 * sign * largest_lag(map.iter(), turn.to_radians(), sign);
        // points of the map are 11 um apart: beside the highest one 6 um, where the gap of curvature 0.13 1/mm is 2 nm, over 34 mm 0.07 urad; an
        // edge of the gear meets points 0.2 um apart on a slope of 2 %, 0.1 urad
        assert!((error - expected).abs() < 0.15, "{turn} deg: {error} urad, expected {expected}");
        held = [held[0] | (expected.abs() < 0.1), held[1] | (expected.abs() > 50.0)];
    }
    assert_eq!(held, [true; 2], "the milled part and what is beside it both carry");
}

/// Passes twice as near leave a quarter of the error, and none leaves more than its ridge over the lever.
#[test]
fn the_milled_pair_tends_to_the_generated_one_with_the_square_of_the_step() {
    const SPECS: [&str; 8] = [
        "functions/bevel",
        "functions/blanks_19x62",
        "machines/bevel_pair",
        "machines/cradle",
        "tools/face_mill",
        "pairs/bevel_19x62",
        "machines/five_axis_table_table",
        "tools/end_mills",
    ];
    let out = folder("milled_bevel");
    let library = self_contained(&SPECS);
    let means = [40, 79, 157].map(|passes| {
        let job = format!(
            "job milled extends bevel_19x62 {{\n machine mill = five_axis_table_table(work_z: 60 mm)\n \
             tool ball = ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)\n mount ball on mill.cutter\n \
             mill finish of pinion_concave with ball.cutting in mill.work {{\n passes profilewise: 0.28 .. 0.98 by {passes}\n \
             along lengthwise: 0.02 .. 0.98 by 3\n lead 5 deg\n tilt 70 deg\n }}\n}}\n"
        );
        let spec = written(&out, "milled.chain", &format!("{library}\n{job}"));
        let found = contact(&spec, &out, &["--job", "milled", "--positions", "24", "--milled", "finish", "--format", "csv"]);
        let milled = &found["milled"];
        let [generated, errors] = ["generated", "milled"].map(|name| numbers(&milled[name]));
        let away: Vec<f64> = generated.iter().zip(&errors).map(|(a, b)| (b - a).abs()).collect();
        let most = away.iter().copied().fold(0.0, f64::max);
        assert!(most <= milled["at_most"].as_f64().unwrap() * (1.0 + 1e-6), "{most} {milled}");
        // on each flank the film of the compound is met at fewer places than before
        let within = [0, 1].map(|k| milled["patterns"][k]["within"].as_u64().unwrap());
        assert!(within[1] > 0 && within[1] <= within[0], "{within:?}");
        away.iter().sum::<f64>() / away.len() as f64
    });
    for pair in means.windows(2) {
        // positions meet the ridges at other phases: some percent of the mean
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.1, "{means:?}");
    }
    let refused = flank(&["contact", "specs/pairs/bevel_19x62.chain", "--milled", "finish"]);
    assert!(
        text(&refused.stderr).contains("job bevel_19x62 mills nothing: add `mill finish of"),
        "{}",
        text(&refused.stderr)
    );
}
