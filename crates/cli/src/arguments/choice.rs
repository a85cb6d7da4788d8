//! Arguments that name one of the library's kinds.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use flank::{Choice, UnknownChoice};

/// Kinds whose names say what they are.
pub(super) fn names<C>() -> impl TypedValueParser<Value = C>
where
    C: Choice + std::str::FromStr<Err = UnknownChoice>,
{
    among(|kind| PossibleValue::new(C::name(kind)))
}

/// Kinds that help describes.
pub(super) fn described<C>() -> impl TypedValueParser<Value = C>
where
    C: Choice + std::str::FromStr<Err = UnknownChoice>,
{
    among(|kind| PossibleValue::new(C::name(kind)).help(C::about(kind)))
}

fn among<C>(value: impl Fn(C) -> PossibleValue) -> impl TypedValueParser<Value = C>
where
    C: Choice + std::str::FromStr<Err = UnknownChoice>,
{
    let known: Vec<PossibleValue> = C::ALL.iter().map(|kind| value(*kind)).collect();
    PossibleValuesParser::new(known).try_map(|name| name.parse::<C>())
}
