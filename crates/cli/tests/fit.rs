//! `flank fit`: settings that made a flank, settings that correct it.

mod support;

use std::path::Path;

use serde_json::Value;
use support::grids::{CHANGED, PINION, VARIED, fit, gauged, names, number, path, plain, rewritten};
use support::{flank, folder, text, top, written};

#[test]
fn settings_of_a_measured_flank_come_back() {
    let file = gauged("fit_back");
    for more in [&[][..], &["--as-it-lies"]] {
        let (told, _) = fit(0, &[&[PINION, "concave", "--measured", path(&file), "--vary", VARIED], more].concat());
        let found = told["identification"]["settings"].as_array().expect("settings");
        for ((name, _, value), setting) in CHANGED.iter().zip(found) {
            assert_eq!(setting["name"], *name, "in the order of the job");
            assert!((number(&setting["new"]) - value).abs() < 1e-9, "{setting}");
            assert!(setting["at_bound"].is_null() && number(&setting["uncertain_by"]) < 1e-6);
        }
        assert!(number(&told["identification"]["left_um"]) < 1e-6);
        // to first order the correction is the other way; what is left is of the second
        for (found, set) in found.iter().zip(told["correction"]["settings"].as_array().expect("settings")) {
            let [there, back] = [found, set].map(|of| number(&of["change"]));
            assert!((there + back).abs() < 0.05 * there.abs(), "{there} {back}");
        }
        assert_eq!(told["turn_deg"].is_null(), !more.is_empty());
    }
}

/// Both flanks, one turn: nothing less makes the space as wide.
#[test]
fn both_flanks_are_fitted_with_one_turn() {
    let file = gauged("fit_both");
    let and = format!("convex={}", path(&file));
    let (told, _) = fit(0, &[PINION, "concave", "--measured", path(&file), "--and", &and, "--vary", VARIED]);
    assert_eq!(told["flanks"].as_array().expect("flanks").len(), 2);
    assert!(number(&told["identification"]["left_um"]) < 1e-6);
    for ((.., value), setting) in CHANGED.iter().zip(told["identification"]["settings"].as_array().expect("settings")) {
        assert!((number(&setting["new"]) - value).abs() < 1e-9, "{setting}");
    }
}

/// One flank of the tooth lies further round: no settings make it so thick, and with the thickness free it does not count.
#[test]
fn the_thickness_of_a_tooth_is_fitted_or_free() {
    const FURTHER: f64 = 2e-3;
    let file = gauged("fit_thickness");
    let steel = std::cell::Cell::new(0.0);
    let turned = rewritten(&file, "further.csv", |place, [x, y, z], [nx, ny, _]| {
        steel.set(steel.get() + x * ny - y * nx);
        let (sine, cosine) = f64::sin_cos(FURTHER);
        plain(place, [x * cosine - y * sine, x * sine + y * cosine, z])
    });
    let and = format!("convex={}", path(&file));
    let asked = [PINION, "concave", "--measured", &turned, "--and", &and, "--vary", VARIED];
    let (fitted, _) = fit(3, &asked);
    assert!(number(&fitted["identification"]["left_um"]) > 1.0 && fitted["thicker_mm"].is_null());
    let (told, _) = fit(0, &[&asked[..], &["--thickness", "free"]].concat());
    assert!(number(&told["identification"]["left_um"]) < 1e-6, "{}", told["identification"]);
    for ((.., value), setting) in CHANGED.iter().zip(told["identification"]["settings"].as_array().expect("settings")) {
        assert!((number(&setting["new"]) - value).abs() < 1e-9, "{setting}");
    }
    // settings change the thickness too: told is what the tooth is thicker than that of the job, before they are fitted
    let (straight, _) =
        fit(0, &[PINION, "concave", "--measured", path(&file), "--and", &and, "--vary", VARIED, "--thickness", "free"]);
    let [thicker, own] = [&told, &straight].map(|told| number(&told["thicker_mm"]));
    let radius = number(&told["turn_mm"]) / number(&told["turn_deg"]).to_radians();
    assert!((thicker - own - radius * FURTHER * steel.get().signum()).abs() < 1e-4, "{thicker} {own} {radius}");
    for (more, says) in [
        (&["--as-it-lies", "--thickness", "free"][..], "--as-it-lies turns nothing"),
        (&["--thickness", "thin"], "write fitted or free"),
    ] {
        let run = flank(&[&["fit"], &asked[..], more].concat());
        assert!(matches!(run.status.code(), Some(1 | 2)) && text(&run.stderr).contains(says), "{}", text(&run.stderr));
    }
    let run = flank(&["fit", PINION, "concave", "--measured", &turned, "--thickness", "free"]);
    assert!(text(&run.stderr).contains("is about two flanks"), "{}", text(&run.stderr));
}

