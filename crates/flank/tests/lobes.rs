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

fn compared(ends: &str, surface: &str) -> DeviationResult {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cam.chain");
    std::fs::write(&file, cam(ends)).expect("the folder is there");
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
        let same = compared(ends, "other");
        assert_eq!((same.known, same.asked, same.not_done.len()), (105, 105, 0), "{ends}: {:?}", same.not_done);
        assert!(same.rms_um.is_some_and(|off| off < 1e-6), "{ends}: {:?}", same.rms_um);
        let larger = compared(ends, "larger");
        let ends_um = [larger.lowest_um, larger.highest_um].map(Option::unwrap_or_default);
        assert_eq!(larger.known, 105, "{ends}: {:?}", larger.not_done);
        assert!(ends_um.iter().all(|off| (off - 500.0).abs() < 1e-6), "{ends}: {ends_um:?}");
    }
}
