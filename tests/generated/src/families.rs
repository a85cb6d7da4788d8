//! Random cases: machines of the trade with their curves drawn tight, and machines of no trade at all.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_tests::Dice;

use crate::case::{Asked, Case, Coordinate};
use crate::machine::{AXES, Kind, Machine, Motion, Range, Step, rounded};
use crate::oracle::Touched;
use crate::pose::Vector;
use crate::tool::{Blade, Shape};

const X: Vector = AXES[0];
const Y: Vector = AXES[1];
const Z: Vector = AXES[2];

/// Numbers with few digits, so that specs stay readable.
struct Random(Dice);

impl Random {
    fn share(&mut self) -> f64 {
        self.0.roll(10_001) as f64 / 10_000.0
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        (1000.0 * (low + self.share() * (high - low))).round() / 1000.0
    }

    fn about_zero(&mut self, reach: f64) -> f64 {
        self.within(-reach, reach)
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.0.roll(n) == 0
    }

    fn side(&mut self) -> f64 {
        if self.one_in(2) { 1.0 } else { -1.0 }
    }

    fn direction(&mut self) -> [f64; 3] {
        match self.0.roll(4) {
            0 => X,
            1 => Y,
            2 => Z,
            _ => loop {
                let v = [self.about_zero(1.0), self.about_zero(1.0), self.about_zero(1.0)];
                if v.iter().map(|x| x * x).sum::<f64>() > 0.1 {
                    return v;
                }
            },
        }
    }
}

/// A machine with its tool, not yet sampled.
struct Parts {
    machine: Machine,
    shape: Shape,
    patch: [Range; 2],
    trimmed_by: Option<(Machine, Shape, [Range; 2])>,
}

impl Parts {
    fn new(machine: Machine, shape: Shape, patch: [Range; 2]) -> Parts {
        Parts { machine, shape, patch, trimmed_by: None }
    }
}

/// The case of a number; nothing where that machine generates nothing that could be sampled.
pub fn case(seed: u64) -> Option<Case> {
    let mut random = Random(Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(17)));
    for _ in 0..8 {
        random.0.roll(2);
    }
    type Family = (&'static str, fn(&mut Random) -> Parts);
    const FAMILIES: [Family; 11] = [
        ("cycloid", cycloid),
        ("gerotor", gerotor),
        ("rack", rack),
        ("rack_tip", rack_tip),
        ("crossed_hob", crossed_hob),
        ("trimmed_rack", trimmed_rack),
        ("hourglass", hourglass),
        ("turned_worm", turned_worm),
        ("globoid_wheel", globoid_wheel),
        ("any_machine", any_machine),
        ("any_machine", any_machine),
    ];
    let (family, parts) = FAMILIES[random.0.roll(FAMILIES.len())];
    for _ in 0..6 {
        let Parts { machine, shape, patch, trimmed_by } = parts(&mut random);
        let sample = [0, 1].map(|_| Asked::only(&Coordinate::Rho, 0.0));
        let case = Case { family, machine, shape, patch, sample, kept: None, trimmed_by };
        if let Some((sample, kept)) = sample_of(&case, &mut random) {
            return Some(Case { sample, kept, ..case });
        }
    }
    None
}

fn about(middle: f64, half: f64) -> Range {
    Range { low: middle - half, high: middle + half }.rounded()
}

fn angle(name: &'static str, range: Range) -> Motion {
    Motion { name, is_angle: true, range }
}

