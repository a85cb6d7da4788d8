//! STL: read back by a reader of others.

mod synthetic;

use std::io::Cursor;

use flank_export::{Dataset, Patch, write_stl};
use synthetic::{Gear, bevel, cross, dataset, gallery, holes, plane, without};

fn bytes_of(dataset: &Dataset) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_stl(&dataset.surfaces(), &mut bytes).expect("a sound dataset");
    bytes.into_inner()
}

type Triangle = ([f64; 3], [[f64; 3]; 3]);

/// Normals and corners as an independent reader sees them.
fn triangles(patches: Vec<Patch>) -> Vec<Triangle> {
    let bytes = bytes_of(&dataset("job", patches));
    let wide = |v: stl_io::Vector<f32>| [f64::from(v[0]), f64::from(v[1]), f64::from(v[2])];
    let mut reader = stl_io::create_stl_reader(&mut Cursor::new(bytes)).expect("a binary STL").collect::<Vec<_>>();
    let all = reader.drain(..).map(|triangle| triangle.expect("a whole triangle"));
    all.map(|triangle| (wide(triangle.normal), triangle.vertices.map(wide))).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The normal of the grid point nearest to a corner.
fn normal_at(patch: &Patch, corner: [f64; 3]) -> [f64; 3] {
    let distance = |a: [f64; 3]| dot(sub(a, corner), sub(a, corner));
    let solved = patch.points.iter().filter(|point| point.is_solved());
    solved.min_by(|a, b| distance(a.position).total_cmp(&distance(b.position))).expect("a solved point").normal
}

fn assert_facets_agree(patch: &Patch, triangles: &[Triangle]) {
    for (normal, corners) in triangles {
        let wound = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let length = dot(wound, wound).sqrt();
        assert!(dot(wound, *normal) > 0.999 * length, "the stored normal is that of the winding");
        for corner in corners {
            assert!(dot(*normal, normal_at(patch, *corner)) > 0.9, "{normal:?} at {corner:?}");
        }
    }
}

#[test]
fn facets_face_where_the_point_normals_do() {
    let helical = Gear { helix: 0.4, width: 30.0 }.flank("flank", [21, 15]);
    let other_side = synthetic::mirrored(&helical, "other");
    for patch in [helical, other_side, bevel([21, 11])] {
        let triangles = triangles(vec![patch.clone()]);
        assert_eq!(triangles.len(), 2 * (patch.rows.count - 1) * (patch.columns.count - 1));
        assert_facets_agree(&patch, &triangles);
    }
}

#[test]
fn only_solved_points_are_used() {
    let whole = plane([3, 3], [0.0; 3], 2.0);
    let corner = without(whole.clone(), |i, j| (i == 0 && j == 0).then_some("out_of_range"));
    assert_eq!(triangles(vec![corner.clone()]).len(), 7);
    assert_facets_agree(&corner, &triangles(vec![corner.clone()]));
    let centre = without(whole.clone(), |i, j| (i == 1 && j == 1).then_some("out_of_range"));
    assert_eq!(triangles(vec![centre]).len(), 4);
    let row = without(whole.clone(), |i, _| (i == 1).then_some("out_of_range"));
    assert!(triangles(vec![row]).is_empty());
    let holed = without(Gear { helix: 0.0, width: 20.0 }.flank("flank", [25, 15]), holes);
    assert!(triangles(vec![holed]).iter().all(|(_, corners)| corners.iter().flatten().all(|x| x.is_finite())));
}

#[test]
fn cells_are_cut_along_the_shorter_diagonal() {
    let mut patch = plane([2, 2], [0.0; 3], 1.0);
    // Pulls two opposite corners apart: the cut must join the other two.
    patch.points[0].position = [-1.0, -1.0, 0.0];
    patch.points[3].position = [2.0, 2.0, 0.0];
    let [near, far] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (_, corners) in triangles(vec![patch]) {
        assert!(corners.contains(&near) && corners.contains(&far));
    }
}

#[test]
fn an_edge_that_is_a_point_leaves_no_sliver() {
    let mut patch = plane([2, 2], [0.0; 3], 1.0);
    patch.points[1].position = patch.points[0].position;
    assert_eq!(triangles(vec![patch]).len(), 1);
}

#[test]
fn the_head_says_mm_and_not_solid() {
    let bytes = bytes_of(&dataset("Zähne", vec![bevel([3, 3])]));
    let head = String::from_utf8(bytes[..80].to_vec()).expect("ASCII");
    assert!(head.starts_with("binary STL in mm; flank 0.1.0; specs/jobs/synthetic.flank; Z?hne"), "{head}");
    assert_eq!(bytes.len(), 84 + 50 * 8);
}

#[test]
fn every_dataset_has_a_mesh() {
    for (name, dataset) in gallery() {
        let bytes = bytes_of(&dataset);
        let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
        assert_eq!(bytes.len(), 84 + 50 * count, "{name}");
        assert_eq!(bytes, bytes_of(&dataset));
    }
}

#[test]
fn a_grid_without_points_ends() {
    let mut patch = plane([1, 1], [0.0; 3], 1.0);
    patch.points.clear();
    patch.columns.count = 0;
    patch.rows.count = usize::MAX;
    assert!(triangles(vec![patch]).is_empty());
}
