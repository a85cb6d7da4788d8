//! `flank test`: what it prints and writes, and how it ends.

mod support;

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use serde_json::Value;
use support::{folder, text, top, written};

/// In a folder, as if no server ran it, or as if one did.
fn tested(folder: &Path, server: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.arg("test").args(arguments).current_dir(folder).env("CI", server);
    command.output().expect("the binary runs")
}

fn gear() -> String {
    std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped")
}

fn broken() -> String {
    gear().replace("drive m.Y = reference_radius * roll", "drive m.Y = 1.001 * reference_radius * roll")
}

#[test]
fn what_holds_and_what_does_not() {
    let folder = folder("test_holds");
    written(&folder, "gear.chain", &gear());
    let run = tested(&folder, "", &[]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("gear.chain: 4 expectations hold"), "{}", text(&run.stdout));

    written(&folder, "gear.chain", &broken());
    let run = tested(&folder, "", &["gear.chain", "--junit", "out.xml", "--annotate"]);
    assert_eq!(run.status.code(), Some(3));
    let told = text(&run.stdout);
    assert!(told.contains("gear.chain: 2 of 4 expectations failed"), "{told}");
    assert!(told.contains("found: off by up to") && told.contains("most at rho ="), "{told}");
    assert!(told.contains("::error file=gear.chain,line="), "{told}");
    let xml = std::fs::read_to_string(folder.join("out.xml")).expect("it is written");
    assert!(xml.contains("tests=\"4\" failures=\"2\"") && xml.matches("<failure").count() == 2, "{xml}");

    let run = tested(&folder, "", &["gear.chain", "--json"]);
    let document: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((&document["schema"], &document["failed"]), (&"flank.test/1".into(), &2.into()));
    let run = tested(&folder, "", &["gear.chain", "--filter", "helical"]);
    assert_eq!((run.status.code(), text(&run.stdout).contains("1 expectation")), (Some(0), true));
    // where nothing is taken, nothing holds either
    let run = tested(&folder, "", &["gear.chain", "--filter", "typo"]);
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), String::new()));
    assert!(text(&run.stderr).contains("--filter typo takes no job and no machine"), "{}", text(&run.stderr));
}

/// The gear of the tutorial with these expectations in place of its own.
fn expecting(expectations: &str) -> String {
    let own = gear();
    let lines = own.lines().filter(|line| !line.trim_start().starts_with("expect "));
    let text: String = lines.map(|line| format!("{line}\n")).collect();
    text.replace("    let base_radius", &format!("{expectations}    let base_radius"))
}

/// Both sides are one expression, or both surfaces one: `flank test` warns of it as `flank check` does, and not of what is derived.
#[test]
fn expectations_that_never_fail_are_warned_of() {
    let folder = folder("test_never");
    for (expected, why) in [
        ("flank_plus: x near x within 1 um", Some("both sides are the same")),
        ("flank_plus: x * 1 near x within 1 um", Some("both sides are the same")),
        ("flank_plus: rho near sqrt(x^2 + y^2) within 1 um", Some("both sides are the same")),
        ("r.module near r.module within 1 um", Some("both sides are the same")),
        ("turn(flank_plus, flank_plus) near 0 deg within 1 arcsec", Some("it compares a surface with itself")),
        ("rms(flank_plus, flank_plus) + 1 um in 0 um .. 2 um", Some("it compares a surface with itself")),
        ("flank_plus: rho near sqrt(x^2 + y^2 + z^2) within 1 mm", None),
        ("turn(flank_plus, flank_plus) near 1 deg within 1 arcsec", None),
    ] {
        written(&folder, "gear.chain", &expecting(&format!("    expect {expected}\n")));
        let run = tested(&folder, "", &["gear.chain"]);
        let (out, told) = (text(&run.stdout), text(&run.stderr));
        match why {
            Some(why) => {
                assert_eq!(run.status.code(), Some(0), "{expected}: {out}{told}");
                assert!(out.contains("gear.chain: 1 expectation holds, 1 warning"), "{expected}: {out}");
                assert!(told.contains("W0006") && told.contains(why), "{expected}: {told}");
            }
            None => assert!(!out.contains("warning") && !told.contains("W0006"), "{expected}: {out}{told}"),
        }
    }
}