/// A pin that stands still leaves a disc on a crank, which turns back by one lobe a turn.
fn cycloid(random: &mut Random) -> Parts {
    let pins = 4.0 + random.0.roll(14) as f64;
    let circle = random.within(25.0, 80.0);
    let eccentricity = rounded(random.within(0.2, 1.3) * circle / pins);
    let radius = rounded(random.within(0.05, 0.6) * circle.min(50.0));
    let half = random.within(0.5, 1.0) * PI;
    let middle = random.about_zero(PI);
    let machine = Machine {
        work: vec![
            Step::moved(Kind::Turn(Z), 0.0, &[1.0]),
            Step::fixed(Kind::Shift(X), eccentricity),
            Step::moved(Kind::Turn(Z), 0.0, &[-pins / (pins - 1.0)]),
        ],
        tool: vec![],
        motions: vec![angle("phi", about(middle, half))],
    };
    Parts::new(machine, Shape::Pin { circle, radius, side: 1.0 }, [about(PI, 2.0), about(0.0, 20.0)])
}

/// The outer ring about an inner wheel of pins.
fn gerotor(random: &mut Random) -> Parts {
    let lobes = 3.0 + random.0.roll(9) as f64;
    let circle = random.within(20.0, 60.0);
    let eccentricity = random.within(0.2, 1.3) * circle / lobes;
    let radius = rounded(random.within(0.1, 0.5) * circle);
    let half = random.within(0.5, 1.2) * PI;
    let machine = Machine {
        work: vec![
            Step::moved(Kind::Turn(Z), 0.0, &[1.0]),
            Step::fixed(Kind::Shift(X), eccentricity),
            Step::moved(Kind::Turn(Z), 0.0, &[-lobes / (lobes + 1.0)]),
        ],
        tool: vec![],
        motions: vec![angle("phi", about(0.0, half))],
    };
    Parts::new(machine, Shape::Pin { circle, radius, side: 1.0 }, [about(0.0, 2.0), about(0.0, 20.0)])
}

/// A rack's tooth, one side of it, that rolls on the reference circle of a gear with few teeth.
struct Rack {
    module: f64,
    pressure: f64,
    side: f64,
    half_roll: f64,
    radius: f64,
    helix: f64,
    shift: f64,
    tip_radius: f64,
    tip_height: f64,
}

impl Rack {
    fn random(random: &mut Random) -> Rack {
        let (module, teeth) = (random.within(1.0, 6.0), 5.0 + random.0.roll(20) as f64);
        let tip_height = rounded(1.25 * module);
        Rack {
            module,
            pressure: random.within(0.2, 0.5),
            side: random.side(),
            half_roll: (8.0 / teeth).clamp(0.6, 1.4),
            radius: rounded(0.5 * module * teeth),
            helix: if random.one_in(3) { random.about_zero(0.4) } else { 0.0 },
            shift: random.about_zero(0.5),
            tip_radius: rounded(random.within(0.1, 0.6) * module).min(rounded(0.4 * tip_height)),
            tip_height,
        }
    }

    fn machine(&self, place: Vec<Step>) -> Machine {
        let mut tool = vec![
            Step::fixed(Kind::Shift(X), self.radius + self.shift * self.module),
            Step::fixed(Kind::Turn(X), self.helix),
            Step::moved(Kind::Shift(Y), 0.0, &[rounded(self.radius * self.helix.cos())]),
        ];
        tool.extend(place);
        let work = vec![Step::moved(Kind::Turn(Z), 0.0, &[1.0])];
        Machine { work, tool, motions: vec![angle("phi", about(0.0, self.half_roll))] }
    }

    fn half_width(&self) -> Range {
        about(0.0, 8.0 * self.module)
    }

    fn flank(&self, high: f64) -> (Machine, Shape, [Range; 2]) {
        let machine = self.machine(vec![
            Step::fixed(Kind::Shift(Y), self.side * PI * self.module / 4.0),
            Step::fixed(Kind::Turn(Z), PI + self.side * self.pressure),
            Step::fixed(Kind::Turn(X), FRAC_PI_2),
        ]);
        let shape = Shape::Graph { of: [0.0; 5], side: self.side, thickness: 0.15 * self.module };
        (machine, shape, [Range { low: rounded(-self.module / self.pressure.cos()), high }, self.half_width()])
    }

