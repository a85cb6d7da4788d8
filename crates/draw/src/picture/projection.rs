//! A patch laid flat: turned into the axial plane, or, where that shows nothing of it, by its rows and columns.

use flank_export::Patch;
use flank_export::shape::Mesh;
use flank_export::shape::{Side, axial, ends, is_last, is_thread, named_sides, rows_follow_profile, words};
use flank_export::text::one_line;
use flank_export::vector::{Vector, cross, dot, length, sub};

/// A patch of which less than this share is seen in the axial plane is laid by rows and columns.
const LEAST_SHARE: f64 = 0.04;

/// A patch lies over itself on paper where areas that are turned over take more than half of what this leaves: the last cells at a
/// corner may be.
const UNFOLDED: f64 = 0.98;

/// What goes across and up where a flank is laid flat.
const LAID_FLAT: [&str; 2] = ["lengthwise, mm", "profilewise, mm"];

/// The nodes of a patch on paper.
pub(super) struct Projection {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Across and up.
    pub(super) nodes: Vec<Option<[f64; 2]>>,
    /// What across and up are.
    way: Way,
    /// What goes across and up.
    pub(super) titles: [String; 2],
    /// What the sides are called.
    pub(super) words: Vec<(Side, String)>,
}

/// How a patch is brought onto paper.
enum Way {
    /// From z, radius and one: across and up, mm.
    Axial([[f64; 3]; 2]),
    /// By the ways along rows and columns, mm, from the nodes where they are in space.
    Developed(Vec<Option<Vector>>),
    /// By shares of rows and columns.
    Index,
}

impl Projection {
    pub(super) fn of_patch(patch: &Patch, mesh: &Mesh) -> Projection {
        let flat: Vec<Option<[f64; 2]>> = mesh.nodes.iter().map(|node| Some(axial(node.as_ref()?.position))).collect();
        if share_seen(mesh, &flat) < LEAST_SHARE {
            Projection::by_index(patch, mesh)
        } else {
            axially(patch, mesh, flat)
        }
    }

    fn by_index(patch: &Patch, mesh: &Mesh) -> Projection {
        let share = |k: usize, count: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
        let place = |at: usize| [share(at % mesh.columns, mesh.columns), share(at / mesh.columns, mesh.rows)];
        let arrow = |label: &str| format!("{} \u{2192}", one_line(label));
        let titles = [&patch.columns.label, &patch.rows.label]
            .map(|label| if ends(label).is_some() { String::new() } else { arrow(label) });
        Projection {
            rows: mesh.rows,
            columns: mesh.columns,
            nodes: (0..mesh.nodes.len()).map(|at| mesh.nodes[at].map(|_| place(at))).collect(),
            way: Way::Index,
            titles: [
                titles[0].clone(),
                if titles[1].is_empty() { String::new() } else { format!("up: {}", titles[1]) },
            ],
            words: named_sides(patch),
        }
    }

    /// Turned so that the tooth lies with its length to the right, toe or lower face on the left, and its tip up; a thread, or what the
    /// axial plane does not show, by the mean lengths of its rows and columns.
    pub(super) fn laid_flat(patch: &Patch, mesh: &Mesh) -> Projection {
        let all: Vec<(Side, String)> = words(patch, mesh);
        let flat: Vec<Option<[f64; 2]>> = mesh.nodes.iter().map(|node| Some(axial(node.as_ref()?.position))).collect();
        let is_shown = share_seen(mesh, &flat) >= LEAST_SHARE && !is_folded(mesh, &flat) && !is_thread(patch);
        let plain = Projection {
            rows: mesh.rows,
            columns: mesh.columns,
            nodes: flat,
            way: Way::Index,
            titles: Default::default(),
            words: all,
        };
        let by_rows = rows_follow_profile(patch).unwrap_or(true);
        if is_shown { plain.turned(by_rows) } else { plain.developed(mesh, by_rows) }
    }

    /// The sides at which length and profile begin and end: from toe to heel, and from root to tip. `by_rows`: rows follow the profile.
    fn ways(&self, by_rows: bool) -> [[Side; 2]; 2] {
        let (rows, columns) = ([Side::FirstRow, Side::LastRow], [Side::FirstColumn, Side::LastColumn]);
        let begins_last = |side: Side| self.words.iter().any(|(named, word)| *named == side && is_last(word));
        let in_order = |[first, last]: [Side; 2]| if begins_last(first) { [last, first] } else { [first, last] };
        (if by_rows { [columns, rows] } else { [rows, columns] }).map(in_order)
    }

