//! What can be asked of a spec. Lengths are mm, times seconds.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Dimension, Job, Request};

use crate::project::Project;
use crate::project::choices::{
    BrickFormat, CutterFormat, ElementOrder, EmitForm, FunctionLanguage, MeshFormat, NcDialect, PictureFormat,
    PlotKind, PointFormat, ReportFormat, SolidPart, TableFormat,
};
use crate::project::failure::Failure;
use crate::project::session::EvaluatorOptions;

/// Which jobs of a spec, with which values. A [`Job`](crate::Job) makes one of itself.
#[derive(Clone, Debug)]
pub struct JobSelection {
    /// The spec.
    pub project: Project,
    /// The job, where the spec holds several; all of them otherwise.
    pub job: Option<String>,
    /// Other values for job parameters and settings, each with its unit: `teeth` and `25`, `pinion.m.swivel` and `-3 deg`.
    pub set: Vec<(String, String)>,
}

impl JobSelection {
    /// All jobs of a spec, as they are written.
    pub fn all(project: Project) -> JobSelection {
        JobSelection { project, job: None, set: Vec::new() }
    }

    /// The file of the spec.
    pub fn file(&self) -> &Path {
        self.project.file()
    }

    pub(crate) fn request(&self) -> Request<'_> {
        let files = self.project.shared_files();
        Request { files, job: self.job.as_deref(), set: &self.set, whole: false, ..Request::default() }
    }

    /// # Errors
    /// If one name is empty or set twice, whatever the file says.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self.set.iter().any(|(name, _)| name.trim().is_empty()) {
            return Err(Failure::Request("a value is set without a name: name a parameter or a setting".to_string()));
        }
        let twice =
            self.set.iter().enumerate().find(|(k, (name, _))| self.set[..*k].iter().any(|(known, _)| known == name));
        match twice {
            Some((_, (name, _))) => {
                Err(Failure::Request(format!("the option `set {name}=…` is given twice: leave one of them out")))
            }
            None => Ok(()),
        }
    }

    /// The values that were set by hand, of parameters and settings of these jobs.
    pub(crate) fn set_in(&self, jobs: &[&Job<'_>]) -> Vec<&(String, String)> {
        self.set.iter().filter(|(name, _)| jobs.iter().any(|job| self.changes(name, job))).collect()
    }

    /// Whether a value that was set by hand changes a job; one with the job's name before it goes before one for all jobs.
    pub(crate) fn changes(&self, name: &str, job: &Job<'_>) -> bool {
        let own = format!("{}.{name}", job.name);
        job.has_parameter(name) && !self.set.iter().any(|(other, _)| *other == own)
    }
}

/// Points of surfaces.
#[derive(Clone, Debug)]
pub struct SolveRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with the points.
    pub format: Vec<PointFormat>,
    /// Also smooth faces in a STEP file, this near to the exact surface, mm.
    pub step: Option<f64>,
    /// Also where each surface turns back, and where the tool's contact ends.
    pub limits: bool,
    /// No picture.
    pub no_picture: bool,
    /// Also curvatures, sliding velocities, contact lines and the metric at each point.
    pub geometry: bool,
    /// Also how far each point moves with each parameter.
    pub sensitivity: bool,
    /// Also a proof for each point that exactly one root lies near it.
    pub certify: bool,
    /// Results hold the points of all surfaces in arrays, also of those that are otherwise too many to keep.
    pub arrays: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Closed bodies.
#[derive(Clone, Debug)]
pub struct SolidRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// What of each is written.
    pub part: SolidPart,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with the closed surface.
    pub format: Vec<MeshFormat>,
    /// Also as a body with smooth faces in a STEP file, this near to the exact surfaces, mm; of the whole gear alone.
    pub step: Option<f64>,
    /// How far the middles of a mesh's edges may lie off the exact surfaces, mm.
    pub deviation: f64,
    /// kg/m³
    pub density: f64,
    /// Diameter of the balls that the gear is measured over, mm; one that touches about the middle of the flanks otherwise.
    pub ball: Option<f64>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Bodies as bricks for finite elements.
