//! What the solver's results look like to a writer of files.

use schemars::JsonSchema;
use serde::Serialize;

use crate::files::error::Malformed;
use crate::points::known::Known;
use crate::points::tally::Tally;
use crate::text::one_line;

/// Everything one job produced, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    /// Where the surfaces come from.
    pub header: Header,
    /// The surfaces, in the order they appear in files.
    pub patches: Vec<Patch>,
}

/// Where a dataset comes from; stated at the head of every file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Program and version, such as `flank 0.1.0`.
    pub program: String,
    /// The spec file, as the user gave it. A picture of an empty one says nothing of where it comes from, nor of residuals.
    pub spec: String,
    /// Hash of what the spec says.
    pub spec_hash: String,
    /// The job of the spec that was run.
    pub job: String,
    /// Further sentences on conventions, written as they are.
    pub conventions: Vec<String>,
}

/// One surface: a grid of points in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Name of the surface, such as `right flank`.
    pub name: String,
    /// The frame of positions and normals, such as `m.table`.
    pub frame: String,
    /// How the spaces of its body follow each other.
    pub layout: Layout,
    /// What index `i` runs over.
    pub rows: Axis,
    /// What index `j` runs over.
    pub columns: Axis,
    /// What the numbers in [`Point::unknowns`] are, in the same order.
    pub unknowns: Vec<Unknown>,
    /// The points, row by row: point `(i, j)` is at `i * columns.count + j`.
    pub points: Vec<Point>,
    /// What more is known of the points, in the order it appears in files.
    pub fields: Vec<Field>,
}

/// How the spaces of a body follow each other, which says where its teeth have their tips.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Layout {
    /// About z: tips lie away from it, or towards it.
    #[default]
    Round,
    /// Beside each other along y, as those of a rack.
    Straight {
        /// Whether tips lie in the direction of x, or against it; where nothing says so, a flank leans to its tip.
        tips_to_x: Option<bool>,
    },
}

impl Layout {
    /// Where a point lies in the section of the blank: along z, and the distance from it or x.
    #[must_use]
    pub fn section(self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        match self {
            Layout::Round => [z, x.hypot(y)],
            Layout::Straight { .. } => [z, x],
        }
    }

    /// Beside a point: away from the axis, or x; from a space to the next.
    #[must_use]
    pub fn directions(self, [x, y, _]: [f64; 3]) -> [[f64; 3]; 2] {
        match self {
            Layout::Round => {
                let radius = x.hypot(y).max(f64::MIN_POSITIVE);
                [[x / radius, y / radius, 0.0], [-y / radius, x / radius, 0.0]]
            }
            Layout::Straight { .. } => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }
}

/// Something more that is known of each solved point of a patch: a curvature, a direction, a sensitivity.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Its name, such as `k1`: the title of its column. A vector's columns are `name_x`, `name_y`, `name_z`.
    pub name: String,
    /// The unit that its values are handed over and written in, such as `1/mm`; `1` for a plain number or a direction.
    pub unit: String,
    /// One sentence for the head of files, with the sign convention.
    pub meaning: String,
    /// One value for each point, in the order of the points.
    pub values: Values,
}

/// The values of a field: none where it is not defined; what a point that is not solved has is not written.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// A number for each point.
    Scalars(Known<f64>),
    /// A vector in the patch's frame for each point.
    Vectors(Known<[f64; 3]>),
}

/// One direction of a grid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "GridAxis")]
pub struct Axis {
    /// What changes along it, such as `z`, or from where to where it runs, such as `toe -> heel`.
    pub label: String,
    /// How many points it has.
    pub count: usize,
}

impl Axis {
    /// The label of the one row of points that are no neighbours of each other.
    pub const LIST: &'static str = "list";

    /// Whether its points are no neighbours of each other: no line joins them.
    pub fn is_list(&self) -> bool {
        self.label == Axis::LIST
    }
}

