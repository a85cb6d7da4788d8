//! From arguments to what is asked of the library.

use std::path::PathBuf;

use flank::{
    Choice, ContactRequest, ConvertRequest, DeriveRequest, DeviationRequest, FitRequest, JobSelection, MeasureRequest,
    MeshFormat, MeshRequest, MillRequest, PlotRequest, PointFormat, ReportRequest, SolidRequest, SolveRequest,
    SynthesisRequest, ToleranceRequest, ViewRequest,
};

use crate::arguments::{
    Contact, Convert, Derive, Deviation, EaseOffWish, Fit, JobArguments, Measure, Mesh, Mill, Onto, Plot, Report,
    Solve, Tolerance, View,
};
use crate::failure::Failure;
use crate::spec;

impl JobArguments {
    /// # Errors
    /// If the standard input cannot be read.
    pub(crate) fn jobs(&self) -> Result<JobSelection, Failure> {
        Ok(JobSelection { project: spec::project(&self.file)?, job: self.job.clone(), set: self.set.clone() })
    }
}

impl Solve {
    pub(crate) fn request(&self) -> Result<SolveRequest, Failure> {
        Ok(SolveRequest {
            jobs: self.which.jobs()?,
            out: self.out.clone(),
            format: once(&self.format),
            step: self.faces.step,
            limits: self.limits,
            no_picture: self.no_picture,
            geometry: self.geometry,
            sensitivity: self.sensitivity,
            certify: self.certify,
            arrays: false,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Solve {
    /// The bodies, if these are asked for.
    pub(crate) fn solid_request(&self) -> Result<Option<SolidRequest>, Failure> {
        let Some(part) = self.body.solid else { return Ok(None) };
        Ok(Some(SolidRequest {
            jobs: self.which.jobs()?,
            part,
            out: self.out.clone(),
            format: once(&self.format).into_iter().map(mesh_format).collect::<Result<_, _>>()?,
            step: self.faces.step,
            deviation: self.body.deviation,
            density: self.body.density,
            ball: self.body.ball,
            evaluator: self.evaluator.evaluator(),
        }))
    }
}

/// Formats, each once.
fn once<Format: Copy + PartialEq>(formats: &[Format]) -> Vec<Format> {
    let is_new = |k: &usize| !formats[..*k].contains(&formats[*k]);
    (0..formats.len()).filter(is_new).map(|k| formats[k]).collect()
}

fn mesh_format(format: PointFormat) -> Result<MeshFormat, Failure> {
    match format {
        PointFormat::Stl => Ok(MeshFormat::Stl),
        PointFormat::Obj => Ok(MeshFormat::Obj),
        PointFormat::ThreeMf => Ok(MeshFormat::ThreeMf),
        PointFormat::Csv | PointFormat::Json | PointFormat::Parquet | PointFormat::Vtp => {
            Err(Failure::of_usage(format!("a body is written as stl, obj or 3mf, not as {}", format.name())))
        }
    }
}

impl Mesh {
    pub(crate) fn request(&self) -> Result<MeshRequest, Failure> {
        Ok(MeshRequest {
            jobs: self.which.jobs()?,
            teeth: self.teeth.0,
            elements: self.elements,
            order: self.order,
            out: self.out.clone(),
            format: once(&self.format),
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Plot {
    pub(crate) fn request(&self) -> Result<PlotRequest, Failure> {
        Ok(PlotRequest {
            jobs: self.which.jobs()?,
            what: self.what.clone(),
            surface: self.surface.clone(),
            reference: self.reference.clone(),
            of: self.of.clone(),
            contact: self.contact.clone(),
            milling: self.milling.clone(),
            errors: self.errors.clone(),
            positions: self.positions,
            compound: self.compound,
            out: self.out.clone(),
            format: once(&self.format),
            size: self.size,
            no_origin: self.no_origin,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Report {
    pub(crate) fn request(&self) -> Result<ReportRequest, Failure> {
        Ok(ReportRequest {
            jobs: self.which.jobs()?,
            out: self.out.clone(),
            format: once(&self.format),
            certify: self.certify,
            step: self.faces.step,
            date: self.date.clone(),
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl View {
    pub(crate) fn request(&self) -> Result<ViewRequest, Failure> {
        Ok(ViewRequest { jobs: self.which.jobs()?, out: self.out.clone(), evaluator: self.evaluator.evaluator() })
    }
}

impl Deviation {
    pub(crate) fn request(&self) -> Result<DeviationRequest, Failure> {
        Ok(DeviationRequest {
            jobs: self.which.jobs()?,
            surface: self.surface.clone(),
            reference: self.reference.clone(),
            reference_jobs: None,
            measured: self.measured.clone(),
            rows: self.rows,
            columns: self.columns,
            margin: self.margin.margin,
            no_align: self.no_align,
            out: self.out.clone(),
            format: once(&self.format),
            no_picture: self.no_picture,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Fit {
    pub(crate) fn request(&self) -> Result<FitRequest, Failure> {
        let parabola = |wish: &EaseOffWish| match wish {
            EaseOffWish::Parabola(wanted) => Some(*wanted),
            EaseOffWish::Table(_) => None,
        };
        let table = |wish: &EaseOffWish| match wish {
            EaseOffWish::Parabola(_) => None,
            EaseOffWish::Table(file) => Some(file.clone()),
        };
        // of both flanks in one file
        let and =
            |(name, file): &(String, Option<PathBuf>)| Some((name.clone(), file.clone().or(self.measured.clone())?));
        Ok(FitRequest {
            jobs: self.which.jobs()?,
            surface: self.surface.clone().unwrap_or_default(),
            measured: self.measured.clone(),
            and: self.and.as_ref().and_then(and),
            rows: self.rows,
            columns: self.columns,
            margin: self.margin.margin,
            ease_off: self.ease_off.as_ref().and_then(parabola),
            ease_off_table: self.ease_off.as_ref().and_then(table),
            from: self.from.clone(),
            from_jobs: None,
            vary: self.vary.clone(),
            order: self.order,
            noise: self.noise,
            round: self.round.clone(),
            keep: self.keep.clone(),
            as_it_lies: self.as_it_lies,
            is_thickness_free: self.is_thickness_free,
            share: self.share,
            within: self.within,
            resolution: self.resolution,
            write: self.write.clone(),
            dry: self.dry,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Fit {
    /// Of a wanted contact.
    pub(crate) fn synthesis(&self, want: &str) -> Result<SynthesisRequest, Failure> {
        Ok(SynthesisRequest {
            jobs: self.which.jobs()?,
            want: want.to_string(),
            vary: self.vary.clone(),
            round: self.round.clone(),
            write: self.write.clone(),
            dry: self.dry,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Tolerance {
    pub(crate) fn request(&self) -> Result<ToleranceRequest, Failure> {
        Ok(ToleranceRequest {
            jobs: self.which.jobs()?,
            surface: self.surface.clone(),
            scatter: self.scatter.clone(),
            correlations: self.correlations.clone(),
            budget: self.budget.clone(),
            limits: self.limits,
            no_align: self.no_align,
            sweep: self.sweep,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Contact {
    pub(crate) fn request(&self) -> Result<ContactRequest, Failure> {
        Ok(ContactRequest {
            jobs: self.which.jobs()?,
            contact: self.contact.clone(),
            errors: self.errors.clone(),
            positions: self.positions,
            compound: self.compound,
            sensitivity: self.sensitivity,
            vhj: self.vhj,
            certify: self.certify,
            milled: self.milled.clone(),
            out: self.out.clone(),
            format: once(&self.format),
            no_picture: self.no_picture,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Mill {
    pub(crate) fn request(&self) -> Result<MillRequest, Failure> {
        Ok(MillRequest {
            jobs: self.which.jobs()?,
            milling: self.milling.clone(),
            out: self.out.clone(),
            format: once(&self.format),
            nc: self.nc.clone(),
            tool_centre_control: self.tool_centre_control,
            feed: self.feed,
            spindle: self.spindle,
            approach: self.approach,
            spaces: self.spaces,
            verify: self.verify.clone(),
            rows: self.rows,
            columns: self.columns,
            map: self.map.clone(),
            clamp: self.clamp.clone(),
            certify: self.certify,
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Measure {
    pub(crate) fn request(&self) -> Result<MeasureRequest, Failure> {
        Ok(MeasureRequest {
            jobs: self.which.jobs()?,
            surface: self.surface.clone(),
            rows: self.rows,
            columns: self.columns,
            margin: self.margin.margin,
            lines: self.lines,
            out: self.out.clone(),
            format: once(&self.format),
            evaluator: self.evaluator.evaluator(),
        })
    }
}

impl Onto {
    fn request(&self) -> flank::Onto {
        flank::Onto {
            surface: self.surface.clone(),
            tool_frame: self.tool_frame.clone(),
            work_frame: self.work_frame.clone(),
            evaluator: self.evaluator.evaluator(),
        }
    }
}

impl Convert {
    pub(crate) fn request(&self) -> Result<ConvertRequest, Failure> {
        Ok(ConvertRequest {
            jobs: self.which.jobs()?,
            to: self.to.clone(),
            onto: self.onto.request(),
            fit: self.fit.clone(),
            starts: self.starts,
            positions: self.positions,
            order: self.order,
            tolerance: self.tolerance,
            out: self.out.clone(),
            format: once(&self.format),
            no_tables: false,
            nc: self.nc.clone(),
            time: self.time,
            emit: self.emit.clone(),
            emit_form: self.emit_form.clone(),
        })
    }
}

impl Derive {
    pub(crate) fn request(&self) -> Result<DeriveRequest, Failure> {
        Ok(DeriveRequest {
            jobs: self.which.jobs()?,
            latex: self.latex,
            to: self.to.clone(),
            onto: self.onto.request(),
            cost: self.cost,
        })
    }
}
