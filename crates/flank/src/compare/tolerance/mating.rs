//! A contact that the surface takes part in, when settings and mounting change.

use flank_chain_dsl::{Contact, Job};
use flank_expr::Expr;
use flank_solver::{ContactPoint, ContactProblem, ContactState, FlankDirections};

use super::causes::{Cause, CausePlace};
use super::quantity::Quantity;
use crate::contact::influence;
use crate::contact::pair::Members;
use crate::contact::place::{dot, fine_unit, rows_at};
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::session::Session;

/// Positions over a pitch among which the middle is looked for, as `flank contact` has it where nobody says how many.
const POSITIONS: usize = 60;

/// A contact in its middle.
pub(super) struct Mating {
    name: String,
    /// In all axes and all settings.
    problem: ContactProblem,
    middle: ContactPoint,
    is_vertex: bool,
    /// On the second flank.
    along: FlankDirections,
    /// What the second derivative of the error is worth as its height over a pitch, where that is known.
    height: Option<f64>,
    error_unit: &'static str,
    /// For each cause the symbols of the problem that change with it.
    symbols: Vec<Vec<(usize, f64)>>,
    /// The axes of the pair's machine, in the order of its symbols.
    axes: Vec<String>,
}

impl Mating {
    /// `None` where the flanks do not touch in a point, or their sample tells no directions there.
    ///
    /// # Errors
    /// If a flank is not sampled, or the work is cancelled.
    pub(super) fn new<'g>(
        job: &Job<'g>,
        contact: &Contact<'g>,
        causes: &[Cause],
        session: Session<'_>,
    ) -> Result<Option<Mating>, Failure> {
        let mut members = Members::solved(job, contact, session)?;
        members.check_range(job)?;
        let errors = vec![0.0; contact.errors.len()];
        let Ok(rolling) = Rolling::of_members(job, &mut members, &errors, POSITIONS) else { return Ok(None) };
        // along a line nothing is proportional: any change brings the contact to one end or the other
        let is_point = |middle: &&ContactPoint| middle.state != Some(ContactState::Line);
        let Some(middle) = rolling.middle().filter(is_point).cloned() else { return Ok(None) };
        let Some(along) = rows_at(&members, 1, &middle) else { return Ok(None) };
        let is_vertex = rolling.vertex.is_some();
        let pitch = members.pitch(job).filter(|_| is_vertex);
        let height = pitch.map(|pitch| middle.lag_slopes[1].signum() * pitch * pitch / 8.0);
        let open: Vec<Expr<'g>> = causes.iter().filter_map(|of| of.setting(job)).map(|of| of.variable).collect();
        let following = influence::following(job, &open, errors.len());
        let axis = |name: &str| contact.errors.iter().position(|axis| axis.name == name);
        let symbols = causes.iter().map(|cause| match cause.at {
            CausePlace::Setting(at) => following[at].clone(),
            CausePlace::Axis(..) => axis(&cause.name).map(|at| (at, 1.0)).into_iter().collect(),
        });
        Ok(Some(Mating {
            name: contact.name.clone(),
            problem: members.open_problem(job, &errors),
            is_vertex,
            along,
            height,
            error_unit: fine_unit(contact.lag.dimension),
            symbols: symbols.collect(),
            axes: contact.errors.iter().map(|axis| axis.name.clone()).collect(),
            middle,
        }))
    }

    /// What scatters, each with its change by a unit of each cause; `None` where the contact is singular.
    pub(super) fn quantities(&self) -> Option<Vec<Quantity>> {
        let changes = self.symbols.iter().map(|symbols| {
            if symbols.is_empty() {
                return Some([0.0; 4]);
            }
            let change = self.problem.change(&self.middle, symbols, self.is_vertex)?;
            Some(self.numbers(change.moved[1], [change.lag, change.lag_curvature]))
        });
        let changes = changes.collect::<Option<Vec<[f64; 4]>>>()?;
        let fine = if self.error_unit == "um" { 1e-3 } else { 1e-6 };
        let all = [
            ("lengthwise", "mm", 1.0),
            ("profilewise", "mm", 1.0),
            ("error", self.error_unit, fine),
            ("transmission_error", self.error_unit, fine),
        ];
        let quantity = |(at, (name, unit, size)): (usize, &(&str, &'static str, f64))| Quantity {
            name: format!("{}.{name}", self.name),
            unit,
            size: *size,
            gradient: changes.iter().map(|of| of[at]).collect(),
        };
        Some(all[..self.count()].iter().enumerate().map(quantity).collect())
    }

    /// The changes of the same numbers where the axes have errors and the settings other values, all that are no counts; `None` if the
    /// flanks do not touch there.
    pub(super) fn with(&self, error: &dyn Fn(&str) -> f64, settings: &[f64]) -> Option<Vec<f64>> {
        let errors = self.axes.iter().map(|axis| error(axis));
        let values: Vec<f64> = errors.chain(settings.iter().copied()).collect();
        let problem = self.problem.with_values(&values);
        let near = problem.again(&self.middle, self.middle.roll)?;
        let at = if self.is_vertex { problem.vertex_near(&near)? } else { near };
        let moved = std::array::from_fn(|k| at.in_members[1][k] - self.middle.in_members[1][k]);
        let curved = at.lag_slopes[1] - self.middle.lag_slopes[1];
        let numbers = self.numbers(moved, [at.lag - self.middle.lag, curved]);
        let fine = if self.error_unit == "um" { 1e3 } else { 1e6 };
        Some(numbers.iter().zip([1.0, 1.0, fine, fine]).take(self.count()).map(|(of, size)| of * size).collect())
    }

    fn numbers(&self, moved: [f64; 3], [lag, curvature]: [f64; 2]) -> [f64; 4] {
        let FlankDirections { lengthwise, profilewise } = &self.along;
        [dot(&moved, lengthwise), dot(&moved, profilewise), lag, curvature * self.height.unwrap_or(0.0)]
    }

    fn count(&self) -> usize {
        if self.height.is_some() { 4 } else { 3 }
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }
}
