//! Short sums of products in one normal form, for what construction by rules misses: a factor that all components of
//! a vector share, sin² + cos² spread over several terms. Only sums of a few terms are ever written out.

use std::cell::LazyCell;
use std::cmp::Ordering;

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
pub(crate) struct Monomial(Vec<(NodeId, u32)>);

/// A number with the size of what it was summed from.
#[derive(Clone, Copy)]
struct Coefficient {
    value: f64,
    size: f64,
}

/// Each monomial once, in their order.
type Terms = Vec<(Monomial, Coefficient)>;

/// How far products are written out.
#[derive(Clone, Copy, PartialEq, Eq)]
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
        Sum { graph: expr.graph, terms: Sum::terms(expr, products, DEEPEST)? }.settled()
    }

    /// Σ xᵢ².
    pub(crate) fn of_squares(parts: &[Expr<'g>], products: Products) -> Option<Sum<'g>> {
        let graph = parts.first()?.graph;
        let mut sum = Sum { graph, terms: Terms::new() };
        for &part in parts {
            let root = Sum::of(part, products)?;
            sum.terms = added(std::mem::take(&mut sum.terms), multiplied(&root.terms, &root.terms)?);
        }
        sum.settled()
    }

    fn terms(expr: Expr<'g>, products: Products, depth: usize) -> Option<Terms> {
        let graph = expr.graph;
        let below = |id: NodeId| Sum::terms(graph.expr(id), products, depth.checked_sub(1)?);
        let whole = |id: NodeId| vec![(Monomial(vec![(id, 1)]), Coefficient::from(1.0))];
        let negated = |mut terms: Terms| {
            terms.iter_mut().for_each(|(_, c)| *c = c.times(-1.0));
            terms
        };
        Some(match expr.node() {
            Node::Constant(bits) => vec![(Monomial::default(), Coefficient::from(f64::from_bits(bits)))],
            Node::Unary(Unary::Neg, a) => negated(below(a)?),
            Node::Binary(op @ (Binary::Add | Binary::Sub), a, b) => {
                let (a, b) = (below(a)?, below(b)?);
                let sum = added(a, if op == Binary::Add { b } else { negated(b) });
                (sum.len() <= MOST_TERMS).then_some(sum)?
            }
            Node::Binary(Binary::Mul, a, b) => {
                let factor = |id: NodeId| {
                    let terms = below(id)?;
                    let stays = products == Products::Kept && terms.len() > 1;
                    Some(if stays { whole(id) } else { terms })
                };
                multiplied(&factor(a)?, &factor(b)?)?
            }
            _ => whole(expr.id),
        })
    }

    /// With sin² + cos² = 1 wherever it applies, and without terms that vanish.
    fn settled(mut self) -> Option<Sum<'g>> {
        self.terms.retain(|(_, coefficient)| !coefficient.is_rounding());
        while let Some(([sine, cosine], rest)) = self.squares_of_one_angle() {
            let (_, coefficient) = self.terms[sine];
            let mut k = 0..;
            self.terms.retain(|_| k.next().is_some_and(|k| k != sine && k != cosine));
            add(&mut self.terms, rest, coefficient);
            self.terms.retain(|(_, coefficient)| !coefficient.is_rounding());
        }
        self.terms.iter().all(|(_, coefficient)| coefficient.value.is_finite()).then_some(self)
    }

    /// The places of two terms c·x·sin²a and c·x·cos²a, and x.
    fn squares_of_one_angle(&self) -> Option<([usize; 2], Monomial)> {
        for (sine, (monomial, coefficient)) in self.terms.iter().enumerate() {
            for &(factor, power) in monomial.0.iter().filter(|(_, power)| *power >= 2) {
                let Node::Unary(Unary::Sin, angle) = self.graph.node(factor) else { continue };
                let mut rest = monomial.clone();
                rest.set(factor, power - 2);
                let mut partner = rest.clone();
                let cosine = self.graph.expr(angle).cos().id;
                partner.set(cosine, partner.power(cosine) + 2);
                let Ok(cosine) = place(&self.terms, &partner) else { continue };
                if coefficient.plus(self.terms[cosine].1.times(-1.0)).is_rounding() {
                    return Some(([sine, cosine], rest));
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
        let mut common = monomials.next().cloned().unwrap_or_default();
        for monomial in monomials {
            common.0.iter_mut().for_each(|(factor, power)| *power = monomial.power(*factor).min(*power));
            common.0.retain(|(_, power)| *power > 0);
        }
        common
    }

    /// (a, b) turned by an angle: u = a·cos g − b·sin g and v = a·sin g + b·cos g. The angle, a and b, if u and v, written out,
    /// are that.
    pub(crate) fn turned(u: Expr<'g>, v: Expr<'g>) -> Option<(Expr<'g>, [Sum<'g>; 2])> {
        let graph = u.graph;
        let u = Sum::of(u, Products::WrittenOut)?;
        // seldom needed
        let v = LazyCell::new(|| Sum::of(v, Products::WrittenOut));
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
            let mut rest = monomial.clone();
            rest.set(wave, 0);
            add(&mut part.terms, rest, *coefficient);
        }
        Some((a, b))
    }

    /// Divided by something that every term has as a factor.
    pub(crate) fn without(mut self, factor: &Monomial) -> Sum<'g> {
        for (monomial, _) in &mut self.terms {
            factor.0.iter().for_each(|&(node, power)| monomial.set(node, monomial.power(node) - power));
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

    fn set(&mut self, factor: NodeId, power: u32) {
        match self.0.binary_search_by_key(&factor, |(own, _)| *own) {
            Ok(at) if power == 0 => {
                self.0.remove(at);
            }
            Ok(at) => self.0[at].1 = power,
            Err(_) if power == 0 => {}
            Err(at) => self.0.insert(at, (factor, power)),
        }
    }

    fn times(&self, other: &Monomial) -> Monomial {
        let (mut a, mut b) = (self.0.as_slice(), other.0.as_slice());
        let mut product = Vec::with_capacity(a.len() + b.len());
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
        Monomial(product)
    }
}

fn multiplied(a: &Terms, b: &Terms) -> Option<Terms> {
    if a.len() * b.len() > MOST_TERMS {
        return None;
    }
    let mut out = Terms::new();
    for (left, c) in a {
        for (right, d) in b {
            add(&mut out, left.times(right), Coefficient { value: c.value * d.value, size: c.size * d.size });
        }
    }
    Some(out)
}

/// a + b.
fn added(a: Terms, b: Terms) -> Terms {
    let (mut a, mut b) = (a.into_iter().peekable(), b.into_iter().peekable());
    let mut sum = Terms::with_capacity(a.len() + b.len());
    while let (Some((left, _)), Some((right, _))) = (a.peek(), b.peek()) {
        match left.cmp(right) {
            Ordering::Less => sum.extend(a.next()),
            Ordering::Greater => sum.extend(b.next()),
            Ordering::Equal => {
                let both = a.next().zip(b.next());
                sum.extend(both.map(|((monomial, c), (_, d))| (monomial, c.plus(d))));
            }
        }
    }
    sum.extend(a);
    sum.extend(b);
    sum
}

/// Where a monomial is, or belongs.
fn place(terms: &Terms, monomial: &Monomial) -> Result<usize, usize> {
    terms.binary_search_by(|(own, _)| own.cmp(monomial))
}

fn add(terms: &mut Terms, monomial: Monomial, coefficient: Coefficient) {
    match place(terms, &monomial) {
        Ok(at) => terms[at].1 = terms[at].1.plus(coefficient),
        Err(at) => terms.insert(at, (monomial, coefficient)),
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
