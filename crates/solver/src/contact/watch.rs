//! Whether a pair of teeth touches elsewhere before it does so where its contact is followed.
//!
//! At a roll position each place of a flank, on its edges too, has a lag at which the mate passes through it. No place that both teeth have
//! may open the pair more than the contact does. One that does lies beside the contact that is looked for.

use flank_expr::{Expr, InstructionSet, LANES, LaneEvaluator, LaneTape, Tape, TapeError};
use nalgebra::Vector3;

use crate::contact::edge::{FlankEdge, PlacedFlank};
use crate::contact::outline::OutlineSegment;
use crate::contact::point::{ContactPoint, ContactState, placed};
use crate::contact::{ContactProblem, RollingPair};
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::batch::LaneNewton;
use crate::surface::points::SurfacePoint;

/// Places along an edge, and on a flank at most.
const ALONG_EDGE: usize = 9;
const ON_FLANK: usize = 30;
/// A contact that is nearer to a place than so many times the way from one place to the next was found from there, too.
const BESIDE: f64 = 1.5;
/// A place that no mate was found to pass through is tried again at every so many roll positions.
const TRIED_AGAIN: usize = 4;
/// A place that opens the pair by more than this beyond the contact, mm along the normal, is no rounding of solved points.
pub(super) const HIGHER: f64 = 1e-8;

/// Both flanks at places, and the equations of how their mates pass through these.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    members: [Watched; 2],
    /// From all unknowns, the lag and what is given: the point in the frame of each member, the product of normals, and the opening.
    seen: LaneTape,
}

/// A flank at places, and the mate that passes through them.
#[derive(Clone, Debug)]
struct Watched {
    /// Unknowns of the flank; `z` and `rho` are parameters, then what is given but for the roll.
    placing: System,
    /// Unknowns of the mate and the lag; those of the flank and what is given are parameters.
    through: System,
    ranges: [Vec<Range>; 2],
    places: Vec<Place>,
}

/// A place of a flank.
#[derive(Clone, Debug)]
pub(super) struct Place {
    section: [f64; 2],
    unknowns: Vec<f64>,
    /// Of the nearest solved point, in the frame of the member.
    position: [f64; 3],
    /// The edges on which it lies: none within the flank, two at a corner.
    pub(super) edges: Vec<FlankEdge>,
}

/// The mate on its way through a place.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    /// Unknowns of both flanks and the lag.
    unknowns: Vec<f64>,
    /// The place in the frame of its member.
    position: [f64; 3],
    /// The lag, with the sign with which more of it opens.
    pub(super) height: f64,
    /// mm of the normal for a unit of the lag.
    pub(super) opening: f64,
    /// Whether both teeth have the place.
    is_held: bool,
}

/// All places over the roll: where the mate passed through them at the last roll position.
pub(super) struct Watching<'w> {
    watch: &'w Watch,
    /// With the member, those of the first one before those of the second.
    pub(super) places: Vec<(usize, Place)>,
    /// Unknowns of the mate and the lag, from which it is followed.
    starts: Vec<Option<Vec<f64>>>,
    /// Roll positions so far.
    positions: usize,
}

impl Watch {
    /// # Errors
    /// If something depends on a variable that is neither an unknown, nor the roll or lag, nor has a value.
    pub(super) fn new<'g>(pair: &RollingPair<'_, 'g>, points: [&[SurfacePoint]; 2]) -> Result<Watch, TapeError> {
        let own = [pair.surfaces[0].renamed("of the first"), pair.surfaces[1].renamed("of the second")];
        let flanks = [0, 1].map(|k| PlacedFlank { own: own[k].surface(), placement: &pair.placements[k] });
        let moved = flanks.each_ref().map(|flank| flank.own.moved(flank.placement));
        let graph = pair.roll.graph();
        let lag = pair.lag.0;
        let values: Vec<Expr<'g>> = pair.parameters.iter().map(|(name, _)| *name).collect();
        let given = [&[pair.roll][..], &values].concat();
        let apart = (moved[0].position - moved[1].position).0;
        let section = |k: usize| {
            let [x, y, z] = flanks[k].own.position.0;
            [z, (x * x + y * y).sqrt()]
        };
        let watched = |k: usize| {
            let (mate, own_unknowns) = (1 - k, &moved[k].unknowns);
            let targets = ["z of place", "rho of place"].map(|name| graph.variable(name));
            let on_place = section(k).into_iter().zip(targets).map(|(at, target)| at - target);
            let at_place: Vec<Expr<'g>> = flanks[k].own.constraints.iter().copied().chain(on_place).collect();
            let through = [&moved[mate].constraints[..], &apart].concat();
            let places = places(pair, k, points[k]);
            Ok(Watched {
                placing: System::new(&at_place, own_unknowns, &[&targets[..], &values].concat())?,
                through: System::new(
                    &through,
                    &[&moved[mate].unknowns[..], &[lag]].concat(),
                    &[&own_unknowns[..], &given].concat(),
                )?,
                ranges: [pair.surfaces[k].ranges().to_vec(), [pair.surfaces[mate].ranges(), &[pair.lag.1]].concat()],
                places,
            })
        };
        let moves = moved[1].position.derivative(lag) - moved[0].position.derivative(lag);
        let facing = moved[0].normal.dot(moved[1].normal);
        let outputs =
            [&flanks[0].own.position.0[..], &flanks[1].own.position.0, &[facing, moved[0].normal.dot(moves)]].concat();
        let inputs = [&moved[0].unknowns[..], &moved[1].unknowns, &[lag], &given].concat();
        Ok(Watch { members: [watched(0)?, watched(1)?], seen: LaneTape::new(&Tape::new(&outputs, &inputs)?) })
    }
}

