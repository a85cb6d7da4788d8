//! What a spec derived once, as text beside it.

mod angles;
mod compare;
mod text;

use std::path::{Path, PathBuf};

use crate::project::failure::Failure;
use crate::project::files::write_texts;
use crate::project::shown_path;
use crate::solve::cut;
use crate::testing::points::Tested;
use crate::testing::request::TestRequest;
use crate::testing::result::{TestedSnapshot, TestedSpec};
use text::{Kept, KeptSurface};

/// Rows and columns of a sample that are kept.
const MOST_LINES: usize = 4;
/// Bytes of a snapshot that are read.
const MOST_BYTES: usize = 1 << 24;

/// The snapshot of a spec: beside it, with its own ending.
fn beside(spec: &Path) -> PathBuf {
    spec.with_extension("snapshot")
}

/// Whether a spec is compared with its snapshot, or would be if it had one that is proposed.
pub(super) fn is_compared(request: &TestRequest) -> bool {
    let is_asked = request.filter.is_none() && (request.snapshot || request.propose);
    is_asked && (request.propose || request.project.files().exists(&beside(request.project.file())))
}

/// What differs from the snapshot of a spec; nothing if it has none, unless one is proposed. What is filtered is not compared: a snapshot
/// is one of all jobs.
///
/// # Errors
/// If the work is cancelled.
pub(super) fn compared(request: &TestRequest, jobs: &[Tested<'_, '_>]) -> Result<Option<TestedSnapshot>, Failure> {
    if !is_compared(request) {
        return Ok(None);
    }
    let path = beside(request.project.file());
    let files = request.project.files();
    let file = shown_path(&path);
    let is_there = files.exists(&path);
    let now: Vec<KeptSurface> = jobs.iter().flat_map(kept).collect();
    let text = text::written(&shown_path(Path::new(path.file_stem().unwrap_or_default())), &now);
    let found = |differences: Vec<String>, picture| TestedSnapshot {
        file: file.clone(),
        is_same: differences.is_empty(),
        text: (!differences.is_empty()).then(|| text.clone()),
        differences,
        is_accepted: false,
        picture,
    };
    if !is_there {
        return Ok(Some(found(vec!["there is no snapshot yet".to_string()], None)));
    }
    let before = match files.real_path(&path).and_then(|real| files.read(&real, MOST_BYTES)) {
        // tools that keep versions of texts may change the ends of their lines
        Ok(before) => before.replace("\r\n", "\n"),
        Err(error) => return Ok(Some(found(vec![format!("cannot read it: {error}")], None))),
    };
    if before == text {
        return Ok(Some(found(Vec::new(), None)));
    }
    let (differences, picture) = match text::read(&before) {
        Ok(before) => compare::told(jobs, (&before, &now), &request.project)?,
        Err(why) => (vec![why.told()], None),
    };
    Ok(Some(found(differences, picture)))
}

/// Writes the snapshot that a tested spec would have now, and holds it for accepted; its path, if anything differed.
///
/// # Errors
/// What stands in the way.
pub fn accept_snapshot(tested: &mut TestedSpec) -> Result<Option<String>, Failure> {
    let Some(snapshot) = &mut tested.snapshot else { return Ok(None) };
    let Some(text) = &snapshot.text else { return Ok(None) };
    let path = Path::new(&snapshot.file);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    write_texts(folder, &[(name, text.clone())], &[])?;
    snapshot.is_accepted = true;
    Ok(Some(snapshot.file.clone()))
}

/// The surfaces of a job as they are kept.
fn kept(tested: &Tested<'_, '_>) -> Vec<KeptSurface> {
    let of_surface = |(index, surface): (usize, &flank_chain_dsl::GeneratedSurface<'_>)| {
        let sample = surface.sample.as_ref()?;
        let points = tested.points(index);
        let left = cut::heights(tested.job, surface, points, tested.session);
        let [rows, columns] = sample.counts.map(lines);
        let places = rows.iter().flat_map(|row| columns.iter().map(move |column| (*row, *column)));
        let points = places.map(|(row, column)| {
            let point = &points[row * sample.counts[1] + column];
            Kept {
                at: sample.grid.at(row, column),
                status: point.outcome.word().to_string(),
                position: point.position,
                normal: point.normal,
                unknowns: point.unknowns.clone(),
                left: left.as_ref().and_then(|left| left[row * sample.counts[1] + column]).unwrap_or(f64::NAN),
            }
        });
        Some(KeptSurface {
            job: tested.job.name.clone(),
            name: surface.name.clone(),
            frame: surface.frame.clone(),
            coordinates: sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone()),
            unknowns: surface.unknowns.iter().map(|unknown| unknown.name.clone()).collect(),
            counts: [rows.len(), columns.len()],
            solved: tested.points(index).iter().filter(|point| point.outcome.word() == "solved").count(),
            asked: tested.points(index).len(),
            cut_by: surface.cut_by.map(|by| tested.surface(by).name.clone()),
            work: tested.work(index),
            points: points.collect(),
        })
    };
    tested.job.surfaces.iter().enumerate().filter_map(of_surface).collect()
}

/// So many of some lines, evenly, both ends among them.
fn lines(count: usize) -> Vec<usize> {
    if count <= MOST_LINES {
        return (0..count).collect();
    }
    (0..MOST_LINES).map(|k| k * (count - 1) / (MOST_LINES - 1)).collect()
}
