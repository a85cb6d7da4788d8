//! What `flank convert` found.

use std::collections::BTreeMap;
use std::fmt;

use flank_export::fixed;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::columns::aligned;
use crate::project::quantity::{NamedUnit, Travel, UnitSymbol};
use crate::project::remark::NotDone;

/// A job on another machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ConvertResult {
    /// How the axes move.
    Motion(Box<AxisMotion>),
    /// Which settings do the same.
    Settings(Box<FoundSettings>),
}

/// The axis positions at which another machine holds its tool to the work as the job's own does, of `flank convert`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.convert/2")]
pub struct AxisMotion {
    /// What is carried over, and whereto.
    #[serde(flatten)]
    pub of: CarriedJob,
    /// Of the job.
    pub motions: Vec<NamedUnit>,
    /// In the order and units of the motions: where all sampled points are made, if nothing moves between them; null otherwise.
    pub made_at: Option<Vec<f64>>,
    /// That move the tool against the work.
    pub axes: Vec<AxisExtent>,
    /// An axis that only moves the tool along itself and is not needed; null if there is none.
    pub resting: Option<RestingAxis>,
    /// Motions that leave the tool unchanged, in its frame.
    pub tool_symmetries: Vec<ToolSymmetry>,
    /// In the order in which they are passed.
    pub positions: Vec<AxisPosition>,
    /// Null where the axes are not followed over one motion.
    pub polynomials: Option<AxisPolynomials>,
    /// Null without the time that the motion takes.
    pub rates: Option<AxisRates>,
    /// Null without NC programs.
    pub nc_deviation: Option<NcDeviation>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// A job on another machine than its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CarriedJob {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// The machine that it is carried over to.
    pub machine: String,
    /// The file of the machine, as it was given, with forward slashes.
    pub machine_spec: String,
    /// The frame of the tool on the job's own machine.
    pub tool: String,
    /// The frame of the work there.
    pub work: String,
}

/// `job NAME (FILE) on MACHINE (FILE): tool against work`.
impl fmt::Display for CarriedJob {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let CarriedJob { job, spec, machine, machine_spec, tool, work } = self;
        write!(f, "job {job} ({spec}) on {machine} ({machine_spec}): {tool} against {work}")
    }
}

/// How far an axis goes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AxisExtent {
    /// Its name.
    pub name: String,
    /// Of its positions.
    pub unit: UnitSymbol,
    /// Smallest position; null where there is none.
    pub low: Option<f64>,
    /// Largest.
    pub high: Option<f64>,
    /// What the axis can do, in its unit; null where it is not limited.
    pub travel: Option<Travel>,
}

/// An axis that stands still.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RestingAxis {
    /// Its name.
    pub name: String,
    /// Of its position.
    pub unit: UnitSymbol,
    /// Where.
    pub at: f64,
}

/// A motion that leaves the tool unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ToolSymmetry {
    /// Turn, rad.
    pub angular: [f64; 3],
    /// Velocity of the origin, mm.
    pub linear: [f64; 3],
}

/// A position of all axes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AxisPosition {
    /// In the order and units of the motions.
    pub motions: Vec<Option<f64>>,
    /// In the order and units of the axes; null where no posture was found.
    pub axes: Vec<Option<f64>>,
    /// `solved`, or why not.
    pub status: &'static str,
    /// What the axes cannot follow.
    pub missing: Option<MissingMotion>,
}

/// What the axes cannot follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissingMotion {
    /// 0 to 2: displacement along x, y, z; 3 to 5: turn about them.
    #[schemars(range(max = 5))]
    pub direction: usize,
    /// In mm or rad.
    pub by: f64,
}

/// The axes as polynomials of the motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AxisPolynomials {
    /// Value of the motion about which they are, rad or mm.
    pub reference: f64,
    /// The highest power.
    pub order: usize,
    /// Of the coefficients, in words.
    pub units: &'static str,
    /// Of each axis: factors of the powers, constant first.
    pub coefficients: BTreeMap<String, Vec<f64>>,
    /// Largest distance off the flank at sampled points, of order 0, 1, ….
    pub deviation_mm_by_order: Vec<f64>,
    /// What they leave of the axes.
    pub remainders: Remainders,
}

