//! What solves the points of a grid: with unknowns in closed form, as far as these lead to its roots.

use flank_expr::InstructionSet;

use crate::equations::solution::Range;
use crate::equations::system::System;
use crate::newton::batch::LaneNewton;

pub(crate) struct Solvers<'s> {
    system: &'s System,
    ranges: &'s [Range],
    /// Without closed forms.
    pub(crate) careful: LaneNewton<'s>,
    given: Option<LaneNewton<'s>>,
}

impl<'s> Solvers<'s> {
    /// Without closed forms.
    pub(crate) fn new(system: &'s System, ranges: &'s [Range]) -> Solvers<'s> {
        Solvers { system, ranges, careful: LaneNewton::new(system, ranges), given: None }
    }

    /// With closed forms if they lead to a root. An equation that hardly depends on an unknown does not give it.
    pub(crate) fn decide(&mut self, root: &[f64], targets: &[f64; 2]) {
        let instructions = self.system.instructions();
        let given = self.given.take().or_else(|| LaneNewton::with_given(self.system, self.ranges, instructions));
        self.given = given.and_then(|mut given| given.leads_to(root, targets).then_some(given));
    }

    /// The fastest for any points.
    pub(crate) fn newton(&mut self) -> &mut LaneNewton<'s> {
        self.given.as_mut().unwrap_or(&mut self.careful)
    }

    /// Makes others like that, for further threads or with other instructions.
    pub(crate) fn another(&self, instructions: InstructionSet) -> impl Fn() -> LaneNewton<'s> + use<'s> {
        let (system, ranges, has_given) = (self.system, self.ranges, self.given.is_some());
        let given = move || LaneNewton::with_given(system, ranges, instructions).filter(|_| has_given);
        move || given().unwrap_or_else(|| LaneNewton::on(system, ranges, instructions))
    }
}
