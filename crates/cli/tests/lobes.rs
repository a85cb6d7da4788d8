//! Discs of cycloidal drives as bodies, whose lobes no unknown of the pin tells apart: on its way from the ground to the top the place at which the pin
//! touches goes forth and back.

mod support;

use serde_json::Value;
use support::{flank, folder, self_contained, text, written};

/// The volume of a disc by the published closed form of its outline, cut off at a radius, with a bore of half of that; mm.
fn volume([pins, eccentricity, ring, pin]: [f64; 4], tip: f64, width: f64) -> f64 {
    const STEPS: u32 = 1_000_000;
    let place = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(STEPS);
        let turned = (1.0 - pins) * angle;
        let lean = turned.sin().atan2(ring / (eccentricity * pins) - turned.cos());
        let x = ring * angle.cos() - pin * (angle + lean).cos() - eccentricity * (pins * angle).cos();
        let y = ring * angle.sin() - pin * (angle + lean).sin() - eccentricity * (pins * angle).sin();
        [x, y]
    };
    let sector = |k: u32| {
        let ([x0, y0], [x1, y1]) = (place(k), place(k + 1));
        let square = |x: f64, y: f64| (x * x + y * y).min(tip * tip);
        0.25 * (square(x0, y0) + square(x1, y1)) * (x0 * y1 - y0 * x1).atan2(x0 * x1 + y0 * y1)
    };
    let area: f64 = (0..STEPS).map(sector).sum();
    width * (area.abs() - std::f64::consts::PI * (0.5 * tip).powi(2))
}

/// The disc whose halves are made by the halves of the pin, which end in the ground by the pin's angle; in its blank teeth are as much lower than the
/// lobes as `cut` says.
fn disc(cut: &str) -> Value {
    let at = folder("lobes");
    let halves = self_contained(&["machines/eccentric_pair", "tools/pin", "cycloidal/cycloidal_disc"])
        .replace("envelope(q.side, over: forward)", "envelope(q.side_plus, over: forward)")
        .replace("envelope(r.side, over: back)", "envelope(r.side_minus, over: back)")
        .replace("let tip_radius = ", "param tip_cut : length in 0 mm .. 10 mm\n    let tip_radius = -tip_cut + ");
    let spec = written(&at, "halves.chain", &halves);
    let set = format!("tip_cut={cut}mm");
    let run = flank(&[
        "solve",
        &spec,
        "--job",
        "cycloidal_disc",
        "--solid",
        "gear",
        "--json",
        "--set",
        &set,
        "--out",
        at.to_str().expect("a plain path"),
    ]);
    assert_eq!(run.status.code(), Some(0), "{cut}: {}{}", text(&run.stderr), text(&run.stdout));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

#[test]
fn lobes_have_the_volume_of_their_closed_form_however_they_are_cut_off() {
    for cut in ["0", "0.1", "1", "3"] {
        let told = disc(cut);
        let found = told["solids"][0]["volume_mm3"].as_f64().unwrap_or_else(|| panic!("{told}"));
        let tip = 60.0 + 2.5 - 6.0 - cut.parse::<f64>().expect("a number");
        let exact = volume([12.0, 2.5, 60.0, 6.0], tip, 12.0);
        assert!((found / exact - 1.0).abs() < 1e-9, "{cut}: {found} {exact}");
        assert_eq!(told["solids"][0]["gauges"]["edge_below_tip_mm"].is_null(), cut != "0", "{told}");
    }
}
