//! `flank fit`: points that do not go with the others, and gears that stand elsewhere on the measuring machine.

mod support;

use std::path::Path;

use serde_json::Value;
use support::grids::{PINION, VARIED, fit, gauged, number, path, plain, rewritten};
use support::{flank, folder, text, written};

#[test]
fn a_point_that_does_not_go_with_the_others_is_named() {
    let file = gauged("fit_outlier");
    let one = rewritten(&file, "one.csv", |place, at, normal| {
        let off = if place == [2, 3] { 0.05 } else { 0.0 };
        plain(place, std::array::from_fn(|k| at[k] + off * normal[k]))
    });
    let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &one, "--vary", VARIED]);
    let outliers = told["outliers"].as_array().expect("points");
    assert_eq!(outliers.len(), 1, "{outliers:?}");
    assert_eq!((&outliers[0]["row"], &outliers[0]["column"]), (&Value::from(2), &Value::from(3)));
    assert!((number(&outliers[0]["off_um"]) - 50.0).abs() < 0.1, "{outliers:?}");
    assert!(stderr.contains("row 2, column 3 of concave lies 50."), "{stderr}");
    // without it the settings are found
    let without = rewritten(&file, "without.csv", |place, at, _| (place != [2, 3]).then(|| plain(place, at)).flatten());
    let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &without, "--vary", VARIED]);
    assert!(number(&told["identification"]["left_um"]) < 1e-6);
    assert!(stderr.contains("not measured: 1 of 45 points of concave"), "{stderr}");
}

/// A point so far off that the turn which it asks for takes others to the places of their neighbours: it is named, and not they.
#[test]
fn a_point_that_takes_all_others_along_is_named() {
    let file = gauged("fit_far");
    let far = rewritten(&file, "far.csv", |place, at, normal| {
        let off = if place == [3, 5] { 50.0 } else { 0.0 };
        plain(place, std::array::from_fn(|k| at[k] + off * normal[k]))
    });
    let deviation = ["deviation", PINION, "concave", "--measured", &far];
    let fit = ["fit", PINION, "concave", "--measured", &far, "--vary", VARIED];
    for arguments in [&deviation[..], &fit] {
        let run = flank(arguments);
        assert_eq!(run.status.code(), Some(1), "{arguments:?}");
        let told = text(&run.stderr);
        assert!(
            told.contains("far.csv: row 3, column 5 lies ") && told.contains("takes all others along by its turn"),
            "{told}"
        );
    }
}

/// By which a point is off, um.
type Off<'a> = &'a dyn Fn([usize; 2]) -> f64;

/// Measured with 0.4 um of noise, and points that are off by what `off` says, if that is not zero; and the same without these.
fn with_points_off(file: &Path, name: &str, off: impl Fn([usize; 2]) -> f64) -> [String; 2] {
    let noise = |[row, column]: [usize; 2]| {
        8e-4 * (((12.9898 * row as f64 + 78.233 * column as f64).sin() * 43_758.545_3).fract().abs() - 0.5)
    };
    let moved = |place, at: [f64; 3], normal: [f64; 3]| {
        plain(place, std::array::from_fn(|k| at[k] + (noise(place) + 1e-3 * off(place)) * normal[k]))
    };
    let all = rewritten(file, &format!("{name}.csv"), moved);
    let rest = rewritten(file, &format!("{name}_rest.csv"), |place, at, normal| {
        (off(place) == 0.0).then(|| moved(place, at, normal)).flatten()
    });
    [all, rest]
}

/// A row, a column, or several points that are off are told as such and no others, with what the fit without them predicts of them; and that they are
/// why so much is left.
#[test]
fn rows_columns_and_several_points_that_are_off_are_named() {
    let file = gauged("fit_outliers");
    let several = [[1, 9], [2, 4], [3, 3], [4, 8], [5, 1], [5, 5]];
    let ways: [(&str, Off<'_>, &str); 5] = [
        ("row", &|[row, _]| if row == 2 { 50.0 } else { 0.0 }, "row 2, 9 points, of concave lies "),
        ("end", &|[row, _]| if row == 5 { -20.0 } else { 0.0 }, "row 5, 9 points, of concave lies -"),
        ("column", &|[_, column]| if column == 9 { 30.0 } else { 0.0 }, "column 9, 5 points, of concave lies "),
        ("several", &|at| if several.contains(&at) { 40.0 } else { 0.0 }, "row 4, column 8 of concave lies "),
        ("one_of_row", &|at| if at[0] == 2 || at == [4, 6] { 25.0 } else { 0.0 }, "row 4, column 6 of concave lies "),
    ];
    for (name, off, says) in ways {
        let [all, rest] = with_points_off(&file, name, off);
        let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &all, "--vary", VARIED]);
        let outliers = told["outliers"].as_array().expect("points");
        let place = |of: &Value| ["row", "column"].map(|name| of[name].as_u64().expect("an index") as usize);
        let found: Vec<[usize; 2]> = outliers.iter().map(place).collect();
        let wanted: Vec<[usize; 2]> = (0..45).map(|at| [at / 9 + 1, at % 9 + 1]).filter(|at| off(*at) != 0.0).collect();
        assert_eq!(found, wanted, "{name}");
        assert!(stderr.contains(says), "{name}: {stderr}");
        // its own scatter and that of what is predicted
        let far = outliers.iter().map(|of| (number(&of["off_um"]) - off(place(of))).abs()).fold(0.0, f64::max);
        assert!(far < 2.0, "{name}: {far}");
        assert!(outliers.iter().all(|of| number(&of["sigmas"]) > 20.0), "{name}: {outliers:?}");
        assert!(
            stderr.contains("outliers: of the points that go together the settings would leave 0."),
            "{name}: {stderr}"
        );
        assert!(!stderr.contains("rank:") && !stderr.contains("may mean nothing"), "{name}: {stderr}");
        let (refitted, _) =
            fit(3, &[PINION, "concave", "--measured", &rest, "--rows", "5", "--columns", "9", "--vary", VARIED]);
        let (without, left) = (number(&told["without_outliers_um"]), number(&refitted["identification"]["left_um"]));
        assert!((without - left).abs() < 1e-6, "{name}: {without} and {left}");
        assert!(
            refitted["outliers"].as_array().expect("points").is_empty() && refitted["without_outliers_um"].is_null()
        );
        if name == "several" {
            let (told, _) = fit(3, &[PINION, "concave", "--measured", &all, "--vary", VARIED, "--order", "2"]);
            let found: Vec<[usize; 2]> = told["outliers"].as_array().expect("points").iter().map(place).collect();
            assert_eq!(found, wanted, "an order alone");
        }
    }
}

