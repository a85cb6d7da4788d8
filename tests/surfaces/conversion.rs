//! A cradle generator's process carried over to the free-form machine, against the independent table.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_chain_dsl::ToolShape;
use flank_expr::geometry::{Axis, Chain, Step};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{Outcome, PoseProblem, Posture, Range, Screw, TargetAxis, Unproven};
use flank_tests::conversion::{Conversion, compiled, target_axes};
use flank_tests::machines::unseen;
use flank_tests::{largest, points, reference_json};
use serde_json::Value;

#[test]
fn a_cutter_of_revolution_turns_freely() {
    let graph = Graph::new();
    let (job, _) = compiled(&graph, TABLES);
    let found = unseen(&job, &job.surfaces[0]);
    assert_eq!(found, [Screw { angular: [0.0, 0.0, 1.0], linear: [0.0; 3] }]);
}

/// The table's cradle turns the other way; its work's zero lies opposite, and its cutter's phase counts from another line and
/// the other way.
fn of_table(name: &str, value: f64, row: &Value) -> f64 {
    let of = |key: &str| row[key].as_f64().expect("a number");
    match name {
        "A" => value - (of("A") - PI),
        "C" => value - (of("Cc") + FRAC_PI_2),
        _ => value - of(name),
    }
}

const TABLES: [&str; 2] = ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"];

#[test]
fn axes_meet_the_table() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let reference = reference_json("freeform.json");
    let rows = reference["axes"].as_array().expect("rows");
    let motions: Vec<Vec<f64>> = rows.iter().map(|row| vec![-row["psi"].as_f64().expect("a number")]).collect();
    let first = conversion.problem.postures(&motions[0]);
    let line = conversion.problem.follow(&first[0], &motions);
    for (posture, row) in line.iter().zip(rows) {
        assert_eq!((posture.outcome, posture.missing), (Outcome::Solved, None));
        for (name, value) in conversion.axes.iter().zip(&posture.axes) {
            let off = of_table(name, *value, row);
            assert!(off.abs() < 1e-10, "{name} is off by {off:e} at {}", row["psi"]);
        }
    }
}

#[test]
fn taylor_coefficients_meet_the_table() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let reference = reference_json("freeform.json");
    let first = conversion.problem.postures(&[0.0]);
    let series = conversion.problem.series(&first[0], &[0.0], 0, 6).expect("no singular pose");
    for (name, found) in conversion.axes.iter().zip(series) {
        let expected = reference["taylor"][if name == "C" { "Cc" } else { name }].as_array().expect("coefficients");
        for (k, c) in expected.iter().enumerate().skip(1) {
            let c = c.as_f64().expect("a number") * if k % 2 == 0 { 1.0 } else { -1.0 };
            assert!((found[k] - c).abs() < 1e-9 * c.abs(), "{name}, order {k}: {:e} instead of {c:e}", found[k]);
        }
    }
}

/// Polynomials of order four and six cut the flank a little off: as far along its normal as the table's flanks, which are solved
/// anew with polynomials for axes. What is left is of second order: where the deviation d changes along the motion, the tool touches
/// at another value of it, which is worth (d')² / (2 K), 3e-7 mm for d' = 6e-3 mm/rad and a clearance that opens by K = 60 mm/rad².
#[test]
fn what_cut_off_series_leave_meets_the_table() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let first = conversion.problem.postures(&[0.0]);
    let series = conversion.problem.series(&first[0], &[0.0], 0, 6).expect("no singular pose");
    let ToolShape::Surface(tool) = &job.surfaces[0].generation.tool else { panic!("a cutter has a surface") };
    let tool = tool.bound(&job.bindings());
    let position = conversion.problem.chain().point(tool.position);
    let inputs: Vec<Expr<'_>> = tool.unknowns.iter().chain(conversion.problem.unknowns()).copied().collect();
    let tape = Tape::new(&position.0, &inputs).expect("all bound");
    let reference = reference_json("freeform.json");
    for (table, order) in [("poly4_rows", 4), ("poly6_rows", 6)] {
        let rows = reference[table].as_array().expect("rows");
        let of = |row: &Value, key: &str| row[key].as_f64().expect("a number");
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [of(row, "z"), of(row, "rho")]).collect();
        for (point, row) in points(&job, "concave", ["z", "rho"], &targets).iter().zip(rows) {
            let h = point.unknowns[2];
            let axes = series.iter().map(|c| c[..=order].iter().rev().fold(0.0, |sum, c| sum * h + c));
            let at: Vec<f64> = point.unknowns[..2].iter().copied().chain(axes).collect();
            let mut moved = [0.0; 3];
            ScalarEvaluator::new(&tape).run(&at, &mut moved);
            let found: f64 = (0..3).map(|k| point.normal[k] * (moved[k] - point.position[k])).sum();
            let expected = of(row, "dev");
            // the table's normal points out of the tool
            assert!(
                (found + expected).abs() < 2e-3 * expected.abs() + 1e-11,
                "{table}: {found:e} instead of {:e}",
                -expected
            );
        }
    }
}

