//! Settings of the target that are looked for: with which constants it makes the source's poses.

use flank_chain_dsl::{Dimension, Job, RangedVariable};
use flank_expr::geometry::Chain;
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{
    AdjustableMachine, Range, SettingBounds, SettingKind, SettingsFit, SettingsProblem, UnknownSetting,
};

use super::Target;
use super::result::{CarriedJob, FittedPosition, FoundSetting, FoundSettings};
use super::source::{Flank, Source};
use crate::project::failure::Failure;
use crate::project::quantity::{NamedUnit, UnitSymbol};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::ConvertRequest;
use crate::project::session::Session;
use crate::project::units;

/// Positions that the settings are found from; all others follow.
const FITTED: usize = 21;
/// A setting is outside its range if it is so by more than this share of 1 mm or 1 rad and of itself: found from the exact Jacobian, it
/// is known to some thousand roundings, so that a default on the end of its range comes back inside.
const ROUNDING: f64 = 1e-9;

/// The settings that move the tool against the work and have no value, and those that are asked for.
///
/// # Errors
/// In words, if one is asked for that is not there or makes no difference, or one without a value counts something.
pub(super) fn wanted<'t, 'g>(
    target: &'t Job<'g>,
    chain: &Chain<'g>,
    asked: &[String],
) -> Result<Vec<&'t RangedVariable<'g>>, String> {
    let machine = &target.machines[0].name;
    let matter = that_matter(target, chain);
    let matters = |setting: &RangedVariable<'g>| matter.iter().any(|known| known.variable == setting.variable);
    for name in asked {
        let known = target.settings.iter().find(|setting| short(setting) == *name || setting.name == *name);
        let reason = match known {
            None => "there is no such setting",
            Some(setting) if setting.is_count => "it counts something and takes whole numbers only",
            Some(setting) if !matters(setting) => "it does not move the tool against the work",
            Some(_) => continue,
        };
        let can: Vec<String> =
            matter.iter().filter(|setting| !setting.is_count).map(|setting| short(setting)).collect();
        return Err(match &can[..] {
            [] => format!("option `fit {name}`: {reason}; {machine} has no setting that can be looked for"),
            can => format!("option `fit {name}`: {reason}; {machine} can be set by {}", can.join(", ")),
        });
    }
    let has_value = |setting: &RangedVariable<'g>| target.parameters.iter().any(|p| p.variable == setting.variable);
    let is_asked =
        |setting: &RangedVariable<'g>| asked.iter().any(|name| short(setting) == *name || setting.name == *name);
    let wanted: Vec<&RangedVariable<'g>> =
        target.settings.iter().filter(|s| is_asked(s) || (!has_value(s) && matters(s))).collect();
    match wanted.iter().find(|setting| setting.is_count) {
        Some(count) => Err(format!("{} has no value: option `set {}=…`", count.name, count.name)),
        None => Ok(wanted),
    }
}

/// The settings that move the tool against the work.
fn that_matter<'t, 'g>(target: &'t Job<'g>, chain: &Chain<'g>) -> Vec<&'t RangedVariable<'g>> {
    let reached = chain.substituted(&target.bindings_beside(&variables(&target.settings)));
    target.settings.iter().filter(|setting| !reached.twist(setting.variable).is_zero()).collect()
}

fn variables<'g>(settings: &[RangedVariable<'g>]) -> Vec<Expr<'g>> {
    settings.iter().map(|setting| setting.variable).collect()
}

