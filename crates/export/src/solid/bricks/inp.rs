//! Bricks as an input file of Abaqus and CalculiX.

use std::io::Write;

use super::{BrickBody, sentences};
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::text::number::push_shortest;
use crate::text::one_line;

/// Numbers on a line at the most.
const ON_LINE: usize = 16;
/// Digits of the largest coordinate: CalculiX reads twenty letters of a number and no more.
const DIGITS: i32 = 15;
/// Steel: Young's modulus, MPa, Poisson's ratio, and density, t/mm³.
const ELASTIC: &str = "206000., 0.3";
const DENSITY: &str = "7.85E-9";

/// Writes bricks as an input file of Abaqus and CalculiX, mm: C3D8 or C3D20R, an element set for each tooth and one for all, a node set and
/// an element surface for each named part of the surface, a section of steel. Comments at the head state the conventions.
///
/// # Errors
/// When the stream refuses.
pub fn write_inp(header: &Header, body: &BrickBody<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let origin = format!("{}; spec: {}, hash {}; job: {}", header.program, header.spec, header.spec_hash, header.job);
    for sentence in std::iter::once(one_line(&origin)).chain(sentences(header, body)) {
        writeln!(out, "** {sentence}")?;
    }
    write_nodes(body, out)?;
    write_bricks(body, out)?;
    let all = element_set(body.name);
    writeln!(out, "*ELSET, ELSET={all}")?;
    (1..=body.teeth).try_for_each(|tooth| writeln!(out, "TOOTH_{tooth},"))?;
    for set in body.sets {
        writeln!(out, "*NSET, NSET={}", set.name)?;
        write_numbers(set.nodes.iter().map(|node| node + 1), out)?;
        writeln!(out, "*SURFACE, NAME={}, TYPE=ELEMENT", set.name)?;
        set.faces.iter().try_for_each(|(brick, face)| writeln!(out, "{}, S{}", brick + 1, face + 1))?;
    }
    writeln!(out, "*MATERIAL, NAME=STEEL\n*ELASTIC\n{ELASTIC}\n*DENSITY\n{DENSITY}")?;
    writeln!(out, "*SOLID SECTION, ELSET={all}, MATERIAL=STEEL")?;
    Ok(())
}

/// The body's name as that of an element set, which no tooth has.
fn element_set(name: &str) -> String {
    let safe: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
    format!("BODY_{safe}")
}

fn write_nodes(body: &BrickBody<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let largest = body.nodes.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let scale = 10f64.powi((DIGITS - 1 - largest.max(1e-3).log10().ceil() as i32).max(0));
    writeln!(out, "*NODE, NSET=NODES")?;
    let mut line = Vec::new();
    for (number, node) in body.nodes.iter().enumerate() {
        line.clear();
        write!(line, "{}", number + 1)?;
        for x in node {
            line.push(b',');
            push_shortest((x * scale).round() / scale, &mut line);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

fn write_bricks(body: &BrickBody<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let kind = if body.nodes_of_brick == 8 { "C3D8" } else { "C3D20R" };
    let of_tooth = (body.count() / body.teeth).max(1);
    let mut line = Vec::new();
    for (number, nodes) in body.bricks.chunks(body.nodes_of_brick).enumerate() {
        if number.is_multiple_of(of_tooth) {
            writeln!(out, "*ELEMENT, TYPE={kind}, ELSET=TOOTH_{}", number / of_tooth + 1)?;
        }
        line.clear();
        write!(line, "{}", number + 1)?;
        for (k, node) in nodes.iter().enumerate() {
            // the brick's own number stands on the first line, too
            let separator = if k + 1 == ON_LINE { ",\n" } else { "," };
            write!(line, "{separator}{}", node + 1)?;
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

fn write_numbers(numbers: impl Iterator<Item = u32>, out: &mut dyn Write) -> Result<(), WriteError> {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    Ok(numbers.chunks(ON_LINE).try_for_each(|line| writeln!(out, "{},", line.join(",")))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BrickSet;

    #[test]
    fn a_brick_of_the_second_order_takes_two_lines() {
        let header = Header {
            program: "flank".into(),
            spec: "a.chain".into(),
            spec_hash: "5e1f".into(),
            job: "a".into(),
            conventions: Vec::new(),
        };
        let nodes: Vec<[f64; 3]> = (0..20).map(|k| [f64::from(k) / 3.0, -1e-17, 0.0]).collect();
        let bricks: Vec<u32> = (0..20).collect();
        let set = BrickSet { name: "TIP".into(), faces: vec![(0, 2)], nodes: vec![0, 19] };
        let body = BrickBody {
            name: "a-b",
            frame: "m.work",
            nodes: &nodes,
            nodes_of_brick: 20,
            bricks: &bricks,
            teeth: 1,
            sets: &[set],
            deviation: 1e-4,
        };
        let mut file = Vec::new();
        write_inp(&header, &body, &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        assert!(text.contains("\n2,0.3333333333333,0,0\n"), "{text}");
        assert!(
            text.contains(
                "*ELEMENT, TYPE=C3D20R, ELSET=TOOTH_1\n1,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,\n16,17,18,19,20\n"
            ),
            "{text}"
        );
        assert!(text.contains("*NSET, NSET=TIP\n1,20,\n*SURFACE, NAME=TIP, TYPE=ELEMENT\n1, S3\n"), "{text}");
        assert!(
            text.contains("*ELSET, ELSET=BODY_A_B\nTOOTH_1,\n") && text.contains("*SOLID SECTION, ELSET=BODY_A_B,"),
            "{text}"
        );
        assert!(text.lines().all(|line| line.split(',').all(|field| line.starts_with('*') || field.len() <= 20)));
    }
}
