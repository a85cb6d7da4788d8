//! Every sampled surface of the library under every kind of cutter: the envelope of the cutter over all its passes and along them is that surface.

use std::f64::consts::FRAC_PI_2;

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::Graph;
use flank_solver::{
    Chart, Cutter, CutterPose, Lean, Outcome, OutlinePiece, PoseField, SurfaceFrame, SurfaceFrames, SurfacePoint,
    lowest,
};
use flank_tests::{bound, jobs, problem, shipped};
use rayon::prelude::*;

/// Rows and columns of exact points that polynomials go through.
const GRID: [usize; 2] = [17, 17];
/// A patch is a cell of the sample, or so much of it in each direction at which polynomials are exact.
const PARTS: [f64; 5] = [1.0, 0.3, 0.1, 0.03, 0.01];
/// How exact they are, mm and radians.
const EXACT: f64 = 1e-11;
/// Sizes of cutters, mm: the first is taken whose surface bends away from the patch.
const SIZES: [f64; 8] = [4.0, 1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3];
/// Grinding wheels whose surface each place of a dresser makes by itself: between two of these there is no surface.
const WHEELS: [&str; 3] =
    ["dressed_wheel.chain dressing", "thread_wheel.chain plus_wheel", "thread_wheel.chain minus_wheel"];
/// How many kinds of cutters there are.
const KINDS: usize = 5;
/// Half the angle of the cone, radians.
const TAPER: f64 = 0.26;
/// Shares of a patch, of passes and along them.
const PLACES: [[f64; 2]; 4] = [[0.0, 0.33], [0.21, 0.9], [0.5, 0.5], [1.0, 0.1]];

