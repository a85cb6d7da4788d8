//! Lines of contact that no solid ends.

use std::path::Path;
use std::sync::Arc;

use flank::{Buffers, ContactRequest, ContactResult, Disk, JobSelection, NotDoneKind, Project, Unwatched, contact};

/// The shipped internal pair without its solids, changed.
fn rolled(change: impl Fn(String) -> String) -> ContactResult {
    let pairs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/pairs");
    let text = std::fs::read_to_string(pairs.join("internal_pair.chain")).expect("it is shipped");
    let kept = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("solid ") && !line.trim_start().starts_with("expect "));
    let text = change(kept.map(|line| format!("{line}\n")).collect());
    let spec = pairs.join("without_solids.chain");
    let files = Buffers::over(Arc::new(Disk)).with(&spec, text);
    let jobs = JobSelection { project: Project::open(spec, Arc::new(files)), job: None, set: vec![] };
    let request = ContactRequest { positions: 12, no_picture: true, format: vec![], ..ContactRequest::new(jobs) };
    let mut found = Vec::new();
    contact(&request, &Unwatched, &mut |of| found.push(of)).expect("a contact");
    found.remove(0)
}

/// They end where the samples do, and turn evenly on the way: with its solids, whose outlines end where the samples do, the pair touches from -17.735
/// to 9.937 deg.
#[test]
fn samples_end_lines_of_contact() {
    let found = rolled(|text| text);
    assert!(found.not_done.is_empty(), "{:?}", found.not_done);
    // rounding of flanks that are conjugate
    assert!(found.error.as_ref().is_some_and(|error| error.peak_to_peak < 1e-3), "{:?}", found.error);
    let told: Vec<f64> = found.ends.iter().map(|end| end.turn).collect();
    let known = [-17.735, 9.937];
    // these have three decimals
    assert!(told.len() == 2 && (0..2).all(|k| (told[k] - known[k]).abs() < 1e-3), "{told:?}");
}

/// Where samples of one column have no ends either, that is told, and no number that is none.
#[test]
fn a_line_without_an_end_is_told_as_one() {
    let found = rolled(|text| text.replace("z: front .. back by 11", "z: 0 mm"));
    let told = format!("{found} {:?}", found.not_done);
    assert!(found.not_done.iter().any(|of| of.kind == NotDoneKind::NoContact), "{told}");
    assert!(!told.contains("NaN") && told.contains("touch along a line, and nothing says where it ends"), "{told}");
}
