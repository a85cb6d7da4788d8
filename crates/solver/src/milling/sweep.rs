//! What all ways of a cutter together leave over a point of a surface.

use crate::milling::deep::deepest;
use crate::milling::distance::{Shape, ToolBody};
use crate::milling::height::{NormalLine, lowest};
use crate::milling::outline::{Cutter, OutlinePiece};
use crate::milling::series::PoseSeries;

/// Values through which a piece of a pass is known.
const NODES: usize = 13;
/// Pieces of a pass at the least: short ones reach less far.
const PIECES: usize = 32;
/// How much farther than the ends of a piece its middle part may lie from the middle: pieces bend little.
const BENT: f64 = 1.25;

/// A point that lies deeper than this within the cutter, mm, is cut deep, and its height is looked for over the whole way ...
const DEEP: f64 = 2e-3;
/// ... of which that is tried at places so far apart, as a share of the radius of the ball about the cutter; at the least and at the most at so many.
const TRIED: f64 = 0.25;
const TRIES: [usize; 2] = [9, 1000];
/// How far a shank is thought to go on above the outline, as a share of its radius there.
const SHANK: f64 = 2.0;
/// A height by steps is no news where it is lower by less than this, mm.
const LOWER: f64 = 1e-7;

/// A cutter on many ways. What it leaves over a point is the least of the heights at which it passes on any of them.
#[derive(Clone, Debug)]
pub struct SweptCutter {
    ways: Vec<Way>,
    cutter: Cutter,
    body: Shape,
    ball: Ball,
}

/// A ball about the axis that holds the outline.
#[derive(Clone, Copy, Debug)]
struct Ball {
    /// Its centre's height above the origin of the tool, mm.
    z: f64,
    radius: f64,
}

/// A short way.
#[derive(Clone, Debug)]
struct Way {
    series: PoseSeries,
    middle: [f64; 6],
    /// No point of the outline moves farther from where it is in the middle, mm.
    reach: f64,
    number: usize,
}

/// What is left over a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOver {
    /// The least height, mm; negative where the cutter cuts into the surface.
    pub height: f64,
    /// The number of the way on which the cutter leaves it.
    pub way: usize,
}

impl SweptCutter {
    /// Of ways that are short, as straight blocks are: each is passed by the cutter once.
    pub fn of_blocks(blocks: Vec<PoseSeries>, cutter: &Cutter) -> SweptCutter {
        SweptCutter::new(blocks.into_iter().enumerate().collect(), cutter)
    }

    /// Of whole passes.
    pub fn of_passes(passes: &[PoseSeries], cutter: &Cutter) -> SweptCutter {
        let of_pass = |(number, pass): (usize, &PoseSeries)| {
            // as many as the pass has values: a piece is then known more exactly than the pass
            let pieces = PIECES.max(pass.values());
            let place = move |k: usize, share: f64| (k as f64 + share) / pieces as f64;
            let piece = |k: usize| PoseSeries::sampled(NODES, |share| pass.at(place(k, share)));
            (0..pieces).map(|k| (number, piece(k))).collect::<Vec<_>>()
        };
        SweptCutter::new(passes.iter().enumerate().flat_map(of_pass).collect(), cutter)
    }

    fn new(ways: Vec<(usize, PoseSeries)>, cutter: &Cutter) -> SweptCutter {
        let body = body(&cutter.pieces);
        let ball = Ball::around(&body.pieces);
        let way = |(number, series): (usize, PoseSeries)| {
            let middle = series.at(0.5);
            let moved = |share: f64| ball.moved(&middle, &series.at(share));
            let reach = BENT * moved(0.0).max(moved(1.0));
            Way { middle, reach, number, series }
        };
        SweptCutter { ways: ways.into_iter().map(way).collect(), cutter: cutter.clone(), body: body.shape(), ball }
    }

    /// What is left over a point along its normal; `None` if the cutter passes it on no way.
    ///
    /// A way leaves no less than the distance of the point from the cutter in its middle, less how far the cutter moves from there. So ways
    /// are tried in the order of that bound until it is above the least height found.
    pub fn left(&self, line: &NormalLine) -> Option<LeftOver> {
        let point = [line[0], line[1], line[2]];
        let far: Vec<f64> = self.ways.iter().map(|way| self.ball.distance(&way.middle, point) - way.reach).collect();
        let nearest = (0..far.len()).min_by(|a, b| far[*a].total_cmp(&far[*b]))?;
        let mut best = self.lowest_on(nearest, line);
        // a cutter as far away as it is wide does not pass
        let limit = |best: Option<LeftOver>| best.map_or(2.0 * self.ball.radius, |best| best.height.max(0.0));
        let bound = |k: usize| self.body.distance(&self.ways[k].middle, point) - self.ways[k].reach;
        let near = (0..far.len()).filter(|k| *k != nearest && far[*k] <= limit(best));
        let mut near: Vec<(f64, usize)> = near.map(|k| (bound(k), k)).collect();
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (bound, k) in near {
            if bound > limit(best) {
                break;
            }
            let found = self.lowest_on(k, line);
            best = match (best, found) {
                (Some(best), Some(found)) if found.height >= best.height => Some(best),
                (best, found) => found.or(best),
            };
        }
        best
    }

