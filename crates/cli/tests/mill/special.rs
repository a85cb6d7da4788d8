//! Leans, surfaces and blocks that are special cases: a ball that touches with its tip, what only rounding misses, what is straight, long blocks.

use super::support::{folder, self_contained, written};
use super::{json, mill};

/// What the jobs need of the library.
const SPUR_GEAR: [&str; 7] = [
    "machines/hobbing_6axis",
    "machines/rack_generating",
    "tools/rack",
    "hobbing/spur_gear",
    "bodies/spur_gear_body",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const WORM: [&str; 10] = [
    "tools/cylinder",
    "machines/crossed_pair",
    "machines/hobbing_6axis",
    "machines/hobbing_geared",
    "machines/hobbing_radial",
    "tools/hob_straight",
    "pairs/worm_and_wheel",
    "bodies/worm_and_wheel_body",
    "machines/five_axis_table_table",
    "tools/end_mills",
];

/// A job that mills a flank of a spur gear, which is convex across the passes and straight along them.
pub(super) fn spur(cutter: &str, milling: &str) -> String {
    let library = self_contained(&SPUR_GEAR);
    format!(
        "{library}\njob milled extends spur_gear_body {{\n machine mill = five_axis_table_table(work_z: 60 mm)\n tool cutter = {cutter}\n \
         mount cutter on mill.cutter\n mill part of flank_plus with cutter.cutting in mill.work {{\n passes rho: 35 mm .. 39 mm by 13\n \
         along z: -10 mm .. 10 mm by 5\n{milling}\n }}\n}}\n"
    )
}

pub(super) const BALL: &str = "ball_mill(radius: 1 mm, reach: 40 mm, holder_radius: 8 mm)";

/// A ball has no bottom: upright on the surface, and while it leans from one side to the other, it touches with its tip.
#[test]
fn a_ball_touches_with_its_tip() {
    let out = folder("mill_upright");
    for lean in ["lead 0 deg\n tilt 0 deg", "lead 2 deg * (z / 10 mm)\n tilt 0 deg"] {
        let spec = written(&out, "milled.chain", &spur(BALL, lean));
        let found = json(&spec, &out, &[]);
        let [least, most] = [0, 1].map(|k| found["effective_radius"][k].as_f64().unwrap());
        assert!((least - 1.0).abs() < 1e-9 && (most - 1.0).abs() < 1e-9, "{lean}: {least} {most}");
        assert!(found["map"]["left"][1]["height_um"].as_f64().unwrap() > -1e-6, "{lean}");
        assert_eq!(found["map"]["untouched"], 0, "{lean}");
    }
}

/// A ball that touches the milled surface stays clear of it by nothing.
#[test]
fn a_cutter_is_clear_of_what_it_touches() {
    let out = folder("mill_own");
    let milling = |by: &str| format!("lead 0 deg\n tilt 75 deg\n clear of flank_plus by {by} with cutter.whole");
    let spec = written(&out, "milled.chain", &spur(BALL, &milling("0 mm")));
    let found = json(&spec, &out, &[]);
    let least = found["clearances"][0]["least"].as_f64().unwrap();
    assert!(least.abs() < 1e-10, "{least}");
    // what is more than rounding is missed as before
    let spec = written(&out, "milled.chain", &spur(BALL, &milling("0.000001 mm")));
    let (code, _, told) = mill(&spec, &out, &[]);
    assert_eq!(code, 3, "{told}");
    assert!(told.contains("0.000001 mm are wanted"), "{told}");
}

/// A flank that is straight along the tooth is nowhere hollow, and a cone's side leaves no ridge across the feed.
#[test]
fn what_is_straight_has_no_radius() {
    let out = folder("mill_straight");
    let spec = written(&out, "milled.chain", &spur(BALL, "lead 5 deg\n tilt 75 deg"));
    let found = json(&spec, &out, &[]);
    assert!(found["largest_ball"].is_null(), "{}", found["largest_ball"]);
    let (_, told, _) = mill(&spec, &out, &[]);
    assert!(told.contains("largest ball any by the curvature"), "{told}");
    let cone =
        "conical_mill(tip_radius: 0.5 mm, half_angle: 3 deg, cutting_length: 15 mm, reach: 40 mm, holder_radius: 8 mm)";
    let spec = written(&out, "milled.chain", &spur(cone, "lead 0 deg\n tilt 87 deg"));
    let (_, told, errors) = mill(&spec, &out, &[]);
    assert!(told.contains("radius       straight across the feed"), "{told}{errors}");
}

/// Round a worm the rotary table turns far in a block, and the cutter's axis stays 80 degrees away from the pole.
#[test]
fn long_blocks_round_a_thread_pass_no_pole() {
    let out = folder("mill_thread");
    let milling = "job milled extends worm_and_wheel_body {\n machine mill = five_axis_table_table(work_z: 60 mm)\n \
        tool ball = ball_mill(radius: 1 mm, reach: 40 mm, holder_radius: 8 mm)\n mount ball on mill.cutter\n \
        mill a of worm_flank with ball.cutting in mill.work {\n passes rho: 24 mm .. 24.5 mm by 3\n \
        along z: -20 mm .. 20 mm, chord 0.5 um\n lead 5 deg\n tilt -60 deg\n }\n}\n";
    let spec = written(&out, "milled.chain", &format!("{}\n{milling}", self_contained(&WORM)));
    for words in [&[][..], &["--tcp"]] {
        let found = json(&spec, &out, &[&["--nc", "siemens"], words].concat());
        assert!(found["least_from_pole"].as_f64().unwrap() > 60.0, "{found}");
        let [most, least] = [0, 1].map(|k| found["blocks"][k]["height_um"].as_f64().unwrap());
        assert!(most <= 0.5 && least >= -0.5, "{words:?}: {most} {least}");
        assert!(out.join("milled.a.mpf").exists(), "{words:?}");
    }
}

/// A flank with a tip relief bends at once where that begins: it is milled, and the heights of the map are those of the ridges of the involute below.
#[test]
fn a_flank_with_a_tip_relief_is_milled() {
    let out = folder("mill_relief");
    let straight = "side * (pi * module / 4 - u * sin(pressure_angle)), z]";
    let relieved = "side * (pi * module / 4 - u * sin(pressure_angle) + 0.01 / 1 mm * ((-u - 1.7 mm + sqrt((u + 1.7 mm)^2)) / 2)^2), z]";
    let milling = |words: &str| spur(BALL, &format!("lead 0 deg\n tilt 75 deg\n{words}"));
    let plain = milling("").replace("rho: 35 mm .. 39 mm by 13", "rho: 35 mm .. 39 mm, scallop 2 um");
    assert!(plain.contains(straight) && plain.contains("scallop"), "{plain}");
    let spec = written(&out, "plain.chain", &plain);
    let without = json(&spec, &out, &[]);
    let spec = written(&out, "relieved.chain", &plain.replacen(straight, relieved, 1));
    let with = json(&spec, &out, &[]);
    // a hundredth of the scallop
    let off = with["polynomials_off"].as_f64().expect("a number");
    assert!((1e-8..2e-5).contains(&off), "{off}");
    assert!(with["cusp"]["height_um"].as_f64().expect("a height") <= 2.0 + 0.02, "{}", with["cusp"]);
    let heights = |of: &serde_json::Value| -> Vec<f64> {
        let heights = of["map"]["heights_um"].as_array().expect("heights").iter();
        heights.map(|height| height.as_f64().expect("a number")).collect()
    };
    assert_eq!([&with["passes"], &with["map"]["untouched"]], [&without["passes"], &0.into()]);
    let (with, without) = (heights(&with), heights(&without));
    // the lower rows are the same involute
    for k in 0..5 * 31 {
        assert!((with[k] - without[k]).abs() < 1e3 * off, "{k}: {} {}", with[k], without[k]);
    }
}

/// Where the contact lies at the end of the ball's arc, no ridge is as low as asked for, or passes do not meet: that is told with its place.
#[test]
fn scallops_out_of_reach_are_told() {
    let out = folder("mill_scallop");
    for (tilt, part) in
        [("-88", "um are asked for"), ("-89", "um are asked for"), ("-89.9", "do not meet"), ("88", "do not meet")]
    {
        let milling = super::AREA
            .replace("0.45 .. 0.55 by 9", "0.2 .. 0.97, scallop 2 um")
            .replace("0.2 .. 0.8 by 9", "0 .. 1 by 9");
        let spec = super::job("work_z: 60 mm", super::BALL, &format!("{milling} lead 5 deg\n tilt {tilt} deg\n"));
        let spec = written(&out, "milled.chain", &spec);
        let (code, _, told) = mill(&spec, &out, &[]);
        assert!(
            code == 3 && told.contains(part) && told.contains("at profilewise") | told.contains("beside profilewise"),
            "{tilt}: {told}"
        );
    }
}

/// `--feed` is that of the contact: the tip goes as much faster or slower as its way is longer or shorter.
#[test]
fn the_feed_is_that_of_the_contact() {
    let out = folder("mill_feed");
    let spec = written(&out, "milled.chain", &super::sound());
    json(&spec, &out, &["--nc", "linuxcnc", "--feed", "500"]);
    json(&spec, &out, &["--nc", "siemens", "--tcp", "--feed", "500"]);
    let table = super::text_of(&out.join("milled.part.csv"));
    let mut rows = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let titles = rows.next().expect("a header");
    let at = |row: &[&str], names: [&str; 3]| {
        names.map(|name| {
            row[titles.iter().position(|title| *title == name).expect("a column")].parse::<f64>().expect("a number")
        })
    };
    let places: Vec<[[f64; 3]; 2]> =
        rows.take(9).map(|row| [at(&row, ["x", "y", "z"]), at(&row, ["tip_x", "tip_y", "tip_z"])]).collect();
    let ways = |k: usize| {
        places.windows(2).map(move |pair| (0..3).map(|i| (pair[1][k][i] - pair[0][k][i]).powi(2)).sum::<f64>().sqrt())
    };
    let feeds = |extension: &str| -> Vec<f64> {
        let text = super::text_of(&out.join(format!("milled.part.{extension}")));
        let cuts = text.lines().filter(|line| line.contains("G01 X")).map(str::to_string).collect::<Vec<_>>();
        // down first, then along the pass
        cuts[1..9].iter().map(|line| line.rsplit_once('F').expect("a feed").1.parse().expect("a number")).collect()
    };
    for ((contact, tip), (inverse, feed)) in ways(0).zip(ways(1)).zip(feeds("ngc").into_iter().zip(feeds("mpf"))) {
        assert!((inverse * contact / 500.0 - 1.0).abs() < 1e-5, "{inverse} {contact}");
        // one decimal is written
        assert!(
            (feed - 500.0 * tip / contact).abs() < 0.051 && (tip / contact - 1.0).abs() > 1e-3,
            "{feed} {tip} {contact}"
        );
    }
}

/// A clearance below zero would let the cutter cut in.
#[test]
fn a_clearance_is_not_below_zero() {
    let out = folder("mill_below_zero");
    let milling = "lead 0 deg\n tilt 75 deg\n clear of flank_plus by -0.1 mm with cutter.whole";
    let (code, _, told) = mill(&written(&out, "milled.chain", &spur(BALL, milling)), &out, &[]);
    assert!(code == 1 && told.contains("the clearance is below zero"), "{code} {told}");
}
