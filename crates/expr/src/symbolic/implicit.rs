//! Unknowns that equations give: their values by Newton's method, written out, their derivatives by the equations.

use crate::symbolic::graph::{Expr, Graph, Node, NodeId};
use crate::symbolic::hash::NodeMap;

/// One unknown of some equations.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct RootId {
    pub(crate) system: u32,
    pub(crate) component: u8,
}

/// Equations with as many unknowns.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Implicit {
    /// Variables that stand for the unknowns in the equations, and nowhere else.
    pub(crate) unknowns: Vec<NodeId>,
    /// Where each unknown lies.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// What is zero.
    pub(crate) residuals: Vec<NodeId>,
    /// The value of each unknown.
    values: Vec<NodeId>,
    /// How far the last step went, over how far it may go.
    last: NodeId,
}

impl Implicit {
    /// What it is written with.
    pub(crate) fn written(&self) -> impl Iterator<Item = NodeId> {
        self.unknowns.iter().chain(&self.residuals).copied()
    }

    fn root<'g>(&self, graph: &'g Graph, root: RootId) -> Expr<'g> {
        let [value, last] = [self.values[usize::from(root.component)], self.last].map(|id| graph.expr(id));
        if value.as_constant().is_some() && last.as_constant().is_some_and(|last| last <= 1.0) {
            return value;
        }
        graph.intern(Node::Root(root, value.id, last.id))
    }

    /// All unknowns, once the graph has the equations.
    fn roots(self, graph: &Graph) -> Vec<Expr<'_>> {
        let count = self.unknowns.len() as u8;
        let system = graph.implicit(self.clone());
        (0..count).map(|component| self.root(graph, RootId { system, component })).collect()
    }
}

/// What unknowns give, its bounds, and how far it may lie beyond these.
type Bounded<'g> = (Expr<'g>, (f64, f64), f64);

