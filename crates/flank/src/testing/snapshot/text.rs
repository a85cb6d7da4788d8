//! Snapshots as text that a person can review: nine significant digits, few points.

use sha2::{Digest, Sha256};

/// The first word of all snapshots, with the version of what follows.
const HEAD: &str = "flank snapshot";
const VERSION: &str = "1";

/// A surface of a job, as it is kept.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct KeptSurface {
    pub(super) job: String,
    pub(super) name: String,
    pub(super) frame: String,
    /// By which points are found.
    pub(super) coordinates: [String; 2],
    /// Their names.
    pub(super) unknowns: Vec<String>,
    /// Rows and columns that are kept.
    pub(super) counts: [usize; 2],
    /// Of the points that were looked at.
    pub(super) solved: usize,
    pub(super) asked: usize,
    /// The surface of the single edges that cut it, if any do.
    pub(super) cut_by: Option<String>,
    /// Evaluations of the equations, and boxes of the search for the branch.
    pub(super) work: [u64; 2],
    pub(super) points: Vec<Kept>,
}

/// A point, mm and radians.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Kept {
    pub(super) at: [f64; 2],
    pub(super) status: String,
    pub(super) position: [f64; 3],
    pub(super) normal: [f64; 3],
    pub(super) unknowns: Vec<f64>,
    /// What the edges that cut the surface leave over it; no number where that is not known.
    pub(super) left: f64,
}

impl KeptSurface {
    /// Whether both are the same in what is written of them.
    pub(super) fn is_same(&self, other: &KeptSurface) -> bool {
        written("", std::slice::from_ref(self)) == written("", std::slice::from_ref(other))
    }

    /// Whether the points of both are at the same places, in the digits that are written.
    pub(super) fn is_at_places_of(&self, other: &KeptSurface) -> bool {
        let places = |of: &KeptSurface| of.points.iter().map(|point| numbers(&point.at)).collect::<Vec<String>>();
        self.counts == other.counts && places(self) == places(other)
    }
}

impl Kept {
    pub(super) fn is_solved(&self) -> bool {
        self.status == "solved"
    }
}

/// Why a text is no snapshot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NoSnapshot {
    /// It does not begin as one.
    Other,
    /// It is one of another version.
    Version(String),
    /// Its digest is not that of what follows.
    Edited,
}

impl NoSnapshot {
    pub(super) fn told(&self) -> String {
        let accept = "accept the snapshot anew after a look at what is derived";
        match self {
            NoSnapshot::Other => format!("this file is no snapshot: {accept}"),
            NoSnapshot::Version(found) => {
                format!("this snapshot is of version {found}, the program writes version {VERSION}: {accept}")
            }
            NoSnapshot::Edited => format!("this snapshot was edited by hand, and says nothing any more: {accept}"),
        }
    }
}

/// What edges leave, mm: in a thousandth of a nanometre, as it is the small difference of places that have not more digits.
fn height(value: f64) -> String {
    number((1e9 * value).round() / 1e9)
}

/// A number with nine significant digits; what is no number as a dash.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return "-".to_string();
    }
    // what rounding leaves of zero has no digits that mean anything
    if value.abs() < 1e-12 { "0".to_string() } else { format!("{value:.8e}") }
}

fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| number(*value)).collect::<Vec<String>>().join(" ")
}

/// The snapshot of a spec.
pub(super) fn written(spec: &str, surfaces: &[KeptSurface]) -> String {
    let mut body = String::new();
    for (k, surface) in surfaces.iter().enumerate() {
        if k == 0 || surfaces[k - 1].job != surface.job {
            body += &format!("\njob {}\n", surface.job);
        }
        let [rows, columns] = surface.counts;
        let [evaluations, boxes] = surface.work;
        body += &format!("surface {} in {} {rows} x {columns}\n", surface.name, surface.frame);
        body += &format!("solved {} of {}\n", surface.solved, surface.asked);
        body += &format!("work {evaluations} evaluations {boxes} boxes\n");
        if let Some(edges) = &surface.cut_by {
            body += &format!("cut by {edges}\n");
        }
        let (coordinates, unknowns) = (surface.coordinates.join(" "), surface.unknowns.join(" "));
        let left = if surface.cut_by.is_some() { " left" } else { "" };
        body += &format!("{coordinates} status x y z nx ny nz {unknowns}{left}\n");
        for point in &surface.points {
            body += &format!("{} {}", numbers(&point.at), point.status);
            if point.is_solved() {
                let (position, normal) = (numbers(&point.position), numbers(&point.normal));
                body += &format!(" {position} {normal} {}", numbers(&point.unknowns));
                if surface.cut_by.is_some() {
                    body += &format!(" {}", height(point.left));
                }
            }
            body.push('\n');
        }
    }
    format!("{HEAD} {VERSION} {}\n# {spec}: lengths in mm, angles in rad\n{body}", digest(&body))
}

