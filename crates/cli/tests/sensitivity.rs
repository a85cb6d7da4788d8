//! `flank solve --sensitivity`: how far each parameter moves each point.

mod support;

use support::{AGAIN, flank, folder, text};

/// A rack that stands off by 1 mm leaves sin α more material all over its flanks; the face width leaves them where they are.
#[test]
fn sensitivity_is_ranked_written_and_drawn() {
    let out = folder("sensitivity");
    let base = ["solve", "specs/hobbing/spur_gear.chain", "--sensitivity", "--out", out.to_str().unwrap()];
    let run = flank(&base);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for part in [
        "flank_plus moves, over 275 points, with",
        "profile_shift",
        "um/0.001",
        "no influence, ",
        "face_width",
        "integers, which have no derivative: teeth",
    ] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    let csv = std::fs::read_to_string(out.join("spur_gear.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        csv.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).expect("a column");
    let [shift, width] = ["d_normal/d_profile_shift", "d_normal/d_face_width"].map(column);
    for row in rows.iter().filter(|row| row[0].starts_with("flank_")) {
        // module 3 mm, told for 0.001
        let moved: f64 = row[shift].parse().expect("a number");
        assert!((moved - 3.0 * 20f64.to_radians().sin()).abs() < 1e-12, "{moved}");
        assert_eq!(row[width], "0");
    }
    for surface in ["flank_plus", "fillet_minus"] {
        for extension in ["png", "svg"] {
            let path = out.join(format!("spur_gear.{surface}.sensitivity.{extension}"));
            assert!(std::fs::metadata(&path).is_ok_and(|file| file.len() > 1000), "{}", path.display());
        }
    }
    let summary = flank(&[&base[..], &["--json", "--no-picture"]].concat());
    let table: serde_json::Value = serde_json::from_slice(&summary.stdout).expect("JSON");
    let sensitivity = &table["surfaces"][0]["sensitivity"];
    let rms = |k: usize| sensitivity["parameters"][k]["rms"].as_f64().expect("a number");
    assert!(rms(0) > 0.0 && rms(1) > 0.0);
    assert_eq!(sensitivity["counts"], serde_json::json!(["teeth"]));
}

/// Parameters are ranked by what a usual change of each does, not by numbers in units that cannot be compared.
#[test]
fn parameters_are_ranked_by_what_a_usual_change_does() {
    let out = folder("sensitivity_rank");
    let spec = support::written(&out, "led.chain", LED);
    let run = flank(&["solve", &spec, "--sensitivity", "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
    let table = text(&run.stdout);
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip_while(|line| !line.contains("moves, over"))
        .skip(2)
        .take_while(|line| line.contains("um/"))
        .map(|line| line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect())
        .collect();
    let moved: Vec<f64> = rows.iter().map(|row| row[5].parse().expect("a number")).collect();
    assert!(moved.len() > 3 && moved.windows(2).all(|pair| pair[0] >= pair[1]), "{table}");
    let of = |name: &str| rows.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name} in {table}"));
    for (name, unit, change) in [
        ("b.radius", "um/mm", "0.01 mm"),
        ("m.tilt", "um/arcmin", "1 arcmin"),
        ("lead", "um/(mm/rad)", "0.004 mm/rad"),
        ("share", "um/0.001", "0.0025"),
        ("more", "um/0.001", "0.02"),
    ] {
        let row = of(name);
        assert_eq!([row[3], row[4]], [unit, change], "{table}");
    }
    // 1 um/mm and a thousandth of 4 mm/rad
    let [lead, by]: [f64; 2] = [of("lead")[1], of("lead")[5]].map(|cell| cell.parse().expect("a number"));
    assert!((by - 0.004 * lead).abs() < 1e-3 * by, "{lead} {by}");
}

/// A ball that is led along a thread, with a parameter of each kind.
const LED: &str = r#"
machine led {
    param tilt : angle = 0 deg
    axis X : linear
    axis Z : linear
    axis C : rotary
    frame bed
    frame slide in bed = rotate_y(tilt) translate(X, 0 mm, Z)
    frame work  in bed = rotate_z(C)
}
tool led_ball {
    param radius : length = 5 mm
    surface face(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) {
        at = [-radius * cos(u) * cos(v), radius * cos(u) * sin(v), radius * sin(u)]
        body towards [1, 0, 0]
    }
}
job led_thread {
    param lead : length / angle = 4 mm/rad
    param share : number = 2.5
    param more : number in -10 .. 10 = 0
    machine m = led
    tool b = led_ball
    mount b on m.slide
    motion turn : angle in 0 deg .. 360 deg
    drive m.C = turn
    drive m.X = 20 mm * (share + more) / 2.5
    drive m.Z = lead * turn
    surface groove in m.work = envelope(b.face, over: turn)
    sample groove { u: -50 deg .. 50 deg by 5, turn: 10 deg .. 350 deg by 9 }
}
"#;

/// What is told of a parameter is what two solves on both sides of the job's own value find: of a length, an angle and a plain
/// number, in the units that stand beside them. A parameter that counts has no such influence, and none is told.
#[test]
fn influences_are_those_of_two_solves() {
    let out = folder("influences");
    let solve = |more: &[&str]| {
        let command = ["solve", "specs/hobbing/spur_gear.chain", "--sensitivity", "--no-picture", "--format", "json"];
        let run = flank(&[&command[..], more, &["--out", out.to_str().unwrap()]].concat());
        assert_eq!(run.status.code(), Some(0), "{more:?}: {}", text(&run.stderr));
        let file = std::fs::read_to_string(out.join("spur_gear.json")).expect("written");
        (text(&run.stdout), serde_json::from_str::<serde_json::Value>(&file).expect("JSON"))
    };
    let table = solve(&[]).0;
    let (told, nominal) = solve(&["--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    // a parameter, values on both sides of its own, how many of the unit these are off it, the unit
    for (name, values, off, unit) in [
        ("module", ["2.999 mm", "3.001 mm"], 1e-3, "um/mm"),
        ("r.pressure_angle", ["19.995 deg", "20.005 deg"], 0.3, "um/arcmin"),
        ("profile_shift", ["0.1999", "0.2001"], 0.1, "um/0.001"),
    ] {
        let moved = values.map(|value| solve(&["--set", &format!("{name}={value}")]).1);
        let row = |line: &&str| line.split_whitespace().next() == Some(name);
        let mut rows = table.lines().filter(row).map(|line| line.split_whitespace().skip(1).collect::<Vec<_>>());
        for (at, surface) in nominal["surfaces"].as_array().expect("surfaces").iter().enumerate() {
            let fields = surface["fields"].as_array().expect("fields");
            let field = fields.iter().position(|field| field["name"] == format!("d_normal/d_{name}")).expect("a field");
            assert_eq!(fields[field]["unit"], unit);
            let found = differences(surface, [0, 1].map(|side| &moved[side]["surfaces"][at]), off);
            let largest = found.iter().fold(0.0, |largest: f64, um| largest.max(um.abs()));
            let rms = (found.iter().map(|um| um * um).sum::<f64>() / found.len() as f64).sqrt();
            // a difference leaves the square of the step, below 1e-7 of it, and points are solved to 1e-11 mm
            let near = 1e-7 * largest + 1e-8 / off;
            for (point, found) in surface["points"].as_array().expect("points").iter().zip(&found) {
                let exact = point["fields"][field].as_f64().expect("a number");
                assert!((exact - found).abs() < near, "{name}: {exact} {found}");
            }
            let of = &told["surfaces"][at]["sensitivity"];
            let one = of["parameters"].as_array().expect("a list").iter().find(|one| one["name"] == name);
            let one = one.unwrap_or_else(|| panic!("{name} moves {}", surface["name"]));
            let shown = rows.next().expect("a row of the table");
            assert_eq!((&one["unit"], shown[2]), (&unit.into(), unit));
            for (key, found, shown) in [("rms", rms, shown[0]), ("largest", largest, shown[1])] {
                let exact = one[key].as_f64().expect("a number");
                assert!((exact - found).abs() < near, "{name} {key}: {exact} {found}");
                assert!((shown.parse::<f64>().expect("a number") - exact).abs() <= 5.1e-5, "{name} {key}: {shown}");
            }
            // ranked by 0.01 mm, one arcminute, a thousandth of 0.2
            let usual = &one["usual_change"];
            let times = match unit {
                "um/mm" => 0.01,
                "um/arcmin" => 1.0,
                _ => 0.2,
            };
            for (key, by) in [("rms", "rms_um"), ("largest", "largest_um")] {
                let [told, by] = [&one[key], &usual[by]].map(|number| number.as_f64().expect("a number"));
                assert!((by - times * told).abs() < 1e-12 * told, "{name}: {one}");
            }
            assert_eq!(of["counts"], serde_json::json!(["teeth"]));
            assert!(!fields.iter().any(|field| field["name"] == "d_normal/d_teeth"));
        }
    }
}

/// How far points lie from the one surface to the other along the nominal normals, um for each of the units that both are off.
fn differences(nominal: &serde_json::Value, sides: [&serde_json::Value; 2], off: f64) -> Vec<f64> {
    let vector = |point: &serde_json::Value, key: &str| [0, 1, 2].map(|k| point[key][k].as_f64().expect("a number"));
    let points = nominal["points"].as_array().expect("points").iter().enumerate();
    let of = |(at, point): (usize, &serde_json::Value)| {
        let [below, above] = sides.map(|side| vector(&side["points"][at], "position"));
        let normal = vector(point, "normal");
        1e3 * (0..3).map(|k| normal[k] * (above[k] - below[k])).sum::<f64>() / (2.0 * off)
    };
    points.map(of).collect()
}

/// A tool that is another one with one other setting moves with all others of that one, from wherever these have their values.
#[test]
fn a_tool_that_is_another_one_again_moves_with_it() {
    let out = folder("sensitivity_again");
    let spec = support::written(&out, "again.chain", AGAIN);
    let moved = |more: &[&str]| {
        let asked = ["solve", &spec, "--sensitivity", "--json", "--no-picture", "--out", out.to_str().unwrap()];
        let run = flank(&[&asked[..], more].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let surface = document["surfaces"].as_array().expect("surfaces").iter().find(|of| of["name"] == "two");
        let all = surface.expect("a surface")["sensitivity"]["parameters"].clone();
        let helix = all.as_array().expect("parameters").iter().find(|of| of["name"] == "r.helix").cloned();
        helix.expect("a parameter")["rms"].as_f64().expect("a number")
    };
    let (by_definition, given) = (moved(&[]), moved(&["--set", "r.helix=15deg"]));
    assert!(given > 0.0 && (by_definition - given).abs() < 1e-12 * given, "{by_definition} and {given}");
}
