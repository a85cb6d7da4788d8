//! Expressions as text and as LaTeX.

mod name;
mod shape;
mod write;

use std::collections::{HashMap, HashSet};
use std::fmt;

use crate::symbolic::graph::{Expr, Graph, Node, NodeId, Way};
pub(crate) use name::GREEK;
use write::Writer;

/// How expressions are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// As in the language: `2 * sin(phi)`.
    Text,
    /// As in a paper: `2 \, \sin\left(\varphi\right)`.
    Latex,
}

/// A part that several others use, under a name of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// `t1`, `t2`, … as the values write it: `t_{1}` in LaTeX.
    pub name: String,
    /// What it stands for.
    pub value: String,
}

/// Expressions written out, shared parts named once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// Shared parts in an order in which each uses only earlier ones.
    pub definitions: Vec<Definition>,
    /// The expressions.
    pub values: Vec<String>,
}

/// A part gets a name of its own if it is used more than once and has at least this many nodes.
const NAMED_FROM_NODES: f64 = 7.0;

impl Graph {
    /// Writes expressions; parts used more than once and too long to repeat become definitions, named `prefix1`,
    /// `prefix2`, … (a number that would give the name of a variable is left out).
    pub fn listing(&self, roots: &[Expr<'_>], style: Style, prefix: &str) -> Listing {
        let order = self.reachable_by(Way::Words, roots.iter().map(|root| root.id), |_| true);
        let named: Vec<(NodeId, String)> =
            self.worth_naming(&order, roots).into_iter().zip(self.free_names(style, prefix)).collect();
        let writer = Writer::new(self, style, &order, named.iter().cloned().collect());
        Listing {
            definitions: named
                .into_iter()
                .map(|(id, name)| Definition { name, value: writer.definition(id) })
                .collect(),
            values: roots.iter().map(|root| writer.text(root.id)).collect(),
        }
    }

    /// What a node is written with.
    fn words(&self, id: NodeId) -> Vec<NodeId> {
        match self.node(id) {
            Node::Root(root, ..) => self.implicit_of(root).written().collect(),
            Node::Integral(integral, ..) => self.integral_of(integral).written().to_vec(),
            node => node.operands().collect(),
        }
    }

    /// Nodes used more than once and long, even with the parts before them named.
    fn worth_naming(&self, order: &[NodeId], roots: &[Expr<'_>]) -> Vec<NodeId> {
        let mut uses: HashMap<NodeId, u32> = HashMap::new();
        for operand in order.iter().flat_map(|&id| self.words(id)).chain(roots.iter().map(|root| root.id)) {
            *uses.entry(operand).or_insert(0) += 1;
        }
        let mut sizes: HashMap<NodeId, f64> = HashMap::new();
        let mut worth = Vec::new();
        for &id in order {
            let below: f64 = self.words(id).iter().map(|part| sizes[part]).sum();
            let size = below + 1.0;
            let is_named = uses[&id] > 1 && size >= NAMED_FROM_NODES;
            if is_named {
                worth.push(id);
            }
            sizes.insert(id, if is_named { 1.0 } else { size });
        }
        worth
    }

    /// Names as they are written, without those that a variable has: any of the graph, as pages show several expressions of it.
    fn free_names(&self, style: Style, prefix: &str) -> impl Iterator<Item = String> {
        let store = self.store.borrow();
        // none but those that begin alike can be one of these
        let alike = store.variables.iter().filter(|name| name.starts_with(prefix));
        let taken: HashSet<String> = alike.map(|variable| name::variable(variable, style)).collect();
        (1..)
            .map(move |number: u32| name::variable(&format!("{prefix}{number}"), style))
            .filter(move |name| !taken.contains(name))
    }
}

impl fmt::Display for Expr<'_> {
    /// The expression as text, nothing named; meant for small ones.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const TOO_LONG: f64 = 10_000.0;
        let count = self.graph.count(&[*self]);
        if count.written_out > TOO_LONG {
            return write!(f, "(an expression of {} nodes)", count.shared);
        }
        let order = self.graph.reachable_by(Way::Words, [self.id], |_| true);
        f.write_str(&Writer::new(self.graph, Style::Text, &order, HashMap::new()).text(self.id))
    }
}
