//! Tooth surfaces of any machine: the library that the command line `flank` stands on.
//!
//! A [`Project`] is a spec with the files that it uses. What works on the text alone takes one: [`check`], [`lay_out`]. What works on jobs
//! takes a request of its own and a [`Monitor`], which hears how far it is, and gives an [`Answer`] for each job: [`solve`],
//! [`deviation`], [`measure`], [`convert`], [`derive()`], [`plot`], [`view`], [`report`]. What is wrong with a spec comes as [`Findings`],
//! data with a code and a place.
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
//! use flank::{Disk, JobSelection, Project, SolveRequest, Unwatched, solve};
//!
//! let spec = Project::open("specs/hobbing/helical_gear.chain", Arc::new(Disk));
//! let request = SolveRequest { no_picture: true, ..SolveRequest::of(JobSelection::all(spec)) };
//! solve(&request, &Unwatched, &mut |answer| {
//!     let surfaces = answer.document["surfaces"].as_array().map_or(0, Vec::len);
//!     println!("{surfaces} surfaces, complete: {}", answer.is_complete());
//! })?;
//! # Ok::<(), flank::Failure>(())
//! ```

mod compare;
mod convert;
mod derive;
mod draw;
mod exchange;
mod language;
mod page;
mod project;
mod report;
mod solve;

pub use compare::deviation::deviation;
pub use compare::measure::measure;
pub use convert::convert;
pub use derive::derive;
pub use draw::plot;
pub use exchange::import::{Coefficients, ImportRequest, Imported, Signs, import};
pub use exchange::templates::{
    JobFromTemplate, NewJob, Template, TemplateList, TemplateParameter, Together, Words, new_job, template_parameters,
    templates,
};
pub use flank_chain_dsl::syntax::is_reserved;
pub use flank_chain_dsl::{Buffers, Code, Disk, Files};
pub use language::check::{Checked, check};
pub use language::errors::{ErrorCode, error_codes, error_page};
pub use language::layout::{Layout, lay_out};
pub use language::schemas::{Schema, schema, schemas};
pub use page::view;
pub use project::answer::Answer;
pub use project::choices::{
    EmitForm, FunctionLanguage, NcDialect, PictureFormat, PlotKind, PointFormat, ReportFormat, TableFormat,
};
pub use project::failure::Failure;
pub use project::files::write_texts;
pub use project::findings::{Finding, Findings, Note, Place, Severity};
pub use project::monitor::{Monitor, Unwatched, Work};
pub use project::requests::{
    ConvertRequest, DeriveRequest, DeviationRequest, EvaluatorOptions, JobSelection, MeasureRequest, Onto, PlotRequest,
    ReportRequest, SolveRequest, ViewRequest,
};
pub use project::{Project, shown_path};
pub use report::report;
pub use solve::solve;

/// What is asked and what is answered goes from thread to thread.
const _: () = {
    const fn is_shared<T: Send + Sync + 'static>() {}
    is_shared::<Project>();
    is_shared::<JobSelection>();
    is_shared::<SolveRequest>();
    is_shared::<PlotRequest>();
    is_shared::<ReportRequest>();
    is_shared::<ViewRequest>();
    is_shared::<DeviationRequest>();
    is_shared::<MeasureRequest>();
    is_shared::<ConvertRequest>();
    is_shared::<DeriveRequest>();
    is_shared::<Answer>();
    is_shared::<Checked>();
    is_shared::<Findings>();
    is_shared::<Layout>();
    is_shared::<Imported>();
    is_shared::<TemplateList>();
    is_shared::<JobFromTemplate>();
    is_shared::<Failure>();
};
