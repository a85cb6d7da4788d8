//! What all ways of a cutter together leave over a point of a surface.

use rayon::prelude::*;

use crate::milling::deep::deepest;
use crate::milling::distance::{Shape, ToolBody};
use crate::milling::height::{NormalLine, lowest, lowest_until};
use crate::milling::outline::{Cutter, OutlinePiece};
use crate::milling::series::PoseSeries;

/// Values through which a piece of a pass is known.
const NODES: usize = 13;
/// Pieces of a pass at the least: short ones reach less far.
const PIECES: usize = 32;

/// A point that lies deeper than this within the cutter, mm, is cut deep, and its height is looked for over the whole way ...
const DEEP: f64 = 2e-3;
/// ... of which that is tried at places so far apart, as a share of the radius of the ball about the cutter; at the least and at the most at so many.
const TRIED: f64 = 0.25;
const TRIES: [usize; 2] = [9, 1000];
/// How far a shank is thought to go on above the outline, as a share of its radius there.
const SHANK: f64 = 2.0;
/// A height by steps is no news where it is lower by less than this, mm.
const LOWER: f64 = 1e-7;
/// The ball about a cutter has its centre in that of an arc where it is larger than the least by less than this factor.
const TO_BALL: f64 = 1.5;
/// Parts of a way that are shorter against its reach are not cut in two.
const SHORT: f64 = 0.1;
/// Ways of a cluster that are looked at one by one.
const FEW: usize = 8;

/// A cutter on many ways. What it leaves over a point is the least of the heights at which it passes on any of them.
#[derive(Clone, Debug)]
pub struct SweptCutter {
    ways: Vec<Way>,
    /// Ways that are near each other, each cluster before those that it is cut into; the first is of all.
    clusters: Vec<Cluster>,
    /// The ways of clusters, one after the other.
    order: Vec<usize>,
    cutter: Cutter,
    /// What cuts, and the same with a shank.
    solid: Shape,
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

/// Ways whose balls, wherever they move, lie about one place.
#[derive(Clone, Debug)]
struct Cluster {
    center: [f64; 3],
    /// No centre of such a ball in the middle of its way is farther away, mm, ...
    spread: f64,
    /// ... and no such centre, moved as far as the cutter reaches, is farther away, mm.
    radius: f64,
    /// From where to where in the order.
    ways: [usize; 2],
    halves: Option<[usize; 2]>,
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
        SweptCutter::new(passes.par_iter().enumerate().flat_map_iter(of_pass).collect(), cutter)
    }

    fn new(ways: Vec<(usize, PoseSeries)>, cutter: &Cutter) -> SweptCutter {
        let body = body(&cutter.pieces);
        let ball = Ball::around(&body.pieces);
        let way = |(number, series): (usize, PoseSeries)| {
            let middle = series.at(0.5);
            // half of the way, however unevenly the cutter goes
            let reach = 0.5 * ball.fastest(&series);
            Way { middle, reach, number, series }
        };
        let ways: Vec<Way> = ways.into_par_iter().map(way).collect();
        let (mut order, mut clusters): (Vec<usize>, Vec<Cluster>) = ((0..ways.len()).collect(), Vec::new());
        if !ways.is_empty() {
            let spheres: Vec<([f64; 3], f64)> =
                ways.iter().map(|way| (ball.center(&way.middle), way.reach.max(0.0))).collect();
            clustered(&spheres, &mut order, [0, ways.len()], &mut clusters);
        }
        let (cutter, solid) = (cutter.clone(), cutter.body().shape());
        SweptCutter { ways, clusters, order, cutter, solid, body: body.shape(), ball }
    }

    /// What is left over a point along its normal; `None` if the cutter passes it on no way.
    ///
    /// A way leaves no less than the distance of the point from the cutter in its middle, less how far the cutter moves from there. So ways
    /// are tried in the order of that bound until it is above the least height found.
    pub fn left(&self, line: &NormalLine) -> Option<LeftOver> {
        self.left_until(line, f64::NEG_INFINITY)
    }

    /// The same, or what any way leaves that is not above `enough`, mm.
    pub fn left_until(&self, line: &NormalLine, enough: f64) -> Option<LeftOver> {
        let point = [line[0], line[1], line[2]];
        let nearest = self.nearest(point)?;
        if let Some(found) = self.at_a_glance(nearest, line, enough) {
            return Some(found);
        }
        let mut best = self.lowest_on(nearest, line);
        let is_enough = |best: Option<LeftOver>| best.is_some_and(|best| best.height <= enough);
        if is_enough(best) {
            return best;
        }
        // a cutter as far away as it is wide does not pass
        let limit = |best: Option<LeftOver>| best.map_or(2.0 * self.ball.radius, |best| best.height.max(0.0));
        let bound = |k: usize| self.body.distance(&self.ways[k].middle, point) - self.ways[k].reach;
        let mut near: Vec<(f64, usize)> = Vec::new();
        self.within(point, limit(best), |k| near.extend((k != nearest).then(|| (bound(k), k))));
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (bound, k) in near {
            if bound > limit(best) || is_enough(best) {
                break;
            }
            if self.stays_away(k, point, limit(best)) {
                continue;
            }
            let found = self.lowest_on(k, line);
            best = match (best, found) {
                (Some(best), Some(found)) if found.height >= best.height => Some(best),
                (best, found) => found.or(best),
            };
        }
        best
    }

