//! Which settings of a cradle generator make given poses: those of jobs come back, also through a free-form machine.

use flank_chain_dsl::{Dimension, Job};
use flank_expr::geometry::{Axis, Chain, Step, Vector3};
use flank_expr::{Expr, Graph};
use flank_solver::{
    AdjustableMachine, PoseProblem, Range, SettingBounds, SettingKind, SettingsFit, SettingsProblem, TargetAxis,
    UnknownSetting,
};
use flank_tests::machines::{beside, target_axis, unseen};

/// Of all cradle jobs: what a machine summary has without motions.
const BASIC: [&str; 9] = [
    "radial_distance",
    "cradle_angle",
    "machine_root_angle",
    "ratio_of_roll",
    "cutter_tilt",
    "cutter_swivel",
    "work_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
];

/// A job on a cradle generator, and the generator by itself.
fn compiled<'g>(graph: &'g Graph, job: &str) -> (Job<'g>, Job<'g>) {
    let (mut jobs, machine) = beside(graph, [job, "specs/machines/cradle.chain"], &[]);
    (jobs.swap_remove(0), machine)
}

/// Positions of a roll from -8 to 9 degrees.
fn rolls() -> Vec<Vec<f64>> {
    (0..13).map(|k| vec![(-8.0 + 17.0 / 12.0 * f64::from(k)).to_radians()]).collect()
}

/// The settings of these names with which the generator makes the source's poses.
fn fit<'g>(job: &Job<'g>, target: &Job<'g>, source: &Chain<'g>, names: &[&str]) -> SettingsFit {
    let graph = job.motions[0].variable.graph();
    let machine = &target.machines[0];
    let unknown = |name: &&str| {
        let full = format!("{}.{name}", machine.name);
        let setting = target.settings.iter().find(|setting| setting.name == full).expect("a setting");
        let kind = match setting.dimension {
            Dimension::LENGTH => SettingKind::Length,
            Dimension::ANGLE => SettingKind::Angle,
            _ => SettingKind::Number,
        };
        let usual = target.parameters.iter().find(|p| p.name == full).map(|p| p.value);
        let range = Range { low: setting.low, high: setting.high };
        UnknownSetting { variable: setting.variable, sought: SettingBounds { kind, range, usual } }
    };
    let settings: Vec<UnknownSetting<'g>> = names.iter().map(unknown).collect();
    let roll = machine.axes.iter().find(|axis| axis.name == "roll").expect("its one axis");
    let axes = [target_axis(roll)];
    let laws = machine.axes.iter().filter(|axis| axis.law != axis.variable).map(|axis| (axis.variable, axis.law));
    let laws: Vec<(Expr<'g>, Expr<'g>)> = laws.collect();
    let chain = machine.chain(graph, "work", "cutter").expect("both frames").substituted(&laws);
    let open: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
    let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings_beside(&open)).collect();
    let [chain, source] = [&chain, source].map(|chain| chain.substituted(&bindings));
    let generator = AdjustableMachine { chain: &chain, settings: &settings, axes: &axes };
    let motions = [job.motions[0].variable];
    let problem = SettingsProblem::new(&generator, &source, &motions, &unseen(job, &job.surfaces[0]), 200.0);
    problem.expect("all bound").fit(&rolls())
}

/// Names are those of the job's own settings, which all come back.
fn assert_own(job: &Job<'_>, names: &[&str], fit: &SettingsFit, but: &[&str]) {
    assert!(fit.is_exact && fit.displacement < 1e-9 && fit.turn < 1e-11, "{fit:?}");
    for (name, found) in names.iter().zip(&fit.settings).filter(|(name, _)| !but.contains(name)) {
        let own = job.parameters.iter().find(|p| p.name == format!("m.{name}")).expect("a setting of the job").value;
        assert!((found - own).abs() < 1e-8, "{name}: {found} instead of {own}");
    }
    let told: Vec<&str> = fit.undetermined.iter().map(|&k| names[k]).collect();
    assert_eq!(told, but);
}

#[test]
fn a_pinion_on_its_own_generator_has_its_own_settings() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, "specs/bevel/pinion_19x62.chain");
    let found = fit(&job, &target, &job.surfaces[0].generation.driven, &BASIC);
    // without tilt, where to does not matter
    assert_own(&job, &BASIC, &found, &["cutter_swivel"]);
    assert_eq!(found.settings[5], 0.0);
}

/// With tilt, modified roll and helical motion.
#[test]
fn settings_and_motions_of_a_tilted_cutter_come_back() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, "specs/bevel/tilted_pinion.chain");
    let names =
        [&BASIC[..], &["modified_roll_2c", "modified_roll_6d", "helical_motion_1", "helical_motion_2"]].concat();
    let found = fit(&job, &target, &job.surfaces[0].generation.driven, &names);
    assert_own(&job, &names, &found, &[]);
}

/// Cradle to free-form to cradle: what is between are polynomials of six axes.
#[test]
fn settings_come_back_through_a_free_form_machine() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, "specs/bevel/pinion_19x62.chain");
    let axes: Vec<Expr<'_>> = ["X", "Y", "Z", "A", "B", "C"].iter().map(|name| graph.variable(*name)).collect();
    let half = graph.constant(std::f64::consts::PI);
    let free_form = Chain::new(
        &graph,
        vec![
            Step::Rotate(Axis::Z, -axes[3]),
            Step::Rotate(Axis::Y, -(0.5 * half + axes[4])),
            Step::Translate(Vector3([axes[0], axes[1], axes[2]])),
            Step::Rotate(Axis::Z, axes[5]),
            Step::Rotate(Axis::X, half),
        ],
    );
    let free: Vec<TargetAxis<'_>> = axes
        .iter()
        .enumerate()
        .map(|(k, axis)| TargetAxis { variable: *axis, is_rotary: k > 2, travel: None })
        .collect();
    let driven = job.surfaces[0].generation.driven.substituted(&job.bindings());
    let motions = [job.motions[0].variable];
    let problem = PoseProblem::new(&free_form, &free, &driven, &motions, &unseen(&job, &job.surfaces[0]), 1000.0)
        .expect("six axes");
    let posture = &problem.postures(&[0.0])[0];
    let series = problem.series(posture, &[0.0], 0, 16).expect("no singular pose");
    let laws: Vec<(Expr<'_>, Expr<'_>)> = axes
        .iter()
        .zip(series)
        .map(|(axis, c)| (*axis, c.iter().rev().fold(graph.constant(0.0), |sum, c| sum * motions[0] + *c)))
        .collect();
    let found = fit(&job, &target, &free_form.substituted(&laws), &BASIC);
    assert_own(&job, &BASIC, &found, &["cutter_swivel"]);
}

/// A tilted cutter's poses, looked for without tilt: what is left is told, and small settings do not hide it.
#[test]
fn what_settings_cannot_do_is_left() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, "specs/bevel/tilted_pinion.chain");
    let names: Vec<&str> = BASIC.iter().copied().filter(|name| !name.starts_with("cutter")).collect();
    let found = fit(&job, &target, &job.surfaces[0].generation.driven, &names);
    assert!(!found.is_exact && (found.displacement > 1e-4 || found.turn > 1e-6), "{found:?}");
}
