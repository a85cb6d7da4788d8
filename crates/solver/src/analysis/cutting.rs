//! What single cutting edges leave over the surface that edges without end would generate.

use flank_expr::geometry::{Surface, Vector3};
use flank_expr::{Expr, InstructionSet, LANES, ScalarEvaluator, Tape, TapeError};
use rayon::prelude::*;

use crate::analysis::integer_points::{Place, WholeNumbers};
use crate::equations::solution::{Outcome, ROUNDING, Range};
use crate::equations::system::{Evaluation, System};
use crate::newton::batch::LaneNewton;
use crate::newton::scalar::solve_with;
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Points that a thread works on at a time; which they are depends on the points alone.
const TILE: usize = 128;
/// Edges are tried up to this multiple of the ideal height that the lowest one can have: what the height of an edge differs
/// from its quadratic form within a few steps is far less.
const SAFETY: f64 = 2.0;
/// Edges that are tried for one point before it is left undecided.
const MOST_EDGES: usize = 4096;
/// The same where the search has no prospect: where most of some points that are spread over the surface stay undecided, and that takes
/// more than [`PROSPECT`] at each.
const FEW_EDGES: usize = 4;
/// What it takes to bring an edge to pass a point in lanes counts once, what it takes one by one so often.
const CAREFULLY: u64 = 20;
const PROSPECT: u64 = 100;
/// Points at which real edges are compared with ideal ones, and the edges of each: the nearest ones.
const PROBES: usize = 16;
const PROBED_EDGES: usize = 256;

/// A surface that an edge generates over one motion and counts, which are taken as numbers without gaps; and the real
/// edges, one for each set of whole numbers, each swept over the motion.
///
/// The height of an edge over a point is how far along the outward normal of the surface the edge passes. What is left is the
/// least height. Near the counts with which the surface has a point, the ideal edges have the height
/// `q = ½ d · H d`, where d is how far their counts are from these and H is exact: the Hessian of the clearance. So all edges
/// up to a level of q are found without a search. An edge beyond the level is not the lowest if the level is above
/// the q of the nearest edge by as much as real edges differ among each other from ideal ones, which is measured over the whole
/// surface first. All edges up to twice that are tried.
#[derive(Clone, Debug)]
pub struct CuttingEdges {
    /// Of the ideal surface's unknowns: its position's slopes, its normal, the slopes of its constraints.
    guide: Tape,
    ideal: Edges,
    real: Edges,
    counts: Vec<Range>,
    /// Whether the real edges are the ideal ones.
    same: bool,
}

/// The system that brings an edge to pass the normal of a point: unknowns are the edge's parameter, the motion, the height;
/// parameters the point, its normal, the counts.
#[derive(Clone, Debug)]
struct Edges {
    system: System,
    /// Of the parameter and of the motion.
    ranges: [Range; 2],
}

/// What is left at a point of the ideal surface.
#[derive(Clone, Debug, PartialEq)]
pub enum ScallopHeight {
    /// The lowest edge is known.
    Cut {
        /// Of what it leaves over the ideal surface along its outward normal, mm; plus is material.
        height: f64,
        /// Of the lowest edge: its parameter, the motion, its counts.
        edge: Vec<f64>,
    },
    /// None of the edges within the ranges passes.
    Unreached,
    /// An edge that may be lower could not be followed, or there are more than can be tried.
    Undecided,
}

