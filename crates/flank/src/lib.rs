//! Tooth surfaces of any machine: the library that the command line `flank` stands on.
//!
//! A [`Project`] is a spec with the files that it uses, a [`Job`] one job of it with its values and all its texts ([`Project::job`]). What
//! works on the text alone takes a project: [`check`], [`lay_out`]. What works on jobs takes a request of its own and a [`Monitor`], which hears how far it is, and gives a result of its own for each job: [`solve`], [`solid`], [`mesh()`],
//! [`deviation`], [`fit`], [`tolerance`], [`measure`], [`convert`], [`derive()`], [`plot`], [`view`], [`report`]. A result is data; its serialisation is a document
//! whose schema [`schemas`] has, its `Display` a text for people, and what was not done ([`Answer::not_done`]) and what else is to be known
//! ([`Answer::remarks`]) stand in it as data: a code, what it is about, its place in the spec. What is wrong
//! with a spec comes as [`Findings`], data with a code and a place. Messages name the fields of requests as "option `no_align`", or with a
//! value as "option `set teeth=25`", so that a shell can spell them its way.
//!
//! ```
//! use std::sync::Arc;
//!
//! use flank::{Buffers, Disk, Project, check};
//!
//! let text = "machine lathe { axis C : rotary frame bed frame work in bed = rotate_z(B) }";
//! let files = Buffers::over(Arc::new(Disk)).with("lathe.chain".as_ref(), text);
//! let checked = check(&Project::open("lathe.chain", Arc::new(files)));
//! assert!(!checked.ok);
//! let first = &checked.findings.list()[0];
//! assert_eq!((first.code, first.place.line, first.place.column), ("E0201", 1, 72));
//! ```
//!
//! ```no_run
//! use std::sync::Arc;
//!
//! use flank::{Answer, Disk, Project, SolveRequest, Unwatched, solve};
//!
//! let project = Project::open("specs/hobbing/helical_gear.chain", Arc::new(Disk));
//! let job = project.job("helical_gear", &[("teeth".to_string(), "37".to_string())])?;
//! let request = SolveRequest { no_picture: true, ..SolveRequest::new(&job) };
//! solve(&request, &Unwatched, &mut |solved| {
//!     for surface in &solved.surfaces {
//!         let highest = surface.positions().iter().map(|[_, _, z]| *z).fold(f64::MIN, f64::max);
//!         println!("{} of {} reaches z = {highest} mm", surface.summary.name, solved.job);
//!     }
//!     println!("complete: {}", solved.is_complete());
//! })?;
//! # Ok::<(), flank::Failure>(())
//! ```

mod compare;
mod contact;
mod convert;
mod draw;
mod exchange;
mod language;
mod page;
mod project;
mod report;
mod solve;
mod testing;

