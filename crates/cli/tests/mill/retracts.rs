//! Rapids of programs: from the work and back along the cutter's own axis, in all spaces; one zero under tool-centre control; what an axis does
//! not reach.

use std::collections::HashMap;
use std::path::Path;

use super::support::{folder, self_contained, written};
use super::{AREA, BALL, mill, sound, text_of};

const HEAD_HEAD: [&str; 7] = [
    "functions/bevel",
    "machines/cradle",
    "tools/face_mill",
    "functions/blanks_19x62",
    "bevel/pinion_19x62",
    "machines/five_axis_head_head",
    "tools/end_mills",
];
/// From the tip up to the swivel's axis, mm.
const PIVOT: f64 = 250.0;

fn milling(machine: &str, lean: &str) -> String {
    let library = self_contained(&HEAD_HEAD);
    let area = AREA.replace("0.55 by 9", "0.55 by 3").replace("0.8 by 9", "0.8 by 40");
    format!(
        "{library}{NUTATING}\njob milled extends pinion_19x62 {{\n machine mill = {machine}\n tool cutter = {BALL}\n mount cutter on mill.cutter\n \
         mill part of concave with cutter.cutting in mill.work {{\n{area}{lean}\n clear of convex by 0.1 mm with cutter.whole\n }}\n}}\n"
    )
}

/// A table that nutates by 45 degrees: it brings the spindle up to 90 degrees from the turntable's axis.
const NUTATING: &str = "
machine nutating {
    axis X : linear in -600 mm .. 600 mm
    axis Y : linear in -600 mm .. 600 mm
    axis Z : linear in -600 mm .. 600 mm
    axis B : rotary in -180 deg .. 180 deg
    axis C : rotary
    frame bed
    frame tip in bed = translate(X, Y, Z)
    frame cutter in tip = rotate_x(180 deg)
    frame nutator in bed = rotate_x(45 deg) rotate_z(B) rotate_x(-45 deg)
    frame table in nutator = rotate_z(C)
    frame work in table = translate(0 mm, 0 mm, 60 mm)
}
";

/// Tip and axis of the cutter on the machine with both rotary axes in the head.
fn pose(at: &HashMap<char, f64>) -> ([f64; 3], [f64; 3]) {
    let [x, y, z, a, c] = ['X', 'Y', 'Z', 'A', 'C'].map(|axis| at[&axis]);
    let (sa, ca) = a.to_radians().sin_cos();
    let (sc, cc) = c.to_radians().sin_cos();
    let axis = [sc * sa, -cc * sa, ca];
    ([x - PIVOT * axis[0], y - PIVOT * axis[1], z + PIVOT - PIVOT * axis[2]], axis)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn words(line: &str) -> HashMap<char, f64> {
    let word = |word: &str| Some((word.chars().next()?, word[1..].parse().ok()?));
    line.split(' ').filter_map(word).collect()
}

/// The points of the flank that are milled, in all spaces.
fn points(csv: &Path) -> Vec<[f64; 3]> {
    let text = text_of(csv);
    let rows = text
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|number| number.parse::<f64>().expect("a number")).collect::<Vec<_>>());
    let turned = |row: &Vec<f64>, space: u32| {
        let (s, c) = (std::f64::consts::TAU * f64::from(space) / 19.0).sin_cos();
        [c * row[4] - s * row[5], s * row[4] + c * row[5], row[6]]
    };
    rows.flat_map(|row| (0..19).map(move |space| turned(&row, space))).collect()
}

