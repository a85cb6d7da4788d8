//! Expressions and polynomials as the source text of a function that runs without this program.

mod body;
mod helpers;
mod language;
mod names;

use crate::symbolic::graph::Expr;
use crate::tape::{Tape, TapeError};
use body::Body;
use language::{Arrays, Frame};
use names::Scope;

/// The language of an emitted function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99 with its mathematical library.
    C,
    /// Rust with the floats of its standard library.
    Rust,
    /// A module of JavaScript (ECMAScript 2015), for pages and Node.
    JavaScript,
}

/// What an emitted function is called and says about itself.
#[derive(Clone, Copy, Debug)]
pub struct Signature<'a> {
    /// Its name; made into an identifier of the language.
    pub name: &'a str,
    /// Lines of the comment above it: where it comes from, units, conventions, its error bound.
    pub comment: &'a [String],
}

/// A power series in the distance of the argument from a reference.
#[derive(Clone, Copy, Debug)]
pub struct Polynomial<'a> {
    /// What it gives, for the comment.
    pub name: &'a str,
    /// Its coefficients, constant first.
    pub coefficients: &'a [f64],
}

/// A function that fills `values[i]` with the outputs and `derivatives[i]` with their exact first derivatives; with several
/// arguments the derivative of output i by argument k stands at `derivatives[i * arguments + k]`.
///
/// Each part is computed once, in the order of a [`Tape`]. Numbers read back as the same bits. It allocates nothing, keeps
/// nothing between calls, and gives NaN outside its domain, as expressions do.
///
/// ```
/// use flank_expr::{Graph, Language, Signature, emit_function};
///
/// let graph = Graph::new();
/// let phi = graph.variable("φ");
/// let comment = ["swing of the table; phi in radians, X in mm".to_string()];
/// let signature = Signature { name: "table swing", comment: &comment };
/// let text = emit_function(Language::C, signature, &[phi], &[("X", 2.5 * phi.sin())])?;
/// assert!(text.contains("void table_swing(double phi, double values[1], double derivatives[1])"));
/// assert!(text.contains("= sin(phi);"));
/// # Ok::<(), flank_expr::TapeError>(())
/// ```
///
/// # Errors
/// If an output depends on a variable that is not an argument: replace it by its number first ([`crate::Graph::substitute`]).
///
/// # Panics
/// If there is no output, an argument is not a variable, or the expressions are of different graphs.
pub fn emit_function(
    language: Language,
    signature: Signature<'_>,
    arguments: &[Expr<'_>],
    outputs: &[(&str, Expr<'_>)],
) -> Result<String, TapeError> {
    let values = outputs.iter().map(|(_, output)| *output);
    let slopes = outputs.iter().flat_map(|(_, output)| arguments.iter().map(|argument| output.derivative(*argument)));
    let tape = Tape::new(&values.chain(slopes).collect::<Vec<_>>(), arguments)?;
    Ok(of_tape(language, signature, arguments, outputs, (&tape, Arrays::ValuesAndDerivatives)))
}

/// The same without derivatives: a function that fills `values[i]` with the outputs. Derivatives by some of the arguments may be
/// among these.
///
/// ```
/// use flank_expr::{Graph, Language, Signature, emit_values};
///
/// let graph = Graph::new();
/// let phi = graph.variable("φ");
/// let signature = Signature { name: "swing", comment: &[] };
/// let text = emit_values(Language::JavaScript, signature, &[phi], &[("X", 2.5 * phi.sin())])?;
/// assert!(text.contains("export function swing(phi, values) {"));
/// assert!(text.contains("= Math.sin(phi);"));
/// # Ok::<(), flank_expr::TapeError>(())
/// ```
///
/// # Errors
/// As for [`emit_function`].
///
/// # Panics
/// As for [`emit_function`].
pub fn emit_values(
    language: Language,
    signature: Signature<'_>,
    arguments: &[Expr<'_>],
    outputs: &[(&str, Expr<'_>)],
) -> Result<String, TapeError> {
    let values: Vec<Expr<'_>> = outputs.iter().map(|(_, output)| *output).collect();
    let tape = Tape::new(&values, arguments)?;
    Ok(of_tape(language, signature, arguments, outputs, (&tape, Arrays::Values)))
}

fn of_tape(
    language: Language,
    signature: Signature<'_>,
    arguments: &[Expr<'_>],
    outputs: &[(&str, Expr<'_>)],
    (tape, arrays): (&Tape, Arrays),
) -> String {
    assert!(!outputs.is_empty(), "a function has at least one output");
    let names: Vec<String> = arguments
        .iter()
        .map(|argument| argument.graph().variable_name(argument.as_variable().expect("inputs of a tape are variables")))
        .collect();
    let scope = Scope::new(signature.name, &names);
    let body = Body::new(language, &scope, tape, outputs.len());
    let frame = Frame { language, scope: &scope, comment: signature.comment, arrays };
    let titles: Vec<&str> = outputs.iter().map(|(name, _)| *name).collect();
    body.helpers.text(language, scope.function()) + &frame.function(&titles, &body.statements)
}

/// A function that fills `values[i]` with the polynomials and `derivatives[i]` with their first derivatives, by Horner's rule on
/// all of them at once.
///
/// ```
/// use flank_expr::{Language, Polynomial, Signature, emit_polynomials};
///
/// let signature = Signature { name: "axes", comment: &[] };
/// let lift = Polynomial { name: "X", coefficients: &[10.0, 0.5, -0.125] };
/// let text = emit_polynomials(Language::Rust, signature, ("phi", 0.25), &[lift]);
/// assert!(text.contains("pub fn axes(phi: f64, values: &mut [f64; 1], derivatives: &mut [f64; 1])"));
/// ```
///
/// # Panics
/// If there is no polynomial.
pub fn emit_polynomials(
    language: Language,
    signature: Signature<'_>,
    (argument, reference): (&str, f64),
    polynomials: &[Polynomial<'_>],
) -> String {
    assert!(!polynomials.is_empty(), "a function has at least one output");
    let scope = Scope::new(signature.name, &[argument.to_string()]);
    let powers = polynomials.iter().map(|polynomial| polynomial.coefficients.len()).max().unwrap_or(0).max(1);
    let coefficient = |power: usize| move |p: &Polynomial<'_>| p.coefficients.get(power).copied().unwrap_or(0.0);
    let rows: Vec<Vec<f64>> =
        (0..powers).rev().map(|power| polynomials.iter().map(coefficient(power)).collect()).collect();
    let table = language.table("coefficients", &rows);
    let loops = language.horner(&scope.arguments()[0], reference, powers, polynomials.len());
    let frame = Frame { language, scope: &scope, comment: signature.comment, arrays: Arrays::ValuesAndDerivatives };
    let titles: Vec<&str> = polynomials.iter().map(|polynomial| polynomial.name).collect();
    frame.function(&titles, &[table, loops])
}
