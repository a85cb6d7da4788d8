//! What is no body is told with its number and a way out, and what is at the border of that is built.

use std::f64::consts::{FRAC_PI_2, PI};

use flank::{Answer, NotDoneKind, SolidPart};
use flank_tests::bodies::{euler_characteristic, triangles, volume};
use flank_tests::repository;

use crate::asked::{Asked, BODIES};
use crate::spur::{ALPHA, Spur, simpson};

#[test]
fn what_bounds_no_body_is_told_with_its_number() {
    let spaces = "[left, left_fillet, root, right_fillet, right]";
    let with = |to: &'static str| Asked { changed: Some((spaces, to)), ..Asked::new(BODIES, "helical", &[]) };
    let told = with("[left, left_fillet, right_fillet, right]").refused();
    assert!(told.contains("`left_fillet` and `right_fillet`") && told.contains("leave a gap of 0.3660 mm"), "{told}");
    let told = with("[left]").refused();
    assert!(told.contains("is one surface"), "{told}");
    let told = Asked::new(BODIES, "helical", &[("bore", "35 mm")]).refused();
    assert!(told.contains("mm through `bore` of its outline"), "{told}");
    // the root's own radius: 3 mm times 12 / cos 15 deg less 1.05
    let root = 36.0 / f64::to_radians(15.0).cos() - 3.15;
    for bore in [root, root + 1e-7] {
        let told = Asked::new(BODIES, "helical", &[("bore", &*format!("{bore} mm"))]).refused();
        assert!(told.contains("reach `bore`") && told.contains("34.1199 mm from the axis: no wall"), "{told}");
    }
    // the rack is shorter than half the face
    let short = Some(("half_width: 2 * face_width", "half_width: 8 mm"));
    let told = Asked { changed: short, ..Asked::new(BODIES, "helical", &[("helix_angle", "0 deg")]) }.refused();
    assert!(
        told.contains("`left` ends are beyond the ranges of their unknowns, `v`") && told.contains(" by 2.0000 mm"),
        "{told}"
    );
    let told = with("[left, left_fillet, root, right_fillet]").not_done();
    let message = &told.message;
    assert!(message.contains("`right_fillet` does not reach `tip`") && message.contains("`theta` by "), "{told}");
    assert!(told.details[0].starts_with("name in `of:` the surface between `right_fillet` and the tip"), "{told}");
}

/// A bore outside the tip: between both there is nothing that spaces could be cut into.
#[test]
fn an_outline_beside_the_teeth_is_told_as_one() {
    for bore in ["40 mm", "45 mm"] {
        let told = Asked::new(BODIES, "helical", &[("helix_angle", "0 deg"), ("bore", bore)]).not_done();
        let outline =
            format!("it has its material 39.6000 .. {:.4} mm from the axis", bore[..2].parse::<f64>().expect("mm"));
        assert!(
            told.message.contains(&outline) && told.message.contains("no sampled point of `left` and `right`"),
            "{told}"
        );
        // 3 mm times 12 less 1.05
        let [way] = &told.details[..] else { panic!("{told}") };
        assert!(
            way.contains("on the other side of the ground of the spaces, which is 32.8500 mm from the axis"),
            "{told}"
        );
    }
}

