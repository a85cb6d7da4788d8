//! Every job of the library on every machine that may be able to do it: what is carried over makes the same surface, what is not
//! says why.

use std::fmt::Write;

use flank_chain_dsl::{GeneratedSurface, Job, Process, ToolShape};
use flank_expr::geometry::Vector3;
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{Outcome, PoseProblem, Posture, Screw, SurfacePoint, TargetAxis};
use flank_tests::machines::{beside, target_axis, unseen};
use flank_tests::{largest, repository, sampled};

/// File, tool's frame, work's frame.
const TARGETS: [[&str; 3]; 5] = [
    ["free_form", "cutter", "work"],
    ["hobbing_6axis", "hob", "table"],
    ["five_axis_table_table", "cutter", "work"],
    ["five_axis_head_table", "cutter", "work"],
    ["five_axis_head_head", "cutter", "work"],
];
/// Points of each surface that are looked at.
const POINTS: usize = 12;
/// Postures between two of them, so that axes are followed in small steps.
const BETWEEN: usize = 12;
/// No linear axis without travel goes farther, mm.
const REACH: f64 = 10_000.0;

fn specs() -> Vec<String> {
    let mut specs = Vec::new();
    for folder in ["bevel", "double_envelope", "grinding", "hobbing"] {
        let entries = std::fs::read_dir(repository("specs").join(folder)).expect("it is shipped");
        let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a plain name"));
        specs.extend(names.filter(|name| name.ends_with(".chain")).map(|name| format!("specs/{folder}/{name}")));
    }
    specs.sort();
    specs
}

/// One surface of each tool and work.
fn tools<'j, 'g>(job: &'j Job<'g>) -> Vec<&'j GeneratedSurface<'g>> {
    let mut first: Vec<&GeneratedSurface<'_>> = Vec::new();
    let path =
        |s: &GeneratedSurface<'_>| (s.frame.clone(), s.generation.tool_frame().to_string(), s.generation.motions.len());
    for surface in job.surfaces.iter().filter(|surface| surface.sample.is_some()) {
        if first.iter().all(|known| path(known) != path(surface)) {
            first.push(surface);
        }
    }
    first
}

/// How far points of the surface as the target's axes make it lie from where they are, mm; or why they do not.
fn carried<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    points: &[SurfacePoint],
    target: &Job<'g>,
    [tool_frame, work_frame]: [&str; 2],
    unseen: &[Screw],
) -> Result<f64, String> {
    let generation = &surface.generation;
    if generation.motions.is_empty() {
        return Err("nothing moves".to_string());
    }
    let graph = generation.motions[0].graph();
    let machine = &target.machines[0];
    // a rack that does not turn stands on the hobbing machine's head, not on its spindle
    let own = generation.tool_frame().rsplit('.').next().expect("a name");
    let tool = if tool_frame == "hob" && own == "head" { own } else { tool_frame };
    let chain = machine.chain(graph, work_frame, tool).expect("both frames").substituted(&target.bindings());
    let moving = machine.axes.iter().filter(|axis| !chain.twist(axis.variable).is_zero());
    let axes: Vec<TargetAxis<'g>> = moving.clone().map(target_axis).collect();
    let names: Vec<&str> = moving.map(|axis| axis.name.as_str()).collect();
    let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
    let [chain, driven] = [&chain, &generation.driven].map(|chain| chain.substituted(&bindings));
    let problem = PoseProblem::new(&chain, &axes, &driven, &generation.motions, unseen, REACH)
        .map_err(|error| error.to_string())?;
    let of_motions: Vec<usize> = generation
        .motions
        .iter()
        .map(|motion| surface.unknowns.iter().position(|u| u.variable == *motion).expect("an unknown of the surface"))
        .collect();
    let at = |point: &SurfacePoint| -> Vec<f64> { of_motions.iter().map(|&k| point.unknowns[k]).collect() };
    let mut way: Vec<Vec<f64>> = vec![at(&points[0])];
    for point in &points[1..] {
        let (from, to) = (way[way.len() - 1].clone(), at(point));
        way.extend((1..=BETWEEN).map(|k| {
            let share = k as f64 / BETWEEN as f64;
            from.iter().zip(&to).map(|(a, b)| a + share * (b - a)).collect()
        }));
    }
    let first = problem.postures(&way[0]).into_iter().next().expect("what came nearest, if nothing");
    let line = problem.follow(&first, &way);
    if let Some(why) = line.iter().find_map(|posture| told(posture, problem.unknowns().len())) {
        return Err(why);
    }
    let beyond = line.iter().find_map(|posture| match posture.outcome {
        Outcome::Outside { unknown, .. } => Some(names[unknown]),
        _ => None,
    });
    let moved = Moved::new(&problem, surface, &bindings, &generation.motions);
    let mut most: f64 = 0.0;
    for (point, posture) in points.iter().zip(line.iter().step_by(BETWEEN)) {
        most = most.max(moved.off(&problem, posture, point, &at(point)));
    }
    assert!(most < 1e-9, "{} on {}: off by {most:e} mm", job.name, machine.name);
    beyond.map_or(Ok(most), |axis| Err(format!("the same surface, beyond the travel of {axis}")))
}