pub use compare::deviation::deviation;
pub use compare::deviation_result::{DeviationResult, EaseOffDirection, GridPlace};
pub use compare::fit::fit;
pub use compare::fit::result::{
    AdjustedSetting, AdjustedSettings, EaseOffNumbers, FitResult, FittedEaseOff, FittedFlank, KeptSurface,
    OutlyingPoint, RangeBound, SettingChange, SettingsChoice, SettingsDirection,
};
pub use compare::measure::measure;
pub use compare::measure_result::{FlankHand, FlankPart, MeasureResult, MeasuredFlank, MeasuredPart, MiddlePoint};
pub use compare::sweep::request::{CaseSource, Distribution, RunRequest, StudyChunks, SweepRequest, VariedRange};
pub use compare::sweep::result::SweepResult;
pub use compare::sweep::{
    OpenStudy, gather_sweep, note_interruption, plan_sweep, run_sweep, sweep_chunks, sweep_status,
};
pub use compare::synthesis::result::{CheckedContact, ReachedCondition, SynthesisResult, SynthesizedSetting};
pub use compare::synthesis::synthesis;
pub use compare::tolerance::result::{
    CauseKind, ScatteringCause, SweptCases, SweptResult, ToleranceResult, ToleratedResult,
};
pub use compare::tolerance::tolerance;
pub use compare::trace_result::{FlankTraces, InvoluteNumbers, InvoluteSource, TraceNumbers};
pub use contact::contact;
pub use contact::result::{
    Backlash, Clearance, ContactInfluence, ContactKind, ContactMember, ContactMiddle, ContactPattern, ContactResult,
    ErrorGap, FlankEnd, InfluenceKind, LeadingEdge, MilledContact, MilledPattern, MountedError, PlaceOnFlank,
    ProvenContact, TransmissionError, VhjRow,
};
pub use convert::convert;
pub use convert::milling::clamp::{ClampedRates, ClampedSetting, Clamping};
pub use convert::milling::mill;
pub use convert::milling::result::{
    BallAt, ClearanceKept, CurvatureAt, HeightLeft, HeightMap, MillResult, MilledAxis, ProvenClearance, VerifiedProgram,
};
pub use convert::milling::setup::{CutterSetting, MillSetup};
pub use convert::milling::side::SideLeft;
pub use convert::result::{
    AxisExtent, AxisMotion, AxisPolynomials, AxisPosition, AxisRates, CarriedJob, ConvertResult, FittedPosition,
    FoundSetting, FoundSettings, MissingMotion, NcDeviation, Remainders, RestingAxis, ToolSymmetry,
};
pub use draw::plot;
pub use draw::result::{PlotResult, WrittenPicture};
pub use exchange::changes::Words;
pub use exchange::import::{Coefficients, ImportRequest, Imported, Signs, import};
pub use exchange::made::{MadeKind, NewJob};
pub use exchange::templates::{
    FromLibrary, Template, TemplateList, TemplateParameter, Together, new_job, template_parameters, templates,
};
pub use flank_chain_dsl::syntax::{Vocabulary, is_reserved, vocabulary};
pub use flank_chain_dsl::{Buffers, Code, Dimension, Disk, Files, FolderEntry, NameKind, ValueSource, WordKind};
pub use language::check::{CheckResult, Checked, check, check_with_names};
pub use language::derive::derive;
pub use language::derive::result::{
    CostTable, Derivation, DerivationPage, DeriveResult, FormulaStyle, JobCost, Operations, SurfaceCost,
};
pub use language::editor::analysis::{Analysis, LocatedFinding, TextCure, TextEdit, TextSpan, analyse};
pub use language::editor::completion::{Completion, CompletionKind, PathCompletions};
pub use language::editor::hover::Hover;
pub use language::editor::names::{IndexedName, IndexedValue};
pub use language::editor::navigation::Reference;
pub use language::editor::outline::{Fold, OutlineItem, OutlinedJob};
pub use language::editor::rename::RenameError;
pub use language::editor::shipped::ShippedFiles;
pub use language::editor::tokens::{ClassifiedWord, InlayValue, WordClass};
pub use language::errors::{ErrorCode, Explanation, error_codes, error_page};
pub use language::layout::{Layout, lay_out};
pub use language::schemas::{Schema, schema_of, schemas};
pub use page::result::ViewResult;
pub use page::{PageParts, page_parts, view, waiting_page};
pub use project::amount::{AmountFault, product_size, read_amount};
pub use project::answer::{Answer, Timed, Timing};
pub use project::choices::{
    BrickFormat, Choice, CutterFormat, ElementOrder, EmitForm, FunctionLanguage, MeshFormat, NcDialect, PictureFormat,
    PlotKind, PointFormat, ReportFormat, SolidPart, TableFormat, UnknownChoice,
};
pub use project::failure::Failure;
pub use project::files::write_texts;
pub use project::findings::{Finding, FindingCure, Findings, Note, Place, Severity};
pub use project::job::{Job, JobParameter, JobSurface};
pub use project::monitor::{Monitor, Unwatched, Work};
pub use project::quantity::{Extent, NamedUnit, NamedValue, Travel, UnitSymbol};
pub use project::remark::{Message, NotDone, NotDoneKind, Remark, RemarkKind};
pub use project::requests::{
    ClampRange, ContactRequest, ConvertRequest, DeriveRequest, DeviationRequest, FIT_STARTS, FitRequest, JobSelection,
    KeptPlace, MeasureRequest, MeshRequest, MillRequest, MountingError, Onto, PlotRequest, ReportRequest, SolidRequest,
    SolveRequest, SynthesisRequest, ToleranceRequest, ToleratedAmount, ViewRequest, WantedEaseOff,
};
pub use project::session::EvaluatorOptions;
pub use project::{Project, shown_path};
pub use report::report;
pub use report::result::{
    AxisKind, AxisSource, BuiltAxis, BuiltFrame, BuiltMachine, BuiltSolid, ExtremeCurvature, GeneratingProcess, Input,
    InputSource, NotChecked, PassedMotion, ReportResult, ReportedLine, ReportedPicture, ReportedSurface, SampledGrid,
    SolidEdge,
};
pub use solve::arrays::{FieldArray, PointGrid};
pub use solve::body::bricks::mesh;
pub use solve::body::bricks_result::{BrickNumbers, ElementCounts, MeshResult, SetNumbers, ShaftElements};
pub use solve::body::mounted::{MountedSolid, Mounting};
pub use solve::body::result::{
    BallNumbers, BarNumbers, FaceNumbers, GaugeNumbers, LeftOut, MeshNumbers, SolidNumbers, SolidResult, SpanNumbers,
    ThicknessNumbers,
};
pub use solve::body::solid;
pub use solve::result::{
    BranchPoint, BranchSearch, Certified, CutHeights, FieldExtent, Instructions, LineResult, MissedRequirement,
    OpenRanges, ParameterInfluence, PointSummary, SensitivityTable, SmoothFace, SolveResult, SurfaceResult,
    ToolPositions, UsualChange,
};
pub use solve::solve;
pub use solve::status::Status;
pub use testing::result::{TestResult, TestedExpectation, TestedItem, TestedSnapshot, TestedSpec};
pub use testing::{TestRequest, accept_snapshot, find_specs, junit, test, test_spec};

