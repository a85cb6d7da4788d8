//! What the sides of a surface's grid are called: as its labels say, else from the shape.

use super::direction::{directions, rows_are_profile};
use super::mesh::Mesh;
use crate::points::dataset::{Layout, Patch};
use crate::text::one_line;
use crate::vector::{Vector, add, cross, dot, unit};

/// Of a flank's mean normal at least this much goes across the tooth, of a root's or a tip's less does. Of the jobs that ship, fillets,
/// which lead from one to the other, have 0.4 or more, the most inclined root, of a hypoid pinion, has 0.3.
const LEAST_ACROSS: f64 = 0.35;

const ROOT_TIP: [&str; 2] = ["root", "tip"];

/// What ends are called that come last: of tooth and thread, and of what lies between two flanks.
const LAST: [&str; 6] = ["tip", "right side", "heel", "upper face", "outer end", "upper end"];

/// Whether an end is the last one of its kind.
pub fn is_last(word: &str) -> bool {
    LAST.contains(&word)
}

/// A side of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The first row.
    FirstRow,
    /// The last row.
    LastRow,
    /// The first column.
    FirstColumn,
    /// The last column.
    LastColumn,
}

/// What the sides of a flank's grid are called.
pub struct Sides {
    /// Of the first row and the last.
    pub rows: [String; 2],
    /// Of the first column and the last.
    pub columns: [String; 2],
    /// Whether rows follow each other along the profile, from root to tip or back.
    pub rows_are_profile: bool,
}

/// The names of all four sides; `None` where the grid does not tell them.
pub fn sides(patch: &Patch) -> Option<Sides> {
    let words = words(patch, &Mesh::of_patch(patch, 40));
    let word = |side: Side| words.iter().find(|(named, _)| *named == side).map(|(_, word)| word.clone());
    Some(Sides {
        rows: [word(Side::FirstRow)?, word(Side::LastRow)?],
        columns: [word(Side::FirstColumn)?, word(Side::LastColumn)?],
        rows_are_profile: rows_follow_profile(patch)?,
    })
}

/// Whether the rows of a flank follow each other from root to tip or back; `None` where its grid does not tell.
pub fn rows_follow_profile(patch: &Patch) -> Option<bool> {
    if let Some(labelled) = labelled_profile(patch) {
        return Some(labelled);
    }
    let [rows, columns] = directions(&Mesh::of_patch(patch, 40), patch.layout)?;
    Some(rows_are_profile(&rows, &columns))
}

/// z and the distance from it.
pub fn axial(position: Vector) -> [f64; 2] {
    [position[2], position[0].hypot(position[1])]
}

/// The two words of a label like `root -> tip`.
pub fn ends(label: &str) -> Option<[String; 2]> {
    let (from, to) = label.split_once("->").or_else(|| label.split_once('\u{2192}'))?;
    let words = [from, to].map(|word| one_line(word.trim()));
    words.iter().all(|word| !word.is_empty()).then_some(words)
}

/// The sides that the labels of rows and columns name.
pub fn named_sides(patch: &Patch) -> Vec<(Side, String)> {
    let mut words = Vec::new();
    for (label, sides) in [
        (&patch.rows.label, [Side::FirstRow, Side::LastRow]),
        (&patch.columns.label, [Side::FirstColumn, Side::LastColumn]),
    ] {
        if let Some(named) = ends(label) {
            words.extend(sides.into_iter().zip(named));
        }
    }
    words
}

/// The profile by the labels of rows and columns, where these name root and tip.
fn labelled_profile(patch: &Patch) -> Option<bool> {
    let is_profile =
        |label: &str| ends(label).is_some_and(|words| words.iter().any(|word| word == "root" || word == "tip"));
    match [is_profile(&patch.rows.label), is_profile(&patch.columns.label)] {
        [true, _] => Some(true),
        [_, true] => Some(false),
        _ => None,
    }
}

