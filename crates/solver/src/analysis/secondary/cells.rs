//! The cells of a piece: parallelograms that the surface is near, and which of them a point is nearest to.

use nalgebra::Vector3;

/// A quadratic function that vanishes in the middle of a cell with its slopes is nowhere in the cell more than this many times what it is
/// at the corners and halfway between them.
const BETWEEN: f64 = 1.25;
/// Cells, or balls, that are looked at together, in vectors of any width.
const BLOCK: usize = 8;
/// By so little, as a share of where it lies and how large it is, a ball is made larger than its numbers say, so that their rounding
/// leaves no cell out.
const ROUNDED: f64 = 1e-12;
/// Levels of balls at the most: so many hold more cells than a piece has.
const MOST_LEVELS: usize = 5;

/// A place in the middle of a cell or at a corner, and the tangents there.
#[derive(Clone, Copy)]
pub(super) struct Corner(pub(super) [Vector3<f64>; 3]);

#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    ball: Ball,
    /// From its middle to the ends of either parameter.
    pub(super) halves: [Vector3<f64>; 2],
    /// What tells the share of these halves in a vector.
    duals: [Vector3<f64>; 2],
    normal: Vector3<f64>,
    /// The square of the sine of the angle between the halves. What a point is away from the place in the parallelogram whose shares are the
    /// point's own, cut off at its sides, is across the plane what it is from the parallelogram, and in the plane no more than what it is
    /// from there over this sine.
    skew: f64,
    /// How far the surface may be from the parallelogram of the halves.
    sagitta: f64,
    at: [f64; 2],
}

/// A ball that holds some cells.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Vector3<f64>,
    radius: f64,
}

/// All cells of a piece, neighbours together.
#[derive(Debug, Default)]
pub(super) struct Cells {
    blocks: Vec<Block>,
    /// Balls about blocks, about what each of these holds, and so on up to all of it: what stands at a place holds the same number of what
    /// stands below, from that many times the place on.
    levels: Vec<Vec<Balls>>,
    /// How far the surface may be from the parallelogram of a cell at the most.
    sagitta: f64,
}

/// A few balls, number by number; where they are fewer, what is infinitely far away.
#[derive(Clone, Debug)]
struct Balls {
    center: [[f64; BLOCK]; 3],
    radius: [f64; BLOCK],
}

/// A few cells, number by number; where they are fewer, what is infinitely far away.
#[derive(Clone, Debug)]
struct Block {
    /// Which of the piece's cells they are.
    numbers: [usize; BLOCK],
    balls: Balls,
    halves: [[[f64; BLOCK]; 3]; 2],
    duals: [[[f64; BLOCK]; 3]; 2],
    normal: [[f64; BLOCK]; 3],
    skew: [f64; BLOCK],
    sagitta: [f64; BLOCK],
    at: [[f64; BLOCK]; 2],
}

/// The least distance that a point may have from a piece, mm, and the parameters near which.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) least: f64,
    pub(super) at: [f64; 2],
    /// The place of these on the cell's parallelogram.
    pub(super) on: Vector3<f64>,
    block: usize,
}

impl Near {
    /// The same with other parameters.
    pub(super) fn with_start(self, at: [f64; 2]) -> Near {
        Near { at, ..self }
    }
}

impl Corner {
    /// The place halfway to the next corner along a parameter, of the cubic through both with their tangents.
    fn halfway(&self, other: &Corner, along: usize, steps: [f64; 2]) -> Vector3<f64> {
        0.5 * (self.0[0] + other.0[0]) + (self.0[1 + along] - other.0[1 + along]) * (0.125 * steps[along])
    }
}

