//! Surfaces that corrected settings leave where they are.

use flank_chain_dsl::{Job, Parameter};
use flank_solver::{AdjustableSurface, NearFoot, Outcome};

use super::aim::Aimed;
use super::problem::adjustable;
use super::result::KeptSurface;
use crate::compare::deviation_result::GridPlace;
use crate::compare::map::Named;
use crate::project::failure::Failure;
use crate::project::requests::{FitRequest, KeptPlace};
use crate::project::session::Session;
use crate::solve::centre::Centre;
use crate::solve::{self, SolveOptions};

/// A surface with the points of it that stay.
pub(super) struct Keep {
    pub(super) surface: AdjustableSurface,
    pub(super) points: Vec<Aimed>,
    name: String,
    place: KeptPlace,
    /// Where no point is the mean point.
    stand_in: Option<GridPlace>,
}

/// Those that are asked for.
///
/// # Errors
/// If one is not there, has no grid, or is not solved where it is to be kept.
pub(super) fn keeps<'g>(
    job: &Job<'g>,
    settings: &[&Parameter<'g>],
    request: &FitRequest,
    session: Session<'_>,
) -> Result<Vec<Keep>, Failure> {
    request.keep.iter().map(|(name, place)| Keep::new(job, settings, (name, *place), session)).collect()
}

impl Keep {
    fn new<'g>(
        job: &Job<'g>,
        settings: &[&Parameter<'g>],
        (name, place): (&str, KeptPlace),
        session: Session<'_>,
    ) -> Result<Keep, Failure> {
        let of = job.surfaces.iter().find(|surface| surface.name == name).ok_or_else(|| {
            let known: Vec<String> = job.surfaces.iter().map(|surface| format!("`{}`", surface.name)).collect();
            Failure::Input(format!(
                "option `keep` names `{name}`, which is no surface of job `{}`; there is: {}",
                job.name,
                known.join(", ")
            ))
        })?;
        let sample = of.sample.as_ref().ok_or_else(|| {
            Failure::Input(format!(
                "option `keep` names `{name}`, which is not sampled: its sample says where it stays; add `sample {name} {{ … }}`"
            ))
        })?;
        let _working = session.begin(format!("solving {name}"))?;
        let options = SolveOptions {
            geometry: false,
            sensitivity: false,
            certificates: false,
            together: None,
            arrays: false,
            of_shown: false,
            session,
        };
        let (sample, centre) = Centre::of_sample(sample);
        let points = solve::points(job, of, &sample, options).points;
        let places = match place {
            KeptPlace::Middle => vec![centre.middle()],
            KeptPlace::Line => centre.ends()[1].to_vec(),
        };
        if places.iter().any(|at| points[*at].outcome != Outcome::Solved) {
            let message =
                format!("`{name}` is not solved where option `keep` would leave it: look at it with `flank solve`");
            return Err(Failure::Unsolved(message));
        }
        let aimed = |at: &usize| Aimed {
            position: points[*at].position,
            near: NearFoot { unknowns: points[*at].unknowns.clone(), distance: 0.0 },
        };
        let stand_in = centre.stand_in().map(GridPlace::of);
        let surface = adjustable(Named { job, surface: of }, settings);
        Ok(Keep { surface, points: places.iter().map(aimed).collect(), name: name.to_string(), place, stand_in })
    }
}

/// What is told of them, from what is left at their points, mm.
pub(super) fn told(keeps: &[Keep], left: &[f64]) -> Vec<KeptSurface> {
    let mut rest = left;
    let one = |keep: &Keep| {
        let (own, others) = rest.split_at(keep.points.len().min(rest.len()));
        rest = others;
        KeptSurface {
            surface: keep.name.clone(),
            is_line: keep.place == KeptPlace::Line,
            at: keep.stand_in.filter(|_| keep.place == KeptPlace::Middle),
            off_um: 1e3 * own.iter().fold(0.0, |most: f64, off| most.max(off.abs())),
        }
    };
    keeps.iter().map(one).collect()
}
