//! Motion tables: CSV, JSON by the schema of its types, and NC programs read back by a reader of their own.

mod schema;

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::process::Command;

use flank_export::{
    AxisSeries, Dialect, Header, MachineAxis, MotionRow, MotionTable, NcError, Rates, Series, Unit, Unknown,
    WriteError, write_motion_csv, write_motion_json, write_nc,
};
use schema::faults_of;
use serde_json::Value;

const SCHEMA: &str = "flank.motion/2";
/// Seconds.
const CUTTING_TIME: f64 = 12.0;
const ROWS: usize = 101;

fn axis(address: &str, is_rotary: bool, decimals: u8, travel: Option<[f64; 2]>) -> MachineAxis {
    MachineAxis {
        name: format!("slide of {address}"),
        address: address.to_owned(),
        reversed: false,
        offset: 0.0,
        is_rotary,
        decimals,
        travel,
    }
}

/// A cutter swung about a blank: lengths and angles of all sizes, one of them over several turns, rows unevenly far apart.
fn table() -> MotionTable {
    let row = |k: usize| {
        let share = k as f64 / (ROWS - 1) as f64;
        let roll = -0.3 + 0.6 * share.powf(1.3);
        let axes =
            vec![80.0 * roll.sin(), -55.0 * roll.cos(), 0.00004 * roll, 20.0 * roll, 0.3 + 0.01 * roll * roll, -roll];
        MotionRow { motion: roll, axes }
    };
    let coefficients = [[0.0, 80.0], [-55.0, 0.0], [0.0, 0.00004], [0.0, 20.0], [0.3, 0.0], [0.0, -1.0]];
    let series = |(k, coefficients): (usize, [f64; 2])| AxisSeries {
        coefficients: coefficients.to_vec(),
        remainder: (k < 5).then_some(1e-3),
    };
    MotionTable {
        header: Header {
            program: "flank 0.1.0".into(),
            spec: "pinion (final); 100%.chain".into(),
            spec_hash: "5e1f".into(),
            job: "pinion".into(),
            conventions: vec!["the cutter axis is parallel to Z, φ counts from the centre roll; ".repeat(4)],
        },
        motion: Unknown { name: "roll".into(), unit: Unit::Degree },
        axes: vec![
            axis("X", false, 4, Some([-300.0, 300.0])),
            axis("Y", false, 5, Some([-300.0, 300.0])),
            axis("Z", false, 3, Some([0.0, 500.0])),
            axis("A", true, 4, None),
            axis("B", true, 6, Some([-PI / 18.0, PI / 2.0])),
            axis("C", true, 4, Some([-TAU, TAU])),
        ],
        rows: (0..ROWS).map(row).map(|row| MotionRow { axes: above_zero(row.axes), ..row }).collect(),
        series: Some(Series { reference: 0.1, axes: coefficients.into_iter().enumerate().map(series).collect() }),
        rates: None,
    }
}

/// The third axis begins at zero: its first positions print as a negative zero if nobody takes care.
fn above_zero(mut axes: Vec<f64>) -> Vec<f64> {
    axes[2] = if axes[2] < 0.0 { -0.00001 } else { axes[2] };
    axes
}

fn written(write: impl Fn(&mut Vec<u8>) -> Result<(), WriteError>) -> String {
    let [first, second] = [(); 2].map(|()| {
        let mut bytes = Vec::new();
        write(&mut bytes).expect("a sound table");
        bytes
    });
    assert_eq!(first, second, "the same bytes on every run");
    String::from_utf8(first).expect("text")
}

fn program(table: &MotionTable, dialect: Dialect) -> String {
    written(|out| write_nc(table, dialect, CUTTING_TIME, out))
}

/// A position and the minutes that it takes to get there; none for a rapid.
struct Move {
    positions: BTreeMap<String, f64>,
    minutes: Option<f64>,
}