    fn turned(self, by_rows: bool) -> Projection {
        let end = |side: Side| {
            middle(&self.side(side).into_iter().filter_map(|at| self.nodes[at]).collect::<Vec<[f64; 2]>>())
        };
        let [along, up] = self.ways(by_rows).map(|[from, to]| {
            let [from, to] = [from, to].map(end);
            [to[0] - from[0], to[1] - from[1]]
        });
        let long = along[0].hypot(along[1]);
        let across = if long > 0.0 { along.map(|x| x / long) } else { [1.0, 0.0] };
        // a mirrored picture where the tip would be down
        let left = [-across[1], across[0]];
        let way = if left[0] * up[0] + left[1] * up[1] < 0.0 { left.map(|x| -x) } else { left };
        let turned = |[z, radius]: [f64; 2]| [across, way].map(|to| to[0] * z + to[1] * radius);
        let least = self
            .nodes
            .iter()
            .flatten()
            .map(|place| turned(*place))
            .fold([f64::MAX; 2], |least, place| [0, 1].map(|k: usize| least[k].min(place[k])));
        let nodes =
            self.nodes.iter().map(|place| place.map(turned).map(|at| [0, 1].map(|k| at[k] - least[k]))).collect();
        let rows = [[across[0], across[1], -least[0]], [way[0], way[1], -least[1]]];
        Projection { nodes, way: Way::Axial(rows), titles: LAID_FLAT.map(str::to_owned), ..self }
    }

    fn developed(self, mesh: &Mesh, by_rows: bool) -> Projection {
        let [along, up] = self.ways(by_rows);
        let (rows, columns) = (self.rows, self.columns);
        let ways = [(rows, columns), (columns, rows)];
        // by row and by column, how far it is from the first on average
        let [down, right] = [true, false].map(|by_row| {
            let (steps, lines) = ways[usize::from(!by_row)];
            let at = |step: usize, line: usize| {
                mesh.nodes[if by_row { step * columns + line } else { line * columns + step }]
            };
            let step = |k: usize| {
                let known =
                    (0..lines).filter_map(|line| Some(length(sub(at(k, line)?.position, at(k - 1, line)?.position))));
                let (sum, count) = known.fold((0.0, 0), |(sum, count), way| (sum + way, count + 1));
                if count > 0 { sum / f64::from(count) } else { 0.0 }
            };
            let mut far = vec![0.0; steps];
            (1..steps).for_each(|k| far[k] = far[k - 1] + step(k));
            far
        });
        let share = |side: Side, at: usize| {
            let [down_to, right_to] = [&down, &right].map(|far| far.last().copied().unwrap_or_default());
            let (i, j) = (at / columns, at % columns);
            match side {
                Side::FirstRow => down[i],
                Side::LastRow => down_to - down[i],
                Side::FirstColumn => right[j],
                Side::LastColumn => right_to - right[j],
            }
        };
        let place = |at: usize| mesh.nodes[at].map(|_| [share(along[0], at), share(up[0], at)]);
        let nodes = (0..mesh.nodes.len()).map(place).collect();
        let positions = mesh.nodes.iter().map(|node| node.map(|node| node.position)).collect();
        Projection { nodes, way: Way::Developed(positions), titles: LAID_FLAT.map(str::to_owned), ..self }
    }

    /// Whether the nodes are mm in the axial plane.
    pub(super) fn is_axial(&self) -> bool {
        matches!(self.way, Way::Axial(_))
    }

    /// Whether across and up are mm.
    pub(super) fn is_in_mm(&self) -> bool {
        !matches!(self.way, Way::Index)
    }

    /// Where a place in space lies on paper, if that can be said.
    pub(super) fn place(&self, position: Vector) -> Option<[f64; 2]> {
        match &self.way {
            Way::Axial(rows) => {
                let [z, radius] = axial(position);
                Some(rows.map(|[by_z, by_radius, by_one]| by_z * z + by_radius * radius + by_one))
            }
            Way::Developed(positions) => self.beside_nearest(positions, position),
            Way::Index => None,
        }
    }

