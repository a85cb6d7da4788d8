//! The surface of a body, or of some of its teeth, as sheets of points: for who draws it, face by face.

use std::f64::consts::TAU;

use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::body::{Body, shifted};
use crate::solid::section::{Fineness, Layout};

/// Cells of a turned face from the middle of a space to the middle of the next at the least, and of a whole turn.
const AROUND: usize = 4;
const WHOLE_TURN: f64 = 64.0;
/// Cells along an arc of the outline.
const ALONG_ARC: usize = 12;

/// What a sheet is a piece of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetFace {
    /// A surface of a tooth space, by its place in the order that the charts were given in.
    Surface(usize),
    /// The blank: tip, ends, bore.
    Blank,
    /// Where teeth that are not shown are cut off, in the middle of a space.
    Cut,
}

/// A grid of points on a face of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySheet {
    /// What it is a piece of.
    pub face: SheetFace,
    /// Rows and columns.
    pub counts: [usize; 2],
    /// Whether the face ends at its first row, its last row, its first column and its last column, or goes on beyond.
    pub ends: [bool; 4],
    /// Row by row, mm.
    pub points: Vec<[f64; 3]>,
    /// Unit vectors out of the body.
    pub normals: Vec<[f64; 3]>,
}

/// A sheet of one tooth before it is turned: from the first column to the last, then from the first row to the last, turns
/// anticlockwise seen from outside.
struct Piece {
    face: SheetFace,
    counts: [usize; 2],
    ends: [bool; 4],
    places: Vec<Polar>,
}

impl Body {
    /// The sheets of so many teeth next to each other, about the first space in its given place; of all teeth, if there are not as many
    /// more. Their points lie on the exact surfaces, those of blanks between them on circles.
    pub fn sheets(&self, teeth: u32, fineness: &Fineness) -> Vec<BodySheet> {
        let teeth = teeth.min(self.teeth());
        let is_closed = self.arrangement().is_closed();
        let first = if is_closed { -i64::from((teeth - 1) / 2) } else { i64::from((self.teeth() - teeth) / 2) };
        let numbers: Vec<i64> = (first..first + i64::from(teeth)).collect();
        let kind = |tooth: i64| tooth.rem_euclid(self.distinct() as i64) as usize;
        let by = |tooth: i64| if self.distinct() == 1 { tooth as f64 * self.pitch() } else { 0.0 };
        let lines = |kind: usize| {
            let (across, along) = Body::shares_of(fineness);
            self.tooth_lines(kind, &across, &along)
        };
        let kinds: Vec<usize> =
            (0..self.distinct()).filter(|of| numbers.iter().any(|tooth| kind(*tooth) == *of)).collect();
        let lines: Vec<[Vec<Vec<Polar>>; 2]> = kinds.iter().map(|of| lines(*of)).collect();
        let sections: Vec<Section<'_>> = lines.iter().map(|lines| Section::new(self, fineness, lines)).collect();
        let pieces: Vec<Vec<Piece>> = sections.iter().map(Section::pieces).collect();
        let of = |tooth: i64| kinds.iter().position(|of| *of == kind(tooth)).expect("one of those that are shown");
        let turned = |piece: &Piece, tooth: i64| piece.turned(self.arrangement(), by(tooth));
        let mut sheets: Vec<BodySheet> = numbers
            .iter()
            .flat_map(|tooth| pieces[of(*tooth)].iter().map(move |piece| turned(piece, *tooth)))
            .collect();
        if teeth < self.teeth() || !is_closed {
            let last = first + i64::from(teeth) - 1;
            let ([before, _], [_, behind]) = (sections[of(first)].cuts(), sections[of(last)].cuts());
            sheets.push(turned(&before, first));
            sheets.push(turned(&behind, last));
        }
        sheets
    }
}

impl Body {
    /// The angles that a tooth turns through: from the middle of a space to the middle of the next, and along it; none of a straight body.
    pub fn turns(&self, fineness: &Fineness) -> [f64; 2] {
        if !self.arrangement().is_closed() {
            return [0.0; 2];
        }
        let (across, along) = Body::shares_of(fineness);
        let [lines, _] = self.tooth_lines(0, &across, &along);
        let middle = |line: &[Polar]| line[line.len() / 2][2];
        [self.pitch(), (middle(&lines[lines.len() - 1]) - middle(&lines[0])).abs()]
    }
}

/// A tooth from the middle of one space to the middle of the next.
struct Section<'b> {
    body: &'b Body,
    fineness: &'b Fineness,
    layout: Layout,
    /// Across the space before it and the one behind it.
    lines: [&'b [Vec<Polar>]; 2],
    /// The layout's nodes at each place along.
    places: Vec<Vec<Polar>>,
}

impl<'b> Section<'b> {
    fn new(body: &'b Body, fineness: &'b Fineness, lines: &'b [Vec<Vec<Polar>>; 2]) -> Section<'b> {
        let layout = Layout::new(fineness);
        let [own, next] = lines;
        let count = own.len();
        let shares = layout.shares(&layout.top([&own[count / 2], &next[count / 2]]), body.arrangement());
        let below = body.blank().below(count - 1);
        let places = (0..count).map(|j| layout.places([&own[j], &next[j]], below[j], &shares)).collect();
        Section { body, fineness, places, layout, lines: [own, next] }
    }

    /// All but where the tooth is cut off from its neighbours.
    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = self.surfaces();
        pieces.push(self.tip());
        pieces.extend(self.ends());
        pieces.extend(self.rest());
        pieces
    }

