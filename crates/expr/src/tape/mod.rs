//! Expressions laid out as a list of instructions.

pub(crate) mod cost;
pub(crate) mod evaluate;
pub(crate) mod interpret;
pub(crate) mod kernel;
pub(crate) mod lanes;

use std::sync::Arc;

use thiserror::Error;

use crate::symbolic::curve::Curve;
use crate::symbolic::graph::{CurveId, Expr, Graph, Node, NodeId};
use crate::symbolic::hash::{NodeMap, NodeSet};
use crate::symbolic::op::{Binary, Unary};

/// What an instruction does with its registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// `out = op(a)`; `b` is unused.
    Unary(Unary),
    /// `out = op(a, b)`.
    Binary(Binary),
    /// `out` = the derivative of this order of the tape's curve number `b`, at `a`.
    Curve(u8),
    /// `out = a`; of an interval, its middle.
    Middle,
    /// `out = a` where |b| ≤ 1, else NaN.
    Settled,
    /// `out = a`; of an interval, all that lies within `b` of it.
    Widened,
    /// `out = sin(a)` and register `b` = `cos(a)`, together at little more than the cost of one.
    SinCos,
}

/// One step: read registers, then write registers, which may be the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What is done.
    pub operation: Operation,
    /// The register written.
    pub out: u32,
    /// The first operand.
    pub a: u32,
    /// The second operand.
    pub b: u32,
}

// Evaluation streams through instructions: their size is memory traffic.
const _: () = assert!(size_of::<Instruction>() == 16);

/// A straight list of instructions that computes some outputs from some inputs.
///
/// Registers hold the inputs first, then the constants, then temporaries, which are used again once their value is dead.
#[derive(Clone, Debug)]
pub struct Tape {
    input_count: usize,
    constants: Vec<f64>,
    curves: Vec<Arc<Curve>>,
    instructions: Vec<Instruction>,
    outputs: Vec<u32>,
    register_count: usize,
}

/// Why a tape cannot be made.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TapeError {
    /// An output depends on a variable that is not among the inputs.
    #[error("`{0}` has no value: it is not among the inputs of the tape")]
    UnboundVariable(String),
}

impl Tape {
    /// Lays out `outputs` as functions of the variables `inputs`. Of a variable given twice the last entry counts.
    ///
    /// # Errors
    /// If an output depends on a variable that is not an input.
    ///
    /// # Panics
    /// If an entry of `inputs` is not a variable, or the expressions are of different graphs.
    pub fn new(outputs: &[Expr<'_>], inputs: &[Expr<'_>]) -> Result<Tape, TapeError> {
        Tape::with_definitions(outputs, inputs, &[])
    }

