//! Walks through a graph: what expressions are made of, each node once, after what it is made of.

use crate::symbolic::graph::{Expr, Graph, Node, NodeId, VariableId};
use crate::symbolic::op::Binary;

/// What an unknown that equations give, or an integral, is taken for on a walk through the graph.
#[derive(Clone, Copy)]
pub(crate) enum Way {
    /// The steps that compute it.
    Values,
    /// A leaf: its derivatives come from the equations, or from what is integrated.
    Slopes,
    /// The equations, or what is integrated.
    Words,
}

/// Nodes, each after what it is made of.
pub(crate) struct Order {
    pub(crate) nodes: Vec<Placed>,
    /// The place of each root.
    pub(crate) roots: Vec<usize>,
}

/// A node among others.
#[derive(Clone, Copy)]
pub(crate) struct Placed {
    pub(crate) id: NodeId,
    pub(crate) node: Node,
    /// The places of its operands: the only one twice, none as zeros.
    pub(crate) operands: [usize; 2],
}

impl Placed {
    /// Whether it is made of nothing.
    pub(crate) fn is_leaf(&self) -> bool {
        matches!(self.node, Node::Constant(_) | Node::Variable(_))
    }
}

/// Nodes that a walk through the graph has yet to come to, the highest first: what a node is made of lies below it, so that each is met
/// once, in its order, after all that it is part of. The memory is kept, so that a walk costs only what it comes to.
#[derive(Default)]
pub(super) struct Pending {
    /// A bit for each node.
    nodes: Vec<u64>,
    /// A bit for each word of these that is not zero.
    words: Vec<u64>,
    /// The last of those that may not be zero.
    top: usize,
}

impl Pending {
    const BITS: usize = u64::BITS as usize;

    fn begin(&mut self, nodes: usize) {
        let words = nodes.div_ceil(Self::BITS);
        if self.nodes.len() < words {
            self.nodes.resize(2 * words, 0);
            self.words.resize(self.nodes.len().div_ceil(Self::BITS), 0);
        }
        self.top = 0;
    }

    fn insert(&mut self, NodeId(id): NodeId) {
        let word = id as usize / Self::BITS;
        let group = word / Self::BITS;
        self.nodes[word] |= 1 << (id as usize % Self::BITS);
        self.words[group] |= 1 << (word % Self::BITS);
        self.top = self.top.max(group);
    }

    /// Takes out the highest.
    fn pop(&mut self) -> Option<NodeId> {
        while *self.words.get(self.top)? == 0 {
            self.top = self.top.checked_sub(1)?;
        }
        let highest = |bits: u64| bits.ilog2() as usize;
        let word = self.top * Self::BITS + highest(self.words[self.top]);
        let bit = highest(self.nodes[word]);
        self.nodes[word] ^= 1 << bit;
        if self.nodes[word] == 0 {
            self.words[self.top] ^= 1 << (word % Self::BITS);
        }
        Some(NodeId((word * Self::BITS + bit) as u32))
    }
}

