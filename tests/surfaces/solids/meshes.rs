//! Meshes are closed, and as near as they say.

use std::f64::consts::PI;
use std::sync::Arc;

use flank::{Disk, EvaluatorOptions, JobSelection, MeshFormat, Project, SolidPart, SolidRequest, Unwatched, solid};
use flank_tests::bodies::{euler_characteristic, triangles, volume};
use flank_tests::repository;

use crate::asked::{Asked, BODIES, DEVIATION};
use crate::spur::Spur;

#[test]
fn every_mesh_is_closed_and_nears_the_exact_body() {
    let jobs = [
        ("specs/pairs/spur_pair.chain", "spur_pair", "pinion"),
        (BODIES, "helical", "gear"),
        ("specs/bevel/pinion_19x62.chain", "pinion_19x62", "pinion"),
    ];
    for (spec, job, name) in jobs {
        for (part, holes, of) in [(SolidPart::Gear, 0, 1), (SolidPart::Tooth, 2, 0), (SolidPart::Space, 2, 0)] {
            let folder = tempfile::tempdir().expect("a folder");
            let result = Asked { part, ..Asked::new(spec, job, &[]) }.built(folder.path());
            let body = &result.solids[0];
            assert_eq!(body.name, name);
            let file = if result.solids.len() == 1 { job.to_string() } else { format!("{job}.{name}") };
            let mesh = triangles(&folder.path().join(format!("{file}.stl")));
            assert_eq!(euler_characteristic(&mesh), holes, "{job} {part:?}");
            let exact = if of == 1 { body.volume_mm3 } else { body.volume_mm3 / f64::from(body.teeth) };
            let area = body.mesh.area_mm2;
            // no more than a skin as thick as the mesh may be off, and single precision
            let off = (volume(&mesh) - exact).abs();
            assert!(off < area * (DEVIATION + 1e-5), "{job} {part:?}: {off} mm³ of {exact}");
            assert!((volume(&mesh) - body.mesh.volume_mm3).abs() < area * 1e-5, "what is said of the mesh is so");
            if of == 1 {
                assert!((area / body.area_mm2 - 1.0).abs() < 2e-3, "{area} {}", body.area_mm2);
            }
        }
    }
}

/// The front of a blank as part of a torus, bulging or hollow, and its bore as an arc: the middles of the mesh's edges lie as near to them as is
/// said.
#[test]
fn meshes_are_as_near_to_arcs_of_the_blank_as_is_said() {
    let front = "line(from: [-face_width / 2, tip_radius], to: [-face_width / 2, bore])";
    let bore = "line(from: [-face_width / 2, bore], to: [face_width / 2, bore])";
    // between tip and bore 19.6 mm, and along the bore 20 mm; a centre lies on the side of the material where the radius is positive
    let center = |radius: f64, half: f64| radius.signum() * (radius * radius - half * half).sqrt();
    let arcs = [(front, 25.0, [center(25.0, 9.8) - 10.0, 29.8]), (front, -60.0, [center(-60.0, 9.8) - 10.0, 29.8])];
    let arcs = arcs.into_iter().chain([(bore, 40.0, [0.0, 20.0 + center(40.0, 10.0)])]);
    for ((line, radius, [z0, rho0]), part) in
        arcs.flat_map(|arc| [SolidPart::Gear, SolidPart::Tooth].map(|of| (arc, of)))
    {
        let arc = line.replace("line(", "arc(").replace("])", &format!("], radius: {radius} mm)"));
        let set = [("helix_angle", "0 deg")];
        let asked = Asked { changed: Some((line, &arc)), part, ..Asked::new(BODIES, "helical", &set) };
        let off = |[x, y, z]: [f64; 3]| ((z - z0).hypot(x.hypot(y) - rho0) - f64::abs(radius)).abs();
        let is_on = |point: &[f32; 3]| {
            let [x, y, z] = point.map(f64::from);
            (if line == front { z < -5.0 } else { x.hypot(y) < 25.0 }) && off([x, y, z]) < 1e-4
        };
        let (_, mesh) = asked.only();
        let middle = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|k| 0.5 * (f64::from(a[k]) + f64::from(b[k])));
        let on_arc = mesh.iter().filter(|triangle| triangle.iter().all(is_on));
        let far: Vec<f64> =
            on_arc.flat_map(|[a, b, c]| [middle(*a, *b), middle(*b, *c), middle(*c, *a)].map(off)).collect();
        let most = far.iter().copied().fold(0.0, f64::max);
        assert!(far.len() > 100 && most < DEVIATION + 1e-5, "{arc} {part:?}: {most} mm of {}", far.len());
        assert!(most > 0.1 * DEVIATION, "{arc} {part:?}: no finer than is needed: {most} mm");
    }
}

#[test]
fn a_finer_mesh_is_nearer() {
    let asked = |deviation: f64| Asked { deviation, ..Asked::new(BODIES, "helical", &[]) }.only().0;
    let off = [0.08, 0.005].map(|deviation| {
        let body = asked(deviation);
        ((body.mesh.volume_mm3 / body.volume_mm3 - 1.0).abs(), (body.mesh.area_mm2 / body.area_mm2 - 1.0).abs())
    });
    assert!(off[1].0 < off[0].0 / 4.0 && off[1].1 < off[0].1 / 4.0, "{off:?}");
}

