//! One surface held against another one, as a map and as a topography.

use flank_chain_dsl::Job;
use flank_export::{Dataset, PictureOptions, field_maps, topography};

use super::{Drawing, Drawn, name, options, told, with_origin, write};
use crate::arguments::{Plot, What};
use crate::deviation::{self, Measured};
use crate::spec::Origin;

/// What there is to draw of a comparison.
const KINDS: [What; 2] = [What::Deviation, What::Topography];

/// # Errors
/// In words: what is missing, or does not fit.
pub(super) fn plot(jobs: &[Job<'_>], from: &str, arguments: &Plot, origin: &Origin) -> Result<Drawn, String> {
    let [surface] = &arguments.surface[..] else {
        return Err("--from holds one surface against another one: name one with --surface".to_string());
    };
    if let Some(other) = arguments.what.iter().find(|what| !KINDS.contains(what)) {
        let kinds = KINDS.map(name).join(", ");
        return Err(format!("--what {} does not compare surfaces\nwhat fits with --from: {kinds}", name(*other)));
    }
    let surface = deviation::find(jobs, surface)?;
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
