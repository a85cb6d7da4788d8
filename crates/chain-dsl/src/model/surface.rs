//! Surfaces, and how they came about.

use flank_expr::Expr;
use flank_expr::geometry::{Chain, Edge, Step, Surface, Vector3};

use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::model::sample::Sample;

/// A surface of a job in the frame it is asked for in.
#[derive(Clone, Debug)]
pub struct GeneratedSurface<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The frame, as `m.table`.
    pub frame: String,
    /// How it came about.
    pub generation: Generation<'g>,
    /// The surface, in motions and parameters.
    pub surface: Surface<'g>,
    /// Ranges of its unknowns, in the order of `surface.unknowns`.
    pub unknowns: Vec<RangedVariable<'g>>,
    /// The surfaces of the job that cut points of it away, as indices into its surfaces.
    pub trimmed_by: Vec<usize>,
    /// The sweep of the numbered edges that really cut it, as an index into the surfaces of the job: over the same motions, one
    /// and counts.
    pub cut_by: Option<usize>,
    /// Of one more sample of a surface, with a name of its own: that surface, as an index into the surfaces of the job.
    pub sample_of: Option<usize>,
    /// The points that are asked for.
    pub sample: Option<Sample<'g>>,
    /// Where its name is written.
    pub written: Span,
}

/// What a tool is, in its own frame.
#[derive(Clone, Debug)]
pub enum ToolShape<'g> {
    /// A surface: an envelope takes it.
    Surface(Surface<'g>),
    /// A cutting edge: a sweep takes it.
    Edge(Edge<'g>),
}

/// How a surface came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// The envelope of a tool's surface.
    Envelope,
    /// The sweep of a cutting edge.
    Sweep,
    /// The tool's surface itself, seen from another frame.
    Move,
}

/// The envelope that made a surface.
#[derive(Clone, Debug)]
pub struct Generation<'g> {
    /// The tool's surface, as `c.flank`.
    pub tool_name: String,
    /// How the surface came about.
    pub process: Process,
    /// The tool in its own frame.
    pub tool: ToolShape<'g>,
    /// Where it is written on which side of it the steel lies; none of a surface that the job made.
    pub body: Option<Span>,
    /// The frames from work to tool, as `m.table`, with the steps between each and the one before it.
    pub path: Vec<(String, Vec<Step<'g>>)>,
    /// The pose of the tool in the work, in axis variables.
    pub t_work_tool: Chain<'g>,
    /// The same with each axis replaced by its law.
    pub driven: Chain<'g>,
    /// The motions that it is an envelope over.
    pub motions: Vec<Expr<'g>>,
}

impl<'g> Generation<'g> {
    /// A point of the tool in its own frame.
    pub fn position(&self) -> Vector3<'g> {
        match &self.tool {
            ToolShape::Surface(surface) => surface.position,
            ToolShape::Edge(edge) => edge.position,
        }
    }

    /// The frame that the tool is given in.
    pub fn tool_frame(&self) -> &str {
        self.path.last().map_or("", |(name, _)| name)
    }
}
