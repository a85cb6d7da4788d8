//! How finely a tooth is cut into bricks.

use crate::solid::arrangement::Polar;
use crate::solid::body::Body;
use crate::solid::bricks::layout;
use crate::solid::bricks::shaft::{Shaft, ShaftCounts};

/// Samples of a line across a chart by which its length is measured.
const SAMPLES: usize = 1024;
/// Bricks across a flank to which the numbers below belong; of twice as many each brick turns and grows half as much.
const USUAL: f64 = 8.0;
/// How far a fillet turns within a brick at the most, rad.
const TURN: f64 = 0.21;
/// By how much a brick below the root is thicker than the one above it.
const GROWTH: f64 = 1.5;
/// The thickness of bricks in the middle of a tooth, of those at a flank.
const GRADING: f64 = 2.25;
/// Rows by which the sides of a tooth may differ in where its core ends: the corners there lose less than by rows that are longer.
const APART: usize = 2;
/// Sections in which the land of a tooth is looked at.
const LANDS: usize = 16;
/// Bricks below the root at the most.
const MOST_BELOW: usize = 256;

/// How many bricks a tooth is cut into.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrickCounts {
    /// Across each chart of a space: as many on one side of its middle as on the other. One in the middle has an even number.
    pub charts: Vec<usize>,
    /// Layers along flanks, fillets and roots.
    pub band: usize,
    /// Between the layers of both flanks.
    pub core: usize,
    /// From the layers of the root to the rest of the outline.
    pub rim: usize,
    /// Along the tooth.
    pub along: usize,
    /// Of a shaft that goes on beyond the teeth, where sections across these end at it.
    pub shaft: Option<ShaftCounts>,
}

impl Body {
    /// So many bricks up a flank, along the tooth, and from flank to flank; others so that they are about as large, and smaller where a fillet
    /// turns. Along the tooth there are at least as many as the rest of the outline has segments.
    ///
    /// # Panics
    /// If there are none up a flank, or fewer than three from flank to flank.
    pub fn brick_counts(&self, counts: [usize; 3]) -> BrickCounts {
        self.counts_above(counts, None)
    }

    /// The same of a blank that goes on beyond its teeth below their root, which has bricks of its own; `None` of others, and where the corners of its
    /// outline leave no room for these.
    ///
    /// # Panics
    /// As that.
    pub fn brick_counts_with_shaft(&self, counts: [usize; 3]) -> Option<BrickCounts> {
        let shaft = Shaft::of_blank(self.blank())?;
        let counts = self.counts_above(counts, Some(&shaft));
        shaft.lattice(counts.shaft?, counts.along, 1).map(|_| counts)
    }

    fn counts_above(&self, [profile, along, thickness]: [usize; 3], shaft: Option<&Shaft<'_>>) -> BrickCounts {
        assert!(profile > 0 && thickness > 2, "a brick up the flank, and three from flank to flank");
        let last = self.charts().len() - 1;
        let finer = profile as f64 / USUAL;
        let measured: Vec<(f64, f64)> = (0..=last).map(|k| length_and_turn(&middle_line(self, k))).collect();
        let flanks = self.flanks();
        let size = 0.5 * flanks.map(|k| measured[k].0).iter().sum::<f64>() / profile as f64;
        let wanted = |k: usize| {
            let (length, turn) = measured[k];
            (length / size).max(turn / TURN * finer).ceil().max(1.0) as usize
        };
        let own: Vec<usize> = (0..=last).map(wanted).collect();
        let mut charts: Vec<usize> = (0..=last).map(|k| own[k].max(own[last - k])).collect();
        flanks.into_iter().for_each(|k| (charts[k], charts[last - k]) = (profile, profile));
        if last.is_multiple_of(2) {
            charts[last / 2] = charts[last / 2].next_multiple_of(2);
        }
        let middle = self.middle_below(shaft);
        let charts = self.parting_alike(charts, &own, middle);
        let band = ((thickness as f64 / 3.0).round() as usize).max(1);
        let least = if shaft.is_some() { 1 } else { self.blank().rest().len() };
        let along = along.max(least).max(1);
        let growth = GROWTH.powf(1.0 / finer);
        let layers = (1.0 + self.depth_below(middle) * (growth - 1.0) / size).ln() / growth.ln();
        let rim = (layers.round() as usize).clamp(2, MOST_BELOW);
        let shaft = shaft.map(|shaft| shaft.counts(along));
        BrickCounts { charts, band, core: thickness - 2 * band, rim, along, shaft }
    }