    /// The rounding, whose axis stands at a place along y.
    fn tip(&self, y: f64, angles: Range) -> (Machine, Shape, [Range; 2]) {
        let depth = self.tip_radius - self.tip_height;
        let machine =
            self.machine(vec![Step::fixed(Kind::Shift([0.0, 1.0, 0.0]), y), Step::fixed(Kind::Shift(X), depth)]);
        (machine, Shape::Pin { circle: 0.0, radius: self.tip_radius, side: 1.0 }, [angles, self.half_width()])
    }
}

/// The straight flank of a rack.
fn rack(random: &mut Random) -> Parts {
    let rack = Rack::random(random);
    let (machine, shape, patch) = rack.flank(rounded(random.within(0.8, 1.25) * rack.module / rack.pressure.cos()));
    Parts::new(machine, shape, patch)
}

/// The rounded tip of a rack: a fillet.
fn rack_tip(random: &mut Random) -> Parts {
    let rack = Rack::random(random);
    let (machine, shape, patch) = rack.tip(0.0, about(PI + random.0.roll(2) as f64 * 0.3, 1.2));
    Parts::new(machine, shape, patch)
}

/// Flank and rounding of one rack, which trim each other.
fn trimmed_rack(random: &mut Random) -> Parts {
    let rack = Rack { tip_radius: 0.0, ..Rack::random(random) };
    let rack = Rack { tip_radius: rounded(random.within(0.1, 0.35) * rack.module), ..rack };
    let (s, c) = rack.pressure.sin_cos();
    let end = (rack.tip_height - rack.tip_radius * (1.0 - s)) / c;
    let y = rack.side * (PI * rack.module / 4.0 - (rack.tip_height - rack.tip_radius) * s / c - rack.tip_radius / c);
    // from the flank's normal to the middle of the tip, which points to -x
    let angles = if rack.side > 0.0 {
        Range { low: FRAC_PI_2 + rack.pressure, high: PI }
    } else {
        Range { low: PI, high: 1.5 * PI - rack.pressure }
    };
    let parts = [rack.flank(end), rack.tip(y, angles)];
    let [(machine, shape, patch), (its_machine, its_shape, [across, along])] = if random.one_in(2) {
        parts
    } else {
        let [a, b] = parts;
        [b, a]
    };
    // of a rack that is so long that none of its ends passes a point of the grid: a trim goes on beyond them
    let other = (its_machine, its_shape, [across, along.wider_by(0.5).rounded()]);
    Parts { machine, shape, patch, trimmed_by: Some(other) }
}

/// A hob whose axis crosses the work's, fed along it or not.
fn crossed_hob(random: &mut Random) -> Parts {
    let module = random.within(1.0, 5.0);
    let starts = 1.0 + random.0.roll(3) as f64;
    let reference = rounded(random.within(6.0, 15.0) * module);
    let teeth = 6.0 + random.0.roll(40) as f64;
    let lead = starts * module / 2.0;
    let distance = reference + 0.5 * module * teeth;
    let swivel = (lead / reference).atan() + random.about_zero(0.3);
    let is_fed = random.one_in(2);
    let (middle, half) = (random.about_zero(1.0), random.within(0.8, 3.6));
    let mut motions = vec![angle("phi", about(middle, half))];
    let mut feed = Step::fixed(Kind::Shift(Z), random.about_zero(2.0 * module));
    if is_fed {
        motions.push(Motion { name: "feed", is_angle: false, range: about(0.0, 5.0 * module) });
        feed = Step::moved(Kind::Shift(Z), 0.0, &[0.0, 1.0]);
    }
    let machine = Machine {
        work: vec![Step::moved(Kind::Turn(Z), 0.0, &[-starts / teeth])],
        tool: vec![
            Step::fixed(Kind::Shift(X), distance),
            feed,
            Step::fixed(Kind::Turn(X), swivel - FRAC_PI_2),
            Step::moved(Kind::Turn(Z), 0.0, &[1.0]),
        ],
        motions,
    };
    let slope = random.within(0.2, 0.5);
    let shape = Shape::Thread { reference, half: PI * module / 4.0, slope, lead, side: random.side() };
    let tau = random.within(1.0, 5.0);
    let addendum = random.within(0.8, 1.25) * module;
    let patch = [Range { low: reference - addendum, high: reference + addendum }.rounded(), about(PI, tau)];
    Parts::new(machine, shape, patch)
}

