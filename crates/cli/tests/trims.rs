//! Two pins mill one wall on two paths, and each takes away what the other leaves: a point stays exactly if the other pin never covers it.

mod support;

use std::path::Path;

use support::{flank, folder, text, written};

/// Half pins of 5 and 6 mm, whose centres move at 40 mm + swing cos(9 turn) and 41.5 mm + swing2 cos(waves2 turn) from the axis. Where
/// the pins are whole, each makes a second wall behind it, which no sample keeps.
const WALLS: &str = "
machine cam_mill {
    axis C : rotary
    axis X : linear
    frame bed
    frame work in bed = rotate_z(-C)
    frame pin in bed = translate_x(X)
}
tool pin {
    param r : length = 5 mm
    surface side(u: angle in SIDE, v: length in -5 mm .. 5 mm) {
        at = [r * cos(u), r * sin(u), v]
        body inside
    }
}
job walls {
    machine m = cam_mill
    machine k = cam_mill
    tool p = pin
    tool q = pin(r: 6 mm)
    mount p on m.pin
    mount q on k.pin
    motion turn : angle in MOTION
    motion turn2 : angle in MOTION
    drive m.C = turn
    drive m.X = 40 mm + SWING * cos(9 * turn)
    drive k.C = turn2
    drive k.X = 41.5 mm + SWING2 * cos(WAVES2 * turn2)
    surface inner in m.work = envelope(p.side, over: turn)
    surface other in k.work = envelope(q.side, over: turn2)
    sample inner { turn: SAMPLE by 81, z: -1 mm .. 1 mm by 3
        keep u: 90 deg .. 270 deg }
    sample other { turn2: SAMPLE by 81, z: -1 mm .. 1 mm by 3
        keep u: 90 deg .. 270 deg }
    trim inner by other
    trim other by inner
}";
const HALF: &str = "120 deg .. 240 deg";
const WHOLE: &str = "-180 deg .. 180 deg";

/// How two pins move: the swings of both, mm, the waves of the second, and the range of both turns, degrees.
struct Walls {
    swing: f64,
    swing2: f64,
    waves2: f64,
    turns: [f64; 2],
}

/// A point of a table: of which surface or line, its status, turn of the pin that makes it, and where it is across the axis.
struct Row {
    surface: String,
    status: String,
    turn: f64,
    at: [f64; 2],
}

impl Walls {
    fn solved(&self, folder: &Path, side: &str, sample: &str) -> Vec<Row> {
        let [low, high] = self.turns;
        let spec = WALLS.replace("SIDE", side).replace("MOTION", &format!("{low} deg .. {high} deg"));
        let spec =
            spec.replace("SWING2", &format!("{} mm", self.swing2)).replace("SWING", &format!("{} mm", self.swing));
        let spec = spec.replace("WAVES2", &self.waves2.to_string()).replace("SAMPLE", sample);
        let (file, out) = (written(folder, "walls.chain", &spec), folder.to_str().expect("a plain path"));
        let run = flank(&["solve", &file, "--no-picture", "--out", out]);
        let table =
            std::fs::read_to_string(folder.join("walls.csv")).unwrap_or_else(|_| panic!("{}", text(&run.stderr)));
        let mut rows = table.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect::<Vec<_>>());
        let names = rows.next().expect("a head");
        let column = |name: &str| names.iter().position(|title| *title == name).expect("a column");
        let [surface, status, turn, turn2, x, y] = ["surface", "status", "turn", "turn2", "x", "y"].map(column);
        let row = |row: Vec<&str>| {
            let number = |column: usize| row[column].parse().expect("a number");
            let turn = if row[turn].is_empty() { turn2 } else { turn };
            Row {
                surface: row[surface].to_string(),
                status: row[status].to_string(),
                turn: number(turn),
                at: [number(x), number(y)],
            }
        };
        rows.map(row).collect()
    }

    /// How far a point lies off the pin that does not make it, on all of its way: less than zero where that takes it away. The step of
    /// 3e-4 rad along the way makes it larger by less than 5e-6 mm.
    fn clear(&self, row: &Row) -> f64 {
        let [low, high] = self.turns.map(f64::to_radians);
        let is_inner = row.surface.starts_with("inner");
        let (centre, swing, waves, radius) =
            if is_inner { (41.5, self.swing2, self.waves2, 6.0) } else { (40.0, self.swing, 9.0, 5.0) };
        let count = 20_000;
        let off = |step: u32| {
            let turn = low + (high - low) * f64::from(step) / f64::from(count);
            let far = centre + swing * (waves * turn).cos();
            (far * turn.cos() - row.at[0]).hypot(far * turn.sin() - row.at[1])
        };
        (0..=count).map(off).fold(f64::INFINITY, f64::min) - radius
    }
}

