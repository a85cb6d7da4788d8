//! The arguments of `flank measure` and `flank deviation`.

use std::path::PathBuf;

use clap::Args;
use flank::{PointFormat, TableFormat};

use super::choice::{described, names};
use super::{EvaluatorArguments, JobArguments, count, folder};

#[derive(Args, Debug)]
#[command(after_help = "\
Rows run from root to tip (of a root or a tip itself from its left side to its right one), columns along the tooth from toe to heel
(from the lower to the upper face, from the inner to the outer end), both count from 1. The grid lies in the area that the job samples. Normals point out of the material: plus is material.

Examples:
  flank measure specs/bevel/pinion_19x62.chain
  flank measure specs/bevel/pinion_19x62.chain --surface concave --rows 5 --columns 9 --margin 0.1,0.05 --format csv,json
  flank measure specs/hobbing/helical_gear.chain --lines 101       profile and lead lines, too
  flank deviation specs/bevel/pinion_19x62.chain concave --measured measured.csv    and back")]
pub(crate) struct Measure {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The surfaces, several with commas; all that are sampled otherwise
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) surface: Vec<String>,
    /// Rows of the grid
    #[arg(long, value_name = "COUNT", default_value_t = 5, value_parser = count(2..=1000), allow_hyphen_values = true)]
    pub(crate) rows: u32,
    /// Columns of the grid
    #[arg(long, value_name = "COUNT", default_value_t = 9, value_parser = count(2..=1000), allow_hyphen_values = true)]
    pub(crate) columns: u32,
    #[command(flatten)]
    pub(crate) margin: Margin,
    /// Also the profile line and the lead line through the middle, with so many points each
    #[arg(long, value_name = "COUNT", value_parser = count(2..=100_000), allow_hyphen_values = true)]
    pub(crate) lines: Option<u32>,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// csv, json, or both with a comma
    #[arg(long, value_parser = names::<TableFormat>(), value_delimiter = ',', default_value = "csv")]
    pub(crate) format: Vec<TableFormat>,
    /// Print as JSON what the files hold
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// Where in the sampled area a measuring grid lies.
#[derive(Args, Debug)]
pub(crate) struct Margin {
    /// What a measuring grid leaves out at each end of the sampled area, as a share of it: from root to tip and along the tooth
    /// if there are two numbers; 0.05 otherwise
    #[arg(long, value_name = "SHARE[,SHARE]", value_parser = margins, allow_hyphen_values = true)]
    pub(crate) margin: Option<[f64; 2]>,
}

fn margins(text: &str) -> Result<[f64; 2], String> {
    let share = |text: &str| text.trim().parse::<f64>().ok().filter(|share| (0.0..0.5).contains(share));
    let both = match text.split_once(',') {
        Some((profile, length)) => share(profile).zip(share(length)).map(Into::into),
        None => share(text).map(|both| [both; 2]),
    };
    both.ok_or("write one share or two from 0 to below 0.5, for example 0.1,0.05".to_string())
}

#[derive(Args, Debug)]
#[command(after_help = "\
The deviation is signed, in um, plus is material: along the normal of the surface after --reference, at the points of that one's sample.
A surface is named as in the spec, with its job where the file holds several: JOB.SURFACE. The frames of both are laid onto each
other. Without --no-align the surface is first turned about z, a rack's shifted along y, until both meet in the middle of the grid.

With --measured, the points of a file are compared with the surface: a CSV table with row and column as `flank measure` counts them,
and x, y, z in mm or deviation_um. Without --no-align they are first turned about z, a rack's shifted
along y, until the sum of the squares is least.

Examples:
  flank deviation specs/bevel/ease_off_19x62.chain pinion.concave --reference conjugate.concave
  flank deviation specs/bevel/gear_19x62.chain concave --reference convex --no-align    width of the tooth space
  flank deviation specs/bevel/pinion_19x62.chain concave --measured measured.csv")]
pub(crate) struct Deviation {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The surface
    pub(crate) surface: String,
    /// The surface that it is compared with; it is sampled in the spec
    #[arg(long, value_name = "SURFACE", conflicts_with = "measured")]
    pub(crate) reference: Option<String>,
    /// Measured points that are compared with the surface, which is sampled in the spec
    #[arg(long, value_name = "FILE")]
    pub(crate) measured: Option<PathBuf>,
    /// Rows of the grid that was measured; the largest that the file names otherwise
    #[arg(long, value_name = "COUNT", value_parser = count(1..=10_000), allow_hyphen_values = true)]
    pub(crate) rows: Option<u32>,
    /// Columns of that grid, the same way
    #[arg(long, value_name = "COUNT", value_parser = count(1..=10_000), allow_hyphen_values = true)]
    pub(crate) columns: Option<u32>,
    #[command(flatten)]
    pub(crate) margin: Margin,
    /// Do not turn it
    #[arg(long)]
    pub(crate) no_align: bool,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Files with the points, several with commas
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
