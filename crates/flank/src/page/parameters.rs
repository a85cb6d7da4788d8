//! The parameters of a job, and how far the page lets them be moved.

use flank_chain_dsl::{Dimension, Job, Parameter};
use flank_draw::PageParameter;

use super::functions::Functions;
use crate::project::units;
use crate::solve::sensitivity::Sensitivity;
use crate::solve::solved::Solved;

/// By how much of its size a surface may be moved by one parameter, to first order.
const OF_SURFACE: f64 = 0.05;
/// No slider moves a parameter by more than this share of its value, an angle by more than this, radians.
const OF_VALUE: f64 = 0.25;
const OF_ANGLE: f64 = 0.1;
/// A share of a value that moves no surface by more than this share of its size (1 um of 100 mm) is nothing to look at: such a
/// value is taken for zero, which has no size of its own.
const NOTHING: f64 = 1e-5;

/// In the order of the job.
pub(super) fn page_parameters(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> Vec<PageParameter> {
    let reaches: Vec<(f64, &Sensitivity)> =
        solved.iter().filter_map(|solved| Some((size(solved), solved.sensitivity.as_ref()?))).collect();
    let page = |parameter: &Parameter<'_>| PageParameter {
        name: parameter.name.clone(),
        unit: match units::symbol(parameter.dimension) {
            "" => units::inside(parameter.dimension),
            symbol => symbol.to_string(),
        },
        value: parameter.value,
        range: range(parameter, &reaches),
        limits: limits(parameter),
    };
    job.parameters.iter().map(page).collect()
}

/// The function that gives each parameter by its definition; none if there are no parameters.
pub(super) fn definitions<'g>(job: &Job<'g>, functions: &mut Functions<'g>) -> Option<String> {
    let outputs: Vec<_> = job.parameters.iter().map(|parameter| (&*parameter.name, parameter.definition)).collect();
    (!outputs.is_empty()).then(|| functions.add("definitions", &[], &outputs))
}

/// The diagonal of the box around its solved points, mm.
fn size(solved: &Solved<'_, '_>) -> f64 {
    let positions = solved.points.iter().filter(|point| point.outcome == flank_solver::Outcome::Solved);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in positions {
        for k in 0..3 {
            low[k] = low[k].min(point.position[k]);
            high[k] = high[k].max(point.position[k]);
        }
    }
    (0..3).map(|k| (high[k] - low[k]).max(0.0)).fold(0.0, f64::hypot)
}

/// Between which values it must lie.
fn limits(parameter: &Parameter<'_>) -> [f64; 2] {
    parameter.range.map_or([f64::NEG_INFINITY, f64::INFINITY], |(low, high)| [low, high])
}

/// As far as no surface moves by more than a share of its size, within what the spec allows; nothing for what is counted and
/// what moves no surface.
fn range(parameter: &Parameter<'_>, reaches: &[(f64, &Sensitivity)]) -> Option<[f64; 2]> {
    let of_surfaces = reaches.iter().filter_map(|(size, sensitivity)| {
        let most = sensitivity.most(&parameter.name).filter(|most| *most > 0.0)?;
        Some(OF_SURFACE * size / most)
    });
    let of_surfaces = of_surfaces.reduce(f64::min)?;
    let of_value = OF_VALUE * parameter.value.abs();
    let of_value = if of_value * OF_SURFACE > NOTHING * of_surfaces { of_value } else { f64::INFINITY };
    let of_kind = if parameter.dimension == Dimension::ANGLE { OF_ANGLE } else { of_value };
    let by = rounded(units::shown(parameter.dimension, of_surfaces.min(of_kind)));
    let by = by / units::shown(parameter.dimension, 1.0);
    let [low, high] = limits(parameter);
    let range = [(parameter.value - by).max(low), (parameter.value + by).min(high)];
    (range[0] < range[1]).then_some(range)
}

/// The next lower one of 1, 2, 5, 10, 20, …
fn rounded(by: f64) -> f64 {
    let power = 10f64.powf(by.log10().floor());
    [5.0, 2.0].into_iter().map(|k| k * power).find(|step| *step <= by).unwrap_or(power)
}