/// No value lies between ends that are the wrong way round.
#[test]
fn ends_the_wrong_way_round_are_told() {
    let folder = folder("test_ends");
    for expected in ["r.module in 6 mm .. 4 mm", "flank_plus: x in 40 mm .. -40 mm"] {
        written(&folder, "gear.chain", &expecting(&format!("    expect {expected}\n")));
        let told = text(&tested(&folder, "", &["gear.chain"]).stderr);
        assert!(told.contains("E0303") && told.contains("put the smaller end first"), "{expected}: {told}");
    }
}

/// A report goes over nothing that was read for it.
#[test]
fn a_spec_is_not_written_over_by_its_report() {
    let folder = folder("test_over");
    let spec = expecting("    expect all solved\n");
    written(&folder, "gear.chain", &spec);
    let run = tested(&folder, "", &["gear.chain", "--junit", "gear.chain"]);
    assert!(
        run.status.code() == Some(1) && text(&run.stderr).contains("would be written over"),
        "{}",
        text(&run.stderr)
    );
    assert_eq!(std::fs::read_to_string(folder.join("gear.chain")).expect("the spec"), spec);
}

/// What was found is told as it is: a value, a formula that has none, the reason why there is none, the job that expects an error.
#[test]
fn what_was_found_reads_well() {
    let folder = folder("test_found");
    let found = |expected: &str| {
        written(&folder, "gear.chain", &expecting(&format!("    expect {expected}\n")));
        let run = tested(&folder, "", &["gear.chain", "--junit", "out.xml"]);
        assert_eq!(run.status.code(), Some(3), "{expected}: {}", text(&run.stderr));
        text(&run.stdout)
    };
    let told = found("flank_plus: rho in 1 mm .. 2 mm");
    assert!(told.contains("\n    found: reaches "), "{told}");
    let told = found("flank_plus: sqrt(-1 - z^2 / 1 mm^2) near 0 within 1");
    assert!(told.contains("\n    found: no number: the formula has no value there\n    at 35 of 35"), "{told}");
    let told = found("error E0307");
    assert!(told.contains("  first_gear:") && told.contains("\n    found: no error"), "{told}");
    let xml = std::fs::read_to_string(folder.join("out.xml")).expect("it is written");
    assert!(xml.contains("classname=\"first_gear\" name=\"error E0307\""), "{xml}");
}

/// A travel is told in the unit that the machine has it in, and so is how far the axis goes.
#[test]
fn a_travel_is_told_in_its_own_unit() {
    let folder = folder("test_travel");
    let narrow = expecting("    expect travel\n").replace("linear in -60 mm .. 60 mm", "linear in -60000 um .. 500 um");
    assert!(narrow.contains(" um .. "), "{narrow}");
    written(&folder, "gear.chain", &narrow);
    let run = tested(&folder, "", &["gear.chain"]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    assert!(told.contains(" um, its travel is -60000.0000 to 500.0000 um"), "{told}");
}

/// The origin and the turn of a frame are told apart, each with its unit, and what has no tolerance says so.
#[test]
fn a_pose_is_off_by_a_length_and_turned_by_an_angle() {
    let folder = folder("test_pose");
    let found = |near: &str, within: &str| {
        let spec = format!(
            "machine table {{
                axis C : rotary
                frame bed
                frame work in bed = rotate_z(C)
                expect work in bed near {near} at (C: 0 deg) within {within}
            }}"
        );
        written(&folder, "table.chain", &spec);
        let run = tested(&folder, "", &["table.chain"]);
        (run.status.code(), text(&run.stdout))
    };
    let (code, told) = found("rotate_z(3 arcmin)", "1 um");
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("\n    found: off by 0 um, turned by 0.05 deg\n"), "{told}");
    assert!(told.contains("no tolerance is written for the turn, so only rounding is allowed, 0.001 arcsec"), "{told}");
    let (code, told) = found("rotate_x(90 deg)", "1 mm, 1 deg");
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("\n    found: off by 0 um, turned by 90 deg\n") && !told.contains("no tolerance"), "{told}");
    let (code, told) = found("translate_x(2 um)", "1 deg");
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("\n    found: off by 2 um, turned by 0 arcsec\n"), "{told}");
    assert!(told.contains("no tolerance is written for the origin, so only rounding is allowed, 0.001 um"), "{told}");
    let (code, told) = found("mirror_x()", "1 um, 180 deg");
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("one of both poses is mirrored"), "{told}");
    assert_eq!(found("rotate_z(3 arcmin) translate_x(2 um)", "3 um, 4 arcmin").0, Some(0));
}