/// One of the parameters a surface was solved for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Unknown {
    /// Its name in the spec.
    pub name: String,
    /// The unit it is written in.
    pub unit: Unit,
}

/// The unit a number is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
pub enum Unit {
    /// A length, in mm.
    #[serde(rename = "mm")]
    Millimetre,
    /// An angle: handed over in radians, written in degrees. It is not reduced to one turn.
    #[serde(rename = "deg")]
    Degree,
    /// A number without a unit.
    #[serde(rename = "1")]
    One,
}

/// One grid point.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Whether the rest means anything, and whether the point belongs to the finished work.
    pub outcome: Outcome,
    /// Position in the patch's frame, mm.
    pub position: [f64; 3],
    /// Unit normal in the patch's frame; it points out of the body that owns the surface.
    pub normal: [f64; 3],
    /// Values of the patch's unknowns: mm, radians or plain numbers. May be empty where the point is not placed.
    pub unknowns: Vec<f64>,
    /// What the solved equations leave.
    pub residual: f64,
    /// More on a status other than `solved`: which unknown lies how far outside, how long was iterated, what cuts the
    /// point away. May be empty.
    pub reason: String,
}

/// Whether a point was solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Position, normal, unknowns and residual are those of a root.
    Solved,
    /// They are those of a root that is no point of the finished work: the tool that generates it cuts it away. Tables show its
    /// numbers; meshes and pictures leave it out, and it has no fields.
    Undercut,
    /// The same, where another surface cuts it away.
    Trimmed,
    /// The same, where it is not known whether something cuts it away.
    Undecided,
    /// There is no such point, and the word says why: `out_of_range`, `singular`, `not_converged`. Of the point's numbers
    /// only the residual is written: what the best attempt left. [`Point::reason`] says more.
    Unsolved(&'static str),
}

impl Unit {
    /// How files name the unit: `mm`, `deg` or `1`.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Degree => "deg",
            Unit::One => "1",
        }
    }

    /// A value as it is written: radians become degrees.
    pub fn written(self, value: f64) -> f64 {
        match self {
            Unit::Degree => value.to_degrees(),
            Unit::Millimetre | Unit::One => value,
        }
    }
}

impl Field {
    /// The titles of its columns: its name, or that with `_x`, `_y`, `_z`.
    pub fn columns(&self) -> Vec<String> {
        match self.values {
            Values::Scalars(_) => vec![self.name.clone()],
            Values::Vectors(_) => ["x", "y", "z"].map(|axis| format!("{}_{axis}", self.name)).into(),
        }
    }

    /// Whether another field's values go into the same columns.
    pub(crate) fn shares_columns(&self, other: &Field) -> bool {
        self.name == other.name && self.unit == other.unit && self.columns().len() == other.columns().len()
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Values::Scalars(values) => values.len(),
            Values::Vectors(values) => values.len(),
        }
    }

    /// The numbers of one point: one or three, none where there is no value.
    pub(crate) fn at(&self, point: usize) -> &[f64] {
        match self {
            Values::Scalars(values) => values.numbers(point),
            Values::Vectors(values) => values.numbers(point),
        }
    }
}

impl Outcome {
    /// The word in a file's status column; `solved` if it is.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Solved => "solved",
            Outcome::Undercut => "undercut",
            Outcome::Trimmed => "trimmed",
            Outcome::Undecided => "undecided",
            Outcome::Unsolved(word) => word,
        }
    }
}

impl Point {
    /// A point that was asked for and has no solution; `why` is its status word, `residual` what the best attempt left
    /// (NaN if there was none), `reason` what more there is to say.
    #[must_use]
    pub fn unsolved(why: &'static str, residual: f64, reason: String) -> Self {
        Point {
            outcome: Outcome::Unsolved(why),
            position: [f64::NAN; 3],
            normal: [f64::NAN; 3],
            unknowns: Vec::new(),
            residual,
            reason,
        }
    }

    /// The residual, unless there was nothing to measure.
    pub(crate) fn known_residual(&self) -> Option<f64> {
        Some(self.residual).filter(|residual| residual.is_finite())
    }

