//! A machine, a tool and a grid of points that nobody designed, and its text.

use std::fmt::Write;

use crate::machine::{Machine, Range};
use crate::oracle::{Oracle, Part};
use crate::pose::Vector;
use crate::tool::Shape;

/// What points are asked for by.
#[derive(Clone, Debug, PartialEq)]
pub enum Coordinate {
    /// A parameter of the tool or a motion, by its number.
    Unknown(usize),
    /// x, y or z.
    Along(usize),
    Rho,
    PolarAngle,
    /// z + share · x, which needs a name of its own.
    Mixed(f64),
    /// A tenth of z, by a table.
    Tabled,
}

#[derive(Clone, Debug)]
pub struct Asked {
    pub by: Coordinate,
    pub range: Range,
    pub count: usize,
}

impl Asked {
    pub fn value(&self, k: usize) -> f64 {
        if self.count == 1 { self.range.low } else { self.range.at(k as f64 / (self.count - 1) as f64) }
    }

    pub fn denser(&self, times: usize) -> Asked {
        Asked { count: (self.count - 1) * times + 1, ..self.clone() }
    }

    pub fn only(by: &Coordinate, value: f64) -> Asked {
        Asked { by: by.clone(), range: Range { low: value, high: value }, count: 1 }
    }
}

#[derive(Clone, Debug)]
pub struct Case {
    pub family: &'static str,
    pub machine: Machine,
    pub shape: Shape,
    pub patch: [Range; 2],
    pub sample: [Asked; 2],
    /// What the sample keeps of the last unknown.
    pub kept: Option<Range>,
    /// Another part of the tool, on a machine with the same work, and its parameters' ranges; both trim each other.
    pub trimmed_by: Option<(Machine, Shape, [Range; 2])>,
}

/// One job of a case: its grid, and whether the ranges are the wider ones.
#[derive(Clone, Debug)]
pub struct JobText {
    pub name: String,
    pub sample: [Asked; 2],
    pub is_wide: bool,
}

impl Coordinate {
    pub fn has_the_name_of(&self, other: &Coordinate) -> bool {
        self == other || matches!((self, other), (Coordinate::Mixed(_), Coordinate::Mixed(_)))
    }

    pub fn value(&self, unknowns: &[f64], [x, y, z]: Vector) -> f64 {
        match *self {
            Coordinate::Unknown(k) => unknowns[k],
            Coordinate::Along(k) => [x, y, z][k],
            Coordinate::Rho => x.hypot(y),
            Coordinate::PolarAngle => y.atan2(x),
            Coordinate::Mixed(share) => z + share * x,
            Coordinate::Tabled => 0.1 * z,
        }
    }

    /// How far a value is off what is asked for; whole turns do not count.
    pub fn miss(&self, value: f64, asked: f64) -> f64 {
        match self {
            Coordinate::PolarAngle => {
                (value - asked + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
            }
            _ => value - asked,
        }
    }
}

impl Case {
    pub fn ranges(&self, is_wide: bool) -> Vec<Range> {
        let motions = self.machine.motions.iter().map(|motion| motion.range);
        self.patch
            .iter()
            .copied()
            .chain(motions)
            .map(|range| if is_wide { range.wider_by(0.15).rounded() } else { range })
            .collect()
    }

    pub fn oracle(&self, is_wide: bool) -> Oracle<'_> {
        let ranges = self.ranges(is_wide);
        let own = Part { machine: &self.machine, shape: &self.shape, patch: [ranges[0], ranges[1]] };
        let other = self.trimmed_by.as_ref().map(|(machine, shape, patch)| Part { machine, shape, patch: *patch });
        Oracle::new([own].into_iter().chain(other).collect(), &ranges[2..])
    }

    pub fn is_angle(&self, unknown: usize) -> bool {
        match unknown.checked_sub(2) {
            None => self.shape.angles()[unknown],
            Some(motion) => self.machine.motions[motion].is_angle,
        }
    }

