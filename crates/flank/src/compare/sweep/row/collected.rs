//! What can be collected of a case, and the columns that it gives.

use std::fmt;

use flank_chain_dsl::{Job, Sample};

use crate::compare::map::find;
use crate::project::failure::Failure;
use crate::project::units;

/// The words for points, in the order of their columns.
pub(super) const STATUSES: [&str; 8] =
    ["solved", "out_of_range", "undercut", "trimmed", "ambiguous", "undecided", "singular", "not_converged"];
pub(super) const EASE_OFF: [&str; 9] = [
    "slope_rows [um]",
    "slope_columns [um]",
    "crowning_rows [um]",
    "crowning_columns [um]",
    "bias [um]",
    "rms [um]",
    "lowest [um]",
    "highest [um]",
    "turn [deg]",
];
pub(super) const CURVATURE: [&str; 4] =
    ["k1_lowest [1/mm]", "k1_highest [1/mm]", "k2_lowest [1/mm]", "k2_highest [1/mm]"];
pub(super) const WIDTH: [&str; 2] = ["turn [deg]", "width [mm]"];
pub(super) const LIMITS: [&str; 2] = ["singular_line", "contact_limit"];
pub(super) const PLACE: [&str; 6] = ["x [mm]", "y [mm]", "z [mm]", "nx", "ny", "nz"];

/// One thing that is collected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::compare::sweep) enum Collected {
    /// How many points of all samples have which status, and the worst residual.
    Points,
    /// How many points of all samples miss what these require.
    Requirements,
    /// How many points the lines have in the ranges where surfaces turn back, and where the tool's contact ends.
    Limits,
    /// How far a surface lies off that of the job itself.
    EaseOff(String),
    /// How far one surface is turned from another in the middle of the grid.
    Width([String; 2]),
    /// The ends of the principal curvatures.
    Curvature(String),
    /// A point of a sample.
    At(String, [usize; 2]),
    /// The numbers of a contact.
    Contact(String),
}

impl Collected {
    /// All that is named in some texts, of which each may hold several parted by commas.
    ///
    /// # Errors
    /// As for [`Collected::read`].
    pub(in crate::compare::sweep) fn read_all(texts: &[String]) -> Result<Vec<Collected>, Failure> {
        let mut parts: Vec<String> = Vec::new();
        for word in texts.iter().flat_map(|text| text.split(',')) {
            match parts.last_mut() {
                // `width:a,b` and `at:a[1,2]` have commas of their own
                Some(last) if last.starts_with("width:") && !last.contains(',') => {
                    *last += &format!(",{}", word.trim())
                }
                Some(last) if last.contains('[') && !last.contains(']') => *last += &format!(",{}", word.trim()),
                _ => parts.push(word.trim().to_string()),
            }
        }
        parts.iter().map(|text| Collected::read(text)).collect()
    }

    /// # Errors
    /// What can be written, if it is none of that.
    fn read(text: &str) -> Result<Collected, Failure> {
        let name = |text: &str| (!text.trim().is_empty()).then(|| text.trim().to_string());
        let found = match text.split_once(':') {
            None if text == "points" => Some(Collected::Points),
            None if text == "requirements" => Some(Collected::Requirements),
            None if text == "limits" => Some(Collected::Limits),
            Some(("ease_off", of)) => name(of).map(Collected::EaseOff),
            Some(("curvature", of)) => name(of).map(Collected::Curvature),
            Some(("contact", of)) => name(of).map(Collected::Contact),
            Some(("width", of)) => of.split_once(',').and_then(|(a, b)| Some(Collected::Width([name(a)?, name(b)?]))),
            Some(("at", of)) => place(of).map(|(of, at)| Collected::At(of, at)),
            _ => None,
        };
        found.ok_or_else(|| {
            Failure::Request(format!(
                "option `collect {text}`: write points, requirements, limits, ease_off:SURFACE, width:SURFACE,SURFACE, curvature:SURFACE, \
                 at:SURFACE[row,column] or contact:CONTACT"
            ))
        })
    }

