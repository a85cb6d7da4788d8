//! How an operation works: by which instructions, followed by whom, with what is known already.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_expr::InstructionSet;
use flank_solver::MOST_BOXES;

use crate::project::failure::Failure;
use crate::project::monitor::{Monitor, Work};
use crate::project::once::KnownSamples;

/// How the numbers are worked out; it changes no bit of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EvaluatorOptions {
    /// Whether equations are compiled to machine code; otherwise they are interpreted.
    pub machine_code: bool,
    /// Boxes that a search for all branches examines before it reports the rest of the ranges as undecided.
    pub boxes: u64,
}

impl Default for EvaluatorOptions {
    fn default() -> EvaluatorOptions {
        EvaluatorOptions { machine_code: true, boxes: MOST_BOXES }
    }
}

/// The same with who follows the work.
#[derive(Clone, Copy)]
pub(crate) struct Session<'m> {
    options: EvaluatorOptions,
    monitor: &'m dyn Monitor,
    known: Option<&'m KnownSamples>,
    tells_others: bool,
}

impl<'m> Session<'m> {
    pub(crate) fn new(options: EvaluatorOptions, monitor: &'m dyn Monitor) -> Session<'m> {
        Session { options, monitor, known: None, tells_others: true }
    }

    /// The same where samples are solved once, by whoever comes first: of one compilation, whose surfaces do not change.
    pub(crate) fn with_known(self, known: &'m KnownSamples) -> Session<'m> {
        Session { known: Some(known), ..self }
    }

    /// The same where nothing is told of further branches, which are not looked for then.
    pub(crate) fn with_points_alone(self) -> Session<'m> {
        Session { tells_others: false, ..self }
    }

    /// Whether further branches are told of.
    pub(crate) fn tells_others(self) -> bool {
        self.tells_others
    }

    /// What is asked of the sample of a surface.
    pub(crate) fn sample<Found: Clone + Send + Sync + 'static>(
        self,
        of: (&Job<'_>, &GeneratedSurface<'_>),
        sample: &Sample<'_>,
        what: &'static str,
        find: impl FnOnce() -> Found,
    ) -> Found {
        match self.known {
            Some(known) => known.find(of, sample, what, find),
            None => find(),
        }
    }

    pub(crate) fn boxes(self) -> u64 {
        self.options.boxes
    }

    pub(crate) fn instructions(self) -> InstructionSet {
        if self.options.machine_code { InstructionSet::fastest() } else { InstructionSet::widest() }
    }

    pub(crate) fn monitor(self) -> &'m dyn Monitor {
        self.monitor
    }

    /// Long work begins.
    ///
    /// # Errors
    /// If all work is cancelled.
    pub(crate) fn begin(self, what: String) -> Result<Box<dyn Work>, Failure> {
        self.check()?;
        Ok(self.monitor.begin(what))
    }

    /// # Errors
    /// If all work is cancelled.
    pub(crate) fn check(self) -> Result<(), Failure> {
        check(self.monitor)
    }
}

/// # Errors
/// If whoever follows the work has cancelled it.
pub(crate) fn check(monitor: &dyn Monitor) -> Result<(), Failure> {
    if monitor.is_cancelled() { Err(Failure::Cancelled) } else { Ok(()) }
}
