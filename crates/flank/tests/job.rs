//! A job holds its texts and its values, and goes from thread to thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use flank::{
    Answer, DeviationRequest, Disk, EvaluatorOptions, Failure, Files, JobSelection, NotDoneKind, Project, RemarkKind,
    SolveRequest, SolveResult, Status, Unwatched, ValueSource, deviation, solve,
};

/// The disk, with a count of what is read from it.
#[derive(Debug, Default)]
struct Counted(AtomicUsize);

impl Files for Counted {
    fn real_path(&self, path: &Path) -> std::io::Result<PathBuf> {
        Disk.real_path(path)
    }

    fn exists(&self, path: &Path) -> bool {
        Disk.exists(path)
    }

    fn read(&self, real: &Path, most: usize) -> std::io::Result<String> {
        self.0.fetch_add(1, Ordering::Relaxed);
        Disk.read(real, most)
    }
}

fn project(files: Arc<dyn Files>) -> Project {
    Project::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/hobbing/helical_gear.chain"), files)
}

fn solved(jobs: JobSelection, folder: &str) -> SolveResult {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let request = SolveRequest { out, no_picture: true, ..SolveRequest::new(jobs) };
    let mut all = Vec::new();
    solve(&request, &Unwatched, &mut |one| all.push(one)).expect("it is solved");
    all.remove(0)
}

#[test]
fn a_job_needs_its_files_no_more() {
    let files = Arc::new(Counted::default());
    let set = [("teeth".to_string(), "31".to_string())];
    let job = project(files.clone()).job("helical_gear", &set).expect("it is right");
    let read = files.0.load(Ordering::Relaxed);
    assert!(read > 1, "it uses other files");
    let teeth = job.parameters().iter().find(|parameter| parameter.name == "teeth").expect("it has teeth");
    assert!(teeth.value == 31.0 && teeth.is_count && teeth.unit.is_empty(), "{teeth:?}");
    let elsewhere = job.clone();
    let by_job = std::thread::spawn(move || solved((&elsewhere).into(), "job_thread")).join().expect("it ends");
    assert_eq!(files.0.load(Ordering::Relaxed), read, "nothing is read again");

    let by_files =
        solved(JobSelection { set: set.to_vec(), ..JobSelection::all(project(Arc::new(Disk))) }, "job_files");
    assert_eq!(by_job.surfaces.len(), by_files.surfaces.len());
    for (one, other) in by_job.surfaces.iter().zip(&by_files.surfaces) {
        assert_eq!((one.positions(), one.unknowns()), (other.positions(), other.unknowns()));
    }
}

/// Arrays lie side by side, point by point.
#[test]
fn points_come_as_slices() {
    let job = project(Arc::new(Disk)).job("helical_gear", &[]).expect("it is right");
    let result = solved((&job).into(), "job_slices");
    assert!(result.is_complete());
    for (of, surface) in job.surfaces().iter().filter(|surface| surface.counts.is_some()).zip(&result.surfaces) {
        let [rows, columns] = surface.counts();
        assert_eq!(Some([rows, columns]), of.counts);
        let count = rows * columns;
        assert_eq!([surface.positions().len(), surface.normals().len()], [count; 2]);
        assert_eq!([surface.statuses().len(), surface.residuals().len()], [count; 2]);
        assert_eq!(surface.unknowns().len(), count * surface.unknown_names().count());
        let found = surface.statuses().iter().filter(|status| **status == Status::Solved).count();
        assert_eq!(found, surface.summary.solved);
        for normal in surface.normals() {
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            // the sum of three rounded squares
            assert!((length - 1.0).abs() < 1e-14, "{length}");
        }
    }
}

