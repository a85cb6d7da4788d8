//! What `flank derive` prints is true: the printed text is read back, its expressions are evaluated at values at random, and
//! matrices, product, vector part, twists and equation of meshing are checked against products of plain numbers.

#[path = "../../crates/expr/tests/printing/parser.rs"]
mod parser;

use std::collections::HashMap;

use flank_chain_dsl::{Job, derivation};
use flank_expr::{Graph, Style};
use flank_solver::Outcome;
use flank_tests::{job, points};
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

/// The axes of the six-axis machine, each with a rate.
const RATES: [(&str, f64); 6] = [("X", 1.7), ("Y", -0.6), ("Z", 2.3), ("A", 0.11), ("B", -1.9), ("C", 0.4)];

/// A point in the fixed frame, and the rates of the axes.
fn moving() -> HashMap<String, f64> {
    let point = [("P_x", 51.0), ("P_y", -7.0), ("P_z", 13.0)].map(|(name, value)| (name.to_string(), value));
    point.into_iter().chain(RATES.map(|(axis, rate)| (format!("m.{axis}_rate"), rate))).collect()
}

struct Page {
    text: String,
    parameters: HashMap<String, f64>,
}

impl Page {
    fn new(job: &Job<'_>) -> Page {
        let parameters = job.parameters.iter().map(|parameter| (parameter.name.clone(), parameter.value)).collect();
        Page { text: derivation(job, Style::Text), parameters }
    }

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
    let page = Page::new(&job);
    for (spindle, feed, xi, tau) in [(1.3, -4.0, 4.4, 0.7), (4.1, 11.5, 5.0, -2.1), (-0.6, 0.3, 3.9, 1.9)] {
        let mut values = page.axes(spindle, feed);
        values.extend([("xi".to_string(), xi), ("tau".to_string(), tau)]);
        values.extend(moving());
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

/// The paper's stages: each matrix, locus and normal in the fixed and in the work frame, the velocities of a common point by
/// differences of dense matrices, and the equation of meshing.
#[test]
fn the_stages_of_the_paper_are_products_and_differences_of_its_matrices() {
    let graph = Graph::new();
    let page = Page::new(&job(&graph, "specs/hobbing/chang_tsay_nagata.chain", &[]));
    for (spindle, feed, xi, tau) in [(1.3, -4.0, 5.1, 0.7), (4.1, 11.5, 5.3, -2.1), (-0.6, 0.3, 5.4, 1.9)] {
        let axes = page.axes(spindle, feed);
        let mut values = axes.clone();
        values.extend([("xi".to_string(), xi), ("tau".to_string(), tau)]);
        values.extend(moving());
        let read = |values: &HashMap<String, f64>| {
            stages(&page.text, "\nsurface lower_flank", "\nsurface upper_flank", values)
        };
        let found = read(&values);

        let [table_bed, bed_slide, swivel, shift, laid, turned] = table_to_hob(&values);
        let (slide_head, head_hob) = (swivel * shift, laid * turned);
        let steps =
            [("head_hob", head_hob), ("slide_head", slide_head), ("bed_slide", bed_slide), ("table_bed", table_bed)];
        for (name, matrix) in steps {
            assert_near(all(&found, &format!("M_{name}"))[0], &rows(&matrix), 1e-13, name);
            let rotation = matrix.fixed_view::<3, 3>(0, 0).transpose();
            assert_near(all(&found, &format!("L_{name}"))[0], rotation.as_slice(), 1e-15, name);
        }
        let vector = |name: &str| Vector3::from_column_slice(all(&found, name)[0]);
        let (r, n) = (vector("r_t").push(1.0), vector("n_t").push(0.0));
        let bed_hob = bed_slide * slide_head * head_hob;
        for (frame, pose) in [("bed", bed_hob), ("table", table_bed * bed_hob)] {
            assert_near(all(&found, &format!("r_{frame}"))[0], &(pose * r).as_slice()[..3], 1e-12, frame);
            assert_near(all(&found, &format!("n_{frame}"))[0], &(pose * n).as_slice()[..3], 1e-14, frame);
        }

        // a point of the hob and one of the table, both at P, a little before and after
        let at = |time: f64| {
            let moved = RATES.map(|(axis, rate)| (format!("m.{axis}"), axes[&format!("m.{axis}")] + rate * time));
            let [table_bed, rest @ ..] = table_to_hob(&moved.into_iter().collect());
            (table_bed.try_inverse().expect("a rigid motion"), rest.iter().product::<Matrix4<f64>>())
        };
        let h = 1e-5;
        let ((table_after, hob_after), (table_before, hob_before), (table, hob)) = (at(h), at(-h), at(0.0));
        let point = vector("P").push(1.0);
        let speed = |after: Matrix4<f64>, before: Matrix4<f64>, now: Matrix4<f64>| {
            let speed = (after - before) * (now.try_inverse().expect("a rigid motion") * point) / (2.0 * h);
            speed.fixed_rows::<3>(0).into_owned()
        };
        let (of_work, of_tool) = (speed(table_after, table_before, table), speed(hob_after, hob_before, hob));
        assert_near(all(&found, "V_work")[0], of_work.as_slice(), 1e-7, "work");
        assert_near(all(&found, "V_tool")[0], of_tool.as_slice(), 1e-7, "tool");
        assert_near(all(&found, "V")[0], (vector("V_tool") - vector("V_work")).as_slice(), 1e-12, "relative");
        assert_near(all(&found, "f")[0], &[vector("n_bed").dot(&vector("V"))], 1e-12, "equation of meshing");

        // with the rates of the two motions and at the point of the hob, it is the equation that is solved
        for (k, (by_spindle, by_feed)) in [(h, 0.0), (0.0, h)].into_iter().enumerate() {
            let ahead = page.axes(spindle + by_spindle, feed + by_feed);
            let behind = page.axes(spindle - by_spindle, feed - by_feed);
            let mut along = values.clone();
            along.extend(["x", "y", "z"].into_iter().zip(all(&found, "r_bed")[0]).map(|(k, v)| (format!("P_{k}"), *v)));
            for (axis, _) in RATES {
                let slope = (ahead[&format!("m.{axis}")] - behind[&format!("m.{axis}")]) / (2.0 * h);
                along.insert(format!("m.{axis}_rate"), slope);
                let printed = all(&found, &format!("m.{axis}_rate"));
                // printed for each motion along which the axis moves
                let told = if printed.len() == 2 { printed.get(k) } else { printed.first() };
                assert!(
                    slope.abs() < 1e-9 || told.is_some_and(|told| (told[0] - slope).abs() < 1e-7),
                    "{axis}: {slope}"
                );
            }
            let found = read(&along);
            assert_near(all(&found, "f")[0], all(&found, "meshing")[k], 1e-6, "the equation that is solved");
        }
    }
}

/// The parameter of a straight blade that the equation of meshing gives in closed form is that of the solved points.
#[test]
fn the_printed_closed_form_is_the_solved_parameter() {
    let graph = Graph::new();
    let set = [("m.cutter_tilt", "1 deg"), ("m.cutter_swivel", "25 deg")];
    let job = job(&graph, "specs/bevel/thesis_gear.chain", &set);
    let page = derivation(&job, Style::Text);
    let targets = [[24.0, 111.0], [22.0, 100.0], [27.0, 120.0]];
    for solved in points(&job, "concave", ["z", "rho"], &targets) {
        assert_eq!(solved.outcome, Outcome::Solved);
        let [s, theta, roll] = solved.unknowns[..] else { panic!("three unknowns") };
        let mut values: HashMap<String, f64> = job.parameters.iter().map(|p| (p.name.clone(), p.value)).collect();
        values.extend([("theta".to_string(), theta), ("roll".to_string(), roll), ("m.roll".to_string(), roll)]);
        values.extend([("s".to_string(), 1.0), ("m.bed".to_string(), 0.0), ("m.work".to_string(), 0.0)]);
        values.extend(["P_x", "P_y", "P_z"].map(|name| (name.to_string(), 0.0)));
        values.extend(["roll", "bed", "work"].map(|axis| (format!("m.{axis}_rate"), 1.0)));
        let found = stages(&page, "\nsurface concave", "\nsurface convex", &values);
        let printed = all(&found, "s")[0][0];
        assert!((printed - s).abs() < 1e-10, "{printed} {s}");
    }
    assert_eq!(page.matches("it is linear in s,").count(), 2);
    let curved = Graph::new();
    let gear = derivation(&flank_tests::job(&curved, "specs/bevel/gear_19x62.chain", &[]), Style::Text);
    assert_eq!(gear.matches("it is linear in s,").count(), 0, "its blades are curved");
}

/// Brackets of all kinds and environments are closed in their order, and nothing special of LaTeX stands bare in a text.
#[test]
fn latex_is_balanced() {
    for spec in ["hobbing/helical_gear", "hobbing/spur_gear", "bevel/pinion_19x62", "bevel/thesis_gear"] {
        let spec = &format!("specs/{spec}.chain");
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
