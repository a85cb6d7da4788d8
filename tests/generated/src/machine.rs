//! A machine twice: as the text of a spec and as poses that are computed from numbers.

use std::fmt::Write;

use crate::pose::{Pose, Vector};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub low: f64,
    pub high: f64,
}

impl Range {
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    pub fn at(self, share: f64) -> f64 {
        self.low + share * self.width()
    }

    /// With few digits, so that specs stay readable.
    pub fn rounded(self) -> Range {
        Range { low: rounded(self.low), high: rounded(self.high) }
    }

    pub fn wider_by(self, share: f64) -> Range {
        Range { low: self.at(-share), high: self.at(1.0 + share) }
    }

    pub fn holds(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// To four decimals.
pub fn rounded(x: f64) -> f64 {
    (1e4 * x).round() / 1e4 + 0.0
}

/// A motion, mm or radians.
#[derive(Clone, Debug)]
pub struct Motion {
    pub name: &'static str,
    pub is_angle: bool,
    pub range: Range,
}

/// x, y and z.
pub const AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// What a step moves along or about.
#[derive(Clone, Debug)]
pub enum Kind {
    Shift(Vector),
    Turn(Vector),
    /// With what it moves along for each radian, mm.
    Screw(Vector, f64),
    Mirror(Vector),
}

/// A step of a chain of frames, by `constant + Σ slope · motion + wave · sin(first motion)`, mm or radians.
#[derive(Clone, Debug)]
pub struct Step {
    pub kind: Kind,
    pub constant: f64,
    pub slopes: Vec<f64>,
    pub wave: f64,
}

impl Step {
    pub fn fixed(kind: Kind, by: f64) -> Step {
        Step { kind, constant: by, slopes: Vec::new(), wave: 0.0 }
    }

    pub fn moved(kind: Kind, constant: f64, slopes: &[f64]) -> Step {
        Step { kind, constant, slopes: slopes.to_vec(), wave: 0.0 }
    }

    fn moves(&self) -> bool {
        self.wave != 0.0 || self.slopes.iter().any(|slope| *slope != 0.0)
    }

    fn pose(&self, motions: &[f64]) -> Pose {
        let linear: f64 = self.slopes.iter().zip(motions).map(|(slope, m)| slope * m).sum();
        let by = self.constant + linear + if self.wave == 0.0 { 0.0 } else { self.wave * motions[0].sin() };
        match self.kind {
            Kind::Shift(along) => Pose::shifted(along.map(|x| x * by)),
            Kind::Turn(axis) => Pose::screwed(axis, by, 0.0),
            Kind::Screw(axis, lead) => Pose::screwed(axis, by, lead * by),
            Kind::Mirror(normal) => Pose::mirrored(normal),
        }
    }

    fn is_angle(&self) -> bool {
        matches!(self.kind, Kind::Turn(_) | Kind::Screw(..))
    }

    fn unit(&self) -> &'static str {
        if self.is_angle() { "rad" } else { "mm" }
    }

    /// The transform of a frame by an amount that is given as text.
    fn text(&self, by: &str) -> String {
        let vector = |[x, y, z]: Vector| format!("[{x}, {y}, {z}]");
        let along =
            |axis: Vector| ["x", "y", "z"].into_iter().zip(AXES).find(|(_, own)| *own == axis).map(|(name, _)| name);
        match self.kind {
            Kind::Shift(axis) => match (along(axis), axis) {
                (Some(name), _) => format!("translate_{name}({by})"),
                (None, [x, y, z]) => format!("translate({x} * {by}, {y} * {by}, {z} * {by})"),
            },
            Kind::Turn(axis) => match along(axis) {
                Some(name) => format!("rotate_{name}({by})"),
                None => format!("rotate({}, {by})", vector(axis)),
            },
            Kind::Screw(axis, lead) => format!("screw({}, {by}, {lead} mm/rad)", vector(axis)),
            Kind::Mirror(normal) => format!("mirror({})", vector(normal)),
        }
    }

    fn law(&self, motions: &[Motion]) -> String {
        let unit = self.unit();
        let mut out = format!("{} {unit}", self.constant);
        for (slope, motion) in self.slopes.iter().zip(motions).filter(|(slope, _)| **slope != 0.0) {
            // an angle counts as a number where it must be one
            let per = match (self.is_angle(), motion.is_angle) {
                (true, true) | (false, false) => String::new(),
                (false, true) => " mm".to_owned(),
                (true, false) => " rad/mm".to_owned(),
            };
            let _ = write!(out, " + {slope}{per} * {}", motion.name);
        }
        if self.wave != 0.0 {
            let _ = write!(out, " + {} {unit} * sin({})", self.wave, motions[0].name);
        }
        out
    }
}

/// Two chains of frames from the bed, to the work and to the tool's holder.
#[derive(Clone, Debug)]
pub struct Machine {
    pub work: Vec<Step>,
    pub tool: Vec<Step>,
    pub motions: Vec<Motion>,
}

impl Machine {
    /// Of the work and of the tool in the bed.
    fn poses(&self, motions: &[f64]) -> [Pose; 2] {
        let of = |chain: &[Step]| chain.iter().fold(Pose::AT_REST, |pose, step| pose.then(&step.pose(motions)));
        [of(&self.work), of(&self.tool)]
    }

    pub fn at(&self, motions: &[f64]) -> Position {
        let [work, tool] = self.poses(motions);
        Position { work, tool }
    }

    /// `machine NAME { … }`
    pub fn text(&self, name: &str) -> String {
        let (mut axes, mut frames) = (String::new(), String::from("    frame bed\n"));
        for (chain, prefix, last) in [(&self.work, "w", "work"), (&self.tool, "t", "holder")] {
            let mut parent = "bed".to_owned();
            for (k, step) in chain.iter().enumerate() {
                let frame = if k + 1 == chain.len() { last.to_owned() } else { format!("{prefix}{k}") };
                let by = if step.moves() {
                    let kind = if step.is_angle() { "rotary" } else { "linear" };
                    let _ = writeln!(axes, "    axis {}{k} : {kind}", prefix.to_uppercase());
                    format!("{}{k}", prefix.to_uppercase())
                } else {
                    format!("{} {}", step.constant, step.unit())
                };
                let _ = writeln!(frames, "    frame {frame} in {parent} = {}", step.text(&by));
                parent = frame;
            }
            if chain.is_empty() {
                let _ = writeln!(frames, "    frame {last} in bed = translate_z(0 mm)");
            }
        }
        format!("machine {name} {{\n{axes}{frames}}}\n")
    }

    /// `drive MACHINE.… = …` for each axis.
    pub fn drives(&self, machine: &str) -> String {
        let mut out = String::new();
        for (chain, prefix) in [(&self.work, "W"), (&self.tool, "T")] {
            for (k, step) in chain.iter().enumerate().filter(|(_, step)| step.moves()) {
                let _ = writeln!(out, "    drive {machine}.{prefix}{k} = {}", step.law(&self.motions));
            }
        }
        out
    }
}

/// Where work and tool stand.
#[derive(Clone, Copy, Debug)]
pub struct Position {
    work: Pose,
    tool: Pose,
}

impl Position {
    /// A point of the tool in the work.
    pub fn in_work(&self, p: Vector) -> Vector {
        self.work.point_back(self.tool.point(p))
    }

    /// A point of the work in the tool.
    pub fn in_tool(&self, p: Vector) -> Vector {
        self.tool.point_back(self.work.point(p))
    }
}
