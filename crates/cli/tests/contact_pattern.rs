//! How near the mate comes to the points of a flank over all of the roll, and what of a contact is told beyond it.

mod support;

use serde_json::Value;
use support::{flank, folder, self_contained, text, written};

fn document(name: &str, arguments: &[&str], code: i32) -> Value {
    let out = folder(&format!("pattern_{name}"));
    let all = [&["contact"], arguments, &["--json", "--no-picture", "--out", out.to_str().expect("a plain path")]];
    let run = flank(&all.concat());
    assert_eq!(run.status.code(), Some(code), "{}{}", text(&run.stderr), text(&run.stdout));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

/// The pin stands, and the disc goes around in it: neither goes on along the normal where they touch. Ground all around by 0.02 mm too much, a lobe
/// lags by that over its lever, and all others stay behind the one that lags least.
#[test]
fn a_disc_shows_what_the_closed_form_of_its_play_has_within_the_film() {
    let (ring, eccentricity, pins, play, film) = (60.0, 2.5, 12.0, 0.02, 6.35e-3);
    let lever = |crank: f64| {
        let pitch = eccentricity * pins;
        let away = (ring * ring + pitch * pitch - 2.0 * ring * pitch * crank.cos()).sqrt();
        eccentricity * (pins - 1.0) * ring * crank.sin() / away
    };
    let lag = |crank: f64| -play / lever(crank);
    let carried = |crank: f64| {
        let others = (-6..=6).map(|k| crank + f64::from(k) * 30f64.to_radians());
        others.filter(|crank| (0.02..3.01).contains(crank)).map(lag).fold(f64::NEG_INFINITY, f64::max)
    };
    let rows = (0..35).map(|k| (5.0 + 5.0 * f64::from(k)).to_radians());
    let within = rows.filter(|crank| (carried(*crank) - lag(*crank)) * lever(*crank) <= film).count();
    let told = document("disc", &["specs/pairs/cycloidal_drive.chain", "forward"], 0);
    let disc = &told["pattern"][0];
    assert_eq!((&disc["within"], &disc["points"]), (&Value::from(5 * within), &Value::from(175)), "{disc}");
}

/// The least gap lies between roll positions; of crowned flanks it is nothing where the path of contact passes a point.
#[test]
fn the_least_gaps_do_not_depend_on_positions() {
    let patterns = |positions: &str| {
        let told = document("gaps", &["specs/pairs/helical_pair.chain", "--positions", positions], 0);
        told["pattern"].as_array().expect("two flanks").clone()
    };
    let [few, many] = ["7", "240"].map(patterns);
    for (few, many) in few.iter().zip(&many) {
        assert_eq!((&few["within"], &few["rows"]), (&many["within"], &many["rows"]), "{few} {many}");
        for of in [few, many] {
            let least = of["least_um"].as_f64().expect("a gap");
            assert!(least.abs() < 1e-3, "{of}");
        }
    }
}

/// With shortened teeth on the ring, by the formula of tip interference of involutes: the tips of 30 teeth in 36 cut in where they cross, 72 degrees of the
/// pinion's turn from the line of centres, and 30 in 38 have room. The range of the roll ends long before.
#[test]
fn tips_of_a_pinion_foul_those_of_a_ring_with_few_teeth_more() {
    let sets =
        |ring: &str| ["pinion_teeth=30".to_string(), format!("ring_teeth={ring}"), "cutter_teeth=18".to_string()];
    let told = |ring: &str, code: i32| {
        let sets = sets(ring);
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        document("ring", &[&["specs/pairs/internal_pair.chain"], &sets[..]].concat(), code)
    };
    // how far the tip of the pinion goes beyond that of the ring's tooth, along the tip circle of the ring
    let overlap = |ring_teeth: f64| {
        let (module, alpha) = (3.0, 20f64.to_radians());
        let [r1, r2] = [30.0, ring_teeth].map(|teeth| 0.5 * module * teeth);
        let (tip1, tip2, apart) = (r1 + module, r2 - 0.75 * module, r2 - r1);
        let inv = |angle: f64| angle.tan() - angle;
        let [at1, at2] = [(r1, tip1), (r2, tip2)].map(|(r, tip)| inv((r * alpha.cos() / tip).acos()));
        let crossed1 = ((tip2 * tip2 - tip1 * tip1 - apart * apart) / (2.0 * apart * tip1)).acos();
        let crossed2 = ((tip2 * tip2 - tip1 * tip1 + apart * apart) / (2.0 * apart * tip2)).acos();
        tip2 * (crossed2 - (crossed1 + at1 - inv(alpha)) * 30.0 / ring_teeth - inv(alpha) + at2)
    };
    for ring in ["34", "36"] {
        let found = told(ring, 3);
        let least = found["clearances"][0]["least_mm"].as_f64().expect("room");
        let along = overlap(ring.parse().expect("a number"));
        // along the normal it is less than along the circle by the slope of the ring's flank at its tip
        assert!((0.96..1.0).contains(&(-least / along)), "{least} {along}");
    }
    assert!(overlap(38.0) < 0.0);
    let free = told("38", 0);
    assert_eq!(free["clearances"].as_array().map(Vec::len), Some(0), "{free}");
}

/// Where the range of the unknown is too narrow for the offsets of a rolling tester, they are told all the same, with what is beyond.
#[test]
fn offsets_of_a_tester_beyond_the_range_are_told_so() {
    let wide = document("tester", &["specs/pairs/bevel_19x62.chain", "--vhj"], 0);
    let shipped = self_contained(&[
        "functions/bevel",
        "functions/blanks_19x62",
        "machines/bevel_pair",
        "machines/cradle",
        "tools/face_mill",
        "pairs/bevel_19x62",
    ]);
    let narrow = shipped.replace("angle in 1.5 deg .. 4.2 deg", "angle in 2.8 deg .. 2.9 deg");
    assert_ne!(shipped, narrow);
    let spec = written(&folder("pattern_narrow"), "narrow.chain", &narrow);
    let narrow = document("tester", &[&spec, "--vhj"], 3);
    for (wide, narrow) in wide["vhj"].as_array().expect("rows").iter().zip(narrow["vhj"].as_array().expect("rows")) {
        let [a, b] = [wide, narrow].map(|row| row["errors"][0].as_f64().expect("an offset"));
        assert!((a - b).abs() < 1e-6, "{wide} {narrow}");
        let moves_error = narrow["axes"].as_array().map(Vec::len) == Some(2);
        assert_eq!(
            narrow["beyond"][0].as_str().is_some_and(|name| name.starts_with("lag at ")),
            moves_error,
            "{narrow}"
        );
    }
    let none = document("tester", &["specs/pairs/helical_pair.chain", "--vhj"], 0);
    let remarks = none["remarks"].as_array().expect("remarks");
    assert!(remarks.iter().any(|of| of["message"].as_str().is_some_and(|told| told.contains("no mounting error `E`"))));
}