/// What the sides are: as the labels name them; else from the shape.
pub fn words(patch: &Patch, mesh: &Mesh) -> Vec<(Side, String)> {
    let named = named_sides(patch);
    let Some([rows, columns]) = directions(mesh, patch.layout) else { return named };
    let is_by_rows = labelled_profile(patch).unwrap_or_else(|| rows_are_profile(&rows, &columns));
    let (rows, columns) = ((rows, [Side::FirstRow, Side::LastRow]), (columns, [Side::FirstColumn, Side::LastColumn]));
    let ((profile, across), (length, along)) = if is_by_rows { (rows, columns) } else { (columns, rows) };
    let of = |sides: [Side; 2]| {
        let word = |side: Side| named.iter().find(|(known, _)| *known == side).map(|(_, word)| word.clone());
        Some([word(sides[0])?, word(sides[1])?])
    };
    let length_words = of(along).unwrap_or_else(|| length.length_words(patch.layout).map(str::to_owned));
    let profile_words = of(across).unwrap_or_else(|| {
        let way = if is_last(&length_words[0]) { length.chord.map(|part| -part) } else { length.chord };
        let nodes = mesh.nodes.iter().flatten().map(|node| (node.position, node.normal));
        let seen = Seen::along([way, profile.chord], nodes, patch.layout);
        let between = seen.filter(|seen| !seen.is_flank());
        let words = match between {
            // its normals lie in the plane of the axis and lean nowhere
            _ if length.winds => in_order(ROOT_TIP, profile.way[1] > 0.0),
            Some(seen) => {
                let right = match patch.layout {
                    Layout::Straight { tips_to_x: Some(is_up) } => {
                        cross(way, [if is_up { 1.0 } else { -1.0 }, 0.0, 0.0])
                    }
                    _ => seen.right(),
                };
                in_order(["left side", "right side"], dot(profile.chord, right) > 0.0)
            }
            None => in_order(ROOT_TIP, profile.rises(patch.layout)),
        };
        words.map(str::to_owned)
    });
    let all = [(across, profile_words), (along, length_words)];
    all.into_iter().flat_map(|(sides, words)| sides.into_iter().zip(words)).collect()
}

pub(super) fn in_order([first, last]: [&'static str; 2], is_forward: bool) -> [&'static str; 2] {
    if is_forward { [first, last] } else { [last, first] }
}

/// Whether a grid lies on a thread.
pub fn is_thread(patch: &Patch) -> bool {
    directions(&Mesh::of_patch(patch, 40), patch.layout).is_some_and(|both| both.iter().any(|of| of.winds))
}

/// A surface of a tooth as it is seen along the tooth.
pub struct Seen {
    /// The mean of its normals.
    normal: Vector,
    /// Square to the tooth, in the plane of the axis where that has the tooth's length across; to the tip of a flank.
    up: Vector,
    /// Square to both, where the tip is up.
    across: Vector,
}

impl Seen {
    /// Of points with their normals, where the tooth goes `along` and the surface `up` from root to tip.
    pub fn along(
        [along, up]: [Vector; 2],
        points: impl Iterator<Item = (Vector, Option<Vector>)>,
        layout: Layout,
    ) -> Option<Seen> {
        let sums = points.fold([[0.0; 3]; 2], |[positions, normals], (position, normal)| {
            [add(positions, position), add(normals, normal.unwrap_or_default())]
        });
        let [positions, normals] = sums;
        let [_, beside] = layout.directions(positions);
        // from root to tip, as the tooth lies and not as this surface leans
        let height = cross(along, beside);
        let up = if dot(height, up) < 0.0 { height.map(|part| -part) } else { height };
        Some(Seen { normal: unit(normals)?, up, across: unit(cross(along, up))? })
    }

    /// How much of the mean normal goes to the right.
    pub fn to_the_right(&self) -> f64 {
        dot(self.normal, self.across)
    }

    /// Whether it is the side of a tooth, and not its tip or what lies between two of them.
    pub fn is_flank(&self) -> bool {
        self.to_the_right().abs() >= LEAST_ACROSS
    }

    /// To the right of what is no flank: out of the material is up.
    fn right(&self) -> Vector {
        if dot(self.normal, self.up) < 0.0 { self.across.map(|part| -part) } else { self.across }
    }
}