/// Why a posture does not do.
fn told(posture: &Posture, freedoms: usize) -> Option<String> {
    match (posture.outcome, posture.missing) {
        (Outcome::Solved | Outcome::Outside { .. }, None) => None,
        (Outcome::Solved | Outcome::Outside { .. }, Some(missing)) => {
            let how = if missing.direction < 3 { "along" } else { "about" };
            Some(format!("no axis {how} {} of the tool", ["x", "y", "z"][missing.direction % 3]))
        }
        _ if freedoms < 6 => Some(format!("{freedoms} freedoms are too few")),
        (Outcome::Singular, _) => Some("singular".to_string()),
        _ => Some("not reached".to_string()),
    }
}

/// The surface as the target leaves it: of the tool's unknowns and of the target's, position and normal in the work, and the derivative of
/// the position by each of the target's unknowns.
struct Moved {
    tape: Tape,
    tool: usize,
    unknowns: usize,
    has_normal: bool,
}

impl Moved {
    fn new<'g>(
        problem: &PoseProblem<'g>,
        surface: &GeneratedSurface<'g>,
        bindings: &[(Expr<'g>, Expr<'g>)],
        motions: &[Expr<'g>],
    ) -> Moved {
        let graph = motions[0].graph();
        let bound = |v: Vector3<'g>| {
            let new = graph.substitute(&v.0, bindings);
            Vector3([new[0], new[1], new[2]])
        };
        let (position, normal, unknowns, has_normal) = match &surface.generation.tool {
            ToolShape::Surface(tool) => (bound(tool.position), bound(tool.normal), tool.unknowns.clone(), true),
            ToolShape::Edge(edge) => {
                let along = surface.surface.unknowns.iter().filter(|u| !motions.contains(u)).copied().collect();
                (bound(edge.position), Vector3::zero(graph), along, false)
            }
        };
        let chain = problem.chain();
        let (point, normal) = (chain.point(position), chain.direction(normal));
        let slopes = problem.unknowns().iter().flat_map(|x| point.derivative(*x).0);
        let outputs: Vec<Expr<'g>> = point.0.into_iter().chain(normal.0).chain(slopes).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(problem.unknowns()).copied().collect();
        let tape = Tape::new(&outputs, &inputs).expect("all bound");
        Moved { tape, tool: unknowns.len(), unknowns: problem.unknowns().len(), has_normal }
    }

    /// Distance of the point from where it is, mm; with a normal also how far that is off, and by how much the point would leave
    /// the surface over each motion, mm per radian or mm, from the series of the axes there.
    fn off(&self, problem: &PoseProblem<'_>, posture: &Posture, point: &SurfacePoint, motions: &[f64]) -> f64 {
        let mut out = vec![0.0; self.tape.output_count()];
        let series: Vec<Vec<Vec<f64>>> = (0..motions.len())
            .map(|along| {
                problem.series(posture, motions, along, 1).expect("a posture that is followed is not singular")
            })
            .collect();
        let stands = series[0].iter().map(|c| c[0]);
        let inputs: Vec<f64> = point.unknowns[..self.tool].iter().copied().chain(stands).collect();
        ScalarEvaluator::new(&self.tape).run(&inputs, &mut out);
        let apart = |a: &[f64], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let position = apart(&out[..3], &point.position);
        if !self.has_normal {
            return position;
        }
        // the tool's normal points out of the tool, the work's into it
        let normal = apart(&out[3..6], &point.normal).min(apart(&out[3..6], &point.normal.map(|x| -x)));
        let meshing = series.iter().map(|series| {
            let slope = |i: usize| (0..self.unknowns).map(|k| out[6 + 3 * k + i] * series[k][1]).sum::<f64>();
            (0..3).map(|i| out[3 + i] * slope(i)).sum::<f64>().abs()
        });
        largest([position, normal].into_iter().chain(meshing))
    }
}

#[test]
fn what_is_carried_over_makes_the_same_surface() {
    let mut table = String::new();
    let mut count = 0;
    for spec in specs() {
        for [machine, tool_frame, work_frame] in TARGETS {
            let graph = Graph::new();
            let files = [spec.as_str(), &format!("specs/machines/{machine}.chain")];
            let (jobs, target) = beside(&graph, files, &[]);
            for job in &jobs {
                for surface in tools(job) {
                    let solved = sampled(job, &surface.name);
                    let solved: Vec<SurfacePoint> =
                        solved.into_iter().filter(|point| point.outcome == Outcome::Solved).collect();
                    let step = solved.len().div_ceil(POINTS).max(1);
                    let points: Vec<SurfacePoint> = solved.into_iter().step_by(step).collect();
                    let outcome = if surface.generation.process == Process::Move || points.is_empty() {
                        Err("nothing is cut".to_string())
                    } else {
                        let on = |unseen: &[Screw]| {
                            carried(job, surface, &points, &target, [tool_frame, work_frame], unseen)
                        };
                        // where an axis only happens to move the tool along itself, that may stand as it does on the source
                        on(&unseen(job, surface)).or_else(|why| on(&[]).map_err(|_| why))
                    };
                    count += usize::from(outcome.is_ok());
                    let outcome = outcome.map_or_else(|why| why, |_| "the same surface".to_string());
                    let _ = writeln!(table, "{} {} on {machine}: {outcome}", job.name, surface.name);
                }
            }
        }
    }
    assert!(count > 40, "{count} are carried over:\n{table}");
    insta::assert_snapshot!(table);
}