/// A surface of whose branches none is chosen: each stands there with the `keep` that takes it, and the one that is meant makes the body.
#[test]
fn a_surface_with_several_branches_is_told_with_what_chooses_each() {
    const SPEC: &str = "specs/bodies/crowned_gear_body.chain";
    const KEEP: &str = "keep on_thread = spindle + tau: 0 deg .. 360 deg";
    let with = |keep: &str, check: &dyn Fn(Asked<'_>)| {
        check(Asked { changed: Some((KEEP, keep)), ..Asked::new(SPEC, "crowned_gear_body", &[]) });
    };
    with("", &|asked| {
        let told = asked.not_done();
        assert!(told.message.contains("`root` bounds the spaces of `gear` and is ambiguous"), "{told}");
        assert_eq!(told.details.len(), 6, "five turns of the hob, and what to do: {told}");
        assert!(told.details[..5].iter().all(|branch| branch.contains(": `keep spindle: ")), "{told}");
        assert!(told.details[5].contains("Put its `keep` into `sample root`"), "{told}");
        // on the thread that the text asks for
        let branch = told.details.iter().find(|of| of.contains("spindle 237.2392 deg")).expect("one of them");
        let keep = branch.split('`').nth(1).expect("a keep");
        with(keep, &|asked| {
            let (body, _) = asked.only();
            assert!(body.gauges.root_diameter_mm.is_some_and(|root| (root - 104.3579).abs() < 1e-4), "{body}");
        });
    });
}

/// A ground that is sampled along one row of a thread tells no rows apart.
#[test]
fn a_ground_in_one_row_is_told_with_what_to_sample() {
    const ROWS: &str = "105 deg / starts .. 255 deg / starts by 3";
    let worm = Asked {
        changed: Some((ROWS, "[180 deg]")),
        ..Asked::new("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", &[])
    };
    let folder = tempfile::tempdir().expect("a folder");
    let result = worm.built(folder.path());
    let told = &result.not_done()[0];
    assert!(
        told.message.contains("the sampled points of `worm_ground` lie in one row along the spaces of `worm`"),
        "{told}"
    );
    assert!(told.details[0].starts_with("in `sample worm_ground` three values or more"), "{told}");
}

/// Where the bore is too large by the space's whole depth, that is what is told, whatever is looked at first.
#[test]
fn how_far_spaces_go_through_the_bore_is_measured_where_they_go_farthest() {
    // 3 mm times 12 less 1.05
    let root = 36.0 - 3.15;
    for bore in [32.86, 32.9, 33.0, 33.5, 34.0, 36.0, 37.0, 38.0] {
        let set = [("helix_angle", "0 deg"), ("bore", &*format!("{bore} mm"))];
        let told = Asked::new(BODIES, "helical", &set).not_done();
        let by = format!("{:.4} mm through `bore`", bore - root);
        assert!(told.message.contains(&by), "{bore}: {by}, {}", told.message);
        assert!(told.place.is_some() && told.details.len() == 1 && told.kind == NotDoneKind::NoBody, "{told:?}");
    }
}

/// The roundings of a rack whose land is negative cross each other in the middle of the space, where the trochoid's angle is nothing. The
/// ground behind the crossing is no ground, and left out of the space its neighbours end there.
#[test]
fn spaces_that_cross_themselves_are_refused_and_end_where_fillets_meet() {
    let set = [("helix_angle", "0 deg"), ("r.tip_radius", "2 mm")];
    let asked = Asked::new(BODIES, "helical", &set);
    let spur = Spur { module: 3.0, teeth: 24.0, shift: 0.2, rounding: 2.0 / 3.0 };
    let (mut low, mut high) = (ALPHA, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if spur.trochoid(middle)[1] < 0.0 { high = middle } else { low = middle }
    }
    let [root, _] = spur.trochoid(low);
    let told = asked.not_done();
    let parts = ["cross themselves", "`left_fillet` and `right_fillet` meet", " mm from the axis"];
    assert!(parts.iter().all(|part| told.message.contains(part)), "{}", told.message);
    let words: Vec<&str> = told.message.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "from").expect("a place");
    // chords of the fillets
    let place: f64 = words[at - 2].parse().expect("a number");
    assert!((place - root).abs() < 0.01, "{place} {root}");
    assert!(told.details[0].contains("leave `root` out"), "{:?}", told.details);
    let (body, mesh) =
        Asked { changed: Some(("left_fillet, root, right_fillet", "left_fillet, right_fillet")), ..asked }.only();
    assert_eq!(euler_characteristic(&mesh), 0);
    let [left_out] = &body.left_out[..] else { panic!("{body}") };
    assert!(left_out.surface == "root" && left_out.depth_mm > 0.1, "{body}");
    assert!((body.gauges.root_diameter_mm.expect("round") - 2.0 * root).abs() < 1e-7, "{root} {:?}", body.gauges);
    let tip = spur.radius() + 3.6;
    let [form, _] = spur.trochoid(ALPHA);
    let flanks = simpson(form, tip, |rho| 2.0 * spur.involute(rho) * rho);
    // the space reaches no deeper than where they meet
    let section = PI * (tip * tip - 400.0) - 24.0 * (flanks + spur.fillet_to([ALPHA, low]));
    assert!((body.volume_mm3 / (20.0 * section) - 1.0).abs() < 1e-7, "{}", body.volume_mm3);
}

