//! One surface held against another one, as a map and as a topography.

use flank_chain_dsl::Job;
use flank_draw::{PictureOptions, field_maps, topography};
use flank_export::Dataset;

use super::{Drawing, Drawn, name, options, told, with_origin, write};
use crate::arguments::{Plot, What};
use crate::deviation::{self, Measured};
use crate::failure::Failure;
use crate::spec::Origin;

/// What there is to draw of a comparison.
const KINDS: [What; 2] = [What::Deviation, What::Topography];

/// # Errors
/// In words, if the arguments do not compare two surfaces.
pub(super) fn check(arguments: &Plot) -> Result<(), Failure> {
    if arguments.surface.len() != 1 {
        let message = "--from holds one surface against another one: name one with --surface";
        return Err(Failure::of_usage(message.to_string()));
    }
    match arguments.what.iter().find(|what| !KINDS.contains(what)) {
        Some(other) => {
            let (other, kinds) = (name(*other), KINDS.map(name).join(", "));
            let message = format!("--what {other} does not compare surfaces\nwhat fits with --from: {kinds}");
            Err(Failure::of_usage(message))
        }
        None => Ok(()),
    }
}

/// # Errors
/// In words: what is missing, or does not fit.
pub(super) fn plot(jobs: &[Job<'_>], from: &str, arguments: &Plot, origin: &Origin) -> Result<Drawn, String> {
    let surface = deviation::find(jobs, &arguments.surface[0])?;
    let measured = deviation::measure([surface, deviation::find(jobs, from)?], false, arguments.means)?;
    let asked = if arguments.what.is_empty() { &KINDS[..] } else { &arguments.what };
    let drawings: Vec<(What, Drawing)> =
        asked.iter().map(|&what| (what, draw(&measured, what, arguments, origin, &options(arguments)))).collect();
    let written = write(&drawings, &surface.whole_name(), arguments, origin)?;
    Ok(told(&surface.job.name, &written, measured.missing(), arguments))
}

fn draw(
    measured: &Measured<'_, '_>,
    what: What,
    arguments: &Plot,
    origin: &Origin,
    options: &PictureOptions,
) -> Drawing {
    let dataset = measured.dataset(&arguments.which, origin);
    let dataset = Dataset { header: with_origin(dataset.header, arguments), ..dataset };
    let title = measured.title();
    let picture = match what {
        What::Topography => topography(&dataset, &title, &[(0, 0)], &measured.note(), options),
        _ => field_maps(&dataset, &title, &[(0, 0)], &measured.note(), options),
    };
    Drawing { picture, shows: format!("deviation of {title}") }
}
