//! Spaces of two surfaces that end in one line at their bottom, also a single one of them, whose neighbour is itself.

use std::f64::consts::PI;

use flank::SolidNumbers;
use flank_tests::bodies::euler_characteristic;

use crate::asked::Asked;

/// What a text says that lies beside the specs of these tests.
const BESIDE: &str = "tests/surfaces/specs/groove.chain";

fn built(text: &str, job: &str, set: &[(&str, &str)]) -> SolidNumbers {
    let (body, mesh) = Asked { text: Some(text), ..Asked::new(BESIDE, job, set) }.only();
    assert_eq!(euler_characteristic(&mesh), 0, "{body}");
    body
}

/// Good to the charts' 1e-8 mm, as a share of these sizes.
fn assert_volume(body: &SolidNumbers, exact: f64) {
    assert!((body.volume_mm3 / exact - 1.0).abs() < 2e-8, "{exact} mm³ by the closed form: {body}");
}

const SERRATION: &str = "machine mill {
    axis Z : linear
    frame work
    frame cutter in work = translate_z(Z)
}
tool v_cutter {
    param radius : length = 20 mm
    param half : angle = 30 deg
    surface plus, minus(u: length in 0 mm .. 4 mm, v: length in -20 mm .. 20 mm) for side in [1, -1] {
        at = [radius + u * cos(half), side * u * sin(half), v]
        body towards [0, -side, 0]
    }
}
job serration {
    param teeth : count = 36
    machine m = mill
    tool t = v_cutter
    mount t on m.cutter
    drive m.Z = 0 mm
    surface plus, minus in m.work = envelope(t.plus, t.minus)
    sample plus, minus { u: 0.1 mm .. 1.5 mm by 4, v: -5 mm .. 5 mm by 3 }
    let tip = t.radius + 1.5 mm
    profile blank {
        tip   = line(from: [5 mm, tip], to: [-5 mm, tip])
        front = line(from: [-5 mm, tip], to: [-5 mm, 10 mm])
        bore  = line(from: [-5 mm, 10 mm], to: [5 mm, 10 mm])
        back  = line(from: [5 mm, 10 mm], to: [5 mm, tip])
    }
    solid part in m.work = turned(blank, spaces: teeth, of: [minus, plus])
}
";

/// A groove between two planes is two sectors of the tip circle less the triangles below it.
#[test]
fn grooves_along_the_axis_take_away_their_section() {
    let (bottom, tip): (f64, f64) = (20.0, 21.5);
    let half = f64::to_radians(30.0);
    let angle = half - (bottom * half.sin() / tip).asin();
    let groove = tip * tip * angle - bottom * tip * angle.sin();
    for teeth in ["1", "2", "12"] {
        let body = built(SERRATION, "serration", &[("teeth", teeth)]);
        let count: f64 = teeth.parse().expect("a number");
        assert_volume(&body, 10.0 * (PI * (tip * tip - 100.0) - count * groove));
        assert_eq!(body.gauges.edge_below_tip_mm, None, "{teeth} teeth with lands");
    }
}

const THREAD: &str = "machine lathe {
    axis Z : linear
    frame work
    frame cutter in work = translate_z(Z)
}
tool thread {
    param lead : length
    surface plus, minus(u: length in 0 mm .. 6 mm, t: angle in -3600 deg .. 3600 deg) for side in [1, -1] {
        at = [(20 mm + u) * cos(t), (20 mm + u) * sin(t), side * u * tan(30 deg) + lead * t / 360 deg]
        body towards [0, 0, -side]
    }
}
job sharp {
    param starts : count = 1
    param top : length = 21.5 mm
    machine m = lathe
    tool t = thread(lead: starts * 3 mm)
    mount t on m.cutter
    drive m.Z = 0 mm
    surface plus, minus in m.work = envelope(t.plus, t.minus)
    sample plus, minus { u: 0.1 mm .. 2.5 mm by 4, z: -5 mm .. 5 mm by 9 }
    profile blank {
        tip   = line(from: [5 mm, top], to: [-5 mm, top])
        front = line(from: [-5 mm, top], to: [-5 mm, 10 mm])
        bore  = line(from: [-5 mm, 10 mm], to: [5 mm, 10 mm])
        back  = line(from: [5 mm, 10 mm], to: [5 mm, top])
    }
    solid part in m.work = turned(blank, spaces: starts, of: [minus, plus])
}
";

