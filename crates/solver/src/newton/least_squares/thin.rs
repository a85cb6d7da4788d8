//! Singular values of matrices of few columns: Householder's reflections make a square of them, Jacobi's rotations turn its columns until they
//! are square to each other. So small values are as exact as large ones, and nothing is set up that only large matrices repay.

use faer::Mat;

/// Columns are square to each other where their product is less than this share of their lengths'.
const SQUARE: f64 = 4.0 * f64::EPSILON;
/// Rounds over all pairs of columns at the most; some eight do.
const MOST_ROUNDS: usize = 60;

/// Of a matrix with at least as many rows as columns.
pub(super) struct ThinSvd {
    /// A column for each singular value; zeros where that is zero.
    pub(super) left: Mat<f64>,
    /// Falling.
    pub(super) sizes: Vec<f64>,
    pub(super) right: Mat<f64>,
}

impl ThinSvd {
    pub(super) fn new(of: &Mat<f64>) -> ThinSvd {
        let (rows, count) = (of.nrows(), of.ncols());
        let Reflected { reflectors, mut square } = Reflected::new(of);
        let mut turned: Vec<Vec<f64>> = (0..count).map(|k| unit(count, k)).collect();
        for _ in 0..MOST_ROUNDS {
            if !turned_once(&mut square, &mut turned) {
                break;
            }
        }
        let sizes: Vec<f64> = square.iter().map(|of| dot(of, of).sqrt()).collect();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        let mut left = Mat::zeros(rows, count);
        let mut right = Mat::zeros(count, count);
        for (k, from) in order.iter().copied().enumerate() {
            right.col_as_slice_mut(k).copy_from_slice(&turned[from]);
            if sizes[from] > 0.0 {
                let own = left.col_as_slice_mut(k);
                own.iter_mut().zip(&square[from]).for_each(|(own, x)| *own = x / sizes[from]);
                reflectors.iter().enumerate().rev().for_each(|(at, by)| reflect(&mut own[at..], by));
            }
        }
        ThinSvd { left, sizes: order.iter().map(|k| sizes[*k]).collect(), right }
    }
}

/// A matrix as reflections of a square one above zeros.
struct Reflected {
    /// What the rows from one on are reflected by, with the square of its length halved.
    reflectors: Vec<(Vec<f64>, f64)>,
    /// By columns; zero below the diagonal.
    square: Vec<Vec<f64>>,
}

impl Reflected {
    fn new(of: &Mat<f64>) -> Reflected {
        let count = of.ncols();
        let mut columns: Vec<Vec<f64>> = (0..count).map(|k| of.col_as_slice(k).to_vec()).collect();
        let mut reflectors = Vec::with_capacity(count);
        for at in 0..count {
            let mut by = columns[at][at..].to_vec();
            let length = dot(&by, &by).sqrt();
            // away from zero, so that nothing cancels
            by[0] += if by[0] < 0.0 { -length } else { length };
            let half = 0.5 * dot(&by, &by);
            let by = (by, half);
            columns[at..].iter_mut().for_each(|column| reflect(&mut column[at..], &by));
            reflectors.push(by);
        }
        let above = |(k, mut column): (usize, Vec<f64>)| {
            column.truncate(count);
            column[k + 1..].fill(0.0);
            column
        };
        Reflected { reflectors, square: columns.into_iter().enumerate().map(above).collect() }
    }
}

fn reflect(of: &mut [f64], (by, half): &(Vec<f64>, f64)) {
    if *half > 0.0 {
        let share = dot(of, by) / half;
        of.iter_mut().zip(by).for_each(|(x, by)| *x -= share * by);
    }
}

/// Turns each pair of columns square to each other, and the columns of another matrix alike; tells whether any was turned.
fn turned_once(columns: &mut [Vec<f64>], with: &mut [Vec<f64>]) -> bool {
    let mut is_turned = false;
    for q in 1..columns.len() {
        for p in 0..q {
            let [pp, qq, pq] = [(p, p), (q, q), (p, q)].map(|(a, b)| dot(&columns[a], &columns[b]));
            if pq.abs() <= SQUARE * (pp * qq).sqrt() {
                continue;
            }
            is_turned = true;
            let ratio = (qq - pp) / (2.0 * pq);
            let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            turn(columns, [p, q], [cosine, cosine * tangent]);
            turn(with, [p, q], [cosine, cosine * tangent]);
        }
    }
    is_turned
}

fn turn(columns: &mut [Vec<f64>], [p, q]: [usize; 2], [cosine, sine]: [f64; 2]) {
    let (before, from_q) = columns.split_at_mut(q);
    for (a, b) in before[p].iter_mut().zip(&mut from_q[0]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

fn unit(count: usize, at: usize) -> Vec<f64> {
    (0..count).map(|k| f64::from(k == at)).collect()
}

/// In four sums, which run beside each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (fours, rest) = a.as_chunks::<4>();
    let (of_fours, of_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in fours.iter().zip(of_fours) {
        (0..4).for_each(|k| sums[k] += a[k] * b[k]);
    }
    let last: f64 = rest.iter().zip(of_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + last
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(of: &Mat<f64>) -> f64 {
        of.col_iter().flat_map(|of| of.iter().map(|x| x.abs()).collect::<Vec<f64>>()).fold(0.0, f64::max)
    }

    #[test]
    fn small_values_are_exact_and_factors_make_the_matrix() {
        // columns of sizes from 1 to 1e-9, one a sum of two others, one of zeros
        let value = |row: usize, k: usize| ((row * 7 + k * 13 + row * k * 3) % 17) as f64 - 8.0;
        let of = |row: usize, k: usize| match k {
            3 => value(row, 0) + 1e-3 * value(row, 1),
            4 => 0.0,
            _ => 10f64.powi(-3 * k as i32) * value(row, k),
        };
        let matrix = Mat::from_fn(45, 5, of);
        let ThinSvd { left, sizes, right } = ThinSvd::new(&matrix);
        assert!(sizes.windows(2).all(|pair| pair[0] >= pair[1]), "{sizes:?}");
        assert!(sizes[2] > 1e-6 && sizes[3] < 1e-12 && sizes[4] == 0.0, "{sizes:?}");
        let made = Mat::from_fn(45, 5, |row, k| (0..5).map(|j| left[(row, j)] * sizes[j] * right[(k, j)]).sum::<f64>());
        assert!(largest(&(&made - &matrix)) < 1e-13 * sizes[0]);
        let apart = right.transpose() * &right - Mat::<f64>::identity(5, 5);
        assert!(largest(&apart) < 1e-14, "{apart:?}");
        let used = Mat::from_fn(45, 3, |row, k| left[(row, k)]);
        let apart = used.transpose() * &used - Mat::<f64>::identity(3, 3);
        assert!(largest(&apart) < 1e-14, "{apart:?}");
    }
}
