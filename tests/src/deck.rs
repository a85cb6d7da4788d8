//! Input files of Abaqus and CalculiX as tests read them: nodes, bricks, sets and surfaces.

use std::collections::BTreeMap;

/// What an input file holds. Numbers of nodes and bricks are those of the file, less one.
#[derive(Clone, Debug, Default)]
pub struct Deck {
    /// mm
    pub nodes: Vec<[f64; 3]>,
    /// The nodes of each.
    pub bricks: Vec<Vec<usize>>,
    /// Faces of bricks, from 0.
    pub surfaces: BTreeMap<String, Vec<(usize, usize)>>,
    /// Nodes.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Bricks.
    pub tooth_sets: BTreeMap<String, Vec<usize>>,
}

/// The corners of the faces S1 to S6 of a brick, then the middles of their edges, as the manual of CalculiX numbers them (6.2.1 and 6.2.3).
pub const FACES: [[usize; 8]; 6] = [
    [1, 2, 3, 4, 9, 10, 11, 12],
    [5, 8, 7, 6, 16, 15, 14, 13],
    [1, 5, 6, 2, 17, 13, 18, 9],
    [2, 6, 7, 3, 18, 14, 19, 10],
    [3, 7, 8, 4, 19, 15, 20, 11],
    [4, 8, 5, 1, 20, 16, 17, 12],
];

impl Deck {
    /// # Panics
    /// If the file is not what the program writes.
    pub fn read(text: &str) -> Deck {
        let mut deck = Deck::default();
        let (mut keyword, mut name, mut started) = (String::new(), String::new(), Vec::new());
        for line in text.lines().filter(|line| !line.starts_with("**")) {
            if let Some(head) = line.strip_prefix('*') {
                let mut parts = head.split(',').map(str::trim);
                keyword = parts.next().expect("a keyword").to_string();
                let of = |part: &str| {
                    let value = ["ELSET=", "NSET=", "NAME="].iter().find_map(|key| part.strip_prefix(key));
                    value.map(str::to_string)
                };
                name = parts.filter_map(of).next().unwrap_or_default();
                continue;
            }
            let fields: Vec<&str> = line.split(',').map(str::trim).filter(|field| !field.is_empty()).collect();
            let numbers = || fields.iter().map(|field| field.parse::<usize>().expect("a number"));
            match keyword.as_str() {
                "NODE" => {
                    let coordinate = |k: usize| fields[k].parse::<f64>().expect("a coordinate");
                    deck.nodes.push([1, 2, 3].map(coordinate));
                    assert_eq!(fields[0], deck.nodes.len().to_string(), "numbered one after the other");
                }
                "ELEMENT" => {
                    started.extend(numbers());
                    if !line.ends_with(',') {
                        let brick: Vec<usize> = std::mem::take(&mut started);
                        deck.tooth_sets.entry(name.clone()).or_default().push(brick[0] - 1);
                        deck.bricks.push(brick[1..].iter().map(|node| node - 1).collect());
                        assert_eq!(brick[0], deck.bricks.len(), "numbered one after the other");
                    }
                }
                "NSET" => deck.node_sets.entry(name.clone()).or_default().extend(numbers().map(|node| node - 1)),
                "SURFACE" => {
                    let face = fields[1].strip_prefix('S').and_then(|face| face.parse::<usize>().ok());
                    let brick = fields[0].parse::<usize>().expect("a brick");
                    deck.surfaces.entry(name.clone()).or_default().push((brick - 1, face.expect("a face") - 1));
                }
                _ => {}
            }
        }
        deck
    }

    /// The nodes of a face: corners, then the middles of its edges.
    pub fn face(&self, (brick, face): (usize, usize)) -> Vec<usize> {
        let own = &self.bricks[brick];
        FACES[face].iter().filter(|node| **node <= own.len()).map(|node| own[node - 1]).collect()
    }

    /// The integral of the normal that points into the brick over a face, mm²: by the quadratic shape functions where it has eight nodes.
    pub fn face_area(&self, face: (usize, usize)) -> [f64; 3] {
        let nodes: Vec<[f64; 3]> = self.face(face).iter().map(|node| self.nodes[*node]).collect();
        let gauss = [(-(0.6f64.sqrt()), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6f64.sqrt(), 5.0 / 9.0)];
        let mut sum = [0.0; 3];
        for (x, by_x) in gauss {
            for (y, by_y) in gauss {
                let slopes = face_slopes(nodes.len(), [x, y]);
                let tangent = |k: usize| {
                    let parts = nodes.iter().zip(&slopes);
                    parts.fold([0.0; 3], |sum, (node, slope)| [0, 1, 2].map(|j| sum[j] + slope[k] * node[j]))
                };
                let (a, b) = (tangent(0), tangent(1));
                let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                (0..3).for_each(|k| sum[k] += by_x * by_y * normal[k]);
            }
        }
        sum
    }
}

/// The derivatives of the shape functions of a face with four or eight nodes.
fn face_slopes(count: usize, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    const PLACES: [[f64; 2]; 8] =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    let slope = |[a, b]: [f64; 2]| {
        let (p, q) = (1.0 + a * x, 1.0 + b * y);
        match (count, a == 0.0, b == 0.0) {
            (4, ..) => [0.25 * a * q, 0.25 * b * p],
            (_, true, _) => [-x * q, 0.5 * b * (1.0 - x * x)],
            (_, _, true) => [0.5 * a * (1.0 - y * y), -y * p],
            _ => [
                0.25 * a * q * (a * x + b * y - 1.0) + 0.25 * a * p * q,
                0.25 * b * p * (a * x + b * y - 1.0) + 0.25 * b * p * q,
            ],
        }
    };
    PLACES[..count].iter().map(|place| slope(*place)).collect()
}
