//! Profile and helix traces of cylindrical flanks against an involute helicoid, as gear measuring machines plot them.

use flank_chain_dsl::{GeneratedSurface, Job, Solid};
use flank_solver::{InvoluteHelicoid, InvoluteReference, Outcome, SurfacePoint, TraceEvaluation};

use crate::compare::trace_result::{FlankTraces, InvoluteNumbers, InvoluteSource, TraceNumbers};
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::solved::Solved;
use crate::solve::surface::problem;

/// Points of a trace.
const POINTS: usize = 121;
/// Boxes that a search for a point looks at where Newton's method does not reach it.
const BOXES: u64 = 200;
/// The share of the profile that is evaluated, from its root on, and the share of the face that is left out at each end where it is no
/// more than a module, as ISO 1328-1:2013 has both unless something else is agreed.
const PROFILE: f64 = 0.95;
const FACE: f64 = 0.05;
/// The involutes that touch a cylindrical flank in its points have base circles that differ by no larger share, and one that is told by
/// the job no more from the flank's own.
const ALIKE: f64 = 0.05;
/// The same for the helices on the base cylinder, radians.
const PARALLEL: f64 = 0.05;

/// The traces of a flank.
///
/// # Errors
/// If no point is solved, the flank is no involute, or the work is cancelled.
pub(crate) fn traces<'j>(
    job: &'j Job<'_>,
    solved: &Solved<'j, '_>,
    session: Session<'j>,
) -> Result<FlankTraces, Failure> {
    let name = &solved.surface.name;
    let known: Vec<&SurfacePoint> = solved.points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
    let own = own(&known).ok_or_else(|| format!("`{name}` is no flank of a cylindrical gear with involute teeth"))?;
    let (helicoid, source) = nominal(job, solved, own);
    let area = Area::of_points(&known, helicoid).ok_or_else(|| format!("`{name}` lies below its base circle"))?;
    let line = |targets: &[[f64; 2]]| points(job, solved, &known, targets, session);
    let middle = line(&[[area.middle_face(), helicoid.rho(area.middle_roll())]]);
    let reference = middle.first().and_then(|(_, at, normal)| helicoid.through(*at, *normal));
    let reference = reference.ok_or_else(|| format!("`{name}` has no point in the middle of its area"))?;
    let steps = |[low, high]: [f64; 2]| move |k: usize| low + (high - low) * k as f64 / (POINTS - 1) as f64;
    let roll = steps(area.roll);
    let profile: Vec<[f64; 2]> = (0..POINTS).map(|k| [area.middle_face(), helicoid.rho(roll(k))]).collect();
    let face = steps(area.face);
    let helix: Vec<[f64; 2]> = (0..POINTS).map(|k| [face(k), helicoid.rho(area.middle_roll())]).collect();
    let off = |targets: &[[f64; 2]], length: &dyn Fn(usize) -> f64| -> (Vec<f64>, Vec<f64>) {
        let found =
            line(targets).into_iter().filter_map(|(k, at, _)| Some((length(k), 1e3 * reference.deviation(at)?)));
        found.unzip()
    };
    let [low, high] = area.roll;
    // teeth of a ring have their roots outside
    let is_ring = middle.first().is_some_and(|(_, [x, y, _], [u, v, _])| x * u + y * v < 0.0);
    let evaluated = PROFILE * (high - low);
    let range = if is_ring { [high - evaluated, high] } else { [low, low + evaluated] };
    let profile = numbers(off(&profile, &roll), range, POINTS);
    let profile = profile.map(|of| if is_ring { TraceNumbers { slope_um: -of.slope_um, ..of } } else { of });
    let [low, high] = area.face;
    let end = (FACE * (high - low)).min(module(job).unwrap_or(f64::INFINITY));
    let helix = numbers(off(&helix, &face), [low + end, high - end], POINTS);
    let (Some(profile), Some(helix)) = (profile, helix) else {
        return Err(format!("too few points of the traces of `{name}` are solved to evaluate them").into());
    };
    Ok(FlankTraces {
        surface: name.clone(),
        frame: solved.surface.frame.clone(),
        involute: involute(&reference, source),
        profile,
        helix,
    })
}

