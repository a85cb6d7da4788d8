//! How many operations a tape takes, by how often they have to be done.

use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Operation, Tape};

/// Numbers of operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Sums, differences and changes of sign.
    pub additions: usize,
    /// Products.
    pub multiplications: usize,
    /// Quotients.
    pub divisions: usize,
    /// Square roots.
    pub roots: usize,
    /// Angles of which a sine, a cosine or both are taken.
    pub sincos: usize,
    /// All other functions and curves.
    pub others: usize,
}

impl Cost {
    fn count(&mut self, operation: Operation) {
        let counter = match operation {
            Operation::Binary(Binary::Add | Binary::Sub) | Operation::Unary(Unary::Neg) => &mut self.additions,
            Operation::Binary(Binary::Mul) => &mut self.multiplications,
            Operation::Binary(Binary::Div) => &mut self.divisions,
            Operation::Unary(Unary::Sqrt) => &mut self.roots,
            Operation::SinCos | Operation::Unary(Unary::Sin | Unary::Cos) => &mut self.sincos,
            Operation::Middle | Operation::Widened => return,
            Operation::Unary(_) | Operation::Binary(_) | Operation::Curve(_) | Operation::Settled => &mut self.others,
        };
        *counter += 1;
    }
}

impl Tape {
    /// The operations of each stage, for inputs that change at the given stages: an operation belongs to the latest stage
    /// among what it depends on.
    ///
    /// ```
    /// use flank_expr::{Graph, Tape};
    /// let graph = Graph::new();
    /// let (radius, angle) = (graph.variable("radius"), graph.variable("angle"));
    /// let tape = Tape::new(&[radius * radius * angle.sin()], &[radius, angle]).expect("all are inputs");
    /// let [once, each] = tape.cost(&[0, 1])[..] else { panic!("two stages") };
    /// assert_eq!((once.multiplications, each.multiplications, each.sincos), (1, 1, 1));
    /// ```
    ///
    /// # Panics
    /// If there is not one stage for each input.
    pub fn cost(&self, stages: &[usize]) -> Vec<Cost> {
        assert_eq!(stages.len(), self.input_count(), "one stage for each input");
        let mut costs = vec![Cost::default(); stages.iter().max().map_or(1, |last| last + 1)];
        let mut stage_of = vec![0; self.register_count()];
        stage_of[..stages.len()].copy_from_slice(stages);
        for step in self.instructions() {
            let a = stage_of[step.a as usize];
            let stage = match step.operation {
                Operation::Binary(_) | Operation::Settled => a.max(stage_of[step.b as usize]),
                Operation::Unary(_) | Operation::Curve(_) | Operation::SinCos => a,
                Operation::Middle | Operation::Widened => a,
            };
            costs[stage].count(step.operation);
            stage_of[step.out as usize] = stage;
            if step.operation == Operation::SinCos {
                stage_of[step.b as usize] = stage;
            }
        }
        costs
    }
}
