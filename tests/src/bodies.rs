//! Closed meshes as files have them.

use std::collections::BTreeSet;
use std::path::Path;

/// The corners of the triangles of a binary STL file.
///
/// # Panics
/// If there is no such file.
pub fn triangles(path: &Path) -> Vec<[[f32; 3]; 3]> {
    let bytes = std::fs::read(path).expect("written");
    let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("four"));
    let corner = |bytes: &[u8]| [0, 4, 8].map(|k| number(&bytes[k..k + 4]));
    bytes[84..].chunks_exact(50).map(|of| [12, 24, 36].map(|k| corner(&of[k..k + 12]))).collect()
}

/// Vertices less edges plus faces of a mesh, in which each side of a triangle is one of another that runs along it the other way.
///
/// # Panics
/// If it is not closed.
pub fn euler_characteristic(triangles: &[[[f32; 3]; 3]]) -> i64 {
    let bits = |corner: [f32; 3]| corner.map(f32::to_bits);
    let sides = triangles.iter().flat_map(|t| (0..3).map(move |k| (bits(t[k]), bits(t[(k + 1) % 3]))));
    let all: Vec<_> = sides.collect();
    let once: BTreeSet<_> = all.iter().copied().collect();
    assert_eq!(once.len(), all.len(), "no side twice in one sense");
    assert!(once.iter().all(|(a, b)| once.contains(&(*b, *a))), "each side has its other triangle");
    let vertices: BTreeSet<_> = all.iter().map(|(a, _)| *a).collect();
    vertices.len() as i64 - all.len() as i64 / 2 + triangles.len() as i64
}

/// What a closed mesh encloses, mm³.
pub fn volume(triangles: &[[[f32; 3]; 3]]) -> f64 {
    let of = |t: &[[f32; 3]; 3]| {
        let [a, b, c] = t.map(|corner| corner.map(f64::from));
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    triangles.iter().map(of).sum::<f64>() / 6.0
}