/// What was not done says what kind of thing it is and of what.
#[test]
fn what_is_not_done_is_data() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/hobbing/undercut_gear.chain");
    let job = Project::open(file, Arc::new(Disk)).job("undercut_gear", &[]).expect("it is right");
    let result = solved((&job).into(), "job_undercut");
    assert!(!result.not_done.is_empty());
    for missing in &result.not_done {
        assert_eq!(missing.kind, NotDoneKind::NotSolved, "{missing}");
        let surface = result.surfaces.iter().find(|one| Some(&one.summary.name) == missing.of.as_ref());
        let surface = surface.expect("it is one of the surfaces");
        assert!(surface.summary.solved < surface.summary.asked);
        let there = surface.statuses().iter().zip(surface.positions());
        for (status, position) in there.filter(|(status, _)| **status == Status::OutOfRange) {
            assert!(position.iter().all(|x| x.is_nan()), "{status:?}");
        }
    }
    for missing in &result.not_done {
        let place = missing.place.as_ref().expect("surfaces have one");
        assert!(place.file.ends_with("spur_gear.chain") && place.line > 1, "{place:?}");
        assert_eq!(Some(&place.text), missing.of.as_ref());
        assert!(missing.message.starts_with("not solved: ") && !missing.message.contains('\n'), "{missing}");
        assert!(!missing.details.is_empty(), "{missing}");
    }
}

/// What is to be known beside a result is data, and a part of its document.
#[test]
fn remarks_are_data() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/hobbing/crowned_gear_quartic.chain");
    let job = Project::open(file, Arc::new(Disk)).job("crowned_gear_quartic", &[]).expect("it is right");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("job_remarks");
    let request = SolveRequest { limits: true, no_picture: true, out, ..SolveRequest::new(&job) };
    let mut results = Vec::new();
    solve(&request, &Unwatched, &mut |result| results.push(result)).expect("it can be solved");
    let remark = results[0].remarks.iter().find(|remark| remark.kind == RemarkKind::LineNotExcluded);
    let remark = remark.expect("the search for lines is given up");
    assert_eq!(remark.of.as_deref(), Some("lower_flank"));
    assert_eq!(remark.place.as_ref().map(|place| place.text.as_str()), Some("lower_flank"));
    let document = serde_json::to_value(&results[0]).expect("JSON");
    let written = document["remarks"].as_array().expect("a list");
    assert!(written.iter().any(|one| one["kind"] == "line_not_excluded" && one["of"] == "lower_flank"), "{written:?}");
    assert!(document.get("timing").is_none(), "the same input gives the same document");
}

/// The points of a surface that has too many to keep are in the files alone.
#[test]
fn a_streamed_surface_keeps_no_points() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/spiral_bevel.chain");
    let set = ["rows", "columns"].map(|name| (name.to_string(), "300".to_string()));
    let job = Project::open(file, Arc::new(Disk)).job("flank", &set).expect("it is right");
    let result = solved((&job).into(), "job_streamed");
    let surface = &result.surfaces[0];
    assert!(surface.is_streamed() && surface.positions().is_empty() && surface.unknowns().is_empty());
    assert_eq!(surface.summary.asked, 90_000);
}

#[test]
fn there_is_no_other_job() {
    let project = project(Arc::new(Disk));
    let Err(Failure::Findings(findings)) = project.job("helical_gaer", &[]) else { panic!("there is none") };
    assert_eq!(findings.list()[0].place.text, "helical_gaer");
    let wrong = [("teeth".to_string(), "many".to_string())];
    assert!(matches!(project.job("helical_gear", &wrong), Err(Failure::Findings(_))));
    let twice = ["30", "31"].map(|value| ("teeth".to_string(), value.to_string()));
    assert!(matches!(project.job("helical_gear", &twice), Err(Failure::Request(_))));
}

/// A job that is asked for alone is made of the same texts as among all jobs of its file, the tables of the others among them: what is
/// written says the same hash.
#[test]
fn the_hash_of_a_job_does_not_depend_on_which_jobs_are_asked_for() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/tutorial/first_gear.chain");
    let text = std::fs::read_to_string(shipped).expect("it is shipped");
    let mut number = 0;
    let lines = text.lines().map(|line| {
        let is_head = line.starts_with("job ") && line.ends_with('{');
        number += u32::from(is_head);
        let table = format!("\n    let bump = curve(\"{number}.csv\", x: length, y: length)");
        format!("{line}{}\n", if is_head { table } else { String::new() })
    });
    let text: String = lines.collect();
    assert!(number > 1, "several jobs");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("job_hash");
    std::fs::create_dir_all(&folder).expect("a folder");
    (1..=number).for_each(|k| {
        std::fs::write(folder.join(format!("{k}.csv")), format!("x,y\n0,0\n{k},1\n")).expect("a table");
    });
    std::fs::write(folder.join("gears.chain"), text).expect("a spec");
    let project = Project::open(folder.join("gears.chain"), Arc::new(Disk));
    let all = project.jobs(&[]).unwrap_or_else(|failure| panic!("{failure}"));
    assert!(all.len() > 1);
    for job in &all {
        let alone = project.job(job.name(), &[]).expect("it is right");
        assert_eq!((alone.hash(), alone.texts()), (job.hash(), job.texts()), "{}", job.name());
        assert_eq!(alone.texts().len(), 1 + number as usize);
    }
}

