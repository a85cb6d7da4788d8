//! The oracle: evaluation node by node, slow and plain.

use crate::symbolic::graph::{Expr, Graph, Node, Placed};
use crate::tape::kernel;

impl Graph {
    /// Values of the expressions; `values` holds one number per variable of the graph, in order of creation.
    ///
    /// Every other evaluator is tested against this one.
    ///
    /// # Panics
    /// If an expression depends on a variable beyond the end of `values`.
    pub fn evaluate(&self, roots: &[Expr<'_>], values: &[f64]) -> Vec<f64> {
        let order = self.order(roots);
        let mut known: Vec<f64> = Vec::with_capacity(order.nodes.len());
        for Placed { node, operands: [a, b], .. } in order.nodes {
            known.push(match node {
                Node::Constant(bits) => f64::from_bits(bits),
                Node::Variable(variable) => values[variable.index()],
                Node::Unary(op, _) => op.apply(known[a]),
                Node::Curve(curve, order, _) => self.curve_of(curve).value(order, known[a]),
                Node::Middle(_) | Node::Integral(..) => known[a],
                Node::Root(..) => kernel::settled(known[a], known[b]),
                Node::Binary(op, ..) => op.apply(known[a], known[b]),
            });
        }
        order.roots.into_iter().map(|root| known[root]).collect()
    }
}