#[derive(Clone, Debug)]
pub struct MeshRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// Neighbouring teeth, each from the middle of a space to the middle of the next; the whole gear otherwise.
    pub teeth: Option<u32>,
    /// Bricks up a flank (from 1 on), along the tooth (from 1 on), and from flank to flank (from 3 on).
    pub elements: [u32; 3],
    /// The order of their shape functions.
    pub order: ElementOrder,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with the bricks.
    pub format: Vec<BrickFormat>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl MeshRequest {
    /// One tooth of 8 x 12 x 6 bricks of the first order as an input file in the folder `build`.
    pub fn new(jobs: impl Into<JobSelection>) -> MeshRequest {
        MeshRequest {
            jobs: jobs.into(),
            teeth: Some(1),
            elements: [8, 12, 6],
            order: ElementOrder::First,
            out: "build".into(),
            format: vec![BrickFormat::Inp],
            evaluator: EvaluatorOptions::default(),
        }
    }
}

impl SolveRequest {
    /// Points as CSV and a picture, in the folder `build`; of a [`Job`](crate::Job), or of some in a spec.
    pub fn new(jobs: impl Into<JobSelection>) -> SolveRequest {
        SolveRequest {
            jobs: jobs.into(),
            out: "build".into(),
            format: vec![PointFormat::Csv],
            step: None,
            limits: false,
            no_picture: false,
            geometry: false,
            sensitivity: false,
            certify: false,
            arrays: false,
            evaluator: EvaluatorOptions::default(),
        }
    }
}

/// Pictures of jobs.
#[derive(Clone, Debug)]
pub struct PlotRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// What is drawn; the first three that fit if nothing is named.
    pub what: Vec<PlotKind>,
    /// The surfaces that pictures show; otherwise maps show the first that is sampled.
    pub surface: Vec<String>,
    /// The surface that the one surface is compared with.
    pub reference: Option<String>,
    /// The parameters whose influence is shown; those that do most otherwise.
    pub of: Vec<String>,
    /// The contacts that pictures of contacts show; all of a job if none is named.
    pub contact: Vec<String>,
    /// The milling that the picture of one shows; the first of a job if none is named.
    pub milling: Option<String>,
    /// How the members of contacts are mounted wrong, as for [`ContactRequest::errors`].
    pub errors: Vec<(String, MountingError)>,
    /// Positions over a pitch, if not as many as [`ContactRequest::new`] has.
    pub positions: Option<u32>,
    /// Thickness of the marking compound, mm, if not that of [`ContactRequest::new`].
    pub compound: Option<f64>,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files of each picture.
    pub format: Vec<PictureFormat>,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Without the line with spec, hash and program.
    pub no_origin: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Reports on jobs.