impl CuttingEdges {
    /// `ideal` is the surface that an edge sweeps over a motion and counts, in this order behind its own parameter; `real`
    /// the same for the real edge and machine, with the same motion and counts, whose ranges hold.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surfaces do not have the same motion and counts.
    pub fn new<'g>(ideal: &BoundSurface<'g>, real: &BoundSurface<'g>) -> Result<CuttingEdges, TapeError> {
        let ranges = real.ranges();
        let [ideal, real] = [ideal, real].map(BoundSurface::surface);
        assert_eq!(ideal.unknowns[1..], real.unknowns[1..], "the same motion and counts");
        let along = |value: Expr<'g>| ideal.unknowns.iter().map(move |&p| value.derivative(p));
        let slopes = ideal.unknowns.iter().flat_map(|&p| ideal.position.derivative(p).0);
        let bends = ideal.constraints.iter().flat_map(|&c| along(c).collect::<Vec<_>>());
        let guide: Vec<Expr<'g>> = slopes.chain(ideal.normal.0).chain(bends).collect();
        let swept = [ranges[0], ranges[1]];
        Ok(CuttingEdges {
            guide: Tape::new(&guide, &ideal.unknowns)?,
            ideal: Edges::new(ideal, swept)?,
            real: Edges::new(real, swept)?,
            counts: ranges[2..].to_vec(),
            same: ideal.position == real.position && ideal.unknowns == real.unknowns,
        })
    }

    /// The same edges, for which only these instructions are used; see [`System::with_instruction_set`].
    pub fn with_instruction_set(self, instructions: InstructionSet) -> CuttingEdges {
        let on = |edges: Edges| Edges { system: edges.system.with_instruction_set(instructions), ..edges };
        CuttingEdges { ideal: on(self.ideal), real: on(self.real), ..self }
    }

    /// What the edges leave at points of the ideal surface, on as many threads as there are; `None` for a point that is not
    /// solved. The result depends on the points alone.
    pub fn left(&self, points: &[SurfacePoint]) -> Vec<Option<ScallopHeight>> {
        let solved = points.iter().filter(|point| point.outcome == Outcome::Solved);
        let size = solved.flat_map(|point| point.position).fold(1.0, |size: f64, x| size.max(x.abs()));
        let wide = self.real.wide(size);
        let differing = if self.same { 0.0 } else { self.differing(points, size) };
        let most = self.most_edges(points, &wide, differing);
        let tiles = points.par_chunks(TILE).map(|tile| self.tile(tile, &wide, (differing, most)).0);
        tiles.collect::<Vec<_>>().into_iter().flatten().collect()
    }

    /// How many edges are tried for a point: few where most of some points all over the surface stay undecided after many.
    fn most_edges(&self, points: &[SurfacePoint], wide: &[Range; 3], differing: f64) -> usize {
        let probes: Vec<SurfacePoint> = probes(points).into_iter().cloned().collect();
        let is_without_prospect = |probe: &&SurfacePoint| {
            let (left, effort) = self.tile(std::slice::from_ref(*probe), wide, (differing, MOST_EDGES));
            left[0] == Some(ScallopHeight::Undecided) && effort > PROSPECT
        };
        let without = probes.par_iter().filter(is_without_prospect).count();
        if 2 * without > probes.len() { FEW_EDGES } else { MOST_EDGES }
    }

    /// How much the heights of real edges over a point differ among each other from those of the ideal edges with the
    /// same counts; the most of some points all over the surface.
    fn differing(&self, points: &[SurfacePoint], size: f64) -> f64 {
        let probes = probes(points);
        let spread = |point: &&SurfacePoint| {
            let guide = Guide::at(self, &mut ScalarEvaluator::new(&self.guide), point)?;
            let near = guide.nearest(&self.counts, PROBED_EDGES);
            let passes: Vec<Pass> = near.iter().map(|place| guide.pass(place)).collect();
            let [real, ideal] =
                [&self.real, &self.ideal].map(|edges| Passing::new(edges, &edges.wide(size)).all(&passes));
            let both = real.iter().zip(&ideal).filter_map(|pair| match pair {
                (Passed::At { height, .. }, Passed::At { height: ideal, .. }) => Some(height - ideal),
                _ => None,
            });
            let ends = both.fold(None, |ends: Option<(f64, f64)>, x| {
                Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
            });
            ends.map(|(low, high)| high - low)
        };
        probes.par_iter().filter_map(spread).collect::<Vec<f64>>().into_iter().fold(0.0, f64::max)
    }

    /// What is left at some points, with so many edges tried for each at the most; and what that took.
    fn tile(
        &self,
        points: &[SurfacePoint],
        wide: &[Range; 3],
        (differing, most): (f64, usize),
    ) -> (Vec<Option<ScallopHeight>>, u64) {
        let mut guide = ScalarEvaluator::new(&self.guide);
        let mut passing = Passing::new(&self.real, wide);
        let is_solved = |point: &&SurfacePoint| point.outcome == Outcome::Solved;
        let mut begin = |point| Guide::at(self, &mut guide, point).map(|guide| Search::new(guide, self, differing));
        let mut searches: Vec<Option<Search>> = points.iter().filter(is_solved).map(&mut begin).collect();
        loop {
            let mut passes = Vec::new();
            let open = searches.iter_mut().flatten().filter(|search| search.left.is_none());
            let asked: Vec<(&mut Search, usize)> = open
                .map(|search| {
                    let from = passes.len();
                    passes.extend(search.next(&self.counts, most));
                    let count = passes.len() - from;
                    (search, count)
                })
                .collect();
            if asked.is_empty() {
                break;
            }
            let mut passed = passing.all(&passes).into_iter();
            let mut passes = passes.iter();
            for (search, count) in asked {
                search.learn(passes.by_ref().zip(passed.by_ref()).take(count), differing);
            }
        }
        let mut found = searches.into_iter().map(|search| search.map_or(ScallopHeight::Undecided, Search::end));
        let mut end = || found.next().unwrap_or(ScallopHeight::Undecided);
        let left = points.iter().map(|point| is_solved(&point).then(&mut end)).collect();
        (left, passing.effort)
    }
}

