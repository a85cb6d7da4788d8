//! One tooth, one space.

use std::f64::consts::PI;

use flank::{Answer, SolidPart};
use flank_tests::bodies::{euler_characteristic, triangles, volume};

use crate::asked::Asked;
use crate::volumes::moments;

/// The tooth of a worm of one start begins and ends in the middle of the same space: it is the worm.
#[test]
fn the_one_tooth_of_a_worm_is_all_of_it() {
    for part in [SolidPart::Tooth, SolidPart::Space] {
        let folder = tempfile::tempdir().expect("a folder");
        let worm = Asked::new("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", &[]);
        let result = Asked { part, deviation: 0.1, ..worm }.built(folder.path());
        let mesh = triangles(&folder.path().join("worm_and_wheel_body.worm.stl"));
        assert_eq!(euler_characteristic(&mesh), 0, "{part:?}");
        let exact = result.solids[0].volume_mm3;
        assert!((volume(&mesh) / exact - 1.0).abs() < 0.01, "{part:?}: {} {exact}", volume(&mesh));
    }
}

/// The one space is that which the job samples, about the x axis or the middle of the bar's first space.
#[test]
fn a_space_stands_where_it_is_sampled() {
    for job in ["spur_gear_body", "rack_body", "undercut_gear_body"] {
        let folder = tempfile::tempdir().expect("a folder");
        Asked { part: SolidPart::Space, ..Asked::new(&format!("specs/bodies/{job}.chain"), job, &[]) }
            .built(folder.path());
        let (_, centre, _) = moments(&triangles(&folder.path().join(format!("{job}.stl"))));
        assert!(centre[1].abs() < 1e-3, "{job}: {centre:?}");
    }
}

/// Parts are cut off from each other by the same triangles on both sides: a part has its share of what the whole mesh encloses.
#[test]
fn parts_fit_their_copies() {
    for (spec, job) in [("specs/bodies/helical_gear_body.chain", "helical_gear_body"), (DIAGONAL, "diagonal_gear_body")]
    {
        let of = |part: SolidPart| Asked { part, deviation: 0.03, ..Asked::new(spec, job, &[]) }.only().0;
        let body = of(SolidPart::Gear);
        let exact = body.volume_mm3 / f64::from(body.teeth);
        for part in [SolidPart::Tooth, SolidPart::Space] {
            let volume = of(part).mesh.volume_mm3;
            // flanks, fillets and root are chords within 0.03 mm; sides that do not fit made 3e-3 to 8e-3 of it
            assert!((volume / exact - 1.0).abs() < 1.5e-3, "{job} {part:?}: {volume} {exact}");
        }
    }
}

const DIAGONAL: &str = "specs/bodies/diagonal_gear_body.chain";

/// A gear each of whose spaces is a little deeper than the last.
const DEEPENING: &str = r#"
use "spur_gear_body.chain"

machine indexing extends rack_generating {
    axis S     : linear
    axis index : rotary
    frame indexed in table = rotate_z(-index)
    couple X = reference_radius + shift - S
}

job deepening extends spur_gear_body {
    param space : count in 0 .. 1000 = 0
    machine m = indexing(reference_radius: reference_radius, shift: profile_shift * module)
    drive m.C = phi
    drive m.index = 360 deg / teeth * space
    drive m.S = 0.05 mm * space
    surface flank_plus, fillet_plus   in m.indexed = envelope(r.flank_plus, r.fillet_plus, over: phi)
    surface flank_minus, fillet_minus in m.indexed = envelope(r.flank_minus, r.fillet_minus, over: phi)
    surface root in m.indexed = envelope(r.tip, over: phi)
    solid gear in m.indexed = turned(blank, spaces: teeth, each: space, of: [
        flank_minus, fillet_minus, root, fillet_plus, flank_plus
    ])
    expect nothing
}
"#;

/// A part of a gear whose spaces differ is no share of it: its STEP file says no volume, and its mesh is cut off by planes.
#[test]
fn parts_of_gears_whose_spaces_differ() {
    let set = [("teeth", "12"), ("profile_shift", "0.5")];
    for (part, has_volume) in [(SolidPart::Gear, true), (SolidPart::Space, false), (SolidPart::Tooth, false)] {
        let folder = tempfile::tempdir().expect("a folder");
        let of = Asked::new("specs/bodies/deepening.chain", "deepening", &set);
        let result = Asked { part, text: Some(DEEPENING), step: Some(1e-3), ..of }.built(folder.path());
        assert!(result.is_complete(), "{result}");
        let step = std::fs::read_to_string(folder.path().join("deepening.step")).expect("written");
        assert_eq!(step.contains("VOLUME_MEASURE"), has_volume, "{part:?}");
        if part == SolidPart::Space {
            let mesh = triangles(&folder.path().join("deepening.stl"));
            let way = |[x, y, _]: [f32; 3]| f64::from(y).atan2(f64::from(x));
            let ways = || mesh.iter().flatten().map(|at| way(*at));
            for end in [ways().fold(f64::INFINITY, f64::min), ways().fold(f64::NEG_INFINITY, f64::max)] {
                // corners of the part at the tip and at the bore lie on one plane through the axis: single precision
                let on = mesh.iter().flatten().filter(|at| (way(**at) - end).abs() < 1e-6);
                let radii: Vec<f64> = on.map(|[x, y, _]| f64::from(*x).hypot(f64::from(*y))).collect();
                let [low, high] =
                    [radii.iter().copied().fold(f64::INFINITY, f64::min), radii.iter().copied().fold(0.0, f64::max)];
                assert!(high - low > 4.0, "{end}: {low} .. {high}");
            }
        }
    }
}

/// The opening of a slot with parallel walls of half the width `half` between a flat ground at 30 mm and a tip of 40 mm: its area, and its
/// moment along its middle.
fn slot(half: f64) -> [f64; 2] {
    let (ground, tip) = (30f64, 40f64);
    let area = half * (tip * tip - half * half).sqrt() + tip * tip * (half / tip).asin() - 2.0 * half * ground;
    [area, half * (tip * tip - ground * ground) - half.powi(3) / 3.0]
}

/// A setting of the tool says how wide each slot is: what follows from the number of a space follows it into tools and machines. The bore has no
/// columns but those of teeth and grounds, and flat grounds need none.
#[test]
fn settings_of_tools_follow_the_space() {
    for [first, wider] in [["2 mm", "0.2 mm"], ["5 mm", "0 mm"]] {
        let set = [("first", first), ("wider", wider)];
        let asked = Asked::new("tests/surfaces/specs/slotted_disc.chain", "slotted_disc", &set);
        let [first, wider] = [first, wider].map(|text| text.trim_end_matches(" mm").parse::<f64>().expect("a number"));
        let (mut area, mut moment) = (PI * (40.0 * 40.0 - 15.0 * 15.0), [0.0; 2]);
        for space in 0..12 {
            let [own, along] = slot(first + wider * f64::from(space));
            let (sine, cosine) = (f64::from(space) * PI / 6.0).sin_cos();
            area -= own;
            moment = [moment[0] - along * cosine, moment[1] - along * sine];
        }
        let (body, mesh) = asked.only();
        assert!((body.volume_mm3 / (10.0 * area) - 1.0).abs() < 1e-9, "{} {}", body.volume_mm3, 10.0 * area);
        let off = [0, 1].map(|k| body.centre_mm[k] - moment[k] / area);
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{off:?}");
        assert!(mesh.len() < 8000, "{} triangles", mesh.len());
    }
}
