//! The oracle: evaluation node by node, slow and plain.

use crate::graph::{Expr, Graph, Node, NodeId};
use crate::hash::NodeMap;

impl Graph {
    /// Values of the expressions; `values` holds one number per variable of the graph, in order of creation.
    ///
    /// Every other evaluator is held against this one.
    ///
    /// # Panics
    /// If an expression depends on a variable beyond the end of `values`.
    pub fn evaluate(&self, roots: &[Expr<'_>], values: &[f64]) -> Vec<f64> {
        let mut known: NodeMap<NodeId, f64> = NodeMap::default();
        for id in self.reachable(roots.iter().map(|root| root.id)) {
            let value = match self.node(id) {
                Node::Constant(bits) => f64::from_bits(bits),
                Node::Variable(variable) => values[variable.index()],
                Node::Unary(op, a) => op.apply(known[&a]),
                Node::Curve(curve, order, a) => self.curve_of(curve).value(order, known[&a]),
                Node::Binary(op, a, b) => op.apply(known[&a], known[&b]),
            };
            known.insert(id, value);
        }
        roots.iter().map(|root| known[&root.id]).collect()
    }
}
