//! Bodies: closed, on the exact surfaces, with the volume of closed forms.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;
use std::sync::Arc;

use flank::{
    Answer, Buffers, Disk, EvaluatorOptions, JobSelection, MeshFormat, NotDone, NotDoneKind, Project, SolidNumbers,
    SolidPart, SolidRequest, SolidResult, Unwatched, solid,
};
use flank_tests::bodies::{euler_characteristic, triangles, volume};
use flank_tests::repository;

const BODIES: &str = "tests/surfaces/specs/bodies.chain";
const DEVIATION: f64 = 0.01;

struct Asked<'a> {
    spec: &'a str,
    job: &'a str,
    set: &'a [(&'a str, &'a str)],
    part: SolidPart,
    deviation: f64,
    /// What of the text is replaced by what.
    changed: Option<(&'a str, &'a str)>,
    ball: Option<f64>,
    step: Option<f64>,
}

impl<'a> Asked<'a> {
    fn new(spec: &'a str, job: &'a str, set: &'a [(&'a str, &'a str)]) -> Asked<'a> {
        Asked { spec, job, set, part: SolidPart::Gear, deviation: DEVIATION, changed: None, ball: None, step: None }
    }

    /// The result, and the triangles that were written of each solid, in a folder.
    fn built(&self, folder: &Path) -> SolidResult {
        let path = repository(self.spec);
        let mut files = Buffers::over(Arc::new(Disk));
        if let Some((from, to)) = self.changed {
            let text = std::fs::read_to_string(&path).expect("a spec");
            assert!(text.contains(from), "{from}");
            files = files.with(&path, text.replace(from, to));
        }
        let set = self.set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        let project = Project::open(&path, Arc::new(files));
        let request = SolidRequest {
            jobs: JobSelection { project, job: Some(self.job.to_string()), set },
            part: self.part,
            out: folder.to_path_buf(),
            format: vec![MeshFormat::Stl],
            step: self.step,
            deviation: self.deviation,
            density: 7850.0,
            ball: self.ball,
            evaluator: EvaluatorOptions::default(),
        };
        let mut results = Vec::new();
        solid(&request, &Unwatched, &mut |result| results.push(result)).expect("a right spec");
        results.remove(0)
    }

    fn only(&self) -> (SolidNumbers, Vec<[[f32; 3]; 3]>) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut result = self.built(folder.path());
        assert!(result.is_complete(), "{:?}", result.not_done());
        (result.solids.remove(0), triangles(&folder.path().join(format!("{}.stl", self.job))))
    }

    fn refused(&self) -> String {
        self.not_done().message
    }

    fn not_done(&self) -> NotDone {
        let folder = tempfile::tempdir().expect("a folder");
        let result = self.built(folder.path());
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "no broken body in a file");
        result.not_done()[0].clone()
    }
}

/// A gear that a rack of 20 degrees and height 1.25 generates, by the involute and the trochoid in closed form.
struct Spur {
    module: f64,
    teeth: f64,
    shift: f64,
    /// Of the rack's tip, in modules.
    rounding: f64,
}

const ALPHA: f64 = PI / 9.0;

impl Spur {
    fn radius(&self) -> f64 {
        0.5 * self.module * self.teeth
    }

    /// Distance from the axis and angle from the middle of the space, where the rounding of the rack's tip touches at an angle.
    fn trochoid(&self, theta: f64) -> [f64; 2] {
        let (m, r) = (self.module, self.radius());
        let rounding = self.rounding * m;
        let across = PI * m / 4.0 - (1.25 * m - rounding) * ALPHA.tan() - rounding / ALPHA.cos();
        let depth = 1.25 * m - rounding - self.shift * m;
        // the normal goes through the pitch point
        let pitch_point = across - depth / theta.tan();
        let x = across + rounding * theta.cos() - pitch_point;
        let y = r - depth - rounding * theta.sin();
        [x.hypot(y), x.atan2(y) + pitch_point / r]
    }

    /// Half the angle of the space at a distance from the axis.
    fn involute(&self, rho: f64) -> f64 {
        let inv = |angle: f64| angle.tan() - angle;
        let at = (self.radius() * ALPHA.cos() / rho).acos();
        let tooth = FRAC_PI_2 / self.teeth + 2.0 * self.shift * ALPHA.tan() / self.teeth + inv(ALPHA) - inv(at);
        PI / self.teeth - tooth
    }

    /// Where the trochoid crosses the involute of a gear that is cut under: its angle, and the distance from the axis.
    fn undercut(&self) -> (f64, f64) {
        let differs = |theta: f64| {
            let [rho, angle] = self.trochoid(theta);
            angle - self.involute(rho)
        };
        // from the root up the fillet's space is the wider one, from where they cross on the flank's
        let base = self.radius() * ALPHA.cos();
        let thetas = (0..4000).map(|k| FRAC_PI_2 - f64::from(k) / 4000.0 * (FRAC_PI_2 - ALPHA));
        let mut above = thetas.filter(|theta| self.trochoid(*theta)[0] > base);
        let crossed = above.find(|theta| differs(*theta) < 0.0).expect("they cross");
        let (mut low, mut high) = (crossed, crossed + (FRAC_PI_2 - ALPHA) / 4000.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if differs(middle) < 0.0 { low = middle } else { high = middle }
        }
        (low, self.trochoid(low)[0])
    }

    /// The area of one space up to a tip radius: half the angle times twice ρ dρ, flank and fillet one after the other.
    fn space(&self, tip: f64) -> f64 {
        let [form, _] = self.trochoid(ALPHA);
        let flank = simpson(form, tip, |rho| 2.0 * self.involute(rho) * rho);
        flank + self.fillet(ALPHA)
    }

    /// The area of one space up to where the rounding of the rack's tip touches at an angle.
    fn fillet(&self, theta: f64) -> f64 {
        self.fillet_to([theta, FRAC_PI_2])
    }

    /// The same above where it touches at another one.
    fn fillet_to(&self, [theta, deepest]: [f64; 2]) -> f64 {
        let step = 1e-5;
        simpson(theta, deepest, |theta| {
            let [rho, angle] = self.trochoid(theta);
            let slope = (self.trochoid(theta + step)[0] - self.trochoid(theta - step)[0]) / (2.0 * step);
            -2.0 * angle * rho * slope
        })
    }
}

fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 4000;
    let h = (to - from) / STEPS as f64;
    let weight = |k: usize| {
        if k == 0 || k == STEPS {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=STEPS).map(|k| weight(k) * f(from + h * k as f64)).sum::<f64>() * h / 3.0
}

