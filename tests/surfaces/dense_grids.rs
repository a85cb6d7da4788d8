//! The same points in a grid of many rows and columns and in one of few: how close its neighbours are changes nothing about a point.

use flank_solver::{Outcome, SurfacePoint};
use flank_tests::resampled::Resampled;

/// Rows and columns of the dense grid; of these each `STRIDE`th one is in the other grid, too.
const SIDE: usize = 151;
const STRIDE: usize = 15;
/// How far apart the same point may be, mm. All residuals are below 1e-11, and the points of the Hindley worm's wheel, which move farthest for
/// their residuals, lie up to 1e-9 mm apart. What is looked for are points of other branches, which are much farther away.
const SAME: f64 = 2e-9;

#[test]
fn a_point_is_what_it_is_in_a_grid_of_few() {
    let dense = Resampled::shipped(SIDE, |_| true);
    let few = Resampled::shipped((SIDE - 1) / STRIDE + 1, |_| true);
    let (mut compared, mut wrong, mut farthest) = (0, Vec::new(), 0.0_f64);
    for (dense, few) in dense.zip(few).filter(|(dense, few)| dense.counts == [SIDE; 2] && few.counts[0] > 1) {
        let solved = [&dense, &few].map(|grid| grid.solve(None).0);
        for k in 0..few.targets.len() {
            let (i, j) = (k / few.counts[1], k % few.counts[1]);
            let [one, other] = [solved[0].point(STRIDE * i * SIDE + STRIDE * j), solved[1].point(k)];
            compared += 1;
            let apart = apart(&one, &other);
            farthest = farthest.max(apart);
            if one.outcome.word() != other.outcome.word() || apart > SAME {
                let outcomes = [&one, &other].map(|point| point.outcome.word());
                wrong.push(format!("{} ({i}, {j}): {outcomes:?}, {apart:e} mm apart", dense.name));
            }
        }
    }
    println!("{compared} points, at most {farthest:e} mm apart");
    assert!(compared > 20_000, "{compared}");
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
}

/// How far two points are apart, of which both are solved.
fn apart(one: &SurfacePoint, other: &SurfacePoint) -> f64 {
    if [one, other].iter().any(|point| point.outcome != Outcome::Solved) {
        return 0.0;
    }
    one.position.iter().zip(other.position).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
