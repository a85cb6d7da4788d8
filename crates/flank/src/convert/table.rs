//! What `flank convert` knows of a motion, for its files and its result.

use std::collections::BTreeMap;

use flank_chain_dsl::{Axis, Dimension, Job, NcWord};
use flank_solver::{Outcome, Posture, Screw, Unproven};

use super::Conversion;
use super::rates::Rates;
use super::result::{
    AxisExtent, AxisMotion, AxisPolynomials, AxisPosition, AxisRates, CarriedJob, MissingMotion, NcDeviation,
    Remainders, RestingAxis, ToolSymmetry,
};
use super::series::Series;
use crate::project::quantity::{NamedUnit, Travel, UnitSymbol};
use crate::project::remark::NotDone;
use crate::project::requests::ConvertRequest;
use crate::project::shown_path;
use crate::project::units;

/// A column: the name of a motion or an axis.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) dimension: Dimension,
    pub(super) travel: Option<(f64, f64)>,
}

pub(crate) struct Table {
    pub(super) of: CarriedJob,
    /// What is carried over, and whereto, for the heads of files.
    pub(super) carried: String,
    pub(super) motions: Vec<Named>,
    pub(super) axes: Vec<Named>,
    /// What NC programs say of each axis.
    pub(super) words: Vec<NcWord>,
    pub(super) positions: Vec<Vec<f64>>,
    pub(super) line: Vec<Posture>,
    resting: Option<RestingAxis>,
    symmetries: Vec<Screw>,
    /// Where all sampled points are made, if nothing moves between them.
    still: Option<Vec<f64>>,
    pub(super) series: Option<Series>,
    /// Over the cutting time, if there is one.
    pub(super) rates: Option<Rates>,
    /// What an NC program leaves on the flank.
    pub(super) nc_deviation: Option<NcDeviation>,
}

impl Table {
    pub(crate) fn new(
        job: &Job<'_>,
        carried: &Conversion<'_, '_>,
        (series, rates): (Option<Series>, Option<Rates>),
        request: &ConvertRequest,
    ) -> Table {
        let Conversion { source, machine, free, .. } = carried;
        let axis = |axis: &&Axis<'_>| Named { name: axis.name.clone(), dimension: axis.dimension, travel: axis.travel };
        let motions = source.motions.iter();
        let motions =
            motions.map(|motion| Named { name: motion.name.clone(), dimension: motion.dimension, travel: None });
        Table {
            of: super::carried_job(job, (machine, source), request),
            carried: format!(
                "{} against {}, as they make {}, on machine {} ({})",
                source.tool,
                source.work,
                source.surfaces.join(", "),
                machine.name,
                shown_path(&request.to)
            ),
            motions: motions.collect(),
            axes: free.iter().map(axis).collect(),
            words: free.iter().map(|axis| axis.word.clone()).collect(),
            positions: carried.positions.clone(),
            line: carried.line.clone(),
            resting: carried.resting.map(|(axis, at)| RestingAxis {
                name: axis.name.clone(),
                unit: UnitSymbol::of_dimension(axis.dimension),
                at: units::shown(axis.dimension, at),
            }),
            symmetries: source.symmetries.clone(),
            still: source.still.clone(),
            series,
            rates,
            nc_deviation: None,
        }
    }

    /// Postures that the tool stands in as it should, or as nearly as the axes take it, within travel or beyond. Where none was found
    /// the axes say nothing.
    fn reached(&self) -> impl Iterator<Item = &Posture> {
        self.line.iter().filter(|posture| matches!(posture.outcome, Outcome::Solved | Outcome::Outside { .. }))
    }

