//! OBJ, 3MF and VTK files: the points and triangles of the dataset, read back.

mod synthetic;

use std::io::{Cursor, Read};

use flank_export::{Dataset, Patch, Surfaces, Target, WriteError, write_3mf, write_obj, write_vtp};
use synthetic::{Gear, bevel, cross, dataset, gallery, holes, plane, undercut, with_fields, without};

type Writer = fn(&Surfaces<'_>, &mut dyn Target) -> Result<(), WriteError>;

const VTP: Writer = write_vtp;
const OBJ: Writer = |surfaces, out| write_obj(surfaces, out);
const THREE_MF: Writer = |surfaces, out| write_3mf(surfaces, out);

/// One object of a mesh as a reader sees it: points and triangles, which number them from 0.
#[derive(Debug, PartialEq)]
struct Object {
    points: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
}

fn bytes(write: Writer, dataset: &Dataset) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&dataset.surfaces(), &mut bytes).expect("a sound dataset");
    bytes.into_inner()
}

fn from_obj(bytes: &[u8]) -> Vec<Object> {
    let mut objects: Vec<Object> = Vec::new();
    let mut before = 0;
    for line in std::str::from_utf8(bytes).expect("text").lines() {
        let mut words = line.split(' ');
        match words.next() {
            Some("o") => {
                before += objects.last().map_or(0, |object| object.points.len());
                objects.push(Object { points: Vec::new(), triangles: Vec::new() });
            }
            Some("v") => {
                let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
                objects.last_mut().expect("an object").points.push(numbers.try_into().expect("three"));
            }
            Some("f") => {
                let corner = |word: &str| {
                    let (point, normal) = word.split_once("//").expect("a point and a normal");
                    assert_eq!(point, normal);
                    point.parse::<usize>().expect("a number") - 1 - before
                };
                let corners: Vec<usize> = words.map(corner).collect();
                objects.last_mut().expect("an object").triangles.push(corners.try_into().expect("three"));
            }
            _ => {}
        }
    }
    objects
}

fn from_3mf(bytes: &[u8]) -> Vec<Object> {
    let mut package = zip::ZipArchive::new(Cursor::new(bytes)).expect("a zip");
    let mut text = String::new();
    package.by_name("3D/3dmodel.model").expect("the model").read_to_string(&mut text).expect("text");
    let model = roxmltree::Document::parse(&text).expect("well-formed");
    assert_eq!(model.root_element().attribute("unit"), Some("millimeter"));
    let object = |node: roxmltree::Node<'_, '_>| {
        assert_eq!(node.attribute("type"), Some("surface"));
        let all = |tag: &'static str| node.descendants().filter(move |inner| inner.has_tag_name(tag));
        let read = |node: roxmltree::Node<'_, '_>, names: [&str; 3]| {
            names.map(|name| node.attribute(name).expect("it is there").parse::<f64>().expect("a number"))
        };
        Object {
            points: all("vertex").map(|vertex| read(vertex, ["x", "y", "z"])).collect(),
            triangles: all("triangle").map(|t| read(t, ["v1", "v2", "v3"]).map(|at| at as usize)).collect(),
        }
    };
    model.descendants().filter(|node| node.has_tag_name("object")).map(object).collect()
}

