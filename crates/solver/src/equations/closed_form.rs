//! Unknowns in closed form: where an equation is linear in one and all else in it is given, it gives that one too.

use flank_expr::{Expr, VariableId};

/// An unknown that an equation gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'g> {
    /// Its number.
    pub(crate) unknown: usize,
    /// A function of parameters and of unknowns given before it.
    pub(crate) form: Expr<'g>,
}

/// The unknowns that equations give, in the order in which they follow from each other.
pub(crate) fn given_unknowns<'g>(residuals: &[Expr<'g>], unknowns: &[Expr<'g>]) -> Vec<Given<'g>> {
    let mut found: Vec<Given<'g>> = Vec::new();
    let mut equations: Vec<(Expr<'g>, Vec<VariableId>)> =
        residuals.iter().map(|residual| (*residual, residual.graph().variables_of(&[*residual]))).collect();
    loop {
        let is_given = |k: usize| found.iter().any(|given| given.unknown == k);
        let open: Vec<usize> = (0..unknowns.len()).filter(|k| !is_given(*k)).collect();
        let next = equations.iter().enumerate().find_map(|(k, equation)| Some((k, by(equation, unknowns, &open)?)));
        let Some((equation, given)) = next else { return found };
        equations.remove(equation);
        found.push(given);
    }
}

/// The unknown that an equation with these variables gives: the only open one in it.
fn by<'g>(
    (equation, variables): &(Expr<'g>, Vec<VariableId>),
    unknowns: &[Expr<'g>],
    open: &[usize],
) -> Option<Given<'g>> {
    let is_needed = |k: &usize| unknowns[*k].as_variable().is_some_and(|variable| variables.contains(&variable));
    let mut needed = open.iter().copied().filter(is_needed);
    let (unknown, None) = (needed.next()?, needed.next()) else { return None };
    Some(Given { unknown, form: equation.linear_in(unknowns[unknown])?.root() })
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use super::*;

    #[test]
    fn equations_give_what_they_are_linear_in() {
        let graph = Graph::new();
        let [s, a, b, target] = ["s", "a", "b", "target"].map(|name| graph.variable(name));
        let numbers = |residuals: &[Expr<'_>], unknowns: &[Expr<'_>]| {
            given_unknowns(residuals, unknowns).iter().map(|given| given.unknown).collect::<Vec<_>>()
        };
        let meshing = s * a.sin() - b.cos();
        // a and b are given alone, whatever stands first, and s by them
        assert_eq!(numbers(&[meshing, 2.0 * a - target, b - 1.0], &[s, a, b]), [1, 2, 0]);
        // not by what is not given itself
        assert_eq!(numbers(&[meshing, (a * b).sin() - target, b - target], &[s, a, b]), [2]);
        assert_eq!(numbers(&[s * s - a, a - target], &[s, a]), [1]);
        let given = given_unknowns(&[meshing, a - target, b - target], &[s, a, b]);
        assert_eq!(given[2].form, b.cos() / a.sin());
    }
}
