//! NC programs read back by a reader of its own and run through the machine's chain: the flank that they cut is the one that was
//! asked for, but for what their heads state.

mod support;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use flank_chain_dsl::{Compilation, Job, compile_with_machine};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{BoundSurface, Outcome, Range, SurfacePoint, SurfaceProblem};
use support::{flank, folder, text, top};

const JOB: &str = "specs/bevel/thesis_gear.chain";
/// Of the job's cutter: radius at the tips of the outside blades, mm, and their angle.
const OUTSIDE: (f64, f64) = (96.43926979086986, 20.0);

/// Where the axes stand after each move, by address; mm and degrees.
type Positions = Vec<BTreeMap<String, f64>>;

/// A program's moves and its remarks in one line. Reads words of a letter or a name with an equal sign; G00 and G01, absolute, metric.
fn read(program: &str) -> (Positions, String) {
    let (mut positions, mut remarks): (Positions, String) = (Vec::new(), String::new());
    for line in program.lines() {
        let remark = line.strip_prefix("; ").or(line.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')));
        if let Some(remark) = remark {
            let remark = remark.strip_prefix("+ ").unwrap_or(remark);
            remarks = format!("{remarks} {remark}").to_ascii_lowercase();
            continue;
        }
        let mut stand = BTreeMap::new();
        for word in line.split_ascii_whitespace() {
            let (address, value) = word.split_once('=').unwrap_or_else(|| word.split_at(1));
            if let (true, Ok(value)) = ("XYZABCUVW".contains(&address[..1]), value.parse()) {
                stand.insert(address.to_string(), value);
            }
        }
        if !stand.is_empty() {
            positions.push(stand);
        }
    }
    (positions, remarks)
}

/// The two numbers of the sentence on deviations, together, mm.
fn stated(remarks: &str) -> f64 {
    let numbers = remarks.split("off by up to ").nth(1).expect("the head states it");
    let numbers: Vec<f64> = numbers.split(' ').filter_map(|word| word.parse().ok()).take(2).collect();
    1e-3 * (numbers[0] + numbers[1])
}

struct Machine<'g> {
    job: Job<'g>,
    /// Of the axes: position of the cutter's origin in the work, then its rotation row by row.
    pose: Tape,
    axes: Vec<(String, bool)>,
}

fn machine<'g>(graph: &'g Graph, file: &str) -> Machine<'g> {
    let Compilation { mut jobs, machine, diagnostics, .. } =
        compile_with_machine(graph, &top().join(JOB), &top().join(file), &[]);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    let standing = machine.expect("no error");
    let machine = &standing.machines[0];
    let chain = machine.chain(graph, "work", "cutter").expect("both frames").substituted(&standing.bindings());
    let pose = chain.pose();
    let outputs: Vec<Expr<'g>> = pose.translation.0.into_iter().chain(pose.rotation.entries()).collect();
    let variables: Vec<Expr<'g>> = machine.axes.iter().map(|axis| axis.variable).collect();
    let axes = machine.axes.iter().map(|axis| (axis.name.clone(), axis.travel.is_none() || "ABC".contains(&axis.name)));
    let axes = axes.collect();
    Machine { job: jobs.swap_remove(0), pose: Tape::new(&outputs, &variables).expect("all bound"), axes }
}

/// The sampled points of the flank that the outside blades cut.
fn flank_points(job: &Job<'_>) -> Vec<SurfacePoint> {
    let surface = job.surfaces.iter().find(|surface| surface.name == "concave").expect("it is in the job");
    let sample = surface.sample.as_ref().expect("points are asked for");
    let coordinates = sample.functions();
    let ranges: Vec<Range> = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    let points = problem.solve(&sample.targets(), sample.counts).0;
    assert!(points.iter().all(|point| point.outcome == Outcome::Solved));
    points
}

