//! Points that the tool cuts away in another position than the one that generates them, against positions sampled densely, without
//! equations.

mod support;

use std::path::Path;

use support::{flank, folder, text, written};

/// A point of a table.
struct Row {
    surface: String,
    position: [f64; 2],
    z: f64,
    status: String,
    reason: String,
}

fn rows(table: &Path) -> Vec<Row> {
    let csv = std::fs::read_to_string(table).expect("written");
    let mut lines = csv.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let titles = lines.next().expect("titles");
    let column = |name: &str| titles.iter().position(|title| *title == name).expect(name);
    let [x, y, z, status] = ["x", "y", "z", "status"].map(column);
    let number = |row: &[&str], at: usize| row[at].parse().unwrap_or(f64::NAN);
    let row = |row: Vec<&str>| Row {
        surface: row[0].to_string(),
        position: [x, y].map(|at| number(&row, at)),
        z: number(&row, z),
        status: row[status].to_string(),
        reason: row.get(status + 1).unwrap_or(&"").to_string(),
    };
    lines.map(row).collect()
}

/// The deepest that a point comes into a body over a range: densely sampled, then closer about each sample that is deeper than its
/// neighbours. `depth` is negative outside.
fn deepest(depth: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> f64 {
    const SAMPLES: usize = 4000;
    let step = (high - low) / SAMPLES as f64;
    let at = |k: usize| low + k as f64 * step;
    let sampled: Vec<f64> = (0..=SAMPLES).map(|k| depth(at(k))).collect();
    let mut most = sampled.iter().copied().fold(f64::MIN, f64::max);
    for k in 1..SAMPLES {
        if sampled[k] >= sampled[k - 1] && sampled[k] >= sampled[k + 1] {
            let (mut a, mut b) = (at(k - 1), at(k + 1));
            for _ in 0..60 {
                let [c, d] = [a + (b - a) / 3.0, b - (b - a) / 3.0];
                if depth(c) > depth(d) { b = d } else { a = c }
            }
            most = most.max(depth(0.5 * (a + b)));
        }
    }
    most
}

/// Holds the verdict on a point against the depth to which the tool comes; what is touched lies between.
fn held_against(row: &Row, depth: f64) {
    let is_cut = row.status == "undercut";
    assert!(is_cut || row.status == "solved", "{}: {}", row.surface, row.status);
    if depth > 1e-8 {
        assert!(is_cut, "{} {:?} lies {depth:e} mm in the steel, told {}", row.surface, row.position, row.status);
    } else if depth < 1e-10 {
        assert!(
            !is_cut,
            "{} {:?} is out of the steel by {:e} mm, told cut away {}",
            row.surface, row.position, -depth, row.reason
        );
    }
}

struct Cycloid {
    pins: u32,
    eccentricity: f64,
    circle_radius: f64,
    pin_radius: f64,
    crank: [f64; 2],
}

impl Cycloid {
    fn spec(&self, sample: &str) -> String {
        let Cycloid { pins, eccentricity, circle_radius, pin_radius, crank } = self;
        format!(
            "machine cyclo {{
    axis crank : rotary
    frame housing
    frame journal in housing = rotate_z(crank) translate_x({eccentricity} mm)
    frame disc in journal = rotate_z(-crank * {pins} / ({pins} - 1))
}}
tool pin {{
    surface side(theta: angle in 60 deg .. 300 deg, v: length in -20 mm .. 20 mm) {{
        at = [{circle_radius} mm + {pin_radius} mm * cos(theta), {pin_radius} mm * sin(theta), v]
        body towards [-cos(theta), -sin(theta), 0]
    }}
}}
job cycloid_disc {{
    machine m = cyclo()
    tool p = pin()
    mount p on m.housing
    motion crank : angle in {} deg .. {} deg
    drive m.crank = crank
    surface disc in m.disc = envelope(p.side, over: crank)
    sample disc {{ {sample} }}
}}
",
            crank[0], crank[1]
        )
    }

    /// How deep a point of the disc comes into the part of the pin that the tool has.
    fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let depth = |crank: f64| {
            let turned = crank - crank * f64::from(self.pins) / f64::from(self.pins - 1);
            let from_pin = [
                self.eccentricity * crank.cos() + turned.cos() * x - turned.sin() * y - self.circle_radius,
                self.eccentricity * crank.sin() + turned.sin() * x + turned.cos() * y,
            ];
            let theta = from_pin[1].atan2(from_pin[0]).to_degrees().rem_euclid(360.0);
            let depth = self.pin_radius - from_pin[0].hypot(from_pin[1]);
            if (60.0..=300.0).contains(&theta) { depth } else { depth.min(0.0) }
        };
        deepest(depth, self.crank.map(f64::to_radians))
    }
}

