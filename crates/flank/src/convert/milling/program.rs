//! NC programs read as motions of a machine's cutter.

use std::collections::HashMap;
use std::fmt;

use flank_solver::PoseSeries;

use super::klartext;
use super::machine::Machine;

/// Letters of axis words.
const AXIS_LETTERS: &str = "ABCUVWXYZ";

/// A program as the cutter's blocks that cut, in the frame of the work.
pub(super) struct Program {
    pub(super) blocks: Vec<PoseSeries>,
    /// Whether one of them has the tip in the work in its words.
    pub(super) tool_centre_control: bool,
}

impl Program {
    fn push(&mut self, block: Option<PoseSeries>, state: &State<'_, '_, '_>) {
        let Some(block) = block else { return };
        self.tool_centre_control |= state.has_tip_control;
        self.blocks.push(block);
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

/// A word of a block.
pub(super) struct Word {
    pub(super) address: String,
    pub(super) value: f64,
}

/// What a program has said so far.
struct State<'m, 'p, 'g> {
    machine: &'m Machine<'p, 'g>,
    /// Of each axis its address, where it stands (mm or radians), and whether that was said.
    addresses: HashMap<String, usize>,
    axes: Vec<Option<f64>>,
    /// The tip in the work, under tool-centre control.
    tip: [Option<f64>; 3],
    is_cutting: bool,
    has_tip_control: bool,
    /// mm per unit of lengths.
    unit: f64,
}

/// Reads a program in the words of Fanuc, Siemens 840D, LinuxCNC or Heidenhain's Klartext, which its first block tells.
pub(super) fn read(text: &str, machine: &Machine<'_, '_>) -> Result<Program, Fault> {
    let addresses = machine.free.iter().enumerate().map(|(k, axis)| (axis.word.address.clone(), k)).collect();
    let mut state = State {
        machine,
        addresses,
        axes: vec![None; machine.free.len()],
        tip: [None; 3],
        is_cutting: false,
        has_tip_control: false,
        unit: 1.0,
    };
    let mut program = Program { blocks: Vec::new(), tool_centre_control: false };
    let is_klartext = text.lines().any(klartext::begins);
    for (number, line) in text.lines().enumerate() {
        let fault = |message: String| Fault { line: number + 1, message };
        let plain = without_remarks(line);
        let plain = plain.trim();
        if plain.is_empty() || plain == "%" || plain.starts_with(['O', ':']) {
            continue;
        }
        if is_klartext {
            match klartext::line(plain).map_err(fault)? {
                klartext::Line::End => break,
                klartext::Line::Nothing => {}
                klartext::Line::Unit(unit) => state.unit = unit,
                klartext::Line::TipControl(on) => state.tip_control(on),
                klartext::Line::Elsewhere(axes) => state.forget(&axes),
                klartext::Line::Block(words) => program.push(state.block(&words).map_err(fault)?, &state),
            }
            continue;
        }
        for (word, on) in [("TRAORI", true), ("TRAFOOF", false)] {
            if plain.contains(word) {
                state.tip_control(on);
            }
        }
        if plain.contains("TRAORI") || plain.contains("TRAFOOF") {
            continue;
        }
        let words = words(&plain.replace("FNORM", "")).map_err(fault)?;
        if words.iter().any(|word| word.address == "M" && (word.value == 30.0 || word.value == 2.0)) {
            break;
        }
        program.push(state.block(&words).map_err(fault)?, &state);
    }
    if program.blocks.is_empty() {
        return Err(Fault { line: text.lines().count(), message: "the program has no cutting block".to_string() });
    }
    Ok(program)
}

/// A line without remarks.
fn without_remarks(line: &str) -> String {
    let line = line.split(';').next().unwrap_or_default();
    let (mut depth, mut out) = (0, String::new());
    for letter in line.chars() {
        match letter {
            '(' => depth += 1,
            ')' => depth = 0,
            _ if depth == 0 => out.push(letter.to_ascii_uppercase()),
            _ => {}
        }
    }
    out
}

fn words(line: &str) -> Result<Vec<Word>, String> {
    let letters: Vec<char> = line.chars().filter(|letter| !letter.is_whitespace()).collect();
    let (mut at, mut words) = (0, Vec::new());
    while at < letters.len() {
        let mut address = letters[at].to_string();
        if !letters[at].is_ascii_alphabetic() {
            return Err(format!("`{}` begins no word", letters[at]));
        }
        at += 1;
        // an address with a number behind has a sign of equality: B1=12
        let digits = letters[at..].iter().take_while(|letter| letter.is_ascii_digit()).count();
        if letters.get(at + digits) == Some(&'=') {
            address.extend(&letters[at..at + digits]);
            at += digits + 1;
        }
        let is_part = |letter: &&char| letter.is_ascii_digit() || matches!(letter, '.' | '-' | '+');
        let length = letters[at..].iter().take_while(is_part).count();
        let number: String = letters[at..at + length].iter().collect();
        let value = number.parse().map_err(|_| format!("`{address}{number}` has no number"))?;
        words.push(Word { address, value });
        at += length;
    }
    Ok(words)
}

impl State<'_, '_, '_> {
    fn tip_control(&mut self, on: bool) {
        self.has_tip_control = on;
        self.tip = [None; 3];
    }

