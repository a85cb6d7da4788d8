//! Machines: trees of frames moved by axes.

use flank_expr::geometry::{Chain, Step};
use flank_expr::{Expr, Graph};

use crate::values::dimension::{Dimension, WrittenUnit};

/// A machine of a job: a tree of frames moved by axes.
#[derive(Clone, Debug)]
pub struct Machine<'g> {
    /// Its name in the job.
    pub name: String,
    /// The machine that it is one of.
    pub definition: String,
    /// Its axes.
    pub axes: Vec<Axis<'g>>,
    /// Its frames, parents before children; the first is the root.
    pub frames: Vec<Frame<'g>>,
}

/// An axis and its law.
#[derive(Clone, Debug)]
pub struct Axis<'g> {
    /// Its name.
    pub name: String,
    /// The variable in the frames' transforms.
    pub variable: Expr<'g>,
    /// A length or an angle.
    pub dimension: Dimension,
    /// Its value as a function of motions and parameters.
    pub law: Expr<'g>,
    /// How the law was given.
    pub source: LawSource,
    /// Travel, mm or radians.
    pub travel: Option<(f64, f64)>,
    /// What the travel is written in.
    pub travel_unit: Option<WrittenUnit>,
    /// What NC programs say of it.
    pub word: NcWord,
}

/// How NC programs name and count an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct NcWord {
    /// Its letter, perhaps with a number behind.
    pub address: String,
    /// Whether the control counts against the axis of the machine's frames.
    pub reversed: bool,
    /// What the control shows where the axis stands at zero, mm or radians.
    pub offset: f64,
    /// Decimals in which positions are written, in mm or degrees, where the machine says so.
    pub decimals: Option<u8>,
}

impl NcWord {
    /// The word of an axis that nothing is said of: its own name and count.
    pub(crate) fn of_axis(name: &str) -> NcWord {
        NcWord { address: name.to_string(), reversed: false, offset: 0.0, decimals: None }
    }
}

/// Where an axis has its law from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawSource {
    /// `drive` in the job.
    Driven,
    /// `fix` in the machine.
    Fixed,
    /// `couple` in the machine.
    Coupled,
    /// `close` in the machine: a closed loop gives it.
    Closed,
    /// Nowhere: it stands where it is put ([`compile_with_machine`](crate::compile_with_machine)); its law is its own variable.
    Free,
}

/// A frame in its machine.
#[derive(Clone, Debug)]
pub struct Frame<'g> {
    /// Its name.
    pub name: String,
    /// Index of the frame it hangs on; `None` for the root.
    pub parent: Option<usize>,
    /// From the parent to it, in axis variables.
    pub steps: Vec<Step<'g>>,
}

impl<'g> Machine<'g> {
    /// The pose of frame `to` in frame `from`, in axis variables; `None` if the machine has no such frame.
    pub fn chain(&self, graph: &'g Graph, from: &str, to: &str) -> Option<Chain<'g>> {
        let place = |name: &str| self.frames.iter().position(|frame| frame.name == name);
        let hops = path(&self.frames, place(from)?, place(to)?);
        Some(Chain::new(graph, hops.into_iter().flat_map(|(_, steps)| steps).collect()))
    }
}

/// The steps from one frame of a machine to another: up to the frame that both hang on, then down. Each hop is named by
/// the frame that it arrives in.
pub(crate) fn path<'g>(frames: &[Frame<'g>], from: usize, to: usize) -> Vec<(usize, Vec<Step<'g>>)> {
    let line = |start: usize| std::iter::successors(Some(start), |&k| frames[k].parent).collect::<Vec<_>>();
    let (mut up, mut down) = (line(from), line(to));
    // frames above the meeting point belong to neither way
    while up.len() > 1 && down.len() > 1 && up[up.len() - 2] == down[down.len() - 2] {
        up.pop();
        down.pop();
    }
    let mut hops = vec![(from, Vec::new())];
    for pair in up.windows(2) {
        let steps = frames[pair[0]].steps.iter().rev().map(|step| step.inverse()).collect();
        hops.push((pair[1], steps));
    }
    for pair in down.windows(2).rev() {
        hops.push((pair[0], frames[pair[0]].steps.clone()));
    }
    hops
}
