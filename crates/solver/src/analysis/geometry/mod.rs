//! What a surface under constraint is like at a point that lies on it.
//!
//! Everything follows from first derivatives of position, normal and constraints: with T a basis of the null space of
//! ∂c/∂p, the columns of ∂r/∂p · T span the tangent plane and those of ∂n/∂p · T say how the normal turns along them.

mod curvature;
mod null_space;

use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};
use nalgebra::{DMatrix, DMatrixView, Matrix2, Matrix3x2, Vector3};

pub(crate) use curvature::CurvatureChange;
use curvature::oriented;
pub(crate) use curvature::tangents;
pub use curvature::{Curvature, Principal};
use null_space::{null_space, null_space_change};

use crate::surface::bound::BoundSurface;

/// A direction shorter than this share of what it was summed up from is none.
const VANISHED: f64 = 1e-10;
/// Two grid coordinates whose gradients along the surface are this close to parallel do not fix a point.
const NO_COORDINATES: f64 = 1e-10;

/// A surface with the derivatives that its geometry at a point follows from.
///
/// A ball of radius 2, its parameters longitude and latitude:
///
/// ```
/// use flank_expr::Graph;
/// use flank_expr::geometry::{Surface, Vector3};
/// use flank_solver::{BoundSurface, Range, SurfaceGeometry};
///
/// let graph = Graph::new();
/// let (a, b) = (graph.variable("a"), graph.variable("b"));
/// let position = Vector3([a.cos() * b.cos(), a.sin() * b.cos(), b.sin()]).map(|x| 2.0 * x);
/// let ball = Surface::parametric([a, b], position, false);
/// let anywhere = Range { low: -2.0, high: 2.0 };
/// let ball = BoundSurface::new(&ball, vec![anywhere; 2], &[]);
/// let geometry = SurfaceGeometry::new(&ball, &[], [a, b]).expect("nothing else is unknown");
///
/// let point = geometry.at(&[0.3, 0.5]);
/// let curvature = point.curvature.expect("not a singular point");
/// let principal = curvature.principal();
/// assert!((principal.k1 - 0.5).abs() < 1e-15 && (principal.k2 - 0.5).abs() < 1e-15);
/// assert_eq!(principal.directions, None, "every direction is principal");
/// let metric = point.metric.expect("longitude and latitude fix a point");
/// assert!((metric.e - (2.0 * 0.5f64.cos()).powi(2)).abs() < 1e-15 && (metric.g - 4.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct SurfaceGeometry {
    unknowns: usize,
    motions: usize,
    constraints: usize,
    tape: Tape,
}

/// What a surface is like at one of its points. Nothing in it is a NaN: what is not defined is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct PointGeometry {
    /// How the surface bends. `None` at a singular point, where it has no tangent plane.
    pub curvature: Option<Curvature>,
    /// How long the steps of the two coordinates are. `None` where they do not fix a point.
    pub metric: Option<Metric>,
    /// How tool and work touch and slide.
    pub contact: Contact,
}

/// How tool and work touch while the point is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Unit direction of the line along which tool and work touch at the instant (an edge: its own direction), signed as
    /// principal directions are. `None` with no motion, where they touch all over, with several, where they touch in a
    /// point, and where the line has no direction.
    pub line: Option<[f64; 3]>,
    /// For each motion, the velocity of the tool's point against the work, in the work's frame: mm per radian (or per mm) of
    /// the motion. What turns the tool without changing its surface, as the cutting speed of a face mill, is no motion.
    /// `None` where it is not finite.
    pub sliding: Vec<Option<[f64; 3]>>,
    /// Normal curvature of the gap between tool and work (induced or relative curvature): a step s away from the contact the
    /// gap is ½ k s². Zero along the contact line, negative where the tool cuts into the finished surface. `None` for an edge
    /// and where tool or work has no tangent plane.
    pub induced: Option<Curvature>,
}

/// The first fundamental form in the coordinates that points are asked for by: steps a and b of theirs are
/// √(e a² + 2 f a b + g b²) mm along the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// mm² per square of the first coordinate's unit (mm or radian).
    pub e: f64,
    /// mm² per unit of the first and unit of the second coordinate.
    pub f: f64,
    /// mm² per square of the second coordinate's unit.
    pub g: f64,
}