impl Graph {
    /// Every node that the roots are made of, operands before what is made of them.
    pub(crate) fn reachable(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<NodeId> {
        self.reachable_where(roots, |_| true)
    }

    /// The same without nodes of a kind, and what only these are made of.
    pub(crate) fn reachable_where(
        &self,
        roots: impl IntoIterator<Item = NodeId>,
        is_wanted: impl Fn(NodeId) -> bool,
    ) -> Vec<NodeId> {
        self.reachable_by(Way::Values, roots, is_wanted)
    }

    /// The same where unknowns that equations give are taken for something else than their values.
    pub(crate) fn reachable_by(
        &self,
        way: Way,
        roots: impl IntoIterator<Item = NodeId>,
        is_wanted: impl Fn(NodeId) -> bool,
    ) -> Vec<NodeId> {
        let (store, mut pending) = (self.store.borrow(), self.pending.borrow_mut());
        pending.begin(store.nodes.len());
        roots.into_iter().for_each(|root| pending.insert(root));
        let mut found = Vec::with_capacity(64);
        while let Some(id) = pending.pop() {
            if !is_wanted(id) {
                continue;
            }
            found.push(id);
            match (way, store.nodes[id.0 as usize]) {
                (Way::Slopes, Node::Root(..) | Node::Integral(..)) => {}
                (Way::Words, Node::Root(root, ..)) => {
                    let written = store.implicits[root.system as usize].written();
                    written.into_iter().for_each(|part| pending.insert(part));
                }
                (Way::Words, Node::Integral(integral, ..)) => {
                    let written = store.integrals[integral.0 as usize].written();
                    written.into_iter().for_each(|part| pending.insert(part));
                }
                (_, node) => node.operands().for_each(|operand| pending.insert(operand)),
            }
        }
        found.reverse();
        found
    }

    /// What the roots are made of.
    pub(crate) fn order(&self, roots: &[Expr<'_>]) -> Order {
        let found = self.reachable(roots.iter().map(|root| root.id));
        let (nodes, roots) = self.placed(&found, roots.iter().map(|root| root.id));
        Order { nodes, roots: roots.into_iter().map(|root| root.expect("roots are among them")).collect() }
    }

    /// The same numbers without what only enclosures need: a middle is what it is the middle of, and parts that are equal then are one.
    pub(crate) fn without_middles<'g>(&'g self, roots: &[Expr<'g>]) -> Vec<Expr<'g>> {
        if !self.store.borrow().has_middles {
            return roots.to_vec();
        }
        let Order { nodes, roots: places } = self.order(roots);
        if !nodes.iter().any(|placed| matches!(placed.node, Node::Middle(_))) {
            return roots.to_vec();
        }
        let mut images: Vec<NodeId> = Vec::with_capacity(nodes.len());
        for Placed { id, node, operands: [a, b] } in nodes {
            let of = |place: usize| images[place];
            let is_same = node.operands().zip([a, b]).all(|(operand, place)| operand == of(place));
            let image = match node {
                Node::Constant(_) | Node::Variable(_) => id,
                Node::Middle(_) => of(a),
                _ if is_same => id,
                Node::Unary(op, _) => self.intern(Node::Unary(op, of(a))).id,
                Node::Binary(op, ..) => self.intern(Node::Binary(op, of(a), of(b))).id,
                Node::Curve(curve, order, _) => self.intern(Node::Curve(curve, order, of(a))).id,
                Node::Root(root, ..) => self.intern(Node::Root(root, of(a), of(b))).id,
                Node::Integral(integral, ..) => self.intern(Node::Integral(integral, of(a), of(b))).id,
            };
            images.push(image);
        }
        places.into_iter().map(|place| self.expr(images[place])).collect()
    }

    /// Nodes with the places of their operands, which are among them, and the places of the `wanted`; none of what is not among them.
    pub(crate) fn placed(
        &self,
        found: &[NodeId],
        wanted: impl Iterator<Item = NodeId>,
    ) -> (Vec<Placed>, Vec<Option<usize>>) {
        let (store, mut places) = (self.store.borrow(), self.places.borrow_mut());
        places.resize(store.nodes.len(), 0);
        for (place, id) in found.iter().enumerate() {
            places[id.0 as usize] = place as u32;
        }
        let place = |id: NodeId| places[id.0 as usize] as usize;
        let placed = |id: NodeId| {
            let node = store.nodes[id.0 as usize];
            let mut operands = node.operands().map(place);
            let first = operands.next().unwrap_or(0);
            Placed { id, node, operands: [first, operands.next().unwrap_or(first)] }
        };
        let nodes = found.iter().copied().map(placed).collect();
        (nodes, wanted.map(|id| Some(place(id)).filter(|place| found.get(*place) == Some(&id))).collect())
    }

    /// Operations that depend on at least one of the `variables`: what has to be done anew where these change, with equal
    /// parts done once.
    pub fn work(&self, roots: &[Expr<'_>], variables: &[Expr<'_>]) -> usize {
        let variables: Vec<Option<VariableId>> = variables.iter().map(|variable| variable.as_variable()).collect();
        let mut changes: Vec<bool> = Vec::new();
        let mut work = 0;
        for Placed { node, operands: [a, b], .. } in self.order(roots).nodes {
            let changed = match node {
                Node::Constant(_) => false,
                Node::Variable(id) => variables.contains(&Some(id)),
                _ => changes[a] || changes[b],
            };
            work += usize::from(changed && !matches!(node, Node::Variable(_)));
            changes.push(changed);
        }
        work
    }

    /// Nodes of an expression when equal ones are shared, and its variables, in order of creation.
    pub fn extent(&self, root: Expr<'_>) -> (usize, Vec<VariableId>) {
        let found = self.reachable([root.id]);
        let variables = found.iter().filter_map(|id| self.expr(*id).as_variable()).collect();
        (found.len(), variables)
    }

    /// What an expression divides by anywhere in it, each once, what is part of others before them.
    pub fn divisors(&self, root: Expr<'_>) -> Vec<Expr<'_>> {
        let divisor = |id: NodeId| match self.node(id) {
            Node::Binary(Binary::Div, _, by) => Some(by),
            _ => None,
        };
        let mut found: Vec<NodeId> = self.reachable([root.id]).into_iter().filter_map(divisor).collect();
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|id| self.expr(id)).collect()
    }

    /// Nodes of the expressions when equal ones are shared.
    pub fn size(&self, roots: &[Expr<'_>]) -> usize {
        self.reachable(roots.iter().map(|root| root.id)).len()
    }

    /// Sizes of the expressions: nodes when every use is written out, and nodes when equal ones are shared.
    pub fn count(&self, roots: &[Expr<'_>]) -> NodeCount {
        let order = self.order(roots);
        let mut written: Vec<f64> = Vec::with_capacity(order.nodes.len());
        for Placed { node, operands, .. } in &order.nodes {
            let operands = operands.iter().take(node.operands().count());
            written.push(operands.map(|place| written[*place]).sum::<f64>() + 1.0);
        }
        NodeCount { written_out: order.roots.iter().map(|root| written[*root]).sum(), shared: order.nodes.len() }
    }
}

/// Size of a set of expressions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeCount {
    /// Nodes when every use of a part is written out again (a float: it grows exponentially).
    pub written_out: f64,
    /// Nodes when equal parts are shared.
    pub shared: usize,
}
