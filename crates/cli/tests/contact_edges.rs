//! Contacts that edges carry, as a user runs them: whatever roll positions are looked at, nothing is lost and nothing hops.

mod support;

use serde_json::Value;
use support::{flank, folder, self_contained, text, written};

/// What a run prints as JSON, with no picture, and its exit code.
fn run(name: &str, arguments: &[&str]) -> (Value, i32) {
    let out = folder(name);
    let all =
        [&["contact", "--no-picture", "--json", "--out", out.to_str().expect("a plain path")][..], arguments].concat();
    let run = flank(&all);
    let printed = serde_json::from_slice(&run.stdout).unwrap_or_else(|_| panic!("{}", text(&run.stderr)));
    (printed, run.status.code().expect("a code"))
}

fn solved(name: &str, arguments: &[&str]) -> Value {
    let (found, code) = run(name, arguments);
    assert_eq!(code, 0, "{arguments:?}: {}", found["not_done"]);
    found
}

fn peak_to_peak(of: &Value) -> f64 {
    of["error"]["peak_to_peak"].as_f64().expect("an error")
}

/// The error of conjugate flanks is linear in a small error of their mounting: 366.5 urad for a millimetre of E, where a path that was lost at a
/// corner told four times as much.
#[test]
fn conjugate_bevel_flanks_answer_in_proportion() {
    for (error, positions) in [
        (0.01, "240"),
        (0.03, "60"),
        (0.04, "60"),
        (0.05, "60"),
        (0.05, "61"),
        (0.05, "240"),
        (0.06, "60"),
        (0.06, "61"),
    ] {
        let mounted = format!("m.E={error}mm");
        let spec = ["specs/pairs/conjugate_pair.chain", "--error", &mounted, "--positions", positions];
        let found = peak_to_peak(&solved("edges_bevel", &spec)) / error;
        // the quadratic part is 0.2 % within these
        assert!((found / 366.5 - 1.0).abs() < 2e-3, "{error} {positions}: {found}");
    }
    let large = ["60", "61"].map(|positions| {
        let spec = ["specs/pairs/conjugate_pair.chain", "--error", "m.E=-0.2749mm", "--positions", positions];
        peak_to_peak(&solved("edges_bevel", &spec))
    });
    // extremes are solved between positions
    assert!((large[0] / large[1] - 1.0).abs() < 1e-6 && large[0] < 96.0, "{large:?}");
}

/// Involutes that lean in the plane of their axes turn each other evenly to second order: 0.01 arcmin is nothing.
#[test]
fn leaning_spur_gears_turn_evenly() {
    for (spec, error, positions) in [
        ("specs/pairs/internal_pair.chain", "m.D=0.01arcmin", "60"),
        ("specs/pairs/internal_pair.chain", "m.D=0.0001arcmin", "60"),
        ("specs/pairs/spur_pair.chain", "m.D=0.01arcmin", "61"),
        ("specs/pairs/spur_pair.chain", "m.D=0.0001arcmin", "77"),
    ] {
        let contact: &[&str] = if spec.contains("spur") { &["drive_side"] } else { &[] };
        let found =
            solved("edges_spur", &[&[spec][..], contact, &["--error", error, "--positions", positions]].concat());
        assert!(peak_to_peak(&found) < 1e-6, "{spec} {error} {positions}: {}", found["error"]);
    }
}

/// Helical involutes that lean: 10.05 urad for an arcminute of D, whatever carries.
#[test]
fn leaning_helical_gears_answer_in_proportion() {
    for (error, positions) in [(0.2, "60"), (0.2, "61"), (1.0, "60"), (1.0, "61"), (3.0, "60"), (3.0, "61")] {
        let mounted = format!("m.D={error}arcmin");
        let spec =
            ["specs/pairs/helical_pair.chain", "--set", "crowning=0mm", "--error", &mounted, "--positions", positions];
        let found = peak_to_peak(&solved("edges_helical", &spec)) / error;
        assert!((found / 10.05 - 1.0).abs() < 5e-3, "{error} {positions}: {found}");
    }
}