/// A disc or a cone on a turning table cuts a worm that grows with its table's circle.
fn hourglass(random: &mut Random) -> Parts {
    let distance = random.within(40.0, 120.0);
    let table = random.within(0.5, 0.8) * distance;
    let ratio = 1.0 / (4.0 + random.0.roll(30) as f64);
    let tilt = random.about_zero(0.4);
    let (shape, patch) = if random.one_in(2) {
        let circle = random.within(6.0, 30.0);
        let tube = random.within(1.0, 5.0);
        (Shape::Torus { circle, tube, side: 1.0 }, [about(random.side() * 0.8, 0.8), about(PI, 1.5)])
    } else {
        let shape = Shape::Cone { circle: random.within(8.0, 30.0), slope: random.about_zero(0.6), side: 1.0 };
        (shape, [about(0.0, 4.0), about(PI, 1.5)])
    };
    let reach = match shape {
        Shape::Torus { circle, tube, .. } => circle + tube,
        Shape::Cone { circle, .. } => circle,
        _ => 0.0,
    };
    let (middle, half) = (random.about_zero(3.0), random.within(1.0, 4.0));
    let machine = Machine {
        work: vec![Step::moved(Kind::Turn(Z), 0.0, &[-1.0])],
        tool: vec![
            Step::fixed(Kind::Shift(X), distance),
            Step::moved(Kind::Turn(Y), 0.0, &[ratio]),
            Step::fixed(Kind::Shift(X), reach - table),
            Step::fixed(Kind::Turn(X), tilt),
        ],
        motions: vec![angle("phi", about(middle, half))],
    };
    Parts::new(machine, shape, patch)
}

/// A straight blade on a table, not far from tangent to a circle about it.
fn blade(random: &mut Random) -> (Blade, [Range; 2]) {
    let distance = random.within(60.0, 140.0);
    let pitch = random.within(0.6, 0.85) * distance;
    let base = rounded(random.within(0.2, 0.5) * pitch);
    let teeth = 15.0 + random.0.roll(40) as f64;
    let middle = rounded((pitch * pitch - base * base).sqrt());
    let direction = rounded(PI / 2.0 / teeth - (base / pitch).asin());
    let height = random.within(0.02, 0.08) * (distance - pitch);
    let turn = about(random.about_zero(6.0), random.within(1.0, 12.0));
    (Blade { distance, ratio: rounded(-1.0 / teeth), direction, base, middle, side: 1.0 }, [about(0.0, height), turn])
}

/// The worm that a blade on a turning table leaves.
fn turned_worm(random: &mut Random) -> Parts {
    let (blade, patch) = blade(random);
    let machine = Machine { work: vec![], tool: vec![], motions: vec![] };
    Parts::new(machine, Shape::Turned { blade, side: 1.0 }, patch)
}

/// The wheel to such a worm, cut by a copy of it, at its own place or not quite: at its own, two branches cross.
fn globoid_wheel(random: &mut Random) -> Parts {
    let (blade, patch) = blade(random);
    let off = if random.one_in(2) { 0.0 } else { random.about_zero(1.0) };
    let machine = Machine {
        work: vec![Step::moved(Kind::Turn(Z), 0.0, &[blade.ratio])],
        tool: vec![
            Step::fixed(Kind::Shift(X), blade.distance + off),
            Step::fixed(Kind::Turn(X), -FRAC_PI_2),
            Step::moved(Kind::Turn(Z), 0.0, &[1.0]),
        ],
        motions: vec![angle("phi", about(random.about_zero(6.0), random.within(1.0, 10.0)))],
    };
    Parts::new(machine, Shape::Turned { blade, side: -1.0 }, patch)
}

