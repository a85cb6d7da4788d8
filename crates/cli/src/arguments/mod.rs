//! The command line.

mod choice;
mod contact;
mod convert;
mod fit;
mod measuring;
mod mesh;
mod mill;
mod plot;
mod report;
mod solid;
mod sweep;
mod test;
mod tolerance;

use std::num::NonZero;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf, is_separator};

use clap::builder::{ArgPredicate, PathBufValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use flank::{AmountFault, Code, Coefficients, EvaluatorOptions, PointFormat, Signs, ToleratedAmount};

use choice::{described, names};

pub(crate) use contact::Contact;
pub(crate) use convert::{Convert, Onto};
pub(crate) use fit::{EaseOffWish, Fit};
pub(crate) use measuring::{Deviation, Measure};
pub(crate) use mesh::Mesh;
pub(crate) use mill::Mill;
pub(crate) use plot::Plot;
pub(crate) use report::Report;
pub(crate) use solid::SolidArguments;
pub(crate) use sweep::{Sweep, SweepGather, SweepStep};
pub(crate) use test::Test;
pub(crate) use tolerance::Tolerance;

/// Tooth surfaces of any machine: describe frames, axes, a tool and motions; get the surface that the tool leaves.
#[derive(Parser, Debug)]
#[command(
    name = "flank",
    version,
    after_help = "\
Examples:
  flank solve specs/hobbing/helical_gear.chain          points and a picture into build/
  flank check specs/machines/*.chain                    is it right, and if not, where and why
  flank test specs                                      does it make what it is to make
  flank view specs/bevel/pinion_19x62.chain             a page with the machine in 3-D
  flank derive specs/bevel/pinion_19x62.chain | less    what was built, stage by stage
  flank plot specs/bevel/pinion_19x62.chain             the pictures that matter for the job
  flank report specs/bevel/pinion_19x62.chain           all that is known of it on one page
  flank convert specs/bevel/pinion_19x62.chain --to specs/machines/free_form.chain
  flank fmt specs/tools/*.chain                         the settled layout

Exit codes: 0 done; 1 what was read is wrong or has not what is asked of it, or a file cannot be read or written; 2 the
command line is wrong, whatever the files say; 3 done, but something asked for could not be solved, and it is listed; 4 there is
not the memory that it takes; 141 done, but nobody read to the end what was printed."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Solve the surfaces of a job; write points and a picture
    Solve(Solve),
    /// Parse, resolve and check dimensions
    Check(Check),
    /// Check what specs expect of what is derived from them
    Test(Test),
    /// Carry a job over to another machine: axis positions and polynomials that do the same
    Convert(Convert),
    /// Print what was built: matrices, vector parts, twists, the equation of meshing
    Derive(Derive),
    /// Draw surfaces, maps, contact lines, sections, the machine, its motion
    Plot(Plot),
    /// Write all that is known of a job on one page: inputs, machine, what was solved and how well, what was not checked
    Report(Report),
    /// How far one surface lies off another one of the same body (ease-off, tooth-space width), or measured points off a surface
    Deviation(Deviation),
    /// Which settings make a measured flank, which correct it, and which give a wanted ease-off
    Fit(Fit),
    /// How a surface's ease-off and its contacts scatter with settings and mounting errors, and how far these may
    Tolerance(Tolerance),
    /// Many cases of a job: from a table, from ranges or at random; a row of numbers for each
    Sweep(Box<Sweep>),
    /// Where two flanks touch while a pair rolls, how evenly they turn each other, what the marking compound shows
    Contact(Contact),
    /// Write nominal points and normals for a gear measuring machine
    Measure(Measure),
    /// Cut the bodies of a job into bricks for finite elements: CalculiX, Abaqus, ParaView
    Mesh(Mesh),
    /// Passes of a cutter over a surface on a five-axis machine: what they leave, cutter locations, NC programs; or what a program leaves
    Mill(Mill),
    /// What an error means, with an example and how to mend it
    Explain(Explain),
    /// Make a job of a bevel gear's machine summary in a REXS file
    Import(Import),
    /// Lay out specs as all of them are laid out; comments stay
    Fmt(Fmt),
    /// Write a page to look at: the machine moves, the tool generates the work, in 3-D, without a network
    View(View),
    /// Serve an editor: findings while typing, hover, completion, names, and a page that follows
    Lsp(Lsp),
    /// Make a job of one in the library, with all that it uses; or take a machine or a tool of it
    New(New),
    /// The JSON schemas of all that the program prints and writes as JSON
    Schema(Schema),
    /// Print a script that completes arguments in a shell
    Completions(Completions),
    /// Write manual pages
    Man(Man),
}

impl Command {
    /// Whether documents are asked for.
    pub(crate) fn is_json(&self) -> bool {
        match self {
            Command::Solve(arguments) => arguments.json,
            Command::Check(arguments) => arguments.json,
            Command::Test(arguments) => arguments.json,
            Command::Convert(arguments) => arguments.json,
            Command::Derive(arguments) => arguments.json,
            Command::Measure(arguments) => arguments.json,
            Command::Mesh(arguments) => arguments.json,
            Command::Mill(arguments) => arguments.json,
            Command::Plot(arguments) => arguments.json,
            Command::Report(arguments) => arguments.json,
            Command::Deviation(arguments) => arguments.json,
            Command::Fit(arguments) => arguments.json,
            Command::Tolerance(arguments) => arguments.json,
            Command::Sweep(arguments) => arguments.is_json(),
            Command::Contact(arguments) => arguments.json,
            Command::Explain(arguments) => arguments.json,
            Command::Import(arguments) => arguments.json,
            Command::Fmt(arguments) => arguments.json,
            Command::View(arguments) => arguments.json,
            Command::Lsp(_) => false,
            Command::New(arguments) => arguments.json,
            Command::Schema(arguments) => arguments.json,
            Command::Completions(arguments) => arguments.json,
            Command::Man(arguments) => arguments.json,
        }
    }
}

impl Command {
    /// How the numbers are worked out, of a command that works out some.
    pub(crate) fn evaluator(&self) -> Option<EvaluatorArguments> {
        match self {
            Command::Solve(arguments) => Some(arguments.evaluator),
            Command::Convert(arguments) => Some(arguments.onto.evaluator),
            Command::Derive(arguments) => Some(arguments.onto.evaluator),
            Command::Plot(arguments) => Some(arguments.evaluator),
            Command::Report(arguments) => Some(arguments.evaluator),
            Command::Deviation(arguments) => Some(arguments.evaluator),
            Command::Fit(arguments) => Some(arguments.evaluator),
            Command::Tolerance(arguments) => Some(arguments.evaluator),
            Command::Sweep(arguments) => arguments.evaluator(),
            Command::Contact(arguments) => Some(arguments.evaluator),
            Command::Measure(arguments) => Some(arguments.evaluator),
            Command::Mesh(arguments) => Some(arguments.evaluator),
            Command::Mill(arguments) => Some(arguments.evaluator),
            Command::View(arguments) => Some(arguments.evaluator),
            Command::Test(arguments) => Some(arguments.evaluator),
            Command::Check(_)
            | Command::Explain(_)
            | Command::Import(_)
            | Command::Fmt(_)
            | Command::Lsp(_)
            | Command::New(_)
            | Command::Schema(_)
            | Command::Completions(_)
            | Command::Man(_) => None,
        }
    }
}

/// Which job of which file, with which values.
#[derive(Args, Debug)]
pub(crate) struct JobArguments {
    /// The file that the job stands in; - for stdin
    pub(crate) file: PathBuf,
    /// The job, where the file holds several; all of them otherwise
    #[arg(long, value_name = "NAME")]
    pub(crate) job: Option<String>,
    /// Another value for a job parameter or a setting, with its unit: teeth=25, m.swivel="-3 deg"; of one job where several have it:
    /// pinion.m.swivel="-3 deg"
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = name_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

/// How the numbers are worked out; it changes no bit of them.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct EvaluatorArguments {
    /// Interpret the equations instead of compiling them to machine code; the results are the same bit for bit. For systems
    /// that forbid executable memory, and to rule out machine code as a cause
    #[arg(long)]
    no_jit: bool,
    /// Number of threads, at most four for each processor; otherwise the environment's RAYON_NUM_THREADS, and without that one for
    /// each processor
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<NonZero<usize>>,

    /// Boxes that a search for all branches at one place examines before it reports the rest of the ranges as undecided; those at all
    /// places of a grid examine ten times as many
    #[arg(long, value_name = "N", default_value_t = EvaluatorOptions::default().boxes, value_parser = clap::value_parser!(u64).range(1..=MOST_ASKED_FOR))]
    boxes: u64,
}

/// More boxes take minutes, and rarely decide what these do not.
const MOST_ASKED_FOR: u64 = 10_000_000;

impl EvaluatorArguments {
    pub(crate) fn threads(self) -> Option<NonZero<usize>> {
        self.threads
    }

    pub(crate) fn evaluator(self) -> EvaluatorOptions {
        EvaluatorOptions { machine_code: !self.no_jit, boxes: self.boxes }
    }
}

fn threads(text: &str) -> Result<NonZero<usize>, String> {
    text.trim().parse().map_err(|_| "write a whole number from 1 on".to_string())
}

fn name_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_string(), value.trim().to_string()))
        }
        _ => Err("write NAME=VALUE, for example shift=\"0.5 mm\"".to_string()),
    }
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank solve specs/hobbing/helical_gear.chain
  flank solve specs/hobbing/helical_gear.chain --set teeth=37 --set helix_angle=\"15 deg\"
  flank solve specs/bevel/pinion_19x62.chain --out pinion --format csv,json,stl
  flank solve specs/bevel/pinion_19x62.chain --geometry
  flank solve specs/bevel/pinion_19x62.chain --sensitivity
  flank solve specs/hobbing/spur_gear.chain --json --no-picture
  flank solve specs/bevel/gear_19x62.chain --solid gear --format stl,3mf   the closed body, its volume, mass and inertia")]
pub(crate) struct Solve {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Files with the points, several with commas
    #[arg(long, value_parser = described::<PointFormat>(), value_delimiter = ',', default_value = "csv", default_value_if("solid", ArgPredicate::IsPresent, "stl"))]
    pub(crate) format: Vec<PointFormat>,
    #[command(flatten)]
    pub(crate) body: SolidArguments,
    #[command(flatten)]
    pub(crate) faces: Faces,
    /// Also find where each surface turns back (the singular line of undercut) and where the tool's contact ends
    #[arg(long)]
    pub(crate) limits: bool,
    /// Write no picture (otherwise a PNG and an SVG)
    #[arg(long)]
    pub(crate) no_picture: bool,
    /// Add to each point: principal curvatures and directions (k1, k2, d1, d2), sliding velocity, contact line and the angle
    /// between them, curvatures of the gap between tool and work (induced_*), the metric of the sampled coordinates
    #[arg(long)]
    pub(crate) geometry: bool,
    /// Add to each point how far it moves along its normal when a parameter of the job or a setting changes (d_normal/d_NAME:
    /// um per mm, per arcmin, per 0.001 of a number), rank the parameters, draw maps of the most influential
    #[arg(long)]
    pub(crate) sensitivity: bool,
    /// Prove of each point that exactly one root lies near it, and print how near; a point that cannot be certified is named
    #[arg(long)]
    pub(crate) certify: bool,
    /// Print the table as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// The smooth faces of a STEP file.
#[derive(Args, Debug)]
pub(crate) struct Faces {
    /// Also write the surfaces as smooth faces into a STEP file, through as many points as keep them within a distance of the exact
    /// surface (0.1um unless it says another)
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, require_equals = true, default_missing_value = "0.1um", value_parser = length)]
    pub(crate) step: Option<f64>,
}

/// Extensions that no folder for results is made with.
const OF_FILES: [&str; 14] =
    ["csv", "json", "parquet", "stl", "obj", "3mf", "vtp", "step", "inp", "vtu", "png", "svg", "html", "md"];

/// The folder of `--out`.
fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(no_file)
}

fn no_file(path: PathBuf) -> Result<PathBuf, String> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let ends_as_folder = path.as_os_str().as_encoded_bytes().last().is_some_and(|last| is_separator(char::from(*last)));
    if ends_as_folder || !OF_FILES.contains(&extension) {
        return Ok(path);
    }
    let above = path.parent().filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Err(format!(
        "a folder is wanted, and that looks like a file; say --out {}, files are named after the job, or --out {}/ if the folder is \
         called so",
        above.display(),
        path.display()
    ))
}

/// A length in mm.
fn length(text: &str) -> Result<f64, String> {
    match flank::read_amount(text) {
        Ok(ToleratedAmount::Length(length)) if length > 0.0 => Ok(length),
        Ok(ToleratedAmount::Length(_)) => Err("a length above zero is needed, for example 0.1um".to_string()),
        Err(fault @ AmountFault::UnknownUnit(_)) => Err(fault.to_string()),
        _ => Err("write a length with its unit, for example 0.1um".to_string()),
    }
}

/// A whole number within a range.
fn count(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync {
    move |text| {
        let found = text.trim().parse::<u32>().ok().filter(|count| range.contains(count));
        found.ok_or(format!("write a whole number from {} to {}", range.start(), range.end()))
    }
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank check specs/hobbing/helical_gear.chain
  flank check specs/*/*.chain
  flank check --json my_machine.chain
  flank check - < draft.chain          files that it uses are looked for from the current folder")]
pub(crate) struct Check {
    /// The files; - for stdin
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// With --json, also all names: place, what each is, where it is defined, its values
    #[arg(long, requires = "json")]
    pub(crate) index: bool,
}

#[derive(Args, Debug)]
#[command(mut_arg("job", |job| job.help("The job, where the file holds several; all of them otherwise, but with --to one at a time")))]
#[command(after_help = "\
Examples:
  flank derive specs/hobbing/helical_gear.chain
  flank derive specs/bevel/pinion_19x62.chain --latex > pinion.tex
  flank derive specs/hobbing/spur_gear.chain --set teeth=10
  flank derive specs/hobbing/helical_gear.chain --cost  how many operations a point takes
  flank derive specs/bevel/tilted_pinion.chain --surface concave --to specs/machines/free_form.chain")]
pub(crate) struct Derive {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// Print LaTeX instead of text
    #[arg(long)]
    pub(crate) latex: bool,
    /// Print the axes of another machine in closed form: the file of that machine
    #[arg(long, value_name = "FILE", conflicts_with = "cost")]
    pub(crate) to: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) onto: Onto,
    /// Print the number of operations that the equations for a point take, with their Jacobian
    #[arg(long, conflicts_with = "latex")]
    pub(crate) cost: bool,
    /// Print JSON: the pages, or the numbers of operations
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank explain                 all codes
  flank explain E0301           the page about one of them
  flank explain --json E0301")]
pub(crate) struct Explain {
    /// The code, as a report shows it; without one, all codes are listed
    pub(crate) code: Option<Code>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
The job goes to stdout. REXS says neither in which frames its signs are nor what its coefficients multiply, so both must be said;
they are written at the head of the job. Signs:
  frames            as they are in the file, taken for those of the frames of cradle_generator
  left-hand-pinion  of machine summaries: tilt, swivel and cradle angle of a left-hand pinion are reversed, coefficients are not
  right-hand-gear   of machine summaries: tilt and work offset of its right-hand gear are reversed, coefficients are not

Examples:
  flank import pinion.rexs --signs left-hand-pinion --outside 21 --inside 22 > pinion.chain
  flank import pinion.rexs --signs frames --coefficients taylor --settings 12 --outside 21 > pinion.chain")]
pub(crate) struct Import {
    /// The REXS file
    pub(crate) file: PathBuf,
    /// In which frames the file's signs are
    #[arg(long, value_parser = names::<Signs>())]
    pub(crate) signs: Signs,
    /// What the coefficients of motions are: of powers of the roll (polynomial), or to be divided by the factorials (taylor)
    #[arg(long, value_parser = names::<Coefficients>())]
    pub(crate) coefficients: Option<Coefficients>,
    /// The bevel_gear_manufacturing_settings, where the file holds several
    #[arg(long, value_name = "ID")]
    pub(crate) settings: Option<String>,
    /// The bevel_gear_tool with the outside blades
    #[arg(long, value_name = "ID")]
    pub(crate) outside: Option<String>,
    /// The bevel_gear_tool with the inside blades
    #[arg(long, value_name = "ID")]
    pub(crate) inside: Option<String>,
    /// The name of the job
    #[arg(long, default_value = "imported", value_parser = job_name)]
    pub(crate) name: String,
    /// Where the library lies, seen from the job's file
    #[arg(long, value_name = "DIR", default_value = "specs", value_parser = quotable)]
    pub(crate) library: String,
    /// Print the job within JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Prints the files that changed. A file that does not parse is reported and stays as it is.

Examples:
  flank fmt my_machine.chain
  flank fmt --check specs/*/*.chain    changes nothing; exit code 1 if something would change, and what
  flank fmt - < draft.chain            from stdin to stdout")]
pub(crate) struct Fmt {
    /// The files; - for stdin to stdout
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Change nothing, list the files that would change
    #[arg(long)]
    pub(crate) check: bool,
    /// Print as JSON what became of each file
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
One HTML file for each job, which any browser opens by itself. Sliders move the machine and, within limits, the job's parameters:
the page then solves the same equations anew, from the points solved here.

Examples:
  flank view specs/bevel/pinion_19x62.chain
  flank view specs/hobbing/helical_gear.chain --set teeth=37 --out pages
  flank view specs/bevel/ease_off_19x62.chain --job conjugate --json
  flank view specs/bevel/pinion_19x62.chain --serve     a page on this machine that follows each save")]
pub(crate) struct View {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// Folder for the pages; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Print files and sizes as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Write no file: serve the page on this machine and print where; it follows what is saved, until the program is ended
    #[arg(long, conflicts_with_all = ["json", "out"])]
    pub(crate) serve: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Editors start it by themselves; it reads and writes the Language Server Protocol on stdin and stdout, and writes no file that nobody
asked for.

Examples:
  flank lsp    for an editor; see docs/editors.md")]
pub(crate) struct Lsp {}

#[derive(Args, Debug)]
#[command(after_help = "\
Every command takes --json and then prints documents on stdout, each with a `schema` that names its kind and version: one for
each job where a file holds several, and flank.failure/1 where the command fails.

Examples:
  flank schema                  all schemas
  flank schema flank.solve/3    one of them, JSON Schema 2020-12
  flank schema solve            the same")]
pub(crate) struct Schema {
    /// The schema, with or without `flank.` and version; without one, all are listed
    pub(crate) name: Option<String>,
    /// List as JSON; a schema is JSON anyway
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank completions bash > ~/.local/share/bash-completion/completions/flank
  flank completions fish > ~/.config/fish/completions/flank.fish
  flank completions powershell >> $PROFILE")]
pub(crate) struct Completions {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
    /// Print the script within JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank man --out ~/.local/share/man/man1
  man flank-solve")]
pub(crate) struct Man {
    /// Folder for the pages; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "build", value_parser = folder())]
    pub(crate) out: PathBuf,
    /// Print the files as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  flank new                                                   what there is to start from
  flank new helical_gear --name my_gear --set teeth=37 --set helix_angle=\"15 deg\"
  flank new pinion_19x62 --interactive --out my_gears                 asks for each parameter; Enter keeps it
  flank new hobbing_6axis --name my_machine                   a variant of a machine, to go on with
  flank new hob_zi                                            a tool as it is")]
pub(crate) struct New {
    /// The job, machine or tool to start from; without one, all are listed
    pub(crate) template: Option<String>,
    /// What the new job is called, or the variant of a machine
    #[arg(long, value_name = "NAME", value_parser = job_name, requires = "template")]
    pub(crate) name: Option<String>,
    /// Give a parameter another value
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = name_and_value, requires = "template")]
    pub(crate) set: Vec<(String, String)>,
    /// Ask for each parameter that is not set
    #[arg(long, requires = "template")]
    pub(crate) interactive: bool,
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = ".", value_parser = folder(), requires = "template")]
    pub(crate) out: PathBuf,
    /// Print what there is to start from, or the files, as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What may stand between the quotes of `use`.
fn quotable(text: &str) -> Result<String, String> {
    let breaks = |letter: char| letter.is_control() || letter == '"';
    if text.contains(breaks) { Err("it stands between quotes in the job".to_owned()) } else { Ok(text.to_owned()) }
}

fn job_name(text: &str) -> Result<String, String> {
    let is_word = text.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    let is_name = is_word && text.starts_with(|letter: char| letter.is_ascii_alphabetic());
    if !is_name {
        return Err("a file is called so, too: letters from a to z, digits and _, a letter first".to_owned());
    }
    if flank::is_reserved(text) {
        return Err("this is a word of the language and cannot be a name".to_owned());
    }
    Ok(text.to_owned())
}
