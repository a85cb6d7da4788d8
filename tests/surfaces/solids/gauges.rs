//! Thickness, span and balls of closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use flank::{Answer, NotDoneKind};

use crate::asked::{Asked, BODIES};
use crate::spur::{ALPHA, Spur, arcinv};

/// Thickness, span and dimension over balls of a helical involute gear (ISO 21771), and the circles on which the rack's own corners leave it.
#[test]
fn gauges_find_what_an_involute_has() {
    let inv = |angle: f64| angle.tan() - angle;
    for (teeth, shift, helix) in [(24.0, 0.2, 0.0), (24.0, 0.2, 15.0), (31.0, -0.1, -28.0)] {
        let set =
            [("helix_angle", &*format!("{helix} deg")), ("teeth", &*teeth.to_string()), ("shift", &*shift.to_string())];
        let (body, _) = Asked::new(BODIES, "helical", &set).only();
        let beta = f64::to_radians(helix);
        let (radius, transverse) = (1.5 * teeth / beta.cos(), (ALPHA.tan() / beta.cos()).atan());
        let base = radius * transverse.cos();
        let gauges = &body.gauges;
        let near = |found: f64, exact: f64, what: &str| {
            assert!((found - exact).abs() < 2e-8, "{what} of {teeth} teeth at {helix} degrees: {found}, not {exact}");
        };
        near(gauges.tip_diameter_mm.expect("round"), 2.0 * (radius + (1.0 + shift) * 3.0), "tip");
        near(gauges.root_diameter_mm.expect("round"), 2.0 * (radius - (1.25 - shift) * 3.0), "root");
        // where the rounding of the rack's tip begins
        let depth = 3.0 * (1.25 - 0.38 * (1.0 - ALPHA.sin()) - shift);
        let form = base.hypot(radius * transverse.sin() - depth / transverse.sin());
        gauges.form_diameters_mm.expect("round").iter().for_each(|found| near(*found, 2.0 * form, "form diameter"));
        // half the tooth's angle on the reference circle
        let half = (FRAC_PI_2 + 2.0 * shift * ALPHA.tan()) / teeth;
        assert_eq!(gauges.thickness.len(), 5);
        for found in &gauges.thickness {
            let diameter = found.diameter_mm.expect("round");
            let at = (2.0 * base / diameter).acos();
            let angle = 2.0 * (half + inv(transverse) - inv(at));
            near(found.arc_mm, 0.5 * diameter * angle, "thickness");
            // the shortest way between the two lines in which the flanks meet the cylinder: one is by z the other turned
            let lead = radius / beta.tan();
            let turned = |z: f64| angle - z.abs() / lead.abs();
            let apart = |z: f64| (diameter * (0.5 * turned(z)).sin()).hypot(z);
            let (mut low, mut high) = (0.0, 0.5 * diameter * angle);
            while high - low > 1e-9 {
                let [a, b] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
                if apart(a) < apart(b) { high = b } else { low = a }
            }
            near(found.chord_mm.expect("within the face"), apart(low), "chord");
            let height = 0.5 * (gauges.tip_diameter_mm.expect("round") - diameter * (0.5 * turned(low)).cos());
            near(found.chord_height_mm.expect("within the face"), height, "height");
        }
        assert!(gauges.spans.len() > 1, "{:?}", gauges.spans);
        for span in &gauges.spans {
            let across = (f64::from(span.teeth) - 0.5) * PI + teeth * inv(transverse);
            near(span.width_mm, 3.0 * ALPHA.cos() * across + 6.0 * shift * ALPHA.sin(), "span");
        }
        let balls = gauges.balls.as_ref().expect("one touches");
        let wanted = inv(transverse) + balls.ball_mm / (3.0 * teeth * ALPHA.cos()) + half - PI / teeth;
        let centre = base / arcinv(wanted).cos();
        let across = if teeth % 2.0 == 0.0 { 1.0 } else { (FRAC_PI_2 / teeth).cos() };
        near(balls.over_balls_mm, 2.0 * centre * across + balls.ball_mm, "balls");
    }
}

