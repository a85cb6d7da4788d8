//! Deviations of profiles whose distance from the axis has extrema, as cams and lobes have.

use std::path::Path;
use std::sync::Arc;

use flank::{DeviationRequest, DeviationResult, Disk, EvaluatorOptions, JobSelection, Project, Unwatched, deviation};

/// A roller that follows a cam, sampled by the cam's turn: twice by one roller, and by one that is thinner.
fn cam(ends: &str) -> String {
    format!(
        "machine grinder {{
    axis C : rotary
    axis X : linear
    frame bed
    frame slide in bed = translate_x(X)
    frame work  in bed = rotate_z(C)
}}
tool roller {{
    param radius : length = 8 mm
    surface side(u: angle in 90 deg .. 270 deg, v: length in -10 mm .. 10 mm) {{
        at = [radius * cos(u), radius * sin(u), v]
        body inside
    }}
}}
job cam {{
    machine m = grinder
    tool r = roller
    tool thin = r(radius: 7.5 mm)
    mount r, thin on m.slide
    motion turn : angle in -180 deg .. 180 deg
    drive m.C, m.X = turn, 40 mm + 3 mm * cos(2 * turn)
    surface one, other, larger in m.work = envelope(r.side, r.side, thin.side, over: turn)
    sample one, other, larger {{ turn: {ends} by 35, v: -5 mm .. 5 mm by 3 }}
}}
"
    )
}

/// A pin that stands beside the axis, sampled by the angle about its own middle, and a thinner one.
const PIN: &str = "machine table {
    axis C : rotary
    frame bed
    frame seat in bed = translate_x(20 mm)
    frame work in bed = rotate_z(C)
}
tool roller {
    param radius : length = 8 mm
    surface side(u: angle in -180 deg .. 180 deg, v: length in -10 mm .. 10 mm) {
        at = [radius * cos(u), radius * sin(u), v]
        body inside
    }
}
job pin {
    machine m = table
    tool r = roller
    tool thin = r(radius: 7.5 mm)
    mount r, thin on m.seat
    drive m.C = 0 deg
    surface one, other in m.work = move(r.side, thin.side)
    sample one { u: 10 deg .. 170 deg by 34, v: -5 mm .. 5 mm by 3 }
    sample other { u: 60 deg .. 120 deg by 5, v: -5 mm .. 5 mm by 3
        keep u: 0 deg .. 180 deg }
}
";

fn compared(text: &str, surface: &str) -> DeviationResult {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cam.chain");
    std::fs::write(&file, text).expect("the folder is there");
    let project = Project::open(Path::new(&file), Arc::new(Disk));
    let request = DeviationRequest {
        jobs: JobSelection { project, job: None, set: Vec::new() },
        surface: surface.to_string(),
        reference: Some("one".to_string()),
        reference_jobs: None,
        measured: None,
        rows: None,
        columns: None,
        margin: None,
        no_align: true,
        out: folder.path().join("out"),
        format: Vec::new(),
        no_picture: true,
        evaluator: EvaluatorOptions::default(),
    };
    deviation(&request, &Unwatched).expect("the spec is right")
}

/// The same radius comes four times on a whole cam, twice on one of its lobes: the angle tells these points apart.
#[test]
fn cams_and_lobes_are_compared_all_around() {
    for ends in ["-170 deg .. 170 deg", "-60 deg .. 60 deg"] {
        let same = compared(&cam(ends), "other");
        assert_eq!((same.known, same.asked, same.not_done.len()), (105, 105, 0), "{ends}: {:?}", same.not_done);
        assert!(same.rms_um.is_some_and(|off| off < 1e-6), "{ends}: {:?}", same.rms_um);
        let larger = compared(&cam(ends), "larger");
        let ends_um = [larger.lowest_um, larger.highest_um].map(Option::unwrap_or_default);
        assert_eq!(larger.known, 105, "{ends}: {:?}", larger.not_done);
        assert!(ends_um.iter().all(|off| (off - 500.0).abs() < 1e-6), "{ends}: {ends_um:?}");
    }
}

/// The normals of the pin point everywhere. Beyond the radii that the thinner one has, it is not found, which is told with the way out.
#[test]
fn a_surface_that_is_not_found_is_told_so() {
    let thinner = compared(PIN, "other");
    let told: Vec<&str> = thinner.not_done.iter().map(|one| one.message.as_str()).collect();
    let [told] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!((thinner.known, thinner.asked), (87, 102), "{told}");
    assert!(
        told.starts_with("no deviation at 15 of 102 points: other, looked for by rho and z, was not found there;"),
        "{told}"
    );
    let ends = [thinner.lowest_um, thinner.highest_um].map(Option::unwrap_or_default);
    assert!(ends.iter().all(|off| (off + 500.0).abs() < 1e-6), "{ends:?}");
}
