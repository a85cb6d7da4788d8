//! How the work is clamped so that the axes of the machine have least to do.

use std::f64::consts::TAU;

use flank_chain_dsl::{Job, Milling, Parameter};
use flank_export::fixed;
use flank_expr::Expr;
use schemars::JsonSchema;
use serde::Serialize;

use super::machine::Machine;
use super::result::MilledAxis;
use crate::project::failure::Failure;
use crate::project::quantity::Travel;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::{ClampRange, MillRequest};
use crate::project::units;

/// More settings than this are not searched at once.
const MOST: usize = 4;
/// Places of each setting that are tried first, of so many settings.
const GRID: [usize; MOST] = [17, 7, 5, 3];
/// The search looks to both sides of the best place by steps from this share of the range ...
const FIRST_STEP: f64 = 0.125;
/// ... to this one.
const LAST_STEP: f64 = 1e-4;
/// A rate of linear axes counts by this against one of rotary axes: it decides where those stay the same.
const LINEAR: f64 = 0.01;
/// What goes beyond a travel or through a pole counts so much more than rates.
const REFUSED: f64 = 1e3;
/// Where an axis has no travel, its rate is a share of this, mm; of a rotary axis of a turn.
const NO_TRAVEL: f64 = 1000.0;
/// Decimals of a setting, in mm and degrees.
const DECIMALS: usize = 3;

/// How the work is clamped for the least rates of the axes, as far as settings of the machine may change.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Clamping {
    /// The settings that may change.
    pub settings: Vec<ClampedSetting>,
    /// What the axes do as the spec says.
    pub before: ClampedRates,
    /// What they do with the settings that are found.
    pub after: ClampedRates,
}

/// A setting that places the work.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClampedSetting {
    /// As `mill.work_z`.
    pub name: String,
    /// The unit of its values.
    pub unit: String,
    /// Between which values it may lie.
    pub range: [f64; 2],
    /// As the spec says.
    pub before: f64,
    /// As it is found.
    pub after: f64,
}

/// What the axes do with one clamping.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClampedRates {
    /// The largest rate of a rotary axis as a share of its travel, or of a turn where it has none, per mm of the cutter's way.
    pub rotary: f64,
    /// The largest rate of a linear axis as a share of its travel, per mm.
    pub linear: f64,
    /// The least angle of the cutter's axis from where a rotary axis is free, deg.
    pub least_from_pole: f64,
    /// Whether all axes stay within their travels and away from the pole.
    pub is_possible: bool,
    /// The axes.
    pub axes: Vec<MilledAxis>,
}

impl ClampedRates {
    /// What the search lowers.
    fn cost(&self, beyond: f64) -> f64 {
        self.rotary + LINEAR * self.linear + REFUSED * beyond
    }
}

impl Clamping {
    /// Names with what belongs to them.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let of_setting = |(k, setting): (usize, &ClampedSetting)| {
            let ClampedSetting { name, unit, before, after, range } = setting;
            let [low, high] = range.map(|end| fixed(end, DECIMALS));
            let [before, after] = [before, after].map(|value| fixed(*value, DECIMALS));
            let text = format!("{name} = {after} {unit} instead of {before} {unit}, between {low} and {high} {unit}");
            (if k == 0 { "clamp" } else { "" }, text)
        };
        let mut facts: Vec<(&'static str, String)> = self.settings.iter().enumerate().map(of_setting).collect();
        let percent = |share: f64| fixed(100.0 * share, 4);
        let [before, after] = [&self.before, &self.after];
        for (kind, rates) in [("rotary", [before.rotary, after.rotary]), ("linear", [before.linear, after.linear])] {
            let [before, after] = rates.map(percent);
            facts.push(("", format!("{kind} axes at most {after} % of their travel per mm instead of {before} %")));
        }
        let [before, after] = [before, after].map(|rates| fixed(rates.least_from_pole, 3));
        facts.push(("", format!("pole at least {after} deg away instead of {before} deg")));
        facts
    }
}

/// That settings that may change are such.
///
/// # Errors
/// See [`found`].
pub(super) fn check(job: &Job<'_>, milling: &Milling<'_>, request: &MillRequest) -> Result<(), Failure> {
    open(job, milling, request).map(|_| ())
}

fn open<'j, 'g>(
    job: &'j Job<'g>,
    milling: &Milling<'g>,
    request: &MillRequest,
) -> Result<Vec<OpenSetting<'j, 'g>>, Failure> {
    if request.clamp.len() > MOST {
        return Err(Failure::Request(format!("option `clamp`: at most {MOST} settings are searched at once")));
    }
    request.clamp.iter().map(|range| OpenSetting::new(job, milling, range, request)).collect()
}