/// What was corrected is a spec; measured again, the flank is what the prediction says.
#[test]
fn the_corrected_spec_cuts_the_predicted_flank() {
    let file = gauged("fit_corrected");
    let project = folder("fit_corrected_project");
    let copied = std::process::Command::new("cp").args(["-r", "specs", path(&project)]).current_dir(top()).status();
    assert!(copied.expect("cp runs").success());
    written(&project, "flank.toml", "");
    let spec = project.join("specs/bevel/pinion_19x62.chain");
    let corrected = project.join("corrected.chain");
    let asked = [path(&spec), "concave", "--measured", path(&file), "--vary", VARIED, "--share", "0.7"];
    let (dry, _) = fit(0, &[&asked[..], &["--write", path(&corrected), "--dry"]].concat());
    assert!(!corrected.exists(), "told, not written");
    let (told, _) = fit(0, &[&asked[..], &["--write", path(&corrected)]].concat());
    let content = std::fs::read_to_string(&corrected).expect("written");
    assert_eq!(dry["corrected"], content.as_str());
    assert!(content.contains("job pinion_19x62_corrected = pinion_19x62(\n"), "{content}");
    assert_eq!(flank(&["fmt", "--check", path(&corrected)]).status.code(), Some(0));
    // 30 % of the deviation stay
    let [before, after] = ["before_um", "predicted_um"].map(|key| number(&told[key]));
    assert!((after - 0.3 * before).abs() < 0.01 * before, "{before} {after}");
    // the machine's error is the same for the corrected settings: the flank that it cuts now
    let out = folder("fit_corrected_again");
    let correction = told["correction"]["settings"].as_array().expect("settings");
    let set: Vec<String> = CHANGED
        .iter()
        .zip(correction)
        .map(|((name, _, value), of)| {
            format!("{name}={} {}", value + number(&of["change"]), of["unit"].as_str().expect("a unit"))
        })
        .collect();
    let mut arguments = vec!["measure", PINION, "--surface", "concave", "--out", path(&out)];
    set.iter().for_each(|value| arguments.extend(["--set", value]));
    assert_eq!(flank(&arguments).status.code(), Some(0));
    let again = out.join("pinion_19x62.grid.csv");
    let (again, _) = fit(3, &[PINION, "concave", "--measured", path(&again), "--vary", "c.edge_radius"]);
    assert!((number(&again["before_um"]) - after).abs() < 0.01 * before, "{} {after}", again["before_um"]);
    // neither over what is read, nor where it could not be used
    let refused = flank(&["fit", path(&spec), "concave", "--measured", path(&file), "--write", path(&spec)]);
    assert_eq!(refused.status.code(), Some(1), "{}", text(&refused.stderr));
    let elsewhere = format!("{}/nowhere/corrected.chain", path(&project));
    let refused = flank(&["fit", path(&spec), "concave", "--measured", path(&file), "--write", &elsewhere]);
    assert!(text(&refused.stderr).contains("there is no folder"), "{}", text(&refused.stderr));
}

/// Without names, settings are taken until the next would do next to nothing; of two that do the same one is.
#[test]
fn settings_are_chosen() {
    let file = gauged("fit_chosen");
    let (told, _) = fit(0, &[PINION, "concave", "--measured", path(&file)]);
    let chosen = names(&told["correction"]["settings"]);
    let candidates: Vec<&str> =
        told["choice"]["candidates"].as_array().expect("names").iter().filter_map(Value::as_str).collect();
    assert!(chosen.len() < candidates.len() && chosen.iter().all(|name| candidates.contains(name)), "{told}");
    assert!(!candidates.contains(&"c.inside_point_radius"), "the inside blades do not touch this flank");
    assert!(number(&told["identification"]["left_um"]) < 0.5);
    assert!(number(&told["choice"]["all_leave_um"]) < number(&told["identification"]["left_um"]));
}

#[test]
fn what_the_points_do_not_tell_is_said() {
    let file = gauged("fit_untold");
    let varied = "cradle_angle,sliding_base,outside_point_radius,radial_distance,work_offset,machine_root_angle,inside_point_radius";
    let (told, stderr) = fit(0, &[PINION, "concave", "--measured", path(&file), "--vary", varied]);
    let untold: Vec<&str> = told["untold"].as_array().expect("sentences").iter().filter_map(Value::as_str).collect();
    assert_eq!(untold.len(), 2, "{untold:?}");
    let says = |part: &str| untold.iter().any(|told| told.contains(part));
    assert!(says("`m.sliding_base` and `c.outside_point_radius`: only their sum shows"), "{untold:?}");
    assert!(says("`m.cradle_angle` and the turn about z: only their sum shows"), "{untold:?}");
    let settings = told["identification"]["settings"].as_array().expect("settings");
    let is_told = |name: &str| settings.iter().any(|of| of["name"] == name && !of["uncertain_by"].is_null());
    assert!(is_told("m.radial_distance") && !is_told("m.sliding_base") && !is_told("m.cradle_angle"), "{told}");
    assert!(stderr.contains("`c.inside_point_radius` does not move concave"), "{stderr}");
    assert!(!names(&told["correction"]["settings"]).contains(&"c.inside_point_radius"));
}