#[test]
fn a_spur_gear_has_the_volume_of_involute_and_trochoid() {
    for (teeth, shift) in [(24.0, 0.2), (41.0, -0.3), (17.0, 0.45)] {
        let set = [("helix_angle", "0 deg"), ("teeth", &*teeth.to_string()), ("shift", &*shift.to_string())];
        let (body, _) = Asked::new(BODIES, "helical", &set).only();
        let spur = Spur { module: 3.0, teeth, shift, rounding: 0.38 };
        let tip = spur.radius() + (1.0 + shift) * 3.0;
        let section = PI * (tip * tip - 400.0) - teeth * spur.space(tip);
        // the slope by differences is good to some 1e-9
        let off = body.volume_mm3 / (20.0 * section) - 1.0;
        assert!(off.abs() < 2e-8, "{teeth} teeth: {} mm³, {off:e}", body.volume_mm3);
        assert!(body.centre_mm.iter().all(|x| x.abs() < 1e-9), "{:?}", body.centre_mm);
        assert!((body.mass_kg / (7.85e-6 * body.volume_mm3) - 1.0).abs() < 1e-14);
    }
}

/// Thickness, span and dimension over balls of a helical involute gear (ISO 21771), and the circles on which the rack's own corners leave it.
#[test]
fn gauges_find_what_an_involute_has() {
    let inv = |angle: f64| angle.tan() - angle;
    for (teeth, shift, helix) in [(24.0, 0.2, 0.0), (24.0, 0.2, 15.0), (31.0, -0.1, -28.0)] {
        let set =
            [("helix_angle", &*format!("{helix} deg")), ("teeth", &*teeth.to_string()), ("shift", &*shift.to_string())];
        let (body, _) = Asked::new(BODIES, "helical", &set).only();
        let beta = f64::to_radians(helix);
        let (radius, transverse) = (1.5 * teeth / beta.cos(), (ALPHA.tan() / beta.cos()).atan());
        let base = radius * transverse.cos();
        let gauges = &body.gauges;
        let near = |found: f64, exact: f64, what: &str| {
            assert!((found - exact).abs() < 2e-8, "{what} of {teeth} teeth at {helix} degrees: {found}, not {exact}");
        };
        near(gauges.tip_diameter_mm.expect("round"), 2.0 * (radius + (1.0 + shift) * 3.0), "tip");
        near(gauges.root_diameter_mm.expect("round"), 2.0 * (radius - (1.25 - shift) * 3.0), "root");
        // where the rounding of the rack's tip begins
        let depth = 3.0 * (1.25 - 0.38 * (1.0 - ALPHA.sin()) - shift);
        let form = base.hypot(radius * transverse.sin() - depth / transverse.sin());
        gauges.form_diameters_mm.expect("round").iter().for_each(|found| near(*found, 2.0 * form, "form diameter"));
        // half the tooth's angle on the reference circle
        let half = (FRAC_PI_2 + 2.0 * shift * ALPHA.tan()) / teeth;
        assert_eq!(gauges.thickness.len(), 5);
        for found in &gauges.thickness {
            let diameter = found.diameter_mm.expect("round");
            let at = (2.0 * base / diameter).acos();
            let angle = 2.0 * (half + inv(transverse) - inv(at));
            near(found.arc_mm, 0.5 * diameter * angle, "thickness");
            // the shortest way between the two lines in which the flanks meet the cylinder: one is by z the other turned
            let lead = radius / beta.tan();
            let turned = |z: f64| angle - z.abs() / lead.abs();
            let apart = |z: f64| (diameter * (0.5 * turned(z)).sin()).hypot(z);
            let (mut low, mut high) = (0.0, 0.5 * diameter * angle);
            while high - low > 1e-9 {
                let [a, b] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
                if apart(a) < apart(b) { high = b } else { low = a }
            }
            near(found.chord_mm.expect("within the face"), apart(low), "chord");
            let height = 0.5 * (gauges.tip_diameter_mm.expect("round") - diameter * (0.5 * turned(low)).cos());
            near(found.chord_height_mm.expect("within the face"), height, "height");
        }
        assert!(gauges.spans.len() > 1, "{:?}", gauges.spans);
        for span in &gauges.spans {
            let across = (f64::from(span.teeth) - 0.5) * PI + teeth * inv(transverse);
            near(span.width_mm, 3.0 * ALPHA.cos() * across + 6.0 * shift * ALPHA.sin(), "span");
        }
        let balls = gauges.balls.as_ref().expect("one touches");
        let wanted = inv(transverse) + balls.ball_mm / (3.0 * teeth * ALPHA.cos()) + half - PI / teeth;
        let centre = base / arcinv(wanted).cos();
        let across = if teeth % 2.0 == 0.0 { 1.0 } else { (FRAC_PI_2 / teeth).cos() };
        near(balls.over_balls_mm, 2.0 * centre * across + balls.ball_mm, "balls");
    }
}

/// A ball as wide as the space is square to its flanks touches also where these lie aslant; one that does not is told.
#[test]
fn balls_touch_steep_helices_and_those_that_do_not_are_told() {
    let inv = |angle: f64| angle.tan() - angle;
    let set = [("helix_angle", "60 deg"), ("teeth", "11"), ("shift", "0.75 mm")];
    let asked = || Asked::new("specs/bodies/helical_gear_body.chain", "helical_gear_body", &set);
    let (body, _) = asked().only();
    let transverse = (2.0 * ALPHA.tan()).atan();
    let base = 33.0 * transverse.cos();
    let half = (FRAC_PI_2 + 0.5 * ALPHA.tan()) / 11.0;
    let balls = body.gauges.balls.as_ref().expect("one touches");
    let wanted = inv(transverse) + balls.ball_mm / (33.0 * ALPHA.cos()) + half - PI / 11.0;
    let exact = 2.0 * base / arcinv(wanted).cos() * (FRAC_PI_2 / 11.0).cos() + balls.ball_mm;
    assert!((balls.over_balls_mm - exact).abs() < 2e-8, "{balls:?} {exact}");
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { ball: Some(30.0), ..asked() }.built(folder.path());
    assert!(result.solids[0].gauges.balls.is_none());
    let told: Vec<&str> = result.not_done().iter().map(|missing| missing.message.as_str()).collect();
    assert_eq!(told, ["balls of 30 mm do not touch both flanks of a space of `gear` half-way along"]);
}

