//! Closed surfaces of triangles.

use nalgebra::Vector3;

/// A closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// The corners, mm, each once.
    pub vertices: Vec<[f64; 3]>,
    /// Each as three vertices, anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedMesh {
    /// What it encloses, mm³.
    pub fn volume(&self) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|k| Vector3::from(self.vertices[k as usize]));
        self.triangles.iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }

    /// Its area, mm².
    pub fn area(&self) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|k| Vector3::from(self.vertices[k as usize]));
        self.triangles.iter().map(corners).map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
    }

    /// Vertices less edges plus faces: 2 of a ball, 0 of a ring.
    pub fn euler_characteristic(&self) -> i64 {
        let edges = self.triangles.len() * 3 / 2;
        self.vertices.len() as i64 - edges as i64 + self.triangles.len() as i64
    }

    /// Whether every edge has two triangles that run along it in opposite senses.
    pub fn is_closed(&self) -> bool {
        let sides = self.triangles.iter().flat_map(|t| (0..3).map(move |k| (t[k], t[(k + 1) % 3])));
        let mut all: Vec<(u32, u32)> = sides.collect();
        all.sort_unstable();
        let is_once = all.windows(2).all(|pair| pair[0] != pair[1]);
        is_once && all.iter().all(|(a, b)| all.binary_search(&(*b, *a)).is_ok())
    }

    /// The same facing out of what it encloses.
    pub(crate) fn turned_outwards(mut self) -> ClosedMesh {
        if self.volume() < 0.0 {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        self
    }
}
