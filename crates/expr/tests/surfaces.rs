//! Surfaces, their envelopes and the equation of meshing: against determinants and closed forms.

mod support;

use flank_expr::geometry::{Axis, Chain, Step, Surface, Vector3};
use flank_expr::{Expr, Graph, Interval, IntervalEvaluator, Tape};
use nalgebra as na;
use support::Random;
use support::frames::{Point, Setting, slope};

const U: usize = 0;
const V: usize = 1;
const MOTION: usize = 2;
const SECOND: usize = 3;

/// Four tools over (u, v), none with an axis in a special place.
fn tools<'g>(setting: &Setting<'g>) -> [(&'static str, Surface<'g>); 4] {
    let &Setting { graph, u, v, .. } = setting;
    let surface = |position| Surface::parametric([u, v], Vector3(position), false);
    let along = u + 3.0;
    let roll = u + 2.5;
    [
        ("cone", surface([along * 0.4 * v.cos(), along * 0.4 * v.sin(), along * 0.9])),
        ("plane", surface([u + 0.3 * v, v - 0.2 * u + 0.5, 0.7 * v + graph.constant(1.0)])),
        ("sphere", surface([u.cos() * v.cos() * 2.0, u.cos() * v.sin() * 2.0, u.sin() * 2.0])),
        (
            "involute helicoid",
            surface([
                1.5 * ((roll + v).cos() + roll * (roll + v).sin()),
                1.5 * ((roll + v).sin() - roll * (roll + v).cos()),
                0.6 * v,
            ]),
        ),
    ]
}

fn dense_point(setting: &Setting<'_>, chain: &Chain<'_>, tool: &Surface<'_>, at: &Point) -> na::Vector3<f64> {
    (setting.dense(chain, at) * setting.vector_at(tool.position, at).push(1.0)).xyz()
}

/// det(r_u, r_v, r_motion) / |r_u × r_v| in the work frame, all of it from dense matrices and differences.
fn determinant(setting: &Setting<'_>, chain: &Chain<'_>, tool: &Surface<'_>, at: &Point) -> f64 {
    let [r_u, r_v, r_motion] =
        [U, V, MOTION].map(|variable| slope(at, variable, |at| dense_point(setting, chain, tool, at)));
    let normal = r_u.cross(&r_v);
    normal.dot(&r_motion) / normal.norm()
}

#[test]
fn normals_are_those_of_the_tangent_plane() {
    let mut random = Random(21);
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    for (name, tool) in tools(&setting) {
        for _ in 0..20 {
            let at = Setting::point(&mut random);
            let [r_u, r_v] = [U, V].map(|k| slope(&at, k, |at| setting.vector_at(tool.position, at)));
            let expected = r_u.cross(&r_v).normalize();
            let found = setting.vector_at(tool.normal, &at);
            assert!((found - expected).norm() < 1e-8, "{name}: {found} instead of {expected}");
            let flipped = Surface::parametric([setting.u, setting.v], tool.position, true);
            assert!((setting.vector_at(flipped.normal, &at) + expected).norm() < 1e-8, "{name} flipped");
        }
    }
}

#[test]
fn meshing_is_the_determinant() {
    let mut random = Random(22);
    for round in 0..25 {
        let graph = Graph::new();
        let setting = Setting::new(&graph);
        let chain = setting.chain(&mut random, 2 + round % 5);
        for (name, tool) in tools(&setting) {
            let meshing = tool.meshing(&chain, setting.motion);
            let at = Setting::point(&mut random);
            // a mirror in the chain turns the determinant's sign, for it turns r_u × r_v round
            let hand = setting.matrix_at(chain.pose().rotation, &at).determinant();
            let (found, expected) = (setting.number(meshing, &at), hand * determinant(&setting, &chain, &tool, &at));
            assert!(
                (found - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                "{name}, round {round}: {found} instead of {expected}"
            );
            // and the same from exact derivatives, in the work frame
            let moved = tool.moved(&chain);
            let raw = Surface::raw_normal([setting.u, setting.v], moved.position);
            let exact = raw.dot(moved.position.derivative(setting.motion)) / raw.norm();
            let expected = hand * setting.number(exact, &at);
            assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{name}: {found}, {expected}");
        }
    }
}

/// A tube about a helix: its point and its normal turn with the helix, and its normal is known in closed form.
fn tube<'g>(setting: &Setting<'g>) -> (Surface<'g>, Vector3<'g>) {
    let &Setting { graph, u, v, .. } = setting;
    let [radius, lead, thickness] = [2.0, 0.6, 0.3].map(|number| graph.constant(number));
    // across the helix, as a share of the way along its tangent
    let aside = u.sin() / (radius.squared() + lead.squared()).sqrt();
    let normal = Vector3([
        u.cos() * v.cos() - aside * lead * v.sin(),
        u.cos() * v.sin() + aside * lead * v.cos(),
        -(aside * radius),
    ]);
    let helix = Vector3([radius * v.cos(), radius * v.sin(), lead * v]);
    (Surface::parametric([u, v], helix + normal.scaled(thickness), false), normal)
}