/// One setting of three that were changed leaves a smooth deviation of many micrometres: no point of it is off, and one that is, is off from it.
#[test]
fn a_smooth_deviation_has_no_points_that_are_off() {
    let file = gauged("fit_smooth");
    let [plain, _] = with_points_off(&file, "smooth", |_| 0.0);
    let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &plain, "--vary", "ratio_of_roll"]);
    assert!(number(&told["identification"]["left_um"]) > 2.0, "{told}");
    assert!(told["outliers"].as_array().expect("points").is_empty(), "{stderr}");
    let [one, _] = with_points_off(&file, "smooth_one", |at| if at == [3, 8] { 8.0 } else { 0.0 });
    let (told, stderr) = fit(3, &[PINION, "concave", "--measured", &one, "--vary", "ratio_of_roll"]);
    let outliers = told["outliers"].as_array().expect("points");
    assert_eq!((outliers.len(), &outliers[0]["row"], &outliers[0]["column"]), (1, &Value::from(3), &Value::from(8)));
    assert!((number(&outliers[0]["off_um"]) - 8.0).abs() < 1.5, "{outliers:?}");
    assert!(stderr.contains("of a deviation that is smooth beside what the settings do"), "{stderr}");
    assert!(stderr.contains("rank:"), "{stderr}");
}

/// A gear that stands elsewhere on the machine, or whose coordinates are scaled, is told where the points show it; other settings are not taken for that.
#[test]
fn a_gear_that_is_mounted_or_scaled_otherwise_is_told() {
    const GEAR: &str = "specs/hobbing/helical_gear.chain";
    let file = gauged("fit_mounted");
    let (sin, cos) = 4.35f64.to_radians().sin_cos();
    let plain_grid = rewritten(&file, "plain.csv", |place, at, _| plain(place, at));
    let scaled = rewritten(&file, "scaled.csv", |place, at, _| plain(place, at.map(|x| 1.001 * x)));
    let outwards =
        rewritten(&file, "outwards.csv", |place, [x, y, z], _| plain(place, [x + 0.05 * cos, y + 0.05 * sin, z]));
    for (grid, says) in [(&plain_grid, None), (&scaled, Some("1.001")), (&outwards, Some("shifted by 0.0"))] {
        let run = flank(&["fit", PINION, "concave", "--measured", grid, "--vary", VARIED, "--within", "10um"]);
        let stderr = text(&run.stderr);
        assert_eq!(run.status.code(), Some(0), "{stderr}");
        match says {
            Some(says) => assert!(
                stderr.contains("mm beside their places, along the flank, as if all were ") && stderr.contains(says),
                "{stderr}"
            ),
            None => assert!(!stderr.contains("beside their places"), "{stderr}"),
        }
    }
    let out = folder("fit_mounted_helical");
    let measured = flank(&["measure", GEAR, "--surface", "lower_flank", "--out", path(&out)]);
    assert_eq!(measured.status.code(), Some(0));
    let content = std::fs::read_to_string(out.join("helical_gear.grid.csv")).expect("written");
    let lines = content.lines().filter(|line| line.starts_with("lower_flank,grid") || line.contains(",grid,"));
    let shifted = lines.map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let z = cells[7].parse::<f64>().expect("a number") + 0.05;
        format!("{},{},{},{},{z:?}\n", cells[3], cells[4], cells[5], cells[6])
    });
    let shifted = written(&out, "shifted.csv", &format!("row,column,x,y,z\n{}", shifted.collect::<String>()));
    let run = flank(&["fit", GEAR, "lower_flank", "--measured", &shifted, "--vary", "helix_angle"]);
    assert!(text(&run.stderr).contains("as if all were shifted by 0.0500 mm along z"), "{}", text(&run.stderr));
}
