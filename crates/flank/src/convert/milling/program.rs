//! NC programs read as moves of a machine's axes.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::fmt;

use flank_solver::PoseSeries;

use super::block::{Block, Motion, Word};
use super::control::{Control, OF_TIP};
use super::machine::{FreeAxes, Machine};
use super::{iso, klartext};
use crate::project::units;

/// A program as moves, in order.
pub(super) struct Program {
    pub(super) moves: Vec<Move>,
    /// Whether it says that it ends.
    pub(super) has_end: bool,
    /// Whether it says in what lengths are.
    pub(super) has_unit: bool,
}

/// A block from where all axes are known to where they are.
#[derive(Clone)]
pub(super) struct Move {
    pub(super) line: usize,
    pub(super) motion: Motion,
    /// The tip goes straight, else all axes do.
    pub(super) has_tip_control: bool,
    from: Vec<f64>,
    to: Vec<f64>,
}

impl Move {
    /// The cutter in the frame of the work.
    pub(super) fn series(&self, axes: &FreeAxes) -> PoseSeries {
        match self.has_tip_control {
            true => axes.straight_tip(&self.from, &self.to),
            false => axes.straight(&self.from, &self.to),
        }
    }

    /// How far a rotary axis turns, at the most, radians.
    pub(super) fn turn(&self, axes: &FreeAxes) -> f64 {
        axes.rotary().map(|axis| (self.to[axis] - self.from[axis]).abs()).fold(0.0, f64::max)
    }

    /// Its parts in which no rotary axis turns farther, in order.
    pub(super) fn parts(&self, axes: &FreeAxes, turn: f64) -> Vec<Move> {
        if self.turn(axes) <= turn {
            return vec![self.clone()];
        }
        self.halves(axes).iter().flat_map(|half| half.parts(axes, turn)).collect()
    }

    /// Its first half and its second.
    pub(super) fn halves(&self, axes: &FreeAxes) -> [Move; 2] {
        let middle: Vec<f64> = self.from.iter().zip(&self.to).map(|(a, b)| 0.5 * (a + b)).collect();
        let middle = if self.has_tip_control {
            let [a, b] = [&self.from, &self.to].map(|row| axes.pose(row));
            axes.with_tip(&middle, [0, 1, 2].map(|k| 0.5 * (a[k] + b[k])))
        } else {
            middle
        };
        [(&self.from, &middle), (&middle, &self.to)].map(|(from, to)| Move {
            from: from.clone(),
            to: to.clone(),
            ..*self
        })
    }
}

/// What a program says that is not understood, with its line.
pub(super) struct Fault {
    line: usize,
    message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.line, self.message)
    }
}

/// What a program has said so far.
struct State<'m, 'p, 'g> {
    machine: &'m Machine<'p, 'g>,
    /// Of each axis its address, and where it stands (mm or radians), if that was said.
    addresses: HashMap<String, usize>,
    axes: Vec<Option<f64>>,
    /// The words of the tip, under tool-centre control.
    tip: [Option<f64>; 3],
    motion: Option<Motion>,
    has_tip_control: bool,
    /// Whether feeds are the inverse of the time of a block.
    has_inverse_time: bool,
    /// mm per unit of lengths.
    unit: f64,
    /// What the control knows of the machine, in a program that is given the tip: words of linear axes count from the zero of the work then.
    control: Option<Control>,
}

/// Reads a program in the words of Fanuc, Siemens 840D, LinuxCNC or Heidenhain's Klartext, which its first block tells.
pub(super) fn read(text: &str, machine: &Machine<'_, '_>) -> Result<Program, Fault> {
    let lines: Vec<&str> = lines(text);
    let is_klartext = lines.iter().any(|line| klartext::begins(line));
    let mut blocks = Vec::with_capacity(lines.len());
    for (number, line) in lines.iter().enumerate() {
        let capitals = line.trim().to_ascii_uppercase();
        let block = if is_klartext { klartext::line(&capitals) } else { iso::line(&capitals) };
        let line = number + 1;
        let block = block.map_err(|message| Fault { line, message });
        let is_last = block.as_ref().map_or(true, |block| block.ends);
        blocks.push((line, block));
        if is_last {
            break;
        }
    }
    let mut state = State::new(machine);
    let begins = |block: &Result<Block, Fault>| block.as_ref().is_ok_and(|block| block.tip_control == Some(true));
    if let Some((line, _)) = blocks.iter().find(|(_, block)| begins(block)) {
        let control = Control::of_machine(machine);
        let control = control.map_err(|unknown| Fault { line: *line, message: unknown.message(machine) })?;
        state.control = Some(control);
    }
    let mut program = Program { moves: Vec::new(), has_end: false, has_unit: false };
    for (line, block) in blocks {
        let block = block?;
        program.has_unit |= block.unit.is_some();
        program.moves.extend(state.follow(&block, line).map_err(|message| Fault { line, message })?);
        program.has_end |= block.ends && (!is_klartext || lines.iter().any(|line| klartext::ends(line)));
    }
    if !program.moves.iter().any(|one| one.motion == Motion::Straight) {
        let message = "the program has no cutting block".to_string();
        return Err(Fault { line: lines.len().max(1), message });
    }
    Ok(program)
}

/// Its lines, however they end.
fn lines(text: &str) -> Vec<&str> {
    let ends = if text.contains('\n') { '\n' } else { '\r' };
    text.split_terminator(ends).map(|line| line.trim_end_matches('\r')).collect()
}