/// How far a point of the work lies outside the cone of the outside blades, mm, while the cutter stands somewhere.
fn outside(point: [f64; 3], pose: &[f64]) -> f64 {
    let from: Vec<f64> = (0..3).map(|i| point[i] - pose[i]).collect();
    let seen: Vec<f64> = (0..3).map(|j| (0..3).map(|i| pose[3 + 3 * i + j] * from[i]).sum()).collect();
    let (radius, angle) = (OUTSIDE.0, OUTSIDE.1.to_radians());
    (seen[0].hypot(seen[1]) - radius + seen[2] * angle.tan()) * angle.cos()
}

/// The largest distance between the asked flank and what the cutter leaves of a body while the axes run straight from position to
/// position: how near it comes to each point, or how deep it cuts.
fn deviation(machine: &Machine<'_>, stands: &[Vec<f64>]) -> f64 {
    const STEPS: usize = 40;
    let mut evaluator = ScalarEvaluator::new(&machine.pose);
    let mut poses: Vec<[f64; 12]> = Vec::new();
    for pair in stands.windows(2) {
        for step in 0..STEPS {
            let share = step as f64 / STEPS as f64;
            let axes: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + share * (b - a)).collect();
            let mut pose = [0.0; 12];
            evaluator.run(&axes, &mut pose);
            poses.push(pose);
        }
    }
    let points = flank_points(&machine.job);
    let nearest =
        points.iter().map(|point| poses.iter().map(|pose| outside(point.position, pose)).fold(f64::INFINITY, f64::min));
    nearest.fold(0.0, |most: f64, near| most.max(near.abs()))
}

