//! `flank plot` as a user runs it: which pictures there are, what they show, and what is said of those that do not fit.

mod support;

use support::{flank, folder, text};

/// Texts of an SVG, as a screen reader finds them.
fn labels(path: &std::path::Path) -> Vec<String> {
    let svg = std::fs::read_to_string(path).expect("the picture is there");
    let document = roxmltree::Document::parse(&svg).expect("well-formed XML");
    document.descendants().filter_map(|node| node.attribute("aria-label")).map(str::to_owned).collect()
}

/// Draws into a folder of its own and gives the texts of one picture.
fn plotted(name: &str, arguments: &[&str], file: &str) -> Vec<String> {
    let out = folder(name);
    let path = out.to_str().expect("a plain path");
    let run = flank(&[&["plot"], arguments, &["--format", "svg", "--out", path]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    labels(&out.join(file))
}

fn has(labels: &[String], wanted: &[&str]) {
    for wanted in wanted {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
}

#[test]
fn without_a_wish_there_are_the_three_that_matter() {
    let out = folder("plot_defaults");
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--json", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((&table["schema"], &table["job"]), (&"flank.plot/2".into(), &"spur_gear".into()));
    let pictures = table["pictures"].as_array().expect("pictures");
    let kinds: Vec<&str> = pictures.iter().map(|one| one["what"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["surface", "section", "contact-lines"]);
    for picture in pictures {
        assert!(picture["shows"].as_str().unwrap().len() > 5);
        let files = picture["files"].as_array().unwrap();
        assert_eq!(files.len(), 2);
        for file in files {
            assert!(std::fs::metadata(file.as_str().unwrap()).unwrap().len() > 1000, "{file}");
        }
    }
}

#[test]
fn each_kind_says_what_it_shows() {
    let out = folder("plot_kinds");
    let kinds = "gear,surface,curvature,sensitivity,residual,contact-lines,section,machine,motion";
    let run = flank(&[
        "plot",
        "specs/bevel/pinion_19x62.chain",
        "--what",
        kinds,
        "--of",
        "m.radial_distance",
        "--format",
        "svg",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let of = |kind: &str| labels(&out.join(format!("pinion_19x62.{kind}.svg")));
    has(&of("surface"), &["concave", "convex", "root", "tip", "toe", "heel", "z axis"]);
    has(&of("gear"), &["3 of 19 teeth", "tip diameter", "74.107 mm", "tooth thickness there", "concave_fillet"]);
    has(&of("curvature"), &["k1", "k2", "Gaussian curvature", "mean curvature", "1/mm\u{b2}", "toe", "heel"]);
    has(&of("sensitivity"), &["radial distance, \u{b5}m per mm", "m.radial_distance on concave", "root", "tip"]);
    has(&of("residual"), &["residual", "mm or mm/rad", "lengthwise, mm", "profilewise, mm"]);
    has(&of("contact-lines"), &["roll", "concave, deg; in the axial plane", "0", "toe", "heel"]);
    has(&of("section"), &["concave", "root", "convex_fillet", "mm, towards the tip"]);
    has(&of("machine"), &["cradle in bed", "cutter in swivel", "work", "97.959 mm", "about \u{2212}x"]);
    has(&of("motion"), &["cradle, rotary", "work, rotary", "roll", "3.3397 deg per deg", "stands still"]);
}

/// A gear ratio only multiplies what turns, so it is no link of its own; an angle that follows from a number of teeth is told as such.
#[test]
fn numbers_are_no_turns_of_a_machine() {
    let folder = folder("plot_counts");
    let spec = folder.join("indexed.chain");
    let text = "
machine planer {
    param teeth : count
    param index : count
    param height : length
    param swing : angle
    axis Y : linear
    axis C : rotary
    frame bed
    frame ram   in bed = translate(height * teeth, Y, 0 mm) rotate_x(swing * index)
    frame table in bed = rotate_z(C / teeth) rotate_z(index * 360 deg / teeth)
}
tool rack {
    surface flank(u: length in -3 mm .. 3 mm, v: length in -10 mm .. 10 mm) {
        at = [u * cos(20 deg), -u * sin(20 deg), v]
        body towards [0, 1, 0]
    }
}
job spur_gear {
    machine m = planer(teeth: 24, index: 3, height: 1.5 mm, swing: 0 deg)
    tool    r = rack
    mount r on m.ram
    motion roll : angle in -30 deg .. 30 deg
    drive m.Y = 36 mm * roll
    drive m.C = 24 * roll
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 36 mm .. 37 mm by 3, z: -5 mm .. 5 mm by 3 }
}";
    std::fs::write(&spec, text).unwrap();
    let arguments = [spec.to_str().unwrap(), "--what", "machine"];
    let found = plotted("plot_counts_drawn", &arguments, "spur_gear.machine.svg");
    has(&found, &["height", "36.000 mm", "swing", "0.000 deg", "follows from teeth, index", "45.000 deg"]);
    assert!(!found.iter().any(|label| label == "teeth" || label.contains("height, teeth")), "{found:?}");
    assert_eq!(found.iter().filter(|label| label.contains("teeth")).count(), 1, "{found:?}");
}

/// The radial distance moves the flank as `flank solve --sensitivity` says; of others there is a list.
#[test]
fn sensitivity_is_to_what_is_named() {
    let arguments = ["specs/bevel/pinion_19x62.chain", "--what", "sensitivity"];
    let found = plotted("plot_most", &arguments, "pinion_19x62.sensitivity.svg");
    has(&found, &["outside point radius, \u{b5}m per mm", "work offset, \u{b5}m per mm"]);
    let run = flank(&[&["plot"], &arguments[..], &["--of", "m.nothing"]].concat());
    assert_eq!(run.status.code(), Some(1));
    let told = text(&run.stderr);
    assert!(told.contains("no parameter or setting `m.nothing`") && told.contains("m.radial_distance"), "{told}");
}

#[test]
fn surfaces_are_chosen_by_name() {
    let arguments = [
        "specs/hobbing/spur_gear.chain",
        "--what",
        "contact-lines",
        "--surface",
        "flank_minus,flank_plus",
        "--no-origin",
    ];
    let found = plotted("plot_surfaces", &arguments, "spur_gear.contact-lines.svg");
    assert!(!found.iter().any(|label| label.contains("hash")), "{found:?}");
    has(&found, &["flank_minus, deg; in the axial plane, upwards 5 times larger", "lower face", "upper face"]);
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--surface", "flank"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("there is no surface `flank`"), "{}", text(&run.stderr));
}

#[test]
fn a_comparison_is_a_map_and_a_topography() {
    let out = folder("plot_comparison");
    let arguments =
        ["plot", "specs/bevel/ease_off_19x62.chain", "--surface", "pinion.concave", "--reference", "conjugate.concave"];
    let run = flank(&[&arguments[..], &["--format", "svg", "--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    for kind in ["deviation", "topography"] {
        let found = labels(&out.join(format!("pinion.concave.{kind}.svg")));
        has(&found, &["pinion.concave from conjugate.concave", "deviation of concave", "toe", "heel", "\u{b5}m"]);
    }
    let run = flank(&[&arguments[..], &["--what", "section"]].concat());
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("what fits with --reference: deviation, topography"), "{}", text(&run.stderr));
}

/// The teeth of a face gear stand along its axis: no circle about that is the one of their tips. Those of a bevel gear of 73 degrees have circles.
#[test]
fn circles_of_a_section_are_those_of_tips_and_roots() {
    let out = folder("plot_circles");
    let section = |spec: &str, job: &str| {
        let run = flank(&["plot", spec, "--what", "section", "--out", out.to_str().expect("a plain path")]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        std::fs::read_to_string(out.join(format!("{job}.section.svg"))).expect("drawn")
    };
    assert!(!section("specs/hobbing/face_gear.chain", "face_gear").contains(" circle, "));
    for (spec, job) in [("specs/hobbing/spur_gear.chain", "spur_gear"), ("specs/bevel/gear_19x62.chain", "gear_19x62")]
    {
        let drawn = section(spec, job);
        assert!(drawn.contains("tip circle, Ø ") && drawn.contains("root circle, Ø "), "{job}");
    }
}

#[test]
fn what_does_not_fit_says_why_and_what_does() {
    let cases = [
        ("specs/hobbing/spur_gear.chain", "left", "the job does not say with `cut … by …` which edges"),
        ("specs/bevel/formate_gear.chain", "contact-lines", "stands still while it makes"),
        ("specs/bevel/formate_gear.chain", "section", "stands still while it makes"),
        ("specs/bevel/formate_gear.chain", "motion", "nothing moves while"),
        ("specs/double_envelope/shaped_ring_gear.chain", "section", "is an envelope itself"),
        ("tests/surfaces/specs/ring_by_equation.chain", "section", "is given by an equation"),
    ];
    for (spec, kind, why) in cases {
        let run = flank(&["plot", spec, "--what", kind]);
        assert_eq!(run.status.code(), Some(1), "{spec} {kind}");
        let told = text(&run.stderr);
        assert!(told.contains(&format!("--what {kind} does not fit job")) && told.contains(why), "{told}");
        assert!(told.contains("what fits: ") && told.contains("surface") && told.contains("machine"), "{told}");
    }
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--what", "deviation"]);
    assert!(
        text(&run.stderr).contains("takes a second surface: --surface NAME --reference OTHER"),
        "{}",
        text(&run.stderr)
    );
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--size", "12"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("for example 2400x1800"), "{}", text(&run.stderr));
}

/// A map has its values in numbers at five by nine points, and what sums them up beside its name.
#[test]
fn a_map_of_deviations_has_its_numbers() {
    let arguments = [
        "specs/bevel/ease_off_19x62.chain",
        "--what",
        "deviation",
        "--surface",
        "pinion.concave",
        "--reference",
        "conjugate.concave",
    ];
    let found = plotted("plot_numbers", &arguments, "pinion.concave.deviation.svg");
    // as `flank deviation` prints them
    has(&found, &["root to tip: slope \u{2212}160.36 \u{b5}m, crowning 30.01 \u{b5}m", "bias \u{2212}84.00 \u{b5}m"]);
    // the lowest and the middle one are among the 45
    has(&found, &["\u{2212}345", "0"]);
    let is_number = |label: &&String| {
        label.trim_start_matches('\u{2212}').parse::<i32>().is_ok_and(|x| x.abs() > 9 && x % 100 != 0)
    };
    assert!(found.iter().filter(is_number).count() > 30, "{found:?}");
}

/// A flank without an involute has no topography but against another one.
#[test]
fn a_topography_is_no_plane() {
    let run = flank(&["plot", "specs/bevel/pinion_19x62.chain", "--what", "topography"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("no involute: say with --reference"), "{}", text(&run.stderr));
    let spur = ["specs/hobbing/spur_gear.chain", "--what", "topography"];
    has(&plotted("plot_involute", &spur, "spur_gear.topography.svg"), &["deviation from the involute"]);
}

/// The traces of a gear that is crowned by the path of its hob.
#[test]
fn traces_have_their_evaluation() {
    let found =
        plotted("plot_traces", &["specs/hobbing/crowned_gear.chain", "--what", "traces"], "crowned_gear.traces.svg");
    has(&found, &["lower_flank, profile", "upper_flank, helix", "length of roll, mm", "z, mm"]);
    assert_eq!(
        found.iter().filter(|label| label.starts_with("F\u{3b2} ") && label.contains("C\u{3b2} ")).count(),
        2,
        "{found:?}"
    );
    let run = flank(&["plot", "specs/bevel/pinion_19x62.chain", "--what", "traces"]);
    assert!(text(&run.stderr).contains("no flank of a cylindrical gear"), "{}", text(&run.stderr));
}

/// The same picture at each run, to the byte.
#[test]
fn pictures_are_the_same_at_each_run() {
    let files = ["first", "second"].map(|name| {
        let out = folder(&format!("plot_{name}"));
        let run = flank(&[
            "plot",
            "specs/hobbing/helical_gear.chain",
            "--what",
            "section,machine,contact-lines",
            "--size",
            "800x600",
            "--format",
            "png",
            "--out",
            out.to_str().unwrap(),
        ]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        ["section", "machine", "contact-lines"]
            .map(|kind| std::fs::read(out.join(format!("helical_gear.{kind}.png"))).unwrap())
    });
    assert!(files[0] == files[1]);
}

/// What fits is told whatever it takes to draw it.
#[test]
fn what_fits_includes_what_takes_more_to_know() {
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--what", "left"]);
    let told = text(&run.stderr);
    let fits = told.lines().find(|line| line.starts_with("what fits: ")).expect("a list").to_string();
    assert!(fits.contains("curvature") && fits.contains("sensitivity") && !fits.contains("deviation"), "{fits}");
}

/// Points that are not on a picture are told as elsewhere, with the same exit code.
#[test]
fn what_is_not_solved_is_told() {
    let out = folder("plot_unsolved");
    let arguments = ["specs/hobbing/undercut_gear.chain", "--no-picture", "--out", out.to_str().unwrap()];
    let solved = flank(&[&["solve"], &arguments[..]].concat());
    let arguments = ["plot", arguments[0], "--what", "machine", "--json", "--out", arguments[3]];
    let run = flank(&arguments);
    assert_eq!((run.status.code(), solved.status.code()), (Some(3), Some(3)), "{}", text(&run.stderr));
    let told = text(&run.stderr);
    assert!(told.contains("not solved: ") && text(&solved.stderr).contains(&told), "{told}");
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let first = table["not_done"][0]["message"].as_str().expect("a message");
    assert!(told.starts_with(first), "{first}");
    assert!(out.join("undercut_gear.machine.svg").exists());
}

/// A flag that would change nothing is refused, or does what it says.
#[test]
fn flags_are_heeded_or_refused() {
    let found = plotted(
        "plot_one_surface",
        &["specs/hobbing/spur_gear.chain", "--what", "surface", "--surface", "fillet_plus"],
        "spur_gear.surface.svg",
    );
    has(&found, &["fillet_plus"]);
    assert!(!found.iter().any(|label| label.contains("flank_")), "{found:?}");
    let run = flank(&["plot", "specs/hobbing/spur_gear.chain", "--of", "teeth"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("--of names what `sensitivity` shows"), "{}", text(&run.stderr));
}