impl Cell {
    /// From its middle and its corners; nothing where the surface has no place or no two directions.
    pub(super) fn new(at: [f64; 2], middle: Corner, corners: [Corner; 4], steps: [f64; 2]) -> Option<Cell> {
        let center = middle.0[0];
        let halves = [0, 1].map(|k| middle.0[1 + k] * (0.5 * steps[k]));
        let [a, b] = halves;
        let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
        let area = aa * bb - ab * ab;
        let duals = [(a * bb - b * ab) / area, (b * aa - a * ab) / area];
        let [low_low, low_high, high_low, high_high] = &corners;
        let halfway = [
            (low_low.halfway(low_high, 1, steps), -a),
            (high_low.halfway(high_high, 1, steps), a),
            (low_low.halfway(high_low, 0, steps), -b),
            (low_high.halfway(high_high, 0, steps), b),
        ];
        let flat = [-a - b, b - a, a - b, a + b];
        let around = corners.iter().map(|corner| corner.0[0]).zip(flat).chain(halfway);
        let sagitta = BETWEEN * around.map(|(place, flat)| (place - center - flat).norm()).fold(0.0, f64::max);
        let radius = corners.iter().map(|corner| (corner.0[0] - center).norm()).fold(0.0, f64::max) + sagitta;
        let (normal, skew) = (a.cross(&b).normalize(), (area / (aa * bb)).min(1.0));
        let is_whole = duals.iter().all(|dual| dual.iter().all(|x| x.is_finite())) && radius.is_finite();
        is_whole.then_some(Cell { ball: Ball { center, radius }, halves, duals, normal, skew, sagitta, at })
    }

    /// The least and the greatest coordinates of what it may hold.
    pub(super) fn hull(&self) -> [Vector3<f64>; 2] {
        let reach = self.halves[0].abs() + self.halves[1].abs() + Vector3::repeat(self.sagitta);
        [self.ball.center - reach, self.ball.center + reach]
    }
}

impl Ball {
    fn around<'c>(cells: impl ExactSizeIterator<Item = &'c Cell> + Clone) -> Ball {
        let count = cells.len() as f64;
        let center = cells.clone().map(|cell| cell.ball.center).sum::<Vector3<f64>>() / count;
        let reach = |cell: &Cell| (cell.ball.center - center).norm() + cell.ball.radius;
        let radius = cells.map(reach).fold(0.0, f64::max);
        Ball { center, radius: radius + ROUNDED * (radius + center.norm()) }
    }
}

impl Balls {
    fn new(own: impl Iterator<Item = Ball>) -> Balls {
        let mut balls = Balls { center: [[0.0; BLOCK]; 3], radius: [f64::NEG_INFINITY; BLOCK] };
        for (lane, ball) in own.enumerate() {
            (0..3).for_each(|k| balls.center[k][lane] = ball.center[k]);
            balls.radius[lane] = ball.radius;
        }
        balls
    }

    /// How near a point is to each at the least, negative within it.
    #[inline(always)]
    fn least(&self, point: [f64; 3]) -> [f64; BLOCK] {
        let mut least = [0.0; BLOCK];
        for (lane, least) in least.iter_mut().enumerate() {
            let from = self.less_center(lane, point);
            *least = dot(from, from).sqrt() - self.radius[lane];
        }
        least
    }

    /// What leads to a point from the center of one.
    #[inline(always)]
    fn less_center(&self, lane: usize, point: [f64; 3]) -> [f64; 3] {
        less(point, of(&self.center, lane), 1.0)
    }
}

impl Cells {
    pub(super) fn new(cells: &[Cell]) -> Cells {
        let mut order: Vec<usize> = (0..cells.len()).collect();
        divide(cells, &mut order);
        let blocks = order.chunks(BLOCK).map(|numbers| Block::new(cells, numbers)).collect();
        let mut levels = Vec::new();
        let mut each = BLOCK;
        while !cells.is_empty() && levels.last().is_none_or(|top: &Vec<Balls>| top.len() > 1) {
            let ball = |own: &[usize]| Ball::around(own.iter().map(|number| &cells[*number]));
            levels.push(order.chunks(BLOCK * each).map(|own| Balls::new(own.chunks(each).map(ball))).collect());
            each *= BLOCK;
        }
        let sagitta = cells.iter().map(|cell| cell.sagitta).fold(0.0, f64::max);
        Cells { blocks, levels, sagitta }
    }