/// Points spread over a surface.
fn probes(points: &[SurfacePoint]) -> Vec<&SurfacePoint> {
    let solved: Vec<&SurfacePoint> = points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
    solved.iter().copied().step_by(solved.len().div_ceil(PROBES).max(1)).collect()
}

impl Edges {
    /// Of a surface without parameters.
    fn new(swept: &Surface<'_>, ranges: [Range; 2]) -> Result<Edges, TapeError> {
        let graph = swept.position.0[0].graph();
        let vector = |name: &str| Vector3([1, 2, 3].map(|k| graph.variable(format!("{name} {k}"))));
        let (place, normal, height) = (vector("place"), vector("normal"), graph.variable("height"));
        let apart = swept.position - place - normal.scaled(height);
        let parameters: Vec<Expr<'_>> =
            place.0.into_iter().chain(normal.0).chain(swept.unknowns[2..].iter().copied()).collect();
        let unknowns = [swept.unknowns[0], swept.unknowns[1], height];
        Ok(Edges { system: System::new(&apart.0, &unknowns, &parameters)?, ranges })
    }

    /// Where unknowns may wander on their way; `size` is how far from the origin the points are.
    fn wide(&self, size: f64) -> [Range; 3] {
        let [edge, motion] = self.ranges.map(|range| range.wider_by(1.0));
        [edge, motion, Range { low: -size, high: size }]
    }
}

/// What the ideal surface tells of the edges near one of its points.
struct Guide {
    /// Position and normal.
    placed: [f64; 6],
    /// Of the edge and the motion, at the point.
    swept: [f64; 2],
    /// The counts at the point, and how the edge and the motion follow each of them.
    counts: Vec<f64>,
    follows: Vec<[f64; 2]>,
    near: WholeNumbers,
}

impl Guide {
    /// `None` where the surface has no regular point.
    fn at(edges: &CuttingEdges, evaluator: &mut ScalarEvaluator<'_>, point: &SurfacePoint) -> Option<Guide> {
        let mut out = vec![0.0; edges.guide.output_count()];
        evaluator.run(&point.unknowns, &mut out);
        let count = edges.counts.len();
        let slope = |k: usize| [out[3 * k], out[3 * k + 1], out[3 * k + 2]];
        let normal = slope(count + 2);
        let (along_edge, along_motion) = (slope(0), slope(1));
        let follow = |k: usize| {
            let by = slope(k + 2);
            let ways = [along_edge, along_motion, normal.map(|x| -x)].map(nalgebra::Vector3::from);
            let followed = nalgebra::Matrix3::from_columns(&ways).lu().solve(&-nalgebra::Vector3::from(by));
            followed.map_or([f64::NAN; 2], |by| [by[0], by[1]])
        };
        let follows: Vec<[f64; 2]> = (0..count).map(follow).collect();
        let bends = &out[3 * (count + 3)..];
        let bend = |row: usize, column: usize| bends[row * (count + 2) + column];
        // how fast the slope of the height changes along the normal's line; a slope is minus a constraint
        let second = |k: usize, l: usize| {
            let [edge, motion] = follows[l];
            -(bend(k, l + 2) + bend(k, 0) * edge + bend(k, 1) * motion)
        };
        let hessian: Vec<Vec<f64>> =
            (0..count).map(|k| (0..count).map(|l| 0.5 * (second(k, l) + second(l, k))).collect()).collect();
        let [x, y, z] = point.position;
        let counts = point.unknowns[2..].to_vec();
        Some(Guide {
            placed: [x, y, z, normal[0], normal[1], normal[2]],
            swept: [point.unknowns[0], point.unknowns[1]],
            near: WholeNumbers::new(counts.clone(), &hessian)?,
            counts,
            follows,
        })
    }

