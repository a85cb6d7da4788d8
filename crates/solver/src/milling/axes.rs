//! The axes of a five-axis machine at a pose of a cutter, which its own turn does not change.

use flank_expr::geometry::{Axis, Chain, Step, Vector3 as Symbolic};
use flank_expr::{Expr, Graph, InstructionSet, LANES, LaneEvaluator, LaneTape, ScalarEvaluator, Tape};
use nalgebra::Vector3;

use crate::conversion::explicit::{ExplicitProblem, NotExplicit};
use crate::milling::pose::CutterPose;

/// A pose at which formulas are tried: no axis of it is special.
const SOMEWHERE: [f64; 5] = [1.0, 2.0, 3.0, 0.3, 0.4];

/// What changes no faster than this, a mm or a radian, stands still.
const STILL: f64 = 1e-9;

/// Why a machine does not take a cutter along passes; axes are told by their places.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMillAxes {
    /// A rotary axis is parallel to the spindle wherever the axes stand: it does not lean a cutter, which its own turn does not change.
    AlongSpindle {
        /// Which axis it is.
        axis: usize,
        /// How many rotary axes lean the cutter.
        leaning: usize,
    },
    /// Too many axes, or too few.
    Count {
        /// Axes that lean the cutter.
        leaning: usize,
        /// Axes that shift it alone.
        linear: usize,
    },
    /// They have no closed form.
    NotExplicit(NotExplicit),
}

impl NoMillAxes {
    /// Of a machine that has no closed form.
    fn of_machine<'g>(graph: &'g Graph, t_work_tool: &Chain<'g>, axes: &[Expr<'g>], why: NotExplicit) -> NoMillAxes {
        let direction = t_work_tool.direction(Symbolic::constant(graph, [0.0, 0.0, 1.0]));
        let of_axis = |axis: &Expr<'g>| [t_work_tool.twist(*axis).angular, direction.derivative(*axis)];
        let parts: Vec<Expr<'g>> = axes.iter().flat_map(of_axis).flat_map(|vector| vector.0).collect();
        let tape = Tape::new(&parts, axes).expect("nothing is unbound");
        // no angle of it is special
        let row: Vec<f64> = (0..axes.len()).map(|k| 0.3 + 0.4 * k as f64).collect();
        let mut values = vec![0.0; parts.len()];
        ScalarEvaluator::new(&tape).run(&row, &mut values);
        let moves = |part: &[f64]| part.iter().any(|value| value.abs() > STILL);
        let each: Vec<[bool; 2]> = values.chunks(6).map(|parts| [moves(&parts[..3]), moves(&parts[3..])]).collect();
        let leaning = each.iter().filter(|[_, leans]| *leans).count();
        let linear = each.iter().filter(|[turns, _]| !turns).count();
        match each.iter().position(|[turns, leans]| *turns && !leans) {
            Some(axis) => NoMillAxes::AlongSpindle { axis, leaning },
            None if (leaning, linear) != (2, 3) => NoMillAxes::Count { leaning, linear },
            None => NoMillAxes::NotExplicit(why),
        }
    }
}

/// The axes of a machine in closed form.
#[derive(Clone, Debug)]
pub struct MillAxes {
    elbows: [LaneTape; 2],
    forward: Tape,
    axes: usize,
    pole: [f64; 3],
    across: f64,
}

