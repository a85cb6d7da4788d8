//! `flank fit`: from a measured or a wanted flank to settings.

mod aim;
pub(super) mod corrected;
mod fitting;
mod keep;
mod mounting;
mod outliers;
mod problem;
pub(crate) mod result;
pub(super) mod settings;
mod text;
mod verdict;
mod words;

use std::time::Instant;

use flank_expr::Graph;
use flank_solver::AdjustedSurfaces;

use self::aim::Aim;
use self::fitting::Fitting;
use self::problem::Problem;
use self::result::{FitResult, SettingsChoice};
use crate::compare::map::{Named, find};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::requests::FitRequest;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::spec::Origin;

/// Looks for the settings with which a surface comes nearest to measured points, or to another surface with a wanted ease-off, and for
/// those that correct it.
///
/// # Errors
/// What is wrong with the spec or the measured points; what does not go together; that there are fewer points than settings; that a file
/// cannot be written.
pub fn fit(request: &FitRequest, monitor: &dyn Monitor) -> Result<FitResult, Failure> {
    let start = Instant::now();
    check(request)?;
    let graph = Graph::new();
    let among = request.from.as_ref().filter(|_| request.from_jobs.is_none());
    let surfaces: Vec<&str> = [&request.surface].into_iter().chain(among).map(String::as_str).collect();
    let (compilation, jobs) = spec::jobs_of_surfaces(&graph, &request.jobs, &surfaces, monitor)?;
    let mut origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor);
    let of = find(&jobs, &request.surface)?;
    let other_graph = Graph::new();
    let others = request.from_jobs.as_ref().map(|others| spec::jobs(&other_graph, others, monitor)).transpose()?;
    let among = others.as_ref().map_or(&jobs, |(_, others)| others);
    let aims = match (&request.measured, request.is_wish(), &request.from) {
        (Some(file), ..) => {
            let first = Aim::measured(of, file, (request, session), &mut origin)?;
            let second = request.and.iter().map(|(name, file)| {
                let of = of_same_job(of, find_in(of, name)?);
                Aim::measured(of, file, (request, session), &mut origin)
            });
            let second = second.collect::<Result<Vec<_>, Failure>>()?;
            [first].into_iter().chain(second).collect()
        }
        (None, true, Some(from)) => vec![Aim::ease_off(of, from, among, (request, session), &mut origin)?],
        _ => return Err(Failure::Request(NO_AIM.to_string())),
    };
    let open = settings::open(of.job, &request.vary)?;
    if let Some(error) = open.iter().find(|setting| setting.is_error && request.is_wish()) {
        let message = format!(
            "option `vary` names `{}`, an error of the machine: a wanted ease-off is made by what can be set",
            error.name
        );
        return Err(Failure::Input(message));
    }
    let _working = session.begin(format!("fitting {}", of.surface.name))?;
    let keeps = keep::keeps(of.job, &open, request, session)?;
    let problem = Problem::new(&aims, open, keeps, request)?;
    let Found { now, free, choice, identification, correction } = Found::of(&aims, &problem, request)?;
    let fitting = Fitting { aims: &aims, problem: &problem, now: &now };
    let result = fitting.result(request, (&free, choice), (identification.as_ref(), &correction));
    let result = verdict::judged(
        result,
        &fitting,
        (request, &free),
        (identification.as_ref().unwrap_or(&correction), &correction),
    );
    let values: Vec<(String, String)> =
        problem.settable(&free).iter().map(|&k| fitting.new_value(k, &correction)).collect();
    let (corrected, files) = match &request.write {
        Some(file) if !values.is_empty() => {
            let text = corrected::text(&request.jobs, (of.job, &values), file, &origin)?;
            if request.dry { (Some(text), vec![]) } else { (None, vec![corrected::write(file, &text, &origin)?]) }
        }
        _ => (None, vec![]),
    };
    Ok(FitResult {
        corrected,
        files,
        not_done: origin.located(&[of.job], result.not_done.clone()),
        remarks: origin.located(&[of.job], result.remarks.clone()),
        timing: Timing { points: problem.count(), elapsed: start.elapsed(), ..Timing::default() },
        ..result
    })
}