#[derive(Clone, Debug)]
pub struct ReportRequest {
    /// On which jobs.
    pub jobs: JobSelection,
    /// Folder for the files, or the one file.
    pub out: PathBuf,
    /// HTML, or what the one file is, if nothing is named.
    pub format: Vec<ReportFormat>,
    /// Also a proof for each point.
    pub certify: bool,
    /// Also smooth faces in a STEP file, this near to the exact surface, mm.
    pub step: Option<f64>,
    /// A mark to stand on the page.
    pub date: Option<String>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Pages in 3-D.
#[derive(Clone, Debug)]
pub struct ViewRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// Folder for the pages; made if it is not there.
    pub out: PathBuf,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// One surface compared with another, or measured points with a surface.
#[derive(Clone, Debug)]
pub struct DeviationRequest {
    /// The jobs that the surfaces are looked for in.
    pub jobs: JobSelection,
    /// The surface.
    pub surface: String,
    /// The surface that it is compared with.
    pub reference: Option<String>,
    /// The jobs that the reference is looked for in, where they are others: the same ones with other values, or those of another spec.
    pub reference_jobs: Option<JobSelection>,
    /// Measured points that are compared with the surface.
    pub measured: Option<PathBuf>,
    /// Rows of the grid that was measured; the largest that the file names otherwise.
    pub rows: Option<u32>,
    /// Columns of that grid, the same way.
    pub columns: Option<u32>,
    /// What a measuring grid leaves out at each end, as shares from root to tip and along the tooth.
    pub margin: Option<[f64; 2]>,
    /// Whether it is not turned.
    pub no_align: bool,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with the points.
    pub format: Vec<PointFormat>,
    /// No picture.
    pub no_picture: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// What a measuring grid leaves out at each end of the sampled area, if nothing else is asked for.
const MARGIN: f64 = 0.05;

impl DeviationRequest {
    pub(crate) fn margins(&self) -> [f64; 2] {
        self.margin.unwrap_or([MARGIN; 2])
    }
}

/// Which settings make a measured flank, or one with a wanted ease-off.
#[derive(Clone, Debug)]
pub struct FitRequest {
    /// The jobs that the surfaces are looked for in.
    pub jobs: JobSelection,
    /// The surface whose settings are looked for.
    pub surface: String,
    /// Measured points of the surface.
    pub measured: Option<PathBuf>,
    /// A further surface of the same job that was measured in the same position, with its file.
    pub and: Option<(String, PathBuf)>,
    /// Rows of the grid that was measured; the largest that the file names otherwise.
    pub rows: Option<u32>,
    /// Columns of that grid, the same way.
    pub columns: Option<u32>,
    /// What a measuring grid leaves out at each end, as shares from root to tip and along the tooth.
    pub margin: Option<[f64; 2]>,
    /// How the surface shall lie off another one, which `from` names.
    pub ease_off: Option<WantedEaseOff>,
    /// The same as a table of deviations, as measured ones are given, of the surface that `from` names.
    pub ease_off_table: Option<PathBuf>,
    /// The surface that the ease-off is one from; it is sampled in the spec.
    pub from: Option<String>,
    /// The jobs that this surface is looked for in, where they are others: the same ones with other values, or those of another spec.
    pub from_jobs: Option<JobSelection>,
    /// The parameters and settings that may change; some of those that the job gives a value, if none is named.
    pub vary: Vec<String>,
    /// Whether only slopes (1), or slopes, crownings and bias (2) are fitted; the rest of the deviations is left as it is.
    pub order: Option<u8>,
    /// What a measured point scatters by, mm; as all settings leave it where it is not said.
    pub noise: Option<f64>,
    /// Settings that are set in steps, with these: corrections are multiples of them.
    pub round: Vec<(String, ToleratedAmount)>,
    /// Further surfaces of the job that corrected settings leave where they are, in these places of their samples.
    pub keep: Vec<(String, KeptPlace)>,
    /// Whether the points are not turned about z.
    pub as_it_lies: bool,
    /// Whether a further surface is turned by itself, so that the tooth's thickness does not count.
    pub is_thickness_free: bool,
    /// The share of the deviation that the corrected settings take away.
    pub share: f64,
    /// Root of the mean square, mm, up to which a flank is as it was wanted.
    pub within: f64,
    /// A change of the settings that moves the flank by less, mm, is made only where it takes nearly all away that is left of a measured
    /// flank.
    pub resolution: f64,
    /// A file for a spec with the corrected settings.
    pub write: Option<PathBuf>,
    /// Whether that spec is told and not written.
    pub dry: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl FitRequest {
    /// The settings of a surface: all of the deviation is taken away, to 1 um, by changes that move the flank by 0.1 um at least.
    pub fn new(jobs: impl Into<JobSelection>, surface: &str) -> FitRequest {
        FitRequest {
            jobs: jobs.into(),
            surface: surface.to_string(),
            measured: None,
            and: None,
            rows: None,
            columns: None,
            margin: None,
            ease_off: None,
            ease_off_table: None,
            from: None,
            from_jobs: None,
            vary: Vec::new(),
            order: None,
            noise: None,
            round: Vec::new(),
            keep: Vec::new(),
            as_it_lies: false,
            is_thickness_free: false,
            share: 1.0,
            within: 1e-3,
            resolution: 1e-4,
            write: None,
            dry: false,
            evaluator: EvaluatorOptions::default(),
        }
    }

    /// Whether a flank is wanted, and none was measured.
    pub(crate) fn is_wish(&self) -> bool {
        self.ease_off.is_some() || self.ease_off_table.is_some()
    }

    pub(crate) fn margins(&self) -> [f64; 2] {
        self.margin.unwrap_or([MARGIN; 2])
    }
}

/// Where corrected settings leave a surface as it is: its distance along the normal from where it was is zero there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptPlace {
    /// In the middle of its sample: of a root the depth of the tooth, of the opposite flank its thickness.
    Middle,
    /// At both ends of the row through the middle: of a root the root line.
    Line,
}

/// Which settings bring a contact where it is wanted.
#[derive(Clone, Debug)]
pub struct SynthesisRequest {
    /// The jobs that the wanted contact is looked for in.
    pub jobs: JobSelection,
    /// What is wanted of a contact, as its job names it.
    pub want: String,
    /// The parameters and settings that may change; of the first flank those that do most, as many as conditions, if none is named.
    pub vary: Vec<String>,
    /// Settings that are set in steps, with these: what is found are multiples of them.
    pub round: Vec<(String, ToleratedAmount)>,
    /// A file for a spec with the settings.
    pub write: Option<PathBuf>,
    /// Whether that spec is told and not written.
    pub dry: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl SynthesisRequest {
    /// By settings that are chosen, and without a file.
    pub fn new(jobs: impl Into<JobSelection>, want: &str) -> SynthesisRequest {
        SynthesisRequest {
            jobs: jobs.into(),
            want: want.to_string(),
            vary: Vec::new(),
            round: Vec::new(),
            write: None,
            dry: false,
            evaluator: EvaluatorOptions::default(),
        }
    }
}

/// How far a flank shall lie off another one over a sampled area: a parabola in both directions, um, plus is material. The first number of
/// each pair is from root to tip, the second along the tooth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WantedEaseOff {
    /// Rise from end to end.
    pub slopes: [f64; 2],
    /// Drop from the middle to both ends.
    pub crownings: [f64; 2],
    /// Rise along the tip, less that along the root.
    pub bias: f64,
}

/// How what follows from settings and mounting errors scatters with them.
#[derive(Clone, Debug)]
pub struct ToleranceRequest {
    /// The jobs that the surface is looked for in.
    pub jobs: JobSelection,
    /// The surface; of contacts of its job those that it takes part in are looked at too.
    pub surface: String,
    /// Settings, and axes of the machine of a contact, with the standard deviation of each; if none is named, all that do something scatter
    /// by a usual change.
    pub scatter: Vec<(String, ToleratedAmount)>,
    /// Pairs of them with their correlation, above −1 and below 1.
    pub correlations: Vec<([String; 2], f64)>,
    /// Results, with the standard deviation that each may have.
    pub budget: Vec<(String, ToleratedAmount)>,
    /// In the worst case each is off by so many standard deviations.
    pub limits: f64,
    /// Whether the surface is not turned about z.
    pub no_align: bool,
    /// Random cases that the linear numbers are held against.
    pub sweep: Option<u32>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl ToleranceRequest {
    /// All that does something by a usual change, three standard deviations in the worst case.
    pub fn new(jobs: impl Into<JobSelection>, surface: &str) -> ToleranceRequest {
        ToleranceRequest {
            jobs: jobs.into(),
            surface: surface.to_string(),
            scatter: Vec::new(),
            correlations: Vec::new(),
            budget: Vec::new(),
            limits: 3.0,
            no_align: false,
            sweep: None,
            evaluator: EvaluatorOptions::default(),
        }
    }
}

/// How much something may scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToleratedAmount {
    /// mm
    Length(f64),
    /// Radians.
    Angle(f64),
    /// Of a plain number, or what has neither a length nor an angle as unit: in mm and radians.
    Number(f64),
    /// Of a product of powers of lengths and angles, such as a curvature.
    Product {
        /// In mm and radians.
        size: f64,
        /// Neither a length, nor an angle, nor a number.
        dimension: Dimension,
    },
    /// A share of the value.
    Share(f64),
}

/// How far a member is mounted from where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MountingError {
    /// mm
    Length(f64),
    /// Radians.
    Angle(f64),
}

/// Contact of flanks that roll on each other.
#[derive(Clone, Debug)]
pub struct ContactRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// The contact; all if none is named.
    pub contact: Option<String>,
    /// How the members are mounted wrong: axes of the pair's machine, `m.E`, with what is added to them.
    pub errors: Vec<(String, MountingError)>,
    /// Positions over a pitch.
    pub positions: u32,
    /// Thickness of the marking compound, mm.
    pub compound: f64,
    /// Also what each axis of the pair's machine does to the contact.
    pub sensitivity: bool,
    /// Also mountings that bring the contact to toe, middle and heel.
    pub vhj: bool,
    /// Also proofs that the flanks touch where they are said to.
    pub certify: bool,
    /// A milling of the job: also the same pair with the flank that it leaves.
    pub milled: Option<String>,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with gaps and paths.
    pub format: Vec<PointFormat>,
    /// No picture.
    pub no_picture: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl ContactRequest {
    /// All contacts as they are mounted, 60 positions a pitch, 6.35 um (0.00025 inch) of compound, into the folder `build`.
    pub fn new(jobs: impl Into<JobSelection>) -> ContactRequest {
        ContactRequest {
            jobs: jobs.into(),
            contact: None,
            errors: Vec::new(),
            positions: 60,
            compound: 0.00635,
            sensitivity: false,
            vhj: false,
            certify: false,
            milled: None,
            out: "build".into(),
            format: vec![PointFormat::Csv],
            no_picture: false,
            evaluator: EvaluatorOptions::default(),
        }
    }
}

/// A setting of a milling machine that may change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClampRange {
    /// With or without the machine's name: `mill.work_z`.
    pub setting: String,
    /// The lowest value and the highest one, with their units.
    pub ends: [String; 2],
}