/// Reads Klartext: absolute straight lines with a feed over mm and degrees alike.
fn read_klartext(text: &str) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with(';')).collect();
    assert_eq!(
        [lines[0], lines[lines.len() - 2], lines[lines.len() - 1]],
        ["BEGIN PGM FLANK MM", "M30", "END PGM FLANK MM"]
    );
    for line in &lines[1..lines.len() - 2] {
        let words = line.strip_prefix("L ").expect("a straight block");
        let (mut feed, mut positions) = (None, BTreeMap::new());
        for word in words.split(' ') {
            match word.split_at(1) {
                ("R", "0") | ("F", "MAX") => {}
                ("F", value) => feed = Some(value.parse::<f64>().expect("a feed")),
                (address, value) => {
                    assert!(value.starts_with(['+', '-']), "{word} in {line}");
                    positions.insert(address.to_owned(), value.parse::<f64>().expect("a position"));
                }
            }
        }
        let minutes = feed.map(|feed| {
            let before = &moves.last().expect("a rapid before").positions;
            positions.iter().map(|(address, at)| (at - before[address]).powi(2)).sum::<f64>().sqrt() / feed
        });
        moves.push(Move { positions, minutes });
    }
    moves
}

/// Reads absolute straight lines with inverse-time feed; knows nothing of how they were written.
fn read_program(text: &str) -> Vec<Move> {
    if text.starts_with("BEGIN PGM") {
        return read_klartext(text);
    }
    let mut moves: Vec<Move> = Vec::new();
    let (mut motion_code, mut is_inverse, mut has_ended) = (None, false, false);
    for line in text.lines() {
        let code = line.split(';').next().expect("at least one part");
        let code = if code.starts_with('(') { "" } else { code };
        assert!(code.is_ascii() && code.len() < 200, "{line}");
        if code.is_empty() || code == "%" || code.starts_with('O') || has_ended {
            continue;
        }
        let (mut feed, mut positions) = (None, BTreeMap::new());
        for word in code.split(' ') {
            if word == "FNORM" {
                continue;
            }
            let split = word.find('=').unwrap_or(1);
            let (address, value) = (&word[..split], word[split..].trim_start_matches('='));
            let value: f64 = value.parse().unwrap_or_else(|_| panic!("{word} in {line}"));
            match (address, value) {
                ("G", 0.0 | 1.0) => motion_code = Some(value),
                ("G", 93.0 | 94.0) => is_inverse = value == 93.0,
                ("G" | "N" | "P" | "Q", _) => {}
                ("M", 30.0) => has_ended = true,
                ("F", value) => feed = Some(value),
                (address, value) => drop(positions.insert(address.to_owned(), value)),
            }
        }
        if positions.is_empty() {
            continue;
        }
        let minutes = match motion_code.expect("a motion code before the first position") {
            0.0 => None,
            _ => {
                assert!(is_inverse, "{line}");
                Some(1.0 / feed.expect("inverse-time feed in each block"))
            }
        };
        moves.push(Move { positions, minutes });
    }
    assert!(has_ended, "the program ends");
    moves
}

#[test]
fn programs_read_back_as_the_table() {
    let table = table();
    for dialect in Dialect::ALL {
        let moves = read_program(&program(&table, dialect));
        assert_eq!(moves.len(), table.rows.len());
        assert!(moves[0].minutes.is_none() && moves[1..].iter().all(|there| there.minutes.is_some()));
        for (there, row) in moves.iter().zip(&table.rows) {
            assert_eq!(there.positions.len(), table.axes.len());
            for (axis, position) in table.axes.iter().zip(&row.axes) {
                let expected = if axis.is_rotary { position.to_degrees() } else { *position };
                let off = (there.positions[&axis.address] - expected).abs();
                // half of the last decimal, and the rounding of the comparison itself
                assert!(off <= 0.5 * 10f64.powi(-i32::from(axis.decimals)) + 1e-12, "{dialect:?} {}", axis.address);
            }
        }
    }
}

/// A control that counts against the machine and from another zero: travel, extent and positions are as it counts.
#[test]
fn axes_are_written_as_the_control_counts() {
    let mut table = table();
    (table.axes[4].reversed, table.axes[4].offset) = (true, PI / 2.0);
    let moves = read_program(&program(&table, Dialect::Fanuc));
    for (there, row) in moves.iter().zip(&table.rows) {
        assert!((there.positions["B"] - (90.0 - row.axes[4].to_degrees())).abs() <= 0.5e-6 + 1e-12);
    }
    let text = program(&table, Dialect::LinuxCnc);
    let told = "axis B: -slide of B + 90 deg, from 72.759700 to 72.811263 deg, travel 0 .. 100 deg";
    assert!(text.replace(")\n(+", "").contains(told), "{told} in {text}");
    // 15 deg are as many radians as 14.999999999999998 deg
    table.axes[4].offset = 15f64.to_radians();
    let text = program(&table, Dialect::LinuxCnc);
    assert!(text.contains("axis B: -slide of B + 15 deg, from"), "{text}");
    table.axes[4].offset = PI / 2.0;
    table.axes[4].travel = Some([-1.0, 0.31]);
    table.rows[100].axes[4] = 0.32;
    let beyond =
        write_nc(&table, Dialect::Fanuc, CUTTING_TIME, &mut Vec::new()).expect_err("beyond its travel").to_string();
    assert!(beyond.contains("to 71.665351 deg") && beyond.contains("travel is 72.2383"), "{beyond}");
}