/// Arrays hold the points of large surfaces too, if that is asked for, and nothing is written without a format.
#[test]
fn arrays_keep_the_points_of_large_surfaces() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/spiral_bevel.chain");
    let set = ["rows", "columns"].map(|name| (name.to_string(), "300".to_string()));
    let job = Project::open(file, Arc::new(Disk)).job("flank", &set).expect("it is right");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("job_nowhere");
    let _ = std::fs::remove_dir_all(&out);
    let more = SolveRequest::new(&job);
    let request =
        SolveRequest { out: out.clone(), format: Vec::new(), no_picture: true, arrays: true, geometry: true, ..more };
    let mut results = Vec::new();
    solve(&request, &Unwatched, &mut |result| results.push(result)).expect("it can be solved");
    assert!(!out.exists(), "no file, no folder");
    let surface = &mut results[0].surfaces[0];
    assert!(!surface.is_streamed());
    let grid = surface.take_grid();
    assert_eq!((grid.counts, grid.positions.len(), grid.statuses.len()), ([300, 300], 90_000, 90_000));
    let k1 = grid.fields.iter().find(|field| field.name == "k1").expect("it is asked for");
    assert!(k1.width == 1 && k1.values.len() == 90_000 && k1.values.iter().all(|x| x.is_finite()));
    let roll = grid.unknown_names.iter().position(|of| of.name == "phi").expect("it is an unknown");
    assert_eq!(grid.unknown(roll)[0], grid.unknowns[roll].to_degrees());
    assert!(surface.positions().is_empty(), "they are taken");
}

/// Surfaces are compared with those of the same job with other values.
#[test]
fn a_reference_may_have_other_values() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/bevel/pinion_19x62.chain");
    let project = Project::open(file, Arc::new(Disk));
    let nominal = project.job("pinion_19x62", &[]).expect("it is right");
    let set = [("m.radial_distance".to_string(), "98 mm".to_string())];
    let other = project.job("pinion_19x62", &set).expect("it is right");
    assert!(nominal.texts() == other.texts() && nominal.hash() != other.hash(), "values are a part of the hash");
    let compared = |job: &flank::Job, reference: &flank::Job| {
        let request = DeviationRequest {
            jobs: job.into(),
            surface: "concave".to_string(),
            reference: Some("concave".to_string()),
            reference_jobs: Some(reference.into()),
            measured: None,
            rows: None,
            columns: None,
            margin: None,
            no_align: true,
            out: Path::new(env!("CARGO_TARGET_TMPDIR")).join("job_reference"),
            format: Vec::new(),
            no_picture: true,
            evaluator: EvaluatorOptions::default(),
        };
        deviation(&request, &Unwatched).expect("both are solved")
    };
    let [there, back] = [compared(&other, &nominal), compared(&nominal, &other)];
    let [there, back] = [there.middle_um, back.middle_um].map(|um| um.expect("they meet"));
    // some um by 0.04 mm of one setting; the second order is far below a hundredth of that
    assert!(there.abs() > 1.0 && (there + back).abs() < 0.01 * there.abs(), "{there} {back}");
    assert!(compared(&nominal, &nominal).rms_um.expect("they meet") < 1e-6);
}

#[test]
fn all_jobs_of_a_spec() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/bevel/ease_off_19x62.chain");
    let jobs = Project::open(file, Arc::new(Disk)).jobs(&[]).expect("they are right");
    assert_eq!(jobs.iter().map(flank::Job::name).collect::<Vec<_>>(), ["pinion", "basic", "conjugate"]);
    let from_job = jobs[0].parameters().iter().filter(|of| of.given_by == ValueSource::Job).count();
    assert!(from_job > 0 && jobs[0].parameters().iter().any(|of| of.range.is_some()));
}
