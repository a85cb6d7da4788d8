//! A graph in which equal expressions are one node.

use std::cell::RefCell;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::symbolic::curve::Curve;
use crate::symbolic::hash::NodeMap;
use crate::symbolic::implicit::{Implicit, RootId};
use crate::symbolic::integral::{Integral, IntegralId};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::rules;
use crate::symbolic::terms::{Products, Tried};

/// Index of a node. Operands always have smaller indices than what is made of them.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeId(pub(crate) u32);

/// Index of a variable, in order of creation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct VariableId(pub(crate) u32);

impl VariableId {
    /// Position in a slice that holds one entry per variable of the graph.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a curve.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CurveId(pub(crate) u32);

/// One node of the graph.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Node {
    /// A number, kept as its bits so that it can be a key. There is one zero and one NaN.
    Constant(u64),
    /// A variable.
    Variable(VariableId),
    /// An operation on one node.
    Unary(Unary, NodeId),
    /// An operation on two nodes.
    Binary(Binary, NodeId, NodeId),
    /// A derivative of a curve, of an order, at a node.
    Curve(CurveId, u8, NodeId),
    /// A node as a number; of an interval, its middle.
    Middle(NodeId),
    /// An unknown that equations give: its value, and how far the last step went over how far it may go.
    Root(RootId, NodeId, NodeId),
    /// An integral: its value, and how far that is off at the most.
    Integral(IntegralId, NodeId, NodeId),
}

/// In one word, which is folded in once: most of what a table of nodes takes is hashing.
impl Hash for Node {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let word = |kind: u64, which: u64, NodeId(a): NodeId, NodeId(b): NodeId| {
            (u64::from(a) << 32 | u64::from(b)) ^ (which << 8 | kind).wrapping_mul(0xff51_afd7_ed55_8ccd)
        };
        let none = NodeId(0);
        state.write_u64(match *self {
            Node::Constant(bits) => bits,
            Node::Variable(VariableId(id)) => word(1, 0, NodeId(id), none),
            Node::Unary(op, a) => word(2, op as u64, a, none),
            Node::Binary(op, a, b) => word(3, op as u64, a, b),
            Node::Curve(CurveId(curve), order, a) => word(4, u64::from(order), a, NodeId(curve)),
            Node::Middle(a) => word(5, 0, a, none),
            Node::Root(root, a, b) => word(6, u64::from(root.system) << 8 | u64::from(root.component), a, b),
            Node::Integral(IntegralId(integral), a, b) => word(7, u64::from(integral), a, b),
        });
    }
}

impl Node {
    pub(crate) fn constant(value: f64) -> Node {
        let settled = if value == 0.0 {
            0.0
        } else if value.is_nan() {
            f64::NAN
        } else {
            value
        };
        Node::Constant(settled.to_bits())
    }

    /// The nodes it is made of.
    pub(crate) fn operands(self) -> impl Iterator<Item = NodeId> {
        let (a, b) = match self {
            Node::Constant(_) | Node::Variable(_) => (None, None),
            Node::Unary(_, a) | Node::Curve(_, _, a) | Node::Middle(a) => (Some(a), None),
            Node::Binary(_, a, b) | Node::Root(_, a, b) | Node::Integral(_, a, b) => (Some(a), Some(b)),
        };
        a.into_iter().chain(b)
    }
}

#[derive(Default)]
struct Store {
    nodes: Vec<Node>,
    index: NodeMap<Node, NodeId>,
    variables: Vec<String>,
    curves: Vec<Arc<Curve>>,
    implicits: Vec<Arc<Implicit>>,
    integrals: Vec<Arc<Integral>>,
    /// Operations asked for so far, new or not.
    operations: usize,
    room: Option<usize>,
    /// By variable and node in one word.
    derivatives: NodeMap<u64, NodeId>,
    /// Of two squares what their sum is where it is shorter, as [`rules`] find out once.
    square_sums: NodeMap<u64, Option<NodeId>>,
    /// Expressions as sums of products, by node and by how far products are written out.
    terms: NodeMap<u64, Tried>,
}

impl Store {
    fn is_full(&self) -> bool {
        self.room.is_some_and(|room| self.operations > room)
    }
}