    /// Where the edge with these counts is to be looked for.
    fn pass(&self, place: &Place) -> Pass {
        let mut start = [self.swept[0], self.swept[1], place.q];
        for ((at, count), follows) in place.at.iter().zip(&self.counts).zip(&self.follows) {
            start[0] += (at - count) * follows[0];
            start[1] += (at - count) * follows[1];
        }
        let parameters = self.placed.iter().chain(&place.at).copied().collect();
        Pass { q: place.q, parameters, start }
    }

    /// So many edges, or a few less: the nearest ones.
    fn nearest(&self, ranges: &[Range], most: usize) -> Vec<Place> {
        let mut near = vec![self.near.near(ranges)];
        let mut level = near[0].q + self.near.step();
        while let Some(more) = self.near.within(level, ranges, most) {
            let all_told = more.len() <= near.len() && near.len() > 1;
            near = more;
            if all_told {
                break;
            }
            level *= 1.5;
        }
        near
    }
}

/// An edge that may pass a point.
struct Pass {
    q: f64,
    parameters: Vec<f64>,
    start: [f64; 3],
}

/// What became of it.
enum Passed {
    At {
        height: f64,
        swept: [f64; 2],
    },
    /// It passes beyond its end, or with the motion outside its range.
    Beyond,
    /// It could not be followed.
    Lost,
}

/// Brings edges to pass the normals of points.
struct Passing<'e> {
    edges: &'e Edges,
    newton: LaneNewton<'e>,
    evaluation: Evaluation<'e>,
    wide: &'e [Range; 3],
    /// Edges that were brought to pass, those one by one [`CAREFULLY`] times.
    effort: u64,
}

impl<'e> Passing<'e> {
    fn new(edges: &'e Edges, wide: &'e [Range; 3]) -> Passing<'e> {
        let parameters = edges.system.tape().input_count() - wide.len();
        Passing {
            edges,
            newton: LaneNewton::new(&edges.system, wide),
            evaluation: edges.system.evaluation(&vec![0.0; parameters]),
            wide,
            effort: 0,
        }
    }

    fn all(&mut self, passes: &[Pass]) -> Vec<Passed> {
        let mut passed = Vec::with_capacity(passes.len());
        for block in passes.chunks(LANES) {
            for (lane, pass) in block.iter().enumerate() {
                self.newton.put(lane, pass.start.iter().copied(), &pass.parameters);
            }
            self.newton.run(&[true; LANES][..block.len()], true);
            self.effort += block.len() as u64;
            for (lane, pass) in block.iter().enumerate() {
                let root = self.newton.is_root(lane).then(|| [0, 1, 2].map(|k| self.newton.input(k)[lane]));
                let root = root.or_else(|| self.carefully(pass));
                passed.push(self.verdict(pass, root));
            }
        }
        passed
    }

    fn carefully(&mut self, pass: &Pass) -> Option<[f64; 3]> {
        self.effort += CAREFULLY;
        self.evaluation.set_parameters(&pass.parameters);
        let solution = solve_with(&mut self.evaluation, self.wide, &pass.start);
        solution.is_root().then(|| [0, 1, 2].map(|k| solution.unknowns[k]))
    }

    fn verdict(&self, pass: &Pass, root: Option<[f64; 3]>) -> Passed {
        let is_within = |at: [f64; 3]| {
            let ranges = self.edges.ranges.map(|range| range.wider_by(ROUNDING));
            ranges.iter().zip(at).all(|(range, x)| range.low <= x && x <= range.high)
        };
        match root {
            Some([edge, motion, height]) if is_within([edge, motion, height]) => {
                Passed::At { height, swept: [edge, motion] }
            }
            None if is_within(pass.start) => Passed::Lost,
            _ => Passed::Beyond,
        }
    }
}

