//! A blank with tooth spaces, each bounded by charts that share their borders.

use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::blank::Blank;
use crate::solid::chart::Chart;
use crate::solid::section::{Fineness, Layout};

/// Rows of each chart, and columns, at which a body is looked at before it is one.
const LOOKS: usize = 9;
/// The same where it is measured how far it goes through its blank.
const FINE_LOOKS: usize = 65;
/// Rows of a land's chart: enough for half a turn.
const LAND_ROWS: usize = 17;
/// How far a space may reach beyond its blank, and how thin a wall is none, mm: rounding of solved points.
const ON_BLANK: f64 = 1e-6;
/// How much of a section may fold over where an edge lies a little beside the top, as a share: what a mesh of 10 um leaves out of a small gear.
const FOLD: f64 = 0.01;
/// Places nearer to the axis lie on it, mm: rounding of arcs that end there.
pub(crate) const ON_AXIS: f64 = 1e-9;

/// A body of revolution with tooth spaces about its z axis, or a bar with tooth spaces along y.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub(crate) blank: Blank,
    pub(crate) arrangement: Arrangement,
    pub(crate) teeth: u32,
    /// The charts of the first space, where all are alike; else of each space, which all have as many.
    pub(crate) spaces: Vec<Vec<Chart>>,
    /// Whether the charts run against the order that they were given in.
    pub(crate) is_reversed: bool,
    /// Whether the last chart of a space ends in the line where the first one of the next space begins: an edge, and no land.
    pub(crate) has_edge: bool,
}

/// Why charts bound no body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyFault {
    /// The flanks of a tooth meet before the tip.
    Pointed {
        /// How far they reach into each other at the tip, mm.
        overlap: f64,
        /// How far that is from begin to end of the spaces, as a share.
        share: f64,
        /// Of the teeth that differ from each other, how many are pointed, and how many there are.
        teeth: [usize; 2],
        /// Whether all are, all along.
        is_whole: bool,
    },
    /// Neighbouring spaces run into each other below the tip.
    Overlap {
        /// How far, mm.
        overlap: f64,
        /// The distance from the axis, mm.
        rho: f64,
    },
    /// The line across a space crosses itself.
    Crossed {
        /// The charts that cross each other, in the order that they were given in.
        charts: [usize; 2],
        /// Where, `[z, rho]`, mm.
        place: [f64; 2],
    },
    /// The edge in which teeth end lies so far beside their top that what is between folds over it.
    BesideTop {
        /// How far below the top it lies, mm.
        below: f64,
        /// How far beside it, about the axis in radians, or along the bar in mm.
        beside: f64,
        /// Where, `[z, rho]`, mm.
        place: [f64; 2],
    },
    /// A space goes through the blank.
    Through {
        /// The segment of the outline, as an index.
        segment: usize,
        /// How far beyond it at the most, mm.
        by: f64,
    },
    /// A space reaches the rest of the blank, and leaves no wall there.
    NoWall {
        /// The segment of the outline, as an index.
        segment: usize,
        /// Where, `[z, rho]`, mm.
        place: [f64; 2],
    },
}

impl Body {
    /// Of the charts of one space, from one flank to the other, or of those of every space: across from the tip to the tip, along from the
    /// beginning of the spaces to their end. Neighbours have the same points in the rows that they share, but for rounding. With `has_edge` the
    /// last row of the last chart is the first one of the first chart in the next space.
    ///
    /// # Panics
    /// If there are neither the charts of one space nor those of all, or if the ends of the blank do not follow each other.
    ///
    /// # Errors
    /// If teeth are pointed below the tip, spaces overlap or cross themselves, or a space goes through the blank or leaves no wall of it.
    pub fn new(
        blank: Blank,
        (arrangement, teeth): (Arrangement, u32),
        mut spaces: Vec<Vec<Chart>>,
        has_edge: bool,
    ) -> Result<Body, BodyFault> {
        assert!(spaces.len() == 1 || spaces.len() == teeth as usize, "one space, or all");
        let [begin, tip, end] = blank.bounds();
        let is_near = |from: [f64; 2], to: [f64; 2]| (from[0] - to[0]).hypot(from[1] - to[1]) <= ON_BLANK;
        assert!(is_near(begin.to, tip.from) && is_near(tip.to, end.from), "begin, tip and end follow each other");
        for charts in &mut spaces {
            for k in 1..charts.len() {
                let border = charts[k - 1].row(charts[k - 1].counts()[0] - 1).to_vec();
                charts[k] = charts[k].clone().with_row(0, &border);
            }
        }
        let mut body = Body { blank, arrangement, teeth, spaces, is_reversed: false, has_edge };
        let middle = body.lines(&vec![Body::looks(); body.charts().len()], &[0.5]).remove(0);
        if middle.last().map_or(0.0, |end| end[2]) < middle[0][2] {
            let turned = |charts: &Vec<Chart>| charts.iter().rev().map(Chart::reversed).collect();
            body = Body { spaces: body.spaces.iter().map(turned).collect(), is_reversed: true, ..body };
        }
        if body.spaces.len() > 2 && arrangement.near(body.middle(1), body.middle(0)) < body.middle(0) {
            body.spaces[1..].reverse();
        }
        if has_edge {
            body.share_edges();
        }
        body.checked()
    }

