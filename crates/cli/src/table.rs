//! What `flank solve` tells of its work.

use std::fmt::Write;
use std::time::Instant;

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_export::Field;
use flank_expr::Expr;
use flank_solver::{Effort, Outcome, SurfacePoint};
use serde_json::{Map, Value, json};

use crate::cut::Cut;
use crate::failure::not_done;
use crate::limits::Line;
use crate::reach::Needed;
use crate::sensitivity::{self, Sensitivity};
use crate::{branches, certify, cut, fields, reasons, required, units};

/// One surface with its points.
pub(crate) struct Solved<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    pub(crate) sample: &'j Sample<'g>,
    /// The job's parameters with their values.
    pub(crate) bindings: Vec<(Expr<'g>, Expr<'g>)>,
    pub(crate) points: Vec<SurfacePoint>,
    /// Ranges that would reach the points that are outside.
    pub(crate) needed: Vec<Needed>,
    pub(crate) effort: Effort,
    /// Where it meets the surfaces that trim it, in their order.
    pub(crate) trims: Vec<Line<'j, 'g>>,
    /// Where each of the branches at the anchor is.
    pub(crate) branches: Vec<SurfacePoint>,
    /// How near exactly one root is proven to each point, mm, if that was asked for.
    pub(crate) radii: Option<Vec<Option<f64>>>,
    /// What more is known of the points; files show it after the status.
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
    pub(crate) written: Vec<String>,
    pub(crate) since: Instant,
}

/// Something that was reached: its name, unit, smallest and largest value.
struct Reached {
    name: String,
    unit: &'static str,
    ends: Option<(f64, f64)>,
}

/// The points of one row of the table, whatever they are points of.
#[derive(Clone, Copy)]
struct Row<'a, 'g> {
    name: &'a str,
    surface: &'a GeneratedSurface<'g>,
    points: &'a [SurfacePoint],
}

impl Row<'_, '_> {
    fn count(&self) -> usize {
        self.roots().count()
    }

    fn roots(&self) -> impl Iterator<Item = &SurfacePoint> {
        self.points.iter().filter(|point| point.outcome == Outcome::Solved)
    }

    fn worst_residual(&self) -> Option<f64> {
        self.roots().map(|point| point.residual).reduce(f64::max)
    }

    /// Radius and z in the work's frame, then the unknowns.
    fn reached(&self) -> Vec<Reached> {
        let of = |name: &str, unit: &'static str, value: &dyn Fn(&SurfacePoint) -> f64| {
            let ends = self.roots().map(value).fold(None, |ends: Option<(f64, f64)>, x| {
                Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
            });
            Reached { name: name.to_string(), unit, ends }
        };
        let mut all = vec![
            of("rho", "mm", &|point| point.position[0].hypot(point.position[1])),
            of("z", "mm", &|point| point.position[2]),
        ];
        for (k, unknown) in self.surface.unknowns.iter().enumerate() {
            let unit = units::symbol(unknown.dimension);
            all.push(of(&unknown.name, unit, &|point| units::shown(unknown.dimension, point.unknowns[k])));
        }
        all
    }

    /// Cells of the table, two ranges to a line.
    fn cells(&self) -> Vec<[String; 5]> {
        let residual = self.worst_residual().map_or("-".to_string(), |worst| format!("{worst:.1e}"));
        let mut first = [self.name.to_string(), self.points.len().to_string(), self.count().to_string(), residual];
        if self.count() == 0 {
            let [name, asked, found, worst] = first;
            return vec![[name, asked, found, worst, "none within the ranges".to_string()]];
        }
        let reached = self.reached();
        let lines = reached.chunks(2).map(|pair| {
            let reached: Vec<String> = pair.iter().map(Reached::text).collect();
            let [name, asked, found, worst] = std::mem::take(&mut first);
            [name, asked, found, worst, reached.join("   ")]
        });
        lines.collect()
    }

    fn json(&self) -> Map<String, Value> {
        let mut outcomes = Map::new();
        for point in self.points {
            let count = outcomes.entry(point.outcome.word()).or_insert(json!(0));
            *count = json!(count.as_u64().unwrap_or(0) + 1);
        }
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
            ("asked", json!(self.points.len())),
            ("solved", json!(self.count())),
            ("outcomes", Value::Object(outcomes)),
            ("worst_residual", json!(self.worst_residual())),
            ("ranges_reached", json!(reached)),
        ];
        entries.map(|(key, value)| (key.to_string(), value)).into_iter().collect()
    }
}

impl<'g> Solved<'_, 'g> {
    fn row(&self) -> Row<'_, 'g> {
        Row { name: &self.surface.name, surface: self.surface, points: &self.points }
    }
}

impl<'g> Line<'_, 'g> {
    fn row(&self) -> Row<'_, 'g> {
        Row { name: &self.name, surface: self.surface, points: &self.points }
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
        let points: usize = self.solved.iter().map(|solved| solved.points.len()).sum();
        format!("{points} points in {:.0} ms", self.since.elapsed().as_secs_f64() * 1e3)
    }

    /// With what was not done, as told.
    pub(crate) fn json(&self, told: &str) -> String {
        let surfaces: Vec<Value> = self.solved.iter().map(surface_json).collect();
        let table = json!({
            "schema": "flank.solve/2",
            "job": self.job.name,
            "spec": self.spec,
            "surfaces": surfaces,
            "lines": self.lines.iter().map(|line| line.row().json()).collect::<Vec<_>>(),
            "files": self.written,
            "not_done": not_done(told),
        });
        format!("{table:#}\n")
    }
}

/// What was asked for and not solved, in words; empty if nothing.
pub(crate) fn unsolved(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> String {
    let mut out = String::new();
    for solved in solved {
        let asked = solved.points.len();
        let missing = asked - solved.row().count();
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
            Some((low, high)) => format!("{} {low:.4} .. {high:.4} {}", self.name, self.unit).trim_end().to_string(),
            None => self.name.clone(),
        }
    }
}

fn surface_json(solved: &Solved<'_, '_>) -> Value {
    let mut entries = solved.row().json();
    entries.insert("evaluations".to_string(), json!(solved.effort.evaluations));
    entries.insert("fields".to_string(), fields::json(solved));
    entries.insert("cut".to_string(), cut::json(solved));
    entries.insert("sensitivity".to_string(), sensitivity::json(solved));
    entries.insert("branches".to_string(), branches::json(solved));
    entries.insert("not_as_required".to_string(), required::json(solved));
    Value::Object(entries)
}
