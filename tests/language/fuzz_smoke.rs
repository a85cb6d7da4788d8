//! What the fuzzers do, for a few seconds and without a fuzzing engine: the inputs that they once found, hostile inputs, and
//! the same random mutations in every run.

#[path = "../src/conversation.rs"]
#[expect(unreachable_pub, reason = "the fuzzers call it from elsewhere")]
mod conversation;

use std::path::PathBuf;

use conversation::fuzz_lsp;
use flank_tests::targets::{fuzz_layout, fuzz_meaning, fuzz_parser};
use flank_tests::{Dice, repository};

/// Mutated inputs for each target, and conversations: each has threads of its own.
const ROUNDS: usize = 3_000;
const CONVERSATIONS: usize = 1_000;

fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![repository(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| extensions.iter().any(|wanted| found == *wanted)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn contents(paths: Vec<PathBuf>) -> Vec<Vec<u8>> {
    paths.iter().map(|path| std::fs::read(path).expect("a readable file")).collect()
}

/// The specs, and each text of the fixtures by itself.
fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = contents(files("specs", &["chain"]));
    seeds.extend(contents(files("crates/chain-dsl/tests", &["chain"])));
    for fixture in contents(files("crates/chain-dsl/tests", &["txt"])) {
        let text = String::from_utf8(fixture).expect("fixtures are UTF-8");
        seeds.extend(text.split("//---- ").skip(1).map(|text| text.as_bytes().to_vec()));
    }
    assert!(seeds.len() > 200, "{}", seeds.len());
    seeds
}

/// Bytes changed, cut out, doubled or taken from another input.
fn mutated(input: &[u8], other: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..=dice.roll(4) {
        let (from, length) = (dice.roll(bytes.len() + 1), 1 + dice.roll(20));
        let to = (from + length).min(bytes.len());
        match dice.roll(5) {
            0 if from < to => bytes[from] = dice.roll(256) as u8,
            1 => drop(bytes.drain(from..to)),
            2 => {
                let part = bytes[from..to].to_vec();
                let place = dice.roll(bytes.len() + 1);
                bytes.splice(place..place, part);
            }
            3 => {
                let start = dice.roll(other.len() + 1);
                let part = &other[start..(start + length).min(other.len())];
                bytes.splice(from..to, part.iter().copied());
            }
            _ if from < to => bytes[from] ^= 1 << dice.roll(8),
            _ => {}
        }
    }
    bytes
}

fn storm(target: fn(&[u8]), (seeds, rounds): (&[Vec<u8>], usize), seed: u64) {
    let mut dice = Dice(seed);
    for _ in 0..rounds {
        let (input, other) = (&seeds[dice.roll(seeds.len())], &seeds[dice.roll(seeds.len())]);
        let input = mutated(input, other, &mut dice);
        let told = std::panic::catch_unwind(|| target(&input));
        assert!(told.is_ok(), "keep this input in tests/language/fuzz_inputs:\n{}", String::from_utf8_lossy(&input));
    }
}

#[test]
fn inputs_found_before() {
    let inputs = contents(files("tests/language/fuzz_inputs", &["input"]));
    assert!(!inputs.is_empty());
    for input in inputs {
        fuzz_parser(&input);
        fuzz_layout(&input);
        fuzz_meaning(&input);
    }
}

#[test]
fn parser() {
    storm(fuzz_parser, (&seeds(), ROUNDS), 1);
}

#[test]
fn layout() {
    storm(fuzz_layout, (&seeds(), ROUNDS), 3);
}

#[test]
fn meaning() {
    storm(fuzz_meaning, (&seeds(), ROUNDS), 2);
}

#[test]
fn lsp() {
    let seeds = contents(files("tests/language/conversations", &["lsp"]));
    assert!(seeds.len() > 2, "{}", seeds.len());
    seeds.iter().for_each(|conversation| fuzz_lsp(conversation));
    storm(fuzz_lsp, (&seeds, CONVERSATIONS), 4);
}