/// The tooth of a worm of one start begins and ends in the middle of the same space: it is the worm.
#[test]
fn the_one_tooth_of_a_worm_is_all_of_it() {
    for part in [SolidPart::Tooth, SolidPart::Space] {
        let folder = tempfile::tempdir().expect("a folder");
        let worm = Asked::new("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", &[]);
        let result = Asked { part, deviation: 0.1, ..worm }.built(folder.path());
        let mesh = triangles(&folder.path().join("worm_and_wheel_body.worm.stl"));
        assert_eq!(euler_characteristic(&mesh), 0, "{part:?}");
        let exact = result.solids[0].volume_mm3;
        assert!((volume(&mesh) / exact - 1.0).abs() < 0.01, "{part:?}: {} {exact}", volume(&mesh));
    }
}

/// The angle whose involute is given.
fn arcinv(wanted: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        if middle.tan() - middle < wanted { low = middle } else { high = middle }
    }
    low
}

/// Cavalieri: each section of a helical gear is the same one turned.
#[test]
fn a_helical_gear_has_a_volume_in_proportion_to_its_width() {
    let volume = |width: &str| Asked::new(BODIES, "helical", &[("face_width", width)]).only().0.volume_mm3;
    let (one, two) = (volume("15 mm"), volume("30 mm"));
    assert!((two / one - 2.0).abs() < 1e-10, "{one} {two}");
}

#[test]
fn every_mesh_is_closed_and_nears_the_exact_body() {
    let jobs = [
        ("specs/pairs/spur_pair.chain", "spur_pair", "pinion"),
        (BODIES, "helical", "gear"),
        ("specs/bevel/pinion_19x62.chain", "pinion_19x62", "pinion"),
    ];
    for (spec, job, name) in jobs {
        for (part, holes, of) in [(SolidPart::Gear, 0, 1), (SolidPart::Tooth, 2, 0), (SolidPart::Space, 2, 0)] {
            let folder = tempfile::tempdir().expect("a folder");
            let result = Asked { part, ..Asked::new(spec, job, &[]) }.built(folder.path());
            let body = &result.solids[0];
            assert_eq!(body.name, name);
            let file = if result.solids.len() == 1 { job.to_string() } else { format!("{job}.{name}") };
            let mesh = triangles(&folder.path().join(format!("{file}.stl")));
            assert_eq!(euler_characteristic(&mesh), holes, "{job} {part:?}");
            let exact = if of == 1 { body.volume_mm3 } else { body.volume_mm3 / f64::from(body.teeth) };
            let area = body.mesh.area_mm2;
            // no more than a skin as thick as the mesh may be off, and single precision
            let off = (volume(&mesh) - exact).abs();
            assert!(off < area * (DEVIATION + 1e-5), "{job} {part:?}: {off} mm³ of {exact}");
            assert!((volume(&mesh) - body.mesh.volume_mm3).abs() < area * 1e-5, "what is said of the mesh is so");
            if of == 1 {
                assert!((area / body.area_mm2 - 1.0).abs() < 2e-3, "{area} {}", body.area_mm2);
            }
        }
    }
}

/// The front of a blank as part of a torus, bulging or hollow, and its bore as an arc: the middles of the mesh's edges lie as near to them as is
/// said.
#[test]
fn meshes_are_as_near_to_arcs_of_the_blank_as_is_said() {
    let front = "line(from: [-face_width / 2, tip_radius], to: [-face_width / 2, bore])";
    let bore = "line(from: [-face_width / 2, bore], to: [face_width / 2, bore])";
    // between tip and bore 19.6 mm, and along the bore 20 mm; a centre lies on the side of the material where the radius is positive
    let center = |radius: f64, half: f64| radius.signum() * (radius * radius - half * half).sqrt();
    let arcs = [(front, 25.0, [center(25.0, 9.8) - 10.0, 29.8]), (front, -60.0, [center(-60.0, 9.8) - 10.0, 29.8])];
    let arcs = arcs.into_iter().chain([(bore, 40.0, [0.0, 20.0 + center(40.0, 10.0)])]);
    for ((line, radius, [z0, rho0]), part) in
        arcs.flat_map(|arc| [SolidPart::Gear, SolidPart::Tooth].map(|of| (arc, of)))
    {
        let arc = line.replace("line(", "arc(").replace("])", &format!("], radius: {radius} mm)"));
        let set = [("helix_angle", "0 deg")];
        let asked = Asked { changed: Some((line, &arc)), part, ..Asked::new(BODIES, "helical", &set) };
        let off = |[x, y, z]: [f64; 3]| ((z - z0).hypot(x.hypot(y) - rho0) - f64::abs(radius)).abs();
        let is_on = |point: &[f32; 3]| {
            let [x, y, z] = point.map(f64::from);
            (if line == front { z < -5.0 } else { x.hypot(y) < 25.0 }) && off([x, y, z]) < 1e-4
        };
        let (_, mesh) = asked.only();
        let middle = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|k| 0.5 * (f64::from(a[k]) + f64::from(b[k])));
        let on_arc = mesh.iter().filter(|triangle| triangle.iter().all(is_on));
        let far: Vec<f64> =
            on_arc.flat_map(|[a, b, c]| [middle(*a, *b), middle(*b, *c), middle(*c, *a)].map(off)).collect();
        let most = far.iter().copied().fold(0.0, f64::max);
        assert!(far.len() > 100 && most < DEVIATION + 1e-5, "{arc} {part:?}: {most} mm of {}", far.len());
        assert!(most > 0.1 * DEVIATION, "{arc} {part:?}: no finer than is needed: {most} mm");
    }
}

#[test]
fn a_finer_mesh_is_nearer() {
    let asked = |deviation: f64| Asked { deviation, ..Asked::new(BODIES, "helical", &[]) }.only().0;
    let off = [0.08, 0.005].map(|deviation| {
        let body = asked(deviation);
        ((body.mesh.volume_mm3 / body.volume_mm3 - 1.0).abs(), (body.mesh.area_mm2 / body.area_mm2 - 1.0).abs())
    });
    assert!(off[1].0 < off[0].0 / 4.0 && off[1].1 < off[0].1 / 4.0, "{off:?}");
}

