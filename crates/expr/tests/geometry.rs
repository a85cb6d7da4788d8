//! Poses and chains against dense matrices of another library.

mod support;

use flank_expr::geometry::{Axis, Chain, Matrix3, Pose, Step, Twist, Vector3};
use flank_expr::{Graph, Tape};
use nalgebra as na;
use support::Random;
use support::frames::{Point, Setting, slope};

const U: usize = 0;
const MOTION: usize = 2;
const ROUNDS: usize = 60;

/// Runs a check on many random chains at random points.
fn on_chains(seed: u64, check: impl for<'g> Fn(&Setting<'g>, &Chain<'g>, &Point, &mut Random)) {
    let mut random = Random(seed);
    for round in 0..ROUNDS {
        let graph = Graph::new();
        let setting = Setting::new(&graph);
        let chain = setting.chain(&mut random, 1 + round % 7);
        let at = Setting::point(&mut random);
        check(&setting, &chain, &at, &mut random);
    }
}

fn close<R: na::Dim, C: na::Dim>(
    found: na::OMatrix<f64, R, C>,
    expected: na::OMatrix<f64, R, C>,
    tolerance: f64,
    what: &str,
) where
    na::DefaultAllocator: na::allocator::Allocator<R, C>,
{
    let scale = 1.0 + expected.norm();
    let distance = (&found - &expected).norm();
    assert!(distance <= tolerance * scale, "{what}: {found} instead of {expected}");
}

#[test]
fn vectors_are_those_of_the_other_library() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let mut random = Random(11);
    for _ in 0..ROUNDS {
        let (a, b) = (setting.vector(&mut random), setting.vector(&mut random));
        let at = Setting::point(&mut random);
        let (x, y) = (setting.vector_at(a, &at), setting.vector_at(b, &at));
        close(setting.vector_at(a.cross(b), &at), x.cross(&y), 1e-14, "cross");
        close(setting.vector_at(a - b, &at), x - y, 1e-14, "difference");
        assert!((setting.number(a.dot(b), &at) - x.dot(&y)).abs() < 1e-13);
        assert!((setting.number(a.norm(), &at) - x.norm()).abs() < 1e-13);
        if x.norm() > 0.1 {
            close(setting.vector_at(a.normalized(), &at), x.normalize(), 1e-13, "unit");
        }
        let slopes = slope(&at, MOTION, |at| setting.vector_at(a, at));
        close(setting.vector_at(a.derivative(setting.motion), &at), slopes, 1e-9, "derivative");
    }
}

#[test]
fn primitive_and_normalized_vectors_are_short() {
    let graph = Graph::new();
    let [r, t, a] = ["r", "t", "a"].map(|name| graph.variable(name));
    let shown = |v: Vector3<'_>| v.0.map(|part| part.to_string());
    // the raw normal of a cone, as the cross product gives it: it has the radius as a factor
    let slant = Vector3([-(a.sin() * t.cos()), -(a.sin() * t.sin()), -a.cos()]);
    let round = Vector3([-(r * t.sin()), r * t.cos(), graph.constant(0.0)]);
    let normal = slant.cross(round).primitive();
    assert_eq!(shown(normal), ["cos(t) * cos(a)", "sin(t) * cos(a)", "-sin(a)"]);
    assert_eq!(normal.normalized(), normal);
    assert_eq!(normal.scaled(graph.constant(-1.0)).normalized(), -normal);
    // nothing in common: as it was
    let plain = Vector3([r + t, t, a]);
    assert_eq!(plain.primitive(), plain);
    assert_eq!(plain.normalized(), plain.map(|part| part / plain.norm()));
    assert!(Vector3::zero(&graph).primitive().is_zero());
}

