//! The axes of the milling machine along passes.

use std::f64::consts::TAU;

use flank_chain_dsl::{Axis, Job, LawSource, Machine as JobMachine, Milling};
use flank_expr::Expr;
use flank_expr::geometry::Chain;
use flank_solver::{MillAxes, NoMillAxes, PoseSeries};
use nalgebra::{Matrix3, Vector3};

use crate::convert::files::decimals;
use crate::convert::is_mirrored;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::units;

/// Points through which the motion of one block is known.
const POINTS_OF_BLOCK: usize = 9;
/// Axes that do not bring the cutter where it should be by more than this are no solution, mm or parts of a unit vector.
const MET: f64 = 1e-8;
/// A rotary axis that turns farther in one block, radians, ...
const FAR: f64 = 0.5;
/// ... while the cutter's axis is nearer to the pole than this, where it turns ten times as far as that, goes through the pole. Farther off a long
/// block turns it as far.
const SWINGS: f64 = 0.1;
/// Angles that come from cosines are known to the root of rounding where these are near one: a direction is beyond reach by more than this, and
/// at the pole within it, radians.
const ALIKE: f64 = 1e-6;

/// A machine that takes the cutter along passes.
pub(super) struct Machine<'p, 'g> {
    pub(super) machine: &'p JobMachine<'g>,
    /// The axes that stand free.
    pub(super) free: Vec<&'p Axis<'g>>,
    /// The same in numbers.
    pub(super) axes: FreeAxes,
    /// The cutter in the work, in the free axes.
    pub(super) chain: Chain<'g>,
    /// From the work to the cutter it makes a mirror image.
    is_mirrored: bool,
}

/// Free axes in numbers.
pub(super) struct FreeAxes {
    closed: MillAxes,
    elbow: usize,
    is_rotary: Vec<bool>,
    travels: Vec<Option<(f64, f64)>>,
}

/// Why there are no axes.
pub(super) enum NoMachine {
    NotWorkedOut(NoMillAxes),
    NoFreeAxis,
}

impl NoMachine {
    /// In words; nothing where no axis is free.
    pub(super) fn told(&self, machine: &JobMachine<'_>) -> Option<Remark> {
        let NoMachine::NotWorkedOut(why) = self else { return None };
        let name = &machine.name;
        let remark = |why: String, ways: Vec<String>| {
            let message = format!("the axes of {name} are not worked out: {why}");
            Some(Remark::new(RemarkKind::NoAxes, name, message).with(ways))
        };
        let free = || machine.axes.iter().filter(|axis| axis.source == LawSource::Free);
        match why {
            NoMillAxes::AlongSpindle { axis, leaning } => {
                let axis = free().nth(*axis).map_or("a rotary axis", |axis| axis.name.as_str());
                let others = match leaning {
                    0 => "no other rotary axis does".to_string(),
                    1 => "1 other rotary axis does".to_string(),
                    many => format!("{many} other rotary axes do"),
                };
                let why = format!(
                    "{axis} is parallel to the spindle, and a turn about its own axis does not lean a cutter; {others}, and two are needed"
                );
                let way = match leaning {
                    0 | 1 => "take a machine with two rotary axes that lean the spindle against the work".to_string(),
                    _ => format!("hold it still in a variant of the machine: `fix {axis} = 0 deg`"),
                };
                remark(why, vec![way])
            }
            NoMillAxes::Count { leaning, linear } => {
                let why = format!(
                    "its free axes that lean the spindle against the work are {leaning}, those that shift it {linear}; it takes two and three"
                );
                let way = "take another machine, or hold what is too much still in a variant: `fix`".to_string();
                remark(why, vec![way])
            }
            NoMillAxes::NotExplicit(why) => remark(why.to_string(), Vec::new()),
        }
    }
}

impl<'p, 'g> Machine<'p, 'g> {
    pub(super) fn of_milling(job: &'p Job<'g>, milling: &Milling<'g>) -> Result<Machine<'p, 'g>, NoMachine> {
        Machine::with_bindings(job, milling, &[&job.bindings()])
    }

