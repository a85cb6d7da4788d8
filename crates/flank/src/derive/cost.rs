//! `flank derive --cost`

use std::fmt::Write;

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::{Cost, Expr};
use flank_solver::System;
use serde_json::{Value, json};

/// How often each of the three stages is done.
const STAGES: [&str; 3] = ["per spec", "per motion value", "per point"];

/// Operations of residuals with Jacobian at a point of a surface.
pub(crate) struct SurfaceCost<'j> {
    name: &'j str,
    residuals: usize,
    stages: [Cost; 3],
}

impl<'j> SurfaceCost<'j> {
    /// None if no points are asked for.
    pub(crate) fn of(job: &Job<'_>, surface: &'j GeneratedSurface<'_>) -> Option<SurfaceCost<'j>> {
        let sample = surface.sample.as_ref()?;
        let parts = &surface.surface;
        let graph = sample.coordinates[0].value.graph();
        let targets = [graph.variable("target 1"), graph.variable("target 2")];
        let on_target = sample.coordinates.iter().zip(targets).map(|(coordinate, target)| coordinate.value - target);
        let residuals: Vec<Expr<'_>> = parts.constraints.iter().copied().chain(on_target).collect();
        let is_motion = |unknown: &Expr<'_>| job.motions.iter().any(|motion| motion.variable == *unknown);
        let stages = parts.unknowns.iter().map(|unknown| if is_motion(unknown) { 1 } else { 2 }).chain([2, 2]);

        let settings: Vec<Expr<'_>> = job.parameters.iter().map(|parameter| parameter.variable).collect();
        let inputs: Vec<Expr<'_>> = targets.into_iter().chain(settings.iter().copied()).collect();
        let open = System::new(&residuals, &parts.unknowns, &inputs).ok()?;
        let of_spec = open.tape().cost(&stages.clone().chain(settings.iter().map(|_| 0)).collect::<Vec<usize>>())[0];

        let bound = graph.substitute(&residuals, &job.bindings());
        let system = System::new(&bound, &parts.unknowns, &targets).ok()?;
        let costs = system.tape().cost(&stages.collect::<Vec<usize>>());
        Some(SurfaceCost { name: &surface.name, residuals: residuals.len(), stages: [of_spec, costs[1], costs[2]] })
    }

    /// A table: a line for each stage.
    pub(crate) fn text(&self) -> String {
        let n = self.residuals;
        let mut out = format!("surface {}: {n} equations with their {n} x {n} Jacobian\n", self.name);
        let _ = writeln!(
            out,
            "  {:<17} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6}",
            "", "+ -", "*", "/", "sqrt", "sincos", "other"
        );
        for (stage, cost) in STAGES.iter().zip(&self.stages) {
            let Cost { additions, multiplications, divisions, roots, sincos, others } = cost;
            let _ = writeln!(
                out,
                "  {stage:<17} {additions:>6} {multiplications:>6} {divisions:>6} {roots:>6} {sincos:>7} {others:>6}"
            );
        }
        out
    }

    pub(crate) fn json(&self) -> Value {
        let stage = |cost: &Cost| {
            json!({
                "additions": cost.additions,
                "multiplications": cost.multiplications,
                "divisions": cost.divisions,
                "square_roots": cost.roots,
                "sincos": cost.sincos,
                "others": cost.others,
            })
        };
        json!({
            "name": self.name,
            "equations": self.residuals,
            "per_spec": stage(&self.stages[0]),
            "per_motion_value": stage(&self.stages[1]),
            "per_point": stage(&self.stages[2]),
        })
    }
}
