//! A part of a surface between values of two coordinates, at any shares of both.

use flank_chain_dsl::{GeneratedSurface, Job, MilledArea};
use flank_solver::{Chart, Outcome, PoseField, SurfaceFrame, SurfaceFrames, SurfacePoint, SurfaceProblem};

use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::session::Session;
use crate::project::units;
use crate::solve;
use crate::solve::reasons;

/// Rows and columns of exact points that polynomials go through, until these are as near as [`NEAR`].
pub(super) const GRIDS: [[usize; 2]; 5] = [[13, 17], [21, 33], [33, 65], [49, 129], [129, 65]];
/// How near a polynomial is to the surface and to the cutter's pose, mm and radians.
pub(super) const NEAR: f64 = 1e-10;
/// How near it is enough to be where a surface bends at once, as where a relief begins, mm: words of programs have a last decimal of ten times as
/// much.
pub(super) const ENOUGH: f64 = 1e-5;

/// A part of a surface.
pub(super) struct Patch<'j, 'g> {
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    area: MilledArea<'g>,
    problem: SurfaceProblem,
    frames: SurfaceFrames,
}

/// Points of a surface on a lattice of shares of passes and along them.
pub(super) struct Lattice {
    pub(super) shares: [Vec<f64>; 2],
    /// Row by row, their derivatives by both shares.
    pub(super) frames: Vec<SurfaceFrame>,
    /// The largest amount by which an unknown lies outside its range, with its index.
    pub(super) beyond: Option<(usize, f64)>,
}

impl Lattice {
    pub(super) fn at(&self, row: usize, column: usize) -> &SurfaceFrame {
        &self.frames[row * self.shares[1].len() + column]
    }

    /// Row by row, with the shares.
    pub(super) fn each(&self) -> impl Iterator<Item = ([f64; 2], &SurfaceFrame)> {
        let columns = self.shares[1].len();
        let shares = move |k: usize| [self.shares[0][k / columns], self.shares[1][k % columns]];
        self.frames.iter().enumerate().map(move |(k, frame)| (shares(k), frame))
    }
}

impl<'j, 'g> Patch<'j, 'g> {
    pub(super) fn new(
        job: &'j Job<'g>,
        surface: &'j GeneratedSurface<'g>,
        area: MilledArea<'g>,
        session: Session<'_>,
    ) -> Patch<'j, 'g> {
        let coordinates = area.coordinates.each_ref().map(|coordinate| coordinate.value);
        let bound = solve::bound(job, surface);
        Patch {
            job,
            surface,
            area,
            problem: solve::problem(job, surface, coordinates, session),
            frames: SurfaceFrames::new(&bound, coordinates).expect("a job without errors leaves nothing unbound"),
        }
    }