    fn looks() -> Vec<f64> {
        (0..LOOKS).map(|k| k as f64 / (LOOKS - 1) as f64).collect()
    }

    /// The last row of each space becomes the first one of the next.
    fn share_edges(&mut self) {
        for space in 0..self.spaces.len() {
            let next: Vec<[f64; 3]> =
                self.charts_behind(space)[0].row(0).iter().map(|point| self.in_next(*point)).collect();
            let charts = &mut self.spaces[space];
            let last = charts.len() - 1;
            let row = charts[last].counts()[0] - 1;
            charts[last] = charts[last].clone().with_row(row, &next);
        }
    }

    /// The charts of the space behind one, which [`Body::in_next`] brings there.
    fn charts_behind(&self, space: usize) -> &[Chart] {
        &self.spaces[(space + 1) % self.spaces.len()]
    }

    /// A point of the space behind one, as that has it, where it is.
    pub(crate) fn in_next(&self, point: [f64; 3]) -> [f64; 3] {
        if self.spaces.len() == 1 { self.arrangement.moved(point, self.pitch()) } else { point }
    }

    /// The angle in the middle of a space, half-way along, as it is found.
    fn middle(&self, space: usize) -> f64 {
        let line = self.lines_of(space, &vec![Body::looks(); self.charts().len()], &[0.5]).remove(0);
        line[line.len() / 2][2]
    }

    fn checked(self) -> Result<Body, BodyFault> {
        let shares = Body::looks();
        let across = vec![shares.clone(); self.charts().len()];
        let teeth: Vec<[Vec<Vec<Polar>>; 2]> =
            (0..self.spaces.len()).map(|tooth| self.tooth_lines(tooth, &across, &shares)).collect();
        self.check_tips(&teeth, &shares)?;
        for (tooth, [own, next]) in teeth.iter().enumerate() {
            self.check_folds([own, next])?;
            self.check_crossings(own)?;
            for (line, next) in own.iter().zip(next) {
                let last = line.len() - 1;
                for i in 1..line.len() / 2 {
                    let overlap = -self.tooth_width(next[i], line[last - i]);
                    if overlap >= 0.0 {
                        return Err(BodyFault::Overlap { overlap, rho: next[i][1].max(line[last - i][1]) });
                    }
                }
                for place in line.iter().map(|[z, rho, _]| [*z, *rho]) {
                    if self.beyond(place).is_some() {
                        return Err(self.through(tooth));
                    }
                    if let Some(segment) = self.blank.rest_at(place, ON_BLANK) {
                        return Err(BodyFault::NoWall { segment, place });
                    }
                }
            }
        }
        Ok(self)
    }

    /// How far a place `[z, rho]` lies outside the blank, and beyond which segment.
    fn beyond(&self, place: [f64; 2]) -> Option<(usize, f64)> {
        self.blank.outline.beyond(place).filter(|(_, by)| *by > ON_BLANK)
    }

