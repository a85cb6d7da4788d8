//! What a control with tool-centre control makes of its words: it knows lines that its rotary axes turn about, and no frames of a spec.

use flank_export::{TipFrame, TipTurn};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::machine::Machine;
use crate::project::remark::{NotDone, NotDoneKind};

/// The words of a tip.
pub(super) const OF_TIP: [&str; 3] = ["X", "Y", "Z"];
/// Directions and turns that differ by no more than this are the same.
const SAME: f64 = 1e-9;
/// Lines of axes are those of the machine if the tip comes so near to where its frames bring it, mm.
const MET: f64 = 1e-6;
/// Places at which that is looked at: a tip, mm, and turns from zero, radians.
const PLACES: [([f64; 3], [f64; 2]); 3] =
    [([0.0, 0.0, 0.0], [0.7, -1.1]), ([31.0, -17.0, 53.0], [-0.4, 2.3]), ([-12.0, 71.0, -29.0], [1.9, 0.6])];

/// The machine as a control knows it. Its frame has the axes of the words X Y Z, and its origin where the tip is at the zero of the work while rotary
/// words say zero. Words of the tip are places in a frame that coincides with it then, and goes with the work.
pub(super) struct Control {
    /// Where all axes stand then, mm and radians.
    zero: Vec<f64>,
    /// Which axes X Y Z are.
    linear: [usize; 3],
    /// Of each axis, whether its word grows as its position does.
    signs: Vec<f64>,
    /// What carries the work, and what carries the spindle; those that the others carry come first.
    of_work: Vec<Turn>,
    of_spindle: Vec<Turn>,
    /// The frame in that of the work.
    in_work: Matrix3<f64>,
}

/// A rotary axis.
struct Turn {
    axis: usize,
    /// Right-handed about it its word grows.
    about: Unit<Vector3<f64>>,
    through: Vector3<f64>,
}

impl Turn {
    fn turned(&self, place: Vector3<f64>, by: f64) -> Vector3<f64> {
        self.through + Rotation3::from_axis_angle(&self.about, by) * (place - self.through)
    }
}

/// That no control with tool-centre control knows such a machine.
pub(super) struct Unknown {
    why: String,
    way: &'static str,
}

impl Unknown {
    fn new(why: String, way: &'static str) -> Unknown {
        Unknown { why, way }
    }

    pub(super) fn message(&self, machine: &Machine<'_, '_>) -> String {
        format!("no tool-centre control keeps the tip of {} on its way: {}", machine.machine.name, self.why)
    }

    pub(super) fn told(&self, machine: &Machine<'_, '_>) -> NotDone {
        let without = "or leave option `tool_centre_control` out: words are positions of the axes then";
        NotDone::new(NotDoneKind::NotReached, &machine.machine.name, self.message(machine))
            .with(vec![self.way.to_string(), without.to_string()])
    }
}