    /// Counts of charts that are the same on both sides, or with more on each where flanks lean so differently that the core of a tooth would end far
    /// from where the one fillet or the other has turned for it: as many rows above that place on either side, and as many below.
    fn parting_alike(&self, charts: Vec<usize>, own: &[usize], middle: [f64; 2]) -> Vec<usize> {
        let depths = layout::depths(self, &charts, middle);
        if depths[0].abs_diff(depths[1]) < APART {
            return charts;
        }
        let last = charts.len() - 1;
        let at = |side: usize, k: usize| if side == 0 { k } else { last - k };
        // the chart in which it lies, and how many rows of that are above
        let place = |side: usize| {
            let (mut k, mut above) = (0, depths[side]);
            while above > charts[at(side, k)] {
                above -= charts[at(side, k)];
                k += 1;
            }
            (k, above)
        };
        let [(parting, first), (other, second)] = [place(0), place(1)];
        let flanks = self.flanks();
        if parting != other || 2 * parting >= last || parting <= flanks[0] || last - parting >= flanks[1] {
            return charts;
        }
        // of the chart in which that place lies the share below it; as many rows there as either side wants
        let share = |side: usize, above: usize| 1.0 - above as f64 / charts[at(side, parting)] as f64;
        let below = [share(0, first), share(1, second)];
        let wanted = |side: usize| below[side] * own[at(side, parting)] as f64;
        let rows_below = wanted(0).max(wanted(1)).ceil().max(1.0);
        if below.contains(&0.0) {
            return charts;
        }
        let mut charts = charts;
        let mut rows = [0; 2];
        for side in [0, 1] {
            let above = (rows_below / below[side] - rows_below).round() as usize;
            charts[at(side, parting)] = above + rows_below as usize;
            rows[side] = above + (0..parting).map(|k| charts[at(side, k)]).sum::<usize>();
        }
        let most = rows[0].max(rows[1]);
        (0..2).for_each(|side| charts[flanks[side]] += most - rows[side]);
        charts
    }

    /// How wide the land of a tooth is where it is narrowest, mm: 0 where teeth end in an edge.
    pub fn least_land(&self) -> f64 {
        let along: Vec<f64> = (0..=LANDS).map(|k| k as f64 / LANDS as f64).collect();
        let of_tooth = |tooth: usize| {
            let [lines, next] = self.tooth_lines(tooth, &vec![vec![0.0, 1.0]; self.charts().len()], &along);
            let land =
                |(line, next): (&Vec<Polar>, &Vec<Polar>)| self.arrangement.distance(next[0], line[line.len() - 1]);
            lines.iter().zip(&next).map(land).fold(f64::INFINITY, f64::min)
        };
        (0..self.distinct()).map(of_tooth).fold(f64::INFINITY, f64::min)
    }

    /// From the middle of the root to a place below, half-way along, mm.
    fn depth_below(&self, [below_z, below_rho]: [f64; 2]) -> f64 {
        let line = &self.lines(&vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &[0.5])[0];
        let [z, rho, _] = line[line.len() / 2];
        (z - below_z).hypot(rho - below_rho)
    }

    /// A place `[z, rho]` about the middle of the rest of the outline, or of the line above a shaft, whatever the tooth is cut into.
    pub(crate) fn middle_below(&self, shaft: Option<&Shaft<'_>>) -> [f64; 2] {
        let segments = self.blank().rest().len();
        shaft.map_or_else(|| self.blank().below(2 * segments)[segments], Shaft::middle)
    }
}

