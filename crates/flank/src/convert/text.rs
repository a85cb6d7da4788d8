//! What `flank convert` found of a motion, as people read it.

use std::fmt::{self, Formatter};

use flank_export::fixed;

use super::result::{AxisExtent, AxisMotion, AxisPolynomials, AxisRates, NcDeviation, RestingAxis, ToolSymmetry};
use crate::project::columns::aligned;
use crate::project::quantity::{NamedUnit, Travel, UnitSymbol};
use crate::project::units;

/// Powers of the unit of time.
const SECONDS: [&str; 3] = ["s", "s^2", "s^3"];

impl fmt::Display for AxisMotion {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.of)?;
        writeln!(f, "{} positions over {}", self.positions.len(), self.over())?;
        if let Some(at) = &self.made_at {
            let each = self.motions.iter().zip(at);
            let each: Vec<String> =
                each.map(|(motion, x)| format!("{} = {}", motion.name, with_unit(*x, 4, motion.unit))).collect();
            writeln!(f, "that is all of it: the sampled points are all made at {}", each.join(", "))?;
        }
        self.tool_symmetries.iter().try_for_each(|motion| writeln!(f, "the tool is unchanged by {motion}"))?;
        let rows: Vec<[String; 4]> = self.axes.iter().filter_map(AxisExtent::cells).collect();
        if !rows.is_empty() {
            let head = ["axis", "from", "to", "travel"].map(String::from);
            write!(f, "\n{}", aligned(&[vec![head], rows].concat(), "<>>>"))?;
        }
        if let Some(RestingAxis { name, unit, at }) = &self.resting {
            writeln!(f, "{name} stands still at {}: it only moves the tool along itself", with_unit(*at, 4, *unit))?;
        }
        if let Some(polynomials) = &self.polynomials {
            self.write_polynomials(polynomials, f)?;
        }
        if let Some(rates) = &self.rates {
            self.write_rates(rates, f)?;
        }
        if let Some(deviation) = self.nc_deviation {
            writeln!(f, "\nNC programs: {deviation}")?;
        }
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl AxisMotion {
    /// What the motions run over: `roll from … to …`.
    pub(super) fn over(&self) -> String {
        let span = |(k, motion): (usize, &NamedUnit)| {
            let values = self.positions.iter().filter_map(|position| position.motions[k]);
            let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            let [low, high] = [ends.0, ends.1].map(|x| with_unit(x, 6, motion.unit));
            format!("{} from {low} to {high}", motion.name)
        };
        self.motions.iter().enumerate().map(span).collect::<Vec<_>>().join(" and ")
    }

    fn write_polynomials(&self, polynomials: &AxisPolynomials, f: &mut Formatter<'_>) -> fmt::Result {
        let motion = &self.motions[0];
        let about = polynomials.reference;
        let shown_about = if motion.unit == UnitSymbol::Degree { about.to_degrees() } else { about };
        let sign = if about < 0.0 { '+' } else { '-' };
        let order = polynomials.order;
        let shown = with_unit(shown_about.abs(), 6, motion.unit);
        writeln!(f, "\npolynomials in h = {} {sign} {shown}, mm and rad; order {order}", motion.name)?;
        let power = |k: usize| if k == 0 { "1".to_string() } else { format!("h^{k}") };
        let inside = |x: f64| if motion.unit == UnitSymbol::Degree { x.to_radians() } else { x };
        let passed = self.positions.iter().filter_map(|position| position.motions[0]);
        let reach = passed.map(|at| (inside(at) - about).abs()).fold(0.0, f64::max);
        let mut rows = vec![["axis", "coefficient"].map(String::from)];
        for axis in &self.axes {
            let Some(coefficients) = polynomials.coefficients.get(&axis.name) else { continue };
            // what does not show in the last place anywhere on the way is rounding
            let size = coefficients.iter().enumerate().map(|(k, c)| c.abs() * reach.powi(k as i32)).fold(1.0, f64::max);
            let is_rounding = |k: usize, c: f64| c.abs() * reach.powi(k as i32) <= 4.0 * f64::EPSILON * size;
            for (k, c) in coefficients.iter().enumerate().filter(|(k, c)| *k == 0 || !is_rounding(*k, **c)) {
                let visible = if is_rounding(k, *c) { 0.0 } else { *c };
                rows.push([format!("{} {}", axis.name, power(k)), units::scientific(visible, 15)]);
            }
        }
        f.write_str(&aligned(&rows, "<>"))?;
        self.write_remainders(polynomials, f)?;
        match polynomials.deviation_mm_by_order.get(order) {
            Some(most) => writeln!(f, "\nthe flank is then off by up to {:.6} um", most * 1e3),
            None => Ok(()),
        }
    }

    /// What the polynomials leave of each axis: seen at the positions, proven over the whole way.
    fn write_remainders(&self, polynomials: &AxisPolynomials, f: &mut Formatter<'_>) -> fmt::Result {
        let remainders = &polynomials.remainders;
        let Some(proven) = &remainders.proven else {
            return writeln!(f, "\nwhat the polynomials leave is not bounded: {}", self.unbounded(polynomials));
        };
        let seen = format!("seen at {} positions", self.positions.len());
        let head = ["axis off by", &seen, "proven, nowhere more than"].map(String::from);
        let row = |axis: &AxisExtent| {
            let (seen, bound) = (remainders.seen.get(&axis.name)?, proven.get(&axis.name)?);
            Some([axis.name.clone(), small(axis.unit, *seen), at_most(axis.unit, *bound)])
        };
        let rows: Vec<[String; 3]> = [head].into_iter().chain(self.axes.iter().filter_map(row)).collect();
        write!(f, "\n{}", aligned(&rows, "<>>"))
    }

    /// The same in a sentence.
    pub(super) fn remainders_sentence(&self, polynomials: &AxisPolynomials) -> String {
        let Some(proven) = &polynomials.remainders.proven else {
            return format!("no error bound is proven: {}", self.unbounded(polynomials));
        };
        let each = self.axes.iter().filter_map(|axis| Some((axis, proven.get(&axis.name)?)));
        let each: Vec<String> =
            each.map(|(axis, bound)| format!("{} {}", axis.name, at_most(axis.unit, *bound))).collect();
        format!("proven, over {}: off by at most {}", self.over(), each.join(", "))
    }

    /// Why there is no bound.
    fn unbounded(&self, polynomials: &AxisPolynomials) -> String {
        let motion = &self.motions[0];
        let at = polynomials.remainders.not_proven_at.map_or(String::new(), |at| with_unit(at, 6, motion.unit));
        format!("the axes stand in or near a singular pose, or are not smooth, at {} = {at}", motion.name)
    }

    fn write_rates(&self, rates: &AxisRates, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "\n{} evenly in {} s; at most", self.motions[0].name, rates.seconds)?;
        let head = ["axis", "velocity", "acceleration", "jerk"].map(String::from);
        let row = |axis: &AxisExtent| {
            let each = rates.most.get(&axis.name)?;
            let unit = axis.unit.symbol();
            let [velocity, acceleration, jerk] =
                std::array::from_fn(|k| format!("{} {unit}/{}", fixed(each[k], 6), SECONDS[k]));
            Some([axis.name.clone(), velocity, acceleration, jerk])
        };
        let rows: Vec<[String; 4]> = [head].into_iter().chain(self.axes.iter().filter_map(row)).collect();
        f.write_str(&aligned(&rows, "<>>>"))
    }
}