/// The settings with the least rates over poses of a milling.
///
/// # Errors
/// If a setting is none of the milling machine, or does not move the work.
pub(super) fn found(
    job: &Job<'_>,
    milling: &Milling<'_>,
    poses: &[Vec<[f64; 6]>],
    request: &MillRequest,
) -> Result<(Option<Clamping>, Option<NotDone>), Failure> {
    let open = open(job, milling, request)?;
    let search = Search { job, milling, poses, open: &open };
    let as_given: Vec<f64> = open.iter().map(|setting| setting.parameter.value).collect();
    let Some((before, _)) = search.rates(&as_given) else { return Ok((None, None)) };
    let best: Vec<f64> = search.best().iter().zip(&open).map(|(value, setting)| setting.rounded(*value)).collect();
    let Some((after, _)) = search.rates(&best) else { return Ok((None, None)) };
    let not_done = (!after.is_possible).then(|| {
        let names: Vec<&str> = open.iter().map(|setting| setting.parameter.name.as_str()).collect();
        let message = format!(
            "no value of {} keeps the axes of {} within their travels and away from the pole",
            names.join(", "),
            job.machines[milling.machine].name
        );
        let way = "let the settings lie farther apart, or let another one change".to_string();
        NotDone::new(NotDoneKind::BeyondTravel, &milling.name, message).with(vec![way])
    });
    let told = |(setting, after): (&OpenSetting<'_, '_>, &f64)| {
        let dimension = setting.parameter.dimension;
        ClampedSetting {
            name: setting.parameter.name.clone(),
            unit: units::symbol(dimension).to_string(),
            range: [setting.low, setting.high].map(|end| units::shown(dimension, end)),
            before: units::shown(dimension, setting.parameter.value),
            after: units::shown(dimension, *after),
        }
    };
    let settings = open.iter().zip(&best).map(told).collect();
    Ok((Some(Clamping { settings, before, after }), not_done))
}

/// A setting that may change.
struct OpenSetting<'j, 'g> {
    parameter: &'j Parameter<'g>,
    low: f64,
    high: f64,
}

impl<'j, 'g> OpenSetting<'j, 'g> {
    fn new(
        job: &'j Job<'g>,
        milling: &Milling<'g>,
        range: &ClampRange,
        request: &MillRequest,
    ) -> Result<OpenSetting<'j, 'g>, Failure> {
        let machine = &job.machines[milling.machine].name;
        let own = |name: &str| name.strip_prefix(machine.as_str()).is_some_and(|rest| rest.starts_with('.'));
        let settings = || job.parameters.iter().filter(|of| own(&of.name) && !of.is_count);
        let is_named =
            |of: &&Parameter<'g>| of.name == range.setting || of.name == format!("{machine}.{}", range.setting);
        let Some(parameter) = settings().find(is_named) else {
            let known: Vec<String> = settings().map(|of| format!("`{}`", of.name)).collect();
            let message = format!("`{machine}` has no setting `{}`; there is: {}", range.setting, known.join(", "));
            return Err(Failure::Input(message));
        };
        let name = &parameter.name;
        if !moves(job, milling, parameter.variable) || job.decisive.contains(&parameter.variable) {
            return Err(Failure::Input(format!("`{name}` does not move the work against the cutter by itself")));
        }
        let mut ends = [0.0; 2];
        for (end, text) in ends.iter_mut().zip(&range.ends) {
            let mut set: Vec<(String, String)> =
                request.jobs.set.iter().filter(|(other, _)| other != name).cloned().collect();
            set.push((name.clone(), text.clone()));
            let changed = request.jobs.project.job(&job.name, &set)?;
            let value = changed.parameters().iter().find(|of| of.name == *name).map_or(f64::NAN, |of| of.value);
            *end = if units::is_angle(parameter.dimension) { value.to_radians() } else { value };
        }
        let [low, high] = ends;
        if low < high {
            Ok(OpenSetting { parameter, low, high })
        } else {
            Err(Failure::Request(format!("option `clamp {name}`: the first value must be below the last one")))
        }
    }

    /// To decimals that somebody sets.
    fn rounded(&self, value: f64) -> f64 {
        let unit = if units::is_angle(self.parameter.dimension) { TAU / 360.0 } else { 1.0 };
        let step = unit * 10f64.powi(-(DECIMALS as i32));
        (step * (value / step).round()).clamp(self.low, self.high)
    }
}

/// Whether a variable has a part in where the cutter stands in the work.
fn moves<'g>(job: &Job<'g>, milling: &Milling<'g>, variable: Expr<'g>) -> bool {
    let chain = milling.t_work_tool.substituted(&job.bindings_beside(&[variable]));
    let pose = chain.pose();
    let parts: Vec<Expr<'g>> =
        pose.rotation.0.into_iter().chain([pose.translation]).flat_map(|vector| vector.0).collect();
    variable.as_variable().is_some_and(|id| variable.graph().variables_of(&parts).contains(&id))
}

