//! A job with samples of few points, and what is solved of it, once.

use std::cell::{OnceCell, RefCell};

use flank_chain_dsl::{Coordinate, Expectation, Expected, GeneratedSurface, Job, PointSet, Sample, SampleGrid};
use flank_solver::{Outcome, SurfacePoint};

use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::{self, SolveOptions, limits, unsolved};

/// Rows and columns of a sample at which expectations are checked: ends and middle among them.
const MOST_LINES: usize = 7;
/// Points of a list.
const MOST_LISTED: usize = 100;

/// A job that is tested.
pub(super) struct Tested<'j, 'g> {
    pub(super) job: &'j Job<'g>,
    solved: Vec<OnceCell<Counted>>,
    /// The points of lists, by surface and places: several columns of a table are compared one after the other.
    lists: RefCell<Vec<Listed>>,
    /// Of which surfaces it was told what may be wrong with them.
    told: RefCell<Vec<usize>>,
    origin: &'j Origin,
    pub(super) session: Session<'j>,
}

/// Points, those where others trim the surface, and what it took to find them: evaluations of the equations, boxes of the search for the branch.
#[derive(Default)]
struct Counted {
    points: Vec<SurfacePoint>,
    trims: Vec<SurfacePoint>,
    work: [u64; 2],
}

/// The points of a surface at a list of places.
type Listed = (usize, Vec<[f64; 2]>, Vec<SurfacePoint>);

/// A job whose samples have few points.
pub(super) fn thinned<'g>(job: &Job<'g>) -> Job<'g> {
    let mut job = job.clone();
    for surface in &mut job.surfaces {
        surface.sample = surface.sample.take().map(thin);
    }
    job
}

fn thin<'g>(sample: Sample<'g>) -> Sample<'g> {
    let lines = match &sample.grid {
        SampleGrid::Points(points) => [vec![0], spread(points.len(), MOST_LISTED)],
        _ => sample.counts.map(|count| spread(count, MOST_LINES)),
    };
    let counts = lines.each_ref().map(Vec::len);
    Sample { grid: sample.grid.picked(&lines), counts, ..sample }
}

/// So many of the numbers from 0 to `count`, evenly, both ends among them.
fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| (k * (count - 1) + (most - 1) / 2) / (most - 1)).collect()
}

impl<'j, 'g> Tested<'j, 'g> {
    pub(super) fn new(job: &'j Job<'g>, origin: &'j Origin, session: Session<'j>) -> Tested<'j, 'g> {
        Tested {
            job,
            solved: job.surfaces.iter().map(|_| OnceCell::new()).collect(),
            lists: RefCell::default(),
            told: RefCell::default(),
            origin,
            session,
        }
    }

