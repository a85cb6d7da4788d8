//! The arguments of `flank sweep`.

use std::num::NonZero;
use std::path::PathBuf;

use clap::{ArgMatches, Args, Command, Error, FromArgMatches, Subcommand, ValueEnum};
use flank::{CaseSource, Distribution, RunRequest, StudyChunks, SweepRequest, VariedRange};

use super::tolerance::above_zero;
use super::{EvaluatorArguments, JobArguments, count};
use crate::failure::Failure;

const HELP: &str = "\
A study is a folder: its plan, the texts of the spec, and chunks of rows. A chunk is the same bytes whoever computes it and whenever; a run
that was killed goes on where it stopped, and several runs may share the chunks of one study.

Collected: points, requirements, limits, ease_off:SURFACE, width:SURFACE,SURFACE, curvature:SURFACE, at:SURFACE[row,column], contact:CONTACT.

Examples:
  flank sweep specs/bevel/pinion_19x62.chain --scatter 'm.radial_distance=normal(10um)' --count 1000 --seed 7 --collect ease_off:concave --out study
  flank sweep specs/bevel/pinion_19x62.chain --vary 'm.radial_distance=97.9mm..98.1mm by 21' --collect points --out study
  flank sweep plan specs/bevel/pinion_19x62.chain --cases table.csv --collect points --out study
  flank sweep run study --chunks 0..9
  flank sweep gather study --out rows.csv";

/// A study from its plan to its rows, or a step of it.
#[derive(Debug)]
pub(crate) enum Sweep {
    All(SweepPlan),
    Step(SweepStep),
}

/// Either the arguments of a plan or a subcommand.
impl Args for Sweep {
    fn augment_args(command: Command) -> Command {
        SweepStep::augment_subcommands(SweepPlan::augment_args(command))
            .args_conflicts_with_subcommands(true)
            .subcommand_negates_reqs(true)
            .subcommand_required(false)
            .arg_required_else_help(true)
            .after_help(HELP)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Sweep::augment_args(command)
    }
}

impl FromArgMatches for Sweep {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Sweep, Error> {
        match matches.subcommand_name() {
            Some(_) => SweepStep::from_arg_matches(matches).map(Sweep::Step),
            None => SweepPlan::from_arg_matches(matches).map(Sweep::All),
        }
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Sweep::from_arg_matches(matches)?;
        Ok(())
    }
}

#[derive(Subcommand, Debug)]
pub(crate) enum SweepStep {
    /// Make the folder of a study, and compute nothing
    Plan(SweepPlan),
    /// Compute the chunks of a study that are not there
    Run(SweepRun),
    /// How far a study is
    Status(SweepStatus),
    /// All rows of a study in the order of its cases
    Gather(SweepGather),
}

#[derive(Args, Debug)]
pub(crate) struct SweepPlan {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// A table of cases: a column for each parameter or setting, with its unit, as `m.radial_distance [mm]`; CSV or Parquet
    #[arg(long, value_name = "FILE", conflicts_with_all = ["vary", "scatter"])]
    pub(crate) cases: Option<PathBuf>,
    /// Values of a parameter from one to another: 'm.radial_distance=97.9mm..98.1mm by 21'; of several all combinations
    #[arg(long, value_name = "NAME=FROM..TO by COUNT", value_parser = varied, conflicts_with = "scatter", allow_hyphen_values = true)]
    pub(crate) vary: Vec<VariedRange>,
    /// How a parameter scatters about its value: 'm.radial_distance=normal(10um)', 'm.E=uniform(0.05mm)'
    #[arg(long, value_name = "NAME=DISTRIBUTION", value_parser = scattered)]
    pub(crate) scatter: Vec<(String, Distribution)>,
    /// How many random cases
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = count(1..=100_000_000), conflicts_with_all = ["cases", "vary"])]
    pub(crate) count: u32,
    /// Another number gives other random cases
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed, allow_hyphen_values = true, conflicts_with_all = ["cases", "vary"])]
    pub(crate) seed: u64,
    /// Scatter by the points of Sobol's sequence, which fill the space evenly
    #[arg(long, conflicts_with_all = ["cases", "vary"])]
    pub(crate) sobol: bool,
    /// What becomes of each case, several with commas
    #[arg(long, value_name = "WHAT", required = true)]
    pub(crate) collect: Vec<String>,
    /// Keep what a row has no room for: the points of all samples, a CSV file for each case in the folder `points` of the study
    #[arg(long, value_name = "WHAT", value_enum)]
    pub(crate) keep: Option<Kept>,
    /// How long a case may take, seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) limit: Option<f64>,
    /// The folder of the study
    #[arg(long, value_name = "FOLDER", default_value = "study")]
    pub(crate) out: PathBuf,
    /// Print what is known of the study as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// What of each case is kept as a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kept {
    /// The points of all samples
    Points,
}

