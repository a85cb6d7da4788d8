//! Geometry at points of surfaces in closed form.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_expr::geometry::{Axis, Chain, Edge, Step, Surface, Vector3};
use flank_expr::{Expr, Graph};
use flank_solver::{BoundSurface, PointGeometry, Range, SurfaceGeometry};

/// Rounding of a few operations on numbers of order one to ten.
const ROUNDING: f64 = 1e-13;

fn close(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() <= ROUNDING * (1.0 + a.abs().max(b.abs())), "{what}: {a} is not {b}");
}

/// With the last unknowns as motions and the first two as coordinates.
fn geometry_at(surface: &Surface<'_>, motions: usize, at: &[f64]) -> PointGeometry {
    let p = &surface.unknowns;
    let bound = BoundSurface::new(surface, vec![Range { low: -10.0, high: 10.0 }; p.len()], &[]);
    let geometry = SurfaceGeometry::new(&bound, &p[p.len() - motions..], [p[0], p[1]]).expect("all bound");
    geometry.at(at)
}

fn principal(point: &PointGeometry) -> (f64, f64) {
    let principal = point.curvature.expect("a regular point").principal();
    (principal.k1, principal.k2)
}

fn variables<'g>(graph: &'g Graph) -> [Expr<'g>; 2] {
    [graph.variable("u"), graph.variable("v")]
}

#[test]
fn a_cylinder_bends_one_way() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    let cylinder = Surface::parametric([u, v], Vector3([4.0 * u.cos(), 4.0 * u.sin(), v]), false);
    let point = geometry_at(&cylinder, 0, &[0.7, 3.0]);
    let curvature = point.curvature.expect("regular");
    let (k1, k2) = principal(&point);
    close(k1, 0.25, "around");
    close(k2, 0.0, "along");
    let [around, along] = curvature.principal().directions.expect("two different ones");
    close(around[0].abs(), 0.7f64.sin(), "around is square to the axis");
    close(along[2].abs(), 1.0, "along is the axis");
    // Euler's formula half way between
    close(curvature.along([-0.7f64.sin(), 0.7f64.cos(), 1.0]).expect("a tangent"), 0.125, "half way");
    assert_eq!(curvature.along([0.7f64.cos(), 0.7f64.sin(), 0.0]), None, "the normal is no tangent");
    close(curvature.mean(), 0.125, "mean");
    close(curvature.gauss(), 0.0, "gauss");
    let metric = point.metric.expect("u and v fix a point");
    close(metric.e, 16.0, "e");
    close(metric.f, 0.0, "f");
    close(metric.g, 1.0, "g");
    // the body outside of the bore
    let bore = Surface::parametric([u, v], cylinder.position, true);
    assert_eq!(principal(&geometry_at(&bore, 0, &[0.7, 3.0])), (-k2, -k1));
}

#[test]
fn a_torus_has_its_two_radii() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    let radius = 10.0 + 3.0 * v.cos();
    let torus = Surface::parametric([u, v], Vector3([radius * u.cos(), radius * u.sin(), 3.0 * v.sin()]), false);
    for at in [0.4, 1.2, 2.5, -0.9] {
        let (k1, k2) = principal(&geometry_at(&torus, 0, &[2.0, at]));
        close(k1, 1.0 / 3.0, "round the tube");
        close(k2, at.cos() / (10.0 + 3.0 * at.cos()), "round the axis");
    }
}

#[test]
fn a_plane_has_no_principal_directions() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    let position = Vector3([u + v, 2.0 * u - v, 0.3 * u]);
    let point = geometry_at(&Surface::parametric([u, v], position, false), 0, &[1.0, 2.0]);
    let principal = point.curvature.expect("regular").principal();
    assert_eq!((principal.k1, principal.k2, principal.directions), (0.0, 0.0, None));
}

#[test]
fn what_is_not_defined_is_none() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    // the tip of a cone: the circle has no radius, the normal no direction
    let cone = Surface::parametric([u, v], Vector3([v * u.cos(), v * u.sin(), v]), false);
    let tip = geometry_at(&cone, 0, &[0.3, 0.0]);
    assert_eq!((tip.curvature, tip.metric.map(|metric| metric.e)), (None, Some(0.0)));
    // coordinates that are one
    let cone = BoundSurface::new(&cone, vec![Range { low: -10.0, high: 10.0 }; 2], &[]);
    let twice = SurfaceGeometry::new(&cone, &[], [v, 2.0 * v]).expect("all bound").at(&[0.3, 1.0]);
    assert!(twice.metric.is_none() && twice.curvature.is_some());
    // out of the domain
    let root = Surface::parametric([u, v], Vector3([u, v, (u - 5.0).sqrt()]), false);
    let outside = geometry_at(&root, 0, &[1.0, 1.0]);
    assert_eq!((outside.curvature, outside.metric), (None, None));
    assert_eq!(outside.contact.induced, None);
}