    /// The same with the values of parameters, put in one after the other.
    pub(super) fn with_bindings(
        job: &'p Job<'g>,
        milling: &Milling<'g>,
        bindings: &[&[(Expr<'g>, Expr<'g>)]],
    ) -> Result<Machine<'p, 'g>, NoMachine> {
        let machine = &job.machines[milling.machine];
        let free: Vec<&Axis<'g>> = machine.axes.iter().filter(|axis| axis.source == LawSource::Free).collect();
        let Some(first) = free.first() else { return Err(NoMachine::NoFreeAxis) };
        let graph = first.variable.graph();
        let followers = machine.axes.iter().filter(|axis| axis.law != axis.variable);
        let laws: Vec<(Expr<'g>, Expr<'g>)> = followers.map(|axis| (axis.variable, axis.law)).collect();
        let chain = milling.t_work_tool.substituted(&laws);
        let chain = bindings.iter().fold(chain, |chain, bindings| chain.substituted(bindings));
        let variables: Vec<Expr<'g>> = free.iter().map(|axis| axis.variable).collect();
        let closed = MillAxes::new(graph, &chain, &variables).map_err(NoMachine::NotWorkedOut)?;
        let axes = FreeAxes {
            closed,
            elbow: 0,
            is_rotary: free.iter().map(|axis| units::is_angle(axis.dimension)).collect(),
            travels: free.iter().map(|axis| axis.travel).collect(),
        };
        Ok(Machine { machine, free, axes, chain, is_mirrored: is_mirrored(&milling.t_work_tool) })
    }

    /// The same on the elbow on which these poses stay within the travels, and turn less.
    pub(super) fn on_best_elbow(self, passes: &[Vec<[f64; 6]>]) -> Machine<'p, 'g> {
        Machine { axes: self.axes.on_best_elbow(passes), ..self }
    }

    /// Where the axes stand with the tip in the zero of the work, while words of rotary ones say zero.
    pub(super) fn at_zero(&self) -> Vec<f64> {
        let unsaid = |(k, axis): (usize, &&Axis<'g>)| match (self.axes.is_rotary(k), axis.word.reversed) {
            (true, true) => axis.word.offset,
            (true, false) => -axis.word.offset,
            (false, _) => 0.0,
        };
        self.axes.with_tip(&self.free.iter().enumerate().map(unsaid).collect::<Vec<f64>>(), [0.0; 3])
    }

    /// How far the words of an axis are rounded, mm or radians: half of the last decimal.
    pub(super) fn rounding(&self, axis: usize) -> f64 {
        let own = self.free[axis];
        let half = 0.5 * 0.1_f64.powi(i32::from(decimals(own.dimension, &own.word)));
        if self.axes.is_rotary(axis) { half.to_radians() } else { half }
    }

    /// How far rounded words put a point of the cutter beside where it should be, at the most, mm; the point is no farther than `reach` from the tip.
    pub(super) fn rounded(&self, axes: &[f64], reach: f64) -> f64 {
        let here = self.axes.pose(axes);
        let by_axis = |axis: usize| {
            let mut moved = axes.to_vec();
            moved[axis] += self.rounding(axis);
            moved_by(&here, &self.axes.pose(&moved), reach)
        };
        (0..axes.len()).map(by_axis).sum()
    }