/// Solved points of a flank, and places along its edges, with the unknowns of the nearest point as a start.
fn places(pair: &RollingPair<'_, '_>, member: usize, points: &[SurfacePoint]) -> Vec<Place> {
    let section = |point: &SurfacePoint| [point.position[2], point.position[0].hypot(point.position[1])];
    let solved: Vec<&SurfacePoint> = points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
    let outline = pair.outlines[member].as_ref();
    let held = || solved.iter().filter(|point| outline.is_none_or(|outline| outline.holds(section(point))));
    let stride = held().count().div_ceil(ON_FLANK).max(1);
    let within = held().step_by(stride).map(|point| Place {
        section: section(point),
        unknowns: point.unknowns.clone(),
        position: point.position,
        edges: Vec::new(),
    });
    let mut all: Vec<Place> = within.collect();
    let Some(outline) = outline.filter(|outline| !outline.is_open()) else { return all };
    let count = outline.segments().len();
    // the end of a segment is the beginning of the next one
    let along = |(segment, line): (usize, &OutlineSegment)| {
        let edges = |k: usize| {
            let before = (k == 0).then_some((segment + count - 1) % count);
            let mut edges: Vec<FlankEdge> =
                [Some(segment), before].into_iter().flatten().map(|segment| FlankEdge { member, segment }).collect();
            edges.sort();
            edges.dedup();
            edges
        };
        (0..ALONG_EDGE).map(|k| (line.at(k as f64 / ALONG_EDGE as f64), edges(k))).collect::<Vec<_>>()
    };
    for (place, edges) in outline.segments().iter().enumerate().flat_map(along) {
        let off = |point: &SurfacePoint| {
            let [z, rho] = section(point);
            (z - place[0]).hypot(rho - place[1])
        };
        let Some(near) = solved.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        all.push(Place { section: place, unknowns: near.unknowns.clone(), position: near.position, edges });
    }
    all
}