/// No setting of the face hobbed pinion takes a tenth of a micrometre of this ease-off away, and four of them together take all but that. What shows
/// nothing is not promised to show at a finer resolution.
#[test]
fn settings_are_chosen_that_do_something_together() {
    let asked = ["specs/bevel/face_hobbed_pinion.chain", "concave", "--from", "concave"];
    let (told, stderr) = fit(0, &[&asked[..], &["--ease-off", "crowning: 0, 10; bias: 5"]].concat());
    assert!(number(&told["before_um"]) > 3.0 && number(&told["predicted_um"]) < 0.1, "{stderr}");
    assert!(!stderr.contains("no setting takes as much"), "{stderr}");
    assert!(
        names(&told["correction"]["settings"]).len() < told["choice"]["candidates"].as_array().expect("names").len()
    );
    let spur = ["specs/hobbing/spur_gear.chain", "flank_plus", "--from", "flank_plus", "--vary", "r.module"];
    let (told, stderr) = fit(3, &[&spur[..], &["--ease-off", "crowning: 5 lengthwise"]].concat());
    assert!(told["untold"].as_array().expect("words").len() == 1, "{told}");
    assert!(stderr.contains("rank: the 1 of 2 directions") && !stderr.contains("takes in more of them"), "{stderr}");
}

/// Turned by a tooth, it is the same flank, if it may be turned; another flank, too few points, a reversed grid are told.
#[test]
fn grids_that_are_not_those_of_the_flank_are_told() {
    let file = gauged("fit_wrong");
    let (sin, cos) = (360f64 / 19.0).to_radians().sin_cos();
    let next =
        rewritten(&file, "next.csv", |place, [x, y, z], _| plain(place, [x * cos - y * sin, x * sin + y * cos, z]));
    let (told, _) = fit(0, &[PINION, "concave", "--measured", &next, "--vary", VARIED]);
    assert!((number(&told["turn_deg"]) + 360.0 / 19.0).abs() < 0.1, "{}", told["turn_deg"]);
    assert!(number(&told["identification"]["left_um"]) < 1e-6);
    let (_, stderr) = fit(1, &[PINION, "concave", "--measured", &next, "--vary", VARIED, "--as-it-lies"]);
    assert!(stderr.contains("mm beside its nominal point"), "{stderr}");

    let mirrored = rewritten(&file, "mirrored.csv", |place, [x, y, z], _| plain(place, [x, -y, z]));
    let (_, stderr) = fit(1, &[PINION, "concave", "--measured", &mirrored, "--vary", VARIED]);
    assert!(stderr.contains("mm beside its nominal point"), "{stderr}");

    let few = rewritten(&file, "few.csv", |[row, column], at, _| {
        (row < 2 && column < 4).then(|| plain([row, column], at)).flatten()
    });
    let (_, stderr) =
        fit(1, &[PINION, "concave", "--measured", &few, "--rows", "5", "--columns", "9", "--vary", VARIED]);
    assert!(stderr.contains("3 points do not tell 4 unknowns, the turn about z among them"), "{stderr}");

    // from the heel to the toe: deviations alone do not show that, but settings do
    let out = folder("fit_wrong_map");
    let set = ["--set", "m.modified_roll_2c=0.01", "--set", "m.machine_root_angle=15.75 deg"];
    let measured = flank(&[&["measure", PINION, "--surface", "concave", "--out", path(&out)][..], &set].concat());
    assert_eq!(measured.status.code(), Some(0));
    let map = ["deviation", PINION, "concave", "--no-picture", "--measured"];
    let grid = out.join("pinion_19x62.grid.csv");
    assert_eq!(flank(&[&map[..], &[path(&grid), "--out", path(&out)]].concat()).status.code(), Some(0));
    let content = std::fs::read_to_string(out.join("pinion_19x62.concave.measured.deviation.csv")).expect("written");
    let off: Vec<&str> = content
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .filter_map(|line| line.rsplit(',').next())
        .collect();
    let line = |at: usize, column: usize| format!("{},{column},{}\n", at / 9 + 1, off[at]);
    let there: String = (0..45).map(|at| line(at, at % 9 + 1)).collect();
    let back: String = (0..45).map(|at| line(at, 9 - at % 9)).collect();
    let varied = "modified_roll_2c,machine_root_angle,ratio_of_roll";
    let there = written(&out, "there.csv", &format!("row,column,deviation_um\n{there}"));
    fit(0, &[PINION, "concave", "--measured", &there, "--vary", varied]);
    let back = written(&out, "back.csv", &format!("row,column,deviation_um\n{back}"));
    let (_, stderr) = fit(3, &[PINION, "concave", "--measured", &back, "--vary", varied, "--within", "0.1um"]);
    assert!(stderr.contains("with the columns in the other order"), "{stderr}");
}