#[test]
fn poses_compose_and_invert_like_isometries() {
    let mut random = Random(12);
    for _ in 0..ROUNDS {
        let graph = Graph::new();
        let setting = Setting::new(&graph);
        let mut isometry = || {
            let mut triple = || na::Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
            na::Isometry3::new(triple(), triple())
        };
        let (a, b) = (isometry(), isometry());
        let pose = |isometry: &na::Isometry3<f64>| {
            let m = isometry.to_homogeneous();
            let row = |i: usize| Vector3::constant(&graph, [m[(i, 0)], m[(i, 1)], m[(i, 2)]]);
            Pose {
                rotation: Matrix3([row(0), row(1), row(2)]),
                translation: Vector3::constant(&graph, [m[(0, 3)], m[(1, 3)], m[(2, 3)]]),
            }
        };
        let at = [0.0; 5];
        let (p, q) = (pose(&a), pose(&b));
        close(setting.pose_at(p.then(q), &at), (a * b).to_homogeneous(), 1e-14, "then");
        close(setting.pose_at(p.inverse(), &at), a.inverse().to_homogeneous(), 1e-14, "inverse");
        let back = setting.pose_at(p.then(p.inverse()), &at);
        close(back, na::Matrix4::identity(), 1e-14, "there and back");
        let point = Vector3::constant(&graph, [0.3, -1.1, 2.0]);
        let expected = a * na::Point3::new(0.3, -1.1, 2.0);
        close(setting.vector_at(p.point(point), &at), expected.coords, 1e-14, "point");
        let expected = a * na::Vector3::new(0.3, -1.1, 2.0);
        close(setting.vector_at(p.direction(point), &at), expected, 1e-14, "direction");
    }
}

#[test]
fn rotations_about_any_axis() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let mut random = Random(13);
    for _ in 0..ROUNDS {
        let axis = setting.axis(&mut random, false);
        let at = Setting::point(&mut random);
        let found = Step::Rotate(Axis::Along(axis), setting.u).pose(&graph).rotation;
        let unit = na::Unit::new_normalize(setting.vector_at(axis, &at));
        let expected = na::Rotation3::from_axis_angle(&unit, at[U]).into_inner();
        close(setting.matrix_at(found, &at), expected, 1e-14, "Rodrigues");
    }
    // right-handed: a quarter turn about z takes x to y, and so on round
    let quarter = graph.constant(std::f64::consts::FRAC_PI_2);
    let [x, y, z] = [Axis::X, Axis::Y, Axis::Z];
    for (axis, from, to) in [(z, x, y), (x, y, z), (y, z, x)] {
        let turned = Step::Rotate(axis, quarter).pose(&graph).direction(from.direction(&graph));
        assert_eq!(turned, to.direction(&graph), "about {axis:?}");
    }
}

#[test]
fn chains_are_dense_products() {
    on_chains(14, |setting, chain, at, random| {
        let expected = setting.dense(chain, at);
        close(setting.pose_at(chain.pose(), at), expected, 1e-12, "pose");
        let p = setting.vector(random);
        let numbers = setting.vector_at(p, at);
        let point = expected * numbers.push(1.0);
        close(setting.vector_at(chain.point(p), at), point.xyz(), 1e-12, "point");
        let direction = expected * numbers.push(0.0);
        close(setting.vector_at(chain.direction(p), at), direction.xyz(), 1e-12, "direction");
    });
}

#[test]
fn chains_invert_join_and_merge() {
    on_chains(15, |setting, chain, at, random| {
        let dense = setting.dense(chain, at);
        let inverse = dense.try_inverse().expect("a rigid motion");
        close(setting.pose_at(chain.inverse().pose(), at), inverse, 1e-11, "inverse");
        let other = setting.chain(random, 3);
        let joined = setting.pose_at(chain.then(&other).pose(), at);
        close(joined, dense * setting.dense(&other, at), 1e-12, "then");
        let back = chain.then(&chain.inverse()).merged();
        close(setting.pose_at(back.pose(), at), na::Matrix4::identity(), 1e-11, "back");
        let merged = chain.then(&other).merged();
        close(setting.pose_at(merged.pose(), at), dense * setting.dense(&other, at), 1e-12, "merged");
    });
}