/// The unknowns of equations from good starts: two steps of Newton's method, each kept within the ranges and from the middle of where an
/// interval puts the unknowns, which gives intervals the mean-value form. The value is NaN where the last step goes further than
/// `reach`.
///
/// Each residual is zero; `unknowns` are variables that stand nowhere else. They are said to lie in `ranges`, their values stay within
/// `limits`. Something that they give has bounds, too: the value is NaN where it lies further beyond them than its own reach.
pub(crate) fn roots<'g>(
    residuals: &[Expr<'g>],
    unknowns: &[Expr<'g>],
    [ranges, limits]: [&[(f64, f64)]; 2],
    starts: Vec<Expr<'g>>,
    (reach, bounds): (&[f64], &[Bounded<'g>]),
) -> Vec<Expr<'g>> {
    let graph = residuals[0].graph();
    let slopes: Vec<Expr<'g>> =
        residuals.iter().flat_map(|residual| unknowns.iter().map(|unknown| residual.derivative(*unknown))).collect();
    let at = |parts: &[Expr<'g>], place: &[Expr<'g>]| {
        let replacements: Vec<_> = unknowns.iter().copied().zip(place.iter().copied()).collect();
        graph.substitute(parts, &replacements)
    };
    let within = |x: Expr<'g>, (low, high): (f64, f64)| x.max(graph.constant(low)).min(graph.constant(high));
    let clamped = |x: Vec<Expr<'g>>| -> Vec<Expr<'g>> {
        x.into_iter().zip(limits).map(|(x, limits)| within(x, *limits)).collect()
    };
    let step = |x: &[Expr<'g>], middle: &[Expr<'g>]| solution(&at(&slopes, x), &at(residuals, middle));
    let moved = |from: &[Expr<'g>], by: &[Expr<'g>]| clamped(from.iter().zip(by).map(|(x, by)| *x - *by).collect());
    let middles = |x: &[Expr<'g>]| -> Vec<Expr<'g>> { x.iter().map(|x| x.middle()).collect() };
    let start = clamped(starts);
    let middle = middles(&start);
    let near = moved(&middle, &step(&start, &middle));
    let middle = middles(&near);
    let by = step(&near, &middle);
    let values = moved(&middle, &by);
    let sizes = by.iter().zip(reach).map(|(by, reach)| by.abs() / *reach);
    let laws: Vec<Expr<'g>> = bounds.iter().map(|bounded| bounded.0).collect();
    let beyond = at(&laws, &values).into_iter().zip(bounds);
    let beyond = beyond.map(|(law, (_, limits, reach))| (law - within(law, *limits)).abs() / *reach);
    let last = sizes.chain(beyond).reduce(|a, b| a.max(b)).expect("there are unknowns");
    let ids = |exprs: &[Expr<'g>]| exprs.iter().map(|expr| expr.id).collect();
    let system = Implicit {
        unknowns: ids(unknowns),
        ranges: ranges.to_vec(),
        residuals: ids(residuals),
        values: ids(&values),
        last: last.id,
    };
    system.roots(graph)
}

/// The derivative of an unknown: J x' = −∂F.
pub(crate) fn slope<'g>(graph: &'g Graph, root: RootId, variable: Expr<'g>) -> Expr<'g> {
    let system = graph.implicit_of(root);
    let exprs = |ids: &[NodeId]| -> Vec<Expr<'g>> { ids.iter().map(|id| graph.expr(*id)).collect() };
    let (residuals, unknowns) = (exprs(&system.residuals), exprs(&system.unknowns));
    let changes: Vec<Expr<'g>> = residuals.iter().map(|residual| residual.derivative(variable)).collect();
    if changes.iter().all(|change| change.is_zero()) {
        return graph.constant(0.0);
    }
    let slopes = residuals.iter().flat_map(|residual| unknowns.iter().map(|unknown| residual.derivative(*unknown)));
    let parts: Vec<Expr<'g>> = slopes.chain(changes).collect();
    let roots = (0..unknowns.len() as u8).map(|component| system.root(graph, RootId { component, ..root }));
    let replacements: Vec<_> = unknowns.iter().copied().zip(roots).collect();
    let parts = graph.substitute(&parts, &replacements);
    let (slopes, changes) = parts.split_at(unknowns.len() * unknowns.len());
    -solution(slopes, changes)[usize::from(root.component)]
}

/// What becomes of the unknowns where other things are replaced goes into the table.
pub(crate) fn substitute<'g>(graph: &'g Graph, root: RootId, table: &mut NodeMap<NodeId, Expr<'g>>) {
    let system = graph.implicit_of(root);
    let parts: Vec<Expr<'g>> =
        system.residuals.iter().chain(&system.values).chain([&system.last]).map(|id| graph.expr(*id)).collect();
    let images: Vec<NodeId> = graph.substitute_by(&parts, table).into_iter().map(|image| image.id).collect();
    let count = system.unknowns.len();
    let changed = Implicit {
        unknowns: system.unknowns.clone(),
        ranges: system.ranges.clone(),
        residuals: images[..count].to_vec(),
        values: images[count..2 * count].to_vec(),
        last: images[2 * count],
    };
    for (component, image) in changed.roots(graph).into_iter().enumerate() {
        let id = graph.intern(Node::Root(
            RootId { component: component as u8, ..root },
            system.values[component],
            system.last,
        ));
        table.insert(id.id, image);
    }
}

/// The solution of a linear system by determinants: no pivot is sought, so it holds wherever the matrix, row after row, is regular.
fn solution<'g>(matrix: &[Expr<'g>], right: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let size = right.len();
    let columns: Vec<Vec<Expr<'g>>> =
        (0..size).map(|column| (0..size).map(|row| matrix[row * size + column]).collect()).collect();
    let whole = determinant(&columns);
    let replaced = |place: usize| {
        let mut columns = columns.clone();
        columns[place] = right.to_vec();
        determinant(&columns) / whole
    };
    (0..size).map(replaced).collect()
}

/// By the first column; equal minors are one node of the graph.
fn determinant<'g>(columns: &[Vec<Expr<'g>>]) -> Expr<'g> {
    let [first, others @ ..] = columns else { unreachable!("a matrix has columns") };
    if others.is_empty() {
        return first[0];
    }
    let without = |row: usize| -> Vec<Vec<Expr<'g>>> {
        let keep = |column: &Vec<Expr<'g>>| {
            column.iter().enumerate().filter(|(place, _)| *place != row).map(|(_, entry)| *entry).collect()
        };
        others.iter().map(keep).collect()
    };
    let term = |row: usize| {
        let product = first[row] * determinant(&without(row));
        if row.is_multiple_of(2) { product } else { -product }
    };
    (1..first.len()).fold(term(0), |sum, row| sum + term(row))
}