/// The rack x = −u cos α, y = −u sin α as a tool, rolling on a circle of radius R.
fn rolled<'g>(graph: &'g Graph, alpha: f64, radius: f64) -> (Surface<'g>, Chain<'g>, Expr<'g>) {
    let [u, v] = variables(graph);
    let phi = graph.variable("phi");
    let rack = Surface::parametric([u, v], Vector3([-u * alpha.cos(), -u * alpha.sin(), v]), false);
    let zero = graph.constant(0.0);
    let rolling =
        vec![Step::Rotate(Axis::Z, -phi), Step::Translate(Vector3([graph.constant(radius), radius * phi, zero]))];
    (rack, Chain::new(graph, rolling), phi)
}

/// Involute of the base circle rb: its radius of curvature is the distance to the base circle along the normal.
#[test]
fn an_involute_bends_as_it_unwinds() {
    let graph = Graph::new();
    let (alpha, radius) = (0.35f64, 30.0);
    let (rack, t_work_tool, phi) = rolled(&graph, alpha, radius);
    let gear = rack.envelope(&t_work_tool, &[phi]);
    for angle in [-0.1, 0.05, 0.2, 0.4] {
        // the contact lies on the normal through the pitch point
        let u = radius * angle * alpha.sin();
        let point = geometry_at(&gear, 1, &[u, 2.0, angle]);
        let unwound = radius * alpha.sin() - radius * angle * alpha.cos();
        let curvature = point.curvature.expect("regular");
        let principal = curvature.principal();
        let bent = if principal.k1.abs() > principal.k2.abs() { principal.k1 } else { principal.k2 };
        close(bent.abs(), 1.0 / unwound.abs(), "1/sqrt(r² − rb²)");
        close(curvature.gauss(), 0.0, "a cylinder");
        let line = point.contact.line.expect("one motion");
        close(line[2], 1.0, "the contact line is parallel to the axis");
        // a rack is flat: the gap bends as the gear does
        let induced = point.contact.induced.expect("a surface of the tool").principal();
        close(induced.k1.abs().max(induced.k2.abs()), bent.abs(), "induced");
        // the pitch point is the momentary centre: R·angle·cos α away from the contact
        let [x, y, z] = point.contact.sliding[0].expect("finite");
        close(x.hypot(y), (radius * angle).abs() * alpha.cos(), "sliding velocity");
        close(z, 0.0, "no sliding along the tooth");
        close(point.contact.sliding_angle().expect("it slides"), FRAC_PI_2, "across the contact line");
    }
}

#[test]
fn undercut_begins_where_the_tangent_plane_is_lost() {
    let graph = Graph::new();
    let (alpha, radius) = (0.35f64, 30.0);
    let (rack, t_work_tool, phi) = rolled(&graph, alpha, radius);
    let gear = rack.envelope(&t_work_tool, &[phi]);
    // the foot of the involute on its base circle
    let angle = alpha.tan();
    let foot = geometry_at(&gear, 1, &[radius * angle * alpha.sin(), 0.0, angle]);
    assert_eq!((foot.curvature, foot.contact.induced), (None, None));
    assert!(foot.contact.line.is_some() && foot.contact.sliding[0].is_some());
}