impl MillAxes {
    /// Of a machine whose cutter's frame (z out of the spindle) stands in the work by a chain in `axes`, everything else in numbers.
    ///
    /// # Errors
    /// If the machine has not two rotary and three linear axes that turn about lines and shift along lines.
    ///
    /// # Panics
    /// If the chain depends on anything but the axes.
    pub fn new<'g>(graph: &'g Graph, t_work_tool: &Chain<'g>, axes: &[Expr<'g>]) -> Result<MillAxes, NoMillAxes> {
        let spin = graph.variable("turn of the cutter");
        let target = t_work_tool.then(&Chain::new(graph, vec![Step::Rotate(Axis::Z, spin)]));
        let unknowns: Vec<Expr<'g>> = axes.iter().copied().chain([spin]).collect();
        let motions = ["x", "y", "z", "about z", "about x"].map(|name| graph.variable(format!("pose {name}")));
        let [x, y, z, about_z, about_x] = motions;
        let steps =
            vec![Step::Translate(Symbolic([x, y, z])), Step::Rotate(Axis::Z, about_z), Step::Rotate(Axis::X, about_x)];
        let source = Chain::new(graph, steps);
        let somewhere = [SOMEWHERE.to_vec()];
        let problem = ExplicitProblem {
            target: &target,
            unknowns: &unknowns,
            source: &source,
            motions: &motions,
            bindings: &[],
            line: (&somewhere, &[]),
        };
        let both = problem.both_elbows().map_err(|why| NoMillAxes::of_machine(graph, t_work_tool, axes, why))?;
        let inputs: Vec<Expr<'g>> = both.given.iter().flat_map(|vector| vector.0).collect();
        let tape = |formulas: &[Expr<'g>]| Tape::new(&formulas[..axes.len()], &inputs).expect("nothing is unbound");
        let along = Symbolic::constant(graph, [0.0, 0.0, 1.0]);
        let pose = t_work_tool.point(Symbolic::zero(graph)).0.into_iter().chain(t_work_tool.direction(along).0);
        Ok(MillAxes {
            elbows: both.formulas.each_ref().map(|formulas| LaneTape::new(&tape(formulas))),
            forward: Tape::new(&pose.collect::<Vec<_>>(), axes).expect("nothing is unbound"),
            axes: axes.len(),
            pole: both.pole,
            across: both.across,
        })
    }

    /// The axes at a pose on one of both elbows, mm and radians: angles within half a turn to both sides of zero.
    pub fn at(&self, pose: &CutterPose, elbow: usize) -> Vec<f64> {
        let [x, y, z] = pose.tip;
        let [i, j, k] = pose.axis;
        self.at_each(&[[x, y, z, i, j, k]], elbow).remove(0)
    }

    /// The same at many poses: origin of the tool and axis towards the spindle.
    pub fn at_each(&self, poses: &[[f64; 6]], elbow: usize) -> Vec<Vec<f64>> {
        let mut evaluator = LaneEvaluator::new(&self.elbows[elbow], InstructionSet::widest());
        let mut found = Vec::with_capacity(poses.len());
        for some in poses.chunks(LANES) {
            for (lane, [x, y, z, i, j, k]) in some.iter().enumerate() {
                let out_of_spindle = -Vector3::new(*i, *j, *k);
                let least = out_of_spindle.iamin();
                let across = out_of_spindle.cross(&Vector3::ith(least, 1.0)).normalize() * self.across;
                let inputs = out_of_spindle.iter().chain(&across).chain([x, y, z]);
                inputs.enumerate().for_each(|(k, value)| evaluator.input(k)[lane] = *value);
            }
            evaluator.run_first(some.len());
            found.extend((0..some.len()).map(|lane| (0..self.axes).map(|k| evaluator.output(k)[lane]).collect()));
        }
        found
    }

    /// Origin and axis of the cutter, towards the spindle, in the work's frame where the axes stand so.
    pub fn pose(&self, axes: &[f64]) -> [f64; 6] {
        let mut out = [0.0; 6];
        ScalarEvaluator::new(&self.forward).run(axes, &mut out);
        let [x, y, z, i, j, k] = out;
        [x, y, z, -i, -j, -k]
    }

    /// The direction of the first rotary axis as seen from the work, in its frame.
    pub fn pole(&self) -> [f64; 3] {
        self.pole
    }

    /// The angle between the cutter's axis and the first rotary axis as seen from the work, radians: where it is zero, that axis is free.
    pub fn from_pole(&self, axis: [f64; 3]) -> f64 {
        let (axis, pole) = (Vector3::from(axis), Vector3::from(self.pole));
        axis.cross(&pole).norm().atan2(axis.dot(&pole).abs())
    }

    /// The least such angle while the cutter's axis turns from one direction to another.
    pub fn from_pole_between(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        let at_ends = self.from_pole(from).min(self.from_pole(to));
        let [a, b, pole] = [from, to, self.pole].map(Vector3::from);
        let across = a.cross(&b);
        // the direction in the plane of the turn that is nearest to the pole: passed where both ends, or those opposite, lie beside it
        let nearest = pole * across.norm_squared() - across * across.dot(&pole);
        let is_passed = a.cross(&nearest).dot(&across) * nearest.cross(&b).dot(&across) > 0.0;
        if is_passed { at_ends.min(self.from_pole(nearest.into())) } else { at_ends }
    }
}