fn solved(name: &str, spec: &str, job: &str, more: &[&str]) -> Vec<Row> {
    let at = folder(name);
    let out = at.to_str().expect("a plain path");
    let run = flank(&[&["solve", spec, "--no-picture", "--out", out], more].concat());
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    rows(&at.join(format!("{job}.csv")))
}

/// Between a cusp and where the disc's profile crosses itself the clearance's Hessian is positive, and the pin takes the points away all
/// the same, half a turn of the crank farther.
#[test]
fn a_pin_cuts_what_it_has_made() {
    let cycloid = |pins, eccentricity, circle_radius, pin_radius, crank| Cycloid {
        pins,
        eccentricity,
        circle_radius,
        pin_radius,
        crank,
    };
    let half_turns = [-180.0, 180.0];
    let cycloids = [
        (cycloid(12, 2.5, 60.0, 20.0, half_turns), "crank: 66 deg .. 96 deg by 11, v: 0 mm .. 10 mm by 2"),
        (cycloid(12, 2.5, 60.0, 20.0, [-360.0, 360.0]), "crank: 66 deg .. 96 deg by 11, v: 0 mm .. 10 mm by 2"),
        (cycloid(12, 2.5, 60.0, 20.0, half_turns), "crank: 20 deg .. 170 deg by 301, v: 0 mm .. 10 mm by 5"),
        (cycloid(12, 2.5, 60.0, 12.0, half_turns), "crank: 20 deg .. 170 deg by 61, v: 0 mm .. 10 mm by 2"),
        (cycloid(10, 3.0, 60.0, 18.0, half_turns), "crank: 20 deg .. 170 deg by 61, v: 0 mm .. 10 mm by 2"),
        (cycloid(20, 1.5, 80.0, 16.0, half_turns), "crank: 20 deg .. 170 deg by 61, v: 0 mm .. 10 mm by 2"),
    ];
    let mut told = [0, 0];
    for (number, (cycloid, sample)) in cycloids.iter().enumerate() {
        let at = folder("secondary_cycloids");
        let spec = written(&at, &format!("cycloid_{number}.chain"), &cycloid.spec(sample));
        for row in solved("secondary_cycloid", &spec, "cycloid_disc", &[]) {
            held_against(&row, cycloid.depth(row.position));
            told[usize::from(row.reason.contains("in another position"))] += 1;
        }
    }
    assert!(told[0] > 100 && told[1] > 100, "{told:?}");
}

/// What lies between two lines of a grid may be cut away where the points on both lines stay: here one row of eleven, with as many on
/// either side of it.
#[test]
fn a_row_between_rows_that_stay_is_cut() {
    let cycloid =
        Cycloid { pins: 13, eccentricity: 3.5606, circle_radius: 38.349, pin_radius: 7.6315, crank: [-146.75, 212.53] };
    let at = folder("secondary_row");
    let sample = "crank: -144.53 deg .. 142.17 deg by 11, v: 1.8 mm .. 11.2 mm by 11";
    let spec = written(&at, "cycloid.chain", &cycloid.spec(sample));
    // where the pin lies deepest over that row, by trying its positions
    let there = Cycloid { crank: [154.0, 154.6], ..cycloid };
    let is_of_row = |row: &&Row| (1.80..1.82).contains(&there.depth(row.position));
    let rows = solved("secondary_row_points", &spec, "cycloid_disc", &[]);
    let row: Vec<&Row> = rows.iter().filter(is_of_row).collect();
    assert_eq!(row.len(), 11);
    assert!(row.iter().all(|row| row.status == "undercut" && row.reason.contains("in another position")));
}

