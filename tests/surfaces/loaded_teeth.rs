//! Loaded teeth of bricks, solved by CalculiX: stress at the root and stiffness against published formulas.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use flank::{Answer, Disk, ElementOrder, JobSelection, MeshRequest, Project, Unwatched, mesh};
use flank_tests::deck::Deck;
use flank_tests::repository;

/// MPa
const PRESSURE: f64 = 100.0;
const YOUNG: f64 = 206_000.0;
const WIDTH: f64 = 2.0;
const MODULE: f64 = 3.0;
const ALPHA: f64 = PI / 9.0;

/// Whether there is CalculiX; where there is not, the test says that it is skipped.
fn has_calculix() -> bool {
    let found = Command::new("ccx").arg("-v").output().is_ok();
    if !found {
        eprintln!("skipped 1 reader of bricks: no CalculiX; apt-get install calculix-ccx");
    }
    found
}

/// A gear that a rack of 20 degrees, height 1.25 and tip radius 0.38 generates, with a load on its middle tooth of three.
struct Gear {
    deck: Deck,
    /// N, at the middle of where it presses.
    force: [f64; 3],
    at: [f64; 3],
    /// mm and MPa.
    displacement: BTreeMap<usize, Vec<f64>>,
    stress: BTreeMap<usize, Vec<f64>>,
    reaction: [f64; 3],
}

impl Gear {
    /// Pressure on the row of faces whose middle lies nearest to a radius, in plane strain; held at bore and sides.
    fn loaded([teeth, shift, radius]: [f64; 3]) -> Gear {
        let folder = tempfile::tempdir().expect("a folder");
        let set = [
            ("helix_angle", "0 deg".to_string()),
            ("teeth", teeth.to_string()),
            ("shift", shift.to_string()),
            ("face_width", format!("{WIDTH} mm")),
            ("bore", format!("{} mm", MODULE * (0.5 * teeth - 5.5))),
        ];
        let project = Project::open(repository("tests/surfaces/specs/bodies.chain"), Arc::new(Disk));
        let set = set.map(|(name, value)| (name.to_string(), value)).to_vec();
        let request = MeshRequest {
            teeth: Some(3),
            elements: [16, 1, 12],
            order: ElementOrder::Second,
            out: folder.path().to_path_buf(),
            ..MeshRequest::new(JobSelection { project, job: Some("helical".to_string()), set })
        };
        mesh(&request, &Unwatched, &mut |result| assert!(result.is_complete(), "{result}")).expect("a right spec");
        let deck = Deck::read(&std::fs::read_to_string(folder.path().join("helical.inp")).expect("written"));
        let middle = |face: &(usize, usize)| {
            let own = deck.face(*face);
            let sum =
                own[..4].iter().fold([0.0; 3], |sum, node| [0, 1, 2].map(|k| sum[k] + 0.25 * deck.nodes[*node][k]));
            (sum, (sum[0].hypot(sum[1]) - radius).abs())
        };
        let faces = &deck.surfaces["FLANK_LEFT_T2"];
        let face = *faces.iter().min_by(|a, b| middle(a).1.total_cmp(&middle(b).1)).expect("a face");
        let area = deck.face_area(face);
        write_loads(folder.path(), face, &deck);
        let run = Command::new("ccx").arg("load").current_dir(folder.path()).env("OMP_NUM_THREADS", "1").output();
        let run = run.expect("it is there");
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap_or_default();
        let results = read("load.frd");
        let told = String::from_utf8_lossy(&run.stdout).to_string();
        assert!(run.status.success() && !told.contains("*ERROR"), "{told}");
        let [displacement, stress] = [("DISP", 3), ("STRESS", 6)].map(|(name, parts)| values(&results, name, parts));
        Gear {
            at: middle(&face).0,
            force: area.map(|part| PRESSURE * part),
            displacement,
            stress,
            reaction: total_force(&read("load.dat")),
            deck,
        }
    }

