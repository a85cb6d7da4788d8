//! What the marking compound shows: how near the mate comes to the points of a flank, over all of the roll.

mod support;

use serde_json::Value;
use support::{flank, text};

fn document(arguments: &[&str]) -> Value {
    let run = flank(&[&["contact"], arguments, &["--json", "--no-picture"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stderr), text(&run.stdout));
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
    let told = document(&["specs/pairs/cycloidal_drive.chain", "forward"]);
    let disc = &told["pattern"][0];
    assert_eq!((&disc["within"], &disc["points"]), (&Value::from(5 * within), &Value::from(175)), "{disc}");
}
