//! Products of two angles, which are mostly angles with a unit too many: `C * 1 deg`.
//!
//! They are numbers in formulas such as `a * b + cos(a)`. Where an angle is wanted they are an oversight, unless a division by `1 rad` says
//! that they are meant. Powers and products of an angle with itself are not looked at: polynomials in an angle have numbers for coefficients.

use std::collections::HashMap;

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::syntax::ast::{BinaryOperator, Expression, ExpressionKind};
use crate::values::context::Context;
use crate::values::dimension::{self, Dimension};
use crate::values::value::Value;

/// A scalar with its dimension: `a / 1 rad * 1 deg` is the same scalar as `a * 1 deg`, and an angle.
type Scalar<'g> = (Expr<'g>, Dimension);

/// The products so far, and what was made of them without a division by an angle.
#[derive(Default)]
pub(crate) struct AngleProducts<'g>(HashMap<Scalar<'g>, Written>);

/// Where a product of two angles is written.
#[derive(Clone, Debug)]
struct Written {
    product: Span,
    unit: Option<LoneUnit>,
}

/// A factor that is a number with the unit of an angle.
#[derive(Clone, Debug)]
struct LoneUnit {
    number: f64,
    unit: String,
    factor: Span,
    /// The factor with its sign.
    signed: Span,
}

impl<'g> Context<'g> {
    /// Follows products of two angles through an operation; a sum of one and an angle wants an angle.
    pub(super) fn follow_angles(
        &mut self,
        operator: BinaryOperator,
        [left, right]: [&Expression; 2],
        operands: [Option<Scalar<'g>>; 2],
        value: &Value<'g>,
    ) {
        use BinaryOperator as Op;
        let ([Some(a), Some(b)], Value::Scalar(expr, dimension)) = (operands, value) else { return };
        let is_product = operator == Op::Multiply && [a.1, b.1] == [Dimension::ANGLE; 2];
        let known = [a, b].into_iter().find_map(|operand| self.angle_products.0.get(&operand).cloned());
        match operator {
            _ if is_product && a.0 != b.0 && !expr.is_zero() => {
                let product = left.span.to(right.span);
                let unit = lone_unit(right, Span { start: left.span.end, ..right.span })
                    .or_else(|| lone_unit(left, Span { end: right.span.start, ..left.span }));
                self.angle_products.0.insert((*expr, *dimension), Written { product, unit });
            }
            Op::Add | Op::Subtract | Op::Multiply | Op::Divide => {
                let Some(written) = known else { return };
                if is_power_of_angle(*dimension) {
                    self.angle_products.0.insert((*expr, *dimension), written);
                } else if matches!(operator, Op::Add | Op::Subtract) && *dimension == Dimension::ANGLE {
                    self.report(written.warning());
                }
            }
            _ => {}
        }
    }

    /// Follows a product of two angles through a sign.
    pub(super) fn follow_negated_angle(&mut self, operand: Option<Scalar<'g>>, value: &Value<'g>) {
        if let Some(written) = operand.and_then(|operand| self.angle_products.0.get(&operand).cloned())
            && let Value::Scalar(expr, dimension) = value
        {
            self.angle_products.0.insert((*expr, *dimension), written);
        }
    }

    /// Warns where a scalar that is wanted as an angle is a product of two.
    pub(super) fn warn_of_angle_product(&mut self, scalar: Scalar<'g>) {
        if let Some(warning) = self.angle_products.0.get(&scalar).map(Written::warning) {
            self.report(warning);
        }
    }
}

/// Whether it is taken for an angle without being one.
fn is_power_of_angle(dimension: Dimension) -> bool {
    dimension != Dimension::ANGLE && Dimension::ANGLE.accepts(dimension)
}

/// A factor such as `1 deg`.
fn lone_unit(factor: &Expression, signed: Span) -> Option<LoneUnit> {
    let ExpressionKind::Number(number, units) = &factor.kind else { return None };
    let [(unit, 1)] = &units[..] else { return None };
    dimension::unit_size(&unit.node).filter(|(_, of)| *of == Dimension::ANGLE)?;
    Some(LoneUnit { number: *number, unit: unit.node.clone(), factor: factor.span, signed })
}

impl Written {
    fn warning(&self) -> Diagnostic {
        let message = "an angle times an angle stands where an angle is wanted";
        let warning = Diagnostic::new(Code::AngleProduct, self.product, message);
        let end = Span { start: self.product.end, ..self.product };
        let divided = |warning: Diagnostic| warning.cure("divide by `1 rad`", end, " / 1 rad");
        let Some(LoneUnit { number, unit, factor, signed }) = &self.unit else {
            return divided(warning.help("divide by `1 rad` if the product is meant"));
        };
        divided(if *number == 1.0 {
            let title = format!("leave `1 {unit}` out");
            let help =
                format!("{title}: the other factor is an angle already; or divide by `1 rad` if the product is meant");
            warning.help(help).cure(title, *signed, "")
        } else {
            let title = format!("write `{number}`");
            let help = format!(
                "{title} without its unit: the other factor is an angle already; or divide by `1 rad` if the product is meant"
            );
            warning.help(help).cure(title, *factor, number.to_string())
        })
    }
}
