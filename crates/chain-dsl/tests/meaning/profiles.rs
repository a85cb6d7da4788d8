//! Profiles made of segments: each piece against a surface written separately, splines against closed forms.

use flank_chain_dsl::{Compilation, Job, compile_file, render};
use flank_expr::{Expr, Graph};

use crate::files::project;

/// A job that sees what stands on the slide from the bed.
const JOB: &str = r#"
machine stand {
    frame bed
    frame slide in bed = translate(0 mm, 0 mm, 0 mm)
}
job j {
    machine m = stand
    tool t = cutter
    mount t on m.slide
    surface whole in m.bed = move(t.side)
    OTHERS
}
"#;

fn compiled<'g>(graph: &'g Graph, name: &str, tool: &str, others: &str) -> Compilation<'g> {
    let text = format!("{tool}{}", JOB.replace("OTHERS", others));
    let table = "x, y [um]\n0, 0\n1, 100\n3, 300\n4, 400\n4.5, 450\n";
    let folder = project(name, &[("j.chain", &text), ("line.csv", table)]);
    let compilation = compile_file(graph, &folder.join("j.chain"), &[]);
    assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
    compilation
}

/// Position and normal of a surface at values of its unknowns, or any other expressions of them.
fn at<'g>(job: &Job<'g>, surface: &str, values: &[f64], what: impl Fn([Expr<'g>; 6]) -> Vec<Expr<'g>>) -> Vec<f64> {
    let surface = job.surfaces.iter().find(|found| found.name == surface).expect("a surface of the job");
    let graph = surface.surface.position.0[0].graph();
    let mut bound = job.bindings();
    for (unknown, value) in surface.unknowns.iter().zip(values) {
        bound.push((unknown.variable, graph.constant(*value)));
    }
    let ([x, y, z], [nx, ny, nz]) = (surface.surface.position.0, surface.surface.normal.0);
    let exprs = graph.substitute(&what([x, y, z, nx, ny, nz]), &bound);
    exprs.iter().map(|expr| expr.as_constant().expect("every unknown has a value")).collect()
}

fn range(job: &Job<'_>, surface: &str) -> (f64, f64) {
    let surface = job.surfaces.iter().find(|found| found.name == surface).expect("a surface of the job");
    (surface.unknowns[0].low, surface.unknowns[0].high)
}

#[test]
fn each_piece_is_the_surface_written_by_itself() {
    const TOOL: &str = "
        tool cutter {
            param depth : length = 5 mm
            param slope : angle = 20 deg
            param radius : length = 0.8 mm
            let foot = [depth * tan(slope), 0 mm]
            let center = [-radius * cos(slope), -depth - radius * sin(slope)]

            profile tooth {
                flank = line(from: foot, to: [0 mm, -depth])
                edge  = arc(center: center, radius: radius, from: slope, to: -70 deg)
                back  = arc(center: center, radius: radius, from: -70 deg, to: -40 deg)
            }
            surface side(s: along tooth, v: angle in -60 deg .. 60 deg) {
                let p = tooth(s)
                let r = 40 mm + p[0]
                at = [r * cos(v), r * sin(v), p[1]]
                body towards [-cos(v), -sin(v), 1]
            }
            surface flank(u: length in 0 mm .. 5.4 mm, v: angle in -60 deg .. 60 deg) {
                let r = 40 mm + foot[0] - u * sin(slope)
                at = [r * cos(v), r * sin(v), -u * cos(slope)]
                body inside
            }
            surface edge(a: angle in -70 deg .. 20 deg, v: angle in -60 deg .. 60 deg) {
                let r = 40 mm + center[0] + radius * cos(a)
                at = [r * cos(v), r * sin(v), center[1] + radius * sin(a)]
                body towards [-cos(a) * cos(v), -cos(a) * sin(v), -sin(a)]
            }
        }";
    let graph = Graph::new();
    let others = "surface flank in m.bed = move(t.flank)
        surface edge in m.bed = move(t.edge)
        surface alone in m.bed = move(t.side.edge)";
    let compilation = compiled(&graph, "pieces", TOOL, others);
    let job = &compilation.jobs[0];
    let names: Vec<&str> = job.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["whole.flank", "whole.edge", "whole.back", "flank", "edge", "alone"]);

    let (slope, radius) = (20f64.to_radians(), 0.8);
    let length = 5.0 / slope.cos();
    let turned = radius * 90f64.to_radians();
    let ends =
        [(0.0, length), (length, length + turned), (length + turned, length + turned + radius * 30f64.to_radians())];
    for (name, (low, high)) in ["whole.flank", "whole.edge", "whole.back"].into_iter().zip(ends) {
        let found = range(job, name);
        assert!((found.0 - low).abs() < 1e-14 && (found.1 - high).abs() < 1e-14, "{name}: {found:?}");
    }
    for k in 0..=20 {
        let (share, v) = (f64::from(k) / 20.0, 0.1 * f64::from(k) - 1.0);
        for (piece, run, other, own) in [
            ("whole.flank", share * length, "flank", share * length),
            ("whole.edge", length + share * turned, "edge", slope - share * turned / radius),
            ("alone", length + share * turned, "edge", slope - share * turned / radius),
        ] {
            let (one, two) = (at(job, piece, &[run, v], Vec::from), at(job, other, &[own, v], Vec::from));
            for (a, b) in one.iter().zip(&two) {
                assert!((a - b).abs() < 1e-12, "{piece} at {run}: {one:?} {two:?}");
            }
        }
    }
}