/// A gear of four teeth at 80 deg is a worm: its transverse profiles are long spirals, its lines on cylinders wind around the axis.
#[test]
fn angles_of_a_worm_are_those_that_were_changed() {
    let folder = folder("test_angles");
    let mut worm = gear();
    for (from, to) in [
        ("teeth : count = 20\n    /// Right", "teeth : count = 4\n    /// Right"),
        ("helix_angle : angle = 15 deg", "helix_angle : angle = 80 deg"),
        ("half_width: 20 mm", "half_width: 60 mm"),
        ("linear in -60 mm .. 60 mm", "linear in -300 mm .. 300 mm"),
        ("roll : angle in -40 deg .. 40 deg", "roll : angle in -170 deg .. 170 deg"),
    ] {
        assert!(worm.contains(from), "{from}");
        worm = worm.replace(from, to);
    }
    let job = worm.find("job first_helical_gear").expect("it is shipped");
    worm.replace_range(job.., &worm[job..].replace("-10 mm .. 10 mm", "-2 mm .. 2 mm"));
    written(&folder, "worm.chain", &worm);
    assert_eq!(tested(&folder, "", &["--accept"]).status.code(), Some(0));
    let changed = |from: &str, to: &str, angle: &str| -> Vec<f64> {
        assert!(worm.contains(from), "{from}");
        written(&folder, "worm.chain", &worm.replace(from, to));
        let told = text(&tested(&folder, "", &[]).stdout);
        let lines = told.lines().filter(|line| line.contains("first_helical_gear.flank_"));
        let angles =
            lines.filter_map(|line| line.split(&format!("{angle} angle ")).nth(1)?.split(' ').next()?.parse().ok());
        angles.collect()
    };
    // at the radius of the third of four rows that are kept, the nearest to the middle: in closed form, to what nine digits of two normals leave
    let radius = |beta: f64| 16.0 / (2.0 * beta.cos());
    let rho = radius(80_f64.to_radians()) + 1.5;
    let pressure_angle = |alpha: f64, beta: f64| (radius(beta) * (alpha.tan() / beta.cos()).atan().cos() / rho).acos();
    let helix_angle = |beta: f64| (rho * beta.sin() / 8.0).atan();
    let [alpha, beta] = [20_f64, 80.0].map(f64::to_radians);
    let [more_alpha, more_beta] = [20.01_f64, 80.01].map(f64::to_radians);
    let is = |found: Vec<f64>, change: f64| {
        let by = change.to_degrees() * 60.0;
        assert!(
            found.len() == 2 && found.iter().all(|told| (told - by).abs() < 1e-4 * by),
            "{found:?} instead of {by}"
        );
    };
    let both = changed("angle = 20 deg", "angle = 20.01 deg", "pressure");
    is(both, pressure_angle(more_alpha, beta) - pressure_angle(alpha, beta));
    let both = changed("angle = 80 deg", "angle = 80.01 deg", "helix");
    is(both, helix_angle(more_beta) - helix_angle(beta));
}

