//! Points in arrays.

use flank_chain_dsl::GeneratedSurface;
use flank_export::{Field, Patch, Unit, Values};
use flank_solver::{Outcome, SurfacePoint};

use crate::project::quantity::{NamedUnit, UnitSymbol};
use crate::solve::status::Status;

/// The points of a surface, a measuring grid or a line in arrays, row by row: one array for each thing that is known of them. What is not
/// known of a point is NaN.
#[derive(Clone, Debug, Default)]
pub struct PointGrid {
    /// Of the surface or the line.
    pub name: String,
    /// The frame of positions, normals and vectors.
    pub frame: String,
    /// Rows and columns; a line is one row.
    pub counts: [usize; 2],
    /// What rows and columns run over.
    pub labels: [String; 2],
    /// mm. Points that are `solved`, `undercut`, `trimmed` or `undecided` have one.
    pub positions: Vec<[f64; 3]>,
    /// Unit vectors out of the material.
    pub normals: Vec<[f64; 3]>,
    /// The names of the unknowns, and the units that tables have for them.
    pub unknown_names: Vec<NamedUnit>,
    /// The unknowns, one point after the other, mm and radians.
    pub unknowns: Vec<f64>,
    /// What became of each point.
    pub statuses: Vec<Status>,
    /// The largest absolute residual of each point.
    pub residuals: Vec<f64>,
    /// What more is known of solved points.
    pub fields: Vec<FieldArray>,
}

/// What is known of each point beside its place.
#[derive(Clone, Debug)]
pub struct FieldArray {
    /// As the columns of files have it: `k1`, `d_normal/d_m.swivel`.
    pub name: String,
    /// Such as `1/mm`; `1` for a plain number or a direction.
    pub unit: String,
    /// In a sentence, with the sign.
    pub meaning: String,
    /// Numbers for each point: 1, or 3 of a vector.
    pub width: usize,
    /// One point after the other.
    pub values: Vec<f64>,
}

impl PointGrid {
    /// A surface's, without points; each is then [pushed](PointGrid::push).
    pub(crate) fn of_surface(
        surface: &GeneratedSurface<'_>,
        name: &str,
        (counts, labels): ([usize; 2], [String; 2]),
    ) -> PointGrid {
        let points = counts[0] * counts[1];
        PointGrid {
            name: name.to_string(),
            frame: surface.frame.clone(),
            counts,
            labels,
            positions: Vec::with_capacity(points),
            normals: Vec::with_capacity(points),
            unknown_names: surface.unknowns.iter().map(|of| NamedUnit::new(&of.name, of.dimension)).collect(),
            unknowns: Vec::with_capacity(points * surface.unknowns.len()),
            statuses: Vec::with_capacity(points),
            residuals: Vec::with_capacity(points),
            fields: Vec::new(),
        }
    }

    /// The next point.
    pub(crate) fn push(&mut self, point: &SurfacePoint) {
        if matches!(point.outcome, Outcome::Solved | Outcome::CutAway(_) | Outcome::Undecided) {
            self.place(point.position, point.normal, &point.unknowns);
        } else {
            // of a point that is not there nothing is known but why
            self.place([f64::NAN; 3], [f64::NAN; 3], &[]);
        }
        self.statuses.push(point.outcome.into());
        self.residuals.push(point.residual);
    }

    /// With points.
    pub(crate) fn with_points(mut self, points: &[SurfacePoint]) -> PointGrid {
        points.iter().for_each(|point| self.push(point));
        self
    }

    /// With what more is known of its points.
    pub(crate) fn with_fields<'f>(mut self, fields: impl IntoIterator<Item = &'f Field>) -> PointGrid {
        let arrays = fields.into_iter().map(|field| FieldArray::new(field, &self.statuses)).collect();
        self.fields = arrays;
        self
    }

    /// What a file shows.
    pub(crate) fn of_patch(patch: &Patch) -> PointGrid {
        let counts = [patch.rows.count, patch.columns.count];
        let unit = |unit: Unit| match unit {
            Unit::Millimetre => UnitSymbol::Millimetre,
            Unit::Degree => UnitSymbol::Degree,
            Unit::One => UnitSymbol::One,
        };
        let mut grid = PointGrid {
            name: patch.name.clone(),
            frame: patch.frame.clone(),
            counts,
            labels: [patch.rows.label.clone(), patch.columns.label.clone()],
            unknown_names: patch
                .unknowns
                .iter()
                .map(|of| NamedUnit { name: of.name.clone(), unit: unit(of.unit) })
                .collect(),
            ..PointGrid::default()
        };
        for point in &patch.points {
            grid.place(point.position, point.normal, &point.unknowns);
            grid.statuses.push(point.outcome.into());
            grid.residuals.push(point.residual);
        }
        grid.with_fields(&patch.fields)
    }

    fn place(&mut self, position: [f64; 3], normal: [f64; 3], unknowns: &[f64]) {
        // no negative zero, as in files
        self.positions.push(position.map(|x| x + 0.0));
        self.normals.push(normal.map(|x| x + 0.0));
        self.unknowns.extend_from_slice(unknowns);
        self.unknowns.resize(self.positions.len() * self.unknown_names.len(), f64::NAN);
    }

    /// One unknown at each point, in the unit that tables have for it.
    pub fn unknown(&self, place: usize) -> Vec<f64> {
        let is_angle = self.unknown_names[place].unit == UnitSymbol::Degree;
        let values = self.unknowns.iter().skip(place).step_by(self.unknown_names.len());
        values.map(|x| if is_angle { x.to_degrees() } else { *x }).collect()
    }
}

impl FieldArray {
    fn new(field: &Field, statuses: &[Status]) -> FieldArray {
        let (width, mut values): (usize, Vec<f64>) = match &field.values {
            Values::Scalars(known) => (1, known.all_numbers().collect()),
            Values::Vectors(known) => (3, known.all_numbers().collect()),
        };
        // files show them of solved points alone
        for (numbers, status) in values.chunks_mut(width).zip(statuses) {
            if *status != Status::Solved {
                numbers.fill(f64::NAN);
            }
        }
        FieldArray { name: field.name.clone(), unit: field.unit.clone(), meaning: field.meaning.clone(), width, values }
    }
}
