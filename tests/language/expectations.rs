//! What the library is tested by finds what is wrong with it: specs broken on purpose.

use std::path::PathBuf;
use std::sync::Arc;

use flank::{Buffers, Disk, Project, TestRequest, TestedSpec, Unwatched, test, test_spec};
use flank_tests::repository;

/// A text of a spec, or of a file that it uses, and what stands in its place; the setting that this changes, if it is one.
struct Mutation {
    spec: &'static str,
    file: &'static str,
    from: &'static str,
    to: &'static str,
    setting: Option<&'static str>,
}

const fn setting(spec: &'static str, from: &'static str, to: &'static str, setting: &'static str) -> Mutation {
    Mutation { spec, file: spec, from, to, setting: Some(setting) }
}

const fn text(spec: &'static str, file: &'static str, from: &'static str, to: &'static str) -> Mutation {
    Mutation { spec, file, from, to, setting: None }
}

const PINION: &str = "bevel/pinion_19x62.chain";
const GEAR: &str = "bevel/gear_19x62.chain";
const TILTED: &str = "bevel/tilted_pinion.chain";
const FORMATE: &str = "bevel/formate_gear.chain";
const HOBBED: &str = "bevel/face_hobbed_pinion.chain";
const SPUR: &str = "hobbing/spur_gear.chain";
const HELICAL: &str = "hobbing/helical_gear.chain";
const HEAD_TABLE: &str = "machines/five_axis_head_table.chain";
const FREE_FORM: &str = "machines/free_form.chain";
const HEXAPOD: &str = "machines/hexapod.chain";
const HEXAPOD_GEAR: &str = "hexapod/hexapod_gear.chain";
const REAL_HOB: &str = "hobbing/real_hob.chain";
const MILLS: &str = "tools/end_mills.chain";
const GROOVES: &str = "../tests/machines/grooves.chain";

