//! Kinds of files, pictures and functions, each with the name that shells and documents have for it.

use std::path::Path;

use flank_export::Dialect;
use flank_expr::Language;
use schemars::JsonSchema;
use serde::Serialize;

/// A kind among some that have names: what a shell offers its users comes from [`Choice::ALL`]. Each has `FromStr` too.
pub trait Choice: Copy + Send + Sync + 'static {
    /// All of them, in the order in which they are offered.
    const ALL: &'static [Self];

    /// As users write it.
    fn name(self) -> &'static str;

    /// What it is, in a few words.
    fn about(self) -> &'static str;
}

/// There is no kind of a name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no `{name}`; there is: {known}")]
pub struct UnknownChoice {
    name: String,
    known: String,
}

/// The kind of a name.
pub(crate) fn named<C: Choice>(name: &str) -> Result<C, UnknownChoice> {
    let known = || C::ALL.iter().map(|kind| kind.name()).collect::<Vec<&str>>().join(", ");
    let found = C::ALL.iter().copied().find(|kind| kind.name() == name);
    found.ok_or_else(|| UnknownChoice { name: name.to_string(), known: known() })
}

/// An enum with names for its kinds; the text about a kind is its doc comment.
macro_rules! choices {
    ($(#[$meta:meta])* $choice:ident { $(#[doc = $about:literal] $kind:ident = $name:literal,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $choice {
            $(#[doc = $about] $kind,)*
        }

        impl $crate::project::choices::Choice for $choice {
            const ALL: &'static [$choice] = &[$($choice::$kind),*];

            fn name(self) -> &'static str {
                match self {
                    $($choice::$kind => $name,)*
                }
            }

            fn about(self) -> &'static str {
                let about = match self {
                    $($choice::$kind => $about,)*
                };
                about.trim().trim_end_matches('.')
            }
        }

        impl std::str::FromStr for $choice {
            type Err = $crate::project::choices::UnknownChoice;

            fn from_str(name: &str) -> Result<$choice, Self::Err> {
                $crate::project::choices::named(name)
            }
        }
    };
}
pub(crate) use choices;

choices! {
    /// A format of files with points.
    PointFormat {
        /// All points with all that is known of them.
        Csv = "csv",
        /// The same, with a schema.
        Json = "json",
        /// The columns of the CSV file as a Parquet table.
        Parquet = "parquet",
        /// Triangles, single precision.
        Stl = "stl",
        /// Triangles with normals.
        Obj = "obj",
        /// Triangles with their unit, packed.
        ThreeMf = "3mf",
        /// Triangles with all that is known of their points, for ParaView.
        Vtp = "vtp",
    }
}

choices! {
    /// A part of a body.
    SolidPart {
        /// All of it.
        Gear = "gear",
        /// One tooth, from the middle of a space to the middle of the next.
        Tooth = "tooth",
        /// One space, from the middle of a tooth to the middle of the next.
        Space = "space",
    }
}

choices! {
    /// A format of closed meshes.
    MeshFormat {
        /// Triangles, single precision.
        Stl = "stl",
        /// Triangles that share their corners.
        Obj = "obj",
        /// The same with their unit, packed.
        ThreeMf = "3mf",
    }
}

choices! {
    /// A format of bricks for finite elements.
    BrickFormat {
        /// Input of Abaqus and CalculiX.
        Inp = "inp",
        /// The same bricks for ParaView.
        Vtu = "vtu",
    }
}

choices! {
    /// The order of the shape functions of bricks.
    ElementOrder {
        /// Eight nodes, straight edges.
        First = "1",
        /// Twenty nodes, edges through points of the exact surfaces.
        Second = "2",
    }
}

choices! {
    /// A format of pictures.
    PictureFormat {
        /// Pixels.
        Png = "png",
        /// Lines and letters.
        Svg = "svg",
    }
}

choices! {
    /// A format of tables.
    TableFormat {
        /// Comma-separated.
        Csv = "csv",
        /// With a schema.
        Json = "json",
    }
}