#[derive(Args, Debug)]
pub(crate) struct SweepRun {
    /// The folder of the study
    pub(crate) study: PathBuf,
    /// The chunks from the first to the last of these, counted from 0: 40..59
    #[arg(long, value_name = "FIRST..LAST", value_parser = chunks)]
    pub(crate) chunks: Option<(usize, usize)>,
    /// One of several even parts of the chunks, counted from 0: 3/10
    #[arg(long, value_name = "PART/PARTS", value_parser = part, conflicts_with = "chunks")]
    pub(crate) part: Option<(usize, usize)>,
    /// Compute cases with these verdicts again: crashed, limit
    #[arg(long, value_name = "VERDICT", value_delimiter = ',')]
    pub(crate) again: Vec<String>,
    /// Print what is known of the study as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

#[derive(Args, Debug)]
pub(crate) struct SweepStatus {
    /// The folder of the study
    pub(crate) study: PathBuf,
    /// Print it as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct SweepGather {
    /// The folder of the study
    pub(crate) study: PathBuf,
    /// Write the rows to a file instead of printing them: a table of Parquet where its name ends with .parquet, CSV with .csv or
    /// without an ending
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Print what is known of the study as JSON; the rows go to --out
    #[arg(long, requires = "out")]
    pub(crate) json: bool,
}

impl Sweep {
    pub(crate) fn is_json(&self) -> bool {
        match self {
            Sweep::All(plan) | Sweep::Step(SweepStep::Plan(plan)) => plan.json,
            Sweep::Step(SweepStep::Run(run)) => run.json,
            Sweep::Step(SweepStep::Status(status)) => status.json,
            Sweep::Step(SweepStep::Gather(gather)) => gather.json,
        }
    }

