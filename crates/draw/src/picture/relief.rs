//! Heights over a flank that is laid flat, as a relief above its measuring grid.

use super::camera::{Camera, View};
use super::contours::parts_in_bands;
use super::labels::{self, Border};
use super::levels::{Levels, round_up};
use super::maps::Panel;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Item, Place, Rect, Sheet};
use super::palette::{FAINT, GREY, INK};
use super::projection::middle;
use super::surface::{Layers, SEAM};
use flank_export::text::{levelled, shown_unit};
use flank_export::vector::{Vector, cross, dot, sub};

/// The largest height is drawn as this share of the flank's length.
const HEIGHT: f64 = 0.22;
/// The flank is drawn at least this share as high as it is long.
const SLENDEREST: f64 = 0.4;
/// Pieces that each cell is drawn in, in both directions, at least in all so many.
const PIECES: usize = 48;

/// Draws the relief of a panel's values.
pub(super) fn draw(panel: &Panel<'_>, levels: &Levels, rect: Rect, sheet: &mut Sheet) {
    let relief = Relief::of_panel(panel);
    let all: Vec<Vector> = relief.plan.iter().chain(&relief.heights).flatten().copied().collect();
    let room = rect.inside([110.0, 30.0, 110.0, 34.0]);
    let camera = relief.camera();
    let view = View::fitting(camera, &all, room);
    relief.draw_plan(&view, sheet);
    let mut layers = Layers::default();
    relief.add_faces(levels, &view, &mut layers);
    layers.into_items().for_each(|item| sheet.push(item));
    relief.draw_words(panel, &view, rect, sheet);
    let unit = shown_unit(&panel.field.unit);
    draw_bar(relief.amplification * view.scale * camera.seen([0.0, 0.0, 1.0])[1], &unit, rect, sheet);
}

struct Relief {
    rows: usize,
    columns: usize,
    /// Nodes where the height is zero, and where it is.
    plan: Vec<Option<Vector>>,
    heights: Vec<Option<Vector>>,
    /// mm of the drawing per unit of the values.
    amplification: f64,
}

impl Relief {
    fn of_panel(panel: &Panel<'_>) -> Relief {
        let nodes = &panel.projection.nodes;
        let reach = |k: usize| {
            let known = || nodes.iter().flatten().map(|place| place[k]);
            (known().fold(f64::MIN, f64::max) - known().fold(f64::MAX, f64::min)).max(1e-9)
        };
        let stretch = (SLENDEREST * reach(0) / reach(1)).max(1.0);
        let known = || panel.values.iter().flatten();
        let largest = known().fold(0.0, |most: f64, value| most.max(value.abs()));
        let amplification = HEIGHT * reach(0) / if largest > 0.0 { largest } else { 1.0 };
        let plan: Vec<Option<Vector>> =
            nodes.iter().map(|place| place.map(|[across, up]| [across, stretch * up, 0.0])).collect();
        let raised = plan.iter().zip(&panel.values);
        let heights = raised.map(|(at, value)| (*at).zip(*value).map(|([x, y, _], h)| [x, y, amplification * h]));
        Relief { rows: panel.mesh.rows, columns: panel.mesh.columns, heights: heights.collect(), plan, amplification }
    }

    /// The first camera that sees nearly as much of the relief from above as the best one.
    fn camera(&self) -> Camera {
        let cells = (1..self.rows).flat_map(|i| (1..self.columns).map(move |j| i * self.columns + j));
        let normals: Vec<Vector> = cells
            .filter_map(|at| {
                let [a, b, c, d] = [at - self.columns - 1, at - 1, at, at - self.columns].map(|at| self.heights[at]);
                let normal = cross(sub(c?, a?), sub(d?, b?));
                Some(if normal[2] < 0.0 { normal.map(|x| -x) } else { normal })
            })
            .collect();
        let seen = |camera: &Camera| normals.iter().map(|normal| dot(*normal, camera.towards).max(0.0)).sum::<f64>();
        let cameras = Camera::over();
        let most = cameras.iter().map(seen).fold(0.0, f64::max);
        cameras.into_iter().find(|camera| seen(camera) >= 0.8 * most).unwrap_or(cameras[0])
    }

    /// The measuring grid itself, at height zero.
    fn draw_plan(&self, view: &View, sheet: &mut Sheet) {
        let (rows, columns) = (self.rows, self.columns);
        let every = |count: usize| count.div_ceil(16).max(1);
        let line = |at: &mut dyn Iterator<Item = usize>| -> Vec<Place> {
            at.filter_map(|at| self.plan[at]).map(|place| view.place(place)).collect()
        };
        for i in (0..rows).filter(|i| i % every(rows) == 0 || i + 1 == rows) {
            sheet.line(&line(&mut (0..columns).map(|j| i * columns + j)), FAINT, 0.9);
        }
        for j in (0..columns).filter(|j| j % every(columns) == 0 || j + 1 == columns) {
            sheet.line(&line(&mut (0..rows).map(|i| i * columns + j)), FAINT, 0.9);
        }
        let corners = [0, columns - 1, rows * columns - 1, (rows - 1) * columns];
        for at in corners {
            if let (Some(foot), Some(head)) = (self.plan[at], self.heights[at]) {
                sheet.line(&[view.place(foot), view.place(head)], GREY, 1.0);
            }
        }
    }

