//! Where a surface is looked for beside the points of another one: at the same places.

use std::f64::consts::TAU;

use flank_chain_dsl::{Coordinate, GeneratedSurface, Sample};
use flank_solver::{Alignment, Outcome, SurfacePoint};

use crate::solve::centre::Centre;

/// Coordinates that are functions of the place alone, on whatever surface it lies.
const OF_PLACES: [&str; 5] = ["x", "y", "z", "rho", "polar_angle"];
/// Points are given by the two coordinates that the motion of their body leaves as they are, of a turn about z radius and height, unless it moves them along their
/// normals by less than this share of what another way does: hardly more than nothing, as on a root cylinder or an end face.
const HARDLY: f64 = 0.02;

/// Where the points of a grid were asked for.
pub(crate) struct Asked {
    /// The names of its two coordinates.
    pub(crate) names: [String; 2],
    pub(crate) targets: Vec<[f64; 2]>,
    pub(crate) counts: [usize; 2],
    /// Which of them are a sample's own, and which is its middle.
    pub(crate) centre: Centre,
}

impl Asked {
    /// With the mean point, also where the sample does not ask for it.
    pub(crate) fn with_centre(sample: &Sample<'_>) -> Asked {
        let names = sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone());
        let (sample, centre) = Centre::of_sample(sample);
        Asked { names, targets: sample.targets(), counts: sample.counts, centre }
    }

    /// Whether both coordinates are functions of the place alone: the same places on any surface.
    pub(crate) fn is_of_places(&self) -> bool {
        self.names.iter().all(|name| OF_PLACES.contains(&name.as_str()))
    }
}

/// Two coordinates of a surface with the values that points of another one have.
pub(crate) struct Starts<'g> {
    pub(crate) coordinates: [Coordinate<'g>; 2],
    pub(crate) targets: Vec<[f64; 2]>,
}

impl<'g> Starts<'g> {
    /// Of a surface beside the points of a sample of another one: by the sample's own coordinates where these are functions of the
    /// place, else by two that tell the points apart. Names of unknowns say nothing here: another tool's `u` is another place.
    pub(crate) fn beside(
        surface: &GeneratedSurface<'g>,
        (asked, points): (&Asked, &[SurfacePoint]),
        alignment: Alignment,
    ) -> Starts<'g> {
        let (names, targets) = if asked.is_of_places() {
            (asked.names.each_ref().map(String::as_str), asked.targets.clone())
        } else {
            let names = telling(points, alignment);
            (names, values(names, points, asked.centre.middle()))
        };
        let halfway = targets.get(asked.centre.middle()).copied().unwrap_or_default();
        let coordinate = |k: usize| {
            let known = surface.coordinates().into_iter().find(|coordinate| coordinate.name == names[k]);
            surface.about(known.expect("every surface has these"), halfway[k])
        };
        Starts { coordinates: [coordinate(0), coordinate(1)], targets }
    }
}

/// Number of the point at which the search for the branch of a grid begins: in its middle, or beside that.
pub(crate) fn middle([rows, columns]: [usize; 2]) -> usize {
    (rows / 2) * columns + columns / 2
}

fn solved(points: &[SurfacePoint]) -> impl Iterator<Item = &SurfacePoint> {
    points.iter().filter(|point| point.outcome == Outcome::Solved)
}

/// The two of radius, angle and height, of a rack of x, y and z, of which the points' normals have least. Where the normals lean to both sides of
/// the radius, as on a lobe or a whole cam, the same radius and height come twice: angle and height tell those points apart.
fn telling(points: &[SurfacePoint], alignment: Alignment) -> [&'static str; 2] {
    let [out, along] = match alignment {
        Alignment::Turn => ["rho", "polar_angle"],
        Alignment::Shift => ["x", "y"],
    };
    let mut sums = [0.0; 3];
    let mut ends = [[0.0_f64; 2]; 3];
    for SurfacePoint { position: [x, y, _], normal: [nx, ny, nz], .. } in solved(points) {
        let radius = x.hypot(*y).max(f64::MIN_POSITIVE);
        let parts = match alignment {
            Alignment::Turn => [(x * nx + y * ny) / radius, (x * ny - y * nx) / radius, *nz],
            Alignment::Shift => [*nx, *ny, *nz],
        };
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part.abs());
        ends.iter_mut().zip(parts).for_each(|([low, high], part)| (*low, *high) = (low.min(part), high.max(part)));
    }
    let [radial, tangential, axial] = sums;
    let [turns_over, leans_both_ways, _] = ends.map(|[low, high]| low < -HARDLY && high > HARDLY);
    if tangential >= HARDLY * radial.max(axial) {
        if leans_both_ways && !turns_over { [along, "z"] } else { [out, "z"] }
    } else if radial >= axial {
        [along, "z"]
    } else {
        [out, along]
    }
}

/// Values of coordinates of the place at points; where one is not solved, those of the solved one before it, or of the first. A
/// polar angle is within half a turn of that in the middle.
fn values(names: [&str; 2], points: &[SurfacePoint], middle: usize) -> Vec<[f64; 2]> {
    let angle = |point: &SurfacePoint| point.position[1].atan2(point.position[0]);
    let about = points.get(middle).filter(|point| point.outcome == Outcome::Solved).or_else(|| solved(points).next());
    let about = about.map_or(0.0, angle);
    let value = |name: &str, point: &SurfacePoint| {
        let [x, y, z] = point.position;
        match name {
            "rho" => x.hypot(y),
            "x" => x,
            "y" => y,
            "z" => z,
            _ => angle(point) + TAU * ((about - angle(point)) / TAU).round(),
        }
    };
    let mut last = solved(points).next().map(|point| names.map(|name| value(name, point))).unwrap_or_default();
    let values = points.iter().map(|point| {
        if point.outcome == Outcome::Solved {
            last = names.map(|name| value(name, point));
        }
        last
    });
    values.collect()
}