/// How the tool moves in the work, as seen from the tool, where the axes stand at their zero.
struct Screw {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

/// Those of all axes, a mm or a radian of their words.
fn screws(machine: &Machine<'_, '_>, zero: &[f64], signs: &[f64]) -> Vec<Screw> {
    let variables: Vec<Expr<'_>> = machine.free.iter().map(|axis| axis.variable).collect();
    let twists = variables.iter().map(|variable| machine.chain.twist(*variable));
    let parts: Vec<Expr<'_>> = twists.flat_map(|twist| twist.angular.0.into_iter().chain(twist.linear.0)).collect();
    let tape = Tape::new(&parts, &variables).expect("the chain depends on its axes only");
    let mut values = vec![0.0; parts.len()];
    ScalarEvaluator::new(&tape).run(zero, &mut values);
    let of_axis = |(parts, sign): (&[f64], &f64)| Screw {
        angular: *sign * Vector3::from_column_slice(&parts[..3]),
        linear: *sign * Vector3::from_column_slice(&parts[3..]),
    };
    values.chunks(6).zip(signs).map(of_axis).collect()
}

impl Control {
    /// # Errors
    /// If its words cannot say where the tip is.
    pub(super) fn of_machine(machine: &Machine<'_, '_>) -> Result<Control, Unknown> {
        let zero = machine.at_zero();
        let signs: Vec<f64> = machine.free.iter().map(|axis| if axis.word.reversed { -1.0 } else { 1.0 }).collect();
        let linear = linear_axes(machine)?;
        let screws = screws(machine, &zero, &signs);
        let in_tool = Matrix3::from_columns(&linear.map(|axis| screws[axis].linear));
        if (in_tool.transpose() * in_tool - Matrix3::identity()).amax() > SAME || in_tool.determinant() < 0.0 {
            let why = "X Y Z, as their words count, are not a right-handed frame of directions square to each other";
            let way = "`nc` words with or without a sign say how the control counts";
            return Err(Unknown::new(why.to_string(), way));
        }
        let mut control = Control {
            in_work: in_work(machine, &zero, linear, &signs),
            zero,
            linear,
            signs,
            of_work: Vec::new(),
            of_spindle: Vec::new(),
        };
        let mut rotary: Vec<usize> = machine.axes.rotary().collect();
        // as seen from the work
        rotary.sort_by_key(|axis| {
            let variable = machine.free[*axis].variable;
            machine.chain.steps().iter().position(|step| !step.twist(variable.graph(), variable).is_zero())
        });
        for axis in rotary {
            let turn = turn(machine, axis, &screws[axis], in_tool)?;
            let mut turned = control.zero.clone();
            turned[axis] += 1.0;
            let carries_work = (in_work(machine, &turned, linear, &control.signs) - control.in_work).amax() > SAME;
            match carries_work {
                true => control.of_work.push(Turn { about: -turn.about, ..turn }),
                false => control.of_spindle.insert(0, turn),
            }
        }
        if control.off(machine) > MET {
            let why = "its axes do not turn about lines that stand still".to_string();
            return Err(Unknown::new(why, "controls know no other rotary axes"));
        }
        Ok(control)
    }

    /// How far from its words the frames of the machine bring the tip, mm.
    fn off(&self, machine: &Machine<'_, '_>) -> f64 {
        let of_place = |(tip, turns): &([f64; 3], [f64; 2])| {
            let mut row = self.zero.clone();
            self.of_work.iter().chain(&self.of_spindle).zip(turns).for_each(|(turn, by)| row[turn.axis] += by);
            let [x, y, z, ..] = machine.axes.pose(&self.axes(*tip, &row));
            (Vector3::new(x, y, z) - self.in_work * Vector3::from(*tip)).norm()
        };
        PLACES.iter().map(of_place).fold(0.0, f64::max)
    }

    /// The words for a tip that is given in the work.
    pub(super) fn words(&self, tip: [f64; 3]) -> [f64; 3] {
        (self.in_work.transpose() * Vector3::from(tip)).into()
    }

    /// Where a control brings the linear axes for words of the tip, with the rotary ones where they stand in `row`.
    pub(super) fn axes(&self, words: [f64; 3], row: &[f64]) -> Vec<f64> {
        let carried = |turns: &[Turn], place: Vector3<f64>| {
            turns.iter().fold(place, |place, turn| turn.turned(place, self.said(row, turn.axis)))
        };
        let slides = carried(&self.of_work, Vector3::from(words)) - carried(&self.of_spindle, Vector3::zeros());
        let mut found = row.to_vec();
        for (axis, slide) in self.linear.into_iter().zip(slides.iter()) {
            found[axis] = self.position(axis, *slide);
        }
        found
    }

    /// The words of the tip where the axes stand so.
    pub(super) fn tip(&self, row: &[f64]) -> [f64; 3] {
        let origin = Vector3::zeros();
        let by_spindle = self.of_spindle.iter().fold(origin, |at, turn| turn.turned(at, self.said(row, turn.axis)));
        let at = by_spindle + Vector3::from(self.linear.map(|axis| self.said(row, axis)));
        self.of_work.iter().rev().fold(at, |at, turn| turn.turned(at, -self.said(row, turn.axis))).into()
    }

