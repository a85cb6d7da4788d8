//! Rules of sums and differences.

use crate::symbolic::graph::{Expr, Node};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::rules::{commutative, constant_left, negated};
use crate::symbolic::terms::{Products, Sum};

pub(super) fn add<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    // x + 0 = x
    if a.is_zero() {
        return b;
    }
    if b.is_zero() {
        return a;
    }
    // x + x = 2x
    if a == b {
        return 2.0 * a;
    }
    // x + (−y) = x − y
    if let Some(y) = negated(b) {
        return a - y;
    }
    if let Some(x) = negated(a) {
        return b - x;
    }
    // c + (d + x) = (c + d) + x, unless c + d overflows
    if a.as_constant().is_some()
        && let Some((d, x)) = constant_left(Binary::Add, b)
        && (a + d).as_constant().is_some_and(f64::is_finite)
    {
        return (a + d) + x;
    }
    if b.as_constant().is_some() && a.as_constant().is_none() {
        return add(b, a);
    }
    if let Some(sum) = cancelled(a, b)
        .or_else(|| cancelled(b, a))
        .or_else(|| pythagoras(a, b))
        .or_else(|| turned_squares(a, b))
        .or_else(|| multiples(Binary::Add, a, b))
        .or_else(|| common_factor(Binary::Add, a, b))
    {
        return sum;
    }
    commutative(Binary::Add, a, b)
}

pub(super) fn sub<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    // x − 0 = x
    if b.is_zero() {
        return a;
    }
    // 0 − x = −x
    if a.is_zero() {
        return -b;
    }
    // x − x = 0
    if a == b {
        return a.graph.constant(0.0);
    }
    // x − (−y) = x + y
    if let Some(y) = negated(b) {
        return a + y;
    }
    // (x + y) − y = x, x − (x + y) = −y
    if let Some(x) = without_term(a, b) {
        return x;
    }
    if let Some(y) = without_term(b, a) {
        return -y;
    }
    match (a.node(), b.node()) {
        // (x − y) − x = −y
        (Node::Binary(Binary::Sub, x, y), _) if x == b.id => return -a.graph.expr(y),
        // x − (x − y) = y
        (_, Node::Binary(Binary::Sub, x, y)) if x == a.id => return a.graph.expr(y),
        _ => {}
    }
    // (−x) − y = −(x + y)
    if let Node::Unary(Unary::Neg, x) = a.node() {
        return -(a.graph.expr(x) + b);
    }
    // x − c = (−c) + x
    if b.as_constant().is_some() {
        return -b + a;
    }
    multiples(Binary::Sub, a, b)
        .or_else(|| common_factor(Binary::Sub, a, b))
        .unwrap_or_else(|| a.graph.intern(Node::Binary(Binary::Sub, a.id, b.id)))
}

/// (x − y) + y = x, (x − y) + (y − x) = 0, (c − y) + (d + y) = c + d
fn cancelled<'g>(a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    let Node::Binary(Binary::Sub, x, y) = a.node() else {
        return None;
    };
    let (x, y) = (a.graph.expr(x), a.graph.expr(y));
    if y == b {
        return Some(x);
    }
    match b.node() {
        Node::Binary(Binary::Sub, p, q) if (p, q) == (y.id, x.id) => Some(a.graph.constant(0.0)),
        Node::Binary(Binary::Add, d, q) if q == y.id => {
            let (c, d) = (x.as_constant()?, a.graph.expr(d).as_constant()?);
            Some(a.graph.constant(c + d))
        }
        _ => None,
    }
}

/// The other term of a sum of two.
fn without_term<'g>(sum: Expr<'g>, term: Expr<'g>) -> Option<Expr<'g>> {
    match sum.node() {
        Node::Binary(Binary::Add, x, y) if y == term.id => Some(sum.graph.expr(x)),
        Node::Binary(Binary::Add, x, y) if x == term.id => Some(sum.graph.expr(y)),
        _ => None,
    }
}

/// sin²x + cos²x = 1
fn pythagoras<'g>(a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    match (squared(a)?.node(), squared(b)?.node()) {
        (Node::Unary(Unary::Sin, x), Node::Unary(Unary::Cos, y))
        | (Node::Unary(Unary::Cos, x), Node::Unary(Unary::Sin, y))
            if x == y =>
        {
            Some(a.graph.constant(1.0))
        }
        _ => None,
    }
}

/// (x·cos a − y·sin a)² + (x·sin a + y·cos a)² = x² + y²: a distance is the same before and after a rotation.
fn turned_squares<'g>(a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    let roots = [squared(a)?, squared(b)?];
    let is_sum = |x: &Expr<'g>| matches!(x.node(), Node::Binary(Binary::Add | Binary::Sub, ..));
    if !roots.iter().all(is_sum) {
        return None;
    }
    // the distance of one point from an axis is asked for again and again
    let squares = (a.id, b.id);
    let sum = a.graph.known_square_sum(squares).unwrap_or_else(|| {
        let sum = Sum::of_squares(&roots, Products::Kept).filter(|sum| sum.len() <= roots.len());
        let sum = sum.map(|sum| sum.expression().id);
        a.graph.remember_square_sum(squares, sum);
        sum
    });
    sum.map(|id| a.graph.expr(id))
}

/// x of x².
fn squared<'g>(a: Expr<'g>) -> Option<Expr<'g>> {
    match a.node() {
        Node::Binary(Binary::Mul, x, y) if x == y => Some(a.graph.expr(x)),
        _ => None,
    }
}

/// c·x ± d·x = (c ± d)·x, with c or d perhaps one.
fn multiples<'g>(op: Binary, a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    let (left, right) = (constant_left(Binary::Mul, a), constant_left(Binary::Mul, b));
    let (x, y) = (left.map_or(a, |(_, x)| x), right.map_or(b, |(_, y)| y));
    let factor = |of: Option<(Expr<'g>, Expr<'g>)>| of.map_or_else(|| a.graph.constant(1.0), |(c, _)| c);
    (x == y).then(|| factor(left).binary(op, factor(right)) * x)
}

/// x·y ± x·z = x·(y ± z): one multiplication less.
///
/// Not if y and z have a common factor again: two long products that differ at the far end would be rebuilt link by link.
fn common_factor<'g>(op: Binary, a: Expr<'g>, b: Expr<'g>) -> Option<Expr<'g>> {
    let (factor, left, right) = split_factor(a, b)?;
    let only_a_number = factor.as_constant().is_some() && constant_left(Binary::Mul, left).is_none();
    if split_factor(left, right).is_some() && !only_a_number {
        return None;
    }
    Some(factor * left.binary(op, right))
}

/// (x, y, z) of x·y and x·z.
fn split_factor<'g>(a: Expr<'g>, b: Expr<'g>) -> Option<(Expr<'g>, Expr<'g>, Expr<'g>)> {
    let (Node::Binary(Binary::Mul, p, q), Node::Binary(Binary::Mul, r, s)) = (a.node(), b.node()) else {
        return None;
    };
    [(p, q, r, s), (p, q, s, r), (q, p, r, s), (q, p, s, r)]
        .into_iter()
        .find(|(x, _, also_x, _)| x == also_x)
        .map(|(x, y, _, z)| (a.graph.expr(x), a.graph.expr(y), a.graph.expr(z)))
}
