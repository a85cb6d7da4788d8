//! The two ways of reading, whole and in pieces, compared on texts that were damaged at random.

use std::ops::Range;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::source::FileId;
use crate::diagnostics::spelling::closest;

use super::grammar::{self, Rule};
use super::scan::Scan;
use super::{ast, build, limits, parse, recover, words};

const FILE: FileId = FileId(0);

const SPECS: [&str; 4] = [
    include_str!("../../tests/syntax/specs/hobbing.chain"),
    include_str!("../../tests/syntax/specs/face_mill.chain"),
    include_str!("../../tests/syntax/specs/gear_concave.chain"),
    include_str!("../../tests/syntax/specs/everything.chain"),
];

/// Knuth's linear congruential generator.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}

/// What the strict grammar makes of a text, if it accepts it.
fn whole(scan: &Scan) -> Option<(ast::File, Vec<Diagnostic>)> {
    if limits::first_excess(scan, 0..scan.tokens.len()).is_some() {
        return None;
    }
    grammar::strict(Rule::file, scan.text).ok().map(|pairs| build::file(scan, pairs))
}

/// Asks of any text what must hold for all; says whether it was accepted.
fn check(text: &str) -> bool {
    let scan = Scan::new(text, FILE);
    let (file, diagnostics) = parse(text, FILE);
    for diagnostic in &diagnostics {
        let spans = diagnostic.notes.iter().map(|note| note.span).chain([diagnostic.span]);
        for span in spans {
            let covered = text.get(span.start as usize..span.end as usize);
            assert!(covered.is_some_and(|covered| !covered.is_empty() || text.is_empty()), "{text}");
        }
        assert!(!diagnostic.message.is_empty() && diagnostic.message.len() < 300, "{text}");
        assert!(!diagnostic.message.contains("something else"), "{}\n{text}", diagnostic.message);
    }
    match whole(&scan) {
        Some(strict) => {
            assert_eq!((file, diagnostics), strict);
            let (pieces, reports) = recover::file(&scan, None);
            assert_eq!(pieces.items.len(), strict.0.items.len(), "{text}");
            assert_eq!(pieces, strict.0, "{text}");
            if strict.1.is_empty() {
                // nothing but that the strict grammar has nothing against it
                assert!(reports.len() == 1 && reports[0].message.ends_with("does not belong here"), "{text}");
            } else {
                assert_eq!(reports, strict.1, "{text}");
            }
            strict.1.is_empty()
        }
        None => {
            assert!(!diagnostics.is_empty(), "{text}");
            assert!(!diagnostics[0].message.ends_with("does not belong here"), "{text}");
            false
        }
    }
}

/// The bytes of a token, or of one character.
fn some_place(random: &mut Random, scan: &Scan) -> Range<usize> {
    if random.below(4) > 0 && !scan.tokens.is_empty() {
        let token = scan.tokens[random.below(scan.tokens.len())];
        return token.start as usize..token.end as usize;
    }
    let mut start = random.below(scan.text.len());
    while !scan.text.is_char_boundary(start) {
        start -= 1;
    }
    start..start + scan.text[start..].chars().next().map_or(0, char::len_utf8)
}

fn some_word(random: &mut Random) -> &'static str {
    const OTHERS: [&str; 40] = [
        "(", ")", "[", "]", "{", "}", ",", ":", "=", "..", ".", "+", "-", "*", "/", "^", "<", "==", "->", "\"", "\n",
        "//", "///", ";", "°", "α", "\0", "\u{feff}", "\r\n", "3", "1.5 mm", "x", "f(", "if ", " then ", " else ",
        "not ", " and ", "m.work", "'",
    ];
    let lists = [&OTHERS[..], words::ITEMS, words::IN_MACHINE, words::IN_SURFACE, words::IN_JOB, words::UNITS];
    let list = lists[random.below(lists.len())];
    list[random.below(list.len())]
}

/// A text with one thing deleted, doubled, swapped, replaced or put in.
fn damaged(random: &mut Random, text: &str) -> String {
    let scan = Scan::new(text, FILE);
    let place = some_place(random, &scan);
    let other = some_place(random, &scan);
    let (before, this, after) = (&text[..place.start], &text[place.clone()], &text[place.end..]);
    match random.below(6) {
        0 => format!("{before}{after}"),
        1 => format!("{before}{this} {this}{after}"),
        2 if place.end <= other.start => {
            let (between, rest) = (&text[place.end..other.start], &text[other.end..]);
            format!("{before}{}{between}{this}{rest}", &text[other])
        }
        3 => format!("{before}{}{after}", some_word(random)),
        4 => format!("{before} {} {this}{after}", some_word(random)),
        _ => format!("{before}{}{this}{after}", some_word(random)),
    }
}