    /// By the steps of the grid about the nearest node.
    fn beside_nearest(&self, positions: &[Option<Vector>], position: Vector) -> Option<[f64; 2]> {
        let apart = |at: usize| positions[at].map(|node| length(sub(position, node)));
        let known = (0..positions.len()).filter_map(|at| Some((at, apart(at)?)));
        let (near, _) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (i, j) = (near / self.columns, near % self.columns);
        let at = |i: usize, j: usize| i * self.columns + j;
        let around = [
            [at(i.saturating_sub(1), j), at((i + 1).min(self.rows - 1), j)],
            [at(i, j.saturating_sub(1)), at(i, (j + 1).min(self.columns - 1))],
        ];
        let step = |[from, to]: [usize; 2]| {
            let [from, to] = [from, to].map(|at| if positions[at].is_some() { at } else { near });
            Some((sub(positions[to]?, positions[from]?), sub_flat(self.nodes[to]?, self.nodes[from]?)))
        };
        let [(down, down_flat), (right, right_flat)] = [step(around[0])?, step(around[1])?];
        let off = sub(position, positions[near]?);
        let [dd, dr, rr] = [dot(down, down), dot(down, right), dot(right, right)];
        let determinant = dd * rr - dr * dr;
        let [od, or] = [dot(off, down), dot(off, right)];
        let shares = [(od * rr - or * dr) / determinant, (or * dd - od * dr) / determinant];
        let from = self.nodes[near]?;
        shares
            .iter()
            .all(|share| share.is_finite())
            .then(|| [0, 1].map(|k| from[k] + shares[0] * down_flat[k] + shares[1] * right_flat[k]))
    }

    /// The numbers of the nodes along a side, in the order of growing index.
    pub(super) fn side(&self, side: Side) -> Vec<usize> {
        let (rows, columns) = (self.rows, self.columns);
        match side {
            Side::FirstRow => (0..columns).collect(),
            Side::LastRow => ((rows - 1) * columns..rows * columns).collect(),
            Side::FirstColumn => (0..rows).map(|i| i * columns).collect(),
            Side::LastColumn => (0..rows).map(|i| (i + 1) * columns - 1).collect(),
        }
    }
}

fn axially(patch: &Patch, mesh: &Mesh, flat: Vec<Option<[f64; 2]>>) -> Projection {
    let reach = |k: usize| {
        let known = || flat.iter().flatten().map(|place| place[k]);
        known().fold(f64::MIN, f64::max) - known().fold(f64::MAX, f64::min)
    };
    // the longer one goes across
    let swapped = reach(1) > reach(0);
    let nodes =
        if swapped { flat.iter().map(|place| place.map(|[z, radius]| [radius, z])).collect() } else { flat.clone() };
    let titles = ["z, mm".to_owned(), "radius, mm".to_owned()];
    let [z, radius] = titles;
    Projection {
        rows: mesh.rows,
        columns: mesh.columns,
        nodes,
        way: Way::Axial(if swapped { [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]] } else { [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }),
        titles: if swapped { [radius, z] } else { [z, radius] },
        words: words(patch, mesh),
    }
}

fn sub_flat(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// How much of the area is left in the axial plane, less what lies on itself there.
fn share_seen(mesh: &Mesh, flat: &[Option<[f64; 2]>]) -> f64 {
    let (mut seen, mut all) = (0.0, 0.0);
    for face in mesh.faces() {
        let [a, b, c] = [face[0], face[1], face[2]];
        let (Some(p), Some(q), Some(r)) = (mesh.nodes[a], mesh.nodes[b], mesh.nodes[c]) else { continue };
        all += length(cross(sub(q.position, p.position), sub(r.position, p.position)));
        let (Some(p), Some(q), Some(r)) = (flat[a], flat[b], flat[c]) else { continue };
        seen += (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    }
    if all > 0.0 { seen.abs() / all } else { 0.0 }
}

/// Whether a patch lies over itself in the axial plane.
fn is_folded(mesh: &Mesh, flat: &[Option<[f64; 2]>]) -> bool {
    let (mut sum, mut all) = (0.0, 0.0);
    for face in mesh.faces() {
        let (Some(p), Some(q), Some(r)) = (flat[face[0]], flat[face[1]], flat[face[2]]) else { continue };
        let area: f64 = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        sum += area;
        all += area.abs();
    }
    sum.abs() < UNFOLDED * all
}

/// The point between some.
pub(super) fn middle(places: &[[f64; 2]]) -> [f64; 2] {
    let share = 1.0 / places.len().max(1) as f64;
    places.iter().fold([0.0; 2], |sum, place| [sum[0] + share * place[0], sum[1] + share * place[1]])
}
