//! Velocity, acceleration and jerk of the axes while the motion runs evenly.

use super::Conversion;

/// Of the order of the derivative: s, s², s³.
const FACTORIALS: [f64; 3] = [1.0, 2.0, 6.0];

/// What the axes do per second, its square and its cube.
pub(crate) struct Rates {
    /// From the first position to the last one.
    pub(crate) seconds: f64,
    /// For each position and axis velocity, acceleration and jerk, in mm or rad.
    pub(crate) rows: Vec<Vec<[f64; 3]>>,
}

impl Rates {
    /// At the positions of one motion, from their power series: exact but for rounding. `None` at a singular pose.
    ///
    /// # Errors
    /// In words, if the time is so short that they are no numbers.
    pub(crate) fn of_conversion(carried: &Conversion<'_, '_>, seconds: f64) -> Result<Option<Rates>, String> {
        let range = carried.source.ranges[0];
        let rate = (range.high - range.low) / seconds;
        let row = |(at, posture): (&Vec<f64>, &_)| -> Option<Vec<[f64; 3]>> {
            let series = carried.problem.series(posture, at, 0, FACTORIALS.len())?;
            let rates = |c: &Vec<f64>| {
                let order = |k: usize| FACTORIALS[k] * c[k + 1] * rate.powi(k as i32 + 1);
                std::array::from_fn(order)
            };
            Some(series[..carried.free.len()].iter().map(rates).collect())
        };
        let rows: Option<Vec<_>> = carried.positions.iter().zip(&carried.line).map(row).collect();
        let Some(rows) = rows else { return Ok(None) };
        if !rows.iter().flatten().flatten().all(|rate| rate.is_finite()) {
            return Err(format!(
                "in {seconds:e} s (option `time`) the axes would be faster than numbers go: say the seconds that the motion takes"
            ));
        }
        Ok(Some(Rates { seconds, rows }))
    }

    /// The largest velocity, acceleration and jerk of an axis, without sign.
    pub(crate) fn most(&self, axis: usize) -> [f64; 3] {
        let each = self.rows.iter().map(|row| row[axis].map(f64::abs));
        each.fold([0.0; 3], |most, of| std::array::from_fn(|k| f64::max(most[k], of[k])))
    }
}
