//! Hostile and enormous texts: compiled or refused soon and in bounded memory.

use std::fmt::Write;
use std::time::{Duration, Instant};

use flank_chain_dsl::limits::{self, Limit};
use flank_chain_dsl::{Code, Diagnostic, compile_text, render};
use flank_expr::Graph;

use crate::LIBRARY;

/// For one text in a debug build on a loaded machine; none needs a fifth of it on a free one.
const SOON: Duration = Duration::from_secs(20);

/// `count` lines, each made from its number.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).fold(String::new(), |text, k| text + &line(k) + "\n")
}

/// A job with a tool on the machine `m`, and what else it says.
fn job(machine: &str, statements: &str) -> String {
    format!(
        "job j {{
            machine m = {machine}
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            surface s in m.work = envelope(b.face, over: turn)
            {statements}
        }}"
    )
}

/// A job on the small machine of the library.
fn small_job(statements: &str) -> String {
    job("lathe(height: 3 mm)", statements)
}

/// The small machine with a chain of frames between bed and work.
fn long_machine(frames: usize) -> String {
    let chain = lines(frames, |k| {
        let parent = if k == 0 { "bed".to_string() } else { format!("f{}", k - 1) };
        format!("frame f{k} in {parent} = translate(1 mm, {k} um, 2 mm) rotate_x(C / {frames})")
    });
    let last = frames - 1;
    format!("machine long extends lathe {{\n{chain}frame work in f{last} = rotate_z(C)\n}}\n")
}

/// An edge swept over as many motions as a surface may have.
fn sweeps(count: usize) -> String {
    let motions = limits::SURFACE_UNKNOWNS.most - 1;
    let axes = lines(motions, |k| format!("axis A{k} : linear"));
    let frames = lines(motions, |k| {
        format!("frame f{} in f{k} = translate(1 mm, A{k}, 2 mm) rotate_y(A{k} / {} mm * 1 rad)", k + 1, k + 7)
    });
    let drives = lines(motions, |k| format!("motion t{k} : length in 0 mm .. 1 mm\ndrive m.A{k} = t{k}"));
    let over: Vec<String> = (0..motions).map(|k| format!("t{k}")).collect();
    let surfaces = lines(count, |k| format!("surface s{k} in m.f0 = sweep(p.edge, over: [{}])", over.join(", ")));
    format!(
        "machine tower {{ {axes}frame f0\n{frames} }}
        tool pick {{
            surface edge(u: length in 1 mm .. 3 mm) {{
                at = [u, 0 mm, u]
                body towards [1, 0, -1]
            }}
        }}
        job j {{ machine m = tower\ntool p = pick\nmount p on m.f{motions}\n{drives}{surfaces} }}"
    )
}

/// Calls inside each other, each with a name of its own.
fn nested(levels: usize, call: &str, innermost: &str) -> String {
    let open: String = (0..levels).map(|k| call.replace("NAME", &format!("x{k}"))).collect();
    format!("{open}{innermost}{}", ")".repeat(levels))
}

/// Each surface the envelope of the one before.
fn envelopes(levels: usize) -> String {
    let axes = lines(levels, |k| {
        format!(
            "axis A{k} : rotary\nframe f{} in f{k} = rotate_y(A{k}) translate(1 mm, 2 mm, 3 mm) rotate_z(30 deg)",
            k + 1
        )
    });
    let motions = lines(levels, |k| format!("motion t{k} : angle in 0 deg .. 1 deg\ndrive m.A{k} = t{k}"));
    let surfaces = lines(levels, |k| {
        let tool = if k == 0 { "b.face".to_string() } else { format!("s{}", k - 1) };
        format!("surface s{k} in m.f{} = envelope({tool}, over: t{k})", k + 1)
    });
    format!(
        "machine towers {{ frame f0\n{axes} }}\njob j {{ machine m = towers\ntool b = ball\nmount b on m.f0\n{motions}{surfaces} }}"
    )
}