    fn unknown_name(&self, unknown: usize) -> &'static str {
        match unknown.checked_sub(2) {
            None if unknown == 1 && self.shape.blade().is_some() => "turn",
            None => ["u", "v"][unknown],
            Some(motion) => self.machine.motions[motion].name,
        }
    }

    fn asked_text(&self, asked: &Asked) -> String {
        let (name, unit) = match asked.by {
            Coordinate::Unknown(k) => (self.unknown_name(k).to_owned(), if self.is_angle(k) { " rad" } else { " mm" }),
            Coordinate::Along(k) => (["x", "y", "z"][k].to_owned(), " mm"),
            Coordinate::Rho => ("rho".to_owned(), " mm"),
            Coordinate::PolarAngle => ("polar_angle".to_owned(), " rad"),
            Coordinate::Mixed(share) => (format!("slanted = z + {share} * x"), " mm"),
            Coordinate::Tabled => ("tabled = row(z)".to_owned(), ""),
        };
        let Range { low, high } = asked.range;
        if asked.count == 1 {
            format!("{name}: {low}{unit}")
        } else {
            format!("{name}: {low}{unit} .. {high}{unit} by {}", asked.count)
        }
    }

    /// The spec with its jobs; the surface of each is named after it.
    pub fn text(&self, jobs: &[JobText]) -> String {
        let mut out = self.machine.text("mach");
        if let Some(blade) = self.shape.blade() {
            out += &blade.machine();
        }
        if let Some((machine, shape, patch)) = &self.trimmed_by {
            out += &machine.text("other_mach");
            out += &shape.text("other", *patch);
        }
        for (name, is_wide) in [("narrow", false), ("wide", true)] {
            if jobs.iter().any(|job| job.is_wide == is_wide) {
                let ranges = self.ranges(is_wide);
                out += &self.shape.text(name, [ranges[0], ranges[1]]);
            }
        }
        jobs.iter().for_each(|job| out += &self.job_text(job));
        out
    }

    fn job_text(&self, job: &JobText) -> String {
        let ranges = self.ranges(job.is_wide);
        let name = format!("{}_face", job.name);
        let mut out = format!("job {} {{\n", job.name);
        let _ = writeln!(out, "    tool c = {}", if job.is_wide { "wide" } else { "narrow" });
        if job.sample.iter().any(|asked| asked.by == Coordinate::Tabled) {
            out += "    let row = curve(\"rows.csv\", height: length, row: number)\n";
        }
        for (k, range) in ranges.iter().enumerate().skip(if self.shape.blade().is_some() { 1 } else { 2 }) {
            let (dimension, unit) = if self.is_angle(k) { ("angle", "rad") } else { ("length", "mm") };
            let name = self.unknown_name(k);
            let _ = writeln!(out, "    motion {name} : {dimension} in {} {unit} .. {} {unit}", range.low, range.high);
        }
        out += &self.generated(&name);
        let keep = self.kept.map_or(String::new(), |Range { low, high }| {
            let last = ranges.len() - 1;
            let unit = if self.is_angle(last) { "rad" } else { "mm" };
            format!("        keep {}: {low} {unit} .. {high} {unit}\n", self.unknown_name(last))
        });
        let [first, second] = job.sample.each_ref().map(|asked| self.asked_text(asked));
        let _ = writeln!(out, "    sample {name} {{\n        {first}\n        {second}\n{keep}    }}\n}}");
        out
    }

    /// What stands in a job from its machines to its surface.
    fn generated(&self, name: &str) -> String {
        let mut out = String::new();
        let blade = self.shape.blade().is_some();
        let over: Vec<&str> = self.machine.motions.iter().map(|motion| motion.name).collect();
        let over = over.join(", ");
        if blade {
            out += "    machine g = turning\n    mount c on g.blade\n    drive g.worm_turn = turn\n";
        }
        if blade && over.is_empty() {
            let _ = writeln!(out, "    surface {name} in g.worm = sweep(c.face, over: turn)");
            return out;
        }
        out += "    machine m = mach\n";
        out += &self.machine.drives("m");
        if blade {
            let _ = writeln!(out, "    surface {name}_tool in g.worm = sweep(c.face, over: turn)");
            let _ = writeln!(out, "    mount {name}_tool on m.holder");
            let _ = writeln!(out, "    surface {name} in m.work = envelope({name}_tool, over: [{over}])");
        } else {
            let _ = writeln!(
                out,
                "    mount c on m.holder\n    surface {name} in m.work = envelope(c.face, over: [{over}])"
            );
        }
        if let Some((machine, ..)) = &self.trimmed_by {
            let _ = writeln!(out, "    machine o = other_mach\n    tool d = other\n    mount d on o.holder");
            out += &machine.drives("o");
            let _ = writeln!(out, "    surface {name}_other in o.work = envelope(d.face, over: [{over}])");
            let _ = writeln!(out, "    trim {name} by {name}_other");
        }
        out
    }
}