/// Moments of a gear with so many teeth are the same about all axes across its own, and those of a full ring are a ring's.
#[test]
fn inertia_is_that_of_a_ring_with_spaces() {
    let (body, _) = Asked::new(BODIES, "helical", &[]).only();
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = body.inertia_kg_mm2;
    assert!((xx / yy - 1.0).abs() < 1e-10 && [xy, xz, yz].iter().all(|x| x.abs() < 1e-9 * zz), "{xx} {yy} {zz}");
    // between those of the rings with root and tip radius
    let ring = |outer: f64| 7.85e-6 * 0.5 * PI * 20.0 * (outer.powi(4) - 20f64.powi(4));
    assert!(ring(33.0) < zz && zz < ring(41.0), "{zz}");
    // by width h: xx is half of zz and the mass times h²/12
    assert!((xx - 0.5 * zz - body.mass_kg * 400.0 / 12.0).abs() < 1e-9 * xx);
}

#[test]
fn teeth_that_the_rack_undercuts_end_where_flank_and_fillet_meet() {
    let set = [("helix_angle", "0 deg"), ("teeth", "10"), ("shift", "0"), ("bore", "5 mm")];
    let (body, mesh) = Asked::new(BODIES, "helical", &set).only();
    assert_eq!(euler_characteristic(&mesh), 0);
    let spur = Spur { module: 3.0, teeth: 10.0, shift: 0.0, rounding: 0.38 };
    let (theta, form) = spur.undercut();
    let space = spur.fillet(theta) + simpson(form, 18.0, |rho| 2.0 * spur.involute(rho) * rho);
    let exact = 20.0 * (PI * (18.0 * 18.0 - 25.0) - 10.0 * space);
    assert!((body.volume_mm3 / exact - 1.0).abs() < 1e-7, "{} {exact}", body.volume_mm3);
}

/// Fillets that are deeper than what they leave of the flanks: form diameter, span and balls are still the flanks'.
#[test]
fn gauges_touch_the_flank_however_deep_the_fillet_is() {
    let inv = |angle: f64| angle.tan() - angle;
    for (teeth, shift) in [(20.0, -0.5), (14.0, -0.4)] {
        let set = [("helix_angle", "0 deg"), ("teeth", &*teeth.to_string()), ("shift", &*shift.to_string())];
        let (body, _) = Asked::new(BODIES, "helical", &[&set[..], &[("bore", "5 mm")]].concat()).only();
        let (spur, gauges) = (Spur { module: 3.0, teeth, shift, rounding: 0.38 }, &body.gauges);
        let (_, form) = spur.undercut();
        let [root, tip] = [spur.radius() - (1.25 - shift) * 3.0, spur.radius() + (1.0 + shift) * 3.0];
        assert!(form - root > tip - form, "the fillet is the deeper one: {root} {form} {tip}");
        let near = |found: f64, exact: f64, what: &str| {
            assert!((found - exact).abs() < 2e-7, "{what} of {teeth} teeth, shift {shift}: {found}, not {exact}");
        };
        gauges.form_diameters_mm.expect("round").iter().for_each(|found| near(*found, 2.0 * form, "form diameter"));
        let base = spur.radius() * ALPHA.cos();
        for span in &gauges.spans {
            let across = (f64::from(span.teeth) - 0.5) * PI + teeth * inv(ALPHA);
            near(span.width_mm, 3.0 * ALPHA.cos() * across + 6.0 * shift * ALPHA.sin(), "span");
            span.diameters_mm.iter().for_each(|at| assert!(0.5 * at > form, "touches the flank: {span:?}"));
        }
        let touching = |count: f64| {
            base.hypot(
                0.5 * (3.0 * ALPHA.cos() * ((count - 0.5) * PI + teeth * inv(ALPHA)) + 6.0 * shift * ALPHA.sin()),
            )
        };
        let wanted = (1..=7).filter(|k| (form..tip).contains(&touching(f64::from(*k)))).count();
        assert_eq!(gauges.spans.len(), wanted, "{:?}", gauges.spans);
        let balls = gauges.balls.as_ref().expect("one touches");
        let half = (FRAC_PI_2 + 2.0 * shift * ALPHA.tan()) / teeth;
        let wanted = inv(ALPHA) + balls.ball_mm / (3.0 * teeth * ALPHA.cos()) + half - PI / teeth;
        near(balls.over_balls_mm, 2.0 * base / arcinv(wanted).cos() + balls.ball_mm, "balls");
    }
}

/// Flanks of neighbouring spaces meet where the tooth's thickness by the involute is nothing; the space is open from there on.
#[test]
fn pointed_teeth_end_in_an_edge() {
    let set = [("helix_angle", "0 deg"), ("teeth", "9"), ("shift", "0.9"), ("bore", "5 mm")];
    let (body, mesh) = Asked::new(BODIES, "helical", &set).only();
    assert_eq!(euler_characteristic(&mesh), 0);
    let spur = Spur { module: 3.0, teeth: 9.0, shift: 0.9, rounding: 0.38 };
    let (mut low, mut high) = (spur.radius(), spur.radius() + 1.9 * 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if spur.involute(middle) < PI / 9.0 { low = middle } else { high = middle }
    }
    let below = body.gauges.edge_below_tip_mm.expect("pointed");
    let tip = body.gauges.tip_diameter_mm.expect("round");
    assert!((0.5 * tip - low).abs() < 1e-8, "{tip} {low}");
    assert!((spur.radius() + 1.9 * 3.0 - below - low).abs() < 1e-8, "{below}");
    let section = PI * (low * low - 25.0) - 9.0 * spur.space(low);
    assert!((body.volume_mm3 / (20.0 * section) - 1.0).abs() < 2e-8, "{}", body.volume_mm3);
}

