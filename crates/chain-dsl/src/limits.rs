//! The limits of the language, in one place. Each is far above what machines and gears need; all together keep any text, also
//! a hostile one, within seconds and a few hundred megabytes.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;

/// What a text may ask for at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// The greatest number that is allowed.
    pub most: usize,
    /// What is counted, as the tables of the documentation say it.
    pub what: &'static str,
    unit: Unit,
    /// The message about what goes beyond, `{}` being the greatest number.
    message: &'static str,
    /// The way out.
    help: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Pieces,
    Bytes,
}

impl Limit {
    /// The greatest number as it is written: `65,536`, `1 MiB`.
    pub fn stated(self) -> String {
        if self.unit == Unit::Bytes {
            return format!("{} MiB", self.most >> 20);
        }
        let digits = self.most.to_string();
        let groups = digits.as_bytes().rchunks(3).rev().map(|group| String::from_utf8_lossy(group));
        groups.collect::<Vec<_>>().join(",")
    }

    /// The one report on whatever goes beyond the limit.
    pub(crate) fn exceeded(self, place: Span) -> Diagnostic {
        let message = self.message.replacen("{}", &self.stated(), 1);
        Diagnostic::new(Code::LimitExceeded, place, message).help(self.help)
    }
}

macro_rules! limits {
    ($($name:ident = $most:expr, $unit:ident, $what:literal, $message:literal, $help:literal;)*) => {
        $(
            #[doc = concat!("At most this: ", $what, ".")]
            pub const $name: Limit =
                Limit { most: $most, unit: Unit::$unit, what: $what, message: $message, help: $help };
        )*

        impl Limit {
            /// All limits, in the order of the documentation's tables.
            pub const ALL: &[Limit] = &[$($name),*];
        }
    };
}

limits! {
    FILE_BYTES = 1 << 20, Bytes, "size of a file",
        "a file of more than {}", "put tables of numbers into a CSV file, and split the rest with `use`";
    FILES = 256, Pieces, "files that a file uses, with those that they use",
        "more than {} files are used", "use only what is needed; a file may hold many machines and tools";
    ALL_BYTES = 4 << 20, Bytes, "size of all these files together",
        "the files that are used are more than {} together",
        "use only what is needed, and put tables of numbers into CSV files";
    USE_DEPTH = 32, Pieces, "files that use each other in a line",
        "files use each other more than {} deep", "let one file use the others side by side";
    WORD = 1_000, Pieces, "characters of a name, a number or a text in quotes",
        "a word of more than {} characters", "shorten it, or look for a missing space or `\"`";
    STATEMENT_TOKENS = 1 << 16, Pieces, "words and signs of one statement",
        "a statement of more than {} words and signs", "give the parts names with `let`";
    NESTING = 64, Pieces, "brackets, conditions and signs inside each other in an expression",
        "nested deeper than {} levels", "give the parts names with `let`";
    OPERATIONS = 256, Pieces, "operations that hang on each other in an expression",
        "more than {} operations hang on each other", "give the parts names with `let`";
    POWER = 99, Pieces, "power of a length or an angle, above or below a line",
        "a length or an angle to the power of more than {}", "write the formula in ratios, such as `(a / b)^n`";
    MISTAKES = 100, Pieces, "mistakes before the rest is left unread",
        "more than {} mistakes: the rest is not looked at", "begin with the first one; it may cause the others";
    CALL_DEPTH = 64, Pieces, "functions that call each other in a line",
        "functions call each other more than {} deep",
        "a function cannot call itself, nor others that lead back to it";
    LOOP = 6, Pieces, "axes that one closed loop gives",
        "more than {} axes are given by one loop", "close it in parts: loops that share no unknown axis are solved apart";
    EVALUATION_STEPS = 1_000_000, Pieces, "steps to evaluate a text",
        "the text takes more than {} steps to evaluate",
        "look for functions that call others many times over, and give repeated parts names with `let`";
    GRAPH_OPERATIONS = 4_000_000, Pieces, "operations written while formulas are derived",
        "deriving the formulas takes more than {} operations",
        "split the text into files with fewer frames and surfaces";
    EXTENDS_DEPTH = 64, Pieces, "machines that extend each other in a line",
        "machines extend each other more than {} deep", "write what they share into one machine that all extend";
    FRAMES = 10_000, Pieces, "frames of a machine",
        "a machine of more than {} frames",
        "put several transforms into one frame: `frame a in b = rotate_x(A) translate_y(Y)`";
    AXES = 256, Pieces, "axes of a machine, and of all machines of a job",
        "more than {} axes", "what never moves is a `param` or a `let`, not an axis";
    JOB_STATEMENTS = 4_000, Pieces, "statements of a job; one about several things counts for each",
        "a job of more than {} statements",
        "split it into several jobs, or take what they share into machines, tools and functions";
    MOTIONS = 32, Pieces, "motions of a job",
        "a job of more than {} motions", "what depends on another motion is a `let`, not a motion";
    SURFACE_UNKNOWNS = 8, Pieces, "unknowns of a surface: parameters of its tool and motions",
        "a surface of more than {} unknowns", "let some axes follow one motion: `drive m.X = 2 mm/rad * roll`";
    SAMPLE_POINTS = 20_000_000, Pieces, "points of all samples together",
        "samples of more than {} points", "`by` is followed by a number of points, not by a distance";
    SPLINE_POINTS = 256, Pieces, "points of a sample that a spline goes through",
        "a spline through more than {} points of a sample", "a wheel is dressed by fewer: ask for fewer points";
    TABLE_BYTES = 16 << 20, Bytes, "size of all tables that curves are read from, each reading counted",
        "the tables are more than {} together", "keep only the columns and rows that are needed";
    GRID_POINTS = 2_000, Pieces, "points of a grid",
        "a grid of more than {} points", "a spline needs only as many points as the surface has bends: thin it out";
    TABLE_ROWS = 100_000, Pieces, "rows of a table",
        "a table of more than {} rows", "a curve needs only as many points as it has bends: thin the table out";
}
