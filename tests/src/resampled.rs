//! The samples of shipped specs with other numbers of points, as problems for the solver.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, SampleGrid, compile_text};
use flank_expr::Graph;
use flank_solver::{BoundSurface, GridReport, Range, SurfacePoints, SurfaceProblem};

use crate::{jobs, shipped};

/// A surface that points are asked for of.
pub struct Resampled {
    /// `SPEC:JOB.SURFACE`.
    pub name: String,
    /// The problem as `flank solve` poses it.
    pub problem: SurfaceProblem,
    /// The points that are asked for, row by row.
    pub targets: Vec<[f64; 2]>,
    /// Rows and columns.
    pub counts: [usize; 2],
    /// Instructions of the tape of residuals and Jacobian.
    pub instructions: usize,
}

impl Resampled {
    /// A sample with `side` rows and columns between its own ends. A line gets as many points as that has in all, points that are
    /// listed one by one stay what they are; `None` where no points are asked for.
    fn new(spec: &str, job: &Job<'_>, surface: &GeneratedSurface<'_>, side: usize) -> Option<Resampled> {
        let sample = surface.sample.as_ref()?;
        let coordinates = sample.functions();
        let ranges = surface.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect();
        let bound = BoundSurface::new(&surface.surface, ranges, &job.bindings());
        let beyond = surface.unknowns.iter().zip(bound.ranges()).map(|(unknown, range)| match unknown.is_count {
            true => *range,
            false => range.beyond(if unknown.dimension == Dimension::ANGLE { std::f64::consts::TAU } else { 0.0 }),
        });
        let keep = sample.keep.iter().map(|(of, (low, high))| (of.value, Range { low: *low, high: *high }));
        let problem = SurfaceProblem::new(&bound, coordinates)
            .expect("all bound")
            .following_beyond(beyond.collect())
            .keeping(&bound, &keep.collect::<Vec<_>>())
            .expect("all bound");
        let counts = match (&sample.grid, sample.counts) {
            (SampleGrid::Points(_), counts) => counts,
            (_, [1, 1]) => [1, 1],
            (_, [1, _]) => [1, side * side],
            (_, [_, 1]) => [side * side, 1],
            _ => [side, side],
        };
        let grid = resampled(&sample.grid, counts);
        let (rows, columns) = (0..counts[0], 0..counts[1]);
        Some(Resampled {
            name: format!("{spec}:{}.{}", job.name, surface.name),
            instructions: problem.system().tape().instructions().len(),
            problem,
            targets: rows
                .flat_map(|row| columns.clone().map(move |column| (row, column)))
                .map(|(i, j)| grid.at(i, j))
                .collect(),
            counts,
        })
    }

    /// The flank of the common job.
    ///
    /// # Panics
    /// If its text is wrong.
    pub fn common(side: usize) -> Resampled {
        let graph = Graph::new();
        let compilation = compile_text(&graph, "spiral_bevel", include_str!("../../benches/spiral_bevel.chain"), &[]);
        let job = &compilation.jobs[0];
        Resampled::new("benches/spiral_bevel.chain", job, &job.surfaces[0], side).expect("it asks for points")
    }

    /// Solves all of its points without a start, as `flank solve` does. `memory` is that of points that are not needed any more.
    pub fn solve(&self, memory: Option<SurfacePoints>) -> (SurfacePoints, GridReport) {
        self.problem.solve_points(&self.targets, self.counts, None, memory)
    }

    /// Surfaces of the shipped specs, those that `is_meant` takes by the paths of the specs.
    ///
    /// # Panics
    /// If a spec is wrong.
    pub fn shipped(side: usize, is_meant: impl Fn(&str) -> bool) -> impl Iterator<Item = Resampled> {
        shipped().into_iter().filter(move |spec| is_meant(spec)).flat_map(move |spec| {
            let graph = Graph::new();
            let found = |job: &Job<'_>| -> Vec<Resampled> {
                job.surfaces.iter().filter_map(|surface| Resampled::new(&spec, job, surface, side)).collect()
            };
            jobs(&graph, &spec, &[]).iter().flat_map(found).collect::<Vec<_>>()
        })
    }
}

/// The same grid with other numbers of rows and columns; values between those of the spec lie on straight lines.
fn resampled(grid: &SampleGrid, counts: [usize; 2]) -> SampleGrid {
    let along = |values: &[f64], count: usize| -> Vec<f64> {
        let last = values.len() - 1;
        let at = |k: usize| {
            let place = k as f64 / (count.max(2) - 1) as f64 * last as f64;
            let before = (place as usize).min(last.saturating_sub(1));
            values[before] + (place - before as f64) * (values[(before + 1).min(last)] - values[before])
        };
        (0..count).map(at).collect()
    };
    let both = |values: &[Vec<f64>; 2]| [0, 1].map(|k| along(&values[k], counts[k]));
    match grid {
        SampleGrid::Values(values) => SampleGrid::Values(both(values)),
        SampleGrid::Shares { shares, corners } => SampleGrid::Shares { shares: both(shares), corners: *corners },
        SampleGrid::Points(points) => SampleGrid::Points(points.clone()),
    }
}
