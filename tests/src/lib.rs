//! What the tests of flank as a whole share: specs solved at given points, reference tables read.

pub mod bodies;
pub mod compiled;
pub mod conversion;
pub mod deck;
mod dice;
pub mod layout;
pub mod machines;
pub mod pairs;
pub mod resampled;
pub mod targets;
pub mod variants;

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Compilation, Dimension, GeneratedSurface, Job, compile_file, compile_text, render};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{
    BoundSurface, Outcome, PointGeometry, Range, SurfaceGeometry, SurfacePoint, SurfaceProblem, solve_grid,
};
use serde_json::Value;

pub use dice::Dice;

/// A path below the repository's top folder.
pub fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// The pages of the book in `docs/`, in the order of their paths, without those on errors: each of these has a test of
/// its own.
///
/// # Panics
/// If the folder cannot be read.
pub fn pages() -> Vec<PathBuf> {
    let errors = repository("docs/errors");
    markdown(&repository("docs")).into_iter().filter(|page| !page.starts_with(&errors)).collect()
}

/// All pages of the repository that people read.
///
/// # Panics
/// If a folder cannot be read.
pub fn all_pages() -> Vec<PathBuf> {
    let top = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(repository);
    top.into_iter().chain(markdown(&repository("docs"))).collect()
}

fn markdown(folder: &Path) -> Vec<PathBuf> {
    files(folder, "md")
}

/// All specs of the library, as paths from the repository's top folder.
///
/// # Panics
/// If a folder cannot be read.
pub fn shipped() -> Vec<String> {
    let top = repository("");
    let below = |path: PathBuf| path.strip_prefix(&top).map(|path| path.display().to_string());
    files(&repository("specs"), "chain").into_iter().map(|path| below(path).expect("it is below")).collect()
}

/// The files of a folder and of those below that have an extension, in the order of their paths.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let below = |path: PathBuf| match path.extension() {
        _ if path.is_dir() => files(&path, extension),
        Some(own) if own == extension => vec![path],
        _ => Vec::new(),
    };
    paths.into_iter().flat_map(below).collect()
}

/// The first job of a spec, with some values replaced.
///
/// # Panics
/// With the diagnostics, if there are errors.
pub fn job<'g>(graph: &'g Graph, spec: &str, set: &[(&str, &str)]) -> Job<'g> {
    jobs(graph, spec, set).swap_remove(0)
}

/// One of several jobs of a spec, with some values replaced.
///
/// # Panics
/// With the diagnostics, if there are errors; if there is no such job.
pub fn job_named<'g>(graph: &'g Graph, spec: &str, name: &str, set: &[(&str, &str)]) -> Job<'g> {
    jobs(graph, spec, set).into_iter().find(|job| job.name == name).expect("the job is in the spec")
}

/// All jobs of a spec, with some values replaced.
///
/// # Panics
/// With the diagnostics, if there are errors.
pub fn jobs<'g>(graph: &'g Graph, spec: &str, set: &[(&str, &str)]) -> Vec<Job<'g>> {
    let set: Vec<(String, String)> = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    right(compile_file(graph, &repository(spec), &set), spec)
}

fn right<'g>(compilation: Compilation<'g>, what: &str) -> Vec<Job<'g>> {
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert!(!compilation.has_errors(), "{what} is wrong:\n{told}");
    compilation.jobs
}

/// The first job of a text.
///
/// # Panics
/// With the diagnostics, if there are errors.
pub fn job_of_text<'g>(graph: &'g Graph, text: &str) -> Job<'g> {
    right(compile_text(graph, "text", text, &[]), "the text").swap_remove(0)
}