/// The arrays of each piece of a VTK file by name, as numbers, in the order of the file.
fn pieces(bytes: &[u8]) -> Vec<Vec<(String, Vec<f64>)>> {
    let end = b"<AppendedData encoding=\"raw\">";
    let at = bytes.windows(end.len()).position(|window| window == end).expect("appended data");
    let text = std::str::from_utf8(&bytes[..at]).expect("text").to_owned() + "</VTKFile>";
    let data = &bytes[at + end.len()..];
    let data = &data[1 + data.iter().position(|byte| *byte == b'_').expect("where data begin")..];
    let model = roxmltree::Document::parse(&text).expect("well-formed");
    assert_eq!(model.root_element().attribute("header_type"), Some("UInt64"));
    let array = |node: roxmltree::Node<'_, '_>| {
        let offset: usize = node.attribute("offset").expect("appended").parse().expect("a number");
        let (head, rest) = data[offset..].split_first_chunk::<8>().expect("inside the file");
        let values = &rest[..u64::from_le_bytes(*head) as usize];
        let values = match node.attribute("type") {
            Some("Int32") => values.as_chunks().0.iter().map(|b| f64::from(i32::from_le_bytes(*b))).collect(),
            Some("Int64") => values.as_chunks().0.iter().map(|b| i64::from_le_bytes(*b) as f64).collect(),
            Some("Float64") => values.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
            other => panic!("numbers of type {other:?}"),
        };
        (node.attribute("Name").expect("a name").to_owned(), values)
    };
    let piece = |node: roxmltree::Node<'_, '_>| {
        let arrays = node.descendants().filter(|inner| inner.has_tag_name("DataArray")).map(array).collect::<Vec<_>>();
        let count = |name| node.attribute(name).expect("it is there").parse::<usize>().expect("a number");
        assert_eq!(self::array(&arrays, "points").len(), 3 * count("NumberOfPoints"));
        assert_eq!(self::array(&arrays, "offsets").len(), count("NumberOfPolys"));
        arrays
    };
    model.descendants().filter(|node| node.has_tag_name("Piece")).map(piece).collect()
}

fn array<'a>(piece: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &piece.iter().find(|(known, _)| known == name).expect("it is there").1
}

fn threes(numbers: &[f64]) -> Vec<[f64; 3]> {
    numbers.as_chunks().0.to_vec()
}

fn from_vtp(bytes: &[u8]) -> Vec<Object> {
    let object = |piece: Vec<(String, Vec<f64>)>| {
        assert!(array(&piece, "offsets").iter().enumerate().all(|(k, offset)| *offset == 3.0 * (k as f64 + 1.0)));
        let triangles =
            threes(array(&piece, "connectivity")).iter().map(|corners| corners.map(|at| at as usize)).collect();
        Object { points: threes(array(&piece, "points")), triangles }
    };
    pieces(bytes).into_iter().map(object).collect()
}

fn solved(patch: &Patch) -> Vec<[f64; 3]> {
    patch.points.iter().filter(|point| point.is_solved()).map(|point| point.position).collect()
}

#[test]
fn every_format_has_the_same_points_and_triangles() {
    // VTK has more points than these where some are cut away
    for (name, dataset) in gallery().into_iter().filter(|(name, _)| *name != "undercut") {
        let expected: Vec<Vec<[f64; 3]>> = dataset.patches.iter().map(solved).collect();
        let vtp = from_vtp(&bytes(VTP, &dataset));
        let obj = from_obj(&bytes(OBJ, &dataset));
        assert_eq!(vtp, obj, "{name}");
        assert_eq!(vtp.into_iter().map(|object| object.points).collect::<Vec<_>>(), expected, "{name}: bit for bit");
        let with_triangles: Vec<Object> = obj.into_iter().filter(|object| !object.triangles.is_empty()).collect();
        assert_eq!(from_3mf(&bytes(THREE_MF, &dataset)), with_triangles, "{name}");
    }
}

#[test]
fn triangles_face_where_the_normals_do() {
    let patch = Gear { helix: 0.4, width: 30.0 }.flank("flank", [21, 15]);
    let object = from_vtp(&bytes(VTP, &dataset("job", vec![patch.clone()]))).remove(0);
    assert_eq!(object.triangles.len(), 2 * 20 * 14);
    for corners in object.triangles {
        let [a, b, c] = corners.map(|at| object.points[at]);
        let [ab, ac] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let normal = patch.points[corners[0]].normal;
        assert!(cross(ab, ac).iter().zip(normal).map(|(x, n)| x * n).sum::<f64>() > 0.0);
    }
}

