//! `flank measure` and `flank deviation --measured`: to the measuring machine and back.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text, top, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";

/// A point of the concave flank's grid: row and column from 1, position and normal.
type Nominal = ([usize; 2], [f64; 3], [f64; 3]);

fn measure(out: &Path, arguments: &[&str]) -> Value {
    let run = flank(
        &[&["measure", "--json", "--out", out.to_str().expect("a plain path"), "--format", "csv,json"], arguments]
            .concat(),
    );
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

/// The points of one part of a surface in a CSV file of `flank measure`, by the titles of its columns.
fn nominal(file: &Path, surface: &str, part: &str) -> Vec<Nominal> {
    let content = std::fs::read_to_string(file).expect("written");
    let mut lines = content.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("surface,flank,part,row,column,x,y,z,nx,ny,nz,status"));
    let point = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cells[k].parse::<f64>().expect("a number");
        let index = |k: usize| cells[k].parse::<usize>().expect("an index");
        let is_meant = cells[0] == surface && cells[2] == part;
        is_meant.then(|| ([index(3), index(4)], [5, 6, 7].map(number), [8, 9, 10].map(number)))
    };
    lines.filter_map(point).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Deviations in um, row by row, from the CSV file of `flank deviation`.
fn deviations(out: &Path, name: &str) -> Vec<f64> {
    let content = std::fs::read_to_string(out.join(name)).expect("written");
    let lines = content.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.rsplit(',').next().expect("cells").parse().expect("a number")).collect()
}

/// The two flanks of a space face each other, with their fillets; what lies between them, or on a tip, is neither.
#[test]
fn roots_and_tips_are_neither_left_nor_right() {
    let out = folder("measure_hands");
    for spec in
        [PINION, "specs/bevel/hypoid_pinion.chain", "specs/bevel/formate_gear.chain", "specs/hobbing/worm_wheel.chain"]
    {
        let run = flank(&["measure", spec, "--json", "--out", out.to_str().expect("a plain path")]);
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let hands: Vec<(&str, Option<&str>)> = told["flanks"]
            .as_array()
            .expect("flanks")
            .iter()
            .map(|one| (one["surface"].as_str().expect("a name"), one["flank"].as_str()))
            .collect();
        for (name, hand) in &hands {
            let is_between = ["root", "tip"].iter().any(|part| name.ends_with(part));
            assert_eq!(hand.is_none(), is_between, "{spec}: {name} {hand:?}");
        }
        let of = |side: &str, other: &str| -> Vec<Option<&str>> {
            let is_meant = |name: &str| name.contains(side) && !name.contains(other);
            hands.iter().filter(|(name, hand)| is_meant(name) && hand.is_some()).map(|(_, hand)| *hand).collect()
        };
        let sides = if spec.ends_with("worm_wheel.chain") { ["lower", "upper"] } else { ["concave", "convex"] };
        let [one, two] = [of(sides[0], sides[1]), of(sides[1], sides[0])];
        assert!(one.len() > 1 && one.iter().all(|hand| *hand == one[0]), "{spec}: {hands:?}");
        assert!(two.len() > 1 && two.iter().all(|hand| *hand == two[0] && *hand != one[0]), "{spec}: {hands:?}");
    }
}

/// Sides are called as what they are: a root has no tip, a fillet that is sampled by z no toe, and a thread no faces.
#[test]
fn sides_are_called_as_what_they_are() {
    let out = folder("measure_sides");
    let told = measure(&out, &[PINION]);
    let ends = |told: &Value, surface: &str| {
        let all = told["flanks"].as_array().expect("flanks");
        let one = all.iter().find(|one| one["surface"] == surface).expect("it is measured");
        [&one["rows"], &one["columns"]].map(|ends| format!("{} to {}", ends[0], ends[1]).replace('"', ""))
    };
    assert_eq!(ends(&told, "convex"), ["root to tip", "toe to heel"]);
    assert_eq!(ends(&told, "convex_fillet"), ["root to tip", "inner end to outer end"]);
    assert_eq!(ends(&told, "root"), ["left side to right side", "inner end to outer end"]);
    // on the left, seen along the space, lies the flank that faces right
    let file = out.join("pinion_19x62.grid.csv");
    let grid = |surface: &str| nominal(&file, surface, "grid");
    let middle = |grid: &[Nominal], row: usize| grid.iter().find(|(place, ..)| *place == [row, 5]).expect("a point").1;
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let (root, right) = (grid("root"), grid("convex_fillet"));
    assert!(right.iter().all(|(_, [x, y, _], n)| x * n[1] - y * n[0] > 0.0), "it faces right");
    assert!(apart(middle(&root, 1), middle(&right, 1)) < apart(middle(&root, 5), middle(&right, 1)));
    let outwards = |grid: &[Nominal]| (1..9).all(|column| radius(grid[column].1) > radius(grid[column - 1].1));
    assert!(outwards(&root) && outwards(&right));
    // the worm is asked for over nearly two turns of its thread, in the direction of the rows
    let told = measure(&out, &["specs/double_envelope/hourglass_worm_wheel.chain", "--surface", "worm"]);
    assert_eq!(ends(&told, "worm"), ["root to tip", "lower end to upper end"]);
    assert_eq!(told["flanks"][0]["flank"], Value::Null);
    let worm = nominal(&out.join("hourglass_worm_wheel.grid.csv"), "worm", "grid");
    assert!((9..45).all(|at| radius(worm[at].1) > radius(worm[at - 9].1)), "from root to tip");
    assert!((1..9).all(|column| worm[column].1[2] > worm[column - 1].1[2]), "along the thread");
}