/// Specs given by their paths below `specs`, as one text: what a file uses must stand there, too. Expectations that need other files
/// are left out.
///
/// # Panics
/// If one cannot be read.
pub fn library(paths: &[&str]) -> String {
    let read = |path: &&str| std::fs::read_to_string(repository("specs").join(path)).expect("the spec is there");
    let all: String = paths.iter().map(read).collect();
    let needs_files = |line: &str| line.contains(" near table(") || line.trim_start().starts_with("expect on ");
    let lines = all.lines().filter(|line| !line.starts_with("use ") && !line.starts_with("//!") && !needs_files(line));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Points of a surface at given values of two of its coordinates, in the order given.
///
/// # Panics
/// If there is no such surface or coordinate.
pub fn points(job: &Job<'_>, surface: &str, coordinates: [&str; 2], targets: &[[f64; 2]]) -> Vec<SurfacePoint> {
    let (problem, surface) = asked(job, surface, coordinates);
    // a reference's points are no grid: of several branches the one is taken that reaches them all
    let (solutions, _) = solve_grid(problem.system(), &ranges(surface), targets, [1, targets.len()]);
    problem.points(&solutions)
}

/// The same as `flank solve` does it: on the branch that the surface's sample keeps, where the targets are the rows of a
/// lattice, each of so many columns.
///
/// # Panics
/// If there is no such surface or coordinate, or the last row is not full.
pub fn grid(
    job: &Job<'_>,
    surface: &str,
    coordinates: [&str; 2],
    targets: &[[f64; 2]],
    columns: usize,
) -> Vec<SurfacePoint> {
    assert_eq!(targets.len() % columns, 0, "full rows");
    asked(job, surface, coordinates).0.solve(targets, [targets.len() / columns, columns]).0
}

fn asked<'j, 'g>(
    job: &'j Job<'g>,
    surface: &str,
    coordinates: [&str; 2],
) -> (SurfaceProblem, &'j GeneratedSurface<'g>) {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let values = coordinates.map(|name| surface.coordinate(name).expect("a coordinate of the surface").value);
    (problem(job, surface, values), surface)
}

fn ranges(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect()
}

/// Where `flank solve` follows a surface beyond its ranges.
pub fn followed(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    let at_least = |dimension| if dimension == Dimension::ANGLE { std::f64::consts::TAU } else { 0.0 };
    let wider = surface.unknowns.iter().zip(ranges(surface));
    wider.map(|(u, range)| if u.is_count { range } else { range.beyond(at_least(u.dimension)) }).collect()
}

/// A surface with the values of the job's parameters.
pub fn bound<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>) -> BoundSurface<'g> {
    BoundSurface::new(&surface.surface, ranges(surface), &job.bindings())
}

/// What `flank solve` solves: points of a surface at values of two coordinates, on the branch that its sample keeps.
///
/// # Panics
/// If a variable is not bound.
pub fn problem<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>, coordinates: [Expr<'g>; 2]) -> SurfaceProblem {
    let kept = surface.sample.iter().flat_map(|sample| &sample.keep);
    let keep: Vec<_> = kept.map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
    let bound = bound(job, surface);
    let problem = SurfaceProblem::new(&bound, coordinates);
    let problem = problem.map(|problem| problem.following_beyond(followed(surface)));
    let problem = problem.and_then(|problem| problem.keeping(&bound, &keep));
    problem.expect("nothing is unbound")
}

/// The points that a surface's sample asks for, as `flank solve` finds them.
///
/// # Panics
/// If there is no such surface, or nothing is asked of it.
pub fn sampled(job: &Job<'_>, surface: &str) -> Vec<SurfacePoint> {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let sample = surface.sample.as_ref().expect("points are asked for");
    let coordinates = sample.functions();
    problem(job, surface, coordinates).solve(&sample.targets(), sample.counts).0
}

/// A vector turned about z.
pub fn turned(v: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos, v[2]]
}

/// A surface at values of its unknowns that another source says solve its equations.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// Position, mm.
    pub position: [f64; 3],
    /// Unit normal.
    pub normal: [f64; 3],
    /// The largest of the constraints.
    pub residual: f64,
    /// Curvatures, contact, metric in z and rho.
    pub geometry: PointGeometry,
}

