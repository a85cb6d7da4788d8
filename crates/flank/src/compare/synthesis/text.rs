//! The synthesis of a contact, for people.

use std::fmt;

use flank_export::fixed;

use super::result::{CheckedContact, ReachedCondition, SynthesisResult, SynthesizedSetting};
use crate::compare::fit::result::RangeBound;
use crate::contact::result::ContactKind;
use crate::project::columns::aligned;
use crate::project::units;

impl fmt::Display for SynthesisResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SynthesisResult { job, want, contact, surface, film_um, .. } = self;
        writeln!(f, "{want} of {job}: contact {contact} at its vertex, on {surface}\n")?;
        writeln!(f, "{}", conditions(&self.conditions).trim_end())?;
        if self.conditions.iter().any(|of| of.name == "ellipse") {
            writeln!(f, "\nellipse: its longer axis at {} um of compound", fixed(*film_um, 2))?;
        }
        if !self.settings.is_empty() {
            writeln!(f, "\n{}", settings(&self.settings).trim_end())?;
        }
        if let Some(all) = self.chosen_of {
            writeln!(f, "\nchosen: {} of {} that change it", self.settings.len(), units::counted(all, "setting"))?;
        }
        if let Some(checked) = &self.checked {
            writeln!(f, "\nwhole contact with these settings: {}", checked.words())?;
        }
        if let Some(text) = &self.corrected {
            write!(f, "\n{text}")?;
        }
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

fn conditions(of: &[ReachedCondition]) -> String {
    let head = ["", "now", "wanted", "within", "reached", ""].map(String::from);
    let number = |of: Option<f64>| of.map_or("-".to_string(), |value| fixed(value, 6));
    let row = |of: &ReachedCondition| {
        let within = of.within.map_or("exactly".to_string(), |within| fixed(within, 6));
        let reached = of.checked.or(of.reached);
        [of.name.clone(), number(of.now), fixed(of.wanted, 6), within, number(reached), of.unit.clone()]
    };
    let rows: Vec<[String; 6]> = [head].into_iter().chain(of.iter().map(row)).collect();
    aligned(&rows, "<>>>><")
}

fn settings(of: &[SynthesizedSetting]) -> String {
    let head = ["setting", "now", "change", "new", "", "at a bound"].map(String::from);
    let row = |of: &SynthesizedSetting| {
        let bound = match of.at_bound {
            Some(RangeBound::Low) => "lower",
            Some(RangeBound::High) => "upper",
            None => "-",
        };
        let [now, change, new] = [of.now, of.change, of.new].map(|value| fixed(value, 6));
        [of.name.clone(), now, change, new, of.unit.clone(), bound.to_string()]
    };
    let rows: Vec<[String; 6]> = [head].into_iter().chain(of.iter().map(row)).collect();
    aligned(&rows, "<>>><<")
}

impl CheckedContact {
    fn words(&self) -> String {
        let kind = match self.kind {
            Some(ContactKind::Point) => "contact in a point",
            Some(ContactKind::Line) => "contact along a line",
            Some(ContactKind::Crossing) => "the flanks run into each other",
            Some(ContactKind::Edge) => "contact at an edge",
            None => "no contact",
        };
        let mut words = vec![kind.to_string()];
        words.extend(
            self.least_um
                .filter(|least| *least < 0.0)
                .map(|least| format!("they reach into each other by {} um", fixed(-least, 3))),
        );
        if self.is_free {
            words.push("the edges of both flanks are free".to_string());
        }
        if !self.touches.is_empty() {
            words.push(format!("the pattern reaches {}", self.touches.join(", ")));
        }
        words.extend(self.edges.iter().map(|edge| format!("{} carries", edge.edge)));
        words.dedup();
        words.join("; ")
    }
}