/// The tooth of a rack: flanks, roundings and the land of the tip. x is the height over the datum line, away from the work.
struct Rack {
    module: f64,
    shift: f64,
    teeth: f64,
}

impl Rack {
    /// How deep a point of the gear comes into the rack, along the datum line.
    fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let alpha = 20f64.to_radians();
        let [tip, radius] = [1.25, 0.38].map(|share| share * self.module);
        let center = [
            tip - radius,
            std::f64::consts::PI * self.module / 4.0 - (tip - radius) * alpha.tan() - radius / alpha.cos(),
        ];
        let half_width = |below: f64| {
            if below > center[0] + radius * alpha.sin() {
                center[1] + (radius * radius - (below - center[0]).powi(2)).sqrt()
            } else {
                std::f64::consts::PI * self.module / 4.0 - below * alpha.tan()
            }
        };
        let reference = self.module * self.teeth / 2.0;
        let depth = |phi: f64| {
            let (sine, cosine) = phi.sin_cos();
            let below = reference + self.shift - (cosine * x - sine * y);
            let along = sine * x + cosine * y - reference * phi;
            // a gear that is far from the tooth does not count
            if (-self.module..tip).contains(&below) { half_width(below) - along.abs() } else { -1.0 }
        };
        deepest(depth, [-60.0, 60.0].map(f64::to_radians))
    }
}

/// Flank and fillet of few teeth cross each other, and no `trim` says so.
#[test]
fn a_rack_cuts_flanks_by_its_rounding_and_fillets_by_its_flank() {
    for teeth in [7, 8, 10, 12, 14, 17, 24] {
        let rack = Rack { module: 3.0, shift: 0.6, teeth: f64::from(teeth) };
        let set = format!("teeth={teeth}");
        let rows = solved("secondary_rack", "specs/hobbing/spur_gear.chain", "spur_gear", &["--set", &set]);
        let cut = rows.iter().filter(|row| row.status == "undercut").count();
        // a spur gear is the same at each height
        let mut seen: Vec<[f64; 2]> = Vec::new();
        for row in &rows {
            if !seen.iter().any(|other| (0..2).all(|k| (other[k] - row.position[k]).abs() < 1e-6)) {
                seen.push(row.position);
                held_against(row, rack.depth(row.position));
            }
        }
        assert_eq!(cut > 0, teeth < 13, "{teeth} teeth: {cut}");
    }
}

