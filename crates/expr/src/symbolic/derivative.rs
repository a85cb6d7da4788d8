//! Exact derivatives and substitution, both on the shared graph.

use std::sync::Arc;

use crate::symbolic::curve::Curve;
use crate::symbolic::graph::{CurveId, Expr, Graph, Node, NodeId, Placed, VariableId, Way};
use crate::symbolic::hash::NodeMap;
use crate::symbolic::implicit;
use crate::symbolic::integral;
use crate::symbolic::op::{Binary, Unary};

impl<'g> Expr<'g> {
    /// The exact partial derivative with respect to a variable.
    ///
    /// Cost: a few nodes for each node that depends on the variable, once; repeated calls cost only what is new. At a kink
    /// (`abs`, `min`, `max`) it is the mean of the two sides. The slope of the side that `min` or `max` does not take must
    /// be finite: it is multiplied by zero.
    ///
    /// # Panics
    /// If `variable` is not a variable, or of another graph.
    pub fn derivative(self, variable: Expr<'g>) -> Expr<'g> {
        self.graph.assert_owns(variable);
        let id = variable.as_variable().expect("the derivative is taken with respect to a variable");
        let graph = self.graph;
        if let Some(known) = graph.known_derivative(id, self.id) {
            return graph.expr(known);
        }
        for node in graph.reachable_without_derivative(self.id, id) {
            let slope = rule(graph, node, id);
            graph.remember_derivative(id, node, slope.id);
        }
        known(graph, self.id, id)
    }
}

/// An expression that is linear in a variable: `intercept + slope · variable`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Linear<'g> {
    /// Its value where the variable is zero.
    pub intercept: Expr<'g>,
    /// Its derivative, which does not depend on the variable.
    pub slope: Expr<'g>,
}

impl<'g> Linear<'g> {
    /// Where it is zero: a root in closed form.
    pub fn root(self) -> Expr<'g> {
        -self.intercept / self.slope
    }
}

impl<'g> Expr<'g> {
    /// The expression as one that is linear in a variable, if its derivative can be seen not to depend on it and is not zero.
    ///
    /// Seen is what the graph's rules simplify: an expression may be linear without being written so.
    ///
    /// # Panics
    /// If `variable` is not a variable, or of another graph.
    pub fn linear_in(self, variable: Expr<'g>) -> Option<Linear<'g>> {
        let slope = self.derivative(variable);
        let depends = slope.graph.work(&[slope], &[variable]) > 0 || slope == variable;
        if slope.is_zero() || depends {
            return None;
        }
        let intercept = self.graph.substitute(&[self], &[(variable, self.graph.constant(0.0))])[0];
        Some(Linear { intercept, slope })
    }
}

fn known<'g>(graph: &'g Graph, node: NodeId, variable: VariableId) -> Expr<'g> {
    graph.expr(graph.known_derivative(variable, node).expect("operands come before what is made of them"))
}

/// The derivative of one node, whose operands' derivatives are known.
fn rule<'g>(graph: &'g Graph, node: NodeId, variable: VariableId) -> Expr<'g> {
    let y = graph.expr(node);
    match graph.node(node) {
        Node::Constant(_) => graph.constant(0.0),
        Node::Variable(id) => graph.constant(if id == variable { 1.0 } else { 0.0 }),
        Node::Curve(curve, order, a) => {
            let slope = known(graph, a, variable);
            if slope.is_zero() { slope } else { graph.expr(a).on_curve(curve, order + 1) * slope }
        }
        // it moves as what it is the middle of: a node that is a point
        Node::Middle(a) => known(graph, a, variable),
        Node::Root(root, ..) => implicit::slope(graph, root, graph.expr_of(variable)),
        Node::Integral(id, ..) => integral::slope(graph, id, graph.expr_of(variable)),
        Node::Unary(op, a) => {
            let slope = known(graph, a, variable);
            if slope.is_zero() { slope } else { unary_rule(op, graph.expr(a), y, slope) }
        }
        Node::Binary(op, a, b) => {
            let slopes = (known(graph, a, variable), known(graph, b, variable));
            if slopes.0.is_zero() && slopes.1.is_zero() {
                return slopes.0;
            }
            binary_rule(op, (graph.expr(a), graph.expr(b)), y, slopes)
        }
    }
}

fn unary_rule<'g>(op: Unary, a: Expr<'g>, y: Expr<'g>, da: Expr<'g>) -> Expr<'g> {
    match op {
        Unary::Neg => -da,
        Unary::Sqrt => da / (2.0 * y),
        Unary::Sin => a.cos() * da,
        Unary::Cos => -(a.sin() * da),
        Unary::Tan => (1.0 + y.squared()) * da,
        Unary::Asin => da / (1.0 - a.squared()).sqrt(),
        Unary::Acos => -(da / (1.0 - a.squared()).sqrt()),
        Unary::Atan => da / (1.0 + a.squared()),
        Unary::Sinh => a.cosh() * da,
        Unary::Cosh => a.sinh() * da,
        Unary::Tanh => (1.0 - y.squared()) * da,
        Unary::Asinh => da / (1.0 + a.squared()).sqrt(),
        Unary::Acosh => da / (a.squared() - 1.0).sqrt(),
        Unary::Atanh => da / (1.0 - a.squared()),
        // d(tan a − a) = tan²a da
        Unary::Arcinv => da / y.tan().squared(),
        Unary::Exp => y * da,
        Unary::Ln => da / a,
        Unary::Abs => a.sign() * da,
        Unary::Sign => a.graph.constant(0.0),
    }
}

