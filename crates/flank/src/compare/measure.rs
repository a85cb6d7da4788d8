//! `flank measure`: nominal points and normals for gear measuring machines.

use std::collections::BTreeMap;

use flank_chain_dsl::{GeneratedSurface, Job, Sample, SampleGrid, spaced};
use flank_export::{Axis, FlankEnds, Hand, MeasuringGrid, NominalFlank, NominalPart, Patch, Point};
use flank_expr::Graph;
use flank_solver::SurfacePoint;

use crate::compare::map::find;
use crate::compare::measure_result::{MeasureResult, MeasuredFlank, MeasuredPart, MiddlePoint};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::MeasureRequest;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::solve;
use crate::solve::Branch;
use crate::solve::SolveOptions;
use crate::solve::arrays::PointGrid;

/// Rows and columns of the grid that shows how a flank lies.
const TRIAL: usize = 13;

/// Writes nominal points and normals of surfaces for measuring machines. `each` is given the result of each job.
///
/// # Errors
/// What is wrong with the spec; that a surface that is named has no grid, or several branches, or that none of a job has one; that a file
/// cannot be written.
pub fn measure(
    request: &MeasureRequest,
    monitor: &dyn Monitor,
    each: &mut dyn FnMut(MeasureResult),
) -> Result<(), Failure> {
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let named = request.surface.iter().map(|name| find(&jobs, name)).collect::<Result<Vec<_>, String>>()?;
    let session = Session::new(request.evaluator, monitor);
    for job in solve::asked((&jobs, &origin), monitor)? {
        let is_meant = |surface: &&GeneratedSurface<'_>| match named.is_empty() {
            true => surface.sample.is_some(),
            false => named.iter().any(|of| of.job.name == job.name && of.surface.name == surface.name),
        };
        let meant: Vec<&GeneratedSurface<'_>> = job.surfaces.iter().filter(is_meant).collect();
        if meant.is_empty() {
            continue;
        }
        let mut taken = Taken::default();
        for surface in &meant {
            match flank(job, surface, (request, session)) {
                Ok(flank) => taken.flanks.push(flank),
                Err(reason) if named.is_empty() => taken.leave(&surface.name, reason)?,
                Err(reason) => return Err(reason),
            }
        }
        let Taken { flanks, left, unknown } = taken;
        if flanks.is_empty() {
            return Err(none(left, unknown));
        }
        let header = solve::header(&[job], &request.jobs, &origin);
        let grid = MeasuringGrid { header, margins: request.margins(), flanks };
        let mut folder = Folder::at(&request.out, &origin, monitor);
        for format in &request.format {
            folder.grid(&format!("{}.grid", job.name), &grid, *format)?;
        }
        let not_done = origin.located(&[job], unknown.into_iter().chain(unsolved(&grid)).collect());
        let remarks = origin.located(&[job], left);
        each(MeasureResult { remarks, not_done, ..result(&grid, folder.finish()?) });
    }
    Ok(())
}

/// The surfaces of a job, where all that are sampled are meant.
#[derive(Default)]
struct Taken {
    flanks: Vec<NominalFlank>,
    /// Those that have no grid.
    left: Vec<Remark>,
    /// Those of which nobody knows which branch is meant.
    unknown: Vec<NotDone>,
}

impl Taken {
    /// # Errors
    /// What ends the work on the other surfaces, too.
    fn leave(&mut self, name: &str, reason: Failure) -> Result<(), Failure> {
        match reason {
            Failure::Input(reason) => {
                let message = format!("{name} is not measured: {reason}");
                self.left.push(Remark::new(RemarkKind::NoGrid, name, message));
            }
            Failure::NotDone(branches) => self.unknown.extend(branches),
            other => return Err(other),
        }
        Ok(())
    }
}

