//! Measured points that do not go with the others.

use flank_export::fixed;
use flank_solver::{AdjustedSurfaces, LinearModel};

use super::fitting::{Fitting, GridLine};
use super::result::OutlyingPoint;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::units;

/// No machine measures to this, mm: what is nearer goes with the others.
const NEAR: f64 = 1e-5;
/// Where a smooth deviation beside what the settings do leaves less than this share of the variance, the settings alone predict too little.
const SMOOTH: f64 = 0.5;
/// So many degrees of freedom are left at the least for a smooth deviation to be told from noise.
const FREE: usize = 6;
/// Of so few points a line is told point by point.
const FEW: usize = 2;
/// Without what was found first, others may be found; so many times at the most.
const MOST_ROUNDS: usize = 4;

/// The points that do not go with the others, and what is left of these.
pub(super) struct Outliers {
    pub(super) points: Vec<OutlyingPoint>,
    /// A remark for each of them, or for a line of them.
    pub(super) remarks: Vec<Remark>,
    pub(super) others: Option<Others>,
}

/// The points that go together, fitted without those that do not.
pub(super) struct Others {
    pub(super) count: usize,
    pub(super) rank: usize,
    /// What is left where nothing but the motion is fitted, mm, root of the mean square.
    pub(super) before: f64,
    /// What the settings leave.
    pub(super) left: f64,
}

/// What predicts points from others.
struct Models {
    settings: LinearModel,
    /// Settings that have values, and a smooth deviation from them.
    smooth: LinearModel,
}

/// Points, by their places among all.
#[derive(Default)]
struct Found {
    points: Vec<usize>,
    /// Whether the others are predicted by a smooth deviation from what the settings do.
    is_smooth: bool,
}

impl Models {
    fn of(fitting: &Fitting<'_, '_>, settings: LinearModel, distances: &[f64]) -> Models {
        // what settings do that is not smooth is next to nothing, and much of it would make up for a point: they do not change with the shapes
        let smooth = LinearModel::new(distances).with(&fitting.problem.smooth(fitting.aims));
        Models { settings, smooth }
    }

    fn outlying(&self, lines: &[Vec<usize>]) -> Found {
        let found = if self.smooth.free() < FREE { Vec::new() } else { self.smooth.outlying(lines, NEAR) };
        let variance = |of: &LinearModel| of.without(&found).and_then(|rest| rest.variance());
        match (variance(&self.smooth), variance(&self.settings)) {
            (Some(smooth), Some(settings)) if smooth < SMOOTH * settings => Found { points: found, is_smooth: true },
            // what the settings explain they predict best
            _ => Found { points: self.settings.outlying(lines, NEAR), is_smooth: false },
        }
    }
}

impl Outliers {
    pub(super) fn none() -> Outliers {
        Outliers { points: Vec::new(), remarks: Vec::new(), others: None }
    }

    /// Of a measured flank that is fitted as a whole by settings that are free, or of which an order alone is.
    pub(super) fn of(
        fitting: &Fitting<'_, '_>,
        main: &AdjustedSurfaces,
        (free, is_part): (&[usize], bool),
    ) -> Outliers {
        let lines = fitting.lines();
        let sets: Vec<Vec<usize>> = lines.iter().map(|line| line.points.clone()).collect();
        let distances = main.distances();
        let (mut models, mut found, mut others);
        if is_part {
            // of what is not fitted nothing is known but that it is smooth
            models = Models::of(fitting, LinearModel::new(&distances), &distances);
            found = Found { points: models.smooth.outlying(&sets, NEAR), is_smooth: true };
            others = None;
        } else {
            models = Models::of(fitting, main.fit.linear_model(), &distances);
            (found, others) = (models.outlying(&sets), None);
            for _ in 0..MOST_ROUNDS {
                let Some((again, rest)) = without(fitting, &found.points, free) else { break };
                let next = again.outlying(&sets);
                let is_same = next.points == found.points;
                (models, found, others) = (again, next, Some(rest).filter(|_| is_same));
                if is_same {
                    break;
                }
            }
        }
        let model = if found.is_smooth { &models.smooth } else { &models.settings };
        let Some(rest) = model.without(&found.points).filter(|_| !found.points.is_empty()) else {
            return Outliers::none();
        };
        let told = |&row: &usize| {
            let of = |line: &&GridLine| line.points.contains(&row);
            let mut both = lines.iter().filter(of).map(|line| line.at + 1);
            let [row_at, column] = [both.next(), both.next()].map(|at| at.expect("it lies in a row and in a column"));
            let (off, deviation) = rest.off(row);
            let surface = lines.iter().find(of).map_or(0, |line| line.surface);
            let surface = fitting.aims[surface].of.surface.name.clone();
            OutlyingPoint { surface, row: row_at, column, off_um: 1e3 * off, sigmas: off.abs() / deviation }
        };
        let points: Vec<OutlyingPoint> = found.points.iter().map(told).collect();
        let remarks = remarks(fitting, (&found, &points), &lines);
        Outliers { points, remarks, others }
    }
}

