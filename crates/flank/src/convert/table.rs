//! What `flank convert` tells of a motion.

use std::collections::BTreeMap;
use std::fmt::Write;

use flank_chain_dsl::{Axis, Dimension, Job, NcWord};
use flank_export::fixed;
use flank_solver::{Outcome, Posture, Screw, Unproven};

use super::Conversion;
use super::blocks::Blocks;
use super::rates::Rates;
use super::result::{
    AxisExtent, AxisMotion, AxisPolynomials, AxisPosition, AxisRates, MissingMotion, NcDeviation, Remainders,
    UnseenMotion,
};
use super::series::Series;
use crate::project::remark::NotDone;
use crate::project::quantity::{NamedUnit, Travel, UnitSymbol};
use crate::project::requests::ConvertRequest;
use crate::project::shown_path;
use crate::project::units;
use crate::solve::table::aligned;

/// Powers of the unit of time.
const SECONDS: [&str; 3] = ["s", "s^2", "s^3"];

/// A column: the name of a motion or an axis.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) dimension: Dimension,
    pub(super) travel: Option<(f64, f64)>,
}

pub(crate) struct Table {
    pub(super) title: String,
    /// What is carried over, and whereto, for the heads of files.
    pub(super) carried: String,
    pub(super) job: String,
    pub(super) machine: String,
    pub(super) motions: Vec<Named>,
    pub(super) axes: Vec<Named>,
    /// What NC programs say of each axis.
    pub(super) words: Vec<NcWord>,
    pub(super) positions: Vec<Vec<f64>>,
    pub(super) line: Vec<Posture>,
    symmetries: Vec<Screw>,
    /// Where all sampled points are made, if nothing moves between them.
    still: Option<String>,
    pub(super) series: Option<Series>,
    /// Over the cutting time, if there is one.
    pub(super) rates: Option<Rates>,
    /// What an NC program leaves on the flank.
    pub(super) blocks: Option<Blocks>,
    /// Files that were written.
    pub(super) written: Vec<String>,
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
        let [file, to] = [request.jobs.file(), &request.to].map(shown_path);
        Table {
            title: format!(
                "job {} ({file}) on {} ({to}): {} against {}",
                job.name, machine.name, source.tool, source.work
            ),
            carried: format!(
                "{} against {}, as they make {}, on machine {} ({to})",
                source.tool,
                source.work,
                source.surfaces.join(", "),
                machine.name
            ),
            job: job.name.clone(),
            machine: machine.name.clone(),
            motions: motions.collect(),
            axes: free.iter().map(axis).collect(),
            words: free.iter().map(|axis| axis.word.clone()).collect(),
            positions: carried.positions.clone(),
            line: carried.line.clone(),
            symmetries: source.symmetries.clone(),
            still: source.still.as_ref().map(|at| source.place(at)),
            series,
            rates,
            blocks: None,
            written: Vec::new(),
        }
    }

    fn text(&self) -> String {
        let mut out = format!("{}\n\n", self.title);
        let _ = writeln!(out, "{} positions over {}", self.positions.len(), self.over());
        if let Some(at) = &self.still {
            let _ = writeln!(out, "that is all of it: the sampled points are all made at {at}");
        }
        for screw in &self.symmetries {
            let _ = writeln!(out, "the tool is unchanged by {}", unseen(screw));
        }
        let mut rows = vec![["axis", "from", "to", "travel"].map(String::from)];
        rows.extend(self.axes.iter().enumerate().map(|(k, axis)| {
            let (low, high) = self.ends(k);
            let travel = axis.travel.map(|(low, high)| {
                format!("{} .. {}", units::as_given(axis.dimension, low), units::as_given(axis.dimension, high))
            });
            let [low, high] = [low, high].map(|x| units::text(axis.dimension, x, 6));
            [axis.name.clone(), low, high, travel.unwrap_or_default()]
        }));
        if self.reached().next().is_some() {
            let _ = write!(out, "\n{}", aligned(&rows, "<>>>"));
        }
        if let Some(series) = &self.series {
            self.series_text(series, &mut out);
        }
        if let Some(rates) = &self.rates {
            self.rates_text(rates, &mut out);
        }
        if let Some(blocks) = self.blocks {
            let _ = writeln!(out, "\nNC programs: {}", blocks.sentence());
        }
        if !self.written.is_empty() {
            let _ = writeln!(out, "\nwrote {}", self.written.join(", "));
        }
        out
    }

    fn series_text(&self, series: &Series, out: &mut String) {
        let motion = &self.motions[0];
        let sign = if series.about < 0.0 { '+' } else { '-' };
        let about = units::text(motion.dimension, series.about.abs(), 6);
        let _ =
            writeln!(out, "\npolynomials in h = {} {sign} {about}, mm and rad; order {}", motion.name, series.order);
        let power = |k: usize| if k == 0 { "1".to_string() } else { format!("h^{k}") };
        let mut rows = vec![["axis", "coefficient"].map(String::from)];
        for (axis, coefficients) in self.axes.iter().zip(&series.axes) {
            // what does not show in the last place anywhere on the way is rounding
            let reach = self.positions.iter().map(|position| (position[0] - series.about).abs()).fold(0.0, f64::max);
            let size = coefficients.iter().enumerate().map(|(k, c)| c.abs() * reach.powi(k as i32)).fold(1.0, f64::max);
            let is_rounding = |k: usize, c: f64| c.abs() * reach.powi(k as i32) <= 4.0 * f64::EPSILON * size;
            for (k, c) in coefficients.iter().enumerate().filter(|(k, c)| *k == 0 || !is_rounding(*k, **c)) {
                let visible = if is_rounding(k, *c) { 0.0 } else { *c };
                rows.push([format!("{} {}", axis.name, power(k)), units::scientific(visible, 15)]);
            }
        }
        out.push_str(&aligned(&rows, "<>"));
        self.remainders_text(series, out);
        if let Some(most) = series.deviations.get(series.order) {
            let _ = writeln!(out, "\nthe flank is then off by up to {:.6} um", most * 1e3);
        }
    }

    fn rates_text(&self, rates: &Rates, out: &mut String) {
        let _ = writeln!(out, "\n{} evenly in {} s; at most", self.motions[0].name, rates.seconds);
        let mut rows = vec![["axis", "velocity", "acceleration", "jerk"].map(String::from)];
        rows.extend(self.axes.iter().enumerate().map(|(k, axis)| {
            let each = rates.most(k);
            let unit = units::symbol(axis.dimension);
            let [velocity, acceleration, jerk] =
                std::array::from_fn(|k| format!("{} {unit}/{}", units::digits(axis.dimension, each[k], 6), SECONDS[k]));
            [axis.name.clone(), velocity, acceleration, jerk]
        }));
        out.push_str(&aligned(&rows, "<>>>"));
    }

    /// What the polynomials leave of each axis: seen at the positions, proven over the whole way.
    fn remainders_text(&self, series: &Series, out: &mut String) {
        let bounds = match &series.remainders {
            Ok(bounds) => bounds,
            Err(unproven) => {
                let at = units::text(self.motions[0].dimension, unproven.at, 6);
                let _ =
                    writeln!(out, "\nwhat the polynomials leave is not bounded: {}", unbounded(&self.motions[0], &at));
                return;
            }
        };
        let seen = format!("seen at {} positions", self.positions.len());
        let mut rows = vec![["axis off by", &seen, "proven, nowhere more than"].map(String::from)];
        for ((axis, seen), bound) in self.axes.iter().zip(&series.seen).zip(bounds) {
            rows.push([axis.name.clone(), small(axis.dimension, *seen), at_most(axis.dimension, *bound)]);
        }
        let _ = write!(out, "\n{}", aligned(&rows, "<>>"));
    }

    /// The same in a sentence.
    pub(super) fn remainders(&self, series: &Series) -> String {
        match &series.remainders {
            Ok(bounds) => {
                let each = self.axes.iter().zip(bounds);
                let each: Vec<String> =
                    each.map(|(axis, bound)| format!("{} {}", axis.name, at_most(axis.dimension, *bound))).collect();
                format!("proven, over {}: off by at most {}", self.over(), each.join(", "))
            }
            Err(unproven) => {
                let at = units::text(self.motions[0].dimension, unproven.at, 6);
                format!("no error bound is proven: {}", unbounded(&self.motions[0], &at))
            }
        }
    }

    pub(super) fn over(&self) -> String {
        let each: Vec<String> = self.motions.iter().enumerate().map(|(k, motion)| self.span(k, motion)).collect();
        each.join(" and ")
    }

    /// `roll from … to …`
    fn span(&self, k: usize, motion: &Named) -> String {
        let values = self.positions.iter().map(|position| position[k]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let [low, high] = [low, high].map(|x| units::text(motion.dimension, x, 6));
        format!("{} from {low} to {high}", motion.name)
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
    pub(super) fn result(self, not_done: Vec<NotDone>) -> AxisMotion {
        let named = |named: &Named| NamedUnit::new(&named.name, named.dimension);
        let symmetries = self.symmetries.iter();
        AxisMotion {
            motions: self.motions.iter().map(named).collect(),
            axes: self.axes.iter().enumerate().map(|(k, axis)| self.extent(k, axis)).collect(),
            unseen_by_the_tool: symmetries
                .map(|screw| UnseenMotion { angular: screw.angular, linear: screw.linear })
                .collect(),
            positions: self.positions.iter().zip(&self.line).map(|(at, posture)| self.position(at, posture)).collect(),
            polynomials: self.series.as_ref().map(|series| self.polynomials(series)),
            rates: self.rates.as_ref().map(|rates| self.axis_rates(rates)),
            nc_deviation: self.blocks.map(|of| NcDeviation { straight_mm: of.straight, rounding_mm: of.rounding }),
            text: self.text(),
            job: self.job,
            machine: self.machine,
            files: self.written,
            not_done,
        }
    }

    fn extent(&self, k: usize, axis: &Named) -> AxisExtent {
        let (low, high) = self.ends(k);
        let [low, high] = [low, high].map(|x| finite(units::shown(axis.dimension, x)));
        let travel = axis.travel.map(|travel| Travel::new(axis.dimension, travel));
        AxisExtent { name: axis.name.clone(), unit: UnitSymbol::of(axis.dimension), low, high, travel }
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

/// Why there is no bound.
fn unbounded(motion: &Named, at: &str) -> String {
    format!("the axes stand in or near a singular pose, or are not smooth, at {} = {at}", motion.name)
}

/// A small amount with its unit.
fn small(dimension: Dimension, amount: f64) -> String {
    format!("{} {}", units::scientific(units::shown(dimension, amount), 3), units::symbol(dimension))
}

/// The same, rounded up.
fn at_most(dimension: Dimension, bound: f64) -> String {
    const HALF_OF_THE_LAST_DIGIT: f64 = 0.0005;
    small(dimension, bound * (1.0 + HALF_OF_THE_LAST_DIGIT))
}

fn unseen(screw: &Screw) -> String {
    let shown = |v: [f64; 3]| format!("[{}]", v.map(|x| fixed(x, 6)).join(", "));
    if screw.angular == [0.0; 3] {
        return format!("a shift along {}", shown(screw.linear));
    }
    let turn = format!("a turn about {}", shown(screw.angular));
    if screw.linear == [0.0; 3] {
        turn
    } else {
        format!("{turn} with the velocity {} mm/rad of its origin", shown(screw.linear))
    }
}