/// The compilation's findings, and how long it took, also to show what was found.
fn findings(name: &str, text: &str) -> Vec<Diagnostic> {
    let start = Instant::now();
    let graph = Graph::new();
    let compilation = compile_text(&graph, "text", text, &[]);
    let compiled = start.elapsed();
    let shown = render(&compilation.diagnostics, &compilation.sources, false);
    let told = start.elapsed();
    println!(
        "{name}: {compiled:?}, told by {told:?}, {} bytes, {} nodes, {} findings of {} bytes, {} MiB so far",
        text.len(),
        graph.len(),
        compilation.diagnostics.len(),
        shown.len(),
        peak_memory() >> 20,
    );
    assert!(told < SOON, "{name} took {told:?}");
    compilation.diagnostics
}

/// Bytes that the process has held at most; zero where the system does not say.
fn peak_memory() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<usize>().ok()).unwrap_or(0) << 10
}

/// Texts that go beyond a limit.
fn refused() -> Vec<(&'static str, String, Limit)> {
    let doubling = |body: &str| {
        lines(40, |k| {
            let below = k.saturating_sub(1);
            format!(
                "fn f{k}(x: number) = {}",
                if k == 0 { "x".to_string() } else { body.replace("f()", &format!("f{below}")) }
            )
        })
    };
    vec![
        ("functions that call others twice", doubling("f()(x) + f()(x)"), limits::EVALUATION_STEPS),
        (
            "functions that call others twice with different values",
            doubling("f()(x * 1.5) + sin(f()(x + 0.5))"),
            limits::EVALUATION_STEPS,
        ),
        (
            "lists of lists of lists",
            small_job(&format!("let a0 = [1, 2]\n{}", lines(40, |k| format!("let a{} = [a{k}, a{k}]", k + 1)))),
            limits::EVALUATION_STEPS,
        ),
        (
            "a list negated inside lists",
            small_job(&format!("let a0 = [1, 2]\n{}", lines(40, |k| format!("let a{} = [-a{k}, 2 * a{k}]", k + 1)))),
            limits::EVALUATION_STEPS,
        ),
        (
            "many surfaces over a long chain",
            long_machine(3_000)
                + &job(
                    "long(height: 3 mm)",
                    &lines(100, |k| format!("surface s{k} in m.f{} = envelope(b.face, over: turn)", 2_999 - k)),
                ),
            limits::GRAPH_OPERATIONS,
        ),
        ("10²⁰ points", small_job("sample s { u: 0 deg .. 1 deg by 1e20, turn: 1 deg }"), limits::SAMPLE_POINTS),
        (
            "10²⁰ points of an outline",
            small_job(
                "sample s { toe_root: [0 mm, 1 mm] heel_root: [5 mm, 1 mm] toe_tip: [0 mm, 3 mm] heel_tip: [5 mm, 3 mm] profilewise: 0.1 .. 0.9 by 1e10 lengthwise: 0.1 .. 0.9 by 1e10 }",
            ),
            limits::SAMPLE_POINTS,
        ),
        (
            "many large samples",
            small_job(&lines(25, |k| {
                format!(
                    "surface s{k} in m.work = envelope(b.face, over: turn)\nsample s{k} {{ u: 0 deg .. 1 deg by 1000, turn: 1 deg .. 2 deg by 1000 }}"
                )
            })),
            limits::SAMPLE_POINTS,
        ),
        ("too many frames", long_machine(10_001), limits::FRAMES),
        (
            "twenty thousand frames",
            format!(
                "machine m {{ frame f0\n{}}}",
                lines(20_000, |k| format!("frame f{} in f{k} = rotate_x(1 deg)", k + 1))
            ),
            limits::FRAMES,
        ),
        (
            "a million frames by extending",
            format!(
                "machine m {{ frame f\n{}}}\n{}",
                lines(9_000, |k| format!("frame f{k} in f = mirror_x()")),
                lines(10_000, |k| format!("machine m{k} extends m {{}}"))
            ),
            limits::EVALUATION_STEPS,
        ),
        (
            "a million frames by jobs",
            format!(
                "machine m {{ frame f\n{}}}\n{}",
                lines(9_000, |k| format!("frame f{k} in f = mirror_x()")),
                lines(10_000, |k| format!("job j{k} {{ machine n = m }}"))
            ),
            limits::MISTAKES,
        ),
        (
            "thousands of machines that extend each other",
            format!("machine m0 {{ frame f }}\n{}", lines(10_000, |k| format!("machine m{} extends m{k} {{}}", k + 1))),
            limits::EXTENDS_DEPTH,
        ),
        (
            "many axes",
            format!("machine m {{ frame f\n{}}}", lines(20_000, |k| format!("axis a{k} : linear\nfix a{k} = 0 mm"))),
            limits::AXES,
        ),
        (
            "many axes by many machines",
            format!("job j {{ {} }}", lines(3_000, |k| format!("machine m{k} = lathe(height: 3 mm)"))),
            limits::AXES,
        ),
        (
            "many motions",
            small_job(&lines(3_000, |k| format!("motion m{k} : angle in 0 deg .. 1 deg"))),
            limits::MOTIONS,
        ),
        (
            "a surface over many motions",
            small_job(&format!(
                "{}surface t in m.work = envelope(b.face, over: [{}])",
                lines(20, |k| format!("motion m{k} : angle in 0 deg .. 1 deg")),
                lines(20, |k| format!("m{k},"))
            )),
            limits::SURFACE_UNKNOWNS,
        ),
        (
            "powers of powers of a length",
            format!("fn f(x: length) = {}x{}", "(".repeat(6), ")^64".repeat(6)),
            limits::POWER,
        ),
        (
            "a power of a length by multiplying",
            format!(
                "fn f0(x: length) {{ {} a40 }}",
                lines(40, |k| {
                    let before = if k == 0 { "x".to_string() } else { format!("a{k}") };
                    format!("let a{} = {before} * {before}", k + 1)
                })
            ),
            limits::POWER,
        ),
        (
            "a long list of samples",
            small_job(&format!("sample {} {{ z: 0 mm }}", vec!["s"; 20_000].join(", "))),
            limits::JOB_STATEMENTS,
        ),
        (
            "long lists of axes and laws",
            small_job(&format!("drive {} = {}", vec!["m.C"; 10_000].join(", "), vec!["turn"; 10_000].join(", "))),
            limits::JOB_STATEMENTS,
        ),
        (
            "a sum of very many terms",
            small_job("let a = sum(k in 1 .. 1000000000000: k * turn)"),
            limits::EVALUATION_STEPS,
        ),
        (
            "sums of sums of sums",
            small_job("let a = sum(a in 1 .. 1000: sum(b in 1 .. 1000: sum(c in 1 .. 1000: a * b * c * turn)))"),
            limits::EVALUATION_STEPS,
        ),
        (
            "derivatives of derivatives",
            format!(
                "fn d0(x: number) = exp(x * x) / (x + exp(x))\n{}",
                lines(40, |k| format!("fn d{}(x: number) = derivative(d{k}(x), x)", k + 1))
            ),
            limits::EVALUATION_STEPS,
        ),
        (
            "integrals of integrals",
            small_job(&format!(
                "let a = {}",
                nested(8, "integral(NAME in 0 .. 1: ", "exp(turn / 1 rad * x0 * x1 * x2 * x3 * x4 * x5 * x6 * x7)")
            )),
            limits::EVALUATION_STEPS,
        ),
        (
            "thousands of integrals",
            small_job(&lines(3_000, |k| {
                format!("let a{k} = integral(x in 0 .. {}: exp(sin(x * turn) * cos({k} * x * 1 rad)))", k + 1)
            })),
            limits::MISTAKES,
        ),
        (
            "thousands of roots",
            small_job(&lines(3_000, |k| {
                format!("let a{k} = root(x in -3 .. 5: x + 0.5 * sin(x * 1 rad) - turn / 1 rad - {k} / 3000)")
            })),
            limits::EVALUATION_STEPS,
        ),
        (
            "machines that insert into each other",
            format!(
                "machine m0 {{ frame f\nframe g in f = mirror_x() }}\n{}",
                lines(3_000, |k| format!("machine m{} extends m{k} {{ insert i{k} in f = mirror_y() }}", k + 1))
            ),
            limits::EXTENDS_DEPTH,
        ),
        (
            "a loop of seven axes",
            format!(
                "machine arm extends lathe {{ {}frame tip in bed = translate_x(100 mm)\nclose g6 = tip\nclose g5 = tip along x }}\n{}",
                lines(7, |k| format!(
                    "unknown u{k} : rotary in -40 deg .. 40 deg\nframe g{k} in {} = rotate_z(u{k}) rotate_x({k} deg) translate_x(20 mm)",
                    if k == 0 { "bed".to_owned() } else { format!("g{}", k - 1) }
                )),
                job("arm(height: 3 mm)", "")
            ),
            limits::LOOP,
        ),
        (
            "a sum within a sum within a sum",
            small_job(&format!("let a = {}", nested(60, "sum(NAME in 1 .. 3: ", "turn"))),
            limits::EVALUATION_STEPS,
        ),
        (
            "thousands of samples of one surface",
            small_job(&lines(5_000, |k| format!("sample s as p{k} {{ u: 1 deg, turn: 2 deg }}"))),
            limits::JOB_STATEMENTS,
        ),
        (
            "thousands of variants of a long job",
            small_job(&lines(3_000, |k| format!("let a{k} = {k}")))
                + "\n"
                + &lines(10_000, |k| format!("job j{k} = j()")),
            limits::EVALUATION_STEPS,
        ),
        (
            "thousands of jobs that extend each other",
            small_job(&lines(3_000, |k| format!("let a{k} = {k}")))
                + "\n"
                + &lines(10_000, |k| {
                    format!(
                        "job j{k} extends {} {{ let b{k} = {k} }}",
                        match k {
                            0 => "j".to_owned(),
                            _ => format!("j{}", k - 1),
                        }
                    )
                }),
            limits::EVALUATION_STEPS,
        ),
        ("a power of a length by name", format!("fn f(x: {}) = x", ["length^99"; 1_000].join(" * ")), limits::POWER),
        ("a long job", small_job(&lines(20_000, |k| format!("let a{k} = {k}"))), limits::JOB_STATEMENTS),
        ("thousands of jobs' errors", lines(20_000, |k| format!("job j{k} {{ machine m = m{k} }}")), limits::MISTAKES),
        (
            "thousands of unknown names",
            format!("machine m {{ frame f\n{}}}", lines(20_000, |k| format!("let a{k} = b{k}"))),
            limits::MISTAKES,
        ),
        (
            "thousands of unknown functions",
            format!(
                "{}machine m {{ frame f\n{}}}",
                lines(10_000, |k| format!("fn f{k}() = 1")),
                lines(15_000, |k| format!("let a{k} = g{k}()"))
            ),
            limits::MISTAKES,
        ),
        (
            "thousands of unknown parents",
            format!("machine m {{ frame f\n{}}}", lines(9_000, |k| format!("frame f{k} in g{k} = mirror_x()"))),
            limits::MISTAKES,
        ),
        ("thousands of twins", format!("machine m {{ {} }}", "frame f\n".repeat(100_000)), limits::MISTAKES),
        (
            "thousands of mistakes in one line",
            format!("machine m {{ frame f {} }}", "frame g in h ".repeat(50_000)),
            limits::MISTAKES,
        ),
        (
            "thousands of surfaces by a long condition",
            format!(
                "fn f(x: number, y: number) = {}\ntool t {{ {} }}",
                (0..100).map(|k| format!("sin({k} * x * 1 rad) * exp(y / {k}.5)")).collect::<Vec<_>>().join(" + "),
                lines(4_000, |k| {
                    let parameters = ["u", "v", "w"].map(|name| format!("{name}: length in -1 mm .. 1 mm")).join(", ");
                    format!(
                        "surface s{k}({parameters}) {{ at = [u, v, w] body where f(u / 1 mm, v / {k}.5 mm) < w / 1 mm }}"
                    )
                })
            ),
            limits::EVALUATION_STEPS,
        ),
        (
            "a spline through hundreds of points of a sample",
            small_job(
                "sample s as many { u: 0 deg .. 40 deg by 300, turn: 10 deg }\nprofile p { face = spline(many, rho, z) }",
            ),
            limits::SPLINE_POINTS,
        ),
        (
            "thousands of sides of one surface",
            format!(
                "tool t {{ {} surface {}(u: length in 0 mm .. 1 mm, v: length in 0 mm .. 1 mm) for side in [{}] {{ at = [u, v, side * 1 mm] body towards [0, 0, 1] }} }}",
                lines(1_000, |k| format!("let a{k} = {k}")),
                lines(4_000, |k| format!("s{k},")).trim_end().trim_end_matches(','),
                "1, ".repeat(4_000)
            ),
            limits::EVALUATION_STEPS,
        ),
        ("a very long name", format!("machine m {{ frame {} }}", "f".repeat(500_000)), limits::WORD),
        ("a very long number", format!("machine m {{ frame f let a = {} }}", "1".repeat(500_000)), limits::WORD),
        ("a very long path", format!("use \"{}\"", "../".repeat(300_000)), limits::WORD),
        (
            "a copied scope",
            format!(
                "tool t {{ {}{} }}",
                lines(10_000, |k| format!("let a{k} = {k}")),
                lines(4_000, |k| format!(
                    "surface s{k}(u: length in 0 mm .. 1 mm, v: length in 0 mm .. 1 mm) {{ at = [u, v, 0 mm] body towards [0, 0, 1] }}"
                ))
            ),
            limits::EVALUATION_STEPS,
        ),
    ]
}

