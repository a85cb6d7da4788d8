//! Whether measured points lie beside their places as those of a gear do that is mounted or scaled otherwise.

use flank_solver::{Outcome, SurfacePoint};

use crate::compare::gauged::Gauged;

/// Points that lie beside their places by less than this, mm, root of the mean square, were probed so.
const BESIDE: f64 = 0.01;
/// What leaves less than this share of it explains it.
const EXPLAINED: f64 = 0.3;

/// What moves all points of a gear.
struct Cause {
    /// Of the radius and the height of a point, per unit: what it moves them by.
    moves: fn([f64; 2]) -> [f64; 2],
    /// What all points look as if they were, and what is to be asked.
    words: fn(f64) -> [String; 2],
}

const CAUSES: [Cause; 3] = [
    Cause {
        moves: |_| [0.0, 1.0],
        words: |by| {
            [
                format!("shifted by {by:.4} mm along z"),
                "does z = 0 of the measurement lie where it does in the spec?".to_string(),
            ]
        },
    },
    Cause {
        moves: |_| [1.0, 0.0],
        words: |by| {
            [
                format!("shifted by {by:.4} mm away from the axis"),
                "is the axis of the measurement that of the gear?".to_string(),
            ]
        },
    },
    Cause {
        moves: |at| at,
        words: |by| {
            [
                format!("{:.6} times as far from the origin", 1.0 + by),
                "are x, y and z in mm, and as they were measured?".to_string(),
            ]
        },
    },
];

/// A point beside its place.
struct Beside {
    /// Radius and height of its place.
    place: [f64; 2],
    /// The direction along the flank in the plane of both.
    along: [f64; 2],
    /// How far it lies off along that, mm.
    off: f64,
}

impl Gauged {
    /// Points lie where the surface was found along normals, or at the radii and heights of their places. Where they do neither, and one
    /// cause moves all of them: what they look as if, in words. Settings would make up for it.
    pub(super) fn mounted(&self) -> Option<String> {
        let pairs = self.positions.iter().zip(&self.nominal);
        let all: Vec<Beside> = pairs.filter_map(|(at, of)| Beside::of((*at)?, of)).collect();
        let rms = |of: &dyn Fn(&Beside) -> f64| {
            (all.iter().map(|one| of(one).powi(2)).sum::<f64>() / all.len().max(1) as f64).sqrt()
        };
        let beside = rms(&|of| of.off);
        if beside < BESIDE {
            return None;
        }
        let fitted = CAUSES.iter().map(|cause| {
            let effect = |of: &Beside| dot((cause.moves)(of.place), of.along);
            let squares: f64 = all.iter().map(|of| effect(of).powi(2)).sum();
            let by = all.iter().map(|of| effect(of) * of.off).sum::<f64>() / squares;
            (rms(&|of| of.off - by * effect(of)), by, cause)
        });
        let (left, by, cause) = fitted.filter(|of| of.0.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let [as_if, question] = (cause.words)(by);
        (left < EXPLAINED * beside).then(|| {
            format!(
                "the points lie {beside:.4} mm beside their places, along the flank, as if all were {as_if}; settings make up for some of that: \
                 {question}"
            )
        })
    }
}

impl Beside {
    /// A turn about z, and what lies along the normal, do not change that.
    fn of(at: [f64; 3], nominal: &SurfacePoint) -> Option<Beside> {
        let SurfacePoint { outcome: Outcome::Solved, position: [x, y, z], normal: [nx, ny, nz], .. } = *nominal else {
            return None;
        };
        let radius = x.hypot(y);
        let outwards = (x * nx + y * ny) / radius;
        let length = outwards.hypot(nz);
        let along = [-nz / length, outwards / length];
        let off = dot([at[0].hypot(at[1]) - radius, at[2] - z], along);
        off.is_finite().then_some(Beside { place: [radius, z], along, off })
    }
}

fn dot([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * c + b * d
}