    /// What one of the blocks leaves over a point, mm; `None` if the cutter does not pass it on that.
    pub fn left_by(&self, block: usize, line: &NormalLine) -> Option<f64> {
        lowest(&self.ways[block].series, &self.cutter, line, 0.5).map(|found| found.height)
    }

    /// Whether the cutter stays farther from a point than a distance on all of a way: as it does in parts at whose ends it is far enough away.
    fn stays_away(&self, k: usize, point: [f64; 3], far: f64) -> bool {
        let way = &self.ways[k];
        let distance = |share: f64| self.body.distance(&way.series.at(share), point);
        let mut left = vec![([0.0, 1.0], [0.0, 1.0].map(distance), 2.0 * way.reach)];
        while let Some((shares, ends, moved)) = left.pop() {
            // a distance changes by no more than the cutter moves
            if 0.5 * (ends[0] + ends[1] - moved) > far {
                continue;
            }
            if ends[0].min(ends[1]) <= far || moved < SHORT * way.reach {
                return false;
            }
            let middle = 0.5 * (shares[0] + shares[1]);
            let here = distance(middle);
            left.push(([shares[0], middle], [ends[0], here], 0.5 * moved));
            left.push(([middle, shares[1]], [here, ends[1]], 0.5 * moved));
        }
        true
    }

    /// A height that is not above `enough`, if a way is seen at once to leave one: the place in that height lies in the cutter.
    fn at_a_glance(&self, k: usize, line: &NormalLine, enough: f64) -> Option<LeftOver> {
        if enough == f64::NEG_INFINITY {
            return None;
        }
        let way = &self.ways[k];
        let place = [0, 1, 2].map(|k| line[k] + enough * line[3 + k]);
        let is_within = |share: f64| self.solid.distance(&way.series.at(share), place) < 0.0;
        if [0.0, 1.0, 0.5].into_iter().any(is_within) {
            return Some(LeftOver { height: enough, way: way.number });
        }
        let found = lowest_until(&way.series, &self.cutter, line, 0.5, enough)?;
        (found.height <= enough).then_some(LeftOver { height: found.height, way: way.number })
    }

    /// How near a point comes to the ball about the cutter on a way, at the least.
    fn far(&self, k: usize, point: [f64; 3]) -> f64 {
        self.ball.distance(&self.ways[k].middle, point) - self.ways[k].reach
    }

    /// The way in whose middle the ball is nearest; of several the first.
    fn nearest(&self, point: [f64; 3]) -> Option<usize> {
        let far = |k: usize| distance(self.ball.center(&self.ways[k].middle), point);
        let far_from = |cluster: usize| distance(self.clusters[cluster].center, point) - self.clusters[cluster].spread;
        let mut best: Option<(f64, usize)> = None;
        let mut left = if self.clusters.is_empty() { Vec::new() } else { vec![(far_from(0), 0)] };
        while let Some((least, at)) = left.pop() {
            if best.is_some_and(|(known, _)| least > known) {
                continue;
            }
            let Some(halves) = self.clusters[at].halves else {
                let [from, to] = self.clusters[at].ways;
                let own = self.order[from..to].iter().map(|k| (far(*k), *k));
                best = own.chain(best).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                continue;
            };
            let mut halves = halves.map(|half| (far_from(half), half));
            // the nearer one is looked at first
            if halves[0].0 < halves[1].0 {
                halves.swap(0, 1);
            }
            left.extend(halves);
        }
        best.map(|(_, k)| k)
    }