/// Why nothing of a job is measured.
fn none(left: Vec<Remark>, unknown: Vec<NotDone>) -> Failure {
    match unknown.is_empty() {
        true => Failure::Input(left.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
        false => Failure::NotDone(unknown),
    }
}

/// How the measuring grid of a surface lies in its sample.
pub(crate) struct Placed<'j, 'g> {
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &'j Sample<'g>,
    ends: FlankEnds,
    margins: [f64; 2],
    /// Its branch, where the middle of the sample tells it.
    branch: Option<Branch<'g>>,
    session: Session<'j>,
}

impl<'j, 'g> Placed<'j, 'g> {
    /// # Errors
    /// If the surface is not sampled, several of its branches qualify, or its sample does not tell root and tip from the length of the
    /// tooth.
    pub(crate) fn new(
        job: &'j Job<'g>,
        surface: &'j GeneratedSurface<'g>,
        margins: [f64; 2],
        session: Session<'j>,
    ) -> Result<Placed<'j, 'g>, Failure> {
        let name = &surface.name;
        let sample = surface.sample.as_ref().ok_or(format!(
            "`{name}` is not sampled: its sample says where it is measured; add `sample {name} {{ … }}`"
        ))?;
        if let SampleGrid::Points(_) = sample.grid {
            return Err(Failure::from(format!(
                "`{name}` is sampled at the points of a table: a grid needs an area, which a sample of two coordinates has"
            )));
        }
        if let Some(k) = sample.counts.iter().position(|count| *count < 2) {
            return Err(Failure::from(format!(
                "`{name}` is sampled at one value of `{}` only: a grid needs an area between two",
                sample.labels[k]
            )));
        }
        let shares = spaced((0.0, 1.0), TRIAL);
        let trial = lattice(sample, false, [&shares, &shares]);
        let axes = [0, 1].map(|k| Axis { label: sample.labels[k].clone(), count: TRIAL });
        // what is cut away lies between the same ends
        let mut found = solve::untrimmed(job, surface, &trial, session);
        let branch = found.branch(&trial);
        if branch.is_none() {
            found = solve::points(job, surface, &trial, wanted(session));
        }
        if let Some(branches) = found.ambiguous(surface, &trial) {
            return Err(Failure::NotDone(vec![branches]));
        }
        let patch = solve::patch(job, name, surface, axes, &found.points);
        let ends = FlankEnds::of_patch(&patch).ok_or(format!(
            "the grid of `{name}` does not tell root and tip from the length of the tooth; a sample between the corners of the blank \
             does: `toe_root: [z, rho]`, …"
        ))?;
        Ok(Placed { job, surface, sample, ends, margins, branch, session })
    }

    /// Points at shares from root to tip and along the tooth.
    pub(crate) fn sample(&self, profile: &[f64], length: &[f64]) -> Sample<'g> {
        let FlankEnds { rows_are_profile, reversed, .. } = self.ends;
        let labels = [&self.ends.profile, &self.ends.length].map(|[from, to]| format!("{from} -> {to}"));
        let along = |shares: &[f64], back: bool| -> Vec<f64> {
            shares.iter().map(|share| if back { 1.0 - share } else { *share }).collect()
        };
        let [v, u] = [along(profile, reversed[0]), along(length, reversed[1])];
        let placed = lattice(self.sample, !rows_are_profile, [&v, &u]);
        Sample { labels, ..placed }
    }

    /// The shares of so many rows and columns within the margins.
    pub(crate) fn shares(&self, counts: [usize; 2]) -> [Vec<f64>; 2] {
        [0, 1].map(|k| within(self.margins[k], counts[k]))
    }

    /// So many rows and columns as the sample has.
    pub(crate) fn counts(&self) -> [usize; 2] {
        let [rows, columns] = self.sample.counts;
        if self.ends.rows_are_profile { [rows, columns] } else { [columns, rows] }
    }

    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn solved(&self, sample: &Sample<'g>) -> Result<Vec<SurfacePoint>, Failure> {
        let _working = self.session.begin(format!("solving {}", self.surface.name))?;
        // of other numbers of points none lies in the middle
        let branch = self.branch.as_ref().filter(|_| sample.counts.iter().all(|count| count % 2 == 1));
        let known =
            branch.and_then(|branch| solve::points_of_branch(self.job, self.surface, (sample, branch), self.session));
        Ok(known.unwrap_or_else(|| solve::points(self.job, self.surface, sample, wanted(self.session)).points))
    }

    fn part(&self, counts: [usize; 2]) -> Result<Patch, Failure> {
        let [profile, length] = self.shares(counts);
        let sample = self.sample(&profile, &length);
        let axes = [0, 1].map(|k| Axis { label: sample.labels[k].clone(), count: sample.counts[k] });
        let points = self.solved(&sample)?;
        Ok(solve::patch(self.job, &self.surface.name, self.surface, axes, &points))
    }
}

/// Points alone.
fn wanted(session: Session<'_>) -> SolveOptions<'_> {
    SolveOptions {
        geometry: false,
        sensitivity: false,
        certificates: false,
        together: None,
        arrays: false,
        of_shown: false,
        session,
    }
}

/// So many shares from end to end, without the margins.
fn within(margin: f64, count: usize) -> Vec<f64> {
    spaced((0.0, 1.0), count).into_iter().map(|share| margin + (1.0 - 2.0 * margin) * share).collect()
}

/// Points of a sample's area at shares of the way along its rows and its columns; `across`: along its columns and its rows.
fn lattice<'g>(sample: &Sample<'g>, across: bool, shares: [&[f64]; 2]) -> Sample<'g> {
    let [a, b] = sample.coordinates.clone();
    let (coordinates, grid) = match (&sample.grid, across) {
        (SampleGrid::Values([rows, columns]), false) => ([a, b], SampleGrid::Values(between([rows, columns], shares))),
        (SampleGrid::Values([rows, columns]), true) => ([b, a], SampleGrid::Values(between([columns, rows], shares))),
        (SampleGrid::Shares { shares: [rows, columns], corners }, false) => {
            ([a, b], SampleGrid::Shares { shares: between([rows, columns], shares), corners: *corners })
        }
        (SampleGrid::Shares { shares: [rows, columns], corners: [toe_root, heel_root, toe_tip, heel_tip] }, true) => {
            let corners = [*toe_root, *toe_tip, *heel_root, *heel_tip];
            ([a, b], SampleGrid::Shares { shares: between([columns, rows], shares), corners })
        }
        // a list has no area, and is refused before
        (SampleGrid::Points(points), _) => ([a, b], SampleGrid::Points(points.clone())),
    };
    Sample { coordinates, counts: shares.map(<[f64]>::len), grid, ..sample.clone() }
}

