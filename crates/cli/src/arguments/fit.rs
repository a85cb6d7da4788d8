//! The arguments of `flank fit`.

use std::path::PathBuf;

use clap::Args;
use flank::{KeptPlace, ToleratedAmount, WantedEaseOff};

use super::measuring::Margin;
use super::tolerance::amount;
use super::{EvaluatorArguments, JobArguments, count, length};

#[derive(Args, Debug)]
#[command(after_help = "\
With --measured, the points of a file are those of the surface as it was cut: a CSV table as `flank deviation --measured` reads it.
Two answers are given: the settings that made the measured flank (identification), and the settings to be set in place of the job's, so
that the next one is as the spec has it (correction). Without --vary, settings are taken among those that the job gives a value, one
after the other, until the next would lower what is left by less than 0.1 um.

With --ease-off, the surface shall lie off another one by a parabola in both directions, as `flank deviation` tells it: crowning (drop
from the middle to the ends), slope (rise from end to end), both first from root to tip, then along the tooth, and bias; um, plus is
material, and what is not named is zero.

With --want, a contact shall be at its vertex what the job says in `want NAME in CONTACT = vertex(…)`. Without --vary, as many settings of
the first flank are taken as it has conditions, those that do most. The whole contact with the settings that are found is solved anew.

Examples:
  flank fit specs/bevel/pinion_19x62.chain concave --measured measured.csv
  flank fit specs/bevel/pinion_19x62.chain concave --measured measured.csv --and convex
  flank fit specs/bevel/pinion_19x62.chain concave --measured measured.csv --vary radial_distance,machine_root_angle --share 0.7
  flank fit specs/bevel/pinion_19x62.chain concave --measured measured.csv --write corrected.chain
  flank fit specs/bevel/ease_off_19x62.chain pinion.concave --ease-off 'crowning: 50, 25' --from basic.concave --order 2
  flank fit specs/pairs/bevel_19x62.chain --want centred --vary p.radial_distance,p.work_offset,p.sliding_base,p.ratio_of_roll,p.modified_roll_2c,pinion_cutter.blade_angle")]
