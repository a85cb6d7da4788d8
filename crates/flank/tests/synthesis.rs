//! Contacts that are wanted: what is possible comes back through the whole contact, what is not is told.

use std::path::Path;
use std::sync::Arc;

use flank::{
    Buffers, ContactRequest, ContactResult, Disk, Failure, JobSelection, NotDoneKind, Project, RemarkKind,
    SynthesisRequest, SynthesisResult, Unwatched, contact, synthesis,
};

/// Settings that wishes are made and met by, each with the change up to which it is drawn, in its unit.
const SETTINGS: [(&str, f64, f64, &str); 6] = [
    ("p.radial_distance", 99.808, 0.15, "mm"),
    ("p.work_offset", -1.8799, 0.1, "mm"),
    ("p.machine_center_to_crossing_point", 4.9987, 0.1, "mm"),
    ("p.ratio_of_roll", 3.4108, 0.004, ""),
    ("p.modified_roll_2c", 0.092298, 0.003, ""),
    ("pinion_cutter.blade_angle", 19.882, 0.1, "deg"),
];

/// The pair with a wish of its own.
fn wished(wish: &str) -> JobSelection {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/pairs/wished.chain");
    let text = format!(
        "use \"bevel_19x62.chain\"
        use \"../machines/cradle.chain\"
        job wished extends bevel_19x62 {{
            param shift : length in -0.02 mm .. 0.02 mm = 0 mm
            machine p = cradle_generator(
                radial_distance: 99.808 mm + shift, cradle_angle: -51.522 deg,
                work_offset: -1.8799 mm, sliding_base: -1.3231 mm, machine_root_angle: 15.64096727073747 deg,
                machine_center_to_crossing_point: 4.9987 mm,
                ratio_of_roll: 3.4108, modified_roll_2c: 0.092298, modified_roll_6d: -0.27878
            )
            want wish in drive_side = vertex({wish})
        }}"
    );
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text);
    JobSelection { project: Project::open(spec, Arc::new(files)), job: Some("wished".to_string()), set: vec![] }
}

fn solved(wish: &str, vary: &[&str]) -> Result<SynthesisResult, Failure> {
    let vary = vary.iter().map(|name| name.to_string()).collect();
    synthesis(&SynthesisRequest { vary, ..SynthesisRequest::new(wished(wish), "wish") }, &Unwatched)
}

fn rolled(set: Vec<(String, String)>) -> ContactResult {
    let selection = JobSelection { set, ..wished("ellipse: 8 mm") };
    let request = ContactRequest { positions: 12, no_picture: true, format: vec![], ..ContactRequest::new(selection) };
    let mut found = Vec::new();
    contact(&request, &Unwatched, &mut |of| found.push(of)).expect("a contact");
    found.remove(0)
}

/// A setting that the gear and its mounting share does not change the pinion alone, and that is told.
#[test]
fn settings_that_the_mate_follows_are_told() {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/pairs/shared.chain");
    let text = "use \"bevel_19x62.chain\"
        use \"../machines/bevel_pair.chain\"
        job shared extends bevel_19x62 {
            param height : length in -0.05 mm .. 0.05 mm = 0 mm
            machine m = bevel_pair(shaft_angle: 95 deg, hypoid_offset: height)
            want wish in drive_side = vertex(lengthwise: 0.36)
        }";
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text.to_string());
    let jobs =
        JobSelection { project: Project::open(spec, Arc::new(files)), job: Some("shared".to_string()), set: vec![] };
    let of = |vary: &str| {
        let vary = vec![vary.to_string()];
        synthesis(&SynthesisRequest { vary, ..SynthesisRequest::new(jobs.clone(), "wish") }, &Unwatched)
            .expect("settings")
    };
    let told = |result: &SynthesisResult| result.remarks.iter().any(|remark| remark.kind == RemarkKind::MovesMate);
    let (shared, own) = (of("height"), of("p.work_offset"));
    assert!(told(&shared) && !told(&own), "{:?} {:?}", shared.remarks, own.remarks);
}

