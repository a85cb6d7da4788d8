//! Expressions a hundred thousand operations deep: nothing recurses, nothing is quadratic.

use flank_expr::{Expr, Graph, ScalarEvaluator, Style, Tape};

const DEEP: usize = 100_000;

/// Runs on a stack so small that recursion over the depth of an expression would overflow it.
fn on_a_small_stack(work: fn()) {
    std::thread::Builder::new()
        .stack_size(128 * 1024)
        .spawn(work)
        .expect("a thread")
        .join()
        .expect("no overflow, no panic");
}

/// A chain that uses every second link twice and that no rule shortens.
fn chain<'g>(x: Expr<'g>, y: Expr<'g>) -> Expr<'g> {
    let mut f = x;
    for k in 0..DEEP / 4 {
        f = match k % 4 {
            0 => (f * y + x).sin(),
            1 => (f + y) / (f + 2.0),
            2 => f.max(x) * f,
            _ => (f - y).atan2(x),
        };
    }
    f
}

#[test]
fn every_pass_over_a_deep_chain() {
    on_a_small_stack(|| {
        let graph = Graph::new();
        let (x, y) = (graph.variable("x"), graph.variable("y"));
        let f = chain(x, y);
        let slope = f.derivative(x);
        let oracle = graph.evaluate(&[f, slope], &[0.3, 0.4]);
        let tape = Tape::new(&[f, slope], &[x, y]).unwrap();
        let mut found = [0.0; 2];
        ScalarEvaluator::new(&tape).run(&[0.3, 0.4], &mut found);
        assert_eq!(found.map(f64::to_bits).to_vec(), oracle.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        let moved = graph.substitute(&[f], &[(x, y + 0.1), (y, x)]);
        assert_eq!(graph.variables_of(&moved).len(), 2);
        assert!(graph.count(&[slope]).shared > DEEP / 2);
        assert!(f.to_string().starts_with("(an expression of"));
    });
}

#[test]
fn printing_of_deep_expressions() {
    on_a_small_stack(|| {
        let graph = Graph::new();
        let (x, y) = (graph.variable("x"), graph.variable("y"));
        let (mut nested, mut sum, mut power) = (x, x, x);
        for k in 0..DEEP {
            nested = (nested + y).sin();
            sum = sum - y * (k as f64 + 0.5);
            power = y.pow(power);
        }
        for style in [Style::Text, Style::Latex] {
            let values = graph.listing(&[nested, sum, power], style, "t").values;
            assert!(values.iter().all(|value| value.len() > DEEP), "{style:?}");
        }
        // shared parts: one definition each, none longer than a few links
        let deep = chain(x, y);
        let listing = graph.listing(&[deep, deep.sin()], Style::Text, "t");
        assert!(listing.definitions.len() > DEEP / 20);
        assert!(listing.definitions.iter().all(|definition| definition.value.len() < 1000));
    });
}

/// Rules that look below the top of an expression, on chains made to lead them down.
#[test]
fn rules_do_not_descend() {
    on_a_small_stack(|| {
        let graph = Graph::new();
        let (x, y, z) = (graph.variable("x"), graph.variable("y"), graph.variable("z"));
        // two products that differ at the far end only, added at every link
        let (mut left, mut right) = (y, z);
        for k in 0..DEEP {
            let factor = (x + k as f64).sin();
            (left, right) = (factor * left, factor * right);
            let before = graph.len();
            let _ = (left + right, left - right);
            assert!(graph.len() - before <= 8);
        }
        // constants that cannot merge, then a factor that could be pulled through all of them
        let mut tiny = x;
        let mut huge = x;
        let mut sum = x;
        for _ in 0..DEEP {
            tiny = 1e-300 * tiny;
            huge = 1e300 * huge;
            sum = 1e308 + sum;
        }
        let before = graph.len();
        let _ = (tiny * y, y * huge, 1e300 * tiny, -tiny, -huge, tiny + tiny * y, sum - 1e308, 2.0 * sum);
        let _ = (tiny.sin(), (-tiny).sin(), tiny * tiny, tiny + tiny / 3.0, 1e-300 * huge, y - tiny);
        assert!(graph.len() - before < 200, "{} new nodes", graph.len() - before);
        // signs
        let mut signed = x;
        for _ in 0..DEEP {
            signed = -(signed * -y) - z;
        }
        let _ = -signed;
        assert!(graph.len() < 30 * DEEP);
    });
}
