//! A tool's surface where it stands at one moment, as its work sees it.

use flank_chain_dsl::{GeneratedSurface, Job, Process, ToolShape};
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::Range;

use super::maps::dot;
use crate::solve::ranges;

/// Cells of the grid that a tool is cut by a plane in: along its profile, and along its other parameter.
const CELLS: [usize; 2] = [64, 96];
/// Halvings that bring a point of the cut onto the plane.
const HALVINGS: usize = 40;

/// What a tool's two parameters run over while the motions stand still; the path of an edge takes its first motion as the second
/// parameter.
pub(super) struct Tool {
    /// Position and normal in the work's frame from the unknowns of the generated surface.
    tape: Tape,
    ranges: [Range; 2],
}

/// A plane by one of its points and its unit normal.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) point: [f64; 3],
    pub(super) normal: [f64; 3],
}

impl Plane {
    pub(super) fn height(&self, at: [f64; 3]) -> f64 {
        dot(self.normal, [0, 1, 2].map(|k| at[k] - self.point[k]))
    }
}

impl Tool {
    /// # Errors
    /// In words, if nothing has two parameters while the motions stand still.
    pub(super) fn of<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>) -> Result<Tool, String> {
        let (generation, name) = (&surface.generation, &surface.name);
        match &generation.tool {
            _ if generation.process == Process::Move || generation.motions.is_empty() => {
                return Err(format!("`{}` stands still while it makes `{name}`", generation.tool_name));
            }
            ToolShape::Surface(tool) if !tool.constraints.is_empty() => {
                return Err(format!("the tool of `{name}`, `{}`, is an envelope itself", generation.tool_name));
            }
            ToolShape::Edge(_) if generation.motions.len() < 2 => {
                return Err(format!(
                    "`{name}` is the path of an edge over one motion: at one moment the tool is a line"
                ));
            }
            ToolShape::Surface(_) | ToolShape::Edge(_) => {}
        }
        let bound = surface.surface.bound(&job.bindings());
        let outputs: Vec<_> = bound.position.0.into_iter().chain(bound.normal.0).collect();
        let tape = Tape::new(&outputs, &bound.unknowns).expect("a job without errors leaves nothing unbound");
        let ranges = ranges(surface);
        Ok(Tool { tape, ranges: [ranges[0], ranges[1]] })
    }

    /// Position and outward normal of the tool over an even grid; `rest` are the motions that stand still.
    pub(super) fn grid(&self, rest: &[f64], [rows, columns]: [usize; 2]) -> Vec<[[f64; 3]; 2]> {
        let mut sheet = Sheet::new(self, rest);
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        (0..rows * columns)
            .map(|at| {
                let [position, normal] = sheet.at([share(at / columns, rows), share(at % columns, columns)]);
                // the work's normal is the tool's turned round
                [position, normal.map(|x| -x)]
            })
            .collect()
    }

    /// Where the tool meets a plane: short straight pieces with their ends on both, mm.
    pub(super) fn cut(&self, rest: &[f64], plane: &Plane) -> Vec<[[f64; 3]; 2]> {
        let mut sheet = Sheet::new(self, rest);
        let [rows, columns] = CELLS;
        let share = |i: usize, j: usize| [i as f64 / rows as f64, j as f64 / columns as f64];
        let height = |sheet: &mut Sheet<'_>, i: usize, j: usize| plane.height(sheet.at(share(i, j))[0]);
        let mut above: Vec<f64> = (0..=columns).map(|j| height(&mut sheet, 0, j)).collect();
        let mut pieces = Vec::new();
        for i in 1..=rows {
            let below: Vec<f64> = (0..=columns).map(|j| height(&mut sheet, i, j)).collect();
            for j in 1..=columns {
                let corners = [
                    (share(i - 1, j - 1), above[j - 1]),
                    (share(i - 1, j), above[j]),
                    (share(i, j), below[j]),
                    (share(i, j - 1), below[j - 1]),
                ];
                let ends: Vec<[f64; 3]> =
                    (0..4).filter_map(|k| sheet.crossing(plane, corners[k], corners[(k + 1) % 4])).collect();
                pieces.extend(ends.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
            }
            above = below;
        }
        pieces
    }
}

/// The tool at one moment.
struct Sheet<'t> {
    evaluator: ScalarEvaluator<'t>,
    ranges: [Range; 2],
    inputs: Vec<f64>,
}

impl<'t> Sheet<'t> {
    fn new(tool: &'t Tool, rest: &[f64]) -> Sheet<'t> {
        let inputs = [0.0; 2].into_iter().chain(rest.iter().copied()).collect();
        Sheet { evaluator: ScalarEvaluator::new(&tool.tape), ranges: tool.ranges, inputs }
    }

    /// Position and normal at shares of both ranges.
    fn at(&mut self, shares: [f64; 2]) -> [[f64; 3]; 2] {
        for ((input, range), share) in self.inputs.iter_mut().zip(self.ranges).zip(shares) {
            *input = range.low + share * (range.high - range.low);
        }
        let mut out = [0.0; 6];
        self.evaluator.run(&self.inputs, &mut out);
        [[out[0], out[1], out[2]], [out[3], out[4], out[5]]]
    }

    /// Where the plane lies between two places with heights of both signs.
    fn crossing(
        &mut self,
        plane: &Plane,
        (from, low): ([f64; 2], f64),
        (to, high): ([f64; 2], f64),
    ) -> Option<[f64; 3]> {
        if !(low.is_finite() && high.is_finite()) || (low < 0.0) == (high < 0.0) {
            return None;
        }
        let place = |share: f64| [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            let side = plane.height(self.at(place(middle))[0]) < 0.0;
            if side == (low < 0.0) { near = middle } else { far = middle }
        }
        Some(self.at(place(near))[0])
    }
}
