//! Programs read back: what is not understood is told with its line, and what a program does not do as the milling says is told, too.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::support::{folder, written};
use super::{AREA, BALL, job, json, mill, sound, text_of};

/// A control, and what its programs are called.
type Control = (&'static str, &'static str);
/// A line, and what is told of it.
type Change = (&'static str, &'static str);

/// Few passes and positions: what is read is the same.
fn small() -> String {
    let area = AREA.replace("0.55 by 9", "0.46 by 2").replace("0.8 by 9", "0.8 by 5");
    job("work_z: 60 mm", BALL, &format!("{area} lead 5 deg\n tilt 70 deg\n"))
}

/// A program of a control, and its lines.
fn program(spec: &str, out: &Path, (control, extension): Control, arguments: &[&str]) -> (PathBuf, Vec<String>) {
    json(spec, out, &[&["--nc", control], arguments].concat());
    let file = out.join(format!("milled.part.{extension}"));
    let lines = text_of(&file).lines().map(str::to_string).collect();
    (file, lines)
}

/// The place of a cutting block after some.
fn cut(lines: &[String], after: usize) -> usize {
    let is_cut = |line: &String| line.contains("G01 X") || line.starts_with("L X") && !line.contains("FMAX");
    lines.iter().enumerate().filter(|(_, line)| is_cut(line)).nth(after).expect("it cuts").0
}

/// Lines with another before one of them.
fn with(lines: &[String], before: usize, line: &str) -> String {
    [&lines[..before], &[line.to_string()], &lines[before..]].concat().join("\n")
}

/// Exit code and the document.
fn verified(spec: &str, out: &Path, file: &str, arguments: &[&str]) -> (i32, Value) {
    let (code, told, errors) = mill(spec, out, &[&["--verify", file, "--json"], arguments].concat());
    (code, serde_json::from_str(&told).unwrap_or_else(|_| panic!("JSON, not {errors}")))
}

/// Words that change where the cutter goes, and are not followed.
#[test]
fn words_that_change_the_result_are_errors_with_their_line() {
    let out = folder("mill_changed");
    let spec = written(&out, "milled.chain", &small());
    let cases: [(Control, &[Change]); 3] = [
        (
            ("linuxcnc", "ngc"),
            &[
                ("G92 X0 Y0", "G92 moves the zero"),
                ("G52 X5.", "G52 moves the zero"),
                ("G10 L2 P1 X5. Y5.", "G10 moves the zero"),
                ("G55", "G55 counts from another zero than G54"),
                ("G68.2 X0 Y0 Z0 I10 J20 K30", "G68.2 turns, scales or mirrors"),
                ("G51.1 X0", "G51.1 turns, scales or mirrors"),
                ("G41 D1", "G41 puts the cutter beside its way"),
                ("G43 H1", "G43 adds a tool length"),
                ("G28 Z0", "G28 goes to a point of the machine by way of its words"),
                ("G65 P9000 X5.", "G65 calls a macro"),
                ("G81 X0 Y0 Z-5 R2 F100", "G81 is a cycle"),
                ("G5.2 X1 Y1", "G5.2 is a curve"),
                ("G01 X0 R2", "mill has no word `R`"),
                ("M98 P7777", "M98 calls or ends a subprogram"),
                ("M61 Q2", "M61 is not followed"),
                ("O100 CALL", "`CALL` is not followed"),
                ("/ G01 X1", "`/` marks a block"),
                ("#100 = 5", "`#` begins a variable"),
                ("G01 X1 X2", "`X` stands twice in one block"),
                ("G0 G1 X1", "G0 and G1 stand in one block"),
                ("G01 A-185", "A goes beyond its travel: to 185.000 deg as mill counts"),
                ("G20 G01 Z300 F3", "Z goes beyond its travel: to 7620.000 mm as mill counts"),
                ("(open G01 X1 F3", "`(` begins a remark that has no end in its line"),
                ("G01 X#1 F3", "`X` has a parameter or an expression for a value, which is not read"),
                ("G01 X[1+2] F3", "`X` has a parameter or an expression for a value"),
                ("G01 X1", "has no `F`: with inverse-time feed (G93) each block that cuts needs its own"),
                ("G01 X1 F0", "`F0` is no feed"),
                ("G01 X1 F-5", "`F-5` is no feed"),
            ],
        ),
        (
            ("siemens", "mpf"),
            &[
                ("L100 P3", "L100 calls a subprogram"),
                ("T1 D1", "D1 adds to the tool"),
                ("TRANS X10", "`TRANS` is not followed"),
                ("CYCLE800(0,\"TC1\",0,57,0,0,0,0,30,0,0,0,0,1)", "`CYCLE800` is not followed"),
                ("G500", "G500 counts from another zero"),
                ("X=IC(5)", "`X=IC(5)` counts from where the axis stands"),
                ("C=ACP(5)", "`C=ACP(5)` is not followed"),
                ("G01 A3=0.1", "mill has no word `A3`"),
                ("C=DC(-80.1)", "`C=DC(-80.1)` is no position of DC, which takes 0 .. 359.999"),
                ("X=R1", "`X` has a parameter or an expression for a value"),
                ("N100 A1: G01", "`:` ends a label"),
            ],
        ),
        (
            ("heidenhain", "h"),
            &[
                ("TOOL CALL 1 Z DL+0.5 DR+0.2", "`DL+0.5` adds to the tool"),
                ("L X+1 X+2 F100", "`X` stands twice in one block"),
                ("M99", "M99 calls or ends a subprogram"),
                ("M126", "M126 is not followed"),
            ],
        ),
    ];
    for (control, changes) in cases {
        let (_, lines) = program(&spec, &out, control, &[]);
        let place = cut(&lines, 1);
        for (line, part) in changes {
            let file = written(&out, "changed.nc", &with(&lines, place, line));
            let (code, _, told) = mill(&spec, &out, &["--verify", &file]);
            assert_eq!(code, 1, "{line}: {told}");
            assert!(told.contains(&format!(":{}: {part}", place + 1)), "{part} in {told}");
        }
    }
    // positions of the machine leave open where the axis is in the work
    let (_, lines) = program(&spec, &out, ("linuxcnc", "ngc"), &[]);
    let place = cut(&lines, 1);
    let changed = with(&lines, place, "G53 G0 Z400");
    let (code, _, told) = mill(&spec, &out, &["--verify", &written(&out, "changed.nc", &changed)]);
    assert_eq!(code, 1, "{told}");
    assert!(told.contains(&format!(":{}: cuts before each axis has its position", place + 2)), "{told}");
}

