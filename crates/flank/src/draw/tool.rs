//! A tool's surface where it stands at one moment, as its work sees it.

use flank_chain_dsl::{GeneratedSurface, Job, Process, ToolShape};
use flank_expr::{InstructionSet, LANES, LaneEvaluator, LaneTape, ScalarEvaluator, Tape, Varies};
use flank_solver::{Range, SectionPlane};

use crate::solve;

/// Cells of the grid that a tool is cut by a plane in: along its profile, and along its other parameter.
const CELLS: [usize; 2] = [64, 96];
/// Halvings that bring a point of the cut onto the plane.
const HALVINGS: usize = 40;

/// What a tool's two parameters run over while the motions stand still; the path of an edge takes its first motion as the second
/// parameter.
pub(super) struct Tool {
    /// Position and normal in the work's frame from the unknowns of the generated surface.
    tape: Tape,
    /// The position alone, where the motions are the same in all lanes.
    positions: LaneTape,
    ranges: [Range; 2],
}

impl Tool {
    /// # Errors
    /// In words, if nothing has two parameters while the motions stand still.
    pub(super) fn of_surface<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>) -> Result<Tool, String> {
        let (generation, name) = (&surface.generation, &surface.name);
        match &generation.tool {
            _ if generation.process == Process::Move || generation.motions.is_empty() => {
                return Err(format!("`{}` stands still while it makes `{name}`", generation.tool_name));
            }
            ToolShape::Surface(tool) if tool.given > 0 => {
                let tool = &generation.tool_name;
                return Err(format!("the tool of `{name}`, `{tool}`, is given by an equation, not by two parameters"));
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
        let surface = solve::bound(job, surface);
        let bound = surface.surface();
        let outputs: Vec<_> = bound.position.0.into_iter().chain(bound.normal.0).collect();
        let [tape, positions] = [&outputs[..], &bound.position.0]
            .map(|outputs| Tape::new(outputs, &bound.unknowns).expect("a job without errors leaves nothing unbound"));
        let varies = |k: usize| if k < 2 { Varies::Freely } else { Varies::ByRun };
        let varies: Vec<Varies> = (0..bound.unknowns.len()).map(varies).collect();
        let ranges = surface.ranges();
        Ok(Tool { tape, positions: LaneTape::with_inputs(&positions, &varies), ranges: [ranges[0], ranges[1]] })
    }

    /// Position and outward normal of the tool over an even grid; `rest` are the motions that stand still.
    pub(super) fn grid(&self, rest: &[f64], [rows, columns]: [usize; 2]) -> Vec<[[f64; 3]; 2]> {
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let mut inputs: Vec<f64> = [0.0; 2].into_iter().chain(rest.iter().copied()).collect();
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        (0..rows * columns)
            .map(|at| {
                inputs[..2]
                    .copy_from_slice(&self.parameters([share(at / columns, rows), share(at % columns, columns)]));
                let mut out = [0.0; 6];
                evaluator.run(&inputs, &mut out);
                // the work's normal is the tool's turned round
                [[out[0], out[1], out[2]], [-out[3], -out[4], -out[5]]]
            })
            .collect()
    }

    /// The two parameters at shares of both ranges.
    fn parameters(&self, shares: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.ranges[k].low + shares[k] * (self.ranges[k].high - self.ranges[k].low))
    }

    /// Where the tool meets a plane: short straight pieces with their ends on both, mm.
    pub(super) fn cut(&self, rest: &[f64], plane: &SectionPlane) -> Vec<[[f64; 3]; 2]> {
        let mut sheet = Sheet::new(self, rest);
        let [rows, columns] = CELLS;
        let share = |i: usize, j: usize| [i as f64 / rows as f64, j as f64 / columns as f64];
        let nodes: Vec<[f64; 2]> = (0..=rows).flat_map(|i| (0..=columns).map(move |j| share(i, j))).collect();
        let heights: Vec<f64> = sheet.at(&nodes).into_iter().map(|position| plane.height(position)).collect();
        let node = |i: usize, j: usize| (share(i, j), heights[i * (columns + 1) + j]);
        let mut crossings = Vec::new();
        for (i, j) in (1..=rows).flat_map(|i| (1..=columns).map(move |j| (i, j))) {
            let corners = [node(i - 1, j - 1), node(i - 1, j), node(i, j), node(i, j - 1)];
            let sides = (0..4).map(|k| Crossing { from: corners[k], to: corners[(k + 1) % 4] });
            let crossed: Vec<Crossing> = sides.filter(Crossing::is_one).collect();
            crossings.extend(crossed.chunks_exact(2).flatten());
        }
        sheet.crossed(&crossings, plane).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }
}

/// A side of a cell, by its ends as shares of both ranges with their heights over a plane.
#[derive(Clone, Copy)]
struct Crossing {
    from: ([f64; 2], f64),
    to: ([f64; 2], f64),
}

impl Crossing {
    /// Whether its ends lie on both sides of the plane.
    fn is_one(&self) -> bool {
        let (low, high) = (self.from.1, self.to.1);
        low.is_finite() && high.is_finite() && (low < 0.0) != (high < 0.0)
    }

    fn place(&self, share: f64) -> [f64; 2] {
        let (from, to) = (self.from.0, self.to.0);
        [0, 1].map(|k| from[k] + share * (to[k] - from[k]))
    }
}

/// The tool at one moment.
struct Sheet<'t> {
    tool: &'t Tool,
    lanes: LaneEvaluator<'t>,
}

impl<'t> Sheet<'t> {
    fn new(tool: &'t Tool, rest: &[f64]) -> Sheet<'t> {
        // machine code does not pay for so few
        let mut lanes = LaneEvaluator::new(&tool.positions, InstructionSet::widest());
        rest.iter().enumerate().for_each(|(k, value)| lanes.set_uniform(2 + k, *value));
        Sheet { tool, lanes }
    }

    /// Positions at shares of both ranges.
    fn at(&mut self, shares: &[[f64; 2]]) -> Vec<[f64; 3]> {
        let mut positions = Vec::with_capacity(shares.len());
        for block in shares.chunks(LANES) {
            for (lane, shares) in block.iter().enumerate() {
                let parameters = self.tool.parameters(*shares);
                (0..2).for_each(|k| self.lanes.input(k)[lane] = parameters[k]);
            }
            self.lanes.run_first(block.len());
            positions.extend((0..block.len()).map(|lane| [0, 1, 2].map(|k| self.lanes.output(k)[lane])));
        }
        positions
    }

    /// Where the plane lies between the ends of each crossing.
    fn crossed(&mut self, crossings: &[Crossing], plane: &SectionPlane) -> Vec<[f64; 3]> {
        let mut between = vec![[0.0, 1.0]; crossings.len()];
        for _ in 0..HALVINGS {
            let middle = |[near, far]: [f64; 2]| 0.5 * (near + far);
            let shares = crossings.iter().zip(&between).map(|(crossing, ends)| crossing.place(middle(*ends)));
            let positions = self.at(&shares.collect::<Vec<_>>());
            for ((crossing, ends), position) in crossings.iter().zip(&mut between).zip(positions) {
                let is_near = (plane.height(position) < 0.0) == (crossing.from.1 < 0.0);
                ends[usize::from(!is_near)] = middle(*ends);
            }
        }
        let shares = crossings.iter().zip(between).map(|(crossing, [near, _])| crossing.place(near));
        self.at(&shares.collect::<Vec<_>>())
    }
}