fn radius([x, y, _]: [f64; 3]) -> f64 {
    x.hypot(y)
}

#[test]
fn a_bevel_grid_runs_from_root_to_tip_and_toe_to_heel_on_the_flank_that_is_sampled() {
    let out = folder("measure_bevel");
    let told = measure(&out, &[PINION, "--surface", "concave,convex"]);
    assert_eq!(told["flanks"][0]["rows"], serde_json::json!(["root", "tip"]));
    assert_eq!(told["flanks"][0]["columns"], serde_json::json!(["toe", "heel"]));
    let hands = [0, 1].map(|k| told["flanks"][k]["flank"].as_str().expect("a hand").to_string());
    assert!(hands == ["left", "right"] || hands == ["right", "left"], "{hands:?}");
    for (surface, hand) in [("concave", &hands[0]), ("convex", &hands[1])] {
        let grid = nominal(&out.join("pinion_19x62.grid.csv"), surface, "grid");
        assert_eq!(grid.len(), 45);
        let at = |row: usize, column: usize| grid[(row - 1) * 9 + column - 1];
        for (index, (place, position, normal)) in grid.iter().enumerate() {
            assert_eq!(*place, [index / 9 + 1, index % 9 + 1]);
            assert!((dot(*normal, *normal) - 1.0).abs() < 1e-12);
            // out of the material: it leans to the tip, and the tooth lies behind a flank, seen along the tooth
            let [x, y, _] = *position;
            let around = (x * normal[1] - y * normal[0]) / x.hypot(y);
            assert_eq!(around > 0.0, hand == "right", "{surface} {place:?}: {around}");
        }
        let rho = |(_, [x, y, _], _): Nominal| x.hypot(y);
        assert!((1..=9).all(|column| (1..5).all(|row| rho(at(row + 1, column)) > rho(at(row, column)))));
        assert!((1..=5).all(|row| (1..9).all(|column| rho(at(row, column + 1)) > rho(at(row, column)))));
        let middle = nominal(&out.join("pinion_19x62.grid.csv"), surface, "middle");
        assert!((0..3).all(|k| (middle[0].1[k] - at(3, 5).1[k]).abs() < 1e-9), "the middle of an odd grid");
        let shown =
            told["flanks"].as_array().unwrap().iter().find(|one| one["surface"] == surface).expect("it is told");
        let [x, y, z] = middle[0].1;
        for (key, value) in [("rho_mm", x.hypot(y)), ("z_mm", z), ("angle_deg", y.atan2(x).to_degrees())] {
            assert!((shown["middle"][key].as_f64().expect("a number") - value).abs() < 1e-9, "{key}: {shown}");
        }
    }
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("pinion_19x62.grid.json")).unwrap()).expect("JSON");
    let first = &file["flanks"][0]["parts"][0]["points"][0];
    assert_eq!(first["position"][0], nominal(&out.join("pinion_19x62.grid.csv"), "concave", "grid")[0].1[0]);
}