    /// Where a space goes through the blank the farthest.
    fn through(&self, space: usize) -> BodyFault {
        let shares: Vec<f64> = (0..FINE_LOOKS).map(|k| k as f64 / (FINE_LOOKS - 1) as f64).collect();
        let lines = self.lines_of(space, &vec![shares.clone(); self.charts().len()], &shares);
        let places = lines.iter().flatten().filter_map(|[z, rho, _]| self.beyond([*z, *rho]));
        let farthest = places.max_by(|a, b| a.1.total_cmp(&b.1)).expect("it goes through at one of these places");
        BodyFault::Through { segment: farthest.0, by: farthest.1 }
    }

    /// Each line across a space bounds it only if it does not cross itself.
    fn check_crossings(&self, lines: &[Vec<Polar>]) -> Result<(), BodyFault> {
        for line in lines {
            let [tip, ground] = [line[0], line[line.len() / 2]];
            let down = [ground[0] - tip[0], ground[1] - tip[1]];
            let depth = down[0].hypot(down[1]);
            let flat = |[z, rho, way]: Polar| {
                let depth = ((z - tip[0]) * down[0] + (rho - tip[1]) * down[1]) / depth;
                [depth, way * self.arrangement.arc(tip[1])]
            };
            let flat: Vec<[f64; 2]> = line.iter().map(|place| flat(*place)).collect();
            if let Some(([i, j], share)) = crossing(&flat) {
                let charts = [i, j].map(|step| {
                    let chart = step / (LOOKS - 1);
                    if self.is_reversed { self.charts().len() - 1 - chart } else { chart }
                });
                let place = [0, 1].map(|k| (1.0 - share) * line[i][k] + share * line[i + 1][k]);
                return Err(BodyFault::Crossed { charts, place });
            }
        }
        Ok(())
    }

    /// Where teeth end in an edge, each section of a tooth has to be laid out without folds: a part of it that lies above the edge, beside it,
    /// folds over it.
    fn check_folds(&self, [own, next]: [&[Vec<Polar>]; 2]) -> Result<(), BodyFault> {
        if !self.has_edge {
            return Ok(());
        }
        let cells = LOOKS - 1;
        let fineness =
            Fineness { charts: vec![cells; self.charts().len()], tooth: cells, rim: 1, along: cells, arc: 1 };
        let layout = Layout::new(&fineness);
        let (half, below) = (LOOKS / 2, self.blank.below(cells));
        let shares = layout.shares(&layout.top([&own[half], &next[half]]), self.arrangement);
        for j in 0..LOOKS {
            let (line, tip, down) = (&own[j], own[j][own[j].len() - 1], below[j]);
            let down = [down[0] - tip[0], down[1] - tip[1]];
            let depth = |place: Polar| (place[0] - tip[0]) * down[0] + (place[1] - tip[1]) * down[1];
            let places = layout.places([line, &next[j]], below[j], &shares);
            let area = |[a, b, c]: [usize; 3]| {
                let [a, b, c] = [a, b, c].map(|node| [places[node][2], depth(places[node])]);
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            // of a cell what turns back, by the better of its diagonals, and all of it
            let of_cell = |[a, b, c, d]: &[usize; 4]| {
                let halves = [[[*a, *b, *c], [*a, *c, *d]], [[*a, *b, *d], [*b, *c, *d]]];
                let back = halves.map(|of| of.iter().map(|corners| -area(*corners).min(0.0)).sum::<f64>());
                [back[0].min(back[1]), halves[0].iter().map(|corners| area(*corners)).sum()]
            };
            let sums = layout.cells().iter().map(of_cell).fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
            if sums[0] > FOLD * sums[1] {
                return Err(self.beside_top([line, &next[j]], j));
            }
        }
        Ok(())
    }

    /// How far the edge behind a space lies beside the top of the tooth, in a section.
    fn beside_top(&self, [line, next]: [&[Polar]; 2], section: usize) -> BodyFault {
        let edge = line[line.len() - 1];
        let tip = self.blank.tip(section as f64 / (LOOKS - 1) as f64);
        let off = |place: &Polar| (place[0] - tip[0]).hypot(place[1] - tip[1]);
        let tooth = line[line.len() / 2..].iter().chain(&next[..next.len() / 2]);
        let top = tooth.min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or(edge);
        BodyFault::BesideTop {
            below: off(&edge) - off(&top),
            beside: (top[2] - edge[2]).abs(),
            place: [edge[0], edge[1]],
        }
    }

    /// All teeth have lands, or end in edges; where spaces differ some may be pointed and others not.
    fn check_tips(&self, teeth: &[[Vec<Vec<Polar>>; 2]], shares: &[f64]) -> Result<(), BodyFault> {
        if self.has_edge {
            return Ok(());
        }
        let overlaps = |[own, next]: &[Vec<Vec<Polar>>; 2]| -> Vec<f64> {
            own.iter().zip(next).map(|(line, next)| -self.tooth_width(next[0], line[line.len() - 1])).collect()
        };
        let overlaps: Vec<Vec<f64>> = teeth.iter().map(overlaps).collect();
        let overlap_at = |(k, overlap): (usize, &f64)| (*overlap, shares[k]);
        let all = overlaps.iter().flat_map(|of_tooth| of_tooth.iter().enumerate().map(overlap_at));
        match all.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((overlap, share)) if overlap >= 0.0 => {
                let is_pointed = |of_tooth: &&Vec<f64>| of_tooth.iter().any(|overlap| *overlap >= 0.0);
                let is_whole = overlaps.iter().flatten().all(|overlap| *overlap >= 0.0);
                let teeth = [overlaps.iter().filter(is_pointed).count(), overlaps.len()];
                Err(BodyFault::Pointed { overlap, share, teeth, is_whole })
            }
            _ => Ok(()),
        }
    }