/// A ball as wide as the space is square to its flanks touches also where these lie aslant; one that does not is told.
#[test]
fn balls_touch_steep_helices_and_those_that_do_not_are_told() {
    let inv = |angle: f64| angle.tan() - angle;
    let set = [("helix_angle", "60 deg"), ("teeth", "11"), ("shift", "0.75 mm")];
    let asked = || Asked::new("specs/bodies/helical_gear_body.chain", "helical_gear_body", &set);
    let (body, _) = asked().only();
    let transverse = (2.0 * ALPHA.tan()).atan();
    let base = 33.0 * transverse.cos();
    let half = (FRAC_PI_2 + 0.5 * ALPHA.tan()) / 11.0;
    let balls = body.gauges.balls.as_ref().expect("one touches");
    let wanted = inv(transverse) + balls.ball_mm / (33.0 * ALPHA.cos()) + half - PI / 11.0;
    let exact = 2.0 * base / arcinv(wanted).cos() * (FRAC_PI_2 / 11.0).cos() + balls.ball_mm;
    assert!((balls.over_balls_mm - exact).abs() < 2e-8, "{balls:?} {exact}");
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { ball: Some(30.0), ..asked() }.built(folder.path());
    assert!(result.solids[0].gauges.balls.is_none());
    let told: Vec<&str> = result.not_done().iter().map(|missing| missing.message.as_str()).collect();
    assert_eq!(told, ["balls of 30 mm do not touch both flanks of a space of `gear` half-way along"]);
}

/// Fillets that are deeper than what they leave of the flanks: form diameter, span and balls are still the flanks'.
#[test]
fn gauges_touch_the_flank_however_deep_the_fillet_is() {
    let inv = |angle: f64| angle.tan() - angle;
    for (teeth, shift) in [(20.0, -0.5), (14.0, -0.4)] {
        let set = [("helix_angle", "0 deg"), ("teeth", &*teeth.to_string()), ("shift", &*shift.to_string())];
        let (body, _) = Asked::new(BODIES, "helical", &[&set[..], &[("bore", "5 mm")]].concat()).only();
        let (spur, gauges) = (Spur { module: 3.0, teeth, shift, rounding: 0.38 }, &body.gauges);
        let (_, form) = spur.undercut();
        let [root, tip] = [spur.radius() - (1.25 - shift) * 3.0, spur.radius() + (1.0 + shift) * 3.0];
        assert!(form - root > tip - form, "the fillet is the deeper one: {root} {form} {tip}");
        let near = |found: f64, exact: f64, what: &str| {
            assert!((found - exact).abs() < 2e-7, "{what} of {teeth} teeth, shift {shift}: {found}, not {exact}");
        };
        gauges.form_diameters_mm.expect("round").iter().for_each(|found| near(*found, 2.0 * form, "form diameter"));
        let base = spur.radius() * ALPHA.cos();
        for span in &gauges.spans {
            let across = (f64::from(span.teeth) - 0.5) * PI + teeth * inv(ALPHA);
            near(span.width_mm, 3.0 * ALPHA.cos() * across + 6.0 * shift * ALPHA.sin(), "span");
            span.diameters_mm.iter().for_each(|at| assert!(0.5 * at > form, "touches the flank: {span:?}"));
        }
        let touching = |count: f64| {
            base.hypot(
                0.5 * (3.0 * ALPHA.cos() * ((count - 0.5) * PI + teeth * inv(ALPHA)) + 6.0 * shift * ALPHA.sin()),
            )
        };
        let wanted = (1..=7).filter(|k| (form..tip).contains(&touching(f64::from(*k)))).count();
        assert_eq!(gauges.spans.len(), wanted, "{:?}", gauges.spans);
        let balls = gauges.balls.as_ref().expect("one touches");
        let half = (FRAC_PI_2 + 2.0 * shift * ALPHA.tan()) / teeth;
        let wanted = inv(ALPHA) + balls.ball_mm / (3.0 * teeth * ALPHA.cos()) + half - PI / teeth;
        near(balls.over_balls_mm, 2.0 * base / arcinv(wanted).cos() + balls.ball_mm, "balls");
    }
}

/// The ball that is taken where none is asked for touches about where the middle of the flanks is, and an anvil reaches it: of a small gear as of a
/// large one, also where flanks lean so much that a ball as wide as the space would lie below the tip.
#[test]
fn balls_touch_about_the_middle_of_the_flanks_and_stand_out() {
    let spur: [&[(&str, &str)]; 5] = [
        &[("teeth", "24")],
        &[("teeth", "120"), ("r.pressure_angle", "25 deg"), ("r.tip_radius", "0.6 mm")],
        &[("teeth", "200"), ("profile_shift", "-1.2")],
        &[("module", "0.05 mm"), ("face_width", "1 mm")],
        &[("teeth", "12"), ("profile_shift", "0.6")],
    ];
    for set in spur {
        let (body, _) = Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", set).only();
        let (gauges, tip) = (&body.gauges, body.gauges.tip_diameter_mm.expect("round"));
        let balls = gauges.balls.as_ref().expect("one fits");
        let form = gauges.form_diameters_mm.expect("round")[0];
        let share = (balls.diameters_mm[0] - form) / (tip - form);
        assert!((share - 0.5).abs() < 0.1 && balls.over_balls_mm > tip, "{set:?}: {share} {balls:?} {tip}");
        // in steps of a quarter of a millimetre, or of a hundredth
        let steps = balls.ball_mm * if balls.ball_mm > 1.0 { 4.0 } else { 100.0 };
        assert!((steps - steps.round()).abs() < 1e-9, "{balls:?}");
    }
    let ring = Asked::new("specs/bodies/internal_pair_body.chain", "internal_pair_body", &[]);
    let folder = tempfile::tempdir().expect("a folder");
    let solids = ring.built(folder.path()).solids;
    let gauges = &solids.iter().find(|of| of.name == "ring").expect("it has one").gauges;
    let balls = gauges.balls.as_ref().expect("one fits");
    assert!(balls.over_balls_mm < gauges.tip_diameter_mm.expect("round"), "between them: {balls:?}");
}