impl Contact {
    /// The angle between the contact line and the sliding velocity, from 0 to π/2. `None` without a contact line, and where
    /// nothing slides.
    pub fn sliding_angle(&self) -> Option<f64> {
        let (line, [Some(velocity)]) = (Vector3::from(self.line?), self.sliding.as_slice()) else { return None };
        let velocity = Vector3::from(*velocity);
        let across = line.cross(&velocity).norm();
        (velocity.norm() > 0.0).then(|| across.atan2(line.dot(&velocity).abs()))
    }
}

impl SurfaceGeometry {
    /// The geometry of `surface`, made over `motions`, in two `coordinates` (functions of its unknowns).
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the motions are not the last of the surface's unknowns, or it does not have two unknowns more than constraints.
    pub fn new<'g>(
        surface: &BoundSurface<'g>,
        motions: &[Expr<'g>],
        coordinates: [Expr<'g>; 2],
    ) -> Result<SurfaceGeometry, TapeError> {
        let coordinates = surface.with_values(&coordinates);
        let surface = surface.surface();
        let p = &surface.unknowns;
        assert!(p.ends_with(motions), "the motions are the last unknowns");
        assert_eq!(p.len(), surface.constraints.len() + 2, "a surface has two unknowns more than constraints");
        let functions =
            surface.position.0.into_iter().chain(surface.normal.0).chain(surface.constraints.iter().copied());
        let functions: Vec<Expr<'g>> = functions.chain(coordinates).collect();
        // column by column, as matrices are stored
        let slopes = p.iter().flat_map(|p| functions.iter().map(|function| function.derivative(*p)));
        let outputs: Vec<Expr<'g>> = surface.normal.0.into_iter().chain(slopes).collect();
        Ok(SurfaceGeometry {
            unknowns: p.len(),
            motions: motions.len(),
            constraints: surface.constraints.len(),
            tape: Tape::new(&outputs, p)?,
        })
    }

    /// The same of a surface that was given while settings were open ([`Graph::with_settings`](flank_expr::Graph::with_settings)), with
    /// these values of them.
    #[must_use]
    pub fn with_settings(&self, values: &[f64]) -> SurfaceGeometry {
        SurfaceGeometry { tape: self.tape.with_settings(values), ..*self }
    }

    /// The geometry at a point of the surface, given by its unknowns (mm or radians), which must solve the constraints.
    ///
    /// # Panics
    /// If there is not one number for each unknown.
    pub fn at(&self, unknowns: &[f64]) -> PointGeometry {
        let mut out = vec![0.0; self.tape.output_count()];
        ScalarEvaluator::new(&self.tape).run(unknowns, &mut out);
        let slopes = DMatrixView::from_slice(&out[3..], 6 + self.constraints + 2, self.unknowns);
        let slopes = Slopes {
            position: slopes.rows(0, 3).into_owned(),
            normal: slopes.rows(3, 3).into_owned(),
            constraints: slopes.rows(6, self.constraints).into_owned(),
            coordinates: slopes.rows(6 + self.constraints, 2).into_owned(),
        };
        let normal = Vector3::from_column_slice(&out[..3]);
        let tangents = normal.iter().all(|component| component.is_finite()).then(|| tangents(normal));
        let free = null_space(&slopes.constraints);
        let curvature = tangents.zip(free.as_ref()).and_then(|(tangents, free)| slopes.curvature(tangents, free));
        PointGeometry {
            curvature,
            metric: free.as_ref().and_then(|free| slopes.metric(free)),
            contact: self.contact(&slopes, tangents, curvature.as_ref()),
        }
    }

    fn contact(&self, slopes: &Slopes, tangents: Option<Matrix3x2<f64>>, work: Option<&Curvature>) -> Contact {
        let still = self.unknowns - self.motions;
        let sliding = slopes.position.columns(still, self.motions);
        let sliding = sliding.column_iter().map(|v| v.iter().all(|x| x.is_finite()).then(|| [v[0], v[1], v[2]]));
        let at_rest = slopes.first_unknowns(still);
        let line = (still == self.constraints + 1).then(|| at_rest.only_direction()).flatten();
        // the tool's own constraints come before the equations of meshing, one for each motion
        let of_tool = self.constraints.checked_sub(self.motions).filter(|_| still >= 2);
        let tool = tangents.zip(of_tool).and_then(|(tangents, count)| {
            let free = null_space(&at_rest.constraints.rows(0, count).into_owned())?;
            at_rest.curvature(tangents, &free)
        });
        // both measured by the work's normal: the tool lies on its side, so its curvatures have the other sign
        let induced = work.zip(tool).map(|(work, tool)| work.minus(&tool));
        Contact { line, sliding: sliding.collect(), induced }
    }
}

/// The curvature of a surface at a point, in tangents of its own or of a surface that touches it there, from derivatives with respect to
/// its unknowns (columns) of position, normal and constraints.
pub(crate) fn curvature_in(
    tangents: Matrix3x2<f64>,
    [position, normal, constraints]: [&DMatrix<f64>; 3],
) -> Option<Curvature> {
    let slopes = Slopes {
        position: position.clone(),
        normal: normal.clone(),
        constraints: constraints.clone(),
        coordinates: DMatrix::zeros(0, position.ncols()),
    };
    slopes.curvature(tangents, &null_space(&slopes.constraints)?)
}

/// The same with its change, where these derivatives change at rates of their own and stay those of a surface with a unit normal.
pub(crate) fn curvature_change_in(
    tangents: Matrix3x2<f64>,
    at: [&DMatrix<f64>; 3],
    rates: [&DMatrix<f64>; 3],
) -> Option<(Curvature, CurvatureChange)> {
    let [position, normal, constraints] = at;
    let free = null_space(constraints)?;
    let moving = null_space_change(constraints, rates[2], &free)?;
    let two = |all: DMatrix<f64>| Matrix3x2::from_column_slice(all.as_slice());
    let changed = |at: &DMatrix<f64>, rates: &DMatrix<f64>| two(rates * &free + at * &moving);
    let along = [two(position * &free), changed(position, rates[0])];
    let turning = [two(normal * &free), changed(normal, rates[1])];
    Curvature::changing(tangents, along, turning, [position.norm(), normal.norm()])
}

/// Derivatives with respect to the unknowns (columns).
struct Slopes {
    position: DMatrix<f64>,
    normal: DMatrix<f64>,
    constraints: DMatrix<f64>,
    coordinates: DMatrix<f64>,
}

impl Slopes {
    /// Those with respect to the first unknowns alone.
    fn first_unknowns(&self, count: usize) -> Slopes {
        let first = |all: &DMatrix<f64>| all.columns(0, count).into_owned();
        Slopes {
            position: first(&self.position),
            normal: first(&self.normal),
            constraints: first(&self.constraints),
            coordinates: first(&self.coordinates),
        }
    }