/// A surface of a job at values of its unknowns.
///
/// # Panics
/// If there is no such surface.
pub fn evaluated(job: &Job<'_>, surface: &str, unknowns: &[Vec<f64>]) -> Vec<Evaluated> {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let [z, rho] = ["z", "rho"].map(|name| surface.coordinate(name).expect("every surface has it").value);
    let bound = bound(job, surface);
    let geometry = SurfaceGeometry::new(&bound, &surface.generation.motions, [z, rho]).expect("all bound");
    let made = bound.surface();
    let outputs = made.position.0.into_iter().chain(made.normal.0).chain(made.constraints.iter().copied());
    let outputs: Vec<Expr<'_>> = outputs.collect();
    let tape = Tape::new(&outputs, &made.unknowns).expect("all bound");
    let evaluate = |at: &Vec<f64>| {
        let mut out = vec![0.0; tape.output_count()];
        ScalarEvaluator::new(&tape).run(at, &mut out);
        let vector = |first: usize| [out[first], out[first + 1], out[first + 2]];
        let residual = difference(&out[6..], &vec![0.0; out.len() - 6]);
        Evaluated { position: vector(0), normal: vector(3), residual, geometry: geometry.at(at) }
    };
    unknowns.iter().map(evaluate).collect()
}

/// A JSON file of `tests/reference`.
///
/// # Panics
/// If it cannot be read.
pub fn reference_json(name: &str) -> Value {
    let text = std::fs::read_to_string(repository("tests/reference").join(name)).expect("the reference file is there");
    serde_json::from_str(&text).expect("the reference file is JSON")
}

/// A CSV file of `tests/reference`: one function of column names to numbers for each row.
///
/// # Panics
/// If it cannot be read.
pub fn reference_csv(name: &str) -> Vec<Row> {
    let mut reader =
        csv::Reader::from_path(repository("tests/reference").join(name)).expect("the reference file is there");
    let headers: Vec<String> = reader.headers().expect("a head").iter().map(str::to_string).collect();
    reader
        .records()
        .map(|record| {
            let values = record.expect("a row").iter().map(|cell| cell.parse().expect("a number")).collect();
            Row { headers: headers.clone(), values }
        })
        .collect()
}

/// One row of a reference table.
#[derive(Clone, Debug)]
pub struct Row {
    headers: Vec<String>,
    values: Vec<f64>,
}

impl Row {
    /// The number in a column.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn get(&self, column: &str) -> f64 {
        let index = self.headers.iter().position(|header| header == column).expect("the column is there");
        self.values[index]
    }
}

/// A number of a JSON object.
///
/// # Panics
/// If it is not there.
pub fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key} is a number"))
}

/// A vector of a JSON object.
///
/// # Panics
/// If it is not there.
pub fn vector(row: &Value, key: &str) -> [f64; 3] {
    std::array::from_fn(|k| row[key][k].as_f64().unwrap_or_else(|| panic!("{key} is a vector")))
}

/// The largest difference of two vectors' components; NaN if any is.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "vectors of one length");
    largest(a.iter().zip(b).map(|(x, y)| (x - y).abs()))
}

/// The largest of some sizes, zero of none; NaN if any is.
pub fn largest(sizes: impl IntoIterator<Item = f64>) -> f64 {
    sizes.into_iter().fold(0.0, |most, size| if size.is_nan() || size > most { size } else { most })
}

/// Asserts that a point was solved, lies at `position` and has `normal`, to 1e-9 mm and 1e-9: the bound that every
/// derived surface has to meet; reference tables carry 12 decimals or more.
pub fn assert_point(point: &SurfacePoint, position: [f64; 3], normal: [f64; 3], what: &str) {
    const BOUND: f64 = 1e-9;
    assert_eq!(point.outcome, Outcome::Solved, "{what}");
    let (off, turned) = (difference(&point.position, &position), difference(&point.normal, &normal));
    assert!(off <= BOUND, "{what}: position {:?} is {off:e} mm from {position:?}", point.position);
    assert!(turned <= BOUND, "{what}: normal {:?} is {turned:e} from {normal:?}", point.normal);
}

/// A vector turned round: reference normals point out of the tool, flank's out of the gear.
pub fn reversed(v: [f64; 3]) -> [f64; 3] {
    v.map(|component| -component)
}
