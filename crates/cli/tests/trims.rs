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

/// The named columns of all points of a job.
fn points<const N: usize>(folder: &Path, (job, spec): (&str, &str), columns: [&str; N]) -> Vec<[String; N]> {
    let (file, out) = (written(folder, &format!("{job}.chain"), spec), folder.to_str().expect("a plain path"));
    let run = flank(&["solve", &file, "--no-picture", "--out", out]);
    let table = std::fs::read_to_string(folder.join(format!("{job}.csv")));
    let table = table.unwrap_or_else(|_| panic!("{}", text(&run.stderr)));
    let mut rows = table.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect::<Vec<_>>());
    let names = rows.next().expect("a head");
    let columns = columns.map(|name| names.iter().position(|title| *title == name).expect("a column"));
    rows.map(|row| columns.map(|column| row[column].to_string())).collect()
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

impl Walls {
    fn solved(&self, folder: &Path, side: &str, sample: &str) -> Vec<Row> {
        let [low, high] = self.turns;
        let spec = WALLS.replace("SIDE", side).replace("MOTION", &format!("{low} deg .. {high} deg"));
        let spec =
            spec.replace("SWING2", &format!("{} mm", self.swing2)).replace("SWING", &format!("{} mm", self.swing));
        let spec = spec.replace("WAVES2", &self.waves2.to_string()).replace("SAMPLE", sample);
        let columns = ["surface", "status", "turn", "turn2", "x", "y"];
        let row = |[surface, status, turn, turn2, x, y]: [String; 6]| {
            let turn = number(if turn.is_empty() { &turn2 } else { &turn });
            Row { surface, status, turn, at: [number(&x), number(&y)] }
        };
        points(folder, ("walls", &spec), columns).into_iter().map(row).collect()
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

/// Two pins that roll past one work, each with a feed of its own: the wall of the first runs into what the second takes and out of it again.
const ROLLED: &str = "
machine roller {
    axis c : rotary
    axis x : linear
    axis y : linear
    frame bed
    frame slide in bed = translate(x, y, 0 mm)
    frame part in bed = rotate_z(c)
}
tool pin {
    param r : length
    surface skin(a: angle in -180 deg .. 180 deg, v: length in -9 mm .. 9 mm) {
        at = [r * cos(a), r * sin(a), v]
        body inside
    }
}
job rolled {
    machine m = roller
    machine n = roller
    tool p = pin(r: OWN_RADIUS mm)
    tool q = pin(r: OTHER_RADIUS mm)
    mount p on m.slide
    mount q on n.slide
    motion turn : angle in -20 deg .. 20 deg
    motion other : angle in -OTHER_TURN deg .. OTHER_TURN deg
    drive m.c, m.x, m.y = turn, OWN_WAY * turn
    drive n.c, n.x, n.y = other, OTHER_WAY * other
    surface wall in m.part = envelope(p.skin, over: turn)
    surface cut in n.part = envelope(q.skin, over: other)
    sample wall { turn: -19 deg .. 19 deg by 61, z: -1 mm .. 1 mm by COUNT
        keep nx: -1 .. 0.05 }
    trim wall by cut
}";

/// A pin that rolls past the work: its radius, how far it is from the axis, by how much and in how many waves that changes, where it starts
/// along its feed, the feed for a turn of one radian, mm, and the range of the turn to either side, degrees.
struct Pin {
    radius: f64,
    far: f64,
    swing: f64,
    waves: f64,
    start: f64,
    feed: f64,
    turn: f64,
}

impl Pin {
    const fn new([radius, far, swing, waves, start, feed, turn]: [f64; 7]) -> Pin {
        Pin { radius, far, swing, waves, start, feed, turn }
    }

    /// Where it goes, as a spec says it; the word for the turn follows.
    fn way(&self, turn: &str) -> String {
        let Pin { far, swing, waves, start, feed, .. } = self;
        format!("{far} mm + {swing} mm * cos({waves} * {turn}), {start} mm + {feed} mm")
    }

    /// How far a point of the work stays off the pin on all its way. A step of 2e-5 rad of 34 mm and 43 mm/rad makes it larger by less than
    /// 1e-6 mm where the pin has 1 mm.
    fn clear(&self, [x, y]: [f64; 2]) -> f64 {
        let off = |step: i32| {
            let turn = f64::from(step) / 50_000.0 * self.turn.to_radians();
            let (sin, cos) = turn.sin_cos();
            let [along, across] = [cos * x - sin * y, sin * x + cos * y];
            let far = self.far + self.swing * (self.waves * turn).cos();
            (along - far).hypot(across - self.start - self.feed * turn) - self.radius
        };
        (-50_000..=50_000).map(off).fold(f64::INFINITY, f64::min)
    }
}

/// The points of the first pin's wall that its own tool leaves, each with whether it is trimmed. Of these a point stays exactly if the second
/// pin is clear of it.
fn rolled(folder: &Path, [own, other]: &[Pin; 2], count: usize) -> Vec<bool> {
    let spec = ROLLED.replace("COUNT", &count.to_string()).replace("OTHER_TURN", &other.turn.to_string());
    let spec = spec.replace("OWN_RADIUS", &own.radius.to_string()).replace("OTHER_RADIUS", &other.radius.to_string());
    let spec = spec.replace("OWN_WAY", &own.way("turn")).replace("OTHER_WAY", &other.way("other"));
    let mut verdicts = Vec::new();
    for [surface, status, x, y] in points(folder, ("rolled", &spec), ["surface", "status", "x", "y"]) {
        if surface != "wall" || status == "undercut" {
            continue;
        }
        let clear = other.clear([number(&x), number(&y)]);
        if clear.abs() > 1e-5 {
            assert_eq!(status, if clear < 0.0 { "trimmed" } else { "solved" }, "{clear} at {x}, {y} of\n{spec}");
        }
        verdicts.push(status == "trimmed");
    }
    verdicts
}

/// Points of one cross-section are alike on each of its lines. The second crossing was found on some lines alone, and all points behind the first
/// one were called trimmed on the others.
#[test]
fn a_crossing_that_one_line_has_the_next_one_has() {
    let folder = folder("rolled");
    let pins = [[1.4, 29.2, 0.0, 1.0, -0.9, 15.0, 20.0], [2.6, 30.1, 0.0, 1.0, -0.2, 33.0, 50.0]].map(Pin::new);
    for count in [2, 3, 5] {
        let trimmed = rolled(&folder, &pins, count).into_iter().filter(|is_trimmed| *is_trimmed).count();
        assert!(trimmed > 30 * count && trimmed < 50 * count, "{count}: {trimmed}");
    }
}

/// What the second pin takes ends with its motion, where it leaves its own round and no envelope: points within it there went unseen, and all
/// points beyond it were called trimmed. It leaves two walls, of which the nearer one counts: they were undecided.
#[test]
fn what_a_tool_takes_is_known_where_its_envelope_ends() {
    let folder = folder("ends");
    // with how many of how many points are trimmed
    let cases = [
        // some points are in the steel on all its way
        ([1.9, 29.9, 0.5, 4.0, 0.8, 18.0, 20.0], [2.9, 29.2, 0.5, 3.0, 2.4, 33.0, 20.0], [88, 122]),
        // points beyond the end of its motion
        ([1.2, 30.7, 0.0, 5.0, 0.7, 21.0, 20.0], [2.1, 29.3, 0.0, 6.0, -3.0, 21.0, 20.0], [78, 122]),
        ([1.1, 29.4, 0.5, 4.0, -0.7, 42.0, 20.0], [1.5, 29.8, 0.5, 5.0, 2.5, 39.0, 20.0], [72, 122]),
        // nothing meets; beside the points lie both walls
        ([2.0, 30.3, 0.5, 5.0, -1.7, 27.0, 20.0], [2.6, 30.2, 0.0, 7.0, 1.6, 27.0, 20.0], [66, 66]),
        ([2.4, 31.2, 0.0, 7.0, -1.5, 18.0, 20.0], [1.6, 30.1, 0.5, 2.0, -0.5, 21.0, 20.0], [0, 122]),
        // the wall comes out of what the pin takes where its own tool cuts it away
        ([1.2, 31.8, 0.5, 2.0, -2.7, 39.0, 20.0], [1.7, 31.7, 0.0, 5.0, -2.2, 18.0, 50.0], [2, 80]),
    ];
    for (own, other, expected) in cases {
        let verdicts = rolled(&folder, &[own, other].map(Pin::new), 2);
        let trimmed = verdicts.iter().filter(|is_trimmed| **is_trimmed).count();
        assert_eq!([trimmed, verdicts.len()], expected, "{own:?} {other:?}");
    }
}

/// Two racks that make one gear.
const RACKS: &str = "
machine planer {
    param r : length
    axis C : rotary
    axis Y : linear
    frame bed
    frame table in bed = rotate_z(C)
    frame rack in bed = translate(r, Y, 0 mm)
}
tool rack {
    param alpha : angle
    param tip : length
    param rounding : length
    param root : length
    param shift : length in -100 mm .. 100 mm
    let half = 2.356194490192345 mm
    let end = (tip - rounding * (1 - sin(alpha))) / cos(alpha)
    let center = half - (tip - rounding) * tan(alpha) - rounding / cos(alpha)
    surface flank_plus, flank_minus(u: length in -root / cos(alpha) .. end, v: length in -5 mm .. 5 mm) for side in [1, -1] {
        at = [shift - u * cos(alpha), side * (half - u * sin(alpha)), v]
        body towards [0, -side, 0]
    }
    surface fillet_plus, fillet_minus(a: angle in alpha .. 90 deg, v: length in -5 mm .. 5 mm) for side in [1, -1] {
        at = [shift - (tip - rounding) - rounding * sin(a), side * (center + rounding * cos(a)), v]
        body towards [sin(a), -side * cos(a), 0]
    }
    surface land(share: number in -1 .. 1, v: length in -5 mm .. 5 mm) {
        at = [shift - tip, share * center, v]
        body towards [1, 0, 0]
    }
}
job gear {
    machine m = planer(r: RADIUS mm)
    tool t = rack(FIRST)
    tool k = rack(SECOND)
    mount t on m.rack
    mount k on m.rack
    motion roll : angle in -60 deg .. 60 deg
    drive m.C, m.Y = roll, RADIUS mm * roll
    surface flank in m.table = envelope(t.flank_plus, over: roll)
    surface flank_plus, flank_minus, fillet_plus, fillet_minus, land in m.table =
        envelope(k.flank_plus, k.flank_minus, k.fillet_plus, k.fillet_minus, k.land, over: roll)
    TRIMS
    sample flank { u: -t.root / cos(t.alpha) * 0.99 .. t.end * 0.99 by 46, z: -1 mm .. 1 mm by 2 }
}";

struct Rack {
    /// rad
    alpha: f64,
    tip: f64,
    rounding: f64,
    root: f64,
    shift: f64,
}

impl Rack {
    fn arguments(&self) -> String {
        let Rack { alpha, tip, rounding, root, shift } = self;
        format!("alpha: {alpha} rad, tip: {tip} mm, rounding: {rounding} mm, root: {root} mm, shift: {shift} mm")
    }

    /// How deep the tooth of the rack comes at the most into a point of a gear, mm: on its whole way, by 2.1e-5 rad.
    fn depth(&self, radius: f64, [x, y]: [f64; 2]) -> f64 {
        let half = 0.75 * std::f64::consts::PI;
        let (sine, cosine) = self.alpha.sin_cos();
        let center =
            [self.tip - self.rounding, half - (self.tip - self.rounding) * sine / cosine - self.rounding / cosine];
        let depth = |step: u32| {
            let roll = (f64::from(step) / 50_000.0 - 1.0) * std::f64::consts::FRAC_PI_3;
            let below = radius + self.shift - (roll.cos() * x - roll.sin() * y);
            let aside = (roll.sin() * x + roll.cos() * y - radius * roll).abs();
            let flat = ((half - aside) * cosine - below * sine).min(self.tip - below);
            let [down, out] = [below - center[0], aside - center[1]];
            let is_round = out > 0.0 && down > out * sine / cosine;
            let depth = if is_round { flat.min(self.rounding - down.hypot(out)) } else { flat };
            if below < -self.root { f64::NEG_INFINITY } else { depth }
        };
        (0..=100_000).map(depth).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A flank enters what another tool takes through its flank and leaves it through its rounding: beyond that it stays. A land meets the flank,
/// too, and bounds the same body.
#[test]
fn what_leaves_a_body_may_enter_it_again() {
    let cases = [
        (
            36.0,
            Rack {
                alpha: 0.4958255383780585,
                tip: 3.753226551724058,
                rounding: 0.49241157384317996,
                root: 1.906315039314884,
                shift: -0.26104535993027145,
            },
            Rack {
                alpha: 0.31453700763950954,
                tip: 3.086134338285172,
                rounding: 0.38119435676289154,
                root: 1.5134589114758419,
                shift: 0.38610521966013955,
            },
            &["flank_plus", "fillet_plus"][..],
        ),
        (
            25.5,
            Rack {
                alpha: 0.4999277378071509,
                tip: 2.5220846110607216,
                rounding: 1.023569270441799,
                root: 2.736798327876583,
                shift: 0.2534961678374821,
            },
            Rack {
                alpha: 0.19733487332829128,
                tip: 1.8848409524398182,
                rounding: 0.2816868421286136,
                root: 1.7997945907695443,
                shift: 0.4146262186684053,
            },
            &["land", "flank_plus", "fillet_plus", "flank_minus", "fillet_minus"][..],
        ),
    ];
    let folder = folder("racks");
    for (radius, own, other, by) in cases {
        let trims: Vec<String> = by.iter().map(|by| format!("trim flank by {by}")).collect();
        let spec = RACKS.replace("RADIUS", &radius.to_string()).replace("TRIMS", &trims.join("\n    "));
        let spec = spec.replace("FIRST", &own.arguments()).replace("SECOND", &other.arguments());
        let mut told = [0, 0];
        let gear = points(&folder, ("gear", &spec), ["surface", "status", "x", "y"]);
        for [_, status, x, y] in gear.iter().filter(|[surface, ..]| surface == "flank") {
            let at = [number(x), number(y)];
            let depth = other.depth(radius, at);
            let is_taken = status == "trimmed";
            assert!(is_taken || status == "solved", "{status}");
            // what lies between is touched, as far as the steps of the roll tell
            assert!(if is_taken { depth > -1e-6 } else { depth < 1e-6 }, "{depth} at {at:?}, told {status}");
            told[usize::from(is_taken)] += 1;
        }
        assert!(told[0] > 40 && told[1] > 20, "{told:?}");
    }
}