/// Two numbers as one key.
fn pair(a: u32, b: u32) -> u64 {
    u64::from(a) << 32 | u64::from(b)
}

/// The arena of all symbolic scalars of one model.
///
/// Nodes are never removed; two equal expressions are the same node, so a derivative or a product costs only what is new
/// in it.
///
/// ```
/// let graph = flank_expr::Graph::new();
/// let x = graph.variable("x");
/// let f = (x * 2.0).sin() * x;
/// let slope = f.derivative(x);
/// assert_eq!(graph.evaluate(&[slope], &[0.0]), [0.0]);
/// ```
#[derive(Default)]
pub struct Graph {
    store: RefCell<Store>,
    pending: RefCell<Pending>,
    /// Where nodes stand in the last order that was made of them.
    places: RefCell<Vec<u32>>,
    /// What tapes take for settings, with their first numbers.
    pub(crate) settings: RefCell<Vec<(NodeId, f64)>>,
}

/// Nodes that a walk through the graph has yet to come to, the highest first: what a node is made of lies below it, so that each is met
/// once, in its order, after all that it is part of. The memory is kept, so that a walk costs only what it comes to.
#[derive(Default)]
struct Pending {
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

impl fmt::Debug for Graph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Graph({} nodes)", self.len())
    }
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Graph {
        Graph::default()
    }

    /// Number of nodes made so far.
    pub fn len(&self) -> usize {
        self.store.borrow().nodes.len()
    }

    /// Sets how many operations it may be asked for from its beginning on, known ones or new: a bound on memory and time. At
    /// first there is none.
    ///
    /// A full graph still makes variables, and NaN of everything else: whoever sets a bound asks [`Graph::is_full`].
    pub fn set_room(&self, room: Option<usize>) {
        self.store.borrow_mut().room = room;
    }

    /// True if the room is used up: expressions made since then mean nothing.
    pub fn is_full(&self) -> bool {
        self.store.borrow().is_full()
    }

    /// True before the first node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number.
    pub fn constant(&self, value: f64) -> Expr<'_> {
        self.intern(Node::constant(value))
    }

    /// A new variable; names are for printing, two variables of one name are two variables.
    pub fn variable(&self, name: impl Into<String>) -> Expr<'_> {
        let id = {
            let mut store = self.store.borrow_mut();
            store.variables.push(name.into());
            VariableId(store.variables.len() as u32 - 1)
        };
        self.intern(Node::Variable(id))
    }

    /// Takes in a curve, which expressions then can be put into.
    pub fn curve(&self, curve: Curve) -> CurveId {
        let mut store = self.store.borrow_mut();
        store.curves.push(Arc::new(curve));
        CurveId(store.curves.len() as u32 - 1)
    }

    pub(crate) fn curve_of(&self, id: CurveId) -> Arc<Curve> {
        Arc::clone(&self.store.borrow().curves[id.0 as usize])
    }

    /// Takes in equations; the same ones are kept once.
    pub(crate) fn implicit(&self, implicit: Implicit) -> u32 {
        let mut store = self.store.borrow_mut();
        let known = store.implicits.iter().position(|other| **other == implicit);
        let place = known.unwrap_or(store.implicits.len());
        if known.is_none() {
            store.implicits.push(Arc::new(implicit));
        }
        place as u32
    }

    /// Takes in an integral; the same one is kept once.
    pub(crate) fn integral(&self, integral: Integral) -> IntegralId {
        let mut store = self.store.borrow_mut();
        let known = store.integrals.iter().position(|other| **other == integral);
        let place = known.unwrap_or(store.integrals.len());
        if known.is_none() {
            store.integrals.push(Arc::new(integral));
        }
        IntegralId(place as u32)
    }

    pub(crate) fn integral_of(&self, integral: IntegralId) -> Arc<Integral> {
        Arc::clone(&self.store.borrow().integrals[integral.0 as usize])
    }

    pub(crate) fn implicit_of(&self, root: RootId) -> Arc<Implicit> {
        Arc::clone(&self.store.borrow().implicits[root.system as usize])
    }

    /// Number of variables made so far.
    pub fn variable_count(&self) -> usize {
        self.store.borrow().variables.len()
    }

    /// The name of a variable.
    pub fn variable_name(&self, variable: VariableId) -> String {
        self.store.borrow().variables[variable.index()].clone()
    }

    /// An expression of another graph would silently mean some other node.
    pub(crate) fn assert_owns(&self, expr: Expr<'_>) {
        assert!(std::ptr::eq(self, expr.graph), "expressions of two graphs");
    }

    pub(crate) fn node(&self, id: NodeId) -> Node {
        self.store.borrow().nodes[id.0 as usize]
    }

    /// A variable by its number.
    pub(crate) fn expr_of(&self, variable: VariableId) -> Expr<'_> {
        self.intern(Node::Variable(variable))
    }

    pub(crate) fn expr(&self, id: NodeId) -> Expr<'_> {
        Expr { graph: self, id }
    }

    pub(crate) fn intern(&self, node: Node) -> Expr<'_> {
        let mut guard = self.store.borrow_mut();
        let store = &mut *guard;
        store.operations += 1;
        let node = match node {
            Node::Variable(_) => node,
            _ if store.is_full() => Node::constant(f64::NAN),
            _ => node,
        };
        let next = NodeId(u32::try_from(store.nodes.len()).expect("fewer than 2³² nodes"));
        let id = *store.index.entry(node).or_insert(next);
        if id == next {
            store.nodes.push(node);
        }
        drop(guard);
        self.expr(id)
    }

    pub(crate) fn known_derivative(&self, variable: VariableId, id: NodeId) -> Option<NodeId> {
        self.store.borrow().derivatives.get(&pair(variable.0, id.0)).copied()
    }

    pub(crate) fn remember_derivative(&self, variable: VariableId, id: NodeId, derivative: NodeId) {
        self.store.borrow_mut().derivatives.insert(pair(variable.0, id.0), derivative);
    }

    pub(crate) fn known_square_sum(&self, (a, b): (NodeId, NodeId)) -> Option<Option<NodeId>> {
        self.store.borrow().square_sums.get(&pair(a.0, b.0)).copied()
    }

    pub(crate) fn remember_square_sum(&self, (a, b): (NodeId, NodeId), sum: Option<NodeId>) {
        self.store.borrow_mut().square_sums.insert(pair(a.0, b.0), sum);
    }

    pub(crate) fn known_terms(&self, id: NodeId, products: Products) -> Option<Tried> {
        self.store.borrow().terms.get(&pair(products as u32, id.0)).cloned()
    }

    pub(crate) fn remember_terms(&self, id: NodeId, products: Products, tried: Tried) {
        /// All are forgotten where there are more: each may hold some thousand bytes.
        const MOST: usize = 4096;
        let terms = &mut self.store.borrow_mut().terms;
        if terms.len() >= MOST {
            terms.clear();
        }
        terms.insert(pair(products as u32, id.0), tried);
    }

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
        let mut found = Vec::new();
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

