//! The surfaces of a job: how many points are solved, the first of them, and where the files are.

use std::sync::Arc;

use flank::{Disk, Failure, PointFormat, Project, SolveRequest, Unwatched, solve};

fn main() -> Result<(), Failure> {
    let spec = Project::open("specs/hobbing/helical_gear.chain", Arc::new(Disk));
    let job = spec.job("helical_gear", &[("teeth".to_string(), "37".to_string())])?;
    let request = SolveRequest { format: vec![PointFormat::Csv, PointFormat::Stl], ..SolveRequest::new(&job) };
    solve(&request, &Unwatched, &mut |solved| {
        for surface in &solved.surfaces {
            let summary = &surface.summary;
            println!("{}: {} of {} points", summary.name, summary.solved, summary.asked);
            for (position, normal) in surface.positions().iter().zip(surface.normals()).take(3) {
                println!("  {position:?} mm, normal {normal:?}");
            }
        }
        println!("files: {}", solved.files.join(", "));
        for missing in &solved.not_done {
            println!("{:?}: {missing}", missing.kind);
        }
    })
}