    /// Axes went where the program does not say in the work's coordinates.
    fn forget(&mut self, addresses: &[String]) {
        for axis in addresses.iter().filter_map(|address| self.addresses.get(address)) {
            self.axes[*axis] = None;
        }
        self.tip = [None; 3];
    }

    /// A block: where it goes, if it cuts.
    fn block(&mut self, words: &[Word]) -> Result<Option<PoseSeries>, String> {
        for word in words.iter().filter(|word| word.address == "G") {
            self.preparatory(word.value)?;
        }
        for word in words.iter().filter(|word| word.address == "M") {
            match word.value as i64 {
                428 | 128 => self.tip_control(true),
                429 | 129 => self.tip_control(false),
                _ => {}
            }
        }
        let (axes, tip) = (self.axes.clone(), self.tip);
        let mut moves = false;
        for word in words {
            let is_axis = word.address.starts_with(|first: char| AXIS_LETTERS.contains(first));
            if is_axis || self.addresses.contains_key(&word.address) {
                self.axis(word)?;
                moves = true;
            }
        }
        if !moves {
            return Ok(None);
        }
        // where the axes came from is known only if that was said
        let first = if self.has_tip_control && tip.iter().any(Option::is_none) { None } else { Some(()) };
        let Some(()) = first.filter(|()| self.is_cutting) else { return Ok(None) };
        let known = |all: &[Option<f64>]| all.iter().copied().collect::<Option<Vec<f64>>>();
        let (Some(from), Some(to)) = (known(&axes), known(&self.axes)) else {
            return Err("cuts before each axis has its position".to_string());
        };
        if !self.has_tip_control {
            return Ok(Some(self.machine.axes.straight(&from, &to)));
        }
        let (Some(a), Some(b)) = (known(&tip), known(&self.tip)) else { return Ok(None) };
        Ok(Some(self.machine.axes.straight_tip((&from, &to), (&a, &b))))
    }

    fn preparatory(&mut self, value: f64) -> Result<(), String> {
        match (value * 10.0).round() as i64 {
            0 => self.is_cutting = false,
            10 => self.is_cutting = true,
            20 | 30 => return Err(format!("G{value} is a circle: only straight blocks are followed")),
            910 => return Err("G91 counts from where the axes stand: only absolute positions are followed".to_string()),
            200 | 700 => self.unit = 25.4,
            210 | 710 | 7100 => self.unit = 1.0,
            434 => self.tip_control(true),
            490 => self.tip_control(false),
            _ => {}
        }
        Ok(())
    }

    fn axis(&mut self, word: &Word) -> Result<(), String> {
        let of_tip = ["X", "Y", "Z"].iter().position(|address| *address == word.address);
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
        let programmed =
            if self.machine.axes.is_rotary(axis) { word.value.to_radians() } else { word.value * self.unit };
        let position = if own.reversed { own.offset - programmed } else { programmed - own.offset };
        self.axes[axis] = Some(position);
        Ok(())
    }
}