    /// How wide the tooth is between a place on the lower side of the space behind it and one on the upper side of the space before it.
    fn tooth_width(&self, behind: Polar, before: Polar) -> f64 {
        (behind[2] - before[2]) * self.arrangement.arc(0.5 * (behind[1] + before[1]))
    }

    /// Whether teeth end in an edge, and not in a land of the blank.
    pub fn has_edge(&self) -> bool {
        self.has_edge
    }

    /// Whether its blank goes as far as the axis, as that of a shaft does.
    pub fn reaches_axis(&self) -> bool {
        let is_on_axis = |[_, rho]: [f64; 2]| rho.abs() < ON_AXIS;
        self.arrangement.is_closed() && self.blank.outline.segments().iter().any(|segment| is_on_axis(segment.from))
    }

    /// How the spaces follow each other.
    pub fn arrangement(&self) -> Arrangement {
        self.arrangement
    }

    /// From a tooth to the next, on average where they differ: an angle, or a length.
    pub fn pitch(&self) -> f64 {
        self.arrangement.pitch(self.teeth)
    }

    /// How many teeth.
    pub fn teeth(&self) -> u32 {
        self.teeth
    }

    /// How many teeth differ from each other: all, or one.
    pub fn distinct(&self) -> usize {
        self.spaces.len()
    }

    /// How far the way to a tooth is from that of its kind: nothing where all differ.
    pub(crate) fn way_of(&self, tooth: usize) -> f64 {
        if self.spaces.len() == 1 { tooth as f64 * self.pitch() } else { 0.0 }
    }

    /// The blank.
    pub fn blank(&self) -> &Blank {
        &self.blank
    }

    /// The charts of the first space, in the order of the angle.
    pub fn charts(&self) -> &[Chart] {
        &self.spaces[0]
    }

    /// The charts of every space that differs from the first one, and of that.
    pub fn spaces(&self) -> &[Vec<Chart>] {
        &self.spaces
    }

    /// Whether the charts run against the order that they were given in.
    pub fn is_reversed(&self) -> bool {
        self.is_reversed
    }

    /// The land of the tooth behind a space as a chart: across from the last row of the space to the first row of the next, along as
    /// they are. Nothing where teeth end in an edge.
    pub fn land(&self, space: usize) -> Option<Chart> {
        if self.has_edge {
            return None;
        }
        let columns = self.charts()[0].counts()[1];
        let along = Chart::shares(columns);
        let [lines, next] = self.tooth_lines(space, &vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &along);
        let place = |across: f64, j: usize| {
            let [z, rho] = self.blank.tip(along[j]);
            let (from, to) = (lines[j][lines[j].len() - 1][2], next[j][0][2]);
            self.arrangement.position([z, rho, (1.0 - across) * from + across * to])
        };
        let points = Chart::shares(LAND_ROWS).into_iter().flat_map(|across| (0..columns).map(move |j| (across, j)));
        let chart = Chart::through(points.map(|(across, j)| place(across, j)).collect(), [LAND_ROWS, columns]);
        let own = &self.spaces[space];
        let last = &own[own.len() - 1];
        let chart = chart.with_row(0, last.row(last.counts()[0] - 1));
        let next = self.charts_behind(space)[0].row(0).iter().map(|point| self.in_next(*point));
        Some(chart.with_row(LAND_ROWS - 1, &next.collect::<Vec<[f64; 3]>>()))
    }