/// The sides of one tooth go on from spaces that wind, and reach no shaft beyond them: numbers and mesh of the part are there, which have the shaft,
/// and in place of its STEP file the reason and ways out. The whole gear has one.
#[test]
fn a_tooth_of_a_shaft_that_is_longer_than_its_teeth_has_no_smooth_sides() {
    let bore = "bore  = line(from: [front, reference_radius / 2], to: [back, reference_radius / 2])";
    let shaft = "neck  = line(from: [front, reference_radius / 2], to: [front - 12 mm, reference_radius / 2])
        end   = line(from: [front - 12 mm, reference_radius / 2], to: [front - 12 mm, reference_radius / 3])
        bore  = line(from: [front - 12 mm, reference_radius / 3], to: [back, reference_radius / 3])";
    let back = ("back  = line(from: [back, reference_radius / 2]", "back  = line(from: [back, reference_radius / 3]");
    let spec = "specs/bodies/helical_gear_body.chain";
    let text = std::fs::read_to_string(repository(spec)).expect("a spec");
    assert!(text.contains(bore) && text.contains(back.0), "{spec}");
    let longer = text.replace(bore, shaft).replace(back.0, back.1);
    let asked = Asked::new(spec, "helical_gear_body", &[]);
    let asked = Asked { step: Some(1e-4), changed: Some((&text, &longer)), ..asked };
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { part: SolidPart::Tooth, ..asked }.built(folder.path());
    let told = &result.not_done()[0];
    assert_eq!(told.kind, NotDoneKind::FaceInexact);
    assert!(
        told.message.contains("`neck` of the outline") && told.message.contains("by up to 12.0000 mm"),
        "{}",
        told.message
    );
    assert!(told.details[0].contains("option `solid gear`"), "{:?}", told.details);
    assert!(!folder.path().join("helical_gear_body.step").exists());
    let mesh = triangles(&folder.path().join("helical_gear_body.stl"));
    let share = result.solids[0].volume_mm3 / f64::from(result.solids[0].teeth);
    assert!((volume(&mesh) / share - 1.0).abs() < 1e-3, "a mesh within 10 um: {} of {share}", volume(&mesh));
    let result = Asked { part: SolidPart::Gear, ..asked }.built(folder.path());
    assert!(result.is_complete() && folder.path().join("helical_gear_body.step").exists(), "{:?}", result.not_done());
}

/// What is too narrow is named with the range that it has.
#[test]
fn ranges_that_end_too_soon_are_told() {
    let told = Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", &[("teeth", "4")]).not_done();
    assert!(told.message.contains("beyond the ranges of their unknowns, `phi` by 18.5194 deg"), "{}", told.message);
    assert_eq!(told.details, ["`phi`, the motion, has the range -60 deg .. 60 deg: a wider one reaches there"]);
    let set = [("r.tip_radius", "0 mm")];
    let told = Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", &set).not_done();
    let parts = ["81: cut away by the tool itself", "a rounding without a radius, is left out of `of:`"];
    assert!(told.details.iter().zip(parts).all(|(told, part)| told.contains(part)), "{told:?}");
}

