//! Surfaces with all that is known of their points as VTK PolyData, which ParaView opens.

use std::io::Write;

use crate::columns::{union_of_fields, union_of_unknowns};
use crate::conventions::{one_line, sentences};
use crate::dataset::{Dataset, Field, Patch, Unknown, Values};
use crate::error::WriteError;
use crate::facets::{Places, facets};
use crate::tally::Tally;
use crate::xml::escaped;

/// Writes all patches as one VTK PolyData file (`.vtp`, XML with raw appended data, little-endian), one piece for each patch.
///
/// Points are the solved ones, mm. Each has its `normal`, `row` and `column` in the grid, its patch's number as `surface` (from 0, in
/// the order of the file's head), its unknowns and fields as `name [unit]`, and its `residual`; NaN where a patch has no such
/// unknown or field, or a field is not defined. Cells are triangles that face out of the body, as in STL. A comment at the head
/// states the conventions, and how many points were asked for.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_vtp(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    let pieces: Vec<Piece<'_>> = dataset.patches.iter().enumerate().map(|(k, patch)| Piece::new(k, patch)).collect();
    let arrays = arrays(dataset);
    out.write_all(b"<?xml version=\"1.0\"?>\n")?;
    writeln!(out, "<!--\n{}\n-->", head(dataset))?;
    writeln!(out, "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">")?;
    writeln!(out, "<PolyData>")?;
    let mut offset = 0;
    for piece in &pieces {
        piece.declare(&arrays, &mut offset, out)?;
    }
    write!(out, "</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    for piece in &pieces {
        for array in &arrays {
            out.write_all(&piece.bytes(array).to_le_bytes())?;
            piece.write(array, out)?;
        }
    }
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?;
    Ok(())
}

/// The solved points of a patch and its triangles.
struct Piece<'a> {
    number: usize,
    patch: &'a Patch,
    places: Places,
    triangles: usize,
}

/// What one array of a piece holds.
struct Array<'a> {
    name: String,
    section: Section,
    what: What<'a>,
}

#[derive(Clone, Copy, PartialEq)]
enum Section {
    PointData,
    Points,
    Polys,
}

enum What<'a> {
    Normal,
    Row,
    Column,
    Surface,
    Unknown(&'a Unknown),
    Residual,
    Field(&'a Field),
    Position,
    Connectivity,
    Offsets,
}

/// All arrays of a piece, in the order in which they stand in the file.
fn arrays(dataset: &Dataset) -> Vec<Array<'_>> {
    let mut arrays = Vec::new();
    let mut add = |name: String, section, what| arrays.push(Array { name, section, what });
    add("normal".into(), Section::PointData, What::Normal);
    add("row".into(), Section::PointData, What::Row);
    add("column".into(), Section::PointData, What::Column);
    add("surface".into(), Section::PointData, What::Surface);
    for unknown in union_of_unknowns(&dataset.patches) {
        let name = format!("{} [{}]", unknown.name, unknown.unit.symbol());
        add(name, Section::PointData, What::Unknown(unknown));
    }
    add("residual".into(), Section::PointData, What::Residual);
    for field in union_of_fields(&dataset.patches) {
        add(format!("{} [{}]", field.name, field.unit), Section::PointData, What::Field(field));
    }
    add("points".into(), Section::Points, What::Position);
    add("connectivity".into(), Section::Polys, What::Connectivity);
    add("offsets".into(), Section::Polys, What::Offsets);
    arrays
}

impl Array<'_> {
    fn components(&self) -> usize {
        match &self.what {
            What::Normal | What::Position => 3,
            What::Field(field) => match field.values {
                Values::Scalars(_) => 1,
                Values::Vectors(_) => 3,
            },
            _ => 1,
        }
    }

    /// The name of its numbers' type, and their size in bytes.
    fn kind(&self) -> (&'static str, usize) {
        match self.what {
            What::Row | What::Column | What::Surface => ("Int32", 4),
            What::Connectivity | What::Offsets => ("Int64", 8),
            _ => ("Float64", 8),
        }
    }
}

