//! Words of the tip are what a control takes them for, which knows no frames of a spec: places in a frame along the machine's axes while rotary words
//! are zero.

use std::path::Path;

use super::support::{folder, self_contained, written};
use super::{json, mill, text_of, tip};

type Matrix = [[f64; 3]; 3];

/// About x, y or z.
fn turn(about: usize, degrees: f64) -> Matrix {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (next, last) = ((about + 1) % 3, (about + 2) % 3);
    let mut found = [[0.0; 3]; 3];
    found[about][about] = 1.0;
    (found[next][next], found[last][last]) = (cos, cos);
    (found[next][last], found[last][next]) = (-sin, sin);
    found
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// A vector of the machine in the work that is turned so.
fn in_work(turned: &Matrix, vector: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (0..3).map(|i| turned[i][k] * vector[i]).sum())
}

/// A job on a variant of a machine, with what the variant says.
fn job(machine: &str, variant: &str, frame: &str, lean: &str) -> String {
    let milling = format!(
        "face with ball.cutting in mill.{frame} {{\n passes v: -1 mm .. 1 mm, step 0.5 mm\n along u: -15 mm .. 15 mm by 9\n {lean}"
    );
    let job = tip::job(&milling);
    let (before, job) = job.split_once("job milled").expect("it has a job");
    let library = match machine {
        "five_axis_table_table" => String::new(),
        other => self_contained(&[&format!("machines/{other}")]),
    };
    let job = job.replace("five_axis_table_table(work_z: 60 mm)", "variant");
    format!("{before}{library}machine variant extends {machine} {{\n{variant}\n}}\njob milled{job}")
}

/// The words of the tip in blocks that cut, and in which lines of the program they stand.
fn words(program: &str) -> Vec<(usize, [f64; 3])> {
    let of_line = |line: &str| {
        let word = |letter: char| line.split(' ').find_map(|word| word.strip_prefix(letter)?.parse().ok());
        Some([word('X')?, word('Y')?, word('Z')?])
    };
    let blocks = program.lines().enumerate().filter(|(_, line)| line.contains("G01"));
    blocks.filter_map(|(number, line)| Some((number, of_line(line)?))).collect()
}

/// The tips of a plan in the work, pass by pass.
fn tips(csv: &Path) -> Vec<Vec<[f64; 3]>> {
    let text = text_of(csv);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = lines.next().expect("titles").split(',').collect();
    let columns = ["pass", "tip_x", "tip_y", "tip_z"].map(|name| titles.iter().position(|title| *title == name));
    let mut passes: Vec<Vec<[f64; 3]>> = Vec::new();
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().expect("a number")).collect();
        let [pass, x, y, z] = columns.map(|column| row[column.expect("a column")]);
        passes.resize_with(passes.len().max(pass as usize), Vec::new);
        passes[pass as usize - 1].push([x, y, z]);
    }
    passes
}

