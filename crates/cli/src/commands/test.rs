//! `flank test`

use std::collections::HashMap;
use std::io::{BufRead, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use flank::{
    TestRequest, TestResult, TestedSnapshot, TestedSpec, accept_snapshot, find_specs, junit, test, write_texts,
};

use crate::arguments::Test;
use crate::failure::{Failure, findings_in_full};
use crate::progress::Terminal;
use crate::spelling::with_flags;
use crate::{Ending, document, eprint, print};

/// How often saved files are looked for.
const LOOK: Duration = Duration::from_millis(200);

/// Servers that build software say so.
const BUILD_SERVER: &str = "CI";

pub(crate) fn run(arguments: &Test) -> Result<Ending, Failure> {
    check_keeping(arguments)?;
    let specs = find_specs(&arguments.paths)?;
    let mut result = tested(arguments, &specs)?;
    if arguments.watch {
        return watch(arguments, result);
    }
    if arguments.review {
        review(&mut result)?;
        // what was accepted differs no more
        result = TestResult::of_specs(result.specs);
    }
    Ok(if result.failed == 0 { Ending::Done } else { Ending::Unsolved })
}

/// # Errors
/// If snapshots are to be kept where nobody looks at them.
fn check_keeping(arguments: &Test) -> Result<(), Failure> {
    let is_server = std::env::var_os(BUILD_SERVER).is_some_and(|value| !value.is_empty() && value != "false");
    if is_server && (arguments.accept || arguments.review) {
        let message = format!("the variable {BUILD_SERVER} says that a server runs this: nothing is accepted there");
        return Err(Failure::of_usage(message));
    }
    if arguments.review && !std::io::stdin().is_terminal() {
        return Err(Failure::of_usage("--review asks on a terminal, and there is none".to_string()));
    }
    Ok(())
}

/// Tests specs, and says what became of them.
fn tested(arguments: &Test, specs: &[PathBuf]) -> Result<TestResult, Failure> {
    let start = Instant::now();
    let requests: Vec<TestRequest> = specs
        .iter()
        .map(|spec| TestRequest {
            filter: arguments.filter.clone(),
            propose: arguments.accept,
            evaluator: arguments.evaluator.evaluator(),
            ..TestRequest::new(spec)
        })
        .collect();
    let mut result = test(&requests, &Terminal)?;
    if arguments.accept {
        result = accepted(result)?;
    }
    if arguments.json {
        print(&document::text(&result));
    } else {
        print(&with_flags(&result.to_string()));
        result
            .specs
            .iter()
            .filter(|spec| spec.has_findings())
            .for_each(|spec| eprint(&findings_in_full(&spec.findings)));
    }
    if arguments.annotate {
        result.specs.iter().for_each(annotate);
    }
    if let Some(file) = &arguments.junit {
        let read: Vec<PathBuf> = result.specs.iter().flat_map(|spec| spec.read.clone()).collect();
        write(file, junit(&result), &read)?;
    }
    result.specs.iter().try_for_each(|spec| draw(arguments, spec))?;
    eprint(&format!("tested in {:.0} ms\n", start.elapsed().as_secs_f64() * 1e3));
    Ok(result)
}

fn write(file: &Path, text: String, read: &[PathBuf]) -> Result<(), Failure> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    write_texts(folder, &[(name, text)], read)?;
    Ok(())
}

/// Writes the map of what moved.
fn draw(arguments: &Test, spec: &TestedSpec) -> Result<(), Failure> {
    let Some(picture) = spec.snapshot.as_ref().and_then(|snapshot| snapshot.picture.as_ref()) else { return Ok(()) };
    let stem = Path::new(&spec.file).file_stem().unwrap_or_default().to_string_lossy();
    let written = write_texts(&arguments.out, &[(format!("{stem}.moved.svg"), picture.clone())], &spec.read)?;
    eprint(&format!("wrote {}\n", written.join(", ")));
    Ok(())
}

/// A line for each failure as forges read it.
fn annotate(spec: &TestedSpec) {
    let line = |at: &str, message: &str| {
        print(&format!("::error {at}::{}\n", escaped(message)));
    };
    // in a property a comma would end it, and a colon the command
    let file = |file: &str| format!("file={}", escaped(file).replace(':', "%3A").replace(',', "%2C"));
    for expectation in spec.items.iter().flat_map(|item| &item.expectations).filter(|expectation| !expectation.holds) {
        let place = &expectation.place;
        let at = format!("{},line={},col={}", file(&place.file), place.line, place.column);
        line(&at, &format!("{}: found: {}", expectation.expected, expectation.found));
    }
    if spec.is_wrong() {
        for finding in spec.findings.list() {
            let at = format!("{},line={},col={}", file(&finding.place.file), finding.place.line, finding.place.column);
            line(&at, &finding.message);
        }
    }
    spec.failure.iter().for_each(|why| line(&file(&spec.file), why));
    let differs = spec.snapshot.iter().filter(|snapshot| snapshot.differs());
    differs.for_each(|snapshot| line(&file(&snapshot.file), &snapshot.differences.join("; ")));
}