#[test]
fn a_normal_turns_with_its_point() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let (tube, closed_form) = tube(&setting);
    let mut random = Random(25);
    for _ in 0..50 {
        let at = Setting::point(&mut random);
        let [found, expected] = [tube.normal, closed_form].map(|normal| setting.vector_at(normal, &at));
        let sign = found.dot(&expected).signum();
        assert!((found * sign - expected).norm() < 1e-14, "{found} instead of {expected}");
    }
    // its length does not depend on the turn: the third component shows it alone
    assert!(tube.normal.0[2].derivative(setting.v).is_zero());
}

/// Turned by the hob's thread and spindle together, the equation of meshing knows the two as one angle, as the position does.
#[test]
fn a_thread_that_turns_about_its_axis_meshes_by_one_angle() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let &Setting { u, v, motion, .. } = &setting;
    let (tube, _) = tube(&setting);
    let constant = |x, y, z| Vector3::constant(&graph, [x, y, z]);
    let t_work_hob = Chain::new(
        &graph,
        vec![
            Step::Rotate(Axis::Z, -0.1 * motion),
            Step::Translate(constant(40.0, 0.0, 0.0)),
            Step::Rotate(Axis::X, graph.constant(1.4)),
            Step::Rotate(Axis::Z, motion),
        ],
    );
    let meshing = tube.meshing(&t_work_hob, motion);
    let angles: Vec<String> = graph.angles_in(&[meshing]).iter().map(|angle| angle.to_string()).collect();
    assert!(angles.iter().all(|angle| [u, v + motion].iter().any(|known| known.to_string() == *angle)), "{angles:?}");
    let mut random = Random(26);
    for _ in 0..50 {
        let at = Setting::point(&mut random);
        let (found, expected) = (setting.number(meshing, &at), determinant(&setting, &t_work_hob, &tube, &at));
        assert!((found.abs() - expected.abs()).abs() < 1e-6 * (1.0 + expected.abs()), "{found} instead of {expected}");
    }
    // before the turn it is linear in one sine and one cosine; products of several are enclosed 0.4 wide over the same box
    let [.., (_, helicoid)] = tools(&setting);
    let meshing = helicoid.meshing(&t_work_hob, motion);
    let tape = Tape::new(&[meshing], &[u, v, motion]).expect("all variables are inputs");
    let mut enclosed = [Interval::WHOLE];
    let inputs = [Interval::point(0.5), Interval::new(0.2, 0.3), Interval::point(0.7)];
    IntervalEvaluator::new(&tape).run(&inputs, &mut enclosed);
    assert!(enclosed[0].width() < 0.1, "{:?}", enclosed[0]);
}

#[test]
fn envelope_collects_unknowns_and_constraints() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let mut random = Random(23);
    let chain = setting.chain(&mut random, 4);
    let tool = tools(&setting)[0].1.clone();
    let &Setting { u, v, motion, second, .. } = &setting;
    let both = tool.envelope(&chain, &[motion, second]);
    assert_eq!(both.unknowns, [u, v, motion, second]);
    assert_eq!(both.constraints, [tool.meshing(&chain, motion), tool.meshing(&chain, second)]);
    let formate = tool.envelope(&chain, &[]);
    assert_eq!(formate.unknowns, [u, v]);
    assert_eq!(formate.constraints, []);
    assert_eq!(formate.position, tool.moved(&chain).position);
    assert_eq!(formate.normal, -tool.moved(&chain).normal);
}

