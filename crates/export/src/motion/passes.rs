//! Passes of a cutter as an NC program (ISO 6983) that a machine runs from start to end.

use std::io::Write;

use super::dialect::Dialect;
use super::nc::{NcError, axis_word, block_length, check_axes, extent_line, push_axis_word};
use super::table::MachineAxis;
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::text::number::{fixed, push_fixed, shortest};
use crate::text::one_line;

/// Decimals of tips in the work, mm.
const DECIMALS_OF_TIPS: usize = 4;
/// Letters of a block, about.
const BLOCK: usize = 80;

/// A program that mills along passes.
#[derive(Debug, Clone, PartialEq)]
pub struct PassProgram {
    /// Where it comes from.
    pub header: Header,
    /// What it mills, in one line.
    pub title: String,
    /// The axes, in the order of words.
    pub axes: Vec<MachineAxis>,
    /// The axis that takes the cutter away from the work, and where it stands when the cutter is away.
    pub retract: (usize, f64),
    /// The passes, in order.
    pub passes: Vec<ProgramPass>,
    /// Of the contact along the surface, mm/min.
    pub feed: f64,
    /// Revolutions of the cutter a minute.
    pub spindle: Option<f64>,
    /// What the words of blocks are of.
    pub words: WordsOf,
}

/// What the words of cutting blocks are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WordsOf {
    /// All axes, with inverse-time feed where the control has it.
    Axes,
    /// The tip in the work, and the rotary axes: the control keeps the tip on its way (tool-centre control).
    Tip,
}

/// A pass.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramPass {
    /// What it is, in one line.
    pub name: String,
    /// The positions of the axes: where the cutter comes down to, the positions on the surface, where it is lifted to; mm and radians.
    pub rows: Vec<Vec<f64>>,
    /// The tips there, in the work, mm.
    pub tips: Vec<[f64; 3]>,
    /// The way of the cutter to each row but the first, mm.
    pub ways: Vec<f64>,
}

/// Writes passes: the cutter away from the work, the other axes to the pass, down, along, up and away; spindle and coolant about all.
///
/// Blocks of axes have inverse-time feed (`G93`), so that the cutter goes along the surface with the feed whatever the rotary axes do; with
/// tool-centre control (`TRAORI`, `G43.4`, `FUNCTION TCPM`) the feed is that of the tip. Heidenhain's language has no inverse-time feed: `F` of
/// blocks of axes is their length over mm and degrees alike, per minute.
///
/// # Errors
/// When a position is beyond the travel of its axis, the control lacks an axis or takes no such feed, or the stream refuses.
pub fn write_passes(program: &PassProgram, dialect: Dialect, out: &mut dyn Write) -> Result<(), WriteError> {
    check_axes(&program.axes, dialect)?;
    let travels = program.axes.iter().map(MachineAxis::printed_travel).collect();
    let blocks = Blocks { program, dialect, travels, out: Vec::new() }.all()?;
    let step = dialect.numbering(blocks.len());
    for line in dialect.opening() {
        writeln!(out, "{line}")?;
    }
    for line in head(program, dialect).iter().flat_map(|remark| dialect.remark(remark)) {
        writeln!(out, "{line}")?;
    }
    for (index, block) in blocks.iter().enumerate() {
        match step {
            // a remark stands without a number
            Some(step) if !block.starts_with(['(', ';']) => writeln!(out, "N{} {block}", (index + 1) * step)?,
            _ => writeln!(out, "{block}")?,
        }
    }
    for line in dialect.closing() {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

fn head(program: &PassProgram, dialect: Dialect) -> Vec<String> {
    let header = &program.header;
    let mut head = vec![
        format!("job {}, for {}", header.job, dialect.name()),
        program.title.clone(),
        format!("by {}, spec {}, hash {}", header.program, header.spec, header.spec_hash),
    ];
    head.extend(header.conventions.iter().map(|sentence| format!("- {}", one_line(sentence))));
    head.push("- lengths in mm, angles in degrees; positions are absolute, no rotary axis may roll over".to_owned());
    head.push(match program.words {
        WordsOf::Axes => "- words are positions of the axes, counted as the control does; X Y Z of the tip".to_owned(),
        WordsOf::Tip => {
            "- X Y Z of cutting blocks are the tip in the work; rotary words are positions of the axes".to_owned()
        }
    });
    if program.words == WordsOf::Axes {
        head.push(format!("- F of cutting blocks: {}", dialect.feed_kind()));
    }
    head.push("- tool length as in the spec: no length is added".to_owned());
    for (index, axis) in program.axes.iter().enumerate() {
        let values = program.passes.iter().flat_map(|pass| &pass.rows).map(|row| row[index]);
        let ends = [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)];
        head.push(extent_line(axis, ends));
    }
    head
}

struct Blocks<'p> {
    program: &'p PassProgram,
    dialect: Dialect,
    /// Of each axis, as programs count it.
    travels: Vec<[f64; 2]>,
    out: Vec<String>,
}

