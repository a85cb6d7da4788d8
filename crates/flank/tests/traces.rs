//! Profile and helix traces against involutes in closed form.

use std::path::Path;
use std::sync::Arc;

use flank::{
    Disk, EvaluatorOptions, FlankTraces, InvoluteSource, JobSelection, Project, ReportFormat, ReportRequest,
    TraceNumbers, Unwatched, report,
};

/// The traces of the flanks of a shipped job, with other values.
fn traces(spec: &str, set: &[(&str, &str)]) -> Vec<FlankTraces> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").join(spec);
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let jobs = JobSelection { project: Project::open(file, Arc::new(Disk)), job: None, set };
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_path_buf();
    let request = ReportRequest {
        jobs,
        out,
        format: vec![ReportFormat::Html],
        certify: false,
        step: None,
        date: None,
        evaluator: EvaluatorOptions::default(),
    };
    let mut found = Vec::new();
    report(&request, &Unwatched, &mut |result| found.extend(result.traces)).expect("it is shipped");
    found
}

/// Turn of an involute from its base circle to a distance from the axis.
fn involute(base: f64, rho: f64) -> f64 {
    let roll = ((rho / base).powi(2) - 1.0).sqrt();
    roll - roll.atan()
}

fn evaluated(of: &TraceNumbers) -> [f64; 4] {
    [of.total_um, of.form_um, of.slope_um, of.crowning_um]
}

/// A rack generates the involute itself: nothing is left but what points are solved to, 1e-9 mm.
#[test]
fn a_generated_spur_gear_has_no_deviations() {
    let found = traces("hobbing/spur_gear.chain", &[]);
    assert_eq!(found.iter().map(|of| &*of.surface).collect::<Vec<_>>(), ["flank_plus", "flank_minus"]);
    for of in &found {
        // the rack has the pressure angle, the job has none
        assert_eq!(of.involute.source, InvoluteSource::Tool);
        assert!((of.involute.base_diameter_mm - 72.0 * 20f64.to_radians().cos()).abs() < 1e-12, "{:?}", of.involute);
        for trace in [&of.profile, &of.helix] {
            assert_eq!(trace.lengths_mm.len(), trace.asked);
            assert!(evaluated(trace).iter().all(|um| um.abs() < 1e-5), "{:?}", evaluated(trace));
        }
        // 95 % of the length of roll, and 5 % of the face left out at each end
        let lengths = &of.profile.lengths_mm;
        let share = (of.profile.evaluated_to_mm - lengths[0]) / (lengths[lengths.len() - 1] - lengths[0]);
        assert!((share - 0.95).abs() < 1e-12, "{share}");
        assert!((of.helix.evaluated_from_mm + 9.0).abs() < 1e-9 && (of.helix.evaluated_to_mm - 9.0).abs() < 1e-9);
    }
}

/// A table that turns too much with the feed: the flank is a helicoid of another lead, whose helix trace is a straight line.
#[test]
fn a_wrong_lead_is_a_helix_slope() {
    let twist: f64 = -0.00573;
    let found = traces("hobbing/crowned_gear.chain", &[("crowning", "0 mm"), ("m.twist", "-0.00573 rad/mm")]);
    let beta = (-18f64).to_radians();
    let radius = 4.0 * 27.0 / (2.0 * beta.cos());
    let base = radius * (20f64.to_radians().tan() / beta.cos()).atan().cos();
    let rise = 1e3 * base * (twist - beta.tan() / radius) * 32.0;
    assert!(rise.abs() > 5.0, "{rise}");
    for (of, side) in found.iter().zip([1.0, -1.0]) {
        let [total, form, slope, crowning] = evaluated(&of.helix);
        // whichever flank it is, the two are opposite
        assert!((slope.abs() - rise.abs()).abs() < 1e-4, "{slope} {rise}");
        assert!((slope * side - found[0].helix.slope_um).abs() < 1e-4, "{slope}");
        // over the 90 % of the face that are evaluated, and beyond them where material stands out
        assert!((total - 0.95 * rise.abs()).abs() < 1e-4, "{total} {rise}");
        assert!(form < 1e-4 && crowning.abs() < 1e-4, "{form} {crowning}");
    }
}

