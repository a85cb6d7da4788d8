//! The same relative pose on another machine: axis values for which tool and work stand to each other as they do on the first.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Svd};
use flank_expr::geometry::{Chain, Pose, Step, Twist};
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};
use thiserror::Error;

use crate::conversion::orientation;
use crate::conversion::symmetry::{Screw, doubled, slipping};
use crate::equations::solution::{Outcome, ROUNDING, Range, Solution, distance};
use crate::equations::system::{Evaluation, Linearized, System};
use crate::equations::tolerance::TOLERANCE;
use crate::newton::multistart::{WIDELY, probe, scan};
use crate::newton::scalar::solve_with;

/// Halvings of a step along the motion until the axes follow.
const MOST_HALVINGS: u32 = 12;
/// Of its range, or of a turn, no axis moves farther in one step beyond where it was expected.
const FARTHEST_STEP: f64 = 0.02;
/// Of a pose: displacements along x, y, z, turns about them.
const COMPONENTS: usize = 6;
/// Postures that the next one is expected from.
const MOST_PASSED: usize = 6;
/// Where steps get longer, rounding of the last postures grows by the sum of their weights: fewer postures count then.
const LARGEST_WEIGHTS: f64 = 100.0;
/// Where it has no travel, a rotary axis turns as far as it must; this is how far it may (rad).
const FREE_TURNS: f64 = 1e4;

/// Where the axes of the target machine have to stand while the source's motions run.
#[derive(Clone, Debug)]
pub struct PoseProblem<'g> {
    /// From work to tool on the target machine, followed by the motions that leave the tool unchanged.
    chain: Chain<'g>,
    /// Axes, then amounts of the tool's own symmetries.
    unknowns: Vec<Expr<'g>>,
    /// By these amounts.
    slips: Vec<Step<'g>>,
    motions: Vec<Expr<'g>>,
    /// What vanishes where the pose is met: displacements, then turns.
    deviation: Vec<Expr<'g>>,
    /// What is positive there, and negative half a turn away.
    upright: Expr<'g>,
    /// Parameters: the source's motions.
    system: System,
    /// What of the pose the axes cannot reach: components of the deviation that must come out as zero.
    rest: Tape,
    components: Vec<usize>,
    axes: usize,
    is_rotary: Vec<bool>,
    travels: Vec<Range>,
    /// Where postures are looked for: within travel and one turn of each rotary axis, and wherever else they may be.
    search: [Vec<Range>; 2],
}

/// An axis of the target machine.
#[derive(Clone, Copy, Debug)]
pub struct TargetAxis<'g> {
    /// Its variable in the chain.
    pub variable: Expr<'g>,
    /// Whether it turns.
    pub is_rotary: bool,
    /// Its travel, mm or radians, if it ends.
    pub travel: Option<Range>,
}

/// Why no posture can be asked for.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PoseError {
    /// There are more free axes than a pose needs, and more than one way to stand.
    #[error("{0} axes more than the pose needs: it does not tell where they stand")]
    Redundant(usize),
    /// Something depends on a variable that is not given.
    #[error(transparent)]
    Unbound(#[from] TapeError),
}

/// The axes at one value of the motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    /// The verdict; [`Outcome::Outside`] names the axis that is beyond its travel. The values are those of the pose all the same.
    pub outcome: Outcome,
    /// Axis values, mm or radians, rotary axes continuous from posture to posture.
    pub axes: Vec<f64>,
    /// What of the pose is not reached, if anything.
    pub missing: Option<Missing>,
    /// The axes, and by how much the tool slides along itself.
    unknowns: Vec<f64>,
}

/// The part of a pose that a machine has no axis for, seen in the tool's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missing {
    /// 0 to 2: displacement along x, y, z; 3 to 5: turn about them.
    pub direction: usize,
    /// How much is missing, mm or radians.
    pub by: f64,
}

impl Posture {
    /// The tool stands as it should, within travel or beyond it.
    pub(crate) fn is_root(&self) -> bool {
        self.outcome.is_root()
    }

    /// The axes, and by how much the tool slides along itself, as in [`PoseProblem::unknowns`].
    pub fn unknowns(&self) -> &[f64] {
        &self.unknowns
    }
}

