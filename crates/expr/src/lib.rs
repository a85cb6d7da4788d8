//! Symbolic scalars that share everything, differentiate exactly, and run as tapes; and the geometry of rigid motions and
//! enveloped surfaces over such scalars.
//!
//! Order of the modules is the pipeline: a [`Graph`] makes [`Expr`]s and simplifies them on construction, `derivative`
//! differentiates on the shared graph, [`Tape`] lays expressions out for fast evaluation. [`geometry`] builds vectors,
//! poses, chains, twists and surfaces under constraint from them. Nothing here knows of machines or gears.
//!
//! ```
//! use flank_expr::{Graph, ScalarEvaluator, Tape};
//!
//! let graph = Graph::new();
//! let (x, y) = (graph.variable("x"), graph.variable("y"));
//! let f = x.sin() * y;
//! let tape = Tape::new(&[f, f.derivative(x)], &[x, y]).expect("x and y are the inputs");
//! let mut evaluator = ScalarEvaluator::new(&tape);
//! let mut out = [0.0; 2];
//! evaluator.run(&[0.0, 3.0], &mut out);
//! assert_eq!(out, [0.0, 3.0]);
//! ```

mod emit;
mod enclosure;
pub mod geometry;
mod symbolic;
mod tape;

pub use emit::{Language, Polynomial, Signature, emit_function, emit_polynomials, emit_values};
pub use enclosure::implicit::{NoRoot, OnlyRoots, Unknown, every_root, has_one_root, roots};
pub use enclosure::interval::{Interval, IntervalEvaluator};
pub use enclosure::quadrature::{End, Unproven, integral};
pub use enclosure::taylor::{Coefficient, TaylorEvaluator};
pub use symbolic::curve::{Curve, CurveError};
pub use symbolic::derivative::Linear;
pub use symbolic::graph::{CurveId, Expr, Graph, Node, NodeCount, NodeId, VariableId};
pub use symbolic::implicit::RootId;
pub use symbolic::integral::IntegralId;
pub use symbolic::op::{Binary, Unary};
pub use symbolic::print::{Definition, Listing, Style};
pub use tape::cost::Cost;
pub use tape::evaluate::ScalarEvaluator;
pub use tape::lanes::{InstructionSet, LANES, LaneEvaluator, LaneTape, Varies};
pub use tape::{Instruction, Operation, Tape, TapeError};
