//! What `flank derive` prints.

use std::fmt::{self, Write};

use flank_expr::Cost;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::remark::NotDone;

/// What was built, or what it costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DeriveResult {
    /// The derivation of each job, or the closed form of one on another machine.
    Derivation(Derivation),
    /// How many operations points take.
    Cost(CostTable),
}

/// What was built from a job, stage by stage, of `flank derive`. Lengths are mm, angles rad unless a unit stands by them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.derivation/2")]
pub struct Derivation {
    /// How formulas are written.
    pub style: FormulaStyle,
    /// In the order of the spec.
    pub jobs: Vec<DerivationPage>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// A way to write formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FormulaStyle {
    /// Plain text.
    Text,
    /// LaTeX.
    Latex,
}

/// The derivation of one job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct DerivationPage {
    /// The job of the spec.
    pub job: String,
    /// The whole derivation in that style.
    pub page: String,
}

/// How many operations the equations of a point take with their Jacobian, of `flank derive --cost`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.cost/2")]
pub struct CostTable {
    /// In the order of the spec.
    pub jobs: Vec<JobCost>,
}

/// What the points of a job take.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct JobCost {
    /// The job of the spec.
    pub job: String,
    /// Those that are sampled.
    pub surfaces: Vec<SurfaceCost>,
}

/// Operations of residuals with Jacobian at a point of a surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SurfaceCost {
    /// Of the surface.
    pub name: String,
    /// How many are solved together.
    pub equations: usize,
    /// What is done once.
    pub per_spec: Operations,
    /// What is done for each value of the motions.
    pub per_motion_value: Operations,
    /// What is done for each point.
    pub per_point: Operations,
}

/// Numbers of operations.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Operations {
    /// Sums and differences.
    pub additions: usize,
    /// Products.
    pub multiplications: usize,
    /// Quotients.
    pub divisions: usize,
    /// Square roots.
    pub square_roots: usize,
    /// Sines and cosines; both of one angle count once.
    pub sincos: usize,
    /// All others.
    pub others: usize,
}

impl From<&Cost> for Operations {
    fn from(cost: &Cost) -> Operations {
        Operations {
            additions: cost.additions,
            multiplications: cost.multiplications,
            divisions: cost.divisions,
            square_roots: cost.roots,
            sincos: cost.sincos,
            others: cost.others,
        }
    }
}

impl Answer for DeriveResult {
    fn not_done(&self) -> &[NotDone] {
        match self {
            DeriveResult::Derivation(derivation) => &derivation.not_done,
            DeriveResult::Cost(_) => &[],
        }
    }
}

impl fmt::Display for DeriveResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DeriveResult::Derivation(derivation) => derivation.jobs.iter().try_for_each(|job| f.write_str(&job.page)),
            DeriveResult::Cost(costs) => costs.jobs.iter().try_for_each(|job| {
                writeln!(f, "job {}", job.job)?;
                job.surfaces.iter().try_for_each(|surface| write!(f, "\n{surface}"))
            }),
        }
    }
}

/// A table: a line for each stage.
impl fmt::Display for SurfaceCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = self.equations;
        writeln!(f, "surface {}: {n} equations with their {n} x {n} Jacobian", self.name)?;
        let head = ["", "+ -", "*", "/", "sqrt", "sincos", "other"];
        f.write_str(&row(head))?;
        let stages = [
            ("per spec", &self.per_spec),
            ("per motion value", &self.per_motion_value),
            ("per point", &self.per_point),
        ];
        stages.into_iter().try_for_each(|(stage, of)| {
            let counts = [of.additions, of.multiplications, of.divisions, of.square_roots, of.sincos, of.others];
            let [a, b, c, d, e, g] = counts.map(|count| count.to_string());
            f.write_str(&row([stage, &a, &b, &c, &d, &e, &g]))
        })
    }
}

fn row([stage, additions, multiplications, divisions, roots, sincos, others]: [&str; 7]) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "  {stage:<17} {additions:>6} {multiplications:>6} {divisions:>6} {roots:>6} {sincos:>7} {others:>6}"
    );
    out
}
