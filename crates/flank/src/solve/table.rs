//! What `flank solve` tells of its work.

use std::fmt::Write;
use std::time::Instant;

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_export::{Field, fixed};
use flank_expr::Expr;
use flank_solver::{GridReport, SurfacePoint};
use serde_json::{Map, Value, json};

use crate::project::failure::not_done;
use crate::project::units;
use crate::solve::branches;
use crate::solve::certify;
use crate::solve::cut;
use crate::solve::cut::Cut;
use crate::solve::fields;
use crate::solve::limits::Line;
use crate::solve::reach::Needed;
use crate::solve::reasons;
use crate::solve::required;
use crate::solve::secondary::{self, Positions};
use crate::solve::sensitivity::{self, Sensitivity};
use crate::solve::step::{self, Smooth};
use crate::solve::stream::Streamed;
use crate::solve::summary::{Ends, Summary};

/// One surface with its points.
pub(crate) struct Solved<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    pub(crate) sample: &'j Sample<'g>,
    /// The job's parameters with their values.
    pub(crate) bindings: Vec<(Expr<'g>, Expr<'g>)>,
    /// Ranges that would reach the points that are outside.
    pub(crate) needed: Vec<Needed>,
    /// What is told of its points.
    pub(crate) summary: Summary,
    /// All of them; some for a picture if there are too many to keep.
    pub(crate) points: Vec<SurfacePoint>,
    /// The sample's rows and columns that these points stand in.
    pub(crate) lines: [Vec<usize>; 2],
    /// What hands over the points if they are too many to keep.
    pub(crate) streamed: Option<Streamed<'j, 'g>>,
    pub(crate) effort: GridReport,
    /// Where it meets the surfaces that trim it, in their order.
    pub(crate) trims: Vec<Line<'j, 'g>>,
    /// Which positions of its tool its points were held against.
    pub(crate) positions: Positions,
    /// Where each of the branches at the anchor is.
    pub(crate) branches: Vec<SurfacePoint>,
    /// Branches that have points at other places, each with the point of its own branch there if that has one.
    pub(crate) elsewhere: Vec<(SurfacePoint, Option<SurfacePoint>)>,
    /// Where nothing was found: the branches there that the sample's `keep` does not take.
    pub(crate) kept_out: Vec<SurfacePoint>,
    /// How near exactly one root is proven to each point, mm, if that was asked for.
    pub(crate) radii: Option<Vec<Option<f64>>>,
    /// What more is known of these points; files show it after the status. What is known of each point of a streamed surface it has itself.
    pub(crate) fields: Vec<Field>,
    pub(crate) sensitivity: Option<Sensitivity>,
    /// What the single edges leave, if the job says which.
    pub(crate) cut: Option<Cut>,
}

/// A job's surfaces.
pub(crate) struct Table<'a, 'j, 'g> {
    pub(crate) job: &'a Job<'g>,
    pub(crate) spec: String,
    pub(crate) solved: &'a [Solved<'j, 'g>],
    pub(crate) lines: &'a [&'a Line<'j, 'g>],
    /// Of a STEP file, if one was asked for.
    pub(crate) faces: &'a [Smooth],
    pub(crate) written: Vec<String>,
    pub(crate) since: Instant,
}

/// Something that was reached: its name, unit, smallest and largest value.
pub(crate) struct Reached {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) ends: Option<(f64, f64)>,
}

/// One row of the table, whatever it is of.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a, 'g> {
    pub(crate) name: &'a str,
    surface: &'a GeneratedSurface<'g>,
    summary: &'a Summary,
}

impl Row<'_, '_> {
    /// Radius and z in the work's frame, then the unknowns.
    pub(crate) fn reached(&self) -> Vec<Reached> {
        let length = |name: &str, ends: Ends| Reached { name: name.to_string(), unit: "mm", ends: ends.0 };
        let mut all = vec![length("rho", self.summary.rho), length("z", self.summary.z)];
        for (unknown, ends) in self.surface.unknowns.iter().zip(&self.summary.unknowns) {
            let shown = |x: f64| units::shown(unknown.dimension, x);
            all.push(Reached {
                name: unknown.name.clone(),
                unit: units::symbol(unknown.dimension),
                ends: ends.0.map(|(low, high)| (shown(low), shown(high))),
            });
        }
        all
    }

    /// Cells of the table, two ranges to a line.
    fn cells(&self) -> Vec<[String; 5]> {
        let residual = self.summary.worst_residual.map_or("-".to_string(), |worst| format!("{worst:.1e}"));
        let solved = self.summary.solved();
        let mut first = [self.name.to_string(), self.summary.asked.to_string(), solved.to_string(), residual];
        if solved == 0 {
            let [name, asked, found, worst] = first;
            return vec![[name, asked, found, worst, none(self.surface, self.summary)]];
        }
        let reached = self.reached();
        let lines = reached.chunks(2).map(|pair| {
            let reached: Vec<String> = pair.iter().map(Reached::text).collect();
            let [name, asked, found, worst] = std::mem::take(&mut first);
            [name, asked, found, worst, reached.join("   ")]
        });
        lines.collect()
    }

    pub(crate) fn json(&self) -> Map<String, Value> {
        let reached: Vec<Value> = self
            .reached()
            .iter()
            .map(|reached| {
                let (low, high) = reached.ends.unzip();
                json!({ "name": reached.name, "unit": reached.unit, "low": low, "high": high })
            })
            .collect();
        let entries = [
            ("name", json!(self.name)),
            ("frame", json!(self.surface.frame)),
            ("asked", json!(self.summary.asked)),
            ("solved", json!(self.summary.solved())),
            ("outcomes", json!(self.summary.outcomes)),
            ("worst_residual", json!(self.summary.worst_residual)),
            ("ranges_reached", json!(reached)),
        ];
        entries.map(|(key, value)| (key.to_string(), value)).into_iter().collect()
    }
}

