//! What is proposed: the words that shipped specs have where they have them, and what makes a right text where it is accepted.

use std::path::Path;
use std::sync::Arc;

use flank::{Analysis, Buffers, Completion, CompletionKind, Disk, Project, Severity, analyse};
use flank_chain_dsl::FileId;
use flank_chain_dsl::syntax::{TokenKind, tokens};
use rayon::prelude::*;

use serde_json::json;

use crate::client::Client;
use crate::support::top;

fn analysed(path: &Path, text: &str) -> Analysis {
    let files = Buffers::over(Arc::new(Disk)).with(path, text);
    analyse(&Project::open(path, Arc::new(files)))
}

/// Of every part of the language.
const SPECS: [&str; 14] = [
    "specs/hobbing/spur_gear.chain",
    "specs/bevel/pinion_19x62.chain",
    "specs/pairs/spur_pair.chain",
    "specs/grinding/dressed_wheel.chain",
    "specs/bodies/rack_and_pinion_body.chain",
    "specs/tutorial/first_gear.chain",
    "specs/machines/cradle.chain",
    "specs/tools/rack.chain",
    "specs/machines/crank_and_rocker.chain",
    "specs/hobbing/crowned_gear.chain",
    "specs/tools/form_wheel.chain",
    "specs/pairs/bevel_19x62.chain",
    "specs/machines/relieving_lathe.chain",
    "specs/grinding/thread_wheel.chain",
];

/// Of the words that are not proposed: where they stand, and the number of proposals that there are.
struct Counted {
    words: usize,
    missing: Vec<String>,
}

/// Cuts every second word of a spec off, one after the other, each behind its first letter.
fn cut(spec: &str) -> Counted {
    let path = top().join(spec).canonicalize().expect("it is shipped");
    let text = std::fs::read_to_string(&path).expect("UTF-8");
    let whole = analysed(&path, &text);
    let defined: Vec<usize> =
        whole.classified().iter().filter(|word| word.is_definition).map(|word| word.span.start).collect();
    let words = tokens(&text, FileId(0)).into_iter().filter(|token| token.kind == TokenKind::Word);
    let spans = words.map(|token| token.span.start as usize..token.span.end as usize);
    let spans: Vec<_> = spans.filter(|span| !defined.contains(&span.start)).collect();
    let spans: Vec<_> = spans.into_iter().step_by(2).collect();
    let missing = spans.par_iter().filter_map(|span| {
        let word = &text[span.clone()];
        let letter = word.chars().next().expect("a letter").len_utf8();
        let typed = format!("{}{}", &text[..span.start + letter], &text[span.end..]);
        let found = analysed(&path, &typed).completions(span.start + letter);
        let line = text[..span.start].matches('\n').count() + 1;
        let is_it = |one: &Completion| one.label == word || one.label.starts_with(&format!("{word}."));
        (!found.iter().any(is_it)).then(|| format!("{spec}:{line}: {word}, of {}", found.len()))
    });
    Counted { missing: missing.collect(), words: spans.len() }
}

#[test]
fn the_words_of_shipped_specs_are_proposed_behind_their_first_letter() {
    let all: Vec<Counted> = SPECS.iter().map(|spec| cut(spec)).collect();
    let words: usize = all.iter().map(|counted| counted.words).sum();
    let missing: Vec<&String> = all.iter().flat_map(|counted| &counted.missing).collect();
    // what is left are units in formulas whose other side says less than they do, and names further down in a machine
    let share = missing.len() as f64 / words as f64;
    assert!(words > 1500, "{words}");
    assert!(share < 0.01, "{} of {words}:\n{missing:#?}", missing.len());
}

#[test]
fn proposals_take_the_place_of_what_stands_before_the_cursor() {
    for spec in [SPECS[5], SPECS[7]] {
        let path = top().join(spec).canonicalize().expect("it is shipped");
        let text = std::fs::read_to_string(&path).expect("UTF-8");
        let analysis = analysed(&path, &text);
        let places: Vec<usize> = (0..=text.len()).filter(|at| text.is_char_boundary(*at)).collect();
        places.par_iter().for_each(|&at| {
            for proposal in analysis.completions(at) {
                let replaced = &text[proposal.replaces.start..at];
                assert!(replaced.chars().all(|letter| letter.is_alphanumeric() || letter == '_'), "{spec}: {replaced}");
            }
        });
    }
}