/// The search for the lowest edge over a point.
struct Search {
    guide: Guide,
    /// Edges up to this q are tried in the next round; those up to `tried` have been.
    level: f64,
    tried: f64,
    count: usize,
    /// The least q of an edge that passes.
    nearest: Option<f64>,
    lowest: Option<(f64, Vec<f64>)>,
    lost: bool,
    left: Option<ScallopHeight>,
}

impl Search {
    fn new(guide: Guide, edges: &CuttingEdges, differing: f64) -> Search {
        let level = SAFETY * (guide.near.near(&edges.counts).q + differing);
        Search { guide, level, tried: -1.0, count: 0, nearest: None, lowest: None, lost: false, left: None }
    }

    /// The edges of the next round.
    fn next(&mut self, ranges: &[Range], most: usize) -> Vec<Pass> {
        let Some(places) = self.guide.near.within(self.level, ranges, most) else {
            self.left = Some(ScallopHeight::Undecided);
            return Vec::new();
        };
        if places.len() == self.count && self.nearest.is_none() && self.level > self.guide.near.step() {
            // a wider circle holds no further edge
            self.left = Some(if self.lost { ScallopHeight::Undecided } else { ScallopHeight::Unreached });
        }
        let new = places.iter().filter(|place| place.q > self.tried).map(|place| self.guide.pass(place)).collect();
        self.count = places.len();
        new
    }

    /// What the edges of a round have come to.
    fn learn<'p>(&mut self, passes: impl Iterator<Item = (&'p Pass, Passed)>, differing: f64) {
        if self.left.is_some() {
            return;
        }
        for (pass, passed) in passes {
            match passed {
                Passed::At { height, swept } => {
                    self.nearest = Some(self.nearest.map_or(pass.q, |nearest| nearest.min(pass.q)));
                    if self.lowest.as_ref().is_none_or(|(lowest, _)| height < *lowest) {
                        self.lowest = Some((height, swept.iter().chain(&pass.parameters[6..]).copied().collect()));
                    }
                }
                Passed::Lost => self.lost = true,
                Passed::Beyond => {}
            }
        }
        self.tried = self.level;
        match self.nearest.map(|nearest| SAFETY * (nearest + differing)) {
            Some(enough) if enough <= self.level => self.left = Some(self.verdict()),
            Some(enough) => self.level = enough,
            None => self.level = (4.0 * self.level).max(self.guide.near.step()),
        }
    }

    fn verdict(&mut self) -> ScallopHeight {
        match self.lowest.take() {
            Some((height, edge)) if !self.lost => ScallopHeight::Cut { height, edge },
            _ => ScallopHeight::Undecided,
        }
    }

    fn end(self) -> ScallopHeight {
        self.left.unwrap_or(ScallopHeight::Undecided)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A search over counts around zero with `q = ½ h n²` that begins with all edges up to q = 1.
    fn search(h: f64) -> Search {
        let near = WholeNumbers::new(vec![0.0], &[vec![h]]).expect("positive");
        let guide = Guide { placed: [0.0; 6], swept: [0.0; 2], counts: vec![0.0], follows: vec![[0.0; 2]], near };
        Search { guide, level: 1.0, tried: -1.0, count: 0, nearest: None, lowest: None, lost: false, left: None }
    }

    /// What becomes of a search if each edge becomes the same.
    fn end(mut search: Search, counts: Range, passed: fn() -> Passed) -> ScallopHeight {
        while search.left.is_none() {
            let passes = search.next(&[counts], MOST_EDGES);
            search.learn(passes.iter().map(|pass| (pass, passed())), 0.0);
        }
        search.end()
    }

    #[test]
    fn what_was_not_tried_or_not_followed_is_not_unreached() {
        let few = Range { low: -3.0, high: 3.0 };
        assert_eq!(end(search(1.0), few, || Passed::Beyond), ScallopHeight::Unreached);
        assert_eq!(end(search(1.0), few, || Passed::Lost), ScallopHeight::Undecided);
        let at = || Passed::At { height: 0.5, swept: [0.0; 2] };
        assert!(matches!(end(search(1.0), few, at), ScallopHeight::Cut { height: 0.5, .. }));
        // more than can be tried, from the first
        let many = Range { low: -1e6, high: 1e6 };
        assert_eq!(end(search(1e-9), many, || Passed::Beyond), ScallopHeight::Undecided);
    }
}