pub(crate) struct Fit {
    #[command(flatten)]
    pub(crate) which: JobArguments,
    /// The surface; none with --want
    #[arg(required_unless_present = "want", conflicts_with = "want")]
    pub(crate) surface: Option<String>,
    /// What a contact shall be like: a `want` of the job. Its settings are looked for
    #[arg(long, value_name = "NAME", conflicts_with_all = ["measured", "and", "ease_off", "from", "rows", "columns", "margin", "order", "noise",
          "as_it_lies", "is_thickness_free", "share", "within", "resolution"])]
    pub(crate) want: Option<String>,
    /// Measured points of the surface, which is sampled in the spec
    #[arg(long, value_name = "FILE")]
    pub(crate) measured: Option<PathBuf>,
    /// A further surface of the job that was measured in the same position, with its file if that is another one: the tooth's thickness counts
    #[arg(long, value_name = "SURFACE[=FILE]", value_parser = surface_and_file, requires = "measured")]
    pub(crate) and: Option<(String, Option<PathBuf>)>,
    /// Rows of the grid that was measured; the largest that the file names otherwise
    #[arg(long, value_name = "COUNT", value_parser = count(1..=10_000), allow_hyphen_values = true)]
    pub(crate) rows: Option<u32>,
    /// Columns of that grid, the same way
    #[arg(long, value_name = "COUNT", value_parser = count(1..=10_000), allow_hyphen_values = true)]
    pub(crate) columns: Option<u32>,
    #[command(flatten)]
    pub(crate) margin: Margin,
    /// The ease-off that is wanted, in um: 'crowning: 50, 25; slope: 0, 0; bias: 0'; or a CSV table of it, with row, column and deviation_um
    #[arg(long, value_name = "WISH", value_parser = wish, conflicts_with = "measured", requires = "from")]
    pub(crate) ease_off: Option<EaseOffWish>,
    /// The surface that the ease-off is one from; it is sampled in the spec
    #[arg(long, value_name = "SURFACE", requires = "ease_off")]
    pub(crate) from: Option<String>,
    /// The parameters and settings that may change, several with commas: radial_distance,c.blade_angle
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) vary: Vec<String>,
    /// Fit slopes (1), or slopes, crownings and bias (2), and leave the rest of the deviations as it is; all of them otherwise
    #[arg(long, value_name = "1|2", value_parser = clap::value_parser!(u8).range(1..=2))]
    pub(crate) order: Option<u8>,
    /// What a measured point scatters by; without it as all settings leave it. Without --vary, settings that take less than twice that are not changed
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) noise: Option<f64>,
    /// Round corrections to these steps instead of those in the spec, several with commas: radial_distance=1um,machine_root_angle=1arcsec; the others are fitted again
    #[arg(long, value_name = "NAME=STEP", value_delimiter = ',', value_parser = amount)]
    pub(crate) round: Vec<(String, ToleratedAmount)>,
    /// Leave a further surface of the job where it is in its middle, or at both ends of its middle row: root (the tooth's depth), root=line (the root line), convex (its thickness)
    #[arg(long, value_name = "SURFACE[=line]", value_delimiter = ',', value_parser = kept, conflicts_with = "want")]
    pub(crate) keep: Vec<(String, KeptPlace)>,
    /// Do not turn the points about z, or shift those of a rack along y
    #[arg(long)]
    pub(crate) as_it_lies: bool,
    /// Whether the tooth's thickness counts where both flanks are fitted: with `free` each has a turn of its own
    #[arg(long = "thickness", value_name = "fitted|free", default_value = "fitted", value_parser = thickness, action = clap::ArgAction::Set, hide_default_value = true)]
    pub(crate) is_thickness_free: bool,
    /// The share of the deviation that the correction takes away
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = share, allow_hyphen_values = true)]
    pub(crate) share: f64,
    /// What may be left, root of the mean square; the exit code is 3 if it is more
    #[arg(long, value_name = "LENGTH", default_value = "1um", value_parser = length)]
    pub(crate) within: f64,
    /// Changes of settings that together move the flank by less are made only where they take nearly all away that is left of a measured flank
    #[arg(long, value_name = "LENGTH", default_value = "0.1um", value_parser = length)]
    pub(crate) resolution: f64,
    /// Write the job with the corrected settings, a variant of it, into this file
    #[arg(long, value_name = "FILE")]
    pub(crate) write: Option<PathBuf>,
    /// Print that spec, write nothing
    #[arg(long, requires = "write")]
    pub(crate) dry: bool,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) evaluator: EvaluatorArguments,
}

/// How a surface shall lie off another one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EaseOffWish {
    /// As a parabola.
    Parabola(WantedEaseOff),
    /// As a file says.
    Table(PathBuf),
}

fn wish(text: &str) -> Result<EaseOffWish, String> {
    let is_file = text.trim().to_lowercase().ends_with(".csv");
    if is_file { Ok(EaseOffWish::Table(text.trim().into())) } else { ease_off(text).map(EaseOffWish::Parabola) }
}

/// Without a file it is the one of the first surface.
fn surface_and_file(text: &str) -> Result<(String, Option<PathBuf>), String> {
    let (name, file) = match text.split_once('=') {
        Some((name, file)) => (name.trim(), Some(file.trim())),
        None => (text.trim(), None),
    };
    if name.is_empty() || file.is_some_and(str::is_empty) {
        return Err(
            "write SURFACE=FILE, for example convex=measured.csv; or SURFACE, which is in the same file".to_string()
        );
    }
    Ok((name.to_string(), file.map(PathBuf::from)))
}

