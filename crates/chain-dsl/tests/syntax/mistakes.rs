//! Mistakes in the syntax, one fixture each.

use crate::fixtures::check;
use crate::read;

#[test]
fn one_mistake_gives_one_report() {
    let files =
        ["expressions.txt", "statements.txt", "machines.txt", "tools.txt", "jobs.txt", "items.txt", "braces.txt"];
    let count: usize =
        files.iter().map(|file| check(&format!("syntax/mistakes/{file}"), true, |text| read(text).1)).sum();
    assert!(count > 120, "{count}");
}

#[test]
fn several_mistakes_give_several_reports() {
    check("syntax/mistakes/several.txt", false, |text| read(text).1);
}
