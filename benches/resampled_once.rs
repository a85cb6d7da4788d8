//! A surface of the library with another number of points, again and again, for the count of instructions: `resampled_once
//! SPEC:JOB.SURFACE SIDE REPETITIONS`.

use std::env::args;
use std::hint::black_box;
use std::process::ExitCode;

use flank_tests::resampled::Resampled;

fn main() -> ExitCode {
    let words: Vec<String> = args().skip(1).collect();
    let number = |k: usize| words.get(k).and_then(|word| word.parse::<usize>().ok());
    let (Some(name), Some(side), Some(repetitions)) = (words.first(), number(1), number(2)) else {
        eprintln!("usage: resampled_once SPEC:JOB.SURFACE SIDE REPETITIONS");
        return ExitCode::FAILURE;
    };
    let is_meant = |spec: &str| name.strip_prefix(spec).is_some_and(|rest| rest.starts_with(':'));
    let Some(surface) = Resampled::shipped(side, is_meant).find(|surface| surface.name == *name) else {
        eprintln!("no surface of the library is called {name}");
        return ExitCode::FAILURE;
    };
    let mut memory = None;
    for _ in 0..repetitions {
        memory = Some(black_box(surface.solve(memory.take()).0));
    }
    ExitCode::SUCCESS
}