fn kept(text: &str) -> Result<(String, KeptPlace), String> {
    match text.trim().split_once('=') {
        None if !text.trim().is_empty() => Ok((text.trim().to_string(), KeptPlace::Middle)),
        Some((name, "line")) if !name.is_empty() => Ok((name.to_string(), KeptPlace::Line)),
        Some((name, "middle")) if !name.is_empty() => Ok((name.to_string(), KeptPlace::Middle)),
        _ => Err("write SURFACE, SURFACE=middle or SURFACE=line, for example root=line".to_string()),
    }
}

fn thickness(text: &str) -> Result<bool, String> {
    match text.trim() {
        "free" => Ok(true),
        "fitted" => Ok(false),
        _ => Err("write fitted or free".to_string()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|share| *share > 0.0 && *share <= 1.0);
    found.ok_or("write a share above 0 and 1 at the most, for example 0.7".to_string())
}

fn ease_off(text: &str) -> Result<WantedEaseOff, String> {
    let mut wanted = WantedEaseOff::default();
    let mut known = Vec::new();
    for part in text.split(';').map(str::trim).filter(|part| !part.is_empty()) {
        let (name, values) = part.split_once(':').ok_or(format!("`{part}` has no value: {WISH}"))?;
        let name = name.trim();
        if known.contains(&name) {
            return Err(format!("`{name}` is there twice"));
        }
        known.push(name);
        match name {
            "crowning" => wanted.crownings = pair(values)?,
            "slope" => wanted.slopes = pair(values)?,
            "bias" => wanted.bias = micrometres(values)?,
            _ => return Err(format!("there is no `{name}`: {WISH}")),
        }
    }
    if known.is_empty() { Err(WISH.to_string()) } else { Ok(wanted) }
}

const WISH: &str = "write `crowning: 50, 25; slope: 0, 0; bias: 0`, um, each first from root to tip (profilewise), then along the tooth \
                    (lengthwise); or `crowning: 25 um lengthwise`";

/// Profilewise, then lengthwise, unless words behind the values say so; what is not named is zero.
fn pair(text: &str) -> Result<[f64; 2], String> {
    let mut found = [None; 2];
    for (k, part) in text.split(',').enumerate() {
        let (value, place) = match part.trim() {
            part if part.ends_with("profilewise") => (part.trim_end_matches("profilewise"), 0),
            part if part.ends_with("lengthwise") => (part.trim_end_matches("lengthwise"), 1),
            part => (part, k),
        };
        let place = found.get_mut(place).filter(|place| place.is_none()).ok_or(format!("`{}`: {WISH}", text.trim()))?;
        *place = Some(micrometres(value)?);
    }
    Ok(found.map(|value| value.unwrap_or(0.0)))
}

fn micrometres(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (digits, unit) = match (text.strip_suffix("um").or(text.strip_suffix("µm")), text.strip_suffix("mm")) {
        (Some(digits), _) => (digits, 1.0),
        (None, Some(digits)) => (digits, 1e3),
        (None, None) => (text, 1.0),
    };
    let number = digits.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    number.map(|value| value * unit).ok_or(format!("`{text}` is no length in um: {WISH}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_read() {
        let wanted = WantedEaseOff { slopes: [1.0, -2.0], crownings: [50.0, 25.0], bias: 3.0 };
        for text in [
            "crowning: 50 um profilewise, 25 um lengthwise; slope: 1, -2; bias: 3",
            "bias: 3um;slope:-2 lengthwise, 1 profilewise; crowning: 0.05 mm, 25",
        ] {
            assert_eq!(ease_off(text), Ok(wanted), "{text}");
        }
        assert_eq!(ease_off("crowning: 25 lengthwise").map(|of| of.crownings), Ok([0.0, 25.0]));
        for text in
            ["", "crowning", "crowning: a", "twist: 3", "bias: 1; bias: 2", "slope: 1, 2, 3", "slope: 1 lengthwise, 2"]
        {
            assert!(ease_off(text).is_err(), "{text}");
        }
    }
}