    /// The same where some variables stand for expressions, each in the inputs and in variables defined before it. What depends on
    /// them is computed from their numbers: nothing cancels because of what they stand for. An input that is defined has no
    /// effect.
    ///
    /// ```
    /// use flank_expr::{Graph, ScalarEvaluator, Tape};
    /// let graph = Graph::new();
    /// let (x, y) = (graph.variable("x"), graph.variable("y"));
    /// let tape = Tape::with_definitions(&[y, 3.0 * y - x], &[x], &[(y, x / 3.0)]).expect("y is defined");
    /// let mut out = [0.0; 2];
    /// ScalarEvaluator::new(&tape).run(&[0.7], &mut out);
    /// assert_eq!(out, [0.7 / 3.0, 3.0 * (0.7 / 3.0) - 0.7], "rounding and all");
    /// ```
    ///
    /// # Errors
    /// If an output or a definition depends on a variable that is neither an input nor defined.
    ///
    /// # Panics
    /// As for [`Tape::new`], and if what is defined is not a variable, or is needed by a definition before its own.
    pub fn with_definitions(
        outputs: &[Expr<'_>],
        inputs: &[Expr<'_>],
        definitions: &[(Expr<'_>, Expr<'_>)],
    ) -> Result<Tape, TapeError> {
        assert!(inputs.iter().all(|input| input.as_variable().is_some()), "inputs of a tape are variables");
        let mut tape = Tape {
            input_count: inputs.len(),
            constants: Vec::new(),
            curves: Vec::new(),
            instructions: Vec::new(),
            outputs: Vec::new(),
            register_count: inputs.len(),
        };
        let Some(first) = outputs.first() else {
            return Ok(tape);
        };
        let graph = first.graph();
        for &expr in
            outputs.iter().chain(inputs).chain(definitions.iter().flat_map(|(variable, value)| [variable, value]))
        {
            graph.assert_owns(expr);
        }
        let roots = definitions.iter().map(|(_, value)| vec![value.id]);
        let roots = roots.chain([outputs.iter().map(|output| output.id).collect()]);
        let mut order: Vec<NodeId> = roots.flat_map(|roots| graph.reachable(roots)).collect();
        if !definitions.is_empty() {
            let mut seen = NodeSet::default();
            order.retain(|id| seen.insert(*id));
        }
        let mut registers = Registers::new(graph, &order, outputs, definitions);
        for (index, input) in inputs.iter().enumerate() {
            registers.place.insert(input.id, index as u32);
        }
        tape.place_leaves(graph, &order, &mut registers)?;
        registers.next = (tape.input_count + tape.constants.len()) as u32;
        tape.instructions = order.iter().filter_map(|&id| registers.step(graph, id)).collect();
        tape.curves = registers.curves.iter().map(|&id| graph.curve_of(id)).collect();
        tape.outputs = outputs.iter().map(|output| registers.place[&registers.meant(output.id)]).collect();
        tape.register_count = registers.next as usize;
        Ok(tape)
    }

    fn place_leaves(&mut self, graph: &Graph, order: &[NodeId], registers: &mut Registers) -> Result<(), TapeError> {
        for &id in order {
            match graph.node(id) {
                Node::Constant(bits) => {
                    registers.place.insert(id, (self.input_count + self.constants.len()) as u32);
                    self.constants.push(f64::from_bits(bits));
                }
                Node::Variable(variable) if !registers.place.contains_key(&id) && registers.meant(id) == id => {
                    return Err(TapeError::UnboundVariable(graph.variable_name(variable)));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Number of inputs.
    pub fn input_count(&self) -> usize {
        self.input_count
    }

    /// Number of outputs.
    pub fn output_count(&self) -> usize {
        self.outputs.len()
    }

    /// Registers that an evaluator needs.
    pub fn register_count(&self) -> usize {
        self.register_count
    }

    /// The numbers in the registers after the inputs.
    pub fn constants(&self) -> &[f64] {
        &self.constants
    }

    /// The curves that instructions refer to by number.
    pub fn curves(&self) -> &[Arc<Curve>] {
        &self.curves
    }

    /// The steps.
    pub fn instructions(&self) -> &[Instruction] {
        &self.instructions
    }

    /// Register of each output after the last step.
    pub fn outputs(&self) -> &[u32] {
        &self.outputs
    }
}

/// Which node lives in which register, and which registers are free.
struct Registers {
    place: NodeMap<NodeId, u32>,
    /// What defined variables stand for.
    meanings: NodeMap<NodeId, NodeId>,
    uses: NodeMap<NodeId, u32>,
    /// The cosine that has the angle of a sine, and the other way round, where both are wanted.
    partners: NodeMap<NodeId, NodeId>,
    free: Vec<u32>,
    /// Curves in the order in which the tape numbers them.
    curves: Vec<CurveId>,
    next: u32,
}

impl Registers {
    fn new(graph: &Graph, order: &[NodeId], outputs: &[Expr<'_>], definitions: &[(Expr<'_>, Expr<'_>)]) -> Registers {
        let mut meanings = NodeMap::<NodeId, NodeId>::default();
        for (variable, value) in definitions {
            assert!(variable.as_variable().is_some(), "what is defined is a variable");
            let meaning = meanings.get(&value.id).copied().unwrap_or(value.id);
            meanings.insert(variable.id, meaning);
        }
        let meant = |id: NodeId| meanings.get(&id).copied().unwrap_or(id);
        let mut uses = NodeMap::with_capacity_and_hasher(order.len(), Default::default());
        for &id in order {
            let mut before = None;
            for operand in
                graph.node(id).operands().map(meant).filter(|&operand| before.replace(operand) != Some(operand))
            {
                *uses.entry(operand).or_insert(0) += 1;
            }
        }
        // an output is read once more, after the last step
        for output in outputs {
            *uses.entry(meant(output.id)).or_insert(0) += 1;
        }
        // leaves are never written again
        for &id in order {
            if matches!(graph.node(id), Node::Constant(_) | Node::Variable(_)) {
                uses.insert(id, u32::MAX);
            }
        }
        let partners = partners(graph, order);
        let place = NodeMap::with_capacity_and_hasher(order.len(), Default::default());
        Registers { place, meanings, uses, partners, free: Vec::new(), curves: Vec::new(), next: 0 }
    }

    fn meant(&self, id: NodeId) -> NodeId {
        self.meanings.get(&id).copied().unwrap_or(id)
    }

    /// The instruction of a node; none for a leaf, which is in its register from the start, nor for the second of a sine and
    /// a cosine.
    fn step(&mut self, graph: &Graph, id: NodeId) -> Option<Instruction> {
        if self.place.contains_key(&id) {
            return None;
        }
        let (operation, a, b) = match graph.node(id).with_operands(|operand| self.meant(operand)) {
            Node::Unary(Unary::Sin, a) if self.partners.contains_key(&id) => {
                return Some(self.sin_cos_step(id, self.partners[&id], a));
            }
            Node::Unary(Unary::Cos, a) if self.partners.contains_key(&id) => {
                return Some(self.sin_cos_step(self.partners[&id], id, a));
            }
            Node::Unary(op, a) => (Operation::Unary(op), a, a),
            Node::Binary(op, a, b) => (Operation::Binary(op), a, b),
            Node::Middle(a) => (Operation::Middle, a, a),
            Node::Root(_, a, b) => (Operation::Settled, a, b),
            Node::Integral(_, a, b) => (Operation::Widened, a, b),
            Node::Curve(curve, order, a) => return Some(self.curve_step(id, curve, order, a)),
            Node::Constant(_) | Node::Variable(_) => return None,
        };
        let (a_register, b_register) = (self.place[&a], self.place[&b]);
        self.release(a);
        if b != a {
            self.release(b);
        }
        Some(Instruction { operation, out: self.allocate(id), a: a_register, b: b_register })
    }

    fn sin_cos_step(&mut self, sine: NodeId, cosine: NodeId, a: NodeId) -> Instruction {
        let a_register = self.place[&a];
        self.release(a);
        self.release(a);
        let (out, b) = (self.allocate(sine), self.allocate(cosine));
        Instruction { operation: Operation::SinCos, out, a: a_register, b }
    }

    fn curve_step(&mut self, id: NodeId, curve: CurveId, order: u8, a: NodeId) -> Instruction {
        let known = self.curves.iter().position(|&other| other == curve);
        let index = known.unwrap_or(self.curves.len());
        if known.is_none() {
            self.curves.push(curve);
        }
        let a_register = self.place[&a];
        self.release(a);
        Instruction { operation: Operation::Curve(order), out: self.allocate(id), a: a_register, b: index as u32 }
    }

    fn release(&mut self, id: NodeId) {
        let Some(left) = self.uses.get_mut(&id).filter(|left| **left != u32::MAX) else {
            return;
        };
        *left -= 1;
        if *left == 0 {
            self.free.push(self.place[&id]);
        }
    }

    fn allocate(&mut self, id: NodeId) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        });
        self.place.insert(id, register);
        register
    }
}

/// Of each angle whose sine and cosine are both among the nodes, the one by the other.
fn partners(graph: &Graph, order: &[NodeId]) -> NodeMap<NodeId, NodeId> {
    let (mut of_angle, mut partners) = (NodeMap::<NodeId, NodeId>::default(), NodeMap::default());
    for &id in order {
        let Node::Unary(Unary::Sin | Unary::Cos, angle) = graph.node(id) else { continue };
        if let Some(other) = of_angle.insert(angle, id) {
            partners.insert(id, other);
            partners.insert(other, id);
        }
    }
    partners
}