/// Without margins and with as many rows and columns, the grid's points are those of `flank solve`.
#[test]
fn the_grid_lies_on_the_solved_surface() {
    let out = folder("measure_solved");
    measure(&out, &[PINION, "--surface", "convex", "--rows", "15", "--columns", "31", "--margin", "0"]);
    let grid = nominal(&out.join("pinion_19x62.grid.csv"), "convex", "grid");
    let run = flank(&["solve", PINION, "--no-picture", "--format", "json", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0));
    let solved: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("pinion_19x62.json")).unwrap()).expect("JSON");
    let convex =
        solved["surfaces"].as_array().unwrap().iter().find(|one| one["name"] == "convex").expect("it is solved");
    let points = convex["points"].as_array().unwrap();
    assert_eq!(points.len(), grid.len());
    for (point, (place, position, normal)) in points.iter().zip(grid) {
        assert_eq!(
            [1, 1].map(|one| one as u64),
            [place[0] as u64 - point["i"].as_u64().unwrap(), place[1] as u64 - point["j"].as_u64().unwrap()]
        );
        for k in 0..3 {
            assert!((point["position"][k].as_f64().unwrap() - position[k]).abs() < 1e-9);
            assert!((point["normal"][k].as_f64().unwrap() - normal[k]).abs() < 1e-9);
        }
    }
}

#[test]
fn cylindrical_gears_have_profile_and_lead_lines() {
    let out = folder("measure_lines");
    let told = measure(&out, &["specs/hobbing/helical_gear.chain", "--lines", "21", "--margin", "0.1,0.2"]);
    assert_eq!(told["flanks"][0]["columns"], serde_json::json!(["lower face", "upper face"]));
    let file = out.join("helical_gear.grid.csv");
    let [profile, lead] = ["profile", "lead"].map(|part| nominal(&file, "lower_flank", part));
    assert_eq!((profile.len(), lead.len()), (21, 21));
    assert!(profile.iter().enumerate().all(|(k, point)| point.0 == [k + 1, 1] && point.1[2].abs() < 1e-9));
    assert!(lead.windows(2).all(|pair| pair[1].1[2] > pair[0].1[2]));
    let rho = |point: &Nominal| point.1[0].hypot(point.1[1]);
    assert!(lead.iter().all(|point| (rho(point) - rho(&lead[0])).abs() < 1e-9), "a lead line has one diameter");
    assert!((rho(&profile[10]) - rho(&lead[10])).abs() < 1e-9);
}