/// A bevel gear whose cutter lies 0.1 mm farther from the cradle. The numbers are those of normals that `flank solve` gives at the kept
/// point in the middle, row 9 and column 20, computed outside of this program. One that is only turned about its axis has the angles that it had.
#[test]
fn angles_of_a_bevel_gear_are_those_of_its_normals() {
    let folder = folder("test_bevel_angles");
    let parts = ["functions/bevel", "functions/blanks_19x62", "machines/cradle", "tools/face_mill", "bevel/gear_19x62"];
    let spec = support::self_contained(&parts);
    written(&folder, "gear.chain", &spec);
    assert_eq!(tested(&folder, "", &["--accept"]).status.code(), Some(0));
    let changed = |from: &str, to: &str| -> Vec<String> {
        assert!(spec.contains(from), "{from}");
        written(&folder, "gear.chain", &spec.replacen(from, to, 1));
        let told = text(&tested(&folder, "", &[]).stdout);
        let flanks = ["gear_19x62.concave moved", "gear_19x62.convex moved"];
        let lines = told.lines().filter(|line| flanks.iter().any(|flank| line.trim_start().starts_with(flank)));
        lines.map(str::to_string).collect()
    };
    let turned = changed(
        "frame work           in head           = rotate_z(work)",
        "frame work in head = rotate_z(work + 1 arcmin)",
    );
    assert!(turned.len() == 2 && turned.iter().all(|line| !line.contains("arcmin")), "{turned:?}");
    let farther = changed("radial_distance: 97.95367814746567 mm", "radial_distance: 98.05367814746567 mm");
    for (line, wanted) in farther.iter().zip([[-0.111135, -3.657929], [0.135974, -3.769808]]) {
        for (angle, by) in ["pressure", "spiral"].into_iter().zip(wanted) {
            let told = line.split(&format!("{angle} angle ")).nth(1).and_then(|rest| rest.split(' ').next());
            let told: f64 = told.and_then(|told| told.parse().ok()).expect("an angle");
            // nine digits of normals, six of what is told
            assert!((told - by).abs() < 1e-4, "{line}: {told} instead of {by}");
        }
    }
    assert_eq!(farther.len(), 2);
}

/// A comma ends a property of a line for forges, and a colon the properties.
#[test]
fn names_of_files_are_escaped_for_forges() {
    let folder = folder("test_annotate");
    written(&folder, "a,b 5%.chain", &broken());
    let told = text(&tested(&folder, "", &["a,b 5%.chain", "--annotate"]).stdout);
    let line = told.lines().find(|line| line.starts_with("::error ")).expect("a line for forges");
    assert!(line.starts_with("::error file=a%2Cb 5%25.chain,line="), "{line}");
}

/// A surface that is only moved has no tool that touches it; all its points are solved.
#[test]
fn values_that_a_surface_has_nowhere_are_not_its_points_fault() {
    let folder = folder("test_no_value");
    let spec = "machine bench {
            axis lift : linear
            frame bed
            frame part in bed = translate_z(lift)
            fix lift = 0 mm
        }
        tool plate {
            surface face(u: length in -5 mm .. 5 mm, v: length in -1 mm .. 1 mm) {
                at = [u, v, 0 mm]
                body towards [0, 0, -1]
            }
        }
        job j {
            machine m = bench
            tool t = plate
            mount t on m.part
            surface s in m.bed = move(t.face)
            sample s { u: -3 mm .. 3 mm by 5, v: -0.5 mm .. 0.5 mm by 3 }
            expect all solved
            expect s: induced_k1 near 0 / 1 mm within 1 / 1 mm
        }";
    written(&folder, "s.chain", spec);
    let told = text(&tested(&folder, "", &[]).stdout);
    assert!(
        told.contains("found: no point of s has this value") && told.contains("1 of 2 expectations failed"),
        "{told}"
    );
    assert!(told.contains("induced curvatures are of an envelope"), "{told}");
}

