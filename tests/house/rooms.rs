//! What the crates must not contain, as ARCHITECTURE.md states it.

use std::path::{Path, PathBuf};

use flank_tests::repository;

/// All that the library `flank` stands on, and itself.
const BELOW: [&str; 6] = ["expr", "chain-dsl", "solver", "export", "draw", "flank"];

/// Lines of the command line and the page that it serves at the most, and of the protocol of editors beside it.
const MOST_LINES: [usize; 2] = [4500, 2850];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder of sources");
    let inner = entries.map(|entry| entry.expect("an entry").path()).flat_map(|path| {
        if path.is_dir() {
            sources(&path)
        } else {
            let is_rust = path.extension().is_some_and(|extension| extension == "rs");
            Vec::from_iter(is_rust.then_some(path))
        }
    });
    let mut all: Vec<PathBuf> = inner.collect();
    all.sort();
    all
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).expect("UTF-8")
}

/// A source without its comments.
fn code(path: &Path) -> String {
    let text = text(path);
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.map(|line| format!("{line}\n")).collect()
}

/// The rooms of a crate, each after all that it uses.
const ROOMS: [(&str, &[&str]); 3] = [
    (
        "solver",
        &[
            "equations",
            "newton",
            "roots",
            "continuation",
            "surface",
            "analysis",
            "contact",
            "solid",
            "conversion",
            "milling",
        ],
    ),
    ("export", &["vector", "text", "schema", "files", "points", "shape", "solid", "step", "motion", "measuring"]),
    ("flank", &["project", "solve", "compare", "convert", "draw", "report", "page", "testing", "exchange", "language"]),
];

/// Entries of a crate's `src/` at the most.
const MOST_ENTRIES: usize = 12;

#[test]
fn rooms_use_only_those_before_them() {
    for (folder, rooms) in ROOMS {
        let root = repository(&format!("crates/{folder}/src"));
        for (number, room) in rooms.iter().enumerate() {
            let inner = if root.join(room).is_dir() {
                sources(&root.join(room))
            } else {
                vec![root.join(format!("{room}.rs"))]
            };
            for path in inner {
                let code = code(&path);
                let before_tests = code.split("#[cfg(test)]").next().unwrap_or_default();
                for later in &rooms[number + 1..] {
                    assert!(!before_tests.contains(&format!("crate::{later}::")), "{} uses {later}", path.display());
                }
            }
        }
    }
}

#[test]
fn a_crate_shows_at_most_a_dozen_entries() {
    for folder in BELOW.iter().chain(&["cli", "lsp"]) {
        let entries = std::fs::read_dir(repository(&format!("crates/{folder}/src"))).expect("a folder").count();
        assert!(entries <= MOST_ENTRIES, "{folder}: {entries}");
    }
}

#[test]
fn libraries_know_no_terminal() {
    for folder in BELOW {
        let manifest = text(&repository(&format!("crates/{folder}/Cargo.toml")));
        assert!(!manifest.contains("clap"), "{folder} depends on the argument parser");
        for path in sources(&repository(&format!("crates/{folder}/src"))) {
            let code = code(&path);
            for word in ["println!", "eprintln!", "std::process::exit", "clap::"] {
                assert!(!code.contains(word), "{}: {word}", path.display());
            }
        }
    }
}

/// An error is a type with its reasons. Functions of a crate's own may still hand words to each other.
#[test]
fn no_public_function_returns_words_as_an_error() {
    for folder in BELOW {
        for path in sources(&repository(&format!("crates/{folder}/src"))) {
            let code = code(&path);
            for signature in code.split("pub fn ").skip(1) {
                let signature = signature.split(['{', ';']).next().unwrap_or_default();
                let result = signature.rsplit("-> ").next().unwrap_or_default();
                let is_of_words = result.starts_with("Result<") && result.contains(", String>");
                assert!(!is_of_words, "{}: {signature}", path.display());
            }
        }
    }
}