/// Passes of cutters over surfaces.
#[derive(Clone, Debug)]
pub struct MillRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// The milling; all if none is named.
    pub milling: Option<String>,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with cutter locations.
    pub format: Vec<CutterFormat>,
    /// Controls that programs are written for.
    pub nc: Vec<NcDialect>,
    /// Whether the control keeps the tip on its way, so that blocks are straight in the work.
    pub tool_centre_control: bool,
    /// Of the cutter along the surface, mm/min.
    pub feed: f64,
    /// Revolutions of the cutter a minute, if programs are to say that.
    pub spindle: Option<f64>,
    /// How far above a pass the cutter comes down and is lifted with feed, mm.
    pub approach: f64,
    /// Spaces of the work that a program mills, one after the other.
    pub spaces: u32,
    /// A program whose blocks are measured on the surface.
    pub verify: Option<PathBuf>,
    /// Rows of the points at which what is left is known, of equal cells by the coordinate that passes are counted by.
    pub rows: u32,
    /// Columns of these points, by the coordinate that passes run along.
    pub columns: u32,
    /// Files with these points.
    pub map: Vec<PointFormat>,
    /// Settings of the milling machine that may place the work otherwise, so that its axes go slower.
    pub clamp: Vec<ClampRange>,
    /// Also proofs that the cutter stays clear between its positions, so much nearer than it is asked for, mm.
    pub certify: Option<f64>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl MillRequest {
    /// All millings, cutter locations and what is left as tables into the folder `build`, 600 mm/min, one space.
    pub fn new(jobs: impl Into<JobSelection>) -> MillRequest {
        MillRequest {
            jobs: jobs.into(),
            milling: None,
            out: "build".into(),
            format: vec![CutterFormat::Csv],
            nc: Vec::new(),
            tool_centre_control: false,
            feed: 600.0,
            spindle: None,
            approach: 5.0,
            spaces: 1,
            verify: None,
            rows: 15,
            columns: 31,
            map: vec![PointFormat::Csv],
            clamp: Vec::new(),
            certify: None,
            evaluator: EvaluatorOptions::default(),
        }
    }
}

