//! Where frames of machines are expected: how far their origins are off, and by which angle they are turned.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_chain_dsl::{Expected, PoseDifference, PoseTolerance};
use flank_expr::Graph;

use crate::models::compiled;

/// The pose that a machine of three axes is expected in; it stands at 3 mm, 4 mm, turned by an angle about a skew axis.
fn expected(turn: &str, near: &str, within: &str) -> (PoseDifference, PoseTolerance) {
    let text = format!(
        "machine skew {{
            axis X : linear
            axis Y : linear
            axis C : rotary
            frame bed
            frame table in bed = translate(X, Y, 0 mm) rotate([1, 2, 2], C)
            expect table in bed near {near} at (X: 3 mm, Y: 4 mm, C: {turn}) within {within}
        }}"
    );
    let graph = Graph::new();
    let compilation = compiled(&graph, &text);
    let machine = compilation.machines.iter().find(|machine| machine.name == "skew").expect("it is compiled");
    let [expectation] = &machine.expectations[..] else { panic!("one expectation") };
    let Expected::Pose { off, within } = expectation.what else { panic!("a pose") };
    (off, within)
}

/// The angle of one rotation by itself, from a hundredth of what rounding may turn to half a turn and beyond it.
#[test]
fn the_angle_is_that_of_the_rotation_however_small() {
    let arcsec = PI / 648e3;
    for (turn, angle) in [
        ("1e-5 arcsec", 1e-5 * arcsec),
        ("0.2 arcsec", 0.2 * arcsec),
        ("3 arcmin", 180.0 * arcsec),
        ("-90 deg", FRAC_PI_2),
        ("648000 arcsec", PI),
        ("179.9999 deg", 179.9999_f64.to_radians()),
        ("270 deg", FRAC_PI_2),
    ] {
        let (off, _) = expected(turn, "translate(3 mm, 4 mm, 0 mm)", "1 um, 1 arcsec");
        // entries of a rotation are rounded by about 1e-16 each
        let found = off.angle.expect("of one hand");
        assert!((found - angle).abs() < 1e-15, "{turn}: {found} is not {angle}");
        assert_eq!(off.distance, 0.0, "{turn}");
    }
}

#[test]
fn the_distance_is_that_of_the_origins() {
    let (off, _) = expected("0 deg", "translate(0 mm, 0 mm, 0 mm)", "1 um, 1 arcsec");
    assert_eq!((off.distance, off.angle), (5.0, Some(0.0)));
    // turned as the table is, and moved along its own axis [1, 2, 2] / 3 by 3 um
    let near = "translate(3 mm, 4 mm, 0 mm) rotate([1, 2, 2], 30 deg) translate(1 um, 2 um, 2 um)";
    let (off, _) = expected("30 deg", near, "1 um, 1 arcsec");
    assert!((off.distance - 3e-3).abs() < 1e-15 && off.angle.is_some_and(|angle| angle < 1e-15), "{off:?}");
}

/// Turns of 60 deg about two axes at right angles lie the angle apart whose cosine is 1/8: the trace of the rotation between them is 5/4.
#[test]
fn turns_about_other_axes_are_one_rotation() {
    let (off, _) =
        expected("0 deg", "translate(3 mm, 4 mm, 0 mm) rotate_x(60 deg) rotate_y(-60 deg)", "1 um, 1 arcsec");
    assert!((off.angle.expect("of one hand") - 0.125_f64.acos()).abs() < 1e-15, "{off:?}");
    let (off, _) = expected("0 deg", "translate(3 mm, 4 mm, 0 mm) mirror_x()", "1 um, 180 deg");
    assert_eq!(off.angle, None);
}

/// A length alone lets nothing be turned, an angle alone nothing be moved, in whatever order they are written.
#[test]
fn a_tolerance_that_is_not_written_is_that_of_rounding() {
    let exact = "translate(3 mm, 4 mm, 0 mm)";
    let allows = |turn: &str, near: &str, within: &str| {
        let (off, within) = expected(turn, near, within);
        within.allows(off)
    };
    assert!(allows("0 deg", exact, "1 um"));
    assert!(allows("1e-4 arcsec", exact, "1 um"));
    assert!(!allows("1 arcsec", exact, "1 um"));
    assert!(!allows("3 arcmin", exact, "1 mm"));
    assert!(allows("1 arcsec", exact, "2 arcsec"));
    assert!(!allows("1 arcsec", "translate(3.0005 mm, 4 mm, 0 mm)", "2 arcsec"));
    assert!(allows("1 arcsec", "translate(3.0005 mm, 4 mm, 0 mm)", "1 um, 2 arcsec"));
    assert!(allows("1 arcsec", "translate(3.0005 mm, 4 mm, 0 mm)", "2 arcsec, 1 um"));
    assert!(!allows("3 arcsec", "translate(3.0005 mm, 4 mm, 0 mm)", "2 arcsec, 1 um"));
    assert!(!allows("1 arcsec", "translate(3.002 mm, 4 mm, 0 mm)", "2 arcsec, 1 um"));
    assert!(allows("170 deg", exact, "1 um, 180 deg"));
    assert!(!allows("0 deg", "translate(3 mm, 4 mm, 0 mm) mirror_z()", "1 um, 180 deg"));
}