#[test]
fn what_bounds_no_body_is_told_with_its_number() {
    let spaces = "[left, left_fillet, root, right_fillet, right]";
    let with = |to: &'static str| Asked { changed: Some((spaces, to)), ..Asked::new(BODIES, "helical", &[]) };
    let told = with("[left, left_fillet, right_fillet, right]").refused();
    assert!(told.contains("`left_fillet` and `right_fillet`") && told.contains("leave a gap of 0.3660 mm"), "{told}");
    let told = with("[left]").refused();
    assert!(told.contains("is one surface"), "{told}");
    let told = Asked::new(BODIES, "helical", &[("bore", "35 mm")]).refused();
    assert!(told.contains("mm through `bore` of its outline"), "{told}");
    // the root's own radius: 3 mm times 12 / cos 15 deg less 1.05
    let root = 36.0 / f64::to_radians(15.0).cos() - 3.15;
    for bore in [root, root + 1e-7] {
        let told = Asked::new(BODIES, "helical", &[("bore", &*format!("{bore} mm"))]).refused();
        assert!(told.contains("reach `bore`") && told.contains("34.1199 mm from the axis: no wall"), "{told}");
    }
    // the rack is shorter than half the face
    let short = Some(("half_width: 2 * face_width", "half_width: 8 mm"));
    let told = Asked { changed: short, ..Asked::new(BODIES, "helical", &[("helix_angle", "0 deg")]) }.refused();
    assert!(
        told.contains("`left` ends are beyond the ranges of their unknowns, `v`") && told.contains(" by 2.0000 mm"),
        "{told}"
    );
    let told = with("[left, left_fillet, root, right_fillet]").not_done();
    let message = &told.message;
    assert!(message.contains("`right_fillet` does not reach `tip`") && message.contains("`theta` by "), "{told}");
    assert!(told.details[0].starts_with("name in `of:` the surface between `right_fillet` and the tip"), "{told}");
    // the bore lies 0.4 mm outside the tip
    let told = Asked::new(BODIES, "helical", &[("helix_angle", "0 deg"), ("bore", "40 mm")]).refused();
    assert!(told.contains("through `tip` of its outline, and leave it by `bore`"), "{told}");
}

/// Balls between two pins of a ring, by the distance of their centres, which stay clear of the ground that the pins stand out of: the program's
/// own choice does, and another one is refused with how deep it would lie.
#[test]
fn balls_stay_clear_of_the_ground_between_flanks() {
    let asked =
        |ball: Option<f64>| Asked { ball, ..Asked::new("specs/bodies/pin_ring_body.chain", "pin_ring_body", &[]) };
    let (ring, pin, half) = (60.0, 6.0, PI / 12.0);
    let ground = f64::hypot(ring, pin);
    let centre = |ball: f64| {
        let apart = pin + 0.5 * ball;
        ring * half.cos() - (apart * apart - (ring * half.sin()).powi(2)).sqrt()
    };
    let balls = asked(None).only().0.gauges.balls.expect("one fits");
    let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-7, "{found}, not {exact}");
    near(balls.over_balls_mm, 2.0 * centre(balls.ball_mm) - balls.ball_mm);
    assert!(centre(balls.ball_mm) + 0.5 * balls.ball_mm < ground, "{balls:?}");
    let refused = |ball: f64| {
        let folder = tempfile::tempdir().expect("a folder");
        let result = asked(Some(ball)).built(folder.path());
        assert!(result.solids[0].gauges.balls.is_none() && result.not_done()[0].kind == NotDoneKind::NoBall);
        result.not_done()[0].message.clone()
    };
    let deep = centre(20.5) + 10.25 - ground;
    assert!(refused(20.5).ends_with(&format!("would lie {deep:.4} mm deep in the steel of `ground`")), "{deep}");
    let set = [("pins", "3")];
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { set: &set, ..asked(Some(98.25)) }.built(folder.path());
    assert!(result.not_done()[0].message.ends_with("in opposite spaces of `ring` would lie in each other"), "{result}");
    let none = Asked { set: &set, ..asked(None) }.only().0.gauges.balls;
    assert!(none.as_ref().is_none_or(|balls| balls.over_balls_mm > 0.0), "{none:?}");
}

/// Bodies stand at the lag that all pairs of teeth leave, their edges too: of a worm of three starts the throat of the wheel and the tip of the worm
/// carry over a part of the pitch, and where flanks alone were looked at they lay 0.012 mm in each other.
#[test]
fn pairs_stand_where_flanks_and_edges_let_them() {
    for starts in ["1", "3"] {
        let folder = tempfile::tempdir().expect("a folder");
        let set = [("starts", starts)];
        let pair = Asked::new("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", &set);
        let result = Asked { deviation: 0.1, ..pair }.built(folder.path());
        assert!(result.is_complete(), "{starts}: {:?}", result.not_done());
        assert!(result.to_string().contains("stand as they mesh in the middle"), "{result}");
    }
}

/// Where the bore is too large by the space's whole depth, that is what is told, whatever is looked at first.
#[test]
fn how_far_spaces_go_through_the_bore_is_measured_where_they_go_farthest() {
    // 3 mm times 12 less 1.05
    let root = 36.0 - 3.15;
    for bore in [32.86, 32.9, 33.0, 33.5, 34.0, 36.0, 37.0, 38.0] {
        let set = [("helix_angle", "0 deg"), ("bore", &*format!("{bore} mm"))];
        let told = Asked::new(BODIES, "helical", &set).not_done();
        let by = format!("{:.4} mm through `bore`", bore - root);
        assert!(told.message.contains(&by), "{bore}: {by}, {}", told.message);
        assert!(told.place.is_some() && told.details.len() == 1 && told.kind == NotDoneKind::NoBody, "{told:?}");
    }
}

/// The roundings of a rack whose land is negative cross each other in the middle of the space, where the trochoid's angle is nothing. The
/// ground behind the crossing is no ground, and left out of the space its neighbours end there.
#[test]
fn spaces_that_cross_themselves_are_refused_and_end_where_fillets_meet() {
    let set = [("helix_angle", "0 deg"), ("r.tip_radius", "2 mm")];
    let asked = Asked::new(BODIES, "helical", &set);
    let spur = Spur { module: 3.0, teeth: 24.0, shift: 0.2, rounding: 2.0 / 3.0 };
    let (mut low, mut high) = (ALPHA, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if spur.trochoid(middle)[1] < 0.0 { high = middle } else { low = middle }
    }
    let [root, _] = spur.trochoid(low);
    let told = asked.not_done();
    let parts = ["cross themselves", "`left_fillet` and `right_fillet` meet", " mm from the axis"];
    assert!(parts.iter().all(|part| told.message.contains(part)), "{}", told.message);
    let words: Vec<&str> = told.message.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "from").expect("a place");
    // chords of the fillets
    let place: f64 = words[at - 2].parse().expect("a number");
    assert!((place - root).abs() < 0.01, "{place} {root}");
    assert!(told.details[0].contains("leave `root` out"), "{:?}", told.details);
    let (body, mesh) =
        Asked { changed: Some(("left_fillet, root, right_fillet", "left_fillet, right_fillet")), ..asked }.only();
    assert_eq!(euler_characteristic(&mesh), 0);
    assert!((body.gauges.root_diameter_mm.expect("round") - 2.0 * root).abs() < 1e-7, "{root} {:?}", body.gauges);
    let tip = spur.radius() + 3.6;
    let [form, _] = spur.trochoid(ALPHA);
    let flanks = simpson(form, tip, |rho| 2.0 * spur.involute(rho) * rho);
    // the space reaches no deeper than where they meet
    let section = PI * (tip * tip - 400.0) - 24.0 * (flanks + spur.fillet_to([ALPHA, low]));
    assert!((body.volume_mm3 / (20.0 * section) - 1.0).abs() < 1e-7, "{}", body.volume_mm3);
}