/// The fit without some points, with what it predicts of them. `None` if there are none, or too few are left.
fn without(fitting: &Fitting<'_, '_>, points: &[usize], free: &[usize]) -> Option<(Models, Others)> {
    let problem = fitting.problem;
    let [before, left] = (!points.is_empty()).then(|| problem.without(fitting.now, (points, free)))??;
    let all = problem.all_at(&left)?;
    let distances = all.distances();
    let settings = LinearModel::new(&distances).with(&problem.directions(&left, &all));
    let others =
        Others { count: left.fit.residuals.len(), rank: left.fit.rank(), before: before.rms(), left: left.rms() };
    Some((Models::of(fitting, settings, &distances), others))
}

/// Lines all of whose points are among them are told as such, then those that are left.
fn remarks(fitting: &Fitting<'_, '_>, (found, points): (&Found, &[OutlyingPoint]), lines: &[GridLine]) -> Vec<Remark> {
    let by = if found.is_smooth { ", of a deviation that is smooth beside what the settings do" } else { "" };
    let remark = |surface: &str, which: String, off: String, sigmas: String, [it, its]: [&str; 2]| {
        let message = format!(
            "{which} of {surface} lies {off} um off what the others predict{by}, {sigmas} standard deviations; {it} as all do: leave {its} \
             numbers empty if it was measured wrong"
        );
        Remark::new(RemarkKind::Outlier, surface, message)
    };
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut remarks = Vec::new();
    for line in lines.iter().filter(|line| line.points.len() > FEW) {
        let of: Vec<usize> = left.iter().copied().filter(|k| line.points.contains(&found.points[*k])).collect();
        if of.len() < line.points.len() {
            continue;
        }
        left.retain(|k| !of.contains(k));
        let least =
            |value: &dyn Fn(&OutlyingPoint) -> f64| of.iter().map(|k| value(&points[*k])).fold(f64::INFINITY, f64::min);
        let (low, high) = (least(&|of| of.off_um), -least(&|of| -of.off_um));
        let name = if line.is_row { "row" } else { "column" };
        let which = format!("{name} {}, {},", line.at + 1, units::counted(of.len(), "point"));
        let off = format!("{} .. {}", fixed(low, 3), fixed(high, 3));
        let sigmas = format!("at least {}", fixed(least(&|of| of.sigmas), 1));
        remarks.push(remark(
            &fitting.aims[line.surface].of.surface.name,
            which,
            off,
            sigmas,
            ["its points count", "their"],
        ));
    }
    remarks.extend(left.into_iter().map(|k| {
        let OutlyingPoint { surface, row, column, off_um, sigmas } = &points[k];
        let [off, sigmas] = [fixed(*off_um, 3), fixed(*sigmas, 1)];
        remark(surface, format!("row {row}, column {column}"), off, sigmas, ["it counts", "its"])
    }));
    remarks
}
