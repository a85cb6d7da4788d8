//! Mutated specs: whatever a text contains, there is an answer and no panic.

use flank_chain_dsl::{compile_text, render};
use flank_expr::Graph;
use flank_tests::{Dice, library, problem};

fn words(text: &str) -> Vec<&str> {
    text.split_inclusive(|c: char| !c.is_alphanumeric() && c != '_').collect()
}

const STRANGE: [&str; 14] = [
    "0 mm",
    "0",
    "-",
    "1e308",
    "1e-320 mm",
    "90 deg",
    "[",
    "}",
    "..",
    "envelope(",
    "over:",
    "\u{0}",
    "φ",
    "translate(1 mm, 1 mm, 1 mm)",
];

fn mutated(text: &str, dice: &mut Dice) -> String {
    let mut parts = words(text).into_iter().map(str::to_string).collect::<Vec<_>>();
    for _ in 0..=dice.roll(3) {
        let (a, b) = (dice.roll(parts.len()), dice.roll(parts.len()));
        match dice.roll(5) {
            0 => parts[a] = String::new(),
            1 => parts[a] = parts[b].clone(),
            2 => parts.swap(a, b),
            3 => parts.insert(a, STRANGE[dice.roll(STRANGE.len())].to_string()),
            _ => parts[a] = STRANGE[dice.roll(STRANGE.len())].to_string(),
        }
    }
    parts.concat()
}

/// Compiles, shows what is wrong, and solves a few points of what is right.
fn survive(text: &str) -> bool {
    let graph = Graph::new();
    let compilation = compile_text(&graph, "mutated.chain", text, &[]);
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert_eq!(compilation.diagnostics.is_empty(), told.is_empty());
    for job in &compilation.jobs {
        for surface in &job.surfaces {
            let Some(sample) = &surface.sample else {
                continue;
            };
            let coordinates = sample.functions();
            let problem = problem(job, surface, coordinates);
            let few = &sample.targets()[..sample.targets().len().min(3)];
            let (points, _) = problem.solve(few, [few.len(), 1]);
            assert_eq!(points.len(), few.len());
        }
    }
    compilation.has_errors()
}

fn storm(parts: &[&str], rounds: usize, seed: u64) {
    let text = library(parts);
    assert!(!survive(&text), "the spec itself is right");
    let mut dice = Dice(seed);
    let wrong = (0..rounds).filter(|_| survive(&mutated(&text, &mut dice))).count();
    assert!(wrong > rounds / 3, "mutations mostly make a text wrong: {wrong} of {rounds}");
    assert!(wrong < rounds, "and some leave it right");
}

#[test]
fn spur_gear() {
    let machines = ["machines/hobbing_6axis.chain", "machines/rack_generating.chain"];
    storm(&[machines[0], machines[1], "tools/rack.chain", "hobbing/spur_gear.chain"], 400, 1);
}

#[test]
fn helical_gear() {
    let tools = ["tools/involute.chain", "tools/hob_zi.chain"];
    storm(
        &["machines/hobbing_6axis.chain", tools[0], tools[1], "functions/hobbing.chain", "hobbing/helical_gear.chain"],
        400,
        2,
    );
}

#[test]
fn pinion() {
    storm(
        &[
            "functions/bevel.chain",
            "machines/cradle.chain",
            "tools/face_mill.chain",
            "functions/blanks_19x62.chain",
            "bevel/pinion_19x62.chain",
        ],
        300,
        3,
    );
}
