//! `flank solve --sensitivity`: how far each parameter moves the surfaces.

use std::f64::consts::PI;

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Parameter};
use flank_export::{Field, Known, Values};
use flank_solver::{Displacement, NormalSensitivity, SurfacePoint};

use crate::project::units;
use crate::solve::result::{ParameterInfluence, SensitivityTable, UsualChange};

/// Maps on one picture.
pub(crate) const MAPS: usize = 6;

/// What the numbers are, for pictures.
pub(crate) const NOTE: &str = "Normal displacement of the surface per unit of a parameter, exact derivative; plus is more \
    material. One scale for all parameters of a unit. Parameters whose definition contains it follow; to first order it does not matter whether the points that are \
    asked for move with it.";

/// How the points of a surface move with each parameter of the job that is no count.
pub(crate) struct Sensitivity {
    influences: Vec<Influence>,
    counts: Vec<String>,
    /// Points at which all influences are known.
    points: usize,
}

struct Influence {
    parameter: String,
    /// The change that values are told for: mm, radians or 1.
    step: f64,
    unit: String,
    dimension: Dimension,
    /// The change that parameters are ranked by, in the same unit.
    usual_change: f64,
    /// um for the step, as the two that follow.
    values: Known<f64>,
    rms: f64,
    largest: f64,
    /// Whether it moves any point.
    moves: bool,
}

pub(crate) fn over_points<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>, points: &[SurfacePoint]) -> Sensitivity {
    let changing =
        |p: &Parameter<'g>| flank_solver::Parameter { variable: p.variable, definition: p.definition, value: p.value };
    let parameters: Vec<_> = job.parameters.iter().map(changing).collect();
    let exact =
        NormalSensitivity::new(&surface.surface, &parameters).expect("a job without errors leaves nothing unbound");
    let (counts, continuous): (Vec<_>, Vec<_>) =
        job.parameters.iter().enumerate().partition(|(_, parameter)| parameter.is_count);
    let places: Vec<usize> = continuous.iter().map(|(k, _)| *k).collect();
    let (moved, known) = exact.over(points, &places);
    let influences = continuous.iter().zip(moved);
    let influences = influences.map(|((_, parameter), moved)| Influence::new(parameter, moved)).collect();
    let counts = counts.into_iter().map(|(_, parameter)| parameter.name.clone()).collect();
    Sensitivity { influences, counts, points: known }
}

impl Influence {
    fn new(parameter: &Parameter<'_>, moved: Displacement) -> Influence {
        let (size, step) = small_step(parameter.dimension);
        let moves = moved.moves();
        let Displacement { at_points, rms, largest } = moved.times(1e3 * size);
        Influence {
            parameter: parameter.name.clone(),
            step: size,
            unit: format!("um/{step}"),
            dimension: parameter.dimension,
            usual_change: usual_change(parameter),
            values: at_points.into_iter().map(|um| (!um.is_nan()).then_some(um)).collect(),
            rms,
            largest,
            moves,
        }
    }

    /// As pictures show it: with its name in words.
    fn plain_field(&self) -> Field {
        let name = self.parameter.rsplit('.').next().unwrap_or_default().replace('_', " ");
        let unit = self.unit.replacen("um/", "\u{b5}m per ", 1);
        Field { name: format!("{name}, {unit}"), meaning: self.parameter.clone(), ..self.field() }
    }

    fn field(&self) -> Field {
        Field {
            name: format!("d_normal/d_{}", self.parameter),
            unit: self.unit.clone(),
            meaning: format!(
                "normal displacement of the surface for a change of `{}`; plus is more material",
                self.parameter
            ),
            values: Values::Scalars(self.values.clone()),
        }
    }

    /// A number that is told for the step, for the usual change instead: um.
    fn by_usual_change(&self, um: f64) -> f64 {
        um * self.usual_change / self.step
    }

    /// The usual change and its unit, to three digits.
    fn shown_usual_change(&self) -> (f64, String) {
        let (size, unit) = match self.dimension {
            Dimension::LENGTH => (self.usual_change, "mm".to_string()),
            Dimension::ANGLE => (self.usual_change / ARCMIN, "arcmin".to_string()),
            Dimension::NUMBER => (self.usual_change, String::new()),
            other => (self.usual_change, units::inside(other)),
        };
        (format!("{size:.2e}").parse().unwrap_or(size), unit)
    }

