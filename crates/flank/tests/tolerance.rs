//! Tolerances against random cases and differences that other operations of the library solve.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{
    Buffers, CauseKind, ContactRequest, ContactResult, DeviationRequest, DeviationResult, Disk, Failure, JobSelection,
    MountingError, Project, ToleranceRequest, ToleranceResult, ToleratedAmount, Unwatched, contact, deviation,
    tolerance,
};

fn spec(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").join(name)
}

fn opened(name: &str) -> JobSelection {
    JobSelection { project: Project::open(spec(name), Arc::new(Disk)), job: None, set: Vec::new() }
}

/// SplitMix64 and the sum of twelve uniform numbers: mean 0, variance 1, another way than the library's.
struct Dice(u64);

impl Dice {
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn deviation_of<'r>(of: &'r ToleranceResult, name: &str) -> &'r flank::ToleratedResult {
    of.results.iter().find(|of| of.name == name).unwrap_or_else(|| panic!("{name} in {:?}", of.results))
}

const FIVE: [(&str, f64, &str); 5] = [
    ("m.radial_distance", 0.005, "mm"),
    ("m.machine_root_angle", 0.5, "arcmin"),
    ("m.work_offset", 0.005, "mm"),
    ("m.ratio_of_roll", 3e-4, ""),
    ("c.blade_angle", 0.5, "arcmin"),
];

/// How far a surface of the job `off` lies off that of the job `nominal`.
fn deviated(jobs: JobSelection, surface: &str) -> DeviationResult {
    let request = DeviationRequest {
        jobs,
        surface: format!("off.{surface}"),
        reference: Some(format!("nominal.{surface}")),
        reference_jobs: None,
        measured: None,
        rows: None,
        columns: None,
        margin: None,
        no_align: false,
        out: std::env::temp_dir(),
        format: vec![],
        no_picture: true,
        evaluator: flank::EvaluatorOptions::default(),
    };
    deviation(&request, &Unwatched).expect("deviations")
}

/// Of slopes, crownings and bias the standard deviation over 300 cases, each solved anew by `flank deviation`: within three standard errors,
/// 12 %, of the linear one.
#[test]
fn linear_tolerances_are_those_of_random_cases() {
    let text = "use \"pinion_19x62.chain\"\njob nominal = pinion_19x62()\njob off = pinion_19x62()\n";
    let files = Buffers::over(Arc::new(Disk)).with(&spec("bevel/both.chain"), text);
    let both =
        JobSelection { project: Project::open(spec("bevel/both.chain"), Arc::new(files)), job: None, set: vec![] };
    let amount = |(name, by, unit): (&str, f64, &str)| {
        let amount = match unit {
            "mm" => ToleratedAmount::Length(by),
            "arcmin" => ToleratedAmount::Angle((by / 60.0f64).to_radians()),
            _ => ToleratedAmount::Number(by),
        };
        (name.to_string(), amount)
    };
    let request = ToleranceRequest {
        scatter: FIVE.map(amount).to_vec(),
        ..ToleranceRequest::new(opened("bevel/pinion_19x62.chain"), "concave")
    };
    let told = tolerance(&request, &Unwatched).expect("tolerances");
    let values: Vec<f64> = told.causes.iter().map(|cause| cause.now).collect();
    let value = |name: &str| {
        let at = told.causes.iter().position(|cause| cause.name == name).expect("a cause");
        (values[at], told.causes[at].unit.clone())
    };
    let (cases, mut dice, mut squares) = (300, Dice(3), [0.0; 5]);
    for _ in 0..cases {
        let set = FIVE.map(|(name, by, unit)| {
            let (now, shown) = value(name);
            let off = by * dice.normal() / if unit == "arcmin" { 60.0 } else { 1.0 };
            (format!("off.{name}"), format!("{:?} {shown}", now + off))
        });
        let jobs = JobSelection { set: set.to_vec(), ..both.clone() };
        let found = deviated(jobs, "concave");
        let [across, along] = found.directions.map(|of| of.expect("a parabola"));
        assert!(across.direction.contains("root"), "{}", across.direction);
        let numbers =
            [across.slope_um, along.slope_um, across.crowning_um, along.crowning_um, found.bias_um.expect("a bias")];
        squares.iter_mut().zip(numbers).for_each(|(sum, x)| *sum += x * x);
    }
    let error = 1.0 / (2.0 * f64::from(cases)).sqrt();
    let names = ["slope_profilewise", "slope_lengthwise", "crowning_profilewise", "crowning_lengthwise", "bias"];
    for (name, squares) in names.into_iter().zip(squares) {
        let (linear, shown) = (deviation_of(&told, name).standard_deviation, (squares / f64::from(cases)).sqrt());
        assert!((shown / linear - 1.0).abs() < 3.0 * error, "{name}: {linear} um, {shown} um over the cases");
    }
}