/// A hob of another pressure angle leaves an involute of another base circle: that on which its normal base pitch is the gear's.
#[test]
fn a_wrong_pressure_angle_is_a_profile_slope() {
    let set = [("h.normal_pressure_angle", "20.2 deg"), ("crowning", "0 mm")];
    let found = traces("hobbing/crowned_gear.chain", &set);
    let beta = (-18f64).to_radians();
    let radius = 4.0 * 27.0 / (2.0 * beta.cos());
    let twist = beta.tan() / radius;
    let base = |pressure_angle: f64| {
        let normal = 27.0 * 4.0 / 2.0 * pressure_angle.to_radians().cos();
        normal / (1.0 - (normal * twist).powi(2)).sqrt()
    };
    let (design, made) = (base(20.0), base(20.2));
    for of in &found {
        assert!((of.involute.base_diameter_mm - 2.0 * design).abs() < 1e-9, "{:?}", of.involute);
        let lengths = &of.profile.lengths_mm;
        let middle = lengths[lengths.len() / 2];
        let rho = |length: f64| design.hypot(length);
        let off = |length: f64| {
            let apart = |length: f64| involute(made, rho(length)) - involute(design, rho(length));
            // a smaller base circle bends the involute back from the tip's material
            -1e3 * design * (apart(length) - apart(middle))
        };
        for (length, found) in lengths.iter().zip(&of.profile.deviations_um) {
            assert!((found - off(*length)).abs() < 1e-4, "{length}: {found} {}", off(*length));
        }
        assert!(of.profile.slope_um < -10.0, "more pressure angle, less material at the tip: {}", of.profile.slope_um);
        assert!(evaluated(&of.helix).iter().all(|um| um.abs() < 1e-4), "{:?}", evaluated(&of.helix));
    }
}

/// What is set of the tool from outside makes another flank, not another gear: a job without a pressure angle of its own is held against that
/// which its text gives the tool. An involute of a base circle with another radius rises over it by the length of roll times the share of
/// the change, but for terms of its square.
#[test]
fn a_tool_that_is_set_otherwise_is_held_against_the_text() {
    let design = 36.0 * 20f64.to_radians().cos();
    for degrees in [20.2_f64, 19.9] {
        let found = traces("hobbing/spur_gear.chain", &[("r.pressure_angle", &format!("{degrees} deg"))]);
        let made = 36.0 * degrees.to_radians().cos();
        assert_eq!(found.len(), 2);
        for of in &found {
            assert_eq!(of.involute.source, InvoluteSource::Tool);
            assert!((of.involute.base_diameter_mm - 2.0 * design).abs() < 1e-12, "{:?}", of.involute);
            let lengths = &of.profile.lengths_mm;
            let middle = lengths[lengths.len() / 2];
            let apart = |length: f64| {
                let rho = design.hypot(length);
                involute(made, rho) - involute(design, rho)
            };
            for (length, found) in lengths.iter().zip(&of.profile.deviations_um) {
                let wanted = -1e3 * design * (apart(*length) - apart(middle));
                assert!((found - wanted).abs() < 1e-4, "{length}: {found} {wanted}");
            }
            let share = made / design - 1.0;
            let rise = 1e3 * share * (lengths[lengths.len() - 1] - lengths[0]);
            assert!((of.profile.slope_um / rise - 1.0).abs() < 20.0 * share.abs(), "{} {rise}", of.profile.slope_um);
            assert!(of.profile.form_um < 0.05 * rise.abs(), "{}", of.profile.form_um);
        }
    }
}

/// A job that names other gear data than its flank has is held against that flank, and says so.
#[test]
fn gear_data_of_another_flank_are_not_taken() {
    let found = traces("hobbing/crowned_gear.chain", &[("h.normal_pressure_angle", "30 deg"), ("crowning", "0 mm")]);
    for of in &found {
        assert_eq!(of.involute.source, InvoluteSource::Flank);
        assert!(of.profile.slope_um.abs() < 1e-4, "its own slope is none: {}", of.profile.slope_um);
    }
}

/// The hob comes 20 um nearer at both ends of the face: seen square to the transverse path of contact the sine of the transverse pressure
/// angle of it. The flank is the envelope of the hob, not its imprint, which is within 2 % of that.
#[test]
fn a_crowned_gear_has_its_crowning() {
    let found = traces("hobbing/crowned_gear.chain", &[("helix_angle", "0 deg")]);
    for of in &found {
        let [_, _, slope, crowning] = evaluated(&of.helix);
        let wanted = 20.0 * 20f64.to_radians().sin() * 0.9 * 0.9;
        assert!((crowning / wanted - 1.0).abs() < 0.02, "{crowning} {wanted}");
        assert!(slope.abs() < 0.02 * crowning, "{slope}");
    }
}

/// The teeth of a ring have their roots outside: 95 % of the length of roll is counted from there, and a rise towards the tip is a fall over
/// the length of roll.
#[test]
fn a_ring_is_evaluated_from_its_root() {
    let found = traces("hobbing/skived_internal_gear.chain", &[]);
    assert!(!found.is_empty());
    for TraceNumbers { lengths_mm, evaluated_from_mm, evaluated_to_mm, slope_um, mean, .. } in
        found.into_iter().map(|of| of.profile)
    {
        let [tip, root] = [lengths_mm[0], lengths_mm[lengths_mm.len() - 1]];
        assert!((evaluated_to_mm - root).abs() < 1e-9, "{evaluated_to_mm} {root}");
        assert!((evaluated_from_mm - root + 0.95 * (root - tip)).abs() < 1e-9, "{evaluated_from_mm}");
        assert!(mean[1] != 0.0 && (slope_um + mean[1] * (root - tip)).abs() < 1e-12, "{slope_um} {mean:?}");
    }
}