/// How far the points of a flank lie off its reference, along its normal, um: the transverse deviation by the cosine of the base helix angle.
/// The reference is the one that the traces have.
pub(crate) fn topography(job: &Job<'_>, solved: &Solved<'_, '_>) -> Option<(Vec<Option<f64>>, InvoluteNumbers)> {
    let known: Vec<&SurfacePoint> = solved.points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
    let own = own(&known)?;
    let (helicoid, source) = nominal(job, solved, own);
    let middle = middle(&known, helicoid)?;
    let reference = helicoid.through(middle.position, middle.normal)?;
    let along_normal = 1e3 * helicoid.base_helix_angle().cos();
    let off = |point: &SurfacePoint| {
        let off = reference.deviation(point.position).filter(|_| point.outcome == Outcome::Solved);
        off.map(|off| along_normal * off)
    };
    Some((solved.points.iter().map(off).collect(), involute(&reference, source)))
}

fn involute(reference: &InvoluteReference, source: InvoluteSource) -> InvoluteNumbers {
    let helicoid = reference.helicoid();
    InvoluteNumbers {
        base_diameter_mm: 2.0 * helicoid.base_radius,
        base_helix_angle_deg: helicoid.base_helix_angle().to_degrees(),
        source,
    }
}

/// The helicoid that touches a flank in its middle, if those of its other points have nearly its base circle and helix.
fn own(known: &[&SurfacePoint]) -> Option<InvoluteHelicoid> {
    let touching = |point: &SurfacePoint| InvoluteHelicoid::touching(point.position, point.normal);
    let rho = |point: &SurfacePoint| point.position[0].hypot(point.position[1]);
    let ends = |of: &dyn Fn(&SurfacePoint) -> f64| {
        let all = || known.iter().map(|point| of(point));
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    };
    let [rhos, faces] = [ends(&rho), ends(&|point| point.position[2])];
    let off = |point: &SurfacePoint| {
        let share =
            |[low, high]: [f64; 2], x: f64| (x - 0.5 * (low + high)).abs() / (high - low).max(f64::MIN_POSITIVE);
        share(rhos, rho(point)) + share(faces, point.position[2])
    };
    let found = touching(known.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?)?;
    let is_like = |point: &&SurfacePoint| touching(point).is_some_and(|other| are_alike(other, found));
    known.iter().all(is_like).then_some(found)
}

fn are_alike(a: InvoluteHelicoid, b: InvoluteHelicoid) -> bool {
    (a.base_radius - b.base_radius).abs() < ALIKE * b.base_radius
        && (a.base_helix_angle() - b.base_helix_angle()).abs() < PARALLEL
}

/// What a flank should be, and who says so: the job, if that is nearly what the flank is, else its middle.
fn nominal(job: &Job<'_>, solved: &Solved<'_, '_>, own: InvoluteHelicoid) -> (InvoluteHelicoid, InvoluteSource) {
    let told = told(job, solved.surface).and_then(|(told, source)| Some((matched(told, own)?, source)));
    told.unwrap_or((own, InvoluteSource::Flank))
}