    /// Lines across the first space.
    pub(crate) fn lines(&self, across: &[Vec<f64>], along: &[f64]) -> Vec<Vec<Polar>> {
        self.lines_of(0, across, along)
    }

    /// Lines across the spaces before a tooth and behind it, one of those that [`Body::distinct`] counts: the angle grows from tooth to tooth.
    pub(crate) fn tooth_lines(&self, tooth: usize, across: &[Vec<f64>], along: &[f64]) -> [Vec<Vec<Polar>>; 2] {
        let count = self.spaces.len();
        let own = self.lines_of(tooth, across, along);
        if count == 1 {
            let next = own.iter().map(|line| line.iter().map(|place| shifted(*place, self.pitch())).collect());
            let next = next.collect();
            return [own, next];
        }
        let middle = |lines: &[Vec<Polar>]| lines[lines.len() / 2][lines[0].len() / 2][2];
        let mut next = self.lines_of((tooth + 1) % count, across, along);
        let (from, to) = (middle(&own), middle(&next));
        let by = self.arrangement.near(to, from + self.pitch()) - to;
        next.iter_mut().flatten().for_each(|place| *place = shifted(*place, by));
        [own, next]
    }

    /// Lines across a space, from tip to tip, at shares of the way along: of each chart the points at shares across, the border of two
    /// once. The angle grows from the first point to the last, and does not jump from line to line.
    fn lines_of(&self, space: usize, across: &[Vec<f64>], along: &[f64]) -> Vec<Vec<Polar>> {
        let lattices: Vec<(usize, Vec<[f64; 3]>)> = self.spaces[space]
            .iter()
            .zip(across)
            .enumerate()
            .map(|(k, (chart, shares))| {
                let first = usize::from(k > 0 && shares[0] == 0.0);
                (shares.len() - first, chart.lattice(&shares[first..], along))
            })
            .collect();
        let columns = along.len();
        let rows: usize = lattices.iter().map(|(rows, _)| rows).sum();
        let mut before: Option<f64> = None;
        let mut line = |j: usize| {
            let points = lattices.iter().flat_map(|(rows, lattice)| (0..*rows).map(move |i| lattice[i * columns + j]));
            let mut line: Vec<Polar> = points.map(|point| self.arrangement.place(point)).collect();
            let middle = rows / 2;
            line[middle][2] = before.map_or(line[middle][2], |before| self.arrangement.near(line[middle][2], before));
            before = Some(line[middle][2]);
            for i in middle + 1..rows {
                line[i][2] = self.arrangement.near(line[i][2], line[i - 1][2]);
            }
            for i in (0..middle).rev() {
                line[i][2] = self.arrangement.near(line[i][2], line[i + 1][2]);
            }
            line
        };
        (0..columns).map(&mut line).collect()
    }
}

/// The first two steps of a line that cross each other, and where on the first one, as a share.
fn crossing(line: &[[f64; 2]]) -> Option<([usize; 2], f64)> {
    let side = |[p, q]: [[f64; 2]; 2], at: [f64; 2]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
    let step = |k: usize| [line[k], line[k + 1]];
    let parts = |of: usize, other: usize| step(other).map(|at| side(step(of), at)).into_iter().product::<f64>() < 0.0;
    let later = |i: usize| (i + 2..line.len() - 1).map(move |j| [i, j]);
    let [i, j] = (0..line.len() - 1).flat_map(later).find(|[i, j]| parts(*i, *j) && parts(*j, *i))?;
    let [from, to] = step(i).map(|at| side(step(j), at));
    Some(([i, j], from / (from - to)))
}

/// A place farther on along the spaces.
pub(crate) fn shifted([z, rho, way]: Polar, by: f64) -> Polar {
    [z, rho, way + by]
}