/// The throat of a wheel carries at any number of positions.
#[test]
fn the_throat_of_a_wheel_carries() {
    let of = |positions: &str| {
        let spec = ["specs/pairs/worm_and_wheel.chain", "--error", "m.G=0.3449mm", "--positions", positions];
        peak_to_peak(&solved("edges_worm", &spec))
    };
    let found = ["60", "77", "120"].map(of);
    assert!(found.iter().all(|of| (of / found[0] - 1.0).abs() < 1e-6 && (of - 4.42).abs() < 0.01), "{found:?}");
}

/// Involute helicoids of 23 and 47 teeth with lead crowning `c` and profile crowning `p`.
fn helicoids((tb, c, p, xi0): (f64, f64, f64, f64), half_width: f64, law: &str) -> String {
    format!(
        r#"{machine}
tool helicoid {{
    param rb : length
    param tb : number
    param c : 1 / length = 0 / 1 mm
    param p : length = 0 mm
    param xi0 : angle = 0.4 rad
    surface flank(xi: angle in 0.001 rad .. 1.2 rad, w: length in -100 mm .. 100 mm) {{
        let phi = (tb * w + (c * w^2 + p * ((xi - xi0) / 1 rad)^2)) / rb * 1 rad
        let psi = phi + xi
        at = [rb * (cos(psi) + xi * sin(psi)), rb * (sin(psi) - xi * cos(psi)), w]
        body towards [-sin(psi), cos(psi), 0]
    }}
}}
machine still {{
    axis lift : linear
    frame bed
    frame part in bed = translate_z(lift)
    fix lift = 0 mm
}}
job mine {{
    machine w = still
    tool p = helicoid(rb: 33.8792129446432 mm, tb: {tb:?}, c: {c:?} / 1 mm, p: {p:?} mm, xi0: {xi0:?} rad)
    tool g = helicoid(rb: 69.23143514774915 mm, tb: {back:?})
    mount p on w.part
    mount g on w.part
    surface pf in w.bed = move(p.flank)
    surface gf in w.bed = move(g.flank)
    profile pb {{
        tip = line(from: [{half_width:?} mm, 39.27544673622022 mm], to: [-{half_width:?} mm, 39.27544673622022 mm])
        front = line(from: [-{half_width:?} mm, 39.27544673622022 mm], to: [-{half_width:?} mm, 17 mm])
        bore = line(from: [-{half_width:?} mm, 17 mm], to: [{half_width:?} mm, 17 mm])
        back = line(from: [{half_width:?} mm, 17 mm], to: [{half_width:?} mm, 39.27544673622022 mm])
    }}
    profile gb {{
        tip = line(from: [16 mm, 77.12808680879783 mm], to: [-16 mm, 77.12808680879783 mm])
        front = line(from: [-16 mm, 77.12808680879783 mm], to: [-16 mm, 35 mm])
        bore = line(from: [-16 mm, 35 mm], to: [16 mm, 35 mm])
        back = line(from: [16 mm, 35 mm], to: [16 mm, 77.12808680879783 mm])
    }}
    solid pinion in w.bed = turned(pb, spaces: 23, of: [pf])
    solid gear in w.bed = turned(gb, spaces: 47, of: [gf])
    sample pf {{ rho: 34.2 mm .. 39.27544673622022 mm by 15, z: -{half_width:?} mm .. {half_width:?} mm by 21 }}
    sample gf {{ rho: 70 mm .. 77.12808680879783 mm by 15, z: -16 mm .. 16 mm by 21 }}
    machine m = parallel_pair(centre_distance: 110.40353354501806 mm)
    mount pf on m.pinion
    mount gf on m.gear
    motion turn : angle in -40 deg .. 40 deg
    unknown lag : angle in -1.9148936170212767 deg .. 1.9148936170212767 deg
    drive m.pinion = turn
    drive m.gear = {law}
    contact c = pf with gf, over: turn, for: lag
}}
"#,
        machine = self_contained(&["machines/parallel_pair"]),
        back = -tb
    )
}