/// At each radius a thread of this pitch leaves the same share of a circle, whatever its starts are; where its crests are sharp, up to these.
#[test]
fn threads_of_one_start_have_lands_or_sharp_crests() {
    let slope = 2.0 * f64::to_radians(30.0).tan() / 3.0;
    let crest = 20.0 + 1.0 / slope;
    for (starts, top) in [("1", 21.5), ("2", 21.5), ("1", 23.0), ("2", 23.0)] {
        let body = built(THREAD, "sharp", &[("starts", starts), ("top", &format!("{top} mm"))]);
        let outer = crest.min(top);
        let integral = |rho: f64| rho.powi(3) / 3.0 - 10.0 * rho * rho;
        let grooves = 2.0 * PI * slope * (integral(outer) - integral(20.0));
        assert_volume(&body, 10.0 * (PI * (outer * outer - 100.0) - grooves));
        let edge = body.gauges.edge_below_tip_mm;
        assert_eq!(edge.is_some(), top > crest, "{starts} starts up to {top} mm: {edge:?}");
    }
}

const NUT: &str = "machine whirler {
    param lead : length / angle
    param tilt : angle
    axis C : rotary
    frame bed
    frame nut in bed = translate_z(-lead * C) rotate_z(-C)
    frame ring in bed = translate_x(12 mm) rotate_x(tilt)
}
tool gothic {
    param e : length = 0.15 mm
    param r : length = 2.1 mm
    surface upper, lower(s: angle in asin(e / r) .. 80 deg, t: angle in -180 deg .. 180 deg) for side in [1, -1] {
        let q = 8 mm - r * (1 - cos(s))
        at = [q * cos(t), q * sin(t), side * (r * sin(s) - e)]
        body towards [-cos(s) * cos(t), -cos(s) * sin(t), -side * sin(s)]
    }
}
job nut {
    let lead = 5 mm/rev
    machine m = whirler(lead: lead, tilt: atan(lead * 1 rad / 20 mm))
    tool w = gothic
    mount w on m.ring
    motion turn : angle in -1500 deg .. 1500 deg
    drive m.C = turn
    surface plus, minus in m.nut = envelope(w.upper, w.lower, over: turn)
    sample plus, minus {
        rho: 18.5 mm .. 19.8 mm by 9, z: -3 mm .. 3 mm by 5
        keep t: -90 deg .. 90 deg
    }
    profile blank {
        tip   = line(from: [-6 mm, 18.6 mm], to: [6 mm, 18.6 mm])
        back  = line(from: [6 mm, 18.6 mm], to: [6 mm, 28 mm])
        rim   = line(from: [6 mm, 28 mm], to: [-6 mm, 28 mm])
        front = line(from: [-6 mm, 28 mm], to: [-6 mm, 18.6 mm])
    }
    solid part in m.nut = turned(blank, spaces: 1, of: [minus, plus])
}
";

/// A whirled nut, in which both arcs of its groove end in one line: by the axial section of the groove, whose points an equation of meshing of its
/// own has, and a spline through 800 of each side. The order in which the surfaces are named is that of either side.
#[test]
fn a_nut_of_one_start_takes_away_its_groove() {
    let exact = 15_465.523_076_23;
    for of in ["[minus, plus]", "[plus, minus]"] {
        let body = built(&NUT.replace("[minus, plus])", &format!("{of})")), "nut", &[]);
        assert_volume(&body, exact);
    }
}

const BAR: &str = "machine mill {
    axis Z : linear
    frame work
    frame cutter in work = translate_z(Z)
}
tool cutter {
    let lean = 15 deg
    surface plus, minus(u: length in 0 mm .. 6 mm, v: length in -40 mm .. 40 mm) for side in [1, -1] {
        at = [u * cos(30 deg), side * u * sin(30 deg) + v * sin(lean), v * cos(lean)]
        body towards [0, -side, 0]
    }
}
job bar {
    param far : length
    machine m = mill
    tool t = cutter
    mount t on m.cutter
    drive m.Z = 0 mm
    surface plus, minus in m.work = envelope(t.plus, t.minus)
    sample plus, minus { u: 0.1 mm .. 2.5 mm by 4, v: -far .. far by 3 }
    profile section {
        tip   = line(from: [10 mm, 3 mm], to: [-10 mm, 3 mm])
        front = line(from: [-10 mm, 3 mm], to: [-10 mm, -5 mm])
        base  = line(from: [-10 mm, -5 mm], to: [10 mm, -5 mm])
        back  = line(from: [10 mm, -5 mm], to: [10 mm, 3 mm])
    }
    solid part in m.work = extruded(section, spaces: 8, pitch: 6 mm, of: [minus, plus])
}
";

/// The base lies nearer to short samples than the ends of the spaces do.
#[test]
fn how_far_a_groove_is_sampled_does_not_matter() {
    let exact = 8.0 * 20.0 * (6.0 * 8.0 - 9.0 * f64::to_radians(30.0).tan());
    for far in ["0.5 mm", "5 mm", "9.9 mm", "12 mm"] {
        let (body, _) = Asked { text: Some(BAR), ..Asked::new(BESIDE, "bar", &[("far", far)]) }.only();
        assert_volume(&body, exact);
    }
}
