//! What the blocks of a program leave in each space of the work: at the points of the map, at the contacts of the plan and half-way between its
//! passes, and where each block is deepest.

use flank_chain_dsl::{BlockLength, PassSpacing};
use flank_export::fixed;
use flank_solver::{Cutter, Guard, NormalLine, Obstacle, PoseSeries, SpacePlace, Struck, SweptCutter};
use rayon::prelude::*;

use super::left::LeftMap;
use super::machine::Machine;
use super::patch::Lattice;
use super::plan::{LeftAt, Plan, higher};
use super::result::HeightLeft;
use super::ridge::Ridges;
use super::target::{Fields, Target};
use super::verify::in_space;
use super::{Found, left_at};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;

/// Rows and columns of points at the most in each space but the first.
const POINTS: [usize; 2] = [15, 31];
/// A block that stays farther than this above what it should leave, mm, is not looked at for how deep it goes.
const BESIDE: f64 = 0.01;
/// Depths of blocks are first known to some 1e-5 mm; the deepest by less than this, mm, are solved, ...
const CLOSE: f64 = 1e-4;
/// ... of so many at the most.
const SOLVED: usize = 500;
/// Of so many of these the height over the surface is looked at.
const LOOKED_AT: usize = 8;
/// What is more than rounding, mm.
const ROUNDING: f64 = 1e-7;
/// Contacts that tell whether a program cuts in a space.
const FEW: usize = 9;
/// From the highest place of so many parts of the map by so many ridges are climbed.
const PARTS: usize = 4;
/// Details that are told at the most.
const TOLD: usize = 6;

/// The blocks of a program that come near what is milled.
pub(super) struct Blocks {
    pub(super) series: Vec<PoseSeries>,
    pub(super) lines: Vec<usize>,
    pub(super) has_tip_control: bool,
}

/// What blocks leave in the spaces that they are to mill, counted from zero.
pub(super) struct Measured {
    pub(super) spaces: Vec<u32>,
    /// How many spaces the work has.
    of: u32,
    /// The most that is left, and in which space.
    most: Option<(LeftAt, u32)>,
    /// The least, in which space and by which line.
    pub(super) least: Option<(LeftAt, u32, usize)>,
    /// How deep blocks may go, mm.
    pub(super) promised: f64,
    /// Blocks that are deeper.
    pub(super) deep: usize,
    /// Of each space points of its map that are not passed over, and how many it has.
    maps: Vec<[usize; 2]>,
    missing: Missing,
}

/// What is not milled.
#[derive(Default)]
struct Missing {
    spaces: Vec<u32>,
    /// Pass and space, with what is left in their place.
    passes: Vec<(usize, u32, Option<LeftAt>)>,
    /// The place in which too much is left, its space, and how many there are.
    high: Option<(LeftAt, u32, usize)>,
    /// How much may be left, mm.
    allowed: f64,
}

/// A place at which a program is looked at.
struct Spot {
    shares: [f64; 2],
    line: NormalLine,
    /// The pass that touches there.
    pass: Option<usize>,
}

/// What may be left, mm, over the surface with its stock.
#[derive(Clone, Copy)]
struct Limits {
    /// Anywhere, ...
    anywhere: f64,
    /// ... beside what passes leave, ...
    by_blocks: f64,
    /// ... and at a contact of a pass, where a block ends.
    contact: f64,
}

/// The program as what it sweeps, in all spaces.
struct Sweep<'f> {
    fields: &'f Fields,
    plan: &'f Plan,
    /// The contacts of all passes.
    lattice: &'f Lattice,
    cutter: &'f Cutter,
    stock: f64,
    swept: SweptCutter,
    places: Vec<SpacePlace>,
    limits: Limits,
}