/// Deviations of a flank with two settings changed, from the tip to the root: other settings make them to a tenth of a micrometre, and it is told
/// all the same, also where a point was not measured. In their own order nothing is told.
#[test]
fn a_reversed_grid_is_told_however_little_is_left() {
    const GEAR: &str = "specs/bevel/gear_19x62.chain";
    let out = folder("fit_reversed");
    let set = ["--set", "m.radial_distance=98 mm", "--set", "c.blade_angle=20.1 deg"];
    let measured = flank(&[&["measure", GEAR, "--surface", "concave", "--out", path(&out)][..], &set].concat());
    assert_eq!(measured.status.code(), Some(0), "{}", text(&measured.stderr));
    let grid = out.join("gear_19x62.grid.csv");
    let vary = ["--vary", "radial_distance,blade_angle"];
    let (told, stderr) = fit(0, &[&[GEAR, "concave", "--measured", path(&grid)], &vary[..]].concat());
    assert!(!stderr.contains("in the other order"), "{stderr}");
    let before = told["flanks"][0]["before_um"].as_array().expect("a grid").iter().map(number).collect::<Vec<f64>>();
    let line = |at: usize| format!("{},{},{}\n", 5 - at / 9, at % 9 + 1, before[at]);
    for (name, left_out) in [("all.csv", None), ("less.csv", Some(20))] {
        let lines: String = (0..45).filter(|at| Some(*at) != left_out).map(line).collect();
        // as spreadsheets write it, with a byte order mark
        let file = written(&out, name, &format!("\u{feff}row,column,deviation_um\n{lines}"));
        let code = if left_out.is_some() { 3 } else { 0 };
        let (told, stderr) = fit(code, &[&[GEAR, "concave", "--measured", &file], &vary[..]].concat());
        assert!(number(&told["identification"]["left_um"]) < 1.0);
        assert!(stderr.contains("note: with the rows in the other order 0.0"), "{stderr}");
        assert_eq!(told["remarks"][0]["kind"], "other_order", "{}", told["remarks"]);
    }
}

/// A point that stands in the file twice is refused with its line; a row that is missing is counted, and the others are fitted; both flanks
/// may stand in one file.
#[test]
fn points_twice_rows_that_miss_and_flanks_in_one_file() {
    let file = gauged("fit_twice");
    let once = rewritten(&file, "once.csv", |place, at, _| plain(place, at));
    let content = std::fs::read_to_string(&once).expect("written");
    let twice = written(
        file.parent().expect("a folder"),
        "twice.csv",
        &(content.clone() + content.lines().nth(6).expect("a line") + "\n"),
    );
    let refused = flank(&["fit", PINION, "concave", "--measured", &twice, "--vary", VARIED]);
    let stderr = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("twice.csv: line 47: row 1, column 6 is there already"), "{stderr}");

    let rows = rewritten(&file, "rows.csv", |place, at, _| if place[0] == 3 { None } else { plain(place, at) });
    let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &rows, "--vary", VARIED]);
    assert!(stderr.contains("not measured: 9 of 45 points of concave"), "{stderr}");
    for ((.., value), setting) in CHANGED.iter().zip(told["identification"]["settings"].as_array().expect("settings")) {
        assert!((number(&setting["new"]) - value).abs() < 1e-9, "{setting}");
    }

    let (told, _) = fit(0, &[PINION, "concave", "--measured", path(&file), "--and", "convex", "--vary", VARIED]);
    assert_eq!(told["flanks"].as_array().expect("flanks").iter().map(|of| number(&of["known"])).sum::<f64>(), 90.0);
    assert!(number(&told["identification"]["left_um"]) < 1e-6);
}