    /// Whether the point belongs to the finished work: what meshes and pictures show.
    #[must_use]
    pub fn is_solved(&self) -> bool {
        self.outcome == Outcome::Solved
    }

    /// Whether the point's numbers are those of a point of the surface, be it undercut or trimmed: what tables show.
    #[must_use]
    pub fn is_placed(&self) -> bool {
        !matches!(self.outcome, Outcome::Unsolved(_))
    }
}

impl Patch {
    /// The grid point in row `i` and column `j`, if there is one.
    #[must_use]
    pub fn point(&self, i: usize, j: usize) -> Option<&Point> {
        if i >= self.rows.count || j >= self.columns.count {
            return None;
        }
        self.points.get(i.checked_mul(self.columns.count)?.checked_add(j)?)
    }

    /// Points with their row and column, in the order of files; `first` is the number of the first.
    pub fn numbered<'p>(&self, first: usize, points: &'p [Point]) -> impl Iterator<Item = (usize, usize, &'p Point)> {
        let columns = self.columns.count.max(1);
        (first..).zip(points).map(move |(at, point)| (at / columns, at % columns, point))
    }

    /// Its frame, what rows and columns run over, and how much of it is solved by a tally of its points; one line.
    pub(crate) fn told(&self, tally: &Tally) -> String {
        format!(
            "frame {}; {} rows i: {}; {} columns j: {}; {}",
            one_line(&self.frame),
            self.rows.count,
            one_line(&self.rows.label),
            self.columns.count,
            one_line(&self.columns.label),
            tally.verdict(),
        )
    }

    pub(crate) fn check(&self) -> Result<(), Malformed> {
        if self.rows.count.checked_mul(self.columns.count) != Some(self.points.len()) {
            return Err(miscounted(self, self.points.len()));
        }
        self.check_fields(self.points.len())?;
        self.check_points(0, &self.points)
    }

    /// Whether each field has a value for each of so many points.
    pub(crate) fn check_fields(&self, points: usize) -> Result<(), Malformed> {
        match self.fields.iter().find(|field| field.values.len() != points) {
            Some(field) => Err(Malformed::FieldLength {
                surface: self.name.clone(),
                field: field.name.clone(),
                values: field.values.len(),
                points,
            }),
            None => Ok(()),
        }
    }

    /// Whether points, the first of them with this number, have all their numbers.
    pub(crate) fn check_points(&self, first: usize, points: &[Point]) -> Result<(), Malformed> {
        for (i, j, point) in self.numbered(first, points).filter(|(_, _, point)| point.is_placed()) {
            if point.unknowns.len() != self.unknowns.len() {
                return Err(Malformed::UnknownCount {
                    surface: self.name.clone(),
                    i,
                    j,
                    given: point.unknowns.len(),
                    named: self.unknowns.len(),
                });
            }
            let has_fields = |_: &&Field| point.is_solved();
            let of_fields =
                self.fields.iter().filter(has_fields).flat_map(|field| field.values.at(i * self.columns.count + j));
            let of_point = point.position.iter().chain(&point.normal).chain(&point.unknowns).chain([&point.residual]);
            if !of_point.chain(of_fields).all(|number| number.is_finite()) {
                return Err(Malformed::NotANumber { surface: self.name.clone(), i, j });
            }
        }
        Ok(())
    }
}

/// A grid that has not as many points as it says.
pub(crate) fn miscounted(patch: &Patch, points: usize) -> Malformed {
    let (surface, rows, columns) = (patch.name.clone(), patch.rows.count, patch.columns.count);
    Malformed::PointCount { surface, rows, columns, points }
}

impl Dataset {
    /// Whether the grids are complete and every solved point has all its numbers. The writers of data refuse what fails.
    ///
    /// # Errors
    /// The first fault, by surface and grid point.
    pub fn check(&self) -> Result<(), Malformed> {
        self.patches.iter().try_for_each(Patch::check)
    }
}