const WAVES: &str = "tests/surfaces/specs/waves.chain";

/// Planes touch waves where these are round, and not where they are hollow: by the distance of the closed section from a plane through the axis, whose
/// maxima along the upper flank of the last tooth are what planes touch, and whose minima lie in the steel.
#[test]
fn planes_touch_no_hollow_flank() {
    for (count, all) in [(20.0_f64, vec![3]), (7.0, vec![])] {
        let (body, _) = Asked::new(WAVES, "waves", &[("n", &*count.to_string())]).only();
        let rho = |t: f64| 20.0 - 3.0 * (count * t).cos();
        let slope =
            |t: f64, turned: f64| 3.0 * count * (count * t).sin() * (t + turned).sin() + rho(t) * (t + turned).cos();
        let tip = -f64::acos(-0.5) / count;
        let mut found = Vec::new();
        for teeth in 1..=count as u32 / 2 {
            let turned = f64::from(teeth) * PI / count;
            let step = |k: u32| tip - tip * f64::from(k) / 1000.0;
            for (mut from, mut to) in (0..1000).map(|k| (step(k), step(k + 1))) {
                // from the tip on it grows and falls
                if slope(from, turned) <= 0.0 || slope(to, turned) > 0.0 {
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (from + to);
                    if slope(middle, turned) > 0.0 { from = middle } else { to = middle }
                }
                found.push((teeth, 2.0 * rho(from) * (from + turned).sin(), 2.0 * rho(from)));
            }
        }
        assert_eq!(found.iter().map(|of| of.0).collect::<Vec<u32>>(), all);
        let spans = &body.gauges.spans;
        assert_eq!(spans.iter().map(|of| of.teeth).collect::<Vec<u32>>(), all, "{spans:?}");
        for (span, (_, width, diameter)) in spans.iter().zip(found) {
            // charts are within 1e-8 mm, and their slopes within 1e-6
            assert!((span.width_mm - width).abs() < 5e-8, "{span:?} {width}");
            assert!(span.diameters_mm.iter().all(|at| (at - diameter).abs() < 1e-5), "{span:?} {diameter}");
        }
    }
}

/// Where balls stand out beyond the tip only if they touch just below it, one is found that does: by the least distance of its centre from the
/// closed surface of steep waves, outer and inner ones.
#[test]
fn balls_that_touch_just_below_the_tip_are_found() {
    let outer: [f64; 5] = [18.0, 4.0, 21.5, 10.0, 1.0];
    let inner = [33.0, 3.0, 18.5, -4.0, -1.0];
    for [count, high, tip, twist, side] in [outer, inner] {
        let lengths = [high, tip, if side > 0.0 { 10.0 } else { 30.0 }].map(|of| format!("{of} mm"));
        let (n, twisted) = (count.to_string(), format!("{twist} deg/mm"));
        let inner = if side > 0.0 { "0" } else { "1" };
        let [a, to, bore] = &lengths;
        let set = [("n", &*n), ("a", a), ("tip", to), ("bore", bore), ("twist", &*twisted), ("inner", inner)];
        let (body, _) = Asked::new(WAVES, "waves", &set).only();
        let balls = body.gauges.balls.as_ref().expect("one fits");
        let opposite = if count % 2.0 == 0.0 { 1.0 } else { (FRAC_PI_2 / count).cos() };
        let centre = 0.5 * (balls.over_balls_mm - side * balls.ball_mm) / opposite;
        let away = |[t, z]: [f64; 2]| {
            let (rho, angle) = (20.0 - side * high * (count * t).cos(), t + twist.to_radians() * z);
            let is_beyond = side * (rho - tip) > 0.0;
            if is_beyond { f64::INFINITY } else { (rho * angle.cos() - centre).hypot(rho * angle.sin()).hypot(z) }
        };
        // the least of a lattice, then of ever smaller ones about it
        let (mut at, mut size) = ([0.0; 2], [PI / count, balls.ball_mm]);
        for _ in 0..60 {
            let lattice = (-40..=40).flat_map(|i| (-40..=40).map(move |j| [f64::from(i) / 40.0, f64::from(j) / 40.0]));
            let places = lattice.map(|[i, j]| [at[0] + i * size[0], at[1] + j * size[1]]);
            at = places.min_by(|a, b| away(*a).total_cmp(&away(*b))).expect("a lattice has places");
            size = size.map(|size| 0.6 * size);
        }
        // charts are within 1e-8 mm
        assert!((away(at) - 0.5 * balls.ball_mm).abs() < 5e-8, "{balls:?} {}", away(at));
        assert!(side * (centre - tip) + 0.5 * balls.ball_mm > 0.0, "stands out: {balls:?}");
        assert!(balls.diameters_mm.iter().all(|at| side * (0.5 * at - tip) < 0.0), "below the tip: {balls:?}");
    }
}