impl Measured {
    /// In as many spaces as are asked for, and the map in the first. Less than `promised` below the surface, mm, is not too deep.
    pub(super) fn of_blocks(
        blocks: Blocks,
        target: &Target<'_, '_>,
        found: &Found<'_, '_>,
        (machine, asked, promised): (&Machine<'_, '_>, u32, f64),
    ) -> (Measured, LeftMap) {
        let swept = SweptCutter::of_blocks(blocks.series.clone(), &found.cutter.cutting);
        let rounded = rounded(found, machine);
        let limits = Limits::new(target, found, rounded);
        let sweep = Sweep {
            fields: &found.fields,
            plan: &found.milled.plan,
            lattice: &found.milled.lattice,
            cutter: &found.cutter.cutting,
            stock: target.milling.stock,
            swept,
            places: found.spaces.alike(),
            limits,
        };
        let spots = sweep.spots();
        let spaces = sweep.wanted(&spots, asked);
        let first = sweep.map(target, found, (spaces[0], f64::NEG_INFINITY));
        // of the other spaces what is more is of interest, and whether all is passed over
        let known = first.highest().map_or(f64::NEG_INFINITY, |left| left.height);
        let others = spaces[1..].iter().map(|space| sweep.map(target, found, (*space, known)));
        let maps: Vec<LeftMap> = std::iter::once(first).chain(others).collect();
        let mut most: Option<(LeftAt, u32)> = None;
        let mut least: Option<(LeftAt, u32, usize)> = None;
        for (map, space) in maps.iter().zip(&spaces) {
            let one = map.highest().map(|left| (left, *space));
            most = most.into_iter().chain(one).reduce(|a, b| if b.0.height > a.0.height { b } else { a });
            let one = map.deepest().map(|(left, number)| (left, *space, blocks.lines[number]));
            least = least.into_iter().chain(one).reduce(deeper);
        }
        let missing = sweep.missing(&found.swept, &spots, &spaces);
        if let Some((left, space, _)) = missing.high.filter(|(left, ..)| left.height.is_finite()) {
            most = most.map(|(known, of)| if left.height > known.height { (left, space) } else { (known, of) });
        }
        let most = most.map(|known| sweep.highest(known, &maps[0]));
        let depths = sweep.depths(&blocks.series, &spaces);
        let deepest = depths.first().map(|depth| (depth.left, depth.space, blocks.lines[depth.block]));
        let least = least.into_iter().chain(deepest).reduce(deeper);
        // the blocks of the plan may be deeper between the places at which these are looked at
        let is_beyond = least.is_some_and(|(left, ..)| left.height < -promised);
        let promised = if is_beyond {
            promised.max(rounded - sweep.planned(&found.milled.axes, machine, &blocks))
        } else {
            promised
        };
        let deep = depths.iter().filter(|depth| depth.left.height < -promised).count();
        let counts = maps.iter().map(|map| [map.untouched(), map.points()]).collect();
        let of = sweep.places.len() as u32;
        let map = maps.into_iter().next().expect("one space is asked for at the least");
        (Measured { spaces, of, most, least, promised, deep, maps: counts, missing }, map)
    }

    /// Points of all maps that are not passed over.
    pub(super) fn untouched(&self) -> usize {
        self.maps.iter().map(|[untouched, _]| untouched).sum()
    }

    /// The most and the least, with what a rapid leaves in the first space.
    pub(super) fn ends(&self, target: &Target<'_, '_>, rapid: Option<LeftAt>) -> Option<[HeightLeft; 2]> {
        let rapid = rapid.map(|left| (left, 0, 0));
        let least = self.least.into_iter().chain(rapid).reduce(deeper);
        let ((most, of_most), (least, of_least, _)) = self.most.zip(least)?;
        Some([(most, of_most), (least, of_least)].map(|(left, space)| {
            let told = left_at(target, left);
            HeightLeft { place: in_space(told.place, space), ..told }
        }))
    }

