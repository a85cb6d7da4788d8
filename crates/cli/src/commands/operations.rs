//! Commands that ask one thing of a spec, and print what the library answers.

use flank::{Answer, Failure as Refused, Monitor};

use crate::arguments::{
    Contact, Convert, Derive, Deviation, Fit, Measure, Mesh, Mill, Plot, Report, Solve, Tolerance, View,
};
use crate::commands::editor;
use crate::failure::Failure;
use crate::progress::{Terminal, noted};
use crate::spelling::with_flags;
use crate::{Ending, document, eprint, print};

/// Prints each result as it comes.
fn told<A: Answer>(
    as_document: bool,
    operation: impl FnOnce(&dyn Monitor, &mut dyn FnMut(A)) -> Result<(), Refused>,
) -> Result<Ending, Failure> {
    let mut ending = Ending::Done;
    operation(&Terminal, &mut |answer| {
        print(&if as_document { document::text(&answer) } else { with_flags(&answer.to_string()) });
        answer.timing().iter().for_each(|timing| eprint(&format!("{timing}\n")));
        answer.remarks().iter().for_each(noted);
        answer.not_done().iter().for_each(|missing| eprint(&with_flags(&format!("{missing}\n"))));
        if !answer.is_complete() {
            ending = Ending::Unsolved;
        }
    })?;
    Ok(ending)
}

pub(crate) fn solve(arguments: &Solve) -> Result<Ending, Failure> {
    if let Some(request) = arguments.solid_request()? {
        return told(arguments.json, |monitor, each| flank::solid(&request, monitor, each));
    }
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::solve(&request, monitor, each))
}

pub(crate) fn plot(arguments: &Plot) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::plot(&request, monitor, each))
}

pub(crate) fn report(arguments: &Report) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::report(&request, monitor, each))
}

pub(crate) fn view(arguments: &View) -> Result<Ending, Failure> {
    if arguments.serve {
        return editor::view(arguments);
    }
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::view(&request, monitor, each))
}

pub(crate) fn measure(arguments: &Measure) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::measure(&request, monitor, each))
}

pub(crate) fn mesh(arguments: &Mesh) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::mesh(&request, monitor, each))
}

pub(crate) fn mill(arguments: &Mill) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::mill(&request, monitor, each))
}

pub(crate) fn deviation(arguments: &Deviation) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::deviation(&request, monitor).map(each))
}

pub(crate) fn fit(arguments: &Fit) -> Result<Ending, Failure> {
    if let Some(want) = &arguments.want {
        let request = arguments.synthesis(want)?;
        return told(arguments.json, |monitor, each| flank::synthesis(&request, monitor).map(each));
    }
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::fit(&request, monitor).map(each))
}

pub(crate) fn tolerance(arguments: &Tolerance) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::tolerance(&request, monitor).map(each))
}

pub(crate) fn contact(arguments: &Contact) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::contact(&request, monitor, each))
}

pub(crate) fn convert(arguments: &Convert) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::convert(&request, monitor).map(each))
}

pub(crate) fn derive(arguments: &Derive) -> Result<Ending, Failure> {
    let request = arguments.request()?;
    told(arguments.json, |monitor, each| flank::derive(&request, monitor).map(each))
}