/// A block with A as a position and C a whole turn off, to which the shorter way leads.
fn by_other_words(block: &str) -> String {
    let word = |word: &str| match (word.strip_prefix('A'), word.strip_prefix('C')) {
        (Some(at), _) => format!("A=AC({at})"),
        (_, Some(at)) => format!("C=DC({})", at.parse::<f64>().expect("a position") + 360.0),
        _ => word.to_string(),
    };
    block.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// What controls write every day and the cutter does not notice: the same heights as without.
#[test]
fn everyday_words_are_followed() {
    let out = folder("mill_everyday");
    let spec = written(&out, "milled.chain", &small());
    let (own, lines) = program(&spec, &out, ("siemens", "mpf"), &[]);
    let (code, expected) = verified(&spec, &out, own.to_str().unwrap(), &[]);
    assert_eq!(code, 0);
    let mut theirs = lines.clone();
    let place = cut(&theirs, 1);
    theirs[place] = by_other_words(&theirs[place]);
    assert!(theirs[place].contains("C=DC(") && theirs[place].contains("A=AC("), "{}", theirs[place]);
    let words = "G54 G642 ADIS=0.01\nT=\"BALL 2\"\nG4 F0.5\nSOFT FFWON\nMSG(\"pass; X1 (first)\")\nCYCLE832(0.01,1,1)\n; fr\u{e4}sen";
    let text = with(&theirs, place, words);
    // remarks in the letters of an old control
    let bytes: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).expect("Latin-1")).collect();
    let file = out.join("theirs.mpf");
    std::fs::write(&file, bytes).unwrap();
    let (code, found) = verified(&spec, &out, file.to_str().unwrap(), &[]);
    assert_eq!(code, 0, "{found}");
    for part in ["blocks", "untouched"] {
        assert_eq!(found["verified"][part], expected["verified"][part], "{part}");
    }
    let height = |of: &Value, k: usize| of["verified"]["left"][k]["height_um"].as_f64().expect("a height");
    for k in 0..2 {
        // another turn of C is rounded otherwise
        assert!((height(&found, k) - height(&expected, k)).abs() < 1e-6, "{k}");
    }
}

/// A program that is cut off, or has no end: exit code 3 and what it is.
#[test]
fn what_a_program_does_not_do_is_told() {
    let out = folder("mill_not_done");
    let spec = written(&out, "milled.chain", &sound());
    let (_, lines) = program(&spec, &out, ("linuxcnc", "ngc"), &[]);
    let (_, klartext) = program(&spec, &out, ("heidenhain", "h"), &[]);
    let cases: [(String, &[&str]); 3] = [
        (
            lines[..lines.len() / 2].join("\n"),
            &["not_milled", "does not say that it ends", " of 465 points of concave"],
        ),
        (lines.join("\n").replace("M30", ""), &["not_milled", "does not say that it ends", "it may be cut off"]),
        (klartext.join("\n").replace("END PGM FLANK MM", ""), &["not_milled", "does not say that it ends"]),
    ];
    for (text, parts) in cases {
        let file = written(&out, "theirs.nc", &text);
        let (code, found) = verified(&spec, &out, &file, &[]);
        let told = found["not_done"].to_string();
        assert_eq!(code, 3, "{told}");
        for part in parts {
            assert!(told.contains(part), "{part} in {told}");
        }
    }
}

