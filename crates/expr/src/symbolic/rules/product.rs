//! Rules of products, quotients and powers.

use crate::symbolic::graph::{Expr, Node};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::rules::{commutative, constant_left};

pub(super) fn mul<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    if b.as_constant().is_some() {
        return mul(b, a);
    }
    if let Some(c) = a.as_constant() {
        // 0·x = 0, 1·x = x, (−1)·x = −x
        if c == 0.0 {
            return a;
        } else if c == 1.0 {
            return b;
        } else if c < 0.0 {
            return -(-a * b);
        }
        // c·(d·x) = (c·d)·x, unless c·d overflows or underflows, where x could bring it back
        if let Some((d, x)) = constant_left(Binary::Mul, b)
            && (a * d).as_constant().is_some_and(f64::is_normal)
        {
            return (a * d) * x;
        }
    }
    // (−x)·y = −(x·y)
    if let Node::Unary(Unary::Neg, x) = a.node() {
        return -(a.graph.expr(x) * b);
    }
    if let Node::Unary(Unary::Neg, y) = b.node() {
        return -(a * a.graph.expr(y));
    }
    // √x·√x = x
    if a == b
        && let Node::Unary(Unary::Sqrt, x) = a.node()
    {
        return a.graph.expr(x);
    }
    match (constant_left(Binary::Mul, a), constant_left(Binary::Mul, b)) {
        // (c·x)·(d·y) = (c·d)·(x·y), unless c·d overflows or underflows
        (Some((c, x)), Some((d, y))) if (c * d).as_constant().is_some_and(f64::is_normal) => return (c * d) * (x * y),
        // x·(c·x) = c·(x·x)
        (_, Some((c, x))) if x == a => return c * (a * a),
        (Some((c, x)), _) if x == b => return c * (b * b),
        _ => {}
    }
    commutative(Binary::Mul, a, b)
}

pub(super) fn div<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    // 0/x = 0
    if a.is_zero() {
        return a;
    }
    // x/x = 1
    if a == b {
        return a.graph.constant(1.0);
    }
    // x/1 = x, x/(−1) = −x; other constants stay: a quotient is more exact than a product with a rounded reciprocal
    match b.as_constant() {
        Some(1.0) => return a,
        Some(-1.0) => return -a,
        _ => {}
    }
    // (−x)/y = −(x/y) = x/(−y)
    if let Node::Unary(Unary::Neg, x) = a.node() {
        return -(a.graph.expr(x) / b);
    }
    if let Node::Unary(Unary::Neg, y) = b.node() {
        return -(a / a.graph.expr(y));
    }
    // (c·x)/(d·y) = (c/d)·x/y, unless c/d overflows or underflows
    if let (Some((c, x)), Some((d, y))) = (constant_left(Binary::Mul, a), constant_left(Binary::Mul, b))
        && let Some(ratio) = (c / d).as_constant()
        && ratio.is_normal()
    {
        return div(ratio * x, y);
    }
    a.graph.intern(Node::Binary(Binary::Div, a.id, b.id))
}

pub(super) fn pow<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    match b.as_constant() {
        // small whole powers are products, half is a square root
        Some(e) if e.fract() == 0.0 && e.abs() <= 64.0 => a.powi(e as i32),
        Some(0.5) => a.sqrt(),
        _ => a.graph.intern(Node::Binary(Binary::Pow, a.id, b.id)),
    }
}