    /// How near a point is to the surface at the least, and the nearest place on a parallelogram, of several the first; `None` if no cell is
    /// within a distance, mm. Where other points were near that are not far from it is looked at first. `steps` are the sides of a cell in
    /// the parameters.
    #[inline(always)]
    pub(super) fn nearest(
        &self,
        point: [f64; 3],
        within: f64,
        others: [Option<&Near>; 2],
        steps: [f64; 2],
    ) -> Option<Near> {
        // the parallelogram of what is within the distance may be farther away; what is beyond that counts for nothing, looked at or not
        let reach = (within + self.sagitta).min(f64::MAX);
        let mut best = Best { least: f64::INFINITY, flat: f64::INFINITY, at: None };
        let [first, second] = others.map(|other| other.map(|near| near.block));
        let second = second.filter(|block| Some(*block) != first);
        for block in [first, second].into_iter().flatten() {
            best.look_at(&self.blocks, block, point, reach);
        }
        // how many levels are below, and where
        let mut waiting = [(0u32, 0u32, f64::NEG_INFINITY); BLOCK * MOST_LEVELS];
        waiting[0].0 = self.levels.len() as u32;
        let mut count = usize::from(!self.levels.is_empty());
        while count > 0 {
            count -= 1;
            let (below, at, least) = waiting[count];
            let at = at as usize;
            // what a ball holds is nowhere nearer, parallelograms included
            if least > best.flat {
                continue;
            }
            if below == 0 {
                if first != Some(at) && second != Some(at) {
                    best.look_at(&self.blocks, at, point, reach);
                }
                continue;
            }
            let least = self.levels[below as usize - 1][at].least(point);
            let most = best.flat.min(reach);
            let nearest = count;
            for (lane, least) in least.into_iter().enumerate() {
                if least <= most {
                    waiting[count] = (below - 1, (BLOCK * at + lane) as u32, least);
                    // the nearest one comes next
                    if count > nearest && waiting[count - 1].2 < least {
                        waiting.swap(count - 1, count);
                    }
                    count += 1;
                }
            }
        }
        let (block, lane) = best.at.filter(|_| best.least <= within)?;
        Some(self.blocks[block].near(block, lane, point, steps, best.least))
    }
}

/// Puts some cells in an order in which those of each block are neighbours, those of as many blocks as a block has cells, and so on: halves
/// them across the direction in which they reach farthest, again and again.
fn divide(cells: &[Cell], order: &mut [usize]) {
    let count = order.len();
    if count <= BLOCK {
        return;
    }
    let own = order.iter().map(|number| cells[*number].ball.center);
    let low = own.clone().reduce(|a, b| a.inf(&b)).unwrap_or_default();
    let high = own.reduce(|a, b| a.sup(&b)).unwrap_or_default();
    let along = (high - low).imax();
    let place = |number: usize| cells[number].ball.center[along];
    // what is whole on a level stays so
    let mut whole = BLOCK;
    while whole * BLOCK < count {
        whole *= BLOCK;
    }
    let middle = (count / 2).next_multiple_of(whole);
    order.select_nth_unstable_by(middle, |a, b| place(*a).total_cmp(&place(*b)).then(a.cmp(b)));
    let (first, second) = order.split_at_mut(middle);
    divide(cells, first);
    divide(cells, second);
}

/// What is known of the cells that were looked at.
struct Best {
    /// How near the surface is at the least.
    least: f64,
    /// How near the nearest parallelogram is, in which block and at which place there.
    flat: f64,
    at: Option<(usize, usize)>,
}

impl Best {
    #[inline(always)]
    fn look_at(&mut self, blocks: &[Block], block: usize, point: [f64; 3], reach: f64) {
        let cells = &blocks[block];
        let (flat, least) = cells.least(point, reach);
        self.least = lowest(least).min(self.least);
        let nearest = lowest(flat);
        if nearest > self.flat || nearest == f64::INFINITY {
            return;
        }
        for (lane, _) in flat.iter().enumerate().filter(|(_, flat)| **flat == nearest) {
            let is_first = || self.at.is_none_or(|(block, best)| cells.numbers[lane] < blocks[block].numbers[best]);
            if nearest < self.flat || is_first() {
                (self.flat, self.at) = (nearest, Some((block, lane)));
            }
        }
    }
}

// written out: `map` of an array may stay a call within loops that are to become vectors
#[inline(always)]
fn of(vectors: &[[f64; BLOCK]; 3], lane: usize) -> [f64; 3] {
    [vectors[0][lane], vectors[1][lane], vectors[2][lane]]
}

