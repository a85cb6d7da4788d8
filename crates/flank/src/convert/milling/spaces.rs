//! The spaces of the work, in which a milling is repeated.

use std::f64::consts::TAU;

use flank_chain_dsl::{Job, Milling, SolidForm};
use flank_solver::SpacePlace;

use super::distance;
use super::obstacles::Guarded;
use super::patch::Lattice;
use crate::project::failure::Failure;

/// The spaces of the work, and how far it reaches.
pub(super) struct Spaces {
    form: SolidForm,
    /// How many the work has; of a work that says nothing of them, the milled one.
    count: u32,
    /// Why they are not milled by the same poses, in words.
    differ: Option<String>,
    /// The outline of the blank, as z and rho.
    outline: Vec<[f64; 2]>,
}

/// A ball that the work and all that stands on it lie in, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    pub(super) center: [f64; 3],
    pub(super) radius: f64,
}

impl Spaces {
    pub(super) fn of_job(job: &Job<'_>, milling: &Milling<'_>) -> Spaces {
        let solid = job.solids.iter().find(|solid| solid.space.contains(&milling.surface));
        let Some(solid) = solid else {
            return Spaces { form: SolidForm::Turned, count: 1, differ: None, outline: Vec::new() };
        };
        let is_turned = solid.form == SolidForm::Turned;
        let outline = solid.outline.iter().map(|segment| segment.from).filter(|_| is_turned);
        Spaces { form: solid.form, count: solid.teeth, differ: solid.each.clone(), outline: outline.collect() }
    }

    /// That a work has as many spaces as are asked for, all alike.
    ///
    /// # Errors
    /// If it has not.
    pub(super) fn check(job: &Job<'_>, milling: &Milling<'_>, asked: u32) -> Result<(), Failure> {
        if asked <= 1 {
            return Ok(());
        }
        let refused = |why: String| Err(Failure::Request(format!("option `spaces {asked}`: {why}")));
        let name = &job.surfaces[milling.surface].name;
        if !job.solids.iter().any(|solid| solid.space.contains(&milling.surface)) {
            return refused(format!("nothing says how many spaces the work has: name {name} in a `solid` of the job"));
        }
        let spaces = Spaces::of_job(job, milling);
        match spaces.differ {
            Some(each) => refused(format!("the spaces of the work differ by `{each}`: mill them one by one")),
            None if asked > spaces.count => refused(format!("the work has {}", spaces.count)),
            None => Ok(()),
        }
    }

    /// Where a space stands as seen from the milled one.
    pub(super) fn place(&self, space: u32) -> SpacePlace {
        match self.form {
            SolidForm::Turned => SpacePlace { turn: TAU * f64::from(space) / f64::from(self.count), shift: 0.0 },
            SolidForm::Extruded { pitch } => SpacePlace { turn: 0.0, shift: pitch * f64::from(space) },
        }
    }

    /// All that one milling is repeated in: where they differ, the milled one alone.
    pub(super) fn alike(&self) -> Vec<SpacePlace> {
        if self.differ.is_some() { vec![SpacePlace::default()] } else { self.places() }
    }

    /// All of them.
    pub(super) fn places(&self) -> Vec<SpacePlace> {
        (0..self.count).map(|space| self.place(space)).collect()
    }

    /// What holds the milled surface and what the cutter keeps clear of, in all spaces, and the blank.
    pub(super) fn hull(&self, lattice: &Lattice, guarded: &[Guarded<'_>]) -> Hull {
        let milled = lattice.frames.iter().map(|frame| frame.position);
        let kept = guarded.iter().filter(|of| !of.is_fixture).flat_map(|of| of.kept.obstacle.points().iter().copied());
        let points: Vec<[f64; 3]> = milled.chain(kept).collect();
        let at = |place: SpacePlace, [x, y, z]: [f64; 3]| {
            let [x, y, z, ..] = place.placed(&[x, y, z, 0.0, 0.0, 1.0]);
            [x, y, z]
        };
        let ends = [0, self.count - 1].map(|space| self.place(space));
        let places = if self.form == SolidForm::Turned { self.places() } else { ends.to_vec() };
        let mut all: Vec<[f64; 3]> =
            places.iter().flat_map(|place| points.iter().map(|point| at(*place, *point))).collect();
        all.extend(self.outline.iter().flat_map(|[z, rho]| [[*rho, 0.0, *z], [-rho, 0.0, *z]]));
        let fixtures = guarded.iter().filter(|of| of.is_fixture);
        all.extend(fixtures.flat_map(|of| of.kept.obstacle.points().iter().copied()));
        let ends = |k: usize| {
            let values = all.iter().map(|point| point[k]);
            [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
        };
        let center = [0, 1, 2].map(|k| ends(k).iter().sum::<f64>() / 2.0);
        let away = |[x, y, z]: &[f64; 3]| {
            let [a, b, c] = center;
            distance(&[*x, *y, *z, 0.0, 0.0, 0.0], &[a, b, c, 0.0, 0.0, 0.0])
        };
        Hull { center, radius: all.iter().map(away).fold(0.0, f64::max) }
    }
}
