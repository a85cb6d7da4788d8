//! The settled layout: it keeps the meaning and every comment, it is its own layout, and it looks like the shipped specs.

mod generate;
#[allow(unreachable_pub)] // another crate's, where it is public
#[path = "../../../../tests/src/layout.rs"]
mod layout;

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Code, FileId, format};

use generate::Random;
use layout::{check_layout, meaning};

const FILE: FileId = FileId(0);

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// All files below a folder that have this extension, with their texts.
fn files(folder: &Path, extension: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|it| it == extension) {
            let text = std::fs::read_to_string(&path).expect("a text");
            found.push((path, text));
        }
    }
    found.sort();
    found
}

#[test]
fn shipped_specs_are_laid_out() {
    let specs = files(&folder("../../specs"), "chain");
    assert!(specs.len() >= 9);
    for (path, text) in specs {
        assert_eq!(format(&text, FILE).as_ref(), Ok(&text), "run `flank fmt {}`", path.display());
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        // a message is one text: it stands on a line of its own, however long it is
        let code = code.filter(|line| !line.trim_start().starts_with('"'));
        assert_eq!(code.filter(|line| line.chars().count() > 110).count(), 0, "{}", path.display());
    }
}

#[test]
fn specs_keep_meaning_and_comments() {
    let texts = [files(&folder("../../specs"), "chain"), files(&folder("tests"), "chain")].concat();
    assert!(texts.len() >= 14);
    for (path, text) in texts {
        let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
        assert!(check_layout(&text, &path.display().to_string()));
        assert!(check_layout(&std::format!("\u{feff}{}", text.replace('\n', "\r\n")), &path.display().to_string()));
        assert!(check_layout(&text.replace('\n', "\r"), &path.display().to_string()));
        assert!(check_layout(&text.replace("    ", "\t"), &path.display().to_string()));
    }
}

/// Fixtures hold mistakes; those of meaning and a few others parse.
#[test]
fn fixtures_keep_meaning_and_comments() {
    let fixtures = files(&folder("tests"), "txt");
    let texts = fixtures.iter().flat_map(|(path, text)| text.split("//---- ").map(move |text| (path, text)));
    let count =
        texts.filter(|(path, text)| check_layout(&std::format!("// {text}"), &path.display().to_string())).count();
    assert!(count > 80, "{count}");
}

#[test]
fn documentation_keeps_meaning_and_comments() {
    let page = std::fs::read_to_string(folder("../../docs/language.md")).expect("the page");
    let blocks = page.split("```chain").skip(1).filter_map(|block| block.split_once('\n')?.1.split_once("```"));
    let count = blocks.filter(|(block, _)| check_layout(block, "docs/language.md")).count();
    assert!(count >= 7, "{count}");
}

#[test]
fn generated_texts_keep_meaning_and_comments() {
    let parsed = (0..2000).filter(|&seed| check_layout(&generate::text(seed), &std::format!("seed {seed}"))).count();
    assert!(parsed > 1700, "{parsed}");
}

/// Comments put between any two words of the shipped specs.
#[test]
fn comments_in_odd_places_are_kept() {
    let mut random = Random(7);
    let mut parsed = 0;
    for (path, text) in files(&folder("../../specs"), "chain") {
        for _ in 0..25 {
            let mut words: Vec<String> = text.split_inclusive([' ', '\n', '(', ')', ',']).map(str::to_owned).collect();
            for _ in 0..=random.below(4) {
                let place = random.below(words.len());
                let comment = [" // a\n", "\n// a\n", "\n/// a\n", " /// a\n\n", "\n\n//! a\n\n"][random.below(5)];
                words.insert(place, comment.to_owned());
            }
            parsed += usize::from(check_layout(&words.concat(), &path.display().to_string()));
        }
    }
    assert!(parsed > 100, "{parsed}");
}

/// `before/NAME` becomes `after/NAME`; `UPDATE_LAYOUTS=1 cargo test` writes what it becomes now, to be read before it is
/// believed.
#[test]
fn layouts() {
    let texts = files(&folder("tests/layout/before"), "chain");
    assert!(!texts.is_empty());
    for (path, text) in texts {
        let laid_out = format(&text, FILE).expect("a text that parses");
        let after = folder("tests/layout/after").join(path.file_name().expect("a file"));
        if std::env::var_os("UPDATE_LAYOUTS").is_some() {
            std::fs::write(&after, &laid_out).expect("a writable file");
        }
        assert_eq!(laid_out, std::fs::read_to_string(&after).expect("the layout"), "{}", path.display());
    }
}

#[test]
fn brackets_stay_where_they_matter() {
    for text in [
        "(a - b) - c",
        "a - (b - c)",
        "-(a^2)",
        "(-a)^2",
        "-a^2",
        "2^-3",
        "2^3^4",
        "(2^3)^4",
        "not (a and b)",
        "not a and b",
        "-not a",
        "2 mm^2",
        "(2 mm)^2",
        "2 mm ^ 2",
        "2 mm ^ 0.5",
        "a / (b * c)",
        "(if a then b else c) + 1",
        "v[0][i + 1]",
        "2 mm/rev / x",
    ] {
        let text = std::format!("job j {{\n    let x = {text}\n}}\n");
        assert_eq!(format(&text, FILE).as_ref(), Ok(&text));
        assert!(check_layout(&text, &text));
    }
}

#[test]
fn a_text_that_does_not_parse_is_refused() {
    for text in ["machine m {", "job j { let x = 20 furlong }", "tool t { surface s(u: angle in 0 deg .. 1 deg) { } }"]
    {
        assert!(format(text, FILE).is_err_and(|findings| !findings.is_empty()), "{text}");
    }
}

#[test]
fn a_layout_is_no_longer_than_a_file_may_be() {
    let nearly_too_long = std::format!("job j {{\n{}}}", "//\n".repeat(300_000));
    assert!(meaning(&nearly_too_long).is_some());
    assert_eq!(format(&nearly_too_long, FILE).unwrap_err()[0].code, Code::LimitExceeded);
}