#[test]
fn the_cutting_time_is_shared_out_as_the_motion_goes_on() {
    let table = table();
    let whole = table.rows[ROWS - 1].motion - table.rows[0].motion;
    for dialect in Dialect::ALL {
        let moves = read_program(&program(&table, dialect));
        for (pair, there) in table.rows.windows(2).zip(&moves[1..]) {
            let expected = CUTTING_TIME * (pair[1].motion - pair[0].motion) / whole;
            let seconds = 60.0 * there.minutes.expect("a feed");
            // feeds of this table are above 100 and have three decimals; a length is read from positions that are rounded
            let rounded = match dialect {
                Dialect::Heidenhain => {
                    let steps = table.axes.iter().map(|axis| 10f64.powi(-i32::from(axis.decimals)));
                    let whole = pair[0].axes.iter().zip(&pair[1].axes).zip(&table.axes);
                    let moved = whole.map(|((a, b), axis)| if axis.is_rotary { (b - a).to_degrees() } else { b - a });
                    steps.sum::<f64>() / moved.map(|by| by * by).sum::<f64>().sqrt()
                }
                _ => 0.0,
            };
            let off = (seconds - expected).abs();
            assert!(off < (1e-5 + rounded) * expected, "{dialect:?}: {seconds} s, not {expected} s");
        }
    }
}

#[test]
fn heads_tell_what_a_reader_must_know() {
    let table = table();
    for dialect in Dialect::ALL {
        let text = program(&table, dialect).to_lowercase();
        for part in ["hash 5e1f", "[final], 100/.chain", "job pinion", "cutting time 12 s", "not reduced to one turn"] {
            assert!(text.contains(part), "{dialect:?} has no {part}:\n{text}");
        }
        assert!(text.contains("axis x: slide of x, from -23.6416 to 23.6416 mm, travel -300 .. 300 mm"), "{text}");
        assert!(!text.contains("-0.000 ") && text.is_ascii() && text.lines().all(|line| line.len() < 100), "{text}");
    }
}

/// What ends remarks, blocks or programs, and what controls take for orders where a remark begins with it.
const NASTY: [&str; 30] = [
    "LOGOPEN,x.ngc",
    "(LOGOPEN,x.ngc)",
    "py,import",
    "( PY ,x)",
    "ABORT,",
    "MSG,stop",
    "debug,#1",
    "PRINT,",
    "probeopen x",
    "LOGCLOSE",
    "logappend,x",
    "pyrun,x",
    "pyreload",
    "AXIS,hide",
    ") M3 (",
    ";py,x",
    "%",
    "\n%\n",
    "\r\nM30\r\n",
    "$PATH=/x",
    "*RO*",
    "\"",
    "ü",
    "\u{202e}",
    "\u{2028}",
    "\0",
    "M2",
    "O0002",
    "a",
    "and/words",
];

