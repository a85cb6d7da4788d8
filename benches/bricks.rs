//! Bodies as bricks for finite elements: 100,000 of them on polynomials of the size that spiral bevel flanks take.

use std::f64::consts::TAU;

use divan::{Bencher, black_box};
use flank_solver::{Arrangement, Blank, Body, BrickCounts, BrickOrder, Chart, Outline, OutlineSegment};

const TEETH: u32 = 24;
/// Rows and columns of the polynomials.
const POINTS: [usize; 2] = [17, 17];
const TIP: f64 = 39.0;
const ROOT: f64 = 32.0;

fn main() {
    divan::main();
}

/// The angle of a flank from the middle of its space at a distance from the axis, from 32 to 39 mm.
fn half_angle(rho: f64) -> f64 {
    TAU / f64::from(TEETH) * (0.14 + 0.03 * (rho - ROOT))
}

/// Across flank, root and flank, and turned along the tooth.
fn place(chart: usize, across: f64, along: f64) -> [f64; 3] {
    let (rho, angle) = match chart {
        0 => (TIP + across * (ROOT - TIP), -half_angle(TIP + across * (ROOT - TIP))),
        1 => (ROOT, (2.0 * across - 1.0) * half_angle(ROOT)),
        _ => (ROOT + across * (TIP - ROOT), half_angle(ROOT + across * (TIP - ROOT))),
    };
    let turned = angle + 0.2 * along;
    [rho * turned.cos(), rho * turned.sin(), 20.0 * (1.0 - along)]
}

fn body() -> Body {
    let corners = [[20.0, TIP], [0.0, TIP], [0.0, 20.0], [20.0, 20.0]];
    let names = ["tip", "front", "bore", "back"];
    let segment = |k: usize| OutlineSegment {
        name: names[k].to_string(),
        from: corners[k],
        to: corners[(k + 1) % 4],
        center: None,
    };
    let outline = Outline::new((0..4).map(segment).collect());
    // with the material on the left, spaces begin at the back, where the share along is 0
    let blank = Blank { outline, ends: [3, 0, 1] };
    let chart = |k: usize| {
        let points = Chart::shares(POINTS[0])
            .into_iter()
            .flat_map(|u| Chart::shares(POINTS[1]).into_iter().map(move |w| place(k, u, w)))
            .collect();
        Chart::through(points, POINTS)
    };
    Body::new(blank, (Arrangement::Round, TEETH), vec![(0..3).map(chart).collect()], false).expect("a body")
}

/// Three teeth of 34,000 bricks each.
fn hundred_thousand(body: &Body) -> BrickCounts {
    let counts = body.brick_counts([24, 24, 18]);
    let [of_layers, _] = BrickCounts { along: 1, ..counts.clone() }.size(body, BrickOrder::First, 3);
    BrickCounts { along: 100_000_usize.div_ceil(of_layers), ..counts }
}

#[divan::bench(args = [BrickOrder::First, BrickOrder::Second])]
fn three_teeth_of_100_000_bricks(bencher: Bencher, order: BrickOrder) {
    let body = body();
    let counts = hundred_thousand(&body);
    bencher.bench_local(|| {
        let mesh = black_box(&body).bricks(&counts, order, 3);
        assert!(mesh.len() >= 100_000);
        mesh
    });
}

#[divan::bench(args = [BrickOrder::First, BrickOrder::Second])]
fn volume_and_jacobians_of_100_000_bricks(bencher: Bencher, order: BrickOrder) {
    let body = body();
    let mesh = body.bricks(&hundred_thousand(&body), order, 3);
    bencher.bench_local(|| black_box(&mesh).quality());
}