impl<'g> PoseProblem<'g> {
    /// `target` and `source` lead from work to tool on the two machines; `symmetries` are the motions that leave the tool
    /// unchanged ([`symmetries`](crate::symmetries)). `reach` is a length (mm) beyond which no linear axis without travel has to go.
    ///
    /// An axis of the target that only turns or shifts the tool along itself takes over what the source does there; where there are
    /// axes enough without it, the tool stands exactly as on the source.
    ///
    /// # Errors
    /// If more axes are free than a pose needs, or something depends on a variable that is not given.
    pub fn new(
        target: &Chain<'g>,
        axes: &[TargetAxis<'g>],
        source: &Chain<'g>,
        motions: &[Expr<'g>],
        symmetries: &[Screw],
        reach: f64,
    ) -> Result<PoseProblem<'g>, PoseError> {
        let graph = motions[0].graph();
        let variables: Vec<Expr<'g>> = axes.iter().map(|axis| axis.variable).collect();
        let mut slips = symmetries.to_vec();
        while let Some(slip) = doubled(target, &variables, &[], &slips)? {
            slips.remove(slip);
        }
        // with axes enough the tool may as well stand exactly as it does on the source
        slips.truncate(6usize.saturating_sub(variables.len()));
        if variables.len() > 6 {
            return Err(PoseError::Redundant(variables.len() - 6));
        }
        let (slipped, amounts) = slipping(graph, &slips);
        let chain = target.then(&Chain::new(graph, slipped.clone()));
        let off = source.inverse().then(&chain).merged().pose();
        let unknowns: Vec<Expr<'g>> = variables.iter().chain(&amounts).copied().collect();
        let (travels, search) = ranges(axes, &slips, reach);
        let deviation = deviation(&off);
        let components = independent(&chain, &unknowns, &search[0])?;
        let residuals: Vec<Expr<'g>> = components.iter().map(|&k| deviation[k]).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(motions).copied().collect();
        // the antisymmetric part of a rotation vanishes at half a turn as well
        let upright = off.rotation.0.iter().enumerate().fold(graph.constant(-1.0), |sum, (k, row)| sum + row.0[k]);
        Ok(PoseProblem {
            chain,
            unknowns: unknowns.clone(),
            slips: slipped,
            motions: motions.to_vec(),
            upright,
            system: equations(&residuals, upright, &unknowns, motions)?,
            rest: Tape::new(&deviation, &inputs)?,
            deviation,
            components,
            axes: axes.len(),
            is_rotary: axes.iter().map(|axis| axis.is_rotary).collect(),
            travels,
            search,
        })
    }

    /// The same with fewer axes than a pose has freedoms, from mixtures of all components of the deviation instead of some of them:
    /// they fix a posture wherever it stands, but where the pose cannot be met they do not tell which direction is missing. Nothing
    /// where all six components count anyway.
    pub fn mixed(&self) -> Option<PoseProblem<'g>> {
        /// Turns count as displacements so far away, mm.
        const ARM: f64 = 100.0;
        if self.unknowns.len() == COMPONENTS {
            return None;
        }
        // Chebyshev's polynomials at their nodes: of the first n of them, any n components are independent
        let share =
            |k: usize, j: usize| ((k * (2 * j + 1)) as f64 * std::f64::consts::PI / (2 * COMPONENTS) as f64).cos();
        let mixture = |k: usize| {
            let each = self.deviation.iter().enumerate();
            let each = each.map(|(j, part)| if j < 3 { share(k, j) * *part } else { share(k, j) * ARM * *part });
            each.reduce(|sum, part| sum + part).expect("six components")
        };
        let residuals: Vec<Expr<'g>> = (0..self.unknowns.len()).map(mixture).collect();
        let system = equations(&residuals, self.upright, &self.unknowns, &self.motions).ok()?;
        Some(PoseProblem { system, components: Vec::new(), ..self.clone() })
    }

