//! Points that a surface shall go through: measured ones, or those of another surface with an ease-off.

use std::path::Path;

use flank_chain_dsl::Job;
use flank_solver::{Alignment, NearFoot, Outcome, SurfacePoint};

use crate::compare::deviation;
use crate::compare::gauged::{Gauged, GaugedArea};
use crate::compare::map::{Named, find};
use crate::compare::measure::Placed;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::{FitRequest, WantedEaseOff};
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::solve;
use crate::solve::centre::Centre;
use crate::solve::starts::{Asked, Starts};

/// Where a surface shall be.
pub(super) struct Aim<'j, 'g> {
    pub(super) of: Named<'j, 'g>,
    /// What says so.
    pub(super) wanted: String,
    pub(super) counts: [usize; 2],
    /// Row by row.
    pub(super) points: Vec<Option<Aimed>>,
    /// Why points are missing.
    pub(super) missing: Vec<NotDone>,
    measured: Option<Gauged>,
    /// By which the points lie nearer to the surface.
    motion: f64,
}

/// A point with a place of the surface nearby.
#[derive(Clone)]
pub(super) struct Aimed {
    /// mm
    pub(super) position: [f64; 3],
    /// Of the surface.
    pub(super) near: NearFoot,
}

impl<'j, 'g> Aim<'j, 'g> {
    /// # Errors
    /// What is wrong with the file, or why the surface has no grid.
    pub(super) fn measured(
        of: Named<'j, 'g>,
        file: &Path,
        (request, session): (&FitRequest, Session<'_>),
        origin: &mut Origin,
    ) -> Result<Aim<'j, 'g>, Failure> {
        let area = GaugedArea { rows: request.rows, columns: request.columns, margins: request.margins() };
        let gauged = Gauged::read(of, (request.jobs.project.files(), file), area, session, origin)?;
        let aimed = |(nominal, position): (&SurfacePoint, &Option<[f64; 3]>)| {
            let position = (*position).filter(|_| nominal.outcome == Outcome::Solved)?;
            let off = (0..3).map(|k| (position[k] - nominal.position[k]) * nominal.normal[k]).sum();
            Some(Aimed { position, near: NearFoot { unknowns: nominal.unknowns.clone(), distance: off } })
        };
        let motion = of.alignment().median(&gauged.positions, &gauged.nominal).unwrap_or(0.0);
        let (all, name) = (gauged.nominal.len(), &of.surface.name);
        let unsolved = gauged.nominal.iter().filter(|point| point.outcome != Outcome::Solved).count();
        let left_out = gauged.positions.iter().filter(|position| position.is_none()).count() - unsolved.min(all);
        let counted = [
            (unsolved, NotDoneKind::NotSolved, format!("not solved: {unsolved} of {all} nominal points of {name}")),
            (left_out, NotDoneKind::NotMeasured, format!("not measured: {left_out} of {all} points of {name}")),
        ];
        let missing = counted.into_iter().filter(|(count, ..)| *count > 0);
        Ok(Aim {
            of,
            wanted: gauged.shown.clone(),
            counts: gauged.counts,
            points: gauged.nominal.iter().zip(&gauged.positions).map(aimed).collect(),
            missing: missing.map(|(_, kind, message)| NotDone::new(kind, name, message)).collect(),
            measured: Some(gauged),
            motion,
        })
    }

    /// # Errors
    /// If there is no such surface, one of both has no points or several branches, or they do not meet.
    pub(super) fn ease_off(
        of: Named<'j, 'g>,
        from: &str,
        jobs: &'j [Job<'g>],
        (request, session): (&FitRequest, Session<'_>),
        origin: &mut Origin,
    ) -> Result<Aim<'j, 'g>, Failure> {
        let from = find(jobs, from)?;
        let table = match &request.ease_off_table {
            Some(file) => {
                let area = GaugedArea { rows: request.rows, columns: request.columns, margins: request.margins() };
                Some(Gauged::read(from, (request.jobs.project.files(), file), area, session, origin)?)
            }
            None => None,
        };
        let margins = if table.is_some() { request.margins() } else { [0.0; 2] };
        let placed = Placed::new(from.job, from.surface, margins, session)?;
        let counts = table.as_ref().map_or_else(|| placed.counts(), |table| table.counts);
        let [profile, length] = placed.shares(counts);
        let sample = placed.sample(&profile, &length);
        let asked = Asked::with_centre(&sample);
        let points = placed.solved(&Centre::of_sample(&sample).0)?;
        let starts = Starts::beside(of.surface, (&asked, &points), of.alignment());
        let (near, lost) = deviation::solved(of, (&starts.coordinates, &starts.targets, asked.counts), session);
        if let Some(lost) = lost {
            return Err(Failure::NotDone(vec![lost]));
        }
        let deviation = flank_solver::Deviation::new(&solve::bound(of.job, of.surface), of.alignment())
            .expect("a job without errors leaves nothing unbound");
        let middle = asked.centre.middle();
        let motion = deviation.motion_to(points[middle].position, &near[middle]).unwrap_or(0.0);
        let [points, near] = [points, near].map(|points| asked.centre.own(&points));
        let wished = |at: usize, point: &SurfacePoint| match &table {
            Some(table) => {
                let wanted = table.positions[at]?;
                Some((0..3).map(|k| (wanted[k] - point.position[k]) * point.normal[k]).sum())
            }
            None => Some(1e-3 * request.ease_off?.at([at / counts[1], at % counts[1]], counts)),
        };
        let aimed = |(at, (point, near)): (usize, (&SurfacePoint, &SurfacePoint))| {
            let are_solved = [point, near].iter().all(|of| of.outcome == Outcome::Solved);
            let off: f64 = wished(at, point)?;
            let position = std::array::from_fn(|k| point.position[k] + off * point.normal[k]);
            are_solved.then(|| Aimed { position, near: NearFoot { unknowns: near.unknowns.clone(), distance: off } })
        };
        let aimed: Vec<Option<Aimed>> = points.iter().zip(&near).enumerate().map(aimed).collect();
        let all = points.iter().enumerate().filter(|(at, point)| wished(*at, point).is_some()).count();
        let lost = all.saturating_sub(aimed.iter().flatten().count());
        let name = of.whole_name();
        let message = format!("not solved: {lost} of {all} points of {} or of {name} beside them", from.whole_name());
        let missing = (lost > 0).then(|| NotDone::new(NotDoneKind::NotSolved, &of.surface.name, message));
        Ok(Aim {
            of,
            wanted: from.whole_name(),
            counts,
            points: aimed,
            missing: missing.into_iter().collect(),
            measured: None,
            motion: -motion,
        })
    }

    /// The motion that brings the points of all near to their surfaces, to begin with.
    pub(super) fn first_motion(aims: &[Aim<'_, '_>]) -> f64 {
        let measured: Vec<&Gauged> = aims.iter().filter_map(|aim| aim.measured.as_ref()).collect();
        let positions: Vec<Option<[f64; 3]>> = measured.iter().flat_map(|of| of.positions.iter().copied()).collect();
        let nominal: Vec<SurfacePoint> = measured.iter().flat_map(|of| of.nominal.iter().cloned()).collect();
        let median = aims.first().and_then(|aim| aim.of.alignment().median(&positions, &nominal));
        median.unwrap_or(aims.first().map_or(0.0, |aim| aim.motion))
    }

    /// What measured points look as if, where they lie beside their places.
    pub(super) fn mounted(&self) -> Option<String> {
        let of = self.measured.as_ref().filter(|_| self.of.alignment() == Alignment::Turn)?;
        of.mounted()
    }

    /// # Errors
    /// If a measured point, moved by so much, does not belong to its place.
    pub(super) fn check_places(&self, motion: f64) -> Result<(), Failure> {
        self.measured.iter().try_for_each(|of| of.check_places(self.of, motion))
    }
}

impl WantedEaseOff {
    /// In a row and a column of so many, um.
    pub(super) fn at(&self, place: [usize; 2], counts: [usize; 2]) -> f64 {
        let share = |k: usize| match counts[k] {
            0 | 1 => 0.0,
            count => 2.0 * place[k] as f64 / (count - 1) as f64 - 1.0,
        };
        let [v, u] = [share(0), share(1)];
        let ([along_v, along_u], [crown_v, crown_u]) = (self.slopes, self.crownings);
        0.5 * (along_v * v + along_u * u) - crown_v * v * v - crown_u * u * u + 0.25 * self.bias * v * u
    }
}