/// What a wish does to the backlash, of which it says nothing, is told: as `flank contact` tells it of the pair with both values.
#[test]
fn the_backlash_that_changes_is_told() {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/bodies/wished_body.chain");
    let text = "use \"hypoid_pair_body.chain\"
        job wished extends hypoid_pair_body {
            want wish in drive_side = vertex(lengthwise: 0.52)
        }";
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text.to_string());
    let jobs =
        JobSelection { project: Project::open(spec, Arc::new(files)), job: Some("wished".to_string()), set: vec![] };
    let vary = vec!["p.ratio_of_roll".to_string()];
    let found = synthesis(&SynthesisRequest { vary, ..SynthesisRequest::new(jobs.clone(), "wish") }, &Unwatched);
    let found = found.expect("a setting");
    let told = found.remarks.iter().find(|remark| remark.kind == RemarkKind::OtherBacklash).expect("it changes");
    let ratio = format!("{}", found.settings[0].new);
    for set in [vec![], vec![("wished.p.ratio_of_roll".to_string(), ratio)]] {
        let drive_side = Some("drive_side".to_string());
        let selection = JobSelection { set, ..jobs.clone() };
        let request =
            ContactRequest { contact: drive_side, no_picture: true, format: vec![], ..ContactRequest::new(selection) };
        let mut rolled = Vec::new();
        contact(&request, &Unwatched, &mut |of| rolled.push(of)).expect("a contact");
        let normal = rolled[0].backlash.as_ref().expect("both sides are there").normal;
        assert!(told.message.contains(&format!("{normal:.4} mm along the normal")), "{normal}: {}", told.message);
    }
}

/// From -1 to 1, the same in every run.
struct Dice(u64);

