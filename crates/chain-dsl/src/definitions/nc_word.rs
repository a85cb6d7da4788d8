//! What NC programs say of axes: `nc A1 = -tilt by 0.001 deg`.

use flank_expr::Expr;

use crate::definitions::machine::BuiltAxis;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::NcWord;
use crate::syntax::ast;
use crate::values::context::{Context, READABLE, quoted};
use crate::values::dimension::Dimension;
use crate::values::value::{Constant, Scope, Value};

/// Controls take no more decimals.
const MOST_DECIMALS: u8 = 9;
/// Of an increment, as far as it may be off a power of ten by rounding.
const ROUNDING: f64 = 1e-9;

/// Gives axes their words, those of parents first; `words` has each with the place of its machine in the line. A variant's word
/// takes the place of its parents' for the axis.
pub(crate) fn settle<'g>(
    context: &mut Context<'g>,
    words: &[(&ast::NcWord, usize)],
    scope: &Scope<'g>,
    axes: &mut [BuiltAxis<'g>],
) {
    let mut stated: Vec<Option<(usize, Span)>> = vec![None; axes.len()];
    for (word, place) in words {
        let Some(axis) = axis_of(context, word, scope, axes) else { continue };
        let span = word.address.span;
        if let Some((_, first)) = stated[axis].filter(|(other, _)| other == place) {
            let message = format!("axis `{}` has two NC words", axes[axis].name.node);
            context.report(Diagnostic::new(Code::NcWord, span, message).note(first, "the first is here"));
            continue;
        }
        stated[axis] = Some((*place, span));
        if let Some(word) = build(context, word, scope, &axes[axis]) {
            axes[axis].word = word;
        }
    }
    for (k, axis) in axes.iter().enumerate() {
        for (j, other) in axes[..k].iter().enumerate().filter(|(_, other)| other.word.address == axis.word.address) {
            if let Some((_, span)) = stated[k].or(stated[j]) {
                let message =
                    format!("axes `{}` and `{}` are both `{}`", other.name.node, axis.name.node, axis.word.address);
                context.report(Diagnostic::new(Code::NcWord, span, message));
            }
        }
    }
}

/// The one axis that a word's value is made of.
fn axis_of<'g>(
    context: &mut Context<'g>,
    word: &ast::NcWord,
    scope: &Scope<'g>,
    axes: &[BuiltAxis<'g>],
) -> Option<usize> {
    let Value::Scalar(value, _) = context.evaluate(&word.value, scope) else { return None };
    let inside = context.graph.variables_of(&[value]);
    let is_inside = |axis: &BuiltAxis<'g>| axis.variable.as_variable().is_some_and(|own| inside.contains(&own));
    let found: Vec<usize> = (0..axes.len()).filter(|&k| is_inside(&axes[k])).collect();
    if let [axis] = found[..] {
        return Some(axis);
    }
    let names: Vec<&str> = found.iter().map(|&k| axes[k].name.node.as_str()).collect();
    let address = &word.address.node;
    let message = match names[..] {
        [] => format!("`{address}` says nothing of an axis"),
        _ => format!("`{address}` mixes axes {}", quoted(&names)),
    };
    let all = || axes.iter().map(|axis| axis.name.node.as_str()).collect();
    let names: Vec<&str> = if names.is_empty() { all() } else { names };
    let example = names.first().copied().unwrap_or("A");
    let help = format!("a word says where one axis stands, such as `nc {address} = {example}`, or `-{example}`");
    let diagnostic = Diagnostic::new(Code::NcWord, word.value.span, message).help(help);
    context.report(writing_axes(diagnostic, word.value.span, &names));
    None
}

/// Offers each of a few axes as what a word says.
fn writing_axes(diagnostic: Diagnostic, span: Span, names: &[&str]) -> Diagnostic {
    let each = names.iter().take(READABLE).flat_map(|name| [(*name).to_string(), format!("-{name}")]);
    each.fold(diagnostic, |diagnostic, axis| diagnostic.cure(format!("write `{axis}`"), span, axis))
}

fn build<'g>(context: &mut Context<'g>, word: &ast::NcWord, scope: &Scope<'g>, axis: &BuiltAxis<'g>) -> Option<NcWord> {
    let address = &word.address.node;
    if !is_address(address) {
        let message = format!("`{address}` is no address of an NC program");
        let help = "an address is a capital letter, perhaps with a number behind, such as `A` or `B1`";
        context.report(Diagnostic::new(Code::NcWord, word.address.span, message).help(help));
        return None;
    }
    let what = format!("`{address}`");
    let dimension = axis.dimension?;
    let value = context.scalar(&word.value, scope, dimension, &what)?;
    let slope = context.constant(value.derivative(axis.variable));
    let reversed = match slope {
        Constant::Known(slope) if slope.abs() == 1.0 => slope < 0.0,
        Constant::Unknown => return None,
        Constant::Known(_) | Constant::Moves(_) => {
            let name = &axis.name.node;
            let message = format!("{what} does not go on as axis `{name}` does");
            let help = format!("write `{name}` or `-{name}`, perhaps with something added that stands still");
            let diagnostic = Diagnostic::new(Code::NcWord, word.value.span, message).help(help);
            context.report(writing_axes(diagnostic, word.value.span, &[name]));
            return None;
        }
    };
    let zero = context.graph.constant(0.0);
    let rest: Expr<'g> = context.graph.substitute(&[value], &[(axis.variable, zero)])[0];
    let offset = context.require_constant(rest, word.value.span, &what)?;
    let decimals = match &word.increment {
        Some(increment) => Some(decimals(context, increment, scope, dimension)?),
        None => None,
    };
    Some(NcWord { address: address.clone(), reversed, offset, decimals })
}

fn is_address(address: &str) -> bool {
    let mut characters = address.chars();
    let is_led = characters.next().is_some_and(|first| first.is_ascii_uppercase());
    let number = characters.as_str();
    is_led && number.len() <= 2 && number.bytes().all(|c| c.is_ascii_digit())
}

/// The decimals of a power of ten, in mm or degrees.
fn decimals<'g>(
    context: &mut Context<'g>,
    increment: &ast::Expression,
    scope: &Scope<'g>,
    dimension: Dimension,
) -> Option<u8> {
    let value = context.scalar(increment, scope, dimension, "the increment")?;
    let size = context.require_constant(value, increment.span, "the increment")?;
    let written = if dimension == Dimension::ANGLE { size.to_degrees() } else { size };
    let found = (0..=MOST_DECIMALS).find(|&k| (written * 10f64.powi(i32::from(k)) - 1.0).abs() <= ROUNDING);
    if found.is_none() {
        let message = "positions are written in steps of one decimal";
        let example = if dimension == Dimension::ANGLE { "0.001 deg" } else { "0.001 mm" };
        let help = format!("such as `{example}`, with up to {MOST_DECIMALS} decimals");
        context.report(Diagnostic::new(Code::NcWord, increment.span, message).help(help));
    }
    found
}