/// Nominal points for measuring machines.
#[derive(Clone, Debug)]
pub struct MeasureRequest {
    /// Of which jobs.
    pub jobs: JobSelection,
    /// The surfaces; all that are sampled if none is named.
    pub surface: Vec<String>,
    /// Rows of the grid.
    pub rows: u32,
    /// Columns of the grid.
    pub columns: u32,
    /// What the grid leaves out at each end, as shares from root to tip and along the tooth.
    pub margin: Option<[f64; 2]>,
    /// Also the profile line and the lead line through the middle, with so many points each.
    pub lines: Option<u32>,
    /// Folder for the files; made if it is not there.
    pub out: PathBuf,
    /// Files with the grid.
    pub format: Vec<TableFormat>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl MeasureRequest {
    pub(crate) fn margins(&self) -> [f64; 2] {
        self.margin.unwrap_or([MARGIN; 2])
    }
}

/// What is carried over to another machine, and which of its frames stand for the job's.
#[derive(Clone, Debug, Default)]
pub struct Onto {
    /// The surface whose tool is carried over, where the job has several tools.
    pub surface: Option<String>,
    /// The machine's frame that the tool stands in, if it has another name there.
    pub tool_frame: Option<String>,
    /// The machine's frame that the work stands in, if it has another name there.
    pub work_frame: Option<String>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Starts from which settings are looked for, where nobody says how many.
pub const FIT_STARTS: u32 = flank_solver::SETTING_STARTS;

/// A job on another machine.
#[derive(Clone, Debug)]
pub struct ConvertRequest {
    /// Which job; it is one.
    pub jobs: JobSelection,
    /// The file of the other machine; of several in it the last one.
    pub to: PathBuf,
    /// What is carried over.
    pub onto: Onto,
    /// Settings of the machine that are looked for beside those without a value.
    pub fit: Vec<String>,
    /// Starts from which settings are looked for before the nearest are taken; [`FIT_STARTS`] do for most machines.
    pub starts: u32,
    /// Positions over the motion.
    pub positions: u32,
    /// The order of the polynomials; 6 otherwise.
    pub order: Option<u32>,
    /// The smallest order that keeps the flank this near is taken, mm.
    pub tolerance: Option<f64>,
    /// Folder for the files; `build` otherwise.
    pub out: Option<PathBuf>,
    /// Files with positions and polynomials; CSV if nothing is named.
    pub format: Vec<TableFormat>,
    /// No files with positions and polynomials.
    pub no_tables: bool,
    /// NC programs.
    pub nc: Vec<NcDialect>,
    /// Seconds that the motion takes.
    pub time: Option<f64>,
    /// Functions of the motion.
    pub emit: Vec<FunctionLanguage>,
    /// What these compute.
    pub emit_form: Vec<EmitForm>,
}

impl ConvertRequest {
    /// The order of the polynomials where no tolerance chooses it.
    pub(crate) fn order(&self) -> usize {
        self.order.unwrap_or(6) as usize
    }