/// On one line, as forges read it.
fn escaped(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// Writes all snapshots that differ.
fn accepted(mut result: TestResult) -> Result<TestResult, Failure> {
    for spec in &mut result.specs {
        if let Some(written) = accept_snapshot(spec)? {
            eprint(&format!("wrote {written}\n"));
        }
    }
    Ok(TestResult::of_specs(result.specs))
}

/// Asks of each snapshot that differs.
fn review(result: &mut TestResult) -> Result<(), Failure> {
    let differs = |spec: &&mut TestedSpec| spec.snapshot.as_ref().is_some_and(TestedSnapshot::differs);
    let differ: Vec<&mut TestedSpec> = result.specs.iter_mut().filter(differs).collect();
    let count = differ.len();
    for (k, spec) in differ.into_iter().enumerate() {
        let Some(snapshot) = &spec.snapshot else { continue };
        print(&format!("\n{} of {}: {}\n{snapshot}", k + 1, count, spec.file));
        match answer() {
            Some('a') => {
                let written = accept_snapshot(spec)?;
                written.iter().for_each(|file| print(&format!("wrote {file}\n")));
            }
            Some('r') => print("rejected: the spec has to make what it made\n"),
            Some(_) => print("skipped\n"),
            None => break,
        }
    }
    Ok(())
}

/// What is to become of a snapshot; nothing if nobody answers any more.
fn answer() -> Option<char> {
    loop {
        eprint("accept, reject or skip? [a/r/s] ");
        let mut line = String::new();
        if !matches!(std::io::stdin().lock().read_line(&mut line), Ok(1..)) {
            return None;
        }
        match line.trim().chars().next() {
            Some(letter @ ('a' | 'r' | 's')) => return Some(letter),
            None => return Some('s'),
            _ => {}
        }
    }
}

/// When a file was saved last; nothing if it is not there.
fn saved(file: &Path) -> Option<SystemTime> {
    std::fs::metadata(file).and_then(|found| found.modified()).ok()
}

/// Tests again what saved files touch, for as long as the program runs.
fn watch(arguments: &Test, result: TestResult) -> Result<Ending, Failure> {
    let mut read: HashMap<PathBuf, Vec<PathBuf>> = HashMap::new();
    let mut known: HashMap<PathBuf, Option<SystemTime>> = HashMap::new();
    // those whose text is wrong
    let mut wrong: Vec<PathBuf> = Vec::new();
    let mut told = result;
    loop {
        for spec in &told.specs {
            let own = PathBuf::from(&spec.file);
            let mut files = [vec![own.clone()], spec.read.clone()].concat();
            for file in &files {
                known.entry(file.clone()).or_insert_with(|| saved(file));
            }
            // a file that it uses may be away for a moment
            let before = read.remove(&own).filter(|_| spec.is_wrong());
            files.extend(before.into_iter().flatten());
            files.sort();
            files.dedup();
            wrong.retain(|spec| *spec != own);
            wrong.extend(spec.is_wrong().then(|| own.clone()));
            read.insert(own, files);
        }
        eprint("waiting for files to be saved\n");
        let touched = loop {
            std::thread::sleep(LOOK);
            let changed: Vec<&PathBuf> =
                known.iter().filter(|(file, at)| saved(file) != **at).map(|(file, _)| file).collect();
            let mut touched: Vec<PathBuf> = read
                .iter()
                .filter(|(_, files)| files.iter().any(|file| changed.contains(&file)))
                .map(|(spec, _)| spec.clone())
                .collect();
            // a folder without specs at the moment is none to end at
            let all = find_specs(&arguments.paths).unwrap_or_default();
            let new: Vec<PathBuf> = all.into_iter().filter(|spec| !read.contains_key(spec)).collect();
            if !new.is_empty() {
                // what was missing may be there now
                touched.extend(wrong.iter().cloned());
            }
            touched.extend(new);
            touched.retain(|spec| spec.exists());
            touched.sort();
            touched.dedup();
            if !touched.is_empty() {
                break touched;
            }
            read.retain(|spec, _| spec.exists());
        };
        // what is saved while they are tested is seen afterwards
        known.iter_mut().for_each(|(file, at)| *at = saved(file));
        told = match tested(arguments, &touched) {
            Ok(result) => result,
            Err(failure) => {
                failure.tell(false);
                // they are looked at again when they are saved again
                for spec in touched {
                    known.insert(spec.clone(), saved(&spec));
                    read.entry(spec.clone()).or_insert_with(|| vec![spec]);
                }
                continue;
            }
        };
    }
}