    fn load(&self) -> f64 {
        self.force[0].hypot(self.force[1])
    }

    /// Largest principal stress in the section at the fillet of the loaded side, MPa.
    fn root_stress(&self) -> f64 {
        let principal = |node: &usize| {
            let [xx, yy, xy] = [0, 1, 3].map(|k| self.stress[&(node + 1)][k]);
            0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
        };
        self.deck.node_sets["FILLET_LEFT_FILLET_T2"].iter().map(principal).fold(0.0, f64::max)
    }

    /// The angle of the middle of the loaded tooth.
    fn middle(&self) -> f64 {
        let angle = |name: &str| {
            let all = self.deck.node_sets[name].iter().map(|node| self.deck.nodes[*node]);
            let tip = all.max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1]))).expect("nodes");
            tip[1].atan2(tip[0])
        };
        0.5 * (angle("FLANK_LEFT_T2") + angle("FLANK_RIGHT_T2"))
    }

    /// Of a point the height along the middle of the tooth and the distance from it.
    fn in_tooth(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        let (sin, cos) = self.middle().sin_cos();
        [x * cos + y * sin, y * cos - x * sin]
    }

    /// Half the loaded tooth from the root circle up, each place as its height and its distance from the middle.
    fn outline(&self) -> Vec<[f64; 2]> {
        let own = ["FLANK_LEFT_T2", "FILLET_LEFT_FILLET_T2"].iter().flat_map(|name| &self.deck.node_sets[*name]);
        let front = own.map(|node| self.deck.nodes[*node]).filter(|place| place[2] > 0.4 * WIDTH);
        let mut outline: Vec<[f64; 2]> =
            front.map(|place| self.in_tooth(place)).map(|[height, beside]| [height, beside.abs()]).collect();
        outline.sort_by(|a, b| a[0].total_cmp(&b[0]));
        outline.dedup_by(|a, b| (a[0] - b[0]).abs() < 1e-9);
        outline
    }

    /// How far the middle of the tooth gives way along the load where its line passes, mm, and at which height.
    fn give(&self) -> [f64; 2] {
        let ([height, beside], [up, across]) = (self.in_tooth(self.at), self.in_tooth(self.force));
        let crossing = height - beside * up / across;
        let mut line: Vec<(f64, f64)> = Vec::new();
        for (node, place) in self.deck.nodes.iter().enumerate() {
            let [height, beside] = self.in_tooth(*place);
            if beside.abs() < 1e-6 && height > 0.0 && place[2].abs() > 0.4 * WIDTH {
                let moved = &self.displacement[&(node + 1)];
                let along = (moved[0] * self.force[0] + moved[1] * self.force[1]) / self.load();
                line.push((height, along));
            }
        }
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = line.partition_point(|(height, _)| *height < crossing);
        let [(low, a), (high, b)] = [line[at - 1], line[at]];
        [a + (b - a) * (crossing - low) / (high - low), crossing]
    }
}

/// What CalculiX solves: the bricks, what holds them, the pressure.
fn write_loads(folder: &Path, (brick, face): (usize, usize), deck: &Deck) {
    // a node of two sets would count twice in the sum of the reactions
    let held: BTreeSet<usize> =
        ["BORE", "SIDE_1", "SIDE_2"].iter().flat_map(|name| &deck.node_sets[*name]).copied().collect();
    let held: String = held.iter().map(|node| format!("{},\n", node + 1)).collect();
    let text = format!(
        "*INCLUDE, INPUT=helical.inp\n*NSET, NSET=HELD\n{held}*BOUNDARY\nHELD, 1, 2\nFRONT, 3, 3\nBACK, 3, 3\n\
         *STEP\n*STATIC\n*DLOAD\n{}, P{}, {PRESSURE}\n*NODE PRINT, NSET=HELD, TOTALS=ONLY\nRF\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n",
        brick + 1,
        face + 1
    );
    std::fs::write(folder.join("load.inp"), text).expect("the test's file");
}

