//! Rigid motions as plain numbers: a matrix of three rows and a shift.

pub type Vector = [f64; 3];

#[derive(Clone, Copy, Debug)]
pub struct Pose {
    turn: [Vector; 3],
    shift: Vector,
}

impl Pose {
    pub const AT_REST: Pose = Pose { turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

    pub fn shifted(shift: Vector) -> Pose {
        Pose { shift, ..Pose::AT_REST }
    }

    /// About a direction of any length through the origin, right-handed, with what it moves along the direction.
    pub fn screwed(axis: Vector, angle: f64, along: f64) -> Pose {
        let [x, y, z] = unit(axis);
        let (s, c) = angle.sin_cos();
        let w = 1.0 - c;
        Pose {
            turn: [
                [x * x * w + c, x * y * w - z * s, x * z * w + y * s],
                [x * y * w + z * s, y * y * w + c, y * z * w - x * s],
                [x * z * w - y * s, y * z * w + x * s, z * z * w + c],
            ],
            shift: [x * along, y * along, z * along],
        }
    }

    /// Into the mirror image at the plane through the origin that is square to a direction.
    pub fn mirrored(normal: Vector) -> Pose {
        let n = unit(normal);
        let entry = |i: usize, k: usize| if i == k { 1.0 - 2.0 * n[i] * n[k] } else { -2.0 * n[i] * n[k] };
        Pose { turn: std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k))), shift: [0.0; 3] }
    }

    pub fn then(&self, next: &Pose) -> Pose {
        let column = |k: usize| next.turn.map(|row| row[k]);
        let turned = |v: Vector| self.turn.map(|row| dot(row, v));
        let columns = [turned(column(0)), turned(column(1)), turned(column(2))];
        Pose { turn: std::array::from_fn(|i| std::array::from_fn(|k| columns[k][i])), shift: self.point(next.shift) }
    }

    /// A point of the child in the parent.
    pub fn point(&self, p: Vector) -> Vector {
        std::array::from_fn(|i| dot(self.turn[i], p) + self.shift[i])
    }

    /// A point of the parent in the child.
    pub fn point_back(&self, p: Vector) -> Vector {
        let from = minus(p, self.shift);
        std::array::from_fn(|k| self.turn[0][k] * from[0] + self.turn[1][k] * from[1] + self.turn[2][k] * from[2])
    }
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn distance(a: Vector, b: Vector) -> f64 {
    let d = minus(a, b);
    dot(d, d).sqrt()
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
