//! The arguments of `flank test`.

use std::path::PathBuf;

use clap::Args;

use super::{EvaluatorArguments, folder};

#[derive(Args, Debug)]
#[command(after_help = "\
A spec says what it is to be like with `expect` in its jobs and machines. A snapshot beside it says what it derived once: it is written
with --accept, and compared from then on.

Examples:
  flank test                                    all specs below this folder
  flank test specs --filter helical             those of them that are called so
  flank test specs --json                       as a document
  flank test specs --junit tests.xml --annotate for servers that build software
  flank test my_gear.chain --watch              again whenever a file that it reads is saved
  flank test my_gear.chain --accept             keep what it derives
  flank test specs --review                     look at what differs, one spec after the other

Exit codes: 0 all hold; 3 something does not; see `flank --help` for the others.")]
pub(crate) struct Test {
    /// Specs, and folders with specs
    #[arg(default_value = ".")]
    pub(crate) paths: Vec<PathBuf>,
    /// Only jobs and machines whose FILE:NAME contains this text; snapshots are not compared then
    #[arg(long, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// Write snapshots of what is derived now, where it differs or there is none
    #[arg(long, conflicts_with_all = ["filter", "review", "watch"])]
    pub(crate) accept: bool,
    /// Ask of each snapshot that differs what is to become of it
    #[arg(long, conflicts_with_all = ["filter", "watch", "json"])]
    pub(crate) review: bool,
    /// Test again what a saved file touches, until the program is ended
    #[arg(long, conflicts_with = "json")]
    pub(crate) watch: bool,
    /// Also write the results as JUnit's XML
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// Also print each failure as an annotation for the forge that runs the test
    #[arg(long, conflicts_with = "json")]
    pub(crate) annotate: bool,
    /// Print the results as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for the maps of what moved; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}