#[test]
fn the_command_line_is_thin() {
    for shell in ["cli", "lsp"] {
        let manifest = text(&repository(&format!("crates/{shell}/Cargo.toml")));
        let dependencies = manifest.split("[dev-dependencies]").next().expect("a part at least");
        for package in ["flank-expr", "flank-solver", "flank-chain-dsl", "flank-draw"] {
            assert!(!dependencies.contains(package), "{shell} depends on {package}");
        }
    }
    let page = repository("crates/lsp/src/live");
    let (page, protocol): (Vec<PathBuf>, Vec<PathBuf>) =
        sources(&repository("crates/lsp/src")).into_iter().partition(|path| path.starts_with(&page));
    let others = [sources(&repository("crates/cli/src")), page].concat();
    for (paths, most) in [(others, MOST_LINES[0]), (protocol, MOST_LINES[1])] {
        let lines: usize = paths.iter().map(|path| text(path).lines().count()).sum();
        assert!(lines <= most, "{lines} lines, {most} at the most");
    }
}

/// Only a shell knows how its users spell options: the libraries name the fields of requests.
#[test]
fn libraries_name_no_flag() {
    let is_flag = |line: &str| {
        line.match_indices("--").any(|(at, _)| line[at + 2..].starts_with(|letter: char| letter.is_ascii_lowercase()))
    };
    for folder in BELOW {
        for path in sources(&repository(&format!("crates/{folder}/src"))) {
            let code = code(&path);
            let before_tests = code.split("#[cfg(test)]").next().unwrap_or_default();
            if let Some(line) = before_tests.lines().find(|line| is_flag(line)) {
                panic!("{}: {line}", path.display());
            }
        }
    }
}

/// What a `use` names, without its braces: `a::{b, c::d}` as `a::b` and `a::c::d`.
fn named(tree: &str) -> Vec<String> {
    let Some((before, inside)) = tree.split_once('{') else { return vec![tree.trim().to_string()] };
    let inside = inside.trim_end().trim_end_matches('}');
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for letter in inside.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        match letter {
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().expect("there is one").push(letter),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty()).flat_map(|part| named(part));
    parts.map(|part| format!("{}{part}", before.trim())).collect()
}

/// The module of a file in a crate: `solve::cut` of `solve/cut.rs`, nothing of the root.
fn module(root: &Path, path: &Path) -> String {
    let inside = path.strip_prefix(root).expect("a file of the crate").with_extension("");
    let parts: Vec<&str> = inside.iter().map(|part| part.to_str().expect("UTF-8")).collect();
    let ends_with_root = matches!(parts.last(), Some(&("mod" | "lib" | "main")));
    parts[..parts.len() - usize::from(ends_with_root)].join("::")
}

/// Files that need each other in a circle cannot be read one by one.
#[test]
fn no_files_use_each_other_in_a_circle() {
    for folder in ["flank", "cli", "lsp"] {
        let root = repository(&format!("crates/{folder}/src"));
        let files = sources(&root);
        let modules: Vec<String> = files.iter().map(|path| module(&root, path)).collect();
        let owner = |path: &str| {
            let inside = |module: &str| path == module || path.starts_with(&format!("{module}::"));
            let found = modules.iter().enumerate().filter(|(_, module)| !module.is_empty() && inside(module));
            found.max_by_key(|(_, module)| module.len()).map(|(k, _)| k)
        };
        let uses = |k: usize| -> Vec<usize> {
            let code = code(&files[k]);
            let before_tests = code.split("#[cfg(test)]").next().unwrap_or_default();
            let statements = before_tests.split("use crate::").skip(1).filter_map(|rest| rest.split_once(';'));
            let paths = statements.flat_map(|(tree, _)| named(tree));
            paths.filter_map(|path| owner(&path)).filter(|used| *used != k).collect()
        };
        let all: Vec<Vec<usize>> = (0..files.len()).map(uses).collect();
        for first in 0..files.len() {
            let (mut reached, mut open) = (vec![false; files.len()], all[first].clone());
            while let Some(next) = open.pop() {
                if !std::mem::replace(&mut reached[next], true) {
                    open.extend(&all[next]);
                }
            }
            assert!(!reached[first], "{folder}: {} needs itself", modules[first]);
        }
    }
}