/// From the first value to the last.
fn between(values: [&Vec<f64>; 2], shares: [&[f64]; 2]) -> [Vec<f64>; 2] {
    [0, 1].map(|k| {
        let (Some(first), Some(last)) = (values[k].first(), values[k].last()) else { return Vec::new() };
        shares[k].iter().map(|share| (1.0 - share) * first + share * last).collect()
    })
}

fn flank<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    (request, session): (&MeasureRequest, Session<'_>),
) -> Result<NominalFlank, Failure> {
    let placed = Placed::new(job, surface, request.margins(), session)?;
    let grid = placed.part([request.rows as usize, request.columns as usize])?;
    let hand = Hand::of_grid(&grid);
    let mut parts = vec![(NominalPart::Grid, grid)];
    if let Some(count) = request.lines {
        let count = count as usize;
        parts.extend([(NominalPart::Profile, placed.part([count, 1])?), (NominalPart::Lead, placed.part([1, count])?)]);
    }
    parts.push((NominalPart::Middle, placed.part([1, 1])?));
    Ok(NominalFlank { hand, ends: placed.ends, parts })
}

fn solved(patch: &Patch) -> usize {
    patch.points.iter().filter(|point| is_solved(point)).count()
}

fn is_solved(point: &Point) -> bool {
    point.outcome == flank_export::Outcome::Solved
}

fn middle(flank: &NominalFlank) -> Option<MiddlePoint> {
    let (_, patch) = flank.parts.iter().find(|(part, _)| *part == NominalPart::Middle)?;
    let [x, y, z] = patch.points.first().filter(|point| is_solved(point))?.position;
    Some(MiddlePoint { rho_mm: x.hypot(y), z_mm: z, angle_deg: y.atan2(x).to_degrees() })
}

fn result(grid: &MeasuringGrid, files: Vec<String>) -> MeasureResult {
    let part = |(part, patch): &(NominalPart, Patch)| MeasuredPart {
        part: (*part).into(),
        rows: patch.rows.count,
        columns: patch.columns.count,
        asked: patch.points.len(),
        solved: solved(patch),
    };
    let flank = |flank: &NominalFlank| {
        let (_, first) = flank.parts.first()?;
        Some(MeasuredFlank {
            surface: first.name.clone(),
            frame: first.frame.clone(),
            flank: flank.hand.map(Into::into),
            rows: flank.ends.profile.clone(),
            columns: flank.ends.length.clone(),
            parts: flank.parts.iter().map(part).collect(),
            middle: middle(flank),
        })
    };
    MeasureResult {
        job: grid.header.job.clone(),
        spec: grid.header.spec.clone(),
        margins: grid.margins,
        flanks: grid.flanks.iter().filter_map(flank).collect(),
        files,
        remarks: Vec::new(),
        not_done: Vec::new(),
        grids: grid.flanks.iter().flat_map(|flank| &flank.parts).map(|(_, patch)| PointGrid::of_patch(patch)).collect(),
    }
}

/// Which points are not there, and why; empty if all are.
fn unsolved(grid: &MeasuringGrid) -> Vec<NotDone> {
    let parts = grid.flanks.iter().flat_map(|flank| &flank.parts);
    parts.filter_map(|(part, patch)| unsolved_in(*part, patch)).collect()
}

fn unsolved_in(part: NominalPart, patch: &Patch) -> Option<NotDone> {
    let mut reasons: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (at, point) in patch.points.iter().enumerate().filter(|(_, point)| !is_solved(point)) {
        let reason = format!("{} {}", point.outcome.word(), point.reason).trim_end().to_string();
        let place = format!("({}, {})", at / patch.columns.count + 1, at % patch.columns.count + 1);
        reasons.entry(reason).or_default().push(place);
    }
    let (missing, all) = (patch.points.len() - solved(patch), patch.points.len());
    let (name, part) = (&patch.name, part.word());
    let told = reasons.iter().map(|(reason, places)| format!("{reason}: {}", places.join(" "))).collect();
    let message = format!("not solved: {missing} of {all} points of {name}, {part} (row, column)");
    (missing > 0).then(|| NotDone::new(NotDoneKind::NotSolved, name, message).with(told))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_odd_grid_is_the_middle() {
        assert_eq!(within(0.1, 5), [0.1, 0.30000000000000004, 0.5, 0.7000000000000001, 0.9]);
        assert_eq!(within(0.1, 1), [0.5]);
    }
}
