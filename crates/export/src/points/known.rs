//! Values that some points have and others have not.

use std::fmt::Debug;
use std::sync::Arc;

/// A number or a vector, or in its place what says that there is none.
pub trait Kept: Copy + Debug + PartialEq + private::Sealed {
    /// What is kept of a point that has none.
    #[doc(hidden)]
    const NONE: Self;
    #[doc(hidden)]
    fn numbers(&self) -> &[f64];
}

mod private {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for [f64; 3] {}
}

impl Kept for f64 {
    const NONE: f64 = f64::NAN;

    fn numbers(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
}

impl Kept for [f64; 3] {
    const NONE: [f64; 3] = [f64::NAN; 3];

    fn numbers(&self) -> &[f64] {
        self
    }
}

/// One value for each point, in the order of the points, or none; clones share them. What is not a number is no value: that is how a
/// missing one is kept, in no more memory than the value itself.
#[derive(Debug, Clone)]
pub struct Known<T>(Arc<Vec<T>>);

impl<T: Kept> Known<T> {
    /// For so many points; each is then [pushed](Known::push).
    #[must_use]
    pub fn with_capacity(points: usize) -> Known<T> {
        Known(Arc::new(Vec::with_capacity(points)))
    }

    /// The value of the next point.
    pub fn push(&mut self, value: Option<T>) {
        Arc::make_mut(&mut self.0).push(value.unwrap_or(T::NONE));
    }

    /// The number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of a point.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn at(&self, point: usize) -> Option<T> {
        value(self.0[point])
    }

    /// The values of all points.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<T>> + Clone {
        self.0.iter().map(|kept| value(*kept))
    }

    /// The numbers of a point: none where it has no value.
    pub(crate) fn numbers(&self, point: usize) -> &[f64] {
        let kept = &self.0[point];
        if value(*kept).is_some() { kept.numbers() } else { &[] }
    }

    /// The numbers of all points, NaN where there is no value.
    pub fn all_numbers(&self) -> impl Iterator<Item = f64> {
        self.0.iter().flat_map(|kept| kept.numbers().iter().copied())
    }
}

fn value<T: Kept>(kept: T) -> Option<T> {
    (!kept.numbers().iter().any(|number| number.is_nan())).then_some(kept)
}

impl<T: Kept> PartialEq for Known<T> {
    fn eq(&self, other: &Known<T>) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: Kept> FromIterator<Option<T>> for Known<T> {
    fn from_iter<I: IntoIterator<Item = Option<T>>>(values: I) -> Known<T> {
        Known(Arc::new(values.into_iter().map(|value| value.unwrap_or(T::NONE)).collect()))
    }
}

impl<T: Kept, const N: usize> From<[Option<T>; N]> for Known<T> {
    fn from(values: [Option<T>; N]) -> Known<T> {
        values.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_stays_so() {
        let known: Known<f64> = [Some(1.0), None, Some(f64::NAN)].into();
        assert_eq!(known.iter().collect::<Vec<_>>(), [Some(1.0), None, None]);
        assert_eq!([known.numbers(0), known.numbers(1)], [&[1.0][..], &[]]);
        assert_eq!(known, known.iter().collect());
        let vectors: Known<[f64; 3]> = [None, Some([1.0, 2.0, 3.0])].into();
        assert_eq!([vectors.at(0), vectors.at(1)], [None, Some([1.0, 2.0, 3.0])]);
        assert_eq!(vectors.numbers(1), [1.0, 2.0, 3.0]);
    }
}