    /// That something is not milled.
    pub(super) fn missed(&self, file: &str, target: &Target<'_, '_>) -> Vec<NotDone> {
        let name = target.name();
        let Missing { spaces, passes, high, allowed } = &self.missing;
        let of_spaces = (!spaces.is_empty()).then(|| {
            let which = listed(spaces.iter().map(|space| (space + 1).to_string()));
            let what = if spaces.len() == 1 { "space" } else { "spaces" };
            let message = format!("{file} does not mill {name} of {what} {which}: the work has {}", self.of);
            let way = "blocks are missing, or go elsewhere: look at units and zero; option `spaces` says how many are to be milled";
            NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![way.to_string()])
        });
        let is_whole = |space: &u32| !spaces.contains(space);
        let untouched = self.spaces.iter().zip(&self.maps).filter(|(space, [none, _])| is_whole(space) && *none > 0);
        let untouched: Vec<(&u32, &[usize; 2])> = untouched.collect();
        let of_points = untouched.first().map(|(space, [none, all])| {
            let message = in_space(format!("{file} does not pass over {none} of {all} points of {name}"), **space);
            let others = untouched.len() - 1;
            let others = (others > 0).then(|| format!("and points of {} more", units::counted(others, "space")));
            let way = "blocks are missing, or go elsewhere: look at units and zero".to_string();
            NotDone::new(NotDoneKind::HeightUnknown, name, message).with(others.into_iter().chain([way]).collect())
        });
        let of_passes = passes.first().map(|(pass, space, left)| {
            let by = match left {
                Some(left) => format!(
                    "more is left at all of its contacts, {} um at {}",
                    fixed(1e3 * left.height, 4),
                    in_space(target.place(left.shares), *space)
                ),
                None => "nothing passes over its contacts".to_string(),
            };
            let message = format!("{file} has no pass {}: {by}", in_space((pass + 1).to_string(), *space));
            let others = passes[1..].iter().map(|(pass, space, _)| in_space(format!("pass {}", pass + 1), *space));
            let others = (passes.len() > 1).then(|| format!("neither has it {}", listed(others)));
            let way = "blocks are missing, or go elsewhere".to_string();
            NotDone::new(NotDoneKind::NotMilled, name, message).with(others.into_iter().chain([way]).collect())
        });
        let of_heights = high.filter(|_| of_passes.is_none() && of_points.is_none()).map(|(left, space, count)| {
            let by = match left.height.is_finite() {
                true => format!("leaves {} um", fixed(1e3 * left.height, 4)),
                false => "leaves all there is".to_string(),
            };
            let message = format!("{file} {by} on {name} at {}", in_space(target.place(left.shares), space));
            let planned = format!(
                "what is planned or asked for, with blocks and the decimals of words, is no higher than {} um",
                fixed(1e3 * allowed, 4)
            );
            let count = format!("more is left at {}", units::counted(count, "place"));
            NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![count, planned])
        });
        [of_spaces, of_points, of_passes, of_heights].into_iter().flatten().collect()
    }
}

fn listed(all: impl ExactSizeIterator<Item = String>) -> String {
    let count = all.len();
    let told: Vec<String> = all.take(TOLD).collect();
    let others = if count > TOLD { format!(" and {} more", count - TOLD) } else { String::new() };
    format!("{}{others}", told.join(", "))
}

fn deeper(a: (LeftAt, u32, usize), b: (LeftAt, u32, usize)) -> (LeftAt, u32, usize) {
    if b.0.height < a.0.height { b } else { a }
}

/// How far the decimals of words put the cutter off, at the most, mm.
pub(super) fn rounded(found: &Found<'_, '_>, machine: &Machine<'_, '_>) -> f64 {
    let reach = found.cutter.cutting.reach();
    found.milled.axes.iter().flatten().map(|row| machine.rounded(row, reach)).fold(0.0, f64::max)
}

impl Limits {
    fn new(target: &Target<'_, '_>, found: &Found<'_, '_>, rounded: f64) -> Limits {
        let plan = &found.milled.plan;
        let chord = if let BlockLength::Chord(chord) = target.milling.blocks { chord } else { 0.0 };
        let by_blocks = chord.max(plan.blocks[0].height) + rounded;
        let asked = if let PassSpacing::Scallop(height) = target.milling.spacing { height } else { 0.0 };
        let by_passes = plan.cusp.into_iter().chain(found.map.highest()).map(|left| left.height);
        Limits { anywhere: by_passes.fold(asked, f64::max) + by_blocks, by_blocks, contact: rounded + ROUNDING }
    }
}

/// How deep a block goes.
struct Depth {
    left: LeftAt,
    space: u32,
    block: usize,
}

