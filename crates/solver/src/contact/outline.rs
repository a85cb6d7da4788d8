//! Where a tooth ends: the outline of its body in the axial section.

/// How far outside a point may lie that counts as on the outline, mm: rounding of solved points.
const ON: f64 = 1e-9;

/// The outline of a body of revolution in its axial section `[z, rho]`, mm: closed, the material on the left of each segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    segments: Vec<OutlineSegment>,
    /// Whether nothing is known of the body beyond it: then its edges end lines of contact, and do not touch.
    is_open: bool,
}

/// A line or an arc of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineSegment {
    /// What it is called: tip, toe, heel.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends: the next segment begins there.
    pub to: [f64; 2],
    /// The centre of an arc shorter than half a turn; `None` for a line.
    pub center: Option<[f64; 2]>,
}

/// What is zero on a segment's curve and positive on the side of the material: `n · x + ½ bend x²` with x from a point of the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound {
    pub(crate) origin: [f64; 2],
    pub(crate) inward: [f64; 2],
    pub(crate) bend: f64,
}

impl Bound {
    /// How many numbers it is.
    pub(super) const NUMBERS: usize = 5;

    pub(super) fn numbers(&self) -> [f64; Bound::NUMBERS] {
        [self.origin[0], self.origin[1], self.inward[0], self.inward[1], self.bend]
    }

    /// At a point, to first order the distance from the curve, mm.
    pub(crate) fn height(&self, point: [f64; 2]) -> f64 {
        let x = minus(point, self.origin);
        dot(self.inward, x) + 0.5 * self.bend * dot(x, x)
    }

    /// How it grows with z and rho.
    pub(super) fn gradient(&self, point: [f64; 2]) -> [f64; 2] {
        let x = minus(point, self.origin);
        [0, 1].map(|k| self.inward[k] + self.bend * x[k])
    }
}

impl OutlineSegment {
    pub(crate) fn bound(&self) -> Bound {
        let Some(center) = self.center else {
            let along = unit(minus(self.to, self.from));
            return Bound { origin: self.from, inward: [-along[1], along[0]], bend: 0.0 };
        };
        let to_center = minus(center, self.from);
        let radius = norm(to_center);
        // an arc that turns left has its centre on the side of the material
        let side = if cross(minus(self.to, self.from), to_center) >= 0.0 { 1.0 } else { -1.0 };
        Bound { origin: self.from, inward: to_center.map(|x| side * x / radius), bend: -side / radius }
    }

    /// Places `[z, rho]` along it, evenly spaced between its ends.
    pub fn places(&self, count: usize) -> Vec<[f64; 2]> {
        let at = |share: f64| [0, 1].map(|k| self.from[k] + share * (self.to[k] - self.from[k]));
        // of an arc those of the chord, brought to it
        (0..count).map(|k| self.nearest(at((k as f64 + 0.5) / count as f64))).collect()
    }

    /// The place `[z, rho]` at a share of the way from its beginning to its end, by length.
    pub fn at(&self, share: f64) -> [f64; 2] {
        let Some(center) = self.center else {
            return [0, 1].map(|k| (1.0 - share) * self.from[k] + share * self.to[k]);
        };
        let [from, to] = [self.from, self.to].map(|end| minus(end, center));
        let (sin, cos) = (share * cross(from, to).atan2(dot(from, to))).sin_cos();
        [center[0] + cos * from[0] - sin * from[1], center[1] + sin * from[0] + cos * from[1]]
    }

    /// How long it is, mm.
    pub fn length(&self) -> f64 {
        let Some(center) = self.center else { return norm(minus(self.to, self.from)) };
        let [from, to] = [self.from, self.to].map(|end| minus(end, center));
        norm(from) * cross(from, to).atan2(dot(from, to)).abs()
    }

    /// The point of the segment that is nearest.
    pub fn nearest(&self, point: [f64; 2]) -> [f64; 2] {
        let chord = minus(self.to, self.from);
        let ends = || {
            if dot(minus(point, self.from), chord) < dot(minus(point, self.to), [-chord[0], -chord[1]]) {
                self.from
            } else {
                self.to
            }
        };
        let Some(center) = self.center else {
            let share = dot(minus(point, self.from), chord) / dot(chord, chord);
            let share = share.clamp(0.0, 1.0);
            return [0, 1].map(|k| self.from[k] + share * chord[k]);
        };
        let (out, radius) = (minus(point, center), norm(minus(self.from, center)));
        let on = [0, 1].map(|k| center[k] + out[k] * (radius / norm(out)));
        // between its ends where it lies on the far side of the chord, seen from the centre
        let side = |x: [f64; 2]| cross(chord, minus(x, self.from));
        if on.iter().all(|x| x.is_finite()) && side(on) * side(center) <= 0.0 { on } else { ends() }
    }
}