/// The values at nodes in a block of an `.frd` file, by the numbers of the nodes.
fn values(results: &str, block: &str, parts: usize) -> BTreeMap<usize, Vec<f64>> {
    let lines = results.lines().skip_while(|line| !line.starts_with(&format!(" -4  {block}")));
    let lines = lines.take_while(|line| !line.starts_with(" -3")).filter(|line| line.starts_with(" -1"));
    let number = |line: &str, k: usize| line[13 + 12 * k..25 + 12 * k].trim().parse::<f64>().expect("a number");
    let read = |line: &str| {
        let node = line[3..13].trim().parse().expect("a node");
        (node, (0..parts).map(|k| number(line, k)).collect())
    };
    lines.map(read).collect()
}

/// The sum of the reactions in a `.dat` file.
fn total_force(text: &str) -> [f64; 3] {
    let mut lines = text.lines().skip_while(|line| !line.contains("total force"));
    lines.next();
    let numbers = lines.find(|line| !line.trim().is_empty()).expect("three numbers");
    let all: Vec<f64> = numbers.split_whitespace().map(|x| x.parse().expect("a number")).collect();
    [all[0], all[1], all[2]]
}

fn inv(angle: f64) -> f64 {
    angle.tan() - angle
}

/// What ISO 6336-3 (2006, method B, external, no helix) says of a tooth, by the module.
struct IsoRoot {
    /// Chord of the 30 degree tangents.
    chord: f64,
    /// Lever of the load.
    lever: f64,
    radius: f64,
    /// The load's angle to the normal of the tooth's middle.
    angle: f64,
}

impl IsoRoot {
    /// For a load on the circle of a diameter, all lengths by the module.
    fn new(z: f64, shift: f64, load_diameter: f64) -> IsoRoot {
        let (addendum, rounding) = (1.25, 0.38);
        let e = PI / 4.0 - addendum * ALPHA.tan() - (1.0 - ALPHA.sin()) * rounding / ALPHA.cos();
        let g = rounding - addendum + shift;
        let h = 2.0 / z * (FRAC_PI_2 - e) - FRAC_PI_3;
        let mut theta = FRAC_PI_6;
        for _ in 0..50 {
            theta = 2.0 * g / z * theta.tan() - h;
        }
        let chord = z * (FRAC_PI_3 - theta).sin() + 3f64.sqrt() * (g / theta.cos() - rounding);
        let radius = rounding + 2.0 * g * g / (theta.cos() * (z * theta.cos().powi(2) - 2.0 * g));
        let at = (z * ALPHA.cos() / load_diameter).acos();
        let gamma = (FRAC_PI_2 + 2.0 * shift * ALPHA.tan()) / z + inv(ALPHA) - inv(at);
        let angle = at - gamma;
        let lever = 0.5
            * ((gamma.cos() - gamma.sin() * angle.tan()) * load_diameter
                - z * (FRAC_PI_3 - theta).cos()
                - (g / theta.cos() - rounding));
        IsoRoot { chord, lever, radius, angle }
    }

    /// Form factor.
    fn y_f(&self) -> f64 {
        6.0 * self.lever * self.angle.cos() / (self.chord.powi(2) * ALPHA.cos())
    }

    /// Stress correction factor.
    fn y_s(&self) -> f64 {
        let slenderness = self.chord / self.lever;
        let notch = self.chord / (2.0 * self.radius);
        (1.2 + 0.13 * slenderness) * notch.powf(1.0 / (1.21 + 2.3 / slenderness))
    }
}