impl Sweep<'_> {
    /// What is left at points of the map in a space.
    fn map(&self, target: &Target<'_, '_>, found: &Found<'_, '_>, (space, enough): (u32, f64)) -> LeftMap {
        let counts = found.map.counts;
        let counts = if space == 0 { counts } else { [0, 1].map(|k| counts[k].min(POINTS[k])) };
        LeftMap::in_space(target, self.fields, &self.swept, (counts, self.places[space as usize], enough))
    }

    /// The contacts of all passes, row by row, and the places half-way between two; none of a pass with the side, which touches along lines.
    fn spots(&self) -> Vec<Spot> {
        let [passes, along] = &self.plan.shares;
        if passes.len() < 2 {
            return Vec::new();
        }
        let contacts = self.lattice.each().enumerate().map(|(k, (shares, frame))| {
            let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
            Spot { shares, line: [x, y, z, nx, ny, nz], pass: Some(k / along.len()) }
        });
        let between =
            passes.windows(2).flat_map(|pair| along.iter().map(move |share| [0.5 * (pair[0] + pair[1]), *share]));
        let between: Vec<[f64; 2]> = between.collect();
        let between =
            between.into_par_iter().map(|shares| Spot { shares, line: self.fields.surface.at(shares), pass: None });
        contacts.chain(between.collect::<Vec<Spot>>()).collect()
    }

    /// What is left at a place of a space, less the stock; nothing where that is as little as may be.
    fn too_high(&self, spot: &Spot, space: u32, allowed: f64) -> Option<f64> {
        let line = self.places[space as usize].placed(&spot.line);
        let left = self.swept.left_until(&line, self.stock + allowed);
        let height = left.map_or(f64::INFINITY, |left| left.height - self.stock);
        (height > allowed).then_some(height)
    }

    /// The highest ridge of a space near where most is known to be left, in it or in the first, and where the plan leaves most.
    fn highest(&self, (known, space): (LeftAt, u32), map: &LeftMap) -> (LeftAt, u32) {
        let starts: Vec<LeftAt> =
            map.highest_of_parts(PARTS).into_iter().chain(self.plan.cusp).chain([known]).collect();
        let stands = self.places[space as usize];
        let ridges = Ridges { fields: self.fields, swept: &self.swept, stands, cells: map.counts, stock: self.stock };
        (ridges.highest(&starts).map_or(known, |found| higher(known, found)), space)
    }

    /// Spaces that are to be milled.
    fn wanted(&self, spots: &[Spot], asked: u32) -> Vec<u32> {
        let all = self.places.len() as u32;
        let contacts: Vec<&Spot> = spots.iter().filter(|spot| spot.pass.is_some()).collect();
        // what lies deep in the cutter is not milled by it
        let is_left = |spot: &Spot, space: u32| {
            let left = self.swept.left(&self.places[space as usize].placed(&spot.line));
            left.is_some_and(|left| (left.height - self.stock).abs() <= self.limits.anywhere)
        };
        let is_cut = |space: u32| {
            let some = (0..FEW).filter_map(|k| contacts.get(k * (contacts.len().max(1) - 1) / (FEW - 1)));
            2 * some.filter(|spot| is_left(spot, space)).count() > FEW
        };
        let count = if asked == 1 && (1..all).any(is_cut) { all } else { asked.min(all) };
        (0..count).collect()
    }

    fn missing(&self, passes: &SweptCutter, spots: &[Spot], spaces: &[u32]) -> Missing {
        let Limits { anywhere, by_blocks, contact } = self.limits;
        // each place in each space at which more is left than at a contact or anywhere
        let of_space = |space: &u32| -> Vec<Option<f64>> {
            let allowed = |spot: &Spot| if spot.pass.is_some() { contact } else { anywhere };
            spots.par_iter().map(|spot| self.too_high(spot, *space, allowed(spot))).collect()
        };
        let found: Vec<Vec<Option<f64>>> = spaces.iter().map(of_space).collect();
        let is_left = |number: usize| found.iter().any(|heights| heights[number].is_some());
        // where passes leave more themselves a program may, too
        let planned = |number: usize| -> f64 {
            let left = if is_left(number) { passes.left(&spots[number].line) } else { None };
            left.map_or(f64::INFINITY, |left| left.height - self.stock)
        };
        let planned: Vec<f64> = (0..spots.len()).into_par_iter().map(planned).collect();
        let passes = self.plan.shares[0].len();
        let mut missing = Missing { allowed: anywhere, ..Missing::default() };
        let (mut absent, mut count) = (Vec::new(), 0);
        for (heights, space) in found.iter().zip(spaces) {
            let high = |number: usize, allowed: f64| heights[number].filter(|height| *height > allowed);
            let of_pass = |pass: usize| (0..spots.len()).filter(move |number| spots[*number].pass == Some(pass));
            let is_there = |pass: &usize| {
                of_pass(*pass).any(|number| high(number, contact.max(planned[number] + contact)).is_none())
            };
            let gone: Vec<usize> = (0..passes).filter(|pass| !is_there(pass)).collect();
            let is_high = |number: &usize| high(*number, anywhere.max(planned[*number] + by_blocks)).is_some();
            let reached = (0..spots.len()).filter(|number| planned[*number].is_finite());
            if !spots.is_empty() && reached.clone().count() > 0 && reached.clone().all(|number| is_high(&number)) {
                missing.spaces.push(*space);
                continue;
            }
            for number in (0..spots.len()).filter(is_high) {
                let left = LeftAt { shares: spots[number].shares, height: heights[number].unwrap_or(0.0) };
                count += 1;
                let worst = missing.high.map_or(left, |(known, ..)| higher(known, left));
                let of = missing.high.filter(|(known, ..)| *known == worst).map_or(*space, |(_, space, _)| space);
                missing.high = Some((worst, of, count));
            }
            let most = |pass: usize| {
                let known = of_pass(pass).filter_map(|number| Some((number, heights[number]?)));
                let known = known.map(|(number, height)| LeftAt { shares: spots[number].shares, height });
                known.filter(|left| left.height.is_finite()).reduce(higher)
            };
            absent.extend(gone.into_iter().map(|pass| (pass, *space, most(pass))));
        }
        // a program with other passes is measured by what it leaves alone
        let all = passes * (spaces.len() - missing.spaces.len());
        missing.passes = if 2 * absent.len() < all { absent } else { Vec::new() };
        missing
    }

    /// How deep blocks go that do not stay away, in spaces of the work: the deepest first, whose depths are solved.
    fn depths(&self, blocks: &[PoseSeries], spaces: &[u32]) -> Vec<Depth> {
        let places: Vec<SpacePlace> = spaces.iter().map(|space| self.places[*space as usize]).collect();
        let obstacle = Obstacle::new(self.fields.surface.clone());
        let guard = Guard::new(&obstacle, &self.cutter.body(), places.clone());
        let near = |number: usize| Some((number, guard.lowest(&blocks[number], self.stock + BESIDE)?));
        let mut found: Vec<(usize, Struck)> = (0..blocks.len()).into_par_iter().filter_map(near).collect();
        found.sort_unstable_by(|a, b| a.1.distance.total_cmp(&b.1.distance).then(a.0.cmp(&b.0)));
        let least = found.first().map_or(0.0, |(_, struck)| struck.distance);
        let close = found.iter().take_while(|(_, struck)| struck.distance < least + CLOSE).count().min(SOLVED);
        found[..close].par_iter_mut().for_each(|(number, struck)| *struck = guard.sharpened(&blocks[*number], *struck));
        found[..close].sort_unstable_by(|a, b| a.1.distance.total_cmp(&b.1.distance).then(a.0.cmp(&b.0)));
        let depth = |(rank, (block, struck)): (usize, (usize, Struck))| {
            let Struck { distance, place, shares, .. } = struck;
            let line = || places[place].placed(&self.fields.surface.at(shares));
            // along the normal: the distance from what lies deep in the cutter is that of its other side
            let over = if rank < LOOKED_AT { self.swept.left(&line()) } else { None };
            let (height, block) = over.map_or((distance, block), |over| (over.height, over.way));
            Depth { left: LeftAt { shares, height: height - self.stock }, space: spaces[place], block }
        };
        let mut all: Vec<Depth> = found.into_iter().enumerate().map(depth).collect();
        let looked_at = all.len().min(LOOKED_AT);
        all[..looked_at].sort_by(|a, b| a.left.height.total_cmp(&b.left.height));
        all
    }

    /// The least that the blocks of the plan leave, mm.
    fn planned(&self, positions: &[Vec<Vec<f64>>], machine: &Machine<'_, '_>, blocks: &Blocks) -> f64 {
        let straight = |pair: &[Vec<f64>]| match blocks.has_tip_control {
            true => machine.axes.straight_tip(&pair[0], &pair[1]),
            false => machine.axes.straight(&pair[0], &pair[1]),
        };
        let of_pass = |rows: &Vec<Vec<f64>>| rows.windows(2).map(straight).collect::<Vec<PoseSeries>>();
        let planned: Vec<PoseSeries> = positions.iter().flat_map(of_pass).collect();
        let swept = SweptCutter::of_blocks(planned.clone(), self.cutter);
        let sweep = Sweep { swept, places: vec![SpacePlace::default()], ..*self };
        sweep.depths(&planned, &[0]).first().map_or(0.0, |depth| depth.left.height)
    }
}
