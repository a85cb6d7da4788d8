//! What pages show behind `$` is run, and prints what they show.
//!
//! Numbers may differ by rounding, times by anything. `UPDATE_PAGES=1` writes what is printed today into the pages.
#![cfg(unix)]

mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

use support::{folder, text, top};

/// Residuals and last digits of points differ between processors and with each change of the order of operations.
const ROUNDING: f64 = 1e-9;
/// A line that stands for lines that a page does not show.
const LEFT_OUT: &str = "…";

/// A page, the file that its blocks of the language make, and what a reader changes in it: from the line that begins with the first text
/// to the next block or change, the second text is replaced by the third.
struct Page {
    path: &'static str,
    file: &'static str,
    changes: &'static [[&'static str; 3]],
}

const fn page(path: &'static str) -> Page {
    Page { path, file: "page.chain", changes: &[] }
}

const PAGES: [Page; 9] = [
    Page {
        path: "docs/tutorial.md",
        file: "gear.chain",
        changes: &[
            ["Leave out a unit:", "pressure_angle : angle = 20 deg", "pressure_angle : angle = 20"],
            ["Forget an axis:", "    drive m.Y = reference_radius * roll\n", ""],
            ["The help line is", "", ""],
        ],
    },
    Page { path: "docs/new_variant.md", file: "skiving.chain", changes: &[] },
    Page { path: "docs/testing.md", file: "gear.chain", changes: &[] },
    page("docs/conversion.md"),
    page("docs/milling.md"),
    page("docs/contact.md"),
    page("docs/files.md"),
    page("docs/fit.md"),
    page("docs/gears.md"),
];

/// The reader of a page, in a folder with the library.
struct Reader {
    folder: PathBuf,
    /// The right blocks so far.
    right: String,
    page: &'static Page,
}

impl Reader {
    fn new(page: &'static Page) -> Reader {
        let name = page.path.replace('/', "_");
        let folder = folder(&name);
        std::os::unix::fs::symlink(top().canonicalize().expect("the repository").join("specs"), folder.join("specs"))
            .expect("a link to the library");
        Reader { folder, right: String::new(), page }
    }

    fn write(&self, text: &str) {
        std::fs::write(self.folder.join(self.page.file), text).expect("the page's file");
    }

    fn block(&mut self, is_wrong: bool, block: &str) {
        let gap = if self.right.is_empty() { "" } else { "\n" };
        let whole = format!("{}{gap}{block}", self.right);
        self.write(&whole);
        if !is_wrong {
            self.right = whole;
        }
    }

    fn sentence(&self, line: &str) {
        if let Some([_, from, to]) = self.page.changes.iter().find(|[start, ..]| line.starts_with(start)) {
            assert!(self.right.contains(from), "{}: no `{from}` to change", self.page.path);
            self.write(&self.right.replacen(from, to, 1));
        }
    }

    /// Everything that a command prints, line by line.
    fn run(&self, command: &str) -> Vec<String> {
        let binary = Path::new(env!("CARGO_BIN_EXE_flank")).parent().expect("a folder");
        let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap_or_default());
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("({command}) 2>&1")]).current_dir(&self.folder).env("PATH", path);
        let output = shell.env("LC_ALL", "C").output().expect("the shell runs");
        text(&output.stdout).lines().map(|line| line.trim_end().to_string()).collect()
    }
}

/// The page with what its commands print today, and how that differs from what it shows.
fn read_aloud(page: &'static Page) -> (String, Vec<String>) {
    let shown = std::fs::read_to_string(top().join(page.path)).expect("the page is there");
    let mut reader = Reader::new(page);
    let (mut out, mut differences) = (String::new(), Vec::new());
    let mut lines = shown.lines().peekable();
    while let Some(line) = lines.next() {
        out += &format!("{line}\n");
        if let Some(kind) = line.strip_prefix("```chain") {
            let mut block = String::new();
            for line in lines.by_ref().take_while(|line| *line != "```") {
                block += &format!("{line}\n");
            }
            out += &format!("{block}```\n");
            reader.block(!kind.is_empty(), &block);
        } else if let Some(first) = line.strip_prefix("    $ ") {
            let mut command = first.to_string();
            while command.ends_with('\\') {
                let more = lines.next().expect("a command goes on");
                out += &format!("{more}\n");
                command = format!("{} {}", command.trim_end_matches('\\'), more.trim());
            }
            if let Some(gap) = lines.next_if(|line| line.is_empty()) {
                out += &format!("{gap}\n");
            }
            let mut expected = Vec::new();
            while let Some(line) =
                lines.next_if(|line| (line.starts_with("    ") && !line.starts_with("    $ ")) || line.is_empty())
            {
                expected.push(line.strip_prefix("    ").unwrap_or(line).to_string());
            }
            let gap = expected.iter().rev().take_while(|line| line.is_empty()).count();
            expected.truncate(expected.len() - gap);
            let printed = reader.run(&command);
            if !is_shown(&expected, &printed) {
                let [expected, printed] = [&expected, &printed].map(|lines| lines.join("\n"));
                differences.push(format!("{}: $ {command}\nshown:\n{expected}\nprinted:\n{printed}\n", page.path));
            }
            let is_excerpt = expected.iter().any(|line| line.trim() == LEFT_OUT);
            for line in if is_excerpt { &expected } else { &printed } {
                out += if line.is_empty() { "\n".to_string() } else { format!("    {line}\n") }.as_str();
            }
            out += &"\n".repeat(gap);
        } else {
            reader.sentence(line);
        }
    }
    (out, differences)
}

/// Whether lines are what is printed, a line of `…` for any number of them.
fn is_shown(expected: &[String], printed: &[String]) -> bool {
    let parts: Vec<&[String]> = expected.split(|line| line.trim() == LEFT_OUT).collect();
    let last = parts.len() - 1;
    let mut from = 0;
    parts.iter().enumerate().all(|(number, part)| {
        let fits = |at: &usize| {
            let lines = printed.get(*at..*at + part.len()).unwrap_or_default();
            let is_bound = (number > 0 || *at == 0) && (number < last || at + part.len() == printed.len());
            is_bound && lines.len() == part.len() && part.iter().zip(lines).all(|(a, b)| is_same(a, b))
        };
        let found = (from..=printed.len()).find(fits);
        from = found.map_or(from, |at| at + part.len());
        found.is_some()
    })
}

/// Word by word, but for times and rounding.
fn is_same(expected: &str, printed: &str) -> bool {
    let words = |line: &str| -> Vec<String> {
        line.split([' ', ',', ';', '(', ')']).filter(|word| !word.is_empty()).map(str::to_string).collect()
    };
    let [expected, printed] = [words(expected), words(printed)];
    let is_time = |at: usize| expected.get(at + 1).is_some_and(|unit| ["ms", "s"].contains(&unit.as_str()));
    let is_near = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= ROUNDING * (1.0 + a.abs()),
        _ => false,
    };
    let mut pairs = expected.iter().zip(&printed).enumerate();
    expected.len() == printed.len() && pairs.all(|(at, (a, b))| a == b || is_near(a, b) || is_time(at))
}

#[test]
fn pages_show_what_is_printed() {
    let mut differences = Vec::new();
    for page in &PAGES {
        let (today, found) = read_aloud(page);
        if std::env::var_os("UPDATE_PAGES").is_some() {
            std::fs::write(top().join(page.path), today).expect("the page is written");
        } else {
            differences.extend(found);
        }
    }
    assert!(differences.is_empty(), "run with UPDATE_PAGES=1 and look at the pages:\n\n{}", differences.join("\n"));
}