/// Micrometres, arc seconds and millionths of settings; then signs, ratios, units and hands.
const MUTATIONS: [Mutation; 62] = [
    setting(PINION, "97.95940290780507 mm", "97.96040290780507 mm", "m.radial_distance"),
    setting(PINION, "-52.79674678267486 deg", "-52.79702456045264 deg", "m.cradle_angle"),
    setting(PINION, "15.64096727073747 deg", "15.64124504851525 deg", "m.machine_root_angle"),
    setting(PINION, "-0.001306176586991889 mm", "-0.000306176586991889 mm", "m.machine_center_to_crossing_point"),
    setting(PINION, "3.339685914944047", "3.339695914944047", "m.ratio_of_roll"),
    setting(PINION, "95.9517390193892 mm", "95.9527390193892 mm", "c.outside_point_radius"),
    setting(PINION, "94.5482609806108 mm", "94.5472609806108 mm", "c.inside_point_radius"),
    setting(PINION, "blade_angle: 20 deg", "blade_angle: 20.000278 deg", "c.blade_angle"),
    setting(GEAR, "97.95367814746567 mm", "97.95467814746567 mm", "m.radial_distance"),
    setting(GEAR, "52.801158062429394 deg", "52.801435840207172 deg", "m.cradle_angle"),
    setting(GEAR, "75.6638280957449 deg", "75.66355031796712 deg", "m.machine_root_angle"),
    setting(GEAR, "1.023367028989512", "1.023368028989512", "m.ratio_of_roll"),
    setting(GEAR, "96.43926979086986 mm", "96.43826979086986 mm", "c.outside_point_radius"),
    setting(GEAR, "94.06073020913014 mm", "94.06173020913014 mm", "c.inside_point_radius"),
    setting(GEAR, "blade_angle: 20 deg", "blade_angle: 19.999722 deg", "c.blade_angle"),
    setting(GEAR, "blade_radius: 500 mm", "blade_radius: 501 mm", "c.blade_radius"),
    setting(TILTED, "67.8580386297259 mm", "67.8590386297259 mm", "m.radial_distance"),
    setting(TILTED, "-0.8734417561089464 rad", "-0.8734369079 rad", "m.cradle_angle"),
    setting(TILTED, "cutter_tilt: 3.5 deg", "cutter_tilt: 3.5002778 deg", "m.cutter_tilt"),
    setting(TILTED, "cutter_swivel: 55 deg", "cutter_swivel: 55.01 deg", "m.cutter_swivel"),
    setting(TILTED, "work_offset: 0.8 mm", "work_offset: 0.801 mm", "m.work_offset"),
    setting(TILTED, "sliding_base: 0.3 mm", "sliding_base: 0.301 mm", "m.sliding_base"),
    setting(TILTED, "crossing_point: -0.45 mm", "crossing_point: -0.451 mm", "m.machine_center_to_crossing_point"),
    setting(TILTED, "0.3351032163829113 rad", "0.3351080645 rad", "m.machine_root_angle"),
    setting(TILTED, "2.800207406606668", "2.800208406606668", "m.ratio_of_roll"),
    setting(TILTED, "modified_roll_2c: -0.021", "modified_roll_2c: -0.02101", "m.modified_roll_2c"),
    setting(TILTED, "modified_roll_6d: -0.035", "modified_roll_6d: -0.0351", "m.modified_roll_6d"),
    setting(TILTED, "helical_motion_1: -1.7 mm", "helical_motion_1: -1.701 mm", "m.helical_motion_1"),
    setting(TILTED, "helical_motion_2: -0.8 mm", "helical_motion_2: -0.81 mm", "m.helical_motion_2"),
    setting(TILTED, "helical_motion_1: 2.2 mm", "helical_motion_1: 2.201 mm", "n.helical_motion_1"),
    setting(FORMATE, "68.926410763489 mm", "68.927410763489 mm", "m.radial_distance"),
    setting(FORMATE, "sliding_base: -0.2 mm", "sliding_base: -0.201 mm", "m.sliding_base"),
    setting(FORMATE, "inside_point_radius: 62.2 mm", "inside_point_radius: 62.201 mm", "c.inside_point_radius"),
    setting(HOBBED, "104.58879210740612 mm", "104.58979210740612 mm", "m.radial_distance"),
    text(PINION, PINION, "cradle_angle: -52", "cradle_angle: 52"),
    text(PINION, "machines/cradle.chain", "rotate_x(-cradle)", "rotate_x(cradle)"),
    text(GEAR, GEAR, "blade_angle: 20 deg", "blade_angle: 20 rad / 57"),
    text(
        SPUR,
        "machines/rack_generating.chain",
        "reference_radius * cos(swivel) * C",
        "-reference_radius * cos(swivel) * C",
    ),
    text(SPUR, "machines/rack_generating.chain", "reference_radius + shift", "reference_radius - shift"),
    text(SPUR, "tools/rack.chain", "pi * module / 4 - u * sin", "3.1416 * module / 4 - u * sin"),
    text(HELICAL, HELICAL, "hob_starts / teeth * spindle", "hob_starts / (teeth + 1) * spindle"),
    text(HELICAL, HELICAL, "drive m.Z, m.A, m.B = feed, hob_hand", "drive m.Z, m.A, m.B = feed, -hob_hand"),
    text(HEAD_TABLE, HEAD_TABLE, "translate(X, Y, Z)", "translate(Y, X, Z)"),
    text(HEAD_TABLE, HEAD_TABLE, "rotation_point_z) rotate_z(C)", "rotation_point_z) rotate_z(-C)"),
    text(HEAD_TABLE, HEAD_TABLE, "translate_z(0 mm)", "translate_z(0.01 mm)"),
    text(HEAD_TABLE, HEAD_TABLE, "translate(spindle_offset, 0 mm", "translate(0 mm, 0 mm"),
    text(FREE_FORM, FREE_FORM, "translate(X, Y, Z)", "translate(X, Y, -Z)"),
    text(FREE_FORM, FREE_FORM, "= rotate_z(C)", "= rotate_z(-C)"),
    text(HEXAPOD, HEXAPOD, "rotate_x(A) rotate_y(B)", "rotate_y(B) rotate_x(A)"),
    text(HEXAPOD_GEAR, HEXAPOD, "= 420 mm", "= 420.01 mm"),
    text(HEXAPOD_GEAR, HEXAPOD, "= 48 deg", "= 48.01 deg"),
    text(HEXAPOD_GEAR, HEXAPOD, "120 deg * pair", "121 deg * pair"),
    text(REAL_HOB, "tools/hob_zi_edges.chain", "reduced_lead = hand *", "reduced_lead = hand * 1.0001 *"),
    text(REAL_HOB, "tools/hob_zi_edges.chain", "pi / (2 * starts)", "pi / (2.001 * starts)"),
    text(REAL_HOB, "tools/hob_zi_edges.chain", "shrunk = 1 - fall", "shrunk = 1.0001 - fall"),
    text(REAL_HOB, REAL_HOB, "+ hob_radius - e.fall", "+ hob_radius + 0.01 mm - e.fall"),
    text(
        GROOVES,
        MILLS,
        "arc(center: [0 mm, -radius], radius: radius",
        "arc(center: [0 mm, -radius], radius: 1.001 * radius",
    ),
    text(GROOVES, MILLS, "arc(center: [radius - corner, -corner]", "arc(center: [radius - corner, -1.001 * corner]"),
    text(GROOVES, MILLS, "to: [radius, -cutting_length])", "to: [1.001 * radius, -cutting_length])"),
    text(
        GROOVES,
        MILLS,
        "center: [radius - barrel_radius, -height]",
        "center: [radius - barrel_radius, -1.001 * height]",
    ),
    text(GROOVES, MILLS, "end_radius = tip_radius * cos(half_angle)", "end_radius = tip_radius"),
    text(GROOVES, MILLS, "end_height = corner * (1 - sin(half_angle))", "end_height = corner"),
];