    pub(super) fn name(&self) -> &'j str {
        &self.surface.name
    }

    pub(super) fn surface(&self) -> &'j GeneratedSurface<'g> {
        self.surface
    }

    pub(super) fn frame(&self) -> &'j str {
        &self.surface.frame
    }

    /// The values of both coordinates at shares.
    pub(super) fn values(&self, shares: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| {
            let (low, high) = self.area.ranges[k];
            low * (1.0 - shares[k]) + high * shares[k]
        })
    }

    /// A place in words: `profilewise 0.5, lengthwise 0.25`.
    pub(super) fn place(&self, shares: [f64; 2]) -> String {
        let area = &self.area;
        let values = self.values(shares);
        let text = |k: usize| format!("{} {}", area.names[k], units::text(area.dimensions[k], values[k], 4));
        format!("{}, {}", text(0), text(1))
    }

    /// That the surface goes on beyond the range of an unknown.
    pub(super) fn beyond(&self, unknown: usize, by: f64) -> String {
        let unknown = &self.surface.unknowns[unknown];
        format!(
            "{} is continued beyond the range of `{}` by up to {}: what its tool makes ends before",
            self.name(),
            unknown.name,
            units::text(unknown.dimension, by, 4)
        )
    }

    /// What rows and columns run over, as samples call it.
    pub(super) fn labels(&self) -> [String; 2] {
        let area = &self.area;
        let Some((_, is_across)) = area.shares else { return area.names.clone() };
        let sides = ["root -> tip", "toe -> heel"].map(str::to_string);
        let [across, along] = sides;
        if is_across { [along, across] } else { [across, along] }
    }

    /// Points at rows and columns of shares, row by row.
    pub(super) fn points(&self, shares: &[Vec<f64>; 2]) -> Vec<SurfacePoint> {
        let [rows, columns] = shares;
        let places = rows.iter().flat_map(|p| columns.iter().map(move |u| [*p, *u]));
        let targets: Vec<[f64; 2]> = places
            .map(|place| {
                let [pass, along] = self.values(place);
                self.area.at(pass, along)
            })
            .collect();
        self.problem.solve(&targets, [rows.len(), columns.len()]).0
    }

    /// Exact points on a lattice of shares.
    ///
    /// # Errors
    /// The first point that the surface does not have.
    pub(super) fn lattice(&self, shares: [Vec<f64>; 2]) -> Result<Lattice, NotDone> {
        let counts = [shares[0].len(), shares[1].len()];
        let area = &self.area;
        let places: Vec<[f64; 2]> = shares[0].iter().flat_map(|p| shares[1].iter().map(move |u| [*p, *u])).collect();
        let values: Vec<[f64; 2]> = places.iter().map(|place| self.values(*place)).collect();
        let targets: Vec<[f64; 2]> = values.iter().map(|[pass, along]| area.at(*pass, *along)).collect();
        let (points, _) = self.problem.solve_points(&targets, counts, None, None);
        let mut beyond: Option<(usize, f64)> = None;
        for (k, place) in places.iter().enumerate() {
            match points.outcome(k) {
                Outcome::Solved => {}
                Outcome::Outside { unknown, by } => {
                    if beyond.is_none_or(|(_, most)| by > most) {
                        beyond = Some((unknown, by));
                    }
                }
                outcome => {
                    let reason = reasons::of_point(self.job, self.surface, outcome);
                    let message = format!("{} has no point at {}: {}", self.name(), self.place(*place), outcome.word());
                    let details = [reason].into_iter().filter(|reason| !reason.is_empty()).collect();
                    return Err(NotDone::new(NotDoneKind::NotSolved, self.name(), message).with(details));
                }
            }
        }
        let unknowns: Vec<Vec<f64>> = (0..places.len()).map(|k| points.unknowns(k)).collect();
        let frames = self.frames.at(unknowns.iter().map(Vec::as_slice));
        let widths = area.ranges.map(|(low, high)| high - low);
        let mut found = Vec::with_capacity(frames.len());
        for ((frame, [pass, along]), place) in frames.into_iter().zip(&values).zip(&places) {
            let Some(frame) = frame else {
                let message = format!("{} has no tangent plane at {}", self.name(), self.place(*place));
                return Err(NotDone::new(NotDoneKind::NotSolved, self.name(), message));
            };
            // both coordinates are linear in each share
            let rate = |ends: [[f64; 2]; 2], width: f64| [0, 1].map(|k| (ends[1][k] - ends[0][k]) * width);
            let by_pass = rate([area.at(0.0, *along), area.at(1.0, *along)], widths[0]);
            let by_along = rate([area.at(*pass, 0.0), area.at(*pass, 1.0)], widths[1]);
            found.push(frame.by([by_pass, by_along]));
        }
        Ok(Lattice { shares, frames: found, beyond })
    }

    /// Position and normal as polynomials that are as near as [`NEAR`], or else as [`ENOUGH`], and how near they are, mm.
    ///
    /// # Errors
    /// What the surface does not have, or that its polynomials do not come as near.
    pub(super) fn field(&self) -> Result<(PoseField, f64), NotDone> {
        let mut rougher: Option<(PoseField, [Vec<f64>; 2])> = None;
        for counts in GRIDS {
            let lattice = self.lattice(counts.map(Chart::shares))?;
            let field = point_field(&lattice);
            if field.tail() <= NEAR {
                return Ok((field, NEAR));
            }
            rougher = Some((field, lattice.shares));
        }
        let (field, shares) = rougher.expect("there are counts");
        let off = self.off_between(&field, &shares)?;
        if off <= ENOUGH { Ok((field, off)) } else { Err(rough(self.name(), off)) }
    }

    /// How far polynomials are off along the normal, half-way between the shares of the points that they go through, mm.
    fn off_between(&self, field: &PoseField, shares: &[Vec<f64>; 2]) -> Result<f64, NotDone> {
        let lattice = self.lattice(shares.each_ref().map(|nodes| halfway(nodes)))?;
        let off = |(shares, frame): ([f64; 2], &SurfaceFrame)| {
            let near = field.at(shares);
            (0..3).map(|k| (near[k] - frame.position[k]) * frame.normal[k]).sum::<f64>().abs()
        };
        Ok(lattice.each().map(off).fold(0.0, f64::max))
    }
}

/// The middles between numbers.
pub(super) fn halfway(nodes: &[f64]) -> Vec<f64> {
    nodes.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
}

/// That no polynomials come near enough to a surface.
pub(super) fn rough(name: &str, off: f64) -> NotDone {
    let message = format!(
        "{name} is not smooth enough between its ends: polynomials through exact points are off by up to {off:.1e} mm"
    );
    let way = "take a smaller part of it, away from where it turns back or two of its pieces meet".to_string();
    NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![way])
}

/// Position and normal at the nodes of polynomials.
pub(super) fn point_field(lattice: &Lattice) -> PoseField {
    let point = |frame: &SurfaceFrame| {
        let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
        [x, y, z, nx, ny, nz]
    };
    let counts = [lattice.shares[0].len(), lattice.shares[1].len()];
    PoseField::through(lattice.frames.iter().map(point).collect(), counts)
}
