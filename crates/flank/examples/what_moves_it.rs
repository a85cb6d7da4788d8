//! The machine settings that move a flank most, by what a usual change of each does.

use std::sync::Arc;

use flank::{Disk, Failure, JobSelection, Project, SolveRequest, Unwatched, solve};

fn main() -> Result<(), Failure> {
    let spec = Project::open("specs/bevel/pinion_19x62.chain", Arc::new(Disk));
    let request = SolveRequest { sensitivity: true, no_picture: true, ..SolveRequest::new(JobSelection::all(spec)) };
    solve(&request, &Unwatched, &mut |solved| {
        let surface = &solved.surfaces[0];
        println!("{} moves by", surface.summary.name);
        for setting in surface.sensitivity.iter().flat_map(|table| &table.parameters).take(5) {
            let change = &setting.usual_change;
            println!("  {} um for {} {} of {}", change.rms_um, change.size, change.unit, setting.name);
        }
    })
}