    /// Pieces of the surface in the colours of their heights, and the lines of the grid on it.
    fn add_faces(&self, levels: &Levels, view: &View, layers: &mut Layers) {
        let parts = [self.rows, self.columns].map(|count| PIECES.div_ceil(count.saturating_sub(1).max(1)).max(1));
        let every = [self.rows, self.columns].map(|count| count.div_ceil(20).max(1));
        // lines in front of the pieces beside them
        let lift = 8.0 / view.scale;
        for i in 1..self.rows {
            for j in 1..self.columns {
                let at = i * self.columns + j;
                let corners = [at - self.columns - 1, at - 1, at, at - self.columns];
                let [Some(a), Some(b), Some(c), Some(d)] = corners.map(|corner| self.heights[corner]) else { continue };
                let place = |s: f64, t: f64| {
                    let mix = |p: Vector, q: Vector, share: f64| [0, 1, 2].map(|k| p[k] + share * (q[k] - p[k]));
                    mix(mix(a, b, s), mix(d, c, s), t)
                };
                let share = |k: usize, of: usize| k as f64 / of as f64;
                for (k, l) in (0..parts[0]).flat_map(|k| (0..parts[1]).map(move |l| (k, l))) {
                    let corner = |k: usize, l: usize| place(share(k, parts[0]), share(l, parts[1]));
                    let piece = [corner(k, l), corner(k + 1, l), corner(k + 1, l + 1), corner(k, l + 1)];
                    let depth = view.depth(place(share(2 * k + 1, 2 * parts[0]), share(2 * l + 1, 2 * parts[1])));
                    let valued = piece.map(|at| (view.place(at), at[2] / self.amplification));
                    for (fill, points) in parts_in_bands(&valued, levels) {
                        layers.push(depth, Item::Polygon { points, fill, outline: fill, width: SEAM });
                    }
                    let mut edge = |on: bool, from: Vector, to: Vector| {
                        if on {
                            let points = vec![view.place(from), view.place(to)];
                            layers.push(depth + lift, Item::Line { points, colour: INK, width: 0.7 });
                        }
                    };
                    edge(l == 0 && (j - 1) % every[1] == 0, piece[0], piece[1]);
                    edge(l + 1 == parts[1] && j + 1 == self.columns, piece[3], piece[2]);
                    edge(k == 0 && (i - 1) % every[0] == 0, piece[0], piece[3]);
                    edge(k + 1 == parts[0] && i + 1 == self.rows, piece[1], piece[2]);
                }
            }
        }
    }

    /// Words beside the grid; those behind it stand above the relief.
    fn draw_words(&self, panel: &Panel<'_>, view: &View, rect: Rect, sheet: &mut Sheet) {
        let all: Vec<Place> = self.plan.iter().flatten().map(|place| view.place(*place)).collect();
        let centre = middle(&all);
        let mut taken = Occupancy::new(rect.right, rect.bottom);
        for (side, word) in &panel.projection.words {
            let line = panel.projection.side(*side);
            let known =
                line.iter().filter_map(|at| Some((view.place(self.plan[*at]?), view.place(self.heights[*at]?))));
            let (mut feet, heads): (Vec<Place>, Vec<Place>) = known.unzip();
            // in the middle of the side, where the word stands
            let third = feet.len() / 3;
            let lift = feet.iter().zip(&heads).skip(third).take(third + 1).map(|(foot, head)| foot[1] - head[1]);
            let (lowest, highest) = lift.fold((0.0, 0.0), |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
            let up = if middle(&feet)[1] < centre[1] { highest } else { lowest };
            feet.iter_mut().for_each(|foot| foot[1] -= up);
            if let Some(border) = Border::new(feet, &all) {
                labels::word_beside(&border, word, rect, &mut taken, sheet);
            }
        }
    }
}

/// How high a round value is; `scale` is sheet units per unit of the values.
fn draw_bar(scale: f64, unit: &str, rect: Rect, sheet: &mut Sheet) {
    let value = round_up(30.0 / scale);
    let high = value * scale;
    if !(high.is_finite() && high < rect.height()) {
        return;
    }
    let [x, bottom] = [rect.left + 10.0, rect.bottom - 14.0];
    sheet.line(&[[x, bottom], [x, bottom - high]], INK, 2.0);
    for y in [bottom, bottom - high] {
        sheet.line(&[[x - 5.0, y], [x + 5.0, y]], INK, 2.0);
    }
    let text = format!("{} {unit}", levelled(value, value));
    sheet.text([x + 12.0, bottom - 0.5 * high + 5.0], Anchor::Start, 13.0, INK, &text);
}