    /// That the axes do not bring the cutter to one of some poses, whatever their travels; the one that is farthest off is told.
    pub(super) fn unreached(&self, poses: &[[f64; 6]], place: impl Fn(usize) -> String) -> Option<NotDone> {
        let off = |k: usize| {
            let row = self.axes.along(&poses[k..=k]).remove(0);
            let reached = self.axes.pose(&row);
            let by = (0..6).map(|i| (reached[i] - poses[k][i]).abs()).fold(0.0, f64::max);
            // where an axis would have to stand at no real angle
            if reached.iter().all(|x| x.is_finite()) { by } else { f64::INFINITY }
        };
        let reach = self.axes.reach();
        let angle = |k: usize| reach.as_ref().map_or(0.0, |reach| reach.angle(&poses[k]));
        let beyond =
            |k: usize| reach.as_ref().map_or(0.0, |reach| (reach.ends[0] - angle(k)).max(angle(k) - reach.ends[1]));
        let missed = (0..poses.len()).filter(|k| off(*k) > MET);
        let worst = missed.max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)))?;
        let name = &self.machine.name;
        if self.axes.angle_from_pole(&poses[worst]) < ALIKE && beyond(worst) < ALIKE {
            let free = reach.as_ref().map_or("a rotary axis", |reach| self.free[reach.first].name.as_str());
            let message = format!("{name} holds the spindle at its pole at {}: {free} is free there", place(worst));
            let way = "lean the cutter away with `lead` or `tilt`, or clamp the work at another angle".to_string();
            return Some(NotDone::new(NotDoneKind::NotReached, name, message).with(vec![way]));
        }
        let why = match &reach {
            _ if self.is_mirrored => {
                "it is of the other hand: from the work to the cutter it makes a mirror image, and no motion is its own mirror image".to_string()
            }
            Some(reach) if beyond(worst) > ALIKE => format!(
                "it would stand {:.3} deg from the axis of {}, and {:.3} deg .. {:.3} deg are reached",
                angle(worst).to_degrees(),
                self.free[reach.first].name,
                reach.ends[0].to_degrees(),
                reach.ends[1].to_degrees()
            ),
            _ => format!(
                "{:.3} deg from where a rotary axis is free",
                self.axes.angle_from_pole(&poses[worst]).to_degrees()
            ),
        };
        let message = format!("the axes of {name} cannot bring the spindle to its direction at {}", place(worst));
        let way = match self.is_mirrored {
            true => "`mirror` one of the frames between them in a variant of the machine",
            false => "clamp the work at another angle, or lean the cutter otherwise with `lead` and `tilt`",
        };
        Some(NotDone::new(NotDoneKind::NotReached, name, message).with(vec![why, way.to_string()]))
    }

    /// What the machine cannot do on a pass: the first axis beyond its travel, a pole, or a pose that it does not reach.
    pub(super) fn faults(
        &self,
        poses: &[[f64; 6]],
        rows: &[Vec<f64>],
        place: impl Fn(usize) -> String,
    ) -> Vec<NotDone> {
        let mut found = Vec::new();
        let name = &self.machine.name;
        if let Some(missed) = self.unreached(poses, &place) {
            return vec![missed];
        }
        for axis in 0..self.free.len() {
            let Some((low, high)) = self.free[axis].travel else { continue };
            let slack = 1e-9 * (high - low);
            let beyond = |row: &Vec<f64>| (low - row[axis]).max(row[axis] - high);
            let worst = (0..rows.len()).max_by(|a, b| beyond(&rows[*a]).total_cmp(&beyond(&rows[*b])));
            if let Some(k) = worst.filter(|k| beyond(&rows[*k]) > slack) {
                let dimension = self.free[axis].dimension;
                let text = |value: f64| units::text(dimension, value, 3);
                let message = format!(
                    "{name} goes beyond the travel of {}: {} at {}, its travel is {} .. {}",
                    self.free[axis].name,
                    text(rows[k][axis]),
                    place(k),
                    text(low),
                    text(high)
                );
                let way = "clamp the work elsewhere: change the settings of the machine".to_string();
                found.push(NotDone::new(NotDoneKind::BeyondTravel, &self.free[axis].name, message).with(vec![way]));
            }
        }
        for axis in self.axes.rotary() {
            let turn = |k: usize| (rows[k + 1][axis] - rows[k][axis]).abs();
            let from_pole = |k: usize| self.axes.block_from_pole(&poses[k], &poses[k + 1]);
            let swings = (0..rows.len().saturating_sub(1)).filter(|k| turn(*k) > FAR && from_pole(*k) < SWINGS);
            if let Some(k) = swings.max_by(|a, b| turn(*a).total_cmp(&turn(*b))) {
                let message = format!(
                    "{} of {name} turns by {:.1} deg in the block at {}: the cutter's axis passes the pole, {:.3} deg from it",
                    self.free[axis].name,
                    turn(k).to_degrees(),
                    place(k),
                    from_pole(k).to_degrees()
                );
                let way = "lean the cutter away with `lead` or `tilt`, or clamp the work at another angle".to_string();
                found.push(NotDone::new(NotDoneKind::NotReached, name, message).with(vec![way]));
            }
        }
        found
    }
}