/// Between three pins of a ring there is room for no ball that touches two of them: that is said.
#[test]
fn where_no_ball_fits_that_is_said() {
    let set = [("pins", "3")];
    let (body, _) = Asked::new("specs/bodies/pin_ring_body.chain", "pin_ring_body", &set).only();
    assert!(body.gauges.balls.is_none() && body.gauges.no_ball_fits, "{body}");
    assert!(body.to_string().contains("balls    none touches both flanks within their ends"), "{body}");
    let (other, _) =
        Asked { ball: Some(5.25), ..Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", &[]) }.only();
    assert!(!other.gauges.no_ball_fits && other.gauges.balls.is_some(), "{other}");
}

/// Lobes that end in an edge have no thickness there, and none below nothing.
#[test]
fn an_edge_has_no_thickness() {
    for (spec, job) in [("gerotor", "gerotor"), ("rounded_gerotor", "elliptic_gerotor")] {
        let folder = tempfile::tempdir().expect("a folder");
        let spec = format!("specs/cycloidal/{spec}.chain");
        let result = Asked::new(&spec, job, &[]).built(folder.path());
        assert!(!result.solids.is_empty());
        for body in &result.solids {
            let last = body.gauges.thickness.last().expect("up to the tip");
            assert!(last.arc_mm == 0.0 && last.arc_mm.is_sign_positive(), "{}", last.arc_mm);
            assert!(!body.to_string().contains("-0.0000"), "{body}");
        }
    }
}

/// Balls between two pins of a ring, by the distance of their centres, which stay clear of the ground that the pins stand out of: the program's
/// own choice does, and another one is refused with how deep it would lie.
#[test]
fn balls_stay_clear_of_the_ground_between_flanks() {
    let asked =
        |ball: Option<f64>| Asked { ball, ..Asked::new("specs/bodies/pin_ring_body.chain", "pin_ring_body", &[]) };
    let (ring, pin, half) = (60.0, 6.0, PI / 12.0);
    let ground = f64::hypot(ring, pin);
    let centre = |ball: f64| {
        let apart = pin + 0.5 * ball;
        ring * half.cos() - (apart * apart - (ring * half.sin()).powi(2)).sqrt()
    };
    let balls = asked(None).only().0.gauges.balls.expect("one fits");
    let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-7, "{found}, not {exact}");
    near(balls.over_balls_mm, 2.0 * centre(balls.ball_mm) - balls.ball_mm);
    assert!(centre(balls.ball_mm) + 0.5 * balls.ball_mm < ground, "{balls:?}");
    let refused = |ball: f64| {
        let folder = tempfile::tempdir().expect("a folder");
        let result = asked(Some(ball)).built(folder.path());
        assert!(result.solids[0].gauges.balls.is_none() && result.not_done()[0].kind == NotDoneKind::NoBall);
        result.not_done()[0].message.clone()
    };
    let deep = centre(20.5) + 10.25 - ground;
    assert!(refused(20.5).ends_with(&format!("would lie {deep:.4} mm deep in the steel of `ground`")), "{deep}");
    let set = [("pins", "3")];
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { set: &set, ..asked(Some(98.25)) }.built(folder.path());
    assert!(result.not_done()[0].message.ends_with("in opposite spaces of `ring` would lie in each other"), "{result}");
    let none = Asked { set: &set, ..asked(None) }.only().0.gauges.balls;
    assert!(none.as_ref().is_none_or(|balls| balls.over_balls_mm > 0.0), "{none:?}");
}