/// With both rotary axes in the head the spindle points from another side in each space. Every rapid from where the axes are known goes along the
/// cutter's own axis, or stays where the whole cutter lies beyond all flanks.
#[test]
fn rapids_go_along_the_cutter_in_every_space() {
    let out = folder("mill_head_head");
    let spec = written(&out, "milled.chain", &milling("five_axis_head_head", "lead 5 deg\n tilt 70 deg"));
    let (code, _, told) = mill(&spec, &out, &["--nc", "linuxcnc", "--spaces", "19", "--spindle", "9000"]);
    assert_eq!(code, 0, "{told}");
    let program = out.join("milled.part.ngc");
    let flanks = points(&out.join("milled.part.csv"));
    let mut at: HashMap<char, f64> = HashMap::new();
    let (mut along, mut beyond) = (0, 0);
    for line in text_of(&program).lines().filter(|line| line.starts_with('G')) {
        let before = at.clone();
        at.extend(words(line).into_iter().filter(|(axis, _)| "XYZAC".contains(*axis)));
        if !line.starts_with("G00") || before.len() < 5 {
            continue;
        }
        let ends = [pose(&before), pose(&at)];
        let way = [0, 1, 2].map(|k| ends[1].0[k] - ends[0].0[k]);
        let aside = dot(way, way) - dot(way, ends[1].1).powi(2);
        if ['A', 'C'].iter().all(|axis| before[axis] == at[axis]) && aside.max(0.0).sqrt() < 1e-3 {
            along += 1;
            continue;
        }
        for k in 0..=10 {
            let share = f64::from(k) / 10.0;
            let here = at.iter().map(|(axis, to)| (*axis, before[axis] + share * (to - before[axis]))).collect();
            let (tip, axis) = pose(&here);
            let height = |point: &[f64; 3]| dot([0, 1, 2].map(|k| tip[k] - point[k]), axis);
            let least = flanks.iter().map(height).fold(f64::INFINITY, f64::min);
            assert!(least > 10.0, "{line}: {least}");
        }
        beyond += 1;
    }
    // down and up for each of three passes in each space, and from each to the next
    assert_eq!(along, 19 * 3 * 2);
    assert!(beyond > 19 * 3, "{beyond}");
    let (code, _, told) = mill(&spec, &out, &["--verify", program.to_str().unwrap()]);
    assert_eq!(code, 0, "{told}");
    // one that goes through the gear beside the milled space is found there
    let lines: Vec<String> = text_of(&program).lines().map(str::to_string).collect();
    let space = lines.iter().position(|line| line.contains("space 8 pass 2")).unwrap();
    let place = space + lines[space..].iter().position(|line| line.starts_with("G94")).unwrap() + 2;
    let through = [&lines[..place], &["G00 X0 Y0 Z-150".to_string()], &lines[place..]].concat().join("\n");
    let (code, _, told) = mill(&spec, &out, &["--verify", &written(&out, "through.ngc", &through)]);
    assert_eq!(code, 3, "{told}");
    assert!(told.contains("the rapid in line ") && told.contains(" of space "), "{told}");
    assert!(
        told.contains(&format!("line {} of ", place + 1)) || told.contains(&format!("line {} of ", place + 2)),
        "{told}"
    );
}