    /// The far half of the space before the tooth, and the near half of the one behind it.
    fn surfaces(&self) -> Vec<Piece> {
        let Layout { last, middle, .. } = self.layout;
        let (charts, is_reversed) = (self.body.charts(), self.body.is_reversed());
        let mut pieces = Vec::new();
        for (from, to, lines) in [(middle, last, self.lines[0]), (0, middle, self.lines[1])] {
            let mut start = 0;
            for (k, count) in self.fineness.charts.iter().enumerate() {
                let (low, high) = (start.max(from), (start + count).min(to));
                let ends = [low == start, high == start + count, true, true];
                start += count;
                if low >= high {
                    continue;
                }
                let place = |i: usize| lines.iter().map(move |line| line[i]);
                pieces.push(Piece {
                    face: SheetFace::Surface(if is_reversed { charts.len() - 1 - k } else { k }),
                    counts: [high - low + 1, lines.len()],
                    ends,
                    places: (low..=high).flat_map(place).collect(),
                });
            }
        }
        pieces
    }

    fn tip(&self) -> Piece {
        let tooth = self.layout.tooth;
        let place = |k: usize| self.places.iter().map(move |nodes| nodes[k]);
        Piece {
            face: SheetFace::Blank,
            counts: [tooth + 1, self.places.len()],
            ends: [false, false, true, true],
            places: (0..=tooth).flat_map(place).collect(),
        }
    }

    /// Where the spaces begin, and where they end: the tooth, and what is below it.
    fn ends(&self) -> Vec<Piece> {
        let layout = &self.layout;
        let blocks = |nodes: &[Polar]| {
            let tooth = (0..=layout.depth).map(|i| (0..=layout.tooth).map(|k| nodes[layout.in_tooth(i, k)]).collect());
            let rim = (0..=layout.rim).map(|i| (0..=layout.width()).map(|k| nodes[layout.in_rim(i, k)]).collect());
            [tooth.collect::<Vec<Vec<Polar>>>(), rim.collect()]
        };
        let piece = |rows: Vec<Vec<Polar>>, ends: [bool; 4]| Piece {
            face: SheetFace::Blank,
            counts: [rows.len(), rows[0].len()],
            ends,
            places: rows.into_iter().flatten().collect(),
        };
        let [begin, end] = [&self.places[0], &self.places[self.places.len() - 1]].map(|nodes| blocks(nodes));
        let [tooth, rim] = begin;
        let [far_tooth, far_rim] = end.map(|rows| transposed(&rows));
        vec![
            piece(tooth, [false; 4]),
            piece(rim, [false, true, false, false]),
            piece(far_tooth, [false; 4]),
            piece(far_rim, [false, false, false, true]),
        ]
    }

    /// The rest of the outline, a sheet for each of its segments.
    fn rest(&self) -> Vec<Piece> {
        let rest = self.body.blank().rest();
        let whole: f64 = rest.iter().map(|segment| segment.length()).sum();
        let middles = |j: usize| self.lines.map(|lines| lines[j][self.layout.middle][2]);
        let (from, to) = (middles(self.places.len() - 1), middles(0));
        let around = match self.body.arrangement() {
            Arrangement::Round => AROUND.max((WHOLE_TURN * (to[1] - to[0]).abs() / TAU).ceil() as usize),
            Arrangement::Straight { .. } => AROUND,
        };
        let mut before = 0.0;
        rest.iter()
            .map(|segment| {
                let cells = if segment.center.is_some() { ALONG_ARC } else { self.places.len() - 1 };
                let step = |k: usize, turn: f64| {
                    let share = k as f64 / cells as f64;
                    let [z, rho] = segment.at(share);
                    let way = (before + share * segment.length()) / whole;
                    let [start, end] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * way);
                    [z, rho, start + turn * (end - start)]
                };
                let row = |turn: usize| (0..=cells).map(move |k| step(k, turn as f64 / around as f64));
                let places = (0..=around).flat_map(row).collect();
                before += segment.length();
                Piece {
                    face: SheetFace::Blank,
                    counts: [around + 1, cells + 1],
                    ends: [false, false, true, true],
                    places,
                }
            })
            .collect()
    }

    /// Through the middles of the spaces on both sides.
    fn cuts(&self) -> [Piece; 2] {
        let rows = |column: usize| -> Vec<Vec<Polar>> {
            let row = |nodes: &Vec<Polar>| {
                (0..=self.layout.rim).map(|i| nodes[self.layout.in_rim(i, column)]).collect::<Vec<Polar>>()
            };
            self.places.iter().map(row).collect()
        };
        let piece = |rows: Vec<Vec<Polar>>| Piece {
            face: SheetFace::Cut,
            counts: [rows.len(), rows[0].len()],
            ends: [true; 4],
            places: rows.into_iter().flatten().collect(),
        };
        [piece(rows(0)), piece(transposed(&rows(self.layout.width())))]
    }
}

fn transposed(rows: &[Vec<Polar>]) -> Vec<Vec<Polar>> {
    (0..rows[0].len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect()
}

impl Piece {
    fn turned(&self, arrangement: Arrangement, by: f64) -> BodySheet {
        let [rows, columns] = self.counts;
        let points: Vec<[f64; 3]> = self.places.iter().map(|place| arrangement.position(shifted(*place, by))).collect();
        let way = |from: usize, to: usize| nalgebra::Vector3::from(points[to]) - nalgebra::Vector3::from(points[from]);
        let normal = |at: usize| {
            let (i, j) = (at / columns, at % columns);
            let down = way(i.saturating_sub(1) * columns + j, (i + 1).min(rows - 1) * columns + j);
            let right = way(i * columns + j.saturating_sub(1), i * columns + (j + 1).min(columns - 1));
            right.cross(&down).try_normalize(0.0).unwrap_or_default().into()
        };
        let normals = (0..points.len()).map(normal).collect();
        BodySheet { face: self.face, counts: self.counts, ends: self.ends, points, normals }
    }
}
