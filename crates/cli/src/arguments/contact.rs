//! The arguments of `flank contact`.

use std::path::PathBuf;

use clap::Args;
use flank::{AmountFault, MountingError, PointFormat, ToleratedAmount};

use super::choice::described;
use super::{EvaluatorArguments, JobArguments, count, folder, length};

#[derive(Args, Debug)]
#[command(after_help = "\
A contact is said in the spec: two flanks on a pair of shafts, the motion that the pair rolls by, and the unknown that the contact
determines: `contact drive_side = pinion_concave with gear_convex, over: turn, for: lag`. Where the teeth end, and how many there are,
is said by a `solid` of each member.

Examples:
  flank contact specs/pairs/bevel_19x62.chain
  flank contact specs/pairs/bevel_19x62.chain --error m.E=0.1mm --error m.S=2arcmin
  flank contact specs/pairs/bevel_19x62.chain --sensitivity --vhj --certify
  flank contact specs/pairs/spur_pair.chain drive_side --format csv,json --out mesh")]
pub(crate) struct Contact {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The contact, where a job has several; all of them otherwise
    pub(crate) contact: Option<String>,
    /// An axis of the pair's machine that is mounted wrong, with its unit: m.E=0.1mm, m.S=2arcmin
    #[arg(long = "error", value_name = "AXIS=VALUE", value_parser = error)]
    pub(crate) errors: Vec<(String, MountingError)>,
    /// Roll positions over a pitch
    #[arg(long, value_name = "COUNT", default_value_t = 60, value_parser = count(4..=10_000), allow_hyphen_values = true)]
    pub(crate) positions: u32,
    /// Thickness of the marking compound
    #[arg(long, value_name = "LENGTH", default_value = "6.35um", value_parser = length, allow_hyphen_values = true)]
    pub(crate) compound: f64,
    /// Also what each axis of the pair's machine and each setting does to the contact: 0.01 mm, 1 arcmin, or a thousandth of the value
    #[arg(long)]
    pub(crate) sensitivity: bool,
    /// Also how far the pinion is to be offset (E) and moved along its axis (P), and the gear along its own (G), to bring the contact to
    /// toe, middle and heel
    #[arg(long)]
    pub(crate) vhj: bool,
    /// Also prove by interval arithmetic that exactly one point of contact lies where it is computed
    #[arg(long)]
    pub(crate) certify: bool,
    /// Also the pair with the flank that a milling of the job leaves: where its ridges touch, and how evenly it turns
    #[arg(long, value_name = "MILLING")]
    pub(crate) milled: Option<String>,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Files with gaps and paths, several with commas
    #[arg(long, value_parser = described::<PointFormat>(), value_delimiter = ',', default_value = "csv")]
    pub(crate) format: Vec<PointFormat>,
    /// Write no picture (otherwise a PNG and an SVG)
    #[arg(long)]
    pub(crate) no_picture: bool,
    /// Print the numbers as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

pub(super) fn error(text: &str) -> Result<(String, MountingError), String> {
    let wanted = || "write AXIS=VALUE with a unit, for example m.E=0.1mm or m.S=2arcmin".to_string();
    let (axis, value) = text.split_once('=').ok_or_else(wanted)?;
    let axis = Some(axis.trim()).filter(|axis| !axis.is_empty()).ok_or_else(wanted)?;
    let error = match flank::read_amount(value) {
        Ok(ToleratedAmount::Length(mm)) => MountingError::Length(mm),
        Ok(ToleratedAmount::Angle(radians)) => MountingError::Angle(radians),
        Err(fault @ AmountFault::UnknownUnit(_)) => return Err(fault.to_string()),
        _ => return Err(wanted()),
    };
    Ok((axis.to_string(), error))
}