/// A shaft's blank goes as far as its axis: discs as ends, and nothing along the axis.
#[test]
fn a_body_without_a_bore_is_closed_at_its_axis() {
    let set = [("helix_angle", "0 deg"), ("bore", "0 mm")];
    let spur = Spur { module: 3.0, teeth: 24.0, shift: 0.2, rounding: 0.38 };
    let tip = spur.radius() + 3.6;
    let section = PI * tip * tip - 24.0 * spur.space(tip);
    for (part, share) in [(SolidPart::Gear, 1.0), (SolidPart::Tooth, 24.0), (SolidPart::Space, 24.0)] {
        let folder = tempfile::tempdir().expect("a folder");
        let result = Asked { part, ..Asked::new(BODIES, "helical", &set) }.built(folder.path());
        let (body, mesh) = (&result.solids[0], triangles(&folder.path().join("helical.stl")));
        assert_eq!(euler_characteristic(&mesh), 2, "{part:?}");
        assert_eq!((mesh.len(), body.mesh.triangles), (body.mesh.triangles, mesh.len()), "{part:?}");
        let used = body.mesh.vertices as i64 - mesh.len() as i64 / 2;
        assert_eq!(used, 2, "{part:?}: no vertex without a triangle");
        assert!((volume(&mesh) * share / (20.0 * section) - 1.0).abs() < 1e-3, "{part:?}: {}", volume(&mesh));
        assert!((body.volume_mm3 / (20.0 * section) - 1.0).abs() < 2e-8, "{}", body.volume_mm3);
    }
}

/// How far the middles of those sides of triangles that have both ends on a cylinder lie within it, mm.
fn off_cylinder(mesh: &[[[f32; 3]; 3]], rho: f64) -> f64 {
    let sides = mesh.iter().flat_map(|of| (0..3).map(move |k| [of[k], of[(k + 1) % 3]].map(|at| at.map(f64::from))));
    // single precision
    let on = sides.filter(|ends| ends.iter().all(|[x, y, _]| (x.hypot(*y) - rho).abs() < 1e-6 * rho));
    let off = on.map(|[a, b]| rho - (0.5 * (a[0] + b[0])).hypot(0.5 * (a[1] + b[1])));
    off.fold(0.0, f64::max)
}

/// However far teeth wind about the axis: tip and bore of a worm and of a steep pinion are as near to their cylinders as is told, that is no farther
/// than is asked for, and the area nears the exact one.
#[test]
fn meshes_of_threads_are_as_near_as_is_said() {
    let worm = ("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", "worm_and_wheel_body.worm");
    let steep = ("specs/bodies/helical_gear_body.chain", "helical_gear_body", "helical_gear_body");
    let cases: [(_, &[(&str, &str)]); 3] = [
        (worm, &[]),
        (worm, &[("starts", "2")]),
        (steep, &[("teeth", "6"), ("helix_angle", "60 deg"), ("face_width", "60 mm")]),
    ];
    for ((spec, job, file), set) in cases {
        let mut before = f64::INFINITY;
        for deviation in [0.04, 0.01] {
            let folder = tempfile::tempdir().expect("a folder");
            let result = Asked { deviation, ..Asked::new(spec, job, set) }.built(folder.path());
            let body = &result.solids[0];
            let mesh = triangles(&folder.path().join(format!("{file}.stl")));
            let inner = mesh.iter().flatten().map(|[x, y, _]| f64::from(*x).hypot(f64::from(*y)));
            let [tip, bore] = [0.5 * body.gauges.tip_diameter_mm.expect("round"), inner.fold(f64::INFINITY, f64::min)];
            let off = off_cylinder(&mesh, tip).max(off_cylinder(&mesh, bore));
            let told = body.mesh.deviation_mm;
            // 1e-5: single precision
            assert!(told <= deviation && off <= told + 1e-5, "{job} {set:?} {deviation}: {off} {told}");
            let area = (body.mesh.area_mm2 / body.area_mm2 - 1.0).abs();
            // the triangles of the ground wind with the thread
            assert!(area < before && area < 5e-3, "{job} {set:?} {deviation}: area off by {area}");
            before = area;
            assert_eq!(euler_characteristic(&mesh), 0, "{job} {set:?} {deviation}");
        }
    }
}

/// A mesh that nobody has room for is refused before it is made, with a deviation that is possible.
#[test]
fn a_mesh_that_is_too_large_is_refused_beforehand() {
    let path = repository("specs/bodies/spur_gear_body.chain");
    let folder = tempfile::tempdir().expect("a folder");
    let request = SolidRequest {
        jobs: JobSelection { project: Project::open(&path, Arc::new(Disk)), job: None, set: Vec::new() },
        part: SolidPart::Gear,
        out: folder.path().to_path_buf(),
        format: vec![MeshFormat::Stl],
        step: None,
        deviation: 1e-7,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    let refused = solid(&request, &Unwatched, &mut |_| ()).expect_err("it would take gigabytes").to_string();
    assert!(refused.starts_with("the mesh of `gear` within 1.0e-4 um would have"), "{refused}");
    assert!(refused.ends_with("um is possible with option `deviation`"), "{refused}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}
