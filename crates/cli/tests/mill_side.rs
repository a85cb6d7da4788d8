//! `flank mill` with the side of a cutter: nothing is left of an involute helicoid, programs leave what was planned, and what cannot be
//! milled so is told.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text, written};

const GEAR: [&str; 7] = [
    "functions/hobbing",
    "machines/hobbing_6axis",
    "tools/involute",
    "tools/hob_zi",
    "hobbing/helical_gear",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const CROWNED: [&str; 10] = [
    "functions/hobbing",
    "machines/hobbing_6axis",
    "machines/hobbing_geared",
    "machines/hobbing_3axis",
    "tools/involute",
    "tools/hob_zi",
    "hobbing/helical_gear",
    "hobbing/crowned_gear",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const PINION: [&str; 7] = [
    "functions/bevel",
    "machines/cradle",
    "tools/face_mill",
    "functions/blanks_19x62",
    "bevel/pinion_19x62",
    "machines/five_axis_table_table",
    "tools/end_mills",
];
const CYLINDER: &str = "conical_mill(half_angle: 0 deg, tip_radius: 1.5 mm, cutting_length: 20 mm, reach: 30 mm)";
const STRIP: &str = "side z: -6 mm .. 6 mm by 1\n along rho: 51 mm .. 53.5 mm, chord 1 um\n";

fn job(specs: &[&str], (base, surface): (&str, &str), cutter: &str, milling: &str) -> String {
    let library = support::self_contained(specs);
    format!(
        "{library}\njob milled extends {base} {{\n machine mill = five_axis_table_table(work_z: 60 mm)\n tool cutter = {cutter}\n \
         mount cutter on mill.cutter\n mill part of {surface} with cutter.cutting in mill.work {{\n{milling}\n }}\n}}\n"
    )
}

fn gear(cutter: &str, milling: &str) -> String {
    job(&GEAR, ("helical_gear", "upper_flank"), cutter, milling)
}

fn pinion(cutter: &str, milling: &str) -> String {
    job(&PINION, ("pinion_19x62", "concave"), cutter, milling)
}

/// Exit code, what was printed, what was told.
fn mill(spec: &str, out: &Path, arguments: &[&str]) -> (i32, String, String) {
    let out = out.to_str().expect("a plain path");
    let run = flank(&[&["mill", spec, "--out", out][..], arguments].concat());
    (run.status.code().expect("it ends by itself"), text(&run.stdout), text(&run.stderr))
}

fn json(spec: &str, out: &Path, arguments: &[&str]) -> Value {
    let (code, told, errors) = mill(spec, out, &[arguments, &["--json"]].concat());
    assert_eq!(code, 0, "{errors}");
    serde_json::from_str(&told).expect("JSON")
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

fn left(of: &Value) -> [f64; 2] {
    [0, 1].map(|k| number(&of["left"][k]["height_um"]))
}

/// An involute helicoid is developable: a cylinder of any radius leaves nothing of it, and a cone neither.
#[test]
fn nothing_is_left_of_the_flank_of_a_helical_gear() {
    let out = folder("side_gear");
    let cone = CYLINDER.replace("half_angle: 0 deg", "half_angle: 3 deg");
    for (cutter, stock) in [(CYLINDER, 0.0), (&CYLINDER.replace("1.5 mm", "4 mm"), 0.2), (&cone, 0.0)] {
        let spec = written(&out, "milled.chain", &gear(cutter, &format!("{STRIP} stock {stock} mm")));
        let found = json(&spec, &out, &[]);
        let side = &found["side"];
        assert_eq!(side["untouched"], 0, "{side}");
        // points of the flank are solved to 1e-12 mm, and polynomials through them are as near as 1e-11 mm
        assert!(left(side).iter().all(|left| left.abs() < 1e-6), "{cutter}: {side}");
        let [low, high] = [0, 1].map(|k| number(&side["contact"][k]));
        assert!(low > number(&side["side"][0]) && high < number(&side["side"][1]), "{side}");
        assert_eq!((&found["passes"], &found["cusp"]), (&Value::from(1), &Value::Null));
        assert!([0, 1].iter().all(|k| number(&found["blocks"][k]["height_um"]).abs() <= 1.0), "{found}");
    }
}

/// A picture of one pass speaks of no ridges, and of what is rounding no place is told.
#[test]
fn one_pass_is_shown_as_one() {
    let out = folder("side_shown");
    let spec = written(&out, "milled.chain", &gear(CYLINDER, STRIP));
    let place = out.to_str().expect("a plain path");
    let run = flank(&["plot", &spec, "--job", "milled", "--what", "milling", "--format", "svg", "--out", place]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let svg = std::fs::read_to_string(out.join("milled.milling.svg")).expect("a picture");
    for words in ["what the pass leaves", "across the pass, in its middle"] {
        assert!(svg.contains(&format!("aria-label=\"{words}\"")), "{words}");
    }
    assert!(!svg.contains("ridge"), "a pass alone leaves none");
    assert!(!svg.contains("passes is drawn"), "all of them are");
    assert!(!svg.contains("0.000 \u{b5}m"), "what is rounding is not marked");
    let (_, told, _) = mill(&spec, &out, &[]);
    assert!(told.contains("side leaves  at most 0.0000 um\n"), "{told}");
}

/// A program leaves what the pass and its blocks leave.
#[test]
fn programs_leave_what_was_planned() {
    let out = folder("side_program");
    let spec = written(&out, "milled.chain", &gear(CYLINDER, STRIP));
    // half of the last decimal on each of five axes; the work is some 200 mm from the rotary ones
    let rounding = 1e3 * (3.0 * 0.5e-4 + 2.0 * 0.5e-5_f64.to_radians() * 200.0);
    for (control, extension, words) in [("linuxcnc", "ngc", &[][..]), ("siemens", "mpf", &["--tcp"][..])] {
        let planned = json(&spec, &out, &[&["--nc", control], words].concat());
        let program = out.join(format!("milled.part.{extension}"));
        let read = json(&spec, &out, &[&["--verify", program.to_str().unwrap()], words].concat());
        let verified = &read["verified"];
        assert_eq!(verified["untouched"], 0, "{verified}");
        let [most, least] = left(verified);
        let [over, under] = [0, 1].map(|k| number(&planned["blocks"][k]["height_um"]));
        assert!(most < over + rounding && least > under - rounding, "{control}: {verified} {planned}");
        assert!(most - least > 0.1 * (over - under), "{control}: {verified} {planned}");
    }
}

/// A bevel flank is no ruled surface: what is left falls with the places at which the axis is free, and with a narrower strip.
#[test]
fn a_bevel_flank_leaves_what_it_leaves() {
    let out = folder("side_bevel");
    let cone = "conical_mill(half_angle: 4 deg, tip_radius: 1 mm, cutting_length: 25 mm, reach: 40 mm)";
    let largest = |strip: &str, free: usize| {
        let milling = format!("side profilewise: {strip} by {free}\n along lengthwise: 0.4 .. 0.6 by 9\n");
        let spec = written(&out, "milled.chain", &pinion(cone, &milling));
        let found = json(&spec, &out, &[]);
        let side = &found["side"];
        let [most, least] = left(side);
        assert!(most > 0.0 && least < 0.0, "the largest amounts lie on both sides: {side}");
        most.max(-least)
    };
    let [one, two, four] = [1, 2, 4].map(|free| largest("0.45 .. 0.55", free));
    // a search ends within a millionth of the least, or 0.01 nm
    assert!(one > two && four < two + 1e-4 && four > 0.0, "{one} {two} {four}");
    assert!(largest("0.48 .. 0.52", 2) < 0.5 * two);
}

/// Flanks that twist: nothing vanishes there, and the search ends all the same, whatever the cutter and however free its axis. A crowned
/// flank is nearly developable: a cone can do no more for it than a cylinder.
#[test]
fn the_search_ends_on_flanks_that_twist() {
    let out = folder("side_twisted");
    let strip = |free: usize| format!("side z: -6 mm .. 6 mm by {free}\n along rho: 55 mm .. 59 mm by 9\n");
    let left_of = |spec: &str| {
        let side = &json(&written(&out, "milled.chain", spec), &out, &[])["side"];
        assert_eq!(side["is_settled"], true, "{side}");
        left(side)[0]
    };
    let cone = CYLINDER.replace("half_angle: 0 deg", "half_angle: 5 deg");
    let crowned =
        |cutter: &str, free: usize| left_of(&job(&CROWNED, ("crowned_gear", "upper_flank"), cutter, &strip(free)));
    let [least, other] = [CYLINDER, &cone].map(|cutter| crowned(cutter, 4));
    // um: a search ends within a millionth, and begins elsewhere for each cutter
    assert!((least - other).abs() < 1e-3 * least, "{least} {other}");
    assert!(crowned(&cone, 1) > least * (1.0 - 1e-3));
    let wide = |free: usize| {
        let milling = format!("side profilewise: 0.2 .. 0.8 by {free}\n along lengthwise: 0.15 .. 0.85 by 9\n");
        left_of(&pinion(&CYLINDER.replace("1.5 mm", "1 mm"), &milling))
    };
    let [few, many] = [2, 8].map(wide);
    assert!(many < few, "{many} {few}");
}

/// The least height at which a line enters a cone, over the positions of a pass; between them by the parabola through three.
fn scanned(poses: &[[f64; 6]], (half_angle, tip_radius, length): (f64, f64, f64), line: &[f64; 6]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (low, slope) = (tip_radius * (1.0 - half_angle.sin()), half_angle.tan());
    let normal = [line[3], line[4], line[5]];
    let height = |pose: &[f64; 6]| {
        let (from, axis) = ([0, 1, 2].map(|k| line[k] - pose[k]), [pose[3], pose[4], pose[5]]);
        // |y|² − z² = (r + (z − low) tan)² on the cone, y and z being linear in the height
        let [z, dz] = [dot(from, axis), dot(normal, axis)];
        let [r, dr] = [tip_radius * half_angle.cos() + (z - low) * slope, dz * slope];
        let (a, b) = (1.0 - dz * dz - dr * dr, dot(from, normal) - z * dz - r * dr);
        let root = b * b - a * (dot(from, from) - z * z - r * r);
        let height = (-b - root.sqrt()) / a;
        let is_met = root >= 0.0 && (low..=length).contains(&(z + height * dz));
        if is_met { height } else { f64::INFINITY }
    };
    let heights: Vec<f64> = poses.iter().map(height).collect();
    let at = (0..heights.len()).min_by(|a, b| heights[*a].total_cmp(&heights[*b])).expect("positions");
    if at == 0 || at + 1 == heights.len() {
        return heights[at];
    }
    let [a, b, c] = [heights[at - 1], heights[at], heights[at + 1]];
    if a.is_finite() && c.is_finite() { b - (c - a).powi(2) / (8.0 * (a - 2.0 * b + c)) } else { b }
}

/// What one pass leaves on a bevel flank at the points of its map is what the cone leaves in very many positions, without envelopes.
#[test]
fn a_bevel_flank_is_left_as_brute_force_leaves_it() {
    let out = folder("side_bevel_scanned");
    let cone = "conical_mill(half_angle: 4 deg, tip_radius: 1 mm, cutting_length: 25 mm, reach: 40 mm)";
    let milling = "side profilewise: 0.4 .. 0.6 by 3\n along lengthwise: 0.4 .. 0.6 by 1001\n";
    let spec = written(&out, "milled.chain", &pinion(cone, milling));
    let found = json(&spec, &out, &["--rows", "7", "--columns", "11"]);
    let rows = |name: &str| -> (Vec<String>, Vec<Vec<String>>) {
        let text = std::fs::read_to_string(out.join(name)).expect("it is written");
        let mut rows =
            text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').map(String::from).collect());
        (rows.next().expect("a header"), rows.collect())
    };
    let columns = |(header, rows): (Vec<String>, Vec<Vec<String>>), names: [&str; 6]| -> Vec<[f64; 6]> {
        let at = names.map(|name| header.iter().position(|title| title == name).expect(name));
        rows.iter().map(|row| at.map(|at| row[at].parse().expect("a number"))).collect()
    };
    let poses = columns(rows("milled.part.csv"), ["tip_x", "tip_y", "tip_z", "axis_x", "axis_y", "axis_z"]);
    let lines = columns(rows("milled.part.left.csv"), ["x", "y", "z", "nx", "ny", "nz"]);
    let left = found["map"]["heights_um"].as_array().expect("heights");
    assert!(poses.len() == 1001 && lines.len() == 77 && left.len() == 77);
    let (mut most, mut least) = (0.0f64, 0.0f64);
    for (line, left) in lines.iter().zip(left) {
        let (left, brute) = (number(left), 1e3 * scanned(&poses, (4f64.to_radians(), 1.0, 25.0), line));
        // parabolas through heights at positions of some 10 um: the error falls with the cube of their distance, and is half of this
        assert!((left - brute).abs() < 1e-5, "{left} {brute} um at {line:?}");
        (most, least) = (most.max(brute), least.min(brute));
    }
    assert!(most > 0.1 && least < -0.1, "a bevel flank is not ruled: {most} {least} um");
}

/// Exit code 3 with the reason and a way out.
#[test]
fn what_one_pass_does_not_cover_is_told() {
    let out = folder("side_refused");
    let short = CYLINDER.replace("cutting_length: 20 mm", "cutting_length: 10 mm");
    let ball = "ball_mill(radius: 1 mm, reach: 20 mm, holder_radius: 8 mm)";
    let other = "side rho: 51 mm .. 53.5 mm by 1\n along z: -6 mm .. 6 mm, chord 1 um\n";
    let cases: [(String, &[&str]); 3] = [
        (
            gear(&short, STRIP),
            &["cutter.cutting has a side of 8.500 mm, and would touch upper_flank along", "longer side"],
        ),
        (gear(ball, STRIP), &["cutter.cutting has no straight side", "say `passes`"]),
        (gear(CYLINDER, other), &["mill goes beyond the travel of A", "clamp the work elsewhere"]),
    ];
    for (spec, parts) in cases {
        let spec = written(&out, "milled.chain", &spec);
        let (code, _, told) = mill(&spec, &out, &["--nc", "fanuc"]);
        assert_eq!(code, 3, "{told}");
        parts.iter().for_each(|part| assert!(told.contains(part), "{part} in {told}"));
        assert!(!out.join("milled.part.nc").exists(), "{told}");
    }
}

/// What the language says of a pass with the side.
#[test]
fn words_that_do_not_go_together_are_errors() {
    let out = folder("side_words");
    let cases = [
        (format!("{STRIP} lead 3 deg\n"), "`part` says `side` and `lead`"),
        (format!("{STRIP} both ways\n"), "`part` says `side` and `both ways`"),
        (format!("{STRIP} passes z: -6 mm .. 6 mm by 4\n"), "`part` says `side` and `passes`"),
        (STRIP.replace("by 1", "step 1 mm"), "`step` does not say that"),
        (STRIP.replace("by 1", "by 61"), "the number must be a whole number from 1 to 60, not 61"),
        (format!("{STRIP} {}", STRIP.lines().next().unwrap()), "`side` is said twice"),
    ];
    for (milling, part) in cases {
        let spec = written(&out, "milled.chain", &gear(CYLINDER, &milling));
        let (code, _, told) = mill(&spec, &out, &[]);
        assert!(code == 1 && told.contains("error[E0520]") && told.contains(part), "{part} in {code} {told}");
    }
}

/// In point milling a straight side touches in its middle, where `tilt` lays it on the flank.
#[test]
fn points_are_milled_with_the_side_of_a_cone() {
    let out = folder("side_points");
    let cone = "conical_mill(half_angle: 20 deg, tip_radius: 0.5 mm, cutting_length: 4 mm, reach: 30 mm)";
    let milling = "passes profilewise: 0.5 .. 0.7, scallop 1 um\n along lengthwise: 0.4 .. 0.6 by 9\n tilt -70 deg\n";
    let spec = written(&out, "milled.chain", &job(&PINION, ("pinion_19x62", "convex"), cone, milling));
    let found = json(&spec, &out, &[]);
    let cusp = number(&found["cusp"]["height_um"]);
    assert!(cusp > 0.0 && cusp <= 1.0, "{found}");
    // a ball of the tip's radius takes many more passes
    let ball = "ball_mill(radius: 0.5 mm, reach: 20 mm, holder_radius: 8 mm)";
    let spec = written(&out, "milled.chain", &job(&PINION, ("pinion_19x62", "convex"), ball, milling));
    let of_ball = json(&spec, &out, &[]);
    assert!(number(&of_ball["passes"]) > 3.0 * number(&found["passes"]), "{} {}", of_ball["passes"], found["passes"]);
}

/// An involute helicoid, given by the angle about its base circle and by z, that turns left by a turn over so many mm.
fn helicoid(lead: f64, [low, high]: [f64; 2], cutter: &str) -> String {
    let library = support::self_contained(&["machines/five_axis_table_table", "tools/end_mills"]);
    format!(
        "{library}
machine bench {{
    axis lift : linear
    frame table
    frame part in table = translate_z(lift)
    fix lift = 0 mm
}}
tool helicoid {{
    surface skin(xi: angle in 0.01 rad .. 2.5 rad, q: length in -60 mm .. 60 mm) {{
        let g = xi - q / ({lead} mm / 1 rev)
        at = [45 mm * (cos(g) + xi * sin(g)), 45 mm * (sin(g) - xi * cos(g)), q]
        body towards [-sin(g), cos(g), 0]
    }}
}}
job milled {{
    machine b = bench
    tool w = helicoid
    mount w on b.part
    surface skin in b.table = move(w.skin)
    sample skin {{ rho: {low} mm .. {high} mm by 7, z: -8 mm .. 8 mm by 9 }}
    machine mill = five_axis_table_table(work_z: 60 mm)
    tool cutter = {cutter}
    mount cutter on mill.cutter
    mill part of skin with cutter.cutting in mill.work {{
        side z: -8 mm .. 8 mm by 1
        along rho: {low} mm .. {high} mm, chord 1 um
    }}
}}
"
    )
}

/// The line of contact through a corner of the strip is a tangent of the base helix: 8 mm of z shift its length from the base circle by
/// 8 mm · 45 mm / p. So the pass runs from where it says to where it says, also close to the base circle, inside which there is no surface.
#[test]
fn a_pass_runs_as_far_as_the_lines_of_contact_through_its_corners() {
    let out = folder("side_corners");
    let slim = "conical_mill(half_angle: 0 deg, tip_radius: 0.5 mm, cutting_length: 45 mm, reach: 60 mm)";
    for (lead, [low, high], cutter) in [
        (400.0, [48.0, 52.0], CYLINDER.replace("cutting_length: 20 mm", "cutting_length: 25 mm")),
        (400.0, [46.0, 52.0], slim.replace("0.5 mm", "1.5 mm")),
        (250.0, [48.0, 52.0], slim.to_string()),
    ] {
        let found = json(&written(&out, "milled.chain", &helicoid(lead, [low, high], &cutter)), &out, &[]);
        let side = &found["side"];
        let shift = 8.0 * 45.0 * std::f64::consts::TAU / lead;
        let rho = |at: f64, by: f64| ((at * at - 45.0 * 45.0).sqrt() + by).hypot(45.0);
        let needed = [low - rho(low, -shift), rho(high, shift) - high].map(|by| by / (high - low));
        let beyond = [0, 1].map(|k| number(&side["beyond"][k]));
        // a little farther, as the axis may be turned a little otherwise
        let is_near = |(beyond, needed): (f64, f64)| beyond >= needed && beyond < 1.2 * needed + 0.01;
        assert!(beyond.into_iter().zip(needed).all(is_near), "{beyond:?} {needed:?}");
        assert!(low - beyond[0] * (high - low) > 45.0, "{beyond:?}");
        assert_eq!(side["untouched"], 0, "{side}");
        // near the base circle polynomials through the middle of the strip come near slowly
        assert!(left(side).iter().all(|left| left.abs() < 1e-3), "{side}");
    }
}

const SLANTED: &str = "
machine bench {
    axis lift : linear
    frame table
    frame part in table = translate_z(lift)
    fix lift = 0 mm
}
tool blade {
    surface skin(p: length in -30 mm .. 30 mm, q: length in -30 mm .. 30 mm) {
        let a = 0.6 deg / 1 mm * q
        let h = -p^2 / 400 mm + 20 mm
        at = [h * cos(a) - p * sin(a), h * sin(a) + p * cos(a), q]
        body towards [-cos(a), -sin(a), 0]
    }
}
machine slanted {
    axis X : linear in -400 mm .. 400 mm
    axis Y : linear in -300 mm .. 300 mm
    axis Z : linear in -300 mm .. 500 mm
    axis B : rotary in -190 deg .. 190 deg
    axis C : rotary
    frame bed
    frame slide in bed = translate(X, Y, Z)
    frame head in slide = rotate([sin(45 deg), 0, cos(45 deg)], B) translate(13 mm, 3 mm, -70 mm)
    frame cutter in head = rotate_x(180 deg)
    frame table in bed = rotate_x(10 deg) rotate_z(C) translate(1 mm, 2 mm, 3 mm)
    frame work in table = translate(4 mm, -2 mm, 30 mm) rotate_y(-5 deg) rotate_x(97 deg)
}
";

/// With tool-centre control the rotary axes of a slanted head and a table turn evenly: by blocks between its positions a cone is as deep in a
/// twisted blade, beyond what the pass itself leaves, as it is said to be, and no deeper than `chord` allows. Brute force over very many
/// positions, without envelopes, on the row where it is deepest.
#[test]
fn blocks_are_as_deep_as_evenly_turning_axes_go() {
    let out = folder("side_tip");
    let cone = "conical_mill(tip_radius: 3 mm, half_angle: 7 deg, cutting_length: 24 mm)";
    let library = support::self_contained(&["tools/end_mills"]);
    let plan = |blocks: &str| {
        let spec = format!(
            "{library}{SLANTED}\njob milled {{\n machine b = bench\n tool w = blade\n mount w on b.part\n surface skin in b.table = move(w.skin)\n \
             sample skin {{ p: -6 mm .. 6 mm by 7, q: -8 mm .. 8 mm by 9 }}\n machine mill = slanted\n tool cutter = {cone}\n \
             mount cutter on mill.cutter\n mill part of skin with cutter.cutting in mill.work {{\n side p: -6 mm .. 6 mm by 6\n \
             along q: -8 mm .. 8 mm{blocks}\n stock 0.02 mm\n }}\n}}\n"
        );
        let found = json(&written(&out, "milled.chain", &spec), &out, &["--tcp"]);
        let text = std::fs::read_to_string(out.join("milled.part.csv")).expect("it is written");
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let titles: Vec<&str> = lines.next().expect("titles").split(',').collect();
        let names = ["tip_x", "tip_y", "tip_z", "axis_x", "axis_y", "axis_z", "B_deg", "C_deg"];
        let columns = names.map(|name| titles.iter().position(|title| *title == name).expect(name));
        let row = |line: &str| {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().expect("a number")).collect();
            columns.map(|k| row[k])
        };
        (number(&found["blocks"][1]["height_um"]), lines.map(row).collect::<Vec<[f64; 8]>>())
    };
    let turned = |[x, y, z]: [f64; 3], [a, b, c]: [f64; 3], deg: f64| {
        let (sine, cosine) = deg.to_radians().sin_cos();
        let along = (a * x + b * y + c * z) * (1.0 - cosine);
        let cross = [b * z - c * y, c * x - a * z, a * y - b * x];
        [
            x * cosine + cross[0] * sine + a * along,
            y * cosine + cross[1] * sine + b * along,
            z * cosine + cross[2] * sine + c * along,
        ]
    };
    let axis = |b: f64, c: f64| {
        let half = 0.5f64.sqrt();
        let out_of_spindle = turned([0.0, 0.0, 1.0], [half, 0.0, half], b);
        let steps = [([1.0, 0.0, 0.0], 10.0), ([0.0, 0.0, 1.0], c), ([0.0, 1.0, 0.0], -5.0), ([1.0, 0.0, 0.0], 97.0)];
        steps.into_iter().fold(out_of_spindle, |seen, (about, by)| turned(seen, about, -by))
    };
    let (told, rows) = plan(", chord 0.5 um");
    let (_, ideal) = plan(" by 801");
    let ideal: Vec<[f64; 6]> = ideal.into_iter().map(|[x, y, z, i, j, k, ..]| [x, y, z, i, j, k]).collect();
    const PARTS: usize = 200;
    let at = |pair: &[[f64; 8]], share: f64| {
        let [x, y, z, _, _, _, b, c] = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| pair[0][k] + share * (pair[1][k] - pair[0][k]));
        let [i, j, k] = axis(b, c);
        [x, y, z, i, j, k]
    };
    let first = at(&rows[..2], 0.0);
    assert!((3..6).all(|k| (first[k] - rows[0][k]).abs() < 1e-9), "{first:?} {:?}", rows[0]);
    let blocks: Vec<[f64; 6]> =
        rows.windows(2).flat_map(|pair| (0..PARTS).map(move |k| at(pair, k as f64 / PARTS as f64))).collect();
    let deep = (0..=320).map(|k| {
        let (p, q) = (6.0f64, -8.0 + 0.05 * f64::from(k));
        let ((s, c), h, twist) = ((0.6 * q).to_radians().sin_cos(), 20.0 - p * p / 400.0, 0.6f64.to_radians());
        let (by_p, by_q) =
            ([-p / 200.0 * c - s, c - p / 200.0 * s, 0.0], [-twist * (h * s + p * c), twist * (h * c - p * s), 1.0]);
        let n = [by_p[1] * by_q[2], -by_p[0] * by_q[2], by_p[0] * by_q[1] - by_p[1] * by_q[0]];
        let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let line = [h * c - p * s, h * s + p * c, q, n[0] / size, n[1] / size, n[2] / size];
        let of = (7f64.to_radians(), 3.0, 24.0);
        1e3 * (scanned(&blocks, of, &line) - scanned(&ideal, of, &line))
    });
    let deepest = deep.fold(0.0, f64::min);
    assert!(deepest >= -0.5, "{deepest} um");
    // blocks are looked at in their middles, where they are deepest but for what the pass bends
    assert!((told - deepest).abs() < 0.02, "{told} {deepest} um");
}
