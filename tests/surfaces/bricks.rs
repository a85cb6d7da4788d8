//! Bricks for finite elements: conforming, on the exact surfaces, none folded, with the volume of the body.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::sync::Arc;

use flank::{
    Answer, BrickFormat, BrickNumbers, Disk, ElementOrder, JobSelection, MeshRequest, MeshResult, NotDoneKind, Project,
    Unwatched, mesh,
};
use flank_tests::deck::Deck;
use flank_tests::{repository, shipped};

const BODIES: &str = "tests/surfaces/specs/bodies.chain";

struct Asked<'a> {
    spec: &'a str,
    /// All jobs if it is empty.
    job: &'a str,
    set: &'a [(&'a str, &'a str)],
    teeth: Option<u32>,
    elements: [u32; 3],
    order: ElementOrder,
}

impl<'a> Asked<'a> {
    fn new(spec: &'a str, job: &'a str) -> Asked<'a> {
        Asked { spec, job, set: &[], teeth: Some(1), elements: [8, 12, 6], order: ElementOrder::First }
    }

    fn written_to(&self, folder: &Path) -> Vec<MeshResult> {
        let set = self.set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        let project = Project::open(repository(self.spec), Arc::new(Disk));
        let job = Some(self.job.to_string()).filter(|job| !job.is_empty());
        let request = MeshRequest {
            teeth: self.teeth,
            elements: self.elements,
            order: self.order,
            out: folder.to_path_buf(),
            format: vec![BrickFormat::Inp],
            ..MeshRequest::new(JobSelection { project, job, set })
        };
        let mut results = Vec::new();
        mesh(&request, &Unwatched, &mut |result| results.push(result)).expect("a right spec");
        results
    }

    fn results(&self) -> Vec<MeshResult> {
        self.written_to(tempfile::tempdir().expect("a folder").path())
    }

    /// The result, and the files by their names.
    fn meshed(&self) -> (MeshResult, BTreeMap<String, String>) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut results = self.written_to(folder.path());
        let files = std::fs::read_dir(folder.path()).expect("a folder").map(|entry| {
            let path = entry.expect("an entry").path();
            (
                path.file_name().expect("a name").to_string_lossy().to_string(),
                std::fs::read_to_string(path).expect("text"),
            )
        });
        (results.remove(0), files.collect())
    }

    fn only(&self) -> (BrickNumbers, Deck) {
        let (mut result, files) = self.meshed();
        assert!(result.is_complete(), "{:?}", result.not_done());
        (result.solids.remove(0), Deck::read(files.values().next().expect("a file")))
    }
}

const ORDERS: [ElementOrder; 2] = [ElementOrder::First, ElementOrder::Second];

