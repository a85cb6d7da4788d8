//! Passes of a cutter as an NC program (ISO 6983) that a machine runs from start to end.

use std::io::Write;

use super::dialect::Dialect;
use super::nc::{NcError, axis_word, block_length, check_axes, extent_line, push_axis_word};
use super::table::MachineAxis;
use super::tip::TipFrame;
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::text::number::{fixed, push_fixed, shortest};
use crate::text::one_line;

/// The least feed of a tip, mm/min: one decimal of it is written.
const LEAST_FEED: f64 = 0.1;
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
    /// The axis that takes the cutter away from the work at the beginning, and where it stands then.
    pub home: (usize, f64),
    /// The passes, in order.
    pub passes: Vec<ProgramPass>,
    /// The same behind the last pass; nothing where the cutter is away already.
    pub end: Option<(usize, f64)>,
    /// Whether the spindle points along one axis all the time: rotary axes may then turn while the others stand.
    pub is_upright: bool,
    /// Of the contact along the surface, mm/min.
    pub feed: f64,
    /// Revolutions of the cutter a minute.
    pub spindle: Option<f64>,
    /// What the words of blocks are of.
    pub words: WordsOf,
}

/// What the words of cutting blocks are of.
#[derive(Debug, Clone, PartialEq)]
pub enum WordsOf {
    /// All axes, with inverse-time feed where the control has it.
    Axes,
    /// The tip in a frame that goes with the work, and the rotary axes: the control keeps the tip on its way (tool-centre control).
    Tip(TipFrame),
}

/// A pass.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramPass {
    /// What it is, in one line.
    pub name: String,
    /// The rapids to where the cutter comes down to, in order; the last one ends there.
    pub approach: Vec<ProgramRapid>,
    /// The positions of the axes: where the cutter comes down to, the positions on the surface, where it is lifted to; mm and radians.
    pub rows: Vec<Vec<f64>>,
    /// The tips there, in the frame of words of the tip, mm.
    pub tips: Vec<[f64; 3]>,
    /// The way of the contact to each row but the first, of the tip down to the surface and up from it, mm.
    pub ways: Vec<f64>,
    /// The rapids that take the cutter away, in order.
    pub away: Vec<ProgramRapid>,
}

/// A rapid: all axes go straight.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramRapid {
    /// The positions of all axes at its end; mm and radians.
    pub row: Vec<f64>,
    /// The tip there, in the frame of words of the tip, mm.
    pub tip: [f64; 3],
    /// The axes that move.
    pub moves: Vec<usize>,
}