#[test]
fn merging() {
    let graph = Graph::new();
    let Setting { u, v, motion, .. } = Setting::new(&graph);
    let zero = graph.constant(0.0);
    let shift = |x| Step::Translate(Vector3([x, zero, zero]));
    let turn = |angle| Step::Rotate(Axis::Z, angle);
    let cases = [
        (vec![turn(u), turn(v)], vec![turn(u + v)]),
        (vec![shift(u), shift(v)], vec![shift(u + v)]),
        (vec![turn(u), turn(-u)], vec![]),
        (vec![shift(u), turn(zero), shift(v)], vec![shift(u + v)]),
        // the pair in the middle vanishes, and its neighbours meet
        (vec![shift(u), turn(v), turn(-v), shift(motion)], vec![shift(u + motion)]),
        (vec![turn(u), shift(v), turn(motion)], vec![turn(u), shift(v), turn(motion)]),
        (vec![turn(u), Step::Rotate(Axis::X, v)], vec![turn(u), Step::Rotate(Axis::X, v)]),
    ];
    for (steps, expected) in cases {
        assert_eq!(Chain::new(&graph, steps.clone()).merged().steps(), expected, "{steps:?}");
    }
    // links that keep a frame parallel only move it, also with steps of their own in between
    let linked = vec![turn(u), shift(v), turn(motion - u), shift(u), turn(-motion)];
    let merged = Chain::new(&graph, linked.clone()).merged();
    assert!(matches!(merged.steps(), [Step::Translate(_)]), "{:?}", merged.steps());
    let values = [0.3, -1.2, 0.7, 0.1, 2.0];
    let entries = |chain: &Chain<'_>| {
        let pose = chain.pose();
        graph.evaluate(
            &pose.rotation.entries().into_iter().chain(pose.translation.0).collect::<Vec<_>>(),
            &values[..graph.variable_count()],
        )
    };
    let (short, long) = (entries(&merged), entries(&Chain::new(&graph, linked.clone())));
    assert!(short.iter().zip(&long).all(|(a, b)| (a - b).abs() < 1e-15), "{short:?} {long:?}");
    let other_axis = [vec![Step::Rotate(Axis::X, u)], linked, vec![turn(v)]].concat();
    assert_eq!(Chain::new(&graph, other_axis).merged().steps().len(), 3);
    // a palindrome of any steps vanishes altogether
    let mut random = Random(16);
    let setting = Setting::new(&graph);
    for _ in 0..ROUNDS {
        let steps = (0..5).map(|_| setting.step(&mut random)).filter(|step| !matches!(step, Step::Rigid(_)));
        let chain = Chain::new(&graph, steps.collect()).merged();
        assert_eq!(chain.then(&chain.inverse()).merged().steps(), []);
    }
}

#[test]
fn substitution_in_chains() {
    on_chains(17, |setting, chain, at, _| {
        let (motion, parameter) = (setting.motion, setting.parameter);
        let replaced = chain.substituted(&[(motion, 2.0 * setting.u), (parameter, motion - 1.0)]);
        assert_eq!(replaced.steps().len(), chain.steps().len());
        let mut moved = *at;
        moved[MOTION] = 2.0 * at[U];
        moved[4] = at[MOTION] - 1.0;
        let found = setting.pose_at(replaced.pose(), at);
        close(found, setting.dense(chain, &moved), 1e-12, "substituted");
    });
}

fn skew(w: na::Vector3<f64>) -> na::Matrix3<f64> {
    w.cross_matrix()
}

#[test]
fn twists_are_how_the_chain_moves() {
    on_chains(18, |setting, chain, at, _| {
        let twist = chain.twist(setting.motion);
        let (angular, linear) = (setting.vector_at(twist.angular, at), setting.vector_at(twist.linear, at));
        // from the multiplied-out pose
        let other = chain.pose().twist(setting.motion);
        close(angular, setting.vector_at(other.angular, at), 1e-10, "angular, from the pose");
        close(linear, setting.vector_at(other.linear, at), 1e-10, "linear, from the pose");
        // from differences of dense matrices: M⁻¹ ∂M
        let inverse = setting.dense(chain, at).try_inverse().expect("rigid");
        let motion = inverse * slope(at, MOTION, |at| setting.dense(chain, at));
        close(skew(angular), motion.fixed_view::<3, 3>(0, 0).into_owned(), 1e-7, "angular");
        close(linear, motion.fixed_view::<3, 1>(0, 3).into_owned(), 1e-7, "linear");
        // a point that the frame carries
        let p = Vector3([setting.u, setting.v, setting.parameter]);
        let carried = chain.direction(twist.velocity(p));
        let slopes = slope(at, MOTION, |moved| {
            let fixed = setting.vector_at(p, at).push(1.0);
            (setting.dense(chain, moved) * fixed).xyz()
        });
        close(setting.vector_at(carried, at), slopes, 1e-7, "velocity");
    });
}