/// What polynomials leave of axes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Remainders {
    /// In words.
    pub units: &'static str,
    /// Largest of each axis at the positions.
    pub seen: BTreeMap<String, f64>,
    /// Bound of each axis over the whole motion; null where there is no proof.
    pub proven: Option<BTreeMap<String, f64>>,
    /// Value of the motion at which there is none, in its unit; null with a proof.
    pub not_proven_at: Option<f64>,
}

/// What the axes do over time.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AxisRates {
    /// That the motion takes, evenly.
    pub seconds: f64,
    /// In words.
    pub units: &'static str,
    /// Of each axis the largest absolute velocity, acceleration and jerk.
    pub most: BTreeMap<String, [f64; 3]>,
    /// At each position, of each axis.
    pub positions: Vec<Vec<[f64; 3]>>,
}

/// What NC programs leave on the flank.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NcDeviation {
    /// That straight blocks leave at most; null where it is not proven.
    pub straight_mm: Option<f64>,
    /// That rounding to the words' decimals leaves; null where no point shows it.
    pub rounding_mm: Option<f64>,
}

/// Settings of a machine with which it makes the poses of a job on another one, of `flank convert --fit`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.settings/1")]
pub struct FoundSettings {
    /// What is carried over, and to the machine whose settings are looked for.
    #[serde(flatten)]
    pub of: CarriedJob,
    /// In the order of the machine.
    pub settings: Vec<FoundSetting>,
    /// Those that the settings are found from.
    pub positions: Vec<FittedPosition>,
    /// Largest distance that is left of the poses.
    pub displacement_mm: f64,
    /// Largest angle that is left of the poses.
    pub turn_deg: f64,
    /// How far the flank is off along its normal; null where no points are sampled.
    pub deviation_um: Option<f64>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// The axes of the machine, in the order of the positions.
    pub axes: Vec<NamedUnit>,
}

/// A setting that was looked for.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FoundSetting {
    /// Its own name, without the machine's.
    pub name: String,
    /// Of its value.
    pub unit: UnitSymbol,
    /// In its unit.
    pub value: f64,
    /// Whether the poses determine it: it cannot change, with other settings neither, while they stay.
    pub determined: bool,
}

/// A position that settings are found from.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FittedPosition {
    /// In their units.
    pub motions: Vec<f64>,
    /// Of the machine, in their units.
    pub axes: Vec<f64>,
}

impl Answer for ConvertResult {
    fn not_done(&self) -> &[NotDone] {
        match self {
            ConvertResult::Motion(motion) => &motion.not_done,
            ConvertResult::Settings(settings) => &settings.not_done,
        }
    }
}

impl fmt::Display for ConvertResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ConvertResult::Motion(motion) => motion.fmt(f),
            ConvertResult::Settings(settings) => settings.fmt(f),
        }
    }
}

impl fmt::Display for FoundSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |value: f64, decimals: usize, unit: UnitSymbol| {
            format!("{} {}", fixed(value, decimals), unit.symbol()).trim_end().to_string()
        };
        let setting = |of: &FoundSetting| {
            let told = if of.determined { "" } else { "not determined by the poses" };
            [of.name.clone(), text(of.value, 9, of.unit), told.to_string()]
        };
        let axis = |(k, axis): (usize, &NamedUnit)| {
            let values = self.positions.iter().map(|position| position.axes[k]);
            let (low, high) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
            [axis.name.clone(), text(low, 6, axis.unit), text(high, 6, axis.unit)]
        };
        let head = |cells: [&str; 3]| [cells.map(String::from)].into_iter();
        let settings: Vec<_> = head(["setting", "value", ""]).chain(self.settings.iter().map(setting)).collect();
        let axes: Vec<_> = head(["axis", "from", "to"]).chain(self.axes.iter().enumerate().map(axis)).collect();
        write!(f, "{}\n\nsettings from {} positions\n\n", self.of, self.positions.len())?;
        write!(f, "{}\n{}", aligned(&settings, "<><"), aligned(&axes, "<>>"))?;
        writeln!(f, "\nof the poses {:.1e} mm and {:.1e} deg are left", self.displacement_mm, self.turn_deg)?;
        match self.deviation_um {
            Some(deviation) => writeln!(f, "the flank is then off by up to {deviation:.6} um"),
            None => Ok(()),
        }
    }
}
