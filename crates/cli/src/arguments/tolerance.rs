//! The arguments of `flank tolerance`.

use clap::Args;
use flank::ToleratedAmount;

use super::{EvaluatorArguments, JobArguments, count};

#[derive(Args, Debug)]
#[command(after_help = "\
Settings scatter by one standard deviation each, independently unless --correlation says more. From exact derivatives follows how the
ease-off of the surface scatters: its slopes, crownings and bias, as `flank deviation` tells them of the changed surface from the nominal
one, and its position, which is how far it is turned about z, or a rack shifted, to meet in the middle. Of contacts that the surface takes part in: where
they lie on the second flank, the error in the middle, and the height of its parabola over a pitch.

Results: slope_profilewise, slope_lengthwise, crowning_profilewise, crowning_lengthwise, bias, position; of a contact
drive_side.lengthwise, drive_side.profilewise, drive_side.error, drive_side.transmission_error.

Examples:
  flank tolerance specs/bevel/pinion_19x62.chain concave
  flank tolerance specs/bevel/pinion_19x62.chain concave --scatter radial_distance=5um,machine_root_angle=20arcsec,ratio_of_roll=0.01%
  flank tolerance specs/bevel/pinion_19x62.chain concave --budget bias=3um,crowning_lengthwise=2um
  flank tolerance specs/pairs/bevel_19x62.chain pinion_concave --scatter m.E=10um,m.S=1arcmin --sweep 1000")]
pub(crate) struct Tolerance {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The surface; it is sampled in the spec
    pub(crate) surface: String,
    /// What scatters, and by which standard deviation, several with commas: radial_distance=5um,m.S=1arcmin,ratio_of_roll=0.01%; without
    /// it all that the job gives a value by 0.01 mm, 1 arcmin or a thousandth
    #[arg(long, value_name = "NAME=AMOUNT", value_delimiter = ',', value_parser = amount)]
    pub(crate) scatter: Vec<(String, ToleratedAmount)>,
    /// How two of them go together: radial_distance,work_offset=-0.4
    #[arg(long = "correlation", value_name = "NAME,NAME=NUMBER", value_parser = correlation)]
    pub(crate) correlations: Vec<([String; 2], f64)>,
    /// The standard deviation that results may have, several with commas: bias=3um; tells how far each setting may scatter then
    #[arg(long, value_name = "RESULT=AMOUNT", value_delimiter = ',', value_parser = amount)]
    pub(crate) budget: Vec<(String, ToleratedAmount)>,
    /// In the worst case each is off by so many standard deviations
    #[arg(long, value_name = "NUMBER", default_value_t = 3.0, value_parser = limits, allow_hyphen_values = true)]
    pub(crate) limits: f64,
    /// Do not turn the changed surface about z, or shift a rack's along y, until both meet in the middle of the grid
    #[arg(long)]
    pub(crate) no_align: bool,
    /// Also draw so many random cases, solve each anew, and tell where they show something else
    #[arg(long, value_name = "COUNT", value_parser = count(10..=1_000_000), allow_hyphen_values = true)]
    pub(crate) sweep: Option<u32>,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

pub(super) fn amount(text: &str) -> Result<(String, ToleratedAmount), String> {
    let wanted =
        || "write NAME=AMOUNT, for example radial_distance=5um, m.S=1arcmin or ratio_of_roll=0.01%".to_string();
    let (name, value) = text.split_once('=').ok_or_else(wanted)?;
    let name = Some(name.trim()).filter(|name| !name.is_empty()).ok_or_else(wanted)?;
    Ok((name.to_string(), above_zero(value)?))
}

/// An amount that something scatters by.
pub(super) fn above_zero(text: &str) -> Result<ToleratedAmount, String> {
    let amount = flank::read_amount(text).map_err(|fault| fault.to_string())?;
    let (ToleratedAmount::Length(size)
    | ToleratedAmount::Angle(size)
    | ToleratedAmount::Number(size)
    | ToleratedAmount::Product { size, .. }
    | ToleratedAmount::Share(size)) = amount;
    if size > 0.0 { Ok(amount) } else { Err("an amount is above zero".to_string()) }
}

fn correlation(text: &str) -> Result<([String; 2], f64), String> {
    let wanted = || "write NAME,NAME=NUMBER, for example radial_distance,work_offset=-0.4".to_string();
    let (names, value) = text.split_once('=').ok_or_else(wanted)?;
    let (a, b) = names.split_once(',').ok_or_else(wanted)?;
    let value: f64 = value.trim().parse().map_err(|_| wanted())?;
    if !(value > -1.0 && value < 1.0) {
        return Err("a correlation is above -1 and below 1".to_string());
    }
    Ok(([a, b].map(|name| name.trim().to_string()), value))
}

fn limits(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|of| of.is_finite() && *of > 0.0);
    found.ok_or("write a number above 0, for example 3".to_string())
}
