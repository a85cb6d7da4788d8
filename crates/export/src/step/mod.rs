//! Surfaces as smooth faces in a STEP file (ISO 10303-21, AP242).

mod blank;
mod cut;
mod face;
mod shell;
mod solid;
mod spline;

use std::io::Write;

pub use face::{Deviation, Face};
pub use solid::{
    GearBody, GearRun, GearSide, GearStrip, PlacedBody, TurnedSegment, spline_deviation, write_step_assembly,
    write_step_body,
};

use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::text::number::shortest;
use crate::text::one_line;
use spline::{Direction, SplineSurface};

const SCHEMA: &str = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }";

/// Writes faces as one STEP AP242 file, mm: for each an open shell of one B-spline face, whose normal points out of the body.
///
/// How far each is off is stated in the file's head. No date is: the same faces give the same bytes.
///
/// # Errors
/// When the stream refuses.
pub fn write_step(header: &Header, faces: &[&Face], out: &mut dyn Write) -> Result<(), WriteError> {
    let told: Vec<String> = faces.iter().map(|face| face.told()).collect();
    write_head(header, &told, out)?;
    let mut part = DataSection { out, last: 0 };
    let [_, product] = part.product_and_shape(&header.job)?;
    let (context, _) = part.units_of(SAME_POINT)?;
    let shells: Vec<usize> = faces.iter().map(|face| part.shell(face)).collect::<Result<_, _>>()?;
    let model = part.add(&format!("SHELL_BASED_SURFACE_MODEL('',{})", numbers(&shells)))?;
    let origin = part.add("CARTESIAN_POINT('',(0.,0.,0.))")?;
    let [z, x] = ["0.,0.,1.", "1.,0.,0."].map(|direction| part.add(&format!("DIRECTION('',({direction}))")));
    let place = format!("AXIS2_PLACEMENT_3D('',#{origin},#{},#{})", z?, x?);
    let place = part.add(&place)?;
    let shape = part.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{place},#{model}),#{context})"))?;
    part.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{product},#{shape})"))?;
    write_end(part.out)
}

/// Points that are nearer to each other are one, mm.
const SAME_POINT: f64 = 1e-6;

/// All before the data, with lines on what they are.
fn write_head(header: &Header, told: &[String], out: &mut dyn Write) -> Result<(), WriteError> {
    let about = format!("{}; spec: {}, hash {}; job: {}", header.program, header.spec, header.spec_hash, header.job);
    let lines: Vec<String> = [&about].into_iter().chain(told).map(|line| text(line)).collect();
    writeln!(out, "ISO-10303-21;\nHEADER;")?;
    writeln!(out, "FILE_DESCRIPTION(({}),'2;1');", lines.join(",\n"))?;
    writeln!(out, "FILE_NAME({},'',(''),(''),{},'','');", text(&header.job), text(&header.program))?;
    writeln!(out, "FILE_SCHEMA(('{SCHEMA}'));\nENDSEC;\nDATA;")?;
    Ok(())
}

fn write_end(out: &mut dyn Write) -> Result<(), WriteError> {
    Ok(writeln!(out, "ENDSEC;\nEND-ISO-10303-21;")?)
}

impl Face {
    /// What it is and how far it is off, in one line.
    #[must_use]
    pub fn told(&self) -> String {
        let [rows, columns] = self.counts();
        let mut told = format!("`{}` in {}: a face through {rows} x {columns} points", self.name, self.frame);
        if self.left_out > 0 {
            told += &format!(", {} points beyond it", self.left_out);
        }
        if let Some(Deviation { largest, points, missing }) = self.deviation {
            told += &format!(", off by at most {:.2e} um at {points} exact points between them", 1e3 * largest);
            if missing > 0 {
                told += &format!(", not measured at {missing}");
            }
        }
        told
    }
}

/// The data section: entities are numbered as they come.
struct DataSection<'w> {
    out: &'w mut dyn Write,
    last: usize,
}

