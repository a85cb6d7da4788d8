//! What surfaces are held against: other surfaces, measured points, wishes, tolerances.

use std::path::PathBuf;

use flank_chain_dsl::Dimension;

use crate::project::choices::{PointFormat, TableFormat};
use crate::project::requests::JobSelection;
use crate::project::session::EvaluatorOptions;

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
