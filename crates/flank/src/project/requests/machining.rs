//! What other machines shall do: conversion, and milling.

use std::path::{Path, PathBuf};

use crate::project::choices::{CutterFormat, EmitForm, FunctionLanguage, NcDialect, PointFormat, TableFormat};
use crate::project::requests::JobSelection;
use crate::project::session::EvaluatorOptions;

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
    /// Whether the control keeps the tip on its way: in blocks it goes straight in the work, and the rotary axes turn evenly.
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
    /// Starts from which settings are looked for before the nearest are taken; [`FIT_STARTS`](super::FIT_STARTS) do for most machines.
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