/// `a - share b`
#[inline(always)]
fn less(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    [a[0] - b[0] * share, a[1] - b[1] * share, a[2] - b[2] * share]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// In pairs, which vectors take at once.
#[inline(always)]
fn lowest(mut values: [f64; BLOCK]) -> f64 {
    for half in [BLOCK / 2, BLOCK / 4, BLOCK / 8] {
        for k in 0..half {
            let other = values[k + half];
            values[k] = if other < values[k] { other } else { values[k] };
        }
    }
    values[0]
}

impl Block {
    fn new(cells: &[Cell], numbers: &[usize]) -> Block {
        let cell = |lane: usize| numbers.get(lane).map(|number| &cells[*number]);
        let each = |value: &dyn Fn(&Cell) -> f64, without: f64| {
            std::array::from_fn::<f64, BLOCK, _>(|lane| cell(lane).map_or(without, value))
        };
        let vectors = |value: &dyn Fn(&Cell) -> Vector3<f64>| [0, 1, 2].map(|k| each(&|cell| value(cell)[k], 0.0));
        Block {
            numbers: std::array::from_fn(|lane| numbers.get(lane).copied().unwrap_or(usize::MAX)),
            balls: Balls::new(numbers.iter().map(|number| cells[*number].ball)),
            halves: [0, 1].map(|k| vectors(&|cell| cell.halves[k])),
            duals: [0, 1].map(|k| vectors(&|cell| cell.duals[k])),
            normal: vectors(&|cell| cell.normal),
            skew: each(&|cell| cell.skew, 1.0),
            sagitta: each(&|cell| cell.sagitta, f64::NEG_INFINITY),
            at: [0, 1].map(|k| each(&|cell| cell.at[k], 0.0)),
        }
    }

    /// The shares of a cell's halves in the way from its middle to a point, cut off at its sides.
    #[inline(always)]
    fn shares(&self, lane: usize, from: [f64; 3]) -> [f64; 2] {
        let [a, b] = &self.duals;
        [dot(of(a, lane), from).clamp(-1.0, 1.0), dot(of(b, lane), from).clamp(-1.0, 1.0)]
    }

    /// How near a point is to the place in each cell's parallelogram that has its shares, cut off at the sides, and how near it may be to the
    /// surface, which lies about the parallelogram and in the cell's ball; of cells whose balls are beyond a reach the first is left out.
    #[inline(always)]
    fn least(&self, point: [f64; 3], reach: f64) -> ([f64; BLOCK], [f64; BLOCK]) {
        let (mut flat, mut least) = ([f64::INFINITY; BLOCK], [f64::INFINITY; BLOCK]);
        for lane in 0..BLOCK {
            let from = self.balls.less_center(lane, point);
            let [share_a, share_b] = self.shares(lane, from);
            let (a, b) = (of(&self.halves[0], lane), of(&self.halves[1], lane));
            let apart = less(less(from, a, share_a), b, share_b);
            let across = dot(of(&self.normal, lane), from);
            let skew = self.skew[lane];
            let from_flat = (skew * dot(apart, apart) + (1.0 - skew) * (across * across)).sqrt();
            let within_ball = dot(from, from).sqrt() - self.balls.radius[lane];
            let about_flat = from_flat - self.sagitta[lane];
            flat[lane] = if within_ball <= reach { dot(apart, apart).sqrt() } else { f64::INFINITY };
            least[lane] = if about_flat > within_ball { about_flat } else { within_ball };
        }
        (flat, least)
    }

    fn near(&self, block: usize, lane: usize, point: [f64; 3], steps: [f64; 2], least: f64) -> Near {
        let shares = self.shares(lane, self.balls.less_center(lane, point));
        let [a, b] = &self.halves;
        let on = |k: usize| self.balls.center[k][lane] + a[k][lane] * shares[0] + b[k][lane] * shares[1];
        let at = [0, 1].map(|k| self.at[k][lane] + 0.5 * shares[k] * steps[k]);
        Near { least, at, on: Vector3::new(on(0), on(1), on(2)), block }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cells of a helicoid whose parameters run askew, and points about it: which cell is nearest does not depend on what is looked at
    /// first, nor on the order.
    #[test]
    fn the_nearest_cell_is_that_of_all() {
        let steps = [0.3, 1.5];
        let place = |[u, v]: [f64; 2]| {
            let (sin, cos) = (u + 0.1 * v).sin_cos();
            let radius = 10.0 + v;
            let along = Vector3::new(-radius * sin, radius * cos, 4.0);
            let across = Vector3::new(cos, sin, 0.0) + 0.1 * along;
            Corner([Vector3::new(radius * cos, radius * sin, 4.0 * (u + 0.1 * v)), along, across])
        };
        let cells: Vec<Cell> = (0..700)
            .filter_map(|k| {
                let at = [(k / 7) as f64 * steps[0], (k % 7) as f64 * steps[1]];
                let corner = |(a, b): (f64, f64)| place([at[0] + 0.5 * a * steps[0], at[1] + 0.5 * b * steps[1]]);
                Cell::new(at, place(at), [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(corner), steps)
            })
            .collect();
        assert_eq!(cells.len(), 700);
        let (all, single) = (Cells::new(&cells), cells.iter().map(|cell| Cells::new(&[*cell])).collect::<Vec<_>>());
        let mut before = None;
        for k in 0..500 {
            let k = f64::from(k);
            let point = [17.0 * (1.3 * k).sin(), 17.0 * (0.7 * k).cos(), 0.25 * k];
            let near = all.nearest(point, f64::INFINITY, [None, before.as_ref()], steps).expect("there are cells");
            let each = single.iter().map(|one| one.nearest(point, f64::INFINITY, [None; 2], steps).expect("a cell"));
            let least = each.clone().map(|near| near.least).fold(f64::INFINITY, f64::min);
            assert_eq!(near.least, least);
            let alone = all.nearest(point, f64::INFINITY, [None; 2], steps).expect("there are cells");
            assert_eq!(near.at, alone.at);
            assert!(all.nearest(point, 0.99 * least.abs() - 1e-9, [None; 2], steps).is_none() || least < 0.0);
            before = Some(near);
        }
    }

    /// The crest of a hob: its parameters run nearly along one direction, so that shares cut off at the sides lead far from the nearest place.
    /// What other points were near changes nothing, however small the distance that matters.
    #[test]
    fn what_is_looked_at_first_changes_nothing() {
        let steps = [0.1, 0.1];
        let place = |[u, v]: [f64; 2]| {
            let (sin, cos) = (v + 0.6 * u).sin_cos();
            let around = Vector3::new(-50.0 * sin, 50.0 * cos, 0.0);
            Corner([Vector3::new(50.0 * cos, 50.0 * sin, 2.0 * v), 0.6 * around, around + Vector3::new(0.0, 0.0, 2.0)])
        };
        let cells: Vec<Cell> = (0..3000)
            .filter_map(|k| {
                let at = [(k % 10) as f64 * steps[0], (k / 10) as f64 * steps[1]];
                let corner = |(a, b): (f64, f64)| place([at[0] + 0.5 * a * steps[0], at[1] + 0.5 * b * steps[1]]);
                Cell::new(at, place(at), [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(corner), steps)
            })
            .collect();
        assert_eq!(cells.len(), 3000);
        let all = Cells::new(&cells);
        let mut found = 0;
        for k in 0..20_000 {
            let k = f64::from(k);
            let radius = 50.0 + 3.0 * (0.37 * k).sin();
            let point = [radius * (2.1 * k).cos(), radius * (2.1 * k).sin(), 30.0 + 25.0 * (0.013 * k).sin()];
            let within = 1.5 * (1.0 + (0.71 * k).sin());
            let near = |others: [Option<&Near>; 2], within| all.nearest(point, within, others, steps);
            let (alone, wherever) = (near([None; 2], within), near([None; 2], f64::INFINITY));
            let beside = near([None, wherever.as_ref()], within);
            assert_eq!(alone.map(|near| (near.least, near.at)), beside.map(|near| (near.least, near.at)), "{k}");
            found += usize::from(alone.is_some());
        }
        assert!((1000..19_000).contains(&found), "{found}");
    }
}