/// Volume, centre and inertia about it of a closed mesh, of density one: of the tetrahedra over its triangles.
fn moments(mesh: &[[[f32; 3]; 3]]) -> (f64, [f64; 3], [f64; 3]) {
    let (mut volume, mut first, mut second) = (0.0, [0.0; 3], [0.0; 3]);
    for triangle in mesh {
        let [a, b, c] = triangle.map(|corner| corner.map(f64::from));
        let cross = |k: usize| b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3];
        let part = (0..3).map(|k| a[k] * cross(k)).sum::<f64>() / 6.0;
        volume += part;
        for k in 0..3 {
            let (sum, squares) = (a[k] + b[k] + c[k], a[k] * a[k] + b[k] * b[k] + c[k] * c[k]);
            first[k] += part * sum / 4.0;
            second[k] += part * (squares + sum * sum) / 20.0;
        }
    }
    let centre = first.map(|moment| moment / volume);
    let about: Vec<f64> = (0..3).map(|k| second[k] - volume * centre[k] * centre[k]).collect();
    (volume, centre, [about[1] + about[2], about[0] + about[2], about[0] + about[1]])
}

/// A rack from the middle of a space to that of another one has its centre in the middle between, and the moments of its own mesh.
#[test]
fn racks_have_their_centre_in_the_middle() {
    for (teeth, helix) in [(10.0, 0.0), (1.0, 0.0), (10.0, 15.0), (3.0, -45.0)] {
        let set = [("teeth", &*teeth.to_string()), ("helix_angle", &*format!("{helix} deg"))];
        let asked = Asked::new("specs/bodies/rack_body.chain", "rack_body", &set);
        let (body, mesh) = Asked { deviation: 0.001, ..asked }.only();
        let middle = 0.5 * teeth * 3.0 * PI / f64::to_radians(helix).cos();
        let [x, y, z] = body.centre_mm;
        assert!((y - middle).abs() < 1e-7 && z.abs() < 1e-7, "{teeth} teeth at {helix} deg: {y}, not {middle}; {z}");
        let (_, centre, inertia) = moments(&mesh);
        assert!((centre[0] - x).abs() < 1e-3 && (centre[1] - y).abs() < 1e-3, "{centre:?} {x} {y}");
        for (k, found) in inertia.into_iter().enumerate() {
            let own = body.inertia_kg_mm2[k][k] / 7.85e-6;
            assert!((found / own - 1.0).abs() < 2e-4, "{teeth} teeth at {helix} deg, {k}: {found} {own}");
        }
    }
}

/// The one space is that which the job samples, about the x axis or the middle of the bar's first space.
#[test]
fn a_space_stands_where_it_is_sampled() {
    for job in ["spur_gear_body", "rack_body", "undercut_gear_body"] {
        let folder = tempfile::tempdir().expect("a folder");
        Asked { part: SolidPart::Space, ..Asked::new(&format!("specs/bodies/{job}.chain"), job, &[]) }
            .built(folder.path());
        let (_, centre, _) = moments(&triangles(&folder.path().join(format!("{job}.stl"))));
        assert!(centre[1].abs() < 1e-3, "{job}: {centre:?}");
    }
}

/// A shaft's blank goes as far as its axis: discs as ends, and nothing along the axis.
#[test]
fn a_body_without_a_bore_is_closed_at_its_axis() {
    let set = [("helix_angle", "0 deg"), ("bore", "0 mm")];
    let spur = Spur { module: 3.0, teeth: 24.0, shift: 0.2, rounding: 0.38 };
    let tip = spur.radius() + 3.6;
    let section = PI * tip * tip - 24.0 * spur.space(tip);
    for (part, share) in [(SolidPart::Gear, 1.0), (SolidPart::Tooth, 24.0), (SolidPart::Space, 24.0)] {
        let folder = tempfile::tempdir().expect("a folder");
        let result = Asked { part, ..Asked::new(BODIES, "helical", &set) }.built(folder.path());
        let (body, mesh) = (&result.solids[0], triangles(&folder.path().join("helical.stl")));
        assert_eq!(euler_characteristic(&mesh), 2, "{part:?}");
        assert_eq!((mesh.len(), body.mesh.triangles), (body.mesh.triangles, mesh.len()), "{part:?}");
        let used = body.mesh.vertices as i64 - mesh.len() as i64 / 2;
        assert_eq!(used, 2, "{part:?}: no vertex without a triangle");
        assert!((volume(&mesh) * share / (20.0 * section) - 1.0).abs() < 1e-3, "{part:?}: {}", volume(&mesh));
        assert!((body.volume_mm3 / (20.0 * section) - 1.0).abs() < 2e-8, "{}", body.volume_mm3);
    }
}

/// The sides of one tooth go on from spaces that wind, and reach no shaft beyond them: numbers and mesh of the part are there, which have the shaft,
/// and in place of its STEP file the reason and ways out. The whole gear has one.
#[test]
fn a_tooth_of_a_shaft_that_is_longer_than_its_teeth_has_no_smooth_sides() {
    let bore = "bore  = line(from: [front, reference_radius / 2], to: [back, reference_radius / 2])";
    let shaft = "neck  = line(from: [front, reference_radius / 2], to: [front - 12 mm, reference_radius / 2])
        end   = line(from: [front - 12 mm, reference_radius / 2], to: [front - 12 mm, reference_radius / 3])
        bore  = line(from: [front - 12 mm, reference_radius / 3], to: [back, reference_radius / 3])";
    let back = ("back  = line(from: [back, reference_radius / 2]", "back  = line(from: [back, reference_radius / 3]");
    let spec = "specs/bodies/helical_gear_body.chain";
    let text = std::fs::read_to_string(repository(spec)).expect("a spec");
    assert!(text.contains(bore) && text.contains(back.0), "{spec}");
    let longer = text.replace(bore, shaft).replace(back.0, back.1);
    let asked = Asked::new(spec, "helical_gear_body", &[]);
    let asked = Asked { step: Some(1e-4), changed: Some((&text, &longer)), ..asked };
    let folder = tempfile::tempdir().expect("a folder");
    let result = Asked { part: SolidPart::Tooth, ..asked }.built(folder.path());
    let told = &result.not_done()[0];
    assert_eq!(told.kind, NotDoneKind::FaceInexact);
    assert!(
        told.message.contains("`neck` of the outline") && told.message.contains("by up to 12.0000 mm"),
        "{}",
        told.message
    );
    assert!(told.details[0].contains("option `solid gear`"), "{:?}", told.details);
    assert!(!folder.path().join("helical_gear_body.step").exists());
    let mesh = triangles(&folder.path().join("helical_gear_body.stl"));
    let share = result.solids[0].volume_mm3 / f64::from(result.solids[0].teeth);
    assert!((volume(&mesh) / share - 1.0).abs() < 1e-3, "a mesh within 10 um: {} of {share}", volume(&mesh));
    let result = Asked { part: SolidPart::Gear, ..asked }.built(folder.path());
    assert!(result.is_complete() && folder.path().join("helical_gear_body.step").exists(), "{:?}", result.not_done());
}

