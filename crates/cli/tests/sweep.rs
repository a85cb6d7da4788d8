//! `flank sweep`: the rows of a study, how it survives being killed, and what it refuses.

mod support;

use std::path::Path;
use std::process::Command;

use support::studies::{folder, gathered, rows, study};
use support::{flank, self_contained, text, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const PAIR: &str = "specs/pairs/bevel_19x62.chain";

#[test]
fn rows_are_the_same_on_any_number_of_threads_and_anywhere() {
    let folder = folder();
    let [a, b] = ["a", "b"].map(|name| study(&folder, name));
    let asked = |out: &str, threads: &str| {
        let run = flank(&[
            "sweep",
            PINION,
            "--scatter",
            "m.radial_distance=normal(10um)",
            "--scatter",
            "blade_angle=uniform(1arcmin)",
            "--count",
            "20",
            "--seed",
            "7",
            "--collect",
            "ease_off:concave,points",
            "--out",
            out,
            "--threads",
            threads,
        ]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        assert!(text(&run.stdout).contains("20 cases"), "{}", text(&run.stdout));
    };
    asked(&a, "2");
    asked(&b, "1");
    assert_eq!(gathered(&a), gathered(&b));
    // a study is moved, and still whole
    let moved = study(&folder, "moved");
    std::fs::rename(&b, &moved).expect("the same disk");
    let run = flank(&["sweep", "run", &moved]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(gathered(&a), gathered(&moved));
}

/// A case says what `flank deviation` says of the job with the same values; the numbers of points are those of `flank solve`.
#[test]
fn a_row_says_what_other_commands_say() {
    let folder = folder();
    let (study, out) = (study(&folder, "a"), study(&folder, "out"));
    let text_of_both = self_contained(&OF_PINION) + "job other = pinion_19x62(m.radial_distance: 97.9 mm)\n";
    let spec = written(folder.path(), "pinion.chain", &text_of_both);
    let values = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2", "--collect", "ease_off:concave,points"];
    let run = flank(&[&["sweep", &spec, "--job", "pinion_19x62", "--out", &study], &values[..]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let compared = ["deviation", &spec, "other.concave", "--reference", "pinion_19x62.concave"];
    let run = flank(&[&compared[..], &["--json", "--no-picture", "--out", &out]].concat());
    let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
    let row = &rows(&study)[0];
    let number = |k: usize| row[k].parse::<f64>().expect("a number");
    let slope = |k: usize| document["directions"][k]["slope_um"].as_f64().expect("a slope");
    let known =
        [slope(0), slope(1), document["bias_um"].as_f64().expect("a bias"), document["rms_um"].as_f64().expect("rms")];
    for (found, known) in [6, 7, 10, 11].map(number).into_iter().zip(known) {
        // both turn the surface until it meets the middle, to 1e-9 mm
        assert!((found - known).abs() < 1e-5, "{row:?}: {known}");
    }
    assert_eq!((number(15), row[3].as_str(), row[2].as_str()), (1395.0, "done", "97.9"));
}

#[test]
fn contacts_are_collected_with_mounting_errors() {
    let folder = folder();
    let study = study(&folder, "a");
    let table = folder.path().join("cases.csv");
    std::fs::write(&table, "m.E [um],m.S [arcmin]\n0,0\n20,1\n").expect("a file");
    let run = flank(&[
        "sweep",
        PAIR,
        "--cases",
        &table.display().to_string(),
        "--collect",
        "contact:drive_side",
        "--out",
        &study,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let rows = rows(&study);
    let asked = ["contact", PAIR, "drive_side", "--positions", "24", "--json", "--no-picture", "--out"];
    for (row, errors) in rows.iter().zip([&[][..], &["--error", "m.E=20um", "--error", "m.S=1arcmin"]]) {
        let out = folder.path().join("out").display().to_string();
        let run = flank(&[&asked[..], &[&out], errors].concat());
        let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
        let known = document["error"]["peak_to_peak"].as_f64().expect("an error");
        let found: f64 = row[7].parse().expect("a number");
        assert!((found - known).abs() < 1e-6, "{row:?}: {known}");
    }
}

/// The rows of a study of a spec whose numbers are compared: from the first that is collected on.
fn swept(spec: &str, cases: &[&str], collect: &str, out: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let run = flank(&[&["sweep", spec, "--collect", collect, "--out", out], cases].concat());
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    let all = gathered(out);
    // heads of widths have a comma and quotes
    let parts = all.lines().next().expect("a head").split('"').enumerate();
    let heads = parts.flat_map(|(k, part)| match k % 2 {
        1 => vec![part.to_string()],
        _ => part.trim_matches(',').split(',').filter(|head| !head.is_empty()).map(str::to_string).collect(),
    });
    (heads.collect(), rows(out))
}

/// A spec of the library as it is, and the same where the machine requires something of the setting that differs: that each case is computed
/// from its text.
fn once_and_each(folder: &tempfile::TempDir, specs: &[&str], changes: &[[&str; 2]]) -> [String; 2] {
    let own = changes.iter().fold(self_contained(specs), |text, [from, to]| {
        assert!(text.contains(from), "no `{from}`");
        text.replace(from, to)
    });
    let open = "machine cradle_generator extends cradle {\n";
    let required = format!("{open}    require radial_distance > 0 mm, \"it has a radius\"\n");
    assert!(own.contains(open));
    let each = own.replace(open, &required);
    [("once.chain", own), ("each.chain", each)].map(|(name, content)| written(folder.path(), name, &content))
}

const OF_PINION: [&str; 5] =
    ["functions/bevel", "functions/blanks_19x62", "machines/cradle", "tools/face_mill", "bevel/pinion_19x62"];
const OF_PAIR: [&str; 5] =
    ["functions/blanks_19x62", "machines/bevel_pair", "machines/cradle", "tools/face_mill", "pairs/bevel_19x62"];

#[test]
fn cases_that_are_compiled_once_are_those_of_their_texts() {
    let of_points = "points,width:concave,convex,curvature:concave,at:convex[7,15]";
    // a requirement that some points miss, more or fewer of them from case to case
    let missed =
        [["    sample root {\n", "    sample root {\n        require part = roll: -20 deg .. 1.5 deg, \"late\"\n"]];
    let collected: [(&[&str], &[[&str; 2]], _, _, _); 4] = [
        (&OF_PINION, &[], "m.radial_distance=normal(10um)", of_points, "done"),
        (&OF_PINION, &missed, "m.radial_distance=normal(1mm)", "requirements", "not all solved"),
        (&OF_PINION, &[], "m.radial_distance=normal(0.5mm)", "limits", "done"),
        (&OF_PAIR, &[], "p.radial_distance=normal(10um)", "contact:drive_side", "done"),
    ];
    for (specs, changes, setting, collect, verdict) in collected {
        let folder = folder();
        let texts = once_and_each(&folder, specs, changes);
        let mut cases = vec!["--scatter", setting, "--count", "6", "--seed", "7"];
        if specs == OF_PAIR {
            cases.extend(["--scatter", "m.E=normal(10um)", "--scatter", "m.S=uniform(1arcmin)"]);
        }
        let [once, each] = [0, 1].map(|k| swept(&texts[k], &cases, collect, &study(&folder, ["once", "each"][k])).1);
        let inputs = (cases.len() - 4) / 2;
        let mut seen = std::collections::BTreeSet::new();
        for (k, (one, other)) in once.iter().zip(&each).enumerate() {
            let branch = if k == 0 { "searched" } else { "followed" };
            assert_eq!(one[1..4 + inputs], other[1..4 + inputs], "inputs, verdict, reason");
            assert_eq!([&one[4 + inputs], &other[4 + inputs]], [branch, "searched"]);
            assert_eq!(one[2 + inputs], verdict);
            for (one, other) in one[5 + inputs..].iter().zip(&other[5 + inputs..]) {
                let [one, other] = [one, other].map(|cell| cell.parse::<f64>().expect("a number"));
                // points to 1e-11 mm, of a transmission error of 1e-4 rad in urad the lag's last digits
                assert!((one - other).abs() < 2e-9, "{collect}, case {k}: {one} and {other}");
            }
            seen.insert(one[5 + inputs].clone());
        }
        assert!(collect != "requirements" || (seen.len() > 1 && !seen.contains("0")), "{seen:?}");
    }
}

/// The points of a case are those that `flank solve` writes with its values.
#[test]
fn points_of_cases_are_kept_as_files() {
    let folder = folder();
    let [kept, out] = ["kept", "out"].map(|name| study(&folder, name));
    let cases = ["--vary", "m.radial_distance=97.9mm..98.1mm by 3", "--keep", "points"];
    let (_, rows) = swept(PINION, &cases, "at:concave[7,15]", &kept);
    let numbers = |path: &Path| {
        let table = std::fs::read_to_string(path).expect("points");
        let lines = table.lines().filter(|line| !line.starts_with('#')).map(str::to_string);
        (lines.collect::<Vec<String>>(), table)
    };
    assert_eq!(std::fs::read_dir(Path::new(&kept).join("points")).expect("a folder").count(), 3);
    for (row, value) in rows.iter().zip(["97.9 mm", "98 mm", "98.1 mm"]) {
        let (own, whole) = numbers(&Path::new(&kept).join("points").join(format!("{}.csv", row[0])));
        assert!(whole.contains(&format!("# in this case: m.radial_distance = {value}")), "{whole:.600}");
        let set = format!("m.radial_distance={value}");
        let run = flank(&["solve", PINION, "--set", &set, "--no-picture", "--out", &out]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let (known, _) = numbers(&Path::new(&out).join("pinion_19x62.csv"));
        assert_eq!((own.len(), &own[0]), (known.len(), &known[0]));
        for (own, known) in own.iter().zip(&known).skip(1) {
            for (own, known) in own.split(',').zip(known.split(',')) {
                let is_same = match (own.parse::<f64>(), known.parse::<f64>()) {
                    // unknowns of 100 deg and residuals, too
                    (Ok(own), Ok(known)) => (own - known).abs() < 1e-9,
                    _ => own == known,
                };
                assert!(is_same, "{own} and {known}");
            }
        }
    }
    // whether points are kept is part of the study
    let again = ["sweep", "plan", PINION, "--vary", cases[1], "--collect", "at:concave[7,15]", "--out", &kept];
    let refused = flank(&again);
    assert!(text(&refused.stderr).contains("holds another study"), "{}", text(&refused.stderr));
}

/// Far from the job itself a contact is followed only as long as it is what the text finds.
#[test]
fn contacts_far_from_that_of_the_job_are_those_of_their_texts() {
    let folder = folder();
    let texts = once_and_each(&folder, &OF_PAIR, &[]);
    let cases = ["--scatter", "m.G=normal(2mm)", "--scatter", "p.radial_distance=normal(10um)", "--count", "12"];
    let [once, each] =
        [0, 1].map(|k| swept(&texts[k], &cases, "contact:drive_side", &study(&folder, ["once", "each"][k])).1);
    for (k, (one, other)) in once.iter().zip(&each).enumerate() {
        assert_eq!(one[1..6], other[1..6], "inputs, verdict, reason");
        for (one, other) in one[7..].iter().zip(&other[7..]) {
            match (one.parse::<f64>(), other.parse::<f64>()) {
                (Ok(one), Ok(other)) => assert!((one - other).abs() < 1e-8, "case {k}: {one} and {other}"),
                _ => assert_eq!(one, other, "case {k}"),
            }
        }
    }
    let count = |verdict: &str| once.iter().filter(|row| row[4] == verdict).count();
    assert!(count("done") > 0 && count("not all solved") > 0);
}

/// A case is followed while its points are like those of the job itself: one that leaves a range is searched anew, with the numbers of its text.
#[test]
fn a_case_unlike_the_job_itself_is_searched() {
    let folder = folder();
    let table = written(folder.path(), "cases.csv", "m.radial_distance [mm]\n97.96\n94\n110\n");
    let cases = ["--cases", &table];
    let texts = once_and_each(&folder, &OF_PINION, &[]);
    let [once, each] = [0, 1].map(|k| swept(&texts[k], &cases, "points", &study(&folder, ["once", "each"][k])).1);
    let branches: Vec<&str> = once.iter().map(|row| row[5].as_str()).collect();
    assert_eq!(branches, ["searched", "followed", "searched"]);
    for (one, other) in once.iter().zip(&each) {
        // inputs, verdict, reason, then the points of each status
        assert_eq!([&one[1..5], &one[6..14]], [&other[1..5], &other[6..14]]);
    }
    assert_eq!([&once[2][3], &once[2][4]], ["not all solved", "out_of_range"]);
}

/// What `flank deviation` and `flank solve` say of the job with the values of a case.
#[test]
fn widths_and_curvatures_are_those_of_other_commands() {
    let folder = folder();
    let out = folder.path().join("out").display().to_string();
    let cases = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2"];
    let (heads, rows) = swept(PINION, &cases, "width:concave,convex,curvature:concave", &study(&folder, "a"));
    let set = ["--set", "m.radial_distance=98.1 mm", "--no-picture", "--out", &out];
    let found = |head: &str| {
        let at = heads.iter().position(|known| known.ends_with(head)).expect("a column");
        rows[1][at].parse::<f64>().expect("a number")
    };
    let run = flank(&[&["deviation", PINION, "concave", "--reference", "convex", "--json"], &set[..]].concat());
    let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
    for (head, key) in [("convex.turn [deg]", "turn_deg"), ("convex.width [mm]", "turn_mm")] {
        let known = document[key].as_f64().expect("a turn");
        // a turn brings the surface to a point to 1e-9 mm
        assert!((found(head) - known).abs() < 1e-8, "{head}: {} and {known}", found(head));
    }
    let run = flank(&[&["solve", PINION, "--geometry"], &set[..]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = std::fs::read_to_string(Path::new(&out).join("pinion_19x62.csv")).expect("points");
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let columns: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let points: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    for k in ["k1", "k2"] {
        let at = columns.iter().position(|column| *column == k).expect("a column");
        let of_surface = points.iter().filter(|cells| cells[0] == "concave");
        let all: Vec<f64> = of_surface.map(|cells| cells[at].parse().expect("a curvature")).collect();
        let ends = [("lowest", f64::min as fn(f64, f64) -> f64), ("highest", f64::max)];
        for (end, of) in ends {
            let known = all.iter().copied().reduce(of).expect("points");
            let found = found(&format!("{k}_{end} [1/mm]"));
            assert!((found - known).abs() < 1e-12, "{k} {end}: {found} and {known}");
        }
    }
}

/// A linear propagation of tolerances and a study of normal scatter say the same, within three standard errors of the study, of which
/// `STUDY_CASES` gives the number of cases.
#[test]
fn tolerances_and_studies_agree() {
    let folder = folder();
    let agree =
        |spec: &str, surface: &str, settings: &[(&str, &str)], count: f64, (collect, known): (&str, &[[&str; 3]])| {
            let linear: Vec<String> = settings.iter().map(|(name, amount)| format!("{name}={amount}")).collect();
            let run = flank(&["tolerance", spec, surface, "--scatter", &linear.join(","), "--json"]);
            assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
            let document: serde_json::Value = serde_json::from_str(&text(&run.stdout)).expect("a document");
            let scatter =
                settings.iter().flat_map(|(name, amount)| ["--scatter".into(), format!("{name}=normal({amount})")]);
            let number = count.to_string();
            let scatter: Vec<String> =
                scatter.chain(["--count".into(), number, "--seed".into(), "24".into()]).collect();
            let cases: Vec<&str> = scatter.iter().map(String::as_str).collect();
            let (heads, rows) = swept(spec, &cases, collect, &study(&folder, surface));
            for [name, head, scale] in known {
                let results = document["results"].as_array().expect("results").iter();
                let linear =
                    results.filter(|of| of["name"] == *name).filter_map(|of| of["standard_deviation"].as_f64()).next();
                let linear = linear.unwrap_or_else(|| panic!("{name} is no result"));
                let at = heads.iter().position(|known| known.ends_with(head)).unwrap_or_else(|| panic!("no {head}"));
                let scale: f64 = scale.parse().expect("a number");
                let values: Vec<f64> =
                    rows.iter().map(|row| scale * row[at].parse::<f64>().expect("a number")).collect();
                let mean = values.iter().sum::<f64>() / count;
                let found = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
                // the standard error of a standard deviation is 1/√(2 n) of it
                let off = (found / linear - 1.0) * (2.0 * count).sqrt();
                assert!(off.abs() < 3.0, "{name}: {found} and {linear}, {off} standard errors");
            }
        };
    let cases = std::env::var("STUDY_CASES").map_or(400.0, |cases| cases.parse().expect("a number of cases"));
    let settings = [("m.radial_distance", "5um"), ("m.machine_root_angle", "20arcsec"), ("m.ratio_of_roll", "0.01%")];
    let ease_off = [
        ["slope_profilewise", "slope_rows [um]", "1"],
        ["slope_lengthwise", "slope_columns [um]", "1"],
        ["crowning_profilewise", "crowning_rows [um]", "1"],
        ["crowning_lengthwise", "crowning_columns [um]", "1"],
        ["bias", "bias [um]", "1"],
    ];
    agree(PINION, "concave", &settings, cases, ("ease_off:concave", &ease_off));
    let settings = [("m.E", "10um"), ("m.S", "20arcsec"), ("p.radial_distance", "5um")];
    // degrees in urad
    let contact = [["drive_side.error", "lag [deg]", "17453.292519943295"]];
    agree(PAIR, "pinion_concave", &settings, 0.25 * cases, ("contact:drive_side", &contact));
}

/// The same case has the same hash however it is written, and the same study is gone on with.
#[test]
fn what_is_collected_has_one_spelling() {
    let folder = folder();
    let plan = |collect: &[&str], out: &str| {
        let vary = ["sweep", "plan", PINION, "--vary", "m.radial_distance=97.9mm..98.1mm by 2", "--out", out];
        let run = flank(&[&vary[..], collect].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        std::fs::read_to_string(Path::new(out).join("plan.json")).expect("a plan")
    };
    let out = study(&folder, "a");
    let first = plan(&["--collect", "at:concave[0, 0], width:concave,convex"], &out);
    assert_eq!(first, plan(&["--collect", "at:concave[0,0]", "--collect", "width:concave,convex"], &out));
}

/// Spreadsheets put a byte order mark before a table: the cases are the same.
#[test]
fn a_byte_order_mark_is_no_part_of_a_table() {
    let folder = folder();
    let rows = ["", "\u{feff}"].map(|mark| {
        let table = written(folder.path(), "cases.csv", &format!("{mark}m.radial_distance [mm]\n97.9\n98.1\n"));
        let out = study(&folder, if mark.is_empty() { "plain" } else { "marked" });
        let run = flank(&["sweep", PINION, "--cases", &table, "--collect", "at:concave[7,15]", "--out", &out]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        gathered(&out)
    });
    assert_eq!(rows[0], rows[1]);
}

#[test]
fn what_a_case_lacks_is_a_verdict_and_can_be_tried_again() {
    let folder = folder();
    let [late, wrong] = ["late", "wrong"].map(|name| study(&folder, name));
    let run = flank(&[
        "sweep",
        PINION,
        "--vary",
        "m.radial_distance=97.9mm..98.1mm by 3",
        "--limit",
        "1e-9",
        "--collect",
        "points",
        "--out",
        &late,
    ]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let late_rows = gathered(&late);
    assert!(late_rows.lines().skip(1).all(|row| row.split(',').nth(3) == Some("limit")), "{late_rows}");
    assert_eq!(flank(&["sweep", "run", &late, "--again", "limit"]).status.code(), Some(3));
    // what the spec requires does not hold: the code says which error
    let table = written(folder.path(), "cases.csv", "eccentricity [mm]\n1\n6\n");
    let run = flank(&[
        "sweep",
        "specs/cycloidal/cycloidal_disc.chain",
        "--cases",
        &table,
        "--collect",
        "at:side[0,0]",
        "--out",
        &wrong,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let verdicts: Vec<[String; 2]> = rows(&wrong).into_iter().map(|row| [row[3].clone(), row[4].clone()]).collect();
    assert_eq!(verdicts, [["done", ""], ["spec wrong", "E0309"]]);
}

#[test]
fn the_whole_table_is_looked_at_before_anything_runs() {
    let folder = folder();
    let (study, table) = (study(&folder, "a"), folder.path().join("cases.csv"));
    let refused = [
        ("m.radial_distance\n98\n", "column `m.radial_distance` has no unit: write `m.radial_distance [mm]`"),
        ("m.radial_distance [deg]\n98\n", "`deg` is no unit of it; write `m.radial_distance [mm]`"),
        ("m.radial [mm]\n98\n", "has no parameter, setting or axis of a contact `m.radial`"),
        ("m.radial_distance [mm]\n98\nx\n50000\n1,2\n", "cases.csv:3: `x` is no number"),
        (
            "m.radial_distance [mm]\n98\nx\n50000\n1,2\n",
            "cases.csv:4: `m.radial_distance` is 50000 mm, outside its range",
        ),
        ("m.radial_distance [mm]\n98\nx\n50000\n1,2\n", "cases.csv:5: 2 values in 1 column"),
        ("m.radial_distance [mm]\n", "the study has no case"),
    ];
    for (content, known) in refused {
        std::fs::write(&table, content).expect("a file");
        let run =
            flank(&["sweep", PINION, "--cases", &table.display().to_string(), "--collect", "points", "--out", &study]);
        assert_eq!(run.status.code(), Some(1), "{content}");
        assert!(text(&run.stderr).contains(known), "{}", text(&run.stderr));
        assert!(!Path::new(&study).exists(), "{content}");
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = folder();
    let study = study(&folder, "a");
    let vary = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2"];
    let refused: [(&[&str], i32, &str); 9] = [
        (&["--collect", "points"], 2, "say what differs from case to case"),
        (&["--vary", "m.radial_distance=97.9..98.1 by 2", "--collect", "points"], 1, "E0301"),
        (&["--vary", "m.radial_distance=97.9mm by 2", "--collect", "points"], 2, "write NAME=FROM..TO by COUNT"),
        (&[vary[0], vary[1], "--collect", "poinst"], 2, "write points, requirements, limits"),
        (&[vary[0], vary[1], "--collect", "ease_off:nosuch"], 1, "there is no surface `nosuch`"),
        (&[vary[0], vary[1], "--collect", "at:concave[99,0]"], 1, "has rows 0 to 14"),
        (&[vary[0], vary[1], "--collect", "contact:c"], 1, "has no contact `c`; there is: none"),
        (
            &["--scatter", "m.radial_distance=normal(1arcmin)", "--collect", "points"],
            1,
            "this takes a length above zero",
        ),
        (&["--scatter", "m.radial_distance=cauchy(1um)", "--collect", "points"], 2, "write NAME=normal(AMOUNT)"),
    ];
    for (arguments, code, known) in refused {
        let run = flank(&[&["sweep", PINION, "--out", &study], arguments].concat());
        assert_eq!(run.status.code(), Some(code), "{arguments:?}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains(known), "{arguments:?}: {}", text(&run.stderr));
    }
    let asked = |value: &str| {
        let vary = format!("m.radial_distance={value}");
        flank(&["sweep", "plan", PINION, "--vary", &vary, "--collect", "at:concave[0,0]", "--out", &study])
    };
    assert_eq!(asked("97.9mm..98.1mm by 2").status.code(), Some(0));
    // the same study again goes on, another one is refused
    assert_eq!(asked("97.9mm..98.1mm by 2").status.code(), Some(0));
    let other = asked("97.9mm..98.2mm by 2");
    assert_eq!(other.status.code(), Some(1));
    assert!(text(&other.stderr).contains("holds another study"), "{}", text(&other.stderr));
    let incomplete = flank(&["sweep", "gather", &study]);
    assert_eq!(incomplete.status.code(), Some(3));
    assert!(text(&incomplete.stderr).contains("1 of 1 chunk of"), "{}", text(&incomplete.stderr));
    // texts of another spec, a plan of another program
    let spec = Path::new(&study).join("spec/bevel/pinion_19x62.chain");
    let own = std::fs::read_to_string(&spec).expect("its text");
    std::fs::write(&spec, format!("{own}\n// changed\n")).expect("a file");
    let run = flank(&["sweep", "run", &study]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("are not those that the study was planned with"), "{}", text(&run.stderr));
    std::fs::write(&spec, own).expect("a file");
    let plan = Path::new(&study).join("plan.json");
    let changed = std::fs::read_to_string(&plan).expect("a plan").replace(env!("CARGO_PKG_VERSION"), "9.9.9");
    std::fs::write(&plan, changed).expect("a file");
    let run = flank(&["sweep", "run", &study]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("was made by flank 9.9.9"), "{}", text(&run.stderr));
    // it is read all the same
    let run = flank(&["sweep", "status", &study]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("made by flank 9.9.9, this is flank"), "{}", text(&run.stdout));
    let run = flank(&["sweep", "run", &folder.path().join("nothing").display().to_string()]);
    assert!(text(&run.stderr).contains("is no study"), "{}", text(&run.stderr));
}

/// Every command of the page about studies, in its order; blocks of commands have a folder each. Cases are fewer than on the page.
#[test]
#[cfg(unix)]
fn commands_of_the_page_do_what_it_says() {
    let top = support::top().canonicalize().expect("the repository");
    let page = std::fs::read_to_string(top.join("docs/studies.md")).expect("the page");
    let program = Path::new(env!("CARGO_BIN_EXE_flank")).parent().expect("a folder");
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let of_machine: String = (0..20).map(|k| format!("{}\n", 97.9 + 0.01 * f64::from(k))).collect();
    let mounting = "m.E [um],m.P [um],m.G [um],m.S [arcmin],p.radial_distance [um]\n0,0,0,0,99808\n10,-5,3,0.5,99803\n";
    let mut commands = 0;
    for block in page.split("\n\n").filter(|block| block.starts_with("    flank sweep")) {
        let folder = folder();
        std::os::unix::fs::symlink(top.join("specs"), folder.path().join("specs")).expect("a link to the library");
        written(folder.path(), "table.csv", &format!("m.radial_distance [mm]\n{of_machine}"));
        written(folder.path(), "mounting.csv", mounting);
        for command in block.replace("\\\n", " ").lines() {
            let command = command.trim().replace("--count 1000", "--count 100");
            let run = Command::new("sh").args(["-c", &command]).env("PATH", &path).current_dir(folder.path()).output();
            let run = run.expect("a shell");
            assert_eq!(run.status.code(), Some(0), "{command}: {}", text(&run.stderr));
            if command.contains(" plan ") {
                // as many chunks as the page speaks of
                let plan = folder.path().join("study/plan.json");
                let document = std::fs::read_to_string(&plan).expect("a plan");
                let mut document: serde_json::Value = serde_json::from_str(&document).expect("a plan");
                document["chunk"] = 2.into();
                std::fs::write(plan, document.to_string()).expect("a file");
            }
            commands += 1;
        }
        // what was made last is whole
        let status = flank(&["sweep", "status", &folder.path().join("study").display().to_string(), "--json"]);
        let document: serde_json::Value = serde_json::from_str(&text(&status.stdout)).expect("a document");
        assert_eq!(
            (document["chunks"].as_u64(), document["failed"].as_array().map(Vec::len)),
            (document["done"].as_u64(), Some(0))
        );
    }
    assert!(commands >= 8, "{commands} commands");
}

/// A module further on moves the flank of a rack parallel to itself: nothing is left of it once the rack is shifted back.
#[test]
fn a_rack_of_another_module_has_no_ease_off() {
    let folder = folder();
    let cases = ["--vary", "r.module=2.99mm..3.01mm by 3"];
    let collected = "ease_off:flank_minus,width:flank_plus,flank_minus";
    let (heads, rows) = swept("specs/bodies/rack_body.chain", &cases, collected, &study(&folder, "a"));
    let number = |row: &[String], head: &str| {
        let at = heads.iter().position(|known| known.ends_with(head)).expect("a column");
        row[at].parse::<f64>().expect("a number")
    };
    assert_eq!(rows.len(), 3);
    for (row, module) in rows.iter().zip([2.99, 3.0, 3.01]) {
        for head in ["slope_rows [um]", "crowning_rows [um]", "rms [um]", "flank_minus.turn [deg]"] {
            assert!(number(row, head).abs() < 1e-6, "{head}: {row:?}");
        }
        // in the middle of the sampled flank, of the nominal module, the flanks of a space are as far apart as the tooth of the rack cutter is wide
        assert!(number(row, "width [mm]").abs() > 2.0 && number(row, "width [mm]").abs() < module * 1.6, "{row:?}");
    }
}
