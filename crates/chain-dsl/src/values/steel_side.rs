//! What is seen of the side on which the steel of a surface lies.

use flank_expr::{Expr, InstructionSet, LANES, LaneEvaluator, LaneTape, Tape, Varies};

/// Points at which the side of the steel is looked at: a part that is a twenty-fifth of the surface has some of them.
const LOOKS: usize = 100;

/// `|r_u × r_v|` below this is rounding: the points make no surface.
const NO_AREA: f64 = 1e-12;

/// The side of a surface on which steel was seen when its job was compiled: a number of the model, which other values of the settings may
/// turn over.
#[derive(Clone, Debug)]
pub struct SteelSide<'g> {
    /// What is square to the surface, and a direction out of the steel.
    pub(crate) parts: [Expr<'g>; 6],
    /// The unknowns of the surface with their ranges.
    pub(crate) unknowns: Vec<(Expr<'g>, f64, f64)>,
    pub(crate) is_flipped: bool,
}

/// The same while settings are open.
#[derive(Debug)]
pub struct OpenSide {
    tape: LaneTape,
    /// Unknowns stand behind the settings.
    moving: Vec<Moving>,
    is_flipped: bool,
}

impl<'g> SteelSide<'g> {
    /// While settings are open; `bindings` are the values of all others. Nothing where it does not depend on them.
    pub fn opened(&self, open: &[Expr<'g>], bindings: &[(Expr<'g>, Expr<'g>)]) -> Option<OpenSide> {
        let graph = self.parts[0].graph();
        let parts = graph.substitute(&self.parts, bindings);
        let depends = graph.variables_of(&parts);
        if !open.iter().any(|setting| setting.as_variable().is_some_and(|of| depends.contains(&of))) {
            return None;
        }
        let inputs: Vec<Expr<'g>> =
            open.iter().copied().chain(self.unknowns.iter().map(|(variable, ..)| *variable)).collect();
        let tape = Tape::new(&parts, &inputs).expect("a job without errors leaves nothing unbound");
        let moving = self.unknowns.iter().enumerate().map(|(k, (_, low, high))| (Some(open.len() + k), *low, *high));
        let moving: Vec<Moving> = moving.collect();
        Some(OpenSide { tape: in_lanes(&tape, &moving), moving, is_flipped: self.is_flipped })
    }
}

impl OpenSide {
    /// Whether the steel lies on the same side all over the surface with these values of the settings.
    pub fn is_kept(&self, settings: &[f64]) -> bool {
        looked(&self.tape, settings, &self.moving).one_side() == Some(self.is_flipped)
    }
}

/// What was seen at some points of a surface.
#[derive(Default)]
pub(crate) struct Seen {
    /// All of them.
    looks: usize,
    /// Points at which the normal points out of the steel, and into it.
    pub(crate) out: usize,
    pub(crate) into: usize,
    /// Points that cannot be computed.
    undefined: usize,
    /// Points without a normal.
    flat: usize,
    /// Points with a normal.
    whole: usize,
    /// Of the points with a normal, along each axis, how many have a normal that points forward, and how many backward.
    along: [[usize; 2]; 3],
    /// The least that a normal has along each axis, as a share of its length.
    least: [f64; 3],
}

/// The place of an unknown among the inputs of a tape, if it stands there, and its range.
pub(crate) type Moving = (Option<usize>, f64, f64);

/// A tape of the parts of [`SteelSide`] for many points of a surface at once.
pub(crate) fn in_lanes(tape: &Tape, moving: &[Moving]) -> LaneTape {
    let mut varies = vec![Varies::Seldom; tape.input_count()];
    moving.iter().filter_map(|(place, ..)| *place).for_each(|place| varies[place] = Varies::Freely);
    LaneTape::with_inputs(tape, &varies)
}

/// Looks all over a surface by the tape of [`in_lanes`]. `values` are those of its inputs; what moves needs none.
pub(crate) fn looked(tape: &LaneTape, values: &[f64], moving: &[Moving]) -> Seen {
    let mut evaluator = LaneEvaluator::new(tape, InstructionSet::widest());
    let moves = |input: usize| moving.iter().any(|(place, ..)| *place == Some(input));
    for (input, value) in values.iter().enumerate().filter(|(input, _)| !moves(*input)) {
        evaluator.set_uniform(input, *value);
    }
    let steps = steps(moving.len());
    let mut seen = Seen::default();
    for first in (0..LOOKS).step_by(LANES) {
        let count = LANES.min(LOOKS - first);
        for ((place, low, high), step) in moving.iter().zip(&steps) {
            let Some(place) = place else { continue };
            for (lane, value) in evaluator.input(*place)[..count].iter_mut().enumerate() {
                *value = low + (high - low) * (0.5 + (first + lane) as f64 * step).fract();
            }
        }
        evaluator.run_first(count);
        for lane in 0..count {
            let found: [f64; 6] = std::array::from_fn(|part| evaluator.output(part)[lane]);
            seen.add(&found[..3], &found[3..]);
            seen.looks += 1;
        }
    }
    seen
}

/// How far, as a share of each range, one point lies from the one before, so that they fill all directions evenly, and none stands at the
/// same part of a turn again and again: powers of the root of x^(d + 1) = x + 1, the golden ratio's sequence in d directions.
pub(crate) fn steps(directions: usize) -> Vec<f64> {
    let root = (0..32).fold(2.0_f64, |x, _| (1.0 + x).powf(1.0 / (directions + 1) as f64));
    (1..=directions).map(|k| root.powi(-(k as i32))).collect()
}

impl Seen {
    /// Whether the normal points into the steel wherever it is known, if that is the same everywhere.
    pub(crate) fn one_side(&self) -> Option<bool> {
        match (self.out, self.into) {
            (1.., 0) => Some(false),
            (0, 1..) => Some(true),
            _ => None,
        }
    }

    /// No point could be computed.
    pub(crate) fn is_undefined(&self) -> bool {
        self.undefined == self.looks
    }

    /// No point had a normal.
    pub(crate) fn is_flat(&self) -> bool {
        self.whole == 0
    }

    /// The direction lay in the surface at all points.
    pub(crate) fn runs_along(&self) -> bool {
        self.out + self.into == 0
    }

    fn add(&mut self, normal: &[f64], outward: &[f64]) {
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (length, along) = (norm(normal), normal.iter().zip(outward).map(|(n, o)| n * o).sum::<f64>());
        if length.is_nan() {
            self.undefined += 1;
        } else if length < NO_AREA {
            self.flat += 1;
        } else {
            for (k, part) in normal.iter().map(|part| part / length).enumerate() {
                self.along[k][0] += usize::from(part > 1e-9);
                self.along[k][1] += usize::from(part < -1e-9);
                self.least[k] = if self.whole == 0 { part.abs() } else { self.least[k].min(part.abs()) };
            }
            self.whole += 1;
            let cosine = along / (length * norm(outward));
            self.out += usize::from(cosine > 1e-9);
            self.into += usize::from(cosine < -1e-9);
        }
    }

    /// A direction along an axis that leaves the surface everywhere, the steepest of them, and its opposite: `body towards [0, 1, 0]`. None
    /// where the surface goes too far around.
    pub(crate) fn examples(&self) -> Option<[String; 2]> {
        let leaves = |k: &usize| self.along[*k].contains(&self.whole) && self.whole > 0;
        let index = (0..3).filter(leaves).max_by(|&a, &b| self.least[a].total_cmp(&self.least[b]))?;
        let towards = |sign: i32| {
            let parts: Vec<String> = (0..3).map(|k| if k == index { sign } else { 0 }.to_string()).collect();
            format!("body towards [{}]", parts.join(", "))
        };
        let sign = if self.along[index][0] > 0 { 1 } else { -1 };
        Some([towards(sign), towards(-sign)])
    }
}