impl<'w> Watching<'w> {
    /// With the values of a problem's parameters.
    fn new(watch: &'w Watch, problem: &ContactProblem) -> Watching<'w> {
        let mut places = Vec::new();
        for (member, watched) in watch.members.iter().enumerate() {
            let mut newton = LaneNewton::new(&watched.placing, &watched.ranges[0]);
            for chunk in watched.places.chunks(LANES) {
                for (lane, place) in chunk.iter().enumerate() {
                    let given = [&place.section[..], &problem.values].concat();
                    newton.put(lane, place.unknowns.iter().copied(), &given);
                }
                newton.run(&vec![true; chunk.len()], false);
                for (lane, place) in chunk.iter().enumerate() {
                    if newton.is_root(lane) && newton.outcome(lane) == Outcome::Solved {
                        let unknowns = (0..place.unknowns.len()).map(|k| newton.input(k)[lane]).collect();
                        places.push((member, Place { unknowns, ..place.clone() }));
                    }
                }
            }
        }
        Watching { watch, starts: vec![None; places.len()], places, positions: 0 }
    }

    /// How the mates pass through all places at a roll position, near a lag.
    pub(super) fn passed(&mut self, problem: &ContactProblem, roll: f64, near: &ContactPoint) -> Vec<Option<Passed>> {
        if self.positions.is_multiple_of(TRIED_AGAIN) {
            self.begin(problem, roll, near.lag);
        }
        self.positions += 1;
        for (member, watched) in self.watch.members.iter().enumerate() {
            let mut newton = LaneNewton::new(&watched.through, &watched.ranges[1]);
            let tried: Vec<usize> = (0..self.places.len())
                .filter(|at| self.places[*at].0 == member && self.starts[*at].is_some())
                .collect();
            for chunk in tried.chunks(LANES) {
                for (lane, at) in chunk.iter().enumerate() {
                    let given = self.places[*at].1.unknowns.iter().copied().chain(problem.given(roll));
                    let start = self.starts[*at].iter().flatten().copied();
                    newton.put(lane, start, &given.collect::<Vec<f64>>());
                }
                newton.run(&vec![true; chunk.len()], true);
                for (lane, at) in chunk.iter().enumerate() {
                    let is_root = newton.is_root(lane) && newton.outcome(lane) == Outcome::Solved;
                    let count = watched.ranges[1].len();
                    self.starts[*at] = is_root.then(|| (0..count).map(|k| newton.input(k)[lane]).collect());
                }
            }
        }
        self.seen(problem, roll, near.opening.signum())
    }

    /// Starts the mate at its nearest places where it is not on its way.
    fn begin(&mut self, problem: &ContactProblem, roll: f64, lag: f64) {
        let poses = problem.poses_at(lag, roll);
        let at: Vec<[f64; 3]> =
            self.places.iter().map(|(member, place)| placed(&poses[*member], place.position)).collect();
        for k in (0..self.places.len()).filter(|k| self.starts[*k].is_none()).collect::<Vec<usize>>() {
            let off = |other: &usize| (0..3).map(|x| (at[*other][x] - at[k][x]).powi(2)).sum::<f64>();
            let mates = (0..self.places.len()).filter(|other| self.places[*other].0 != self.places[k].0);
            let nearest = mates.min_by(|a, b| off(a).total_cmp(&off(b)));
            self.starts[k] = nearest.map(|mate| [&self.places[mate].1.unknowns[..], &[lag]].concat());
        }
    }

    /// What is known of the places that the mate passes through.
    fn seen(&self, problem: &ContactProblem, roll: f64, opens: f64) -> Vec<Option<Passed>> {
        let mut all = vec![None; self.places.len()];
        let mut evaluator = LaneEvaluator::new(&self.watch.seen, InstructionSet::fastest());
        let given: Vec<f64> = problem.given(roll).collect();
        let reached: Vec<usize> = (0..self.places.len()).filter(|at| self.starts[*at].is_some()).collect();
        for chunk in reached.chunks(LANES) {
            let unknowns = |at: usize| {
                let (member, place) = &self.places[at];
                let (mate, lag) =
                    self.starts[at].as_deref().and_then(|start| start.split_last().map(|(lag, mate)| (mate, *lag)))?;
                let own = &place.unknowns[..];
                Some(if *member == 0 { [own, mate, &[lag]].concat() } else { [mate, own, &[lag]].concat() })
            };
            let unknowns: Vec<Vec<f64>> = chunk.iter().filter_map(|at| unknowns(*at)).collect();
            for (lane, unknowns) in unknowns.iter().enumerate() {
                for (k, value) in unknowns.iter().chain(&given).enumerate() {
                    evaluator.input(k)[lane] = *value;
                }
            }
            evaluator.run();
            for (lane, (at, unknowns)) in chunk.iter().zip(unknowns).enumerate() {
                let out = |k: usize| evaluator.output(k)[lane];
                let positions = [0, 3].map(|from| [from, from + 1, from + 2].map(out));
                let (facing, opening) = (out(6), out(7));
                let member = self.places[*at].0;
                let [x, y, z] = positions[1 - member];
                let outline = problem.outlines[1 - member].as_ref();
                let is_on_mate = outline.is_none_or(|outline| outline.holds([z, x.hypot(y)]));
                let lag = unknowns[problem.lag_at()];
                all[*at] = Some(Passed {
                    height: lag * opens,
                    position: positions[member],
                    opening: opening.abs(),
                    is_held: is_on_mate && facing < 0.0 && opening * opens > 0.0,
                    unknowns,
                });
            }
        }
        all
    }

    /// Places that both teeth have and that open the pair more than something of a height, the highest first.
    pub(super) fn beyond(&self, passed: &[Option<Passed>], height: f64) -> Vec<usize> {
        let held = passed.iter().enumerate().filter_map(|(at, place)| Some((at, place.as_ref()?)));
        let is_beyond =
            |(_, place): &(usize, &Passed)| place.is_held && (place.height - height) * place.opening > HIGHER;
        let mut found: Vec<(usize, &Passed)> = held.filter(is_beyond).collect();
        found.sort_by(|a, b| b.1.height.total_cmp(&a.1.height));
        found.into_iter().map(|(at, _)| at).collect()
    }

    /// Places at edges, away from a contact, beside which the pair may be opened more than what carries does: those that do so more than their
    /// neighbours, and come near to it.
    pub(super) fn beside(&self, passed: &[Option<Passed>], present: &ContactPoint, carrying: f64) -> Vec<usize> {
        let held = |at: usize| passed.get(at)?.as_ref().filter(|passed| passed.is_held);
        let is_on_edge = |at: usize| self.places.get(at).is_some_and(|(_, place)| !place.edges.is_empty());
        if present.state == Some(ContactState::Line) {
            return Vec::new();
        }
        let is_candidate = |at: &usize| {
            let Some(own) = held(*at).filter(|_| is_on_edge(*at)) else { return false };
            let neighbours = [at.wrapping_sub(1), at + 1]
                .into_iter()
                .filter(|k| is_on_edge(*k) && self.places[*k].0 == self.places[*at].0);
            let neighbours: Vec<(usize, &Passed)> = neighbours.filter_map(|k| Some((k, passed[k].as_ref()?))).collect();
            let is_highest = neighbours.iter().all(|(k, of)| held(*k).is_none() || of.height <= own.height);
            // between places of an edge that both teeth have the parabola through three of them is no more than a quarter of that higher; where one
            // of them is beyond the mate the highest point is at its end, up to there
            let rise = |(k, of): &(usize, &Passed)| match held(*k) {
                Some(_) => 0.25 * (own.height - of.height),
                None => of.height - own.height,
            };
            let rise = neighbours.iter().map(rise).fold(0.0, f64::max);
            let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|x| (a[x] - b[x]).powi(2)).sum::<f64>().sqrt();
            let spacing = neighbours.iter().map(|(_, of)| apart(of.position, own.position)).fold(0.0, f64::max);
            let off = apart(present.in_members[self.places[*at].0], own.position);
            is_highest && own.height + rise > carrying && off > BESIDE * spacing
        };
        (0..passed.len()).filter(is_candidate).collect()
    }
}

