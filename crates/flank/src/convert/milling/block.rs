//! What a block of a program says of the cutter.

/// M words that move no axis: stops, spindle, coolant, tool change, clamps of rotary axes, overrides.
const STILL: [i64; 16] = [0, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 14, 19, 48, 49];

/// A word of a block.
#[derive(Debug, PartialEq)]
pub(super) struct Word {
    pub(super) address: String,
    pub(super) value: f64,
    /// A rotary axis goes there by less than half a turn, whole turns not counted.
    pub(super) by_shorter_way: bool,
}

impl Word {
    pub(super) fn new(address: &str, value: f64) -> Word {
        Word { address: address.to_string(), value, by_shorter_way: false }
    }
}

/// How axes go on from here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Straight,
}

/// A block: what it changes, and where it goes.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Block {
    /// mm per unit of lengths.
    pub(super) unit: Option<f64>,
    /// Tool-centre control on or off.
    pub(super) tip_control: Option<bool>,
    pub(super) motion: Option<Motion>,
    pub(super) goes_to: Vec<Word>,
    /// Positions are those of the machine, not of the work.
    pub(super) is_elsewhere: bool,
    /// The number of its feed.
    pub(super) feed: Option<f64>,
    /// Feeds are the inverse of the time of a block from here on, or are not.
    pub(super) inverse_time: Option<bool>,
    /// The program ends.
    pub(super) ends: bool,
}

/// That no number stands behind an address.
pub(super) fn no_number(address: &str, value: &str) -> String {
    let is_read_elsewhere = |letter: char| letter.is_ascii_alphabetic() || matches!(letter, '#' | '[' | '<' | '(');
    match value.trim_start_matches(['+', '-']).chars().next() {
        Some(first) if is_read_elsewhere(first) => format!(
            "`{address}` has a parameter or an expression for a value, which is not read: write the number that it stands for"
        ),
        _ => format!("`{address}` has no number"),
    }
}

impl Block {
    /// An M word.
    ///
    /// # Errors
    /// If it is not known to leave the cutter where it is.
    pub(super) fn auxiliary(&mut self, value: f64) -> Result<(), String> {
        match value as i64 {
            2 | 30 => self.ends = true,
            97..=99 | 198 => return Err(format!("M{value} calls or ends a subprogram: write its blocks out")),
            known if STILL.contains(&known) => {}
            _ => return Err(format!("M{value} is not followed: leave it out for the check if it moves no axis")),
        }
        Ok(())
    }

    /// How it goes.
    ///
    /// # Errors
    /// If it is told twice.
    pub(super) fn goes(&mut self, motion: Motion) -> Result<(), String> {
        match self.motion.replace(motion) {
            Some(known) if known != motion => Err("G0 and G1 stand in one block".to_string()),
            _ => Ok(()),
        }
    }

    /// Where it goes.
    ///
    /// # Errors
    /// If that is told twice.
    pub(super) fn goes_to(&mut self, word: Word) -> Result<(), String> {
        if self.goes_to.iter().any(|known| known.address == word.address) {
            return Err(format!("`{}` stands twice in one block", word.address));
        }
        self.goes_to.push(word);
        Ok(())
    }
}