/// An arc between two points is the one about its centre, in both senses; a very large one is a line but for its height.
#[test]
fn an_arc_through_two_points_is_the_arc_about_its_centre() {
    const TOOL: &str = "
        tool cutter {
            profile by_center {
                there = arc(center: [1 mm, 2 mm], radius: 5 mm, from: 10 deg, to: 70 deg)
                back  = arc(center: [1 mm, 2 mm], radius: 5 mm, from: 70 deg, to: 10 deg)
            }
            let from = [1 mm + 5 mm * cos(10 deg), 2 mm + 5 mm * sin(10 deg)]
            let to = [1 mm + 5 mm * cos(70 deg), 2 mm + 5 mm * sin(70 deg)]
            profile by_ends {
                there  = arc(from: from, to: to, radius: 5 mm)
                back   = arc(from: to, to: from, radius: -5 mm)
                nearly = arc(from: from, to: [from[0], from[1] - 8 mm], radius: 1e12 mm)
            }
            surface side(s: along by_center, v: length in 0 mm .. 1 mm) {
                let p = by_center(s)
                at = [p[0], p[1], v]
                body towards [1 mm - p[0], 2 mm - p[1], 0 mm]
            }
            surface other(s: along by_ends, v: length in 0 mm .. 1 mm) {
                let p = by_ends(s)
                at = [p[0], p[1], v]
                body towards [1 mm - p[0], 2 mm - p[1], 0 mm]
            }
        }";
    let graph = Graph::new();
    let compilation = compiled(&graph, "bows", TOOL, "surface other in m.bed = move(t.other)");
    let job = &compilation.jobs[0];
    for piece in ["there", "back"] {
        let [one, other] = ["whole", "other"].map(|surface| format!("{surface}.{piece}"));
        let (low, high) = range(job, &one);
        assert!((range(job, &other).0 - low).abs() < 1e-14 && (range(job, &other).1 - high).abs() < 1e-14);
        for k in 0..=10 {
            let values = [low + (high - low) * f64::from(k) / 10.0, 0.5];
            let (one, other) = (at(job, &one, &values, Vec::from), at(job, &other, &values, Vec::from));
            assert!(one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-14), "{piece}: {one:?} {other:?}");
        }
    }
    let (low, high) = range(job, "other.nearly");
    let (start, middle) = (
        at(job, "other.nearly", &[low, 0.5], Vec::from),
        at(job, "other.nearly", &[0.5 * (low + high), 0.5], Vec::from),
    );
    assert!((high - low - 8.0).abs() < 1e-14 && (middle[1] - start[1] + 4.0).abs() < 1e-14);
    // 4² / 2R
    assert!((start[0] - middle[0] - 8e-12).abs() < 1e-14, "{}", start[0] - middle[0]);
}

/// A tool with one spline, through these points of the plane.
fn spline(graph: &Graph, name: &str, points: &str) -> f64 {
    let tool = format!(
        "tool cutter {{
            profile tooth {{ top = spline({points}) }}
            surface side(s: along tooth, v: length in 0 mm .. 1 mm) {{
                at = [tooth(s)[0], tooth(s)[1], v]
                body towards [0, -1, 0]
            }}
        }}"
    );
    let compilation = compiled(graph, name, &tool, "");
    let job = &compilation.jobs[0];
    let (low, high) = range(job, "whole.top");
    assert_eq!(low, 0.0);
    let run = |k: u32| high * f64::from(k) / 500.0;
    (0..=500)
        .map(|k| at(job, "whole.top", &[run(k), 0.5], Vec::from))
        .map(|p| p[0].hypot(p[1]) - 10.0)
        .fold(0.0, |a, b| b.abs().max(a))
}

/// Points of a quarter of a circle of 10 mm.
fn circle(count: u32) -> String {
    let angle = |k: u32| std::f64::consts::FRAC_PI_2 * f64::from(count - k) / f64::from(count);
    let point = |a: f64| format!("[{} mm, {} mm]", 10.0 * a.cos(), 10.0 * a.sin());
    let points: Vec<String> = (0..=count).map(|k| point(angle(k))).collect();
    format!("[{}]", points.join(", "))
}