/// The settings, and what they leave to be wished.
pub(super) fn find(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    (request, session): (&ConvertRequest, Session<'_>),
) -> Result<FoundSettings, Failure> {
    let Target { source, settings, .. } = target;
    let positions = source.positions(request.positions as usize);
    let unknown: Vec<UnknownSetting<'_>> = settings.iter().map(|setting| unknown(target.job, setting)).collect();
    let [chain, driven] = [&target.chain, source.driven].map(|chain| chain.substituted(&target.bindings));
    let machine = AdjustableMachine { chain: &chain, settings: &unknown, axes: &target.axes };
    let reach = reach(target, &positions);
    let motions = target.motions();
    let problem = SettingsProblem::new(&machine, &driven, &motions, &source.symmetries, reach)
        .map_err(|error| error.to_string())?
        .starts(request.starts);
    let some: Vec<Vec<f64>> = match positions.len().checked_sub(1) {
        Some(last) if last >= FITTED => (0..FITTED).map(|k| positions[k * last / (FITTED - 1)].clone()).collect(),
        _ => positions.clone(),
    };
    let _working = session.begin(format!("looking for settings of {}", target.machine.name))?;
    let fit = problem.fit(&some);
    let deviation = source.flanks.iter().filter_map(|flank| deviation(&problem, source, flank, &fit, &some));
    let deviation = deviation.fold(None, |most: Option<f64>, d| Some(most.map_or(d, |most| most.max(d))));
    let unsolved = source.unsolved.clone();
    let of = super::carried_job(job, (target.machine, source), request);
    let found = Found { of, target, positions: some, fit, deviation, unsolved };
    Ok(found.result())
}

fn unknown<'g>(target: &Job<'g>, setting: &RangedVariable<'g>) -> UnknownSetting<'g> {
    let usual = target.parameters.iter().find(|p| p.variable == setting.variable).map(|p| p.value);
    let kind = match setting.dimension {
        Dimension::LENGTH => SettingKind::Length,
        Dimension::ANGLE => SettingKind::Angle,
        _ => SettingKind::Number,
    };
    let range = Range { low: setting.low, high: setting.high };
    UnknownSetting { variable: setting.variable, sought: SettingBounds { kind, range, usual } }
}

/// How far tool and work are apart at the most, either one seen from the other, mm.
fn reach(target: &Target<'_, '_>, positions: &[Vec<f64>]) -> f64 {
    let pose = target.source.driven.substituted(&target.bindings).pose();
    let tape = Tape::new(&pose.translation.0, &target.motions()).expect("a job without errors leaves nothing unbound");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let mut out = [0.0; 3];
    let distances = positions.iter().map(|at| {
        evaluator.run(at, &mut out);
        out.iter().map(|x| x * x).sum::<f64>().sqrt()
    });
    1.0 + 1.5 * distances.fold(0.0, f64::max)
}

/// The largest normal distance between the flank and what the machine leaves with these settings where points are sampled.
fn deviation(
    problem: &SettingsProblem<'_>,
    source: &Source<'_, '_>,
    flank: &Flank<'_, '_>,
    fit: &SettingsFit,
    positions: &[Vec<f64>],
) -> Option<f64> {
    let unknowns = &flank.surface.unknowns;
    let place = |k: usize| unknowns.iter().position(|unknown| unknown.variable == source.motions[k].variable);
    let motions: Vec<usize> = (0..source.motions.len()).map(place).collect::<Option<_>>()?;
    let tool = flank.tool.unknowns.len();
    let inputs = flank.tool.unknowns.iter().chain(problem.settings()).chain(problem.moving()).copied();
    let moved = problem.chain().point(flank.tool.position);
    let tape = Tape::new(&moved.0, &inputs.collect::<Vec<_>>()).expect("a job without errors leaves nothing unbound");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let mut out = [0.0; 3];
    let off = flank.solved().map(|point| {
        let at: Vec<f64> = motions.iter().map(|&k| point.unknowns[k]).collect();
        let apart = |k: &usize| positions[*k].iter().zip(&at).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let near = (0..positions.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("there are positions");
        let moving = problem.stand(&fit.settings, &at, &fit.moving[near]);
        evaluator.run(&[&point.unknowns[..tool], &fit.settings, &moving].concat(), &mut out);
        (0..3).map(|k| point.normal[k] * (out[k] - point.position[k])).sum::<f64>().abs()
    });
    off.fold(None, |most: Option<f64>, d| Some(most.map_or(d, |most| most.max(d))))
}

/// What was found.
struct Found<'f, 't, 'g> {
    of: CarriedJob,
    target: &'f Target<'t, 'g>,
    positions: Vec<Vec<f64>>,
    fit: SettingsFit,
    /// mm; none where no points are solved.
    deviation: Option<f64>,
    /// Which points are not solved, as `flank solve` reports.
    unsolved: Vec<NotDone>,
}

impl Found<'_, '_, '_> {
    fn missed(&self) -> Vec<NotDone> {
        let Found { target, fit, .. } = self;
        let name = &target.machine.name;
        let mut missed = self.unsolved.clone();
        if !fit.is_exact {
            let more = that_matter(target.job, &target.chain).into_iter();
            let more = more.filter(|s| !s.is_count && target.settings.iter().all(|wanted| wanted.name != s.name));
            let more: Vec<String> = more.map(short).collect();
            let others = match more.is_empty() {
                true => format!("{name} has no others"),
                false => format!("perhaps with others: option `fit` {}", more.join(" or ")),
            };
            let message =
                format!("not reached: no values of these settings were found that make all poses on {name}; {others}");
            missed.push(NotDone::new(NotDoneKind::NotReached, name, message));
        }
        for (setting, value) in target.settings.iter().zip(&fit.settings) {
            let margin = ROUNDING * (1.0 + value.abs());
            if *value < setting.low - margin || *value > setting.high + margin {
                let [value, low, high] =
                    [*value, setting.low, setting.high].map(|x| units::text(setting.dimension, x, 6));
                let name = &setting.name;
                let message =
                    format!("not reached: {name} would have to be {value}, outside its range {low} .. {high}");
                missed.push(NotDone::new(NotDoneKind::NotReached, name, message));
            }
        }
        missed
    }

    fn result(&self) -> FoundSettings {
        let Found { target, fit, .. } = self;
        let setting = |(k, (setting, value)): (usize, (&&RangedVariable<'_>, &f64))| FoundSetting {
            name: short(setting),
            unit: UnitSymbol::of_dimension(setting.dimension),
            value: units::shown(setting.dimension, *value),
            determined: !fit.undetermined.contains(&k),
        };
        let position = |(at, moving): (&Vec<f64>, &Vec<f64>)| {
            let motions = target.source.motions.iter().zip(at).map(|(motion, x)| units::shown(motion.dimension, *x));
            let axes = target.free.iter().zip(moving).map(|(axis, x)| units::shown(axis.dimension, *x));
            FittedPosition { motions: motions.collect(), axes: axes.collect() }
        };
        FoundSettings {
            of: self.of.clone(),
            settings: target.settings.iter().zip(&fit.settings).enumerate().map(setting).collect(),
            positions: self.positions.iter().zip(&fit.moving).map(position).collect(),
            displacement_mm: fit.displacement,
            turn_deg: fit.turn.to_degrees(),
            deviation_um: self.deviation.map(|mm| mm * 1e3),
            not_done: self.missed(),
            axes: target.free.iter().map(|axis| NamedUnit::new(&axis.name, axis.dimension)).collect(),
        }
    }
}

/// The setting's own name, without its machine's.
fn short(setting: &RangedVariable<'_>) -> String {
    setting.name.rsplit('.').next().unwrap_or(&setting.name).to_string()
}
