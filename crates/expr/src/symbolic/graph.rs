//! A graph in which equal expressions are one node.

use std::cell::RefCell;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use crate::symbolic::curve::Curve;
use crate::symbolic::hash::NodeMap;
use crate::symbolic::implicit::{Implicit, RootId};
use crate::symbolic::integral::{Integral, IntegralId};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::terms::{Products, Tried};
use crate::symbolic::walk::Pending;

pub use crate::symbolic::expression::Expr;
pub use crate::symbolic::walk::NodeCount;
pub(crate) use crate::symbolic::walk::{Placed, Way};

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
        let (operands, count) = match self {
            Node::Constant(_) | Node::Variable(_) => ([NodeId(0); 2], 0),
            Node::Unary(_, a) | Node::Curve(_, _, a) | Node::Middle(a) => ([a; 2], 1),
            Node::Binary(_, a, b) | Node::Root(_, a, b) | Node::Integral(_, a, b) => ([a, b], 2),
        };
        operands.into_iter().take(count)
    }
}

#[derive(Default)]
pub(super) struct Store {
    pub(super) nodes: Vec<Node>,
    index: NodeMap<Node, NodeId>,
    pub(super) variables: Vec<String>,
    curves: Vec<Arc<Curve>>,
    pub(super) implicits: Vec<Arc<Implicit>>,
    pub(super) integrals: Vec<Arc<Integral>>,
    /// Whether one of the nodes is a middle.
    pub(super) has_middles: bool,
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
    pub(super) store: RefCell<Store>,
    pub(super) pending: RefCell<Pending>,
    /// Where nodes stand in the last order that was made of them.
    pub(super) places: RefCell<Vec<u32>>,
    /// What tapes take for settings, with their first numbers.
    pub(crate) settings: RefCell<Vec<(NodeId, f64)>>,
}

impl fmt::Debug for Graph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Graph({} nodes)", self.len())
    }
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Graph {
        /// Nodes of a short text: tables that grow node by node are hashed anew several times.
        const ROOM: usize = 7168;
        let graph = Graph::default();
        let mut store = graph.store.borrow_mut();
        store.nodes.reserve(ROOM);
        store.index.reserve(ROOM);
        store.derivatives.reserve(ROOM);
        drop(store);
        graph
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
            store.has_middles |= matches!(node, Node::Middle(_));
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
}
