//! `flank report` as a user runs it: what stands on the page, and that it is true.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, self_contained, text, written};

/// Runs a report into a folder and gives what it tells as JSON.
fn reported(arguments: &[&str], out: &Path, ending: i32) -> Value {
    let run = flank(&[&["report"], arguments, &["--json", "--out", out.to_str().expect("a plain path")]].concat());
    assert_eq!(run.status.code(), Some(ending), "{arguments:?} {}", text(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(path).expect("the file is there")
}

/// The page as XML: it is well-formed, and its texts are those that a reader sees.
fn page(html: &str) -> roxmltree::Document<'_> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    roxmltree::Document::parse_with_options(html, options).expect("well-formed XML")
}

/// The cells of all rows of all tables.
fn rows(page: &roxmltree::Document<'_>) -> Vec<Vec<String>> {
    let cell = |node: roxmltree::Node<'_, '_>| {
        node.descendants().filter(roxmltree::Node::is_text).filter_map(|part| part.text()).collect::<String>()
    };
    let cells = |row: roxmltree::Node<'_, '_>| row.children().filter(roxmltree::Node::is_element).map(cell).collect();
    page.descendants().filter(|node| node.tag_name().name() == "tr").map(cells).collect()
}

fn has_row(rows: &[Vec<String>], cells: &[&str]) {
    let is_row = |row: &Vec<String>| cells.iter().all(|cell| row.iter().any(|own| own == cell));
    assert!(rows.iter().any(is_row), "no row with {cells:?} in {rows:#?}");
}

/// One of each kind of job; all of the library take some minutes without optimization.
const KINDS: [&str; 9] = [
    "specs/bevel/face_hobbed_pinion.chain",
    "specs/bevel/formate_gear.chain",
    "specs/bevel/conjugate_pinion_19x62.chain",
    "specs/double_envelope/shaped_ring_gear.chain",
    "specs/hobbing/diagonal_gear.chain",
    "specs/hobbing/face_gear.chain",
    "specs/hobbing/real_hob.chain",
    "specs/hobbing/skived_internal_gear.chain",
    "specs/tutorial/first_gear.chain",
];

/// A report is written, well-formed, below 3 MB and loads nothing.
#[test]
fn jobs_of_the_library_have_reports() {
    let out = folder("report_library");
    let mut largest = 0;
    for spec in KINDS {
        let run = flank(&["report", spec, "--out", out.to_str().unwrap()]);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{spec} {}", text(&run.stderr));
        let told = text(&run.stdout);
        for file in told.lines().filter_map(|line| line.strip_prefix("wrote ")) {
            let html = read(file);
            largest = largest.max(html.len());
            assert!(html.len() < 3_000_000, "{file}: {} bytes", html.len());
            let page = page(&html);
            let names = ["script", "link", "iframe", "object"];
            assert!(!page.descendants().any(|node| names.contains(&node.tag_name().name())), "{file}");
            let is_address = |value: &str| value.starts_with("http") && !value.starts_with("http://www.w3.org/");
            assert!(
                !page.descendants().flat_map(|node| node.attributes()).any(|one| is_address(one.value())),
                "{file}"
            );
            let texts = || page.descendants().filter(roxmltree::Node::is_text).filter_map(|part| part.text());
            assert!(!texts().any(|text| text.contains("NaN") || text.contains("url(")), "{file}");
        }
    }
    eprintln!("the largest report has {largest} bytes");
}

/// What the report says of surfaces is what `flank solve` says of them.
#[test]
fn numbers_are_those_of_solve() {
    let out = folder("report_numbers");
    let spec = "specs/hobbing/undercut_gear.chain";
    let told = reported(&[spec, "--certify"], &out, 3);
    let run = flank(&[
        "solve",
        spec,
        "--geometry",
        "--sensitivity",
        "--certify",
        "--limits",
        "--json",
        "--no-picture",
        "--out",
        out.to_str().unwrap(),
    ]);
    let solved: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let surfaces = solved["surfaces"].as_array().unwrap();
    assert_eq!(told["surfaces"].as_array().unwrap().len(), surfaces.len());
    for (own, other) in told["surfaces"].as_array().unwrap().iter().zip(surfaces) {
        for (key, value) in other.as_object().unwrap() {
            assert_eq!(&own[key], value, "{key} of {}", other["name"]);
        }
    }
    let asked: u64 = surfaces.iter().map(|one| one["asked"].as_u64().unwrap()).sum();
    assert_eq!(told["asked"].as_u64(), Some(asked));
    for line in solved["lines"].as_array().unwrap() {
        let own = told["lines"].as_array().unwrap().iter().find(|own| own["name"] == line["name"]).expect("the line");
        assert_eq!(own["ranges_reached"], line["ranges_reached"]);
    }
    let html = read(out.join("undercut_gear.report.html"));
    let rows = rows(&page(&html));
    let first = &surfaces[0];
    let [asked, found] = ["asked", "solved"].map(|key| first[key].to_string());
    let worst = format!("{:.1e}", first["worst_residual"].as_f64().unwrap());
    has_row(&rows, &[first["name"].as_str().unwrap(), &asked, &found, &worst, &first["evaluations"].to_string()]);
    let k1 = first["fields"].as_array().unwrap().iter().find(|field| field["name"] == "k1").unwrap();
    has_row(&rows, &["flank_plus", "largest, k1", &format!("{:.6}", k1["high"].as_f64().unwrap())]);
    let most = &first["sensitivity"]["parameters"][0];
    // the page tells them for a usual change of the parameter
    let (change, of_unit) = match most["unit"].as_str() {
        Some("um/mm") => ("0.01 mm", 0.01),
        Some("um/arcmin") => ("1 arcmin", 1.0),
        other => panic!("{other:?} moves most"),
    };
    let moves = ["rms", "largest"].map(|key| of_unit * most[key].as_f64().expect("a displacement"));
    let row = rows
        .iter()
        .find(|row| row.first().is_some_and(|name| name == "flank_plus") && row.len() == 5 && row[1] == most["name"]);
    let row = row.expect("the parameter that moves it most comes first");
    assert_eq!(row[2], change);
    for (cell, value) in row[3..5].iter().zip(moves) {
        let shown: f64 = cell.replace('\u{2212}', "-").parse().expect("a number");
        assert!((shown - value).abs() <= 5e-4 * value.abs().max(1.0), "{row:?}: {most}");
    }
    // the base circle of ten teeth of module 5 at 20 deg, 25 mm · cos 20 deg
    has_row(&rows, &["flank_plus", "singular line", "23.4923"]);
    for reason in told["surfaces"][0]["reasons"].as_array().unwrap() {
        let reason = reason.as_str().unwrap().replace('<', "&lt;");
        assert!(html.contains(&reason), "{reason}");
    }
    assert!(html.contains("98 of 287 points of flank_plus are not solved"), "the reasons have their counts");
}

/// The curvature of an involute is one over the way along the base tangent, so it is largest where the flank begins.
#[test]
fn extreme_curvatures_stand_where_they_are() {
    let out = folder("report_extremes");
    let told = reported(&["specs/hobbing/spur_gear.chain"], &out, 0);
    let flank = told["surfaces"].as_array().unwrap().iter().find(|one| one["name"] == "flank_plus").expect("a flank");
    let number = |name: &str| {
        let input = told["inputs"].as_array().unwrap().iter().find(|input| input["name"] == name).expect("an input");
        input["value"].as_f64().expect("a number")
    };
    let base = number("module") * number("teeth") / 2.0 * 20f64.to_radians().cos();
    assert_eq!(number("r.pressure_angle"), 20.0);
    let lowest = &flank["ranges_reached"][0];
    assert_eq!(lowest["name"], "rho");
    let rho = lowest["low"].as_f64().expect("a radius");
    let k1 = &flank["curvature"][0];
    let [x, y] = [0, 1].map(|k| k1["position"][k].as_f64().expect("a coordinate"));
    assert!((x.hypot(y) - rho).abs() < 1e-9, "{k1}");
    let expected = 1.0 / (rho * rho - base * base).sqrt();
    assert!((k1["value"].as_f64().expect("a curvature") - expected).abs() < 1e-9 * expected, "{k1}: {expected}");
    let html = read(out.join("spur_gear.report.html"));
    has_row(
        &rows(&page(&html)),
        &["flank_plus", &format!("{expected:.6}"), &format!("{:.4}", 1.0 / expected), &format!("{rho:.4}")],
    );
}

#[test]
fn inputs_say_who_gives_them() {
    let out = folder("report_inputs");
    let told = reported(&["specs/hobbing/undercut_gear.chain", "--set", "teeth=30"], &out, 0);
    let input = |name: &str| {
        let found = told["inputs"].as_array().unwrap().iter().find(|input| input["name"] == name);
        found.unwrap_or_else(|| panic!("no input {name}")).clone()
    };
    let teeth = input("teeth");
    assert_eq!(
        (&teeth["value"], &teeth["given_by"], &teeth["is_count"]),
        (&30.0.into(), &"caller".into(), &true.into())
    );
    let module = input("module");
    assert_eq!((&module["written"], &module["unit"]), (&"5 mm".into(), &"mm".into()));
    assert_eq!(input("profile_shift")["meaning"], "x; from 0.4151 on, this gear is not cut under.");
    let radius = input("m.reference_radius");
    assert_eq!((&radius["written"], &radius["value"]), (&"reference_radius".into(), &75.0.into()));
    assert_eq!((&radius["given_by"], &radius["definition"]), (&"job".into(), &Value::Null));
    let angle = input("r.pressure_angle");
    assert_eq!((&angle["given_by"], &angle["definition"]), (&"definition".into(), &"rack".into()));
    assert_eq!((&angle["value"], &angle["unit"]), (&20.0.into(), &"deg".into()));
    let html = read(out.join("undercut_gear.report.html"));
    // what is set by hand is among the inputs, and no file
    let files = [
        "hobbing/undercut_gear",
        "hobbing/spur_gear",
        "machines/rack_generating",
        "machines/hobbing_6axis",
        "tools/rack",
    ];
    let files = files.map(|file| format!("specs/{file}.chain")).join(", ");
    assert!(html.contains(&format!("<dt>files read</dt><dd>{files}</dd>")));
    let rows = rows(&page(&html));
    has_row(&rows, &["teeth", "30", "--set"]);
    has_row(&rows, &["r.pressure_angle", "20 deg", "20", "deg", "default"]);
    has_row(&rows, &["m.shift", "profile_shift * module", "0", "mm", "job"]);
    assert!(html.contains("flank report specs/hobbing/undercut_gear.chain --job undercut_gear --set teeth=30"));
}

#[test]
fn the_machine_is_as_it_was_built() {
    let out = folder("report_machine");
    let told = reported(&["specs/bevel/pinion_19x62.chain"], &out, 0);
    let machine = &told["machines"][0];
    assert_eq!((&machine["name"], &machine["definition"]), (&"m".into(), &"cradle_generator".into()));
    let named =
        |list: &Value, name: &str| list.as_array().unwrap().iter().find(|one| one["name"] == name).unwrap().clone();
    let cutter = named(&machine["frames"], "cutter");
    assert_eq!((&cutter["parent"], &cutter["transforms"][0]), (&"swivel".into(), &"rotate_z(m.tilt)".into()));
    let cradle = named(&machine["axes"], "cradle");
    assert_eq!((&cradle["law"], &cradle["source"]), (&"m.cradle_angle + roll".into(), &"coupled".into()));
    // the work turns as the cradle does, by the ratio of roll
    let [work, roll] = ["work", "roll"].map(|name| named(&machine["axes"], name));
    let wide = |axis: &Value| axis["high"].as_f64().unwrap() - axis["low"].as_f64().unwrap();
    assert!((wide(&work) / wide(&roll) - 3.339685914944047).abs() < 1e-9);
    assert_eq!(told["surfaces"][0]["chain"].as_array().unwrap().first(), Some(&"m.work".into()));
}

/// The list is made of what was done, not of what might have been.
#[test]
fn what_was_not_checked_depends_on_the_job() {
    let out = folder("report_unchecked");
    let list = |arguments: &[&str], ending: i32| {
        let told = reported(arguments, &out, ending);
        let list = told["not_checked"]["of_this_job"].as_array().unwrap().clone();
        list.iter().map(|one| one.as_str().unwrap().to_string()).collect::<Vec<String>>().join("\n")
    };
    let plain = list(&["specs/hobbing/undercut_gear.chain"], 3);
    assert!(plain.contains("not certified") && plain.contains("Roughness"), "{plain}");
    assert!(!plain.contains("no \u{201c}trim\u{201d}"), "all four are trimmed: {plain}");
    let certified = list(&["specs/hobbing/undercut_gear.chain", "--certify"], 3);
    assert!(!certified.contains("certified"), "{certified}");
    let pinion = list(&["specs/bevel/pinion_19x62.chain"], 0);
    assert!(pinion.contains("cut away of concave, concave_fillet"), "{pinion}");
    assert!(pinion.contains("stay within their travel"), "{pinion}");
    let real = list(&["specs/hobbing/real_hob.chain", "--set", "points=5"], 0);
    assert!(!real.lines().any(|line| line.starts_with("Roughness") && line.contains("lower_flank")), "{real}");
}

/// A report that has the contact of a pair does not say that it was not looked at.
#[test]
fn what_no_report_checks_depends_on_contacts() {
    let out = folder("report_of_a_pair");
    let of = |spec: &str| {
        let run = flank(&["report", spec, "--json", "--out", out.to_str().expect("a plain path")]);
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        (told["contacts"].as_array().expect("contacts").len(), told["not_checked"]["by_no_report"].to_string())
    };
    let (none, alone) = of("specs/hobbing/spur_gear.chain");
    assert!(none == 0 && alone.contains("Meshing with a mating gear"), "{alone}");
    let (some, pair) = of("specs/pairs/spur_pair.chain");
    assert!(some == 2 && !pair.contains("Meshing") && pair.contains("Contact under load"), "{pair}");
}

/// Steel that the tool takes away of a body is told of in the report, too: a cutter of nearly as many teeth as its ring, whose depth
/// `what_the_tool_cuts_in_another_position_is_told` holds against the involute.
#[test]
fn what_a_body_has_too_much_is_told() {
    let out = folder("report_uncut");
    let spec = "specs/bodies/shaped_gear_body.chain";
    let job = ["--job", "shaped_internal_gear_body"];
    let set = ["--set", "teeth=30", "--set", "cutter_teeth=27", "--set", "c.teeth=27", "--set", "c.addendum=4.2 mm"];
    let told = reported(&[&[spec][..], &job, &set].concat(), &out, 3);
    let not_done = told["not_done"].as_array().expect("a list");
    let of_body = not_done.iter().find(|of| of["kind"] == "not_cut").expect("the body is told of");
    let message = of_body["message"].as_str().expect("a message");
    assert!(message.contains("`ring` has steel up to 0.0738 mm deep"), "{message}");
    assert!(read(out.join("shaped_internal_gear_body.report.html")).contains("has steel up to 0.0738 mm deep"));
}

#[test]
fn the_same_job_gives_the_same_bytes() {
    let [first, second] = ["first", "second"].map(|name| {
        let out = folder(&format!("report_{name}"));
        reported(&["specs/hobbing/spur_gear.chain", "--format", "html,md", "--date", "2026-11-21"], &out, 0);
        let mut files: Vec<_> = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.iter().map(|file| (file.file_name().unwrap().to_owned(), read(file))).collect::<Vec<_>>()
    });
    assert!(first.len() > 3 && first == second);
    let page = &first.iter().find(|(name, _)| name == "spur_gear.report.html").expect("the page").1;
    assert!(page.contains("2026-11-21"));
}

/// Tables with one cell for each column, pictures that are there.
#[test]
fn markdown_has_tables_and_pictures() {
    let out = folder("report_markdown");
    let told = reported(&["specs/hobbing/undercut_gear.chain", "--format", "md"], &out, 3);
    let markdown = read(out.join("undercut_gear.report.md"));
    let unescaped = |line: &str| line.replace("\\|", "").matches('|').count();
    let lines: Vec<&str> = markdown.lines().collect();
    let mut tables = 0;
    for (k, rule) in lines.iter().enumerate().filter(|(_, line)| line.starts_with("| --")) {
        tables += 1;
        let columns = unescaped(rule);
        assert!(lines[k - 2].is_empty() && unescaped(lines[k - 1]) == columns, "{}", lines[k - 1]);
        for row in lines[k + 1..].iter().take_while(|line| !line.is_empty()) {
            assert_eq!(unescaped(row), columns, "{row}");
        }
    }
    assert!(tables > 8, "{tables} tables");
    assert!(markdown.contains("| flank\\_plus | envelope of r.flank\\_plus over phi, in m.table |"), "{markdown}");
    let names = told["pictures"].as_array().unwrap();
    for name in names.iter().map(|one| one["name"].as_str().unwrap()) {
        assert!(markdown.contains(&format!("]({name}.svg)")), "{name}");
        assert!(roxmltree::Document::parse(&read(out.join(format!("{name}.svg")))).is_ok());
    }
    assert!(names.len() > 3);
}

/// A spec in which every text of its author tries to get out of its place.
fn hostile() -> String {
    let spec = self_contained(&[
        "machines/hobbing_6axis",
        "machines/rack_generating",
        "tools/rack",
        "hobbing/spur_gear",
        "hobbing/undercut_gear",
    ]);
    let evil = "</table><script>alert(1)</script> ](javascript:alert(1)) | `x` <img src=x onerror=alert(2)> & \u{1}";
    spec.replace("/// The rack's tip", &format!("/// {evil}\n/// The rack's tip"))
        .replace("/// x; from 0.4151", &format!("/// {evil} x; from 0.4151"))
        .replace(
            "sample flank_plus, flank_minus {",
            &format!(
                "sample flank_plus, flank_minus {{\n require wide = x: 0 mm .. 0.001 mm, \"{}\"\n",
                evil.replace('"', "'")
            ),
        )
}

#[test]
fn texts_of_a_spec_stay_text() {
    let out = folder("report_hostile");
    let spec = written(&out, "hostile.chain", &hostile());
    let arguments = ["--job", "undercut_gear", "--format", "html,md", "--date", "<script>alert(3)</script>"];
    reported(&[&[spec.as_str()][..], &arguments].concat(), &out, 3);
    let html = read(out.join("undercut_gear.report.html"));
    let parsed = page(&html);
    let names: Vec<&str> = parsed.descendants().map(|node| node.tag_name().name()).collect();
    assert!(!names.contains(&"script") && !names.contains(&"img"));
    let attributes = parsed.descendants().flat_map(|node| node.attributes());
    assert!(!attributes.into_iter().any(|one| one.name().starts_with("on")));
    assert!(html.matches("&lt;script&gt;alert(1)&lt;/script&gt;").count() >= 3, "all three are shown");
    assert!(!html.contains('\u{1}'));
    let markdown = read(out.join("undercut_gear.report.md"));
    assert!(!markdown.contains("<script") && !markdown.contains("<img"));
    assert!(markdown.contains("\\](javascript") && !markdown.replace("\\](", "").contains("](javascript"));
}

#[test]
fn one_file_can_be_named() {
    let out = folder("report_file");
    let file = out.join("order 4711.HTML");
    let spec = "specs/hobbing/spur_gear.chain";
    let told = reported(&[spec], &file, 0);
    assert_eq!(told["files"].as_array().unwrap().len(), 1);
    assert!(read(&file).starts_with("<!DOCTYPE html>"));
    let refused = |arguments: &[&str], code: i32, why: &str| {
        let run = flank(&[&["report"], arguments].concat());
        assert_eq!(run.status.code(), Some(code));
        assert!(text(&run.stderr).contains(why), "{}", text(&run.stderr));
    };
    refused(&[spec, "--format", "md", "--out", file.to_str().unwrap()], 2, "cannot hold md: name a folder with --out");
    let several = written(
        &out,
        "several.chain",
        &(self_contained(&[
            "machines/hobbing_6axis",
            "machines/rack_generating",
            "tools/rack",
            "hobbing/spur_gear",
            "hobbing/undercut_gear",
        ]) + &self_contained(&["hobbing/undercut_gear"]).replace("job undercut_gear", "job other")),
    );
    refused(&[&several, "--out", file.to_str().unwrap()], 1, "can hold one job of spur_gear, undercut_gear, other");
    refused(&["specs/bevel/ease_off_19x62.chain", "--job", "pinion"], 1, "asks for no points");
}

/// What cannot be written is told, and what was there stays.
#[test]
fn what_was_there_stays() {
    let out = folder("report_kept");
    let blocked = written(&out, "file", "kept");
    let run = flank(&["report", "specs/hobbing/spur_gear.chain", "--out", &blocked]);
    assert_eq!(run.status.code(), Some(1));
    let told =
        format!("cannot make the folder `{blocked}`: there is a file of that name; name another folder with --out\n");
    assert_eq!(text(&run.stderr).lines().last(), Some(format!("error: {told}").trim_end()));
    let run = flank(&["report", "specs/hobbing/spur_gear.chain", "--out", &format!("{blocked}/below")]);
    assert!(text(&run.stderr).contains("a file stands where a folder on the way to it should be"), "{:?}", run.stderr);
    assert_eq!(read(&blocked), "kept");
    // a folder in the place of the file stops everybody, also those whom permissions do not
    std::fs::create_dir(out.join("spur_gear.report.html")).unwrap();
    let run = flank(&["report", "specs/hobbing/spur_gear.chain", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("cannot write"), "{}", text(&run.stderr));
    let left: Vec<_> = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let out = folder("report_read_only");
    let mode = |mode| std::fs::set_permissions(&out, std::fs::Permissions::from_mode(mode)).unwrap();
    mode(0o555);
    let is_writable = std::fs::write(out.join("probe"), "").is_ok();
    let run = flank(&["report", "specs/hobbing/spur_gear.chain", "--out", out.to_str().unwrap()]);
    mode(0o755);
    if is_writable {
        eprintln!("skipped 1 test: permissions do not hold for this user");
        return;
    }
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("cannot write"), "{}", text(&run.stderr));
}
