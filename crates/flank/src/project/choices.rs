//! Kinds of files, pictures and functions.

use std::path::Path;

use flank_export::Dialect;
use flank_expr::Language;
use schemars::JsonSchema;
use serde::Serialize;

/// A format of files with points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointFormat {
    /// All points with all that is known of them.
    Csv,
    /// The same, with a schema.
    Json,
    /// The columns of the CSV file as a Parquet table.
    Parquet,
    /// Triangles, single precision.
    Stl,
    /// Triangles with normals.
    Obj,
    /// Triangles with their unit, packed.
    ThreeMf,
    /// Triangles with all that is known of their points.
    Vtp,
}

/// A format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Pixels.
    Png,
    /// Lines and letters.
    Svg,
}

/// A format of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated.
    Csv,
    /// With a schema.
    Json,
}

/// A format of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportFormat {
    /// One page with its pictures in it.
    Html,
    /// Markdown with its pictures beside it.
    Md,
}

impl ReportFormat {
    /// What a path says it is; nothing for a folder.
    pub fn of(path: &Path) -> Option<ReportFormat> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match &*extension {
            "html" | "htm" => Some(ReportFormat::Html),
            "md" => Some(ReportFormat::Md),
            _ => None,
        }
    }
}

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlotKind {
    /// All surfaces in space, with axis, frame and dimensions.
    Surface,
    /// Heights above the flank's measuring grid.
    Topography,
    /// Maps of the principal curvatures, their product and their mean.
    Curvature,
    /// Maps of how far parameters and settings move the surface.
    Sensitivity,
    /// A map of how far a surface lies off another one.
    Deviation,
    /// A map of what single edges leave.
    Left,
    /// A map of what the solved equations leave.
    Residual,
    /// Lines on which the motions have equal values.
    ContactLines,
    /// A section through the tooth space, with the tool where it touches.
    Section,
    /// The machine as a kinematic diagram.
    Machine,
    /// Positions of the axes over the motions.
    Motion,
}

impl PlotKind {
    /// All kinds.
    pub const ALL: [PlotKind; 11] = [
        PlotKind::Surface,
        PlotKind::Topography,
        PlotKind::Curvature,
        PlotKind::Sensitivity,
        PlotKind::Deviation,
        PlotKind::Left,
        PlotKind::Residual,
        PlotKind::ContactLines,
        PlotKind::Section,
        PlotKind::Machine,
        PlotKind::Motion,
    ];

    /// As files and documents call it.
    pub fn name(self) -> &'static str {
        match self {
            PlotKind::Surface => "surface",
            PlotKind::Topography => "topography",
            PlotKind::Curvature => "curvature",
            PlotKind::Sensitivity => "sensitivity",
            PlotKind::Deviation => "deviation",
            PlotKind::Left => "left",
            PlotKind::Residual => "residual",
            PlotKind::ContactLines => "contact-lines",
            PlotKind::Section => "section",
            PlotKind::Machine => "machine",
            PlotKind::Motion => "motion",
        }
    }
}

/// A control that NC programs are written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NcDialect {
    /// Fanuc.
    Fanuc,
    /// Siemens 840D.
    Siemens,
    /// LinuxCNC.
    LinuxCnc,
}

/// A language that functions are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionLanguage {
    /// C.
    C,
    /// Rust.
    Rust,
    /// JavaScript.
    JavaScript,
}

/// What functions of a motion compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmitForm {
    /// The polynomials.
    Polynomials,
    /// The exact axes in closed form.
    Exact,
}

impl From<NcDialect> for Dialect {
    fn from(dialect: NcDialect) -> Dialect {
        match dialect {
            NcDialect::Fanuc => Dialect::Fanuc,
            NcDialect::Siemens => Dialect::Siemens840D,
            NcDialect::LinuxCnc => Dialect::LinuxCnc,
        }
    }
}

impl From<FunctionLanguage> for Language {
    fn from(language: FunctionLanguage) -> Language {
        match language {
            FunctionLanguage::C => Language::C,
            FunctionLanguage::Rust => Language::Rust,
            FunctionLanguage::JavaScript => Language::JavaScript,
        }
    }
}

impl FunctionLanguage {
    pub(crate) fn extension(self) -> &'static str {
        match self {
            FunctionLanguage::C => "c",
            FunctionLanguage::Rust => "rs",
            FunctionLanguage::JavaScript => "mjs",
        }
    }
}