/// A job carried over to its own machine stands as it stood: two motions, a hob that is a screw, a spindle of more than a turn.
#[test]
fn a_hobbing_job_on_its_own_machine_is_itself() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, ["specs/hobbing/helical_gear.chain", "specs/machines/hobbing_6axis.chain"]);
    let generation = &job.surfaces[0].generation;
    let screws = unseen(&job, &job.surfaces[0]);
    let [Screw { angular, linear }] = screws[..] else { panic!("one screw: {screws:?}") };
    // the lead of the thread, divided by a turn
    let rise = 38.0 * f64::tan(f64::asin(2.0 * 3.0 / 76.0));
    assert_eq!((angular, linear[0], linear[1]), ([0.0, 0.0, 1.0], 0.0, 0.0));
    assert!((linear[2] - rise).abs() < 1e-9, "{linear:?}");
    let conversion = Conversion::new(&graph, &job, &target, ["table", "hob"]);
    let positions: Vec<Vec<f64>> =
        (0..40).map(|k| vec![1.0 + 0.25 * f64::from(k), -13.0 + 0.6 * f64::from(k)]).collect();
    let first = conversion.problem.postures(&positions[0]);
    let laws: Vec<Expr<'_>> = job.machines[0].axes.iter().map(|axis| axis.law).collect();
    let bound = graph.substitute(&laws, &job.bindings());
    let tape = Tape::new(&bound, &generation.motions).expect("all bound");
    for (posture, at) in conversion.problem.follow(&first[0], &positions).iter().zip(&positions) {
        assert_eq!((posture.outcome, posture.missing), (Outcome::Solved, None), "{at:?}");
        let mut expected = vec![0.0; laws.len()];
        ScalarEvaluator::new(&tape).run(at, &mut expected);
        for ((name, found), expected) in conversion.axes.iter().zip(&posture.axes).zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{name}: {found} instead of {expected} at {at:?}");
        }
    }
}

/// The tool of a table that turns only about one axis: what is missing is told.
#[test]
fn what_a_machine_has_no_axis_for_is_told() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"]);
    let machine = &target.machines[0];
    // without B: four axes and the turn that the cutter does not see
    let still = machine.axes.iter().find(|axis| axis.name == "B").expect("B").variable;
    let chain = machine.chain(&graph, "work", "cutter").expect("both frames");
    let chain = chain.substituted(&[(still, graph.constant(0.2))]);
    let axes: Vec<TargetAxis<'_>> = target_axes(&target).into_iter().filter(|axis| axis.variable != still).collect();
    let generation = &job.surfaces[0].generation;
    let screws = unseen(&job, &job.surfaces[0]);
    let [chain, driven] = [&chain, &generation.driven].map(|chain| chain.substituted(&job.bindings()));
    let problem = PoseProblem::new(&chain, &axes, &driven, &generation.motions, &screws, 1000.0).expect("few");
    let posture = &problem.postures(&[0.1])[0];
    let missing = posture.missing.expect("the cutter's axis cannot be met");
    assert!(missing.direction >= 3 && missing.by.abs() > 1e-3, "{missing:?}");
}