/// Noise without a deviation: no setting is worth a change, or the numbers say that they mean nothing.
#[test]
fn noise_is_not_taken_for_settings() {
    let out = folder("fit_noise");
    assert_eq!(flank(&["measure", PINION, "--surface", "concave", "--out", path(&out)]).status.code(), Some(0));
    let noise = |at: usize| 0.6 * ((at * 7919 % 97) as f64 / 48.0 - 1.0);
    let lines: String = (0..45).map(|at| format!("{},{},{}\n", at / 9 + 1, at % 9 + 1, noise(at))).collect();
    let file = written(&out, "noise.csv", &format!("row,column,deviation_um\n{lines}"));
    let (_, stderr) = fit(0, &[PINION, "concave", "--measured", &file, "--vary", VARIED]);
    assert!(stderr.contains("the changes may mean nothing"), "{stderr}");
    let (told, stderr) = fit(0, &[PINION, "concave", "--measured", &file]);
    let is_told = names(&told["correction"]["settings"]).is_empty() || stderr.contains("the changes may mean nothing");
    assert!(is_told, "{stderr}");
}

/// A deviation that is not above the noise that is said asks for no change, and what no setting does is not taken for one.
#[test]
fn noise_that_is_said_is_kept_to() {
    let out = folder("fit_noise_said");
    let noise = |at: usize| 0.6 * ((at * 7919 % 97) as f64 / 48.0 - 1.0);
    let file = deviating(&out, "noise.csv", noise);
    let (_, stderr) = fit(0, &[PINION, "concave", "--measured", &file, "--vary", VARIED, "--noise", "0.4um"]);
    assert!(stderr.contains("is not larger than the measuring noise of 0.400 um"), "{stderr}");
    let (told, _) = fit(0, &[PINION, "concave", "--measured", &file, "--noise", "0.4um"]);
    assert!(names(&told["correction"]["settings"]).is_empty() && number(&told["choice"]["noise_um"]) == 0.4, "{told}");
    // twenty times as much is no noise
    let file = deviating(&out, "more.csv", |at| 6.0 * (at as f64 / 22.0 - 1.0));
    let (told, _) = fit(3, &[PINION, "concave", "--measured", &file, "--noise", "0.4um", "--within", "0.01um"]);
    assert!(!names(&told["correction"]["settings"]).is_empty(), "{told}");
}

/// The grid of the concave flank with deviations by the place, 5 x 9.
fn deviating(out: &Path, name: &str, off: impl Fn(usize) -> f64) -> String {
    let lines: String = (0..45).map(|at| format!("{},{},{}\n", at / 9 + 1, at % 9 + 1, off(at))).collect();
    written(out, name, &format!("row,column,deviation_um\n{lines}"))
}

/// Slopes alone, where what else deviates is beyond all settings: three settings and the turn make three shapes.
#[test]
fn slopes_are_fitted_alone() {
    let out = folder("fit_order");
    let [row, column] = [|at: usize| at as f64 / 9.0 - 2.0, |at: usize| (at % 9) as f64 - 4.0];
    let waves = |at: usize| if at.is_multiple_of(2) { 3.0 } else { -3.0 };
    let file = deviating(&out, "waves.csv", |at| 2.0 * row(at / 9 * 9) + 0.5 * column(at) + waves(at));
    let asked = [PINION, "concave", "--measured", &file, "--vary", VARIED];
    let (all, _) = fit(3, &asked);
    assert!(number(&all["correction"]["left_um"]) > 2.5, "{}", all["correction"]);
    let (told, _) = fit(0, &[&asked[..], &["--order", "1"]].concat());
    assert_eq!(told["order"], 1);
    for of in [&told["identification"], &told["correction"]] {
        assert!(number(&of["left_um"]) < 1e-6, "{of}");
    }
}