/// Whatever stands in names, paths and sentences, and wherever it comes to stand.
#[test]
fn no_text_from_outside_is_an_order() {
    const OPENINGS: [&str; 6] = ["JOB ", "BY ", "- ", "MOTION FROM ", "AXIS ", "+ "];
    let mut seed = 1u64;
    let mut roll = |sides: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % sides
    };
    for round in 0..400 {
        let mut text = || {
            let between = ["", " ", "/", " (", "   "][roll(5)];
            let words = (0..1 + roll(60)).map(|_| NASTY[roll(NASTY.len())]);
            words.collect::<Vec<_>>().join(between)
        };
        let mut table = table();
        table.rows.truncate(2 + round % 2);
        let header = &mut table.header;
        (header.program, header.spec, header.spec_hash, header.job) = (text(), text(), text(), text());
        header.conventions = vec![text(), text()];
        table.motion.name = text();
        table.axes.iter_mut().for_each(|axis| axis.name = text());
        for dialect in Dialect::ALL {
            let program = program(&table, dialect);
            let is_remark = |line: &&str| {
                line.starts_with(match dialect {
                    Dialect::Siemens840D | Dialect::Heidenhain => ';',
                    Dialect::Fanuc | Dialect::LinuxCnc => '(',
                })
            };
            for line in program.lines() {
                let is_plain = line.bytes().all(|letter| matches!(letter, b' '..=b'~')) && line.len() < 80;
                assert!(is_plain, "{dialect:?}: {line:?}");
            }
            for line in program.lines().filter(is_remark) {
                let inside = match dialect {
                    Dialect::Siemens840D | Dialect::Heidenhain => line.strip_prefix("; "),
                    Dialect::Fanuc | Dialect::LinuxCnc => {
                        line.strip_prefix('(').and_then(|line| line.strip_suffix(')'))
                    }
                };
                let inside = inside.expect("nothing stands behind a remark").to_ascii_uppercase();
                assert!(
                    OPENINGS.iter().any(|opening| format!("{inside} ").starts_with(opening)),
                    "{dialect:?}: {line}"
                );
                assert!(!inside.contains(['(', ')', ';', '%', '~']), "{dialect:?}: {line}");
            }
            // what is no remark is as of a table with plain names
            let orders = |program: &str| program.lines().filter(|line| !is_remark(line)).map(str::to_owned).collect();
            let (found, plain): (Vec<String>, Vec<String>) =
                (orders(&program), orders(&self::program(&plain(&table), dialect)));
            assert_eq!(found, plain, "{dialect:?}");
        }
    }
}

/// The same motion under other names.
fn plain(named: &MotionTable) -> MotionTable {
    MotionTable { rows: named.rows.clone(), ..table() }
}

#[test]
fn each_control_has_its_words() {
    let mut table = table();
    table.axes[4].address = "B2".into();
    table.rows.truncate(3);
    let siemens = program(&table, Dialect::Siemens840D);
    assert!(siemens.contains("N30 G93 FNORM\nN40 G01 X"), "{siemens}");
    assert!(siemens.contains(" B2=17."), "{siemens}");
    assert!(siemens.contains("; - zero [G54]: where") && siemens.contains(" G54 "), "{siemens}");
    assert!(siemens.starts_with("; ") && siemens.ends_with("N70 M30\n"), "{siemens}");
    table.axes[4].address = "B".into();
    let fanuc = program(&table, Dialect::Fanuc);
    assert!(fanuc.starts_with("%\nO0001\n(JOB PINION, FOR FANUC)\n") && fanuc.ends_with("N70 M30\n%\n"), "{fanuc}");
    let linuxcnc = program(&table, Dialect::LinuxCnc);
    assert!(linuxcnc.contains("\nG21 G17 G90 G40 G49 G80 G94 G54 G64 P0.00001 Q0\nG00 X"), "{linuxcnc}");
    let heidenhain = program(&table, Dialect::Heidenhain);
    assert!(heidenhain.starts_with("BEGIN PGM FLANK MM\n; job pinion, for Heidenhain\n"), "{heidenhain}");
    assert!(heidenhain.contains("; - datum, the preset that is active") && !heidenhain.contains("G54"), "{heidenhain}");
    assert!(heidenhain.contains(" R0 FMAX\nL X") && heidenhain.ends_with("\nM30\nEND PGM FLANK MM\n"), "{heidenhain}");
}

fn refusal(dialect: Dialect, seconds: f64, spoil: impl Fn(&mut MotionTable)) -> NcError {
    let mut table = table();
    spoil(&mut table);
    let mut bytes = Vec::new();
    match write_nc(&table, dialect, seconds, &mut bytes) {
        Err(WriteError::Refused(error)) if bytes.is_empty() => *error.downcast().expect("refused as an NC program"),
        other => panic!("{other:?}, {} bytes written", bytes.len()),
    }
}