impl ContactProblem {
    /// All places, if it looks at any.
    pub(super) fn watching_places(&self) -> Option<Watching<'_>> {
        self.watch.as_ref().map(|watch| Watching::new(watch, self))
    }

    /// The same pair, which looks at solved points of both flanks and at places of their edges whether it touches there first.
    ///
    /// # Errors
    /// As for [`ContactProblem::new`].
    pub fn watching(
        self,
        pair: &RollingPair<'_, '_>,
        points: [&[SurfacePoint]; 2],
    ) -> Result<ContactProblem, TapeError> {
        let watch = Some(std::sync::Arc::new(Watch::new(pair, points)?));
        Ok(ContactProblem { watch, ..self })
    }

    /// The contact beside a place, if it opens the pair as much as the place does and as what is known: looked for with the edges on which
    /// the place lies and with none; then, where it is vital, with each that there is.
    pub(super) fn contact_beside(
        &self,
        start: &Passed,
        (edges, is_vital): (&[FlankEdge], bool),
        roll: f64,
        known: f64,
    ) -> Option<ContactPoint> {
        let least = start.height.max(known) - HIGHER / start.opening;
        let normal: Vector3<f64> = self.members(&start.unknowns, roll)[0].normal;
        let single = edges.iter().map(|edge| vec![*edge]);
        let own = single.chain([edges.to_vec()]).chain((!edges.is_empty()).then(Vec::new));
        let others = if is_vital { self.ways() } else { Vec::new() };
        let mut found = own.chain(others).filter_map(|edges| self.touching_near(roll, &start.unknowns, &edges, normal));
        found.find(|point| {
            point.outcome == Outcome::Solved && point.state != Some(ContactState::Crossing) && point.height() >= least
        })
    }
}

impl ContactPoint {
    /// The lag, with the sign with which more of it opens the pair.
    pub(super) fn height(&self) -> f64 {
        self.lag * self.opening.signum()
    }

    /// Whether it opens the pair more than something of that height, and not by rounding.
    pub(super) fn is_beyond(&self, height: f64) -> bool {
        (self.height() - height) * self.opening.abs() > HIGHER
    }
}
