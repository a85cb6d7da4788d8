//! The rapids of a program: from the work and back, for each pass in the direction in which the spindle points there.

use flank_export::ProgramRapid;

use super::machine::Machine;
use super::spaces::Hull;

/// Beyond the ends of its travel an axis without one goes away by this, mm.
const AWAY: f64 = 100.0;
/// An axis that follows the tip ends so far before the end of its travel, mm.
const SHORT: f64 = 1.0;
/// A linear axis that moves the cutter so much along its own axis, as a share of its way, is parallel to it.
const PARALLEL: f64 = 1.0 - 1e-9;
/// A cutter that is away stands so far above the ball about the work, mm.
const ABOVE: f64 = 20.0;
/// From one place above the work to another the rotary axes turn by no more than this at once, radians: 10 degrees.
const TURN: f64 = 0.1746;
/// A rapid that comes nearer than [`ABOVE`] by less than this, mm, stays straight.
const LOWER: f64 = 1.0;

/// What a program does about its passes.
pub(super) struct Retracts {
    pub(super) home: (usize, f64),
    pub(super) end: Option<(usize, f64)>,
    pub(super) is_upright: bool,
    /// Of each pass the rapids to it and from it.
    pub(super) of_passes: Vec<[Vec<ProgramRapid>; 2]>,
}

/// The rapids about passes, of which the positions of the axes are given.
///
/// Where one linear axis takes the cutter along its own axis at all passes, that one goes to the end of its travel. Else the cutter goes along
/// its own axis with all linear ones until it stands wholly beyond a plane that touches the ball about the work. There it goes on to the next
/// pass, beyond such planes all the way.
///
/// `by_tip` says that words are the tip in the work, which then goes straight while rotary axes turn.
pub(super) fn retracts(machine: &Machine<'_, '_>, passes: &[&[Vec<f64>]], (hull, by_tip): (Hull, bool)) -> Retracts {
    let rapids = Rapids { machine, passes, hull, by_tip };
    let ends = || passes.iter().flat_map(|rows| [&rows[0], &rows[rows.len() - 1]]);
    let (first, rate) = rapids.best(&passes[0][0]);
    let is_parallel = |row: &Vec<f64>| rapids.along(row, first) * rate.signum() > PARALLEL;
    if ends().all(is_parallel) {
        let home = rapids.home(first, rate);
        let of_passes = rapids.upright((first, home.1 - rapids.short(first, rate)));
        return Retracts { home, end: None, is_upright: true, of_passes };
    }
    let last = passes[passes.len() - 1];
    let home = rapids.home(first, rate);
    let (axis, rate) = rapids.best(&last[last.len() - 1]);
    Retracts { home, end: Some(rapids.home(axis, rate)), is_upright: false, of_passes: rapids.leaning(home) }
}

struct Rapids<'r, 'p, 'g> {
    machine: &'r Machine<'p, 'g>,
    passes: &'r [&'r [Vec<f64>]],
    hull: Hull,
    by_tip: bool,
}