#[test]
fn damaged_texts() {
    let mut random = Random(20_261_121);
    let mut accepted = 0;
    for round in 0..4000 {
        let mut text = SPECS[round % SPECS.len()].to_owned();
        for _ in 0..=random.below(3) {
            text = damaged(&mut random, &text);
        }
        accepted += usize::from(check(&text));
    }
    assert!((100..2000).contains(&accepted), "{accepted} of the damaged texts are still right");
}

#[test]
fn undamaged_and_truncated_texts() {
    for spec in SPECS {
        assert!(check(spec));
        for end in (0..spec.len()).filter(|&end| spec.is_char_boundary(end)).step_by(7) {
            check(&spec[..end]);
            check(&spec[end..]);
        }
    }
}

#[test]
fn random_words() {
    let mut random = Random(7);
    for _ in 0..2000 {
        let words: Vec<&str> = (0..random.below(40)).map(|_| some_word(&mut random)).collect();
        check(&words.join(if random.below(2) == 0 { " " } else { "\n" }));
        check(&format!("job j {{\n{}\n}}", words.join(" ")));
    }
}

/// A mistake in one statement says nothing of the others, whatever the shipped specs have in theirs.
#[test]
fn shipped_specs_are_read_alike_piece_by_piece() {
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../specs"))];
    let (mut read, mut wrong) = (0, Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "chain") {
                let text = std::fs::read_to_string(&path).unwrap();
                let (pieces, _) = recover::file(&Scan::new(&text, FILE), None);
                let (strict, _) = whole(&Scan::new(&text, FILE)).unwrap();
                read += 1;
                if pieces != strict {
                    wrong.push(path);
                }
            }
        }
    }
    assert!(read > 100 && wrong.is_empty(), "{wrong:?} of {read}");
    let expectations = "job j {\n    expect error E0307\n    expect on other within 1 um\n    expect 2 * a in 1 .. 2\n    \
                        expect contact near 3 within 1\n    expect error in 1 .. 2\n    expect (a) in 1 .. 2\n    expect nothing\n}\n";
    assert!(check(expectations));
}

/// One report for one word deleted or doubled.
#[test]
fn one_mistake_is_one_report() {
    for spec in SPECS {
        let scan = Scan::new(spec, FILE);
        for token in &scan.tokens {
            let (start, end) = (token.start as usize, token.end as usize);
            let deleted = format!("{}{}", &spec[..start], &spec[end..]);
            let doubled = format!("{} {}", &spec[..end], &spec[start..]);
            for text in [deleted, doubled] {
                let (_, diagnostics) = parse(&text, FILE);
                assert!(diagnostics.len() <= 1, "{}\n{diagnostics:#?}", &text);
            }
        }
    }
}

#[test]
fn the_scanner_knows_the_words_of_the_grammar() {
    let lists = [words::ITEMS, words::IN_MACHINE, words::IN_TOOL, words::IN_SURFACE, words::IN_JOB];
    let others = ["extends", "on", "in", "by", "if", "then", "else", "and", "or", "not", "μm"];
    let free =
        ["profile", "cut", "nc", "error", "insert", "close", "unknown", "solid", "contact", "want", "mill", "expect"];
    let reserved = lists.concat().into_iter().filter(|word| !free.contains(word)).chain(others);
    for word in reserved.chain(words::UNITS.iter().copied()).chain(words::DIMENSIONS.iter().copied()) {
        assert!(words::reserved(word).is_some(), "{word}");
        assert!(grammar::strict(Rule::job_piece, &format!("let {word} = 3")).is_err(), "{word}");
        let longer = format!("{word}x");
        assert!(words::reserved(&longer).is_none(), "{longer}");
        assert!(grammar::strict(Rule::job_piece, &format!("let {longer} = 3")).is_ok(), "{longer}");
    }
    for word in free.into_iter().chain(["along", "towards", "where", "as", "with"]) {
        assert!(
            words::reserved(word).is_none() && grammar::strict(Rule::job_piece, &format!("let {word} = 3")).is_ok()
        );
    }
    // what the grammar tells by first letters
    for line in include_str!("grammar.pest").lines().filter(|line| line.contains("'..'") && line.contains('"')) {
        let letter = line.split('\'').nth(1).unwrap();
        for rest in line.split('"').skip(1).step_by(2).filter(|rest| *rest != "//") {
            let word = format!("{letter}{rest}");
            assert!(words::reserved(&word).is_some(), "{word}");
        }
    }
}

#[test]
fn the_word_that_was_meant() {
    let meant = |word| closest(word, words::IN_JOB.iter().copied());
    assert_eq!(meant("mahcine"), Some("machine"));
    assert_eq!(meant("surfase"), Some("surface"));
    assert_eq!(meant("mot"), None);
    assert_eq!(meant("x"), None);
    assert_eq!(meant(""), None);
    assert_eq!(meant(&"m".repeat(1000)), None);
    assert_eq!(closest("cradel", ["cradle", "cradles"]), Some("cradle"));
}
