//! Where the nodes of a section lie.
//!
//! Those of the flanks, fillets and roots lie on the exact surfaces. The layers of a band lie along the normals there, which turn into the
//! direction of the tip's land towards the tip. What is inside is interpolated between the borders, then moved in Laplace steps whose
//! weights keep the layers' thicknesses.

use crate::contact::OutlineSegment;
use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::body::Body;
use crate::solid::bricks::Stations;
use crate::solid::bricks::counts::BrickCounts;
use crate::solid::bricks::layout::{Hand, Layout};

/// Laplace steps: more move no node by a tenth of its cell.
const LAPLACE_STEPS: usize = 24;
/// Of the way from the root to the rest of the outline the band takes so much at the most.
const MOST_OF_RIM: f64 = 0.35;

/// All sections of a tooth, one of those that [`Body::distinct`] counts.
pub(crate) struct Sections<'b> {
    body: &'b Body,
    layout: &'b Layout,
    /// Lines across the space before it and the one behind it.
    lines: [Vec<Vec<Polar>>; 2],
    stations: &'b Stations,
    band_share: f64,
    band: Vec<f64>,
    rim: Vec<f64>,
    /// Of the lower row the shares of the way to the next space.
    around: Vec<f64>,
    /// Nodes that Laplace steps move, each with its neighbours.
    free: Vec<(usize, [usize; 4])>,
}

impl<'b> Sections<'b> {
    pub(crate) fn new(
        (body, tooth): (&'b Body, usize),
        layout: &'b Layout,
        counts: &BrickCounts,
        stations: &'b Stations,
    ) -> Sections<'b> {
        let lines = body.tooth_lines(tooth, &stations.across, &stations.along);
        let mut sections = Sections {
            body,
            layout,
            lines,
            stations,
            band_share: counts.band_share(),
            band: counts.band_shares(layout.steps),
            rim: Vec::new(),
            around: Vec::new(),
            free: free(layout),
        };
        let middle = stations.along.len() / 2;
        let mut places = vec![[0.0; 3]; layout.nodes];
        sections.place_bands(middle, &mut places);
        sections.place_core(&mut places);
        let top: Vec<Polar> = (0..=layout.width()).map(|column| places[layout.in_rim(0, column)]).collect();
        sections.around = mixed_shares(&top, body.arrangement);
        let [z, rho, _] = top[0];
        let way = (z - stations.below[middle][0]).hypot(rho - stations.below[middle][1]);
        let whole: f64 = top.windows(2).map(|pair| body.arrangement.distance(pair[0], pair[1])).sum();
        let size = whole / layout.width() as f64 * layout.steps as f64;
        sections.rim = counts.rim_shares(size / way, layout.steps);
        sections
    }

    /// The nodes of a section, of those that [`Stations::sections`] counts; beyond the teeth those of the shaft alone.
    pub(crate) fn places(&self, at: usize) -> Vec<Polar> {
        let mut places = vec![[0.0; 3]; self.layout.nodes];
        if let Some(section) = self.stations.of_teeth(at) {
            self.place_bands(section, &mut places);
            self.place_core(&mut places);
            self.place_rim(section, &mut places);
            smooth(&self.free, self.body.arrangement, &mut places);
            self.bring_to_end(section, &mut places);
        }
        self.place_shaft(at, &mut places);
        places
    }

    fn place_bands(&self, section: usize, places: &mut [Polar]) {
        let (layout, below) = (self.layout, self.stations.below[section]);
        let [line, next] = self.lines.each_ref().map(|lines| &lines[section]);
        let (last, arrangement) = (line.len() - 1, self.body.arrangement);
        let into = [line, next].map(|line| normals(line, below, arrangement));
        let down = direction(line[0], below);
        let half = |row: usize| 0.5 * arrangement.distance(line[last - row], next[row]);
        let root = line[last / 2];
        let deepest = MOST_OF_RIM * (root[0] - below[0]).hypot(root[1] - below[1]);
        for row in 0..=layout.profile {
            let thickness = (self.band_share * half(row.min(layout.depth))).min(deepest);
            // at the tip along its land
            let turn = (row as f64 / layout.depth as f64).min(1.0);
            for (hand, at, inward) in [(Hand::Low, last - row, 1.0), (Hand::High, row, -1.0)] {
                let (place, normal) = if hand == Hand::Low { (line[at], into[0][at]) } else { (next[at], into[1][at]) };
                let [x, y] = unit([(1.0 - turn) * inward + turn * normal[0], turn * normal[1]]);
                for (layer, share) in self.band.iter().enumerate() {
                    let [x, y] = [x, y].map(|part| part * share * thickness);
                    let [z, rho, way] = place;
                    places[layout.in_band(hand, row, layer)] = match layer {
                        0 => place,
                        _ => [z + y * down[0], rho + y * down[1], way + x / arrangement.arc(rho)],
                    };
                }
            }
        }
    }

    fn place_core(&self, places: &mut [Polar]) {
        let layout = self.layout;
        for row in 0..=layout.depth {
            let [from, to] = [0, layout.core].map(|column| places[layout.in_core(row, column)]);
            for column in 1..layout.core {
                places[layout.in_core(row, column)] = between(from, to, column as f64 / layout.core as f64);
            }
        }
    }

    fn place_rim(&self, section: usize, places: &mut [Polar]) {
        let (layout, below) = (self.layout, self.stations.below[section]);
        let [start, end] = self.lines.each_ref().map(|lines| lines[section][(lines[section].len() - 1) / 2][2]);
        for (column, around) in self.around.iter().enumerate() {
            let from = places[layout.in_rim(0, column)];
            let to = [below[0], below[1], start + around * (end - start)];
            for (row, share) in self.rim.iter().enumerate().skip(1) {
                places[layout.in_rim(row, column)] = between(from, to, *share);
            }
        }
    }

