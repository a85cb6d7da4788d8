//! How finely a body is cut into triangles, and how far these are off it.

use nalgebra::Vector3;

use crate::contact::OutlineSegment;
use crate::solid::arrangement::Arrangement;
use crate::solid::bands::is_first_diagonal;
use crate::solid::body::Body;
use crate::solid::mesh::{BodyPart, on_end};
use crate::solid::section::{Fineness, Layout};

/// Cells of a chart in one direction at the most: with so many each chord is as near as charts themselves are.
const MOST_CELLS: usize = 1 << 13;
/// Where the rest of the outline wants more columns, grounds get them that have fewer than a share of those of teeth: one in so many.
const FEW_OF_GROUND: usize = 4;
/// Curved ends are not looked at more finely than this: nobody has the room for such a mesh.
const MOST_TRIANGLES: usize = 1 << 25;

impl Body {
    /// So finely that the middles of cells' sides are no farther than `tolerance` (mm) from the exact surfaces.
    pub fn fineness(&self, part: BodyPart, tolerance: f64) -> Fineness {
        let mut charts = vec![2; self.charts().len()];
        let rest = self.blank().rest();
        // diagonals are off along the angle and along the arc
        let arcs = rest.iter().map(|segment| arc_cells(segment, 0.5 * tolerance)).collect::<Vec<usize>>();
        let arc = arcs.iter().copied().max().unwrap_or(1);
        let mut along = (2 * rest.len()).next_power_of_two();
        if !(part == BodyPart::Gear && self.arrangement().is_closed()) {
            // sides of a part have as many cells below as along, and each segment its share
            let whole: f64 = rest.iter().map(|segment| segment.length()).sum();
            let of_all = |(segment, cells): (&&OutlineSegment, &usize)| *cells as f64 * whole / segment.length();
            let needed = rest.iter().zip(&arcs).filter(|(_, cells)| **cells > 1).map(of_all).fold(0.0, f64::max);
            along = along.max(needed.ceil() as usize).next_power_of_two().min(MOST_CELLS);
        }
        for (k, chart) in self.spaces.iter().flat_map(|charts| charts.iter().enumerate()) {
            let count = &mut charts[k];
            let doubled = |cells: usize| (0..=2 * cells).map(|k| k as f64 / (2 * cells) as f64).collect::<Vec<f64>>();
            while *count < MOST_CELLS
                && sag(&chart.lattice(&doubled(*count), &[0.0, 0.5, 1.0]), [2 * *count + 1, 3], 0) > tolerance
            {
                *count *= 2;
            }
            while along < MOST_CELLS
                && sag(&chart.lattice(&[0.0, 0.5, 1.0], &doubled(along)), [3, 2 * along + 1], 1) > tolerance
            {
                along *= 2;
            }
        }
        // the two flanks have as many rows as each other, and so do the fillets beside them
        let last = charts.len() - 1;
        for k in 0..=last / 2 {
            let both = charts[k].max(charts[last - k]);
            (charts[k], charts[last - k]) = (both, both);
        }
        let [line, next] = self.tooth_lines(0, &vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &[0.5]);
        let (tip, land) = (line[0][0][1], next[0][0][2] - line[0][line[0].len() - 1][2]);
        let steps = |rho: f64, angle: f64| match self.arrangement {
            Arrangement::Round => (angle * (rho / (8.0 * tolerance)).sqrt()).ceil() as usize,
            Arrangement::Straight { .. } => 1,
        };
        let widest =
            rest.iter().flat_map(|segment| [0.0, 0.5, 1.0].map(|share| segment.at(share)[1])).fold(0.0, f64::max);
        let of_charts = Layout::new(&Fineness { charts: charts.clone(), tooth: 0, rim: 1, along, arc }).width();
        // twice as many, since they are not even
        let below = (2 * steps(widest, self.pitch())).saturating_sub(of_charts);
        let tooth = steps(tip, land).max(below).max(2).next_multiple_of(2);
        self.fine_ends(Fineness { charts, tooth, rim: 1, along, arc }, tolerance)
    }

    /// Finer until curved ends are near enough.
    fn fine_ends(&self, mut fineness: Fineness, tolerance: f64) -> Fineness {
        loop {
            let EndSag { around, in_teeth, below, diagonal } = self.sag_of_ends(&fineness);
            let down = in_teeth.max(below);
            let is_near = around.max(down).max(diagonal) <= tolerance;
            if is_near || self.triangles(BodyPart::Gear, &fineness) > MOST_TRIANGLES {
                return fineness;
            }
            // a diagonal is as far off as sides of both directions together
            let is_around = around > tolerance || (down <= tolerance && around >= down);
            let finest_chart = fineness.charts.iter().copied().max().unwrap_or_default();
            if is_around && fineness.tooth < MOST_CELLS {
                fineness.tooth *= 2;
            } else if below >= in_teeth && fineness.rim < MOST_CELLS {
                fineness.rim *= 2;
            } else if below < in_teeth && finest_chart < MOST_CELLS {
                fineness.charts.iter_mut().for_each(|cells| *cells *= 2);
            } else {
                return fineness;
            }
        }
    }