/// A value of the variable that makes the constraint zero, by Newton's method with the exact derivative.
fn solved(setting: &Setting<'_>, constraint: Expr<'_>, by: (Expr<'_>, usize), start: Point) -> Option<Point> {
    let slope = constraint.derivative(by.0);
    let mut at = start;
    for _ in 0..60 {
        let values = setting.graph.evaluate(&[constraint, slope], &at);
        let step = (values[0] / values[1]).clamp(-0.2, 0.2);
        at[by.1] -= step;
        if step.abs() < 1e-14 {
            return Some(at);
        }
    }
    None
}

#[test]
fn meshing_of_an_envelope_is_the_determinant_on_it() {
    let mut random = Random(24);
    let mut compared = 0;
    for _ in 0..40 {
        let graph = Graph::new();
        let setting = Setting::new(&graph);
        let (first, then) = (setting.chain(&mut random, 4), setting.chain(&mut random, 4));
        for (name, tool) in tools(&setting) {
            let gear = tool.envelope(&first, &[setting.motion]);
            // `then` moves with the first motion too: only its own one must count
            let still = then.substituted(&[(setting.motion, graph.constant(0.3))]);
            let meshing = gear.meshing(&still, setting.second);
            let start = Setting::point(&mut random);
            let Some(at) = solved(&setting, gear.constraints[0], (setting.motion, MOTION), start) else {
                continue;
            };
            let Some([s, t]) = tangents(&setting, &gear, &at) else {
                continue;
            };
            let normal = s.cross(&t);
            if normal.norm() < 0.05 {
                continue;
            }
            let unit = normal.normalize();
            let own = setting.vector_at(gear.normal, &at);
            assert!((own.dot(&unit).abs() - 1.0).abs() < 1e-7, "{name}: normal {own}, tangent plane {unit}");
            let dense = |at: &Point| setting.dense(&still, at);
            let p = setting.vector_at(gear.position, &at).push(1.0);
            // the tool's motion against a fixed point of the gear does not depend on it in this frame
            let velocity = slope(&at, SECOND, |moved| (dense(moved) * p).xyz());
            let carried = dense(&at).fixed_view::<3, 3>(0, 0) * own;
            let expected = carried.dot(&velocity);
            let partial = setting.number(meshing, &at);
            assert!((partial - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{name}: {partial}, {expected}");
            compared += 1;
        }
    }
    assert!(compared > 40, "only {compared} points");
}

/// Two tangents of a surface with three unknowns and one constraint, from the null space of the constraint's gradient.
fn tangents(setting: &Setting<'_>, surface: &Surface<'_>, at: &Point) -> Option<[na::Vector3<f64>; 2]> {
    let gradient =
        na::Vector3::from_fn(|k, _| setting.number(surface.constraints[0].derivative(surface.unknowns[k]), at));
    let columns = na::Matrix3::from_columns(
        &[0, 1, 2].map(|k| setting.vector_at(surface.position.derivative(surface.unknowns[k]), at)),
    );
    let any = if gradient.x.abs() < 0.6 * gradient.norm() { na::Vector3::x() } else { na::Vector3::y() };
    let first = gradient.cross(&any).try_normalize(1e-6)?;
    let second = gradient.cross(&first).normalize();
    Some([columns * first, columns * second])
}

#[test]
fn sphere_along_a_line_leaves_a_cylinder() {
    const RADIUS: f64 = 2.0;
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let sphere = tools(&setting)[2].1.clone();
    let direction = na::Vector3::new(0.48, -0.6, 0.64);
    let line = Vector3::constant(&graph, direction.into()).scaled(5.0 * setting.motion);
    let offset = na::Vector3::new(1.0, 2.0, -3.0);
    let chain = Chain::new(
        &graph,
        vec![
            Step::Translate(Vector3::constant(&graph, offset.into())),
            Step::Translate(line),
            Step::Rotate(Axis::X, 0.3 * setting.motion + 0.2),
            Step::Rotate(Axis::Z, setting.parameter),
        ],
    );
    let bore = sphere.envelope(&chain, &[setting.motion]);
    let mut random = Random(25);
    let mut points = 0;
    for _ in 0..50 {
        let start = Setting::point(&mut random);
        let Some(at) = solved(&setting, bore.constraints[0], (setting.u, U), start) else {
            continue;
        };
        let p = setting.vector_at(bore.position, &at) - offset;
        let radial = p - direction * p.dot(&direction);
        assert!((radial.norm() - RADIUS).abs() < 1e-12, "distance {}", radial.norm());
        // the sphere's normal points inwards, also beyond a pole, the bore's the other way
        let outwards = radial.normalize();
        let normal = setting.vector_at(bore.normal, &at);
        assert!((normal - outwards).norm() < 1e-12, "normal {normal}");
        points += 1;
    }
    assert!(points > 30, "{points} points");
}

/// A rack's flank, inclined by the pressure angle, while its pitch line rolls on the pitch circle.
#[test]
fn rolling_rack_leaves_an_involute() {
    const PITCH_RADIUS: f64 = 20.0;
    let pressure = 20_f64.to_radians();
    let base = PITCH_RADIUS * pressure.cos();
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let &Setting { u, v, motion, .. } = &setting;
    let zero = graph.constant(0.0);
    for side in [1.0, -1.0] {
        let flank =
            Surface::parametric([u, v], Vector3([u * pressure.cos(), u * (-side * pressure.sin()), v]), side < 0.0);
        // fixed frame: the work turns by `motion`, the rack runs along y at the pitch radius
        let chain = Chain::new(
            &graph,
            vec![
                Step::Rotate(Axis::Z, -motion),
                Step::Translate(Vector3([graph.constant(PITCH_RADIUS), PITCH_RADIUS * motion, zero])),
            ],
        );
        let tooth = flank.envelope(&chain, &[motion]);
        for k in -8..9 {
            let start = [0.1, 1.5, 0.03 * f64::from(k), 0.0, 0.0];
            let at = solved(&setting, tooth.constraints[0], (u, U), start).expect("linear in u");
            let p = setting.vector_at(tooth.position, &at);
            let n = setting.vector_at(tooth.normal, &at);
            let radius = p.xy().norm();
            // normals touch the base circle
            let arm = p.x * n.y - p.y * n.x;
            assert!((arm.abs() - base).abs() < 1e-12, "arm {arm}, base {base}");
            // polar angle of the involute: inv α at this radius, the same start for every point
            let at_radius = (base / radius).acos();
            let involute = |angle: f64| angle.tan() - angle;
            let polar = p.y.atan2(p.x);
            let start = polar + side * (involute(at_radius) - involute(pressure));
            assert!(start.abs() < 1e-12, "side {side}, motion {}: {start}", at[MOTION]);
            assert_eq!(p.z, 1.5);
        }
    }
}