fn random_step(random: &mut Random, motions: &[Motion], moves: bool) -> Step {
    let law = |random: &mut Random, is_angle: bool| -> Vec<f64> {
        motions
            .iter()
            .map(|motion| match (random.one_in(3), is_angle, motion.is_angle) {
                (true, ..) => 0.0,
                (_, true, true) => random.about_zero(1.5),
                (_, true, false) => random.about_zero(0.08),
                (_, false, true) => random.about_zero(25.0),
                (_, false, false) => random.about_zero(1.5),
            })
            .collect()
    };
    let kind = match random.0.roll(8) {
        0..3 => Kind::Shift(random.direction()),
        3..6 => Kind::Turn(random.direction()),
        6 => Kind::Screw(random.direction(), random.about_zero(8.0)),
        _ if !moves => Kind::Mirror(random.direction()),
        _ => Kind::Turn(random.direction()),
    };
    let is_angle = matches!(kind, Kind::Turn(_) | Kind::Screw(..));
    let constant = if is_angle { random.about_zero(1.0) } else { random.about_zero(30.0) };
    match kind {
        Kind::Mirror(_) => Step::fixed(kind, 0.0),
        _ if moves => {
            let slopes = law(random, is_angle);
            let wave = if motions[0].is_angle && random.one_in(4) {
                random.about_zero(if is_angle { 0.2 } else { 4.0 })
            } else {
                0.0
            };
            Step { kind, constant, slopes, wave }
        }
        _ => Step::fixed(kind, constant),
    }
}

/// Frames, laws and tools at random.
fn any_machine(random: &mut Random) -> Parts {
    let mut motions = Vec::new();
    for name in ["phi", "feed"].into_iter().take(1 + usize::from(random.one_in(3))) {
        let is_angle = !random.one_in(3);
        let (middle, half) = if is_angle {
            (random.about_zero(1.0), random.within(0.3, 1.2))
        } else {
            (random.about_zero(20.0), random.within(5.0, 20.0))
        };
        motions.push(Motion { name, is_angle, range: about(middle, half) });
    }
    let chain = |random: &mut Random, motions: &[Motion]| -> Vec<Step> {
        let count = 1 + random.0.roll(4);
        (0..count)
            .map(|_| {
                let moves = random.one_in(2);
                random_step(random, motions, moves)
            })
            .collect()
    };
    let work = chain(random, &motions);
    let tool = chain(random, &motions);
    let (shape, patch) = any_tool(random);
    Parts::new(Machine { work, tool, motions }, shape, patch)
}

fn any_tool(random: &mut Random) -> (Shape, [Range; 2]) {
    match random.0.roll(4) {
        0 => {
            let of = [
                random.about_zero(0.04),
                random.about_zero(0.04),
                random.about_zero(0.03),
                random.about_zero(0.2),
                random.about_zero(0.2),
            ];
            (Shape::Graph { of, side: random.side(), thickness: 1.0 }, [about(0.0, 10.0), about(0.0, 12.0)])
        }
        1 => {
            let shape =
                Shape::Torus { circle: random.within(20.0, 60.0), tube: random.within(3.0, 15.0), side: random.side() };
            (shape, [about(random.side() * 0.5, 1.2), about(0.0, 0.8)])
        }
        2 => {
            let shape =
                Shape::Cone { circle: random.within(20.0, 60.0), slope: random.about_zero(0.8), side: random.side() };
            (shape, [about(0.0, 6.0), about(0.0, 1.0)])
        }
        _ => {
            let shape = Shape::Pin { circle: random.about_zero(20.0), radius: random.within(3.0, 20.0), side: 1.0 };
            (shape, [about(random.about_zero(1.0), 1.3), about(0.0, 12.0)])
        }
    }
}

