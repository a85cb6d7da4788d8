//! A pair with a milled flank: where it touches the mate, and how evenly the pair turns then.
//!
//! The gap g(x, lag) from the generated flank to its mate grows with the lag, and the milled flank is higher by h(x). So a pair of teeth
//! stands where the largest of all lags is that brings g down to h. On a ridge h has a kink, from which it falls to both sides faster
//! than the gap grows: the places are looked for on the ridges. What one pass leaves is smooth: they are looked for on rows, and between them.

use flank_draw::{DrawnContact, MilledPairDrawing, PassChart};
use flank_export::text::shown_unit;
use flank_export::{Axis, Field, Header, Layout, Outcome as Written, Patch, Point, Values, fixed};
use flank_solver::{ContactPoint, Gap, GapProblem, Outcome, RollingPair, SurfacePoint};
use rayon::prelude::*;

use crate::contact::drawn::FILMS;
use crate::contact::pair::Members;
use crate::contact::pattern::{reach_of, reach_of_film};
use crate::contact::place::{fine, fine_unit};
use crate::contact::result::{MilledContact, MilledPattern};
use crate::contact::rolling::Rolling;
use crate::convert::milling::flank::{Crest, MilledFlank, MilledPlace};
use crate::project::units;

/// Places of each crest from which the highest against the mate is looked for.
const COLUMNS: usize = 21;
/// Roll positions while the contact goes over one ridge.
const PER_RIDGE: f64 = 8.0;
const MOST_PARTS: isize = 40;
/// Crests on which it is looked for at each roll position.
const TRIED: usize = 3;
/// How far apart places are among which the highest is looked for, in columns or rows, again and again.
const APART: [f64; 3] = [0.5, 0.125, 0.03125];
/// The ridges beside the contact, in passes, are looked at too.
const BESIDE: f64 = 2.0;
/// By how much the lag is changed to see how the gap follows, mm along the normal.
const OPENED: f64 = 1e-3;
/// A gap this much below zero is none, um.
const ROUNDING: f64 = 1e-3;
/// Columns of the pattern, and rows at the most.
const PATTERN_COLUMNS: usize = 41;
const PATTERN_ROWS: usize = 241;

/// A pair whose one flank is milled.
pub(crate) struct MilledPair {
    pub(crate) result: MilledContact,
    /// Roll positions, and by how much of the unknown the milled pair is ahead of the generated one there.
    pub(crate) ahead: Vec<(f64, f64)>,
    /// The points of passes and ridges with the least gaps of the generated and of the milled flank.
    pub(crate) patches: [Patch; 2],
    pub(crate) drawing: MilledPairDrawing,
}

/// A place of a crest: which, the share along it, and how far it is ahead.
type Place = (usize, f64, f64);

/// A roll position at which the pair of teeth that the others are told by is near to its mate.
struct Position {
    /// Counted in parts of a step.
    number: isize,
    roll: f64,
    /// The composite lag of the generated pair.
    lag: f64,
    own: ContactPoint,
}

impl Position {
    /// Roll and composite lag, then the same with the flanks opened a little.
    fn opened(&self) -> [[f64; 2]; 2] {
        [[self.roll, self.lag], [self.roll, self.lag + OPENED / self.own.opening]]
    }

    /// By how much the lag goes beyond the composite one where a place of this height touches, from the gaps of both: these change evenly over
    /// some um. `None` where opening does not open there.
    fn ahead(&self, height: f64, [near, opened]: [f64; 2]) -> Option<f64> {
        let rate = (opened - near) * self.own.opening.abs() / OPENED;
        (rate > 0.0).then(|| (height - near) / rate)
    }
}

/// What the search for the places works with.
struct Search<'a> {
    flank: &'a MilledFlank,
    /// From points of the flank to its mate, of which these are points.
    gaps: GapProblem,
    mate: &'a [SurfacePoint],
    /// Points of the flank itself, beyond the milled part, too.
    own: &'a [SurfacePoint],
    /// How far away it is looked for, mm.
    reach: f64,
    /// Which of both members is milled, its surface and its frame.
    member: usize,
    surface: &'a str,
    frame: &'a str,
}

/// A point of the flank as gaps are asked for.
fn node([x, y, z, nx, ny, nz]: [f64; 6]) -> SurfacePoint {
    SurfacePoint {
        outcome: Outcome::Solved,
        unknowns: Vec::new(),
        position: [x, y, z],
        normal: [nx, ny, nz],
        residual: 0.0,
    }
}