/// Two straight sides of a comb's tooth meet at a kink. The point that the kink generates on one of them enters the steel of the other
/// right there, at its very end.
#[test]
fn a_kink_cuts_the_points_of_its_own_corner() {
    const CORNERS: [[f64; 2]; 3] = [[-5.0, 2.0], [2.0, 4.5], [5.0, 5.8]];
    const RADIUS: f64 = 72.5;
    let corner = |k: usize| format!("[{} mm, {} mm]", CORNERS[k][0], CORNERS[k][1]);
    let spec = format!(
        "machine planer {{
    param raise : length = 1.5 mm
    axis C : rotary
    axis Y : linear
    frame bed
    frame table in bed = rotate_z(C)
    frame comb in bed = translate({RADIUS} mm + raise, Y, 0 mm)
    couple Y = {RADIUS} mm * C
}}
tool comb {{
    profile side {{
        flank = line(from: {}, to: {})
        relief = line(from: {}, to: {})
    }}
    surface face(s: along side, w: length in -20 mm .. 20 mm) {{
        let p = side(s)
        at = [p[0], p[1], w]
        body towards [0, -1, 0]
    }}
}}
job planed {{
    machine m = planer
    tool c = comb
    mount c on m.comb
    motion roll : angle in -50 deg .. 50 deg
    drive m.C = roll
    surface flank in m.table = envelope(c.face, over: roll)
    sample flank.flank {{ s: c.side.flank.from .. c.side.flank.to by 41, z: -15 mm .. 15 mm by 3 }}
    sample flank.relief {{ s: c.side.relief.from .. c.side.relief.to by 41, z: -15 mm .. 15 mm by 3 }}
}}
",
        corner(0),
        corner(1),
        corner(1),
        corner(2)
    );
    let depth = |[x, y]: [f64; 2]| {
        let into = |roll: f64| {
            let (sine, cosine) = roll.sin_cos();
            let at = [cosine * x - sine * y - RADIUS - 1.5, sine * x + cosine * y - RADIUS * roll];
            let of = |[[a, b], [c, d]]: [[f64; 2]; 2]| b + (at[0] - a) / (c - a) * (d - b) - at[1];
            let side = if at[0] < CORNERS[1][0] { [CORNERS[0], CORNERS[1]] } else { [CORNERS[1], CORNERS[2]] };
            if (CORNERS[0][0]..=CORNERS[2][0]).contains(&at[0]) { of(side) } else { -1.0 }
        };
        deepest(into, [-50.0, 50.0].map(f64::to_radians))
    };
    let at = folder("secondary_kink");
    let spec = written(&at, "planed.chain", &spec);
    let rows = solved("secondary_kink_points", &spec, "planed", &[]);
    rows.iter().for_each(|row| held_against(row, depth(row.position)));
    let is_corner = |row: &&Row| depth(row.position) > 1e-4 && row.reason.contains("in another position");
    let cut = rows.iter().filter(is_corner).count();
    assert!(cut >= 6, "{cut} of {}", rows.len());
}

/// A cone that wobbles about its apex: all points of a ray share one fate, also where the ray leaves the cone's ends. Their ways go
/// through the steel's surface at the very end, and lie beyond it before and after.
#[test]
fn the_ends_of_a_cone_cut_like_its_middle() {
    const SPEC: &str = "machine wobble {
    axis shaft : rotary
    axis turn : rotary
    frame bed
    frame swash in bed = rotate_z(shaft) rotate_y(5 deg) rotate_z(-shaft)
    frame crown in bed = rotate_z(turn)
    couple turn = shaft / 21
}
tool cone_roller {
    surface side(u: length in 30 mm .. 60 mm, a: angle in -180 deg .. 180 deg) {
        at = u * [cos(3 deg), sin(3 deg) * cos(a), sin(3 deg) * sin(a)]
        body towards [0, -cos(a), -sin(a)]
    }
}
job crown {
    machine m = wobble
    tool r = cone_roller
    mount r on m.swash
    motion shaft : angle in -180 deg .. 180 deg
    drive m.shaft = shaft
    surface flank in m.crown = envelope(r.side, over: shaft)
    sample flank { shaft: -170 deg .. 170 deg by 35, u: 30 mm .. 60 mm by 3 }
}
";
    let depth = |row: &Row| {
        let [x, y, z] = [row.position[0], row.position[1], row.z];
        let turned = |[a, b]: [f64; 2], by: f64| [by.cos() * a - by.sin() * b, by.sin() * a + by.cos() * b];
        let into = |shaft: f64| {
            let [x, y] = turned([x, y], shaft / 21.0 - shaft);
            let [z, x] = turned([z, x], -5f64.to_radians());
            let [x, y] = turned([x, y], shaft);
            3f64.to_radians() - y.hypot(z).atan2(x)
        };
        x.hypot(y).hypot(z) * deepest(into, [-180.0, 180.0].map(f64::to_radians))
    };
    let at = folder("secondary_cone");
    let spec = written(&at, "crown.chain", SPEC);
    let rows = solved("secondary_cone_points", &spec, "crown", &[]);
    let positioned: Vec<&Row> = rows.iter().filter(|row| row.z.is_finite()).collect();
    positioned.iter().for_each(|row| held_against(row, depth(row)));
    let cut = positioned.iter().filter(|row| row.reason.contains("in another position")).count();
    assert!(positioned.len() >= 90 && cut >= 6, "{cut} of {}", positioned.len());
}