    /// From work to tool on the target machine, in its axes and in the amounts by which the tool slides along itself.
    pub fn chain(&self) -> &Chain<'g> {
        &self.chain
    }

    /// A chain that ends in the tool's frame, as the machine's with its parameters as symbols, followed by the motions that leave the tool unchanged.
    pub fn slipped(&self, to_tool: &Chain<'g>) -> Chain<'g> {
        to_tool.then(&Chain::new(self.unknowns[0].graph(), self.slips.clone()))
    }

    /// What the chain and [`PoseProblem::series`] are in: the axes, then those amounts.
    pub fn unknowns(&self) -> &[Expr<'g>] {
        &self.unknowns
    }

    pub(crate) fn system(&self) -> &System {
        &self.system
    }

    pub(crate) fn travels(&self) -> &[Range] {
        &self.travels
    }

    pub(crate) fn is_rotary(&self, axis: usize) -> bool {
        self.is_rotary[axis]
    }

    /// Of which differences of unknowns count as shares.
    pub(crate) fn widths(&self) -> &[Range] {
        &self.search[1]
    }

    /// Postures at one value of the motions within travel and one turn of each rotary axis, the least turned one first; if there
    /// is none, those beyond the travels; if there is none either, what came nearest to one.
    pub fn postures(&self, motions: &[f64]) -> Vec<Posture> {
        let near = self.look(motions, &self.search[0]);
        let is_within = |posture: &Posture| posture.outcome == Outcome::Solved;
        if near.first().is_some_and(|first| is_within(first) && first.missing.is_none()) {
            return near;
        }
        let far = self.look(motions, &self.search[1]);
        let is_beyond = |posture: &Posture| matches!(posture.outcome, Outcome::Outside { .. });
        let is_whole = |first: &Posture| (is_within(first) || is_beyond(first)) && first.missing.is_none();
        if far.first().is_some_and(is_whole) || !near.iter().any(is_within) { far } else { near }
    }

    /// Postures somewhere in ranges, those with the whole pose before those that lack some of it, the least turned one first.
    fn look(&self, motions: &[f64], ranges: &[Range]) -> Vec<Posture> {
        let mut found = scan(&mut self.system.evaluation(motions), ranges, WIDELY, Solution::is_solved).0;
        let turned = |solution: &Solution| -> f64 {
            solution.unknowns.iter().zip(&self.search[1]).map(|(x, range)| (x / range.width()).powi(2)).sum()
        };
        found.sort_by(|a, b| turned(a).total_cmp(&turned(b)));
        let mut postures: Vec<Posture> = found.into_iter().map(|solution| self.posture(motions, solution)).collect();
        postures.sort_by_key(|posture| posture.missing.is_some());
        postures
    }

    /// Postures at values of the motions, each continuous with the one before it, from one of [`PoseProblem::postures`] at the
    /// first. Where no posture follows, the rest has no root: the last one tells why.
    pub fn follow(&self, first: &Posture, motions: &[Vec<f64>]) -> Vec<Posture> {
        let Some(start) = motions.first() else { return Vec::new() };
        let mut walk = Walk {
            evaluation: self.system.evaluation(start),
            ranges: self.wide(),
            passed: vec![(start.clone(), first.unknowns.clone())],
        };
        motions.iter().map(|wanted| self.advance(&mut walk, wanted)).collect()
    }

    /// Goes on to a value of the motions, in steps that are halved until the axes follow.
    fn advance(&self, walk: &mut Walk<'_>, wanted: &[f64]) -> Posture {
        let mut share = 1.0;
        let mut smallest = 0;
        loop {
            let at = &walk.passed[walk.passed.len() - 1].0;
            let step: Vec<f64> = at.iter().zip(wanted).map(|(a, b)| a + share * (b - a)).collect();
            let expected = walk.expected(&step);
            walk.evaluation.set_parameters(&step);
            let solution = solve_with(&mut walk.evaluation, &walk.ranges, &expected);
            let moved = distance(&solution.unknowns, &expected, &self.search[1]);
            let follows = solution.is_solved() && moved <= FARTHEST_STEP;
            if follows {
                walk.take(step, &solution.unknowns);
                if share == 1.0 {
                    return self.posture(wanted, solution);
                }
                share = 1.0;
            } else if smallest == MOST_HALVINGS {
                return self.posture(wanted, Solution { outcome: lost(&solution), ..solution });
            } else {
                smallest += 1;
                share *= 0.5;
            }
        }
    }

    /// Series of each unknown, axes first, in powers of the change of one of the motions, about a posture: coefficients up to an order, constant
    /// first; `None` where the posture is singular.
    pub fn series(&self, posture: &Posture, motions: &[f64], along: usize, order: usize) -> Option<Vec<Vec<f64>>> {
        self.system.series(&posture.unknowns, motions, &[(along, 1.0)], order)
    }

    /// How near a posture is to a singular one: the least change of the pose that axes can make together, as a share of the largest,
    /// and the axes that make it.
    pub fn weakest(&self, posture: &Posture, motions: &[f64]) -> (f64, Vec<usize>) {
        const INVOLVED: f64 = 0.02;
        let size = self.system.size();
        let mut evaluation = self.system.evaluation(motions);
        evaluation.at(&posture.unknowns);
        let width = |j: usize| self.search[1][j].width();
        let scaled = |i: usize, j: usize| evaluation.jacobian(i, j) * width(j);
        let row = |i: usize| (0..size).map(|j| scaled(i, j).abs()).fold(f64::MIN_POSITIVE, f64::max);
        let Ok(svd) = Svd::new(Mat::from_fn(size, size, |i, j| scaled(i, j) / row(i)).as_ref()) else {
            return (0.0, Vec::new());
        };
        let (sizes, v) = (svd.S(), svd.V());
        let share = |k: usize| v[(k, size - 1)].abs();
        let most = (0..size).map(share).fold(0.0, f64::max);
        let involved = (0..self.axes).filter(|&k| share(k) > INVOLVED * most).collect();
        (sizes[size - 1] / sizes[0], involved)
    }

    /// Axes that stand beyond their travels, and by how much (mm or radians); that which is farthest beyond, as a share of its travel,
    /// first.
    pub fn beyond(&self, axes: &[f64]) -> Vec<(usize, f64)> {
        let each = axes.iter().zip(&self.travels).enumerate();
        let mut beyond: Vec<(usize, f64)> = each
            .map(|(k, (x, travel))| (k, travel.excess(*x)))
            .filter(|&(k, by)| by > ROUNDING * self.travels[k].width())
            .collect();
        let share = |(k, by): &(usize, f64)| by / self.travels[*k].width();
        beyond.sort_by(|a, b| share(b).total_cmp(&share(a)));
        beyond
    }

    /// By what angle (rad) the tool's orientation is missed at least, at one value of the motions, however far the axes turn; and which
    /// axes turn it. Where it is not missed, rounding is left: up to the root of the smallest difference of numbers.
    ///
    /// # Errors
    /// If something depends on a variable that is not given.
    pub fn turn_missed(&self, motions: &[f64]) -> Result<(f64, Vec<usize>), TapeError> {
        let graph = self.upright.graph();
        let inside = graph.variables_of(&[self.upright]);
        let turns = |unknown: &Expr<'g>| unknown.as_variable().is_some_and(|own| inside.contains(&own));
        let turning: Vec<usize> = (0..self.unknowns.len()).filter(|k| turns(&self.unknowns[*k])).collect();
        let angles = turning.iter().map(|k| self.unknowns[*k]);
        let inputs: Vec<Expr<'g>> = angles.chain(self.motions.iter().copied()).collect();
        let tape = Tape::new(&[self.upright], &inputs)?;
        let (mut evaluator, mut upright) = (ScalarEvaluator::new(&tape), [0.0]);
        let mut at = [vec![0.0; turning.len()], motions.to_vec()].concat();
        let most = orientation::greatest(turning.len(), |angles| {
            at[..angles.len()].copy_from_slice(angles);
            evaluator.run(&at, &mut upright);
            upright[0]
        });
        // of a rotation matrix: the trace is 1 + 2 cos of the angle
        let missed = (0.5 * most).clamp(-1.0, 1.0).acos();
        Ok((missed, turning.into_iter().filter(|k| *k < self.axes).collect()))
    }

    pub(crate) fn posture(&self, motions: &[f64], solution: Solution) -> Posture {
        let mut deviation = [0.0; 6];
        if self.components.len() < deviation.len() {
            ScalarEvaluator::new(&self.rest).run(&[&solution.unknowns[..], motions].concat(), &mut deviation);
        }
        let rest = (0..6).filter(|k| !self.components.contains(k)).map(|k| Missing { direction: k, by: deviation[k] });
        let is_defined = rest.clone().all(|rest| rest.by.is_finite());
        let missing = rest.max_by(|a, b| a.by.abs().total_cmp(&b.by.abs())).filter(|most| most.by.abs() > TOLERANCE);
        let axes = solution.unknowns[..self.axes].to_vec();
        let outcome = match (solution.outcome, self.beyond(&axes).first()) {
            (Outcome::Solved, _) if !is_defined => Outcome::NotConverged { iterations: solution.iterations },
            (Outcome::Solved, Some(&(unknown, by))) => Outcome::Outside { unknown, by },
            (outcome, _) => outcome,
        };
        Posture { outcome, axes, missing, unknowns: solution.unknowns }
    }

    /// Ranges in which Newton may go anywhere: what lies beyond an axis's travel is reported, not prevented.
    pub(crate) fn wide(&self) -> Vec<Range> {
        let wide = |range: &Range| range.wider_by(FREE_TURNS);
        self.search[1].iter().map(wide).collect()
    }
}

