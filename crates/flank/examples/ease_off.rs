//! One flank compared with another: ease-off with slopes, crownings and bias.

use std::sync::Arc;

use flank::{
    DeviationRequest, Disk, EvaluatorOptions, Failure, JobSelection, PointFormat, Project, Unwatched, deviation,
};

fn main() -> Result<(), Failure> {
    let request = DeviationRequest {
        jobs: JobSelection::all(Project::open("specs/bevel/ease_off_19x62.chain", Arc::new(Disk))),
        surface: "pinion.concave".to_string(),
        reference: Some("conjugate.concave".to_string()),
        reference_jobs: None,
        measured: None,
        rows: None,
        columns: None,
        margin: None,
        no_align: false,
        out: "build".into(),
        format: vec![PointFormat::Csv],
        no_picture: true,
        evaluator: EvaluatorOptions::default(),
    };
    let found = deviation(&request, &Unwatched)?;
    print!("{found}");
    let largest = found.deviations().iter().fold(0.0, |largest: f64, off| largest.max(off.abs()));
    println!("{largest} um at most");
    Ok(())
}