const LAW: &str = "3.1159817171792796 rad - 23 / 47 * turn + lag";

/// Against a search without equations of touching: of a grid of points of the pinion, refined sixteen times, the turn of the gear at which its
/// involute passes through each, the greatest over the common part of five pairs of teeth, at 240 positions of a pitch. Between these the error is
/// a little more than it has.
#[test]
fn helicoids_are_as_a_search_finds_them() {
    let wrong = ["--error", "m.I=-4arcmin", "--error", "m.D=-5arcmin", "--error", "m.A=0.1mm"];
    let cases: [(_, f64, &[&str], f64); 4] = [
        ((0.6, -1e-4, 0.0, 0.4), 20.0, &wrong, 123.561),
        ((-0.2, 1e-5, -0.1, 0.5), 16.0, &["--error", "m.A=0.1mm", "--error", "m.G=2.5mm"], 99.739),
        ((0.303456595824419, 0.0, 0.0, 0.4), 16.0, &["--error", "m.D=1.5arcmin"], 15.0787),
        ((0.303456595824419, 0.0, 0.0, 0.4), 16.0, &["--error", "m.D=-5arcmin"], 50.10),
    ];
    for (case, (form, half_width, errors, searched)) in cases.into_iter().enumerate() {
        let spec = written(&folder("edges_own"), &format!("own_{case}.chain"), &helicoids(form, half_width, LAW));
        let found = ["12", "60", "61", "120"].map(|positions| {
            peak_to_peak(&solved("edges_searched", &[&[spec.as_str(), "--positions", positions], errors].concat()))
        });
        for peaks in found {
            assert!((peaks / found[1] - 1.0).abs() < 1e-6, "{case}: {found:?}");
            assert!((0.9999 * searched..1.006 * searched).contains(&peaks), "{case}: {found:?} {searched}");
        }
    }
}

/// The middle lies between both ends, where flanks touch with an even error; an extreme is found although it falls onto a position, and is beyond
/// all that the file has; and where edges alone touch, that is told.
#[test]
fn the_middle_is_where_it_is_told_to_be() {
    for positions in ["7", "60"] {
        let found = solved("edges_middle", &["specs/pairs/helical_pair.chain", "--positions", positions]);
        let ends: f64 =
            found["ends"].as_array().expect("ends").iter().map(|end| end["turn"].as_f64().expect("a number")).sum();
        let middle = &found["middle"];
        assert!((middle["turn"].as_f64().expect("a number") - 0.5 * ends).abs() < 1e-6, "{middle} {ends}");
        let worm = solved("edges_middle", &["specs/pairs/worm_and_wheel.chain", "--positions", positions]);
        let middle = &worm["middle"];
        assert_eq!(middle["is_vertex"], true);
        assert!((middle["turn"].as_f64().expect("a number") - 90.0).abs() < 1e-6, "{middle}");
    }
    let drive = solved("edges_middle", &["specs/pairs/cycloidal_drive.chain", "forward"]);
    assert_eq!((&drive["middle"]["is_vertex"], &drive["kind"]), (&Value::from(true), &Value::from("line")));
    let spur = ["specs/pairs/spur_pair.chain", "drive_side", "--error", "m.D=0.1arcmin"];
    let edge = solved("edges_middle", &spur);
    assert_eq!((&edge["kind"], &edge["middle"]["is_vertex"]), (&Value::from("edge"), &Value::from(false)));
    assert!(edge["middle"]["edge"].as_str().is_some_and(|edge| edge.contains(" of ")), "{}", edge["middle"]);
}