/// The largest distance of the axes from polynomials at postures over a range, and the bound of a tube.
fn sampled_and_proven(conversion: &Conversion<'_>, range: Range, series: &[Vec<f64>], about: f64) -> [Vec<f64>; 2] {
    let first = conversion.problem.postures(&[about]).swap_remove(0);
    let tube = conversion.problem.tube(&first, about, range).expect("no singular pose");
    let mut sampled = vec![0.0f64; first.axes.len()];
    for end in [range.low, range.high] {
        let motions: Vec<Vec<f64>> = (0..=100).map(|k| vec![about + (end - about) * f64::from(k) / 100.0]).collect();
        for (posture, motion) in conversion.problem.follow(&first, &motions).iter().zip(&motions) {
            let h = motion[0] - about;
            for ((most, axis), c) in sampled.iter_mut().zip(&posture.axes).zip(series) {
                *most = largest([*most, (axis - c.iter().rev().fold(0.0, |sum, c| sum * h + c)).abs()]);
            }
        }
    }
    [sampled, tube.distances(about, series)]
}

/// What is proven of each axis's remainder is never below what is seen at 201 positions, and hardly above it: where the order of
/// the series decides, not rounding (a length of 100 mm after some hundred operations), by less than a hundredth.
#[test]
fn remainders_are_bounded() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let reference = reference_json("freeform.json");
    let range = Range { low: -0.3, high: 0.2 };
    let first = conversion.problem.postures(&[0.0]).swap_remove(0);
    for order in 2..=8 {
        let series = conversion.problem.series(&first, &[0.0], 0, order).expect("no singular pose");
        let [sampled, proven] = sampled_and_proven(&conversion, range, &series, 0.0);
        for (k, name) in conversion.axes.iter().enumerate() {
            let [seen, bound] = [sampled[k], proven[k]];
            assert!(bound >= seen && bound <= 1.01 * seen + 2e-12, "{name}, order {order}: {bound:e}, {seen:e} seen");
            let table = &reference["max_dev"][format!("order{order}")][if name == "C" { "Cc" } else { name }];
            if let Some(table) = table.as_f64() {
                assert!(bound >= table && bound <= 1.01 * table + 2e-12, "{name}: {bound:e}, {table:e} in the table");
            }
        }
    }
}

/// How far straight blocks are off the axes is bounded, never below what is seen and hardly above it.
#[test]
fn straight_blocks_are_bounded() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let range = Range { low: -0.3, high: 0.2 };
    let first = conversion.problem.postures(&[0.0]).swap_remove(0);
    let tube = conversion.problem.tube(&first, 0.0, range).expect("no singular pose");
    for count in [1, 2, 7, 50] {
        for block in 0..count {
            let at = |k: usize| range.low + (range.high - range.low) * k as f64 / count as f64;
            let (from, to) = (at(block), at(block + 1));
            let between: Vec<Vec<f64>> = (0..=40).map(|k| vec![from + (to - from) * f64::from(k) / 40.0]).collect();
            let way: Vec<Vec<f64>> = (0..=20).map(|k| vec![from * f64::from(k) / 20.0]).collect();
            let start = conversion.problem.follow(&first, &way).swap_remove(20);
            let line = conversion.problem.follow(&start, &between);
            let chords: Vec<Vec<f64>> = (0..conversion.axes.len())
                .map(|k| vec![line[0].axes[k], (line[40].axes[k] - line[0].axes[k]) / (to - from)])
                .collect();
            let proven = tube.distances_over(Range { low: from, high: to }, from, &chords);
            for (k, name) in conversion.axes.iter().enumerate() {
                let off = |(at, posture): (&Vec<f64>, &Posture)| {
                    (posture.axes[k] - chords[k][0] - (at[0] - from) * chords[k][1]).abs()
                };
                let seen = largest(between.iter().zip(&line).map(off));
                // a block is bounded in sixteen parts, each by the sizes of its coefficients
                assert!(
                    proven[k] >= seen && proven[k] <= 1.02 * seen + 2e-12,
                    "{name}, {count}: {:e}, {seen:e}",
                    proven[k]
                );
            }
        }
    }
}

/// A polynomial that is wrong is as far off as it is.
#[test]
fn remainders_of_wrong_polynomials_show() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    let first = conversion.problem.postures(&[0.0]).swap_remove(0);
    let mut series = conversion.problem.series(&first, &[0.0], 0, 6).expect("no singular pose");
    series[0][1] += 0.5;
    series[3][0] += 0.1;
    let [sampled, proven] = sampled_and_proven(&conversion, Range { low: -0.3, high: 0.2 }, &series, 0.0);
    assert!((proven[0] - 0.15).abs() < 1e-3 && proven[3] >= 0.1, "{proven:?}");
    assert!(sampled.iter().zip(&proven).all(|(seen, bound)| bound >= seen), "{sampled:?} {proven:?}");
}

