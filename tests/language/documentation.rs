//! Every block of the documentation means what its page says.

use std::fs;
use std::path::{Path, PathBuf};

use flank_chain_dsl::{Compilation, GeneratedSurface, Job, Severity, compile_file, compile_text, render};
use flank_expr::Graph;
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{assert_point, pages, problem, repository};

struct Block {
    line: usize,
    text: String,
    /// The code that it must give, if it is one of the wrong ones.
    wrong: Option<String>,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut announced = None;
    let mut open: Option<Block> = None;
    for (index, line) in page.lines().enumerate() {
        if let Some(code) = line.strip_prefix("Error ").and_then(|rest| rest.strip_suffix(':')) {
            announced = Some(code.to_string());
        }
        match (&mut open, line.trim()) {
            (None, "```chain") => open = Some(Block { line: index + 1, text: String::new(), wrong: None }),
            (None, "```chain,wrong") => {
                let wrong = Some(announced.take().expect("a wrong block has its error above it"));
                open = Some(Block { line: index + 1, text: String::new(), wrong });
            }
            (None, fence) => assert!(!fence.starts_with("```chain"), "line {}: no such kind of block", index + 1),
            (Some(_), "```") => blocks.extend(open.take()),
            (Some(block), _) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

fn read(page: &Path) -> String {
    fs::read_to_string(page).expect("the page is there")
}

/// The right blocks of a page as one text, by a blank line apart.
fn whole(page: &Path) -> String {
    let right = blocks(&read(page)).into_iter().filter(|block| block.wrong.is_none());
    right.map(|block| block.text).collect::<Vec<_>>().join("\n")
}

/// A project folder of its own with a copy of the library, in which texts of pages stand as files at the top.
struct Project(PathBuf);

impl Project {
    fn new(name: &str) -> Project {
        let top = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        if top.exists() {
            fs::remove_dir_all(&top).expect("the last run's folder can go");
        }
        copy(&repository("specs"), &top.join("specs"));
        fs::write(top.join("flank.toml"), "").expect("the folder can be written to");
        Project(top)
    }

    fn compile<'g>(&self, graph: &'g Graph, text: &str) -> Compilation<'g> {
        let file = self.0.join("page.chain");
        fs::write(&file, text).expect("the folder can be written to");
        compile_file(graph, &file, &[])
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("the folder can be made");
    for entry in fs::read_dir(from).expect("the folder is there") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).expect("the file can be copied");
        }
    }
}

/// A block is compiled together with the right ones before it on its page, in the repository's top folder.
#[test]
fn blocks_compile_one_after_the_other() {
    let project = Project::new("blocks");
    let mut count = 0;
    for page in pages() {
        let shown = page.display();
        let mut so_far = String::new();
        for block in blocks(&read(&page)) {
            count += 1;
            let text = format!("{so_far}\n{}", block.text);
            let graph = Graph::new();
            let compilation = project.compile(&graph, &text);
            let told = render(&compilation.diagnostics, &compilation.sources, false);
            let errors: Vec<&str> = compilation
                .diagnostics
                .iter()
                .filter(|finding| finding.severity() == Severity::Error)
                .map(|finding| finding.code.as_str())
                .collect();
            match block.wrong {
                Some(code) => assert_eq!(errors, [code], "{shown}, block at line {}:\n{told}", block.line),
                None => {
                    assert!(compilation.diagnostics.is_empty(), "{shown}, block at line {}:\n{told}", block.line);
                    so_far = text;
                }
            }
        }
    }
    assert!(count >= 20, "the pages have their blocks: {count}");
}

/// The page on the language needs nothing but itself.
#[test]
fn the_language_stands_alone() {
    let graph = Graph::new();
    let compilation = compile_text(&graph, "docs/language.md", &whole(&repository("docs/language.md")), &[]);
    assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
}

/// The points that a surface is asked for.
fn solved(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Vec<SurfacePoint> {
    let Some(sample) = &surface.sample else { return Vec::new() };
    let coordinates = sample.functions();
    problem(job, surface, coordinates).solve(&sample.targets(), sample.counts).0
}

/// All surfaces of a job on a page with their points.
fn surfaces_of(page: &str, name: &str) -> Vec<Vec<SurfacePoint>> {
    let graph = Graph::new();
    let jobs = Project::new(name).compile(&graph, &whole(&repository(page))).jobs;
    let job = jobs.iter().find(|job| job.name == name).expect("the job is on the page");
    job.surfaces.iter().map(|surface| solved(job, surface)).collect()
}

/// Every point that a page asks for is there.
#[test]
fn samples_are_solved() {
    let project = Project::new("samples");
    for page in pages() {
        let graph = Graph::new();
        for job in project.compile(&graph, &whole(&page)).jobs {
            for surface in &job.surfaces {
                let lost = solved(&job, surface).iter().filter(|point| point.outcome != Outcome::Solved).count();
                assert_eq!(lost, 0, "{}: {} of job {}", page.display(), surface.name, job.name);
            }
        }
    }
}

/// The tutorial's closed form: each normal touches the base circle.
#[test]
fn the_first_gear_is_an_involute() {
    for points in surfaces_of("docs/tutorial.md", "first_gear") {
        assert_eq!(points.len(), 45);
        for SurfacePoint { position: [x, y, _], normal: [nx, ny, _], .. } in points {
            let moment = (x * ny - y * nx).abs();
            assert!((moment - 40.0 * 20f64.to_radians().cos()).abs() < 1e-12, "{moment}");
        }
    }
}

/// Theory: a cradle machine and its conversion to a free-form machine.
#[test]
fn two_machines_cut_one_flank() {
    let surfaces = surfaces_of("docs/theory.md", "two_machines");
    let [on_cradle, on_free_form] = surfaces.as_slice() else { panic!("two surfaces") };
    assert_eq!(on_cradle.len(), 119);
    for (a, b) in on_cradle.iter().zip(on_free_form) {
        assert_point(b, a.position, a.normal, "the same point");
    }
}

/// The tutorial builds up the file that ships.
/// How many lines a script and a spec take that do the same, as the tour says: lines with code.
#[test]
fn the_tour_counts_the_lines_of_both() {
    let read = |path: &str| fs::read_to_string(repository(path)).expect("the file is there");
    let (script, spec) = (read("benches/peers/spiral_bevel_casadi.py"), read("benches/spiral_bevel.chain"));
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with(['#', '/']);
    // every other piece between three quotes is a remark
    let script = script.split("\"\"\"").step_by(2).collect::<String>();
    let of_main = script.split_once("\ndef main").expect("the script has a main function").1;
    let count = |text: &str| text.lines().filter(is_code).count();
    let (all, of_main) = (count(&script), count(&format!("def main{of_main}")));
    // without the job that asks for the same surface by other coordinates
    let spec = count(spec.split_once("job grid").expect("the spec has a second job").0);
    let told = format!("| {all}, of which {of_main} for arguments, targets and timing | {spec} |");
    assert!(read("docs/tour.md").contains(&told), "{told}");
}

#[test]
fn the_tutorial_ends_with_its_file() {
    let shipped = read(&repository("specs/tutorial/first_gear.chain"));
    assert_eq!(whole(&repository("docs/tutorial.md")), shipped);
}