/// Steps of two settings; the third one makes up for them as far as it can.
#[test]
fn corrections_are_multiples_of_steps() {
    let file = gauged("fit_round");
    let asked = [PINION, "concave", "--measured", path(&file), "--vary", VARIED];
    let (exact, _) = fit(0, &asked);
    let (told, _) = fit(0, &[&asked[..], &["--round", "radial_distance=20um,m.work_offset=0.01mm"]].concat());
    let settings = told["correction"]["settings"].as_array().expect("settings");
    for (setting, step) in settings.iter().zip([0.02, 0.01]) {
        let share = number(&setting["new"]) / step;
        assert!((share - share.round()).abs() < 1e-9 && number(&setting["step"]) == step, "{setting}");
        assert!(setting["at_bound"].is_null(), "a step is no end of a range: {setting}");
        assert!(setting["is_rounded"] == true && setting["uncertain_by"].is_null(), "{setting}");
    }
    assert!(settings[2]["step"].is_null() && settings[2]["is_rounded"] == false);
    let run = flank(&[&["fit"], &asked[..], &["--round", "radial_distance=20um,m.work_offset=0.01mm"]].concat());
    let told_to_people = text(&run.stdout);
    let is_said = told_to_people.matches("  rounded\n").count() == 2 && !told_to_people.contains("not determined");
    assert!(is_said, "{told_to_people}");
    for (found, exact) in told["identification"]["settings"].as_array().expect("settings").iter().zip(CHANGED) {
        assert!((number(&found["new"]) - exact.2).abs() < 1e-9, "what was is not rounded: {found}");
    }
    let [rounded, best] = [&told, &exact].map(|told| number(&told["correction"]["left_um"]));
    assert!(best < 1e-2 && rounded > best && rounded < 1.0, "{rounded} {best}");
    // what is identified without steps is met, so that they are the reason
    let (_, stderr) = fit(3, &[&asked[..], &["--round", "radial_distance=2mm", "--within", "0.02um"]].concat());
    let is_told = stderr.contains("steps: m.radial_distance stands on a step of --round");
    assert!(is_told && !stderr.contains("rank:"), "{stderr}");
    for (round, says) in [
        ("nosuch=1um", "names `nosuch`, which does not vary"),
        ("radial_distance=1arcsec", "this step is one in mm"),
        ("radial_distance=1um,m.radial_distance=2um", "names `m.radial_distance` twice"),
        ("radial_distance=0um", "--round"),
    ] {
        let run = flank(&[&["fit"], &asked[..], &["--round", round]].concat());
        assert!(matches!(run.status.code(), Some(1 | 2)), "{round}: {:?}", run.status.code());
        assert!(text(&run.stderr).contains(says), "{round}: {}", text(&run.stderr));
    }
}

/// A machine whose dials have steps: they are kept to without being asked for, also in the spec that is written; other ones may be asked for.
#[test]
fn corrections_are_multiples_of_the_steps_of_the_machine() {
    let file = gauged("fit_steps");
    let project = folder("fit_steps_project");
    let copied = std::process::Command::new("cp").args(["-r", "specs", path(&project)]).current_dir(top()).status();
    assert!(copied.expect("cp runs").success());
    written(&project, "flank.toml", "");
    let text_of_job = std::fs::read_to_string(project.join("specs/bevel/pinion_19x62.chain")).expect("a spec");
    let dialled = "\n/// As its dials show it.\nmachine dialled extends cradle_generator {\n    \
                   param radial_distance : length in 0 mm .. 500 mm step 20 um\n    \
                   param work_offset : length step 0.01 mm = 0 mm\n}\n";
    let of_dialled = text_of_job.replace("= cradle_generator(", "= dialled(");
    assert_ne!(of_dialled, text_of_job, "the job names its machine");
    let spec = written(&project.join("specs/bevel"), "dialled.chain", &(of_dialled + dialled));
    assert_eq!(flank(&["fmt", "--check", &spec]).status.code(), Some(0));
    let corrected = project.join("corrected.chain");
    let asked = [spec.as_str(), "concave", "--measured", path(&file), "--vary", VARIED, "--write", path(&corrected)];
    let (told, _) = fit(0, &asked);
    let settings = told["correction"]["settings"].as_array().expect("settings");
    let content = std::fs::read_to_string(&corrected).expect("written");
    for (setting, step) in settings.iter().zip([0.02, 0.01]) {
        let share = number(&setting["new"]) / step;
        assert!((share - share.round()).abs() < 1e-9 && number(&setting["step"]) == step, "{setting}");
    }
    let of_flags = [PINION, "concave", "--measured", path(&file), "--vary", VARIED];
    let (of_flags, _) = fit(0, &[&of_flags[..], &["--round", "radial_distance=20um,m.work_offset=0.01mm"]].concat());
    for (setting, same) in settings.iter().zip(of_flags["correction"]["settings"].as_array().expect("settings")) {
        assert!((number(&setting["new"]) - number(&same["new"])).abs() < 1e-9, "{setting} {same}");
    }
    assert!(content.contains("m.radial_distance: 97.8") && content.contains(" mm"), "{content}");
    let (finer, _) = fit(0, &[&asked[..6], &["--round", "radial_distance=5um"]].concat());
    assert_eq!(number(&finer["correction"]["settings"][0]["step"]), 0.005);
}