/// What is asked and what is answered goes from thread to thread.
const _: () = {
    const fn is_shared<T: Send + Sync + 'static>() {}
    is_shared::<Project>();
    is_shared::<Job>();
    is_shared::<JobSelection>();
    is_shared::<SolveRequest>();
    is_shared::<SolidRequest>();
    is_shared::<MeshRequest>();
    is_shared::<PlotRequest>();
    is_shared::<ReportRequest>();
    is_shared::<ViewRequest>();
    is_shared::<DeviationRequest>();
    is_shared::<FitRequest>();
    is_shared::<ToleranceRequest>();
    is_shared::<ContactRequest>();
    is_shared::<MeasureRequest>();
    is_shared::<MillRequest>();
    is_shared::<ConvertRequest>();
    is_shared::<DeriveRequest>();
    is_shared::<SolveResult>();
    is_shared::<SolidResult>();
    is_shared::<MeshResult>();
    is_shared::<DeviationResult>();
    is_shared::<FitResult>();
    is_shared::<ToleranceResult>();
    is_shared::<ContactResult>();
    is_shared::<MeasureResult>();
    is_shared::<MillResult>();
    is_shared::<ConvertResult>();
    is_shared::<DeriveResult>();
    is_shared::<PlotResult>();
    is_shared::<ViewResult>();
    is_shared::<ReportResult>();
    is_shared::<TestRequest>();
    is_shared::<TestResult>();
    is_shared::<Analysis>();
    is_shared::<Checked>();
    is_shared::<Findings>();
    is_shared::<Layout>();
    is_shared::<Imported>();
    is_shared::<TemplateList>();
    is_shared::<FromLibrary>();
    is_shared::<Failure>();
};