/// A line of postures on its way.
struct Walk<'s> {
    evaluation: Evaluation<'s>,
    /// Where Newton may go.
    ranges: Vec<Range>,
    /// The last values of the motions with their unknowns, no two of them the same, the newest one behind.
    passed: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Walk<'_> {
    /// By the polynomial through the last postures; where there are several motions, straight on.
    fn expected(&self, step: &[f64]) -> Vec<f64> {
        let most = if step.len() == 1 { MOST_PASSED } else { 2 };
        let weights = (1..=most.min(self.passed.len())).rev().map(|count| self.weights(step, count));
        // one point alone has the weight one
        let weights =
            weights.into_iter().find(|weights| weights.iter().map(|w| w.abs()).sum::<f64>() <= LARGEST_WEIGHTS);
        let weights = weights.unwrap_or(vec![1.0]);
        let used = &self.passed[self.passed.len() - weights.len()..];
        let of = |k: usize| used.iter().zip(&weights).map(|((_, unknowns), weight)| weight * unknowns[k]).sum();
        (0..used[0].1.len()).map(of).collect()
    }

    /// Lagrange's weights of the last few postures, by how far each is from the newest one along the step.
    fn weights(&self, step: &[f64], count: usize) -> Vec<f64> {
        let used = &self.passed[self.passed.len() - count..];
        let newest = &used[count - 1].0;
        let along: Vec<f64> = if count > 1 {
            used[count - 2].0.iter().zip(newest).map(|(before, newest)| newest - before).collect()
        } else {
            return vec![1.0];
        };
        let place = |at: &[f64]| -> f64 { at.iter().zip(newest).zip(&along).map(|((a, b), by)| (a - b) * by).sum() };
        let (places, aim): (Vec<f64>, f64) = (used.iter().map(|(at, _)| place(at)).collect(), place(step));
        let weight = |i: usize| {
            let others = places.iter().enumerate().filter(|(j, _)| *j != i);
            others.map(|(_, place)| (aim - place) / (places[i] - place)).product()
        };
        (0..count).map(weight).collect()
    }

    fn take(&mut self, step: Vec<f64>, unknowns: &[f64]) {
        let newest = self.passed.last_mut().expect("a walk has begun somewhere");
        if newest.0 == step {
            newest.1 = unknowns.to_vec();
            return;
        }
        if self.passed.len() == MOST_PASSED {
            self.passed.remove(0);
        }
        self.passed.push((step, unknowns.to_vec()));
    }
}