/// Programs of a machine whose axes have their own names, and of one that has other words for them.
#[test]
fn programs_cut_the_asked_flank() {
    let out = folder("nc");
    let table = std::fs::read_to_string(top().join("specs/machines/free_form.chain")).expect("it is shipped");
    let words = "machine relabelled extends free_form {\n    nc B  = 90 deg - B by 0.0001 deg\n    nc C1 = -C\n    nc Y  = -Y by 1 um\n}\n";
    let relabelled = support::written(&out, "relabelled.chain", &format!("{table}{words}"));
    let plain = |_: &str, x: f64| x;
    let other = |address: &str, x: f64| match address {
        "B" => 90.0 - x,
        "C" | "Y" => -x,
        _ => x,
    };
    type Read = fn(&str, f64) -> f64;
    let runs: [(&str, &str, &str, Read); 5] = [
        ("specs/machines/free_form.chain", "fanuc", "nc", plain),
        ("specs/machines/free_form.chain", "siemens", "mpf", plain),
        ("specs/machines/free_form.chain", "linuxcnc", "ngc", plain),
        ("specs/machines/free_form.chain", "heidenhain", "h", plain),
        (&relabelled, "siemens", "mpf", other),
    ];
    for (to, control, extension, count) in runs {
        let arguments = ["convert", JOB, "--to", to, "--nc", control, "--time", "30", "--positions", "201"];
        let run = flank(&[&arguments[..], &["--surface", "concave", "--out", out.to_str().unwrap()]].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let name = if to == relabelled { "relabelled" } else { "free_form" };
        let program = std::fs::read_to_string(out.join(format!("thesis_gear_on_{name}.{extension}"))).unwrap();
        let (positions, remarks) = read(&program);
        assert_eq!(positions.len(), 201, "{control}");
        let graph = Graph::new();
        let machine = machine(&graph, "specs/machines/free_form.chain");
        let stand = |position: &BTreeMap<String, f64>| -> Vec<f64> {
            let of = |(axis, is_rotary): &(String, bool)| {
                let written =
                    position.get(axis).or(position.get(&format!("{axis}1"))).expect("each axis in each block");
                let value = count(axis, *written);
                if *is_rotary { value.to_radians() } else { value }
            };
            machine.axes.iter().map(of).collect()
        };
        let found = deviation(&machine, &positions.iter().map(stand).collect::<Vec<_>>());
        let stated = stated(&remarks);
        // half the sub-step of the scan here, 2e-7 mm, is not the program's
        assert!(found < stated + 2e-7, "{control} on {name}: {found:e} mm, stated {stated:e}");
        // and what is stated is not just large
        assert!(stated < 1e-3 && found > 0.02 * stated, "{control} on {name}: {found:e} mm, stated {stated:e}");
    }
}

/// Debian's LinuxCNC has its interpreter as a program: what it understands are the positions of the table.
#[test]
fn linuxcnc_understands_its_program() {
    if Command::new("rs274").arg("-h").output().is_err() {
        eprintln!("skipped 1 test: rs274 of linuxcnc-uspace is not installed");
        return;
    }
    let out = folder("rs274");
    let arguments = ["convert", JOB, "--to", "specs/machines/free_form.chain", "--nc", "linuxcnc", "--time", "30"];
    let run = flank(&[&arguments[..], &["--surface", "concave", "--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let program = out.join("thesis_gear_on_free_form.ngc");
    let told = interpreted(&out, &program);
    let (positions, _) = read(&std::fs::read_to_string(&program).unwrap());
    let fed: Vec<Vec<f64>> = told
        .lines()
        .filter_map(|line| line.split("STRAIGHT_FEED(").nth(1))
        .map(|numbers| numbers.trim_end_matches(')').split(',').map(|x| x.trim().parse().expect("a number")).collect())
        .collect();
    assert_eq!(fed.len(), positions.len() - 1, "{told}");
    for (fed, position) in fed.iter().zip(&positions[1..]) {
        for (found, axis) in fed.iter().zip(["X", "Y", "Z", "A", "B", "C"]) {
            // the interpreter prints four decimals
            assert!((found - position[axis]).abs() < 1e-4, "{axis}: {found} instead of {}", position[axis]);
        }
    }
}

/// Remarks that begin with a path's words: the interpreter obeys none of them, and reads the same positions.
#[test]
fn linuxcnc_takes_no_orders_from_a_path() {
    if Command::new("rs274").arg("-h").output().is_err() {
        eprintln!("skipped 1 test: rs274 of linuxcnc-uspace is not installed");
        return;
    }
    let out = folder("rs274_path");
    let job = support::self_contained(&[
        "functions/bevel",
        "machines/cradle",
        "machines/cradle_tilt",
        "tools/face_mill",
        "functions/blanks_19x62",
        "bevel/gear_19x62",
        "bevel/thesis_gear",
    ]);
    let mut told = Vec::new();
    for words in ["plain ".repeat(12), "LOGOPEN,opened.txt ".repeat(12), "ABORT,no ".repeat(20), "PY,1 ".repeat(40)] {
        let named = out.join(&words);
        std::fs::create_dir(&named).expect("the test's folder");
        let spec = support::written(&named, "thesis_gear.chain", &job);
        let arguments =
            ["convert", &spec, "--to", "specs/machines/free_form.chain", "--nc", "linuxcnc", "--time", "30"];
        let of = ["--job", "thesis_gear", "--surface", "concave", "--out", out.to_str().unwrap()];
        let run = flank(&[&arguments[..], &of].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let read = interpreted(&out, &out.join("thesis_gear_on_free_form.ngc"));
        told.push(read.lines().filter(|line| line.contains("STRAIGHT_FEED")).map(str::to_owned).collect::<Vec<_>>());
        assert!(!out.join("opened.txt").exists() && !top().join("crates/cli/opened.txt").exists(), "{words}");
    }
    assert!(!told[0].is_empty() && told.windows(2).all(|pair| pair[0].len() == pair[1].len()), "{told:?}");
}

/// The interpreter runs once at a time.
static INTERPRETER: Mutex<()> = Mutex::new(());

/// What the interpreter makes of a program.
fn interpreted(folder: &Path, program: &Path) -> String {
    let _alone = INTERPRETER.lock().unwrap_or_else(PoisonError::into_inner);
    let tools = support::written(folder, "tool.tbl", "T1 P1 D10.0 Z0.0 ;cutter\n");
    let variables = support::written(folder, "v.var", "5161 0\n5220 1\n");
    let arguments = ["-g", "-t", &tools, "-v", &variables, program.to_str().expect("a plain path")];
    let run = Command::new("rs274").args(arguments).current_dir(folder).output().expect("it is installed");
    let told = format!("{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{}: {told}", run.status);
    told
}