/// A range that ends before the flank is reached: the setting stands at its end, and that is the reason.
#[test]
fn a_setting_stays_within_its_range() {
    let project = folder("fit_range");
    let spec = std::fs::read_to_string(top().join(PINION)).expect("it is shipped");
    let machine = "machine narrow extends cradle_generator { param radial_distance : length in 97.9 mm .. 98 mm }\n";
    let spec = format!("{}\n{machine}", spec.replace("cradle_generator(", "narrow(").replace("../", "specs/"));
    std::os::unix::fs::symlink(top().canonicalize().expect("the repository").join("specs"), project.join("specs"))
        .expect("a link");
    let spec = written(&project, "narrow.chain", &spec);
    let file = gauged("fit_range_grid");
    let (told, stderr) = fit(3, &[&spec, "concave", "--measured", path(&file), "--vary", VARIED, "--within", "0.01um"]);
    let first = &told["identification"]["settings"][0];
    assert_eq!((&first["at_bound"], &first["uncertain_by"]), (&Value::from("high"), &Value::Null));
    assert!((number(&first["new"]) - 98.0).abs() < 1e-12);
    assert!(stderr.contains("not met") && number(&told["identification"]["left_um"]) > 0.01, "{stderr}");
    // where the range does not end for the correction, which goes the other way, it is the reason all the same
    let wider = std::fs::read_to_string(&spec).expect("it was written").replace("97.9 mm .. 98 mm", "90 mm .. 98 mm");
    let spec = written(&project, "wider.chain", &wider);
    let (told, stderr) = fit(3, &[&spec, "concave", "--measured", path(&file), "--vary", VARIED, "--within", "0.01um"]);
    assert!(told["correction"]["settings"][0]["at_bound"].is_null(), "{told}");
    let is_told = stderr.contains("bounds: m.radial_distance stands at the end of its range");
    assert!(is_told && !stderr.contains("rank:"), "{stderr}");
}

#[test]
fn what_does_not_go_together_is_refused() {
    let usage = [
        &["fit", PINION, "concave"][..],
        &["fit", PINION, "concave", "--measured", "a.csv", "--from", "convex"],
        &["fit", PINION, "concave", "--ease-off", "bias: 3"],
        &["fit", PINION, "concave", "--ease-off", "twist: 3", "--from", "convex"],
        &["fit", PINION, "concave", "--measured", "a.csv", "--share", "1.5"],
        &["fit", PINION, "concave", "--measured", "a.csv", "--dry"],
        &["fit", PINION, "concave", "--measured", "a.csv", "--and", "convex="],
        &["fit", PINION, "concave", "--measured", "a.csv", "--keep", "root=point"],
        &["fit", PINION, "concave", "--want", "centred"],
        &["fit", PINION, "--want", "centred", "--measured", "a.csv"],
    ];
    for arguments in usage {
        let run = flank(arguments);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {}", text(&run.stderr));
    }
    let file = gauged("fit_refused");
    for (more, says) in [
        (&["--vary", "nosuch"][..], "has no setting `nosuch`"),
        (&["--vary", "theta_from,c.theta_from"], "names `c.theta_from` twice"),
        (&["--and", "nosuch=a.csv"], "has no surface `nosuch`"),
    ] {
        let run = flank(&[&["fit", PINION, "concave", "--measured", path(&file)], more].concat());
        assert!(matches!(run.status.code(), Some(1 | 2)), "{more:?}");
        assert!(text(&run.stderr).contains(says), "{more:?}: {}", text(&run.stderr));
    }
}

/// With the root line kept, the root lies where it did at both ends of it; without, the same correction lifts or tilts it.
#[test]
fn a_root_line_is_kept() {
    let file = gauged("fit_keep");
    let varied = "radial_distance,machine_root_angle,work_offset,sliding_base,machine_center_to_crossing_point,outside_point_radius";
    let asked = ["concave", "--measured", path(&file), "--vary", varied, "--within", "10um"];
    let (free, _) = fit(0, &[&[PINION][..], &asked].concat());
    let (kept, _) = fit(0, &[&[PINION][..], &asked, &["--keep", "root=line"]].concat());
    let told = &kept["kept"][0];
    assert_eq!((&told["surface"], &told["is_line"]), (&Value::from("root"), &Value::from(true)));
    assert!(number(&told["off_um"]) < 1e-6, "{told}");
    assert!(free["kept"].as_array().is_some_and(Vec::is_empty));
    // of the same correction without it the root tilts: by the settings that move it, the sliding base and the machine centre, it goes elsewhere
    let value = |of: &Value, name: &str| {
        let all = of["correction"]["settings"].as_array().expect("settings").iter();
        all.filter(|of| of["name"] == name).map(|of| number(&of["new"])).next().expect("it varies")
    };
    // a root plane at the machine root angle, the sliding base and the centre's share along the cradle's axis: these make the root line
    let line = |of: &Value| {
        let angle = value(of, "m.machine_root_angle");
        let depth =
            value(of, "m.sliding_base") + value(of, "m.machine_center_to_crossing_point") * angle.to_radians().sin();
        [angle, depth]
    };
    let [nominal_angle, nominal_depth] =
        [15.64096727073747, -0.001306176586991889 * 15.64096727073747f64.to_radians().sin()];
    let [[angle, depth], [free_angle, _]] = [line(&kept), line(&free)];
    assert!((angle - nominal_angle).abs() < 1e-3 && (depth - nominal_depth).abs() < 1e-3, "{angle} {depth}");
    assert!((free_angle - nominal_angle).abs() > 1e-2, "{free_angle}");
}

