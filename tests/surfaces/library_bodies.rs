//! Bodies of gears of all kinds: each is closed and has the volume of its exact surfaces, or it is named with the reason why not.

use std::sync::Arc;

use flank::{
    Answer, Disk, EvaluatorOptions, JobSelection, MeshFormat, Project, SolidPart, SolidRequest, SolidResult, Unwatched,
    solid,
};
use flank_tests::bodies::{euler_characteristic, triangles, volume};
use flank_tests::repository;

/// Coarse, so that all of the library takes seconds, mm.
const DEVIATION: f64 = 0.1;

/// Solids of shipped jobs that name one flank, for a contact, and what is said of them.
const FLANKS: [(&str, &str); 6] = [
    ("bevel_19x62", "pinion"),
    ("bevel_19x62", "gear"),
    ("hypoid_pair", "pinion"),
    ("hypoid_pair", "gear"),
    ("conjugate_pair", "pinion"),
    ("conjugate_pair", "gear"),
];

fn built(spec: &str, set: &[(&str, &str)], folder: &std::path::Path) -> Vec<SolidResult> {
    let project = Project::open(repository(spec), Arc::new(Disk));
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let request = SolidRequest {
        jobs: JobSelection { project, job: None, set },
        part: SolidPart::Gear,
        out: folder.to_path_buf(),
        format: vec![MeshFormat::Stl],
        step: None,
        deviation: DEVIATION,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    let mut results = Vec::new();
    solid(&request, &Unwatched, &mut |result| results.push(result)).expect("a right spec");
    results
}

/// Each is closed, of genus 1 for its bore, and as large as its exact surfaces say, within a skin as thick as the mesh may be off.
fn check(spec: &str, expected: &[(&str, u32)]) {
    check_of_genus(spec, expected, 1);
}

fn check_of_genus(spec: &str, expected: &[(&str, u32)], genus: i64) {
    let folder = tempfile::tempdir().expect("a folder");
    let results = built(spec, &[], folder.path());
    let mut found = Vec::new();
    for result in &results {
        for missing in result.not_done() {
            let name = missing.of.clone().unwrap_or_default();
            assert!(FLANKS.contains(&(&*result.job, &*name)), "{spec}: {}", missing.message);
            assert!(missing.message.contains("is one surface"), "{}", missing.message);
        }
        for body in &result.solids {
            let name = &body.name;
            found.push((name.as_str(), body.teeth));
            assert_eq!(body.into_steel, [""; 0], "{spec} {name}");
            // polynomials through exact points, whose last coefficients are rounding
            assert!(body.error_mm < 1e-8, "{spec} {name}: {}", body.error_mm);
            let alone = result.solids.len() + result.not_done().len() == 1;
            let file = if alone { result.job.clone() } else { format!("{}.{name}", result.job) };
            let mesh = triangles(&folder.path().join(format!("{file}.stl")));
            assert_eq!(euler_characteristic(&mesh), 2 - 2 * genus, "{spec} {name}");
            let off = (volume(&mesh) - body.volume_mm3).abs();
            assert!(off < body.area_mm2 * DEVIATION, "{spec} {name}: {off} mm³ of {}", body.volume_mm3);
            // a tooth is narrower than a pitch, at its tip, too
            for tooth in &body.gauges.thickness {
                let pitch = tooth.diameter_mm.map(|diameter| std::f64::consts::PI * diameter / f64::from(body.teeth));
                assert!(pitch.is_none_or(|pitch| tooth.arc_mm < 0.9 * pitch), "{spec} {name}: {tooth:?}");
            }
            let is_as_wide = (body.mesh.area_mm2 / body.area_mm2 - 1.0).abs() < 0.02;
            assert!(is_as_wide, "{spec} {name}: {} mm² of {}", body.mesh.area_mm2, body.area_mm2);
        }
    }
    assert_eq!(found, expected, "{spec}");
}

#[test]
fn cylindrical_gears() {
    check("specs/bodies/spur_gear_body.chain", &[("gear", 24)]);
    check("specs/bodies/undercut_gear_body.chain", &[("gear", 10)]);
    check("specs/bodies/semi_topped_gear_body.chain", &[("gear", 24)]);
    check("specs/bodies/helical_gear_body.chain", &[("gear", 31)]);
    check("specs/bodies/diagonal_gear_body.chain", &[("gear", 31)]);
    check("specs/bodies/shaped_gear_body.chain", &[("gear", 47), ("ring", 73)]);
    check("specs/bodies/internal_pair_body.chain", &[("pinion", 21), ("ring", 62)]);
    check("specs/bodies/rack_and_pinion_body.chain", &[("pinion", 24)]);
}

#[test]
fn crowned_and_taper_gears() {
    check("specs/bodies/crowned_gear_body.chain", &[("gear", 27)]);
    check("specs/bodies/crowned_gear_quartic_body.chain", &[("gear", 27)]);
    check("specs/bodies/beveloid_body.chain", &[("gear", 30)]);
    check("specs/bodies/helical_pair_body.chain", &[("pinion", 27), ("gear", 47)]);
}

#[test]
fn worm_gears_and_face_gears() {
    check("specs/bodies/worm_wheel_body.chain", &[("wheel", 40)]);
    check("specs/bodies/worm_and_wheel_body.chain", &[("worm", 1), ("wheel", 40)]);
    check("specs/bodies/face_gear_body.chain", &[("gear", 108)]);
    check("specs/bodies/face_gear_pair_body.chain", &[("pinion", 23), ("gear", 108)]);
}

/// Each section of a worm across its axis is the same one turned, and a space in it is as wide as along the axis by the reduced lead.
#[test]
fn worms_of_several_starts() {
    for starts in [2.0, 3.0, 4.0] {
        let folder = tempfile::tempdir().expect("a folder");
        let set = [("starts", &*starts.to_string())];
        let results = built("specs/bodies/worm_and_wheel_body.chain", &set, folder.path());
        assert!(results[0].is_complete(), "{:?}", results[0].not_done());
        let (module, radius, slope) = (4.0, 25.0, f64::to_radians(20.0).tan());
        let whole = |rho: f64| {
            (0.5 * std::f64::consts::PI * module - 2.0 * radius * slope) * rho * rho / 2.0
                + 2.0 * slope * rho.powi(3) / 3.0
        };
        let [tip, root, bore] = [radius + 0.8 * module, radius - module, 0.5 * (radius - module)];
        let section = std::f64::consts::PI * (tip * tip - bore * bore) - 2.0 / module * (whole(tip) - whole(root));
        let end = std::f64::consts::PI * module * ((300.0 + 500.0 / starts) / 360.0 * starts - 0.5);
        let (worm, exact) = (&results[0].solids[0], 2.0 * end * section);
        assert_eq!((worm.name.as_str(), f64::from(worm.teeth)), ("worm", starts));
        assert!((worm.volume_mm3 / exact - 1.0).abs() < 1e-8, "{starts} starts: {} {exact}", worm.volume_mm3);
    }
}

/// Bars have no bore; what their volume is, their specs expect in closed form.
#[test]
fn racks() {
    check_of_genus("specs/bodies/rack_body.chain", &[("rack", 10)], 0);
    check_of_genus("specs/bodies/helical_rack_body.chain", &[("rack", 10)], 0);
}

/// Half pins in the bore of a ring: its volume, diameters and thickness are expected in closed form by its spec.
#[test]
fn pin_rings() {
    check("specs/bodies/pin_ring_body.chain", &[("ring", 12)]);
}

/// All spaces differ.
#[test]
fn a_gear_whose_spaces_differ() {
    check("specs/bodies/elliptical_gear_body.chain", &[("gear", 36)]);
}

/// An ellipse of equal axes is a circle: twenty spaces, each with a law of its own, leave the volume of the round gear, but for its bore.
#[test]
fn a_round_elliptical_gear_is_a_spur_gear() {
    let volume = |spec: &str, set: &[(&str, &str)]| {
        let folder = tempfile::tempdir().expect("a folder");
        let results = built(spec, set, folder.path());
        assert!(results[0].is_complete(), "{:?}", results[0].not_done());
        results[0].solids[0].volume_mm3
    };
    let elliptical = volume("specs/bodies/elliptical_gear_body.chain", &[("axis_ratio", "1"), ("teeth", "20")]);
    let spur = volume("specs/bodies/spur_gear_body.chain", &[("profile_shift", "0"), ("teeth", "20")]);
    let reference: f64 = 30.0;
    let bores = std::f64::consts::PI * 20.0 * ((reference / 2.0).powi(2) - (reference / 4.0).powi(2));
    let off = elliptical / (spur + bores) - 1.0;
    // charts are within 1e-8 mm
    assert!(off.abs() < 1e-9, "{off:e}: {elliptical} and {spur} mm³");
}

#[test]
fn bevel_gears() {
    check("specs/bevel/octoid_gear.chain", &[("gear", 20)]);
    check("specs/bevel/pinion_19x62.chain", &[("pinion", 19)]);
    check("specs/bevel/gear_19x62.chain", &[("gear", 62)]);
    check("specs/bevel/thesis_gear.chain", &[("gear", 62)]);
    check("specs/bevel/duplex_helical_pinion.chain", &[("pinion", 19)]);
    check("specs/bevel/formate_gear.chain", &[("gear", 41)]);
    check("specs/bevel/helixform_gear.chain", &[("gear", 41)]);
    check("specs/bodies/hypoid_gear_body.chain", &[("gear", 41)]);
    check("specs/bodies/hypoid_pair_body.chain", &[("gear", 41), ("pinion", 13)]);
    check("specs/bodies/face_hobbed_pinion_body.chain", &[("pinion", 17)]);
    check("specs/bevel/pair_from_blank.chain", &[("pinion", 19), ("gear", 62)]);
}

#[test]
fn flanks_for_contacts_are_no_bodies() {
    check("specs/pairs/bevel_19x62.chain", &[]);
    check("specs/pairs/hypoid_pair.chain", &[]);
}

/// A lobe of a cycloidal disc against the area that its closed form encloses: Green's theorem along the equidistant of an epitrochoid, whose
/// teeth end in no land.
#[test]
fn cycloidal_discs_end_in_edges() {
    use std::f64::consts::{PI, TAU};
    let folder = tempfile::tempdir().expect("a folder");
    let results = built("specs/cycloidal/cycloidal_disc.chain", &[], folder.path());
    let body = &results[0].solids[0];
    let (pins, eccentricity, ring, pin, width) = (12.0, 2.5, 60.0, 6.0, 12.0);
    let point = |t: f64| {
        // the pin's centre in the disc, and the pin's radius towards the pitch point
        let centre = [ring * (t / (pins - 1.0)).cos(), ring * (t / (pins - 1.0)).sin()];
        let crank = t + t / (pins - 1.0);
        let off = [eccentricity * crank.cos(), eccentricity * crank.sin()];
        let curve = [centre[0] - off[0], centre[1] - off[1]];
        let pitch = [eccentricity * (pins - 1.0) * crank.cos(), eccentricity * (pins - 1.0) * crank.sin()];
        let towards = [pitch[0] - curve[0], pitch[1] - curve[1]];
        let length = towards[0].hypot(towards[1]);
        [curve[0] + pin * towards[0] / length, curve[1] + pin * towards[1] / length]
    };
    // the trapezoidal rule is exact to rounding over a period of a smooth curve
    let steps = 40_000;
    let around = TAU * (pins - 1.0);
    let area: f64 = (0..steps)
        .map(|k| {
            let [a, b] = [k, k + 1].map(|k| point(around * f64::from(k) / f64::from(steps)));
            0.5 * (a[0] * b[1] - a[1] * b[0])
        })
        .sum();
    let bore = (ring + eccentricity - pin) / 2.0;
    let exact = width * (area - PI * bore * bore);
    // chords of so many steps
    assert!((body.volume_mm3 / exact - 1.0).abs() < 1e-6, "{} {exact}", body.volume_mm3);
    let mesh = triangles(&folder.path().join("cycloidal_disc.stl"));
    assert_eq!(euler_characteristic(&mesh), 0);
}

/// A spec, values of its parameters, and what speaks against its body.
type Odd = (&'static str, &'static [(&'static str, &'static str)], Option<&'static str>);

/// Odd numbers give a body, or a reason with its number and no file.
#[test]
fn odd_numbers_give_a_body_or_a_reason() {
    let spur = "specs/bodies/spur_gear_body.chain";
    let helical = "specs/bodies/helical_gear_body.chain";
    let odd: [Odd; 11] = [
        (spur, &[("teeth", "7")], None),
        (spur, &[("teeth", "4"), ("profile_shift", "0")], Some("9 of 9 points there are beyond the ranges")),
        (spur, &[("teeth", "8"), ("profile_shift", "0.9")], None),
        (spur, &[("teeth", "300"), ("profile_shift", "-0.5")], None),
        (spur, &[("profile_shift", "1.9")], None),
        (spur, &[("module", "0.01 mm"), ("face_width", "0.05 mm")], None),
        (spur, &[("face_width", "400 mm")], None),
        (helical, &[("helix_angle", "45 deg")], None),
        (helical, &[("helix_angle", "0 deg"), ("teeth", "12"), ("shift", "0 mm")], None),
        ("specs/bodies/face_gear_body.chain", &[("inner_radius", "120 mm")], Some("neither end in one line nor meet")),
        ("specs/bodies/worm_wheel_body.chain", &[("teeth", "11")], Some("neither end in one line nor meet")),
    ];
    for (spec, set, reason) in odd {
        let folder = tempfile::tempdir().expect("a folder");
        let results = built(spec, set, folder.path());
        for result in results {
            let told: Vec<&str> = result.not_done().iter().map(|missing| missing.message.as_str()).collect();
            match reason {
                None => {
                    assert!(told.is_empty(), "{spec} {set:?}: {told:?}");
                    let mesh = triangles(&folder.path().join(format!("{}.stl", result.job)));
                    assert_eq!(euler_characteristic(&mesh), 0, "{spec} {set:?}");
                }
                Some(reason) => {
                    assert!(
                        told.iter().all(|told| told.contains(reason)) && !told.is_empty(),
                        "{spec} {set:?}: {told:?}"
                    );
                    let files = std::fs::read_dir(folder.path()).expect("a folder").count();
                    assert_eq!(files, 0, "no broken body in a file: {spec} {set:?}");
                }
            }
        }
    }
}