impl Dice {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// z, rho, path in degrees, length of the ellipse, height of the error over a pitch in urad; `None` unless flank touches flank in a point
/// within both teeth.
fn numbers(of: &ContactResult) -> Option<[f64; 5]> {
    let middle = of.middle.as_ref().filter(|middle| middle.is_vertex && of.not_done.is_empty())?;
    let [long, _] = middle.ellipse?;
    let pitch = 360.0 / 19.0;
    let height = middle.parabola.abs() * pitch * pitch / 8.0;
    Some([middle.on[1].z, middle.on[1].rho, middle.on[1].path_angle?, 2.0 * long, height])
}

/// Fifty contacts that some settings make are wished for, without their settings. The settings that are found, given to `flank contact`,
/// make them: to 1e-6 mm, 1e-6 rad of the path, and of the error 1e-6 rad a thousand times over.
#[test]
fn what_is_possible_comes_back() {
    let mut dice = Dice(21);
    let (mut met, mut drawn) = (0, 0);
    while met < 50 {
        drawn += 1;
        assert!(drawn < 200, "{met} of {drawn} draws are contacts");
        let set = SETTINGS.iter().map(|(name, value, by, unit)| {
            (name.to_string(), format!("{:?} {unit}", value + by * dice.share()).trim_end().to_string())
        });
        let Some(wanted) = numbers(&rolled(set.collect())) else { continue };
        let [z, rho, path, ellipse, height] = wanted;
        let wish = format!(
            "z: {z:?} mm, rho: {rho:?} mm, path: {path:?} deg, ellipse: {ellipse:?} mm, transmission_error: {:?} rad",
            1e-6 * height
        );
        let found = solved(&wish, &SETTINGS.map(|(name, ..)| name)).expect("a result");
        assert!(found.not_done.is_empty(), "{drawn}: {wish}: {:?}", found.not_done);
        assert!(found.conditions.iter().all(|of| of.is_met) && found.is_settled, "{drawn}: {:?}", found.conditions);
        let set = found
            .settings
            .iter()
            .map(|of| (of.name.clone(), format!("{:?} {}", of.new, of.unit).trim_end().to_string()));
        let there = numbers(&rolled(set.collect())).expect("they touch");
        for (k, most) in [(0, 1e-6), (1, 1e-6), (2, 1e-6f64.to_degrees()), (3, 1e-6), (4, 1e-3)] {
            let off = (there[k] - wanted[k]).abs();
            assert!(off < most, "{drawn}: number {k} is off by {off:e}: {there:?} for {wanted:?}");
        }
        met += 1;
    }
}

/// Twenty wishes that nothing makes, each with a word of the reason.
#[test]
fn what_is_not_possible_is_told() {
    let all = SETTINGS.map(|(name, ..)| name);
    let (place, other) = ("z: 21.7 mm, rho: 106.3 mm", ["pinion_cutter.inside_point_radius"]);
    let cases: Vec<(String, Vec<&str>, &str)> = vec![
        // off the tooth
        ("lengthwise: 1.1, profilewise: 0.5".into(), all.to_vec(), "heel of gear_convex"),
        ("lengthwise: -0.1, profilewise: 0.5".into(), all.to_vec(), "toe of gear_convex"),
        ("lengthwise: 0.5, profilewise: 1.3".into(), all.to_vec(), "tip of gear_convex"),
        ("z: 80 mm, rho: 106 mm".into(), all.to_vec(), "gear_convex"),
        ("z: 21.7 mm, rho: 300 mm".into(), all.to_vec(), "gear_convex"),
        // a setting of the other flank
        ("lengthwise: 0.5".into(), other.to_vec(), "none of these settings changes lengthwise"),
        ("path: 20 deg".into(), other.to_vec(), "none of these settings changes path"),
        ("ellipse: 9 mm".into(), other.to_vec(), "none of these settings changes ellipse"),
        ("transmission_error: 10 arcsec".into(), other.to_vec(), "none of these settings changes transmission_error"),
        // the cradle's angle turns the tooth, so that the lag leaves its range, and shifts where the roll is modified
        ("path: 20 deg".into(), vec!["p.cradle_angle"], "range: `lag` would have to leave its range"),
        // more numbers than settings
        (place.into(), vec!["p.radial_distance"], "z and rho together"),
        ("lengthwise: 0.4, profilewise: 0.8".into(), vec!["p.ratio_of_roll"], "lengthwise and profilewise together"),
        ("path: 12 deg, ellipse: 7 mm".into(), vec!["p.work_offset"], "path and ellipse together"),
        (format!("{place}, path: 9 deg"), vec!["p.ratio_of_roll", "p.radial_distance"], "together"),
        (format!("{place}, ellipse: 7 mm"), vec!["p.ratio_of_roll", "p.radial_distance"], "together"),
        (
            "ellipse: 7 mm, transmission_error: 25 arcsec".into(),
            vec!["p.modified_roll_2c"],
            "ellipse and transmission_error together",
        ),
        (
            "path: 9 deg, transmission_error: 25 arcsec".into(),
            vec!["p.modified_roll_2c"],
            "path and transmission_error together",
        ),
        // a range that ends before, and a place where the mate's tooth ends
        ("lengthwise: 0.5".into(), vec!["shift"], "bounds: shift"),
        ("profilewise: 0.1".into(), vec!["pinion_cutter.blade_angle"], "beyond the tip of pinion_concave"),
        // with this path and this error the flanks part too slowly in one direction for so short an ellipse
        (format!("{place}, path: 9 deg, ellipse: 0.2 mm, transmission_error: 29 arcsec"), all.to_vec(), "ellipse"),
    ];
    assert_eq!(cases.len(), 20);
    let mut wrong = Vec::new();
    for (wish, vary, word) in cases {
        let told = match solved(&wish, &vary) {
            Ok(found) => {
                assert!(found.not_done.iter().any(|of| of.kind == NotDoneKind::NotMet), "{wish} is met");
                format!("{:?}", found.not_done)
            }
            Err(Failure::Unsolved(reason)) => reason,
            Err(other) => panic!("{wish}: {other}"),
        };
        if !told.contains(word) {
            wrong.push(format!("{wish} by {vary:?}: {told}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A number that need not hold exactly gives way, and the exact ones hold.
#[test]
fn least_squares_give_way_to_what_is_exact() {
    let vary = ["p.radial_distance", "p.ratio_of_roll"];
    let found = solved("z: 21.8 mm, rho: 106.4 mm, path: about(8 deg, 5 deg), ellipse: about(6.8 mm, 1 mm)", &vary)
        .expect("a result");
    assert!(found.not_done.is_empty(), "{:?}", found.not_done);
    for of in &found.conditions {
        let off = (of.reached.expect("it is there") - of.wanted).abs();
        assert!(off < of.within.unwrap_or(1e-6), "{of:?}");
        assert!(of.within.is_none() || off > 1e-6, "two settings have only two numbers to give: {of:?}");
    }
}

/// A shipped pair with other lines and wishes.
fn over(pair: &str, lines: &str) -> JobSelection {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/pairs/over.chain");
    let text = format!("use \"{pair}.chain\"\njob over extends {pair} {{\n{lines}\n}}");
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text);
    JobSelection { project: Project::open(spec, Arc::new(files)), job: Some("over".to_string()), set: vec![] }
}

fn found(pair: &str, lines: &str, vary: &[&str]) -> Result<SynthesisResult, Failure> {
    let vary = vary.iter().map(|name| name.to_string()).collect();
    synthesis(&SynthesisRequest { vary, ..SynthesisRequest::new(over(pair, lines), "wish") }, &Unwatched)
}

/// A wish for which the lag leaves its range is told by that, whatever may be set; with a wider range it is met.
#[test]
fn the_range_that_is_in_the_way_is_told() {
    let wish = "want wish in drive_side = vertex(lengthwise: 0.3172, profilewise: 0.7313, path: 15.826 deg)";
    let four = ["p.radial_distance", "p.work_offset", "p.ratio_of_roll", "p.modified_roll_2c"];
    let six = [&four[..], &["p.sliding_base", "pinion_cutter.blade_angle"]].concat();
    for vary in [&four[..], &six] {
        let narrow = found("bevel_19x62", wish, vary).expect("a result");
        let told = format!("{:?}", narrow.not_done);
        assert!(told.contains("range: `lag` would have to leave its range"), "{vary:?}: {told}");
    }
    let range = "unknown lag : angle in 2.7 deg .. 5.5 deg";
    let wide = found("bevel_19x62", &format!("{range}\n{wish}"), &four).expect("a result");
    assert!(wide.conditions.iter().all(|of| of.is_met), "{:?}", wide.not_done);
    assert!(wide.not_done.iter().all(|of| of.kind != NotDoneKind::NotMet), "{:?}", wide.not_done);
}

/// Where the setting that does most does not bring it, others are tried, those that were not are named, and no number is told as an end that is farther
/// off than the one that was reached.
#[test]
fn other_settings_are_tried_or_named() {
    let wish = "want wish in drive_side = vertex(ellipse: 8 mm)";
    let chosen = found("bevel_19x62", wish, &[]).expect("a result");
    let told = format!("{:?}", chosen.not_done);
    let tried = ["p.radial_distance", "p.work_offset", "p.ratio_of_roll"];
    assert!(told.contains("settings: not tried") && tried.iter().all(|name| !told.contains(name)), "{told}");
    let few = found("bevel_19x62", wish, &["p.ratio_of_roll"]).expect("a result");
    let told = format!("{:?}", few.not_done);
    assert!(told.contains("others than these may bring it"), "{told}");
    assert!(few.not_done.iter().all(|of| of.place.is_some()), "{told}");
    let reached = few.conditions[0].reached.expect("an ellipse");
    let end = told.split("it comes to ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
    assert!(end.is_none_or(|end| (8.0 - end).abs() <= (8.0 - reached).abs() + 1e-4), "{reached}: {told}");
}

/// What stands at the end of the way is told at the end of it, and not only nearer by.
#[test]
fn the_end_of_a_tool_is_told_all_the_way() {
    let full = "want wish in drive_side = vertex(lengthwise: 0.6679, path: 15.737 deg, ellipse: 4.023 mm)";
    let part = "want wish in drive_side = vertex(lengthwise: 0.597160, path: 18.72616 deg, ellipse: 6.750674 mm)";
    for wish in [part, full] {
        let told = format!("{:?}", found("hypoid_pair", wish, &[]).expect("a result").not_done);
        assert!(told.contains("range: `s` would have to leave its range"), "{wish}: {told}");
    }
}

/// An even error has no vertex, and what to do about that is said.
#[test]
fn an_even_error_has_no_vertex() {
    let wish = "want wish in drive_side = vertex(z: 34.5 mm, rho: 165 mm)";
    let Err(Failure::Unsolved(told)) = found("face_gear_pair", wish, &[]) else { panic!("there is no vertex") };
    assert!(told.contains("is even as it is") && told.contains("crown a flank along the path"), "{told}");
}

/// Settings that do not make what is wanted are printed where that is asked for, and not written.
#[test]
fn what_is_not_met_is_not_written() {
    let specs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/pairs");
    let file = specs.join("not_written.chain");
    let asked = |vary: &[&str], dry: bool| {
        let jobs = JobSelection {
            project: Project::open(specs.join("bevel_19x62.chain"), Arc::new(Disk)),
            job: Some("bevel_19x62".to_string()),
            set: vec![],
        };
        let vary = vary.iter().map(|name| name.to_string()).collect();
        let request =
            SynthesisRequest { vary, write: Some(file.clone()), dry, ..SynthesisRequest::new(jobs, "centred") };
        synthesis(&request, &Unwatched).expect("a result")
    };
    let is_told = |found: &SynthesisResult| {
        let mut details = found.not_done.iter().flat_map(|of| &of.details);
        details.any(|line| line.contains("not_written.chain` is not written"))
    };
    // five numbers and one setting
    let refused = asked(&["p.ratio_of_roll"], false);
    assert!(!file.exists() && refused.files.is_empty() && refused.corrected.is_none(), "{:?}", refused.files);
    assert!(
        refused.not_done.iter().any(|of| of.kind == NotDoneKind::NotMet) && is_told(&refused),
        "{:?}",
        refused.not_done
    );
    let printed = asked(&["p.ratio_of_roll"], true);
    assert!(printed.corrected.is_some_and(|text| text.contains("ratio_of_roll")), "{:?}", printed.not_done);
    assert!(!file.exists());
    let met = asked(&SETTINGS.map(|(name, ..)| name), true);
    assert!(met.not_done.is_empty() && met.corrected.is_some(), "{:?}", met.not_done);
}

/// Of two settings that meet one wish the changes are the least by their scales, 0.1 mm and a hundredth: with the one a little farther or nearer, and
/// the other looked for anew, they are greater.
#[test]
fn of_all_that_meets_a_wish_settings_change_least() {
    let (wish, now) = ("lengthwise: 0.42", [99.808, 3.4108]);
    let scales = [0.1, 1e-2 * now[1]];
    let size = |of: [f64; 2]| [0, 1].map(|k| ((of[k] - now[k]) / scales[k]).powi(2)).iter().sum::<f64>();
    let new = |found: &SynthesisResult, name: &str| {
        assert!(found.not_done.is_empty(), "{:?}", found.not_done);
        found.settings.iter().find(|of| of.name == name).expect("it varies").new
    };
    let (radial, ratio) = ("p.radial_distance", "p.ratio_of_roll");
    let both = solved(wish, &[radial, ratio]).expect("a result");
    let least = [new(&both, radial), new(&both, ratio)];
    let beside = |by: f64| {
        let held = least[0] + by;
        let jobs = JobSelection { set: vec![(radial.to_string(), format!("{held:?} mm"))], ..wished(wish) };
        let request = SynthesisRequest { vary: vec![ratio.to_string()], ..SynthesisRequest::new(jobs, "wish") };
        [held, new(&synthesis(&request, &Unwatched).expect("a result"), ratio)]
    };
    let step = 0.1 * (least[0] - now[0]).abs().max(1e-3);
    let [before, after] = [-step, step].map(|by| size(beside(by)));
    assert!(size(least) < before && size(least) < after, "{before} {} {after}", size(least));
    // the slope there is zero: what is left over the step is the third derivative's, a small share of what the sum of squares bends by
    let [slope, bend] = [0.5 * (after - before), before + after - 2.0 * size(least)];
    assert!(slope.abs() < 0.05 * bend, "{slope} {bend}");
}

/// A setting that another one follows does what it does through that, and nothing where that one varies by itself: the reason is told.
#[test]
fn what_is_followed_by_what_varies_is_told() {
    let told = |vary: &[&str]| format!("{:?}", solved("lengthwise: 0.36", vary).expect("a result").remarks);
    let both = told(&["shift", "p.radial_distance"]);
    let why =
        "`shift` changes nothing that wish wants beside `p.radial_distance`, which follows it and varies by itself";
    assert!(both.contains(why), "{both}");
    let other = told(&["p.radial_distance", "pinion_cutter.inside_point_radius"]);
    assert!(other.contains("changes nothing that wish wants: it stays"), "{other}");
    assert!(!told(&["shift"]).contains("changes nothing"));
}

const ROLL: &str = "p.modified_roll_2c";

/// Wishes, settings, what is told, and which of the wishes stand against each other.
type Fight = (&'static [&'static str], &'static [&'static str], &'static str, &'static [&'static str]);

/// Wishes that fight are named, no more and no fewer: without any one of them the others are met. A wish that is not met by itself is told alone, and
/// so is the end of a range that holds it.
#[test]
fn wishes_that_stand_against_each_other_are_named() {
    const PATH: &str = "path: 8.8 deg";
    const ERROR: &str = "transmission_error: 28 arcsec";
    const NEAR: &str = "lengthwise: about(0.35, 0.2)";
    const PLACE: &str = "lengthwise: 0.4";
    let cases: [Fight; 5] = [
        (&[PATH, ERROR], &[ROLL], "against: path and transmission_error: each", &[PATH, ERROR]),
        // what is met anyway does not take part
        (&[NEAR, PATH, ERROR], &[ROLL], "against: path and transmission_error: each", &[PATH, ERROR]),
        (
            &[PLACE, PATH, ERROR],
            &[ROLL, "p.ratio_of_roll"],
            "against: lengthwise, path, transmission_error: without any one",
            &[PLACE, PATH, ERROR],
        ),
        (
            &["lengthwise: 0.5", "path: about(8.55 deg, 1 deg)"],
            &["shift"],
            "against: no search meets lengthwise",
            &["lengthwise: 0.5"],
        ),
        // a search for one of the others alone may lead off the flanks: that does not stand against it
        (
            &[
                "lengthwise: 0.45",
                "profilewise: 0.6",
                "path: about(10 deg, 1 deg)",
                "ellipse: 0.2 mm",
                "transmission_error: 20 arcsec",
            ],
            &[
                "p.radial_distance",
                "p.work_offset",
                "p.sliding_base",
                "p.ratio_of_roll",
                ROLL,
                "pinion_cutter.blade_angle",
            ],
            "against: no search meets ellipse",
            &["ellipse: 0.2 mm"],
        ),
    ];
    for (wishes, vary, told, against) in cases {
        let found = solved(&wishes.join(", "), vary).expect("a result");
        let reasons = format!("{:?}", found.not_done);
        assert!(reasons.contains(told), "{wishes:?}: {reasons}");
        assert_eq!(reasons.contains("bounds: shift"), vary.contains(&"shift"), "{reasons}");
        let is_met =
            |of: &[&str]| solved(&of.join(", "), vary).expect("a result").conditions.iter().all(|of| of.is_met);
        assert!(!is_met(against), "{against:?}");
        for left in 0..against.len() {
            let others: Vec<&str> = against.iter().enumerate().filter(|(k, _)| *k != left).map(|(_, of)| *of).collect();
            assert!(others.is_empty() || is_met(&others), "{others:?}");
        }
    }
}

/// Path in degrees and height of the error in arcseconds where one setting has a value.
fn with_roll(value: f64) -> [f64; 2] {
    let [_, _, path, _, height] = numbers(&rolled(vec![(ROLL.to_string(), format!("{value:?}"))])).expect("they touch");
    [path, (1e-6 * height).to_degrees() * 3600.0]
}

/// Where wishes cannot all be met the settings are those with the least squares of what is off, each by how far it may be off, or by what is worth a
/// millimetre where that is not said: with the setting a little greater or smaller, solved by the whole contact, more is left.
#[test]
fn what_cannot_be_met_is_met_by_least_squares() {
    let wanted = [8.8, 28.0];
    // 1 mm is worth 0.1 rad of a path, and all of an error
    let cases = [
        ("path: about(8.8 deg, 0.1 deg), transmission_error: about(28 arcsec, 0.1 arcsec)", [0.1, 0.1]),
        ("path: 8.8 deg, transmission_error: 28 arcsec", [0.1f64.to_degrees(), 28.0]),
    ];
    for (wish, scales) in cases {
        let found = solved(wish, &[ROLL]).expect("a result");
        let value = found.settings[0].new;
        let left = |by: f64| {
            let there = with_roll(value + by);
            (0..2).map(|k| ((there[k] - wanted[k]) / scales[k]).powi(2)).sum::<f64>()
        };
        let step = 2e-4;
        let [before, at, after] = [-step, 0.0, step].map(left);
        assert!(at < before && at < after, "{wish}: {before} {at} {after}");
        // the slope is zero: what is left is the third derivative's share
        assert!((after - before).abs() < 0.01 * (before + after - 2.0 * at), "{wish}: {before} {at} {after}");
        // what is told as reached is a vertex of the pair: solving it anew finds the same
        for of in &found.conditions {
            let (reached, checked) = (of.reached.expect("a contact"), of.checked.expect("a contact"));
            assert!((reached - checked).abs() < 1e-6 * reached.abs(), "{wish}: {of:?}");
        }
        let told = format!("{:?}", found.not_done);
        assert!(told.contains("least squares: nearest to all of it these settings leave path -0."), "{told}");
    }
}

/// Where the least squares leave a number farther off than it may be, and other settings leave all of them near enough, these are found.
#[test]
fn all_are_near_enough_where_that_can_be() {
    let (value, step, within) = (0.085, 1e-3, [0.01, 0.03]);
    let [before, at, after] = [-step, 0.0, step].map(|by| with_roll(value + by));
    let slope = [0, 1].map(|k| (after[k] - before[k]) / (2.0 * step) / within[k]);
    // at that value both are 0.95 of what they may be off, to such sides that the steeper one draws it away
    let steep = usize::from(slope[1].abs() > slope[0].abs());
    let side = |k: usize| if k == steep { -slope[k].signum() } else { slope[k].signum() };
    let wanted = [0, 1].map(|k| at[k] - 0.95 * side(k) * within[k]);
    let shift = -0.95 * (0..2).map(|k| slope[k] * side(k)).sum::<f64>() / slope.iter().map(|of| of * of).sum::<f64>();
    let farthest = (0..2).map(|k| (0.95 * side(k) + slope[k] * shift).abs()).fold(0.0, f64::max);
    assert!(farthest > 1.02, "least squares alone are near enough: {farthest}");
    let [path, error] = wanted;
    let wish = format!(
        "path: about({path:?} deg, {:?} deg), transmission_error: about({error:?} arcsec, {:?} arcsec)",
        within[0], within[1]
    );
    let found = solved(&wish, &[ROLL]).expect("a result");
    assert!(found.conditions.iter().all(|of| of.is_met), "{:?} {:?}", found.conditions, found.not_done);
}

/// What is to hold exactly does, however far off the others are by how far they may be.
#[test]
fn what_is_exact_holds_beside_what_is_far_off() {
    let wish = "z: 21.8 mm, rho: 106.4 mm, path: about(12 deg, 0.001 deg)";
    let found = solved(wish, &["p.radial_distance", "p.ratio_of_roll"]).expect("a result");
    let [z, rho, path] = &found.conditions[..] else { panic!("{:?}", found.conditions) };
    assert!(z.is_met && rho.is_met && !path.is_met, "{:?}", found.conditions);
    assert!(found.not_done[0].message.ends_with("is not met: path"), "{:?}", found.not_done);
}

/// Settings that are left free change least beside numbers that need not hold exactly as well: where these are met, as beside exact ones.
#[test]
fn settings_change_least_beside_what_need_not_hold() {
    let vary = SETTINGS.map(|(name, ..)| name);
    let [exact, about, mixed] = [
        "lengthwise: 0.4, path: 9 deg",
        "lengthwise: about(0.4, 0.01), path: about(9 deg, 2 deg)",
        "lengthwise: 0.4, path: about(9 deg, 2 deg)",
    ]
    .map(|wish| solved(wish, &vary).expect("a result"));
    for other in [about, mixed] {
        assert!(other.conditions.iter().all(|of| of.is_met), "{:?}", other.conditions);
        for (of, to) in other.settings.iter().zip(&exact.settings) {
            // least changes are known to 1e-6 of a scale: 0.1 mm, 10 arcminutes, a hundredth
            assert!((of.new - to.new).abs() < 1e-6, "{of:?} {to:?}");
        }
    }
}