impl Blocks<'_> {
    fn all(mut self) -> Result<Vec<String>, NcError> {
        let PassProgram { axes, passes, spindle, .. } = self.program;
        let decimals = axes.iter().filter(|axis| !axis.is_rotary).map(|axis| axis.decimals).max().unwrap_or(3);
        let least_increment = format!("{:.*}", usize::from(decimals), 10f64.powi(-i32::from(decimals)));
        self.out.extend(self.dialect.settling(&least_increment));
        let tool = self.dialect.tool(spindle.map(shortest).as_deref());
        if self.dialect == Dialect::Heidenhain {
            // no axis moves before a tool is called, and the call itself takes the spindle away
            self.out.extend(tool);
            self.retract()?;
        } else {
            self.retract()?;
            self.out.extend(tool);
        }
        self.out.push("M08".to_owned());
        for pass in passes {
            self.pass(pass)?;
        }
        self.out.extend(["M09", "M05", "M30"].map(str::to_owned));
        Ok(self.out)
    }

    /// The cutter away from the work.
    fn retract(&mut self) -> Result<(), NcError> {
        let (axis, position) = self.program.retract;
        let axis = &self.program.axes[axis];
        let word = axis_word(axis, position, self.dialect, &|| "the clearance plane".to_owned())?;
        self.out.push(self.dialect.rapid(&word));
        Ok(())
    }

    fn pass(&mut self, pass: &ProgramPass) -> Result<(), NcError> {
        let program = self.program;
        self.out.extend(self.dialect.remark(&pass.name));
        let last = pass.rows.len() - 1;
        let first = self.axis_words(pass, 0)?;
        let retract = program.retract.0;
        let others = first.iter().enumerate().filter(|(axis, _)| *axis != retract).map(|(_, word)| word.as_str());
        self.out.push(self.dialect.rapid(&others.collect::<Vec<_>>().join(" ")));
        self.out.push(self.dialect.rapid(&first[retract]));
        let (straight, _) = self.dialect.straight();
        match program.words {
            WordsOf::Axes => {
                let inverse_time = self.dialect.inverse_time();
                self.out.extend(inverse_time.map(|[on, _]| on.to_owned()));
                for row in 1..=last {
                    let mut block = String::with_capacity(BLOCK);
                    block.push_str(straight);
                    self.push_axis_words(pass, row, &mut block)?;
                    block.push_str(" F");
                    push_fixed(self.feed_of_axes(pass, row)?, self.dialect.feed_decimals(), &mut block);
                    self.out.push(block);
                }
                self.out.extend(inverse_time.map(|[_, off]| off.to_owned()));
            }
            WordsOf::Tip => {
                self.out.push(self.dialect.tip_control()[0].to_owned());
                for row in 1..=last {
                    let words = self.tip_words(pass, row)?;
                    self.out.push(format!("{straight} {words} F{}", fixed(program.feed, 1)));
                }
                self.out.push(self.dialect.tip_control()[1].to_owned());
            }
        }
        self.retract()
    }

    /// Each with a space before it.
    fn push_axis_words(&self, pass: &ProgramPass, row: usize, block: &mut String) -> Result<(), NcError> {
        let place = || format!("row {} of {}", row + 1, pass.name);
        let axes = self.program.axes.iter().zip(&self.travels).zip(&pass.rows[row]);
        for ((axis, travel), position) in axes {
            block.push(' ');
            push_axis_word((axis, *travel), *position, self.dialect, &place, block)?;
        }
        Ok(())
    }

    fn axis_words(&self, pass: &ProgramPass, row: usize) -> Result<Vec<String>, NcError> {
        let place = || format!("row {} of {}", row + 1, pass.name);
        let axes = self.program.axes.iter().zip(&pass.rows[row]);
        axes.map(|(axis, position)| axis_word(axis, *position, self.dialect, &place)).collect()
    }

    fn tip_words(&self, pass: &ProgramPass, row: usize) -> Result<String, NcError> {
        // the axes are where they can be, too
        let axes = self.axis_words(pass, row)?;
        let rotary = self.program.axes.iter().zip(axes).filter(|(axis, _)| axis.is_rotary).map(|(_, word)| word);
        let tip = ["X", "Y", "Z"].into_iter().zip(pass.tips[row]);
        let tip = tip.map(|(address, at)| self.dialect.word(address, &fixed(at, DECIMALS_OF_TIPS)));
        Ok(tip.chain(rotary).collect::<Vec<String>>().join(" "))
    }

    /// The feed of a block of all axes, so that the contact has the feed of the program.
    fn feed_of_axes(&self, pass: &ProgramPass, row: usize) -> Result<f64, NcError> {
        let range = self.dialect.feeds();
        let seconds = 60.0 * pass.ways[row - 1] / self.program.feed;
        let length = block_length(&self.program.axes, &pass.rows[row - 1], &pass.rows[row]);
        let feed = self.dialect.feed(seconds, length);
        // a block that is shorter than the control can tell takes the least time that it can
        let feed = feed.min(*range.end());
        if range.contains(&feed) {
            return Ok(feed);
        }
        Err(NcError::Feed {
            motion: format!("row {} of {}", row + 1, pass.name),
            seconds,
            kind: self.dialect.feed_kind(),
            feed,
            dialect: self.dialect.name(),
            low: *range.start(),
            high: *range.end(),
        })
    }
}
