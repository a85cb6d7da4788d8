//! Which parameters of a job decide numbers of it that are no functions of them.

use std::collections::HashSet;

use flank_expr::Expr;

use crate::model::Job;
use crate::values::context::Context;

/// Their names: a job that is built again for splines through its own points has other variables.
#[derive(Default)]
pub(super) struct Decisive {
    names: HashSet<String>,
}

impl Decisive {
    /// Takes what has decided something of a job as it was built, and what that is made of.
    pub(super) fn add<'g>(&mut self, context: &Context<'g>, built: &Job<'g>) {
        // a setting comes after what it is made of
        for parameter in built.parameters.iter().rev().filter(|of| context.is_decisive(of.variable)) {
            context.variables_of(&[parameter.definition]).into_iter().for_each(|variable| context.decides(variable));
            self.names.insert(parameter.name.clone());
        }
    }

    /// Those of a job, in its order.
    pub(super) fn of<'g>(&self, built: &Job<'g>) -> Vec<Expr<'g>> {
        let all = built.parameters.iter().filter(|of| self.names.contains(&of.name));
        all.map(|of| of.variable).collect()
    }
}