choices! {
    /// A format of reports.
    ReportFormat {
        /// One page with its pictures in it.
        Html = "html",
        /// Markdown with its pictures beside it.
        Md = "md",
    }
}

impl ReportFormat {
    /// What a path says it is; nothing for a folder.
    pub fn of_path(path: &Path) -> Option<ReportFormat> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match &*extension {
            "html" | "htm" => Some(ReportFormat::Html),
            "md" => Some(ReportFormat::Md),
            _ => None,
        }
    }
}

choices! {
    /// A kind of picture.
    #[derive(Serialize, JsonSchema)]
    #[serde(rename_all = "kebab-case")]
    PlotKind {
        /// The whole gear, and three of its teeth large, with its data: of a job with a `solid`.
        Gear = "gear",
        /// All surfaces in space, with axis, frame and dimensions.
        Surface = "surface",
        /// Heights above the flank's measuring grid: of the deviation, of what single edges leave, or over the involute.
        Topography = "topography",
        /// Profile and helix traces of involute flanks with their evaluation by ISO 1328-1.
        Traces = "traces",
        /// Maps of the principal curvatures, their product and their mean.
        Curvature = "curvature",
        /// Maps of how far parameters and settings move the surface.
        Sensitivity = "sensitivity",
        /// A map of how far a surface lies off another one.
        Deviation = "deviation",
        /// A map of what single edges leave.
        Left = "left",
        /// A map of what the solved equations leave.
        Residual = "residual",
        /// Lines on which the motions have equal values.
        ContactLines = "contact-lines",
        /// A section through the tooth space, with the tool where it touches.
        Section = "section",
        /// The machine as a kinematic diagram.
        Machine = "machine",
        /// Positions of the axes over the motions.
        Motion = "motion",
        /// Contact pattern of a pair: both flanks laid flat with what the marking compound shows, path and ellipses.
        Pattern = "pattern",
        /// Transmission error of a pair over the roll, with all pairs of teeth in mesh.
        Error = "error",
        /// Maps of the least gap between the flanks of a pair over the roll.
        Gap = "gap",
        /// The path of contact of a pair on both flanks, with roll positions and ellipses.
        Path = "path",
        /// What an end mill leaves: the ridges between its passes, the cutter across them, clearances and rotary axes along a pass.
        Milling = "milling",
    }
}

choices! {
    /// A control that NC programs are written for.
    NcDialect {
        /// Fanuc.
        Fanuc = "fanuc",
        /// Siemens 840D.
        Siemens = "siemens",
        /// LinuxCNC.
        LinuxCnc = "linuxcnc",
        /// Heidenhain TNC, Klartext.
        Heidenhain = "heidenhain",
    }
}

choices! {
    /// A format of cutter locations.
    CutterFormat {
        /// A table with contact, normal, tip, axis and the axes of the machine.
        Csv = "csv",
        /// APT: GOTO with tip and axis.
        Apt = "apt",
    }
}

choices! {
    /// A language that functions are written in.
    FunctionLanguage {
        /// C.
        C = "c",
        /// Rust.
        Rust = "rust",
        /// JavaScript.
        JavaScript = "javascript",
    }
}

choices! {
    /// What functions of a motion compute.
    EmitForm {
        /// The polynomials.
        Polynomials = "polynomials",
        /// The exact axes in closed form.
        Exact = "exact",
    }
}

impl From<NcDialect> for Dialect {
    fn from(dialect: NcDialect) -> Dialect {
        match dialect {
            NcDialect::Fanuc => Dialect::Fanuc,
            NcDialect::Siemens => Dialect::Siemens840D,
            NcDialect::LinuxCnc => Dialect::LinuxCnc,
            NcDialect::Heidenhain => Dialect::Heidenhain,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_found_by_their_names() {
        for kind in PlotKind::ALL {
            assert_eq!(kind.name().parse(), Ok(*kind));
            assert_eq!(serde_json::to_value(kind).expect("a text"), kind.name(), "documents have the same name");
        }
        let unknown = "pdf".parse::<PictureFormat>().expect_err("there is none");
        assert_eq!(unknown.to_string(), "there is no `pdf`; there is: png, svg");
    }
}