/// What has become of points none of which is solved.
fn none(surface: &GeneratedSurface<'_>, summary: &Summary) -> String {
    let outcomes: Vec<(&&str, &usize)> = summary.outcomes.iter().collect();
    let by = reasons::outside(surface, summary);
    match outcomes[..] {
        [] | [(&"out_of_range", _)] => {
            format!("none within the ranges{}", by.map_or(String::new(), |by| format!(": outside, {by}")))
        }
        [(word, _)] => format!("none: {word}"),
        _ => {
            let each: Vec<String> = outcomes.iter().map(|(word, count)| format!("{count} {word}")).collect();
            format!("none: {}{}", each.join(", "), by.map_or(String::new(), |by| format!("; {by}")))
        }
    }
}

impl<'g> Solved<'_, 'g> {
    /// Rows and columns of its points.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.lines[k].len())
    }

    /// Where one of its points stands in the sample: row and column.
    pub(crate) fn place(&self, at: usize) -> [usize; 2] {
        let columns = self.lines[1].len();
        [self.lines[0][at / columns], self.lines[1][at % columns]]
    }

    pub(crate) fn row(&self) -> Row<'_, 'g> {
        Row { name: &self.surface.name, surface: self.surface, summary: &self.summary }
    }
}

impl<'g> Line<'_, 'g> {
    pub(crate) fn row(&self) -> Row<'_, 'g> {
        Row { name: &self.name, surface: self.surface, summary: &self.summary }
    }
}

impl Table<'_, '_, '_> {
    pub(crate) fn text(&self) -> String {
        let mut out = format!("job {} ({})\n\n", self.job.name, self.spec);
        let mut rows = vec![["surface", "asked", "solved", "worst residual", "ranges reached"].map(String::from)];
        let all = self.solved.iter().map(Solved::row).chain(self.lines.iter().map(|line| line.row()));
        rows.extend(all.flat_map(|row| row.cells()));
        out.push_str(&aligned(&rows, "<>>>"));
        out.push_str(&fields::text(self.solved));
        out.push_str(&sensitivity::text(self.solved));
        out.push_str(&certify::text(self.solved));
        let _ = writeln!(out, "\nwrote {}", self.written.join(", "));
        out
    }

    /// What differs from run to run.
    pub(crate) fn time(&self) -> String {
        let points: usize = self.solved.iter().map(|solved| solved.summary.asked).sum();
        format!("{} in {:.0} ms", units::counted(points, "point"), self.since.elapsed().as_secs_f64() * 1e3)
    }

    /// With what was not done, as told.
    pub(crate) fn json(&self, told: &str) -> Value {
        let surfaces: Vec<Value> = self.solved.iter().map(surface_json).collect();
        json!({
            "schema": "flank.solve/3",
            "job": self.job.name,
            "spec": self.spec,
            "surfaces": surfaces,
            "lines": self.lines.iter().map(|line| line.row().json()).collect::<Vec<_>>(),
            "faces": step::json(self.faces),
            "files": self.written,
            "not_done": not_done(told),
        })
    }
}

/// What was not done of points: branches that nothing chooses between, requirements that do not hold, points that are not solved;
/// empty if all is well.
pub(crate) fn failures(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> String {
    branches::ambiguous(solved) + &required::text(solved) + &unsolved(job, solved)
}

/// What was asked for and not solved, in words; empty if nothing.
fn unsolved(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> String {
    let mut out = String::new();
    for solved in solved {
        let asked = solved.summary.asked;
        let missing = asked - solved.summary.solved();
        if missing > 0 {
            let _ = writeln!(out, "not solved: {missing} of {asked} points of {}", solved.surface.name);
            reasons::counted(job, solved).iter().for_each(|reason| {
                let _ = writeln!(out, "  {reason}");
            });
        }
    }
    out
}

/// Rows with their cells below each other, all to the left but those whose place in `sides` holds a `>`.
pub(crate) fn aligned<const N: usize>(rows: &[[String; N]], sides: &str) -> String {
    let widths: [usize; N] = std::array::from_fn(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0));
    let cell = |k: usize, text: &str| match sides.as_bytes().get(k) {
        Some(b'>') => format!("  {text:>0$}", widths[k]),
        _ => format!("  {text:<0$}", widths[k]),
    };
    let line = |row: &[String; N]| (0..N).map(|k| cell(k, &row[k])).collect::<String>();
    rows.iter().map(|row| line(row).trim_end().to_string() + "\n").collect()
}

impl Reached {
    fn text(&self) -> String {
        match self.ends {
            Some((low, high)) => {
                let [low, high] = [low, high].map(|x| fixed(x, 4));
                format!("{} {low} .. {high} {}", self.name, self.unit).trim_end().to_string()
            }
            None => self.name.clone(),
        }
    }
}

/// All that is told of a surface as data.
pub(crate) fn surface_json(solved: &Solved<'_, '_>) -> Value {
    let mut entries = solved.row().json();
    entries.insert("evaluations".to_string(), json!(solved.effort.evaluations));
    entries.insert("fields".to_string(), fields::json(solved));
    entries.insert("cut".to_string(), cut::json(solved));
    entries.insert("sensitivity".to_string(), sensitivity::json(solved));
    entries.insert("branches".to_string(), branches::json(solved));
    entries.insert("positions".to_string(), secondary::json(solved));
    entries.insert("not_as_required".to_string(), required::json(solved));
    Value::Object(entries)
}