/// What is too narrow is named with the range that it has.
#[test]
fn ranges_that_end_too_soon_are_told() {
    let told = Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", &[("teeth", "4")]).not_done();
    assert!(told.message.contains("beyond the ranges of their unknowns, `phi` by 18.5194 deg"), "{}", told.message);
    assert_eq!(told.details, ["`phi`, the motion, has the range -60 deg .. 60 deg: a wider one reaches there"]);
    let set = [("r.tip_radius", "0 mm")];
    let told = Asked::new("specs/bodies/spur_gear_body.chain", "spur_gear_body", &set).not_done();
    let parts = ["81: cut away by the tool itself", "a rounding without a radius, is left out of `of:`"];
    assert!(told.details.iter().zip(parts).all(|(told, part)| told.contains(part)), "{told:?}");
}

/// A cutter's rounding makes the fillet; left out, it is a gap.
#[test]
fn a_rounding_that_no_surface_is_named_for_is_a_gap() {
    let told = Asked::new(BODIES, "internal", &[]).refused();
    assert!(told.contains("`left` and `root`") && told.contains("leave a gap of "), "{told}");
}

/// How far the middles of those sides of triangles that have both ends on a cylinder lie within it, mm.
fn off_cylinder(mesh: &[[[f32; 3]; 3]], rho: f64) -> f64 {
    let sides = mesh.iter().flat_map(|of| (0..3).map(move |k| [of[k], of[(k + 1) % 3]].map(|at| at.map(f64::from))));
    // single precision
    let on = sides.filter(|ends| ends.iter().all(|[x, y, _]| (x.hypot(*y) - rho).abs() < 1e-6 * rho));
    let off = on.map(|[a, b]| rho - (0.5 * (a[0] + b[0])).hypot(0.5 * (a[1] + b[1])));
    off.fold(0.0, f64::max)
}

/// However far teeth wind about the axis: tip and bore of a worm and of a steep pinion are as near to their cylinders as is told, that is no farther
/// than is asked for, and the area nears the exact one.
#[test]
fn meshes_of_threads_are_as_near_as_is_said() {
    let worm = ("specs/bodies/worm_and_wheel_body.chain", "worm_and_wheel_body", "worm_and_wheel_body.worm");
    let steep = ("specs/bodies/helical_gear_body.chain", "helical_gear_body", "helical_gear_body");
    let cases: [(_, &[(&str, &str)]); 3] = [
        (worm, &[]),
        (worm, &[("starts", "2")]),
        (steep, &[("teeth", "6"), ("helix_angle", "60 deg"), ("face_width", "60 mm")]),
    ];
    for ((spec, job, file), set) in cases {
        let mut before = f64::INFINITY;
        for deviation in [0.04, 0.01] {
            let folder = tempfile::tempdir().expect("a folder");
            let result = Asked { deviation, ..Asked::new(spec, job, set) }.built(folder.path());
            let body = &result.solids[0];
            let mesh = triangles(&folder.path().join(format!("{file}.stl")));
            let inner = mesh.iter().flatten().map(|[x, y, _]| f64::from(*x).hypot(f64::from(*y)));
            let [tip, bore] = [0.5 * body.gauges.tip_diameter_mm.expect("round"), inner.fold(f64::INFINITY, f64::min)];
            let off = off_cylinder(&mesh, tip).max(off_cylinder(&mesh, bore));
            let told = body.mesh.deviation_mm;
            // 1e-5: single precision
            assert!(told <= deviation && off <= told + 1e-5, "{job} {set:?} {deviation}: {off} {told}");
            let area = (body.mesh.area_mm2 / body.area_mm2 - 1.0).abs();
            // the triangles of the ground wind with the thread
            assert!(area < before && area < 5e-3, "{job} {set:?} {deviation}: area off by {area}");
            before = area;
            assert_eq!(euler_characteristic(&mesh), 0, "{job} {set:?} {deviation}");
        }
    }
}

/// Parts are cut off from each other by the same triangles on both sides: a part has its share of what the whole mesh encloses.
#[test]
fn parts_fit_their_copies() {
    for (spec, job) in [("specs/bodies/helical_gear_body.chain", "helical_gear_body"), (DIAGONAL, "diagonal_gear_body")]
    {
        let of = |part: SolidPart| Asked { part, deviation: 0.03, ..Asked::new(spec, job, &[]) }.only().0;
        let body = of(SolidPart::Gear);
        let exact = body.volume_mm3 / f64::from(body.teeth);
        for part in [SolidPart::Tooth, SolidPart::Space] {
            let volume = of(part).mesh.volume_mm3;
            // flanks, fillets and root are chords within 0.03 mm; sides that do not fit made 3e-3 to 8e-3 of it
            assert!((volume / exact - 1.0).abs() < 1.5e-3, "{job} {part:?}: {volume} {exact}");
        }
    }
}

const DIAGONAL: &str = "specs/bodies/diagonal_gear_body.chain";