    /// Of the positions that are reached.
    fn ends(&self, k: usize) -> (f64, f64) {
        let values = self.reached().map(|posture| posture.axes[k]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    }

    fn by_axis<T: Clone>(&self, values: impl IntoIterator<Item = T>) -> BTreeMap<String, T> {
        self.axes.iter().map(|axis| axis.name.clone()).zip(values).collect()
    }

    /// With what the target cannot do.
    pub(super) fn result(&self, not_done: Vec<NotDone>) -> AxisMotion {
        let named = |named: &Named| NamedUnit::new(&named.name, named.dimension);
        let symmetries = self.symmetries.iter();
        let shown = |at: &Vec<f64>| -> Vec<f64> {
            self.motions.iter().zip(at).map(|(motion, x)| units::shown(motion.dimension, *x)).collect()
        };
        AxisMotion {
            of: self.of.clone(),
            made_at: self.still.as_ref().map(shown),
            motions: self.motions.iter().map(named).collect(),
            axes: self.axes.iter().enumerate().map(|(k, axis)| self.extent(k, axis)).collect(),
            resting: self.resting.clone(),
            tool_symmetries: symmetries
                .map(|screw| ToolSymmetry { angular: screw.angular, linear: screw.linear })
                .collect(),
            positions: self.positions.iter().zip(&self.line).map(|(at, posture)| self.position(at, posture)).collect(),
            polynomials: self.series.as_ref().map(|series| self.polynomials(series)),
            rates: self.rates.as_ref().map(|rates| self.axis_rates(rates)),
            nc_deviation: self.nc_deviation,
            files: Vec::new(),
            not_done,
        }
    }

    fn extent(&self, k: usize, axis: &Named) -> AxisExtent {
        let (low, high) = self.ends(k);
        let [low, high] = [low, high].map(|x| finite(units::shown(axis.dimension, x)));
        let travel = axis.travel.map(|travel| Travel::new(axis.dimension, travel));
        AxisExtent { name: axis.name.clone(), unit: UnitSymbol::of_dimension(axis.dimension), low, high, travel }
    }

    fn position(&self, at: &[f64], posture: &Posture) -> AxisPosition {
        let shown = |values: &[f64], of: &[Named]| -> Vec<Option<f64>> {
            of.iter().zip(values).map(|(named, x)| finite(units::shown(named.dimension, *x))).collect()
        };
        AxisPosition {
            motions: shown(at, &self.motions),
            axes: shown(&posture.axes, &self.axes),
            status: posture.outcome.word(),
            missing: posture.missing.map(|missing| MissingMotion { direction: missing.direction, by: missing.by }),
        }
    }

    fn polynomials(&self, series: &Series) -> AxisPolynomials {
        let bounds = series.remainders.as_ref();
        let not_proven_at = |unproven: &Unproven| units::shown(self.motions[0].dimension, unproven.at);
        AxisPolynomials {
            reference: series.about,
            order: series.order,
            units: "mm and rad per rad (mm) of the motion to the power",
            coefficients: self.by_axis(series.axes.iter().cloned()),
            deviation_mm_by_order: series.deviations.clone(),
            remainders: Remainders {
                units: "mm and rad",
                seen: self.by_axis(series.seen.iter().copied()),
                proven: bounds.ok().map(|bounds| self.by_axis(bounds.iter().copied())),
                not_proven_at: bounds.err().map(not_proven_at),
            },
        }
    }

    fn axis_rates(&self, rates: &Rates) -> AxisRates {
        let shown = |axis: usize, of: [f64; 3]| of.map(|rate| units::shown(self.axes[axis].dimension, rate));
        let row = |row: &Vec<[f64; 3]>| -> Vec<[f64; 3]> {
            row.iter().enumerate().map(|(axis, of)| shown(axis, *of)).collect()
        };
        AxisRates {
            seconds: rates.seconds,
            units: "velocity, acceleration, jerk: mm or deg per s, s^2, s^3",
            most: self.by_axis((0..self.axes.len()).map(|k| shown(k, rates.most(k)))),
            positions: rates.rows.iter().map(row).collect(),
        }
    }
}

/// A number that is one.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