/// A hob's spindle turns by more than a turn; the axes are polynomials of the third order themselves.
#[test]
fn remainders_over_more_than_a_turn() {
    let graph = Graph::new();
    let (_, target) = compiled(&graph, ["specs/hobbing/helical_gear.chain", "specs/machines/hobbing_6axis.chain"]);
    let machine = &target.machines[0];
    let turn = graph.variable("turn");
    let chain = machine.chain(&graph, "table", "hob").expect("both frames");
    let law = |name: &str| match name {
        "X" => 90.0 + 0.01 * turn.powi(3),
        "Y" => 0.1 * turn.powi(2),
        "Z" => 0.5 * turn,
        "A" => graph.constant(0.3),
        "B" => turn,
        _ => 0.05 * turn,
    };
    let laws: Vec<_> = machine.axes.iter().map(|axis| (axis.variable, law(&axis.name))).collect();
    let axes = target_axes(&target);
    let source = chain.substituted(&laws);
    let problem = PoseProblem::new(&chain, &axes, &source, &[turn], &[], 1000.0).expect("six axes");
    let conversion = Conversion { problem, axes: Vec::new() };
    let first = conversion.problem.postures(&[0.0]).swap_remove(0);
    let series = conversion.problem.series(&first, &[0.0], 0, 3).expect("no singular pose");
    let [sampled, proven] = sampled_and_proven(&conversion, Range { low: -4.0, high: 5.0 }, &series, 0.0);
    assert!(sampled.iter().zip(&proven).all(|(seen, bound)| seen <= bound && *bound < 1e-11), "{sampled:?} {proven:?}");
}

/// Ranges of no width, and of one that rounding ends at once.
#[test]
fn a_range_of_one_value_proves_nothing_and_one_of_two_neighbours_ends() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = Conversion::new(&graph, &job, &target, ["work", "cutter"]);
    for about in [-0.2, 0.0, 0.1_f64] {
        let first = conversion.problem.postures(&[about]).swap_remove(0);
        let tube = |low: f64, high: f64| conversion.problem.tube(&first, about, Range { low, high });
        assert_eq!(tube(about, about).map(|_| ()), Err(Unproven { at: about }));
        for (low, high) in [(about, about.next_up()), (about.next_down(), about), (about.next_up(), about.next_up())] {
            let distances = tube(low, high).expect("no singular pose").distances(about, &vec![vec![0.0]; 6]);
            let axes = first.axes.iter().zip(&distances);
            assert!(axes.clone().all(|(axis, off)| axis.abs() <= *off && *off < axis.abs() + 1e-9), "{distances:?}");
        }
        let elsewhere = Range { low: about + 0.2, high: about + 0.3 };
        let tube = tube(about, about + 0.1).expect("no singular pose");
        let outside = tube.distances_over(elsewhere, about, &vec![vec![0.0]; 6]);
        assert!(outside.iter().all(|off| *off == f64::INFINITY), "{outside:?}");
    }
}

/// The free-form machine holds its tool parallel to the work's axis in the middle of a tool's swing, or nearly.
#[test]
fn in_a_singular_pose_nothing_is_claimed() {
    let graph = Graph::new();
    let (_, target) = compiled(&graph, TABLES);
    let swing = graph.variable("swing");
    let machine = &target.machines[0];
    let chain = machine.chain(&graph, "work", "cutter").expect("both frames");
    let tube = |beside: f64| {
        let turned = [(Axis::X, swing), (Axis::Y, graph.constant(beside))].map(|(line, by)| Step::Rotate(line, by));
        let source = Chain::new(&graph, turned.to_vec());
        let problem = PoseProblem::new(&chain, &target_axes(&target), &source, &[swing], &[], 1000.0);
        let problem = problem.expect("six axes");
        let first = problem.postures(&[-0.5]).swap_remove(0);
        assert!(problem.follow(&first, &[vec![-0.5]])[0].missing.is_none());
        problem.tube(&first, -0.5, Range { low: -0.5, high: 0.5 }).map(|_| ())
    };
    let Err(Unproven { at }) = tube(0.0) else { panic!("nothing is proven through a singular pose") };
    assert!(at > -0.01 && at <= 0.0, "{at}");
    // A and C turn by half a turn within some hundredths of a radian
    assert_eq!(tube(0.02), Ok(()));
}