impl<'m, 'p, 'g> State<'m, 'p, 'g> {
    fn new(machine: &'m Machine<'p, 'g>) -> State<'m, 'p, 'g> {
        State {
            machine,
            addresses: machine.free.iter().enumerate().map(|(k, axis)| (axis.word.address.clone(), k)).collect(),
            axes: vec![None; machine.free.len()],
            tip: [None; 3],
            motion: None,
            has_tip_control: false,
            has_inverse_time: false,
            unit: 1.0,
            control: None,
        }
    }

    /// A block: where it goes from where, if both are known.
    fn follow(&mut self, block: &Block, line: usize) -> Result<Option<Move>, String> {
        self.unit = block.unit.unwrap_or(self.unit);
        self.has_inverse_time = block.inverse_time.unwrap_or(self.has_inverse_time);
        self.motion = block.motion.or(self.motion);
        if let Some(on) = block.tip_control {
            self.tip_control(on);
        }
        if block.is_elsewhere {
            self.forget(&block.goes_to);
            return Ok(None);
        }
        if block.goes_to.is_empty() {
            return Ok(None);
        }
        let before = self.known();
        block.goes_to.iter().try_for_each(|word| self.axis(word))?;
        if self.has_tip_control {
            self.follow_tip();
        }
        self.within_travels()?;
        if self.motion == Some(Motion::Straight) {
            self.has_feed(block)?;
        }
        let motion = self.motion.ok_or("goes before the program says how: G0 or G1")?;
        match (before, self.known()) {
            (Some(from), Some(to)) => Ok(Some(Move { line, motion, has_tip_control: self.has_tip_control, from, to })),
            // a rapid from an unknown place is how a program begins
            _ if motion == Motion::Rapid => Ok(None),
            _ => Err("cuts before each axis has its position".to_string()),
        }
    }

    /// That a control would go on at a block that cuts.
    fn has_feed(&self, block: &Block) -> Result<(), String> {
        match block.feed {
            None if self.has_inverse_time => {
                Err("has no `F`: with inverse-time feed (G93) each block that cuts needs its own, and controls stop"
                    .to_string())
            }
            Some(feed) if feed <= 0.0 => Err(format!("`F{feed}` is no feed: controls stop; it has to be above zero")),
            _ => Ok(()),
        }
    }

    /// Where all axes stand, if that was said of each.
    fn known(&self) -> Option<Vec<f64>> {
        self.axes.iter().copied().collect()
    }

    fn tip_control(&mut self, on: bool) {
        self.has_tip_control = on;
        let tip = self.known().zip(self.control.as_ref()).map(|(axes, control)| control.tip(&axes));
        self.tip = tip.map_or([None; 3], |tip| tip.map(Some));
    }

    /// The linear axes follow the tip.
    fn follow_tip(&mut self) {
        let free = &self.machine.axes;
        let is_turned = self.axes.iter().enumerate().all(|(k, at)| at.is_some() || !free.is_rotary(k));
        let from: Vec<f64> = self.axes.iter().map(|at| at.unwrap_or(0.0)).collect();
        let tip = if let [Some(x), Some(y), Some(z)] = self.tip { Some([x, y, z]) } else { None };
        let found = tip.filter(|_| is_turned).zip(self.control.as_ref()).map(|(tip, control)| control.axes(tip, &from));
        for axis in (0..from.len()).filter(|axis| !free.is_rotary(*axis)) {
            self.axes[axis] = found.as_ref().map(|found| found[axis]);
        }
    }

    /// Axes went where the program does not say in the work's coordinates.
    fn forget(&mut self, words: &[Word]) {
        for axis in words.iter().filter_map(|word| self.addresses.get(&word.address)) {
            self.axes[*axis] = None;
        }
        self.tip = [None; 3];
    }

    fn axis(&mut self, word: &Word) -> Result<(), String> {
        let of_tip = OF_TIP.iter().position(|address| *address == word.address);
        if let Some(k) = of_tip.filter(|_| self.has_tip_control) {
            self.tip[k] = Some(word.value * self.unit);
            return Ok(());
        }
        let Some(axis) = self.addresses.get(&word.address).copied() else {
            let known: Vec<&str> = self.machine.free.iter().map(|axis| axis.word.address.as_str()).collect();
            return Err(format!(
                "{} has no word `{}`; it has {}",
                self.machine.machine.name,
                word.address,
                known.join(" ")
            ));
        };
        let own = &self.machine.free[axis].word;
        let is_rotary = self.machine.axes.is_rotary(axis);
        let programmed = if is_rotary { word.value.to_radians() } else { word.value * self.unit };
        let position = match &self.control {
            Some(control) if !is_rotary => control.position(axis, programmed),
            _ if own.reversed => own.offset - programmed,
            _ => programmed - own.offset,
        };
        let before = self.axes[axis].filter(|_| word.by_shorter_way && is_rotary);
        let turns = before.map_or(0.0, |before| ((before - position) / TAU).round());
        self.axes[axis] = Some(position + TAU * turns);
        Ok(())
    }

    /// That no axis is beyond its travel by more than its words are rounded.
    fn within_travels(&self) -> Result<(), String> {
        for (k, (axis, at)) in self.machine.free.iter().zip(&self.axes).enumerate() {
            let (Some((low, high)), Some(at)) = (axis.travel, *at) else { continue };
            let rounding = self.machine.rounding(k);
            if at < low - rounding || at > high + rounding {
                let text = |value: f64| units::text(axis.dimension, value, 3);
                let inches = if self.unit > 1.0 { "; its words count as inches here" } else { "" };
                return Err(format!(
                    "{} goes beyond its travel: to {} as {} counts, and its travel is {} .. {}{inches}",
                    axis.name,
                    text(at),
                    self.machine.machine.name,
                    text(low),
                    text(high)
                ));
            }
        }
        Ok(())
    }
}