impl<'a> Piece<'a> {
    fn new(number: usize, patch: &'a Patch) -> Piece<'a> {
        Piece {
            number,
            patch,
            places: Places::of(patch),
            triangles: facets(&patch.points, patch.columns.count).count(),
        }
    }

    /// How many bytes an array takes.
    fn bytes(&self, array: &Array<'_>) -> u64 {
        let tuples = match array.what {
            What::Connectivity => 3 * self.triangles,
            What::Offsets => self.triangles,
            _ => self.places.solved,
        };
        (tuples * array.components() * array.kind().1) as u64
    }

    /// What stands of the piece in the XML part; `offset` goes on to where the next piece's data begin.
    fn declare(&self, arrays: &[Array<'_>], offset: &mut u64, out: &mut dyn Write) -> Result<(), WriteError> {
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">",
            self.places.solved, self.triangles
        )?;
        let sections = [
            (Section::PointData, "PointData Normals=\"normal\"", "PointData"),
            (Section::Points, "Points", "Points"),
            (Section::Polys, "Polys", "Polys"),
        ];
        for (section, start, end) in sections {
            writeln!(out, "<{start}>")?;
            for array in arrays.iter().filter(|array| array.section == section) {
                writeln!(
                    out,
                    "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{offset}\"/>",
                    array.kind().0,
                    escaped(&one_line(&array.name)),
                    array.components()
                )?;
                *offset += 8 + self.bytes(array);
            }
            writeln!(out, "</{end}>")?;
        }
        writeln!(out, "</Piece>")?;
        Ok(())
    }

    fn write(&self, array: &Array<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
        let solved = || self.patch.numbered(0, &self.patch.points).filter(|(_, _, point)| point.is_solved());
        let columns = self.patch.columns.count;
        let mut float = |numbers: &[f64]| numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()));
        match array.what {
            What::Normal => solved().try_for_each(|(_, _, point)| float(&point.normal))?,
            What::Position => solved().try_for_each(|(_, _, point)| float(&point.position))?,
            What::Residual => solved().try_for_each(|(_, _, point)| float(&[point.residual]))?,
            What::Unknown(unknown) => {
                let place = self.patch.unknowns.iter().position(|own| own == unknown);
                let value = |values: &[f64]| place.map_or(f64::NAN, |place| unknown.unit.written(values[place]));
                solved().try_for_each(|(_, _, point)| float(&[value(&point.unknowns)]))?;
            }
            What::Field(field) => {
                let own = self.patch.fields.iter().find(|own| own.shares_columns(field));
                let nothing = &[f64::NAN; 3][..array.components()];
                let value = |at| own.map(|own| own.values.at(at)).filter(|known| !known.is_empty()).unwrap_or(nothing);
                solved().try_for_each(|(i, j, _)| float(value(i * columns + j)))?;
            }
            What::Row => solved().try_for_each(|(i, _, _)| out.write_all(&(i as i32).to_le_bytes()))?,
            What::Column => solved().try_for_each(|(_, j, _)| out.write_all(&(j as i32).to_le_bytes()))?,
            What::Surface => solved().try_for_each(|_| out.write_all(&(self.number as i32).to_le_bytes()))?,
            What::Connectivity => {
                let mut places = facets(&self.patch.points, self.patch.columns.count)
                    .flatten()
                    .map(|at| self.places.of_point(at) as i64);
                places.try_for_each(|place| out.write_all(&place.to_le_bytes()))?;
            }
            What::Offsets => {
                (1..=self.triangles as i64).try_for_each(|k| out.write_all(&(3 * k).to_le_bytes()))?;
            }
        }
        Ok(())
    }
}

/// The conventions, as lines that may stand in an XML comment.
fn head(dataset: &Dataset) -> String {
    let header = &dataset.header;
    let mut lines = vec![
        format!("{}; spec: {}, hash {}; job: {}", header.program, header.spec, header.spec_hash, header.job),
        "only solved points are in this file".to_owned(),
    ];
    lines.extend(sentences(&dataset.header));
    lines.extend(dataset.patches.iter().enumerate().map(|(k, patch)| {
        format!("surface {k} `{}`: frame {}; {}", patch.name, patch.frame, Tally::of([patch]).verdict())
    }));
    lines.iter().map(|line| one_line(line).replace("--", "- -")).collect::<Vec<_>>().join("\n")
}