/// Rolls a contact with a milled flank beside the generated one.
pub(crate) fn rolled<'j, 'g>(
    (members, member): (&Members<'j, 'g>, usize),
    (pair, rolling): (&RollingPair<'_, 'g>, &Rolling),
    (flank, milling): (&MilledFlank, &str),
    (compound, shown, header): (f64, &DrawnContact, Header),
) -> MilledPair {
    let gaps = GapProblem::new(pair, member).expect("a job without errors leaves nothing unbound");
    let surface = members.surfaces[member];
    let search = Search {
        flank,
        gaps,
        mate: &members.points[1 - member],
        own: &members.points[member],
        reach: reach_of(rolling, members.teeth()),
        member,
        surface: &surface.name,
        frame: &surface.frame,
    };
    let parts = search.parts(rolling);
    let positions = positions(rolling, parts, reach_of_film(compound));
    let own = search.ahead(&positions);
    let pitch = rolling.engagement.steps as isize * parts;
    // all pairs of teeth do the same, a pitch later
    let composite = |number: isize| {
        let alike = positions.iter().zip(&own).filter(|(position, _)| match rolling.has_pitch {
            true => (position.number - number) % pitch == 0,
            false => position.number == number,
        });
        alike.filter_map(|(_, ahead)| *ahead).reduce(f64::max)
    };
    let reference = rolling.middle().map_or(0.0, |middle| middle.lag);
    let steps = rolling.steps();
    let within = |position: &&Position| (steps.start * parts..=steps.end * parts).contains(&position.number);
    let (lag, roll) = (&members.contact.lag, &members.contact.roll);
    let (mut rows, mut all_ahead): (Vec<[f64; 4]>, Vec<(f64, f64)>) = (Vec::new(), Vec::new());
    for position in positions.iter().filter(within) {
        let Some(ahead) = composite(position.number) else { continue };
        let milled = position.lag + position.own.opening.signum() * ahead;
        let at = units::shown(roll.dimension, position.roll);
        let [generated, milled] = [position.lag, milled].map(|lag_at| fine(lag.dimension, lag_at - reference));
        rows.push([at, generated, milled, fine(lag.dimension, ahead)]);
        all_ahead.push((position.roll, ahead));
    }
    let whole: Vec<([f64; 2], [f64; 2])> = positions
        .iter()
        .filter(|position| position.number % parts == 0)
        .filter_map(|position| {
            let milled = position.lag + position.own.opening.signum() * composite(position.number)?;
            Some(([position.roll, position.lag], [position.roll, milled]))
        })
        .collect();
    let (patches, patterns) = search.pattern(&whole, compound);
    let spread = |k: usize| {
        let ends = rows.iter().map(|row| [row[k], row[k]]).reduce(|[a, b], [c, _]| [a.min(c), b.max(c)]);
        ends.unwrap_or([f64::NAN; 2])
    };
    let openings = positions.iter().map(|position| position.own.opening.abs());
    let lever = openings.reduce(f64::min).unwrap_or(f64::NAN);
    let [of_generated, of_milled] = [1, 2].map(|k| spread(k)[1] - spread(k)[0]);
    let result = MilledContact {
        milling: milling.to_string(),
        surface: surface.name.clone(),
        has_one_pass: flank.has_one_pass(),
        ridge_um: 1e3 * flank.ends()[0],
        least_um: 1e3 * flank.ends()[1],
        unit: fine_unit(lag.dimension).to_string(),
        peak_to_peak: of_milled,
        generated_peak_to_peak: of_generated,
        ahead: spread(3),
        at_most: fine(lag.dimension, (flank.ends()[0] + flank.stock()) / lever),
        patterns,
        rolls: rows.iter().map(|row| row[0]).collect(),
        generated: rows.iter().map(|row| row[1]).collect(),
        milled: rows.iter().map(|row| row[2]).collect(),
    };
    let curve = |k: usize| rows.iter().map(|row| [row[0], row[k]]).collect::<Vec<[f64; 2]>>();
    let unit = shown_unit(&result.unit);
    let chart = |title: &str, about: &str, curves: Vec<(String, Vec<[f64; 2]>)>| PassChart {
        title: title.to_string(),
        about: about.to_string(),
        over: shown.error.over.clone(),
        unit: result.unit.clone(),
        curves,
        limits: Vec::new(),
    };
    let named = |what: &str, size: f64, k: usize| (format!("{what}, {} {unit} peak to peak", fixed(size, 2)), curve(k));
    let errors = vec![named("generated", of_generated, 1), named("milled", of_milled, 2)];
    let away = vec![(format!("at most {} {unit}", fixed(spread(3)[1], 2)), curve(3))];
    let film = 1e3 * compound;
    let drawing = MilledPairDrawing {
        header,
        title: format!("{}: {} as {milling} mills it", shown.name, result.surface),
        note: format!(
            "Least gap over the mesh of a pair of teeth, up to {FILMS} films of {film} \u{b5}m, on the part of the flank that comes so near; \
             white: the edge of the film, red: the path of contact of the generated pair. Errors are from that of its middle."
        ),
        film,
        flanks: cropped(&patches, FILMS * film),
        path: shown.flanks[member].path.iter().map(|(_, line)| line.clone()).collect(),
        charts: vec![
            chart("error over a pitch", "of the generated and of the milled pair", errors),
            chart("what is left adds", "by how much it holds the driven member away", away),
        ],
    };
    MilledPair { result, ahead: all_ahead, patches, drawing }
}