impl DataSection<'_> {
    fn add(&mut self, entity: &str) -> Result<usize, WriteError> {
        self.last += 1;
        writeln!(self.out, "#{}={entity};", self.last)?;
        Ok(self.last)
    }

    /// A product, and its shape.
    fn product_and_shape(&mut self, name: &str) -> Result<[usize; 2], WriteError> {
        let application = self.add("APPLICATION_CONTEXT('managed model based 3d engineering')")?;
        self.add(&format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','ap242_managed_model_based_3d_engineering',2014,#{application})"
        ))?;
        let context = self.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"))?;
        let name = text(name);
        let product = self.add(&format!("PRODUCT({name},{name},'',(#{context}))"))?;
        self.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"))?;
        let formation = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"))?;
        let stage = self.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"))?;
        let definition = self.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{stage})"))?;
        let shape = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"))?;
        Ok([definition, shape])
    }

    /// Millimetres, radians, and how near points have to be to be one, mm: the context, and the unit of length.
    fn units_of(&mut self, near: f64) -> Result<(usize, usize), WriteError> {
        let length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")?;
        let angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")?;
        let solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")?;
        let near = self.add(&format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','')",
            real(near)
        ))?;
        let context = self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{near}))GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('',''))"
        ))?;
        Ok((context, length))
    }

    fn shell(&mut self, face: &Face) -> Result<usize, WriteError> {
        let name = text(&face.name);
        let points: Vec<usize> = face.spline.poles.iter().map(|pole| self.point(*pole)).collect::<Result<_, _>>()?;
        let surface = self.spline_surface(&face.name, &face.spline, &points)?;
        let edges = self.border(face, &points)?;
        let border = self.add(&format!("EDGE_LOOP('',{})", numbers(&edges)))?;
        // the border runs around the spline's own normal
        let sense = if face.is_turned { ".F." } else { ".T." };
        let bound = self.add(&format!("FACE_OUTER_BOUND('',#{border},{sense})"))?;
        let of_body = self.add(&format!("ADVANCED_FACE({name},(#{bound}),#{surface},{sense})"))?;
        self.add(&format!("OPEN_SHELL({name},(#{of_body}))"))
    }

    fn spline_surface(&mut self, name: &str, spline: &SplineSurface, poles: &[usize]) -> Result<usize, WriteError> {
        let [along, across] = &spline.directions;
        let rows: Vec<String> = poles.chunks_exact(across.count).map(numbers).collect();
        let (u, v) = (knots(along), knots(across));
        self.add(&format!(
            "B_SPLINE_SURFACE_WITH_KNOTS({},{},{},({}),.UNSPECIFIED.,.F.,.F.,.F.,{},{},{},{},.UNSPECIFIED.)",
            text(name),
            along.degree,
            across.degree,
            rows.join(","),
            u.0,
            v.0,
            u.1,
            v.1
        ))
    }

    /// The four edges, one after the other around the spline's own normal.
    fn border(&mut self, face: &Face, points: &[usize]) -> Result<Vec<usize>, WriteError> {
        let [along, across] = &face.spline.directions;
        let [last_row, last_column] = [along.count - 1, across.count - 1];
        let corners = [[0, 0], [last_row, 0], [last_row, last_column], [0, last_column]];
        let corners = corners.map(|[row, column]| points[face.pole(row, column)]);
        let vertices: Vec<usize> =
            corners.iter().map(|corner| self.add(&format!("VERTEX_POINT('',#{corner})"))).collect::<Result<_, _>>()?;
        let column = |j: usize| (0..along.count).map(|i| points[face.pole(i, j)]).collect::<Vec<_>>();
        let row = |i: usize| (0..across.count).map(|j| points[face.pole(i, j)]).collect::<Vec<_>>();
        let edges = [
            (along, column(0), 0, 1, ".T."),
            (across, row(last_row), 1, 2, ".T."),
            (along, column(last_column), 3, 2, ".F."),
            (across, row(0), 0, 3, ".F."),
        ];
        edges
            .into_iter()
            .map(|(direction, poles, from, to, sense)| {
                let (counts, values) = knots(direction);
                let curve = self.add(&format!(
                    "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{counts},{values},.UNSPECIFIED.)",
                    direction.degree,
                    numbers(&poles)
                ))?;
                let (from, to) = (vertices[from], vertices[to]);
                let edge = self.add(&format!("EDGE_CURVE('',#{from},#{to},#{curve},.T.)"))?;
                self.add(&format!("ORIENTED_EDGE('',*,*,#{edge},{sense})"))
            })
            .collect()
    }

    fn point(&mut self, [x, y, z]: [f64; 3]) -> Result<usize, WriteError> {
        self.add(&format!("CARTESIAN_POINT('',({},{},{}))", real(x), real(y), real(z)))
    }
}

/// How often each knot counts, and the knots.
fn knots(direction: &Direction) -> (String, String) {
    let (mut counts, mut values): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    for knot in &direction.knots {
        if values.last() == Some(knot) {
            *counts.last_mut().expect("a count for each value") += 1;
        } else {
            values.push(*knot);
            counts.push(1);
        }
    }
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    let values: Vec<String> = values.into_iter().map(real).collect();
    (format!("({})", counts.join(",")), format!("({})", values.join(",")))
}

fn numbers(entities: &[usize]) -> String {
    let numbers: Vec<String> = entities.iter().map(|entity| format!("#{entity}")).collect();
    format!("({})", numbers.join(","))
}

/// A number that has a decimal point, whatever it is.
fn real(value: f64) -> String {
    let text = shortest(value).replace('e', "E");
    match text.split_once('E') {
        _ if text.contains('.') => text,
        Some((digits, exponent)) => format!("{digits}.E{exponent}"),
        None => text + ".",
    }
}

/// A string, with what is not ASCII as the format encodes it.
fn text(text: &str) -> String {
    let mut out = String::from("'");
    for letter in one_line(text).chars() {
        match letter {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(letter),
            _ => out += &format!("\\X4\\{:08X}\\X0\\", letter as u32),
        }
    }
    out + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point() {
        assert_eq!([1.0, -0.5, 1e-20, 1.5e300, -0.0].map(real), ["1.", "-0.5", "1.E-20", "1.5E300", "0."]);
    }

    #[test]
    fn strings_are_ascii() {
        assert_eq!(text("it's 5 µm\n"), "'it''s 5 \\X4\\000000B5\\X0\\m '");
    }
}