/// A ball of radius ρ on a circle of radius R leaves a torus, fed across the plane a flat groove's bottom.
#[test]
fn a_ball_that_two_motions_carry_touches_in_a_point() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    let (turn, feed) = (graph.variable("turn"), graph.variable("feed"));
    let ball = Vector3([u.cos() * v.cos(), u.sin() * v.cos(), v.sin()]).map(|x| 3.0 * x);
    let ball = Surface::parametric([u, v], ball, false);
    let zero = graph.constant(0.0);
    let about = Step::Rotate(Axis::Z, turn);
    let carried = Chain::new(&graph, vec![about, Step::Translate(Vector3([graph.constant(20.0), zero, feed]))]);
    let bore = ball.envelope(&carried, &[turn, feed]);
    // the outermost point of the ball cuts a bore of radius 23
    let point = geometry_at(&bore, 2, &[0.0, 0.0, 0.6, 5.0]);
    let (k1, k2) = principal(&point);
    close(k1, 0.0, "along the bore");
    close(k2, -1.0 / 23.0, "round the bore");
    assert_eq!(point.contact.line, None);
    let induced = point.contact.induced.expect("a surface of the tool").principal();
    close(induced.k1, 1.0 / 3.0, "gap along the bore");
    close(induced.k2, 1.0 / 3.0 - 1.0 / 23.0, "gap round the bore");
    let [round, along] = [0, 1].map(|k| point.contact.sliding[k].expect("finite"));
    close(round[0].hypot(round[1]), 23.0, "mm per radian");
    assert_eq!(along, [0.0, 0.0, 1.0]);
    // one motion alone: the ball touches the torus along a circle
    let torus = ball.envelope(&carried, &[turn]);
    let torus = Surface {
        position: torus.position.map(|x| graph.substitute(&[x], &[(feed, zero)])[0]),
        normal: torus.normal.map(|x| graph.substitute(&[x], &[(feed, zero)])[0]),
        constraints: graph.substitute(&torus.constraints, &[(feed, zero)]),
        ..torus
    };
    let point = geometry_at(&torus, 1, &[0.0, 0.8, 0.6]);
    let (k1, k2) = principal(&point);
    close(k1, -0.8f64.cos() / (20.0 + 3.0 * 0.8f64.cos()), "round the axis, hollow");
    close(k2, -1.0 / 3.0, "round the ball, hollow");
    let line = point.contact.line.expect("one motion");
    close(line[2], 0.8f64.cos(), "along the meridian");
}

/// A straight edge through the axis that turns and climbs leaves a helicoid: both of its principal curvatures are
/// ± p / (p² + u²).
#[test]
fn an_edge_leaves_a_helicoid() {
    let graph = Graph::new();
    let (u, turn) = (graph.variable("u"), graph.variable("turn"));
    let zero = graph.constant(0.0);
    let steel = Vector3::constant(&graph, [0.0, 0.0, 1.0]);
    let edge = Edge { parameter: u, position: Vector3([u, zero, zero]), steel };
    let climb = Step::Translate(Vector3([zero, zero, 2.5 * turn]));
    let chain = Chain::new(&graph, vec![climb, Step::Rotate(Axis::Z, turn)]);
    let helicoid = edge.sweep(&chain, &[turn], false);
    let point = geometry_at(&helicoid, 1, &[4.0, 0.3]);
    let (k1, k2) = principal(&point);
    let bent = 2.5 / (2.5 * 2.5 + 16.0);
    close(k1, bent, "k1");
    close(k2, -bent, "k2");
    let line = point.contact.line.expect("the edge");
    close(line[0], 0.3f64.cos(), "the edge itself");
    assert_eq!(point.contact.induced, None, "an edge has no curvatures");
    let [x, y, z] = point.contact.sliding[0].expect("finite");
    close(x.hypot(y), 4.0, "round");
    close(z, 2.5, "up");
}

/// Signs of directions are settled, so that they do not jump from point to point.
#[test]
fn directions_are_oriented_and_right_handed() {
    let graph = Graph::new();
    let [u, v] = variables(&graph);
    let radius = 10.0 + 3.0 * v.cos();
    let torus = Surface::parametric([u, v], Vector3([radius * u.cos(), radius * u.sin(), 3.0 * v.sin()]), false);
    for k in 0..40 {
        let (a, b) = (f64::from(k) * PI / 7.0, -1.4 + f64::from(k) * 0.07);
        assert!(b.abs() < FRAC_PI_2);
        let directions = geometry_at(&torus, 0, &[a, b]).curvature.expect("regular").principal().directions;
        let [[x, y, z], e] = directions.expect("two different ones");
        let normal = [a.cos() * b.cos(), a.sin() * b.cos(), b.sin()];
        assert!(z > 0.0 || (z.abs() < 1e-9 && (y > 0.0 || (y.abs() < 1e-9 && x > 0.0))), "{:?}", [x, y, z]);
        let cross = [y * e[2] - z * e[1], z * e[0] - x * e[2], x * e[1] - y * e[0]];
        cross.iter().zip(normal).for_each(|(c, n)| close(*c, n, "d1 × d2 is the normal"));
    }
}
