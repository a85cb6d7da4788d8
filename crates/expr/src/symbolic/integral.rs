//! Integrals: their values by sums over nodes, their derivatives by what is integrated.

use crate::symbolic::graph::{Expr, Graph, Node, NodeId};
use crate::symbolic::hash::NodeMap;

/// One integral of a graph.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct IntegralId(pub(crate) u32);

/// What is integrated, and what it comes to.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Integral {
    /// Stands in the integrand, and nowhere else.
    variable: NodeId,
    integrand: NodeId,
    ends: [NodeId; 2],
    /// The sum over the nodes.
    value: NodeId,
    /// How far that is off at the most.
    bound: NodeId,
}

impl Integral {
    /// Its variable, its integrand, both ends.
    pub(crate) fn written(&self) -> [NodeId; 4] {
        [self.variable, self.integrand, self.ends[0], self.ends[1]]
    }

    /// Once the graph has it; a number where nothing moves.
    fn expr(self, graph: &Graph) -> Expr<'_> {
        let [value, bound] = [self.value, self.bound].map(|id| graph.expr(id));
        if value.as_constant().is_some() {
            return value;
        }
        let id = graph.integral(self);
        graph.intern(Node::Integral(id, value.id, bound.id))
    }
}

/// An integral over `variable`, which stands nowhere else, whose value is known to within a bound.
pub(crate) fn integral<'g>(
    integrand: Expr<'g>,
    variable: Expr<'g>,
    ends: [Expr<'g>; 2],
    (value, bound): (Expr<'g>, f64),
) -> Expr<'g> {
    let graph = variable.graph();
    let bound = graph.constant(bound).id;
    let ends = ends.map(|end| end.id);
    Integral { variable: variable.id, integrand: integrand.id, ends, value: value.id, bound }.expr(graph)
}

/// By what moves the ends alone, an integral changes as its integrand says there: no sum. By what moves the integrand, the sum changes.
pub(crate) fn slope<'g>(graph: &'g Graph, id: IntegralId, variable: Expr<'g>) -> Expr<'g> {
    let integral = graph.integral_of(id);
    let [own, integrand, from, to] = integral.written().map(|id| graph.expr(id));
    let inside = graph.variables_of(&[integrand]);
    if variable.as_variable().is_some_and(|variable| inside.contains(&variable)) {
        return graph.expr(integral.value).derivative(variable);
    }
    let at = |end: Expr<'g>| {
        let slope = end.derivative(variable);
        if slope.is_zero() { slope } else { graph.substitute(&[integrand], &[(own, end)])[0] * slope }
    };
    at(to) - at(from)
}

/// What becomes of an integral where other things are replaced.
pub(crate) fn substitute<'g>(graph: &'g Graph, id: IntegralId, table: &mut NodeMap<NodeId, Expr<'g>>) -> Expr<'g> {
    let integral = graph.integral_of(id);
    let parts = [integral.integrand, integral.ends[0], integral.ends[1], integral.value].map(|id| graph.expr(id));
    let images = graph.substitute_by(&parts, table);
    Integral { integrand: images[0].id, ends: [images[1].id, images[2].id], value: images[3].id, ..(*integral).clone() }
        .expr(graph)
}
