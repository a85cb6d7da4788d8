//! What is known of a contact in words.

use std::fmt;

use flank_export::fixed;

use crate::contact::result::{
    ContactInfluence, ContactKind, ContactMiddle, ContactPattern, ContactResult, InfluenceKind, MilledContact,
    MilledPattern, TransmissionError,
};
use crate::project::units;

/// Below this a parabola or a curvature of the gap is zero, in the units in which it is printed: rounding.
const NOTHING: f64 = 1e-9;

/// A thickness as it was given: what changes between units leaves behind is none of it.
fn film(um: f64) -> String {
    format!("{}", format!("{um:.12e}").parse().unwrap_or(um))
}

fn small(value: f64) -> String {
    if value.abs() < NOTHING { "0".to_string() } else { units::scientific(value, 3) }
}

impl fmt::Display for ContactResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.heading())?;
        self.facts().iter().try_for_each(|(name, text)| writeln!(f, "  {name:12} {text}"))?;
        self.write_influences(f)?;
        self.write_vhj(f)?;
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl ContactResult {
    /// What touches what.
    pub(crate) fn heading(&self) -> String {
        let [first, second] = &self.members;
        let ContactResult { job, contact, over, unknown, .. } = self;
        format!(
            "contact {contact} of {job}: {} ({}) with {} ({}), over {over}, for {unknown}",
            first.surface, first.frame, second.surface, second.frame
        )
    }

    /// What is known of it: names with what belongs to them, some names several times.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let ContactResult { over, over_unit, .. } = self;
        let mut facts: Vec<(&str, String)> = Vec::new();
        for error in &self.mounted {
            let value = (error.value * 1e9).round() / 1e9;
            facts.push(("mounted", format!("{} {value} {} off", error.axis, error.unit)));
        }
        facts.extend(self.middle.iter().flat_map(|middle| self.of_middle(middle)));
        if let Some(error) = &self.error {
            let transfers: Vec<String> = error.transfers.iter().map(|turn| fixed(*turn, 3)).collect();
            let handed = match transfers.len() {
                0 => String::new(),
                _ => format!(", transfer at {over} {} {over_unit}", transfers.join(" and ")),
            };
            let (size, unit) = (fixed(error.peak_to_peak, 3), &error.unit);
            facts.push(("error", format!("peak to peak {size} {unit} over {}{handed}", error.over(over_unit))));
            facts.extend(error.gap.iter().map(|gap| {
                let [from, to] = [gap.from, gap.to].map(|turn| fixed(turn, 3));
                let why = if gap.is_of_roll { ": the range of the roll ends" } else { "" };
                ("", format!("no pair is known to touch from {over} {from} to {to} {over_unit}{why}"))
            }));
        }
        if let Some(ratio) = self.ratio {
            let pairs = self.error.as_ref().map_or(String::new(), |error| {
                format!("; up to {} within the film at a time", units::counted(error.pairs, "pair"))
            });
            facts.push(("ratio", format!("{} on the flanks{pairs}", fixed(ratio, 3))));
        }
        for end in &self.ends {
            let what = if end.is_begin { "begins" } else { "ends" };
            let at = end.at.as_deref().unwrap_or("the end of what its tool makes");
            let turn = fixed(end.turn, 3);
            facts.push(("flanks", format!("contact {what} at {over} {turn} {over_unit}: {at} of {}", end.of)));
        }
        if self.error.is_some() && self.edges.is_empty() && self.members.iter().any(|member| member.solid.is_some()) {
            facts.push(("edges", "no edge carries".to_string()));
        }
        for edge in &self.edges {
            let [from, to] = [edge.from, edge.to].map(|turn| fixed(turn, 3));
            facts.push(("edges", format!("{} carries from {over} {from} to {to} {over_unit}", edge.edge)));
        }
        facts.extend(self.pattern.iter().map(|pattern| ("pattern", pattern.text())));
        let known = self.error.as_ref().map_or("a pitch".to_string(), |error| error.over(over_unit));
        facts.extend(self.milled.iter().flat_map(|milled| milled.facts(&known)));
        if let Some(backlash) = &self.backlash {
            let (unit, other) = (&self.unknown_unit, &backlash.other);
            let (least, normal, turn) = (fixed(backlash.least, 5), fixed(backlash.normal, 4), fixed(backlash.turn, 3));
            facts.push((
                "backlash",
                format!("{least} {unit}, {normal} mm along the normal, to {other} at {over} {turn} {over_unit}"),
            ));
        }
        if self.kind.is_some() && self.clearances.is_empty() && self.members.iter().any(|member| member.solid.is_some())
        {
            let nothing = match self.members.iter().all(|member| member.space.is_empty()) {
                true => "only the flanks are looked at: no solid names fillets or roots of its spaces",
                false => "no edge comes together with what else the tooth spaces have",
            };
            facts.push(("room", nothing.to_string()));
        }
        for room in &self.clearances {
            let (least, turn) = (fixed(room.least_mm, 4), fixed(room.turn, 3));
            let what = format!("edges of {} to {}", room.of, room.with);
            facts.push(("room", format!("{least} mm from {what}, least at {over} {turn} {over_unit}")));
        }
        if let Some(proven) = &self.proven {
            let near = proven.radius_mm.zip(proven.error).map_or(String::new(), |(radius, error)| {
                let (radius, error) = (units::scientific(radius, 1), units::scientific(error, 1));
                format!(": exactly one contact within {radius} mm and {error} {} of each", self.unknown_unit)
            });
            facts.push((
                "proven",
                format!("{} of {}{near}", proven.points, units::counted(self.timing.points, "position")),
            ));
        }
        facts.into_iter().map(|(name, text)| (name.to_string(), text)).collect()
    }

    fn of_middle(&self, middle: &ContactMiddle) -> Vec<(&'static str, String)> {
        let ContactResult { over, over_unit, unknown_unit, .. } = self;
        let error_unit = self.error.as_ref().map_or("", |error| error.unit.as_str());
        let mut facts: Vec<(&str, String)> = Vec::new();
        for (member, place) in self.members.iter().zip(&middle.on) {
            let shares = place
                .shares
                .map_or(String::new(), |[u, v]| format!("lengthwise {}, profilewise {}; ", fixed(u, 3), fixed(v, 3)));
            let (z, rho) = (fixed(place.z, 3), fixed(place.rho, 3));
            let path = place
                .path_angle
                .map_or(String::new(), |angle| format!("; the path at {} deg to its rows", fixed(angle, 1)));
            facts.push(("middle", format!("{shares}z {z} mm, rho {rho} mm on {}{path}", member.surface)));
        }
        let vertex = match (middle.is_vertex, &middle.edge) {
            (_, Some(_)) => "where an edge touches and the flanks do not",
            (true, None) => "where the error is extreme",
            (false, None) => "in the middle of contact of the flanks",
        };
        facts.push(("roll", format!("{over} {} {over_unit}, {vertex}", fixed(middle.turn, 3))));
        let kind = match (self.kind, &middle.edge) {
            (Some(ContactKind::Line), _) => "line contact".to_string(),
            (Some(ContactKind::Crossing), _) => {
                "no contact: the flanks run into each other beside the point, so that edges carry".to_string()
            }
            (_, Some(edge)) => format!("contact at an edge: {edge}"),
            _ => "contact in a point".to_string(),
        };
        let gap =
            middle.gap.map_or(String::new(), |[a, b]| format!(", gap curvatures {} and {} 1/mm", small(a), small(b)));
        let film = self.pattern.first().map_or(String::new(), |pattern| format!(" at {} um", film(pattern.film_um)));
        let ellipse = middle.ellipse.map_or(String::new(), |[a, b]| {
            format!(", ellipse {} x {} mm{film}", fixed(2.0 * a, 2), fixed(2.0 * b, 2))
        });
        facts.push(("contact", format!("{kind}{gap}{ellipse}")));
        let (error, parabola) = (fixed(middle.error, 7), small(middle.parabola));
        facts.push(("error", format!("{error} {unknown_unit} there, parabola {parabola} {error_unit}/{over_unit}^2")));
        let [sliding, entraining] = [middle.sliding, middle.entraining].map(|speed| fixed(speed, 3));
        facts.push(("velocities", format!("sliding {sliding}, entraining {entraining} mm/rad of {over}")));
        facts
    }

    /// A row for each place, and from toe to heel.
    fn write_vhj(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for rows in self.vhj.chunk_by(|a, b| a.axes == b.axes) {
            writeln!(f)?;
            let mounted = |errors: &[f64]| {
                let each =
                    rows[0].axes.iter().zip(errors).map(|(axis, error)| format!("{axis} {:>8} mm", fixed(*error, 4)));
                each.collect::<Vec<String>>().join(", ")
            };
            let unchanged = if rows[0].axes.len() > 2 { ", the error as it is" } else { "" };
            for row in rows {
                let (to, lengthwise) = (&row.to, fixed(row.lengthwise, 1));
                let nothing = || format!("no {} bring the contact there", row.axes.join(" and "));
                let mounting = row.errors.as_deref().map_or_else(nothing, mounted);
                let beyond = match row.beyond.len() {
                    0 => String::new(),
                    _ => format!("; beyond its range: {}", row.beyond.join(", ")),
                };
                writeln!(f, "  to {to:9} lengthwise {lengthwise}: {mounting}{unchanged}{beyond}")?;
            }
            if let [Some(toe), .., Some(heel)] = &rows.iter().map(|row| row.errors.as_ref()).collect::<Vec<_>>()[..] {
                let way: Vec<f64> = heel.iter().zip(toe.iter()).map(|(heel, toe)| heel - toe).collect();
                writeln!(f, "  toe to heel{:18}{}", ":", mounted(&way))?;
            }
        }
        Ok(())
    }

    fn write_influences(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.error.as_ref().map_or("", |error| error.unit.as_str());
        for (kind, title) in [(InfluenceKind::Mounting, "axis"), (InfluenceKind::Setting, "setting")] {
            let (shown, rest): (Vec<_>, Vec<_>) =
                self.influences.iter().filter(|of| of.kind == kind).partition(|of| of.is_shown());
            let width = shown.iter().map(|of| of.name.len()).max().unwrap_or(0).max(title.len());
            if !shown.is_empty() {
                writeln!(f, "\n  {title:width$}  per       moves on both, mm   {unit:>9}  parabola %  ellipse %")?;
            }
            for of in &shown {
                let [a, b] = of.moved_mm.map(|way| fixed(way, 4));
                let percent = |share: Option<f64>| share.map_or("-".to_string(), |share| fixed(100.0 * share, 2));
                let (error, parabola, ellipse) = (fixed(of.error, 3), percent(of.parabola), percent(of.ellipse));
                let (name, per) = (&of.name, &of.per);
                writeln!(f, "  {name:width$}  {per:8}  {a:>8} {b:>8}   {error:>9}  {parabola:>10}  {ellipse:>9}")?;
            }
            if !rest.is_empty() {
                let more = rest.len();
                writeln!(f, "  {more} more: less than this table can show")?;
            }
        }
        Ok(())
    }
}