/// A worm wheel under a hob whose thread has straight sides in its axial section. x runs from the hob's axis to the wheel's, z along the
/// hob.
struct WormHob {
    teeth: f64,
    /// mm for each rad.
    pitch: f64,
    radius: f64,
    tip: f64,
    center_distance: f64,
    /// deg
    spindle: [f64; 2],
}

impl WormHob {
    const ALPHA: f64 = 20.0;

    fn spec(&self) -> String {
        let WormHob { teeth, pitch, radius, tip, center_distance, spindle: [from, to] } = self;
        // half the axial gap at the reference radius
        let half = pitch * std::f64::consts::FRAC_PI_2;
        let slope = Self::ALPHA.to_radians().tan();
        let half_tip = half - (tip - radius) * slope;
        let [bottom, top] = [0.93, 1.2].map(|share| share * pitch * teeth);
        let surface = |name: &str, sign: f64| {
            format!(
                "    surface {name}(r: length in {} mm .. {tip} mm, theta: angle in -1100 deg .. 1100 deg) {{
        at = [r * cos(theta), r * sin(theta), {pitch} mm/rad * theta + {sign} * ({half} mm - (r - {radius} mm) * {slope})]
        body towards [0, 0, {}]
    }}
",
                2.0 * radius - tip,
                -sign
            )
        };
        format!(
            "machine wheel_hobbing {{
    axis B : rotary
    frame base
    frame hob in base = rotate_z(B)
    frame wheel in base = translate_x({center_distance} mm) rotate_x(-90 deg) rotate_z(-B / {teeth})
}}
tool hob {{
{}{}    surface tip(w: length in -{half_tip} mm .. {half_tip} mm, theta: angle in -1100 deg .. 1100 deg) {{
        at = [{tip} mm * cos(theta), {tip} mm * sin(theta), {pitch} mm/rad * theta + w]
        body towards [-cos(theta), -sin(theta), 0]
    }}
}}
job wheel {{
    machine m = wheel_hobbing
    tool h = hob
    mount h on m.hob
    motion spindle : angle in {from} deg .. {to} deg
    drive m.B = spindle
    surface plus in m.wheel = envelope(h.plus, over: spindle)
    surface minus in m.wheel = envelope(h.minus, over: spindle)
    sample plus {{ rho: {bottom} mm .. {top} mm by 31, z: -6 mm .. 6 mm by 9, keep spindle: -20 deg .. 340 deg }}
    sample minus {{ rho: {bottom} mm .. {top} mm by 31, z: -6 mm .. 6 mm by 9, keep spindle: -340 deg .. 20 deg }}
}}
",
            surface("plus", 1.0),
            surface("minus", -1.0)
        )
    }

    /// How deep a point of the wheel comes into the thread, across its sides in the axial section.
    fn depth(&self, row: &Row) -> f64 {
        let WormHob { teeth, pitch, radius, tip, center_distance, spindle } = self;
        let ([x, y], z) = (row.position, row.z);
        let lead = std::f64::consts::TAU * pitch;
        let slope = Self::ALPHA.to_radians().tan();
        let depth = |spindle: f64| {
            let (sine, cosine) = (-spindle / teeth).sin_cos();
            let at = [center_distance + cosine * x - sine * y, z, -(sine * x + cosine * y)];
            let (r, azimuth) = (at[0].hypot(at[1]), at[1].atan2(at[0]) - spindle);
            let turns = ((at[2] - pitch * azimuth) / lead).round();
            let along = at[2] - pitch * azimuth - turns * lead;
            (lead / 4.0 - (r - radius) * slope - along.abs()).min(tip - r)
        };
        deepest(depth, spindle.map(f64::to_radians))
    }
}

