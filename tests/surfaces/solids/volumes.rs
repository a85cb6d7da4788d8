//! Volumes, centres and moments of closed forms.

use std::f64::consts::PI;

use flank::Answer;
use flank_tests::bodies::euler_characteristic;

use crate::asked::{Asked, BODIES};
use crate::spur::{Spur, simpson};

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

/// Cavalieri: each section of a helical gear is the same one turned.
#[test]
fn a_helical_gear_has_a_volume_in_proportion_to_its_width() {
    let volume = |width: &str| Asked::new(BODIES, "helical", &[("face_width", width)]).only().0.volume_mm3;
    let (one, two) = (volume("15 mm"), volume("30 mm"));
    assert!((two / one - 2.0).abs() < 1e-10, "{one} {two}");
}

/// A bore lies nearer to what is sampled than the ends of a wide gear do, of which the middle alone is.
#[test]
fn how_far_a_gear_is_sampled_does_not_matter() {
    let wide = [("face_width", "60 mm"), ("bore", "31 mm")];
    let short = Some(("z: -face_width / 2 .. face_width / 2", "z: -face_width / 4 .. face_width / 4"));
    let volume =
        |set: &[(&str, &str)], changed| Asked { changed, ..Asked::new(BODIES, "helical", set) }.only().0.volume_mm3;
    let (one, three) = (volume(&[("bore", "31 mm")], None), volume(&wide, short));
    assert!((three / one - 3.0).abs() < 1e-9, "{one} {three}");
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

/// Volume, centre and inertia about it of a closed mesh, of density one: of the tetrahedra over its triangles.
pub(crate) fn moments(mesh: &[[[f32; 3]; 3]]) -> (f64, [f64; 3], [f64; 3]) {
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
