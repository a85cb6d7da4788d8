//! Surfaces with all that is known of their points as VTK PolyData, which ParaView opens.

use crate::files::error::WriteError;
use crate::files::regions::{Regions, Target};
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::columns::{union_of_fields, union_of_unknowns};
use crate::points::conventions::sentences_of_points;
use crate::points::dataset::{Field, Outcome, Patch, Point, Unknown, Values};
use crate::points::facets::{Mesh, count_facets};
use crate::text::one_line;
use crate::text::xml::escaped;

/// Writes all surfaces as one VTK PolyData file (`.vtp`, XML with raw appended data, little-endian), one piece for each.
///
/// Points are the solved ones, and those that are undercut, trimmed or undecided, mm. Each has its `status` (0 to 3), its `normal`, `row` and
/// `column` in the grid, its patch's number as `surface` (from 0, in the order of the file's head), its unknowns and fields as
/// `name [unit]`, and its `residual`; NaN where a patch has no such unknown or field, or a field is not defined. Cells are triangles
/// of solved points that face out of the body, as in STL. A comment at the head states the conventions, and how many points were
/// asked for.
///
/// The points are asked for three times; the arrays are filled side by side, so that no more than a part of each is held.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the target refuses.
pub fn write_vtp(surfaces: &Surfaces<'_>, out: &mut dyn Target) -> Result<(), WriteError> {
    let seen = Seen::of_surfaces(surfaces)?;
    let arrays = arrays(surfaces);
    let pieces = surfaces.list.iter().zip(&seen.tallies).enumerate();
    let pieces = pieces.map(|(number, (surface, tally))| {
        Ok(Piece { number, surface: *surface, points: tally.placed, triangles: count_facets(*surface)? })
    });
    let pieces = pieces.collect::<Result<Vec<Piece<'_>>, WriteError>>()?;
    out.write_all(b"<?xml version=\"1.0\"?>\n")?;
    writeln!(out, "<!--\n{}\n-->", head(surfaces, &seen))?;
    writeln!(out, "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">")?;
    writeln!(out, "<PolyData>")?;
    let mut offset = 0;
    for piece in &pieces {
        piece.declare(&arrays, &mut offset, out)?;
    }
    write!(out, "</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    pieces.iter().try_for_each(|piece| piece.write(&arrays, out))?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?;
    Ok(())
}

/// The points of a surface that have a place, and the triangles of the solved ones.
struct Piece<'a> {
    number: usize,
    surface: &'a dyn Banded,
    points: usize,
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
    Status,
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
fn arrays<'b>(surfaces: &Surfaces<'b>) -> Vec<Array<'b>> {
    let mut arrays = Vec::new();
    let mut add = |name: String, section, what| arrays.push(Array { name, section, what });
    add("status".into(), Section::PointData, What::Status);
    add("normal".into(), Section::PointData, What::Normal);
    add("row".into(), Section::PointData, What::Row);
    add("column".into(), Section::PointData, What::Column);
    add("surface".into(), Section::PointData, What::Surface);
    for unknown in union_of_unknowns(surfaces.outlines()) {
        let name = format!("{} [{}]", unknown.name, unknown.unit.symbol());
        add(name, Section::PointData, What::Unknown(unknown));
    }
    add("residual".into(), Section::PointData, What::Residual);
    for field in union_of_fields(surfaces.outlines()) {
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
            What::Status | What::Row | What::Column | What::Surface => ("Int32", 4),
            What::Connectivity | What::Offsets => ("Int64", 8),
            _ => ("Float64", 8),
        }
    }
}