/// A symbolic scalar: a handle into its graph.
#[derive(Clone, Copy)]
pub struct Expr<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) id: NodeId,
}

impl PartialEq for Expr<'_> {
    /// Same node of the same graph.
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id && std::ptr::eq(self.graph, other.graph)
    }
}

impl Eq for Expr<'_> {}

impl fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl<'g> Expr<'g> {
    /// The graph it lives in.
    pub fn graph(self) -> &'g Graph {
        self.graph
    }

    /// What it is made of.
    pub fn node(self) -> Node {
        self.graph.node(self.id)
    }

    /// Its value if it is a number.
    pub fn as_constant(self) -> Option<f64> {
        match self.node() {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Its variable if it is one.
    pub fn as_variable(self) -> Option<VariableId> {
        match self.node() {
            Node::Variable(id) => Some(id),
            _ => None,
        }
    }

    /// Numerator and denominator.
    pub(crate) fn as_quotient(self) -> (Expr<'g>, Expr<'g>) {
        match self.node() {
            Node::Binary(Binary::Div, a, b) => (self.graph.expr(a), self.graph.expr(b)),
            Node::Unary(Unary::Neg, a) => {
                let (numerator, denominator) = self.graph.expr(a).as_quotient();
                (-numerator, denominator)
            }
            _ => (self, self.graph.constant(1.0)),
        }
    }

    /// True for the number zero.
    pub fn is_zero(self) -> bool {
        self.as_constant() == Some(0.0)
    }

    /// An operation on it, simplified.
    pub fn unary(self, op: Unary) -> Expr<'g> {
        rules::unary(op, self)
    }

    /// An operation on it and another one, simplified.
    ///
    /// # Panics
    /// If the two are of different graphs.
    pub fn binary(self, op: Binary, other: Expr<'g>) -> Expr<'g> {
        self.graph.assert_owns(other);
        rules::binary(op, self, other)
    }

    /// The same number; of an interval, its middle.
    pub(crate) fn middle(self) -> Expr<'g> {
        if self.as_constant().is_some() { self } else { self.graph.intern(Node::Middle(self.id)) }
    }

    /// A derivative of a curve (order 0: its value) here.
    pub fn on_curve(self, curve: CurveId, order: u8) -> Expr<'g> {
        if let Some(x) = self.as_constant() {
            return self.graph.constant(self.graph.curve_of(curve).value(order, x));
        }
        self.graph.intern(Node::Curve(curve, order, self.id))
    }

    /// x·x.
    pub fn squared(self) -> Expr<'g> {
        self * self
    }

    /// Integer power by repeated squaring; negative ones divide.
    pub fn powi(self, exponent: i32) -> Expr<'g> {
        let one = self.graph.constant(1.0);
        let (mut result, mut square, mut left) = (one, self, exponent.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                result = result * square;
            }
            left >>= 1;
            if left > 0 {
                square = square.squared();
            }
        }
        if exponent < 0 { one / result } else { result }
    }
}