/// Weber and Banaschek (1953) in plane strain: how far a tooth gives way along a load and how far the body below it, by what a part of the width
/// carries and by Young's modulus. `outline` is half the tooth from the root up, each place as its height and half its thickness, mm; the
/// load's line crosses the middle at a height.
fn weber_banaschek(outline: &[[f64; 2]], crossing: f64, angle: f64) -> f64 {
    let [root, half] = outline[0];
    let inside = outline.windows(2).take_while(|pair| pair[1][0] <= crossing);
    let (bending, shear) = inside.fold((0.0, 0.0), |(bending, shear), pair| {
        let [height, half] = [0, 1].map(|k| 0.5 * (pair[0][k] + pair[1][k]));
        let (step, thickness) = (pair[1][0] - pair[0][0], 2.0 * half);
        (bending + step * (crossing - height).powi(2) / thickness.powi(3), shear + step / thickness)
    });
    let oblique = 1.0 + 0.294 * angle.tan().powi(2);
    let lever = (crossing - root) / (2.0 * half);
    let tooth = 10.92 * bending + 3.1 * oblique * shear;
    let body = 5.2 * lever * lever + lever + 1.4 * oblique;
    angle.cos().powi(2) * (tooth + body)
}

/// Form factors and stress correction factors for a load at the tip, as handbooks print them for this rack (no profile shift).
#[test]
fn the_factors_are_those_of_the_tables() {
    for (z, y_fa, y_sa) in
        [(17.0, 2.97, 1.52), (20.0, 2.80, 1.55), (25.0, 2.62, 1.59), (50.0, 2.32, 1.70), (100.0, 2.18, 1.79)]
    {
        let iso = IsoRoot::new(z, 0.0, z + 2.0);
        let off = [iso.y_f() / y_fa - 1.0, iso.y_s() / y_sa - 1.0];
        // two decimals are printed, and are partly read from charts
        assert!(off.iter().all(|off| off.abs() < 0.01), "{z} teeth: {} {}", iso.y_f(), iso.y_s());
    }
}

/// Teeth with and without profile shift, loaded high and low. The factors of ISO 6336-3 hold for any tooth, and are on the safe side: by finite
/// elements the stress of the side that is pulled is 5 to 15 % less, the more the shorter the lever is, since the standard leaves out the radial
/// part of the load. The formulas of Weber and Banaschek take the gear for a half plane, which is stiffer than a rim.
#[test]
fn stress_and_stiffness_are_those_of_published_formulas() {
    if !has_calculix() {
        return;
    }
    for (teeth, shift, above) in [(24.0, 0.2, 1.0), (24.0, 0.2, 0.6), (41.0, -0.3, 0.3), (17.0, 0.45, 0.8)] {
        let gear = Gear::loaded([teeth, shift, MODULE * (0.5 * teeth + above)]);
        for k in 0..2 {
            let off = gear.reaction[k] + gear.force[k];
            // seven digits are printed
            assert!(off.abs() < 1e-6 * gear.load(), "reactions add up: {:?} {:?}", gear.reaction, gear.force);
        }
        // the pressure is normal to an involute
        let arm = (gear.at[0] * gear.force[1] - gear.at[1] * gear.force[0]).abs() / gear.load();
        let base = 0.5 * MODULE * teeth * ALPHA.cos();
        assert!((arm / base - 1.0).abs() < 1e-3, "{arm} {base}");
        let iso = IsoRoot::new(teeth, shift, 2.0 * gear.at[0].hypot(gear.at[1]) / MODULE);
        let published = gear.load() * ALPHA.cos() / (WIDTH * MODULE) * iso.y_f() * iso.y_s();
        let found = gear.root_stress();
        let [give, crossing] = gear.give();
        let tooth = weber_banaschek(&gear.outline(), crossing, iso.angle) * gear.load() / (WIDTH * YOUNG);
        println!(
            "{teeth} teeth, x {shift}: {found:.2} MPa, {published:.2} MPa by ISO 6336-3; {:.3} um, {:.3} um by Weber and Banaschek",
            1e3 * give,
            1e3 * tooth
        );
        let share = found / published;
        assert!((0.85..1.0).contains(&share), "{teeth} teeth, x {shift}: {found} MPa, {published} MPa");
        assert!((1.0..1.1).contains(&(give / tooth)), "{teeth} teeth, x {shift}: {give} mm, {tooth} mm");
    }
}
