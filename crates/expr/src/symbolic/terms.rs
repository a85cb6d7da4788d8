//! Short sums of products in one normal form, for what construction by rules misses: a factor that all components of
//! a vector share, sin² + cos² spread over several terms. Only sums of a few terms are ever written out.

use std::cell::LazyCell;
use std::cmp::Ordering;
use std::rc::Rc;

use crate::symbolic::graph::{Expr, Graph, Node, NodeId};
use crate::symbolic::op::{Binary, Unary};

/// Terms of the longest sum that is written out.
const MOST_TERMS: usize = 24;
/// Products and sums inside each other that are looked through.
const DEEPEST: usize = 24;

/// Coefficients that differ, or are what is left of larger ones, by less than this share are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Powers of the factors of one term, none of them zero, in the order of the nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Monomial(Rc<[(NodeId, u32)]>);

/// A number with the size of what it was summed from.
#[derive(Clone, Copy)]
struct Coefficient {
    value: f64,
    size: f64,
}

/// Each monomial once, in their order.
type Terms = Vec<(Monomial, Coefficient)>;

/// The terms of an expression, which many others are made of.
#[derive(Clone)]
pub(crate) struct Written {
    terms: Rc<Terms>,
    /// Products and sums inside each other in it.
    depth: usize,
}

/// What became of an expression: its terms, or that they were too many, or too deep for so many levels.
pub(crate) type Tried = Result<Written, usize>;

/// How far products are written out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Products {
    /// A sum that is a factor stays one.
    Kept,
    /// Sums are multiplied with each other.
    WrittenOut,
}

/// Σ coefficient · Π factorᵖᵒʷᵉʳ.
pub(crate) struct Sum<'g> {
    graph: &'g Graph,
    terms: Terms,
}

