//! Bricks as a VTK unstructured grid, which ParaView opens.

use std::io::Write;

use super::{BrickBody, sentences};
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::text::one_line;
use crate::text::xml::escaped;

/// Cell types of VTK: hexahedron and quadratic hexahedron, whose nodes have the order of C3D8 and C3D20.
const HEXAHEDRON: u8 = 12;
const QUADRATIC_HEXAHEDRON: u8 = 25;

/// Writes bricks as one VTK unstructured grid (`.vtu`, XML with raw appended data, little-endian), mm. Cells have their `tooth`, from 1; of each
/// named part of the surface there is an array of points that is 1 on it. A comment at the head states the conventions.
///
/// # Errors
/// When the stream refuses.
pub fn write_vtu(header: &Header, body: &BrickBody<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let (points, cells) = (body.nodes.len(), body.count());
    let mut declared = Declared { offset: 0, out };
    let origin = format!("{}; spec: {}, hash {}; job: {}", header.program, header.spec, header.spec_hash, header.job);
    let lines = std::iter::once(origin).chain(sentences(header, body));
    // twice, for three in a row
    let inert = |line: String| one_line(&line).replace("--", "- -").replace("--", "- -");
    let head: Vec<String> = lines.map(inert).collect();
    writeln!(declared.out, "<?xml version=\"1.0\"?>\n<!--\n{}\n-->", head.join("\n"))?;
    writeln!(
        declared.out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<PointData>"
    )?;
    body.sets.iter().try_for_each(|set| declared.array("UInt8", &set.name, 1, points))?;
    writeln!(declared.out, "</PointData>\n<CellData>")?;
    declared.array("Int32", "tooth", 1, 4 * cells)?;
    writeln!(declared.out, "</CellData>\n<Points>")?;
    declared.array("Float64", "points", 3, 24 * points)?;
    writeln!(declared.out, "</Points>\n<Cells>")?;
    declared.array("Int64", "connectivity", 1, 8 * body.bricks.len())?;
    declared.array("Int64", "offsets", 1, 8 * cells)?;
    declared.array("UInt8", "types", 1, cells)?;
    write!(declared.out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    write_arrays(body, declared.out)?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?;
    Ok(())
}

/// The XML part; `offset` goes on to where the next array begins.
struct Declared<'o> {
    offset: u64,
    out: &'o mut dyn Write,
}

impl Declared<'_> {
    fn array(&mut self, kind: &str, name: &str, components: usize, bytes: usize) -> Result<(), WriteError> {
        writeln!(
            self.out,
            "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{}\"/>",
            escaped(name),
            self.offset
        )?;
        self.offset += 8 + bytes as u64;
        Ok(())
    }
}

/// The arrays in the order in which they are declared, each with its length before it.
fn write_arrays(body: &BrickBody<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let cells = body.count();
    let mut held = Vec::new();
    for set in body.sets {
        held.clear();
        held.resize(body.nodes.len(), 0);
        set.nodes.iter().for_each(|node| held[*node as usize] = 1);
        write_array(&held, out)?;
    }
    let numbers = |held: &mut Vec<u8>, numbers: &mut dyn Iterator<Item = i64>| {
        held.clear();
        numbers.for_each(|number| held.extend_from_slice(&number.to_le_bytes()));
    };
    held.clear();
    (0..cells).for_each(|cell| held.extend_from_slice(&((cell * body.teeth / cells) as i32 + 1).to_le_bytes()));
    write_array(&held, out)?;
    held.clear();
    body.nodes.iter().flatten().for_each(|x| held.extend_from_slice(&x.to_le_bytes()));
    write_array(&held, out)?;
    numbers(&mut held, &mut body.bricks.iter().map(|node| i64::from(*node)));
    write_array(&held, out)?;
    numbers(&mut held, &mut (1..=cells).map(|cell| (cell * body.nodes_of_brick) as i64));
    write_array(&held, out)?;
    let kind = if body.nodes_of_brick == 8 { HEXAHEDRON } else { QUADRATIC_HEXAHEDRON };
    write_array(&vec![kind; cells], out)
}

fn write_array(bytes: &[u8], out: &mut dyn Write) -> Result<(), WriteError> {
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(bytes)?;
    Ok(())
}