/// Under tool-centre control rapids count from the zero of the work as blocks do; only the first one is a position of the machine, and says so.
#[test]
fn tool_centre_control_has_one_zero() {
    let out = folder("mill_one_zero");
    let settings = "work_x: 18 mm, work_y: 19 mm, work_z: 27 mm";
    let spec = super::job(settings, BALL, &format!("{AREA} lead 5 deg\n tilt 70 deg\n"));
    let spec = written(&out, "milled.chain", &spec);
    let controls = [
        ("siemens", "mpf", "SUPA", "TRAORI"),
        ("fanuc", "nc", "G53", "G43.4"),
        ("heidenhain", "h", "M91", "FUNCTION TCPM"),
    ];
    for (control, extension, machine, on) in controls {
        let (code, _, told) = mill(&spec, &out, &["--tcp", "--nc", control, "--spindle", "9000"]);
        assert_eq!(code, 0, "{told}");
        let program = out.join(format!("milled.part.{extension}"));
        let text = text_of(&program);
        let blocks: Vec<&str> = text.lines().filter(|line| !line.starts_with(['(', ';'])).collect();
        let is_word_of_z = |line: &str| line.split(' ').any(|word| word.starts_with('Z') && word.len() > 1);
        let moves = blocks.iter().position(|line| line.contains(on)).unwrap();
        let before: Vec<&&str> = blocks[..moves].iter().filter(|line| is_word_of_z(line)).collect();
        assert!(before.len() == 1 && before[0].contains(machine), "{before:?}");
        // what is no rapid of rotary axes alone stands between on and off
        let mut is_on = false;
        for line in &blocks[moves..] {
            is_on |= line.contains(on);
            is_on &= !["TRAFOOF", "G49", "RESET"].iter().any(|off| line.contains(off));
            assert!(is_on || !is_word_of_z(line), "{line}");
        }
        let head: String = text.lines().filter(|line| line.starts_with(['(', ';'])).collect();
        let head = head.to_lowercase().replace(")(+", "").replace("; +", "");
        assert!(
            head.contains("the origin of m.work") && head.replace('+', "").contains("x18.0000 y19.0000 z27.0000"),
            "{head}"
        );
        assert!(head.contains("length"), "{head}");
        // Klartext has no word for a zero
        let calls_zero = blocks.iter().any(|line| line.split(' ').any(|word| word == "G54"));
        let [zero, preset] = ["zero [g54]", "datum, the preset that is active"].map(|of| head.contains(of));
        assert_eq!(
            [calls_zero, zero, preset],
            [control != "heidenhain", control != "heidenhain", control == "heidenhain"],
            "{head}"
        );
        let (code, _, told) = mill(&spec, &out, &["--tcp", "--verify", program.to_str().unwrap()]);
        assert_eq!(code, 0, "{told}");
    }
}

/// Where the machine has no such direction, that is said with the angle that is wanted and those that are reached.
#[test]
fn directions_that_are_not_reached_are_told() {
    let out = folder("mill_not_reached");
    for words in [&[][..], &["--tcp"]] {
        let spec = written(&out, "milled.chain", &milling("nutating", "lead 5 deg\n tilt 70 deg"));
        let (code, _, told) = mill(&spec, &out, &[&["--nc", "siemens"], words].concat());
        assert_eq!(code, 3, "{told}");
        for part in [
            "the axes of mill cannot bring the spindle to its direction at profilewise",
            "it would stand 10",
            " deg from the axis of C, and 0.000 deg .. 90.000 deg are reached",
            "clamp the work at another angle, or lean the cutter otherwise",
        ] {
            assert!(told.contains(part), "{part} in {told}");
        }
        assert!(!told.contains("leaves the surface"), "{told}");
    }
}

/// Options that are wrong are told though the plan does not work; what a program leaves unsaid is told, too.
#[test]
fn options_are_looked_at_first() {
    let out = folder("mill_options");
    let unsound = sound().replace("tilt 70 deg", "tilt 89 deg\n stock -2 mm");
    let spec = written(&out, "milled.chain", &unsound);
    let cases: [(&[&str], &str); 5] = [
        (&["--clamp", "mill.foo=1mm..2mm"], "has no setting `mill.foo`"),
        (&["--spaces", "1000000", "--nc", "fanuc"], "the work has 19"),
        (&["--feed", "-5"], "write a number above zero"),
        (&["--approach", "-1mm"], "a length above zero is needed"),
        (&[], "`stock -2 mm` of part lies deeper than an arc of cutter.cutting is round: its radius is 1 mm"),
    ];
    for (arguments, part) in cases {
        let (code, _, told) = mill(&spec, &out, arguments);
        assert!(code != 0 && told.contains(part), "{code} {told}");
    }
    let spec = written(&out, "milled.chain", &sound());
    let (code, _, told) = mill(&spec, &out, &["--nc", "linuxcnc"]);
    assert!(code == 0 && told.contains("does not start the spindle") && told.contains("--spindle"), "{told}");
    assert!(text_of(&out.join("milled.part.ngc")).contains("does not start the spindle"));
    let (code, _, told) = mill(&spec, &out, &["--tcp"]);
    assert!(code == 0 && told.contains("no program is asked for"), "{told}");
}