fn binary_rule<'g>(op: Binary, (a, b): (Expr<'g>, Expr<'g>), y: Expr<'g>, (da, db): (Expr<'g>, Expr<'g>)) -> Expr<'g> {
    match op {
        Binary::Add => da + db,
        Binary::Sub => da - db,
        Binary::Mul => da * b + a * db,
        Binary::Div => (da - y * db) / b,
        // the two parts apart, so that a constant exponent never meets the logarithm of a negative base
        Binary::Pow if db.is_zero() => b * a.pow(b - 1.0) * da,
        Binary::Pow if da.is_zero() => y * a.ln() * db,
        Binary::Pow => b * a.pow(b - 1.0) * da + y * a.ln() * db,
        Binary::Atan2 => (b * da - a * db) / (a.squared() + b.squared()),
        // weights 0, ½ or 1, each exact: a large slope of the side that is not taken leaves no rounding error behind
        Binary::Min => blend((a - b).sign(), db, da),
        Binary::Max => blend((a - b).sign(), da, db),
    }
}

/// One expression where the side is 1, another where it is −1, their mean where it is 0.
fn blend<'g>(side: Expr<'g>, positive: Expr<'g>, negative: Expr<'g>) -> Expr<'g> {
    if positive == negative {
        return positive;
    }
    (0.5 + 0.5 * side) * positive + (0.5 - 0.5 * side) * negative
}

impl Graph {
    fn reachable_without_derivative(&self, root: NodeId, variable: VariableId) -> Vec<NodeId> {
        self.reachable_by(Way::Slopes, [root], |id| self.known_derivative(variable, id).is_none())
    }

    /// The expressions with variables, or longer parts, replaced wherever they stand as a whole; simplified anew. Shared parts
    /// stay shared.
    pub fn substitute<'g>(&'g self, roots: &[Expr<'g>], replacements: &[(Expr<'g>, Expr<'g>)]) -> Vec<Expr<'g>> {
        let mut table: NodeMap<NodeId, Expr<'g>> = replacements.iter().map(|(part, value)| (part.id, *value)).collect();
        self.substitute_by(roots, &mut table)
    }

    /// The same by a table, which learns what becomes of unknowns that equations give.
    pub(crate) fn substitute_by<'g>(
        &'g self,
        roots: &[Expr<'g>],
        table: &mut NodeMap<NodeId, Expr<'g>>,
    ) -> Vec<Expr<'g>> {
        let order = self.order(roots);
        let mut image: Vec<Expr<'g>> = Vec::with_capacity(order.nodes.len());
        for Placed { id, node, operands: [a, b] } in order.nodes {
            image.push(match node {
                _ if table.contains_key(&id) => table[&id],
                Node::Middle(_) => image[a].middle(),
                Node::Root(root, value, last) if (image[a].id, image[b].id) == (value, last) => {
                    self.intern(Node::Root(root, value, last))
                }
                Node::Root(root, ..) => {
                    implicit::substitute(self, root, table);
                    table[&id]
                }
                Node::Integral(_, value, _) if image[a].id == value => self.expr(id),
                Node::Integral(known, ..) => integral::substitute(self, known, table),
                Node::Constant(_) | Node::Variable(_) => self.expr(id),
                Node::Unary(op, _) => image[a].unary(op),
                Node::Curve(curve, order, _) => image[a].on_curve(curve, order),
                Node::Binary(op, ..) => image[a].binary(op, image[b]),
            });
        }
        order.roots.into_iter().map(|root| image[root]).collect()
    }

    /// What the expressions take the sine or cosine of, in order of creation.
    pub fn angles_in<'g>(&'g self, roots: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let angle = |id: NodeId| match self.node(id) {
            Node::Unary(Unary::Sin | Unary::Cos, angle) => Some(angle),
            _ => None,
        };
        let mut angles: Vec<NodeId> =
            self.reachable(roots.iter().map(|root| root.id)).into_iter().filter_map(angle).collect();
        angles.sort_unstable();
        angles.dedup();
        angles.into_iter().map(|id| self.expr(id)).collect()
    }

    /// The curves that the expressions use, with what they are asked for, in order of creation.
    pub fn curves_in<'g>(&'g self, roots: &[Expr<'g>]) -> Vec<(Arc<Curve>, Expr<'g>)> {
        let used = |id: NodeId| match self.node(id) {
            Node::Curve(curve, _, at) => Some((at, curve)),
            _ => None,
        };
        let mut found: Vec<(NodeId, CurveId)> =
            self.reachable(roots.iter().map(|root| root.id)).into_iter().filter_map(used).collect();
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|(at, curve)| (self.curve_of(curve), self.expr(at))).collect()
    }

    /// The variables that the expressions depend on, in order of creation.
    pub fn variables_of(&self, roots: &[Expr<'_>]) -> Vec<VariableId> {
        let found = self.reachable(roots.iter().map(|root| root.id));
        found.into_iter().filter_map(|id| self.expr(id).as_variable()).collect()
    }
}