fn rolled(pair: &str, set: Vec<(String, String)>, errors: Vec<(String, MountingError)>) -> ContactResult {
    let request = ContactRequest {
        errors,
        positions: 12,
        no_picture: true,
        format: vec![],
        ..ContactRequest::new(JobSelection { set, ..opened(&format!("pairs/{pair}.chain")) })
    };
    let mut found = Vec::new();
    contact(&request, &Unwatched, &mut |of| found.push(of)).expect("a contact");
    found.remove(0)
}

/// A value as a spec has it.
fn written(value: f64, unit: &str) -> String {
    format!("{value:?} {unit}").trim_end().to_string()
}

/// What a number changes by with a cause, from central differences of two steps so that their square cancels; and how far that may be off: a
/// hundredth of what the steps differ by, and rounding of solved points, 1e-6 um, over the step.
fn differenced<const N: usize>(step: f64, numbers: impl Fn(f64) -> [f64; N]) -> [(f64, f64); N] {
    let [a, b, c, d] = [-step, -0.5 * step, 0.5 * step, step].map(numbers);
    std::array::from_fn(|k| {
        let (wide, fine) = ((d[k] - a[k]) / (2.0 * step), (c[k] - b[k]) / step);
        ((4.0 * fine - wide) / 3.0, 1e-2 * (fine - wide).abs() + 1e-6 / step)
    })
}

/// Slopes, crownings, bias and place of bevel, hypoid and helical flanks change with a setting as `flank deviation` says of flanks with the
/// setting a little greater and smaller.
#[test]
fn flanks_change_as_their_differences_say() {
    let jobs = [
        ("bevel", "pinion_19x62", "concave", &["m.radial_distance", "m.machine_root_angle", "m.ratio_of_roll"][..]),
        ("pairs", "hypoid_pair", "gear_convex", &["g.work_offset", "c.blade_angle"]),
        ("hobbing", "helical_gear", "lower_flank", &["h.normal_pressure_angle", "helix_angle"]),
    ];
    for (folder, job, surface, names) in jobs {
        let scatter = |name: &&str| {
            let (told, unit) = (name.to_string(), if name.ends_with("_angle") { "angle" } else { "length" });
            let amount = match (unit, name.ends_with("ratio_of_roll")) {
                (_, true) => ToleratedAmount::Number(1e-4),
                ("angle", _) => ToleratedAmount::Angle(1e-4),
                _ => ToleratedAmount::Length(1e-3),
            };
            (told, amount)
        };
        let request = ToleranceRequest {
            scatter: names.iter().map(scatter).collect(),
            ..ToleranceRequest::new(opened(&format!("{folder}/{job}.chain")), surface)
        };
        let told = tolerance(&request, &Unwatched).expect("tolerances");
        let text = format!("use \"{job}.chain\"\njob nominal = {job}()\njob off = {job}()\n");
        let both = spec(&format!("{folder}/both.chain"));
        let files = Buffers::over(Arc::new(Disk)).with(&both, text);
        let both = JobSelection { project: Project::open(both, Arc::new(files)), job: None, set: vec![] };
        for (at, cause) in told.causes.iter().enumerate() {
            let numbers = |by: f64| {
                let set = vec![(format!("off.{}", cause.name), written(cause.now + by * cause.scatter, &cause.unit))];
                let found = deviated(JobSelection { set, ..both.clone() }, surface);
                let [across, along] = found.directions.map(|of| of.expect("a parabola"));
                let (slopes, crownings) = ([across.slope_um, along.slope_um], [across.crowning_um, along.crowning_um]);
                // it lies as far off as it is turned back
                let place = -1e3 * found.turn_mm.expect("a turn");
                [slopes[0], slopes[1], crownings[0], crownings[1], found.bias_um.expect("a bias"), place]
            };
            let of = [
                "slope_profilewise",
                "slope_lengthwise",
                "crowning_profilewise",
                "crowning_lengthwise",
                "bias",
                "position",
            ];
            for (name, (known, off)) in of.into_iter().zip(differenced(1.0, numbers)) {
                let exact = deviation_of(&told, name).changes[at];
                assert!(
                    (exact - known).abs() < 1e-6 * known.abs() + off,
                    "{job} {} {name}: {exact} {known} {off}",
                    cause.name
                );
            }
        }
    }
}

