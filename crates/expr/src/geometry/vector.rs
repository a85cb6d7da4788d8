//! Vectors and matrices of symbolic scalars.

use std::ops::{Add, Neg, Sub};

use crate::geometry::turned::Turned;
use crate::symbolic::graph::{Expr, Graph};
use crate::symbolic::terms::{Products, Sum};

/// A vector of three scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vector3<'g>(pub [Expr<'g>; 3]);

impl<'g> Vector3<'g> {
    /// The vector of zeros.
    pub fn zero(graph: &'g Graph) -> Vector3<'g> {
        Vector3([graph.constant(0.0); 3])
    }

    /// A vector of numbers.
    pub fn constant(graph: &'g Graph, components: [f64; 3]) -> Vector3<'g> {
        Vector3(components.map(|component| graph.constant(component)))
    }

    /// The same operation on each component.
    pub fn map(self, operation: impl FnMut(Expr<'g>) -> Expr<'g>) -> Vector3<'g> {
        Vector3(self.0.map(operation))
    }

    /// a · b.
    pub fn dot(self, other: Vector3<'g>) -> Expr<'g> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// a × b.
    pub fn cross(self, other: Vector3<'g>) -> Vector3<'g> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Vector3([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Length.
    pub fn norm(self) -> Expr<'g> {
        self.dot(self).sqrt()
    }

    /// Multiplied by a scalar.
    pub fn scaled(self, factor: Expr<'g>) -> Vector3<'g> {
        self.map(|component| factor * component)
    }

    /// Divided by its length, which a turn of the vector does not change.
    pub fn normalized(self) -> Vector3<'g> {
        match Turned::of(self) {
            Some(Turned { before, turn }) => turn.of(before.over_its_length()),
            None => self.over_its_length(),
        }
    }

    fn over_its_length(self) -> Vector3<'g> {
        let mut square = self.dot(self);
        for products in [Products::Kept, Products::WrittenOut] {
            match Sum::of_squares(&self.0, products) {
                Some(sum) if sum.is_one() => return self,
                Some(sum) => square = cheaper([square], [sum.expression()])[0],
                None => {}
            }
        }
        let norm = square.sqrt();
        self.map(|component| component / norm)
    }

    /// A vector along the same line: without what all three components have as a factor, with sin² + cos² = 1 where that
    /// makes it shorter. Where the factor is negative it points the other way.
    pub fn primitive(self) -> Vector3<'g> {
        let mut best = self;
        for products in [Products::Kept, Products::WrittenOut] {
            let sums: Option<Vec<Sum<'g>>> = self.0.iter().map(|part| Sum::of(*part, products)).collect();
            let Some(sums) = sums else { continue };
            let factor = Sum::common_factor(&sums);
            let parts: Vec<Expr<'g>> = sums.into_iter().map(|sum| sum.without(&factor).expression()).collect();
            // the shorter one, and of two as short the one without the factor: a radius by itself is as short as 1
            best = Vector3(cheaper([parts[0], parts[1], parts[2]], best.0));
        }
        best
    }

    /// Partial derivative of each component.
    pub fn derivative(self, variable: Expr<'g>) -> Vector3<'g> {
        self.map(|component| component.derivative(variable))
    }

    /// True if every component is the number zero.
    pub fn is_zero(self) -> bool {
        self.0.iter().all(|component| component.is_zero())
    }
}

/// The shorter of two ways to write the same.
fn cheaper<'g, const N: usize>(a: [Expr<'g>; N], b: [Expr<'g>; N]) -> [Expr<'g>; N] {
    let size = |exprs: &[Expr<'g>]| exprs[0].graph().size(exprs);
    if size(&b) < size(&a) { b } else { a }
}

impl<'g> Add for Vector3<'g> {
    type Output = Vector3<'g>;
    fn add(self, other: Vector3<'g>) -> Vector3<'g> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Vector3([a + x, b + y, c + z])
    }
}

impl<'g> Sub for Vector3<'g> {
    type Output = Vector3<'g>;
    fn sub(self, other: Vector3<'g>) -> Vector3<'g> {
        self + -other
    }
}

impl<'g> Neg for Vector3<'g> {
    type Output = Vector3<'g>;
    fn neg(self) -> Vector3<'g> {
        self.map(|component| -component)
    }
}

/// A 3 × 3 matrix of scalars, as rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matrix3<'g>(pub [Vector3<'g>; 3]);

impl<'g> Matrix3<'g> {
    /// Ones on the diagonal.
    pub fn identity(graph: &'g Graph) -> Matrix3<'g> {
        let row = |k: usize| Vector3(std::array::from_fn(|j| graph.constant(if j == k { 1.0 } else { 0.0 })));
        Matrix3([row(0), row(1), row(2)])
    }

    /// Rows and columns exchanged: the inverse of a rotation.
    pub fn transposed(self) -> Matrix3<'g> {
        Matrix3(std::array::from_fn(|i| Vector3(std::array::from_fn(|j| self.0[j].0[i]))))
    }

    /// Matrix times column.
    pub fn times(self, column: Vector3<'g>) -> Vector3<'g> {
        Vector3(self.0.map(|row| row.dot(column)))
    }

    /// Matrix times matrix.
    pub fn product(self, right: Matrix3<'g>) -> Matrix3<'g> {
        let columns = right.transposed();
        Matrix3(self.0.map(|row| columns.times(row)))
    }

    /// Partial derivative of each entry.
    pub fn derivative(self, variable: Expr<'g>) -> Matrix3<'g> {
        Matrix3(self.0.map(|row| row.derivative(variable)))
    }

    /// All entries, row by row.
    pub fn entries(self) -> [Expr<'g>; 9] {
        std::array::from_fn(|k| self.0[k / 3].0[k % 3])
    }
}