/// The rows and columns of both in which one of them has a gap up to `most`, and those beside them; gaps are no wider there than that.
fn cropped(patches: &[Patch; 2], most: f64) -> [Patch; 2] {
    let [rows, columns] = [patches[0].rows.count, patches[0].columns.count];
    let gap = |patch: &Patch, at: usize| match &patch.fields[0].values {
        Values::Scalars(values) => values.at(at),
        Values::Vectors(_) => None,
    };
    let is_near = |at: &usize| patches.iter().any(|patch| gap(patch, *at).is_some_and(|gap| gap <= most));
    let near: Vec<usize> = (0..rows * columns).filter(is_near).collect();
    let range = |of: &dyn Fn(usize) -> usize, count: usize| {
        let (low, high) = (near.iter().map(|at| of(*at)).min(), near.iter().map(|at| of(*at)).max());
        (low.unwrap_or(0).saturating_sub(1), (high.unwrap_or(count - 1) + 2).min(count))
    };
    let ((top, bottom), (left, right)) = (range(&|at| at / columns, rows), range(&|at| at % columns, columns));
    patches.each_ref().map(|patch| {
        let kept: Vec<usize> =
            (top..bottom).flat_map(|row| (left..right).map(move |column| row * columns + column)).collect();
        // below zero only by rounding of the place along a ridge
        let shown = |gap: f64| if gap > -ROUNDING { gap.clamp(0.0, most) } else { gap };
        let gaps = kept.iter().map(|at| gap(patch, *at).map(shown)).collect();
        let axis = |label: &str, count: usize| Axis { label: label.to_string(), count };
        Patch {
            rows: axis("profilewise", bottom - top),
            columns: axis("lengthwise", right - left),
            points: kept.iter().map(|at| patch.points[*at].clone()).collect(),
            fields: vec![field("gap", "least distance to the mate along the normal, over the mesh", gaps)],
            ..patch.clone()
        }
    })
}

/// Roll positions at which the pair of teeth is near, each step in parts.
fn positions(rolling: &Rolling, parts: isize, reach: f64) -> Vec<Position> {
    let steps = rolling.all_steps();
    let Some(middle) = rolling.middle() else { return Vec::new() };
    let step = rolling.engagement.pitch / (rolling.engagement.steps as f64 * parts as f64);
    let numbers = steps.start * parts..=(steps.end - 1) * parts;
    let position = |number: isize| {
        let roll = middle.roll + number as f64 * step;
        let own = rolling.problem.pair_at(&rolling.engagement, 0, roll)?;
        let lag = if rolling.has_pitch { rolling.lag_at(roll)? } else { own.lag };
        (((lag - own.lag) * own.opening).abs() <= reach).then_some(Position { number, roll, lag, own })
    };
    numbers.into_par_iter().filter_map(position).collect()
}

