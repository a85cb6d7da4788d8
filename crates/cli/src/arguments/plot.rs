//! The arguments of `flank plot`.

use std::path::PathBuf;

use clap::Args;
use flank::{MountingError, PictureFormat, PlotKind};

use super::choice::{described, names};
use super::contact::error;
use super::{EvaluatorArguments, JobArguments, count, folder, length};

#[derive(Args, Debug)]
#[command(after_help = "\
Without --what: the first three that fit of deviation, left, surface, section, contact-lines, machine, curvature.

Maps show the first surface that is sampled, or those of --surface.

Examples:
  flank plot specs/hobbing/helical_gear.chain
  flank plot specs/bevel/pinion_19x62.chain --what section,machine,motion --surface convex
  flank plot specs/hobbing/spur_gear.chain --what contact-lines --surface flank_plus,flank_minus --format svg
  flank plot specs/bevel/pinion_19x62.chain --what sensitivity --of m.radial_distance,c.blade_angle
  flank plot specs/bevel/ease_off_19x62.chain --what topography --surface pinion.concave --reference conjugate.concave
  flank plot specs/pairs/bevel_19x62.chain --what pattern,error --error m.S=2arcmin")]
pub(crate) struct Plot {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// What is drawn, several with commas
    #[arg(long, value_parser = described::<PlotKind>(), value_delimiter = ',')]
    pub(crate) what: Vec<PlotKind>,
    /// The surfaces that pictures show, several with commas; otherwise maps show the first that is sampled
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) surface: Vec<String>,
    /// The surface that the one of --surface is compared with: for deviation and topography
    #[arg(long, value_name = "SURFACE", requires = "surface")]
    pub(crate) reference: Option<String>,
    /// The parameters or settings whose influence `sensitivity` shows; those that do most otherwise
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) of: Vec<String>,
    /// The contacts that pattern, error, gap and path show, several with commas; otherwise all of the job, side by side
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) contact: Vec<String>,
    /// The milling of the picture `milling`; the first of a job otherwise
    #[arg(long, value_name = "NAME")]
    pub(crate) milling: Option<String>,
    /// For pictures of contacts: an axis of the pair's machine that is mounted wrong, with its unit: m.E=0.1mm, m.S=2arcmin
    #[arg(long = "error", value_name = "AXIS=VALUE", value_parser = error)]
    pub(crate) errors: Vec<(String, MountingError)>,
    /// For pictures of contacts: roll positions over a pitch [default: 60]
    #[arg(long, value_name = "COUNT", value_parser = count(4..=10_000), allow_hyphen_values = true)]
    pub(crate) positions: Option<u32>,
    /// For pictures of contacts: thickness of the marking compound [default: 6.35um]
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub(crate) compound: Option<f64>,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// png, svg, or both with a comma
    #[arg(long, value_parser = names::<PictureFormat>(), value_delimiter = ',', default_value = "png,svg")]
    pub(crate) format: Vec<PictureFormat>,
    /// Pixels across and down; lines and letters grow with them
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1200x900", value_parser = pixels)]
    pub(crate) size: (u32, u32),
    /// Leave out the line with spec, hash and program, and residuals, as a paper wants it
    #[arg(long)]
    pub(crate) no_origin: bool,
    /// Print what the files show as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// Pixels across and down.
fn pixels(text: &str) -> Result<(u32, u32), String> {
    let side = |digits: &str| digits.trim().parse::<u32>().ok().filter(|side| (64..=16_384).contains(side));
    let both = text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?)));
    both.ok_or("write two numbers from 64 to 16384, for example 2400x1800".to_string())
}