/// Half a millimetre against the normal and back, with feed and as a rapid: as deep as that, with its line, and in the map.
#[test]
fn what_goes_through_the_flank_is_told() {
    let out = folder("mill_dive");
    let spec = written(&out, "milled.chain", &sound());
    let (own, lines) = program(&spec, &out, ("siemens", "mpf"), &["--tcp"]);
    let csv = text_of(&out.join("milled.part.csv"));
    let mut rows = csv.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = rows.next().unwrap().split(',').collect();
    let row: Vec<f64> = rows.nth(4 * 9 + 4).unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    let column =
        |name: &str| row[titles.iter().position(|title| *title == name).unwrap_or_else(|| panic!("{titles:?}"))];
    let [normal, tip] = [["nx", "ny", "nz"], ["tip_x", "tip_y", "tip_z"]].map(|names| names.map(column));
    let to = |by: f64| {
        let word = |k: usize| format!("{}{:.4}", ["X", "Y", "Z"][k], tip[k] - by * normal[k]);
        [0, 1, 2].map(word).join(" ")
    };
    // each pass before has ten blocks: down, eight along, up; then down, and four along
    let place = cut(&lines, 4 * 10 + 4);
    assert!(lines[place].contains(&to(0.0)), "{} is at {}", lines[place], to(0.0));
    let fine = ["--tcp", "--rows", "15", "--columns", "161"];
    // the last of them is deeper than the ball is round
    for (motion, what, by) in [("G00", "the rapid in line", 0.5), ("G01", "line", 0.5), ("G01", "line", 1.6)] {
        let dive = with(&lines, place + 1, &format!("{motion} {}\n{motion} {}", to(by), to(0.0)));
        let (code, found) = verified(&spec, &out, &written(&out, "dive.mpf", &dive), &fine);
        let told = found["not_done"].to_string();
        assert_eq!(code, 3, "{told}");
        // both blocks are as deep where they meet
        let of_line = |line: usize| told.contains(&format!("\"{what} {line} of "));
        assert!(told.contains("too_deep") && (of_line(place + 2) || of_line(place + 3)), "{told}");
        let depth = -found["verified"]["left"][1]["height_um"].as_f64().unwrap();
        // a point of the map is within 0.06 mm of the contact, where a ball of 1 mm is 2 um higher
        let deep = 1e3 * by;
        assert!((deep - 5.0..deep + 0.2).contains(&depth), "{motion} {by}: {depth}");
    }
    assert_eq!(verified(&spec, &out, own.to_str().unwrap(), &fine).0, 0);
}

/// A rotary axis that goes round a whole turn in a block, as where an angle is written a turn off: what it cuts on the way is told with its line.
#[test]
fn a_turn_in_one_block_is_followed() {
    let out = folder("mill_turn");
    let spec = written(&out, "milled.chain", &sound());
    let (_, mut lines) = program(&spec, &out, ("linuxcnc", "ngc"), &[]);
    let place = cut(&lines, 14);
    let at = |word: &str| word.strip_prefix('C').map(|at| format!("C{:.5}", at.parse::<f64>().unwrap() + 360.0));
    lines[place] =
        lines[place].split(' ').map(|word| at(word).unwrap_or(word.to_string())).collect::<Vec<_>>().join(" ");
    let (code, found) = verified(&spec, &out, &written(&out, "turn.ngc", &lines.join("\n")), &[]);
    let told = found["not_done"].to_string();
    assert_eq!(code, 3, "{told}");
    let of_line = |line: usize| told.contains(&format!("\"line {line} of "));
    assert!(told.contains("too_deep") && (of_line(place + 1) || of_line(place + 2)), "{told}");
    assert!(found["verified"]["left"][1]["height_um"].as_f64().unwrap() < -1000.0, "{found}");
}

/// A program does not say its unit, or its lines end as those of old machines: the one is told, the other read.
#[test]
fn what_a_program_leaves_open_is_told() {
    let out = folder("mill_open");
    let spec = written(&out, "milled.chain", &small());
    let (_, lines) = program(&spec, &out, ("linuxcnc", "ngc"), &[]);
    let open = lines.join("\n").replace("G21 ", "");
    let (code, found) = verified(&spec, &out, &written(&out, "open.ngc", &open), &[]);
    assert_eq!(code, 0, "{found}");
    assert!(found["remarks"].to_string().contains("does not say its unit: lengths are read as mm"), "{found}");
    let (code, found) = verified(&spec, &out, &written(&out, "ends.ngc", &lines.join("\r")), &[]);
    assert_eq!(code, 0, "{found}");
    assert!(!found["remarks"].to_string().contains("does not say its unit"), "{found}");
    let (code, _, told) = mill(&spec, &out, &["--verify", &written(&out, "empty.ngc", "")]);
    assert!(code == 1 && told.contains(":1: the program has no cutting block"), "{told}");
}
