//! `flank convert` as a user runs it.

mod support;

use support::{flank, folder, text};

/// A pinion on the free-form machine: what is printed, and the same as JSON.
#[test]
fn convert_carries_a_job_over() {
    let out = folder("convert");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain"];
    let arguments = [&spec[..], &["--out", out.to_str().unwrap()]].concat();
    let files = ["--nc", "fanuc,siemens,linuxcnc", "--time", "20", "--emit", "c,rust", "--format", "csv,json"];
    let run = flank(&[&arguments[..], &["--tolerance", "0.1um"], &files].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    for extension in ["csv", "json", "nc", "mpf", "ngc", "c", "rs"] {
        let name = format!("pinion_19x62_on_free_form.{extension}");
        assert!(out.join(&name).is_file() && told.contains(&name), "{name}: {told}");
    }
    assert!(told.contains("proven, nowhere more than"), "{told}");
    let head = std::fs::read_to_string(out.join("pinion_19x62_on_free_form.c")).unwrap();
    assert!(head.contains("* proven, over roll from -10.367281 deg to 11.380923 deg: off by at most X 4.0"), "{head}");
    assert!(told.contains("the tool is unchanged by a turn about [0.000000, 0.000000, 1.000000]"), "{told}");
    let run = flank(&[&arguments[..], &["--order", "9", "--positions", "21", "--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    assert_eq!(table["schema"], "flank.convert/2");
    assert_eq!(table["positions"].as_array().unwrap().len(), 21);
    let series = &table["polynomials"];
    let h = table["positions"][20]["motions"][0].as_f64().unwrap().to_radians() - series["reference"].as_f64().unwrap();
    // the last position by the polynomials: what is left is of order ten
    for (k, axis) in table["axes"].as_array().unwrap().iter().enumerate() {
        let coefficients = series["coefficients"][axis["name"].as_str().unwrap()].as_array().unwrap();
        let value = coefficients.iter().rev().fold(0.0, |sum, c| sum * h + c.as_f64().unwrap());
        let value = if axis["unit"] == "deg" { value.to_degrees() } else { value };
        let found = table["positions"][20]["axes"][k].as_f64().unwrap();
        assert!((value - found).abs() < 1e-8, "{}: {value} instead of {found}", axis["name"]);
    }
    let remainders = &series["remainders"];
    for axis in ["X", "Y", "Z", "A", "B", "C"] {
        let [seen, proven] = ["seen", "proven"].map(|key| remainders[key][axis].as_f64().unwrap());
        assert!(seen <= proven && proven < 1.01 * seen + 1e-12, "{axis}: {remainders}");
    }
    let deviations: Vec<f64> =
        series["deviation_mm_by_order"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert!(deviations.len() == 10 && deviations[9] < 1e-8 && deviations[2] > 1e-3, "{deviations:?}");
}

#[test]
fn convert_tells_what_the_other_machine_cannot_do() {
    let out = folder("convert-not");
    let told = |arguments: &[&str], code: i32| {
        let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--out", out.to_str().unwrap(), "--to"];
        let run = flank(&[&spec, arguments].concat());
        assert_eq!(run.status.code(), Some(code), "{}", text(&run.stderr));
        text(&run.stderr)
    };
    let six = "specs/machines/hobbing_6axis.chain";
    assert!(told(&[six], 1).contains("hobbing_6axis has no frame `work` that stands for m.work"));
    let beyond = told(&[six, "--tool-frame", "hob", "--work-frame", "table"], 3);
    assert!(beyond.contains("101 of 101 positions: axis hobbing_6axis.X has to stand at -"), "{beyond}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "what cannot be reached is no program");
    assert!(told(&["specs/tools/rack.chain"], 1).contains("there is no machine in specs/tools/rack.chain"));
    let run = flank(&["convert", "specs/bevel/tilted_pinion.chain", "--to", "specs/machines/free_form.chain"]);
    assert!(text(&run.stderr).contains("has several tools"), "{}", text(&run.stderr));
}

/// The numbers of the printed table, from what this pinion's machine sheet says: without tilt the root angle and the distance of cutter
/// and cradle stay, the work turns by the ratio of roll, the cutter back by the roll.
#[test]
fn printed_axes_are_those_of_the_machine_sheet() {
    let out = folder("convert-table");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain"];
    let run = flank(&[&spec[..], &["--out", out.to_str().unwrap()]].concat());
    let told = text(&run.stdout);
    let numbers = |start: &str| -> Vec<f64> {
        let line = told.lines().find(|line| line.trim_start().starts_with(start)).expect("it is printed");
        line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    let ends = |axis: &str| [numbers(axis)[0], numbers(axis)[1]];
    let over = told.lines().find(|line| line.contains("positions over roll")).expect("it is printed");
    let over: Vec<f64> = over.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let roll = over[2] - over[1];
    // printed to 1e-6
    let near =
        |found: f64, expected: f64| assert!((found - expected).abs() < 4e-6, "{found} instead of {expected}: {told}");
    ends("B ").into_iter().for_each(|root| near(root, 15.64096727073747));
    near(ends("A ")[1] - ends("A ")[0], 3.3396859 * roll);
    near(ends("C ")[1] - ends("C ")[0], roll);
    assert_eq!(over[0], 101.0);
    // the cradle stands in the machine's centre, the slides in the crossing point of the gear's axes: by so much along the work's axis
    let off = 0.001306176586991889;
    let root = 15.64096727073747_f64.to_radians();
    ends("Z ").into_iter().for_each(|z| near(z, -off * root.sin()));
    // X and Y run one way, so that the ends belong together: the smallest X with the largest Y
    let [x, y] = [ends("X ").map(|x| x - off * root.cos()), ends("Y ")];
    [x[0].hypot(y[1]), x[1].hypot(y[0])].into_iter().for_each(|distance| near(distance, 97.95940290780507));
}

/// The paper's path as formulas, and as functions; where there is none, that is told.
#[test]
fn the_explicit_path_is_printed_and_emitted() {
    let to = ["--to", "specs/machines/free_form.chain"];
    let run = flank(&[&["derive", "specs/bevel/tilted_pinion.chain", "--surface", "concave"][..], &to].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    for formula in ["f_z = ", "free_form.A = -atan2(-f_y, -f_x)", "free_form.B = -atan2(f_z, t1)"] {
        assert!(told.contains(formula), "{formula}: {told}");
    }
    let out = folder("convert-exact");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--out", out.to_str().unwrap()];
    let run = flank(&[&spec[..], &to, &["--emit", "c,rust", "--emit-form", "exact,polynomials"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    for name in ["_exact.c", "_exact.rs", ".c", ".rs"] {
        assert!(out.join(format!("pinion_19x62_on_free_form{name}")).is_file(), "{name}");
    }
    let exact = std::fs::read_to_string(out.join("pinion_19x62_on_free_form_exact.c")).unwrap();
    assert!(exact.contains("exact but for rounding") && exact.contains("atan2("), "{exact}");
    let latex = flank(&[&["derive", "specs/bevel/pinion_19x62.chain", "--latex"][..], &to].concat());
    assert!(text(&latex.stdout).contains("f_{x}"), "{}", text(&latex.stdout));
}

#[test]
fn a_tolerance_that_no_order_meets_is_told() {
    let out = folder("convert-unmet");
    let spec = [
        "convert",
        "specs/bevel/pinion_19x62.chain",
        "--to",
        "specs/machines/free_form.chain",
        "--tolerance",
        "1e-13um",
    ];
    let run = flank(&[&spec[..], &["--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stdout));
    let told = text(&run.stderr);
    assert!(told.contains("no order up to 30 keeps the flank within 1.000e-13 um; order "), "{told}");
    assert!(told.contains("nearer than rounding lets it"), "{told}");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "no polynomials were found");
}

/// The pinion of the library with all that it uses, in a folder; its text, to be changed, and where variants of it belong.
fn pinion_in(out: &std::path::Path) -> (String, std::path::PathBuf) {
    let run = flank(&["new", "pinion_19x62", "--out", out.to_str().expect("a plain path")]);
    assert!(run.status.success(), "{}", text_of(&run));
    let here = out.join("bevel");
    (std::fs::read_to_string(here.join("pinion_19x62.chain")).expect("written"), here)
}

/// Where no point says what a polynomial leaves, no tolerance is kept; nothing claims that one is.
#[test]
fn a_tolerance_without_solved_points_is_told() {
    let out = folder("convert-pointless");
    let (job, here) = pinion_in(&out);
    let unsampled = job.split("    // back to the depth").next().expect("a job").to_string() + "}\n";
    let kept = |line: &&str| !line.contains("envelope(") || line.contains("surface concave,");
    let edge: String = unsampled.lines().filter(kept).map(|line| format!("{line}\n")).collect();
    let edge = edge
        .replace("surface concave, concave_fillet in", "surface concave in")
        .replace("envelope(c.outside.blade, c.outside.edge, over: roll)", "sweep(k.edge, over: roll)")
        .replace("    mount c on m.cutter", "    mount c on m.cutter\n    tool k = knife()\n    mount k on m.cutter")
        + "tool knife { surface edge(u: length in 0 mm .. 3 mm) { at = [95 mm, 0 mm, u] body towards [1, 0, 0] } }\n";
    // far outside: no roll and no place on the blade reach it
    let beyond = job.split("    sample concave_fillet").next().expect("a job").to_string() + "}\n";
    let beyond = beyond
        .replace("toe_root_1()", "[992 mm, 925 mm]")
        .replace("heel_root_1()", "[1027 mm, 935 mm]")
        .replace("toe_tip_1()", "[990 mm, 930 mm]")
        .replace("heel_tip_1()", "[1025 mm, 943 mm]");
    for (name, text, is_asked) in [("unsampled", &unsampled, false), ("edge", &edge, false), ("beyond", &beyond, true)]
    {
        let job = support::written(&here, &format!("{name}.chain"), text);
        let files = out.join(name);
        let files_there = || std::fs::read_dir(&files).map_or(0, Iterator::count);
        let to = [
            "--to",
            "specs/machines/free_form.chain",
            "--time",
            "20",
            "--nc",
            "fanuc",
            "--out",
            files.to_str().unwrap(),
        ];
        let run = flank(&[&["convert", &job, "--tolerance", "0.1um"][..], &to].concat());
        let told = text_of(&run);
        assert_eq!(run.status.code(), Some(3), "{name}: {told}");
        assert!(told.contains("no order is known to keep the flank within 1.000e-1 um"), "{name}: {told}");
        assert!(!told.contains("off by up to 0.000000 um"), "{name}: {told}");
        assert_eq!(told.contains("not solved: 465 of 465 points of concave\n"), is_asked, "{name}: {told}");
        assert_eq!(files_there(), 0, "{name}");
        // an order that is said is taken; points that are asked for and not solved are told all the same
        let run = flank(&[&["convert", &job, "--order", "6"][..], &to].concat());
        assert_eq!(run.status.code(), Some(if is_asked { 3 } else { 0 }), "{name}: {}", text_of(&run));
        assert_eq!(files_there(), 2, "{name}");
    }
}

fn text_of(run: &std::process::Output) -> String {
    text(&run.stdout) + &text(&run.stderr)
}

/// Points that the job's own machine does not reach are told as `flank solve` tells them.
#[test]
fn points_that_are_not_solved_are_told() {
    let out = folder("convert-unsolved");
    let (job, here) = pinion_in(&out);
    let job = support::written(&here, "job.chain", &job.replace("-20 deg .. 20 deg", "-20 deg .. 5 deg"));
    let at = ["--out", out.to_str().unwrap()];
    let solved = flank(&[&["solve", &job, "--no-picture"][..], &at].concat());
    assert_eq!(solved.status.code(), Some(3));
    let told = text(&solved.stderr);
    let from = told.find("not solved: ").expect("some are not");
    let of_concave = told[from..].split_inclusive('\n').take(4).collect::<String>();
    assert!(of_concave.starts_with("not solved: ") && of_concave.contains(" points of concave\n"), "{told}");
    let to = ["--to", "specs/machines/free_form.chain"];
    let run = flank(&[&["convert", &job][..], &to, &at].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text_of(&run));
    assert!(text(&run.stderr).contains(&of_concave), "{}\n{told}", text(&run.stderr));
    let run = flank(&[&["convert", &job, "--json"][..], &to, &at].concat());
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(table["not_done"][0]["kind"], "not_solved", "{}", table["not_done"]);
    assert_eq!(table["not_done"][0]["of"], "concave");
    let run = flank(&["convert", &job, "--to", out.join("machines/cradle.chain").to_str().unwrap(), "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(found["not_done"][0]["kind"], "not_solved", "{}", found["not_done"]);
    assert_eq!(found["not_done"][0]["of"], "concave");
    let run = flank(&[&["derive", &job, "--surface", "concave"][..], &to].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text_of(&run));
    assert!(text(&run.stdout).contains("pinion_19x62 on free_form"), "{}", text_of(&run));
    assert!(text(&run.stderr).contains(&of_concave), "{}\n{told}", text(&run.stderr));
    let run = flank(&[&["derive", &job, "--surface", "concave", "--json"][..], &to].concat());
    let page: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(page["not_done"][0]["kind"], "not_solved", "{}", page["not_done"]);
    assert_eq!(page["not_done"][0]["of"], "concave");
}

/// What is only made of one motion is not passed over in silence where a job has two.
#[test]
fn a_tolerance_over_two_motions_is_told() {
    let out = folder("convert-two");
    let job = ["convert", "specs/hobbing/helical_gear.chain", "--to", "specs/machines/hobbing_6axis.chain"];
    let asked = ["--tolerance", "1um", "--emit", "c", "--out", out.to_str().unwrap()];
    let run = flank(&[&job[..], &asked].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(3), "{told}");
    assert!(
        told.contains("nothing is done for --tolerance, --out, --emit: the job runs over spindle and feed"),
        "{told}"
    );
}

/// At a constant rate velocities are differences of positions in the limit; here of 1,001 of them, which the mean of the ends of each
/// step meets to the third order.
#[test]
fn rates_are_those_of_the_positions() {
    let out = folder("convert-rates");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain", "--time", "20"];
    let run = flank(&[&spec[..], &["--positions", "1001", "--json", "--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("JSON");
    let rate = |row: usize, axis: usize, order: usize| table["rates"]["positions"][row][axis][order].as_f64().unwrap();
    let position = |row: usize, axis: usize| table["positions"][row]["axes"][axis].as_f64().unwrap();
    let step = 20.0 / 1000.0;
    for row in (0..1000).step_by(37) {
        for axis in 0..6 {
            let moved = [
                position(row + 1, axis) - position(row, axis),
                rate(row + 1, axis, 0) - rate(row, axis, 0),
                rate(row + 1, axis, 1) - rate(row, axis, 1),
            ];
            for (order, moved) in moved.into_iter().enumerate() {
                let mean = 0.5 * (rate(row, axis, order) + rate(row + 1, axis, order));
                // (0.02 s)² / 12 of the third derivative of each, which is below 1e-3 per s³
                assert!((moved / step - mean).abs() < 4e-8, "{row} {axis} {order}: {} {mean}", moved / step);
            }
        }
    }
    let most = table["rates"]["most"]["X"][0].as_f64().unwrap();
    let largest = (0..=1000).map(|row| rate(row, 0, 0).abs()).fold(0.0, f64::max);
    assert_eq!(most, largest);
}

/// The work's axis stands at 145 to 219 degrees, and whole turns more or less: travels beyond half a turn hold that.
#[test]
fn a_rotary_travel_beyond_half_a_turn_is_used() {
    let out = folder("convert-turns");
    let free_form = support::self_contained(&["machines/free_form"]);
    for (low, high) in [(140.0, 230.0), (500.0, 590.0), (-230.0, -130.0)] {
        let machine =
            format!("{free_form}machine far extends free_form {{ axis A : rotary in {low} deg .. {high} deg }}\n");
        let target = support::written(&out, "target.chain", &machine);
        let job =
            ["convert", "specs/bevel/pinion_19x62.chain", "--to", &target, "--json", "--out", out.to_str().unwrap()];
        let run = flank(&job);
        assert_eq!(run.status.code(), Some(0), "{low} .. {high}: {}", text(&run.stderr));
        let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let axis = table["axes"].as_array().unwrap().iter().find(|axis| axis["name"] == "A").expect("an axis");
        let [from, to] = ["low", "high"].map(|end| axis[end].as_f64().unwrap());
        assert!(low <= from && to <= high, "{axis}");
    }
}

/// What no machine can do is told in words, with the place.
#[test]
fn bad_targets_are_told() {
    let out = folder("convert-bad");
    let told = |job: &str, machine: &str, frames: &[&str]| {
        let target = support::written(&out, "target.chain", machine);
        let job = if job.ends_with(".chain") { job.to_string() } else { support::written(&out, "job.chain", job) };
        let run = flank(&[&["convert", &job, "--to", &target, "--out", out.to_str().unwrap()], frames].concat());
        assert!(matches!(run.status.code(), Some(1 | 3)), "{}", text(&run.stdout));
        text(&run.stderr)
    };
    let pinion = "specs/bevel/pinion_19x62.chain";
    let free_form = support::self_contained(&["machines/free_form"]);
    // without B the cutter's axis cannot be met
    let told_of = told(pinion, &format!("{free_form}machine stiff extends free_form {{ fix B = 20 deg }}\n"), &[]);
    assert!(told_of.contains("stiff has no axis that moves the tool about the tool's own"), "{told_of}");
    assert!(told_of.contains("deg are missing, at roll = "), "{told_of}");
    // a cutter of 95 mm radius on a small slide
    let small = format!("{free_form}machine small extends free_form {{ axis Y : linear in -40 mm .. 40 mm }}\n");
    let told_of = told(pinion, &small, &[]);
    assert!(told_of.contains("axis small.Y has to stand at 8"), "{told_of}");
    assert!(told_of.contains("beyond its travel (the tool cuts at a radius of up to 9"), "{told_of}");
    // two motions, one axis
    let one = "machine one { axis X : linear frame bed frame hob in bed = translate_x(X) frame table in bed = rotate_z(0 deg) }\n";
    let told_of = told("specs/hobbing/helical_gear.chain", one, &[]);
    assert!(told_of.contains("runs over spindle and feed, each by itself, and one has only X to follow"), "{told_of}");
    // no axis at all
    let none = "machine none { axis X : linear fix X = 1 mm frame bed frame cutter in bed = translate_x(X) frame work in bed = rotate_z(0 deg) }\n";
    assert!(told(pinion, none, &[]).contains("no axis of none moves the tool against the work"));
}

/// The thesis gear's cutter points 165.6638 deg away from the work's axis. A head that nutates about an axis at 45 degrees turns its
/// spindle by 90 at most: 75.6638 are missing. A fork head gets there, and stands beyond its travel in two axes.
#[test]
fn directions_beyond_reach_and_all_axes_beyond_travel_are_told() {
    let out = folder("convert-directions");
    let told = |target: &str| {
        let run = flank(&["convert", "specs/bevel/thesis_gear.chain", "--to", target, "--out", out.to_str().unwrap()]);
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
        (text(&run.stdout), text(&run.stderr))
    };
    let nutating = "machine nutating {
        axis X : linear
        axis Y : linear
        axis Z : linear
        axis B : rotary
        axis C : rotary
        frame ground
        frame cross in ground = translate(-X, -Y, 0 mm)
        frame work in cross = rotate_z(-C)
        frame ram in ground = translate_z(Z)
        frame head in ram = rotate([0, 1, 1], B)
        frame cutter in head = translate_z(-180 mm) rotate_x(180 deg)
    }";
    let (printed, told_of) = told(&support::written(&out, "nutating.chain", nutating));
    let missing = "101 of 101 positions: the tool's axis cannot point there: 75.6638 deg are missing, wherever B, C of nutating stand";
    assert!(told_of.contains(missing), "{told_of}");
    assert!(!printed.contains("travel"), "no positions: {printed}");
    let (_, told_of) = told("specs/machines/five_axis_head_table.chain");
    // 174 of 900 mm are a larger share than 46 of 240 degrees
    let both = told_of.find("head_table.Z has to stand at -473.8846 mm, 173.8846 mm beyond");
    let second = told_of.find("head_table.B has to stand at 165.6638 deg, 45.6638 deg beyond");
    assert!(both.is_some() && both < second, "{told_of}");
}

/// A shaped gear and its cutter turn about parallel axes: two axes of the free-form machine do the same.
#[test]
fn a_singular_pose_is_told_with_its_place() {
    let out = folder("convert-singular");
    let job = ["convert", "specs/hobbing/shaped_gear.chain", "--job", "shaped_gear", "--out", out.to_str().unwrap()];
    let to = ["--to", "specs/machines/free_form.chain", "--tool-frame", "cutter", "--work-frame", "work"];
    let run = flank(&[&job[..], &to].concat());
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(3), "{told}{}", text(&run.stdout));
    assert!(told.contains("free_form stands in a singular pose: "), "{told}");
    assert!(told.contains("A, C can move together without moving the tool"), "{told}");
    assert!(told.contains("at roll = "), "{told}");
    // one of them is enough, and five axes meet these poses
    let fixed =
        support::self_contained(&["machines/free_form"]) + "machine still extends free_form { fix C = 0 deg }\n";
    let fixed = support::written(&out, "still.chain", &fixed);
    let run = flank(&[&job[..], &["--to", &fixed, "--tool-frame", "cutter", "--work-frame", "work"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}

/// The rates that are printed, from the circle on which the cutter goes: without tilt, X and Y turn evenly about the machine's centre.
#[test]
fn printed_rates_are_those_of_an_even_turn() {
    let out = folder("convert-rates");
    let spec = ["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain", "--time", "20"];
    let run = flank(&[&spec[..], &["--out", out.to_str().unwrap()]].concat());
    let told = text(&run.stdout);
    let (positions, rates) = told.split_once("velocity").expect("rates are printed");
    let numbers = |part: &str, axis: &str| -> Vec<f64> {
        let line = part.lines().find(|line| line.trim_start().starts_with(axis)).expect("it is printed");
        line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
    };
    let near = |found: &[f64], expected: [f64; 3]| {
        // printed to 1e-6
        let is_near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 2e-6);
        assert!(is_near && found.len() == 3, "{found:?} instead of {expected:?}: {told}");
    };
    let cutter = numbers(positions, "C ");
    let turn = (cutter[1] - cutter[0]) / 20.0;
    near(&numbers(rates, "C "), [turn, 0.0, 0.0]);
    near(&numbers(rates, "A "), [3.339685914944047 * turn, 0.0, 0.0]);
    let per_second = turn.to_radians();
    let centre = 0.001306176586991889 * 15.64096727073747_f64.to_radians().cos();
    // both run one way, through positive values: the largest are at the end
    let (x, y) = (numbers(positions, "X ")[1] - centre, numbers(positions, "Y ")[1]);
    near(&numbers(rates, "X "), [y * per_second, x * per_second.powi(2), y * per_second.powi(3)]);
    near(&numbers(rates, "Y "), [x * per_second, y * per_second.powi(2), x * per_second.powi(3)]);
}

/// A rack planer with a slide that the job drives, and one without it, whose Y and C are those of the former.
const PLANERS: [&str; 2] = [
    "machine planer {
        axis X : linear
        axis Y : linear in -60 mm .. 60 mm
        axis C : rotary
        frame bed
        frame slide in bed = translate(40 mm + X, Y, 0 mm)
        frame table in bed = rotate_z(C)
    }
    tool rack {
        surface flank(u: length in -4 mm .. 4 mm, v: length in -10 mm .. 10 mm) {
            at = [-u * cos(20 deg), -u * sin(20 deg), v]
            body towards [0, -1, 0]
        }
    }
    job planed {
        machine m = planer
        tool r = rack
        mount r on m.slide
        motion roll : angle in -40 deg .. 40 deg
        drive m.C = roll
        drive m.Y = 40 mm * roll
        surface flank in m.table = envelope(r.flank, over: roll)
    ",
    "machine small {
        axis Y : linear in -60 mm .. 60 mm
        axis C : rotary
        frame bed
        frame slide in bed = translate(40 mm, Y, 0 mm)
        frame table in bed = rotate_z(C)
    }",
];

/// What is printed, what is told, and the exit code of a job of [`PLANERS`] with further statements, carried over.
fn planed(name: &str, statements: &str, arguments: &[&str]) -> (String, String, Option<i32>) {
    let out = folder(name);
    let job = support::written(&out, "job.chain", &format!("{}{statements}\n}}\n", PLANERS[0]));
    let machine = support::written(&out, "machine.chain", PLANERS[1]);
    let files = ["convert", &job, "--to", &machine, "--out", out.to_str().expect("a plain path")];
    let run = flank(&[&files[..], arguments].concat());
    let programs = std::fs::read_dir(&out).expect("the test's folder").count() - 2;
    assert_eq!(programs > 0, run.status.code() == Some(0), "files only of what is done: {}", text(&run.stderr));
    (text(&run.stdout), text(&run.stderr), run.status.code())
}

/// Also where the other machine has no axis for what is no number.
#[test]
fn a_pose_that_is_no_number_is_met_by_none() {
    let drive = "drive m.X = 1 mm * sqrt(roll / 1 rad - 0.01)";
    let (printed, told, code) = planed("convert-undefined", drive, &["--nc", "linuxcnc", "--time", "5"]);
    assert_eq!(code, Some(3), "{printed}{told}");
    let what =
        "51 of 101 positions: where m.slide stands against m.table is no number: an axis of the job is driven by what";
    assert!(told.contains(what), "{told}");
    assert!(!printed.contains("proven"), "{printed}");
}

/// One circle, or one line of contact, of the flank needs the motion at one value, where a machine would stand still.
#[test]
fn points_of_one_line_of_contact_are_made_by_all_of_the_motion() {
    let samples = [
        "sample flank { roll: 3 deg, v: -9 mm .. 9 mm by 25 }",
        "sample flank { rho: 41.966 mm, z: -9 mm .. 9 mm by 5 }",
        "sample flank { rho: 41.566 mm, z: -9 mm .. 9 mm by 5 }",
    ];
    for sample in samples {
        let statements = format!("drive m.X = 0 mm\n{sample}");
        let (printed, told, code) = planed("convert-still", &statements, &["--positions", "9"]);
        assert_eq!(code, Some(0), "{told}");
        let over = "9 positions over roll from -40.000000 deg to 40.000000 deg\nthat is all of it: the sampled points are all made at roll = ";
        assert!(printed.contains(over), "{printed}");
    }
}

#[test]
fn a_time_in_which_nothing_can_move_is_told() {
    let (_, told, code) = planed("convert-instant", "drive m.X = 0 mm", &["--time", "1e-300"]);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("in 1e-300 s (--time) the axes would be faster than numbers go"), "{told}");
}

/// What rounding leaves of a coefficient that is none reads as none; the file has its bits.
#[test]
fn coefficients_that_are_rounding_are_shown_as_zero() {
    let out = folder("convert-zero");
    let spec = ["convert", "specs/hobbing/spur_gear.chain", "--to", "specs/machines/hobbing_6axis.chain"];
    let run = flank(&[&spec[..], &["--format", "json", "--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told = text(&run.stdout);
    let coefficient = |of: &str| -> String {
        let line = told.lines().find(|line| line.trim_start().starts_with(of)).expect("it is printed");
        line.split_whitespace().last().expect("a number").to_string()
    };
    assert_eq!([coefficient("Y 1"), coefficient("Z 1")], ["0", "0"], "{told}");
    assert_eq!(coefficient("X 1"), "3.660000000000000e1");
    assert!(!told.contains("0.000e0"), "{told}");
}

/// Edges are carried over as far as the points that they sweep need it, as faces are: not over all that the motions could do.
#[test]
fn a_swept_surface_is_carried_over_as_far_as_its_points_need() {
    let spec = "specs/hobbing/shaped_gear.chain";
    let to = ["--job", "shaped_internal_gear", "--to", "specs/machines/hobbing_6axis.chain"];
    let run = flank(&[&["convert", spec][..], &to].concat());
    let told = text_of(&run);
    // the sample is 20 mm wide
    assert!(told.contains("stroke from -10.000000 mm to 10.000000 mm"), "{told}");
}

/// What leads from the work to the tool on a machine with a mirrored work frame is no motion on one without: that is told before anything is
/// solved, and not as a direction that cannot be reached.
#[test]
fn machines_of_opposite_hand_are_told() {
    let out = folder("convert-hand");
    let free_form = support::self_contained(&["machines/free_form"]);
    let renamed = free_form.replace("frame work", "frame right_hand").replace("expect work", "expect right_hand");
    let mirrored =
        format!("{renamed}machine other_hand extends free_form {{ frame work in right_hand = mirror_z() }}\n");
    let target = support::written(&out, "mirrored.chain", &mirrored);
    let run = flank(&["convert", "specs/bevel/pinion_19x62.chain", "--to", &target, "--json"]);
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("other_hand is of the other hand") && !told.contains("deg are missing"), "{told}");
    assert!(!text(&run.stdout).contains("solved"), "{}", text(&run.stdout));
}