fn count(rows: &[Row], surface: &str, status: &str) -> usize {
    rows.iter().filter(|row| row.surface == surface && row.status == status).count()
}

/// Each crossing on a line of the grid is a root of its own, and is listed: where the waves of one wall are as far from the axis as the
/// other wall, a cylinder, which no value of its tool's angle tells from another.
#[test]
fn each_crossing_is_listed() {
    let folder = folder("crossings");
    let walls = Walls { swing: 1.0, swing2: 0.0, waves2: 0.0, turns: [-60.0, 60.0] };
    let rows = walls.solved(&folder, HALF, "-40 deg .. 40 deg");
    // the pin touches the wall where its centre moves across
    let outside = |degrees: f64| {
        let turn = degrees.to_radians();
        let (along, across) = (40.0 + (9.0 * turn).cos(), -9.0 * (9.0 * turn).sin());
        let speed = along.hypot(across);
        (along - 5.0 * along / speed).hypot(5.0 * across / speed) - 35.5
    };
    let mut crossings = Vec::new();
    for step in -80..80 {
        let mut ends = [f64::from(step) / 2.0, f64::from(step + 1) / 2.0];
        if outside(ends[0]) * outside(ends[1]) > 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = f64::midpoint(ends[0], ends[1]);
            let k = usize::from(outside(middle) * outside(ends[0]) <= 0.0);
            ends[k] = middle;
        }
        crossings.push(ends[0]);
    }
    assert_eq!(crossings.len(), 4, "{crossings:?}");
    let listed: Vec<f64> =
        rows.iter().filter(|row| row.surface == "inner.trimmed_by_other").map(|row| row.turn).collect();
    assert_eq!(listed.len(), 12, "four on each of three lines: {listed:?}");
    for crossing in crossings {
        // 1e-8 mm, some times the tolerance of a point, at a slope of 1 mm/rad
        let here = listed.iter().filter(|turn| (*turn - crossing).abs() < 1e-6).count();
        assert_eq!(here, 3, "{crossing} in {listed:?}");
    }
    for row in rows.iter().filter(|row| row.surface == "inner") {
        assert_eq!(row.status, if outside(row.turn) > 0.0 { "trimmed" } else { "solved" }, "at {}", row.turn);
    }
}

/// Walls around the axis that meet nowhere: the inner one stays, whether or not the turn comes round to where it began.
#[test]
fn a_wall_around_the_axis_takes_all_that_lies_above_it() {
    let folder = folder("full_turn");
    for (side, turns) in [(HALF, [-180.0, 180.0]), (HALF, [-179.9, 179.9]), (HALF, [0.0, 360.0]), (WHOLE, [0.0, 360.0])]
    {
        let walls = Walls { swing: 0.0, swing2: 0.0, waves2: 0.0, turns };
        let rows = walls.solved(&folder, side, &format!("{} deg .. {} deg", turns[0], turns[1]));
        assert_eq!(
            (count(&rows, "inner", "solved"), count(&rows, "other", "trimmed")),
            (243, 243),
            "{side}, {turns:?}"
        );
    }
}

/// A point stays exactly if the other pin is clear of it on all its way; also where that pin cuts under its own wall, and where both
/// walls close around the axis.
#[test]
fn what_the_other_pin_covers_is_trimmed() {
    let folder = folder("covered");
    let undercut = Walls { swing: 0.96, swing2: 2.43, waves2: 11.0, turns: [-60.0, 60.0] };
    let closed = Walls { swing: 1.0, swing2: 2.0, waves2: 4.0, turns: [0.0, 360.0] };
    for (walls, side, sample) in [
        (&undercut, HALF, "-40 deg .. 40 deg"),
        (&closed, HALF, "0 deg .. 360 deg"),
        (&closed, WHOLE, "0 deg .. 360 deg"),
    ] {
        let rows = walls.solved(&folder, side, sample);
        for row in &rows {
            let clear = walls.clear(row);
            let is_right = match (row.surface.contains('.'), row.status.as_str()) {
                (true, _) => clear.abs() < 1e-5,
                (false, "solved") => clear > -1e-5,
                (false, "trimmed") => clear < 1e-5,
                (false, status) => status == "undercut",
            };
            assert!(is_right, "{} at {} is {}: {clear}", row.surface, row.turn, row.status);
        }
        for (surface, status) in [("inner", "solved"), ("inner", "trimmed"), ("other", "solved"), ("other", "trimmed")]
        {
            assert!(count(&rows, surface, status) > 20, "{surface}, {status}, {side}");
        }
        for line in ["inner.trimmed_by_other", "other.trimmed_by_inner"] {
            assert!(count(&rows, line, "solved") >= 12, "{line}, {side}");
        }
    }
}