/// Room is the least over the roll, not over the positions.
#[test]
fn room_does_not_depend_on_positions() {
    let rooms = |arguments: &[&str]| -> Vec<f64> {
        let found = solved("edges_room", &[&["specs/pairs/spur_pair.chain", "drive_side"], arguments].concat());
        let rooms = found["clearances"].as_array().expect("room").iter();
        rooms.map(|room| room["least_mm"].as_f64().expect("a number")).collect()
    };
    let known = rooms(&["--positions", "20"]);
    assert_eq!(known.len(), 2);
    for arguments in [&["--positions", "61"][..], &["--positions", "240"], &["--error", "m.D=0.0001arcmin"]] {
        for (known, found) in known.iter().zip(rooms(arguments)) {
            // a golden section settles a kink to a millionth of a position
            assert!((known - found).abs() < 2e-7, "{arguments:?}: {known} {found}");
        }
    }
}

/// Teeth without backlash lean into each other: at the ends of the face, by the lean over the whole width along the normal of both sides. That is a
/// note where the error is asked for, and no failure.
#[test]
fn a_pair_without_backlash_jams_by_its_lean() {
    for (error, lean) in [("m.D=0.1arcmin", 0.1_f64), ("m.D=-1arcmin", 1.0)] {
        let found = solved("edges_jam", &["specs/pairs/spur_pair.chain", "drive_side", "--error", error]);
        let normal = found["backlash"]["normal"].as_f64().expect("a backlash");
        let lean = (lean / 60.0).to_radians();
        let known = -20.0 * lean * 20.0_f64.to_radians().cos();
        // what is of its square is left out
        assert!((normal / known - 1.0).abs() < lean, "{error}: {normal} {known}");
        let told = |of: &Value| of["kind"] == "negative_backlash";
        assert!(found["remarks"].as_array().expect("a list").iter().any(told), "{error}: {}", found["remarks"]);
    }
    let straight = solved("edges_jam", &["specs/pairs/spur_pair.chain", "drive_side"]);
    assert!(straight["remarks"].as_array().expect("a list").iter().all(|of| of["kind"] != "negative_backlash"));
}

/// Laws and numbers of teeth that do not belong together are told with a way out.
#[test]
fn a_law_of_other_teeth_is_told() {
    let form = (0.303456595824419, 6e-5, 0.0, 0.4);
    let ratio = LAW.replace("23 / 47", "23 / 46");
    let sign = LAW.replace("- 23", "+ 23");
    let off = LAW.replace("rad -", "rad + 10 * 360 deg / 47 + 720 deg -");
    let tooth = helicoids(form, 16.0, &LAW.replace("23 / 47", "22 / 47")).replace("spaces: 23", "spaces: 22");
    let near = helicoids(form, 16.0, LAW).replace("110.40353354501806", "100");
    let cases = [
        (
            helicoids(form, 16.0, &ratio),
            "does not carry a tooth of gear (47) on while one of pinion (23) passes",
            "23 / 47",
        ),
        (helicoids(form, 16.0, &sign), "the law turns it by 0.489362", "other sign"),
        (tooth, "the flanks are not those of 22 teeth of pinion and 47 of gear", "`spaces`"),
        (helicoids(form, 16.0, &off), "do not reach each other", "right to a pitch"),
        (near, "do not reach each other", "set them apart"),
    ];
    for (case, (content, message, way)) in cases.into_iter().enumerate() {
        let spec = written(&folder("edges_law"), &format!("law_{case}.chain"), &content);
        let (found, code) = run("edges_law_out", &[&spec]);
        assert_eq!(code, 3, "{case}");
        let told = found["not_done"].to_string();
        assert!(told.contains(message) && told.contains(way), "{case}: {told}");
    }
    let run = flank(&["contact", "specs/pairs/spur_pair.chain", "--compound", "-1um"]);
    assert!(text(&run.stderr).contains("a length above zero"), "{}", text(&run.stderr));
    // flanks that lean by 6 milliseconds of arc touch along a line as far as is looked at, and are 0.2 nm apart at its other end
    for spec in ["specs/pairs/spur_pair.chain", "specs/pairs/rack_and_pinion.chain"] {
        let (found, _) = crate::run("edges_line", &[spec, "drive_side", "--error", "m.I=0.0001arcmin"]);
        assert!(!found["not_done"].to_string().contains("reach into each other"), "{spec}");
    }
}