    fn told(&self) -> ParameterInfluence {
        let (size, unit) = self.shown_usual_change();
        let [rms_um, largest_um] = [self.rms, self.largest].map(|um| self.by_usual_change(um));
        ParameterInfluence {
            name: self.parameter.clone(),
            unit: self.unit.clone(),
            rms: self.rms,
            largest: self.largest,
            usual_change: UsualChange { size, unit, rms_um, largest_um },
        }
    }
}

const ARCMIN: f64 = PI / 10_800.0;

/// The change of a parameter that is usual when a machine is set, so that parameters of all dimensions can be ranked: 0.01 mm of a length
/// and one arcminute of an angle; of all others a thousandth of the value, where that is zero of the width of the range, and where
/// there is none of one, in mm and radians.
pub(crate) fn usual_change(parameter: &Parameter<'_>) -> f64 {
    const SHARE: f64 = 1e-3;
    match parameter.dimension {
        Dimension::LENGTH => 0.01,
        Dimension::ANGLE => ARCMIN,
        _ if parameter.value != 0.0 => SHARE * parameter.value.abs(),
        _ => SHARE * parameter.range.map_or(1.0, |(low, high)| high - low),
    }
}

/// The change of a parameter that displacements are told for: its size in mm and radians, and how it is written.
fn small_step(dimension: Dimension) -> (f64, String) {
    match dimension {
        Dimension::LENGTH => (1.0, "mm".to_string()),
        Dimension::ANGLE => (ARCMIN, "arcmin".to_string()),
        Dimension::NUMBER => (1e-3, "0.001".to_string()),
        other => (1.0, format!("({})", crate::project::units::inside(other))),
    }
}

impl Sensitivity {
    /// A field for each parameter, in the order of the job.
    pub(crate) fn fields(&self) -> impl Iterator<Item = Field> {
        self.influences.iter().map(Influence::field)
    }

    /// Those of some places in that order, with names in words.
    pub(crate) fn plain_fields(&self, places: &[usize]) -> Vec<Field> {
        places.iter().map(|place| self.influences[*place].plain_field()).collect()
    }

    /// The parameters that move the surface, the one whose usual change does most first, each by its place in the job.
    fn ranked(&self) -> Vec<(usize, &Influence)> {
        let mut ranked: Vec<(usize, &Influence)> =
            self.influences.iter().enumerate().filter(|(_, one)| one.moves).collect();
        ranked.sort_by(|(_, a), (_, b)| b.by_usual_change(b.rms).total_cmp(&a.by_usual_change(a.rms)));
        ranked
    }

    /// The largest normal displacement by a parameter, mm per mm, radian or 1 of it; `None` for counts.
    pub(crate) fn most(&self, parameter: &str) -> Option<f64> {
        let of = self.influences.iter().find(|one| one.parameter == parameter)?;
        Some(1e-3 * of.largest / of.step)
    }

    /// The names of all parameters, in the order of [`Sensitivity::fields`].
    pub(crate) fn parameters(&self) -> impl Iterator<Item = &str> {
        self.influences.iter().map(|one| one.parameter.as_str())
    }

    /// The places, in that order, of those that move the surface most.
    pub(crate) fn most_moving(&self, count: usize) -> Vec<usize> {
        self.ranked().into_iter().take(count).map(|(k, _)| k).collect()
    }

    /// The parameters that move no point; of none can be said so where no point is known.
    fn idle(&self) -> Vec<&str> {
        self.influences.iter().filter(|one| self.points > 0 && !one.moves).map(|one| one.parameter.as_str()).collect()
    }

    pub(crate) fn table(&self) -> SensitivityTable {
        SensitivityTable {
            points: self.points,
            parameters: self.ranked().iter().map(|(_, one)| one.told()).collect(),
            no_influence: self.idle().into_iter().map(str::to_string).collect(),
            counts: self.counts.clone(),
        }
    }
}