/// A cylinder of 10 mm whose points slide by 5 deg: they leave it nowhere, and the way of each is a chord.
#[test]
fn points_that_slide_along_their_surface_do_not_move_it() {
    let folder = folder("test_slide");
    let spec = |zero: &str| {
        format!(
            "machine bench {{
                axis lift : linear
                frame bed
                frame part in bed = translate_z(lift)
                fix lift = 0 mm
            }}
            tool cylinder {{
                param zero : angle = {zero}
                surface side(a: angle in -60 deg .. 60 deg, v: length in -5 mm .. 5 mm) {{
                    at = [10 mm * cos(a + zero), 10 mm * sin(a + zero), v]
                    body inside
                }}
            }}
            job j {{
                machine m = bench
                tool t = cylinder
                mount t on m.part
                surface s in m.bed = move(t.side)
                sample s {{ a: -30 deg .. 30 deg by 5, v: -3 mm .. 3 mm by 3 }}
            }}"
        )
    };
    written(&folder, "s.chain", &spec("0 deg"));
    let accepted = tested(&folder, "", &["--accept"]);
    assert_eq!(accepted.status.code(), Some(0));
    let same = tested(&folder, "", &[]);
    assert_eq!(same.status.code(), Some(0));
    assert!(text(&same.stdout).contains("s.chain: as in its snapshot"), "{}", text(&same.stdout));
    written(&folder, "s.chain", &spec("5 deg"));
    let told = text(&tested(&folder, "", &[]).stdout);
    let chord = 20.0 * 2.5_f64.to_radians().sin();
    let slid = format!("j.s is the same surface, along which points slid by at most {chord:.6} mm");
    assert!(told.contains(&slid) && !told.contains("moved along its normal"), "{told}");
}

/// The teeth of a face gear run along the radius, those of a rack's gear along the axis: a sample by both does not say which. Of the face gear,
/// whose profiles run along the axis, no angle is told, neither under the name of the other.
#[test]
fn no_angle_is_told_of_teeth_along_the_radius() {
    let folder = folder("test_face_gear");
    let parts = [
        "machines/hobbing_6axis",
        "machines/power_skiving",
        "machines/gear_shaping",
        "tools/involute",
        "tools/pinion_cutter",
        "hobbing/face_gear",
    ];
    let spec = support::self_contained(&parts);
    written(&folder, "face.chain", &spec);
    assert_eq!(tested(&folder, "", &["--accept"]).status.code(), Some(0));
    let (from, to) = ("normal_pressure_angle : angle in 1 deg .. 45 deg = 20 deg", "20.01 deg");
    assert!(spec.contains(from));
    written(&folder, "face.chain", &spec.replace(from, &from.replace("20 deg", to)));
    let told = text(&tested(&folder, "", &[]).stdout);
    let moved = told.lines().filter(|line| line.contains("moved along its normal"));
    assert_eq!(moved.clone().count(), 2, "{told}");
    assert!(moved.clone().all(|line| !line.contains("angle")), "{told}");
}