/// A grid about a point that the tool touches in passing, by two coordinates that tell its neighbours apart.
fn sample_of(case: &Case, random: &mut Random) -> Option<([Asked; 2], Option<Range>)> {
    let oracle = case.oracle(false);
    let centre = (0..6).find_map(|_| {
        let at = [0, 1].map(|k| case.patch[k].at(0.1 + 0.8 * random.share()));
        let fixed = [(0, at[0]), (1, at[1])];
        let found = oracle.touched(&|_, _| [f64::NAN; 2], &fixed);
        let stays = |point: &Touched| {
            oracle
                .deepest(point.position, Some(&point.unknowns[2..]), 0.0)
                .is_some_and(|deepest| deepest.height > -1e-7)
        };
        let take_any = random.one_in(3);
        found.into_iter().find(|point| take_any || stays(point))
    })?;
    let unknowns = case.ranges(false).len();
    let motion = case.ranges(false)[unknowns - 1];
    let kept = random.one_in(2).then(|| {
        let reach = random.within(0.05, 0.4) * motion.width();
        let Range { low, high } = about(centre.unknowns[unknowns - 1], reach);
        Range { low: low.max(motion.low), high: high.min(motion.high) }
    });
    for _ in 0..12 {
        let pair = [0, 1].map(|_| random_coordinate(random, unknowns));
        if pair[0].has_the_name_of(&pair[1]) || !tells_apart(case, &centre, &pair) {
            continue;
        }
        let sample = pair.map(|by| {
            let value = by.value(&centre.unknowns, centre.position);
            let half = match by {
                Coordinate::Unknown(k) => random.within(0.03, 0.4) * case.ranges(false)[k].width(),
                Coordinate::PolarAngle => random.within(0.02, 0.3),
                Coordinate::Tabled => random.within(0.03, 0.6),
                _ => random.within(0.3, 6.0),
            };
            Asked { by, range: about(value, half), count: [3, 5][random.0.roll(2)] }
        });
        return Some((sample, kept));
    }
    None
}

fn random_coordinate(random: &mut Random, unknowns: usize) -> Coordinate {
    match random.0.roll(11) {
        0..3 => Coordinate::Along(random.0.roll(3)),
        3 => Coordinate::Rho,
        4 => Coordinate::PolarAngle,
        5 => Coordinate::Mixed(random.about_zero(0.8)),
        6 => Coordinate::Tabled,
        _ => Coordinate::Unknown(random.0.roll(unknowns)),
    }
}

/// Whether two coordinates fix a point beside one that is known: both change, and not alike, along the surface.
pub fn tells_apart(case: &Case, point: &Touched, pair: &[Coordinate; 2]) -> bool {
    let oracle = case.oracle(false);
    let near: Vec<[f64; 2]> = (0..2)
        .filter_map(|k| {
            // beside the point along the surface: one parameter moves, the motions follow
            let moved = |share: f64| {
                let mut fixed: Vec<(usize, f64)> = (0..2).map(|k| (k, point.unknowns[k])).collect();
                fixed[k].1 += share * case.patch[k].width();
                oracle.beside(&fixed, &point.unknowns)
            };
            let there = moved(1e-4).or_else(|| moved(-1e-4))?;
            Some([0, 1].map(|n| {
                pair[n].miss(
                    pair[n].value(&there.unknowns, there.position),
                    pair[n].value(&point.unknowns, point.position),
                ) * 1e4
            }))
        })
        .collect();
    match near[..] {
        [a, b] => {
            let length = |v: [f64; 2]| v[0].hypot(v[1]);
            let area = (a[0] * b[1] - a[1] * b[0]).abs();
            area > 1e-2 * length([a[0], b[0]]) * length([a[1], b[1]]) && area > 1e-3
        }
        _ => false,
    }
}