/// Texts just within the limits.
fn accepted() -> Vec<(&'static str, String)> {
    let mut shared = String::from("let a0 = sin(turn)\n");
    for k in 0..2_000 {
        let _ = writeln!(shared, "let a{} = a{k} * a{k} + a{k}", k + 1);
    }
    vec![
        ("10,000 frames", long_machine(9_990) + &job("long(height: 3 mm)", "")),
        (
            "10,000 frames side by side",
            format!("machine m {{ frame f\n{}}}", lines(9_999, |k| format!("frame f{k} in f = translate_x({k} mm)"))),
        ),
        (
            "20,000 lets",
            format!("machine m {{ frame f\n let a0 = 1 {}}}", lines(20_000, |k| format!("let a{} = a{k} + 1", k + 1))),
        ),
        (
            "10,000 parameters",
            format!(
                "machine p {{ frame f\n {}}}\njob k {{ machine m = p({}) \n tool t = ball mount t on m.f surface s in m.f = move(t.face) }}",
                lines(10_000, |k| format!("param p{k} : length in 0 mm .. 2 cm")),
                lines(10_000, |k| format!("p{k}: 1 mm,"))
            ),
        ),
        ("expressions that share", small_job(&shared)),
        ("a statement of 60,000 words", format!("machine m {{ frame f let a = [{}0] }}", "1, ".repeat(30_000))),
        (
            "a function of many words called often",
            format!(
                "fn f(x: number) = [{}][0]\nmachine m {{ frame f\n{}}}",
                "1 mm, ".repeat(10_000),
                lines(20, |k| format!("let a{k} = f({k})"))
            ),
        ),
        ("envelopes of envelopes", envelopes(6)),
        ("sweeps over seven motions", sweeps(100)),
        (
            "roots of roots",
            small_job(&format!(
                "let a = {}",
                nested(12, "root(NAME in -3 .. 9: NAME + 0.5 * sin(NAME * 1 rad) - ", "turn / 1 rad")
            )),
        ),
        (
            "derivatives of a root and an integral",
            small_job(&format!(
                "let a0 = root(x in -3 .. 5: x + 0.5 * sin(x * 1 rad) - turn / 1 rad) + integral(x in 0 .. 1: exp(x * sin(turn)))\n{}",
                lines(8, |k| format!("let a{} = derivative(a{k}, turn) * 1 rad", k + 1))
            )),
        ),
        (
            "two hundred loops",
            format!(
                "machine arms extends lathe {{ {} }}\n{}",
                lines(200, |k| format!(
                    "unknown u{k} : rotary in -40 deg .. 40 deg\nframe g{k} in bed = rotate_z(u{k}) translate_x(50 mm)\nframe h{k} in bed = rotate_z(C / 3) translate_x(50 mm)\nclose g{k} = h{k} along y"
                )),
                job("arms(height: 3 mm)", "")
            ),
        ),
        (
            "9,000 frames inserted",
            format!(
                "machine a {{ frame f\nframe g in f = mirror_x() }}\nmachine b extends a {{ {} }}",
                lines(9_000, |k| format!("insert i{k} in f = mirror_y()"))
            ),
        ),
        ("an empty file", " ".repeat((1 << 20) - LIBRARY.len() - 1)),
        ("comments", "// nothing\n".repeat(90_000)),
    ]
}