impl BrickCounts {
    /// What is below the teeth of a body that these are of.
    pub(crate) fn shaft_of<'b>(&self, body: &'b Body) -> Option<Shaft<'b>> {
        self.shaft.and_then(|_| Shaft::of_blank(body.blank()))
    }

    /// How thick the band is beside a tooth, of half the tooth.
    pub(crate) fn band_share(&self) -> f64 {
        let growth = self.band_growth();
        let layers: f64 = (0..self.band).map(|k| growth.powi(k as i32)).sum();
        layers / (layers + 0.5 * self.core as f64 * GRADING)
    }

    fn band_growth(&self) -> f64 {
        GRADING.powf(1.0 / self.band as f64)
    }

    /// Shares of the band's thickness between its layers.
    pub(crate) fn band_shares(&self, steps: usize) -> Vec<f64> {
        refined(&growing(self.band, self.band_growth()), steps)
    }

    /// Shares of the way from the band to the rest of the outline: the first layer as thick as is wanted, of the whole way.
    pub(crate) fn rim_shares(&self, first: f64, steps: usize) -> Vec<f64> {
        refined(&growing(self.rim, growth_from(first, self.rim)), steps)
    }
}

/// Shares between layers each of which is so much thicker than the one before.
fn growing(count: usize, growth: f64) -> Vec<f64> {
    let mut sums = vec![0.0];
    (0..count).for_each(|k| sums.push(sums[k] + growth.powi(k as i32)));
    let whole = sums[count];
    sums.iter().map(|sum| sum / whole).collect()
}

/// By how much each of some layers is thicker than the one before if the first has a share of all; between 1 and 2.
fn growth_from(first: f64, count: usize) -> f64 {
    let share = |growth: f64| 1.0 / (0..count).map(|k| growth.powi(k as i32)).sum::<f64>();
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if share(middle) > first { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// With so many steps between two neighbours.
pub(crate) fn refined(stations: &[f64], steps: usize) -> Vec<f64> {
    let between = |pair: &[f64]| {
        (0..steps).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / steps as f64).collect::<Vec<f64>>()
    };
    let mut fine: Vec<f64> = stations.windows(2).flat_map(between).collect();
    fine.extend(stations.last());
    fine
}

/// Shares across a chart at which it is cut into pieces of one length, half-way along.
pub(crate) fn even_shares(body: &Body, chart: usize, count: usize) -> Vec<f64> {
    let line = middle_line(body, chart);
    let mut sums = vec![0.0];
    line.windows(2).for_each(|pair| sums.push(sums[sums.len() - 1] + apart(pair[0], pair[1])));
    let whole = sums[SAMPLES];
    let share = |k: usize| {
        if k == 0 || k == count {
            return if k == 0 { 0.0 } else { 1.0 };
        }
        let wanted = whole * k as f64 / count as f64;
        let at = sums.partition_point(|sum| *sum < wanted).clamp(1, SAMPLES);
        (at as f64 - (sums[at] - wanted) / (sums[at] - sums[at - 1])) / SAMPLES as f64
    };
    (0..=count).map(share).collect()
}

fn middle_line(body: &Body, chart: usize) -> Vec<[f64; 3]> {
    let shares: Vec<f64> = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64).collect();
    body.charts()[chart].lattice(&shares, &[0.5])
}

/// How long a line is, mm, and by how much it turns, rad.
fn length_and_turn(line: &[[f64; 3]]) -> (f64, f64) {
    let steps: Vec<nalgebra::Vector3<f64>> =
        line.windows(2).map(|pair| nalgebra::Vector3::from(pair[1]) - nalgebra::Vector3::from(pair[0])).collect();
    let length = steps.iter().map(|step| step.norm()).sum();
    (length, steps.windows(2).map(|pair| pair[0].angle(&pair[1])).sum())
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
