//! Parts of distances that are fitted alone.

/// A shape of which less than this share is its own is made up by those before it.
const OWN: f64 = 1e-9;

/// The space of some shapes over points: what of distances lies in it is fitted, and the rest is left as it is.
///
/// ```
/// use flank_solver::Shapes;
///
/// let slope = Shapes::new(&[vec![1.0, 1.0, 1.0], vec![-1.0, 0.0, 1.0]]);
/// let part = slope.part(&[0.0, 3.0, 6.0]);
/// assert!(part.iter().zip([0.0, 3.0, 6.0]).all(|(a, b)| (a - b).abs() < 1e-14), "all of a line");
/// assert!(slope.part(&[1.0, -2.0, 1.0]).iter().all(|off| off.abs() < 1e-14), "nothing of what is square to it");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Shapes {
    /// Of length one, square to each other.
    basis: Vec<Vec<f64>>,
}

impl Shapes {
    /// Of shapes with a value for each point; those that others make up count once.
    ///
    /// # Panics
    /// If they have not as many values.
    #[must_use]
    pub fn new(shapes: &[Vec<f64>]) -> Shapes {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for shape in shapes {
            let whole = product(shape, shape).sqrt();
            let mut own = shape.clone();
            // twice is enough
            for _ in 0..2 {
                for unit in &basis {
                    let along = product(&own, unit);
                    own.iter_mut().zip(unit).for_each(|(own, unit)| *own -= along * unit);
                }
            }
            let length = product(&own, &own).sqrt();
            if length > OWN * whole {
                basis.push(own.into_iter().map(|own| own / length).collect());
            }
        }
        Shapes { basis }
    }

    /// The part of distances that lies in the space.
    ///
    /// # Panics
    /// If there are not as many as points.
    #[must_use]
    pub fn part(&self, of: &[f64]) -> Vec<f64> {
        let mut part = vec![0.0; of.len()];
        for unit in &self.basis {
            let along = product(of, unit);
            part.iter_mut().zip(unit).for_each(|(part, unit)| *part += along * unit);
        }
        part
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "a value for each point");
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
