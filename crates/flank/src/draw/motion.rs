//! What the axes of a machine do over the motions.

use flank_chain_dsl::{Dimension, RangedVariable};
use flank_draw::{PictureOptions, axis_positions};
use flank_export::{MachineAxis, MotionRow, MotionTable, Unknown};
use flank_expr::Expr;
use flank_solver::Range;

use super::subject::{Subject, number};
use super::{Drawing, Unfit, counted};
use crate::solve;
use crate::solve::travel;

const POSITIONS: usize = 121;

pub(super) fn draw(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let motions = subject.motions();
    if motions.is_empty() {
        return Err(format!("nothing moves while `{}` is made", subject.first().surface.name));
    }
    let machine = subject.machine().ok_or("the surface stands in no machine")?;
    let (_, point) = subject.middle()?;
    let posture = subject.posture(point);
    let reached = travel::reached(subject.job, &subject.solved);
    let tables: Vec<MotionTable> =
        motions.iter().map(|motion| table(subject, motion, range(motion, &reached), &posture)).collect();
    let names: Vec<&str> = motions.iter().map(|motion| motion.name.as_str()).collect();
    let shows = format!("{} of {} over {}", counted(machine.axes.len(), "axis"), machine.name, names.join(", "));
    Ok(Drawing { picture: axis_positions(&tables, options), shows })
}

/// As far as the solved points need it.
fn range(motion: &RangedVariable<'_>, reached: &[(Expr<'_>, Range)]) -> Range {
    let found = reached.iter().find(|(variable, _)| variable.as_variable() == motion.variable.as_variable());
    found.map_or(Range { low: motion.low, high: motion.high }, |(_, range)| *range)
}

/// All axes over one motion; the other motions stand where the middle of the surface is made.
fn table<'g>(
    subject: &Subject<'_, 'g>,
    motion: &RangedVariable<'g>,
    range: Range,
    posture: &[(Expr<'g>, Expr<'g>)],
) -> MotionTable {
    let others: Vec<(Expr<'g>, Expr<'g>)> =
        posture.iter().copied().filter(|(variable, _)| *variable != motion.variable).collect();
    let axes = subject.machine().map_or(&[][..], |machine| &machine.axes);
    let at = |step: usize| range.low + (range.high - range.low) * step as f64 / (POSITIONS - 1) as f64;
    let row = |step: usize| {
        let value = motion.variable.graph().constant(at(step));
        let bindings: Vec<(Expr<'g>, Expr<'g>)> = others.iter().copied().chain([(motion.variable, value)]).collect();
        MotionRow { motion: at(step), axes: axes.iter().map(|axis| number(axis.law, &bindings)).collect() }
    };
    MotionTable {
        header: subject.dataset.header.clone(),
        motion: Unknown { name: motion.name.clone(), unit: solve::unit(motion.dimension) },
        axes: axes
            .iter()
            .map(|axis| MachineAxis {
                name: axis.name.clone(),
                address: axis.name.clone(),
                is_rotary: axis.dimension == Dimension::ANGLE,
                decimals: 3,
                offset: 0.0,
                reversed: false,
                travel: axis.travel.map(|(low, high)| [low, high]),
            })
            .collect(),
        rows: (0..POSITIONS).map(row).collect(),
        series: None,
        rates: None,
    }
}
