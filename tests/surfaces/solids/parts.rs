//! One tooth, one space.

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
