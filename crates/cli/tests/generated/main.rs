//! Random generated surfaces with cusps, self-crossings and bifurcations: what `flank solve` says of their points is held against
//! trying the tool at many positions, and against what it says of the same points in other grids, by other coordinates, in wider
//! ranges.
//!
//! `FLANK_GENERATED_CASES` is the number of cases, `FLANK_GENERATED_FIRST` the first of them; into the folder `FLANK_GENERATED_FOLDER` go
//! the specs of the cases with a finding.

#![allow(unreachable_pub)] // its modules are its own

mod case;
mod checks;
mod families;
mod judge;
mod machine;
mod newton;
mod oracle;
mod pose;
mod positions;
mod run;
mod tool;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use judge::{Counts, Finding, Judged};

/// What is known to be wrong: kinds of findings, and how many of the first 40 cases have one at most. All are globoid wheels, whose worm's
/// flank is a line on one of two branches that cross.
const KNOWN: [(&str, usize); 4] =
    [("cut_away_by_nothing", 3), ("lost_cut_away", 1), ("other_when_denser", 2), ("solved_but_a_line", 2)];

/// What came out of one case.
struct Report {
    seed: u64,
    family: &'static str,
    /// Of its grids, and of its points by other coordinates.
    specs: [String; 2],
    counts: Counts,
    findings: Vec<Finding>,
}

fn report(seed: u64, folder: &Path) -> Option<Report> {
    let case = families::case(seed)?;
    let jobs = judge::first_jobs(&case);
    let names = |jobs: &[case::JobText]| jobs.iter().map(|job| job.name.clone()).collect::<Vec<String>>();
    let (spec, mut others_spec) = (case.text(&jobs), String::new());
    let (mut counts, mut findings) = (Counts::default(), Vec::new());
    let solved = |spec: &str, jobs: &[case::JobText]| {
        let names = names(jobs);
        run::solved(folder, spec, &names.iter().map(String::as_str).collect::<Vec<&str>>())
    };
    let refused = |told: String| Finding { kind: "refused", job: String::new(), what: told };
    match solved(&spec, &jobs) {
        Err(told) => findings.push(refused(told)),
        Ok(outcomes) => {
            let judged: Vec<Judged<'_>> =
                jobs.iter().zip(&outcomes).map(|(job, outcome)| Judged::new(&case, job, outcome)).collect();
            for judged in &judged {
                findings.extend(judged.points(&mut counts));
            }
            let same: Vec<(usize, usize)> = (0..outcomes[0].points.len()).map(|n| (n, n)).collect();
            findings.extend(judged[0].against(&judged[1], &judge::common(&case), "other_when_denser"));
            findings.extend(judged[0].against(&judged[2], &same, "other_when_wider"));
            let others = judge::other_jobs(&judged[0]);
            let (numbers, others): (Vec<usize>, Vec<case::JobText>) = others.into_iter().unzip();
            if !others.is_empty() {
                let text = case.text(&others);
                others_spec.clone_from(&text);
                match solved(&text, &others) {
                    Err(told) => findings.push(refused(told)),
                    Ok(found) => {
                        for ((n, job), outcome) in numbers.iter().zip(&others).zip(&found) {
                            let other = Judged::new(&case, job, outcome);
                            findings.extend(other.points(&mut counts));
                            findings.extend(judged[0].against(&other, &[(*n, 0)], "other_by_others"));
                        }
                    }
                }
            }
        }
    }
    Some(Report { seed, family: case.family, specs: [spec, others_spec], counts, findings })
}

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn what_is_said_of_points_is_so() {
    let (first, count) = (number("FLANK_GENERATED_FIRST", 1), number("FLANK_GENERATED_CASES", 40));
    let next = AtomicU64::new(first);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut reports: Vec<Report> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                let next = &next;
                scope.spawn(move || {
                    let folder = run::folder();
                    let seeds = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
                    seeds
                        .take_while(|seed| *seed < first + count)
                        .filter_map(|seed| report(seed, folder.path()))
                        .collect()
                })
            })
            .collect();
        workers.into_iter().flat_map(|worker| -> Vec<Report> { worker.join().expect("no panic") }).collect()
    });
    reports.sort_by_key(|report| report.seed);
    summarise(&reports, count);
}

/// Prints what came out, and fails if more is wrong than is known to be.
fn summarise(reports: &[Report], count: u64) {
    let mut counts = Counts::default();
    let mut families: BTreeMap<&str, usize> = BTreeMap::new();
    // by kind and family: findings, and the cases that have one
    let mut kinds: BTreeMap<(&str, &str), [usize; 2]> = BTreeMap::new();
    for report in reports {
        counts.add(&report.counts);
        *families.entry(report.family).or_default() += 1;
        for kind in report.kinds() {
            let of = kinds.entry((kind, report.family)).or_default();
            of[0] += report.of_kind(kind).count();
            of[1] += 1;
        }
        report.keep();
    }
    println!("{} of {count} numbers make a case: {families:?}", reports.len());
    println!("{counts}");
    for ((kind, family), [findings, cases]) in &kinds {
        println!("{kind} {family}: {findings} in {cases} cases");
    }
    let seeds = |kind: &str| -> Vec<u64> {
        reports.iter().filter(|report| report.of_kind(kind).next().is_some()).map(|report| report.seed).collect()
    };
    let known = |kind: &str| KNOWN.iter().find(|(known, _)| *known == kind).map_or(0, |(_, cases)| *cases);
    let all: BTreeSet<&str> = kinds.keys().map(|(kind, _)| *kind).collect();
    let too_many: Vec<&str> =
        all.into_iter().filter(|kind| seeds(kind).len() > known(kind) * count.div_ceil(40) as usize).collect();
    for kind in &too_many {
        let seeds = seeds(kind);
        let first = reports.iter().find(|report| report.of_kind(kind).next().is_some()).expect("one has it");
        println!(
            "\n{kind}: {} cases, {} are known; the numbers {seeds:?}\n{}",
            seeds.len(),
            known(kind),
            first.text(kind, 0)
        );
    }
    assert!(too_many.is_empty(), "{too_many:?}");
}

impl Report {
    fn kinds(&self) -> BTreeSet<&'static str> {
        self.findings.iter().map(|finding| finding.kind).collect()
    }

    fn of_kind(&self, kind: &str) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind == kind)
    }

    /// One of its specs, under the first findings of a kind.
    fn text(&self, kind: &str, spec: usize) -> String {
        let told = self.of_kind(kind).take(5);
        let told: String =
            told.map(|finding| format!("//! {}: {}\n", finding.job, finding.what.replace('\n', "\n//! "))).collect();
        format!("{told}{}", self.specs[spec])
    }

    /// Writes the specs that have findings into a folder, if one is given.
    fn keep(&self) {
        let Some(folder) = std::env::var_os("FLANK_GENERATED_FOLDER") else { return };
        for kind in self.kinds() {
            for (number, end) in ["", "_by_others"].into_iter().enumerate() {
                let path = Path::new(&folder).join(format!("{kind}_{}{end}.chain", self.seed));
                std::fs::write(path, self.text(kind, number)).expect("the folder takes files");
            }
        }
    }
}
