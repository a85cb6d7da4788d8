//! What a control has to know so that words of a tip bring it where they should.

use super::dialect::Dialect;
use super::table::MachineAxis;
use crate::text::number::fixed;

/// Decimals of directions.
const OF_DIRECTIONS: usize = 6;

/// The frame that words of a tip are in: along the words X Y Z of the machine while words of rotary axes are zero, and fast to the work. Its origin is
/// that of the work's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TipFrame {
    /// The name of the work's frame.
    pub work: String,
    /// Where all axes stand with the tip in the origin and words of rotary axes at zero, mm and radians.
    pub zero: Vec<f64>,
    /// Which axes have the words X Y Z.
    pub linear: [usize; 3],
    /// x of the work in this frame.
    pub work_x: [f64; 3],
    /// z of the work in this frame.
    pub work_z: [f64; 3],
    /// The rotary axes.
    pub turns: Vec<TipTurn>,
}

/// A rotary axis, where all of them have words of zero.
#[derive(Debug, Clone, PartialEq)]
pub struct TipTurn {
    /// Which axis it is.
    pub axis: usize,
    /// Whether it turns the work, else the spindle.
    pub carries_work: bool,
    /// Right-handed about it the words grow.
    pub about: [f64; 3],
    /// A point on its line, from where the tip is then.
    pub through: [f64; 3],
}

impl TipFrame {
    /// Sentences for the head of a program.
    pub(super) fn sentences(&self, axes: &[MachineAxis], dialect: Dialect) -> Vec<String> {
        let word = |axis: &usize| dialect.word(&axes[*axis].address, &axes[*axis].printed(self.zero[*axis]));
        let words = |some: &[usize]| some.iter().map(word).collect::<Vec<String>>().join(" ");
        let rotary: Vec<usize> = (0..axes.len()).filter(|axis| axes[*axis].is_rotary).collect();
        let [at_zero, place] = [words(&rotary), words(&self.linear)];
        let work = &self.work;
        let mut sentences = vec![
            "X Y Z are the tip, of rapids, too; rotary words are positions of the axes".to_owned(),
            format!(
                "{}: the origin of {work}; with {at_zero} it lies at {place} of the machine as the spec counts",
                dialect.zero()
            ),
            format!(
                "X Y Z of the tip run along those of the machine with {at_zero}, and go with the work{}",
                dialect.frame_of_tip()
            ),
            format!(
                "with {at_zero} x of {work} points along {}, its z along {}",
                direction(self.work_x),
                direction(self.work_z)
            ),
        ];
        sentences.extend(self.turns.iter().map(|turn| self.sentence(turn, axes, dialect)));
        sentences.push(format!("{} are positions of the machine itself, at the end of a travel", dialect.of_machine()));
        sentences.push(dialect.length_of_tip().to_owned());
        sentences
    }

    /// How an axis turns.
    fn sentence(&self, turn: &TipTurn, axes: &[MachineAxis], dialect: Dialect) -> String {
        let place = |k: usize| {
            let axis = &axes[self.linear[k]];
            let from = if turn.carries_work { axis.programmed(self.zero[self.linear[k]]) } else { 0.0 };
            dialect.word(&axis.address, &fixed(from + turn.through[k], usize::from(axis.decimals)))
        };
        let place = [0, 1, 2].map(place).join(" ");
        let about = direction(turn.about);
        let address = &axes[turn.axis].address;
        match turn.carries_work {
            true => format!("{address} turns the work right-handed about {about} through {place} of the machine"),
            false => format!("{address} turns the spindle right-handed about {about} through {place} from the tip"),
        }
    }
}

fn direction(vector: [f64; 3]) -> String {
    format!("[{}]", vector.map(|part| fixed(part, OF_DIRECTIONS)).join(" "))
}
