//! The surfaces of a job: how many points are solved, and where the files are.

use std::sync::Arc;

use flank::{Disk, Failure, JobSelection, PointFormat, Project, SolveRequest, Unwatched, solve};

fn main() -> Result<(), Failure> {
    let spec = Project::open("specs/hobbing/helical_gear.chain", Arc::new(Disk));
    let set = vec![("teeth".to_string(), "37".to_string())];
    let request = SolveRequest {
        format: vec![PointFormat::Csv, PointFormat::Stl],
        ..SolveRequest::of(JobSelection { set, ..JobSelection::all(spec) })
    };
    solve(&request, &Unwatched, &mut |answer| {
        for surface in answer.document["surfaces"].as_array().into_iter().flatten() {
            println!("{}: {} of {} points", surface["name"], surface["solved"], surface["asked"]);
        }
        println!("files: {}", answer.document["files"]);
        print!("{}", answer.not_done);
    })
}