    /// The folder for the files.
    pub(crate) fn out(&self) -> &Path {
        self.out.as_deref().unwrap_or(Path::new("build"))
    }

    /// What files with positions and polynomials there are to be.
    pub(crate) fn formats(&self) -> &[TableFormat] {
        match &self.format[..] {
            [] if self.no_tables => &[],
            [] => &[TableFormat::Csv],
            formats => formats,
        }
    }

    /// What is asked for that there is only of a motion, not of settings.
    pub(crate) fn of_a_motion(&self) -> Vec<&'static str> {
        let asked = [
            (self.order.is_some(), "option `order`"),
            (self.tolerance.is_some(), "option `tolerance`"),
            (self.out.is_some(), "option `out`"),
            (!self.format.is_empty(), "option `format`"),
            (!self.nc.is_empty(), "option `nc`"),
            (self.time.is_some(), "option `time`"),
            (!self.emit.is_empty(), "option `emit`"),
        ];
        asked.into_iter().filter_map(|(is_asked, name)| is_asked.then_some(name)).collect()
    }
}

/// What was built.
#[derive(Clone, Debug)]
pub struct DeriveRequest {
    /// Of which jobs; with a machine to carry over to, one.
    pub jobs: JobSelection,
    /// LaTeX instead of text.
    pub latex: bool,
    /// The axes of the machine in this file in closed form.
    pub to: Option<PathBuf>,
    /// What is carried over to it.
    pub onto: Onto,
    /// How many operations the equations of a point take.
    pub cost: bool,
}