/// Writes passes: the cutter away from the work, then for each its rapids, down, along, up and away; spindle and coolant about all.
///
/// With tool-centre control there is one zero, that of the work, from which rapids count, too. Only the first way out, for which nothing is known of
/// where the cutter is, and that at the end are positions of the machine (`G53`, `SUPA`, `M91`).
///
/// Blocks of axes have inverse-time feed (`G93`), so that the cutter goes along the surface with the feed whatever the rotary axes do; with
/// tool-centre control (`TRAORI`, `G43.4`, `FUNCTION TCPM`) `F` is the feed of the tip with which the contact goes so fast. Heidenhain's language has no inverse-time feed: `F` of
/// blocks of axes is their length over mm and degrees alike, per minute.
///
/// # Errors
/// When a position is beyond the travel of its axis, the control lacks an axis or takes no such feed, or the stream refuses.
pub fn write_passes(program: &PassProgram, dialect: Dialect, out: &mut dyn Write) -> Result<(), WriteError> {
    check_axes(&program.axes, dialect)?;
    let travels = program.axes.iter().map(MachineAxis::printed_travel).collect();
    let blocks =
        Blocks { program, dialect, travels, has_tip_control: false, is_positioned: false, out: Vec::new() }.all()?;
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
    match &program.words {
        WordsOf::Axes => {
            head.push("- words are positions of the axes, counted as the control does; X Y Z of the tip".to_owned());
            head.push(format!("- F of cutting blocks: {}", dialect.feed_kind()));
            head.push(dialect.zero_of_axes());
            head.push(format!("- tool length as in the spec, no length is added: {}", dialect.length_of_axes()));
        }
        WordsOf::Tip(frame) => {
            let sentences = frame.sentences(&program.axes, dialect);
            head.extend(sentences.into_iter().map(|sentence| format!("- {sentence}")));
        }
    }
    if !program.is_upright {
        head.push(format!("- in rapids all axes go straight and arrive together{}", dialect.straight_rapids()));
    }
    if program.spindle.is_none() {
        head.push("- no speed is said: the program does not start the spindle".to_owned());
    }
    head.push(
        "- axes are said from where to where they go on passes; rapids and ways down and up go farther".to_owned(),
    );
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
    /// Whether the control keeps the tip on its way.
    has_tip_control: bool,
    /// Whether all axes have their positions.
    is_positioned: bool,
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
            self.alone(self.program.home)?;
        } else {
            self.alone(self.program.home)?;
            self.out.extend(tool);
        }
        self.out.push("M08".to_owned());
        for pass in passes {
            self.pass(pass)?;
        }
        self.tip_control(false);
        if let Some(end) = self.program.end {
            self.alone(end)?;
        }
        self.out.extend(["M09", "M05", "M30"].map(str::to_owned));
        Ok(self.out)
    }

    /// One axis to a position of the machine, the cutter away from the work.
    fn alone(&mut self, (axis, position): (usize, f64)) -> Result<(), NcError> {
        let axis = &self.program.axes[axis];
        let word = axis_word(axis, position, self.dialect, &|| "the clearance plane".to_owned())?;
        self.out.push(match self.program.words {
            WordsOf::Axes => self.dialect.rapid(&word),
            WordsOf::Tip(_) => self.dialect.rapid_of_machine(&word),
        });
        Ok(())
    }

    fn tip_control(&mut self, on: bool) {
        if self.has_tip_control != on {
            self.out.push(self.dialect.tip_control()[usize::from(!on)].to_owned());
            self.has_tip_control = on;
        }
    }

    fn rapid(&mut self, rapid: &ProgramRapid, name: &str) -> Result<(), NcError> {
        let place = || format!("a rapid of {name}");
        // the axes are where they can be, too
        let axes = self.words_of_axes(&rapid.row, &place)?;
        let of = |keep: &dyn Fn(usize) -> bool| {
            rapid.moves.iter().filter(|axis| keep(**axis)).map(|axis| axes[*axis].clone()).collect::<Vec<_>>()
        };
        let WordsOf::Tip(frame) = &self.program.words else {
            self.out.push(self.dialect.rapid(&of(&|_| true).join(" ")));
            return Ok(());
        };
        let mut rotary = of(&|axis| self.program.axes[axis].is_rotary);
        // a spindle that leans swings about its axes unless the control keeps its tip where it is
        if !rotary.is_empty() && (self.program.is_upright || !self.is_positioned) {
            self.tip_control(false);
            self.out.push(self.dialect.rapid(&rotary.join(" ")));
            rotary.clear();
        }
        self.tip_control(true);
        self.is_positioned = true;
        let words: Vec<String> = self.words_of_tip(frame, rapid.tip).into_iter().chain(rotary).collect();
        self.out.push(self.dialect.rapid(&words.join(" ")));
        Ok(())
    }

    fn pass(&mut self, pass: &ProgramPass) -> Result<(), NcError> {
        let program = self.program;
        self.out.extend(self.dialect.remark(&pass.name));
        pass.approach.iter().try_for_each(|rapid| self.rapid(rapid, &pass.name))?;
        let (straight, _) = self.dialect.straight();
        match &program.words {
            WordsOf::Axes => {
                let inverse_time = self.dialect.inverse_time();
                self.out.extend(inverse_time.map(|[on, _]| on.to_owned()));
                for row in 1..pass.rows.len() {
                    let mut block = String::with_capacity(BLOCK);
                    block.push_str(straight);
                    self.push_axis_words(pass, row, &mut block)?;
                    block.push_str(" F");
                    push_fixed(self.feed_of_axes(pass, row)?, self.dialect.feed_decimals(), &mut block);
                    self.out.push(block);
                }
                self.out.extend(inverse_time.map(|[_, off]| off.to_owned()));
            }
            WordsOf::Tip(frame) => {
                for row in 1..pass.rows.len() {
                    let words = self.tip_words(frame, pass, row)?;
                    self.out.push(format!("{straight} {words} F{}", fixed(self.feed_of_tip(pass, row), 1)));
                }
            }
        }
        pass.away.iter().try_for_each(|rapid| self.rapid(rapid, &pass.name))
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

    fn words_of_axes(&self, row: &[f64], place: &dyn Fn() -> String) -> Result<Vec<String>, NcError> {
        let axes = self.program.axes.iter().zip(row);
        axes.map(|(axis, position)| axis_word(axis, *position, self.dialect, place)).collect()
    }

    /// With the decimals of the axes that have the same words.
    fn words_of_tip(&self, frame: &TipFrame, tip: [f64; 3]) -> Vec<String> {
        let words = frame.linear.iter().map(|axis| &self.program.axes[*axis]).zip(tip);
        words.map(|(axis, at)| self.dialect.word(&axis.address, &fixed(at, usize::from(axis.decimals)))).collect()
    }

    fn tip_words(&self, frame: &TipFrame, pass: &ProgramPass, row: usize) -> Result<String, NcError> {
        // the axes are where they can be, too
        let axes = self.words_of_axes(&pass.rows[row], &|| format!("row {} of {}", row + 1, pass.name))?;
        let rotary = self.program.axes.iter().zip(axes).filter(|(axis, _)| axis.is_rotary).map(|(_, word)| word);
        Ok(self.words_of_tip(frame, pass.tips[row]).into_iter().chain(rotary).collect::<Vec<String>>().join(" "))
    }

    /// The feed of the tip in a block, so that the contact has the feed of the program, mm/min.
    fn feed_of_tip(&self, pass: &ProgramPass, row: usize) -> f64 {
        let [from, to] = [pass.tips[row - 1], pass.tips[row]];
        let way = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum::<f64>().sqrt();
        // no control takes a feed of nothing
        (self.program.feed * way / pass.ways[row - 1]).max(LEAST_FEED)
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
