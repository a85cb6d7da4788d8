//! Functions for the page, in JavaScript.

use flank_chain_dsl::Job;
use flank_expr::{Expr, Language, Signature, emit_values};

/// The functions that were emitted so far. All take the job's parameters behind their own arguments.
pub(super) struct Functions<'g> {
    parameters: Vec<Expr<'g>>,
    pub(super) text: String,
    pub(super) names: Vec<String>,
}

impl<'g> Functions<'g> {
    pub(super) fn of_job(job: &Job<'g>) -> Functions<'g> {
        let parameters = job.parameters.iter().map(|parameter| parameter.variable).collect();
        Functions { parameters, text: String::new(), names: Vec::new() }
    }

    /// Emits a function and gives back its name.
    pub(super) fn add(&mut self, what: &str, arguments: &[Expr<'g>], outputs: &[(&str, Expr<'g>)]) -> String {
        let name = format!("flank_{what}_{}", self.names.len());
        let arguments: Vec<Expr<'g>> = arguments.iter().chain(&self.parameters).copied().collect();
        let signature = Signature { name: &name, comment: &[] };
        let text = emit_values(Language::JavaScript, signature, &arguments, outputs)
            .expect("a job without errors leaves nothing unbound");
        self.text += &text;
        self.names.push(name.clone());
        name
    }
}