/// A hob turns many times while the wheel turns once: less its turning, along which the thread slides in itself, the work passes slowly.
#[test]
fn a_thread_cuts_the_teeth_of_its_wheel_in_other_turns() {
    let at = folder("secondary_thread");
    let mut told = [0, 0];
    for (teeth, spindle) in [(5.0, 540.0), (6.0, 900.0), (7.0, 720.0)] {
        let hob = WormHob {
            teeth,
            pitch: 2.0,
            radius: 20.0,
            tip: 24.5,
            center_distance: 20.0 + 2.0 * teeth,
            spindle: [-spindle, spindle],
        };
        let spec = written(&at, &format!("wheel_{teeth}.chain"), &hob.spec());
        let rows = solved("secondary_thread_points", &spec, "wheel", &[]);
        for row in rows.iter().filter(|row| row.status == "solved" || row.reason.contains("in another position")) {
            held_against(row, hob.depth(row));
            told[usize::from(row.status == "undercut")] += 1;
        }
    }
    assert!(told[0] > 300 && told[1] > 50, "{told:?}");
}

/// The worm of a wheel with 50 teeth meshes over eight whole turns. Places whole turns apart have the same velocity and lie beside
/// neighbouring threads; the way from one to the other leads around the worm, not through a thread.
#[test]
fn whole_turns_between_places_are_no_way_through_the_steel() {
    let rows = solved(
        "secondary_turns",
        "specs/globoid/hindley_worm_wheel.chain",
        "hindley_worm_wheel",
        &["--set", "teeth=50"],
    );
    let told: Vec<&Row> = rows.iter().filter(|row| row.surface == "plus" || row.surface == "minus").collect();
    assert!(told.len() > 500 && told.iter().all(|row| row.status == "solved"), "{}", told.len());
}

/// What was not looked at is said, and only then.
#[test]
fn what_was_not_looked_at_is_said() {
    let at = folder("secondary_unseen");
    let out = at.to_str().expect("a plain path");
    let told = |spec: &str, more: &[&str]| {
        let run = flank(&[&["solve", spec, "--no-picture", "--json", "--out", out], more].concat());
        let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let unseen = |surface: &serde_json::Value| {
            (surface["name"].as_str().unwrap().to_string(), surface["positions"]["not_looked_at"].clone())
        };
        table["surfaces"].as_array().unwrap().iter().map(unseen).collect::<Vec<_>>()
    };
    let spur = told("specs/hobbing/spur_gear.chain", &[]);
    assert!(spur.iter().all(|(_, unseen)| unseen.is_null()), "{spur:?}");
    let helical = told("specs/hobbing/helical_gear.chain", &[]);
    assert!(
        helical.iter().all(|(_, unseen)| unseen.as_str().unwrap().contains("several motions at once")),
        "{helical:?}"
    );
    // the crest of its hob is a band about a cylinder, whose turns are equally near at many places: they cost no more than others
    let bevel = told("specs/bodies/beveloid_body.chain", &[]);
    assert!(
        bevel.len() > 1 && bevel.iter().all(|(_, unseen)| unseen.as_str().is_none_or(|why| !why.contains("too long"))),
        "{bevel:?}"
    );
    // few teeth, which nearly everything about the hob may cut
    let few = told("specs/bodies/beveloid_body.chain", &["--set", "teeth=6", "--set", "cone_angle=-15.6411 deg"]);
    assert!(few.iter().all(|(_, unseen)| unseen.as_str().is_none_or(|why| !why.contains("too long"))), "{few:?}");
    let wheel = told("specs/double_envelope/hourglass_worm_wheel.chain", &[]);
    assert!(wheel[0].1.is_null() && wheel[1].1.as_str().unwrap().contains("generated itself"), "{wheel:?}");
    let forms = told("tests/surfaces/specs/ring_by_equation.chain", &[]);
    assert!(forms.len() == 1 && forms[0].1.as_str().unwrap().contains("given by an equation"), "{forms:?}");
}