    /// Where an axis stands while its word, counted from the zero of the work, says so.
    pub(super) fn position(&self, axis: usize, word: f64) -> f64 {
        self.zero[axis] + self.signs[axis] * word
    }

    /// By how much the word of an axis differs from that at the zero.
    fn said(&self, row: &[f64], axis: usize) -> f64 {
        self.signs[axis] * (row[axis] - self.zero[axis])
    }

    /// What the head of a program says of it; `work` is the frame of the work.
    pub(super) fn frame(&self, work: &str) -> TipFrame {
        let of_turns = |turns: &[Turn], carries_work: bool| {
            let turn = |turn: &Turn| TipTurn {
                axis: turn.axis,
                carries_work,
                about: turn.about.into_inner().into(),
                through: turn.through.into(),
            };
            turns.iter().map(turn).collect::<Vec<TipTurn>>()
        };
        let of_work = |k: usize| self.in_work.row(k).transpose().into();
        TipFrame {
            work: work.to_string(),
            zero: self.zero.clone(),
            linear: self.linear,
            work_x: of_work(0),
            work_z: of_work(2),
            turns: [of_turns(&self.of_work, true), of_turns(&self.of_spindle, false)].concat(),
        }
    }
}

/// The axes that are called X, Y and Z.
fn linear_axes(machine: &Machine<'_, '_>) -> Result<[usize; 3], Unknown> {
    let called = |address: &str| {
        let is_called = |(k, axis): &(usize, &&flank_chain_dsl::Axis<'_>)| {
            axis.word.address == address && !machine.axes.is_rotary(*k)
        };
        machine.free.iter().enumerate().find(is_called).map(|(k, _)| k)
    };
    if let [Some(x), Some(y), Some(z)] = OF_TIP.map(called) {
        return Ok([x, y, z]);
    }
    let names = machine.free.iter().enumerate().filter(|(k, _)| !machine.axes.is_rotary(*k));
    let names: Vec<&str> = names.map(|(_, axis)| axis.word.address.as_str()).collect();
    let why = format!("its linear axes have the words {}, and those of a tip are X Y Z", names.join(" "));
    Err(Unknown::new(why, "`nc X = …`, `nc Y = …` and `nc Z = …` say which axes these are"))
}

/// The directions of the words X Y Z in the work.
fn in_work(machine: &Machine<'_, '_>, zero: &[f64], linear: [usize; 3], signs: &[f64]) -> Matrix3<f64> {
    let here = machine.axes.pose(zero);
    let direction = |axis: usize| {
        let mut moved = zero.to_vec();
        moved[axis] += signs[axis];
        let there = machine.axes.pose(&moved);
        Vector3::from([0, 1, 2].map(|k| there[k] - here[k]))
    };
    Matrix3::from_columns(&linear.map(direction))
}

/// The line of a rotary axis, from how the tool moves with it.
fn turn(machine: &Machine<'_, '_>, axis: usize, screw: &Screw, in_tool: Matrix3<f64>) -> Result<Turn, Unknown> {
    let [angular, linear] = [screw.angular, screw.linear].map(|vector| in_tool.transpose() * vector);
    let name = &machine.free[axis].name;
    let rate = angular.norm();
    if (rate - 1.0).abs() > SAME {
        let why = format!("{name} turns by {} deg for each degree of its word", flank_export::fixed(rate, 6));
        return Err(Unknown::new(why, "give the machine an axis that turns as its word says"));
    }
    let along = angular.dot(&linear);
    if along.abs() > SAME {
        let why = format!("{name} shifts along its own line while it turns");
        return Err(Unknown::new(why, "give the machine an axis that turns about a line which stands still"));
    }
    Ok(Turn { axis, about: Unit::new_normalize(angular), through: angular.cross(&linear) })
}