/// A cutter's rounding makes the fillet; left out, it is a gap.
#[test]
fn a_rounding_that_no_surface_is_named_for_is_a_gap() {
    let told = Asked::new(BODIES, "internal", &[]).refused();
    assert!(told.contains("`left` and `root`") && told.contains("leave a gap of "), "{told}");
}

/// Where the halves of a lobe end far beside its top, no body is made of them; a little beside it the top is found all the same.
#[test]
fn lobes_that_end_beside_their_tops_are_told() {
    let gerotor = |place: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        Asked::new("specs/cycloidal/gerotor.chain", "gerotor", &[("p.place", place)]).built(folder.path())
    };
    let result = gerotor("180 deg");
    let told = &result.not_done()[0];
    // the ring's radius plus the eccentricity less the pin's radius is the top, 43.7 mm across; the ground is twice the eccentricity below
    assert!(told.message.contains("end in an edge 5.7000 mm below their top"), "{told}");
    assert!(told.message.contains("about the axis beside it") && told.details[0].contains("end on the top"), "{told}");
    let result = gerotor("1 deg");
    let gauges = &result.solids[0].gauges;
    for (found, exact) in [(gauges.tip_diameter_mm, 43.7), (gauges.root_diameter_mm, 32.3)] {
        let off = (found.expect("round") - exact).abs();
        // a search that stops where depths are equal to rounding
        assert!(off < 1e-6, "{off}");
    }
}

/// Lobes that the blank is lower than are turned down: they have lands, and the volume lies between those of the ground and of the whole lobes.
#[test]
fn round_lobes_can_be_turned_down() {
    let lower = Some(("ring_radius + eccentricity - pin_radius", "ring_radius + eccentricity - pin_radius - 1 mm"));
    let of =
        |changed| Asked { changed, ..Asked::new("specs/cycloidal/cycloidal_disc.chain", "cycloidal_disc", &[]) }.only();
    let ((whole, _), (turned, mesh)) = (of(None), of(lower));
    assert_eq!(euler_characteristic(&mesh), 0);
    let tip = turned.gauges.tip_diameter_mm.expect("round");
    // the ring's radius, the eccentricity, less the pin's radius and what is turned off
    assert!((tip - 2.0 * 55.5).abs() < 1e-6 && turned.gauges.edge_below_tip_mm.is_none(), "{tip}");
    // the bore is half as large as the blank: 0.5 mm smaller
    let bore = PI * (28.25_f64.powi(2) - 27.75_f64.powi(2)) * 12.0;
    let off = whole.volume_mm3 + bore - turned.volume_mm3;
    let ring = PI * (56.5_f64.powi(2) - 55.5_f64.powi(2)) * 12.0;
    assert!(off > 0.05 * ring && off < ring, "{off} of {ring}");
}

/// The lobes of a screw rotor have their crests at the end of a piece of the profile, where a height just below is met on both sides: the piece that
/// is named is the one that counts, up to the crest itself.
#[test]
fn lobes_of_rotors_reach_just_below_their_crests() {
    const BODY: &str = r#"
use "female_rotor.chain"
job rotor extends female_rotor {
    param below : length in 0 mm .. 5 mm = 0 mm
    let half = rotor_length / 2
    let top = tip_radius - below
    profile blank {
        tip   = line(from: [half, top], to: [-half, top])
        front = line(from: [-half, top], to: [-half, 10 mm])
        bore  = line(from: [-half, 10 mm], to: [half, 10 mm])
        back  = line(from: [half, 10 mm], to: [half, top])
    }
    solid female in m.gear = turned(blank, spaces: female_lobes, of: [minus.hollow, minus.lobe, plus.lobe, plus.hollow])
}
"#;
    let tips = ["0 mm", "0.02 mm", "0.05 mm", "0.3 mm"].map(|below| {
        let set = [("below", below)];
        let of = Asked::new("specs/rotors/rotor_body.chain", "rotor", &set);
        let folder = tempfile::tempdir().expect("a folder");
        let result = Asked { text: Some(BODY), ..of }.built(folder.path());
        assert!(result.is_complete(), "{below}: {result}");
        result.solids[0].gauges.tip_diameter_mm.expect("round")
    });
    for (tip, below) in tips.into_iter().zip([0.0, 0.02, 0.05, 0.3]) {
        // heights of the blank, given in mm
        assert!((tips[0] - 2.0 * below - tip).abs() < 1e-6, "{below}: {tip}");
    }
}