    /// Solves the samples that expectations look at point by point, side by side.
    pub(super) fn solve_looked_at(&self) {
        let is_looked_at = |index: &usize| {
            let is_limited = self.surface(*index).sample.as_ref().is_some_and(|sample| !sample.limits.is_empty());
            let is_named = |expectation: &Expectation<'_>| match &expectation.what {
                Expected::Status { surfaces, at, .. } => at.is_empty() && surfaces.contains(index),
                Expected::AtPoints { surface, .. } => surface == index,
                _ => false,
            };
            is_limited || self.job.expectations.iter().any(is_named)
        };
        let surfaces = (0..self.job.surfaces.len()).filter(is_looked_at).map(|index| self.surface(index));
        solve::solve_side_by_side(self.job, &surfaces.collect::<Vec<_>>(), self.session);
    }

    pub(super) fn surface(&self, index: usize) -> &'j GeneratedSurface<'g> {
        &self.job.surfaces[index]
    }

    /// The points of the sample of a surface; none if it has no sample.
    pub(super) fn points(&self, index: usize) -> &[SurfacePoint] {
        &self.counted(index).points
    }

    /// What may be wrong with a surface, as far as the points of its sample tell: for the first expectation that asks.
    pub(super) fn hints(&self, index: usize) -> Vec<String> {
        let mut told = self.told.borrow_mut();
        if told.contains(&index) {
            return Vec::new();
        }
        told.push(index);
        unsolved::hints((self.job, Some(self.origin)), self.surface(index), self.points(index))
    }

    /// Evaluations of the equations that the sample of a surface took, and boxes of the search for its branch.
    pub(super) fn work(&self, index: usize) -> [u64; 2] {
        self.counted(index).work
    }

    fn counted(&self, index: usize) -> &Counted {
        self.solved[index].get_or_init(|| {
            let surface = self.surface(index);
            let Some(sample) = &surface.sample else { return Counted::default() };
            let found = solve::points(self.job, surface, sample, self.options());
            Counted {
                work: [found.effort.evaluations, found.effort.boxes],
                trims: found.trims.into_iter().flat_map(|line| line.points).collect(),
                points: found.points,
            }
        })
    }

    /// Points one by one at values of two coordinates, as the tool generates them: also those that something cuts away.
    pub(super) fn generated(
        &self,
        index: usize,
        coordinates: [Coordinate<'g>; 2],
        at: Vec<[f64; 2]>,
    ) -> (Sample<'g>, Vec<SurfacePoint>) {
        let surface = self.surface(index);
        let sample = self.list(index, Some(coordinates), at.clone());
        if let Some((.., known)) = self.lists.borrow().iter().find(|(of, places, _)| *of == index && *places == at) {
            return (sample, known.clone());
        }
        let coordinates = sample.functions();
        let problem = solve::problem(self.job, surface, coordinates, self.session).points_alone();
        let (points, _) = problem.solve(&at, [1, at.len()]);
        self.lists.borrow_mut().push((index, at, points.clone()));
        (sample, points)
    }

    /// Points one by one at values of the coordinates of a surface's sample.
    pub(super) fn listed(&self, index: usize, at: Vec<[f64; 2]>) -> (Sample<'g>, Vec<SurfacePoint>) {
        let sample = self.list(index, None, at);
        let points = solve::points(self.job, self.surface(index), &sample, self.options()).points;
        (sample, points)
    }

    fn list(&self, index: usize, coordinates: Option<[Coordinate<'g>; 2]>, at: Vec<[f64; 2]>) -> Sample<'g> {
        let surface = self.surface(index);
        let own = surface.sample.clone();
        let graph = surface.surface.position.0[0].graph();
        let ends = [0, 1].map(|k| {
            let end = |of: Option<&[f64; 2]>| graph.constant(of.map_or(0.0, |of| of[k]));
            [end(at.first()), end(at.last())]
        });
        let (keep, limits) =
            own.as_ref().map_or_else(Default::default, |sample| (sample.keep.clone(), sample.limits.clone()));
        let counts = [1, at.len()];
        let grid = SampleGrid::Points(at);
        let middle = grid.middle(counts);
        let coordinates = coordinates.unwrap_or_else(|| {
            own.map(|sample| sample.coordinates).expect("a place is given in the coordinates of a sample")
        });
        let [first, second] = coordinates;
        Sample {
            coordinates: [surface.about(first, middle[0]), surface.about(second, middle[1])],
            labels: ["list".to_string(), "point".to_string()],
            counts,
            grid,
            ends: flank_chain_dsl::SampleEnds { values: ends, corners: None },
            keep,
            limits,
        }
    }

    /// The points of a set that are solved.
    pub(super) fn set(&self, index: usize, set: PointSet) -> Result<Vec<SurfacePoint>, Failure> {
        let is_solved = |point: &SurfacePoint| point.outcome == Outcome::Solved;
        let surface = self.surface(index);
        let of_line = match set {
            PointSet::Sample => {
                return Ok(self.points(index).iter().filter(|point| is_solved(point)).cloned().collect());
            }
            PointSet::Trim => {
                return Ok(self.counted(index).trims.iter().filter(|point| is_solved(point)).cloned().collect());
            }
            PointSet::SingularLine => "singular line",
            PointSet::ContactLimit => "contact limit",
        };
        let lines = limits::lines(self.job, [surface], self.session)?;
        let wanted = lines.into_iter().filter(|line| line.kind == of_line);
        Ok(wanted.flat_map(|line| line.points).filter(is_solved).collect())
    }

    pub(super) fn options(&self) -> SolveOptions<'j> {
        SolveOptions {
            geometry: false,
            sensitivity: false,
            certificates: false,
            together: None,
            arrays: false,
            of_shown: false,
            session: self.session,
        }
    }
}

/// Where a point of a sample is: `rho = 46.2 mm, z = 10 mm`.
pub(super) fn place(sample: &Sample<'_>, at: usize) -> String {
    let columns = sample.counts[1].max(1);
    let values = sample.grid.at(at / columns, at % columns);
    let each = sample.coordinates.iter().zip(values);
    let each = each.map(|(of, value)| format!("{} = {}", of.name, units::text(of.dimension, value, 4)));
    each.collect::<Vec<String>>().join(", ")
}
