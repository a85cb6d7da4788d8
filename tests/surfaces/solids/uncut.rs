//! Steel that bodies have and that tools of their jobs take away is told.

use std::f64::consts::{FRAC_PI_2, PI};

use flank::{Answer, NotDoneKind, SolidResult};

use crate::asked::{Asked, BODIES};
use crate::spur::ALPHA;

fn built(asked: &Asked<'_>) -> SolidResult {
    let folder = tempfile::tempdir().expect("a folder");
    asked.built(folder.path())
}

/// How deep a point of a ring comes into the flanks of a shaping cutter of involute teeth at most, as it rolls in the ring by 60 deg to both sides:
/// along the cutter's base circle, at positions so near to each other that the deepest is missed by less than 1e-6 mm.
fn depth_in_cutter([x, y]: [f64; 2], (module, teeth, cutter_teeth): (f64, f64, f64), outer: f64) -> f64 {
    let radius = 0.5 * module * cutter_teeth;
    let base = radius * ALPHA.cos();
    let half = FRAC_PI_2 / cutter_teeth + ALPHA.tan() - ALPHA;
    let count = 20_000;
    let depth = |k: i32| {
        let turn = f64::from(k - count) / f64::from(count) * PI / 3.0;
        let (sin, cos) = (turn * cutter_teeth / teeth).sin_cos();
        let [from, across] = [cos * x - sin * y - 0.5 * module * (teeth - cutter_teeth), sin * x + cos * y];
        let (sin, cos) = turn.sin_cos();
        let [own, aside] = [cos * from + sin * across, (cos * across - sin * from).abs()];
        let rho = own.hypot(aside);
        let is_flank = base < rho && rho < outer;
        let roll = ((rho / base).powi(2) - 1.0).max(0.0).sqrt();
        if is_flank { base * (half - (roll - roll.atan()) - aside.atan2(own)) } else { f64::NEG_INFINITY }
    };
    (0..=2 * count).map(depth).fold(f64::NEG_INFINITY, f64::max)
}

/// A cutter of nearly as many teeth as its ring cuts the tips off again as it rolls out: the body without that is no gear.
#[test]
fn what_the_tool_cuts_in_another_position_is_told() {
    let set = [("teeth", "30"), ("cutter_teeth", "27"), ("c.teeth", "27"), ("c.addendum", "4.2 mm")];
    let ring = Asked::new("specs/bodies/shaped_gear_body.chain", "shaped_internal_gear_body", &set);
    let result = built(&ring);
    let body = &result.solids[0];
    let [told] = result.not_done() else { panic!("{:?}", result.not_done()) };
    assert_eq!(told.kind, NotDoneKind::NotCut);
    assert!(told.message.contains("`ring` has steel up to 0.0738 mm deep"), "{told}");
    for side in ["plus", "minus"] {
        let of_side = told.details.iter().any(|line| {
            line.contains(&format!("flank_{side}: "))
                && line.contains(&format!("by c.flank_{side} in another position of the tool, by up to 0.0738 mm"))
        });
        assert!(of_side, "{told}");
    }
    // of the edge at the tip: the space there is as wide as the tooth of the pinion that would fill it
    let (module, teeth) = (3.0, 30.0);
    let tip = 0.5 * body.gauges.tip_diameter_mm.expect("round");
    let roll = ((tip / (0.5 * module * teeth * ALPHA.cos())).powi(2) - 1.0).sqrt();
    let half = FRAC_PI_2 / teeth + ALPHA.tan() - ALPHA - (roll - roll.atan());
    let exact = depth_in_cutter([tip * half.cos(), tip * half.sin()], (module, teeth, 27.0), 40.5 + 4.2 - 0.6);
    let deepest = body.cut_away_mm.expect("some of it is");
    assert!((deepest - exact).abs() < 2e-6, "{deepest} {exact}");
    assert!(body.to_string().contains("cut away in other positions of the tool, by up to 0.0738"), "{body}");

    // as it is shipped nothing is, nor of a tooth that the rack undercuts, whose flank and fillet meet
    let shipped = Asked::new("specs/bodies/shaped_gear_body.chain", "shaped_internal_gear_body", &[]);
    let undercut = [("helix_angle", "0 deg"), ("teeth", "10"), ("shift", "0"), ("bore", "5 mm")];
    for whole in [shipped, Asked::new(BODIES, "helical", &undercut)] {
        assert_eq!(whole.only().0.cut_away_mm, None);
    }
}

/// A second rack that takes the corners of the tips away.
const CHAMFERED: &str = "use \"spur_gear_body.chain\"
job chamfered extends spur_gear_body {
    tool q = rack(module: module, pressure_angle: 40 deg, tip_radius: 0 mm, tip_height: 0 mm, root_height: 2 * module)
    mount q on m.head
    surface chamfer_plus, chamfer_minus in m.table = envelope(q.flank_plus, q.flank_minus, over: phi)
    trim flank_plus by chamfer_plus
    trim flank_minus by chamfer_minus
    expect nothing
}
";

/// Of surfaces that trim those of a body, and are none of it.
#[test]
fn a_trim_that_a_body_leaves_out_is_told() {
    let asked = |text| Asked { text: Some(text), ..Asked::new("specs/bodies/chamfered.chain", "chamfered", &[]) };
    let result = built(&asked(CHAMFERED));
    assert_eq!(result.not_done().len(), 2, "{:?}", result.not_done());
    for (told, side) in result.not_done().iter().zip(["minus", "plus"]) {
        assert_eq!(told.kind, NotDoneKind::NotCut);
        let (chamfer, flank) = (format!("`chamfer_{side}`"), format!("`flank_{side}`"));
        assert!(told.message.starts_with(&format!("{chamfer} trims {flank} and is no surface of `gear`")), "{told}");
        assert!(told.details[0].starts_with(&format!("name {chamfer} in `of:` beside {flank}")), "{told}");
    }
    // the way out
    let named = CHAMFERED.replace(
        "    expect nothing",
        "    sample chamfer_plus, chamfer_minus { rho: 36.7 mm .. 39 mm by 5, z: front .. back by 3 }
    solid gear in m.table = turned(blank, spaces: teeth, of: [
        chamfer_minus, flank_minus, fillet_minus, root, fillet_plus, flank_plus, chamfer_plus
    ])
    expect nothing",
    );
    let (body, _) = asked(&named).only();
    assert!(body.volume_mm3 < result.solids[0].volume_mm3 - 1000.0, "{body}");
    // chamfers above the tip take nothing from the body
    let above = CHAMFERED.replace("mount q on m.head", "mount q on m.head\n    let tip_radius = reference_radius");
    if let [told, ..] = built(&asked(&above)).not_done() {
        panic!("{told}");
    }
}
