//! Values of the language, and names for them.

use std::collections::HashMap;
use std::rc::Rc;

use flank_expr::{CurveId, Expr};

use crate::values::dimension::Dimension;
use crate::values::grids::Grid;
use crate::values::segment::{Profile, Segment};

/// A value of the language.
#[derive(Clone, Debug)]
pub(crate) enum Value<'g> {
    Scalar(Expr<'g>, Dimension),
    Vector(Vec<Value<'g>>),
    /// `None` where the answer is not known yet: a definition checked without values.
    Truth(Option<bool>),
    Text,
    /// A curve with the dimensions of its x and y.
    Curve(CurveId, Dimension, Dimension),
    /// Values on a grid of two parameters, smooth between.
    Grid(Rc<Grid>),
    /// A profile, outside of the surfaces along it.
    Profile(Rc<Profile<'g>>),
    /// A profile in that piece of a surface which runs along this segment.
    Segment(Rc<Segment<'g>>),
    /// Something wrong that has been reported: whatever is made of it is silent.
    Poison,
}

impl<'g> Value<'g> {
    /// Number of values inside it.
    pub(crate) fn size(&self) -> usize {
        match self {
            Value::Vector(parts) => parts.iter().map(|part| part.size() + 1).sum(),
            _ => 0,
        }
    }

    /// The greatest power of a length or an angle in it.
    pub(crate) fn greatest_power(&self) -> usize {
        match self {
            Value::Scalar(_, dimension) => dimension.greatest_power(),
            Value::Vector(parts) => parts.iter().map(Value::greatest_power).max().unwrap_or(0),
            _ => 0,
        }
    }

    /// The scalar that it is, with its dimension.
    pub(crate) fn as_scalar(&self) -> Option<(Expr<'g>, Dimension)> {
        match self {
            Value::Scalar(expr, dimension) => Some((*expr, *dimension)),
            _ => None,
        }
    }

    pub(crate) fn described(&self) -> String {
        match self {
            Value::Scalar(_, dimension) if *dimension == Dimension::NUMBER => "a number".to_string(),
            Value::Scalar(_, dimension) => format!("{} {dimension}", article(*dimension)),
            Value::Vector(parts) => format!("a vector of {}", parts.len()),
            Value::Truth(_) => "a condition".to_string(),
            Value::Curve(..) => "a curve".to_string(),
            Value::Grid(_) => "a grid".to_string(),
            Value::Profile(_) | Value::Segment(_) => "a profile".to_string(),
            Value::Text => "a text".to_string(),
            Value::Poison => "an error".to_string(),
        }
    }
}

/// `a` or `an` before a dimension's name.
pub(crate) fn article(dimension: Dimension) -> &'static str {
    if dimension.to_string().starts_with('a') { "an" } else { "a" }
}

/// Names and their values.
pub(crate) type Scope<'g> = HashMap<String, Value<'g>>;

/// Whether an expression is a number now.
pub(crate) enum Constant {
    Known(f64),
    /// It depends on a parameter that has no value yet.
    Unknown,
    /// It depends on something that moves.
    Moves(String),
}
