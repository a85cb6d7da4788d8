//! What can be asked of a spec. Lengths are mm, times seconds.

mod comparisons;
mod machining;

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Job, Request};

use crate::project::Project;
use crate::project::choices::{
    BrickFormat, ElementOrder, MeshFormat, PictureFormat, PlotKind, PointFormat, ReportFormat, SolidPart,
};
use crate::project::failure::Failure;
use crate::project::session::EvaluatorOptions;

pub use self::comparisons::{
    DeviationRequest, FitRequest, KeptPlace, MeasureRequest, SynthesisRequest, ToleranceRequest, ToleratedAmount,
    WantedEaseOff,
};
pub use self::machining::{ClampRange, ConvertRequest, DeriveRequest, MillRequest, Onto};

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
        Request {
            files,
            jobs: self.job.as_deref().into_iter().collect(),
            set: &self.set,
            whole: false,
            ..Request::default()
        }
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

/// Starts from which settings are looked for, where nobody says how many.
pub const FIT_STARTS: u32 = flank_solver::SETTING_STARTS;