impl AxisExtent {
    /// Its name, both ends and its travel; nothing where it has no position.
    fn cells(&self) -> Option<[String; 4]> {
        let [low, high] = [self.low?, self.high?].map(|x| with_unit(x, 6, self.unit));
        let as_given = |x: f64| format!("{} {}", if x == 0.0 { 0.0 } else { x }, self.unit.symbol());
        let travel = self.travel.map(|Travel { low, high }| format!("{} .. {}", as_given(low), as_given(high)));
        Some([self.name.clone(), low, high, travel.unwrap_or_default()])
    }
}

/// `a turn about [0, 0, 1]`.
impl fmt::Display for ToolSymmetry {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let shown = |v: [f64; 3]| format!("[{}]", v.map(|x| fixed(x, 6)).join(", "));
        if self.angular == [0.0; 3] {
            return write!(f, "a shift along {}", shown(self.linear));
        }
        write!(f, "a turn about {}", shown(self.angular))?;
        if self.linear == [0.0; 3] {
            Ok(())
        } else {
            write!(f, " with the velocity {} mm/rad of its origin", shown(self.linear))
        }
    }
}

/// A sentence, for the head of a program.
impl fmt::Display for NcDeviation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let um = |mm: f64| format!("{:.4} um", mm * 1e3);
        match (self.straight_mm, self.rounding_mm.map(um)) {
            (_, None) => f.write_str(
                "how far straight blocks and rounded positions leave the flank off is not known: no point of the flank is sampled \
                 and solved on a surface that a face of the tool makes",
            ),
            (Some(straight), Some(rounding)) => write!(
                f,
                "where points were sampled, straight blocks leave the flank off by up to {}, rounded positions by up to {rounding}",
                um(straight)
            ),
            (None, Some(rounding)) => write!(
                f,
                "where points were sampled, rounded positions by up to {rounding}; how far straight blocks leave the flank off is \
                 not known: there is no proof where the axes stand between positions"
            ),
        }
    }
}

/// A value with its unit.
fn with_unit(value: f64, decimals: usize, unit: UnitSymbol) -> String {
    format!("{} {}", fixed(value, decimals), unit.symbol()).trim_end().to_string()
}

/// A small amount of mm or rad with its unit.
fn small(unit: UnitSymbol, amount: f64) -> String {
    let shown = if unit == UnitSymbol::Degree { amount.to_degrees() } else { amount };
    format!("{} {}", units::scientific(shown, 3), unit.symbol())
}

/// The same, rounded up.
fn at_most(unit: UnitSymbol, bound: f64) -> String {
    const HALF_OF_THE_LAST_DIGIT: f64 = 0.0005;
    small(unit, bound * (1.0 + HALF_OF_THE_LAST_DIGIT))
}
