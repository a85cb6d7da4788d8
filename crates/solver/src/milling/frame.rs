//! A surface at a point with its steps along two coordinates.

use flank_expr::{Expr, InstructionSet, LANES, LaneEvaluator, LaneTape, Tape, TapeError};

use crate::surface::bound::BoundSurface;

/// A pivot below this share of its row is none.
const NO_PIVOT: f64 = 1e-12;

/// Position, normal and their derivatives by two coordinates, at solved points of a surface.
#[derive(Clone, Debug)]
pub struct SurfaceFrames {
    unknowns: usize,
    tape: LaneTape,
}

/// A point of a surface, in the surface's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFrame {
    /// mm.
    pub position: [f64; 3],
    /// Unit vector out of the body.
    pub normal: [f64; 3],
    /// How the position changes with each coordinate, mm per mm or radian.
    pub steps: [[f64; 3]; 2],
    /// How the normal changes with each coordinate.
    pub turns: [[f64; 3]; 2],
}

impl SurfaceFrames {
    /// Of a surface whose points are asked for by two functions of its unknowns.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn new<'g>(surface: &BoundSurface<'g>, coordinates: [Expr<'g>; 2]) -> Result<SurfaceFrames, TapeError> {
        let coordinates = surface.with_values(&coordinates);
        let surface = surface.surface();
        let p = &surface.unknowns;
        assert_eq!(p.len(), surface.constraints.len() + 2, "a surface has two unknowns more than constraints");
        let point: Vec<Expr<'g>> = surface.position.0.into_iter().chain(surface.normal.0).collect();
        let equations = surface.constraints.iter().copied().chain(coordinates);
        let slopes = equations.chain(point.iter().copied()).flat_map(|f| p.iter().map(move |p| f.derivative(*p)));
        let outputs: Vec<Expr<'g>> = point.iter().copied().chain(slopes).collect();
        Ok(SurfaceFrames { unknowns: p.len(), tape: LaneTape::new(&Tape::new(&outputs, p)?) })
    }

    /// At many points of the surface, given by their unknowns; `None` where the coordinates do not fix a point.
    ///
    /// # Panics
    /// If there is not one number for each unknown.
    pub fn at<'u>(&self, points: impl Iterator<Item = &'u [f64]>) -> Vec<Option<SurfaceFrame>> {
        let mut evaluator = LaneEvaluator::new(&self.tape, InstructionSet::widest());
        let mut out = vec![0.0; self.tape.output_count()];
        let (mut scratch, mut found) = (Scratch::new(self.unknowns), Vec::new());
        let (mut points, mut waiting) = (points.peekable(), 0);
        while let Some(unknowns) = points.next() {
            unknowns.iter().enumerate().for_each(|(k, value)| evaluator.input(k)[waiting] = *value);
            waiting += 1;
            if waiting < LANES && points.peek().is_some() {
                continue;
            }
            evaluator.run_first(waiting);
            for lane in 0..waiting {
                out.iter_mut().enumerate().for_each(|(k, out)| *out = evaluator.output(k)[lane]);
                found.push(self.frame(&out, &mut scratch));
            }
            waiting = 0;
        }
        found
    }

    fn frame(&self, out: &[f64], scratch: &mut Scratch) -> Option<SurfaceFrame> {
        let count = self.unknowns;
        let (matrix, slopes) = out[6..].split_at(count * count);
        // the unknowns follow each coordinate while the constraints hold
        scratch.matrix.copy_from_slice(matrix);
        for (row, right) in scratch.right.iter_mut().enumerate() {
            *right = [count - 2, count - 1].map(|which| if row == which { 1.0 } else { 0.0 });
        }
        scratch.solve()?;
        let followed = &scratch.right;
        let along = |from: usize| {
            [0, 1].map(|which| {
                let part = |k: usize| -> f64 {
                    let row = &slopes[(from + k) * count..][..count];
                    row.iter().zip(followed).map(|(slope, rates)| slope * rates[which]).sum()
                };
                [part(0), part(1), part(2)]
            })
        };
        let frame = SurfaceFrame {
            position: [out[0], out[1], out[2]],
            normal: [out[3], out[4], out[5]],
            steps: along(0),
            turns: along(3),
        };
        let is_finite = frame.steps.iter().chain(&frame.turns).flatten().all(|number| number.is_finite());
        is_finite.then_some(frame)
    }
}

impl SurfaceFrame {
    /// The same in other coordinates: of each of these, how the old ones change with it.
    #[must_use]
    pub fn by(&self, rates: [[f64; 2]; 2]) -> SurfaceFrame {
        let mixed = |old: [[f64; 3]; 2]| rates.map(|[a, b]| [0, 1, 2].map(|k| a * old[0][k] + b * old[1][k]));
        SurfaceFrame { steps: mixed(self.steps), turns: mixed(self.turns), ..*self }
    }
}

/// A square system, row by row, with two right sides.
struct Scratch {
    matrix: Vec<f64>,
    right: Vec<[f64; 2]>,
    scale: Vec<f64>,
}

impl Scratch {
    fn new(count: usize) -> Scratch {
        Scratch { matrix: vec![0.0; count * count], right: vec![[0.0; 2]; count], scale: vec![0.0; count] }
    }

    /// Puts the solutions in the place of the right sides, by elimination with row pivots; `None` without a pivot.
    fn solve(&mut self) -> Option<()> {
        let Scratch { matrix, right, scale } = self;
        let count = right.len();
        for (row, scale) in matrix.chunks(count).zip(scale.iter_mut()) {
            *scale = row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        }
        for k in 0..count {
            let weight = |row: usize| matrix[row * count + k].abs() / scale[row];
            let pivot = (k..count).max_by(|a, b| weight(*a).total_cmp(&weight(*b)))?;
            // a NaN is no pivot
            let is_pivot = weight(pivot) > NO_PIVOT;
            if !is_pivot {
                return None;
            }
            if pivot != k {
                (0..count).for_each(|j| matrix.swap(k * count + j, pivot * count + j));
                right.swap(k, pivot);
                scale.swap(k, pivot);
            }
            for row in k + 1..count {
                let factor = matrix[row * count + k] / matrix[k * count + k];
                (k..count).for_each(|j| matrix[row * count + j] -= factor * matrix[k * count + j]);
                let [a, b] = right[k];
                right[row] = [right[row][0] - factor * a, right[row][1] - factor * b];
            }
        }
        for k in (0..count).rev() {
            let sum = |which: usize| -> f64 { (k + 1..count).map(|j| matrix[k * count + j] * right[j][which]).sum() };
            let sums = [sum(0), sum(1)];
            right[k] = [0, 1].map(|which| (right[k][which] - sums[which]) / matrix[k * count + k]);
        }
        Some(())
    }
}