    pub(crate) fn evaluator(&self) -> Option<EvaluatorArguments> {
        match self {
            Sweep::All(plan) | Sweep::Step(SweepStep::Plan(plan)) => Some(plan.evaluator),
            Sweep::Step(SweepStep::Run(run)) => Some(run.evaluator),
            Sweep::Step(SweepStep::Status(_) | SweepStep::Gather(_)) => None,
        }
    }
}

impl SweepPlan {
    /// # Errors
    /// If the standard input cannot be read, or nothing differs from case to case.
    pub(crate) fn request(&self) -> Result<SweepRequest, Failure> {
        let cases = match (&self.cases, &self.vary[..], &self.scatter[..]) {
            (Some(table), ..) => CaseSource::Table(table.clone()),
            (None, [], []) => {
                return Err(Failure::of_usage(
                    "say what differs from case to case: --cases FILE, --vary or --scatter".to_string(),
                ));
            }
            (None, ranges, []) => CaseSource::Ranges(ranges.to_vec()),
            (None, _, settings) => CaseSource::Scatter {
                settings: settings.to_vec(),
                count: u64::from(self.count),
                seed: self.seed,
                sobol: self.sobol,
            },
        };
        Ok(SweepRequest {
            jobs: self.which.jobs()?,
            cases,
            collect: self.collect.clone(),
            keep_points: self.keep == Some(Kept::Points),
            out: self.out.clone(),
            limit: self.limit.map(std::time::Duration::from_secs_f64),
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl SweepRun {
    pub(crate) fn request(&self) -> RunRequest {
        let chunks = match (self.chunks, self.part) {
            (Some((first, last)), _) => StudyChunks::Between(first, last),
            (None, Some((part, parts))) => StudyChunks::Part(part, parts),
            (None, None) => StudyChunks::All,
        };
        RunRequest {
            study: self.study.clone(),
            chunks,
            again: self.again.clone(),
            evaluator: self.evaluator.evaluator(),
        }
    }
}

/// `m.radial_distance=97.9mm..98.1mm by 21`
fn varied(text: &str) -> Result<VariedRange, String> {
    let wanted = || "write NAME=FROM..TO by COUNT, for example 'm.radial_distance=97.9mm..98.1mm by 21'".to_string();
    let (name, rest) = text.split_once('=').ok_or_else(wanted)?;
    let (ends, count) = rest.rsplit_once(" by ").ok_or_else(wanted)?;
    let (from, to) = ends.split_once("..").ok_or_else(wanted)?;
    let count: NonZero<u32> = count.trim().parse().map_err(|_| wanted())?;
    let ends = [from, to].map(|end| spaced(end.trim()));
    if name.trim().is_empty() || ends.iter().any(String::is_empty) {
        return Err(wanted());
    }
    Ok(VariedRange { name: name.trim().to_string(), ends, count: count.get() })
}

/// A number and its unit with a blank between, as the language reads them.
pub(super) fn spaced(text: &str) -> String {
    let unit = text.find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E').unwrap_or(text.len());
    let (number, unit) = text.split_at(unit);
    // a product that begins with a stroke is shown so, and the language has a power for it
    if let Ok(amount) = flank::read_amount(text)
        && number.trim_end().ends_with('/')
    {
        return amount.to_string();
    }
    format!("{} {}", number.trim(), unit.trim()).trim().to_string()
}

/// `m.radial_distance=normal(10um)`
fn scattered(text: &str) -> Result<(String, Distribution), String> {
    let wanted = || {
        "write NAME=normal(AMOUNT) or NAME=uniform(AMOUNT), for example 'm.radial_distance=normal(10um)'".to_string()
    };
    let (name, rest) = text.split_once('=').ok_or_else(wanted)?;
    let (kind, inner) = rest.trim().strip_suffix(')').and_then(|rest| rest.split_once('(')).ok_or_else(wanted)?;
    let name = Some(name.trim()).filter(|name| !name.is_empty()).ok_or_else(wanted)?;
    let distribution = match kind.trim() {
        "normal" => Distribution::Normal(above_zero(inner)?),
        "uniform" => Distribution::Uniform(above_zero(inner)?),
        _ => return Err(wanted()),
    };
    Ok((name.to_string(), distribution))
}

fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

fn chunks(text: &str) -> Result<(usize, usize), String> {
    let wanted = || "write FIRST..LAST, for example 40..59".to_string();
    let (first, last) = text.split_once("..").ok_or_else(wanted)?;
    Ok((first.trim().parse().map_err(|_| wanted())?, last.trim().parse().map_err(|_| wanted())?))
}

fn part(text: &str) -> Result<(usize, usize), String> {
    let wanted = || "write PART/PARTS, the first part is 0: for example 3/10".to_string();
    let (part, parts) = text.split_once('/').ok_or_else(wanted)?;
    let found = (part.trim().parse().map_err(|_| wanted())?, parts.trim().parse().map_err(|_| wanted())?);
    if found.0 < found.1 { Ok(found) } else { Err(wanted()) }
}

fn seconds(text: &str) -> Result<f64, String> {
    let found = text.trim().trim_end_matches('s').trim().parse::<f64>().ok();
    found.filter(|of| of.is_finite() && *of > 0.0).ok_or_else(|| "write seconds, for example 60".to_string())
}