fn place(file: &str) -> PathBuf {
    repository("specs").join(file)
}

fn tested(spec: &str, files: Buffers, propose: bool) -> TestedSpec {
    let project = Project::open(place(spec), Arc::new(files));
    let request = TestRequest { project, propose, ..TestRequest::new(place(spec)) };
    test_spec(&request, &Unwatched).expect("nobody cancels")
}

#[test]
fn specs_that_are_broken_on_purpose_are_found_and_the_setting_is_named() {
    let (mut named, mut asked) = (0, 0);
    for Mutation { spec, file, from, to, setting } in MUTATIONS {
        let disk = || Buffers::over(Arc::new(Disk));
        let text = std::fs::read_to_string(place(file)).expect("it is in the library");
        assert!(text.contains(from), "{file}: {from}");
        let broken = text.replacen(from, to, 1);
        let found = tested(spec, disk().with(&place(file), broken.clone()), false);
        assert!(found.failed() > 0, "{spec}: {from} -> {to} is not found");
        let Some(setting) = setting else { continue };
        asked += 1;
        let before = tested(spec, disk(), true).snapshot.and_then(|snapshot| snapshot.text).expect("one is proposed");
        let snapshot = place(spec).with_extension("snapshot");
        let files = disk().with(&place(file), broken).with(&snapshot, before.clone());
        let told = tested(spec, files, false).snapshot.expect("there is one");
        assert!(!told.is_same, "{spec}: {from} -> {to} leaves the snapshot as it is");
        let is_named = told.differences.iter().any(|line| line.contains("explained") && line.contains(setting));
        if is_named {
            named += 1;
        } else {
            println!("{spec}: {setting} is not named: {:#?}", told.differences);
        }
        // as it was, it is the same
        assert!(tested(spec, disk().with(&snapshot, before), false).snapshot.is_some_and(|told| told.is_same));
    }
    println!("{named} of {asked} settings are named");
    assert!(named >= 30, "{named} of {asked}");
}

/// A snapshot that somebody edits, or that another version wrote, says so.
#[test]
fn a_snapshot_that_was_edited_is_none() {
    let before = tested(SPUR, Buffers::over(Arc::new(Disk)), true).snapshot.and_then(|snapshot| snapshot.text);
    let before = before.expect("one is proposed");
    for (from, to, why) in [("status x", "status  x", "edited"), ("snapshot 1", "snapshot 9", "version 9")] {
        let files = Buffers::over(Arc::new(Disk));
        let files = files.with(&place(SPUR).with_extension("snapshot"), before.replacen(from, to, 1));
        let told = tested(SPUR, files, false).snapshot.expect("there is one");
        assert!(told.differences.iter().any(|line| line.contains(why)), "{why}: {:?}", told.differences);
    }
}

/// The snapshot of a job is the same bytes with one thread and with four, and by interpreted equations.
#[test]
fn a_snapshot_is_the_same_bytes_however_it_is_worked_out() {
    let text = |threads: usize, machine_code: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("some threads");
        pool.install(|| {
            [PINION, HELICAL, TILTED].map(|spec| {
                let evaluator = flank::EvaluatorOptions { machine_code, ..flank::EvaluatorOptions::default() };
                let request = TestRequest { propose: true, evaluator, ..TestRequest::new(place(spec)) };
                test_spec(&request, &Unwatched).expect("nobody cancels").snapshot.and_then(|snapshot| snapshot.text)
            })
        })
    };
    let one = text(1, true);
    assert!(one.iter().all(Option::is_some));
    assert_eq!(one, text(4, true));
    assert_eq!(one, text(2, false));
}

/// What ships holds.
#[test]
fn the_library_is_what_it_says() {
    // no job of the library says by itself what end mills are like
    let specs = flank::find_specs(&[repository("specs"), place(GROOVES)]).expect("the library");
    let requests: Vec<TestRequest> = specs.iter().map(TestRequest::new).collect();
    let result = test(&requests, &Unwatched).expect("nobody cancels");
    assert_eq!(result.failed, 0, "{result}");
    assert!(result.passed > 150, "{}", result.passed);
    // each job says what it is checked against
    for spec in &result.specs {
        let silent = spec.items.iter().find(|item| item.expectations.is_empty());
        assert!(silent.is_none(), "{}: nothing is expected of {}", spec.file, silent.map_or("", |item| &item.name));
    }
}
