//! Whoever follows an operation may cancel it; no file is left then.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use flank::{
    Disk, EvaluatorOptions, Failure, JobSelection, MeasureRequest, Monitor, PictureFormat, PlotKind, PlotRequest,
    PointFormat, Project, ReportRequest, SolveRequest, TableFormat, ViewRequest, Work, measure, plot, report, solve,
    view,
};

/// Cancels once long work has begun so many times.
struct Impatient {
    patience: usize,
    begun: AtomicUsize,
}

struct Line;

impl Work for Line {}

impl Monitor for Impatient {
    fn begin(&self, _: String) -> Box<dyn Work> {
        self.begun.fetch_add(1, Ordering::Relaxed);
        Box::new(Line)
    }

    fn is_cancelled(&self) -> bool {
        self.begun.load(Ordering::Relaxed) >= self.patience
    }
}

fn spec(name: &str) -> JobSelection {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").join(name);
    JobSelection::all(Project::open(file, Arc::new(Disk)))
}

/// An empty folder of a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

fn files(folder: &Path) -> usize {
    std::fs::read_dir(folder).expect("the folder of the test").count()
}

/// Cancelled after any number of beginnings an operation says so and leaves nothing; left alone it leaves files.
fn check(name: &str, operation: impl Fn(&dyn Monitor, PathBuf) -> Result<(), Failure>) {
    let out = folder(name);
    let watched = |patience: usize| {
        let monitor = Impatient { patience, begun: AtomicUsize::new(0) };
        let ended = operation(&monitor, out.clone());
        (ended, monitor.begun.into_inner())
    };
    let (_, all) = watched(usize::MAX);
    assert!(all > 0 && files(&out) > 0, "{name}: {all} pieces of work");
    let out = folder(name);
    for patience in 0..=all {
        let (ended, begun) = watched(patience);
        assert!(matches!(ended, Err(Failure::Cancelled)), "{name} after {patience}: {ended:?}");
        assert_eq!(begun, patience, "{name}: nothing begins once it is cancelled");
        assert_eq!(files(&out), 0, "{name} after {patience}");
    }
}

const GEAR: &str = "hobbing/undercut_gear.chain";

#[test]
fn solve_ends_without_files() {
    check("cancel_solve", |monitor, out| {
        let more = SolveRequest::new(spec(GEAR));
        let request = SolveRequest { out, limits: true, step: Some(1e-3), format: vec![PointFormat::Csv], ..more };
        solve(&request, monitor, &mut |_| {})
    });
}

/// A surface of more points than are kept is solved anew for each file.
#[test]
fn bands_end_without_files() {
    check("cancel_bands", |monitor, out| {
        let set = ["rows", "columns"].map(|name| (name.to_string(), "300".to_string())).to_vec();
        let jobs = JobSelection { job: Some("flank".to_string()), set, ..spec("../benches/spiral_bevel.chain") };
        let more = SolveRequest::new(jobs);
        solve(&SolveRequest { out, no_picture: true, ..more }, monitor, &mut |_| {})
    });
}

#[test]
fn pictures_end_without_files() {
    check("cancel_plot", |monitor, out| {
        let request = PlotRequest {
            jobs: spec(GEAR),
            what: vec![PlotKind::Surface, PlotKind::Residual],
            surface: Vec::new(),
            reference: None,
            of: Vec::new(),
            contact: Vec::new(),
            milling: None,
            errors: Vec::new(),
            positions: None,
            compound: None,
            out,
            format: vec![PictureFormat::Svg],
            size: (400, 300),
            no_origin: true,
            evaluator: EvaluatorOptions::default(),
        };
        plot(&request, monitor, &mut |_| {})
    });
}

#[test]
fn reports_and_pages_end_without_files() {
    let evaluator = EvaluatorOptions::default();
    check("cancel_report", |monitor, out| {
        let request = ReportRequest {
            jobs: spec(GEAR),
            out,
            format: Vec::new(),
            certify: false,
            step: None,
            date: None,
            evaluator,
        };
        report(&request, monitor, &mut |_| {})
    });
    check("cancel_view", |monitor, out| {
        view(&ViewRequest { jobs: spec("hobbing/spur_gear.chain"), out, evaluator }, monitor, &mut |_| {})
    });
}

#[test]
fn measuring_ends_without_files() {
    check("cancel_measure", |monitor, out| {
        let request = MeasureRequest {
            jobs: spec("bevel/pinion_19x62.chain"),
            surface: Vec::new(),
            rows: 5,
            columns: 9,
            margin: None,
            lines: Some(5),
            out,
            format: vec![TableFormat::Csv],
            evaluator: EvaluatorOptions::default(),
        };
        measure(&request, monitor, &mut |_| {})
    });
}