impl Search<'_> {
    /// In how many parts steps of the roll are cut, so that the error shows each ridge.
    fn parts(&self, rolling: &Rolling) -> isize {
        let points = &rolling.engagement.points;
        let places = points.iter().filter_map(|point| self.flank.place(point.in_members[self.member]));
        let ends = places.map(|place| [place[0], place[0]]).reduce(|[a, b], [c, _]| [a.min(c), b.max(c)]);
        let crossed = ends.map_or(0.0, |[low, high]| (high - low) * (self.flank.passes() - 1) as f64);
        ((PER_RIDGE * crossed / points.len() as f64).ceil() as isize).clamp(1, MOST_PARTS)
    }

    /// By how much the lag of the pair of teeth goes beyond the composite one of the generated pair, in the direction that opens.
    fn ahead(&self, positions: &[Position]) -> Vec<Option<f64>> {
        let along = |column: usize| column as f64 / (COLUMNS - 1) as f64;
        let solved = self.own.iter().filter(|point| point.outcome == Outcome::Solved);
        let crests = self.flank.crests(solved.map(|point| point.position));
        let of_crest = |crest: &Crest| (0..COLUMNS).map(|column| self.flank.place_of(*crest, along(column))).collect();
        let places: Vec<Vec<Option<MilledPlace>>> = crests.par_iter().map(of_crest).collect();
        let known: Vec<(usize, usize, &MilledPlace)> = places
            .iter()
            .enumerate()
            .flat_map(|(crest, row)| row.iter().enumerate().map(move |(column, place)| (crest, column, place)))
            .filter_map(|(crest, column, place)| Some((crest, column, place.as_ref()?)))
            .collect();
        let nodes: Vec<SurfacePoint> = known.iter().map(|(_, _, place)| node(place.line)).collect();
        let [near, opened] = [0, 1].map(|k| {
            let at: Vec<[f64; 2]> = positions.iter().map(|position| position.opened()[k]).collect();
            self.gaps.each(&nodes, &at, self.mate, self.reach)
        });
        let of_position = |(k, position): (usize, &Position)| {
            let ahead = |(place, (crest, column, at)): (usize, &(usize, usize, &MilledPlace))| {
                let ahead = position.ahead(at.height, [near[place][k]?, opened[place][k]?])?;
                Some((*crest, along(*column), ahead))
            };
            let places: Vec<Place> = known.iter().enumerate().filter_map(ahead).collect();
            // of each crest the highest place by the parabola through its columns
            let highest = |row: &[Place]| {
                let most = (0..row.len()).max_by(|a, b| row[*a].2.total_cmp(&row[*b].2)).unwrap_or_default();
                let three = row.get(most.wrapping_sub(1)..=most + 1).unwrap_or_default();
                let three: Vec<[f64; 2]> = three.iter().map(|at| [at.1, at.2]).collect();
                let (share, ahead) = vertex(&three).unwrap_or((row[most].1, row[most].2));
                (row[most].0, share, ahead)
            };
            let highest: Vec<Place> = places.chunk_by(|a, b| a.0 == b.0).map(highest).collect();
            let tried = self.tried(&crests, &highest, position).into_iter();
            let on_crests = tried.map(|place| match crests[place.0] {
                Crest::Row(row) => self.highest_beside(row, &highest, position),
                crest => self.highest_on(crest, (place.1, place.2), position).1,
            });
            on_crests.chain([self.at_contact(position)]).reduce(f64::max)
        };
        positions.par_iter().enumerate().map(of_position).collect()
    }

    /// Of the highest places of the crests those that are worth a closer look: those that look highest, and of ridges those beside the contact.
    /// A row that stands lower than one beside it leads to the same place.
    fn tried(&self, crests: &[Crest], highest: &[Place], position: &Position) -> Vec<Place> {
        let beside = self.flank.place(position.own.in_members[self.member]).map_or(0.0, |place| place[0]);
        let nearest = self.flank.number_at(beside);
        let is_peak = |k: &usize| {
            let is_higher = |other: Option<&Place>| other.is_some_and(|other| other.2 > highest[*k].2);
            let is_row = matches!(crests[highest[*k].0], Crest::Row(_));
            !is_row || !is_higher(highest.get(k + 1)) && !is_higher(k.checked_sub(1).map(|before| &highest[before]))
        };
        let mut peaks: Vec<Place> = (0..highest.len()).filter(is_peak).map(|k| highest[k]).collect();
        peaks.sort_by(|a, b| b.2.total_cmp(&a.2));
        let is_tried = |(rank, place): &(usize, &Place)| {
            let is_beside = match crests[place.0] {
                Crest::Ridge(after) => (after as f64 - nearest).abs() <= BESIDE,
                Crest::Row(_) | Crest::Border { .. } => false,
            };
            *rank < TRIED || is_beside
        };
        peaks.iter().enumerate().filter(is_tried).map(|(_, place)| *place).collect()
    }

    /// Where the generated flanks touch, with what is left there; beside the milled part the flank is as generated.
    fn at_contact(&self, position: &Position) -> f64 {
        let own = &position.own;
        let left = self.flank.left(own.in_members[self.member]).unwrap_or(0.0);
        (own.lag - position.lag) * own.opening.signum() + left / own.opening.abs()
    }

    /// The place of a crest that is most ahead, near a share along it: its share, and how far.
    fn highest_on(&self, crest: Crest, start: (f64, f64), position: &Position) -> (f64, f64) {
        let of = |places: &[f64]| {
            let known: Vec<(f64, MilledPlace)> = places
                .iter()
                .filter(|place| (0.0..=1.0).contains(*place))
                .filter_map(|place| Some((*place, self.flank.place_of(crest, *place)?)))
                .collect();
            let nodes: Vec<SurfacePoint> = known.iter().map(|(_, place)| node(place.line)).collect();
            let gaps = self.gaps.each(&nodes, &position.opened(), self.mate, self.reach);
            let ahead = |((share, place), gaps): (&(f64, MilledPlace), &Vec<Option<f64>>)| {
                Some([*share, position.ahead(place.height, [gaps[0]?, gaps[1]?])?])
            };
            known.iter().zip(&gaps).filter_map(ahead).collect()
        };
        highest_near(start, 1.0 / (COLUMNS - 1) as f64, of)
    }

    /// How far the highest place of what one pass leaves is ahead, near a row; `highest` are those of the rows.
    fn highest_beside(&self, row: f64, highest: &[Place], position: &Position) -> f64 {
        let last = (self.flank.rows() - 1) as f64;
        let rows: Vec<&Place> = highest.iter().filter(|place| place.0 < self.flank.rows()).collect();
        // the highest places of neighbouring rows lie on a line across them
        let start = |row: f64| -> Option<(f64, f64)> {
            let after = rows.partition_point(|place| (place.0 as f64) < row);
            let (a, b) = (rows.get(after.saturating_sub(1))?, rows.get(after).or(rows.last())?);
            let share = if a.0 == b.0 { 0.0 } else { (row - a.0 as f64) / (b.0 - a.0) as f64 };
            Some((a.1 + share * (b.1 - a.1), f64::NEG_INFINITY))
        };
        let of = |places: &[f64]| {
            let within = places.iter().filter(|place| (0.0..=last).contains(*place));
            within
                .filter_map(|place| Some([*place, self.highest_on(Crest::Row(*place), start(*place)?, position).1]))
                .filter(|[_, ahead]| ahead.is_finite())
                .collect()
        };
        highest_near((row, f64::NEG_INFINITY), 1.0, of).1
    }

    /// The least gaps with the generated and with the milled flank, on passes and ridges, over positions of both.
    fn pattern(&self, positions: &[([f64; 2], [f64; 2])], compound: f64) -> ([Patch; 2], [MilledPattern; 2]) {
        let along = |column: usize| column as f64 / (PATTERN_COLUMNS - 1) as f64;
        let mut places = self.rows_of_pattern(&along);
        let rows = places.len() / PATTERN_COLUMNS;
        let nothing = SurfacePoint { outcome: Outcome::NotConverged { iterations: 0 }, ..node([f64::NAN; 6]) };
        let nodes: Vec<SurfacePoint> =
            places.iter().map(|place| place.as_ref().map_or(nothing.clone(), |place| node(place.line))).collect();
        // on a pass the cutter touches the flank but for the stock
        let stock = self.flank.stock();
        places.iter_mut().flatten().filter(|place| place.height.is_nan()).for_each(|place| place.height = stock);
        let heights = places.iter().map(|place| place.as_ref().map_or(0.0, |place| place.height));
        let heights: Vec<f64> = heights.collect();
        let of = |is_milled: bool| {
            let at: Vec<[f64; 2]> =
                positions.iter().map(|(own, milled)| if is_milled { *milled } else { *own }).collect();
            let gaps = self.gaps.least(&nodes, &at, self.mate, self.reach);
            let gap = |(gap, height): (&Option<Gap>, &f64)| {
                gap.map(|gap| 1e3 * (gap.distance - if is_milled { *height } else { 0.0 }))
            };
            let gaps: Vec<Option<f64>> = gaps.iter().zip(&heights).map(gap).collect();
            let film = 1e3 * compound;
            let pattern = MilledPattern {
                is_milled,
                within: gaps.iter().flatten().filter(|gap| **gap <= film).count(),
                points: gaps.len(),
                least_um: gaps.iter().flatten().copied().reduce(f64::min),
            };
            let name = if is_milled { "as it is milled" } else { "as it is generated" };
            let left = heights.iter().map(|height| Some(if is_milled { 1e3 * height } else { 0.0 })).collect();
            (self.patch(name, rows, &nodes, [gaps, left]), pattern)
        };
        let [(generated, of_generated), (milled, of_milled)] = [false, true].map(of);
        ([generated, milled], [of_generated, of_milled])
    }

    /// Places of a pass, the ridge behind it, and so on; of one pass alone those of its rows. On a pass the height is no number.
    fn rows_of_pattern(&self, along: &(dyn Fn(usize) -> f64 + Sync)) -> Vec<Option<MilledPlace>> {
        let of_crest =
            |crest: Crest| (0..PATTERN_COLUMNS).map(|column| self.flank.place_of(crest, along(column))).collect();
        if self.flank.has_one_pass() {
            let rows: Vec<Crest> = (0..2 * self.flank.rows() - 1).map(|row| Crest::Row(0.5 * row as f64)).collect();
            return rows.into_par_iter().map(of_crest).collect::<Vec<Vec<_>>>().into_iter().flatten().collect();
        }
        let every = (2 * self.flank.passes()).div_ceil(PATTERN_ROWS);
        let passes: Vec<usize> = (0..self.flank.passes()).step_by(every).collect();
        let of_pass = |pass: &usize| -> Vec<Vec<Option<MilledPlace>>> {
            let on_pass =
                |column: usize| Some(MilledPlace { line: self.flank.on_pass(*pass, along(column)), height: f64::NAN });
            let own = (0..PATTERN_COLUMNS).map(on_pass).collect();
            let is_last = *pass + 1 == self.flank.passes();
            let ridge = (!is_last).then(|| of_crest(Crest::Ridge(*pass)));
            std::iter::once(own).chain(ridge).collect()
        };
        passes.par_iter().flat_map_iter(of_pass).flatten().collect()
    }

    fn patch(&self, name: &str, rows: usize, nodes: &[SurfacePoint], [gaps, left]: [Vec<Option<f64>>; 2]) -> Patch {
        let point = |node: &SurfacePoint| Point {
            outcome: if node.outcome == Outcome::Solved { Written::Solved } else { Written::Unsolved("not_converged") },
            position: node.position,
            normal: node.normal,
            unknowns: Vec::new(),
            residual: 0.0,
            reason: String::new(),
        };
        let [of_rows, of_columns] = self.flank.labels.clone();
        Patch {
            name: format!("{} {name}", self.surface),
            frame: self.frame.to_string(),
            layout: Layout::Round,
            rows: Axis { label: of_rows, count: rows },
            columns: Axis { label: of_columns, count: PATTERN_COLUMNS },
            unknowns: Vec::new(),
            points: nodes.iter().map(point).collect(),
            fields: vec![
                field("gap", "least distance to the mate along the normal, over the mesh", gaps),
                field("left", "height over the generated flank along its normal; plus is material", left),
            ],
        }
    }
}

