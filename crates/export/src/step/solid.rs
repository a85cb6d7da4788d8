//! The body of a gear as one closed shell whose faces share their edges and vertices.

use std::io::Write;

use super::shell::Shell;
use super::spline::SplineSurface;
use super::{DataSection, numbers, real, text};
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::solid::PlacedFrame;
use crate::vector::Vector;

/// A line or an arc `[z, rho]` of the outline of a turned blank, or `[z, x]` of that of a bar, the material on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedSegment {
    /// What it is called.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// The centre of an arc.
    pub center: Option<[f64; 2]>,
}

/// How the spaces of a gear follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GearRun {
    /// All around the z axis, by this angle.
    Round {
        /// From one space to the next.
        pitch: f64,
    },
    /// Along y.
    Straight {
        /// From one space to the next, mm.
        pitch: f64,
    },
}

/// A strip of the toothed side of a gear, from where spaces begin to where they end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GearStrip {
    /// A surface.
    Surface {
        /// Which.
        surface: usize,
        /// How many spaces farther on.
        spaces: i32,
    },
    /// The land of a tooth on the tip of the blank.
    Land,
}

/// Where a part of a gear is cut off.
#[derive(Clone, Debug, PartialEq)]
pub enum GearSide {
    /// By the plane through the outermost row and the axis, or the direction of x.
    Flat,
    /// By a surface through a grid of points, row by row, mm: rows from the outermost row inwards, columns along the spaces.
    Bent {
        /// The grid.
        points: Vec<Vector>,
        /// Rows and columns.
        counts: [usize; 2],
        /// Points along each segment of the rest of the outline.
        rest: Vec<Vec<Vector>>,
    },
}

/// A gear, or some teeth or spaces of it: a turned blank, or a bar, with tooth spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct GearBody {
    /// What it is called.
    pub name: String,
    /// What it consists of, in a few words.
    pub about: String,
    /// How its spaces follow each other.
    pub run: GearRun,
    /// Surfaces of spaces, each with its name and a grid of points, row by row, mm: rows across the space, columns from where it begins to
    /// where it ends. All have as many columns.
    pub surfaces: Vec<(String, Vec<Vector>, [usize; 2])>,
    /// What follows each other on the toothed side. Surfaces that do have a row in common.
    pub strips: Vec<GearStrip>,
    /// Where it is cut off before its first strip and behind its last one; nothing where these are neighbours.
    pub sides: Option<[GearSide; 2]>,
    /// The segments of the outline that spaces begin at, leave the blank by, and end at.
    pub ends: [TurnedSegment; 3],
    /// The others, from the end of the spaces round to their beginning.
    pub rest: Vec<TurnedSegment>,
    /// How far the faces are off the exact surfaces at the most, mm.
    pub deviation: f64,
    /// mm³, where it is known.
    pub volume: Option<f64>,
    /// mm², where it is known.
    pub area: Option<f64>,
    /// mm, where it is known.
    pub centre: Option<Vector>,
}

/// How far the cubic spline through a grid of points, row by row, is off a lattice of the same surface with one more row and column between any
/// two, mm.
///
/// # Panics
/// If there are not `counts[0] · counts[1]` points, and as many between them as there have to be.
#[must_use]
pub fn spline_deviation(points: Vec<Vector>, counts: [usize; 2], doubled: &[Vector]) -> f64 {
    SplineSurface::through(points, counts).off(doubled)
}

/// A gear where it is mounted.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBody<'b> {
    /// In its own frame.
    pub body: &'b GearBody,
    /// That frame in the one of the assembly.
    pub place: PlacedFrame,
}

/// Writes a gear as one STEP AP242 file, mm: a `MANIFOLD_SOLID_BREP` whose edges are splines that both their faces have, with volume, area
/// and centre as geometric validation properties (CAx-IF recommended practices, version 4.3). The same body gives the same bytes.
///
/// # Errors
/// When the stream refuses.
pub fn write_step_body(header: &Header, body: &GearBody, out: &mut dyn Write) -> Result<(), WriteError> {
    super::write_head(header, &[told(body)], out)?;
    let mut part = DataSection { out, last: 0 };
    part.product_of_body(body)?;
    super::write_end(part.out)
}