    /// So many triangles the closed surface of a part has, about.
    pub fn triangles(&self, part: BodyPart, fineness: &Fineness) -> usize {
        let Fineness { tooth, rim, along, arc, .. } = *fineness;
        let layout = Layout::new(fineness);
        let is_ring = part == BodyPart::Gear && self.arrangement().is_closed();
        let cells = layout.depth * tooth + rim * layout.width();
        let below = if is_ring {
            self.blank().rest().iter().map(|segment| if segment.center.is_some() { arc } else { 1 }).sum()
        } else {
            along
        };
        let cut = if is_ring { 0 } else { layout.depth + rim };
        let teeth = if part == BodyPart::Gear { self.teeth() as usize } else { 1 };
        teeth.saturating_mul(
            4 * cells + 2 * along * (layout.last + tooth) + 2 * below * layout.width() + 4 * along * cut,
        )
    }

    /// How far sides of triangles lie off the charts of a space, of all spaces where these differ: square to the cells.
    pub(crate) fn offs_of_charts(&self, fineness: &Fineness) -> Vec<Off> {
        let halves = |cells: usize| (0..=2 * cells).map(|k| k as f64 / (2 * cells) as f64).collect::<Vec<f64>>();
        let along = halves(fineness.along);
        let of_chart = |k: usize| {
            let across = halves(fineness.charts[k]);
            self.spaces
                .iter()
                .map(|charts| off_cells(&charts[k].lattice(&across, &along), along.len()))
                .fold(Off::default(), Off::or)
        };
        (0..fineness.charts.len()).map(of_chart).collect()
    }

    pub(crate) fn off_of_ends(&self, fineness: &Fineness) -> f64 {
        let EndSag { around, in_teeth, below, diagonal } = self.sag_of_ends(fineness);
        around.max(in_teeth).max(below).max(diagonal)
    }

    /// How far cells on curved ends lie off these.
    fn sag_of_ends(&self, fineness: &Fineness) -> EndSag {
        let (across, _) = Body::shares_of(fineness);
        let layout = Layout::new(fineness);
        let [lines, next] = self.tooth_lines(0, &across, &[0.0, 0.5, 1.0]);
        let arrangement = self.arrangement;
        let shares = layout.shares(&layout.top([&lines[1], &next[1]]), arrangement);
        let [begin, _, end] = self.blank().bounds();
        let mut most = EndSag::default();
        for (j, segment, below) in [(0, begin, begin.from), (2, end, end.to)] {
            if segment.center.is_none() && segment.from[0] == segment.to[0] {
                continue;
            }
            let places = layout.places([&lines[j], &next[j]], below, &shares);
            let sag = |a: usize, b: usize| {
                let [p, q] = [places[a], places[b]].map(|place| on_end(segment, place));
                let middle = on_end(segment, [0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
                let [p, q, middle] = [p, q, middle].map(|place| Vector3::from(arrangement.position(place)));
                (0.5 * (p + q) - middle).norm()
            };
            let off = |a: usize, b: usize| {
                let [p, q] =
                    [places[a], places[b]].map(|place| Vector3::from(arrangement.position(on_end(segment, place))));
                let middle = arrangement.section((0.5 * (p + q)).into());
                let on = segment.nearest(middle);
                (on[0] - middle[0]).hypot(on[1] - middle[1])
            };
            for [a, b, c, d] in layout.cells() {
                most.around = most.around.max(sag(a, b)).max(sag(d, c));
                let down = if layout.is_in_rim(a) { &mut most.below } else { &mut most.in_teeth };
                *down = down.max(sag(a, d)).max(sag(b, c));
                most.diagonal = most.diagonal.max(off(a, c)).max(off(b, d));
            }
        }
        most
    }
}

/// How far the sides of triangles lie off a face in their middles, mm: across a space or a tooth, along it, and the diagonals of cells.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Off {
    pub(crate) across: f64,
    pub(crate) along: f64,
    pub(crate) diagonal: f64,
}

impl Off {
    pub(crate) fn most(self) -> f64 {
        self.across.max(self.along).max(self.diagonal)
    }

    pub(crate) fn or(self, other: Off) -> Off {
        Off {
            across: self.across.max(other.across),
            along: self.along.max(other.along),
            diagonal: self.diagonal.max(other.diagonal),
        }
    }