impl Rapids<'_, '_, '_> {
    fn linear(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.machine.free.len()).filter(|axis| !self.machine.axes.is_rotary(*axis))
    }

    /// How far an axis moves the cutter along its own axis, a mm.
    fn along(&self, row: &[f64], axis: usize) -> f64 {
        let here = self.machine.axes.pose(row);
        let mut moved = row.to_vec();
        moved[axis] += 1.0;
        let there = self.machine.axes.pose(&moved);
        (0..3).map(|k| (there[k] - here[k]) * here[3 + k]).sum()
    }

    /// The linear axis that does so most.
    fn best(&self, row: &[f64]) -> (usize, f64) {
        let rates = self.linear().map(|axis| (axis, self.along(row, axis)));
        rates
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .expect("a machine with axes in closed form has linear ones")
    }

    /// The end of an axis away from the work.
    fn home(&self, axis: usize, rate: f64) -> (usize, f64) {
        let positions = self.passes.iter().flat_map(|pass| pass.iter()).map(|row| row[axis]);
        let position = match (self.machine.free[axis].travel, rate > 0.0) {
            (Some((_, high)), true) => high,
            (Some((low, _)), false) => low,
            (None, true) => positions.fold(f64::NEG_INFINITY, f64::max) + AWAY,
            (None, false) => positions.fold(f64::INFINITY, f64::min) - AWAY,
        };
        (axis, position)
    }

    /// How far before the end of a travel an axis stays that follows the tip: decimals of its words would put it beyond.
    fn short(&self, axis: usize, rate: f64) -> f64 {
        let is_near = self.by_tip && self.machine.free[axis].travel.is_some();
        if is_near { SHORT * rate.signum() } else { 0.0 }
    }

    fn rapid(&self, row: Vec<f64>, moves: impl Iterator<Item = usize>) -> ProgramRapid {
        let [x, y, z, ..] = self.machine.axes.pose(&row);
        ProgramRapid { tip: [x, y, z], moves: moves.collect(), row }
    }

    fn all_but(&self, one: usize) -> impl Iterator<Item = usize> {
        (0..self.machine.free.len()).filter(move |axis| *axis != one)
    }

    fn upright(&self, (axis, position): (usize, f64)) -> Vec<[Vec<ProgramRapid>; 2]> {
        let of_pass = |rows: &&[Vec<f64>]| {
            let away =
                |row: &[f64]| row.iter().enumerate().map(|(k, at)| if k == axis { position } else { *at }).collect();
            let [first, last] = [&rows[0], &rows[rows.len() - 1]];
            let down = self.rapid(first.clone(), [axis].into_iter());
            [vec![self.rapid(away(first), self.all_but(axis)), down], vec![self.rapid(away(last), [axis].into_iter())]]
        };
        self.passes.iter().map(of_pass).collect()
    }

    fn leaning(&self, (axis, position): (usize, f64)) -> Vec<[Vec<ProgramRapid>; 2]> {
        let mut before: Option<Vec<f64>> = None;
        let mut found = Vec::with_capacity(self.passes.len());
        for rows in self.passes {
            let [first, last] = [&rows[0], &rows[rows.len() - 1]];
            let above = self.above(first);
            let mut to = match &before {
                Some(before) => self.between(before, &above),
                None => {
                    let mut home = above.clone();
                    let (_, rate) = self.best(first);
                    home[axis] = position - self.short(axis, rate);
                    vec![self.rapid(home, self.all_but(axis)), self.rapid(above, [axis].into_iter())]
                }
            };
            to.push(self.rapid(first.clone(), self.linear()));
            let above = self.above(last);
            found.push([to, vec![self.rapid(above.clone(), self.linear())]]);
            before = Some(above);
        }
        found
    }

    /// How much the cutter lacks to stand beyond the plane over the ball about the work that is square to its axis.
    fn lacks(&self, pose: &[f64; 6]) -> f64 {
        let height: f64 = (0..3).map(|k| (pose[k] - self.hull.center[k]) * pose[3 + k]).sum();
        self.hull.radius + ABOVE - height
    }

    /// The same position with the cutter lifted along its axis until it stands there.
    fn above(&self, row: &[f64]) -> Vec<f64> {
        let pose = self.machine.axes.pose(row);
        let by = self.lacks(&pose).max(0.0);
        self.machine.axes.with_tip(row, [0, 1, 2].map(|k| pose[k] + by * pose[3 + k]))
    }

    /// From one position above the work to another.
    fn between(&self, from: &[f64], to: &[f64]) -> Vec<ProgramRapid> {
        let all = || 0..self.machine.free.len();
        let turn = self.machine.axes.rotary().map(|axis| (to[axis] - from[axis]).abs()).fold(0.0, f64::max);
        let count = (turn / TURN).ceil().max(1.0) as usize;
        let at = |k: usize| {
            let share = k as f64 / count as f64;
            from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect::<Vec<f64>>()
        };
        let on_the_way: Vec<Vec<f64>> = (1..count).map(at).collect();
        let is_low = on_the_way.iter().any(|row| self.lacks(&self.machine.axes.pose(row)) > LOWER);
        let lifted = on_the_way.iter().filter(|_| is_low || self.by_tip).map(|row| self.above(row));
        lifted.chain([to.to_vec()]).map(|row| self.rapid(row, all())).collect()
    }
}