/// A ball, a flat end mill, a bull nose, a barrel and a cone with a round tip of a size, each with a lean in which it cuts with its edge or arc.
fn cutters(size: f64) -> [(&'static str, Cutter, Lean); KINDS] {
    let of = |center: [f64; 2], radius: f64, between: [f64; 2]| {
        let arc = OutlinePiece::Arc { center: center.map(|x| x * size), radius: radius * size, between };
        Cutter { pieces: vec![arc] }
    };
    let lean = |lead: f64, tilt: f64| Lean { lead, tilt, stock: 0.0 };
    let quarter = [0.0, FRAC_PI_2];
    // its side goes on from the arc
    let cone = of([0.0, 1.0], 1.0, [0.0, FRAC_PI_2 - TAPER]);
    let (sine, cosine) = TAPER.sin_cos();
    let from = [cosine, 1.0 - sine].map(|x| x * size);
    let side = OutlinePiece::Line { from, to: [from[0] + 4.0 * size * sine, from[1] + 4.0 * size * cosine] };
    let cone = Cutter { pieces: cone.pieces.into_iter().chain([side]).collect() };
    [
        ("ball", of([0.0, 1.0], 1.0, quarter), lean(0.2, -0.4)),
        ("flat", of([1.0, 0.0], 0.0, quarter), lean(0.1, 0.05)),
        ("bull", of([0.7, 0.3], 0.3, quarter), lean(0.08, -0.1)),
        ("cone", cone, lean(0.2, -0.4)),
        ("barrel", of([-5.0, 0.0], 6.0, [1.47, 1.67]), lean(0.02, 1.55)),
    ]
}

/// Exact points of the part of a sample's middle cell, as `flank solve` finds them; `None` if the surface has no tangent plane at some.
fn frames(job: &Job<'_>, surface: &GeneratedSurface<'_>, part: f64) -> Option<Vec<SurfaceFrame>> {
    let sample = surface.sample.as_ref()?;
    let [rows, columns] = sample.counts;
    let (row, column) = ((rows - 1) / 2, (columns - 1) / 2);
    let targets = sample.targets();
    let target = |i: usize, j: usize| targets[(row + i).min(rows - 1) * columns + (column + j).min(columns - 1)];
    let [a, b, c] = [target(0, 0), target(1, 0), target(0, 1)];
    let steps = [b, c].map(|end| [0, 1].map(|k| part * (end[k] - a[k])));
    let shares: Vec<[f64; 2]> = {
        let [rows, columns] = GRID.map(Chart::shares);
        rows.into_iter().flat_map(|p| columns.clone().into_iter().map(move |u| [p, u])).collect()
    };
    let at = |[p, u]: &[f64; 2]| [0, 1].map(|k| a[k] + p * steps[0][k] + u * steps[1][k]);
    let coordinates = sample.functions();
    let places: Vec<[f64; 2]> = shares.iter().map(at).collect();
    let (points, _): (Vec<SurfacePoint>, _) = problem(job, surface, coordinates).solve(&places, GRID);
    let found = SurfaceFrames::new(&bound(job, surface), coordinates).expect("nothing is unbound");
    let found = found.at(points.iter().map(|point| point.unknowns.as_slice()));
    found
        .into_iter()
        .zip(&points)
        .map(|(frame, point)| frame.filter(|_| point.outcome == Outcome::Solved).map(|frame| frame.by(steps)))
        .collect()
}

fn row(frame: &SurfaceFrame) -> [f64; 6] {
    let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
    [x, y, z, nx, ny, nz]
}

/// The largest height over the patch at which the cutter is lowest, and how far from its contact that is in its passes: both nothing on an envelope.
fn off(frames: &[SurfaceFrame], cutter: &Cutter, lean: Lean) -> Option<f64> {
    let poses: Option<Vec<[f64; 6]>> = frames
        .iter()
        .map(|frame| {
            let pose = CutterPose::touching(frame, cutter, lean, 1.0).ok()?;
            (pose.bending(frame, cutter)?.gap > 0.0).then(|| pose.row())
        })
        .collect();
    let poses = PoseField::through(poses?, GRID);
    let surface = PoseField::through(frames.iter().map(row).collect(), GRID);
    if poses.tail() > EXACT || surface.tail() > EXACT {
        return None;
    }
    let height = |[share, along]: [f64; 2]| {
        let found = lowest(&poses.pass(share), cutter, &surface.at([share, along]), along + 0.03)?;
        // across the passes, too: a pass beside it is no lower than as the gap bends
        let beside = [-0.01, 0.01].map(|by| {
            let line = surface.at([share, along]);
            lowest(&poses.pass((share + by).clamp(0.0, 1.0)), cutter, &line, along)
                .map_or(f64::INFINITY, |it| it.height)
        });
        assert!(beside.iter().all(|beside| *beside > -1e-9), "{beside:?} beside the pass");
        Some(found.height.abs())
    };
    PLACES.into_iter().map(height).try_fold(0.0, |most, height| Some(f64::max(most, height?)))
}

#[test]
fn the_envelope_of_every_cutter_is_every_surface_of_the_library() {
    let of_spec = |spec: &String| {
        let graph = Graph::new();
        let mut told = Vec::new();
        for job in jobs(&graph, spec, &[]) {
            for surface in job.surfaces.iter().filter(|surface| surface.sample.is_some()) {
                let patches = || PARTS.iter().filter_map(|part| frames(&job, surface, *part));
                for number in 0..KINDS {
                    let tried = patches().flat_map(|frames| SIZES.map(|size| (frames.clone(), cutters(size))));
                    let mut tried = tried.filter_map(|(frames, cutters)| {
                        let (_, cutter, lean) = &cutters[number];
                        off(&frames, cutter, *lean)
                    });
                    told.push((format!("{spec} {} {}", surface.name, cutters(1.0)[number].0), tried.next()));
                }
            }
        }
        told
    };
    let told: Vec<(String, Option<f64>)> = shipped().par_iter().flat_map_iter(of_spec).collect();
    let missing: Vec<&String> = told.iter().filter(|(_, off)| off.is_none()).map(|(name, _)| name).collect();
    let known = told.iter().filter_map(|(name, off)| Some((name, (*off)?)));
    let worst = known.max_by(|a, b| a.1.total_cmp(&b.1)).expect("there are surfaces");
    assert!(worst.1 < 1e-9, "{worst:?}");
    assert!(told.len() > KINDS * 380, "{}", told.len());
    let is_known = |name: &&&String| WHEELS.iter().any(|wheel| name.contains(wheel));
    let others: Vec<&&String> = missing.iter().filter(|name| !is_known(name)).collect();
    assert!(others.is_empty(), "of {} not milled: {others:#?}", told.len());
    assert_eq!(missing.len(), KINDS * 5, "wheels");
}
