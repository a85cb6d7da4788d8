//! What `flank derive` prints is true: the printed text is read back, its expressions are evaluated at values at random, and
//! matrices, product, vector part, twists and equation of meshing are held against products of plain numbers.

#[path = "../../crates/expr/tests/printing/parser.rs"]
mod parser;

use std::collections::HashMap;

use flank_chain_dsl::derivation;
use flank_expr::{Graph, Style};
use flank_tests::job;
use nalgebra::{Matrix4, Rotation3, Translation3, Vector3};

/// One printed equation or matrix: its name and its value at the values so far.
type Stage = (String, Vec<f64>);

/// Reads a page from one line to another; definitions (`t1 = …`) hold for what follows them.
fn stages(page: &str, from: &str, to: &str, values: &HashMap<String, f64>) -> Vec<Stage> {
    let section = &page[page.find(from).expect("the section begins")..];
    let section = &section[..section.find(to).expect("the section ends")];
    let mut known = values.clone();
    let mut found: Vec<Stage> = Vec::new();
    for line in section.lines().filter(|line| line.starts_with("  ")) {
        let value = |text: &str| {
            let names = known.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            parser::value(text, &names)
        };
        let row = |text: &str| -> Vec<f64> {
            let inner = text.trim().trim_start_matches('[').trim_end_matches(']');
            inner.split("  ").filter(|entry| !entry.trim().is_empty()).map(|entry| value(entry.trim())).collect()
        };
        if line.trim_start().starts_with('[') {
            found.last_mut().expect("a first row").1.extend(row(line));
        } else if let Some(left) = line.strip_suffix(" = 0") {
            found.push(("meshing".to_string(), vec![value(left)]));
        } else if let Some((name, right)) = line.split_once(" = ") {
            let right = right.split("   (").next().unwrap_or(right);
            if right.starts_with('[') {
                found.push((name.trim().to_string(), row(right)));
            } else {
                let result = value(right);
                known.insert(name.trim().to_string(), result);
                found.push((name.trim().to_string(), vec![result]));
            }
        }
    }
    found
}

fn all<'s>(stages: &'s [Stage], name: &str) -> Vec<&'s [f64]> {
    stages.iter().filter(|(stage, _)| stage == name).map(|(_, values)| values.as_slice()).collect()
}

fn assert_near(a: &[f64], b: &[f64], bound: f64, what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() <= bound, "{what}: {a:?} is not {b:?}");
    }
}