    /// The curvature of the surface whose parameters are free to move along the two columns of `free`.
    fn curvature(&self, tangents: Matrix3x2<f64>, free: &DMatrix<f64>) -> Option<Curvature> {
        let two = |all: &DMatrix<f64>| Matrix3x2::from_column_slice((all * free).as_slice());
        let scales = [self.position.norm(), self.normal.norm()];
        Curvature::new(tangents, two(&self.position), two(&self.normal), scales)
    }

    /// The direction in which the position moves where the constraints leave one direction free.
    fn only_direction(&self) -> Option<[f64; 3]> {
        let free = null_space(&self.constraints)?;
        let moved = &self.position * free.column(0);
        let moved = Vector3::from_column_slice(moved.as_slice());
        let is_long = moved.norm() > VANISHED * self.position.norm();
        is_long.then(|| oriented(moved.normalize()).into())
    }

    fn metric(&self, free: &DMatrix<f64>) -> Option<Metric> {
        let coordinates = &self.coordinates * free;
        let sizes = [coordinates.row(0).norm(), coordinates.row(1).norm()];
        let scaled = Matrix2::from_fn(|i, j| coordinates[(i, j)] / sizes[i]);
        let least = if scaled.iter().all(|entry| entry.is_finite()) { scaled.singular_values().min() } else { 0.0 };
        let inverse = (least > NO_COORDINATES).then(|| scaled.try_inverse()).flatten()?;
        let steps = Matrix3x2::from_column_slice((&self.position * free).as_slice()) * inverse;
        let [a, b] = [0, 1].map(|k| steps.column(k) / sizes[k]);
        let metric = Metric { e: a.norm_squared(), f: a.dot(&b), g: b.norm_squared() };
        [metric.e, metric.f, metric.g].iter().all(|entry| entry.is_finite()).then_some(metric)
    }
}
