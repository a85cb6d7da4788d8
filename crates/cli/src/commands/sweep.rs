//! `flank sweep`

use flank::{Answer, OpenStudy, StudyChunks, SweepResult, gather_sweep, plan_sweep, run_sweep, sweep_status};

use super::interruption;
use crate::arguments::{Sweep, SweepGather, SweepStep};
use crate::failure::Failure;
use crate::progress::Terminal;
use crate::spelling::with_flags;
use crate::{Ending, document, eprint, print};

pub(crate) fn run(arguments: &Sweep) -> Result<Ending, Failure> {
    let json = arguments.is_json();
    match arguments {
        Sweep::All(plan) => {
            plan_sweep(&plan.request()?, &Terminal)?;
            interruption::watch();
            // what there is to know has been said by the plan
            let study = OpenStudy::open(&plan.out, plan.evaluator.evaluator(), &Terminal)?;
            Ok(told(&study.run(StudyChunks::All, &[], &Terminal)?, json))
        }
        Sweep::Step(SweepStep::Plan(plan)) => Ok(told(&plan_sweep(&plan.request()?, &Terminal)?, json)),
        Sweep::Step(SweepStep::Run(run)) => {
            interruption::watch();
            Ok(told(&run_sweep(&run.request(), &Terminal)?, json))
        }
        Sweep::Step(SweepStep::Status(of)) => Ok(told(&sweep_status(&of.study)?, json)),
        Sweep::Step(SweepStep::Gather(of)) => gathered(of),
    }
}

fn gathered(of: &SweepGather) -> Result<Ending, Failure> {
    let (text, result) = gather_sweep(&of.study, of.out.as_deref())?;
    if of.out.is_some() {
        return Ok(told(&result, of.json));
    }
    print(&text);
    Ok(ended(&result))
}

fn told(result: &SweepResult, json: bool) -> Ending {
    print(&if json { document::text(result) } else { result.to_string() });
    result.timing().iter().for_each(|timing| eprint(&format!("{timing}\n")));
    ended(result)
}

fn ended(result: &SweepResult) -> Ending {
    result.not_done().iter().for_each(|missing| eprint(&with_flags(&format!("{missing}\n"))));
    if result.is_complete() { Ending::Done } else { Ending::Unsolved }
}
