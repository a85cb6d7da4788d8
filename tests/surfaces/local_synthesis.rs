//! The recipe of local synthesis, as the page on theory has it, by numbers: from the gear's curvatures at the wanted point to those of the
//! pinion, which settings found by the program cut.

use flank_chain_dsl::{Dimension, Job, SampleGrid};
use flank_expr::Graph;
use flank_solver::{
    ContactNumber, ContactProblem, ContactSynthesis, ContactWish, Curvature, FlankCorners, Range, ScaledUnknown,
    SynthesizedContact,
};
use flank_tests::pairs::with_pair_in;
use flank_tests::{evaluated, job};
use nalgebra::{Rotation3, Vector3};

const PAIR: &str = "specs/pairs/bevel_19x62.chain";
const SETTINGS: [&str; 6] = [
    "p.radial_distance",
    "p.work_offset",
    "p.machine_center_to_crossing_point",
    "p.ratio_of_roll",
    "p.modified_roll_2c",
    "pinion_cutter.blade_angle",
];
/// mm
const FILM: f64 = 0.00635;

/// What is wanted of the contact at its vertex.
struct Wanted {
    place: [f64; 2],
    path: f64,
    ellipse: f64,
    error: f64,
}

/// The pair in its housing: the pinion's axis is z, the gear's lies at the shaft angle to it and turns the other way.
struct Housing {
    axis: Vector3<f64>,
    ratio: f64,
}

impl Housing {
    fn of_19x62() -> Housing {
        let shaft = 95f64.to_radians();
        Housing { axis: Vector3::new(shaft.sin(), 0.0, shaft.cos()), ratio: 19.0 / 62.0 }
    }

    /// From the gear's frame, turned by an angle.
    fn gear(&self, angle: f64) -> Rotation3<f64> {
        let shaft = self.axis.x.atan2(self.axis.z);
        Rotation3::from_axis_angle(&Vector3::y_axis(), shaft)
            * Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI - angle)
    }

    fn spins(&self) -> [Vector3<f64>; 2] {
        [Vector3::z(), -self.ratio * self.axis]
    }

    /// Velocity of the gear against the pinion at a point, per radian of roll.
    fn velocity(&self, at: Vector3<f64>) -> Vector3<f64> {
        let [first, second] = self.spins();
        (second - first).cross(&at)
    }
}

/// A flank at the wanted point: position, normal out of the member and curvature, in its frame.
struct FlankPoint {
    position: Vector3<f64>,
    normal: Vector3<f64>,
    curvature: Curvature,
}

impl FlankPoint {
    fn of(job: &Job<'_>, surface: &str, unknowns: &[f64], outwards: [f64; 3]) -> FlankPoint {
        let found = evaluated(job, surface, &[unknowns.to_vec()]).swap_remove(0);
        assert!(found.residual < 1e-9, "{surface}: {:e}", found.residual);
        let normal = Vector3::from(found.normal);
        FlankPoint {
            position: Vector3::from(found.position),
            normal: normal * normal.dot(&Vector3::from(outwards)).signum(),
            curvature: found.geometry.curvature.expect("a regular point"),
        }
    }

    /// S d, for a tangent d in the housing where the member stands turned: from normal curvatures along d, along what is square to it, and
    /// between both.
    fn bent(&self, stands: &Rotation3<f64>, d: Vector3<f64>) -> Vector3<f64> {
        let own = stands.inverse() * d;
        let across = self.normal.cross(&own);
        let along = |of: Vector3<f64>| self.curvature.along(of.into()).expect("a tangent");
        let mixed = along(own + across) - 0.5 * (along(own) + along(across));
        stands * (along(own) * own + mixed * across)
    }
}

/// Steps 1 to 5: where the gear stands, and of the pinion at the point the normal curvatures along e, along f and between both, with e and f
/// in the housing.
fn recipe(gear: &FlankPoint, corners: FlankCorners, wanted: &Wanted) -> (f64, [Vector3<f64>; 2], [f64; 3]) {
    let housing = Housing::of_19x62();
    // 1: at the vertex the members do not part, which says where the gear stands
    let parting = |angle: f64| {
        let stands = housing.gear(angle);
        (stands * gear.normal).dot(&housing.velocity(stands * gear.position))
    };
    let mut angle = 0.0;
    for _ in 0..40 {
        const STEP: f64 = 1e-4;
        angle -= 2.0 * STEP * parting(angle) / (parting(angle + STEP) - parting(angle - STEP));
    }
    let stands = housing.gear(angle);
    let (r, n) = (stands * gear.position, -(stands * gear.normal));
    let ([first, second], v) = (housing.spins(), housing.velocity(r));
    // 2: what the motion asks of the gap
    let w = (second - first).cross(&n) + gear.bent(&stands, v);
    // 3: along the wanted path; so much the error asks for
    let rows = corners.directions(gear.position.into(), gear.normal.into()).expect("a flank");
    let (sine, cosine) = wanted.path.sin_cos();
    let path = stands * (cosine * Vector3::from(rows.lengthwise) + sine * Vector3::from(rows.profilewise));
    let accelerations = [first, second].map(|spin| spin.cross(&spin.cross(&r)));
    let by_lag = -housing.axis.cross(&r);
    let along = wanted.error * n.dot(&by_lag) + w.dot(&v) - n.dot(&(first + second).cross(&v))
        + n.dot(&(accelerations[1] - accelerations[0]));
    let on_gear = path * ((along - w.dot(&v)) / w.dot(&path));
    let on_pinion = on_gear + v;
    // 4: the ellipse
    let e = on_pinion.normalize();
    let f = n.cross(&e);
    let [g_ee, g_ef] = [e, f].map(|d| w.dot(&d) / on_pinion.norm());
    let k2 = 8.0 * FILM / wanted.ellipse.powi(2);
    assert!(k2 < g_ee, "an ellipse that is possible");
    let g_ff = k2 + g_ef * g_ef / (g_ee - k2);
    // 5: the pinion
    let of_gear = |a: Vector3<f64>, b: Vector3<f64>| gear.bent(&stands, a).dot(&b);
    (angle, [e, f], [g_ee - of_gear(e, e), g_ff - of_gear(f, f), g_ef - of_gear(e, f)])
}