#[test]
fn what_makes_no_program_is_refused() {
    let refused = |spoil: &dyn Fn(&mut MotionTable)| refusal(Dialect::Fanuc, CUTTING_TIME, spoil).to_string();
    let beyond = refused(&|table| table.axes[3].travel = Some([-PI, PI]));
    assert_eq!(
        beyond,
        "axis `slide of A` would have to go to -343.7747 deg at roll = -17.188734 deg, its travel is -180 .. 180 deg"
    );
    let unknown = refused(&|table| table.axes[4].address = "B1".into());
    assert!(unknown.starts_with("Fanuc has no axis address `B1`, which axis `slide of B` has"), "{unknown}");
    let twice = refused(&|table| table.axes[4].address = "A".into());
    assert_eq!(twice, "axes `slide of A` and `slide of B` have the same address `A`");
    let back = refused(&|table| table.rows[50].motion = table.rows[49].motion);
    assert!(back.contains("turns back at roll = "), "{back}");
    assert!(refused(&|table| table.rows.truncate(1)).contains("at least two positions"));
    let quick = refusal(Dialect::Fanuc, 0.1, |_| ()).to_string();
    assert!(quick.contains("Fanuc takes 0.001 .. 9999.999"), "{quick}");
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refusal(Dialect::LinuxCnc, seconds, |_| ()), NcError::Time { .. }));
    }
}

#[test]
fn a_position_at_the_end_of_the_travel_is_taken() {
    let mut table = table();
    table.axes.truncate(1);
    table.axes[0].travel = Some([-1.0, 1.0]);
    table.series = None;
    let row = |motion, x| MotionRow { motion, axes: vec![x] };
    table.rows = vec![row(0.0, -1.0 - 1e-10), row(1.0, 1.0)];
    program(&table, Dialect::Fanuc);
    table.rows[1].axes[0] = 1.0001;
    assert!(write_nc(&table, Dialect::Fanuc, 1.0, &mut Vec::new()).is_err());
}

/// Different in each row, axis and order.
fn rates() -> Rates {
    let rate = |row: usize, axis: usize| [1.0, 2.0, 3.0].map(|order| order * 0.1 + row as f64 + axis as f64 * 0.01);
    Rates { seconds: CUTTING_TIME, rows: (0..ROWS).map(|row| (0..6).map(|axis| rate(row, axis)).collect()).collect() }
}

#[test]
fn rates_stand_behind_the_positions() {
    let table = MotionTable { rates: Some(rates()), ..table() };
    let text = written(|out| write_motion_csv(&table, out));
    let seconds = "# velocity, acceleration and jerk: per s, s^2 and s^3, while the motion takes 12 s evenly";
    assert!(text.lines().any(|line| line == seconds), "{text}");
    let mut body = text.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = body.next().expect("titles").split(',').collect();
    assert_eq!(titles[7..10], ["slide of X velocity", "slide of X acceleration", "slide of X jerk"]);
    let row: Vec<f64> = body.nth(2).expect("a row").split(',').map(|cell| cell.parse().expect("a number")).collect();
    let expected: Vec<f64> = rates().rows[2]
        .iter()
        .enumerate()
        .flat_map(|(axis, of)| of.map(|rate| if axis > 2 { rate.to_degrees() } else { rate }))
        .collect();
    assert_eq!(row[7..], expected);
    let text = written(|out| write_motion_json(&table, out));
    let document: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(faults_of(&document, SCHEMA), Vec::<String>::new());
    assert_eq!(document["seconds"], 12.0);
    assert_eq!(document["rows"][2]["rates"][5][2].as_f64(), Some(expected[17]));
}

#[test]
fn malformed_tables_are_refused() {
    type Spoil = fn(&mut MotionTable);
    let spoilers: [Spoil; 8] = [
        |table| table.rates.as_mut().expect("rates").rows[3].truncate(5),
        |table| table.rates.as_mut().expect("rates").rows.truncate(5),
        |table| table.rates.as_mut().expect("rates").rows[3][2][1] = f64::NAN,
        |table| table.rows[3].axes.truncate(5),
        |table| table.rows[3].axes[2] = f64::NAN,
        |table| table.rows[3].motion = f64::INFINITY,
        |table| table.series.as_mut().expect("a series").axes.truncate(5),
        |table| table.axes[0].travel = Some([f64::NAN, 0.0]),
    ];
    for spoil in spoilers {
        let mut table = MotionTable { rates: Some(rates()), ..table() };
        spoil(&mut table);
        let mut bytes = Vec::new();
        let results = [
            write_motion_csv(&table, &mut bytes),
            write_motion_json(&table, &mut bytes),
            write_nc(&table, Dialect::Fanuc, 1.0, &mut bytes),
        ];
        assert!(results.iter().all(|result| matches!(result, Err(WriteError::Malformed(_)))), "{results:?}");
        assert!(bytes.is_empty());
    }
}