/// Known deviations along the normals, and a turn of the whole gear on the machine, come back.
#[test]
fn known_deviations_come_back() {
    let out = folder("measure_back");
    measure(&out, &[PINION, "--surface", "concave"]);
    let grid = nominal(&out.join("pinion_19x62.grid.csv"), "concave", "grid");
    let lever = |(_, [x, y, _], normal): &Nominal| x * normal[1] - y * normal[0];
    // a bow with a bias in mm, without the part that a turn would take away
    let raw = |at: usize| 0.02 * (at as f64).sin() + 0.001 * at as f64;
    let share = grid.iter().enumerate().map(|(at, point)| raw(at) * lever(point)).sum::<f64>()
        / grid.iter().map(|point| lever(point).powi(2)).sum::<f64>();
    let off: Vec<f64> = grid.iter().enumerate().map(|(at, point)| raw(at) - share * lever(point)).collect();
    let (sine, cosine) = 0.7f64.sin_cos();
    let moved = |(point, off): (&Nominal, &f64)| -> [f64; 3] { [0, 1, 2].map(|k| point.1[k] + off * point.2[k]) };
    let line = |point: &Nominal, cells: String| format!("concave,grid,{},{},{cells}\n", point.0[0], point.0[1]);
    let mut tables = [
        "surface,part,row,column,x,y,z\n",
        "surface,part,row,column,x,y,z\n",
        "surface,part,row,column,deviation_um\n",
    ]
    .map(str::to_string);
    for both in grid.iter().zip(&off) {
        let [x, y, z] = moved(both);
        tables[0] += &line(both.0, format!("{x},{y},{z}"));
        tables[1] += &line(both.0, format!("{},{},{z}", x * cosine - y * sine, x * sine + y * cosine));
        tables[2] += &line(both.0, format!("{}", 1e3 * both.1));
    }
    for (table, turn, more) in [
        (&tables[0], 0.0, &["--no-align"][..]),
        (&tables[0], 0.0, &[]),
        (&tables[1], -0.7, &[]),
        (&tables[2], 0.0, &[]),
    ] {
        let file = written(&out, "measured.csv", table);
        let arguments = ["deviation", PINION, "concave", "--measured", &file, "--json", "--out", out.to_str().unwrap()];
        let run = flank(&[&arguments[..], more].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        assert!((told["turn_deg"].as_f64().expect("a turn").to_radians() - turn).abs() < 1e-10, "{told}");
        are_the_numbers_of(&told, &grid, &off);
        let found = deviations(&out, "pinion_19x62.concave.measured.deviation.csv");
        for (found, off) in found.iter().zip(&off) {
            assert!((1e-3 * found - off).abs() < 1e-9, "{found} um, {off} mm");
        }
        assert_eq!(found.len(), 45);
        assert!(out.join("pinion_19x62.concave.measured.deviation.svg").exists());
    }
}

/// The numbers of a table of 5 rows and 9 columns against the points that it is made of, deviations in mm.
fn are_the_numbers_of(told: &Value, grid: &[Nominal], off: &[f64]) {
    let number = |key: &str| told[key].as_f64().expect("a number");
    let is =
        |found: f64, expected: f64| assert!((found - expected).abs() < 2e-6, "{found} instead of {expected}: {told}");
    is(number("lowest_um"), 1e3 * off.iter().copied().fold(f64::INFINITY, f64::min));
    is(number("highest_um"), 1e3 * off.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    is(number("rms_um"), 1e3 * (off.iter().map(|off| off * off).sum::<f64>() / 45.0).sqrt());
    is(number("middle_um"), 1e3 * off[2 * 9 + 4]);
    let [x, y, _] = grid[2 * 9 + 4].1;
    is(number("turn_mm"), x.hypot(y) * number("turn_deg").to_radians());
    // a slope is what it rises over the way from end to end through the middle
    for (k, [from, to]) in [[4, 4 * 9 + 4], [2 * 9, 2 * 9 + 8]].into_iter().enumerate() {
        let way = (0..3).map(|k| (grid[to].1[k] - grid[from].1[k]).powi(2)).sum::<f64>().sqrt();
        let of = &told["directions"][k];
        let slope = of["slope_um"].as_f64().expect("a slope");
        is(of["slope_arcmin"].as_f64().expect("an angle"), (1e-3 * slope / way).atan().to_degrees() * 60.0);
    }
}

/// Where the middle was not measured, the rest still has its numbers.
#[test]
fn a_middle_that_is_missing_hides_nothing() {
    let out = folder("measure_no_middle");
    let table = "row,column,deviation_um\n1,1,3\n1,3,-4\n3,1,0\n3,3,5\n";
    let file = written(&out, "corners.csv", table);
    let run = flank(&[
        "deviation",
        PINION,
        "concave",
        "--measured",
        &file,
        "--no-align",
        "--no-picture",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(run.status.code(), Some(3));
    // (9 + 16 + 0 + 25) / 4 = 3.5355²
    assert!(text(&run.stdout).contains("range        -4.000 .. 5.000 um, rms 3.536\n"), "{}", text(&run.stdout));
}

/// A last row and a last column that were not measured do not move the points that were.
#[test]
fn ends_that_were_not_measured_keep_their_place() {
    let out = folder("measure_ends");
    measure(&out, &[PINION, "--surface", "concave"]);
    let grid = nominal(&out.join("pinion_19x62.grid.csv"), "concave", "grid");
    let lines = grid.iter().map(|([row, column], [x, y, z], _)| match (row, column) {
        (5, _) | (_, 9) => format!("concave,grid,{row},{column},,,\n"),
        _ => format!("concave,grid,{row},{column},{x},{y},{z}\n"),
    });
    let table = "surface,part,row,column,x,y,z\n".to_string() + &lines.collect::<String>();
    let file = written(&out, "measured.csv", &table);
    let run = flank(
        &[
            &["deviation", PINION, "concave", "--measured", &file, "--no-align", "--no-picture", "--json"][..],
            &["--out", out.to_str().unwrap()],
        ]
        .concat(),
    );
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("not measured: 13 of 45 points"), "{}", text(&run.stderr));
    let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    for end in ["lowest_um", "highest_um"] {
        // coordinates are written with all their digits
        assert!(told[end].as_f64().expect("a number").abs() < 1e-6, "{told}");
    }
}

/// Without the lines of a last row the others would be spread over the flank: where the points say so that is an error, and in any case
/// the number of rows can be said.
#[test]
fn lines_that_are_not_there_move_no_others() {
    let out = folder("measure_fewer");
    let at = out.to_str().expect("a plain path");
    measure(&out, &[PINION, "--surface", "concave"]);
    let grid = nominal(&out.join("pinion_19x62.grid.csv"), "concave", "grid");
    // the lines of so many rows and columns
    let table = |titles: &str, cells: &dyn Fn(&Nominal) -> String, there: [usize; 2]| {
        let lines = grid.iter().filter(|(place, ..)| place[0] <= there[0] && place[1] <= there[1]);
        let lines = lines.map(|point| format!("{},{},{}\n", point.0[0], point.0[1], cells(point)));
        written(&out, "measured.csv", &(format!("row,column,{titles}\n") + &lines.collect::<String>()))
    };
    let run = |file: &str, more: &[&str]| {
        let arguments = ["deviation", PINION, "concave", "--measured", file, "--no-picture", "--json", "--out", at];
        flank(&[&arguments[..], more].concat())
    };
    let place = |point: &Nominal| point.1.map(|x| x.to_string()).join(",");
    for (there, said) in [([4, 9], ["--rows", "5"]), ([5, 8], ["--columns", "9"]), ([5, 9], ["--margin", "0.05"])] {
        let file = table("x,y,z", &place, there);
        let wrong = if said[0] == "--margin" { &["--margin", "0.2"][..] } else { &[] };
        for more in [&["--no-align"][..], &[]] {
            let refused = run(&file, &[wrong, more].concat());
            let told = text(&refused.stderr);
            assert_eq!(refused.status.code(), Some(1), "{told}");
            assert!(told.contains(" mm beside its nominal point, and half the way to the next one is "), "{told}");
        }
        let good = run(&file, &said);
        let told: Value = serde_json::from_slice(&good.stdout).expect("JSON");
        // coordinates are written with all their digits
        assert!(told["rms_um"].as_f64().expect("a number") < 1e-6, "{told}");
    }
    let file = table("deviation_um", &|point| point.0[0].to_string(), [4, 9]);
    let told: Value = serde_json::from_slice(&run(&file, &["--rows", "5", "--no-align"]).stdout).expect("JSON");
    let number = |key: &str| told[key].as_f64().expect("a number");
    assert_eq!((number("asked"), number("known")), (45.0, 36.0), "{told}");
    assert!((number("lowest_um") - 1.0).abs().max((number("highest_um") - 4.0).abs()) < 1e-9, "{told}");
    let few = run(&file, &["--rows", "3"]);
    assert!(text(&few.stderr).contains("4 rows are named, more than --rows 3"), "{}", text(&few.stderr));
    let without = flank(&["deviation", PINION, "concave", "--reference", "convex", "--rows", "5"]);
    assert_eq!(without.status.code(), Some(2), "{}", text(&without.stderr));
}

/// What another setting leaves, measured against the nominal flank, is what the exact derivative says, to first order.
#[test]
fn a_neighbouring_setting_is_measured_as_its_derivative_says() {
    let out = folder("measure_neighbour");
    let dense = ["--rows", "15", "--columns", "31", "--margin", "0"];
    const STEP: f64 = 1e-3;
    let sheet = flank(&["derive", PINION]);
    let setting = text(&sheet.stdout)
        .lines()
        .find(|line| line.trim().starts_with("m.radial_distance = "))
        .expect("a setting")
        .to_string();
    let value: f64 = setting.rsplit('=').next().unwrap().trim().trim_end_matches(" mm").parse().expect("mm");
    let set = format!("m.radial_distance={} mm", value + STEP);
    measure(&out, &[&[PINION, "--surface", "concave", "--set", &set][..], &dense].concat());
    let file = out.join("pinion_19x62.grid.csv");
    let arguments =
        ["deviation", PINION, "concave", "--measured", file.to_str().unwrap(), "--margin", "0", "--no-align"];
    let run = flank(&[&arguments[..], &["--no-picture", "--out", out.to_str().unwrap()]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found = deviations(&out, "pinion_19x62.concave.measured.deviation.csv");
    let run =
        flank(&["solve", PINION, "--sensitivity", "--no-picture", "--format", "json", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0));
    let solved: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("pinion_19x62.json")).unwrap()).expect("JSON");
    let concave = &solved["surfaces"][0];
    let fields = concave["fields"].as_array().unwrap();
    let field = fields.iter().position(|field| field["name"] == "d_normal/d_m.radial_distance").expect("a field");
    assert_eq!((&concave["name"], &fields[field]["unit"]), (&"concave".into(), &"um/mm".into()));
    let points = concave["points"].as_array().unwrap();
    assert_eq!(points.len(), found.len());
    let largest = found.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    assert!(largest > 0.1, "{largest} um");
    for (point, found) in points.iter().zip(found) {
        let expected = point["fields"][field].as_f64().unwrap() * STEP;
        // the second order of a thousandth of a mm, with curvatures below 0.1 per mm
        assert!((found - expected).abs() < 1e-3 * largest, "{found} um, {expected} um");
    }
}

/// What has neither root nor tip is told, and hides nothing else: it is an error only where it was named, or where there is nothing else.
#[test]
fn what_has_no_grid_hides_nothing_else() {
    let out = folder("measure_no_grid");
    let shaped = ["specs/bodies/shaped_gear_body.chain", "--job", "shaped_gear_body"];
    let told = measure(&out, &shaped);
    let flanks = told["flanks"].as_array().expect("flanks");
    let names: Vec<&str> = flanks.iter().map(|one| one["surface"].as_str().expect("a name")).collect();
    assert_eq!(names, ["flank_plus", "flank_minus", "fillet_plus", "fillet_minus"]);
    let remarks = told["remarks"].as_array().expect("remarks");
    assert_eq!(remarks.len(), 1, "{remarks:?}");
    assert_eq!((&remarks[0]["kind"], &remarks[0]["of"]), (&"no_grid".into(), &"root".into()));
    assert!(remarks[0]["place"].is_object(), "{remarks:?}");
    let content = std::fs::read_to_string(out.join("shaped_gear_body.grid.csv")).expect("written");
    assert!(content.contains("\nfillet_minus,left,grid,5,9,") && !content.contains("\nroot,"), "{content}");
    // people are told on stderr
    let at = out.to_str().expect("a plain path");
    let run = flank(&[&["measure"], &shaped[..], &["--out", at]].concat());
    assert_eq!(run.status.code(), Some(0));
    let why = "root is not measured: the grid of `root` does not tell root and tip from the length of the tooth";
    assert!(text(&run.stderr).contains(why), "{}", text(&run.stderr));
    for named in ["root", "flank_plus,root"] {
        let run = flank(&[&["measure"], &shaped[..], &["--surface", named, "--out", at]].concat());
        assert_eq!(run.status.code(), Some(1), "{named}");
        assert!(text(&run.stderr).contains("error: the grid of `root` does not tell"), "{}", text(&run.stderr));
    }
}

#[test]
fn nothing_to_measure_is_an_error() {
    let out = folder("measure_nothing");
    let at = out.to_str().expect("a plain path");
    let run = flank(&["measure", "specs/grinding/thread_wheel.chain", "--job", "zi", "--out", at]);
    assert_eq!(run.status.code(), Some(1));
    for wheel in ["plus_wheel", "minus_wheel"] {
        let why = format!("{wheel} is not measured: `{wheel}` is sampled at one value of `spindle` only");
        assert!(text(&run.stderr).contains(&why), "{}", text(&run.stderr));
    }
}

#[test]
fn what_is_missing_or_wrong_is_told() {
    let out = folder("measure_wrong");
    let at = out.to_str().unwrap();
    let undercut = flank(&["measure", "specs/hobbing/undercut_gear.chain", "--out", at]);
    assert_eq!(undercut.status.code(), Some(3));
    let told = text(&undercut.stderr);
    assert!(told.contains("not solved: 18 of 45 points of flank_plus, grid (row, column)"), "{told}");
    assert!(told.contains("(undercut): (1, 1) (1, 2)"), "{told}");
    let content = std::fs::read_to_string(out.join("undercut_gear.grid.csv")).expect("written");
    assert!(content.contains("flank_plus,left,grid,1,1,,,,,,,undercut"), "{content}");
    let partial = written(&out, "partial.csv", "row,column,deviation_um\n1,1,3\n2,2,4\n3,3,5\n");
    for (arguments, code, words) in [
        (&["measure", PINION, "--surface", "flank"][..], 1, "there is no surface `flank`"),
        (&["measure", PINION, "--rows", "1"], 2, "write a whole number from 2 to 1000"),
        (&["measure", PINION, "--margin", "0.5"], 2, "from 0 to below 0.5"),
        (&["deviation", PINION, "concave"], 2, "`concave` is compared with: --reference SURFACE or --measured FILE"),
        (&["measure", PINION, "--rows", "-1"], 2, "write a whole number from 2 to 1000"),
        (&["measure", PINION, "--margin", "-0.1"], 2, "write one share or two"),
        (&["deviation", PINION, "concave", "--reference", "convex", "--margin", "0.1"], 2, "--margin says where"),
        (
            &["deviation", PINION, "concave", "--measured", "none.csv"],
            1,
            "error[E0001]: cannot read `none.csv`: there is no such file",
        ),
        (&["deviation", PINION, "concave", "--measured", PINION], 1, "there is no column `row`"),
        (&["deviation", PINION, "concave", "--measured", &partial], 3, "not measured: 6 of 9 points"),
    ] {
        let run = flank(&[arguments, &["--out", at]].concat());
        assert_eq!(run.status.code(), Some(code), "{arguments:?}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains(words), "{arguments:?}: {}", text(&run.stderr));
    }
}

/// The file of a machine stays, whatever it is called.
#[test]
fn what_was_measured_is_not_written_over() {
    let out = folder("measure_own_input");
    let at = out.to_str().unwrap();
    let table = "row,column,deviation_um\n1,1,3\n1,2,-4\n2,1,0\n2,2,5\n";
    let file = written(&out, "pinion_19x62.concave.measured.csv", table);
    let run = flank(&["deviation", PINION, "concave", "--measured", &file, "--no-picture", "--out", at]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(std::fs::read_to_string(&file).expect("still there"), table);
    assert!(out.join("pinion_19x62.concave.measured.deviation.csv").exists());
    let file = written(&out, "pinion_19x62.concave.measured.deviation.csv", table);
    let run = flank(&["deviation", PINION, "concave", "--measured", &file, "--no-picture", "--out", at]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("is what this command reads"), "{}", text(&run.stderr));
    assert_eq!(std::fs::read_to_string(&file).expect("still there"), table);
}

#[cfg(unix)]
#[test]
fn what_has_no_end_is_not_read() {
    for (file, why) in support::endless(&folder("measured_endless")) {
        let run = flank(&["deviation", PINION, "concave", "--measured", &file]);
        assert_eq!(run.status.code(), Some(1), "{file}");
        let told = text(&run.stderr);
        assert!(told.contains(&format!("error[E0001]: cannot read `{file}`: {why}")), "{told}");
    }
}

/// A rack that lies 0.05 mm further along the direction in which its spaces follow each other is the nominal one, shifted. Held as it lies
/// the flank that faces that way has too much material, 50 um cos 20 deg = 46.985 um along the normal, everywhere.
#[test]
fn a_rack_is_shifted_onto_its_place() {
    let out = folder("measure_rack");
    let rack = "specs/bodies/rack_body.chain";
    let folder = out.to_str().expect("a plain path");
    measure(&out, &[rack, "--surface", "flank_minus"]);
    let line = |([row, column], [x, y, z], _): &Nominal| format!("{row},{column},{x:?},{:?},{z:?}\n", y + 0.05);
    let moved: String = nominal(&out.join("rack_body.grid.csv"), "flank_minus", "grid").iter().map(line).collect();
    let file = written(&out, "moved.csv", &format!("row,column,x,y,z\n{moved}"));
    let held = ["deviation", rack, "flank_minus", "--measured", &file, "--no-picture", "--out", folder];
    let told = |more: &[&str]| -> Value {
        let run = flank(&[&held[..], &["--json"], more].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        serde_json::from_slice(&run.stdout).expect("JSON")
    };
    let number = |told: &Value, key: &str| told[key].as_f64().expect("a number");
    let aligned = told(&[]);
    assert!((number(&aligned, "shift_mm") + 0.05).abs() < 1e-9 && aligned["turn_deg"].is_null(), "{aligned}");
    assert!(number(&aligned, "rms_um") < 1e-6, "{aligned}");
    let as_it_lies = told(&["--no-align"]);
    let off = 50.0 * 20f64.to_radians().cos();
    for key in ["lowest_um", "highest_um"] {
        assert!((number(&as_it_lies, key) - off).abs() < 1e-6, "{as_it_lies}");
    }
    let shown = text(&flank(&held).stdout);
    assert!(shown.contains("  shift along y -0.050000 mm\n") && !shown.contains("turn about z"), "{shown}");
    // no setting is to be corrected
    let fitted = ["fit", rack, "flank_minus", "--measured", &file, "--vary", "r.pressure_angle", "--json"];
    let run = flank(&fitted);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert!((number(&found, "shift_mm") + 0.05).abs() < 1e-9 && found["turn_deg"].is_null(), "{found}");
    assert!(number(&found["identification"]["settings"][0], "change").abs() < 1e-9, "{found}");
    assert!(number(&found, "before_um") < 1e-6, "{found}");
}

/// A point that was written down 5 m off does not keep the others from their place: before, nothing was shifted, without a word.
#[test]
fn one_point_far_off_leaves_the_others_in_place() {
    let out = folder("measure_far");
    let rack = "specs/bodies/rack_body.chain";
    measure(&out, &[rack, "--surface", "flank_minus"]);
    let line = |([row, column], at, normal): &Nominal| {
        let off = if [*row, *column] == [3, 5] { 5000.0 } else { 0.0 };
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| at[k] + off * normal[k]);
        format!("{row},{column},{x:?},{:?},{z:?}\n", y + 0.05)
    };
    let moved: String = nominal(&out.join("rack_body.grid.csv"), "flank_minus", "grid").iter().map(line).collect();
    let file = written(&out, "far.csv", &format!("row,column,x,y,z\n{moved}"));
    let folder = out.to_str().expect("a plain path");
    let held = ["deviation", rack, "flank_minus", "--measured", &file, "--no-picture", "--out", folder, "--json"];
    let fitted = ["fit", rack, "flank_minus", "--measured", &file, "--vary", "r.pressure_angle", "--json"];
    for arguments in [&held[..], &fitted] {
        let run = flank(arguments);
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
        assert!(text(&run.stderr).contains("no deviation at 1 "), "{}", text(&run.stderr));
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let shift = told["shift_mm"].as_f64().expect("a shift");
        assert!((shift + 0.05).abs() < 1e-9, "{told}");
    }
}

/// What is the profile and what the length is told by the surface, however wide or deep the sample is: a gear narrower than its teeth are
/// deep, racks, whose teeth stand in the direction of x, and a short piece of a thread.
#[test]
fn profile_and_length_are_told_whatever_is_longer() {
    let out = folder("measure_short");
    let lies = |arguments: &[&str], surface: &str| {
        let told = measure(&out, &[arguments, &["--rows", "3", "--columns", "3"]].concat());
        let all = told["flanks"].as_array().expect("flanks").clone();
        let one = all.iter().find(|one| one["surface"] == surface).expect("it is measured").clone();
        let ends = |key: &str| format!("{} to {}", one[key][0], one[key][1]).replace('"', "");
        (one["flank"].as_str().map(str::to_string), ends("rows"), ends("columns"))
    };
    let is = |hand: Option<&str>, rows: &str, columns: &str| (hand.map(str::to_string), rows.into(), columns.into());
    let faces = "lower face to upper face";
    for width in ["1 mm", "5 mm", "6 mm", "60 mm"] {
        let set = format!("face_width={width}");
        let gear = ["specs/hobbing/helical_gear.chain", "--set", &set];
        for (surface, hand) in [("lower_flank", "right"), ("upper_flank", "left")] {
            assert_eq!(lies(&gear, surface), is(Some(hand), "root to tip", faces), "{width}");
            let grid = nominal(&out.join("helical_gear.grid.csv"), surface, "grid");
            assert!((0..3).all(|k| (radius(grid[k].1) - radius(grid[0].1)).abs() < 1e-6), "row 1 lies at the root");
            assert!(radius(grid[8].1) > radius(grid[0].1) + 4.0, "{width}: row 3 lies at the tip");
        }
    }
    // seen along z, x up, y is to the right: a normal to -y points to the left
    for (spec, job) in
        [("specs/bodies/rack_body.chain", "rack_body"), ("specs/bodies/helical_rack_body.chain", "helical_rack_body")]
    {
        for (surface, hand) in
            [("flank_minus", "right"), ("fillet_minus", "right"), ("fillet_plus", "left"), ("flank_plus", "left")]
        {
            assert_eq!(lies(&[spec], surface), is(Some(hand), "root to tip", faces), "{spec}: {surface}");
            let grid = nominal(&out.join(format!("{job}.grid.csv")), surface, "grid");
            let to_the_right = if hand == "right" { 1.0 } else { -1.0 };
            assert!(grid.iter().all(|(.., normal)| normal[1] * to_the_right > 0.0), "{surface}");
            assert!(grid[8].1[0] > grid[0].1[0] + 0.3 && grid[8].1[2] > grid[0].1[2], "{surface}: up and along");
        }
    }
    let root = lies(&["specs/bodies/helical_rack_body.chain"], "root");
    assert_eq!(root, is(None, "left side to right side", faces));
    let grid = nominal(&out.join("helical_rack_body.grid.csv"), "root", "grid");
    assert!(grid[6].1[1] > grid[0].1[1], "from the left side to the right one");
    // without a solid it is the contact that moves it as a rack; its tips point to -x, and the flank with a normal to y to the left
    assert_eq!(lies(&["specs/pairs/rack_and_pinion.chain"], "rack_flank"), is(Some("left"), "root to tip", faces));
    for half in ["0.5 mm", "3 mm", "6 mm"] {
        let wheel = std::fs::read_to_string(top().join("specs/grinding/dressed_wheel.chain")).expect("it is there");
        let wheel = wheel
            .replace("z: -3 mm .. 3 mm by 7", &format!("z: -{half} .. {half} by 7"))
            .replace("\"../", "\"../../../specs/")
            .replace("\"thread_wheel.chain\"", "\"../../../specs/grinding/thread_wheel.chain\"");
        let spec = written(&out, "wheel.chain", &wheel);
        let thread = lies(&[&spec, "--surface", "thread"], "thread");
        assert_eq!(thread, is(None, "root to tip", "lower end to upper end"), "{half}");
    }
}