    /// All ways whose ball comes as near as `limit`, mm.
    fn within(&self, point: [f64; 3], limit: f64, mut each: impl FnMut(usize)) {
        let mut left = if self.clusters.is_empty() { Vec::new() } else { vec![0] };
        while let Some(at) = left.pop() {
            let Cluster { center, radius, ways: [from, to], halves, .. } = self.clusters[at];
            if distance(center, point) - radius - self.ball.radius > limit {
                continue;
            }
            match halves {
                Some(halves) => left.extend(halves),
                None => self.order[from..to].iter().filter(|k| self.far(**k, point) <= limit).for_each(|k| each(*k)),
            }
        }
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

/// Adds a cluster of some of the order with all that it is cut into, across where it is widest, and says where it stands.
fn clustered(
    spheres: &[([f64; 3], f64)],
    order: &mut [usize],
    [from, to]: [usize; 2],
    clusters: &mut Vec<Cluster>,
) -> usize {
    let ends = [0, 1, 2].map(|k| {
        let values = order[from..to].iter().map(|way| spheres[*way].0[k]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    });
    let center = ends.map(|(low, high)| 0.5 * (low + high));
    let reach = |way: &usize| distance(spheres[*way].0, center) + spheres[*way].1;
    let radius = order[from..to].iter().map(reach).fold(0.0, f64::max);
    let spread = order[from..to].iter().map(|way| distance(spheres[*way].0, center)).fold(0.0, f64::max);
    let number = clusters.len();
    clusters.push(Cluster { center, spread, radius, ways: [from, to], halves: None });
    if to - from > FEW {
        let widest = (0..3).max_by(|a, b| (ends[*a].1 - ends[*a].0).total_cmp(&(ends[*b].1 - ends[*b].0)));
        let across = widest.unwrap_or(0);
        let middle = (from + to) / 2;
        order[from..to].select_nth_unstable_by(middle - from, |a, b| {
            spheres[*a].0[across].total_cmp(&spheres[*b].0[across]).then(a.cmp(b))
        });
        let halves = [[from, middle], [middle, to]].map(|part| clustered(spheres, order, part, clusters));
        clusters[number].halves = Some(halves);
    }
    number
}

impl Cutter {
    /// What cuts as a body: an edge has its bottom, and a cutter that is nothing but an edge is a pin.
    pub fn body(&self) -> ToolBody {
        let is_edge = |piece: &OutlinePiece| matches!(piece, OutlinePiece::Arc { radius: 0.0, .. });
        if self.pieces.iter().all(is_edge) { body(&self.pieces) } else { ToolBody { pieces: closed(&self.pieces) } }
    }
}

/// The pieces, with the bottom of an edge.
fn closed(pieces: &[OutlinePiece]) -> Vec<OutlinePiece> {
    let of = |piece: &OutlinePiece| match *piece {
        OutlinePiece::Arc { center: [rho, z], radius: 0.0, .. } => OutlinePiece::Line { from: [0.0, z], to: [rho, z] },
        piece => piece,
    };
    pieces.iter().map(of).collect()
}

/// What lies within the pieces, and above all of them a shank goes on.
fn body(pieces: &[OutlinePiece]) -> ToolBody {
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
    ToolBody { pieces: closed(pieces).into_iter().chain(shank).collect() }
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
        // of what is flat and wide it lies in its middle
        let centres = pieces.iter().filter_map(|piece| match *piece {
            OutlinePiece::Arc { center: [0.0, z], .. } => Some(z),
            _ => None,
        });
        let of = |z: f64| Ball { z, radius: ends.iter().map(|at| at[0].hypot(at[1] - z)).fold(0.0, f64::max) };
        // a ball touches with all sides as far from its centre: what is nearest to that is the way that touches
        let middle = [0.5 * (low + high)].map(of);
        let all = centres.map(of).filter(|ball| ball.radius < TO_BALL * middle[0].radius).chain(middle);
        all.into_iter().next().unwrap_or(Ball { z: 0.0, radius: 0.0 })
    }

    fn center(self, pose: &[f64; 6]) -> [f64; 3] {
        [0, 1, 2].map(|k| pose[k] + self.z * pose[3 + k])
    }

    /// How fast a point in the ball moves with the share of a way, at the most.
    fn fastest(self, way: &PoseSeries) -> f64 {
        let [moved, turned] = way.rates(self.z);
        moved + self.radius * turned
    }

    /// The distance of a point; negative inside.
    fn distance(self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        distance(self.center(pose), point) - self.radius
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cutter that hardly moves at first and is fast at last passes a point between places at which it is far away on both sides.
    #[test]
    fn a_cutter_that_is_fast_at_last_passes_what_lies_there() {
        let ball = OutlinePiece::Arc { center: [0.0, 0.05], radius: 0.05, between: [0.0, std::f64::consts::FRAC_PI_2] };
        let cutter = Cutter { pieces: vec![ball] };
        let fast = PoseSeries::sampled(5, |s| [20.0 * s.powi(3), 0.0, -0.01, 0.0, 0.0, 1.0]);
        let above = PoseSeries::sampled(5, |s| [16.7 + 1e-3 * s, 0.0, 0.25, 0.0, 0.0, 1.0]);
        let swept = SweptCutter::of_blocks(vec![fast, above], &cutter);
        let left = swept.left(&[16.7, 0.0, 0.0, 0.0, 0.0, 1.0]).expect("both pass");
        assert!(left.way == 0 && (left.height + 0.01).abs() < 1e-9, "{left:?}");
    }
}