#[test]
fn a_spline_through_points_of_a_circle_tends_to_it_with_the_fourth_order() {
    let worst = [16, 32, 64].map(|count| spline(&Graph::new(), "circle", &circle(count)));
    assert!(worst[2] < 1e-6, "{worst:?}");
    for pair in worst.windows(2) {
        assert!((12.0..24.0).contains(&(pair[0] / pair[1])), "{worst:?}");
    }
}

#[test]
fn a_spline_through_points_of_a_line_is_the_line_and_differentiates_exactly() {
    const TOOL: &str = r#"
        tool cutter {
            profile tooth {
                top  = spline("line.csv", x: length, y: length)
                next = spline([[4.5 mm, 0.45 mm], [5 mm, 1 mm], [6 mm, 1.5 mm], [6.5 mm, 3 mm]])
            }
            surface side(s: along tooth, v: length in 0 mm .. 1 mm) {
                at = [tooth(s)[0], tooth(s)[1], v]
                body towards [1, -1, 0]
            }
        }"#;
    let graph = Graph::new();
    let compilation = compiled(&graph, "line", TOOL, "");
    let job = &compilation.jobs[0];
    let scale = 1.0 / 1f64.hypot(0.1);
    let end = 4.5 / scale;
    assert!((range(job, "whole.top").1 - end).abs() < 1e-14);
    for k in 0..=30 {
        let run = end * f64::from(k) / 30.0;
        let found = at(job, "whole.top", &[run, 0.5], Vec::from);
        for (a, b) in found.iter().zip([run * scale, 0.1 * run * scale, 0.5, -0.1 * scale, scale, 0.0]) {
            assert!((a - b).abs() < 1e-14 || (a + b).abs() < 1e-14, "{found:?} at {run}");
        }
    }
    let surface = job.surfaces.iter().find(|surface| surface.name == "whole.next").expect("a piece");
    let s = surface.unknowns[0].variable;
    let (low, high) = range(job, "whole.next");
    for k in 1..20 {
        let (run, h) = (low + (high - low) * f64::from(k) / 20.3, 1e-5);
        let point = |run: f64| at(job, "whole.next", &[run, 0.5], |[x, y, ..]| vec![x, y]);
        let exact = at(job, "whole.next", &[run, 0.5], |[x, y, ..]| vec![x.derivative(s), y.derivative(s)]);
        let (before, after) = (point(run - h), point(run + h));
        for i in 0..2 {
            let quotient = (after[i] - before[i]) / (2.0 * h);
            // the quotient errs by h²/6 times the third derivative, about 1, and by rounding over 2h
            assert!((exact[i] - quotient).abs() < 1e-9, "{i} at {run}: {} {quotient}", exact[i]);
        }
    }
}

#[test]
fn an_edge_along_a_profile_sweeps_a_surface_for_each_segment() {
    const TEXT: &str = "
        tool knife {
            param half : length = 2 mm
            profile blade {
                left  = line(from: [-half, 0.5 mm], to: [0 mm, 0 mm])
                right = line(from: [0 mm, 0 mm], to: [half, 0.5 mm])
            }
            surface edge(s: along blade) {
                let p = blade(s)
                at = [p[1], 0 mm, p[0]]
                body towards [1, 0, 0]
            }
        }
        job j {
            machine m = lathe(height: 0 mm)
            tool k = knife
            mount k on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            surface groove in m.work = sweep(k.edge, over: turn)
            sample groove.left { s: 0 mm .. k.blade.left.to by 3, turn: 0 deg .. 90 deg by 5 }
        }";
    let graph = Graph::new();
    let compilation = super::models::compiled(&graph, TEXT);
    let job = &compilation.jobs[0];
    let names: Vec<&str> = job.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["groove.left", "groove.right"]);
    let sample = job.surfaces[0].sample.as_ref().expect("a sample");
    assert_eq!(sample.targets().len(), 15);
    assert!((sample.targets()[14][0] - 2f64.hypot(0.5)).abs() < 1e-15);
    assert!(job.surfaces[1].sample.is_none());
}

#[test]
fn an_envelope_of_pieces_is_a_tool_in_pieces() {
    const TEXT: &str = "
        machine pair extends lathe {
            axis D : rotary
            frame mate in bed = translate_x(80 mm) rotate_z(D)
        }
        job j {
            machine m = pair(height: 4 mm)
            tool b = blade
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            motion mesh : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            drive m.D = -2 * mesh
            surface first in m.bed = envelope(b.side, over: turn)
            surface second in m.mate = envelope(first, over: mesh)
            surface third in m.mate = envelope(first.edge, over: mesh)
        }";
    let graph = Graph::new();
    let compilation = super::models::compiled(&graph, TEXT);
    let names: Vec<&str> = compilation.jobs[0].surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["first.flank", "first.edge", "second.flank", "second.edge", "third"]);
    assert_eq!(compilation.jobs[0].surfaces[3].generation.tool_name, "first.edge");
    assert_eq!(compilation.jobs[0].surfaces[1].generation.tool_name, "b.side.edge");
}
