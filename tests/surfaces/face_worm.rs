//! Face gears of helicon and spiroid worms, against the closed form of the angle at which a point of the worm's thread is in mesh.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flank_expr::Graph;
use flank_tests::{assert_point, grid, job_named, turned};

const SPEC: &str = "specs/face_worm/helicon_wheel.chain";

/// Threads and teeth, centre distance, position and radius of the worm, its taper.
struct Drive {
    starts: f64,
    teeth: f64,
    distance: f64,
    position: f64,
    radius: f64,
    taper: f64,
}

impl Drive {
    fn axial_pitch(&self) -> f64 {
        TAU * self.distance / (self.teeth - self.starts * self.position / self.radius)
    }

    /// Point and normal out of the thread of a right-hand worm. Side -1 faces the small end.
    fn worm(&self, side: f64, u: f64, tau: f64) -> ([f64; 3], [f64; 3]) {
        let slope = if side > 0.0 { 30.0_f64 } else { 10.0 }.to_radians().tan();
        let (lead, taper) = (self.starts * self.axial_pitch() / TAU, self.taper.tan());
        let pitch_z = lead * tau + side * self.axial_pitch() / 4.0;
        let (rho, z) = (self.radius + pitch_z * taper + u, pitch_z - side * u * slope);
        // along the flank's line, and along the thread: in directions of radius, polar angle and axis
        let [across, along] = [[1.0, 0.0, -side * slope], [lead * taper, rho, lead]];
        let normal = [
            across[1] * along[2] - across[2] * along[1],
            across[2] * along[0] - across[0] * along[2],
            across[0] * along[1] - across[1] * along[0],
        ];
        let size = side * normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        (turned([rho, 0.0, z], tau), turned(normal.map(|x| x / size), tau))
    }

    /// Position and normal of the wheel where that point is in mesh, on the side of the wheel.
    ///
    /// When the worm has turned by φ, the velocity of its point along the normal is n·(z × r), that of the wheel, which turns backwards about
    /// y, −i (n_x Z − n_z X) with X and Z from the wheel's axis. Equal they are where A cos φ − B sin φ = −C.
    fn wheel(&self, side: f64, u: f64, tau: f64) -> ([f64; 3], [f64; 3]) {
        let ([x, y, z], [nx, ny, nz]) = self.worm(side, u, tau);
        let ratio = self.starts / self.teeth;
        let a = ratio * (nx * (z + self.position) - nz * x);
        let b = ratio * (ny * (z + self.position) - nz * y);
        let c = ratio * nz * self.distance + ny * x - nx * y;
        let (middle, apart) = ((-b).atan2(a), (-c / a.hypot(b)).acos());
        let is_over_wheel = |turn: &f64| (turn + tau).rem_euclid(TAU) < PI;
        let nearest = |turn: f64| turn - ((turn + tau - FRAC_PI_2) / TAU).round() * TAU;
        let turn = [middle + apart, middle - apart].map(nearest).into_iter().find(is_over_wheel).expect("in mesh");
        let on_wheel = |[x, y, z]: [f64; 3]| turned([x, z, -y], -ratio * turn);
        let [x, y, z] = turned([x, y, z], turn);
        let normal = turned([nx, ny, nz], turn);
        (on_wheel([x - self.distance, y, z + self.position]), on_wheel(normal.map(|part| -part)))
    }
}

#[test]
fn threads_are_in_mesh_at_the_angle_of_the_closed_form() {
    let helicon = |taper: f64| Drive { starts: 1.0, teeth: 47.0, distance: 40.0, position: 60.0, radius: 15.0, taper };
    let larger = Drive { starts: 2.0, teeth: 61.0, distance: 50.0, position: 70.0, radius: 18.0, taper: 0.0 };
    let set = [
        ("starts", "2"),
        ("teeth", "61"),
        ("centre_distance", "50 mm"),
        ("worm_position", "70 mm"),
        ("worm_radius", "18 mm"),
    ];
    let drives = [
        ("helicon_wheel", helicon(0.0), &[][..]),
        ("spiroid_wheel", helicon(5.0_f64.to_radians()), &[]),
        ("helicon_wheel", larger, &set),
    ];
    for (name, drive, set) in drives {
        let graph = Graph::new();
        let job = job_named(&graph, SPEC, name, set);
        for (surface, side) in [("small_end", -1.0), ("large_end", 1.0)] {
            let heights = [-0.8, -0.3, 0.0, 0.4, 0.9].map(|share| share * 0.25 * drive.axial_pitch());
            let turns: Vec<f64> = (-6..=6).map(|k| f64::from(k) * 0.5).collect();
            let targets: Vec<[f64; 2]> =
                heights.iter().flat_map(|height| turns.iter().map(|turn| [*height, *turn])).collect();
            let solved = grid(&job, surface, ["u", "tau"], &targets, turns.len());
            for ([u, tau], point) in targets.iter().zip(&solved) {
                let (position, normal) = drive.wheel(side, *u, *tau);
                assert_point(point, position, normal, &format!("{name} {surface} at {u} mm, {tau} rad"));
            }
        }
    }
}