/// The directions in which rotary axes hold a cutter.
struct Reach {
    /// The rotary axis that does not change the angle from its own direction: the first as seen from the work.
    first: usize,
    /// Its direction in the work.
    pole: Vector3<f64>,
    /// Between which angles from that the other one brings the cutter's axis, radians.
    ends: [f64; 2],
}

impl Reach {
    fn angle(&self, pose: &[f64; 6]) -> f64 {
        let axis = Vector3::new(pose[3], pose[4], pose[5]);
        axis.cross(&self.pole).norm().atan2(axis.dot(&self.pole))
    }
}

/// How far a point of the cutter moves from one pose to another, at the most, mm; it is no farther than `reach` from the tip.
pub(super) fn moved_by(from: &[f64; 6], to: &[f64; 6], reach: f64) -> f64 {
    let turned = (3..6).map(|k| (from[k] - to[k]).powi(2)).sum::<f64>().sqrt();
    super::distance(from, to) + reach * turned
}

impl FreeAxes {
    /// The same on the elbow on which these poses stay within the travels, and turn less.
    fn on_best_elbow(self, passes: &[Vec<[f64; 6]>]) -> FreeAxes {
        let cost = |elbow: usize| {
            let beyond = |row: &Vec<f64>| {
                let each = row.iter().zip(&self.travels).map(|(at, travel)| match *travel {
                    Some((low, high)) => (low - at).max(at - high).max(0.0),
                    None => 0.0,
                });
                each.sum::<f64>()
            };
            let lines = passes.iter().map(|pass| self.on_elbow(pass, elbow));
            lines.fold((0.0, 0.0), |(missed, turned): (f64, f64), line| {
                let off: f64 = line.iter().map(beyond).sum();
                let turns: f64 = line.iter().map(|row| self.rotary().map(|k| row[k].abs()).sum::<f64>()).sum();
                (missed + off, turned + turns)
            })
        };
        let [first, second] = [0, 1].map(cost);
        let elbow = usize::from(second.0 < first.0 || second.0 == first.0 && second.1 < first.1);
        FreeAxes { elbow, ..self }
    }

    /// Where the cutter's axis goes; `None` unless one of the rotary axes leaves its angle from the pole as it is.
    fn reach(&self) -> Option<Reach> {
        const THIRDS: [f64; 3] = [0.0, TAU / 3.0, 2.0 * TAU / 3.0];
        let pole = Vector3::from(self.closed.pole());
        let pole = if pole.z < 0.0 { -pole } else { pole };
        // over a turn of an axis the cosine of that angle is a mean and a swing
        let swing = |axis: usize| {
            let cosines = THIRDS.map(|at| {
                let mut row = vec![0.0; self.is_rotary.len()];
                row[axis] = at;
                let [_, _, _, i, j, k] = self.closed.pose(&row);
                pole.dot(&Vector3::new(i, j, k))
            });
            let mean = cosines.iter().sum::<f64>() / 3.0;
            (mean, (cosines.iter().map(|x| (x - mean).powi(2)).sum::<f64>() * 2.0 / 3.0).sqrt())
        };
        let first = self.rotary().min_by(|a, b| swing(*a).1.total_cmp(&swing(*b).1))?;
        let (mean, by) = swing(self.rotary().find(|axis| *axis != first)?);
        let ends = [mean + by, mean - by].map(|cosine| cosine.clamp(-1.0, 1.0).acos());
        (swing(first).1 < MET).then_some(Reach { first, pole, ends })
    }