impl Piece<'_> {
    /// How many bytes an array takes.
    fn bytes(&self, array: &Array<'_>) -> u64 {
        let tuples = match array.what {
            What::Connectivity => 3 * self.triangles,
            What::Offsets => self.triangles,
            _ => self.points,
        };
        (tuples * array.components() * array.kind().1) as u64
    }

    /// What stands of the piece in the XML part; `offset` goes on to where the next piece's data begin.
    fn declare(&self, arrays: &[Array<'_>], offset: &mut u64, out: &mut dyn Target) -> Result<(), WriteError> {
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">",
            self.points, self.triangles
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

    /// The arrays, each with its length before it.
    fn write(&self, arrays: &[Array<'_>], out: &mut dyn Target) -> Result<(), WriteError> {
        let mut regions = Regions::new(out.stream_position()?, arrays.iter().map(|array| 8 + self.bytes(array)));
        for (k, array) in arrays.iter().enumerate() {
            regions.push(k, &self.bytes(array).to_le_bytes(), out)?;
        }
        let patch = self.surface.outline();
        let of_points: Vec<(usize, OfPoint<'_>)> = arrays
            .iter()
            .enumerate()
            .filter(|(_, array)| array.section != Section::Polys)
            .map(|(k, array)| (k, array.of_point(patch, self.number)))
            .collect();
        let polys = |what: fn(&What<'_>) -> bool| arrays.iter().position(|array| what(&array.what));
        let connectivity = polys(|what| matches!(what, What::Connectivity)).expect("every piece has one");
        let offsets = polys(|what| matches!(what, What::Offsets)).expect("every piece has them");
        let (mut first, mut triangles, mut mesh, mut bytes) =
            (0, 0_i64, Mesh::of_surface(self.surface, Point::is_placed), Vec::new());
        self.surface.bands(&mut |points| {
            for (at, (i, j, point)) in (first..).zip(patch.numbered(first, points)) {
                for (k, of_point) in of_points.iter().filter(|_| point.is_placed()) {
                    bytes.clear();
                    of_point(&mut bytes, [at, i, j], point);
                    regions.push(*k, &bytes, out)?;
                }
            }
            first += points.len();
            mesh.add(points, &mut |corners| {
                triangles += 1;
                regions.push(offsets, &(3 * triangles).to_le_bytes(), out)?;
                let corners = corners.map(|(place, _)| (place as i64).to_le_bytes());
                Ok(regions.push(connectivity, corners.as_flattened(), out)?)
            })
        })?;
        Ok(regions.finish(out)?)
    }
}

/// Puts what an array has of a point behind its bytes: of the point with this number, row and column.
type OfPoint<'p> = Box<dyn Fn(&mut Vec<u8>, [usize; 3], &Point) + 'p>;

impl Array<'_> {
    /// The numbers of the points of a surface.
    fn of_point<'p>(&'p self, patch: &'p Patch, number: usize) -> OfPoint<'p> {
        fn float(bytes: &mut Vec<u8>, numbers: &[f64]) {
            numbers.iter().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        }
        fn whole(bytes: &mut Vec<u8>, number: usize) {
            bytes.extend_from_slice(&(number as i32).to_le_bytes());
        }
        match &self.what {
            What::Normal => Box::new(|bytes, _, point| float(bytes, &point.normal)),
            What::Position => Box::new(|bytes, _, point| float(bytes, &point.position)),
            What::Residual => Box::new(|bytes, _, point| float(bytes, &[point.residual])),
            What::Unknown(unknown) => {
                let place = patch.unknowns.iter().position(|own| own == *unknown);
                Box::new(move |bytes, _, point| {
                    let value = place.map(|place| unknown.unit.written(point.unknowns[place]));
                    float(bytes, &[value.unwrap_or(f64::NAN)]);
                })
            }
            What::Field(field) => {
                let own = patch.fields.iter().find(|own| own.shares_columns(field));
                let nothing = &[f64::NAN; 3][..self.components()];
                Box::new(move |bytes, [at, ..], point| {
                    let known = own
                        .filter(|_| point.is_solved())
                        .map(|own| own.values.at(at))
                        .filter(|known| !known.is_empty());
                    float(bytes, known.unwrap_or(nothing));
                })
            }
            What::Status => Box::new(|bytes, _, point| whole(bytes, status(point.outcome))),
            What::Row => Box::new(|bytes, [_, i, _], _| whole(bytes, i)),
            What::Column => Box::new(|bytes, [_, _, j], _| whole(bytes, j)),
            What::Surface => Box::new(move |bytes, _, _| whole(bytes, number)),
            What::Connectivity | What::Offsets => Box::new(|_, _, _| {}),
        }
    }
}

/// What stands for an outcome in the array of them.
fn status(outcome: Outcome) -> usize {
    match outcome {
        Outcome::Solved => 0,
        Outcome::Undercut => 1,
        Outcome::Trimmed => 2,
        Outcome::Undecided => 3,
        Outcome::Unsolved(_) => unreachable!("such a point is not in the file"),
    }
}

/// The conventions, as lines that may stand in an XML comment.
fn head(surfaces: &Surfaces<'_>, seen: &Seen) -> String {
    let header = surfaces.header;
    let mut lines =
        vec![format!("{}; spec: {}, hash {}; job: {}", header.program, header.spec, header.spec_hash, header.job)];
    lines.extend(sentences_of_points(header));
    lines.extend(surfaces.outlines().zip(&seen.tallies).enumerate().map(|(k, (patch, tally))| {
        format!("surface {k} `{}`: frame {}; {}", patch.name, patch.frame, tally.verdict())
    }));
    // twice, for three in a row
    let inert = |line: &String| one_line(line).replace("--", "- -").replace("--", "- -");
    lines.iter().map(inert).collect::<Vec<_>>().join("\n")
}
