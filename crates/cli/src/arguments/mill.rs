//! The arguments of `flank mill`.

use std::path::PathBuf;

use clap::Args;
use flank::{ClampRange, CutterFormat, NcDialect, PointFormat};

use super::choice::{described, names};
use super::sweep::spaced;
use super::{EvaluatorArguments, JobArguments, count, folder, length};

#[derive(Args, Debug)]
#[command(after_help = "\
What is milled is said in the spec: `mill finish of flank with e.cutting in m.work { … }` names a surface, a cutter, a machine, how far
apart passes are and how long blocks, and how the cutter leans.

Examples:
  flank mill specs/bevel/milled_pinion.chain
  flank mill specs/bevel/milled_pinion.chain --format csv,apt --nc linuxcnc,siemens --feed 800 --spindle 12000
  flank mill specs/bevel/milled_pinion.chain --nc siemens --tcp --spaces 19
  flank mill specs/bevel/milled_pinion.chain --clamp mill.work_z=20mm..120mm
  flank mill specs/bevel/milled_pinion.chain finish --verify build/milled_pinion.finish.ngc")]
pub(crate) struct Mill {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The milling, where a job has several; all of them otherwise
    pub(crate) milling: Option<String>,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Files with cutter locations, several with commas
    #[arg(long, value_parser = described::<CutterFormat>(), value_delimiter = ',', default_value = "csv")]
    pub(crate) format: Vec<CutterFormat>,
    /// Write an NC program: fanuc, siemens, linuxcnc, heidenhain
    #[arg(long, value_parser = names::<NcDialect>(), value_delimiter = ',')]
    pub(crate) nc: Vec<NcDialect>,
    /// The control keeps the tip on its way (tool-centre control): it goes straight, and rotary axes turn evenly
    #[arg(long = "tool-centre-control", visible_alias = "tcp")]
    pub(crate) tool_centre_control: bool,
    /// Feed of the contact along the surface, mm/min
    #[arg(long, value_name = "MM/MIN", default_value = "600", value_parser = positive, allow_hyphen_values = true)]
    pub(crate) feed: f64,
    /// Revolutions of the cutter a minute, for programs
    #[arg(long, value_name = "RPM", value_parser = positive, allow_hyphen_values = true)]
    pub(crate) spindle: Option<f64>,
    /// How far above a pass the cutter comes down and is lifted with feed
    #[arg(long, value_name = "LENGTH", default_value = "5mm", value_parser = length, allow_hyphen_values = true)]
    pub(crate) approach: f64,
    /// Spaces of the work that a program mills, one after the other
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = count(1..=1_000_000), allow_hyphen_values = true)]
    pub(crate) spaces: u32,
    /// Read a program and measure what its blocks leave on the surface, in as many spaces as `--spaces` says
    #[arg(long, value_name = "FILE")]
    pub(crate) verify: Option<PathBuf>,
    /// Rows of the points at which what is left is told, by the coordinate that passes are counted by
    #[arg(long, value_name = "COUNT", default_value_t = 15, value_parser = count(1..=1000), allow_hyphen_values = true)]
    pub(crate) rows: u32,
    /// Columns of these points, by the coordinate that passes run along
    #[arg(long, value_name = "COUNT", default_value_t = 31, value_parser = count(1..=1000), allow_hyphen_values = true)]
    pub(crate) columns: u32,
    /// Files with these points: csv, json, parquet, stl, obj, 3mf, vtp, several with commas
    #[arg(long, value_name = "FORMAT", value_parser = names::<PointFormat>(), value_delimiter = ',', default_value = "csv")]
    pub(crate) map: Vec<PointFormat>,
    /// Look for the value of a setting of the milling machine between two with which the axes go slowest: 'mill.work_z=20mm..120mm'; several together
    #[arg(long, value_name = "NAME=FROM..TO", value_parser = clamp_range, allow_hyphen_values = true)]
    pub(crate) clamp: Vec<ClampRange>,
    /// Also prove that the cutter comes nowhere nearer to what it keeps clear of than is asked for, less this: on all blocks, between positions, too
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, require_equals = true, default_missing_value = "1um", value_parser = length)]
    pub(crate) certify: Option<f64>,
    /// Print the numbers as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// `mill.work_z=20mm..120mm`
fn clamp_range(text: &str) -> Result<ClampRange, String> {
    let wanted = || "write NAME=FROM..TO, for example mill.work_z=20mm..120mm".to_string();
    let (setting, ends) = text.split_once('=').ok_or_else(wanted)?;
    let (from, to) = ends.split_once("..").ok_or_else(wanted)?;
    let ends = [from, to].map(|end| spaced(end.trim()));
    let setting = setting.trim().to_string();
    if setting.is_empty() || ends.iter().any(String::is_empty) {
        Err(wanted())
    } else {
        Ok(ClampRange { setting, ends })
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
    found.ok_or("write a number above zero, for example 600".to_string())
}