#[test]
fn twists_of_what_stands_still_vanish() {
    let graph = Graph::new();
    let setting = Setting::new(&graph);
    let chain = Chain::new(
        &graph,
        vec![
            Step::Rotate(Axis::X, setting.parameter),
            Step::Translate(Vector3([setting.parameter; 3])),
            Step::Rotate(Axis::Z, setting.second),
        ],
    );
    assert!(chain.twist(setting.motion).is_zero());
    assert!(!chain.twist(setting.second).is_zero());
    assert_eq!(Twist::zero(&graph).plus(Twist::zero(&graph)), Twist::zero(&graph));
}

#[test]
fn long_chains_stay_linear() {
    let steps = |length: usize| {
        let graph = Graph::new();
        let setting = Setting::new(&graph);
        let mut random = Random(19);
        let chain = setting.chain(&mut random, length);
        let p = Vector3([setting.u, setting.v, setting.parameter]);
        let velocity = chain.twist(setting.motion).velocity(p);
        let outputs = [chain.point(p).0, velocity.0, chain.pose().translation.0].concat();
        let inputs = [setting.u, setting.v, setting.motion, setting.second, setting.parameter];
        let tape = Tape::new(&outputs, &inputs).unwrap();
        (tape.instructions().len(), graph.len())
    };
    let (short, long) = (steps(500), steps(1000));
    assert!(long.0 < 300 * 1000, "{} steps of the tape for 1000 frames", long.0);
    assert!(long.0 * 10 < short.0 * 22, "{} then {}", short.0, long.0);
    assert!(long.1 * 10 < short.1 * 22, "{} then {} nodes", short.1, long.1);
}

/// A point of a thread, (r·cos g − w·sin g, r·sin g + w·cos g), on a spindle turned by another angle: the two angles become
/// one, and so do those of a normal that is divided by its length.
#[test]
fn what_turns_already_turns_on() {
    let graph = Graph::new();
    let [thread, spindle, width] = ["thread", "spindle", "width"].map(|name| graph.variable(name));
    let (c, s) = ((thread - width).cos(), (thread - width).sin());
    let length = (1.0 + width * width).sqrt();
    for axis in 0..3 {
        let in_order = |parts: [_; 3]| Vector3(std::array::from_fn(|k| parts[(k + 3 - axis) % 3]));
        let point = in_order([thread * 0.5, 2.0 * c - width * s, 2.0 * s + width * c]);
        let normal = in_order([1.0 / length, -(width * s / length), width * c / length]);
        let turn = Step::Rotate([Axis::X, Axis::Y, Axis::Z][axis], spindle);
        let chain = Chain::new(&graph, vec![turn]);
        let turned = [chain.point(point), chain.direction(normal)];
        let dense = [point, normal].map(|vector| turn.pose(&graph).direction(vector));
        let outputs: Vec<_> = turned.iter().chain(&dense).flat_map(|vector| vector.0).collect();
        for at in [[0.3, 1.1, -0.7], [-2.0, 5.0, 0.4], [4.0, -0.2, 2.5]] {
            let found = graph.evaluate(&outputs, &at);
            for (a, b) in found[..6].iter().zip(&found[6..]) {
                assert!((a - b).abs() < 1e-13, "axis {axis}: {a} instead of {b}");
            }
        }
        let tape = Tape::new(&outputs[..6], &[thread, spindle, width]).expect("all given");
        let angles: usize = tape.cost(&[0, 0, 0]).iter().map(|stage| stage.sincos).sum();
        assert_eq!(angles, 1, "axis {axis}");
    }
}