fn rows(matrix: &Matrix4<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

/// The six-axis machine by hand: bed, slide, head, hob; and the table.
fn table_to_hob(axes: &HashMap<String, f64>) -> [Matrix4<f64>; 6] {
    let axis = |name: &str| axes[&format!("m.{name}")];
    let turn = |about, angle| Rotation3::from_axis_angle(&about, angle).to_homogeneous();
    let (x, z) = (Vector3::x_axis(), Vector3::z_axis());
    [
        turn(z, -axis("C")),
        Translation3::new(axis("X"), 0.0, axis("Z")).to_homogeneous(),
        turn(x, axis("A")),
        Translation3::new(0.0, axis("Y"), 0.0).to_homogeneous(),
        turn(x, -std::f64::consts::FRAC_PI_2),
        turn(z, axis("B")),
    ]
}

struct Page {
    text: String,
    parameters: HashMap<String, f64>,
}

impl Page {
    /// The axes' laws as they are printed, at values of the motions.
    fn axes(&self, spindle: f64, feed: f64) -> HashMap<String, f64> {
        let mut values = self.parameters.clone();
        values.insert("spindle".to_string(), spindle);
        values.insert("feed".to_string(), feed);
        let found = stages(&self.text, "\naxes:", "\nsurface ", &values);
        values.extend(found.into_iter().map(|(name, value)| (name, value[0])));
        values
    }

    fn pose(&self, spindle: f64, feed: f64) -> Matrix4<f64> {
        table_to_hob(&self.axes(spindle, feed)).iter().product()
    }
}

#[test]
fn the_stages_of_the_six_axis_machine_are_products_of_its_matrices() {
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/helical_gear.chain", &[("hob_shift", "-7.3 mm"), ("helix_angle", "-17 deg")]);
    let parameters = job.parameters.iter().map(|parameter| (parameter.name.clone(), parameter.value)).collect();
    let page = Page { text: derivation(&job, Style::Text), parameters };
    for (spindle, feed, xi, tau) in [(1.3, -4.0, 4.4, 0.7), (4.1, 11.5, 5.0, -2.1), (-0.6, 0.3, 3.9, 1.9)] {
        let mut values = page.axes(spindle, feed);
        values.extend([("xi".to_string(), xi), ("tau".to_string(), tau)]);
        let found = stages(&page.text, "\nsurface lower_flank", "\nsurface upper_flank", &values);

        let steps = table_to_hob(&values);
        let pose = page.pose(spindle, feed);
        let matrices = all(&found, "M");
        assert_eq!(matrices.len(), steps.len() + 1);
        for (printed, step) in matrices.iter().zip(&steps) {
            assert_near(printed, &rows(step), 1e-14, "elementary matrix");
        }
        assert_near(matrices[6], &rows(&pose), 1e-12, "product");
        let rotation = pose.fixed_view::<3, 3>(0, 0).into_owned();
        assert_near(all(&found, "L")[0], rotation.transpose().as_slice(), 1e-14, "vector part");

        let vector = |name: &str, k: usize| Vector3::from_column_slice(all(&found, name)[k]);
        let (r, n) = (vector("r_t", 0), vector("n_t", 0));
        assert!((n.norm() - 1.0).abs() < 1e-14);
        let h = 1e-5;
        for (k, (by_spindle, by_feed)) in [(h, 0.0), (0.0, h)].into_iter().enumerate() {
            let ahead = page.pose(spindle + by_spindle, feed + by_feed);
            let behind = page.pose(spindle - by_spindle, feed - by_feed);
            let twist = pose.try_inverse().expect("a rigid motion") * (ahead - behind) / (2.0 * h);
            let (omega, v) = (vector("omega", k), vector("v", k));
            assert_near(omega.as_slice(), &[twist[(2, 1)], twist[(0, 2)], twist[(1, 0)]], 1e-8, "angular");
            assert_near(v.as_slice(), &[twist[(0, 3)], twist[(1, 3)], twist[(2, 3)]], 1e-8, "linear");
            let meshing = n.dot(&(omega.cross(&r) + v));
            assert_near(all(&found, "meshing")[k], &[meshing], 1e-12, "equation of meshing");
        }

        let in_work = pose * r.push(1.0);
        assert_near(all(&found, "r")[0], &in_work.as_slice()[..3], 1e-12, "position");
        assert_near(all(&found, "n")[0], (-(rotation * n)).as_slice(), 1e-14, "normal");
    }
}

/// Brackets of all kinds and environments are closed in their order, and nothing special of LaTeX stands bare in a text.
#[test]
fn latex_is_balanced() {
    for spec in ["specs/hobbing/helical_gear.chain", "specs/hobbing/spur_gear.chain", "specs/bevel/pinion_19x62.chain"]
    {
        let graph = Graph::new();
        let page = derivation(&job(&graph, spec, &[]), Style::Latex);
        for (open, close) in [("\\[ ", " \\]"), ("\\begin{", "\\end{"), ("\\left(", "\\right)")] {
            assert_eq!(page.matches(open).count(), page.matches(close).count(), "{spec}: {open}");
        }
        for line in page.lines() {
            let depths = line.replace("\\{", "").replace("\\}", "").chars().fold(vec![0i32], |mut depths, c| {
                let now = depths[depths.len() - 1];
                depths.push(now + i32::from(c == '{') - i32::from(c == '}'));
                depths
            });
            assert!(depths.iter().all(|depth| *depth >= 0) && depths.ends_with(&[0]), "{spec}: {line}");
            assert_eq!(line.matches('$').count() % 2, 0, "{spec}: {line}");
        }
        assert!(!page.contains("textbackslash"), "{spec}: a formula was taken for text");
        assert!(page.is_ascii(), "{spec}: plain LaTeX sets ASCII");
    }
}
