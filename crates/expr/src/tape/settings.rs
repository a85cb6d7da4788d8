//! Settings of tapes: variables that get another number without the tape being laid out anew.

use crate::symbolic::graph::{Expr, Graph};
use crate::tape::{Instruction, Operation, Tape};

impl Graph {
    /// Calls something whose tapes take these variables for settings: numbers that a tape has from the beginning and that
    /// [`Tape::with_settings`] changes, without any other work. They are no inputs, and nothing of them is computed in advance.
    ///
    /// ```
    /// use flank_expr::{Graph, ScalarEvaluator, Tape};
    /// let graph = Graph::new();
    /// let (x, a) = (graph.variable("x"), graph.variable("a"));
    /// let tape = graph.with_settings(&[(a, 2.0)], || Tape::new(&[a * x + a], &[x])).expect("a is a setting");
    /// let mut out = [0.0];
    /// ScalarEvaluator::new(&tape).run(&[3.0], &mut out);
    /// assert_eq!(out, [8.0]);
    /// ScalarEvaluator::new(&tape.with_settings(&[5.0])).run(&[3.0], &mut out);
    /// assert_eq!(out, [20.0]);
    /// ```
    ///
    /// # Panics
    /// If one of them is no variable of this graph.
    pub fn with_settings<R>(&self, settings: &[(Expr<'_>, f64)], make: impl FnOnce() -> R) -> R {
        let settings = settings.iter().map(|(variable, value)| {
            self.assert_owns(*variable);
            assert!(variable.as_variable().is_some(), "a setting is a variable");
            (variable.id, *value)
        });
        let before = self.settings.replace(settings.collect());
        let made = make();
        self.settings.replace(before);
        made
    }
}

impl Tape {
    /// Whether its outputs depend on its settings.
    pub fn uses_settings(&self) -> bool {
        let settings = self.input_count..self.input_count + self.setting_count;
        let is_setting = |register: u32| settings.contains(&(register as usize));
        let reads = |step: &Instruction| match step.operation {
            Operation::Binary(_) | Operation::Settled | Operation::Widened => is_setting(step.a) || is_setting(step.b),
            Operation::Unary(_) | Operation::Curve(_) | Operation::Middle | Operation::SinCos => is_setting(step.a),
        };
        self.instructions.iter().any(reads) || self.outputs.iter().any(|output| is_setting(*output))
    }

    /// The same tape with other numbers for its settings, in the order in which they were named.
    ///
    /// A tape of nothing has none, whatever was named.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn with_settings(&self, values: &[f64]) -> Tape {
        let mut tape = self.clone();
        if tape.setting_count > 0 {
            tape.constants[..tape.setting_count].copy_from_slice(values);
        }
        tape
    }

    /// How many settings it has.
    pub fn setting_count(&self) -> usize {
        self.setting_count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tape::evaluate::ScalarEvaluator;
    use crate::tape::lanes::{InstructionSet, LaneEvaluator, LaneTape, Varies};

    /// One by one and in lanes of every kind, with machine code that was made before: the bits of a tape that has the numbers from
    /// the beginning, where nothing can be computed in advance.
    #[test]
    fn settings_are_as_good_as_inputs() {
        let graph = Graph::new();
        let [x, y, a, b] = ["x", "y", "a", "b"].map(|name| graph.variable(name));
        let outputs = [(a * x + b).sin() * y - (a * b).exp(), a.cos() / (x + b), b];
        let made = graph.with_settings(&[(a, 0.25), (b, -1.5)], || Tape::new(&outputs, &[x, y])).expect("settings");
        let known = Tape::new(&outputs, &[x, y, a, b]).expect("all are inputs");
        assert_eq!((made.input_count(), made.setting_count(), known.setting_count()), (2, 2, 0));
        let lanes = LaneTape::with_inputs(&made, &[Varies::Freely, Varies::Seldom]);
        for instructions in InstructionSet::available() {
            // what was made of it before is not made again
            lanes.translate(instructions);
            for values in [[0.25, -1.5], [0.5, 2.0], [-3.0, 0.125]] {
                let tape = made.with_settings(&values);
                let [mut one, mut other] = [[0.0; 3]; 2];
                ScalarEvaluator::new(&tape).run(&[0.7, 1.3], &mut one);
                ScalarEvaluator::new(&known).run(&[0.7, 1.3, values[0], values[1]], &mut other);
                assert_eq!(one.map(f64::to_bits), other.map(f64::to_bits));
                let lanes = lanes.with_settings(&values);
                let mut evaluator = LaneEvaluator::new(&lanes, instructions);
                evaluator.input(0).fill(0.7);
                evaluator.set_uniform(1, 1.3);
                evaluator.run();
                let in_lanes = [0, 1, 2].map(|k| evaluator.output(k)[3].to_bits());
                assert_eq!(in_lanes, other.map(f64::to_bits), "{instructions:?}");
            }
        }
    }
}