impl TransmissionError {
    /// How far of the roll it is known, in words.
    fn over(&self, unit: &str) -> String {
        let known = fixed(self.over, 3);
        match (self.pitch, &self.gap) {
            (Some(_), None) => "a pitch".to_string(),
            (Some(pitch), Some(_)) => format!("{known} of a pitch of {} {unit}", fixed(pitch, 3)),
            (None, _) => format!("{known} {unit} of the roll"),
        }
    }
}

impl MilledContact {
    fn facts(&self, known: &str) -> Vec<(&'static str, String)> {
        let MilledContact { milling, surface, unit, patterns, .. } = self;
        let [size, generated, least, most, bound] =
            [self.peak_to_peak, self.generated_peak_to_peak, self.ahead[0], self.ahead[1], self.at_most]
                .map(|value| fixed(value, 3));
        let [ridge, least_left] = [self.ridge_um, self.least_um].map(|height| fixed(height, 3));
        let (what, holds) = match self.has_one_pass {
            true => (format!("one pass leaves {least_left} to {ridge} um"), "it holds the pair"),
            false => (format!("ridges up to {ridge} um"), "the ridges hold it"),
        };
        let share = |pattern: &MilledPattern| fixed(100.0 * pattern.within as f64 / pattern.points.max(1) as f64, 1);
        let [of_generated, of_milled] = patterns.each_ref().map(share);
        vec![
            ("milled", format!("{surface} by {milling}, {what}")),
            ("", format!("error peak to peak {size} {unit} over {known}, of the generated pair {generated}")),
            ("", format!("{holds} {least} to {most} {unit} away; {bound} at the most")),
            ("", format!("pattern {of_milled} % of the milled part, as generated {of_generated} %")),
        ]
    }
}

impl ContactInfluence {
    /// Whether a table with four decimals of a millimetre and three of an error shows more than zeros.
    pub(crate) fn is_shown(&self) -> bool {
        self.moved_mm.iter().any(|way| *way >= 5e-5) || self.error.abs() >= 5e-4
    }
}

impl ContactPattern {
    fn text(&self) -> String {
        let ContactPattern { surface, within, points, film_um, .. } = self;
        let share = fixed(100.0 * *within as f64 / (*points).max(1) as f64, 1);
        let extent = self.rows.zip(self.columns).map_or(String::new(), |([a, b], [c, d])| {
            let [a, b, c, d] = [a, b, c, d].map(|share| fixed(share, 2));
            format!(", rows {a} to {b}, columns {c} to {d} of its sample")
        });
        let least = self.least_um.map_or(String::new(), |least| format!(", least gap {} um", fixed(least, 3)));
        let touches = match self.touches.len() {
            0 => String::new(),
            _ => format!("; touches {}", self.touches.join(", ")),
        };
        format!("{share} % of {surface} within {} um{extent}{least}{touches}", film(*film_um))
    }
}