/// Both flanks with the thickness free, and the root line or the thickness at the mean point kept: what is kept is turned with the first flank,
/// and by how much thicker the tooth was measured changes nothing of the correction.
#[test]
fn what_is_kept_stays_where_the_thickness_is_free() {
    const FURTHER: f64 = 2e-3;
    let file = gauged("fit_keep_free");
    let thicker = rewritten(&file, "further.csv", |place, [x, y, z], _| {
        let (sine, cosine) = f64::sin_cos(FURTHER);
        plain(place, [x * cosine - y * sine, x * sine + y * cosine, z])
    });
    let varied =
        "radial_distance,machine_root_angle,work_offset,sliding_base,machine_center_to_crossing_point,ratio_of_roll";
    let and = format!("convex={}", path(&file));
    let corrected = |measured: &str, more: &[&str]| {
        let asked = [PINION, "concave", "--measured", measured, "--and", &and, "--vary", varied, "--within", "20um"];
        fit(0, &[&asked[..], &["--thickness", "free"], more].concat()).0
    };
    let new = |told: &Value| -> Vec<f64> {
        let settings = told["correction"]["settings"].as_array().expect("settings");
        settings.iter().map(|of| number(&of["new"])).collect()
    };
    for kept in ["root=line", "root"] {
        let [own, other] = [path(&file), &thicker].map(|measured| corrected(measured, &["--keep", kept]));
        for told in [&own, &other] {
            assert!(number(&told["kept"][0]["off_um"]) < 1e-6, "{kept}: {}", told["kept"]);
        }
        for (of, with) in new(&own).into_iter().zip(new(&other)) {
            assert!((of - with).abs() < 1e-8, "{kept}: {of} {with}");
        }
        assert!(number(&other["thicker_mm"]).abs() > 0.05, "{other}");
        // the correction is another one than without it
        let free = corrected(path(&file), &[]);
        assert!(new(&own).iter().zip(new(&free)).any(|(of, with)| (of - with).abs() > 1e-3), "{kept}");
    }
}

/// The job's own file is what is read: that is told, and not that it would use itself.
#[test]
fn the_file_of_the_job_is_not_written_over() {
    let file = gauged("fit_own_file");
    let folder = file.parent().expect("a folder");
    let spec = written(
        folder,
        "own.chain",
        &support::self_contained(&[
            "functions/blanks_19x62",
            "functions/bevel",
            "machines/cradle",
            "tools/face_mill",
            "bevel/pinion_19x62",
        ]),
    );
    let before = std::fs::read_to_string(&spec).expect("written");
    let run = flank(&["fit", &spec, "concave", "--measured", path(&file), "--vary", VARIED, "--write", &spec]);
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("is what this command reads and would be written over") && !told.contains("E0"), "{told}");
    assert_eq!(std::fs::read_to_string(&spec).expect("kept"), before);
}

/// Of a file with several jobs those that the surfaces are named with are built: what is set in another one is told, and a name that is no
/// job's with all there are.
#[test]
fn what_is_set_in_jobs_that_are_not_fitted_is_told() {
    let spec = "specs/bevel/ease_off_19x62.chain";
    let told = |surface: &str, more: &[&str]| {
        let wish = "crowning: 50 um profilewise, 25 um lengthwise; slope: 0, 0; bias: 0";
        let arguments =
            ["fit", spec, surface, "--from", "conjugate.concave", "--ease-off", wish, "--vary", "radial_distance"];
        let run = flank(&[&arguments[..], more].concat());
        (run.status.code(), text(&run.stderr))
    };
    let (code, words) = told("basic.concave", &["--set", "pinion.m.radial_distance=99 mm"]);
    assert!(code == Some(1) && words.contains("none of the jobs `basic`, `conjugate` has a parameter"), "{words}");
    assert!(words.contains("job `pinion` has one, and is not asked for"), "{words}");
    assert_eq!(told("basic.concave", &["--set", "m.radial_distance=97.9 mm"]).0, Some(3));
    let (_, words) = told("bassic.concave", &[]);
    assert!(words.contains("`pinion.concave`, `basic.concave`"), "{words}");
    let (_, words) = told("concave", &[]);
    assert!(words.contains("several jobs have a surface `concave`"), "{words}");
}