#[test]
fn hostile_texts_are_refused_soon() {
    for (name, text, limit) in refused() {
        let found = findings(name, &format!("{text}\n{LIBRARY}"));
        let table = format!("more than {}", limit.stated());
        let is_told =
            found.iter().any(|finding| finding.code == Code::LimitExceeded && finding.message.contains(&table));
        assert!(is_told, "{name}: {:#?}", &found[..found.len().min(3)]);
        assert!(found.iter().all(|finding| finding.help.is_some() || finding.code != Code::LimitExceeded), "{name}");
    }
    memory_is_bounded();
}

#[test]
fn enormous_texts_compile_soon() {
    for (name, text) in accepted() {
        let found = findings(name, &format!("{text}\n{LIBRARY}"));
        let errors: Vec<&Diagnostic> =
            found.iter().filter(|finding| finding.severity() == flank_chain_dsl::Severity::Error).collect();
        assert!(errors.is_empty(), "{name}: {:#?}", &errors[..errors.len().min(3)]);
    }
    memory_is_bounded();
}

/// What the whole of these tests may hold at one time.
fn memory_is_bounded() {
    assert!(peak_memory() < 700 << 20, "{} MiB", peak_memory() >> 20);
}

#[test]
fn a_long_circle_is_told_briefly() {
    let text = format!(
        "machine m {{ frame f\n{}}}",
        lines(9_000, |k| format!("frame f{k} in f{} = mirror_x()", (k + 1) % 9_000))
    );
    let found = findings("a circle of frames", &text);
    assert_eq!(found.iter().map(|finding| finding.code).collect::<Vec<_>>(), [Code::CyclicFrames]);
    assert!(found[0].message.ends_with(" → f14 → f15 → … → f0"), "{}", found[0].message);
}

