//! Milling a flank of the published pinion: poses with curvatures and axes, distances to the opposite flank, a program, and what its blocks leave, at
//! 100 × 200 positions.

use divan::{Bencher, black_box};
use flank_chain_dsl::{GeneratedSurface, Job, SampleGrid};
use flank_export::{Dialect, Header, MachineAxis, PassProgram, ProgramPass, ProgramRapid, WordsOf, write_passes};
use flank_expr::Graph;
use flank_solver::{
    BoundSurface, Chart, Cutter, CutterPose, Lean, MillAxes, Obstacle, OutlinePiece, PoseField, PoseSeries, Range,
    SurfaceFrame, SurfaceFrames, SurfaceProblem, SweptCutter, ToolBody,
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
        let coordinates = sample.functions();
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

/// The axes of the job's machine.
fn axes<'g>(graph: &'g Graph, job: &Job<'g>) -> MillAxes {
    let milling = &job.millings[0];
    let variables: Vec<_> = job.machines[milling.machine].axes.iter().map(|axis| axis.variable).collect();
    MillAxes::new(graph, &milling.t_work_tool.substituted(&job.bindings()), &variables).expect("five axes")
}

/// Points with their frames alone, a part of the next.
#[divan::bench]
fn points_20000(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let flank = Flank::new(&job, "concave");
    bencher.bench_local(|| black_box(flank.passes()));
}

/// Points, poses, curvatures of the gap, axes. The goal is 30 ms.
#[divan::bench]
fn poses_20000(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let (flank, cutter) = (Flank::new(&job, "concave"), ball());
    let axes = axes(&graph, &job);
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

/// A program of all positions, without its file. The goal is 20 ms.
#[divan::bench]
fn program_20000(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let rows: Vec<[f64; 6]> =
        poses(&Flank::new(&job, "concave").passes(), &ball()).iter().map(CutterPose::row).collect();
    let along = axes(&graph, &job).at_each(&rows, 0);
    let axis = |(k, address): (usize, &str)| MachineAxis {
        name: address.to_string(),
        address: address.to_string(),
        reversed: k == 4,
        offset: 0.0,
        is_rotary: k > 2,
        decimals: if k > 2 { 5 } else { 4 },
        travel: None,
    };
    let pass = |number: usize| {
        let [from, to] = [number, number + 1].map(|k| k * POSITIONS[1]);
        let places = &rows[from..to];
        let rapid =
            |row: &Vec<f64>, moves: &[usize]| ProgramRapid { row: row.clone(), tip: [0.0; 3], moves: moves.to_vec() };
        ProgramPass {
            name: format!("pass {}", number + 1),
            approach: vec![rapid(&along[from], &[0, 1, 3, 4]), rapid(&along[from], &[2])],
            away: vec![rapid(&along[to - 1], &[2])],
            rows: along[from..to].to_vec(),
            tips: places.iter().map(|[x, y, z, ..]| [*x, *y, *z]).collect(),
            ways: vec![0.25; POSITIONS[1] - 1],
        }
    };
    let program = PassProgram {
        header: Header {
            program: String::new(),
            spec: String::new(),
            spec_hash: String::new(),
            job: String::new(),
            conventions: Vec::new(),
        },
        title: String::new(),
        axes: ["X", "Y", "Z", "A", "C"].into_iter().enumerate().map(axis).collect(),
        home: (2, 200.0),
        end: None,
        is_upright: true,
        passes: (0..rows.len() / POSITIONS[1]).map(pass).collect(),
        feed: 600.0,
        spindle: None,
        words: WordsOf::Axes,
    };
    bencher.bench_local(|| {
        let mut text = Vec::new();
        write_passes(black_box(&program), Dialect::LinuxCnc, &mut text).expect("it is written");
        text
    });
}

/// What the blocks between all positions leave at the 15 × 31 points of a map: most of a program's verification. The goal is 1 s.
#[divan::bench]
fn left_by_20000_blocks(bencher: Bencher) {
    let graph = Graph::new();
    let job = job(&graph, MILLED, &[]);
    let flank = Flank::new(&job, "concave");
    let rows: Vec<[f64; 6]> = poses(&flank.passes(), &ball()).iter().map(CutterPose::row).collect();
    let block = |pair: &[[f64; 6]]| {
        let (from, to) = (pair[0], pair[1]);
        PoseSeries::sampled(9, |share| [0, 1, 2, 3, 4, 5].map(|k| from[k] + share * (to[k] - from[k])))
    };
    let middles = |count: usize, [low, high]: [f64; 2]| -> Vec<f64> {
        (0..count).map(|k| low + (high - low) * (k as f64 + 0.5) / count as f64).collect()
    };
    let points = flank.at([&middles(15, [0.2, 0.97]), &middles(31, [0.0, 1.0])]);
    bencher.bench_local(|| {
        let blocks = rows.chunks(POSITIONS[1]).flat_map(|pass| pass.windows(2).map(block)).collect();
        let swept = SweptCutter::of_blocks(blocks, &ball());
        let left = |frame: &SurfaceFrame| {
            let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
            swept.left(&[x, y, z, nx, ny, nz]).expect("a pass goes over it").height
        };
        points.iter().map(left).fold(0.0, f64::max)
    });
}