fn field(name: &str, meaning: &str, values: Vec<Option<f64>>) -> Field {
    Field {
        name: name.to_string(),
        unit: "um".to_string(),
        meaning: meaning.to_string(),
        values: Values::Scalars(values.into_iter().collect()),
    }
}

/// The highest value, and where, near a start: of places around it, nearer and nearer together. `of` gives place and value of those that have one.
fn highest_near(start: (f64, f64), unit: f64, of: impl Fn(&[f64]) -> Vec<[f64; 2]>) -> (f64, f64) {
    let (mut at, mut best) = start;
    for apart in APART {
        let values = of(&[-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| at + k * apart * unit));
        let Some(most) = (0..values.len()).max_by(|a, b| values[*a][1].total_cmp(&values[*b][1])) else { break };
        (at, best) = match values.get(most.wrapping_sub(1)..=most + 1) {
            Some(three) => vertex(three).unwrap_or((values[most][0], values[most][1])),
            None => (values[most][0], values[most][1]),
        };
    }
    (at, best)
}

/// The highest place of the parabola through three places that are evenly apart, if it has one between them.
fn vertex(three: &[[f64; 2]]) -> Option<(f64, f64)> {
    let [[_, a], [at, b], [after, c]] = three else { return None };
    let (slope, bend) = (0.5 * (c - a), a - 2.0 * b + c);
    let share = -slope / bend;
    let is_between = bend < 0.0 && share.abs() <= 1.0;
    is_between.then(|| (at + share * (after - at), b + 0.5 * slope * share))
}
