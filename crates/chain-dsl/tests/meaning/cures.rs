//! Changes of the text: each one that a finding offers mends it, and whatever names a change in words offers it.

use std::path::Path;
use std::sync::Arc;

use flank_chain_dsl::{Buffers, Code, Cure, Diagnostic, Disk, Request, compile_request, compile_text};
use flank_expr::Graph;

use crate::LIBRARY;
use crate::files::project;
use crate::fixtures::{TITLE, is_remark};

fn folder(name: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read_to_string(path).expect("a text")).collect()
}

/// The fixtures of a folder, without the remarks in them.
fn mistakes(name: &str) -> Vec<String> {
    let without_remarks = |text: &str| text.split_inclusive('\n').filter(|line| !is_remark(line)).collect();
    let of_file = |file: String| -> Vec<String> {
        let texts = file.split(TITLE).skip(1).map(|text| text.split_once('\n').expect("a text below its title").1);
        texts.map(without_remarks).collect()
    };
    folder(name).into_iter().flat_map(of_file).collect()
}

/// Wrong texts: all fixtures, and the blocks of the pages about errors.
fn wrong_texts() -> Vec<String> {
    let of_page = |page: String| -> Vec<String> {
        let blocks = page.split("```chain\n").skip(1).map(|block| block.split("```").next().unwrap_or_default());
        blocks.map(str::to_string).collect()
    };
    let meaning = mistakes("tests/meaning/mistakes").into_iter().map(|text| format!("{text}{LIBRARY}"));
    let pages = folder("../../docs/errors").into_iter().flat_map(of_page);
    meaning.chain(mistakes("tests/syntax/mistakes")).chain(pages).collect()
}

fn found(text: &str) -> Vec<Diagnostic> {
    compile_text(&Graph::new(), "text", text, &[]).diagnostics
}

fn changed(text: &str, cure: &Cure) -> String {
    let [start, end] = [cure.span.start, cure.span.end].map(|at| at as usize);
    format!("{}{}{}", &text[..start], cure.replacement, &text[end..])
}

/// Whether it is still found where it was found before a change.
fn is_found(all: &[Diagnostic], of: &Diagnostic, by: &Cure) -> bool {
    let start = of.span.start;
    let moved =
        if start >= by.span.end { start + by.replacement.len() as u32 + by.span.start - by.span.end } else { start };
    all.iter().any(|found| (found.code, &found.message, found.span.start) == (of.code, &of.message, moved))
}

/// How much of a text cannot be read.
fn unread(all: &[Diagnostic]) -> usize {
    all.iter().filter(|found| found.code == Code::Syntax).count()
}

/// Whether a help tells words that could be written as they stand. What is an example says so, what the user has to fill in is a `…`, and
/// a word alone names something.
fn names_a_change(help: &str) -> bool {
    const IMPERATIVE: [&str; 5] = ["write `", "did you mean `", "there is: `", "leave `", "add `"];
    const OF_EXAMPLES: [&str; 5] = ["for example ", "such as ", "as in ", ", as ", "an "];
    let quoted: Vec<&str> = help.split('`').collect();
    if IMPERATIVE.iter().any(|begins| help.starts_with(begins)) && !quoted[1].contains('…') {
        return true;
    }
    let mut is_example = false;
    for pair in quoted.chunks_exact(2) {
        let (before, words) = (pair[0], pair[1]);
        is_example = match before.trim_matches([',', ' ']) {
            "" | "or" | "and" => is_example,
            _ => OF_EXAMPLES.iter().any(|word| before.ends_with(word)),
        };
        let is_word = words.chars().all(|letter| letter.is_alphanumeric() || "_.:+-*/^={}[]()".contains(letter));
        if !is_example && !is_word && !words.contains('…') {
            return true;
        }
    }
    false
}

#[test]
fn every_change_mends_what_offers_it_and_every_help_that_names_one_offers_it() {
    let (mut wrong, mut changes) = (Vec::new(), 0);
    for text in wrong_texts() {
        let before = found(&text);
        for finding in &before {
            for cure in &finding.cures {
                let mended = changed(&text, cure);
                let after = found(&mended);
                if is_found(&after, finding, cure) || unread(&after) > unread(&before) {
                    wrong.push(format!("{} {}: {}\n{mended}", finding.code.as_str(), finding.message, cure.title));
                }
                changes += 1;
            }
            if let Some(help) = finding.help.as_ref().filter(|help| finding.cures.is_empty() && names_a_change(help)) {
                wrong.push(format!(
                    "{} {}\nhelp without its change: {help}\n{text}",
                    finding.code.as_str(),
                    finding.message
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(changes > 100, "{changes}");
}

/// What is offered for a `use` in `jobs/gear.chain`, among files on the disk and texts that are nowhere but in memory.
fn meant_by(used: &str) -> Option<String> {
    let on_disk = [("machines/hobbing/lathe.chain", ""), ("machines/planer.chain", ""), ("machines/notes.txt", "")];
    let folder = project("slips", &on_disk);
    let main = folder.join("jobs/gear.chain");
    let files = Buffers::over(Arc::new(Disk))
        .with(&main, format!("use \"{used}\""))
        .with(&folder.join("jobs/blank.chain"), "")
        .with(&folder.join("../beside.chain"), "");
    let graph = Graph::new();
    let compilation = compile_request(&graph, &main, &Request { files: Arc::new(files), ..Request::default() });
    let finding = compilation.diagnostics.iter().find(|found| found.code == Code::UnreadableFile).expect("a finding");
    assert_eq!(finding.help.as_ref().expect("a help").contains("did you mean"), !finding.cures.is_empty());
    finding.cures.first().map(|cure| cure.replacement.clone())
}

#[test]
fn a_slip_in_a_path_is_mended_by_the_nearest_file() {
    std::fs::create_dir_all(project("slips", &[]).join("jobs")).expect("a folder");
    for (used, meant) in [
        ("../mahcines/planer.chain", "../machines/planer.chain"),
        ("../machines/planar.chain", "../machines/planer.chain"),
        ("../machine/hobing/lahte.chain", "../machines/hobbing/lathe.chain"),
        ("../machines/planer", "../machines/planer.chain"),
        ("blanc.chain", "blank.chain"),
    ] {
        assert_eq!(meant_by(used), Some(format!("\"{meant}\"")), "{used}");
    }
    for used in ["../machines/spindle.chain", "../machines/notes", "../tools/planer.chain", "../machines/", ""] {
        assert_eq!(meant_by(used), None, "{used}");
    }
}

/// A value far off would be right by chance; a unit or a parent that cannot stand there is wrong for sure.
#[test]
fn what_cannot_be_meant_is_not_offered() {
    let written = |text: &str| -> Vec<String> {
        let finding = found(text).into_iter().next().expect("a finding");
        finding.cures.into_iter().map(|cure| cure.replacement).collect()
    };
    assert!(written("tool t { param radius : length let a = zeta * radius }").is_empty());
    assert_eq!(written("tool t { param radius : length = 4 m }"), ["mm", "um", "µm", "cm", "inch"]);
    assert_eq!(written("tool t { param tilt : angle in 0 deg .. 9 gon }"), ["deg", "rad", "arcmin", "arcsec", "rev"]);
    let machines = "machine a extends none { } machine b extends a { } machine c { frame bed }";
    assert_eq!(written(machines), ["c"]);
    let frames =
        "machine m { frame base frame a in none = mirror_x() frame b in a = mirror_x() frame c in none = mirror_x() }";
    assert_eq!(written(frames), ["base"]);
}