#[test]
fn csv_has_the_numbers() {
    let table = table();
    let text = written(|out| write_motion_csv(&table, out));
    let (head, body): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
    assert_eq!(body[0], "roll,slide of X,slide of Y,slide of Z,slide of A,slide of B,slide of C");
    for (line, row) in body[1..].iter().zip(&table.rows) {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let degrees = |index: usize| row.axes[index].to_degrees();
        let expected =
            [row.motion.to_degrees(), row.axes[0], row.axes[1], row.axes[2], degrees(3), degrees(4), degrees(5)];
        assert_eq!(numbers, expected);
    }
    assert!(head.iter().any(|line| line.starts_with("# axis `slide of X` in mm, address X, from -23.6")), "{head:?}");
    // 20 deg per deg, and half a degree of the reference in it
    assert!(
        head.contains(&"# polynomial of `slide of A`: 0 20; remainder within 0.057295779513082325 deg"),
        "{head:?}"
    );
}

#[test]
fn json_keeps_the_schema() {
    for mut table in [table(), MotionTable { rows: Vec::new(), series: None, ..table() }] {
        table.axes[0].travel = None;
        let text = written(|out| write_motion_json(&table, out));
        let document: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(document["schema"], SCHEMA);
        assert_eq!(faults_of(&document, SCHEMA), Vec::<String>::new());
        assert_eq!(text.lines().filter(|line| line.contains("{\"motion\"")).count(), table.rows.len());
        for (out, row) in document["rows"].as_array().expect("rows").iter().zip(&table.rows) {
            assert_eq!(out["motion"].as_f64(), Some(row.motion.to_degrees()));
            assert_eq!(out["axes"][1].as_f64(), Some(row.axes[1]));
            assert_eq!(out["axes"][3].as_f64(), Some(row.axes[3].to_degrees()));
        }
        let mut spoilt = document.clone();
        spoilt["axes"][0]["unit"] = "rad".into();
        spoilt["schema"] = "flank.motion/1".into();
        assert_eq!(faults_of(&spoilt, SCHEMA), ["/axes/0/unit: oneOf", "/schema: const"]);
    }
}

/// Files give the same positions whether one takes rows or polynomials: both in the units of the file.
#[test]
fn written_polynomials_give_written_positions() {
    let mut table = table();
    let series = table.series.as_mut().expect("a series");
    series.axes[4].coefficients = vec![0.3 + 0.01 * 0.1 * 0.1, 2.0 * 0.01 * 0.1, 0.01];
    let text = written(|out| write_motion_json(&table, out));
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    let coefficients = document["series"]["axes"][4]["coefficients"].as_array().expect("coefficients");
    for row in document["rows"].as_array().expect("rows") {
        let distance = number(&row["motion"]) - number(&document["series"]["reference"]);
        let value = coefficients.iter().rev().fold(0.0, |sum, c| sum * distance + number(c));
        assert!((value - number(&row["axes"][4])).abs() < 1e-12);
    }
}

/// LinuxCNC's own interpreter, where it is installed: `rs274` of Debian's `linuxcnc-uspace`.
#[test]
fn linuxcnc_takes_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for empty in ["tool.tbl", "parameters.var"] {
        std::fs::write(path(empty), "").expect("written");
    }
    let table = table();
    std::fs::write(path("part.ngc"), program(&table, Dialect::LinuxCnc)).expect("written");
    let arguments = ["-g", "-t", "tool.tbl", "-v", "parameters.var", "part.ngc"];
    let Ok(output) = Command::new("rs274").args(arguments).current_dir(folder.path()).output() else {
        eprintln!("skipped 1 of 1 interpreters: rs274 is not installed");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let moves: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| line.split_once("STRAIGHT_FEED(").or_else(|| line.split_once("STRAIGHT_TRAVERSE(")))
        .map(|(_, numbers)| numbers.trim_end_matches(')').split(", ").map(|x| x.parse().expect("a number")).collect())
        .collect();
    assert_eq!(moves.len(), table.rows.len());
    for (found, row) in moves.iter().zip(&table.rows) {
        for ((axis, position), found) in table.axes.iter().zip(&row.axes).zip(found) {
            let expected = if axis.is_rotary { position.to_degrees() } else { *position };
            // it prints four decimals itself
            let last = 0.5 * 10f64.powi(-i32::from(axis.decimals)) + 0.5e-4;
            assert!((found - expected).abs() <= last + 1e-12, "{} {found} {expected}", axis.address);
        }
    }
}