/// The middle of the space turned by so many teeth.
fn turned([x, y, z]: [f64; 3], by: f64) -> [f64; 3] {
    [x * by.cos() - y * by.sin(), x * by.sin() + y * by.cos(), z]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Each inner face is one of two bricks, which have it the other way round; each outer one stands in one surface. The outer faces are closed.
fn is_conforming(deck: &Deck, names: &[&str]) {
    let sorted = |face: (usize, usize)| {
        let mut nodes = deck.face(face);
        nodes.sort_unstable();
        nodes
    };
    let mut faces: BTreeMap<Vec<usize>, Vec<(usize, usize)>> = BTreeMap::new();
    for brick in 0..deck.bricks.len() {
        (0..6).for_each(|face| faces.entry(sorted((brick, face))).or_default().push((brick, face)));
    }
    let outer: BTreeSet<(usize, usize)> = faces.values().filter(|of| of.len() == 1).map(|of| of[0]).collect();
    assert!(faces.values().all(|of| of.len() <= 2), "no face of three bricks");
    let named: Vec<(usize, usize)> = deck.surfaces.values().flatten().copied().collect();
    let once: BTreeSet<(usize, usize)> = named.iter().copied().collect();
    assert_eq!((named.len(), &once), (outer.len(), &outer), "each outer face has one name");
    assert_eq!(deck.surfaces.keys().map(String::as_str).collect::<Vec<&str>>(), names);
    let sides = |face: &(usize, usize)| {
        let own = deck.face(*face);
        (0..4).map(|k| (own[k], own[(k + 1) % 4])).collect::<Vec<_>>()
    };
    let sides: Vec<(usize, usize)> = outer.iter().flat_map(sides).collect();
    let all: BTreeSet<(usize, usize)> = sides.iter().copied().collect();
    assert!(all.len() == sides.len() && all.iter().all(|(a, b)| all.contains(&(*b, *a))), "the outside is closed");
    for (name, faces) in &deck.surfaces {
        let nodes: BTreeSet<usize> = faces.iter().flat_map(|face| deck.face(*face)).collect();
        assert_eq!(nodes, deck.node_sets[name].iter().copied().collect(), "{name}");
    }
    let used: BTreeSet<usize> = deck.bricks.iter().flatten().copied().collect();
    assert_eq!(used.len(), deck.nodes.len(), "no node without a brick");
    let places: BTreeSet<[i64; 3]> = deck.nodes.iter().map(|node| node.map(|x| (x * 1e6).round() as i64)).collect();
    assert_eq!(places.len(), deck.nodes.len(), "no two nodes in one place");
}

/// Flanks of 12 and 35 degrees: their fillets turn into the root at other places, and each side has its own rows above and below.
#[test]
fn sides_that_differ_have_rows_of_their_own() {
    const SPEC: &str = "tests/surfaces/specs/asymmetric.chain";
    let names = [
        "BACK",
        "BORE",
        "FILLET_COAST_FILLET",
        "FILLET_LOADED_FILLET",
        "FLANK_COAST",
        "FLANK_LOADED",
        "FRONT",
        "ROOT_ROOT",
        "SIDE_1",
        "SIDE_2",
        "TIP",
    ];
    // of 32 and 20 degrees the root is 0.06 mm long, beside bricks that are 0.5 mm thick
    let angles =
        [("35 deg", "12 deg"), ("12 deg", "35 deg"), ("32 deg", "20 deg"), ("25 deg", "10 deg"), ("20 deg", "20 deg")];
    for (order, (loaded, coast)) in ORDERS.into_iter().flat_map(|order| angles.map(|of| (order, of))) {
        let set = [("loaded_angle", loaded), ("coast_angle", coast)];
        let (numbers, deck) = Asked { set: &set, order, ..Asked::new(SPEC, "asymmetric") }.only();
        // with the same rows on both sides the least was 0.03, with the mean of the directions beside a node -1.00
        assert!(numbers.least_scaled_jacobian > 0.3, "{loaded} {coast}: {numbers}");
        assert!(numbers.least_jacobian > 0.3, "at Gauss points, {loaded} {coast}: {numbers}");
        let exact = numbers.exact_volume_mm3.expect("all teeth are alike");
        // edges a tenth of the tooth's width long: straight ones lose some 1e-4 of it, parabolas the square of that and a reserve
        let off = if order == ElementOrder::First { 1e-3 } else { 2e-6 };
        assert!((numbers.volume_mm3 / exact - 1.0).abs() < off, "{loaded} {coast}: {numbers}");
        let across = &numbers.elements.across;
        let sides = [&across[..2], &across[3..]].map(|side| side.iter().sum::<usize>());
        assert_eq!((sides[0], across[2] % 2), (sides[1], 0), "{across:?}");
        if loaded == coast {
            assert_eq!((across[0], across[1]), (across[4], across[3]), "{across:?}");
        }
        is_conforming(&deck, &names);
    }
}

/// A shaft below the root and beyond the teeth on one side: conforming, each face on the segment that it lies on, and all of the volume. Mirrored
/// or with a shaft on both sides it is the same.
#[test]
fn a_shaft_beyond_the_teeth_has_bricks_of_its_own() {
    const SPEC: &str = "tests/surfaces/specs/asymmetric.chain";
    let names = [
        "BACK",
        "BORE",
        "END",
        "FILLET_COAST_FILLET",
        "FILLET_LOADED_FILLET",
        "FLANK_COAST",
        "FLANK_LOADED",
        "FRONT",
        "NECK",
        "ROOT_ROOT",
        "SIDE_1",
        "SIDE_2",
        "TIP",
    ];
    // names of segments, and what of [z, rho] is the same all over each
    let segments = [("NECK", 1, 22.0), ("END", 0, -22.0), ("BORE", 1, 15.0), ("BACK", 0, 10.0), ("FRONT", 0, -10.0)];
    for order in ORDERS {
        for teeth in [1, 3, 24] {
            let set = [("loaded_angle", "20 deg"), ("coast_angle", "20 deg")];
            let asked =
                Asked { set: &set, order, teeth: Some(teeth), elements: [4, 6, 4], ..Asked::new(SPEC, "shaft") };
            let (numbers, deck) = asked.only();
            let shaft = numbers.elements.shaft.expect("its own");
            let [first, second] = shaft.ends;
            assert!(first.min(second) == 0 && first.max(second) > 2, "{numbers}");
            assert!(numbers.least_scaled_jacobian > 0.3, "{numbers}");
            if teeth == 1 {
                is_conforming(&deck, &names);
            }
            let exact = numbers.exact_volume_mm3.expect("alike");
            assert!((numbers.volume_mm3 / exact - 1.0).abs() < 0.001, "{numbers}");
            for (name, k, wanted) in segments {
                for node in &deck.node_sets[name] {
                    let [x, y, z] = deck.nodes[*node];
                    let found = [z, x.hypot(y)][k];
                    assert!((found - wanted).abs() < 1e-9, "{name}: {found}");
                }
            }
        }
    }
}

/// A shaft that ends in a point has no face for its bricks: that is told, with a number that a scaled Jacobian may have.
#[test]
fn a_shaft_that_has_no_bricks_is_told_as_the_reason() {
    const SPEC: &str = "tests/surfaces/specs/asymmetric.chain";
    let (result, files) = Asked::new(SPEC, "spindle").meshed();
    let [told] = result.not_done() else { panic!("{:?}", result.not_done()) };
    assert!(files.is_empty() && told.kind == NotDoneKind::NoBricks, "{told}");
    assert!(told.message.contains("of the outline goes on beyond the teeth, by up to 12.0000 mm"), "{told}");
    assert!(told.details[0].contains("a blank that ends with its teeth"), "{told}");
    let printed = told.message.split("Jacobian is ").nth(1).and_then(|rest| rest.split(',').next());
    let printed: f64 = printed.and_then(|number| number.parse().ok()).expect("a number");
    assert!((-1.0..0.1).contains(&printed), "unit vectors have no larger determinant: {printed}");
}

#[test]
fn bricks_share_their_faces_and_sides_match() {
    let single = [
        "BACK",
        "BORE",
        "FILLET_LEFT_FILLET",
        "FILLET_RIGHT_FILLET",
        "FLANK_LEFT",
        "FLANK_RIGHT",
        "FRONT",
        "ROOT_ROOT",
        "SIDE_1",
        "SIDE_2",
        "TIP",
    ];
    for order in ORDERS {
        let (numbers, deck) = Asked { order, elements: [4, 3, 4], ..Asked::new(BODIES, "helical") }.only();
        is_conforming(&deck, &single);
        let counts = (numbers.bricks, numbers.nodes, numbers.connectivity().len());
        assert_eq!(counts, (deck.bricks.len(), deck.nodes.len(), deck.bricks.len()));
        let written = numbers.positions().iter().zip(&deck.nodes).map(|(a, b)| apart(*a, *b)).fold(0.0, f64::max);
        assert!(written < 1e-12, "{written}: thirteen decimals are written");
        let three = Asked { order, elements: [4, 3, 4], teeth: Some(3), ..Asked::new(BODIES, "helical") }.only();
        for ((numbers, deck), teeth) in [((numbers, deck), 1.0), (three, 3.0)] {
            let pitch = TAU / f64::from(numbers.teeth);
            let [first, last] = ["SIDE_1", "SIDE_2"].map(|name| &deck.node_sets[name]);
            assert_eq!(first.len(), last.len());
            for node in first {
                let to = turned(deck.nodes[*node], teeth * pitch);
                let near = last.iter().map(|other| apart(to, deck.nodes[*other])).fold(f64::INFINITY, f64::min);
                assert!(near < 1e-11, "{near} mm, {teeth} teeth");
            }
            assert_eq!(deck.tooth_sets.len() as f64, teeth);
        }
    }
}

#[test]
fn several_teeth_and_whole_gears_are_conforming() {
    for (spec, job, teeth) in [
        (BODIES, "helical", Some(3)),
        (BODIES, "helical", None),
        ("specs/bevel/pinion_19x62.chain", "pinion_19x62", Some(1)),
        ("specs/bevel/pinion_19x62.chain", "pinion_19x62", None),
    ] {
        let (numbers, deck) = Asked { teeth, elements: [3, 2, 3], ..Asked::new(spec, job) }.only();
        let names: Vec<&str> = numbers.sets.iter().map(|set| set.name.as_str()).collect();
        let mut sorted = names.clone();
        sorted.sort_unstable();
        is_conforming(&deck, &sorted);
        assert_eq!(names.contains(&"SIDE_1"), teeth.is_some());
        let count = teeth.unwrap_or(numbers.teeth);
        let flanks = names.iter().filter(|name| name.starts_with("FLANK_")).count();
        assert_eq!(flanks, 2 * count as usize, "{names:?}");
        for set in &numbers.sets {
            let [faces, nodes] =
                [numbers.set_faces(&set.name).map(<[_]>::len), numbers.set_nodes(&set.name).map(<[_]>::len)];
            assert_eq!((faces, nodes), (Some(set.faces), Some(set.nodes)));
        }
    }
}

/// Corners and middles of edges on the flanks lie on involutes, those on the tip on its circle, in planes at the ends.
#[test]
fn nodes_lie_on_the_exact_surfaces() {
    let set = [("helix_angle", "0 deg")];
    let (_, deck) = Asked { set: &set, order: ElementOrder::Second, ..Asked::new(BODIES, "helical") }.only();
    let (teeth, shift, module, alpha) = (24.0, 0.2, 3.0, PI / 9.0);
    let base = 0.5 * module * teeth * f64::cos(alpha);
    let inv = |angle: f64| angle.tan() - angle;
    let half = (FRAC_PI_2 + 2.0 * shift * alpha.tan()) / teeth;
    for (name, sign) in [("FLANK_LEFT", 1.0), ("FLANK_RIGHT", -1.0)] {
        let off = deck.node_sets[name].iter().map(|node| {
            let [x, y, _] = deck.nodes[*node];
            let rho = x.hypot(y);
            // from the middle of the tooth
            let tooth = half + inv(alpha) - inv((base / rho).acos());
            let pitches = y.atan2(x) / (TAU / teeth) * 2.0;
            let middle = (pitches / 2.0 - 0.5).round() + 0.5;
            let angle = y.atan2(x) - middle * TAU / teeth;
            (rho * (angle.abs() - tooth)).abs().max(if angle * sign > 0.0 { 0.0 } else { 1.0 })
        });
        let off = off.fold(0.0, f64::max);
        assert!(off < 2e-8, "{name}: {off:e} mm");
    }
    let tip = 0.5 * module * teeth + (1.0 + shift) * module;
    for (name, rho) in [("TIP", tip), ("BORE", 20.0)] {
        let off =
            deck.node_sets[name].iter().map(|node| (deck.nodes[*node][0].hypot(deck.nodes[*node][1]) - rho).abs());
        assert!(off.fold(0.0, f64::max) < 1e-8, "{name}");
    }
    for (name, z) in [("FRONT", -10.0), ("BACK", 10.0)] {
        assert!(deck.node_sets[name].iter().all(|node| (deck.nodes[*node][2] - z).abs() < 1e-8), "{name}");
    }
}

/// Straight edges miss a share of the volume that falls with the square of their length, parabolas one that falls with the fourth power.
#[test]
fn volumes_converge_to_that_of_the_body() {
    for (spec, job, set) in [
        (BODIES, "helical", vec![("helix_angle", "0 deg")]),
        (BODIES, "helical", vec![]),
        ("specs/bevel/pinion_19x62.chain", "pinion_19x62", vec![]),
    ] {
        for (order, rate) in ORDERS.into_iter().zip([2.0, 4.0]) {
            let off = [1, 2, 4].map(|finer| {
                let elements = [4 * finer, 4 * finer, 4 * finer];
                let (numbers, _) = Asked { set: &set, order, elements, ..Asked::new(spec, job) }.only();
                (numbers.volume_mm3 / numbers.exact_volume_mm3.expect("all teeth are alike") - 1.0).abs()
            });
            let found = (off[0] / off[2]).log2() / 2.0;
            // the coarsest may still be off by more than its share
            assert!((rate - 0.35..rate + 0.6).contains(&found), "{job} {order:?}: {found} of {off:?}");
        }
    }
}

/// Some teeth of a gear whose spaces differ have no share of its volume to be held against.
#[test]
fn teeth_that_differ_have_no_share_of_the_volume() {
    // wider slots than it has by itself: below narrow ones bricks would fold
    let set = [("first", "4 mm"), ("wider", "0.05 mm")];
    for (teeth, is_known) in [(1, false), (12, true)] {
        let asked = Asked::new("tests/surfaces/specs/slotted_disc.chain", "slotted_disc");
        let (numbers, _) = Asked { teeth: Some(teeth), set: &set, elements: [8, 6, 6], ..asked }.only();
        assert_eq!(numbers.exact_volume_mm3.is_some(), is_known);
    }
}

/// A chamfer above the flank is no flank, and halves of the root are root: sets have true names, and bricks up the flank are counted there.
#[test]
fn surfaces_of_a_space_have_the_names_of_what_they_are() {
    let asked = Asked { elements: [6, 4, 4], ..Asked::new("specs/bodies/semi_topped_gear_body.chain", "") };
    let (numbers, deck) = asked.only();
    let names: Vec<&str> = numbers.sets.iter().map(|set| set.name.as_str()).take(8).collect();
    let sides = |kind: &str, name: &str| ["MINUS", "PLUS"].map(|side| format!("{kind}_{side}_{name}"));
    let kinds = [("CHAMFER", "CHAMFER"), ("FLANK", "FLANK"), ("FILLET", "ROUNDING"), ("ROOT", "TIP")];
    for (place, (kind, name)) in kinds.into_iter().enumerate() {
        let both = [names[place], names[7 - place]];
        assert!(sides(kind, name).iter().all(|side| both.contains(&side.as_str())), "{both:?}");
    }
    let across = &numbers.elements.across;
    assert_eq!([across[1], across[6]], [6, 6], "{across:?}");
    assert!(across[0] < 3 && numbers.bricks < 1500, "{across:?} {} bricks", numbers.bricks);
    // involutes from the form diameter on, module 3, 24 teeth; the chamfer begins above the middle of the tooth
    let rho = |name: &str| deck.node_sets[name].iter().map(|node| deck.nodes[*node][0].hypot(deck.nodes[*node][1]));
    let highest = rho("FLANK_MINUS_FLANK").fold(0.0, f64::max);
    assert!(rho("CHAMFER_MINUS_CHAMFER").all(|rho| rho > highest - 1e-9 && rho > 37.0), "{highest}");
    let worm_wheel = Asked { elements: [4, 4, 4], ..Asked::new("specs/bodies/worm_wheel_body.chain", "") }.only().0;
    let roots = worm_wheel.sets.iter().filter(|set| set.name.starts_with("ROOT_")).count();
    assert_eq!(roots, 2, "{:?}", worm_wheel.sets);
}

/// Bodies that the layout does not fit: lobes and pins without a land, tips that are generated, and a thread of one start, along which a section across the axis runs.
const REFUSED: [(&str, &str); 5] = [
    ("gear", "end in an edge"),
    ("disc", "end in an edge"),
    ("ring", "end in an edge"),
    ("rotor", "end in an edge"),
    ("worm", "nearly so: their least scaled Jacobian is 0.0"),
];

/// No brick of any body of the library is folded or nearly so, as they come.
#[test]
fn bricks_of_all_bodies_are_well_shaped() {
    let is_with_bodies = |spec: &String| {
        let text = std::fs::read_to_string(repository(spec)).expect("text");
        text.contains("= turned(") || text.contains("= extruded(")
    };
    let specs = shipped().into_iter().filter(is_with_bodies).chain([BODIES.to_string()]);
    let mut bodies = 0;
    for spec in specs {
        for order in ORDERS {
            for result in (Asked { order, ..Asked::new(&spec, "") }).results() {
                let refused = result.not_done().iter().filter(|not_done| not_done.kind == NotDoneKind::NoBricks);
                for refused in refused {
                    let is_known = REFUSED
                        .iter()
                        .any(|(of, why)| refused.of.as_deref() == Some(*of) && refused.message.contains(why));
                    assert!(is_known, "{spec}: {refused:?}");
                }
                for solid in &result.solids {
                    bodies += 1;
                    let least = [solid.least_scaled_jacobian, solid.least_jacobian];
                    assert!(least[0] >= 0.2 && least[1] > 0.0, "{spec} {} {order:?}: {least:?}", solid.name);
                }
            }
        }
    }
    // pinions and gears of the bevel and spur pairs at the least
    assert!(bodies >= 10, "{bodies}");
}

#[test]
fn what_cannot_be_cut_is_told_with_its_reason() {
    let (result, files) = Asked { teeth: Some(25), ..Asked::new(BODIES, "helical") }.meshed();
    assert!(files.is_empty());
    assert_eq!(result.not_done()[0].message, "`gear` has 24 teeth: there are no 25 of them");
    let (result, files) = Asked { set: &[("bore", "35 mm")], ..Asked::new(BODIES, "helical") }.meshed();
    assert!(files.is_empty() && result.not_done()[0].message.contains("mm through `bore` of its outline"), "{result}");
    let (result, files) = Asked { set: &[("bore", "0 mm")], ..Asked::new(BODIES, "helical") }.meshed();
    let told = &result.not_done()[0];
    assert!(files.is_empty() && told.message.contains("the blank of `gear` reaches its axis"), "{told}");
    assert!(told.details[0].starts_with("a bore, however small") && told.kind == NotDoneKind::NoBricks, "{told}");
}

/// Bricks of the second order are held to their own map: the straight edges of these are good, but the curved ones turn back at corners. The first
/// order with the same numbers is told as a way out.
#[test]
fn bricks_that_curved_edges_fold_are_refused() {
    let asked = |order: ElementOrder| {
        let (result, files) =
            Asked { order, elements: [1, 12, 6], ..Asked::new("specs/bodies/undercut_gear_body.chain", "") }.meshed();
        (result, files.is_empty())
    };
    let (result, is_empty) = asked(ElementOrder::Second);
    let told = &result.not_done()[0];
    assert!(is_empty && told.message.contains("nearly so: their least scaled Jacobian is -"), "{told}");
    assert!(told.details.iter().any(|way| way.starts_with("bricks of the first order")), "{told}");
    let (result, is_empty) = asked(ElementOrder::First);
    assert!(result.is_complete() && !is_empty, "{result}");
}

/// Bricks that are another body are refused: too few along a thread.
#[test]
fn bricks_of_another_volume_are_refused() {
    let asked = Asked { elements: [8, 3, 6], ..Asked::new("specs/bodies/worm_and_wheel_body.chain", "") };
    let result = asked.results().remove(0);
    let told = result.not_done().iter().find(|told| told.of.as_deref() == Some("worm")).expect("it is refused");
    assert!(told.message.contains("their volume is -17.6 % off"), "{told}");
}