impl Outline {
    /// Of segments that follow each other and close, with the material on their left.
    ///
    /// # Panics
    /// If there is none.
    pub fn new(segments: Vec<OutlineSegment>) -> Outline {
        assert!(!segments.is_empty(), "an outline has segments");
        Outline { segments, is_open: false }
    }

    /// The same of a body that goes on beyond it: its edges end lines of contact, and do not touch.
    #[must_use]
    pub fn open(self) -> Outline {
        Outline { is_open: true, ..self }
    }

    /// Whether the body goes on beyond it.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Its segments, one after the other.
    pub fn segments(&self) -> &[OutlineSegment] {
        &self.segments
    }

    /// The segment beyond which a point lies, and how far, mm; `None` for a point inside or on the outline.
    pub fn beyond(&self, point: [f64; 2]) -> Option<(usize, f64)> {
        let reach = |k: &usize| {
            let segment = &self.segments[*k];
            (norm(minus(point, segment.nearest(point))), -segment.bound().height(point).abs())
        };
        // of two that share the nearest point, their corner, the one that the point lies more squarely beside says on which side it is
        let nearest = (0..self.segments.len()).min_by(|a, b| {
            let ((near, beside), (other_near, other_beside)) = (reach(a), reach(b));
            let same = (near - other_near).abs() <= ON * (1.0 + near);
            if same { beside.total_cmp(&other_beside) } else { near.total_cmp(&other_near) }
        })?;
        let distance = reach(&nearest).0;
        (self.segments[nearest].bound().height(point) < 0.0 && distance > ON).then_some((nearest, distance))
    }

    /// The segments on which a point lies, or from which it is no farther away than so much, mm.
    pub fn segments_at(&self, point: [f64; 2], within: f64) -> Vec<usize> {
        let is_near = |k: &usize| norm(minus(point, self.segments[*k].nearest(point))) <= within;
        (0..self.segments.len()).filter(is_near).collect()
    }

    /// Whether a point lies inside or on it.
    pub fn holds(&self, point: [f64; 2]) -> bool {
        self.beyond(point).is_none()
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn norm(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

fn unit(a: [f64; 2]) -> [f64; 2] {
    a.map(|x| x / norm(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 2], to: [f64; 2]) -> OutlineSegment {
        OutlineSegment { name: String::new(), from, to, center: None }
    }

    /// A square with a notch and with one side that bulges: inside, outside, and beyond which segment.
    #[test]
    fn a_point_is_inside_or_beyond_a_segment() {
        let bulge = OutlineSegment { center: Some([1.0, 2.0]), ..line([4.0, 0.0], [4.0, 4.0]) };
        let outline = Outline::new(vec![
            line([0.0, 0.0], [4.0, 0.0]),
            bulge,
            line([4.0, 4.0], [2.0, 4.0]),
            line([2.0, 4.0], [2.0, 2.0]),
            line([2.0, 2.0], [0.0, 4.0]),
            line([0.0, 4.0], [0.0, 0.0]),
        ]);
        for inside in [[1.0, 1.0], [4.5, 2.0], [3.0, 3.9], [1.9, 1.9], [0.1, 3.8], [4.0, 0.0]] {
            assert!(outline.holds(inside), "{inside:?}");
        }
        let beyond = [
            ([1.0, -0.5], 0, 0.5),
            ([5.0, 2.0], 1, 4.0 - 13f64.sqrt()),
            ([3.0, 4.5], 2, 0.5),
            ([1.8, 3.5], 3, 0.2),
            ([1.0, 4.0], 4, 0.5f64.sqrt()),
            ([-0.5, 2.0], 5, 0.5),
            ([-0.3, -0.4], 0, 0.5),
        ];
        for (point, segment, distance) in beyond {
            let (found, by) = outline.beyond(point).expect("it is outside");
            assert!(found == segment && (by - distance).abs() < 1e-12, "{point:?}: {found} {by}");
        }
    }

    /// Both sides of an arc, bulging and hollow: zero on it, one a millimetre from it.
    #[test]
    fn the_bound_of_an_arc_is_zero_on_it() {
        for (from, to, sign) in [([3.0, 0.0], [0.0, 3.0], 1.0), ([0.0, 3.0], [3.0, 0.0], -1.0)] {
            let bound = OutlineSegment { center: Some([0.0, 0.0]), ..line(from, to) }.bound();
            let at = |radius: f64| [radius * 0.6, radius * 0.8];
            assert!(bound.height(at(3.0)).abs() < 1e-15);
            assert!((bound.height(at(2.999)) * sign - 0.001).abs() < 1e-6);
            let gradient = bound.gradient(at(3.0));
            assert!(gradient.iter().zip([0.6, 0.8]).all(|(a, b)| (a + sign * b).abs() < 1e-15), "{gradient:?}");
        }
    }
}