/// What the parameters of a job say by the names that ISO 21771 has for them: the base cylinder of a gear with this module, number of
/// teeth, pressure angle and helix angle. What the job leaves to the tool is what the text says of that: a tool that is set otherwise from
/// outside makes another flank, and no other gear is meant.
fn told(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Option<(InvoluteHelicoid, InvoluteSource)> {
    let named = |name: &str| job.parameters.iter().find(|of| of.name == name);
    let tool = surface.generation.tool_name.split('.').next().unwrap_or_default();
    // the normal one first: where there are both, they differ by the helix
    let either = |name: &str| {
        let names = [format!("normal_{name}"), name.to_string()];
        let of_job = names.iter().find_map(|name| named(name)).map(|of| (of.value, InvoluteSource::Job));
        let of_tool = || {
            let own = names.iter().find_map(|name| named(&format!("{tool}.{name}")));
            let of_any = |name: &String| job.parameters.iter().find(|of| of.name.rsplit('.').next() == Some(name));
            let told = own.or_else(|| names.iter().find_map(of_any))?;
            Some((told.value_in_text, InvoluteSource::Tool))
        };
        of_job.or_else(of_tool)
    };
    let is_of = |solid: &&Solid| solid.space.iter().any(|at| job.surfaces[*at].name == surface.name);
    let own_teeth = || named("teeth").map(|of| of.value);
    let teeth = job.solids.iter().find(is_of).map(|solid| f64::from(solid.teeth)).or_else(own_teeth)?;
    let ((module, of_module), (pressure_angle, of_angle)) = (either("module")?, either("pressure_angle")?);
    let helix_angle = named("helix_angle").map_or(0.0, |of| of.value);
    let radius = 0.5 * module * teeth / helix_angle.cos();
    let transverse = (pressure_angle.tan() / helix_angle.cos()).atan();
    let told = InvoluteHelicoid { base_radius: radius * transverse.cos(), twist: helix_angle.tan() / radius };
    let source = if of_module == InvoluteSource::Job { of_angle } else { of_module };
    Some((told, source))
}

/// The normal module of a job that names it, mm.
fn module(job: &Job<'_>) -> Option<f64> {
    let named = |name: &str| job.parameters.iter().find(|of| of.name == name).map(|of| of.value);
    named("normal_module").or_else(|| named("module"))
}

/// The one that is told, of the hand of the flank, if it is nearly the flank's own. The members of a pair have opposite hands, and a job
/// names one angle for both.
fn matched(told: InvoluteHelicoid, own: InvoluteHelicoid) -> Option<InvoluteHelicoid> {
    let twist = if told.twist * own.twist < 0.0 { -told.twist } else { told.twist };
    Some(InvoluteHelicoid { twist, ..told }).filter(|told| are_alike(*told, own))
}

/// Over which lengths of roll and heights a flank has points.
struct Area {
    roll: [f64; 2],
    face: [f64; 2],
}

impl Area {
    fn of_points(known: &[&SurfacePoint], helicoid: InvoluteHelicoid) -> Option<Area> {
        let rolls =
            || known.iter().filter_map(|point| helicoid.roll_length(point.position[0].hypot(point.position[1])));
        let faces = || known.iter().map(|point| point.position[2]);
        let roll = [rolls().fold(f64::INFINITY, f64::min), rolls().fold(f64::NEG_INFINITY, f64::max)];
        let face = [faces().fold(f64::INFINITY, f64::min), faces().fold(f64::NEG_INFINITY, f64::max)];
        (roll[0] < roll[1] && face[0] < face[1]).then_some(Area { roll, face })
    }

    fn middle_roll(&self) -> f64 {
        0.5 * (self.roll[0] + self.roll[1])
    }

    fn middle_face(&self) -> f64 {
        0.5 * (self.face[0] + self.face[1])
    }

    /// How far a point is from the middle.
    fn off(&self, helicoid: InvoluteHelicoid, point: &SurfacePoint) -> f64 {
        let [x, y, z] = point.position;
        let roll = helicoid.roll_length(x.hypot(y)).unwrap_or(f64::INFINITY);
        let share = |[low, high]: [f64; 2], at: f64| ((at - 0.5 * (low + high)) / (high - low)).abs();
        share(self.roll, roll) + share(self.face, z)
    }
}

/// The point of a flank that is nearest to the middle of its area.
fn middle<'p>(known: &[&'p SurfacePoint], helicoid: InvoluteHelicoid) -> Option<&'p SurfacePoint> {
    let area = Area::of_points(known, helicoid)?;
    known.iter().copied().min_by(|a, b| area.off(helicoid, a).total_cmp(&area.off(helicoid, b)))
}

/// Points of a flank at heights and distances from the axis, mm, by their places in the list; those that are not there are left out.
fn points<'j>(
    job: &'j Job<'_>,
    solved: &Solved<'j, '_>,
    known: &[&SurfacePoint],
    targets: &[[f64; 2]],
    session: Session<'j>,
) -> Vec<(usize, [f64; 3], [f64; 3])> {
    let [x, y, z] = solved.surface.surface.position.0;
    let coordinates = [z, (x * x + y * y).sqrt()];
    let wanted = targets[targets.len() / 2];
    let off = |point: &SurfacePoint| {
        let [x, y, z] = point.position;
        (z - wanted[0]).hypot(x.hypot(y) - wanted[1])
    };
    let near = known.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|point| &point.unknowns[..]);
    let problem = problem(job, solved.surface, coordinates, session).boxes(BOXES);
    let found = problem.solve_points(targets, [1, targets.len()], near, None).0;
    let solved = (0..found.len()).filter(|k| found.outcome(*k) == Outcome::Solved);
    let both = solved.map(|k| {
        let [x, y, z, u, v, w] = found.position_and_normal(k);
        (k, [x, y, z], [u, v, w])
    });
    both.collect()
}

fn numbers((lengths, deviations): (Vec<f64>, Vec<f64>), range: [f64; 2], asked: usize) -> Option<TraceNumbers> {
    let found = TraceEvaluation::of_trace(&lengths, &deviations, range)?;
    Some(TraceNumbers {
        asked,
        evaluated_from_mm: range[0],
        evaluated_to_mm: range[1],
        total_um: found.total,
        form_um: found.form,
        slope_um: found.slope,
        crowning_um: found.crowning,
        mean: found.mean,
        lengths_mm: lengths,
        deviations_um: deviations,
    })
}