    pub(super) fn rotary(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.is_rotary.len()).filter(|k| self.is_rotary(*k))
    }

    pub(super) fn is_rotary(&self, axis: usize) -> bool {
        self.is_rotary[axis]
    }

    /// The axes at poses one after the other: angles go on without jumps, and begin within their travel if they can.
    pub(super) fn along(&self, poses: &[[f64; 6]]) -> Vec<Vec<f64>> {
        self.on_elbow(poses, self.elbow)
    }

    fn on_elbow(&self, poses: &[[f64; 6]], elbow: usize) -> Vec<Vec<f64>> {
        let mut rows = self.closed.at_each(poses, elbow);
        for axis in self.rotary() {
            for k in 1..rows.len() {
                let before = rows[k - 1][axis];
                rows[k][axis] -= TAU * ((rows[k][axis] - before) / TAU).round();
            }
            let Some((low, high)) = self.travels[axis] else { continue };
            let values = rows.iter().map(|row| row[axis]);
            let (least, most) =
                (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
            let turns = [0.0, -1.0, 1.0, -2.0, 2.0];
            let fits = turns.into_iter().map(|turn| turn * TAU).find(|by| least + by >= low && most + by <= high);
            rows.iter_mut().for_each(|row| row[axis] += fits.unwrap_or(0.0));
        }
        rows
    }

    /// The cutter while all axes go straight from one position to another.
    pub(super) fn straight(&self, from: &[f64], to: &[f64]) -> PoseSeries {
        PoseSeries::sampled(POINTS_OF_BLOCK, |share| {
            let at: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
            self.closed.pose(&at)
        })
    }

    /// The cutter while its tip goes straight and the rotary axes turn evenly: tool-centre control.
    pub(super) fn straight_tip(&self, from: &[f64], to: &[f64]) -> PoseSeries {
        let [tip, end] = [from, to].map(|axes| self.closed.pose(axes));
        PoseSeries::sampled(POINTS_OF_BLOCK, |share| {
            let at: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
            let mut pose = self.closed.pose(&at);
            (0..3).for_each(|k| pose[k] = tip[k] + share * (end[k] - tip[k]));
            pose
        })
    }

    /// The axes with linear ones that bring the tip to a place.
    pub(super) fn with_tip(&self, axes: &[f64], tip: [f64; 3]) -> Vec<f64> {
        let linear: Vec<usize> = (0..axes.len()).filter(|axis| !self.is_rotary[*axis]).collect();
        let at = |axes: &[f64]| {
            let [x, y, z, ..] = self.closed.pose(axes);
            Vector3::new(x, y, z)
        };
        let here = at(axes);
        let mut found = axes.to_vec();
        let shift = |axis: &usize| {
            let mut moved = axes.to_vec();
            moved[*axis] += 1.0;
            at(&moved) - here
        };
        let shifts = Matrix3::from_columns(&linear.iter().map(shift).collect::<Vec<_>>());
        let by = shifts.lu().solve(&(Vector3::from(tip) - here)).expect("the linear axes of closed forms span space");
        linear.iter().zip(by.iter()).for_each(|(axis, by)| found[*axis] += by);
        found
    }

    /// Where the axes bring the cutter.
    pub(super) fn pose(&self, axes: &[f64]) -> [f64; 6] {
        self.closed.pose(axes)
    }

    /// The least angle of the cutter's axis from where a rotary axis is free while it turns from one pose to another, radians.
    fn block_from_pole(&self, from: &[f64; 6], to: &[f64; 6]) -> f64 {
        self.closed.from_pole_between([from[3], from[4], from[5]], [to[3], to[4], to[5]])
    }

    /// The angle of the cutter's axis from where a rotary axis is free, radians.
    pub(super) fn angle_from_pole(&self, row: &[f64; 6]) -> f64 {
        self.closed.from_pole([row[3], row[4], row[5]])
    }
}