impl<'g> Sum<'g> {
    /// The terms of an expression; `None` if they are too many.
    pub(crate) fn of(expr: Expr<'g>, products: Products) -> Option<Sum<'g>> {
        Sum { graph: expr.graph, terms: Sum::terms(expr, products, DEEPEST)?.terms.to_vec() }.settled()
    }

    /// Σ xᵢ².
    pub(crate) fn of_squares(parts: &[Expr<'g>], products: Products) -> Option<Sum<'g>> {
        let graph = parts.first()?.graph;
        let mut sum = Sum { graph, terms: Terms::new() };
        for &part in parts {
            let root = Sum::of(part, products)?;
            sum.terms = added(&sum.terms, 1.0, &multiplied(&root.terms, &root.terms)?);
        }
        sum.settled()
    }

    /// The terms of an expression in which at most so many products and sums are inside each other, worked out once.
    fn terms(expr: Expr<'g>, products: Products, deepest: usize) -> Option<Written> {
        match expr.graph.known_terms(expr.id, products) {
            Some(Ok(written)) => return (written.depth <= deepest).then_some(written),
            Some(Err(tried)) if deepest <= tried => return None,
            _ => {}
        }
        let found = Sum::written_out(expr, products, deepest);
        expr.graph.remember_terms(expr.id, products, found.clone().ok_or(deepest));
        found
    }

    fn written_out(expr: Expr<'g>, products: Products, deepest: usize) -> Option<Written> {
        let graph = expr.graph;
        let below = |id: NodeId| Sum::terms(graph.expr(id), products, deepest.checked_sub(1)?);
        let whole = |id: NodeId| vec![(Monomial(Rc::new([(id, 1)])), Coefficient::from(1.0))];
        let (terms, depth) = match expr.node() {
            Node::Constant(bits) => (vec![(Monomial::default(), Coefficient::from(f64::from_bits(bits)))], 0),
            Node::Unary(Unary::Neg, a) => {
                let a = below(a)?;
                (added(&[], -1.0, &a.terms), 1 + a.depth)
            }
            Node::Binary(op @ (Binary::Add | Binary::Sub), a, b) => {
                let (a, b) = (below(a)?, below(b)?);
                let sum = added(&a.terms, if op == Binary::Add { 1.0 } else { -1.0 }, &b.terms);
                ((sum.len() <= MOST_TERMS).then_some(sum)?, 1 + a.depth.max(b.depth))
            }
            Node::Binary(Binary::Mul, a, b) => {
                let factors = (below(a)?, below(b)?);
                let factor = |id: NodeId, written: &Written| {
                    let stays = products == Products::Kept && written.terms.len() > 1;
                    // the same factor with either sign: −a − b is a + b, negative
                    match stays.then(|| written.terms.iter().all(|(_, coefficient)| coefficient.value < 0.0)) {
                        Some(true) => {
                            let positive = Sum { graph, terms: added(&[], -1.0, &written.terms) }.expression();
                            Rc::new(added(&[], -1.0, &whole(positive.id)))
                        }
                        Some(false) => Rc::new(whole(id)),
                        None => Rc::clone(&written.terms),
                    }
                };
                let product = multiplied(&factor(a, &factors.0), &factor(b, &factors.1))?;
                (product, 1 + factors.0.depth.max(factors.1.depth))
            }
            _ => (whole(expr.id), 0),
        };
        Some(Written { terms: Rc::new(terms), depth })
    }

    /// With sin² + cos² = 1 wherever it applies, and without terms that vanish.
    fn settled(mut self) -> Option<Sum<'g>> {
        self.terms.retain(|(_, coefficient)| !coefficient.is_rounding());
        while let Some(([sine, cosine], rest)) = self.squares_of_one_angle() {
            let (_, coefficient) = self.terms[sine];
            let mut k = 0..;
            self.terms.retain(|_| k.next().is_some_and(|k| k != sine && k != cosine));
            add(&mut self.terms, &rest.0, coefficient);
            self.terms.retain(|(_, coefficient)| !coefficient.is_rounding());
        }
        self.terms.iter().all(|(_, coefficient)| coefficient.value.is_finite()).then_some(self)
    }

    /// The places of two terms c·x·sin²a and c·x·cos²a, and x.
    fn squares_of_one_angle(&self) -> Option<([usize; 2], Monomial)> {
        let mut partner = Vec::new();
        for (sine, (monomial, coefficient)) in self.terms.iter().enumerate() {
            for &(factor, power) in monomial.0.iter().filter(|(_, power)| *power >= 2) {
                let Node::Unary(Unary::Sin, angle) = self.graph.node(factor) else { continue };
                let cosine = self.graph.expr(angle).cos().id;
                partner.clear();
                partner.extend_from_slice(&monomial.0);
                set(&mut partner, factor, power - 2);
                set(&mut partner, cosine, monomial.power(cosine) + 2);
                let Ok(cosine) = place(&self.terms, &partner) else { continue };
                if coefficient.plus(self.terms[cosine].1.times(-1.0)).is_rounding() {
                    return Some(([sine, cosine], monomial.with(factor, power - 2)));
                }
            }
        }
        None
    }

    /// Number of terms.
    pub(crate) fn len(&self) -> usize {
        self.terms.len()
    }

    /// Whether the sum is the number one.
    pub(crate) fn is_one(&self) -> bool {
        matches!(&self.terms[..], [(monomial, c)] if monomial.0.is_empty() && c.plus((-1.0).into()).is_rounding())
    }

    /// What all terms of all sums have as a factor.
    pub(crate) fn common_factor(sums: &[Sum<'g>]) -> Monomial {
        let mut monomials = sums.iter().flat_map(|sum| &sum.terms).map(|(monomial, _)| monomial);
        let mut common = monomials.next().map_or_else(Vec::new, |first| first.0.to_vec());
        for monomial in monomials {
            common.iter_mut().for_each(|(factor, power)| *power = monomial.power(*factor).min(*power));
            common.retain(|(_, power)| *power > 0);
        }
        Monomial(common.into())
    }

    /// (a, b) turned by an angle: u = a·cos g − b·sin g and v = a·sin g + b·cos g. The angle, a and b, if u and v, as sums of these
    /// products, are that.
    pub(crate) fn turned(u: Expr<'g>, v: Expr<'g>, products: Products) -> Option<(Expr<'g>, [Sum<'g>; 2])> {
        let graph = u.graph;
        let u = Sum::of(u, products)?;
        // seldom needed
        let v = LazyCell::new(|| Sum::of(v, products));
        let (first, _) = u.terms.first()?;
        first.0.iter().find_map(|&(factor, _)| {
            let (Node::Unary(Unary::Sin, angle) | Node::Unary(Unary::Cos, angle)) = graph.node(factor) else {
                return None;
            };
            let angle = graph.expr(angle);
            let (a, minus_b) = u.waves(angle)?;
            let (b, also_a) = v.as_ref()?.waves(angle)?;
            let same =
                differ_by_rounding(&a.terms, 1.0, &also_a.terms) && differ_by_rounding(&b.terms, -1.0, &minus_b.terms);
            same.then_some((angle, [a, b]))
        })
    }

    /// (a, b) of a·cos g + b·sin g, if each term is a multiple of one of the two.
    fn waves(&self, angle: Expr<'g>) -> Option<(Sum<'g>, Sum<'g>)> {
        let (cosine, sine) = (angle.cos().id, angle.sin().id);
        let empty = || Sum { graph: self.graph, terms: Terms::new() };
        let (mut a, mut b) = (empty(), empty());
        for (monomial, coefficient) in &self.terms {
            let (part, wave) = match (monomial.power(cosine), monomial.power(sine)) {
                (1, 0) => (&mut a, cosine),
                (0, 1) => (&mut b, sine),
                _ => return None,
            };
            add(&mut part.terms, &monomial.with(wave, 0).0, *coefficient);
        }
        Some((a, b))
    }

    /// Divided by something that every term has as a factor.
    pub(crate) fn without(mut self, factor: &Monomial) -> Sum<'g> {
        for (monomial, _) in &mut self.terms {
            factor.0.iter().for_each(|&(node, power)| *monomial = monomial.with(node, monomial.power(node) - power));
        }
        self.terms.sort_unstable_by(|(a, _), (b, _)| a.cmp(b));
        self
    }

    /// The expression.
    pub(crate) fn expression(&self) -> Expr<'g> {
        let graph = self.graph;
        self.terms.iter().fold(graph.constant(0.0), |sum, (monomial, coefficient)| {
            sum + coefficient.value * product(graph, monomial)
        })
    }
}

