//! The arguments of `flank convert`.

use std::path::PathBuf;

use clap::Args;
use flank::{EmitForm, FunctionLanguage, NcDialect, TableFormat};

use super::choice::names;
use super::{EvaluatorArguments, JobArguments, count, folder, length};

#[derive(Args, Debug)]
#[command(mut_arg("job", |job| job.help("The job that is carried over, where the file holds several")))]
#[command(after_help = "\
The target machine holds the tool to the work as the job's own machine does, up to motions that leave the tool unchanged: a
cutter of revolution may turn about its axis.

Examples:
  flank convert specs/bevel/pinion_19x62.chain --to specs/machines/free_form.chain
  flank convert specs/bevel/pinion_19x62.chain --to specs/machines/free_form.chain --tolerance 0.1um
  flank convert specs/bevel/pinion_19x62.chain --to specs/machines/free_form.chain --nc linuxcnc --time 20 --emit c
  flank convert specs/bevel/pinion_19x62.chain --to specs/machines/free_form.chain --emit c,rust --emit-form exact
  flank convert specs/bevel/tilted_pinion.chain --surface convex --to specs/machines/free_form.chain --json
  flank convert specs/bevel/thesis_gear.chain --to specs/machines/cradle.chain --fit work_offset    settings that do the same")]
pub(crate) struct Convert {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The file of the target machine; of several in it the last one
    #[arg(long, value_name = "FILE")]
    pub(crate) to: PathBuf,
    #[command(flatten)]
    pub(crate) onto: Onto,
    /// Settings of the target that are looked for beside those without a value: tilt,swivel
    #[arg(long, value_delimiter = ',', value_name = "SETTING")]
    pub(crate) fit: Vec<String>,
    /// Starts from which settings are looked for before the nearest ones are taken
    #[arg(long, value_name = "N", default_value_t = flank::FIT_STARTS, value_parser = count(1..=1_000_000), allow_hyphen_values = true)]
    pub(crate) starts: u32,
    /// How many positions, over the motion as far as the sampled points need it
    #[arg(long, value_name = "COUNT", default_value_t = 101, value_parser = count(1..=1_000_000), allow_hyphen_values = true)]
    pub(crate) positions: u32,
    /// The order of the polynomials; 6 otherwise
    #[arg(long, value_name = "ORDER", value_parser = count(0..=30), allow_hyphen_values = true, conflicts_with = "tolerance")]
    pub(crate) order: Option<u32>,
    /// Take the smallest order that keeps the flank this near, for example 0.1um or 0.002mm
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Folder for the files, made if it is not there; build otherwise
    #[arg(long, value_name = "DIR", value_parser = folder())]
    pub(crate) out: Option<PathBuf>,
    /// Files with positions and polynomials: csv, json, or both with a comma; csv otherwise
    #[arg(long, value_parser = names::<TableFormat>(), value_delimiter = ',')]
    pub(crate) format: Vec<TableFormat>,
    /// Write an NC program with inverse-time feed: fanuc, siemens, linuxcnc; with a feed per minute: heidenhain
    #[arg(long, value_parser = names::<NcDialect>(), value_delimiter = ',', requires = "time")]
    pub(crate) nc: Vec<NcDialect>,
    /// Seconds that the motion takes, evenly: for NC programs, and for velocity, acceleration and jerk of the axes
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) time: Option<f64>,
    /// Write a function of the motion that returns the axes and their first derivatives: c, rust, javascript
    #[arg(long, value_parser = names::<FunctionLanguage>(), value_delimiter = ',')]
    pub(crate) emit: Vec<FunctionLanguage>,
    /// What the function computes: the polynomials, or the exact axes in closed form
    #[arg(long, value_parser = names::<EmitForm>(), value_delimiter = ',', default_value = "polynomials", requires = "emit")]
    pub(crate) emit_form: Vec<EmitForm>,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is carried over, and which frames of the target stand for the job's.
#[derive(Args, Debug)]
pub(crate) struct Onto {
    /// The surface whose tool is carried over, where the job has several tools
    #[arg(long, value_name = "NAME", requires = "to")]
    pub(crate) surface: Option<String>,
    /// The target's frame that the tool stands in, if it has another name there
    #[arg(long, value_name = "NAME", requires = "to")]
    pub(crate) tool_frame: Option<String>,
    /// The target's frame that the work stands in, if it has another name there
    #[arg(long, value_name = "NAME", requires = "to")]
    pub(crate) work_frame: Option<String>,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

fn seconds(text: &str) -> Result<f64, String> {
    let found = text.trim().trim_end_matches('s').trim().parse::<f64>().ok();
    found
        .filter(|x| x.is_finite() && *x > 0.0)
        .ok_or("write a number of seconds above zero, for example 30".to_string())
}