const MACHINE: &str = "machine lathe {
    param depth : length = 2 mm
    axis X : linear
    axis Z : linear
    axis C : rotary
    frame bed
    frame slide in bed = translate(X, 0 mm, Z)
    frame work in bed = rotate_z(C)
}
machine other extends lathe {
    frame slide in bed = translate(X, 0 mm, Z)
}
tool ball {
    param radius : length = 5 mm
    let half = radius / 2
    surface face, back(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) for side in [1, -1] {
        let w = radius * cos(u)
        at = [20 mm - w * cos(v), side * w * sin(v), radius * sin(u)]
        body towards [1, 0, 0]
    }
}
";
const JOB: &str = "job thread {
    param lead : length / angle = 2 mm/rev
    machine m = lathe
    tool b = ball
    mount b on m.slide
    motion turn : angle in 0 deg .. 360 deg
    drive m.C = turn
    drive m.Z = lead * turn
    drive m.X = 20 mm
    surface groove in m.work = envelope(b.face, over: turn)
    sample groove { u: -50 deg .. 50 deg by 5, turn: 10 deg .. 350 deg by 9 }
}
";

/// What stands before a place and what is written there instead, with the mark of the place.
const PLACES: [(&str, &str); 24] = [
    ("frame work in bed", "frame work in |"),
    ("machine other extends lathe", "machine other extends |"),
    ("axis C : rotary", "axis C : |"),
    ("axis X : linear", "error other : |\n    axis X : linear"),
    ("param depth : length = 2 mm", "param depth : length = 2 |"),
    ("let half = radius / 2", "let half = |"),
    ("let w = radius * cos(u)", "let w = radius * cos(|)"),
    ("let w = radius * cos(u)", "let w = 1 * |"),
    ("body towards [1, 0, 0]", "body |"),
    ("machine m = lathe", "machine m = |"),
    ("tool b = ball", "tool b = |"),
    ("mount b on m.slide", "mount | on m.slide"),
    ("mount b on m.slide", "mount b on |"),
    ("mount b on m.slide", "mount b on m.|"),
    ("motion turn : angle in", "let qq = |\n    motion turn : angle in"),
    ("drive m.C = turn", "drive m.C = |"),
    ("drive m.C = turn", "drive | = turn"),
    ("drive m.X = 20 mm", "let qq = |\n    drive m.X = 20 mm"),
    ("drive m.X = 20 mm", "drive m.X = 20 |"),
    ("envelope(b.face, over: turn)", "envelope(|, over: turn)"),
    ("envelope(b.face, over: turn)", "envelope(b.|, over: turn)"),
    ("envelope(b.face, over: turn)", "envelope(b.face, over: |)"),
    ("sample groove", "sample |"),
    ("turn: 10 deg .. 350 deg by 9", "turn: 10 | .. 350 deg by 9"),
];

/// Whether a text with a proposal in it is right; none where it is the beginning of something longer.
fn is_right_with(proposal: &Completion, before: &str, behind: &str) -> Option<bool> {
    let is_whole =
        !proposal.is_snippet && !proposal.text.ends_with(['(', ' ']) && proposal.kind != CompletionKind::Keyword;
    is_whole.then(|| {
        let found = analysed(Path::new("/thread.chain"), &format!("{before}{}{behind}", proposal.text)).findings();
        found.iter().all(|found| found.finding.severity != Severity::Error)
    })
}

#[test]
fn what_is_proposed_makes_a_right_text() {
    let whole = format!("{MACHINE}{JOB}");
    let mut told = Vec::new();
    let (mut tried, mut right) = (0, 0);
    for (written, marked) in PLACES {
        let changed = whole.replacen(written, marked, 1);
        let (before, behind) = changed.split_once('|').unwrap_or_else(|| panic!("no {written}"));
        let found = analysed(Path::new("/thread.chain"), &format!("{before}{behind}")).completions(before.len());
        let judged: Vec<(&str, bool)> =
            found.iter().filter_map(|one| Some((one.label.as_str(), is_right_with(one, before, behind)?))).collect();
        let wrong: Vec<&str> = judged.iter().filter(|(_, is_right)| !is_right).map(|(label, _)| *label).collect();
        told.push(format!("{marked}: {} of {} wrong: {wrong:?}", wrong.len(), judged.len()));
        tried += judged.len();
        right += judged.len() - wrong.len();
    }
    // what is left has another dimension: a formula that begins with it may be right
    assert!(tried > 60 && right as f64 / tried as f64 > 0.7, "{right} of {tried}\n{}", told.join("\n"));
}