/// Where the middle of a contact lies, the error there and its parabola over a pitch change with settings and axes of bevel, hypoid and worm
/// pairs as `flank contact` says of contacts with these a little greater and smaller.
#[test]
fn contacts_change_as_their_differences_say() {
    // 1e-5 of an axis or a setting is far from what makes the contact another one
    let pairs = [
        ("bevel_19x62", "pinion_concave", 19.0, &["m.E", "m.S", "p.radial_distance", "pinion_cutter.blade_angle"][..]),
        ("hypoid_pair", "pinion_concave", 13.0, &["m.P", "offset", "g.machine_root_angle"]),
        ("worm_and_wheel", "worm_flank", 1.0, &["m.G", "module"]),
    ];
    for (pair, surface, teeth, names) in pairs {
        let is_angle = |name: &str| name.ends_with("_angle") || name == "m.S";
        let amount = |name: &&str| match is_angle(name) {
            true => (name.to_string(), ToleratedAmount::Angle(1e-4)),
            false => (name.to_string(), ToleratedAmount::Length(2e-3)),
        };
        let request = ToleranceRequest {
            scatter: names.iter().map(amount).collect(),
            ..ToleranceRequest::new(opened(&format!("pairs/{pair}.chain")), surface)
        };
        let told = tolerance(&request, &Unwatched).expect("tolerances");
        for (at, cause) in told.causes.iter().enumerate() {
            let numbers = |by: f64| {
                let is_axis = cause.kind == CauseKind::Mounting;
                let off = by * cause.scatter;
                let error = if is_angle(&cause.name) {
                    MountingError::Angle(off.to_radians())
                } else {
                    MountingError::Length(off)
                };
                let found = match is_axis {
                    true => rolled(pair, vec![], vec![(cause.name.clone(), error)]),
                    false => rolled(pair, vec![(cause.name.clone(), written(cause.now + off, &cause.unit))], vec![]),
                };
                let middle = found.middle.expect("they touch");
                let pitch = 360.0 / teeth;
                [1e6 * middle.error.to_radians(), middle.parabola.abs() * pitch * pitch / 8.0]
            };
            let of = ["drive_side.error", "drive_side.transmission_error"];
            for (name, (known, off)) in of.into_iter().zip(differenced(1.0, numbers)) {
                let exact = deviation_of(&told, name).changes[at];
                assert!(
                    (exact - known).abs() < 1e-6 * known.abs() + off,
                    "{pair} {} {name}: {exact} {known} {off}",
                    cause.name
                );
            }
        }
    }
}

/// A last part that two settings have says neither.
#[test]
fn a_name_that_two_settings_end_with_is_refused() {
    let request = ToleranceRequest {
        scatter: vec![("radial_distance".to_string(), ToleratedAmount::Length(1e-2))],
        ..ToleranceRequest::new(opened("pairs/bevel_19x62.chain"), "pinion_concave")
    };
    let Err(Failure::Input(reason)) = tolerance(&request, &Unwatched) else { panic!("it is not said which") };
    assert!(reason.contains("several settings end with `radial_distance`"), "{reason}");
}

/// Backwards: with the scatter that a budget leaves to each of them the result scatters by what was wanted.
#[test]
fn a_budget_is_met_by_what_it_allows() {
    let pinion = || opened("bevel/pinion_19x62.chain");
    let named = |of: &ToleranceResult| {
        let scatter = of.causes.iter().filter_map(|cause| {
            let may = cause.may_scatter?;
            Some((
                cause.name.clone(),
                match cause.unit.as_str() {
                    "mm" => ToleratedAmount::Length(may),
                    "deg" => ToleratedAmount::Angle(may.to_radians()),
                    _ => ToleratedAmount::Number(may),
                },
            ))
        });
        scatter.collect::<Vec<_>>()
    };
    let budget = vec![("bias".to_string(), ToleratedAmount::Length(3e-3))];
    let asked = ToleranceRequest { budget: budget.clone(), ..ToleranceRequest::new(pinion(), "concave") };
    let first = tolerance(&asked, &Unwatched).expect("tolerances");
    let again = ToleranceRequest { scatter: named(&first), budget, ..ToleranceRequest::new(pinion(), "concave") };
    let second = tolerance(&again, &Unwatched).expect("tolerances");
    let bias = deviation_of(&second, "bias");
    assert!((bias.standard_deviation - 3.0).abs() < 1e-9, "{}", bias.standard_deviation);
    let even = 1.0 / second.causes.len() as f64;
    assert!(bias.shares.iter().all(|share| (share - even).abs() < 1e-9), "{:?}", bias.shares);
}

/// Two settings of which the flank shows only the sum do not scatter it at all where one takes back what the other does.
#[test]
fn correlated_settings_cancel() {
    let scatter = vec![
        ("m.radial_distance".to_string(), ToleratedAmount::Length(1e-2)),
        ("m.work_offset".to_string(), ToleratedAmount::Length(1e-2)),
    ];
    let pair = ["m.radial_distance", "m.work_offset"].map(str::to_string);
    let of = |correlation: f64| {
        let correlations = if correlation == 0.0 { vec![] } else { vec![(pair.clone(), correlation)] };
        let request = ToleranceRequest {
            scatter: scatter.clone(),
            correlations,
            ..ToleranceRequest::new(opened("bevel/pinion_19x62.chain"), "concave")
        };
        tolerance(&request, &Unwatched).expect("tolerances")
    };
    let (alone, together) = (of(0.0), of(-0.999));
    for (alone, together) in alone.results.iter().zip(&together.results) {
        let [a, b] = alone.changes[..] else { panic!("two causes") };
        let wanted = (a * a + b * b - 2.0 * 0.999 * a * b).sqrt();
        assert!((together.standard_deviation - wanted).abs() < 1e-9 * wanted.max(1e-3), "{}", alone.name);
    }
}