/// On tables and heads, with a work that is clamped askew, tables that are, and words that count from another zero or the other way: what a control makes
/// of the words is the plan, by the turn of the work at words of zero alone; a program with tips in the frame of the work is told to miss it.
#[test]
fn words_of_the_tip_are_along_the_axes_of_the_machine() {
    let out = folder("mill_control");
    let trunnion = "frame trunnion in bed = rotate_y(12.5 deg) rotate_x(A)";
    let askew = "frame clamped in work = translate_z(60 mm) rotate_y(12.5 deg)";
    let head = "nc B = B + 10 deg\nnc C = -C - 30 deg\nframe clamped in work = translate_z(60 mm) rotate_x(20 deg)";
    let swivel = "nc B = 15 deg - B\nnc C = C\nframe clamped in work = translate_z(60 mm) rotate_x(20 deg)";
    let offset = "nc C = 90 deg - C\nframe clamped in work = translate(5 mm, 6 mm, 60 mm)";
    let swung = "nc A = A + 20 deg\nnc C = C\nframe clamped in work = translate(5 mm, 6 mm, 60 mm)";
    let table = "five_axis_table_table";
    let cases = [
        (table, askew, "clamped", turn(1, 12.5)),
        (table, offset, "clamped", turn(2, 90.0)),
        (table, swung, "clamped", turn(0, -20.0)),
        (table, trunnion, "work", turn(1, 12.5)),
        ("five_axis_head_table", head, "clamped", product(turn(2, -30.0), turn(0, 20.0))),
        ("five_axis_head_table", swivel, "clamped", turn(0, 20.0)),
    ];
    for (machine, variant, frame, turned) in cases {
        let spec = written(&out, "milled.chain", &job(machine, variant, frame, "lead 5 deg\n tilt 75 deg"));
        json(&spec, &out, &["--tcp", "--nc", "siemens"]);
        let file = out.join("milled.part.mpf");
        let program = text_of(&file);
        let words = words(&program);
        // down to each pass, along it, and up
        let passes = tips(&out.join("milled.part.csv"));
        assert_eq!(words.len(), passes.iter().map(|pass| pass.len() + 1).sum::<usize>(), "{variant}");
        let mut blocks = words.iter();
        for pass in &passes {
            for (tip, (_, words)) in pass.iter().zip(blocks.by_ref()) {
                let found = in_work(&turned, *words);
                assert!((0..3).all(|k| (found[k] - tip[k]).abs() < 1e-4), "{variant}: {found:?} {tip:?}");
            }
            blocks.next();
        }
        let read = json(&spec, &out, &["--tcp", "--verify", file.to_str().expect("a plain path")]);
        assert_eq!(read["verified"]["untouched"], 0, "{variant}");
        // the same with tips in the frame of the work
        let mut lines: Vec<String> = program.lines().map(str::to_string).collect();
        for (number, words) in &words {
            let [x, y, z] = in_work(&turned, *words);
            let others = lines[*number].split(' ').filter(|word| !word.starts_with(['X', 'Y', 'Z']));
            lines[*number] = format!("{} X{x:.4} Y{y:.4} Z{z:.4}", others.collect::<Vec<&str>>().join(" "));
        }
        let askew = written(&out, "askew.mpf", &lines.join("\n"));
        let (code, _, told) = mill(&spec, &out, &["--tcp", "--verify", &askew]);
        assert!(code != 0, "{variant}: {told}");
    }
}

/// Words of the tip have the decimals of the axes that have the same words.
#[test]
fn words_of_the_tip_have_the_increments_of_their_axes() {
    let out = folder("mill_increments");
    let variant = "nc X = X by 0.1 mm\nnc Z = Z by 1 um\nnc C = -C by 0.01 deg";
    let job = job("five_axis_table_table", variant, "work", "lead 5 deg\n tilt 75 deg");
    let spec = written(&out, "milled.chain", &job);
    json(&spec, &out, &["--tcp", "--nc", "fanuc"]);
    let program = text_of(&out.join("milled.part.nc"));
    let decimals = |word: &str| word.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let is_cut = |line: &&str| line.contains("G01");
    for word in program.lines().filter(is_cut).flat_map(|line| line.split(' ')) {
        let expected = [('X', 1), ('Y', 4), ('Z', 3), ('A', 5), ('C', 2)];
        let known = expected.into_iter().find(|(letter, _)| word.starts_with(*letter));
        assert!(known.is_none_or(|(_, expected)| decimals(word) == expected), "{word}");
    }
}

/// What the words of a tip cannot say is told, and no program is written or followed.
#[test]
fn machines_that_no_control_knows_are_told() {
    let out = folder("mill_unknown");
    let halved = "frame trunnion in bed = rotate_x(2 * A)";
    let skewed = "frame tip in bed = translate(X + 0.1 * Y, Y, Z)";
    let cases = [
        (halved, "no tool-centre control keeps the tip of mill on its way: A turns by 2.000000 deg for each degree"),
        (skewed, "X Y Z, as their words count, are not a right-handed frame"),
        ("nc Z = -Z", "X Y Z, as their words count, are not a right-handed frame"),
        ("nc U = X", "its linear axes have the words U Y Z, and those of a tip are X Y Z"),
    ];
    for (variant, part) in cases {
        let job = job("five_axis_table_table", variant, "work", "lead 5 deg\n tilt 75 deg");
        let spec = written(&out, "milled.chain", &job);
        let (code, _, told) = mill(&spec, &out, &["--tcp", "--nc", "siemens"]);
        assert!(code == 3 && told.contains(part), "{code} {told}");
        assert!(!out.join("milled.part.mpf").exists(), "{told}");
        let program = written(&out, "theirs.mpf", "G90 G54\nTRAORI\nG0 X0 Y0 Z500 A0 C0\nG1 X0 Y0 Z10 F100\nM30\n");
        let (code, _, told) = mill(&spec, &out, &["--tcp", "--verify", &program]);
        assert!(code == 1 && told.contains("theirs.mpf:2: ") && told.contains(part), "{code} {told}");
    }
}
