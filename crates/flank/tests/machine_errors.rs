//! Errors of a machine, against the same errors written into its frames by hand.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{
    Buffers, CauseKind, Disk, FitRequest, JobSelection, MeasureRequest, Project, ReportRequest, SolveRequest,
    SolveResult, TableFormat, ToleranceRequest, Unwatched, fit, measure, report, solve, tolerance,
};

/// The errors, each as the variant names it.
const ERRORS: &str = "m.EXX: 20 um, m.EYX: -10 um, m.EZX: 15 um, m.EAX: 20 arcsec, m.EBX: -30 arcsec, m.ECX: 10 arcsec, \
                      m.EXC: 5 um, m.EYC: 4 um, m.EZC: 3 um, m.EAC: 15 arcsec, m.EBC: -12 arcsec, m.ECC: 8 arcsec";

fn text() -> String {
    format!(
        "use \"helical_gear.chain\"
        use \"../machines/hobbing_6axis.chain\"
        use \"../machines/hobbing_errors.chain\"
        job nominal = helical_gear()
        job worn = helical_gear(m: hobbing_errors)
        job erring = helical_gear(m: hobbing_errors, {ERRORS})
        job written = helical_gear(m: by_hand)
        machine by_hand extends hobbing_6axis {{
            frame slide in bed =
                translate(X + 0.02 mm, -0.01 mm, Z + 0.015 mm) rotate_x(20 arcsec) rotate_y(-30 arcsec) rotate_z(10 arcsec)
            frame table in bed =
                translate(0.005 mm, 0.004 mm, 0.003 mm) rotate_x(15 arcsec) rotate_y(-12 arcsec) rotate_z(C + 8 arcsec)
        }}"
    )
}

fn selection(job: &str, set: &[(&str, &str)]) -> JobSelection {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/hobbing/worn.chain");
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text());
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    JobSelection { project: Project::open(spec, Arc::new(files)), job: Some(job.to_string()), set }
}

fn out(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn solved(job: &str, set: &[(&str, &str)]) -> SolveResult {
    let request = SolveRequest {
        out: out("machine_errors"),
        format: vec![],
        no_picture: true,
        sensitivity: true,
        ..SolveRequest::new(selection(job, set))
    };
    let mut all = Vec::new();
    solve(&request, &Unwatched, &mut |one| all.push(one)).expect("it is solved");
    all.remove(0)
}

fn farthest(a: &SolveResult, b: &SolveResult) -> f64 {
    let pairs = a.surfaces.iter().zip(&b.surfaces).flat_map(|(a, b)| a.positions().iter().zip(b.positions()));
    pairs.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs())).fold(0.0, f64::max)
}

/// Points are solved to 1e-9 mm; an error of 20 um moves them by as much.
#[test]
fn errors_do_what_they_do_in_the_frames() {
    let [nominal, worn, erring, written] = ["nominal", "worn", "erring", "written"].map(|job| solved(job, &[]));
    assert!(farthest(&nominal, &worn) < 1e-9, "they are zero: {:e}", farthest(&nominal, &worn));
    assert!(farthest(&erring, &written) < 1e-9, "{:e}", farthest(&erring, &written));
    assert!(farthest(&erring, &nominal) > 5e-3);
    let told = worn.surfaces[0].sensitivity.as_ref().expect("it was asked for");
    let names: Vec<&str> = told.parameters.iter().map(|of| of.name.as_str()).collect();
    for error in ["m.EXX", "m.EAC", "m.EBC", "m.ECC"] {
        assert!(names.contains(&error), "{error} in {names:?}");
    }
}

/// A gear is cut by a machine with an error, and measured. The error is found, and nothing is set; with a setting beside it the
/// setting alone is corrected.
#[test]
fn an_error_is_identified_and_not_set() {
    let out = out("machine_errors_fit");
    let request = MeasureRequest {
        jobs: selection("worn", &[("m.EAC", "40 arcsec")]),
        surface: vec!["lower_flank".to_string()],
        rows: 5,
        columns: 9,
        margin: None,
        lines: None,
        out: out.clone(),
        format: vec![TableFormat::Csv],
        evaluator: flank::EvaluatorOptions::default(),
    };
    measure(&request, &Unwatched, &mut |_| {}).expect("a grid");
    let asked = |vary: &[&str]| FitRequest {
        measured: Some(out.join("worn.grid.csv")),
        vary: vary.iter().map(|name| name.to_string()).collect(),
        ..FitRequest::new(selection("worn", &[]), "lower_flank")
    };
    let told = fit(&asked(&["m.EAC"]), &Unwatched).expect("a fit");
    let found = &told.identification.as_ref().expect("measured").settings[0];
    assert!(found.is_error && (found.new - 40.0 / 3600.0).abs() < 1e-9, "{found:?}");
    assert!(told.correction.settings.is_empty() && told.not_done.is_empty(), "{:?}", told.not_done);
    assert!(told.to_string().contains("only errors of the machine were looked for"), "{told}");
    let told = fit(&asked(&["m.EAC", "normal_pressure_angle"]), &Unwatched).expect("a fit");
    let names: Vec<&str> = told.correction.settings.iter().map(|of| of.name.as_str()).collect();
    assert_eq!(names, ["normal_pressure_angle"]);
}

/// Errors scatter by a sixth of their range, and stand apart in the report.
#[test]
fn errors_are_told_apart() {
    let told =
        tolerance(&ToleranceRequest::new(selection("worn", &[]), "lower_flank"), &Unwatched).expect("tolerances");
    let errors: Vec<_> = told.causes.iter().filter(|cause| cause.kind == CauseKind::Error).collect();
    assert_eq!(errors.len(), 12);
    assert!((errors[0].scatter - 0.2 / 6.0).abs() < 1e-12, "{:?}", errors[0]);
    let folder = out("machine_errors_report");
    let request = ReportRequest {
        jobs: selection("worn", &[("m.EXX", "20 um")]),
        out: folder.join("worn.md"),
        format: vec![],
        certify: false,
        step: None,
        date: None,
        evaluator: flank::EvaluatorOptions::default(),
    };
    let mut all = Vec::new();
    report(&request, &Unwatched, &mut |one| all.push(one)).expect("a report");
    assert_eq!(all[0].inputs.iter().filter(|input| input.is_error).count(), 12);
    let page = std::fs::read_to_string(folder.join("worn.md")).expect("written");
    assert!(page.contains("errors, zero in the nominal machine"), "{page}");
}