/// Where the halves of a lobe end far beside its top, no body is made of them; a little beside it the top is found all the same.
#[test]
fn lobes_that_end_beside_their_tops_are_told() {
    let gerotor = |place: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        Asked::new("specs/cycloidal/gerotor.chain", "gerotor", &[("p.place", place)]).built(folder.path())
    };
    let result = gerotor("180 deg");
    let told = &result.not_done()[0];
    // the ring's radius plus the eccentricity less the pin's radius is the top, 43.7 mm across; the ground is twice the eccentricity below
    assert!(told.message.contains("end in an edge 5.7000 mm below their top"), "{told}");
    assert!(told.message.contains("about the axis beside it") && told.details[0].contains("end on the top"), "{told}");
    let result = gerotor("1 deg");
    let gauges = &result.solids[0].gauges;
    for (found, exact) in [(gauges.tip_diameter_mm, 43.7), (gauges.root_diameter_mm, 32.3)] {
        let off = (found.expect("round") - exact).abs();
        // a search that stops where depths are equal to rounding
        assert!(off < 1e-6, "{off}");
    }
}

/// Lobes that the blank is lower than are turned down: they have lands, and the volume lies between those of the ground and of the whole lobes.
#[test]
fn round_lobes_can_be_turned_down() {
    let lower = Some(("ring_radius + eccentricity - pin_radius", "ring_radius + eccentricity - pin_radius - 1 mm"));
    let of =
        |changed| Asked { changed, ..Asked::new("specs/cycloidal/cycloidal_disc.chain", "cycloidal_disc", &[]) }.only();
    let ((whole, _), (turned, mesh)) = (of(None), of(lower));
    assert_eq!(euler_characteristic(&mesh), 0);
    let tip = turned.gauges.tip_diameter_mm.expect("round");
    // the ring's radius, the eccentricity, less the pin's radius and what is turned off
    assert!((tip - 2.0 * 55.5).abs() < 1e-6 && turned.gauges.edge_below_tip_mm.is_none(), "{tip}");
    // the bore is half as large as the blank: 0.5 mm smaller
    let bore = PI * (28.25_f64.powi(2) - 27.75_f64.powi(2)) * 12.0;
    let off = whole.volume_mm3 + bore - turned.volume_mm3;
    let ring = PI * (56.5_f64.powi(2) - 55.5_f64.powi(2)) * 12.0;
    assert!(off > 0.05 * ring && off < ring, "{off} of {ring}");
}

/// A gear each of whose spaces is a little deeper than the last.
const DEEPENING: &str = r#"
use "spur_gear_body.chain"

machine indexing extends rack_generating {
    axis S     : linear
    axis index : rotary
    frame indexed in table = rotate_z(-index)
    couple X = reference_radius + shift - S
}

job deepening extends spur_gear_body {
    param space : count in 0 .. 1000 = 0
    machine m = indexing(reference_radius: reference_radius, shift: profile_shift * module)
    drive m.C = phi
    drive m.index = 360 deg / teeth * space
    drive m.S = 0.05 mm * space
    surface flank_plus, fillet_plus   in m.indexed = envelope(r.flank_plus, r.fillet_plus, over: phi)
    surface flank_minus, fillet_minus in m.indexed = envelope(r.flank_minus, r.fillet_minus, over: phi)
    surface root in m.indexed = envelope(r.tip, over: phi)
    solid gear in m.indexed = turned(blank, spaces: teeth, each: space, of: [
        flank_minus, fillet_minus, root, fillet_plus, flank_plus
    ])
    expect nothing
}
"#;

/// A part of a gear whose spaces differ is no share of it: its STEP file says no volume, and its mesh is cut off by planes.
#[test]
fn parts_of_gears_whose_spaces_differ() {
    let path = repository("specs/bodies/deepening.chain");
    let project = Project::open(&path, Arc::new(Buffers::over(Arc::new(Disk)).with(&path, DEEPENING)));
    for (part, has_volume) in [(SolidPart::Gear, true), (SolidPart::Space, false), (SolidPart::Tooth, false)] {
        let folder = tempfile::tempdir().expect("a folder");
        let set =
            [("teeth", "12"), ("profile_shift", "0.5")].map(|(name, value)| (name.to_string(), value.to_string()));
        let request = SolidRequest {
            jobs: JobSelection { project: project.clone(), job: Some("deepening".to_string()), set: set.to_vec() },
            part,
            out: folder.path().to_path_buf(),
            format: vec![MeshFormat::Stl],
            step: Some(1e-3),
            deviation: DEVIATION,
            density: 7850.0,
            ball: None,
            evaluator: EvaluatorOptions::default(),
        };
        solid(&request, &Unwatched, &mut |result| assert!(result.is_complete(), "{result}")).expect("a right spec");
        let step = std::fs::read_to_string(folder.path().join("deepening.step")).expect("written");
        assert_eq!(step.contains("VOLUME_MEASURE"), has_volume, "{part:?}");
        if part == SolidPart::Space {
            let mesh = triangles(&folder.path().join("deepening.stl"));
            let way = |[x, y, _]: [f32; 3]| f64::from(y).atan2(f64::from(x));
            let ways = || mesh.iter().flatten().map(|at| way(*at));
            for end in [ways().fold(f64::INFINITY, f64::min), ways().fold(f64::NEG_INFINITY, f64::max)] {
                // corners of the part at the tip and at the bore lie on one plane through the axis: single precision
                let on = mesh.iter().flatten().filter(|at| (way(**at) - end).abs() < 1e-6);
                let radii: Vec<f64> = on.map(|[x, y, _]| f64::from(*x).hypot(f64::from(*y))).collect();
                let [low, high] =
                    [radii.iter().copied().fold(f64::INFINITY, f64::min), radii.iter().copied().fold(0.0, f64::max)];
                assert!(high - low > 4.0, "{end}: {low} .. {high}");
            }
        }
    }
}

/// A mesh that nobody has room for is refused before it is made, with a deviation that is possible.
#[test]
fn a_mesh_that_is_too_large_is_refused_beforehand() {
    let path = repository("specs/bodies/spur_gear_body.chain");
    let folder = tempfile::tempdir().expect("a folder");
    let request = SolidRequest {
        jobs: JobSelection { project: Project::open(&path, Arc::new(Disk)), job: None, set: Vec::new() },
        part: SolidPart::Gear,
        out: folder.path().to_path_buf(),
        format: vec![MeshFormat::Stl],
        step: None,
        deviation: 1e-7,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    let refused = solid(&request, &Unwatched, &mut |_| ()).expect_err("it would take gigabytes").to_string();
    assert!(refused.starts_with("the mesh of `gear` within 1.0e-4 um would have"), "{refused}");
    assert!(refused.ends_with("um is possible with option `deviation`"), "{refused}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}