/// What is proposed at a mark in the text of the job.
fn proposed(written: &str, marked: &str) -> Vec<String> {
    let changed = format!("{MACHINE}{JOB}").replacen(written, marked, 1);
    let (before, behind) = changed.split_once('|').unwrap_or_else(|| panic!("no {written}"));
    let found = analysed(Path::new("/thread.chain"), &format!("{before}{behind}")).completions(before.len());
    found.into_iter().map(|one| one.label).collect()
}

/// Curvatures are known where points are tested, axes and other motions nowhere; corners are entries, and no values.
#[test]
fn of_points_what_they_have_is_proposed() {
    let other = "motion feed : length in 0 mm .. 1 mm\n    sample groove";
    let in_sample = |entry: &str| proposed("sample groove {", &format!("{other} {{ {entry}"));
    let has = |found: &[String], wanted: &[&str], unwanted: &[&str]| {
        assert!(wanted.iter().all(|one| found.iter().any(|of| of == one)), "{found:?} lacks some of {wanted:?}");
        assert!(!found.iter().any(|of| unwanted.contains(&of.as_str())), "{found:?} has some of {unwanted:?}");
    };
    let never = ["k1", "k2", "gaussian_curvature", "mean_curvature", "feed", "X"];
    has(&in_sample("|, "), &["rho", "toe_root", "lengthwise", "u", "turn"], &never);
    has(&in_sample("deep = |: 0 mm, "), &["rho", "u", "turn", "lead"], &[&never[..], &["toe_root"]].concat());
    has(&in_sample("deep = m.|: 0 mm, "), &["depth"], &never);
    let expected = |what: &str| {
        let all = format!("motion feed : length in 0 mm .. 1 mm\n    expect {what}\n    sample groove");
        proposed("sample groove", &all)
    };
    let never = ["gaussian_curvature", "mean_curvature", "feed", "X"];
    has(&expected("groove: |"), &["rho", "k1", "induced_k1", "u", "turn"], &never);
    has(&expected("groove: m.|"), &["depth"], &never);
}

/// A variant of a job changes settings of its machines and tools.
#[test]
fn settings_of_a_part_are_proposed_behind_its_dot() {
    let whole = format!("{MACHINE}{JOB}job other_thread = thread(lead: 3 mm/rev, m.");
    let found = analysed(Path::new("/thread.chain"), &format!("{whole})\n")).completions(whole.len());
    assert_eq!(found.iter().map(|one| one.text.as_str()).collect::<Vec<_>>(), ["depth: "]);
}

/// The blocks that are offered to an editor: their formats and texts.
fn blocks(client: &mut Client) -> Vec<(u64, String)> {
    client.open("file:///nowhere/empty.chain", "");
    let place = json!({ "line": 0, "character": 0 });
    let params = json!({ "textDocument": { "uri": "file:///nowhere/empty.chain" }, "position": place });
    let list = client.ask("textDocument/completion", params).expect("proposals");
    let items = list["items"].as_array().expect("a list").iter();
    let text = |item: &serde_json::Value| item["textEdit"]["newText"].as_str().expect("a text").to_string();
    let all = items.map(|item| (item["insertTextFormat"].as_u64().expect("a format"), text(item)));
    all.filter(|(_, text)| text.contains('\n')).collect()
}

#[test]
fn places_to_fill_are_for_editors_that_know_them() {
    let mut plain = Client::start();
    let all = blocks(&mut plain);
    assert_eq!(all.len(), 3);
    for (format, text) in &all {
        assert!(*format == 1 && !text.contains('$'), "{text}");
    }
    let machine = all.iter().find(|(_, text)| text.starts_with("machine")).expect("a machine");
    assert!(machine.1.starts_with("machine name {\n    axis C : rotary\n"), "{}", machine.1);
    assert_eq!(plain.end(), Some(0));
    let mut knowing = Client::silent();
    let item = json!({ "snippetSupport": true });
    let capabilities = json!({ "textDocument": { "completion": { "completionItem": item } } });
    let asked = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
    knowing.ask("initialize", asked).expect("it starts");
    knowing.tell("initialized", json!({}));
    assert!(blocks(&mut knowing).iter().all(|(format, text)| *format == 2 && text.contains("${1:name}")));
    assert_eq!(knowing.end(), Some(0));
}
