//! One case from its spec to what is wrong of it, and what came out of many.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use crate::case::{Case, JobText};
use crate::families;
use crate::judge::{self, Counts, Finding, Judged};
use crate::told::Outcome;

/// How the program tells that a motion only slides the tool within itself: it leaves no surface. Where two motions do so together, the
/// coordinates do not tell points apart.
const SLIDES: [&str; 2] = ["error[E0509]", "error[E0506]"];

/// What came out of one case.
#[derive(Clone, Debug)]
pub struct Report {
    seed: u64,
    family: &'static str,
    /// Of its grids, and of its points by other coordinates.
    specs: [String; 2],
    counts: Counts,
    findings: Vec<Finding>,
}

/// How a spec with jobs of these names is solved: for each job the document that is written and the one that is printed; `Err` is
/// what the program says of a spec that it does not take.
pub type Solve<'s> = dyn Fn(&str, &[&str]) -> Result<Vec<[Value; 2]>, String> + 's;

/// Solves the case of a number; not each number makes one.
#[must_use]
pub fn report(seed: u64, solve: &Solve<'_>) -> Option<Report> {
    let case = families::case(seed)?;
    let mut report = Report {
        seed,
        family: case.family,
        specs: [String::new(), String::new()],
        counts: Counts::default(),
        findings: Vec::new(),
    };
    let jobs = judge::first_jobs(&case);
    let Some(outcomes) = report.solved(&case, 0, &jobs, solve) else { return Some(report) };
    let judged: Vec<Judged<'_>> =
        jobs.iter().zip(&outcomes).map(|(job, outcome)| Judged::new(&case, job, outcome)).collect();
    for judged in &judged {
        report.findings.extend(judged.points(&mut report.counts));
    }
    let same: Vec<(usize, usize)> = (0..outcomes[0].points.len()).map(|n| (n, n)).collect();
    report.findings.extend(judged[0].against(&judged[1], &judge::common(&case), "other_when_denser"));
    report.findings.extend(judged[0].against(&judged[2], &same, "other_when_wider"));
    let (numbers, others): (Vec<usize>, Vec<JobText>) = judge::other_jobs(&judged[0]).into_iter().unzip();
    if others.is_empty() {
        return Some(report);
    }
    let Some(found) = report.solved(&case, 1, &others, solve) else { return Some(report) };
    for ((n, job), outcome) in numbers.iter().zip(&others).zip(&found) {
        let other = Judged::new(&case, job, outcome);
        report.findings.extend(other.points(&mut report.counts));
        report.findings.extend(judged[0].against(&other, &[(*n, 0)], "other_by_others"));
    }
    Some(report)
}

impl Report {
    /// The number of the case.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// What the program tells of some jobs of the case; nothing if it does not take them, which is a finding.
    fn solved(&mut self, case: &Case, number: usize, jobs: &[JobText], solve: &Solve<'_>) -> Option<Vec<Outcome>> {
        self.specs[number] = case.text(jobs);
        let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
        match solve(&self.specs[number], &names) {
            Ok(documents) => Some(documents.iter().map(Outcome::new).collect()),
            // some machines at random move the tool only along itself, and the program does not take them
            Err(what) if SLIDES.iter().any(|code| what.contains(code)) => None,
            Err(what) => {
                self.findings.push(Finding { kind: "refused", job: String::new(), what });
                None
            }
        }
    }

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

    /// Writes its specs into a folder for each kind of finding that it has.
    ///
    /// # Panics
    /// If the folder takes no files.
    pub fn keep(&self, folder: &Path) {
        for kind in self.kinds() {
            for (number, end) in ["", "_by_others"].into_iter().enumerate() {
                let path = folder.join(format!("{kind}_{}{end}.chain", self.seed));
                std::fs::write(path, self.text(kind, number)).expect("the folder takes files");
            }
        }
    }
}

/// Prints what came out of some cases, and gives the kinds of findings of which more cases have one than are known to.
#[must_use]
pub fn summarised(reports: &[Report], known: &[(&str, usize)]) -> Vec<&'static str> {
    let mut counts = Counts::default();
    let mut families: BTreeMap<&str, usize> = BTreeMap::new();
    // by kind and family: findings, and the numbers of the cases that have one
    let mut kinds: BTreeMap<(&str, &str), (usize, Vec<u64>)> = BTreeMap::new();
    for report in reports {
        counts.add(&report.counts);
        *families.entry(report.family).or_default() += 1;
        for kind in report.kinds() {
            let (findings, seeds) = kinds.entry((kind, report.family)).or_default();
            *findings += report.of_kind(kind).count();
            seeds.push(report.seed);
        }
    }
    println!("{} cases: {families:?}\n{counts}", reports.len());
    for ((kind, family), (findings, seeds)) in &kinds {
        println!("{kind} {family}: {findings} in {} cases, {seeds:?}", seeds.len());
    }
    let all: BTreeSet<&'static str> = reports.iter().flat_map(Report::kinds).collect();
    let of = |kind: &str| reports.iter().filter(|report| report.of_kind(kind).next().is_some()).collect::<Vec<_>>();
    let most = |kind: &str| known.iter().find(|(known, _)| *known == kind).map_or(0, |(_, cases)| *cases);
    let too_many: Vec<&'static str> = all.into_iter().filter(|kind| of(kind).len() > most(kind)).collect();
    for kind in &too_many {
        println!("\n{kind}: {} cases, {} are known\n{}", of(kind).len(), most(kind), of(kind)[0].text(kind, 0));
    }
    too_many
}