/// Why a step was not taken: a root elsewhere is none.
fn lost(solution: &Solution) -> Outcome {
    match solution.outcome {
        Outcome::Singular => Outcome::Singular,
        _ => Outcome::NotConverged { iterations: solution.iterations },
    }
}

/// The travels of the axes; and where postures are looked for, of each axis and then of each slip: within the travels, then beyond.
fn ranges(axes: &[TargetAxis<'_>], slips: &[Screw], reach: f64) -> (Vec<Range>, [Vec<Range>; 2]) {
    let turn = Range { low: -std::f64::consts::PI, high: std::f64::consts::PI };
    let travel = |axis: &TargetAxis<'_>| {
        let free = if axis.is_rotary { FREE_TURNS } else { reach };
        axis.travel.unwrap_or(Range { low: -free, high: free })
    };
    let travels: Vec<Range> = axes.iter().map(travel).collect();
    let within = |(axis, range): (&TargetAxis<'_>, &Range)| if axis.is_rotary { one_turn(*range) } else { *range };
    let beyond = |(axis, range): (&TargetAxis<'_>, &Range)| if axis.is_rotary { turn } else { range.wider_by(1.0) };
    let slid = |slip: &Screw| if slip.angular == [0.0; 3] { Range { low: -reach, high: reach } } else { turn };
    let slid = slips.iter().map(slid);
    let near = axes.iter().zip(&travels).map(within).chain(slid.clone()).collect();
    let far = axes.iter().zip(&travels).map(beyond).chain(slid).collect();
    (travels, [near, far])
}

/// As much of a range as one turn holds, nearest to zero.
fn one_turn(range: Range) -> Range {
    let turn = 2.0 * std::f64::consts::PI;
    let low = (-0.5 * turn).clamp(range.low, range.low.max(range.high - turn));
    Range { low, high: range.high.min(low + turn) }
}

/// Residuals that vanish, where something else is positive.
fn equations<'g>(
    residuals: &[Expr<'g>],
    positive: Expr<'g>,
    unknowns: &[Expr<'g>],
    motions: &[Expr<'g>],
) -> Result<System, TapeError> {
    let inputs: Vec<Expr<'g>> = unknowns.iter().chain(motions).copied().collect();
    System::one_by_one(residuals, unknowns, motions)?.with_conditions(residuals, &[positive], &[], &inputs)
}

/// Displacement (mm) and turn (the sines of small angles) of what should be the identity.
fn deviation<'g>(off: &Pose<'g>) -> Vec<Expr<'g>> {
    let e = |i: usize, j: usize| off.rotation.0[i].0[j];
    let turn = [e(2, 1) - e(1, 2), e(0, 2) - e(2, 0), e(1, 0) - e(0, 1)].map(|twice| 0.5 * twice);
    off.translation.0.into_iter().chain(turn).collect()
}

/// As many components of the deviation as there are unknowns: those that they change most independently, most everywhere within the
/// travels. Where the pose is met, the deviation changes by the tool's twist.
fn independent(chain: &Chain<'_>, unknowns: &[Expr<'_>], ranges: &[Range]) -> Result<Vec<usize>, TapeError> {
    const PLACES: u32 = 16;
    /// Of two sets, a place where one is this near to nothing does not count more than all others.
    const LEAST: f64 = 1e-6;
    if unknowns.len() == COMPONENTS {
        return Ok((0..COMPONENTS).collect());
    }
    let twists = unknowns.iter().flat_map(|x| {
        let Twist { angular, linear } = chain.twist(*x);
        linear.0.into_iter().chain(angular.0)
    });
    let tape = Tape::new(&twists.collect::<Vec<Expr<'_>>>(), unknowns)?;
    let mut evaluator = ScalarEvaluator::new(&tape);
    let mut places = Vec::new();
    for k in 1..=PLACES {
        let mut out = vec![0.0; tape.output_count()];
        evaluator.run(&probe(ranges, k), &mut out);
        // unknowns by their range; displacements and turns each by the largest of them
        let of = |i: usize, j: usize| out[COMPONENTS * i + j] * ranges[i].width();
        let largest = |columns: std::ops::Range<usize>| {
            let each = columns.flat_map(|j| (0..unknowns.len()).map(move |i| (i, j)));
            each.map(|(i, j)| of(i, j).abs()).fold(f64::MIN_POSITIVE, f64::max)
        };
        let sizes = [largest(0..3), largest(3..COMPONENTS)];
        places.push(Mat::from_fn(unknowns.len(), COMPONENTS, |i, j| of(i, j) / sizes[j / 3]));
    }
    let independence = |chosen: &[usize]| -> f64 {
        let each = places.iter().map(|twists| {
            let square = Mat::from_fn(chosen.len(), chosen.len(), |i, j| twists[(i, chosen[j])]);
            let lu = FullPivLu::new(square.as_ref());
            let size: f64 = (0..chosen.len()).map(|k| lu.U()[(k, k)].abs()).product();
            (size + LEAST).ln()
        });
        each.sum()
    };
    let sets = (0u32..1 << COMPONENTS).filter(|set| set.count_ones() as usize == unknowns.len());
    let sets = sets.map(|set| (0..COMPONENTS).filter(|k| set >> k & 1 == 1).collect::<Vec<usize>>());
    let best = sets.map(|set| (independence(&set), set)).max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.map_or_else(Vec::new, |(_, set)| set))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_turn_of_a_travel_is_that_nearest_to_zero() {
        let of = |low: f64, high: f64| {
            let found = one_turn(Range { low: low.to_radians(), high: high.to_radians() });
            [found.low, found.high].map(|x| (x.to_degrees() * 1e6).round() / 1e6)
        };
        assert_eq!(of(-720.0, 720.0), [-180.0, 180.0]);
        assert_eq!(of(-10.0, 350.0), [-10.0, 350.0]);
        assert_eq!(of(-10.0, 100.0), [-10.0, 100.0]);
        assert_eq!(of(140.0, 230.0), [140.0, 230.0]);
        assert_eq!(of(300.0, 1000.0), [300.0, 660.0]);
        assert_eq!(of(-1000.0, -300.0), [-660.0, -300.0]);
    }
}
