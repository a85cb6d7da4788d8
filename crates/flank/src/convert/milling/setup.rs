//! With what a surface is milled, and how.

use flank_chain_dsl::{BlockLength, Job, PassSpacing, ValueSource};
use flank_export::fixed;
use schemars::JsonSchema;
use serde::Serialize;

use super::target::Target;
use crate::project::choices::Choice;
use crate::project::requests::MillRequest;
use crate::project::units;

/// Cutter, lean, passes and what a program says of feed and speed. Lengths are mm, angles deg.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MillSetup {
    /// What the cutter is defined as, as `ball_mill`; null where all its settings are the job's own.
    pub cutter: Option<String>,
    /// Its settings.
    pub settings: Vec<CutterSetting>,
    /// The machine, and what it is defined as.
    pub machine: [String; 2],
    /// What passes are planned by, in words.
    pub passes: String,
    /// What blocks are planned by, in words.
    pub blocks: String,
    /// Whether every other pass runs backwards.
    pub both_ways: bool,
    /// The least and the largest lean forward in the feed; null with the side of the cutter, which lies as leaves least.
    pub lead: Option<[f64; 2]>,
    /// The same about the direction of the pass.
    pub tilt: Option<[f64; 2]>,
    /// What is left on the surface.
    pub stock: f64,
    /// Of the cutter along the surface, mm/min.
    pub feed: f64,
    /// Revolutions a minute, if programs say that.
    pub spindle: Option<f64>,
    /// How far above a pass the cutter comes down and is lifted with feed.
    pub approach: f64,
    /// Spaces of the work that a program mills.
    pub spaces: u32,
    /// Whether words are the tip in the work and the control keeps it on its way.
    pub tool_centre_control: bool,
    /// The controls that programs are written for: the postprocessors.
    pub controls: Vec<String>,
}

/// A setting of a cutter.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CutterSetting {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// Shares at which the lean is looked at.
const PLACES: usize = 9;

impl MillSetup {
    pub(super) fn new(job: &Job<'_>, target: &Target<'_, '_>, request: &MillRequest) -> MillSetup {
        let milling = target.milling;
        let tool = milling.cutter_name.split('.').next().unwrap_or_default();
        let own = |name: &str| name.strip_prefix(tool).and_then(|rest| rest.strip_prefix('.')).map(str::to_string);
        let all = job.parameters.iter().filter_map(|parameter| Some((own(&parameter.name)?, parameter)));
        let cutter = all.clone().find_map(|(_, parameter)| match &parameter.given_by {
            ValueSource::Definition(name) => Some(name.clone()),
            ValueSource::Job | ValueSource::Caller => None,
        });
        let settings = all.map(|(name, parameter)| CutterSetting {
            name,
            value: units::shown(parameter.dimension, parameter.value),
            unit: units::whole_symbol(parameter.dimension),
        });
        let machine = &job.machines[milling.machine];
        let is_side = matches!(milling.spacing, PassSpacing::Side(_));
        let shares = || (0..PLACES).map(|k| k as f64 / (PLACES - 1) as f64);
        let leans: Vec<_> = shares().flat_map(|p| shares().map(move |u| [p, u])).map(|at| target.lean(at)).collect();
        let extent = |angles: Vec<f64>| {
            let (low, high) = (angles.iter().copied().reduce(f64::min)?, angles.iter().copied().reduce(f64::max)?);
            (!is_side).then(|| [low, high].map(f64::to_degrees))
        };
        MillSetup {
            cutter,
            settings: settings.collect(),
            machine: [machine.name.clone(), machine.definition.clone()],
            passes: passes(milling.spacing),
            blocks: blocks(milling.blocks),
            both_ways: milling.both_ways,
            lead: extent(leans.iter().map(|lean| lean.lead).collect()),
            tilt: extent(leans.iter().map(|lean| lean.tilt).collect()),
            stock: milling.stock,
            feed: request.feed,
            spindle: request.spindle,
            approach: request.approach,
            spaces: request.spaces,
            tool_centre_control: request.tool_centre_control,
            controls: request.nc.iter().map(|control| control.name().to_string()).collect(),
        }
    }

    /// Names with what belongs to them.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let mm = |value: f64| format!("{} mm", plain(value));
        let settings = self.settings.iter().map(|CutterSetting { name, value, unit }| {
            format!("{} {} {unit}", name.replace('_', " "), plain(*value)).trim_end().to_string()
        });
        let settings: Vec<String> = settings.collect();
        let lean = |[low, high]: [f64; 2]| {
            let ends = [low, high].map(|angle| fixed(angle, 3));
            if ends[0] == ends[1] { format!("{} deg", ends[0]) } else { format!("{} .. {} deg", ends[0], ends[1]) }
        };
        let [machine, definition] = &self.machine;
        let mut facts = vec![("cutter", self.cutter.clone().unwrap_or("settings of the job's own".to_string()))];
        facts.push(("sizes", settings.join(", ")));
        facts.push(("machine", format!("{machine} = {definition}")));
        facts.extend(self.lead.map(|lead| ("lead", lean(lead))));
        facts.extend(self.tilt.map(|tilt| ("tilt", lean(tilt))));
        facts.push(("stock", mm(self.stock)));
        let ways = if self.both_ways { "both ways" } else { "one way" };
        facts.push(("passes", format!("{}, {ways}", self.passes)));
        facts.push(("blocks", self.blocks.clone()));
        facts.push(("feed", format!("{} mm/min of the cutter along the surface", plain(self.feed))));
        let speed = self.spindle.map(|speed| format!("{} 1/min", plain(speed)));
        facts.push(("spindle", speed.unwrap_or("not said: option `spindle` does".to_string())));
        let words = match self.tool_centre_control {
            true => "the tip in the work and the rotary axes: the control keeps the tip on its way",
            false => "all axes, with inverse-time feed",
        };
        facts.push(("words", words.to_string()));
        let spaces = units::counted(self.spaces as usize, "space");
        facts.push(("program", format!("{spaces}, down to each pass and up from it by {}", mm(self.approach))));
        let controls = match self.controls.as_slice() {
            [] => "none chosen: option `nc` of `flank mill` names controls".to_string(),
            controls => controls.join(", "),
        };
        facts.push(("postprocessor", controls));
        facts.into_iter().map(|(name, text)| (name.to_string(), text)).collect()
    }
}

/// As short as it is exact to four decimals.
fn plain(value: f64) -> String {
    let text = fixed(value, 4);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

fn passes(spacing: PassSpacing) -> String {
    match spacing {
        PassSpacing::Scallop(height) => format!("no ridge above {} um", plain(1e3 * height)),
        PassSpacing::Step(step) => format!("at most {} mm apart", plain(step)),
        PassSpacing::Count(count) => format!("{count}, evenly spread"),
        PassSpacing::Side(free) => {
            format!("one with the side of the cutter, whose axis is free at {}", units::counted(free, "place"))
        }
    }
}

fn blocks(length: BlockLength) -> String {
    match length {
        BlockLength::Chord(off) => format!("straight, off by at most {} um", plain(1e3 * off)),
        BlockLength::Step(step) => format!("straight, at most {} mm long", plain(step)),
        BlockLength::Count(count) => format!("straight, between {count} positions of a pass"),
    }
}