    /// The heads of its columns, with units.
    pub(in crate::compare::sweep) fn heads(&self, job: &Job<'_>) -> Vec<String> {
        let of = |prefix: String, names: &[&str]| names.iter().map(|name| format!("{prefix}.{name}")).collect();
        match self {
            Collected::Points => STATUSES
                .iter()
                .map(|word| format!("points.{word}"))
                .chain(["points.worst_residual".to_string()])
                .collect(),
            Collected::Requirements => vec!["requirements.missed".to_string()],
            Collected::Limits => of("limits".to_string(), &LIMITS),
            Collected::EaseOff(surface) => of(format!("ease_off:{surface}"), &EASE_OFF),
            Collected::Width([a, b]) => of(format!("width:{a},{b}"), &WIDTH),
            Collected::Curvature(surface) => of(format!("curvature:{surface}"), &CURVATURE),
            Collected::At(surface, [row, column]) => of(format!("at:{surface}[{row},{column}]"), &PLACE),
            Collected::Contact(contact) => {
                let known = job.contacts.iter().find(|known| known.name == *contact);
                let unit = |is_fine: bool| match known.is_some_and(|of| units::is_angle(of.lag.dimension)) {
                    true if is_fine => "urad",
                    true => "deg",
                    false if is_fine => "um",
                    false => "mm",
                };
                let names = [
                    format!("peak_to_peak [{}]", unit(true)),
                    format!("lag [{}]", unit(false)),
                    "ratio".to_string(),
                    "lengthwise".to_string(),
                    "profilewise".to_string(),
                    "z [mm]".to_string(),
                    "rho [mm]".to_string(),
                    "half_length [mm]".to_string(),
                    "half_width [mm]".to_string(),
                ];
                names.iter().map(|name| format!("contact:{contact}.{name}")).collect()
            }
        }
    }

    /// # Errors
    /// If something named is not there, or has no sample.
    pub(in crate::compare::sweep) fn check(&self, job: &Job<'_>) -> Result<(), Failure> {
        let sampled = |name: &String| sample_of(job, name).map(drop);
        match self {
            Collected::Points | Collected::Requirements | Collected::Limits => Ok(()),
            Collected::EaseOff(of) | Collected::Curvature(of) => sampled(of),
            Collected::Width([a, b]) => sampled(a).and_then(|()| sampled(b)),
            Collected::At(of, [row, column]) => {
                let [rows, columns] = sample_of(job, of)?.counts;
                if *row < rows && *column < columns {
                    return Ok(());
                }
                Err(Failure::Input(format!(
                    "option `collect at:{of}[{row},{column}]`: the sample of {of} has rows 0 to {} and columns 0 to {}",
                    rows - 1,
                    columns - 1
                )))
            }
            Collected::Contact(name) => match job.contacts.iter().any(|known| known.name == *name) {
                true => Ok(()),
                false => {
                    let known: Vec<&str> = job.contacts.iter().map(|known| known.name.as_str()).collect();
                    let there = if known.is_empty() { "none".to_string() } else { known.join(", ") };
                    Err(Failure::Input(format!("job `{}` has no contact `{name}`; there is: {there}", job.name)))
                }
            },
        }
    }
}

/// As it is written.
impl fmt::Display for Collected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Collected::Points => write!(f, "points"),
            Collected::Requirements => write!(f, "requirements"),
            Collected::Limits => write!(f, "limits"),
            Collected::EaseOff(of) => write!(f, "ease_off:{of}"),
            Collected::Width([a, b]) => write!(f, "width:{a},{b}"),
            Collected::Curvature(of) => write!(f, "curvature:{of}"),
            Collected::At(of, [row, column]) => write!(f, "at:{of}[{row},{column}]"),
            Collected::Contact(of) => write!(f, "contact:{of}"),
        }
    }
}

/// `concave[7,15]`
fn place(text: &str) -> Option<(String, [usize; 2])> {
    let (name, at) = text.strip_suffix(']')?.split_once('[')?;
    let (row, column) = at.split_once(',')?;
    Some((name.trim().to_string(), [row.trim().parse().ok()?, column.trim().parse().ok()?]))
}

pub(super) fn sample_of<'j, 'g>(job: &'j Job<'g>, name: &str) -> Result<&'j Sample<'g>, Failure> {
    let of = find(std::slice::from_ref(job), name)?;
    of.surface.sample.as_ref().ok_or_else(|| {
        Failure::Input(format!("`{name}` is not sampled: its sample says at which points; add `sample {name} {{ … }}`"))
    })
}
