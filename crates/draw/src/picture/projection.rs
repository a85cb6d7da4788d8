//! A patch laid flat: turned into the axial plane, or, where that shows nothing of it, by its rows and columns.

use flank_export::Patch;
use flank_export::shape::Mesh;
use flank_export::shape::{Side, axial, ends, named_sides, words};
use flank_export::text::one_line;
use flank_export::vector::{Vector, cross, length, sub};

/// A patch of which less than this share is seen in the axial plane is laid by rows and columns.
const LEAST_SHARE: f64 = 0.04;

/// The nodes of a patch on paper.
pub(super) struct Projection {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Across and up: mm in the axial plane, shares of rows and columns otherwise.
    pub(super) nodes: Vec<Option<[f64; 2]>>,
    /// Whether the nodes are mm in the axial plane.
    pub(super) is_axial: bool,
    /// What goes across and up.
    pub(super) titles: [String; 2],
    /// What the sides are called.
    pub(super) words: Vec<(Side, String)>,
    /// Whether across is the radius, and not z.
    swapped: bool,
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
            is_axial: false,
            titles: [
                titles[0].clone(),
                if titles[1].is_empty() { String::new() } else { format!("up: {}", titles[1]) },
            ],
            words: named_sides(patch),
            swapped: false,
        }
    }

    /// Where a place in space lies on paper, if it is a projection of space.
    pub(super) fn place(&self, position: Vector) -> Option<[f64; 2]> {
        let [z, radius] = axial(position);
        self.is_axial.then_some(if self.swapped { [radius, z] } else { [z, radius] })
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
        is_axial: true,
        titles: if swapped { [radius, z] } else { [z, radius] },
        words: words(patch, mesh),
        swapped,
    }
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

/// The point between some.
pub(super) fn middle(places: &[[f64; 2]]) -> [f64; 2] {
    let share = 1.0 / places.len().max(1) as f64;
    places.iter().fold([0.0; 2], |sum, place| [sum[0] + share * place[0], sum[1] + share * place[1]])
}
