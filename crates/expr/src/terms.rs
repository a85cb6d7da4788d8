//! Short sums of products in one normal form, for what construction by rules does not see: a factor that all components of
//! a vector share, sin² + cos² spread over several terms. Only sums of a few terms are ever written out.

use std::collections::BTreeMap;

use crate::graph::{Expr, Graph, Node, NodeId};
use crate::op::{Binary, Unary};

/// Terms of the longest sum that is written out.
const MOST_TERMS: usize = 24;
/// Products and sums inside each other that are looked through.
const DEEPEST: usize = 24;

/// Coefficients that differ, or are what is left of larger ones, by less than this share are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Powers of the factors of one term, by node.
pub(crate) type Monomial = BTreeMap<NodeId, u32>;

/// A number with the size of what it was summed from.
#[derive(Clone, Copy)]
struct Coefficient {
    value: f64,
    size: f64,
}

type Terms = BTreeMap<Monomial, Coefficient>;

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
            for (monomial, coefficient) in multiplied(&root.terms, &root.terms)? {
                sum.add(monomial, coefficient);
            }
        }
        sum.settled()
    }

    fn terms(expr: Expr<'g>, products: Products, depth: usize) -> Option<Terms> {
        let graph = expr.graph;
        let below = |id: NodeId| Sum::terms(graph.expr(id), products, depth.checked_sub(1)?);
        let whole = |id: NodeId| Terms::from([(Monomial::from([(id, 1)]), Coefficient::from(1.0))]);
        Some(match expr.node() {
            Node::Constant(bits) => Terms::from([(Monomial::new(), Coefficient::from(f64::from_bits(bits)))]),
            Node::Unary(Unary::Neg, a) => {
                below(a)?.into_iter().map(|(monomial, c)| (monomial, c.times(-1.0))).collect()
            }
            Node::Binary(op @ (Binary::Add | Binary::Sub), a, b) => {
                let mut sum = Sum { graph, terms: below(a)? };
                for (monomial, c) in below(b)? {
                    sum.add(monomial, if op == Binary::Add { c } else { c.times(-1.0) });
                }
                (sum.terms.len() <= MOST_TERMS).then_some(sum.terms)?
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

    fn add(&mut self, monomial: Monomial, coefficient: Coefficient) {
        add(&mut self.terms, monomial, coefficient);
    }

    /// With sin² + cos² = 1 wherever it applies, and without terms that vanish.
    fn settled(mut self) -> Option<Sum<'g>> {
        self.terms.retain(|_, coefficient| !coefficient.is_rounding());
        while let Some((sine, cosine, rest)) = self.squares_of_one_angle() {
            let coefficient = self.terms.remove(&sine)?;
            self.terms.remove(&cosine);
            self.add(rest, coefficient);
            self.terms.retain(|_, coefficient| !coefficient.is_rounding());
        }
        self.terms.values().all(|coefficient| coefficient.value.is_finite()).then_some(self)
    }

    /// Two terms c·x·sin²a and c·x·cos²a, and x.
    fn squares_of_one_angle(&self) -> Option<(Monomial, Monomial, Monomial)> {
        for (monomial, coefficient) in &self.terms {
            for (&factor, &power) in monomial.iter().filter(|(_, power)| **power >= 2) {
                let Node::Unary(Unary::Sin, angle) = self.graph.node(factor) else { continue };
                let mut rest = monomial.clone();
                raise(&mut rest, factor, power - 2);
                let mut partner = rest.clone();
                let cosine = self.graph.expr(angle).cos().id;
                let already = partner.get(&cosine).copied().unwrap_or(0);
                raise(&mut partner, cosine, already + 2);
                if self.terms.get(&partner).is_some_and(|other| coefficient.plus(other.times(-1.0)).is_rounding()) {
                    return Some((monomial.clone(), partner, rest));
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
        let mut terms = self.terms.iter();
        terms.next().is_some_and(|(monomial, c)| monomial.is_empty() && c.plus((-1.0).into()).is_rounding())
            && terms.next().is_none()
    }

    /// What all terms of all sums have as a factor.
    pub(crate) fn common_factor(sums: &[Sum<'g>]) -> Monomial {
        let mut monomials = sums.iter().flat_map(|sum| sum.terms.keys());
        let mut common = monomials.next().cloned().unwrap_or_default();
        for monomial in monomials {
            common = common
                .into_iter()
                .filter_map(|(factor, power)| Some((factor, power.min(*monomial.get(&factor)?))))
                .collect();
        }
        common
    }

    /// (a, b) turned by an angle: u = a·cos g − b·sin g and v = a·sin g + b·cos g. The angle, a and b, if u and v are that.
    pub(crate) fn turned(u: &Sum<'g>, v: &Sum<'g>) -> Option<(Expr<'g>, [Sum<'g>; 2])> {
        let graph = u.graph;
        let (first, _) = u.terms.first_key_value()?;
        first.keys().find_map(|&factor| {
            let (Node::Unary(Unary::Sin, angle) | Node::Unary(Unary::Cos, angle)) = graph.node(factor) else {
                return None;
            };
            let angle = graph.expr(angle);
            let (a, minus_b) = u.waves(angle)?;
            let (b, also_a) = v.waves(angle)?;
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
        for (monomial, &coefficient) in &self.terms {
            let mut rest = monomial.clone();
            match (rest.remove(&cosine), rest.remove(&sine)) {
                (Some(1), None) => a.terms.insert(rest, coefficient),
                (None, Some(1)) => b.terms.insert(rest, coefficient),
                _ => return None,
            };
        }
        Some((a, b))
    }

    /// Divided by something that every term has as a factor.
    pub(crate) fn without(mut self, factor: &Monomial) -> Sum<'g> {
        self.terms = std::mem::take(&mut self.terms)
            .into_iter()
            .map(|(mut monomial, coefficient)| {
                for (&node, &power) in factor {
                    let left = monomial.get(&node).copied().unwrap_or(0) - power;
                    raise(&mut monomial, node, left);
                }
                (monomial, coefficient)
            })
            .collect();
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
    monomial.iter().fold(graph.constant(1.0), |product, (&factor, &power)| {
        product * graph.expr(factor).powi(i32::try_from(power).expect("a few factors"))
    })
}

fn raise(monomial: &mut Monomial, factor: NodeId, power: u32) {
    if power == 0 {
        monomial.remove(&factor);
    } else {
        monomial.insert(factor, power);
    }
}

fn multiplied(a: &Terms, b: &Terms) -> Option<Terms> {
    if a.len() * b.len() > MOST_TERMS {
        return None;
    }
    let mut out = Terms::new();
    for (left, c) in a {
        for (right, d) in b {
            let mut monomial = left.clone();
            for (&factor, &power) in right {
                *monomial.entry(factor).or_insert(0) += power;
            }
            add(&mut out, monomial, Coefficient { value: c.value * d.value, size: c.size * d.size });
        }
    }
    Some(out)
}

fn add(terms: &mut Terms, monomial: Monomial, coefficient: Coefficient) {
    let sum = terms.get(&monomial).map_or(coefficient, |before| before.plus(coefficient));
    terms.insert(monomial, sum);
}

/// Whether a = factor · b, term by term.
fn differ_by_rounding(a: &Terms, factor: f64, b: &Terms) -> bool {
    a.len() == b.len()
        && a.iter().all(|(monomial, coefficient)| {
            b.get(monomial).is_some_and(|other| coefficient.plus(other.times(-factor)).is_rounding())
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
