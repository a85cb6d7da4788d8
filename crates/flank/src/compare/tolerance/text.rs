//! Tolerances, for people.

use std::fmt;

use flank_export::fixed;

use super::result::{ScatteringCause, ToleranceResult, ToleratedResult};
use crate::project::columns::aligned;
use crate::project::units;

/// Shares below this are not worth a line, unless they are the largest.
const SMALL: f64 = 0.005;
/// Smaller numbers are rounding: in um a thousandth of what points are solved to.
const NOTHING: f64 = 1e-9;

impl fmt::Display for ToleranceResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ToleranceResult { job, surface, frame, counts: [rows, columns], known, .. } = self;
        let points = units::counted(rows * columns, "point");
        writeln!(f, "tolerances of {job}.{surface} ({frame}): {known} of {points}, um along the normal\n")?;
        writeln!(f, "what scatters, by one standard deviation\n")?;
        writeln!(f, "{}\n", causes(&self.causes).trim_end())?;
        writeln!(f, "what scatters by it; in the worst case each is off by {} of these\n", self.limits)?;
        writeln!(f, "{}", results(&self.results).trim_end())?;
        writeln!(f, "\nshares of the variance, the largest first\n")?;
        writeln!(f, "{}", self.shares().trim_end())?;
        let Some(sweep) = self.sweep else { return Ok(()) };
        let beyond = match sweep.beyond {
            0 => String::new(),
            beyond => format!("; in {beyond} a setting lies beyond its range, where the spec refuses it"),
        };
        writeln!(f, "\n{} of {} random cases solved{beyond}\n", sweep.solved, sweep.drawn)?;
        writeln!(f, "{}", swept(&self.results).trim_end())
    }
}

/// A number that may be large or small, to four digits.
fn number(value: f64) -> String {
    match value.abs() {
        size if size < NOTHING => "0".to_string(),
        size if (1e-3..1e5).contains(&size) => {
            let decimals = (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
            fixed(value, decimals)
        }
        _ => format!("{value:.3e}"),
    }
}

fn causes(of: &[ScatteringCause]) -> String {
    let has_budget = of.iter().any(|of| of.may_scatter.is_some());
    let head = ["", "now", "scatter", if has_budget { "may scatter" } else { "" }, ""].map(String::from);
    let row = |of: &ScatteringCause| {
        let may = match of.may_scatter {
            Some(may) => number(may),
            None if has_budget => "-".to_string(),
            None => String::new(),
        };
        [of.name.clone(), fixed(of.now, 6), number(of.scatter), may, of.unit.clone()]
    };
    let rows: Vec<[String; 5]> = [head].into_iter().chain(of.iter().map(row)).collect();
    aligned(&rows, "<>>><")
}

fn results(of: &[ToleratedResult]) -> String {
    let has_wish = of.iter().any(|of| of.wanted.is_some());
    let head = ["", "standard deviation", "worst case", if has_wish { "wanted" } else { "" }, ""].map(String::from);
    let row = |of: &ToleratedResult| {
        let wanted = match of.wanted {
            Some(wanted) => number(wanted),
            None if has_wish => "-".to_string(),
            None => String::new(),
        };
        [of.name.clone(), number(of.standard_deviation), number(of.worst_case), wanted, of.unit.clone()]
    };
    let rows: Vec<[String; 5]> = [head].into_iter().chain(of.iter().map(row)).collect();
    aligned(&rows, "<>>><")
}

fn swept(of: &[ToleratedResult]) -> String {
    let head = ["", "mean", "standard deviation", "lowest", "highest", ""].map(String::from);
    let row = |of: &ToleratedResult| {
        let [mean, by, low, high] = match of.swept {
            Some(swept) => [swept.mean, swept.standard_deviation, swept.lowest, swept.highest].map(number),
            None => ["-"; 4].map(String::from),
        };
        [of.name.clone(), mean, by, low, high, of.unit.clone()]
    };
    let rows: Vec<[String; 6]> = [head].into_iter().chain(of.iter().map(row)).collect();
    aligned(&rows, "<>>>><")
}

impl ToleranceResult {
    fn shares(&self) -> String {
        let row = |of: &ToleratedResult| {
            let mut order: Vec<usize> = (0..of.shares.len()).collect();
            order.sort_by(|a, b| of.shares[*b].total_cmp(&of.shares[*a]));
            let told = order.iter().enumerate().filter(|(k, at)| *k == 0 || of.shares[**at].abs() >= SMALL);
            let part = |at: usize| format!("{} {} %", self.causes[at].name, fixed(100.0 * of.shares[at], 1));
            let parts: Vec<String> = told.map(|(_, at)| part(*at)).collect();
            [of.name.clone(), if of.standard_deviation > 0.0 { parts.join(", ") } else { "-".to_string() }]
        };
        aligned(&self.results.iter().map(row).collect::<Vec<[String; 2]>>(), "<<")
    }
}
