//! Determinants of small symbolic matrices, written out.

use crate::symbolic::graph::{Expr, Graph};

/// The determinant of some columns of `rows`, as many as there are rows, by Laplace's expansion. Entries that are zero leave no
/// trace. The number of terms grows with the factorial of the number of rows.
///
/// # Panics
/// If a row lacks one of the columns.
pub fn determinant<'g>(graph: &'g Graph, rows: &[Vec<Expr<'g>>], columns: &[usize]) -> Expr<'g> {
    let Some((first, rest)) = rows.split_first() else { return graph.constant(1.0) };
    let mut sum = graph.constant(0.0);
    for (k, &column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        let term = first[column] * determinant(graph, rest, &others);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

/// The cofactors of an entry of a square matrix: of all of row `row`, from the first column on. Times the row they sum up to
/// the determinant, times another one to zero.
///
/// # Panics
/// If the matrix is not square.
pub fn cofactors<'g>(graph: &'g Graph, rows: &[Vec<Expr<'g>>], row: usize) -> Vec<Expr<'g>> {
    let others: Vec<Vec<Expr<'g>>> = (0..rows.len()).filter(|i| *i != row).map(|i| rows[i].clone()).collect();
    let cofactor = |column: usize| {
        let columns: Vec<usize> = (0..rows.len()).filter(|j| *j != column).collect();
        let minor = determinant(graph, &others, &columns);
        if (row + column).is_multiple_of(2) { minor } else { -minor }
    };
    (0..rows.len()).map(cofactor).collect()
}