macro_rules! unary_methods {
    ($($method:ident $op:ident $doc:literal;)*) => {
        impl<'g> Expr<'g> {
            $(#[doc = $doc] pub fn $method(self) -> Expr<'g> { self.unary(Unary::$op) })*
        }
    };
}

unary_methods! {
    sqrt Sqrt "Square root; NaN below zero.";
    sin Sin "Sine of radians.";
    cos Cos "Cosine of radians.";
    tan Tan "Tangent of radians.";
    asin Asin "Arc sine in radians; NaN outside [−1, 1].";
    acos Acos "Arc cosine in radians; NaN outside [−1, 1].";
    atan Atan "Arc tangent in radians.";
    sinh Sinh "Hyperbolic sine.";
    cosh Cosh "Hyperbolic cosine.";
    tanh Tanh "Hyperbolic tangent.";
    asinh Asinh "Inverse hyperbolic sine.";
    acosh Acosh "Inverse hyperbolic cosine; NaN below 1.";
    atanh Atanh "Inverse hyperbolic tangent; NaN outside [−1, 1].";
    arcinv Arcinv "The angle in radians whose involute function tan a − a is given.";
    exp Exp "Exponential.";
    ln Ln "Natural logarithm; NaN below zero.";
    abs Abs "Absolute value; its derivative at zero is taken as zero.";
    sign Sign "−1, 0 or 1.";
}

macro_rules! binary_methods {
    ($($method:ident $op:ident $doc:literal;)*) => {
        impl<'g> Expr<'g> {
            $(#[doc = $doc] pub fn $method(self, other: Expr<'g>) -> Expr<'g> { self.binary(Binary::$op, other) })*
        }
    };
}

binary_methods! {
    pow Pow "Power with any exponent.";
    atan2 Atan2 "Angle of the point (x = `other`, y = `self`) in (−π, π].";
    min Min "The smaller of two.";
    max Max "The larger of two.";
}

macro_rules! operators {
    ($($trait:ident $method:ident $op:ident;)*) => {$(
        impl<'g> $trait for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                self.binary(Binary::$op, other)
            }
        }

        impl<'g> $trait<f64> for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: f64) -> Expr<'g> {
                self.binary(Binary::$op, self.graph.constant(other))
            }
        }

        impl<'g> $trait<Expr<'g>> for f64 {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                other.graph.constant(self).binary(Binary::$op, other)
            }
        }
    )*};
}

operators! {
    Add add Add;
    Sub sub Sub;
    Mul mul Mul;
    Div div Div;
}

impl<'g> Neg for Expr<'g> {
    type Output = Expr<'g>;
    fn neg(self) -> Expr<'g> {
        self.unary(Unary::Neg)
    }
}
