//! Values that are no finite numbers: where they are so everywhere, and why.

use std::fmt;

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::values::context::Context;
use crate::values::steel_side::steps;
use crate::values::value::Constant;

impl<'g> Context<'g> {
    /// The number that an expression, which the model keeps, is instead of a finite one wherever its variables are in their ranges;
    /// nothing where it is not known to be so.
    pub(crate) fn nowhere(&self, expr: Expr<'g>) -> Option<f64> {
        let range = self.enclosed(expr, false).ok()?;
        if range.is_empty() {
            return Some(f64::NAN);
        }
        let divides = !range.continuous && self.zero_divisors(expr).next().is_some();
        (divides && !self.is_seen(expr)).then_some(f64::INFINITY)
    }

    /// Whether an expression is finite at one of some places in the ranges of its variables.
    fn is_seen(&self, expr: Expr<'g>) -> bool {
        const LOOKS: usize = 20;
        let Ok(ranges) = self.ranged(expr, false) else { return true };
        let steps = steps(ranges.len());
        let mut values = self.values().to_vec();
        (0..LOOKS).any(|look| {
            for ((variable, range), step) in ranges.iter().zip(&steps) {
                let share = (0.5 + look as f64 * step).fract();
                if let Some(variable) = variable.as_variable() {
                    values[variable.index()] = range.lo + (range.hi - range.lo) * share;
                }
            }
            self.graph.evaluate(&[expr], &values)[0].is_finite()
        })
    }

    /// Reports the value of an expression that is no number, or infinite.
    pub(crate) fn not_finite(&mut self, value: f64, of: Option<Expr<'g>>, span: Span, what: impl fmt::Display) {
        let (reason, help) = if value.is_nan() {
            ("cannot be computed", "look for a root or logarithm of a negative number, an `asin` of more than 1, 0 / 0")
        } else {
            ("is infinite", "look for a division by zero, or a value that grows too large")
        };
        let divisor = of.and_then(|expr| self.zero_divisor(expr));
        let help = divisor.map_or(help.to_string(), |divisor| format!("it is divided by `{divisor}`, which is zero"));
        self.report(Diagnostic::new(Code::NotANumber, span, format!("{what} {reason}")).help(help));
    }

    fn zero_divisors(&self, expr: Expr<'g>) -> impl Iterator<Item = Expr<'g>> {
        let is_zero =
            |divisor: &Expr<'g>| matches!(self.constant_kept(*divisor), Constant::Known(value) if value == 0.0);
        self.graph.divisors(expr).into_iter().filter(is_zero)
    }

    /// What an expression divides by that is zero, in the words of the text; nothing where that is not short.
    fn zero_divisor(&self, expr: Expr<'g>) -> Option<String> {
        const SHORT: usize = 12;
        let found = self.zero_divisors(expr).next()?;
        (found.as_constant().is_none() && self.graph.size(&[found]) <= SHORT).then(|| found.to_string())
    }
}
