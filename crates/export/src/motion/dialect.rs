//! In what the controls differ.

use std::ops::RangeInclusive;

/// Whose words an NC program uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// Fanuc and what follows it.
    Fanuc,
    /// Siemens Sinumerik 840D.
    Siemens840D,
    /// LinuxCNC.
    LinuxCnc,
    /// Heidenhain TNC in its own language, Klartext.
    Heidenhain,
}

impl Dialect {
    /// All of them.
    pub const ALL: [Dialect; 4] = [Dialect::Fanuc, Dialect::Siemens840D, Dialect::LinuxCnc, Dialect::Heidenhain];

    /// Its name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Dialect::Fanuc => "Fanuc",
            Dialect::Siemens840D => "Siemens 840D",
            Dialect::LinuxCnc => "LinuxCNC",
            Dialect::Heidenhain => "Heidenhain",
        }
    }

    /// How names of its program files end.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Dialect::Fanuc => "nc",
            Dialect::Siemens840D => "mpf",
            Dialect::LinuxCnc => "ngc",
            Dialect::Heidenhain => "h",
        }
    }

    /// A remark on lines of its own. The first one begins as the text does, which therefore begins with a word of this program; all others
    /// begin with a sign. Controls take some remarks for orders by how they begin, LinuxCNC `(PY,…)` and `(LOGOPEN,…)`.
    pub(super) fn remark(self, text: &str) -> Vec<String> {
        let wrap = |line: String| match self {
            Dialect::Siemens840D | Dialect::Heidenhain => format!("; {line}"),
            Dialect::Fanuc => format!("({})", line.to_ascii_uppercase()),
            Dialect::LinuxCnc => format!("({line})"),
        };
        lines(&remarkable(text)).into_iter().map(wrap).collect()
    }

    /// What stands before all blocks.
    pub(super) fn opening(self) -> &'static [&'static str] {
        match self {
            Dialect::Fanuc => &["%", "O0001"],
            Dialect::Siemens840D => &[],
            Dialect::LinuxCnc => &["%"],
            Dialect::Heidenhain => &["BEGIN PGM FLANK MM"],
        }
    }

    /// What stands behind them.
    pub(super) fn closing(self) -> &'static [&'static str] {
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc => &["%"],
            Dialect::Siemens840D => &[],
            Dialect::Heidenhain => &["END PGM FLANK MM"],
        }
    }

    /// The block that settles how words are meant: metric, absolute, no compensation, no cycle, from the first zero.
    pub(super) fn settling(self, least_increment: &str) -> Option<String> {
        match self {
            Dialect::Fanuc => Some("G21 G17 G90 G40 G49 G80 G94 G54".to_owned()),
            Dialect::Siemens840D => Some("G710 G17 G90 G40 G94 G54 G64".to_owned()),
            // along the path as close as positions are written, without leaving out positions
            Dialect::LinuxCnc => Some(format!("G21 G17 G90 G40 G49 G80 G94 G54 G64 P{least_increment} Q0")),
            // its first block says metric, `L` is absolute, and `R0` stands in the rapids
            Dialect::Heidenhain => None,
        }
    }

    /// What positions count from, for people.
    pub(super) fn zero(self) -> &'static str {
        match self {
            Dialect::Fanuc | Dialect::Siemens840D | Dialect::LinuxCnc => "zero [G54]",
            // it has presets, which cycle 247 calls by the row of a table
            Dialect::Heidenhain => "datum, the preset that is active, since no block calls one",
        }
    }

    /// A line of the head: that they count from where the axes do.
    pub(super) fn zero_of_axes(self) -> String {
        format!("- {}: where the axes of the machine count from", self.zero())
    }

    /// What has to be set so that words of the tip go with the work, behind a sentence that says so.
    pub(super) fn frame_of_tip(self) -> &'static str {
        match self {
            Dialect::Fanuc => ": bit WKP of parameter 19696 is 0",
            Dialect::Siemens840D | Dialect::LinuxCnc | Dialect::Heidenhain => "",
        }
    }

    /// The words that turn inverse-time feed on and off; none where blocks have a feed per minute.
    pub(super) fn inverse_time(self) -> Option<[&'static str; 2]> {
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc => Some(["G93", "G94"]),
            // a constant feed in each block, whatever profile was set before
            Dialect::Siemens840D => Some(["G93 FNORM", "G94"]),
            Dialect::Heidenhain => None,
        }
    }

    /// The feed of a block of all axes that takes so many seconds: 1/min, or its length in mm and degrees per minute.
    pub(super) fn feed(self, seconds: f64, length: f64) -> f64 {
        match self.inverse_time() {
            Some(_) => 60.0 / seconds,
            None => 60.0 * length / seconds,
        }
    }

    /// What the feed of blocks of all axes is, for people.
    pub(super) fn feed_kind(self) -> &'static str {
        match self.inverse_time() {
            Some(_) => "inverse-time feed in 1/min",
            None => "feed per minute over mm and deg alike",
        }
    }

    /// A block that goes to a position as fast as the machine can.
    pub(super) fn rapid(self, words: &str) -> String {
        match self {
            Dialect::Heidenhain => format!("L {words} R0 FMAX"),
            Dialect::Fanuc | Dialect::Siemens840D | Dialect::LinuxCnc => format!("G00 {words}"),
        }
    }

    /// The same to a position of the machine itself, whatever zero is set.
    pub(super) fn rapid_of_machine(self, words: &str) -> String {
        match self {
            Dialect::Heidenhain => format!("L {words} R0 FMAX {}", self.of_machine()),
            Dialect::Fanuc | Dialect::Siemens840D | Dialect::LinuxCnc => format!("G00 {} {words}", self.of_machine()),
        }
    }

    /// The word of blocks whose positions are those of the machine.
    pub(super) fn of_machine(self) -> &'static str {
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc => "G53",
            Dialect::Siemens840D => "SUPA",
            Dialect::Heidenhain => "M91",
        }
    }

    /// What tool lengths have to be where words are positions of the axes.
    pub(super) fn length_of_axes(self) -> &'static str {
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc => "none is called, the zero of Z is that of the tip",
            Dialect::Siemens840D => "that of T1 D1 has to be 0, or D0 be set",
            Dialect::Heidenhain => "L and R of tool 1 have to be 0 in its table",
        }
    }

    /// What tool lengths have to be where words are the tip.
    pub(super) fn length_of_tip(self) -> &'static str {
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc => "H1 has to be the length of the tool up to its tip",
            Dialect::Siemens840D => "T1 D1 has to have the length of the tool up to its tip",
            Dialect::Heidenhain => "L of tool 1 has to be its length up to its tip",
        }
    }

    /// What has to be set so that rapids go straight.
    pub(super) fn straight_rapids(self) -> &'static str {
        match self {
            Dialect::Fanuc => ": bit LRP of parameter 1401 is 1",
            Dialect::Siemens840D => ": RTLION",
            Dialect::LinuxCnc | Dialect::Heidenhain => "",
        }
    }

    /// The word before a block that goes straight with feed, and whether it holds for the blocks behind.
    pub(super) fn straight(self) -> (&'static str, bool) {
        match self {
            Dialect::Heidenhain => ("L", false),
            Dialect::Fanuc | Dialect::Siemens840D | Dialect::LinuxCnc => ("G01", true),
        }
    }

    /// The blocks that bring the first tool and let it turn.
    pub(super) fn tool(self, spindle: Option<&str>) -> Vec<String> {
        match (self, spindle) {
            (Dialect::Heidenhain, Some(speed)) => vec![format!("TOOL CALL 1 Z S{speed}"), "M3".to_owned()],
            (Dialect::Heidenhain, None) => vec!["TOOL CALL 1 Z".to_owned()],
            (_, Some(speed)) => vec!["T1 M06".to_owned(), format!("S{speed} M03")],
            (_, None) => vec!["T1 M06".to_owned()],
        }
    }

    /// The words that turn tool-centre control on and off.
    pub(super) fn tip_control(self) -> [&'static str; 2] {
        match self {
            // the tip's place in the work, the tool's length as it is
            Dialect::Fanuc => ["G43.4 H1", "G49"],
            Dialect::Siemens840D => ["TRAORI", "TRAFOOF"],
            Dialect::LinuxCnc => ["M428", "M429"],
            // the feed is the tip's in the work, rotary words are positions of the axes, which turn evenly
            Dialect::Heidenhain => ["FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "FUNCTION RESET TCPM"],
        }
    }

    /// An axis word.
    pub(super) fn word(self, address: &str, position: &str) -> String {
        let mut text = String::new();
        self.address(address, &mut text);
        let from = text.len();
        text.push_str(position);
        self.sign(from, &mut text);
        text
    }

    /// Puts an address behind a text.
    pub(super) fn address(self, address: &str, text: &mut String) {
        text.push_str(address);
        if self != Dialect::Heidenhain && address.len() > 1 {
            text.push('=');
        }
    }

    /// Gives the number that stands behind a place of a text its sign, where the control wants one of those above zero, too.
    pub(super) fn sign(self, from: usize, text: &mut String) {
        if self == Dialect::Heidenhain && !text[from..].starts_with('-') {
            text.insert(from, '+');
        }
    }

    /// Whether it has axes of this address.
    pub(super) fn has_axis(self, address: &str) -> bool {
        let letters = match self {
            Dialect::Fanuc | Dialect::LinuxCnc | Dialect::Heidenhain => "ABCUVWXYZ",
            Dialect::Siemens840D => "ABCQUVWXYZ",
        };
        let mut characters = address.chars();
        let is_led = characters.next().is_some_and(|first| letters.contains(first));
        let rest = characters.as_str();
        match self {
            Dialect::Fanuc | Dialect::LinuxCnc | Dialect::Heidenhain => is_led && rest.is_empty(),
            Dialect::Siemens840D => is_led && rest.len() <= 2 && rest.bytes().all(|c| c.is_ascii_digit()),
        }
    }

    /// Decimals of the feed of blocks of all axes.
    pub(super) fn feed_decimals(self) -> usize {
        match self {
            Dialect::Fanuc | Dialect::Siemens840D | Dialect::Heidenhain => 3,
            Dialect::LinuxCnc => 6,
        }
    }

    /// Feeds that it takes for blocks of all axes.
    pub(super) fn feeds(self) -> RangeInclusive<f64> {
        match self {
            Dialect::Fanuc => 0.001..=9_999.999,
            Dialect::Siemens840D => 0.001..=999_999.999,
            Dialect::LinuxCnc => 0.000_001..=f64::MAX,
            Dialect::Heidenhain => 0.001..=99_999.999,
        }
    }

    /// The step of block numbers of so many blocks; none where they are not customary or would grow too long.
    pub(super) fn numbering(self, blocks: usize) -> Option<usize> {
        const LARGEST: usize = 99_999;
        match self {
            Dialect::LinuxCnc | Dialect::Heidenhain => None,
            Dialect::Fanuc | Dialect::Siemens840D => [10, 1].into_iter().find(|step| blocks * step <= LARGEST),
        }
    }
}

/// Text that every control takes in a remark: printable ASCII without what ends a remark, a block or a program.
fn remarkable(text: &str) -> String {
    let settled = |c: char| match c {
        '(' => '[',
        ')' => ']',
        ';' => ',',
        '%' => '/',
        // a line that ends with it goes on
        '~' => '-',
        ' '..='~' => c,
        c if c.is_control() => ' ',
        _ => '?',
    };
    text.chars().map(settled).collect()
}

/// Broken into lines that every control takes, between words and within those that are longer than a line.
fn lines(text: &str) -> Vec<String> {
    const WIDTH: usize = 72;
    const GOES_ON: &str = "+";
    let mut lines: Vec<String> = Vec::new();
    let mut words: Vec<&str> = text.split_ascii_whitespace().rev().collect();
    while let Some(word) = words.pop() {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            Some(line) if line == GOES_ON => {
                let (fits, rest) = word.split_at(WIDTH - 1 - line.len());
                line.push(' ');
                line.push_str(fits);
                words.push(rest);
            }
            Some(_) => {
                lines.push(GOES_ON.to_owned());
                words.push(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    lines
}
