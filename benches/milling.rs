//! Milling a flank of the published pinion: poses with curvatures and axes, and distances to the opposite flank, at 100 × 200 positions.

use divan::{Bencher, black_box};
use flank_chain_dsl::{GeneratedSurface, Job, SampleGrid};
use flank_expr::Graph;
use flank_solver::{
    BoundSurface, Chart, Cutter, CutterPose, Lean, MillAxes, Obstacle, OutlinePiece, PoseField, Range, SurfaceFrame,
    SurfaceFrames, SurfaceProblem, ToolBody,
};
use flank_tests::job;

const MILLED: &str = "specs/bevel/milled_pinion.chain";
/// Passes, and positions on each.
const POSITIONS: [usize; 2] = [100, 200];
const LEAN: Lean = Lean { lead: 0.087, tilt: 1.222, stock: 0.0 };

fn main() {
    divan::main();
}

fn surface<'j, 'g>(job: &'j Job<'g>, name: &str) -> &'j GeneratedSurface<'g> {
    job.surfaces.iter().find(|surface| surface.name == name).expect("a flank")
}

/// What solves points of a flank, with their frames, and where points are asked for.
struct Flank {
    problem: SurfaceProblem,
    frames: SurfaceFrames,
    corners: [[f64; 2]; 4],
}

impl Flank {
    fn new(job: &Job<'_>, name: &str) -> Flank {
        let surface = surface(job, name);
        let sample = surface.sample.as_ref().expect("it is sampled");
        let SampleGrid::Shares { corners, .. } = &sample.grid else { panic!("an outline") };
        let ranges = surface.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect();
        let bound = BoundSurface::new(&surface.surface, ranges, &job.bindings());
        let coordinates = [sample.coordinates[0].value, sample.coordinates[1].value];
        Flank {
            problem: SurfaceProblem::new(&bound, coordinates).expect("nothing is unbound"),
            frames: SurfaceFrames::new(&bound, coordinates).expect("nothing is unbound"),
            corners: *corners,
        }
    }

    /// At shares of the profile and of the length.
    fn at(&self, [profile, length]: [&[f64]; 2]) -> Vec<SurfaceFrame> {
        let [tr, hr, tt, ht] = self.corners;
        let place = |t: f64, s: f64| {
            [0, 1].map(|k| (1.0 - t) * ((1.0 - s) * tr[k] + s * hr[k]) + t * ((1.0 - s) * tt[k] + s * ht[k]))
        };
        let targets: Vec<[f64; 2]> = profile.iter().flat_map(|t| length.iter().map(move |s| place(*t, *s))).collect();
        let (points, _) = self.problem.solve(&targets, [profile.len(), length.len()]);
        let found = self.frames.at(points.iter().map(|point| point.unknowns.as_slice()));
        found.into_iter().map(|frame| frame.expect("a regular point")).collect()
    }

    fn passes(&self) -> Vec<SurfaceFrame> {
        let evenly = |count: usize, [low, high]: [f64; 2]| -> Vec<f64> {
            (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
        };
        self.at([&evenly(POSITIONS[0], [0.2, 0.97]), &evenly(POSITIONS[1], [0.0, 1.0])])
    }
}

fn ball() -> Cutter {
    Cutter { pieces: vec![OutlinePiece::Arc { center: [0.0, 1.0], radius: 1.0, between: [0.0, 1.571] }] }
}

fn poses(frames: &[SurfaceFrame], cutter: &Cutter) -> Vec<CutterPose> {
    frames.iter().map(|frame| CutterPose::touching(frame, cutter, LEAN, 1.0).expect("it touches")).collect()
}

/// Points, poses, curvatures of the gap, axes. The goal is 30 ms.
#[divan::bench]
fn poses_20000(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let (flank, cutter) = (Flank::new(&job, "concave"), ball());
    let milling = &job.millings[0];
    let variables: Vec<_> = job.machines[milling.machine].axes.iter().map(|axis| axis.variable).collect();
    let chain = milling.t_work_tool.substituted(&job.bindings());
    let axes = MillAxes::new(&graph, &chain, &variables).expect("five axes");
    bencher.bench_local(|| {
        let frames = flank.passes();
        let poses = poses(&frames, &cutter);
        let gap = poses.iter().zip(&frames).filter_map(|(pose, frame)| pose.bending(frame, &cutter)).map(|of| of.gap);
        let least = gap.fold(f64::INFINITY, f64::min);
        let rows: Vec<[f64; 6]> = poses.iter().map(CutterPose::row).collect();
        black_box((least, axes.at_each(&rows, 0)))
    });
}

/// The least distance from the opposite flank over all positions. The goal is 0.5 s.
#[divan::bench]
fn clearance_20000(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let rows: Vec<[f64; 6]> =
        poses(&Flank::new(&job, "concave").passes(), &ball()).iter().map(CutterPose::row).collect();
    let counts = [13, 17];
    let shares = counts.map(Chart::shares);
    let convex = Flank::new(&job, "convex").at([&shares[0], &shares[1]]);
    let point = |frame: &SurfaceFrame| {
        let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
        [x, y, z, nx, ny, nz]
    };
    let obstacle = Obstacle::new(PoseField::through(convex.iter().map(point).collect(), counts));
    let body = ToolBody {
        pieces: vec![
            OutlinePiece::Arc { center: [0.0, 1.0], radius: 1.0, between: [0.0, std::f64::consts::FRAC_PI_2] },
            OutlinePiece::Line { from: [1.0, 1.0], to: [1.0, 20.0] },
            OutlinePiece::Line { from: [1.0, 20.0], to: [8.0, 20.0] },
            OutlinePiece::Line { from: [8.0, 20.0], to: [8.0, 60.0] },
        ],
    };
    bencher.bench_local(|| {
        let mut least = f64::INFINITY;
        for pose in &rows {
            let found = obstacle.nearest(&body, black_box(pose), least);
            least = found.map_or(least, |found| found.distance.min(least));
        }
        least
    });
}