/// The surfaces as they are, as they were made, and as they shall be.
struct Found {
    now: AdjustedSurfaces,
    free: Vec<usize>,
    choice: Option<SettingsChoice>,
    identification: Option<AdjustedSurfaces>,
    correction: AdjustedSurfaces,
}

impl Found {
    fn of(aims: &[Aim<'_, '_>], problem: &Problem<'_, '_>, request: &FitRequest) -> Result<Found, Failure> {
        let now = problem.as_it_is()?;
        aims.iter().enumerate().try_for_each(|(k, aim)| aim.check_places(problem.motion_of(&now, k)))?;
        let (free, choice) = Fitting { aims, problem, now: &now }.chosen(request)?;
        let (identification, correction) = match request.is_wish() {
            true => (None, problem.reached(&now, &free)?),
            false => (
                Some(problem.identified(&now, &free)?),
                problem.corrected(&now, &problem.settable(&free), request.share)?,
            ),
        };
        Ok(Found { now, free, choice, identification, correction })
    }
}

const NO_AIM: &str =
    "say what the surface shall be: option `measured FILE`, or option `ease_off WISH` with option `from SURFACE`";

/// What does not go together.
fn check(request: &FitRequest) -> Result<(), Failure> {
    let refused = |message: &str| Err(Failure::Request(message.to_string()));
    let is_table = request.ease_off_table.is_some();
    let has_area = request.rows.or(request.columns).is_some() || request.margin.is_some();
    match (&request.measured, request.is_wish(), &request.from) {
        (Some(_), true, _) => {
            refused("option `measured` and option `ease_off` do not go together: one flank is wanted")
        }
        (Some(_), false, Some(_)) => refused("option `from` is the surface of option `ease_off`"),
        (None, _, _) if request.and.is_some() => {
            refused("option `and` is a further measured surface beside option `measured`")
        }
        (None, true, None) => refused("an ease-off is one from another surface: name it with option `from`"),
        (None, false, None) => refused(NO_AIM),
        (None, true, _) if is_table && request.ease_off.is_some() => {
            refused("option `ease_off` is a parabola or a table, and not both")
        }
        (None, true, Some(_)) if has_area && !is_table => refused(
            "option `rows`, option `columns` and option `margin` are those of a table: of option `measured`, or of option `ease_off`",
        ),
        _ if request.is_thickness_free && request.and.is_none() => {
            refused("option `thickness free` is about two flanks: name the other one with option `and`")
        }
        _ if request.is_thickness_free && request.as_it_lies => refused(
            "option `as_it_lies` turns nothing, and option `thickness free` turns each flank by itself: leave one of them out",
        ),
        _ if !(request.share > 0.0 && request.share <= 1.0) => refused("option `share` is above 0 and 1 at the most"),
        _ if request.dry && request.write.is_none() => {
            refused("option `dry` tells the spec of option `write`: name its file")
        }
        _ => Ok(()),
    }
}

fn find_in<'j, 'g>(of: Named<'j, 'g>, name: &str) -> Result<&'j flank_chain_dsl::GeneratedSurface<'g>, Failure> {
    let own = name.strip_prefix(&format!("{}.", of.job.name)).unwrap_or(name);
    if own == of.surface.name {
        return Err(Failure::Request(format!("option `and` names `{own}` again: a further surface is wanted")));
    }
    of.job.surfaces.iter().find(|surface| surface.name == own).ok_or_else(|| {
        let known: Vec<String> = of.job.surfaces.iter().map(|surface| format!("`{}`", surface.name)).collect();
        Failure::Input(format!("job `{}` has no surface `{own}`; there is: {}", of.job.name, known.join(", ")))
    })
}

fn of_same_job<'j, 'g>(of: Named<'j, 'g>, surface: &'j flank_chain_dsl::GeneratedSurface<'g>) -> Named<'j, 'g> {
    Named { job: of.job, surface }
}