/// Writes gears where they are mounted as an assembly in one STEP AP242 file, mm: a product with its `MANIFOLD_SOLID_BREP` for each, and their
/// places in the product that they are parts of.
///
/// # Errors
/// When the stream refuses.
pub fn write_step_assembly(header: &Header, bodies: &[PlacedBody<'_>], out: &mut dyn Write) -> Result<(), WriteError> {
    let told: Vec<String> = bodies.iter().map(|placed| told(placed.body)).collect();
    super::write_head(header, &told, out)?;
    let mut part = DataSection { out, last: 0 };
    let [product, shape] = part.product_and_shape(&header.job)?;
    let (context, _) = part.units_of(LEAST_UNCERTAINTY)?;
    let own = part.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
    let mut places = Vec::new();
    for PlacedBody { place: PlacedFrame { origin, axes }, .. } in bodies {
        places.push(part.placement(*origin, axes[2], axes[0])?);
    }
    let items = numbers(&[&[own][..], &places].concat());
    let whole = part.add(&format!("SHAPE_REPRESENTATION({},{items},#{context})", text(&header.job)))?;
    part.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{whole})"))?;
    for (k, (placed, place)) in bodies.iter().zip(places).enumerate() {
        let BodyProduct { definition, place: from, representation } = part.product_of_body(placed.body)?;
        let name = text(&placed.body.name);
        let usage = format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('{}',{name},'',#{product},#{definition},$)", k + 1);
        let usage = part.add(&usage)?;
        let shape = part.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"))?;
        let moved = part.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{place})"))?;
        let related = part.add(&format!(
            "(REPRESENTATION_RELATIONSHIP('','',#{representation},#{whole})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        ))?;
        part.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{related},#{shape})"))?;
    }
    super::write_end(part.out)
}

/// What a body is and how far its faces are off, in one line.
fn told(body: &GearBody) -> String {
    let volume = body.volume.map(|volume| format!("; volume {volume:.4} mm3")).unwrap_or_default();
    format!("`{}`: {}, off by at most {:.2e} um{volume}", body.name, body.about, 1e3 * body.deviation)
}

/// A product that is a body.
struct BodyProduct {
    definition: usize,
    place: usize,
    representation: usize,
}

/// What readers take for one point at the least, mm.
pub(super) const LEAST_UNCERTAINTY: f64 = 1e-7;
/// Places nearer to the axis lie on it, mm: rounding of arcs that end there.
const ON_AXIS: f64 = 1e-9;

impl DataSection<'_> {
    fn product_of_body(&mut self, body: &GearBody) -> Result<BodyProduct, WriteError> {
        let [definition, shape] = self.product_and_shape(&body.name)?;
        let (context, length) = self.units_of(body.deviation.max(LEAST_UNCERTAINTY))?;
        let faces = Shell::new(self, body)?.faces()?;
        let shell = self.add(&format!("CLOSED_SHELL('',{})", numbers(&faces)))?;
        let name = text(&body.name);
        let solid = self.add(&format!("MANIFOLD_SOLID_BREP({name},#{shell})"))?;
        let place = self.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
        let made = format!("ADVANCED_BREP_SHAPE_REPRESENTATION({name},(#{place},#{solid}),#{context})");
        let representation = self.add(&made)?;
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"))?;
        self.validation(definition, (context, length), body)?;
        Ok(BodyProduct { definition, place, representation })
    }

    pub(super) fn direction(&mut self, [x, y, z]: Vector) -> Result<usize, WriteError> {
        self.add(&format!("DIRECTION('',({},{},{}))", real(x), real(y), real(z)))
    }

    pub(super) fn placement(&mut self, origin: Vector, axis: Vector, reference: Vector) -> Result<usize, WriteError> {
        let origin = self.point(origin)?;
        let [axis, reference] = [self.direction(axis)?, self.direction(reference)?];
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{axis},#{reference})"))
    }

    fn validation(
        &mut self,
        product: usize,
        (context, length): (usize, usize),
        body: &GearBody,
    ) -> Result<(), WriteError> {
        let unit = |part: &mut Self, power: &str| {
            let element = part.add(&format!("DERIVED_UNIT_ELEMENT(#{length},{power})"))?;
            part.add(&format!("DERIVED_UNIT((#{element}))"))
        };
        let [square, cube] = [unit(self, "2.")?, unit(self, "3.")?];
        let measure = |name: &str, kind: &str, value: f64, unit: usize| {
            format!("MEASURE_REPRESENTATION_ITEM('{name} measure',{kind}_MEASURE({}),#{unit})", real(value))
        };
        let volume = body.volume.map(|volume| measure("volume", "VOLUME", volume, cube));
        let area = body.area.map(|area| measure("surface area", "AREA", area, square));
        let centre = body.centre.map(|centre| {
            let [x, y, z] = centre.map(real);
            format!("CARTESIAN_POINT('centre point',({x},{y},{z}))")
        });
        for (what, item) in [("volume", volume), ("surface area", area), ("centroid", centre)] {
            let Some(item) = item else { continue };
            let property =
                self.add(&format!("PROPERTY_DEFINITION('geometric validation property','{what}',#{product})"))?;
            let item = self.add(&item)?;
            let value = self.add(&format!("REPRESENTATION('{what}',(#{item}),#{context})"))?;
            self.add(&format!("PROPERTY_DEFINITION_REPRESENTATION(#{property},#{value})"))?;
        }
        Ok(())
    }
}

impl GearRun {
    pub(super) fn moved(self, [x, y, z]: Vector, spaces: i32) -> Vector {
        match self {
            GearRun::Round { pitch } => {
                let (sin, cos) = (pitch * f64::from(spaces)).sin_cos();
                [cos * x - sin * y, sin * x + cos * y, z]
            }
            GearRun::Straight { pitch } => [x, y + pitch * f64::from(spaces), z],
        }
    }

    /// Whether a place of the outline lies on the axis: it passes over nothing there.
    pub(super) fn is_on_axis(self, [_, rho]: [f64; 2]) -> bool {
        matches!(self, GearRun::Round { .. }) && rho.abs() < ON_AXIS
    }

    /// Whether a segment of the outline runs along the axis: that bounds nothing.
    pub(super) fn is_along_axis(self, segment: &TurnedSegment) -> bool {
        segment.center.is_none() && self.is_on_axis(segment.from) && self.is_on_axis(segment.to)
    }

    pub(super) fn way(self, [x, y, _]: Vector) -> f64 {
        match self {
            GearRun::Round { .. } => y.atan2(x),
            GearRun::Straight { .. } => y,
        }
    }

    /// A place of the outline, so far on.
    pub(super) fn at(self, [z, rho]: [f64; 2], way: f64) -> Vector {
        match self {
            GearRun::Round { .. } => [rho * way.cos(), rho * way.sin(), z],
            GearRun::Straight { .. } => [rho, way, z],
        }
    }

    /// Unit vectors so far on: away from the axis, and on along the spaces.
    pub(super) fn directions(self, way: f64) -> [Vector; 2] {
        match self {
            GearRun::Round { .. } => [[way.cos(), way.sin(), 0.0], [-way.sin(), way.cos(), 0.0]],
            GearRun::Straight { .. } => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }
}