/// A straight blade of a face mill, written as a line and as a spline through points of it, which has no value beyond its ends: they cut
/// the same points away, and all positions are looked at.
#[test]
fn a_spline_cuts_like_the_line_that_it_follows() {
    let spec = |side: &str| {
        format!(
            "machine cradle {{
    axis Q : rotary
    axis W : rotary
    frame bed
    frame cradle in bed = rotate_z(Q - 5 deg) translate_x(152 mm)
    frame cutter in cradle = rotate_z(80 deg) rotate_x(15 deg)
    frame root in bed = translate(0 mm, -31.75 mm, -4 mm) rotate_y(95 deg)
    frame work in root = translate_z(3 mm) rotate_z(W)
    couple W = 4.2 * Q
}}
tool blade {{
    param radius : length = 75.2 mm
    profile edge {{
        tip  = arc(center: [radius, -1 mm], radius: 1 mm, from: 90 deg, to: 22 deg)
        side = {side}
    }}
    surface outer(s: along edge, t: angle in -180 deg .. 180 deg) {{
        at = [edge(s)[0] * cos(t), edge(s)[0] * sin(t), edge(s)[1]]
        body towards [-cos(t), -sin(t), -0.8]
    }}
}}
job pinion {{
    machine m = cradle
    tool b = blade
    mount b on m.cutter
    motion roll : angle in -50 deg .. 50 deg
    drive m.Q = roll
    surface flank in m.work = envelope(b.outer, over: roll)
    sample flank.tip {{ s: b.edge.tip.from .. b.edge.tip.to by 3, t: -180 deg .. 170 deg by 36 }}
}}
"
        )
    };
    let point = |along: u32| {
        format!(
            "[radius + 1 mm * cos(22 deg) + {along} mm * sin(22 deg), 1 mm * sin(22 deg) - 1 mm - {along} mm * cos(22 deg)]"
        )
    };
    let [line, spline] = [
        format!("line(from: {}, to: {})", point(0), point(14)),
        format!("spline([{}])", [0, 5, 9, 14].map(point).join(", ")),
    ]
    .map(|side| {
        let at = folder("secondary_spline");
        let run = |folder: &str| solved(folder, &written(&at, "pinion.chain", &spec(&side)), "pinion", &[]);
        run("secondary_spline_points")
    });
    let verdicts = |rows: &[Row]| rows.iter().map(|row| row.status.clone()).collect::<Vec<String>>();
    assert_eq!(verdicts(&line), verdicts(&spline));
    let cut = line.iter().filter(|row| row.reason.contains("in another position")).count();
    assert!(cut >= 10, "{cut} of {}", line.len());
}

/// A disc turns through a fin of its tool: how deep its points come into that is told as far as they are in it, and not to where they have come behind it.
#[test]
fn the_depth_in_a_fin_is_no_more_than_its_thickness() {
    let spec = "machine lathe {
    axis C : rotary
    frame bed
    frame slide in bed = translate_x(0 mm)
    frame work in bed = rotate_z(C)
}
tool finned {
    param thickness : length = 0.25 mm
    surface pin(u: angle in 90 deg .. 270 deg, v: length in -10 mm .. 10 mm) {
        at = [40 mm + 8 mm * cos(u), 8 mm * sin(u), v]
        body towards [-cos(u), -sin(u), 0]
    }
    surface front, behind(p: length in -100 mm .. 100 mm, w: length in -12 mm .. 12 mm) for side in [1, -1] {
        at = [p, 20 mm + (1 - side) / 2 * thickness, w]
        body towards [0, side, 0]
    }
}
job disc {
    machine m = lathe
    tool t = finned
    mount t on m.slide
    motion turn : angle in -20 deg .. 120 deg
    drive m.C = -turn
    surface side, front, behind in m.work = envelope(t.pin, t.front, t.behind, over: turn)
    sample side { turn: 0 deg .. 20 deg by 9, v: -5 mm .. 5 mm by 3 }
}
";
    let at = folder("secondary_fin");
    let (spec, out) = (written(&at, "fin.chain", spec), at.to_str().expect("a plain path"));
    // where the range of the motion ends, points are half a millimetre behind the front, on a circle of 32 mm
    let within = 32.0 * 40f64.to_radians().sin() - 20.0;
    for thickness in [0.25, 0.01, 3.0] {
        let set = format!("t.thickness={thickness}mm");
        let run = flank(&["solve", &spec, "--no-picture", "--out", out, "--set", &set]);
        assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
        let told = format!("by up to {:.6} mm", within.min(thickness));
        assert!(text(&run.stderr).contains(&told), "{told}: {}", text(&run.stderr));
    }
}