/// An error of the eccentricity that takes the clearance away leaves the backlash of its neighbours, where the lag is locked at the end of the
/// roll and the path was lost: 0.0212 deg by a closed form of both equidistants, which falls to 0.0208 deg a nanometre farther.
#[test]
fn a_clearance_of_nothing_has_a_backlash() {
    let of = |contact: &str| {
        solved("edges_locked", &["specs/pairs/cycloidal_drive.chain", contact, "--error", "m.E=0.02mm"])
    };
    let both = ["forward", "backward"].map(of);
    for found in &both {
        let least = found["backlash"]["least"].as_f64().expect("a backlash");
        assert!((least - 0.0211).abs() < 5e-4, "{least}");
    }
    let [forward, backward] = both.map(|found| peak_to_peak(&found));
    // one is the mirror image of the other: rounding of positions whose middles are solved apart
    assert!((forward - backward).abs() < 1e-3, "{forward} {backward}");
}

/// Extremes, transfers, what edges carry and the pattern are those of the pair, however few positions are asked for.
#[test]
fn few_positions_lose_no_extreme() {
    let worm = ["specs/pairs/worm_and_wheel.chain"];
    let wrong = ["specs/pairs/worm_and_wheel.chain", "--error", "m.A=-0.05mm"];
    let face = ["specs/pairs/face_gear_pair.chain", "--error", "m.S=3arcmin"];
    for arguments in [&worm[..], &wrong, &face] {
        let of = |positions: &str| solved("edges_few", &[arguments, &["--positions", positions]].concat());
        let known = of("120");
        for positions in ["4", "7", "12"] {
            let found = of(positions);
            let off = peak_to_peak(&found) / peak_to_peak(&known) - 1.0;
            // extremes are solved where two positions or a transfer tell that there is one: 61 positions are off by 5e-5
            assert!(off.abs() < 1e-3, "{arguments:?} {positions}: {off:e}");
            let path = |of: &Value| of["edges"].as_array().expect("edges").len();
            assert_eq!(path(&found), path(&known), "{arguments:?} {positions}");
        }
    }
}

/// The throat of a wheel takes over where it is told, and ends where the next pair does: both solved, whatever the positions.
#[test]
fn edges_carry_between_solved_places() {
    for positions in ["12", "60", "61"] {
        let found = solved("edges_between", &["specs/pairs/worm_and_wheel.chain", "--positions", positions]);
        let throat =
            found["edges"].as_array().expect("edges").iter().find(|of| of["edge"].to_string().contains("throat"));
        let throat = throat.expect("it carries");
        let [from, to] = ["from", "to"].map(|end| throat[end].as_f64().expect("a turn"));
        let transfers = found["error"]["transfers"].as_array().expect("transfers");
        // halving settles a place to 1e-12 of a step
        assert!(transfers.iter().any(|of| (of.as_f64().expect("a turn") - from).abs() < 1e-6), "{positions}: {found}");
        assert!((to - 196.557).abs() < 1e-2, "{positions}: {to}");
    }
}

/// Numbers that are rounding are not told as such: no share of a parabola that is zero, and a film as it was given.
#[test]
fn rounding_is_not_told() {
    let face = solved("edges_rounding", &["specs/pairs/face_gear_pair.chain", "--sensitivity"]);
    let influences = face["influences"].as_array().expect("influences");
    assert!(!influences.is_empty() && influences.iter().all(|of| of["parabola"].is_null()), "{influences:?}");
    let thin = flank(&["contact", "--no-picture", "specs/pairs/face_gear_pair.chain", "--compound", "1e-9mm"]);
    assert!(text(&thin.stdout).contains("within 0.000001 um"), "{}", text(&thin.stdout));
}