/// The first digits of a digest.
fn digest(body: &str) -> String {
    Sha256::digest(body.as_bytes()).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// # Errors
/// Why it is none.
pub(super) fn read(text: &str) -> Result<Vec<KeptSurface>, NoSnapshot> {
    let (head, rest) = text.split_once('\n').ok_or(NoSnapshot::Other)?;
    let words: Vec<&str> = head.strip_prefix(HEAD).ok_or(NoSnapshot::Other)?.split_whitespace().collect();
    let [version, found] = words[..] else { return Err(NoSnapshot::Other) };
    if version != VERSION {
        return Err(NoSnapshot::Version(version.to_string()));
    }
    let (_, body) = rest.split_once('\n').ok_or(NoSnapshot::Edited)?;
    if digest(body) != found {
        return Err(NoSnapshot::Edited);
    }
    parsed(body).ok_or(NoSnapshot::Other)
}

fn parsed(body: &str) -> Option<Vec<KeptSurface>> {
    let mut lines = body.lines().filter(|line| !line.is_empty()).peekable();
    let (mut job, mut surfaces) = (String::new(), Vec::new());
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("job ") {
            job = name.to_string();
            continue;
        }
        let words: Vec<&str> = line.split(' ').collect();
        let ["surface", name, "in", frame, rows, "x", columns] = words[..] else { return None };
        let counts = [rows.parse().ok()?, columns.parse::<usize>().ok()?];
        let (solved, asked) = lines.next()?.strip_prefix("solved ")?.split_once(" of ")?;
        let work: Vec<&str> = lines.next()?.split(' ').collect();
        let ["work", evaluations, "evaluations", boxes, "boxes"] = work[..] else { return None };
        let cut_by = lines.next_if(|line| line.starts_with("cut by ")).map(|line| line["cut by ".len()..].to_string());
        let head: Vec<String> = lines.next()?.split_whitespace().map(str::to_string).collect();
        let [first, second, ..] = &head[..] else { return None };
        let unknowns = head.get(9..head.len() - usize::from(cut_by.is_some()))?.to_vec();
        let points = lines.by_ref().take(counts[0] * counts[1]);
        let points: Option<Vec<Kept>> = points.map(|line| point(line, unknowns.len())).collect();
        surfaces.push(KeptSurface {
            job: job.clone(),
            name: name.to_string(),
            frame: frame.to_string(),
            coordinates: [first.clone(), second.clone()],
            unknowns,
            counts,
            solved: solved.parse().ok()?,
            asked: asked.parse().ok()?,
            cut_by,
            work: [evaluations.parse().ok()?, boxes.parse().ok()?],
            points: points?,
        });
    }
    Some(surfaces)
}

/// A point with so many unknowns.
fn point(line: &str, count: usize) -> Option<Kept> {
    let words: Vec<&str> = line.split(' ').collect();
    let [first, second, status, rest @ ..] = &words[..] else { return None };
    let value = |word: &&str| if *word == "-" { Some(f64::NAN) } else { word.parse::<f64>().ok() };
    let numbers: Vec<f64> = rest.iter().map(value).collect::<Option<_>>()?;
    let vector =
        |from: usize| -> [f64; 3] { std::array::from_fn(|k| numbers.get(from + k).copied().unwrap_or(f64::NAN)) };
    Some(Kept {
        at: [value(first)?, value(second)?],
        status: (*status).to_string(),
        position: vector(0),
        normal: vector(3),
        unknowns: numbers.iter().skip(6).take(count).copied().collect(),
        left: numbers.get(6 + count).copied().unwrap_or(f64::NAN),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface() -> KeptSurface {
        let point = |status: &str| Kept {
            at: [46.5, -1.25e-7],
            status: status.to_string(),
            position: [1.0, 2.0, 3.0],
            normal: [0.0, 0.6, 0.8],
            unknowns: vec![0.5, -0.25],
            left: 1.25e-3,
        };
        KeptSurface {
            job: "gear".to_string(),
            name: "flank".to_string(),
            frame: "m.work".to_string(),
            coordinates: ["rho".to_string(), "z".to_string()],
            unknowns: vec!["u".to_string(), "roll".to_string()],
            counts: [1, 2],
            solved: 1,
            asked: 2,
            cut_by: Some("cuts".to_string()),
            work: [12, 3],
            points: vec![point("solved"), point("undercut")],
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let written = written("gear", &[surface()]);
        let read = read(&written).expect("a snapshot");
        assert_eq!(read[0].points[0], surface().points[0]);
        assert_eq!((read[0].points[1].status.as_str(), read[0].work, read[0].asked), ("undercut", [12, 3], 2));
        assert_eq!((&read[0].unknowns[..], read[0].cut_by.as_deref()), (&surface().unknowns[..], Some("cuts")));
    }

    #[test]
    fn a_snapshot_that_was_edited_or_is_of_another_version_is_told_from_others() {
        let text = written("gear", &[surface()]);
        assert_eq!(read(&text.replace("2.0", "2.1")), Err(NoSnapshot::Edited));
        assert_eq!(read(&text.replace("snapshot 1", "snapshot 7")), Err(NoSnapshot::Version("7".to_string())));
        assert_eq!(read("job gear\n"), Err(NoSnapshot::Other));
    }
}
