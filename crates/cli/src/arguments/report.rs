//! The arguments of `flank report`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use flank::ReportFormat;

use super::choice::described;
use super::{EvaluatorArguments, Faces, JobArguments, no_file};

#[derive(Args, Debug)]
#[command(after_help = "\
One file for each job, JOB.report.html or JOB.report.md; the pictures of Markdown lie beside it. The same job gives the same bytes:
there is no date unless one is given.

Examples:
  flank report specs/bevel/pinion_19x62.chain
  flank report specs/bevel/pinion_19x62.chain --certify --date 2026-11-21 --out order_4711.html
  flank report specs/hobbing/undercut_gear.chain --set teeth=12 --format html,md --out reports
  flank report specs/hobbing/helical_gear.chain --json")]
pub(crate) struct Report {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// Folder for the files, made if it is not there; or a file that ends in .html or .md
    #[arg(long, value_name = "PATH", default_value = "build", value_parser = page_or_folder())]
    pub(crate) out: PathBuf,
    /// html, md, or both with a comma; html, or what the file of --out is, without it
    #[arg(long, value_parser = described::<ReportFormat>(), value_delimiter = ',')]
    pub(crate) format: Vec<ReportFormat>,
    /// Prove of each point that exactly one root lies near it, and state how near
    #[arg(long)]
    pub(crate) certify: bool,
    #[command(flatten)]
    pub(crate) faces: Faces,
    /// A date, or another mark, to stand on the page
    #[arg(long, value_name = "TEXT")]
    pub(crate) date: Option<String>,
    /// Print what is on the page as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

fn page_or_folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new()
        .try_map(|path| if ReportFormat::of_path(&path).is_some() { Ok(path) } else { no_file(path) })
}