/// The rack of a form tool by the tool's own surfaces: each of them faces the other way.
#[test]
fn surfaces_that_face_into_the_steel_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let told = |changed| {
        let rack = Asked::new("specs/bodies/rack_body.chain", "rack_body", &[]);
        let result = Asked { changed, ..rack }.built(folder.path());
        let told = result.to_string().contains("point into the steel");
        (result.solids[0].into_steel.clone(), told)
    };
    assert_eq!(told(None), (Vec::new(), false));
    let all = ["flank_minus", "fillet_minus", "root", "fillet_plus", "flank_plus"].map(str::to_string).to_vec();
    assert_eq!(told(Some(("= envelope(", "= move("))), (all, true));
}

/// Slots with leaning walls, each wider than the one before: where some teeth are pointed and others not, that is told with how many and by how much,
/// and teeth that are all pointed end in edges.
#[test]
fn some_pointed_teeth_among_others_are_told() {
    const SPEC: &str = "tests/surfaces/specs/slotted_disc.chain";
    let [ground, tip, pitch] = [30f64, 40.0, PI / 6.0];
    // where a wall of 30 degrees reaches a circle, as an angle from the middle of its slot
    let angle_at = |rho: f64, half: f64| {
        let (mut low, mut high) = (ground, rho);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let wall = half + (middle - ground) * f64::to_radians(30.0).tan();
            if middle.hypot(wall) < rho { low = middle } else { high = middle }
        }
        (low / rho).acos()
    };
    let angle = |half: f64| angle_at(tip, half);
    for (first, wider) in [(4.0, 0.2), (5.0, 0.2), (2.0, 0.4)] {
        let half = |space: u32| first + wider * f64::from(space);
        let overlaps = (0..12).map(|space| tip * (angle(half(space)) + angle(half((space + 1) % 12)) - pitch));
        let overlaps: Vec<f64> = overlaps.collect();
        let pointed = overlaps.iter().filter(|overlap| **overlap > 0.0).count();
        let most = overlaps.iter().copied().fold(0.0, f64::max);
        assert!((1..12).contains(&pointed), "{overlaps:?}");
        let [first, wider] = [first, wider].map(|value| format!("{value} mm"));
        let set = [("first", &*first), ("wider", &*wider), ("s.slope", "30 deg")];
        let told = Asked::new(SPEC, "slotted_disc", &set).refused();
        let begin = format!("{pointed} of the 12 teeth of `disc` are pointed below the tip, and the others are not");
        assert!(told.contains(&begin), "{told}");
        let by = format!("their flanks overlap by up to {most:.4} mm at `tip`");
        assert!(told.contains(&by), "{told}, not {most}");
    }
    // from 5.5 mm on all are, and the highest edge lies between the first two slots
    let set = [("first", "5.5 mm"), ("wider", "0.02 mm"), ("s.slope", "30 deg")];
    let (body, mesh) = Asked::new(SPEC, "slotted_disc", &set).only();
    assert_eq!(euler_characteristic(&mesh), 0);
    let (mut low, mut high) = (35.0, tip);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if angle_at(middle, 5.5) + angle_at(middle, 5.52) < pitch { low = middle } else { high = middle }
    }
    let found = body.gauges.tip_diameter_mm.expect("round");
    // charts are within 1e-8 mm
    assert!((0.5 * found - low).abs() < 2e-8, "{found} {low}");
}