/// What the program finds for it, with the settings as a spec has them.
fn synthesized(pair: &Job<'_>, wanted: &Wanted, corners: FlankCorners) -> (SynthesizedContact, Vec<(String, String)>) {
    let of = |name: &&str| pair.parameters.iter().find(|of| of.name == **name).expect("a setting");
    let settings: Vec<_> = SETTINGS.iter().map(of).collect();
    let open: Vec<_> = settings.iter().map(|of| of.variable).collect();
    let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    let scale = |dimension: Dimension| if dimension == Dimension::LENGTH { 0.1 } else { 3e-3 };
    let unknowns =
        settings.iter().map(|of| ScaledUnknown { start: of.value, scale: scale(of.dimension), range: everywhere });
    let wish = |of: ContactNumber, wanted: f64| ContactWish { of, wanted, within: None };
    let found = with_pair_in(pair, &open, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(-0.0357, points).expect("they touch");
        let vertex = problem.vertex_near(&first).expect("the error is extreme");
        let synthesis = ContactSynthesis {
            problem: &problem,
            vertex: &vertex,
            wishes: vec![
                wish(ContactNumber::Z, wanted.place[0]),
                wish(ContactNumber::Rho, wanted.place[1]),
                wish(ContactNumber::Path(corners), wanted.path),
                wish(ContactNumber::Ellipse { film: FILM }, wanted.ellipse),
                wish(ContactNumber::Curvature, wanted.error),
            ],
            settings: unknowns.collect(),
        };
        synthesis.solve().expect("they touch")
    });
    let unit = |dimension: Dimension| match dimension {
        Dimension::LENGTH => " mm",
        Dimension::ANGLE => " rad",
        _ => "",
    };
    let value = |(of, value): (&&flank_chain_dsl::Parameter<'_>, &f64)| {
        (of.name.clone(), format!("{value:?}{}", unit(of.dimension)))
    };
    let set = settings.iter().zip(&found.fit.values).map(value).collect();
    (found, set)
}

/// The pinion that these settings cut has the curvatures of the recipe, which knows the gear, the housing and the wish alone.
#[test]
fn settings_cut_the_curvatures_of_the_recipe() {
    let graph = Graph::new();
    let pair = job(&graph, PAIR, &[]);
    let SampleGrid::Shares { corners, .. } = pair.surfaces[1].sample.as_ref().expect("it is sampled").grid else {
        panic!("a sample of shares")
    };
    let corners = FlankCorners(corners);
    for wanted in [
        Wanted { place: [21.6, 106.6], path: 10f64.to_radians(), ellipse: 8.0, error: 0.0090 },
        Wanted { place: [22.0, 107.5], path: 8f64.to_radians(), ellipse: 6.5, error: 0.0105 },
        Wanted { place: [21.2, 105.8], path: 12f64.to_radians(), ellipse: 7.0, error: 0.0095 },
    ] {
        let (found, set) = synthesized(&pair, &wanted, corners);
        let vertex = &found.vertex;
        let what = format!("{:?} with {set:?}", wanted.place);
        assert!(found.fit.residuals.iter().all(|off| off.abs() < 1e-9), "{what}: {:?}", found.fit.residuals);
        let gear = FlankPoint::of(&pair, "gear_convex", &vertex.unknowns[1], vertex.normals[1]);
        let section = [gear.position.z, gear.position.x.hypot(gear.position.y)];
        assert!((0..2).all(|k| (section[k] - wanted.place[k]).abs() < 1e-8), "{what}: {section:?}");
        let (angle, [e, f], bent) = recipe(&gear, corners, &wanted);
        let turned = Housing::of_19x62().ratio * vertex.roll + vertex.lag;
        assert!((angle - turned).abs() < 1e-9, "{what}: the gear stands at {angle}, not at {turned}");

        // 6: the settings
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
        let other = Graph::new();
        let cut = job(&other, PAIR, &set);
        let pinion = FlankPoint::of(&cut, "pinion_concave", &vertex.unknowns[0], vertex.normals[0]);
        let stands = Rotation3::from_axis_angle(&Vector3::z_axis(), vertex.roll);
        let there = Housing::of_19x62().gear(angle);
        assert!((stands * pinion.position - there * gear.position).norm() < 1e-8, "{what}");
        assert!((stands * pinion.normal + there * gear.normal).norm() < 1e-9, "{what}");
        let own = |a: Vector3<f64>, b: Vector3<f64>| pinion.bent(&stands, a).dot(&b);
        for (recipe, cut) in bent.into_iter().zip([own(e, e), own(f, f), own(e, f)]) {
            // 1/mm; wishes are met to 1e-9 of what is worth 1 mm
            assert!((recipe - cut).abs() < 1e-9, "{what}: {recipe} by the recipe, {cut} cut");
        }
    }
}