    fn lowest_on(&self, k: usize, line: &NormalLine) -> Option<LeftOver> {
        let way = &self.ways[k];
        let near = lowest(&way.series, &self.cutter, line, 0.5).map(|found| found.height);
        let point = [line[0], line[1], line[2]];
        let tries = ((2.0 * way.reach / (TRIED * self.ball.radius)) as usize).clamp(TRIES[0], TRIES[1]);
        let is_within = |k: usize| {
            let pose = way.series.at(k as f64 / (tries - 1) as f64);
            self.body.distance(&pose, point) < -DEEP
        };
        let deep = if (0..tries).any(is_within) { deepest(&way.series, &self.cutter, line, 4 * tries) } else { None };
        let deep = deep.map(|(height, _)| height).filter(|height| near.is_none_or(|near| *height < near - LOWER));
        deep.or(near).map(|height| LeftOver { height, way: way.number })
    }
}

/// What lies within the pieces: an edge has its bottom, and above all of them a shank goes on.
fn body(pieces: &[OutlinePiece]) -> ToolBody {
    let of = |piece: &OutlinePiece| match *piece {
        OutlinePiece::Arc { center: [rho, z], radius: 0.0, .. } => {
            vec![OutlinePiece::Line { from: [0.0, z], to: [rho, z] }]
        }
        piece => vec![piece],
    };
    let upper = |piece: &OutlinePiece| match *piece {
        OutlinePiece::Line { from, to } => {
            if to[1] < from[1] {
                from
            } else {
                to
            }
        }
        OutlinePiece::Arc { center, radius, between: [_, end] } => {
            [center[0] + radius * end.sin(), center[1] - radius * end.cos()]
        }
    };
    let end = pieces.iter().map(upper).max_by(|a, b| a[1].total_cmp(&b[1]));
    let shank = end.map(|[rho, z]| OutlinePiece::Line { from: [rho, z], to: [rho, z + SHANK * rho] });
    ToolBody { pieces: pieces.iter().flat_map(of).chain(shank).collect() }
}

impl Ball {
    fn around(pieces: &[OutlinePiece]) -> Ball {
        let ends = pieces.iter().flat_map(|piece| match *piece {
            OutlinePiece::Line { from, to } => vec![from, to],
            OutlinePiece::Arc { center, radius, between: [a, b] } => {
                let at = |angle: f64| [center[0] + radius * angle.sin(), center[1] - radius * angle.cos()];
                (0..=16).map(|k| at(a + (b - a) * f64::from(k) / 16.0)).collect()
            }
        });
        let ends: Vec<[f64; 2]> = ends.collect();
        let (low, high) =
            ends.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at[1]), high.max(at[1])));
        // the centre of a ball is the best there is; of what is flat and wide it lies in its middle
        let centres = pieces.iter().filter_map(|piece| match *piece {
            OutlinePiece::Arc { center: [0.0, z], .. } => Some(z),
            _ => None,
        });
        let of = |z: f64| Ball { z, radius: ends.iter().map(|at| at[0].hypot(at[1] - z)).fold(0.0, f64::max) };
        let all = centres.chain([0.5 * (low + high)]).map(of);
        all.reduce(|a, b| if b.radius < a.radius { b } else { a }).unwrap_or(Ball { z: 0.0, radius: 0.0 })
    }

    fn center(self, pose: &[f64; 6]) -> [f64; 3] {
        [0, 1, 2].map(|k| pose[k] + self.z * pose[3 + k])
    }

    /// How far a point in the ball moves from one pose to another, at the most.
    fn moved(self, from: &[f64; 6], to: &[f64; 6]) -> f64 {
        let turned = (3..6).map(|k| (from[k] - to[k]).powi(2)).sum::<f64>().sqrt();
        distance(self.center(from), self.center(to)) + self.radius * turned
    }

    /// The distance of a point; negative inside.
    fn distance(self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        distance(self.center(pose), point) - self.radius
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
