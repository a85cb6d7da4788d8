//! `flank sweep`: what is told of cases before the first one is computed.

mod support;

use std::fs::File;
use std::path::Path;
use std::process::Output;

use flank_export::{CellKind, ParquetRows};
use support::{flank, text, written};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const PAIR: &str = "specs/pairs/bevel_19x62.chain";
const DISTANCE: &str = "m.radial_distance [mm]";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// A plan of a study of one point for each case.
fn planned(folder: &tempfile::TempDir, cases: &[&str]) -> Output {
    let out = folder.path().join("study").display().to_string();
    flank(&[&["sweep", "plan", PINION, "--collect", "at:concave[0,0]", "--out", &out], cases].concat())
}

fn planned_from(folder: &tempfile::TempDir, name: &str, table: &str) -> Output {
    planned(folder, &["--cases", &written(folder.path(), name, table)])
}

fn gathered(folder: &tempfile::TempDir) -> String {
    let out = folder.path().join("study").display().to_string();
    let run = flank(&["sweep", "run", &out]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    text(&flank(&["sweep", "gather", &out]).stdout)
}

/// What is refused is told, and nothing is made.
fn refused(folder: &tempfile::TempDir, run: &Output, code: i32, known: &[&str]) {
    let told = text(&run.stderr);
    assert_eq!(run.status.code(), Some(code), "{told}");
    known.iter().for_each(|known| assert!(told.contains(known), "no `{known}`: {told}"));
    assert!(!folder.path().join("study").exists());
}

#[test]
fn a_table_may_be_one_of_parquet() {
    let (csv, other) = (folder(), folder());
    let run = planned_from(&csv, "cases.csv", &format!("{DISTANCE},c.blade_angle [deg]\n97.9,20\n98.1,20.5\n"));
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let path = other.path().join("cases.parquet");
    let heads = [(DISTANCE, CellKind::Number), ("c.blade_angle [deg]", CellKind::Text)];
    let heads = heads.map(|(head, kind)| (head.to_string(), kind));
    let mut file = File::create(&path).expect("a file");
    let mut table = ParquetRows::new(&heads, "flank", &mut file).expect("a table");
    table.add(&[vec!["97.9", "20"], vec!["98.1", "20.5"]]).expect("rows");
    table.finish().expect("a whole table");
    let run = planned(&other, &["--cases", &path.display().to_string()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert_eq!(gathered(&csv), gathered(&other));
    // what is no such table, and what is wrong in one
    let (wrong, empty) = (folder(), folder());
    std::fs::write(&path, "PAR1 and no more").expect("a file");
    refused(
        &wrong,
        &planned(&wrong, &["--cases", &path.display().to_string()]),
        1,
        &["cases.parquet", "no table of Parquet"],
    );
    let mut file = File::create(&path).expect("a file");
    let mut table = ParquetRows::new(&heads, "flank", &mut file).expect("a table");
    table.add(&[vec!["", "20"], vec!["98.1", "x"]]).expect("rows");
    table.finish().expect("a whole table");
    let run = planned(&empty, &["--cases", &path.display().to_string()]);
    refused(
        &empty,
        &run,
        1,
        &["cases.parquet:2: `` is no number (E0305)", "cases.parquet:3: `x` is no number (E0305)"],
    );
}

#[test]
fn heads_may_stand_in_quotes() {
    let folder = folder();
    let run = planned_from(
        &folder,
        "cases.csv",
        "\"m.radial_distance [mm]\",\"c.blade_angle [deg]\"\n\"97.9\",20\n98.1,20.5\n",
    );
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(gathered(&folder).contains(",97.9,20,done,"));
}

#[test]
fn all_that_is_wrong_in_a_table_is_told_with_its_line_and_code() {
    let folder = folder();
    let told = |table: &str, known: &[&str]| refused(&folder, &planned_from(&folder, "cases.csv", table), 1, known);
    told(
        "m.radial_distence [mm],c.blade_angle [deg]\n98,400\nx,20\n",
        &[
            "cases.csv:1: job `pinion_19x62` has no parameter, setting or axis of a contact `m.radial_distence`; did you mean \
             `m.radial_distance`? (E0201)",
            "cases.csv:2: `c.blade_angle` is 400 deg, outside its range",
            "(E0307)",
            "cases.csv:3: `x` is no number (E0305)",
        ],
    );
    told("# first\nm.radial_distance\n98\n", &["cases.csv:2: column `m.radial_distance` has no unit", "(E0301)"]);
    told(
        "m.radial_distance [mm];c.blade_angle [deg]\n98;20\n",
        &["cases.csv:1: columns are separated by `;`", "(E0005)"],
    );
    told("m.radial_distance [mm]\tc.blade_angle [deg]\n98\t20\n", &["separated by tabs"]);
    told(
        "blade_angle [deg],c.blade_angle [deg]\n20,20\n",
        &["cases.csv:1: column `c.blade_angle` is given twice", "(E0202)"],
    );
    told("\"\",\"m.radial_distance [mm]\"\n\"1\",98\n", &["cases.csv:1: column 1 has no name", "row.names = FALSE"]);
    told("", &["cases.csv:1: the study has no case: the table is empty (E0005)"]);
    told("m.radial_distance [mm]\n", &["cases.csv:1: the study has no case: the table has no row"]);
}

#[test]
fn what_scatters_beyond_its_range_is_told_before() {
    let folder = folder();
    let scattered = |by: &str, more: &[&str]| planned(&folder, &[&["--scatter", by][..], more].concat());
    let run = scattered("c.blade_angle=normal(20deg)", &["--count", "100"]);
    let known = [
        "--scatter c.blade_angle: ",
        " of 100 cases lie outside its range ",
        "the first is case ",
        "(E0307)",
        "uniform(",
    ];
    refused(&folder, &run, 1, &known);
    // of very many the first ones tell it
    let run = scattered("c.blade_angle=normal(20deg)", &["--count", "100000000", "--sobol"]);
    refused(&folder, &run, 1, &["of the first 1048576 cases"]);
    // what it says helps
    let told = text(&run.stderr).split_once("uniform(").expect("a way out").1.to_string();
    let reach = told.split_once(')').expect("an amount").0.replace(' ', "");
    let run = scattered(&format!("c.blade_angle=uniform({reach})"), &["--count", "100"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
}

#[test]
fn amounts_have_the_units_of_the_language() {
    let folder = folder();
    let run = planned(&folder, &["--scatter", "m.radial_distance=normal(0.01in)", "--count", "2"]);
    refused(&folder, &run, 2, &["there is no unit `in`", "inch", "arcsec", "rev"]);
    assert!(!text(&run.stderr).contains("NAME=AMOUNT"));
    let run = planned(&folder, &["--scatter", "m.radial_distance=normal(0.001inch)", "--count", "2"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let by =
        |unit: &str| flank(&["tolerance", PINION, "concave", "--scatter", &format!("radial_distance=0.001{unit}")]);
    assert_eq!(by("inch").status.code(), Some(0));
    assert_eq!(by("mrad").status.code(), Some(2));
}

#[test]
fn what_has_no_effect_is_refused() {
    let folder = folder();
    let vary = ["--vary", "m.radial_distance=97.9mm..98.1mm by 2"];
    let table = written(folder.path(), "cases.csv", "m.radial_distance [mm]\n98\n");
    for more in [&["--count", "3"][..], &["--seed", "3"], &["--sobol"]] {
        refused(&folder, &planned(&folder, &[&vary[..], more].concat()), 2, &["cannot be used with", "--vary"]);
        let cases = ["--cases", &table];
        refused(&folder, &planned(&folder, &[&cases[..], more].concat()), 2, &["cannot be used with", "--cases"]);
    }
    let run = planned(&folder, &["--scatter", "m.radial_distance=normal(1um)", "--seed", "-3"]);
    refused(&folder, &run, 2, &["write a whole number from 0 to"]);
}

/// An axis of a contact is varied as a setting is, about nothing.
#[test]
fn axes_are_varied() {
    let folder = folder();
    let out = folder.path().join("study").display().to_string();
    let planned =
        |vary: &str| flank(&["sweep", "plan", PAIR, "--vary", vary, "--collect", "contact:drive_side", "--out", &out]);
    let run = planned("m.E=-0.01..0.01mm by 2");
    refused(&folder, &run, 1, &["--vary m.E: `-0.01` is no value of it", "(E0301)"]);
    let run = planned("m.E=-0.01mm..0.01mm by 2");
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(Path::new(&out).join("plan.json").is_file());
}