#[test]
fn vtk_has_all_that_is_known_of_the_points() {
    let first = with_fields(without(bevel([5, 4]), holes));
    let second = plane([3, 3], [0.0; 3], 5.0);
    let pieces = pieces(&bytes(VTP, &dataset("job", vec![first.clone(), second.clone()])));
    let points: Vec<_> = first.points.iter().enumerate().filter(|(_, point)| point.is_solved()).collect();
    assert_eq!(array(&pieces[0], "row"), points.iter().map(|(at, _)| (at / 4) as f64).collect::<Vec<_>>());
    assert_eq!(array(&pieces[0], "column"), points.iter().map(|(at, _)| (at % 4) as f64).collect::<Vec<_>>());
    assert_eq!(threes(array(&pieces[0], "normal")), points.iter().map(|(_, point)| point.normal).collect::<Vec<_>>());
    let degrees: Vec<f64> = points.iter().map(|(_, point)| point.unknowns[0].to_degrees()).collect();
    assert_eq!(array(&pieces[0], "phi [deg]"), degrees);
    assert_eq!(array(&pieces[0], "residual"), points.iter().map(|(_, point)| point.residual).collect::<Vec<_>>());
    assert_eq!(array(&pieces[0], "k1 [1/mm]"), points.iter().map(|(at, _)| *at as f64).collect::<Vec<_>>());
    assert_eq!(array(&pieces[0], "d1 [1]").len(), 3 * points.len());
    assert!(array(&pieces[1], "k1 [1/mm]").iter().all(|value| value.is_nan()), "the second surface has no such field");
    assert_eq!(array(&pieces[1], "surface"), vec![1.0; 9]);
}

/// They have their numbers, and no triangle has them for a corner.
#[test]
fn vtk_has_points_that_are_cut_away() {
    let patch = undercut(with_fields(plane([5, 4], [0.0; 3], 5.0)), 1..2);
    let data = dataset("job", vec![patch.clone()]);
    let pieces = pieces(&bytes(VTP, &data));
    let status = |at: usize| [0.0, 1.0, 3.0][usize::from((4..8).contains(&at)) + usize::from(at == 4)];
    assert_eq!(array(&pieces[0], "status"), (0..20).map(status).collect::<Vec<_>>());
    assert_eq!(
        threes(array(&pieces[0], "points")),
        patch.points.iter().map(|point| point.position).collect::<Vec<_>>()
    );
    let has_field = |at: usize| !array(&pieces[0], "k1 [1/mm]")[at].is_nan();
    assert!((1..20).all(|at| has_field(at) == (status(at) == 0.0)));
    let corners = array(&pieces[0], "connectivity");
    assert_eq!(corners.len(), 3 * 2 * 2 * 3);
    assert!(corners.iter().all(|at| status(*at as usize) == 0.0 && *at < 20.0));
    // the other formats: the same triangles of the solved points alone
    let [obj] = &from_obj(&bytes(OBJ, &data))[..] else { panic!("one surface") };
    assert_eq!((obj.points.len(), obj.triangles.len()), (16, 12));
    assert_eq!(from_3mf(&bytes(THREE_MF, &data))[0].points.len(), 16);
    let places: Vec<[f64; 3]> = corners.iter().map(|at| patch.points[*at as usize].position).collect();
    assert_eq!(obj.triangles.as_flattened().iter().map(|at| obj.points[*at]).collect::<Vec<_>>(), places);
}

#[test]
fn the_same_dataset_gives_the_same_bytes() {
    let dataset = dataset("job", vec![with_fields(bevel([5, 4]))]);
    for write in [VTP, OBJ, THREE_MF] {
        assert_eq!(bytes(write, &dataset), bytes(write, &dataset));
    }
}

/// A backslash at the end of a line would join the next one to it.
#[test]
fn no_line_of_an_obj_file_goes_on() {
    let mut dataset = dataset("job\\", vec![plane([3, 3], [30.0, 0.0, 0.0], 5.0)]);
    dataset.header.conventions = vec!["a sentence \\".to_owned()];
    let patch = &mut dataset.patches[0];
    (patch.name, patch.frame) = ("flank\\".to_owned(), "m.work\\\\".to_owned());
    let written = bytes(OBJ, &dataset);
    let text = std::str::from_utf8(&written).expect("text");
    assert!(text.lines().all(|line| !line.ends_with('\\')), "{text}");
    assert_eq!(from_obj(&written)[0].points.len(), 9);
}
