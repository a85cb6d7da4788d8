//! What is known of a milling in words.

use std::fmt;

use flank_export::fixed;

use super::clamp::Clamping;
use super::result::{BallAt, ClearanceKept, HeightLeft, HeightMap, MillResult, VerifiedProgram};
use super::side::SideLeft;
use crate::project::units;

/// Heights below this, um, are rounding: positions are some 100 mm long.
pub(super) const MEANT: f64 = 1e-6;

impl fmt::Display for MillResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.heading())?;
        self.facts().iter().try_for_each(|(name, text)| writeln!(f, "  {name:12} {text}"))?;
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl MillResult {
    /// What mills what.
    pub(crate) fn heading(&self) -> String {
        let MillResult { job, milling, surface, frame, cutter, .. } = self;
        format!("milling {milling} of {job}: {surface} ({frame}) with {cutter}")
    }

    /// What is known of it: names with what belongs to them.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let mut facts: Vec<(&str, String)> = Vec::new();
        if let (Some(passes), Some(step)) = (self.passes, self.pass_step) {
            facts.push(("passes", format!("{passes} by {}, at most {} mm apart", self.coordinates[0], fixed(step, 4))));
        }
        if let (Some(positions), Some(length)) = (self.positions, self.block_length) {
            let along = &self.coordinates[1];
            facts.push(("positions", format!("{positions} along {along}, at most {} mm apart", fixed(length, 4))));
        }
        facts.extend(self.side.iter().flat_map(SideLeft::facts));
        if let Some(path) = self.path_length {
            facts.push(("path", format!("{} mm", fixed(path, 1))));
        }
        if let Some(cusp) = &self.cusp {
            facts.push(("cusps", format!("at most {}", at(cusp))));
        }
        facts.extend(self.map.iter().flat_map(of_map));
        if let Some([most, least]) = &self.blocks {
            let how = match (self.axes.is_empty(), self.tool_centre_control) {
                (true, _) => "the cutter goes straight",
                (false, true) => "the tip and the rotary axes go straight",
                (false, false) => "the axes go straight",
            };
            facts.push(("blocks", format!("{how}; left {}", at(most))));
            facts.push(("", format!("too deep {}", at(&deep(least)))));
        }
        if let Some(gap) = &self.least_gap_curvature {
            facts.push(("radius", self.effective_radius.map_or("straight across the feed".to_string(), across)));
            facts.push(("gap", format!("bends by {} 1/mm at least, at {}", fixed(gap.curvature, 5), gap.place)));
            facts
                .push(("largest ball", self.largest_ball.as_ref().map_or("any by the curvature".to_string(), of_ball)));
        }
        for kept in &self.clearances {
            let (least, ClearanceKept { surface, body, place, .. }) = (fixed(kept.least, 4), kept);
            facts.push(("clear", format!("{body} comes as near as {least} mm to {surface}, at {place}")));
            if let Some(proven) = kept.proven.as_ref().filter(|proven| proven.proven == proven.blocks) {
                let blocks = units::counted(proven.blocks, "block");
                let limit = fixed(proven.limit, 4);
                facts.push((
                    "",
                    format!("proven to be nowhere nearer than {limit} mm on {blocks}, between positions, too"),
                ));
            }
        }
        for axis in &self.axes {
            let [low, high] = axis.extent.map(|end| fixed(end, 3));
            let (unit, rate) = (&axis.unit, fixed(axis.rate_per_mm, 3));
            facts.push(("axis", format!("{} from {low} to {high} {unit}, at most {rate} {unit} per mm", axis.name)));
        }
        if let Some(pole) = self.least_from_pole {
            facts.push(("pole", format!("at least {} deg away", fixed(pole, 3))));
        }
        facts.extend(self.clamping.iter().flat_map(Clamping::facts));
        facts.extend(self.verified.iter().flat_map(of_program));
        facts.into_iter().map(|(name, text)| (name.to_string(), text)).collect()
    }
}

fn across([least, most]: [f64; 2]) -> String {
    format!("{} .. {} mm across the feed", fixed(least, 3), fixed(most, 3))
}

fn of_ball(ball: &BallAt) -> String {
    format!("R {} mm by the curvature, at {}", fixed(ball.radius, 3), ball.place)
}

fn of_program(program: &VerifiedProgram) -> Vec<(&'static str, String)> {
    let VerifiedProgram { file, blocks, map, .. } = program;
    let words = if program.tool_centre_control { "the cutter in the work" } else { "the axes" };
    let blocks = units::counted(*blocks, "cutting block");
    let mut facts = vec![("program", format!("{file}: {blocks}, words of {words}"))];
    if program.spaces.len() > 1 {
        facts.push(("spaces", format!("{} of the work", program.spaces.len())));
    }
    facts.extend(of_map(map));
    facts
}

fn of_map(map: &HeightMap) -> Vec<(&'static str, String)> {
    let HeightMap { rows, columns, untouched, .. } = map;
    let mut facts = vec![("map", format!("{rows} x {columns} points, {untouched} of them not passed over"))];
    if let Some([most, least]) = &map.left {
        facts.push(("left", format!("at most {}", at(most))));
        facts.push(("", format!("at least {}", at(least))));
    }
    facts
}

/// Of what is rounding no place is told.
pub(super) fn at(left: &HeightLeft) -> String {
    let height = fixed(left.height_um, 4);
    if left.height_um.abs() < MEANT { format!("{height} um") } else { format!("{height} um, at {}", left.place) }
}

fn deep(left: &HeightLeft) -> HeightLeft {
    HeightLeft { height_um: -left.height_um, ..left.clone() }
}
