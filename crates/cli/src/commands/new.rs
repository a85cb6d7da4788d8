//! `flank new`

use std::io::BufRead;

use flank::{MadeKind, NewJob, Template, TemplateList, Words, new_job, template_parameters, templates};

use crate::arguments::New;
use crate::failure::Failure;
use crate::{Ending, document, eprint, print};

pub(crate) fn run(arguments: &New) -> Result<Ending, Failure> {
    let Some(template) = &arguments.template else {
        let all = templates();
        print(&if arguments.json { document::text(&all) } else { list(&all) });
        return Ok(Ending::Done);
    };
    let words = |text: &String, origin: &str| Words { text: text.clone(), origin: origin.to_string() };
    let mut values: Vec<(String, Words)> =
        arguments.set.iter().map(|(name, value)| (name.clone(), words(value, "--set"))).collect();
    if arguments.interactive {
        values.extend(
            asked(template, &values)?.iter().map(|(name, value)| (name.clone(), words(value, "--interactive"))),
        );
    }
    let name = arguments.name.as_ref().map(|name| words(name, "--name"));
    let made = new_job(&NewJob { template: template.clone(), name, values, folder: arguments.out.clone() })?;
    print(&if arguments.json {
        document::text(&made)
    } else {
        let now = match made.kind {
            MadeKind::Job => format!("now: flank solve {}", made.spec),
            MadeKind::Machine => format!("now: machine m = {}(…) in a job that uses {}", made.name, made.spec),
            MadeKind::Tool => format!("now: tool t = {}(…) in a job that uses {}", made.name, made.spec),
        };
        format!("wrote {}\n\n{}{now}\n", made.files.join(", "), left_out(&made.left_out))
    });
    Ok(Ending::Done)
}

/// What the library expects with its own values alone.
fn left_out(expectations: &[String]) -> String {
    if expectations.is_empty() {
        return String::new();
    }
    let each: String = expectations.iter().map(|one| format!("  {}\n", words(one))).collect();
    format!("left out, as it holds with the library's values and not with these:\n{each}\n")
}

/// On one line.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn list(TemplateList { templates, together, machines, tools }: &TemplateList) -> String {
    let all = templates.iter().chain(machines).chain(tools);
    let width = all.map(|template| template.name.len()).max().unwrap_or(0);
    let table = |of: &[Template]| -> String {
        of.iter().map(|template| format!("  {:width$}  {}\n", template.name, template.about)).collect()
    };
    let mut out =
        "Jobs to start from, as in `flank new helical_gear --name my_gear`:\n".to_string() + &table(templates);
    out += "\nJobs that belong together in one file, or vary another, are not made into files of their own; to start from them copy theirs:\n";
    together.iter().for_each(|of| out += &format!("  {}: {}\n", of.file, of.jobs.join(", ")));
    out += "\nMachines, as they are or to vary, as in `flank new hobbing_6axis --name my_machine`:\n";
    out += &table(machines);
    out += "\nTools:\n";
    out += &table(tools);
    out
}

/// The values that the user gives parameters when asked; the others stay as they are.
fn asked(template: &str, set: &[(String, Words)]) -> Result<Vec<(String, String)>, Failure> {
    let open =
        template_parameters(template)?.into_iter().filter(|known| !set.iter().any(|(set, _)| *set == known.name));
    let open: Vec<_> = open.collect();
    let mut values = Vec::new();
    for (at, parameter) in open.iter().enumerate() {
        let about = if parameter.about.is_empty() { String::new() } else { format!(" ({})", parameter.about) };
        eprint(&format!("{}{about} [{}]: ", parameter.name, parameter.default));
        let mut answer = String::new();
        if !matches!(std::io::stdin().lock().read_line(&mut answer), Ok(1..)) {
            let open: Vec<&str> = open[at..].iter().map(|open| open.name.as_str()).collect();
            eprint(&format!("\nnote: nobody answers any more; {} keep their values\n", open.join(", ")));
            break;
        }
        if !answer.trim().is_empty() {
            values.push((parameter.name.clone(), answer.trim().to_string()));
        }
    }
    Ok(values)
}
