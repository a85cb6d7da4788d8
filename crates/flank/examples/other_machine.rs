//! A job on another machine, with a monitor that shows what takes long.

use std::path::PathBuf;
use std::sync::Arc;

use flank::{
    ConvertRequest, ConvertResult, Disk, FIT_STARTS, Failure, JobSelection, Monitor, Onto, Project, TableFormat, Work,
    convert,
};

struct Printer;

struct Line;

impl Work for Line {}

impl Monitor for Printer {
    fn begin(&self, what: String) -> Box<dyn Work> {
        println!("{what} …");
        Box::new(Line)
    }
}

fn main() -> Result<(), Failure> {
    let request = ConvertRequest {
        jobs: JobSelection::all(Project::open("specs/bevel/pinion_19x62.chain", Arc::new(Disk))),
        to: PathBuf::from("specs/machines/free_form.chain"),
        onto: Onto::default(),
        fit: Vec::new(),
        starts: FIT_STARTS,
        positions: 101,
        order: None,
        tolerance: Some(1e-4),
        out: None,
        no_tables: false,
        format: vec![TableFormat::Csv],
        nc: Vec::new(),
        time: None,
        emit: Vec::new(),
        emit_form: Vec::new(),
    };
    let found = convert(&request, &Printer)?;
    print!("{found}");
    if let ConvertResult::Motion(motion) = &found {
        println!("{} axes at {} positions", motion.axes.len(), motion.positions.len());
    }
    Ok(())
}