/// A text that is being typed ends anywhere, also behind a sign of several bytes: all places that findings name lie between characters.
#[test]
fn findings_of_a_text_that_is_cut_off_lie_between_characters() {
    const JOB: &str = "machine lathe {
    axis C : rotary
    frame bed
    frame work in bed = rotate_z(C)
}
tool ball {
    surface face(u: angle in 0 deg .. 90 deg, v: angle in 0 deg .. 90 deg) {
        at = [cos(u) * cos(v) * 1 mm, sin(u) * 1 mm, sin(v) * 1 mm]
        body towards [0, 0, 1]
    }
}
job thread {
    machine m = lathe
    tool b = ball
    motion turn : angle in 0 deg .. 360 deg
    surface s in m.work = envelope(b.face, over: turn)
    sample s { u: 0 deg .. 80 deg by 3, v: 0 deg .. 80 deg by 3 }
}
";
    for cut in 1..=JOB.len() {
        for sign in ["°", "²", " −", "µ\n"] {
            let graph = Graph::new();
            let text = format!("{}{sign}", &JOB[..cut]);
            let compilation = compile_text(&graph, "cut.chain", &text, &[]);
            assert!(!compilation.diagnostics.is_empty(), "{text}");
            for finding in &compilation.diagnostics {
                let notes = finding.notes.iter().map(|note| note.span);
                let spans = [finding.span].into_iter().chain(notes).chain(finding.cures.iter().map(|cure| cure.span));
                for span in spans {
                    let has_place = [span.start, span.end].iter().all(|at| text.is_char_boundary(*at as usize));
                    assert!(has_place && span.start <= span.end, "{text}\n{finding:?}");
                }
            }
        }
    }
}