/// A search for the best clamping.
struct Search<'s, 'j, 'g> {
    job: &'j Job<'g>,
    milling: &'s Milling<'g>,
    poses: &'s [Vec<[f64; 6]>],
    open: &'s [OpenSetting<'j, 'g>],
}

impl<'g> Search<'_, '_, 'g> {
    /// The rates with values of the settings, and how far axes go beyond travels and through the pole; nothing where the axes are not known.
    fn rates(&self, values: &[f64]) -> Option<(ClampedRates, f64)> {
        let variables: Vec<Expr<'g>> = self.open.iter().map(|setting| setting.parameter.variable).collect();
        let graph = variables[0].graph();
        let beside = self.job.bindings_beside(&variables);
        let own: Vec<(Expr<'g>, Expr<'g>)> =
            variables.iter().zip(values).map(|(variable, value)| (*variable, graph.constant(*value))).collect();
        let machine = Machine::with_bindings(self.job, self.milling, &[&beside, &own]).ok()?;
        let machine = machine.on_best_elbow(self.poses);
        let rows: Vec<Vec<Vec<f64>>> = self.poses.iter().map(|pass| machine.axes.along(pass)).collect();
        let axes = super::axes(&machine, self.poses, &rows);
        let share = |axis: &MilledAxis, is_rotary: bool| {
            let whole = match axis.travel {
                Some(Travel { low, high }) => high - low,
                None if is_rotary => 360.0,
                None => NO_TRAVEL,
            };
            (axis.rate_per_mm / whole, axis.travel.map_or(0.0, |travel| excess(travel, axis.extent) / whole))
        };
        let shares: Vec<(bool, (f64, f64))> = axes
            .iter()
            .enumerate()
            .map(|(k, axis)| (machine.axes.is_rotary(k), share(axis, machine.axes.is_rotary(k))))
            .collect();
        let most = |rotary: bool| {
            shares.iter().filter(|(is, _)| *is == rotary).map(|(_, (rate, _))| *rate).fold(0.0, f64::max)
        };
        let faults = self
            .poses
            .iter()
            .zip(&rows)
            .map(|(pass, rows)| machine.faults(pass, rows, |_| String::new()).len())
            .sum::<usize>();
        let beyond = shares.iter().map(|(_, (_, beyond))| beyond).sum::<f64>() + if faults > 0 { 1.0 } else { 0.0 };
        let poles = self.poses.iter().flatten().map(|row| machine.axes.angle_from_pole(row).to_degrees());
        let rates = ClampedRates {
            rotary: most(true),
            linear: most(false),
            least_from_pole: poles.fold(f64::INFINITY, f64::min),
            is_possible: faults == 0,
            axes,
        };
        Some((rates, beyond))
    }

    fn cost(&self, shares: &[f64]) -> f64 {
        self.rates(&self.values(shares)).map_or(f64::INFINITY, |(rates, beyond)| rates.cost(beyond))
    }

    fn values(&self, shares: &[f64]) -> Vec<f64> {
        self.open
            .iter()
            .zip(shares)
            .map(|(setting, share)| setting.low + share * (setting.high - setting.low))
            .collect()
    }

    /// Of a grid the best place, and from there the best ones to both sides of each setting, in steps that are halved. The largest rate has
    /// kinks where another block or axis takes over, so that no derivative leads there.
    fn best(&self) -> Vec<f64> {
        let count = self.open.len();
        let places = GRID[count - 1];
        let of_grid = |number: usize| -> Vec<f64> {
            let digit = |k: usize| number / places.pow(k as u32) % places;
            (0..count).map(|k| digit(k) as f64 / (places - 1) as f64).collect()
        };
        let tried = (0..places.pow(count as u32)).map(of_grid).map(|shares| (self.cost(&shares), shares));
        let (mut least, mut best) = tried.reduce(|a, b| if b.0 < a.0 { b } else { a }).expect("a grid has places");
        let mut step = FIRST_STEP;
        while step >= LAST_STEP {
            let sides = (0..count).flat_map(|k| [(k, -step), (k, step)]);
            let beside = sides.map(|(k, by)| {
                let mut shares = best.clone();
                shares[k] = (shares[k] + by).clamp(0.0, 1.0);
                (self.cost(&shares), shares)
            });
            let (cost, shares) = beside.reduce(|a, b| if b.0 < a.0 { b } else { a }).expect("there are settings");
            if cost < least {
                (least, best) = (cost, shares);
            } else {
                step *= 0.5;
            }
        }
        self.values(&best)
    }
}

/// How far an extent goes beyond a travel at both ends together.
fn excess(travel: Travel, [low, high]: [f64; 2]) -> f64 {
    (travel.low - low).max(0.0) + (high - travel.high).max(0.0)
}