    /// Below the teeth and beyond them, at the angles of the nearest section across them.
    fn place_shaft(&self, at: usize, places: &mut [Polar]) {
        let Some(shaft) = &self.stations.shaft else { return };
        let section = at.saturating_sub(self.stations.before()).min(self.stations.along.len() - 1);
        let [start, end] = self.lines.each_ref().map(|lines| lines[section][(lines[section].len() - 1) / 2][2]);
        for (row, [z, rho]) in shaft.places[at].iter().enumerate() {
            for (column, around) in self.around.iter().enumerate() {
                places[self.layout.in_rim(self.layout.rim + row, column)] = [*z, *rho, start + around * (end - start)];
            }
        }
    }

    /// Of the first and the last section, where these lie on arcs of the outline.
    fn bring_to_end(&self, section: usize, places: &mut [Polar]) {
        let [begin, _, end] = self.body.blank().bounds();
        let segment: &OutlineSegment = match section {
            0 => begin,
            last if last + 1 == self.stations.below.len() => end,
            _ => return,
        };
        if segment.center.is_some() {
            for place in places.iter_mut() {
                let [z, rho] = segment.nearest([place[0], place[1]]);
                (place[0], place[1]) = (z, rho);
            }
        }
    }
}

/// Of the places along a row the shares of the way, half by length and half evenly.
fn mixed_shares(row: &[Polar], arrangement: Arrangement) -> Vec<f64> {
    let mut sums = vec![0.0];
    row.windows(2).for_each(|pair| sums.push(sums[sums.len() - 1] + arrangement.distance(pair[0], pair[1])));
    let (whole, last) = (sums[sums.len() - 1], row.len() - 1);
    let share =
        |(k, sum): (usize, &f64)| if k == last { 1.0 } else { 0.5 * sum / whole + 0.5 * k as f64 / last as f64 };
    sums.iter().enumerate().map(share).collect()
}

/// Unit normals into the material along a line across a space, `[along the circle, towards a place below]`.
///
/// Those of the parabola through a place and its neighbours, in which the nearer one counts more: where a short root follows a fillet, the mean of
/// both directions leans by far more than the root is long. At a corner lengths count for nothing, since both sides go on straight.
pub(crate) fn normals(line: &[Polar], below: [f64; 2], arrangement: Arrangement) -> Vec<[f64; 2]> {
    let down = direction(line[0], below);
    let step = |from: Polar, to: Polar| {
        let x = arrangement.arc(0.5 * (from[1] + to[1])) * (to[2] - from[2]);
        let y = (to[0] - from[0]) * down[0] + (to[1] - from[1]) * down[1];
        (x.hypot(y), unit([x, y]))
    };
    let steps: Vec<(f64, [f64; 2])> = line.windows(2).map(|pair| step(pair[0], pair[1])).collect();
    let last = steps.len() - 1;
    let normal = |k: usize| {
        let ((length, before), (next, after)) = (steps[k.saturating_sub(1)], steps[k.min(last)]);
        let straight = (before[0] * after[0] + before[1] * after[1]).max(0.0);
        let share = if length > 0.0 && next > 0.0 { (length / next).powf(straight) } else { 1.0 };
        let [x, y] = unit([before[0] + share * after[0], before[1] + share * after[1]]);
        [-y, x]
    };
    (0..line.len()).map(normal).collect()
}

/// From a place towards one on the rest of the outline, `[z, rho]`.
fn direction(place: Polar, below: [f64; 2]) -> [f64; 2] {
    unit([below[0] - place[0], below[1] - place[1]])
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let size = x.hypot(y);
    if size == 0.0 { [0.0, 0.0] } else { [x / size, y / size] }
}

fn between(from: Polar, to: Polar, share: f64) -> Polar {
    if share == 1.0 {
        return to;
    }
    [0, 1, 2].map(|k| (1.0 - share) * from[k] + share * to[k])
}

/// Nodes inside the core and the rim, each with its neighbours.
fn free(layout: &Layout) -> Vec<(usize, [usize; 4])> {
    let core = |row: usize, column: usize| layout.in_core(row, column);
    let rim = |row: usize, column: usize| layout.in_rim(row, column);
    let beside = layout.profile - layout.depth;
    let mut free = Vec::new();
    for row in 1..=layout.depth {
        for column in 1..layout.core {
            let under = if row == layout.depth { rim(1, beside + column) } else { core(row + 1, column) };
            let neighbours = [core(row - 1, column), under, core(row, column - 1), core(row, column + 1)];
            free.push((core(row, column), neighbours));
        }
    }
    for row in 1..layout.rim {
        for column in 1..layout.width() {
            let neighbours = [rim(row - 1, column), rim(row + 1, column), rim(row, column - 1), rim(row, column + 1)];
            free.push((rim(row, column), neighbours));
        }
    }
    free
}

/// Each node to the mean of its neighbours, the nearer ones counting more.
fn smooth(free: &[(usize, [usize; 4])], arrangement: Arrangement, places: &mut [Polar]) {
    let weights = |(node, neighbours): &(usize, [usize; 4])| {
        let nearness = neighbours.map(|other| 1.0 / arrangement.distance(places[*node], places[other]));
        let sum: f64 = nearness.iter().sum();
        nearness.map(|of| of / sum)
    };
    let weights: Vec<[f64; 4]> = free.iter().map(weights).collect();
    for _ in 0..LAPLACE_STEPS {
        for ((node, neighbours), weights) in free.iter().zip(&weights) {
            let mut mean = [0.0; 3];
            for (other, weight) in neighbours.iter().zip(weights) {
                (0..3).for_each(|k| mean[k] += weight * places[*other][k]);
            }
            places[*node] = mean;
        }
    }
}
