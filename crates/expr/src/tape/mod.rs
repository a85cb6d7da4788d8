//! Expressions laid out as a list of instructions.

pub(crate) mod cost;
pub(crate) mod evaluate;
pub(crate) mod interpret;
pub(crate) mod kernel;
pub(crate) mod lanes;
mod settings;

use std::sync::Arc;

use thiserror::Error;

use crate::symbolic::curve::Curve;
use crate::symbolic::graph::{CurveId, Expr, Graph, Node, NodeId, Placed};
use crate::symbolic::hash::NodeMap;
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
    /// How many of the constants are settings: the first ones.
    setting_count: usize,
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
    /// Whether another one computes the same, bit by bit, in the same order.
    pub(crate) fn is_same(&self, other: &Tape) -> bool {
        let shape = |of: &Tape| [of.input_count, of.setting_count, of.register_count, of.constants.len()];
        let bits = |of: &Tape| of.constants.iter().map(|constant| constant.to_bits()).collect::<Vec<u64>>();
        shape(self) == shape(other)
            && self.instructions == other.instructions
            && self.outputs == other.outputs
            && bits(self) == bits(other)
            && self.curves == other.curves
    }

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
        let graph = outputs.iter().chain(inputs).next().map(|first| first.graph());
        let settings = graph.map_or(Vec::new(), |graph| graph.settings.borrow().clone());
        let mut tape = Tape {
            input_count: inputs.len(),
            setting_count: settings.len(),
            constants: settings.iter().map(|(_, value)| *value).collect(),
            curves: Vec::new(),
            instructions: Vec::new(),
            outputs: Vec::new(),
            register_count: inputs.len() + settings.len(),
        };
        let Some(graph) = graph.filter(|_| !outputs.is_empty()) else {
            return Ok(tape);
        };
        for &expr in
            outputs.iter().chain(inputs).chain(definitions.iter().flat_map(|(variable, value)| [variable, value]))
        {
            graph.assert_owns(expr);
        }
        let mut order: Vec<NodeId> = graph.reachable(outputs.iter().map(|output| output.id));
        if !definitions.is_empty() {
            let mut defined: Vec<NodeId> =
                definitions.iter().flat_map(|(_, value)| graph.reachable([value.id])).collect();
            defined.append(&mut order);
            order = defined;
            let mut seen = vec![false; graph.len()];
            order.retain(|id| !std::mem::replace(&mut seen[id.0 as usize], true));
        }
        let wanted = definitions.iter().flat_map(|(variable, value)| [variable.id, value.id]);
        let (nodes, places) = graph.placed(&order, wanted.chain(outputs.iter().map(|output| output.id)));
        let (defined, outputs) = places.split_at(2 * definitions.len());
        assert!(
            definitions.iter().all(|(variable, _)| variable.as_variable().is_some()),
            "what is defined is a variable"
        );
        let outputs: Vec<usize> = outputs.iter().map(|output| output.expect("outputs are among them")).collect();
        let mut registers = Registers::new(&nodes, defined, &outputs);
        let settings = settings.iter().enumerate().map(|(k, (id, _))| (*id, inputs.len() + k));
        let inputs: NodeMap<NodeId, usize> =
            settings.chain(inputs.iter().enumerate().map(|(index, input)| (input.id, index))).collect();
        tape.place_leaves(graph, &inputs, &mut registers)?;
        registers.next = (tape.input_count + tape.constants.len()) as u32;
        tape.instructions.reserve(nodes.len());
        for place in 0..nodes.len() {
            if let Some(instruction) = registers.step(place) {
                tape.instructions.push(instruction);
            }
        }
        tape.curves = registers.curves.iter().map(|&id| graph.curve_of(id)).collect();
        tape.outputs = outputs.iter().map(|output| registers.register_of(registers.meant[*output])).collect();
        tape.register_count = registers.next as usize;
        Ok(tape)
    }

    /// [`Tape::with_definitions`] for numbers and series, with fewer steps: what only enclosures need is left out. The numbers are the same.
    ///
    /// # Errors
    /// As for [`Tape::with_definitions`].
    ///
    /// # Panics
    /// As for [`Tape::with_definitions`].
    pub fn of_numbers<'g>(
        outputs: &[Expr<'g>],
        inputs: &[Expr<'g>],
        definitions: &[(Expr<'g>, Expr<'g>)],
    ) -> Result<Tape, TapeError> {
        let Some(first) = outputs.first() else { return Tape::new(outputs, inputs) };
        let all: Vec<Expr<'g>> = outputs.iter().copied().chain(definitions.iter().map(|(_, value)| *value)).collect();
        let all = first.graph().without_middles(&all);
        let (outputs, values) = all.split_at(outputs.len());
        let definitions: Vec<_> =
            definitions.iter().map(|(variable, _)| *variable).zip(values.iter().copied()).collect();
        Tape::with_definitions(outputs, inputs, &definitions)
    }

    fn place_leaves(
        &mut self,
        graph: &Graph,
        inputs: &NodeMap<NodeId, usize>,
        registers: &mut Registers<'_>,
    ) -> Result<(), TapeError> {
        for (place, leaf) in registers.nodes.iter().enumerate() {
            match leaf.node {
                Node::Constant(bits) => {
                    registers.held[place] = (self.input_count + self.constants.len()) as u32;
                    self.constants.push(f64::from_bits(bits));
                }
                Node::Variable(variable) => match inputs.get(&leaf.id) {
                    Some(index) => registers.held[place] = *index as u32,
                    None if registers.meant[place] == place => {
                        return Err(TapeError::UnboundVariable(graph.variable_name(variable)));
                    }
                    None => {}
                },
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

/// Of nothing.
const NOWHERE: u32 = u32::MAX;

/// Which node lives in which register, and which registers are free. Nodes are told by their places.
struct Registers<'n> {
    nodes: &'n [Placed],
    /// The register of each node.
    held: Vec<u32>,
    /// What each node stands for: itself, but for variables that are defined.
    meant: Vec<usize>,
    /// How often each node is still read.
    uses: Vec<u32>,
    /// The cosine that has the angle of a sine, and the other way round, where both are wanted.
    partners: Vec<u32>,
    free: Vec<u32>,
    /// Curves in the order in which the tape numbers them.
    curves: Vec<CurveId>,
    next: u32,
}

impl Registers<'_> {
    /// `defined` has the places of each variable that is defined, and of what it stands for; none of variables that nothing depends on.
    fn new<'n>(nodes: &'n [Placed], defined: &[Option<usize>], outputs: &[usize]) -> Registers<'n> {
        let mut meant: Vec<usize> = (0..nodes.len()).collect();
        for pair in defined.chunks_exact(2) {
            if let [Some(variable), Some(value)] = *pair {
                meant[variable] = meant[value];
            }
        }
        let mut uses = vec![0_u32; nodes.len()];
        for placed in nodes.iter().filter(|placed| !placed.is_leaf()) {
            let [a, b] = placed.operands.map(|operand| meant[operand]);
            uses[a] += 1;
            uses[b] += u32::from(b != a);
        }
        // an output is read once more, after the last step
        for output in outputs {
            uses[meant[*output]] += 1;
        }
        // leaves are never written again
        for (uses, _) in uses.iter_mut().zip(nodes).filter(|(_, placed)| placed.is_leaf()) {
            *uses = u32::MAX;
        }
        let (held, partners) = (vec![NOWHERE; nodes.len()], partners(nodes));
        Registers { nodes, held, meant, uses, partners, free: Vec::new(), curves: Vec::new(), next: 0 }
    }

    fn register_of(&self, place: usize) -> u32 {
        let register = self.held[place];
        assert_ne!(register, NOWHERE, "what is defined is not needed before");
        register
    }

    /// The instruction of a node; none for a leaf, which is in its register from the start, nor for the second of a sine and
    /// a cosine.
    fn step(&mut self, place: usize) -> Option<Instruction> {
        if self.held[place] != NOWHERE {
            return None;
        }
        let Placed { node, operands, .. } = self.nodes[place];
        let [a, b] = operands.map(|operand| self.meant[operand]);
        let partner = self.partners[place];
        let operation = match node {
            Node::Unary(Unary::Sin, _) if partner != NOWHERE => {
                return Some(self.sin_cos_step(place, partner as usize, a));
            }
            Node::Unary(Unary::Cos, _) if partner != NOWHERE => {
                return Some(self.sin_cos_step(partner as usize, place, a));
            }
            Node::Unary(op, _) => Operation::Unary(op),
            Node::Binary(op, ..) => Operation::Binary(op),
            Node::Middle(_) => Operation::Middle,
            Node::Root(..) => Operation::Settled,
            Node::Integral(..) => Operation::Widened,
            Node::Curve(curve, order, _) => return Some(self.curve_step(place, curve, order, a)),
            Node::Constant(_) | Node::Variable(_) => return None,
        };
        let (a_register, b_register) = (self.register_of(a), self.register_of(b));
        self.release(a);
        if b != a {
            self.release(b);
        }
        Some(Instruction { operation, out: self.allocate(place), a: a_register, b: b_register })
    }

    fn sin_cos_step(&mut self, sine: usize, cosine: usize, a: usize) -> Instruction {
        let a_register = self.register_of(a);
        self.release(a);
        self.release(a);
        let (out, b) = (self.allocate(sine), self.allocate(cosine));
        Instruction { operation: Operation::SinCos, out, a: a_register, b }
    }

    fn curve_step(&mut self, place: usize, curve: CurveId, order: u8, a: usize) -> Instruction {
        let known = self.curves.iter().position(|&other| other == curve);
        let index = known.unwrap_or(self.curves.len());
        if known.is_none() {
            self.curves.push(curve);
        }
        let a_register = self.register_of(a);
        self.release(a);
        Instruction { operation: Operation::Curve(order), out: self.allocate(place), a: a_register, b: index as u32 }
    }

    fn release(&mut self, place: usize) {
        let left = &mut self.uses[place];
        if *left == u32::MAX {
            return;
        }
        *left -= 1;
        if *left == 0 {
            self.free.push(self.held[place]);
        }
    }

    fn allocate(&mut self, place: usize) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        });
        self.held[place] = register;
        register
    }
}

/// Of each angle whose sine and cosine are both among the nodes, the one by the other.
fn partners(nodes: &[Placed]) -> Vec<u32> {
    let [mut of_angle, mut partners] = [vec![NOWHERE; nodes.len()], vec![NOWHERE; nodes.len()]];
    for (place, placed) in nodes.iter().enumerate() {
        let Node::Unary(Unary::Sin | Unary::Cos, _) = placed.node else { continue };
        let other = std::mem::replace(&mut of_angle[placed.operands[0]], place as u32);
        if other != NOWHERE {
            partners[place] = other;
            partners[other as usize] = place as u32;
        }
    }
    partners
}