#[test]
fn snapshots_are_accepted_and_differ_in_words() {
    let folder = folder("test_snapshot");
    written(&folder, "gear.chain", &gear());
    let run = tested(&folder, "", &["--accept"]);
    assert_eq!((run.status.code(), text(&run.stderr).contains("wrote ./gear.snapshot")), (Some(0), true));
    let told = text(&run.stdout);
    assert!(told.contains("accepted in ./gear.snapshot:") && told.contains("all hold"), "{told}");
    assert_eq!(tested(&folder, "", &[]).status.code(), Some(0));

    written(&folder, "gear.chain", &gear().replace("angle = 20 deg", "angle = 20.01 deg"));
    let run = tested(&folder, "", &[]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(told.contains("first_gear.flank_plus moved along its normal by at most"), "{told}");
    assert!(told.contains(" at rho = ") && told.contains("all hold") == told.contains("4 expectations: all"), "{told}");
    assert!(told.contains("pressure angle") && told.contains("explained best by r.pressure_angle"), "{told}");
    assert!(folder.join("build/gear.moved.svg").exists(), "{}", text(&run.stderr));

    // rows that are columns now give no angle the name of the other
    let turned = gear()
        .replace("rho: low .. high by 9, z: -10 mm .. 10 mm by 5", "z: -10 mm .. 10 mm by 5, rho: low .. high by 9");
    assert_ne!(turned, gear());
    written(&folder, "gear.chain", &turned.replace("angle = 20 deg", "angle = 20.01 deg"));
    let told = text(&tested(&folder, "", &[]).stdout);
    assert!(told.contains("its sample is by z and rho instead of") && !told.contains(" arcmin"), "{told}");

    // a sample of its own is no other branch: it says what is asked for otherwise
    for (sample, says) in [
        (gear().replace("by 5 }", "by 6 }"), "its sample is another one: 42 points of it are looked at instead of 35"),
        (gear().replace("-10 mm .. 10 mm", "-9 mm .. 10 mm"), "its sample has other places"),
    ] {
        assert_ne!(sample, gear());
        written(&folder, "gear.chain", &sample);
        let run = tested(&folder, "", &[]);
        let told = text(&run.stdout);
        assert!(run.status.code() == Some(3) && told.contains(says) && !told.contains("evaluations"), "{told}");
        // nothing moved, and no setting explains it
        assert!(!told.contains("explained"), "{told}");
    }

    // what became of points
    let less = gear().replacen("param teeth : count = 20", "param teeth : count = 9", 1);
    assert_ne!(less, gear());
    written(&folder, "gear.chain", &less);
    let run = tested(&folder, "", &[]);
    let told = text(&run.stdout);
    assert!(told.contains(" points no longer solved, but ") && told.contains(", the first at rho = "), "{told}");

    // nothing is accepted where a server runs it, and nobody is asked where nobody sits
    for arguments in [["--accept"], ["--review"]] {
        let run = tested(&folder, "true", &arguments);
        assert_eq!((run.status.code(), text(&run.stderr).contains("nothing is accepted")), (Some(2), true));
    }
    let run = tested(&folder, "", &["--review"]);
    assert_eq!((run.status.code(), text(&run.stderr).contains("terminal")), (Some(2), true));
}

#[test]
fn what_cannot_be_tested_says_so() {
    let folder = folder("test_bad");
    let run = tested(&folder, "", &[]);
    assert_eq!((run.status.code(), text(&run.stderr).contains("holds no spec")), (Some(1), true));
    written(&folder, "wrong.chain", &gear().replace("angle = 20 deg", "angle = 20"));
    let run = tested(&folder, "", &[]);
    assert_eq!((run.status.code(), text(&run.stderr).contains("E0301")), (Some(3), true));
    // unless that is what is expected
    let expected = gear().replace("angle = 20 deg", "angle = 20").replace("expect all solved", "expect error E0301");
    written(&folder, "wrong.chain", &expected);
    let run = tested(&folder, "", &[]);
    assert_eq!((run.status.code(), text(&run.stdout).contains("hold")), (Some(0), true), "{}", text(&run.stdout));
}

/// Tests again what is saved.
#[test]
fn a_saved_file_is_tested_again() {
    let folder = folder("test_watch");
    written(&folder, "gear.chain", &gear());
    let out = std::fs::File::create(folder.join("out.txt")).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.args(["test", "gear.chain", "--watch"]).current_dir(&folder).env("CI", "").stdout(out);
    let mut running = command.spawn().expect("the binary runs");
    let start = Instant::now();
    let until = |what: &str| {
        while start.elapsed() < Duration::from_secs(120) {
            if std::fs::read_to_string(folder.join("out.txt")).is_ok_and(|told| told.contains(what)) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        false
    };
    let is_first = until("4 expectations hold");
    // the time of a file may have steps of some milliseconds
    std::thread::sleep(Duration::from_millis(500));
    written(&folder, "gear.chain", &broken());
    let is_second = until("2 of 4 expectations failed");
    running.kill().and_then(|()| running.wait()).expect("it is ended");
    assert!(is_first && is_second);
}

/// A file that was away for a moment, as when an editor or a version control system puts another one in its place, still touches those that
/// use it.
#[test]
fn a_used_file_that_was_away_is_watched_again() {
    let folder = folder("test_away");
    let (machine, job) =
        gear().split_once("job first_gear").map(|(a, b)| (a.to_string(), format!("job first_gear{b}"))).unwrap();
    written(&folder, "parts.chain", &machine);
    written(&folder, "gear.chain", &format!("use \"parts.chain\"\n\n{job}"));
    let out = std::fs::File::create(folder.join("out.txt")).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.args(["test", "gear.chain", "--watch"]).current_dir(&folder).env("CI", "").stdout(out);
    let mut running = command.spawn().expect("the binary runs");
    let start = Instant::now();
    let times = |what: &str, count: usize| {
        while start.elapsed() < Duration::from_secs(120) {
            let told = std::fs::read_to_string(folder.join("out.txt")).unwrap_or_default();
            if told.matches(what).count() >= count {
                return true;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        false
    };
    let is_first = times("4 expectations hold", 1);
    std::fs::rename(folder.join("parts.chain"), folder.join("parts.away")).expect("it is there");
    let is_missed = times(" in the text", 1);
    std::fs::rename(folder.join("parts.away"), folder.join("parts.chain")).expect("it is there");
    let is_back = times("4 expectations hold", 2);
    // the time of a file may have steps of some milliseconds
    std::thread::sleep(Duration::from_millis(500));
    written(&folder, "parts.chain", &machine);
    let is_touched = times("4 expectations hold", 3);
    running.kill().and_then(|()| running.wait()).expect("it is ended");
    assert!(is_first && is_missed && is_back && is_touched, "{is_first} {is_missed} {is_back} {is_touched}");
}

/// One spec under two names is one spec, and what links lead to is tested.
#[cfg(unix)]
#[test]
fn a_spec_is_tested_once_under_all_its_names() {
    let folder = folder("test_names");
    written(&folder, "gear.chain", &gear());
    let run = tested(&folder, "", &["gear.chain", ".", "./gear.chain"]);
    assert!(text(&run.stdout).contains("1 spec, 4 expectations: all hold"), "{}", text(&run.stdout));
    std::fs::create_dir(folder.join("linked")).expect("a folder");
    std::os::unix::fs::symlink("../gear.chain", folder.join("linked/other.chain")).expect("a link");
    let run = tested(&folder, "", &["linked"]);
    assert!(text(&run.stdout).contains("linked/other.chain: 4 expectations hold"), "{}", text(&run.stdout));
    std::os::unix::fs::symlink("nowhere.chain", folder.join("linked/lost.chain")).expect("a link");
    let run = tested(&folder, "", &["linked"]);
    assert!(run.status.code() == Some(3) && text(&run.stdout).contains("linked/lost.chain"), "{}", text(&run.stdout));
}

/// The job of the library and what it is expected to be like go together; what is meant for its own values stays behind.
#[test]
fn a_new_job_brings_its_expectations() {
    let folder = folder("test_new");
    let new = |arguments: &[&str]| {
        let run = Command::new(env!("CARGO_BIN_EXE_flank")).arg("new").args(arguments).current_dir(&folder).output();
        let run = run.expect("the binary runs");
        assert!(run.status.success(), "{}", text(&run.stderr));
    };
    new(&["pinion_19x62", "--name", "my_pinion", "--out", "one"]);
    assert!(folder.join("one/bevel/pinion_19x62.csv").exists());
    new(&["spur_gear", "--name", "my_gear", "--out", "two", "--set", "teeth=31", "--set", "module=2 mm"]);
    for place in ["one/bevel/my_pinion.chain", "two/hobbing/my_gear.chain"] {
        let run = tested(&folder, "", &[place]);
        assert_eq!((run.status.code(), text(&run.stdout).contains("hold")), (Some(0), true), "{}", text(&run.stdout));
    }
}

/// A cam and two ways to sample it: one range holds the outer and the inner branch, so nothing can be said of the other one, which is whole.
const CAM: &str = r#"machine lathe {
    axis X : linear
    axis C : rotary
    frame bed
    frame slide in bed = translate(X, 0 mm, 0 mm)
    frame work in bed = rotate_z(C)
    couple X = 30 mm + 2 mm * sin(3 * C)
}

tool ball {
    surface face(a: angle in -180 deg .. 180 deg, b: angle in -89 deg .. 89 deg) {
        at = [4 mm * cos(b) * cos(a), 4 mm * cos(b) * sin(a), 4 mm * sin(b)]
        body inside
    }
}

job cam {
    machine m = lathe
    tool    t = ball
    mount t on m.slide
    motion turn : angle in -60 deg .. 60 deg
    drive m.C = turn
    surface both, inner in m.work = envelope(t.face, t.face, over: turn)
    sample both { z: -3 mm .. 3 mm by 3, turn: -50 deg .. 50 deg by 5 }
    sample inner {
        z: -3 mm .. 3 mm by 3, turn: -50 deg .. 50 deg by 5
        keep side = cos(a): -1 .. 0
    }
    expect inner solved
    expect both near inner within 1 um
}
"#;

#[test]
fn what_is_ambiguous_is_the_first_reason() {
    let folder = folder("test_ambiguous");
    written(&folder, "cam.chain", CAM);
    let run = tested(&folder, "", &["cam.chain"]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(told.contains("1 of 2 expectations failed"), "{told}");
    assert!(told.contains("    found: ambiguous: the ranges of both hold 2 branches"), "{told}");
    assert!(!told.contains("inner is solved"), "{told}");
}

/// An error that is expected keeps the whole file from being derived: whatever else it expects does not count as held.
#[test]
fn an_expected_error_hides_no_other_job() {
    let folder = folder("test_hides");
    let job = expecting("    expect highest(flank, rho) in 0 mm .. 1 mm\n");
    let wrong = "\njob bad extends first_gear {\n    drive m.C = rol\n    expect error E0201\n}\n";
    written(&folder, "two.chain", &format!("{job}{wrong}"));
    let run = tested(&folder, "", &[]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(told.contains("nothing is tested of it") && told.contains("a file of its own"), "{told}");
    assert!(told.contains("2 of 3 expectations failed"), "the error itself is as expected: {told}");
}

/// What `flank solve` tells as not as required is a failure here, too.
#[test]
fn what_samples_require_is_tested() {
    let folder = folder("test_requires");
    let requiring = |high: &str| {
        let rho = format!("require far = rho: 0 mm .. {high}, \"it lies too far out\"\n        rho: ");
        expecting("    expect all solved\n").replacen("rho: ", &rho, 1)
    };
    written(&folder, "gear.chain", &requiring("100 mm"));
    let run = tested(&folder, "", &[]);
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
    written(&folder, "gear.chain", &requiring("36 mm"));
    let run = tested(&folder, "", &[]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(
        told.contains("require far: ") && told.contains(" .. 36 mm") && told.contains("it lies too far out"),
        "{told}"
    );
    assert!(told.contains("far is"), "{told}");
}

/// Tools that keep versions of texts may change the ends of lines; whatever else a spec expects is tested where its snapshot cannot be read.
#[test]
fn snapshots_with_other_ends_of_lines_are_the_same_and_unreadable_ones_differ() {
    let folder = folder("test_ends");
    written(&folder, "gear.chain", &gear());
    assert_eq!(tested(&folder, "", &["--accept"]).status.code(), Some(0));
    let snapshot = std::fs::read_to_string(folder.join("gear.snapshot")).expect("it is written");
    written(&folder, "gear.snapshot", &snapshot.replace('\n', "\r\n"));
    let run = tested(&folder, "", &[]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stdout));

    std::fs::write(folder.join("gear.snapshot"), b"\xff\xfe").expect("a file");
    let run = tested(&folder, "", &[]);
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(told.contains("cannot read it") && told.contains("1 of 5 expectations failed"), "{told}");
    assert_eq!(tested(&folder, "", &["--accept"]).status.code(), Some(0));
    assert_eq!(tested(&folder, "", &[]).status.code(), Some(0));
}
