//! Tolerances against random cases and differences that other operations of the library solve.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{
    Buffers, ContactRequest, ContactResult, DeviationRequest, Disk, Failure, JobSelection, MountingError, Project,
    ToleranceRequest, ToleranceResult, ToleratedAmount, Unwatched, contact, deviation, tolerance,
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
        let request = DeviationRequest {
            jobs,
            surface: "off.concave".to_string(),
            reference: Some("nominal.concave".to_string()),
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
        let found = deviation(&request, &Unwatched).expect("deviations");
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

fn rolled(set: Vec<(String, String)>, errors: Vec<(String, MountingError)>) -> ContactResult {
    let request = ContactRequest {
        errors,
        positions: 12,
        no_picture: true,
        format: vec![],
        ..ContactRequest::new(JobSelection { set, ..opened("pairs/bevel_19x62.chain") })
    };
    let mut found = Vec::new();
    contact(&request, &Unwatched, &mut |of| found.push(of)).expect("a contact");
    found.remove(0)
}

/// The error in the middle and its parabola over a pitch, against central differences of `flank contact`; the mean of four shifts of
/// ten thousandths of a millimetre leaves 1e-4 of them.
#[test]
fn contacts_scatter_as_their_differences_say() {
    let request = ToleranceRequest {
        scatter: vec![
            ("m.E".to_string(), ToleratedAmount::Length(1e-2)),
            ("radial_distance".to_string(), ToleratedAmount::Length(1e-2)),
        ],
        ..ToleranceRequest::new(opened("pairs/bevel_19x62.chain"), "pinion_concave")
    };
    // two settings end so
    let Err(Failure::Input(reason)) = tolerance(&request, &Unwatched) else { panic!("it is not said which") };
    assert!(reason.contains("several settings end with `radial_distance`"), "{reason}");
    let scatter = vec![request.scatter[0].clone(), ("p.radial_distance".to_string(), request.scatter[1].1)];
    let told = tolerance(&ToleranceRequest { scatter, ..request }, &Unwatched).expect("tolerances");
    let step = 1e-3;
    let axis = |by: f64| rolled(vec![], vec![("m.E".to_string(), MountingError::Length(by))]);
    let setting = |by: f64| rolled(vec![("p.radial_distance".to_string(), format!("{:?} mm", 99.808 + by))], vec![]);
    let pitch = 360.0 / 19.0;
    let numbers = |of: &ContactResult| {
        let middle = of.middle.as_ref().expect("they touch");
        [1e6 * middle.error.to_radians(), middle.parabola.abs() * pitch * pitch / 8.0]
    };
    let both: [(usize, &dyn Fn(f64) -> ContactResult); 2] = [(0, &setting), (1, &axis)];
    for (cause, at) in both {
        let [low, high] = [-step, step].map(|by| numbers(&at(by)));
        for (k, name) in ["drive_side.error", "drive_side.transmission_error"].into_iter().enumerate() {
            let difference = (high[k] - low[k]) / (2.0 * step) * 1e-2;
            let exact = deviation_of(&told, name).changes[cause];
            assert!((exact - difference).abs() < 1e-4 * difference.abs().max(0.1), "{name}: {exact} and {difference}");
        }
    }
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