    /// In which direction finer cells bring the sides nearer, where they are not near enough: a diagonal is about as far off as sides of both
    /// directions together.
    fn is_across(self, tolerance: f64) -> Option<bool> {
        (self.most() > tolerance).then_some(self.across > tolerance || self.across >= self.along)
    }
}

/// How far a mesh is off its body.
pub(crate) struct Offs {
    /// Of each chart of a space.
    pub(crate) charts: Vec<Off>,
    pub(crate) tip: Off,
    /// Of the rest of the outline.
    pub(crate) below: Off,
    pub(crate) ends: f64,
}

impl Offs {
    pub(crate) fn most(&self) -> f64 {
        let blank = self.tip.most().max(self.below.most()).max(self.ends);
        self.charts.iter().fold(blank, |most, off| most.max(off.most()))
    }

    /// Finer cells where they are not near enough; nothing if all are, or could not be finer.
    pub(crate) fn finer(&self, fineness: &Fineness, tolerance: f64) -> Option<Fineness> {
        let mut finer = fineness.clone();
        let last = fineness.charts.len() - 1;
        for (k, off) in self.charts.iter().enumerate() {
            match off.is_across(tolerance) {
                Some(true) => [k, last - k].into_iter().for_each(|k| finer.charts[k] = 2 * fineness.charts[k]),
                Some(false) => finer.along = 2 * fineness.along,
                None => {}
            }
        }
        match self.tip.is_across(tolerance) {
            Some(true) => finer.tooth = 2 * fineness.tooth,
            Some(false) => finer.along = 2 * fineness.along,
            None => {}
        }
        let ground = [last / 2, last - last / 2];
        match self.below.is_across(tolerance) {
            // the rest of the outline has the columns of teeth and of grounds, of which flat ones need none themselves
            Some(true) if fineness.tooth > FEW_OF_GROUND * fineness.charts[ground[0]] => {
                ground.into_iter().for_each(|k| finer.charts[k] = 2 * fineness.charts[k]);
            }
            Some(true) => finer.tooth = 2 * fineness.tooth,
            Some(false) => (finer.along, finer.arc) = (2 * fineness.along, 2 * fineness.arc),
            None => {}
        }
        let cells = finer.charts.iter().chain([&finer.tooth, &finer.along, &finer.arc]);
        let is_possible = cells.into_iter().all(|cells| *cells <= MOST_CELLS);
        (finer != *fineness && is_possible).then_some(finer)
    }
}

/// How far the sides of cells on curved ends lie off these in their middles, mm.
#[derive(Default)]
struct EndSag {
    /// Along the angle.
    around: f64,
    /// From the tip to where the block below begins.
    in_teeth: f64,
    /// From there to the rest of the outline.
    below: f64,
    /// Across cells.
    diagonal: f64,
}

/// Cells along a segment whose middles are no farther from it, mm.
fn arc_cells(segment: &OutlineSegment, tolerance: f64) -> usize {
    let Some(center) = segment.center else { return 1 };
    let radius = (segment.from[0] - center[0]).hypot(segment.from[1] - center[1]);
    let most = 2.0 * (1.0 - tolerance / radius).max(0.0).acos();
    ((segment.length() / radius / most).ceil() as usize).max(1)
}

/// How far points between two others lie off their chord, in one direction of a lattice of doubled fineness.
fn sag(points: &[[f64; 3]], [rows, columns]: [usize; 2], direction: usize) -> f64 {
    let step = if direction == 0 { columns } else { 1 };
    let mut most: f64 = 0.0;
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let along = if direction == 0 { i } else { j };
        if along.is_multiple_of(2) {
            continue;
        }
        let at = i * columns + j;
        let off = [0, 1, 2].map(|k| points[at][k] - 0.5 * (points[at - step][k] + points[at + step][k]));
        most = most.max(off.iter().map(|x| x * x).sum::<f64>().sqrt());
    }
    most
}

/// How far the sides and the shorter diagonals of cells lie off a surface of which there are points at their corners and half-way between.
fn off_cells(points: &[[f64; 3]], columns: usize) -> Off {
    let at = |i: usize, j: usize| Vector3::from(points[i * columns + j]);
    let mut most = Off::default();
    for i in (0..points.len() / columns - 1).step_by(2) {
        for j in (0..columns - 1).step_by(2) {
            let [a, b, c, d] = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
            let normal = (c - a).cross(&(d - b)).try_normalize(0.0).unwrap_or_default();
            let off = |p: Vector3<f64>, q: Vector3<f64>, on: Vector3<f64>| (on - 0.5 * (p + q)).dot(&normal).abs();
            let [first, second] = [off(a, c, at(i + 1, j + 1)), off(b, d, at(i + 1, j + 1))];
            most = most.or(Off {
                across: off(a, b, at(i + 1, j)).max(off(d, c, at(i + 1, j + 2))),
                along: off(a, d, at(i, j + 1)).max(off(b, c, at(i + 2, j + 1))),
                // where both are as long, either may be there
                diagonal: match [true, false].map(|of_equal| is_first_diagonal([a, b, c, d], of_equal)) {
                    [true, true] => first,
                    [false, false] => second,
                    _ => first.max(second),
                },
            });
        }
    }
    most
}