/// Π factorᵖᵒʷᵉʳ.
pub(crate) fn product<'g>(graph: &'g Graph, monomial: &Monomial) -> Expr<'g> {
    monomial.0.iter().fold(graph.constant(1.0), |product, &(factor, power)| {
        product * graph.expr(factor).powi(i32::try_from(power).expect("a few factors"))
    })
}

impl Monomial {
    fn power(&self, factor: NodeId) -> u32 {
        self.0.iter().find(|(own, _)| *own == factor).map_or(0, |(_, power)| *power)
    }

    /// The same with another power of one factor.
    fn with(&self, factor: NodeId, power: u32) -> Monomial {
        let mut factors = self.0.to_vec();
        set(&mut factors, factor, power);
        Monomial(factors.into())
    }

    /// Puts the product with another one into `product`.
    fn times(&self, other: &Monomial, product: &mut Vec<(NodeId, u32)>) {
        let (mut a, mut b) = (&self.0[..], &other.0[..]);
        product.clear();
        while let ([(left, power), a_rest @ ..], [(right, other), b_rest @ ..]) = (a, b) {
            (a, b) = match left.cmp(right) {
                Ordering::Less => (a_rest, b),
                Ordering::Greater => (a, b_rest),
                Ordering::Equal => (a_rest, b_rest),
            };
            product.push(match left.cmp(right) {
                Ordering::Less => (*left, *power),
                Ordering::Greater => (*right, *other),
                Ordering::Equal => (*left, power + other),
            });
        }
        product.extend_from_slice(a);
        product.extend_from_slice(b);
    }
}

/// Gives one factor among others, which are in the order of the nodes, its power.
fn set(factors: &mut Vec<(NodeId, u32)>, factor: NodeId, power: u32) {
    match factors.binary_search_by_key(&factor, |(own, _)| *own) {
        Ok(at) if power == 0 => {
            factors.remove(at);
        }
        Ok(at) => factors[at].1 = power,
        Err(_) if power == 0 => {}
        Err(at) => factors.insert(at, (factor, power)),
    }
}

fn multiplied(a: &Terms, b: &Terms) -> Option<Terms> {
    if a.len() * b.len() > MOST_TERMS {
        return None;
    }
    let mut out = Terms::with_capacity(a.len() * b.len());
    let mut product = Vec::new();
    for (left, c) in a {
        for (right, d) in b {
            left.times(right, &mut product);
            add(&mut out, &product, Coefficient { value: c.value * d.value, size: c.size * d.size });
        }
    }
    Some(out)
}

/// a + factor · b.
fn added(a: &[(Monomial, Coefficient)], factor: f64, b: &[(Monomial, Coefficient)]) -> Terms {
    let (mut a, mut b) = (a, b);
    let mut sum = Terms::with_capacity(a.len() + b.len());
    while let ([(left, c), a_rest @ ..], [(right, d), b_rest @ ..]) = (a, b) {
        let order = left.cmp(right);
        sum.push(match order {
            Ordering::Less => (left.clone(), *c),
            Ordering::Greater => (right.clone(), d.times(factor)),
            Ordering::Equal => (left.clone(), c.plus(d.times(factor))),
        });
        (a, b) = match order {
            Ordering::Less => (a_rest, b),
            Ordering::Greater => (a, b_rest),
            Ordering::Equal => (a_rest, b_rest),
        };
    }
    sum.extend_from_slice(a);
    sum.extend(b.iter().map(|(monomial, d)| (monomial.clone(), d.times(factor))));
    sum
}

/// Where a monomial is, or belongs.
fn place(terms: &Terms, monomial: &[(NodeId, u32)]) -> Result<usize, usize> {
    terms.binary_search_by(|(own, _)| own.0[..].cmp(monomial))
}

fn add(terms: &mut Terms, monomial: &[(NodeId, u32)], coefficient: Coefficient) {
    match place(terms, monomial) {
        Ok(at) => terms[at].1 = terms[at].1.plus(coefficient),
        Err(at) => terms.insert(at, (Monomial(monomial.into()), coefficient)),
    }
}

/// Whether a = factor · b, term by term.
fn differ_by_rounding(a: &Terms, factor: f64, b: &Terms) -> bool {
    a.len() == b.len()
        && a.iter().zip(b).all(|((monomial, coefficient), (same, other))| {
            monomial == same && coefficient.plus(other.times(-factor)).is_rounding()
        })
}

impl From<f64> for Coefficient {
    fn from(value: f64) -> Coefficient {
        Coefficient { value, size: value.abs() }
    }
}

impl Coefficient {
    fn plus(self, other: Coefficient) -> Coefficient {
        Coefficient { value: self.value + other.value, size: self.size + other.size }
    }

    fn times(self, factor: f64) -> Coefficient {
        Coefficient { value: self.value * factor, size: self.size * factor.abs() }
    }

    fn is_rounding(self) -> bool {
        self.value.abs() <= ROUNDING * self.size
    }
}
