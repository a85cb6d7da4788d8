//! Settings of a machine: the constants with which it makes given poses, while some of its axes move.

mod search;

use flank_expr::geometry::{Chain, Pose};
use flank_expr::{Expr, Tape, TapeError};

use crate::conversion::poses::TargetAxis;
use crate::conversion::symmetry::Screw;
use crate::conversion::symmetry::{doubled, slipping};
use crate::equations::solution::Range;
use search::Search;

/// A constant that is looked for.
#[derive(Clone, Copy, Debug)]
pub struct UnknownSetting<'g> {
    /// Its variable in the chain.
    pub variable: Expr<'g>,
    /// Which values it may have.
    pub sought: SettingBounds,
}

/// Which values a setting may have.
#[derive(Clone, Copy, Debug)]
pub struct SettingBounds {
    /// What it is counted in.
    pub kind: SettingKind,
    /// Where it may lie; endless where nothing is said.
    pub range: Range,
    /// What it is where the poses do not tell.
    pub usual: Option<f64>,
}

/// A machine that is to be set up.
#[derive(Clone, Copy, Debug)]
pub struct AdjustableMachine<'a, 'g> {
    /// From work to tool.
    pub chain: &'a Chain<'g>,
    /// The constants in it that are looked for.
    pub settings: &'a [UnknownSetting<'g>],
    /// The axes that move.
    pub axes: &'a [TargetAxis<'g>],
}

/// How far a setting may be looked for, and what two values of it have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingKind {
    /// mm.
    Length,
    /// rad; whole turns may make no difference.
    Angle,
    /// A ratio, a coefficient.
    Number,
}

/// Poses of a source's motions that a machine with unknown settings shall make.
#[derive(Clone, Debug)]
pub struct SettingsProblem<'g> {
    chain: Chain<'g>,
    settings: Vec<Expr<'g>>,
    /// Axes, then amounts by which the tool slides along itself: they are others in each pose.
    moving: Vec<Expr<'g>>,
    search: Search,
}

/// Starts from which settings are looked for, where nobody says how many.
pub const STARTS: u32 = 1024;

/// Settings and how well they do.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingsFit {
    /// In the order of the problem's settings; mm, radians or numbers.
    pub settings: Vec<f64>,
    /// Settings that the poses do not determine: they can change, alone or with others, and the poses stay. As few of them as fix all
    /// others are as usual, or where they happened to be.
    pub undetermined: Vec<usize>,
    /// For each pose the axes, then how far the tool slides along itself.
    pub moving: Vec<Vec<f64>>,
    /// The largest displacement that is left, mm.
    pub displacement: f64,
    /// The largest turn that is left, radians.
    pub turn: f64,
    /// Whether only rounding is left.
    pub is_exact: bool,
}

impl<'g> SettingsProblem<'g> {
    /// `source` leads from work to tool on the other machine, in `motions`; `symmetries` are the motions that leave the tool
    /// unchanged. Nothing on the way is longer than `reach`, mm, by much.
    ///
    /// # Errors
    /// If something depends on a variable that is not given.
    ///
    /// # Panics
    /// If there is no motion.
    pub fn new(
        target: &AdjustableMachine<'_, 'g>,
        source: &Chain<'g>,
        motions: &[Expr<'g>],
        symmetries: &[Screw],
        reach: f64,
    ) -> Result<SettingsProblem<'g>, TapeError> {
        let graph = motions[0].graph();
        let AdjustableMachine { chain: target, settings, axes } = *target;
        let variables: Vec<Expr<'g>> = axes.iter().map(|axis| axis.variable).collect();
        let constants: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
        let mut slips = symmetries.to_vec();
        while let Some(slip) = doubled(target, &variables, &constants, &slips)? {
            slips.remove(slip);
        }
        let (slipped, amounts) = slipping(graph, &slips);
        let chain = target.then(&Chain::new(graph, slipped));
        let off = source.inverse().then(&chain).merged().pose();
        let moving: Vec<Expr<'g>> = variables.into_iter().chain(amounts).collect();
        let unknowns: Vec<Expr<'g>> = constants.iter().chain(&moving).copied().collect();
        let rows = rows(&off, reach);
        let derivatives = rows.iter().flat_map(|row| unknowns.iter().map(|x| row.derivative(*x)));
        let outputs: Vec<Expr<'g>> = rows.iter().copied().chain(derivatives).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(motions).copied().collect();
        let turns = |slip: &Screw| slip.angular != [0.0; 3];
        let search = Search {
            settings: settings.iter().map(|setting| setting.sought).collect(),
            is_rotary: axes.iter().map(|axis| axis.is_rotary).chain(slips.iter().map(turns)).collect(),
            tape: Tape::new(&outputs, &inputs)?,
            reach,
            starts: STARTS,
        };
        Ok(SettingsProblem { chain, settings: constants, moving, search })
    }

    /// Looks for them from so many starts at the most, one at least, in place of [`STARTS`].
    #[must_use]
    pub fn starts(mut self, starts: u32) -> SettingsProblem<'g> {
        self.search.starts = starts.max(1);
        self
    }

    /// From work to tool on the target machine, in settings and in what moves.
    pub fn chain(&self) -> &Chain<'g> {
        &self.chain
    }

    /// What else the chain is in: the axes, then the amounts by which the tool slides along itself.
    pub fn moving(&self) -> &[Expr<'g>] {
        &self.moving
    }

    /// Its settings.
    pub fn settings(&self) -> &[Expr<'g>] {
        &self.settings
    }

    /// Settings with which the machine comes nearest to the source at all these values of its motions, found without a start value.
    /// Of several that do it exactly, those within their ranges and nearest to what is usual.
    ///
    /// # Panics
    /// If there are no values.
    pub fn fit(&self, motions: &[Vec<f64>]) -> SettingsFit {
        self.search.fit(motions)
    }

    /// Where what moves has to stand with these settings at a value of the motions, from a place nearby.
    pub fn stand(&self, settings: &[f64], motions: &[f64], near: &[f64]) -> Vec<f64> {
        self.search.stand(settings, motions, near)
    }
}

/// What should be the identity less the identity; displacements as shares of the reach. Unlike its antisymmetric part, which is all
/// that small turns need, the whole rotation grows up to half a turn.
fn rows<'g>(off: &Pose<'g>, reach: f64) -> Vec<Expr<'g>> {
    let entries = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let turned = entries.map(|(i, j)| off.rotation.0[i].0[j] - if i == j { 1.0 } else { 0.0 });
    off.translation.0.into_iter().map(|x| x * (1.0 / reach)).chain(turned).collect()
}
