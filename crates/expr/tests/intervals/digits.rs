//! Numbers of fifty digits, and the operations on them.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use flank_expr::{Binary, Interval, Operation, Tape, Unary};

type Big = FBig<HalfEven, 2>;

/// Fifty decimal digits.
const BITS: usize = 170;

/// A real number, known to fifty digits.
#[derive(Clone, Debug)]
pub(crate) struct Digits(Big);

impl From<f64> for Digits {
    fn from(x: f64) -> Digits {
        Digits(Big::try_from(x).expect("finite").with_precision(BITS).value())
    }
}

impl From<&Digits> for f64 {
    fn from(x: &Digits) -> f64 {
        x.0.to_f64().value()
    }
}

impl Digits {
    /// The outputs of a tape without curves; `None` where one is not defined.
    pub(crate) fn outputs(tape: &Tape, inputs: &[Digits]) -> Vec<Option<Digits>> {
        let constants = tape.constants().iter().map(|x| Digits::from(*x));
        let mut registers: Vec<Option<Digits>> = inputs.iter().cloned().chain(constants).map(Some).collect();
        registers.resize(tape.register_count(), None);
        for step in tape.instructions() {
            let a = registers[step.a as usize].clone();
            let b = registers.get(step.b as usize).cloned().flatten();
            registers[step.out as usize] = match step.operation {
                Operation::Unary(op) => a.and_then(|a| a.unary(op)),
                Operation::Binary(op) => a.zip(b).and_then(|(a, b)| a.binary(op, &b)),
                Operation::SinCos => {
                    registers[step.b as usize] = a.as_ref().and_then(|a| a.unary(Unary::Cos));
                    a.and_then(|a| a.unary(Unary::Sin))
                }
                // the sum over the nodes, which the bound of an integral widens
                Operation::Widened => a,
                Operation::Curve(_) | Operation::Middle | Operation::Settled => {
                    unreachable!("the tapes that are tested here have no curves and roots")
                }
            };
        }
        tape.outputs().iter().map(|&register| registers[register as usize].clone()).collect()
    }

    /// Ends are floats and compared exactly; infinite ends hold everything.
    pub(crate) fn lies_in(&self, found: Interval) -> bool {
        let end = |x: f64| Big::try_from(x).expect("finite");
        (found.lo == f64::NEG_INFINITY || end(found.lo) <= self.0)
            && (found.hi == f64::INFINITY || self.0 <= end(found.hi))
    }

    /// `None` outside the domain.
    pub(crate) fn unary(&self, op: Unary) -> Option<Digits> {
        let x = &self.0;
        let (zero, one) = (Digits::from(0.0).0, Digits::from(1.0).0);
        let inside = match op {
            Unary::Sqrt => *x >= zero,
            Unary::Ln => *x > zero,
            Unary::Asin | Unary::Acos => -&one <= *x && *x <= one,
            Unary::Atanh => -&one < *x && *x < one,
            Unary::Acosh => *x >= one,
            _ => true,
        };
        inside.then(|| {
            Digits(match op {
                Unary::Neg => -x,
                Unary::Sqrt => x.sqrt(),
                Unary::Sin => x.sin(),
                Unary::Cos => x.cos(),
                Unary::Tan => x.tan(),
                Unary::Asin => x.asin(),
                Unary::Acos => x.acos(),
                Unary::Atan => x.atan(),
                Unary::Sinh => x.sinh(),
                Unary::Cosh => x.cosh(),
                Unary::Tanh => x.tanh(),
                Unary::Asinh => x.asinh(),
                Unary::Acosh => x.acosh(),
                Unary::Atanh => x.atanh(),
                Unary::Arcinv => inverse_involute(x),
                Unary::Exp => x.exp(),
                Unary::Ln => x.ln(),
                Unary::Abs if *x < zero => -x,
                Unary::Abs => x.clone(),
                Unary::Sign if *x < zero => -one,
                Unary::Sign if *x > zero => one,
                Unary::Sign => zero,
            })
        })
    }

    /// `None` outside the domain.
    pub(crate) fn binary(&self, op: Binary, other: &Digits) -> Option<Digits> {
        let (x, y) = (&self.0, &other.0);
        let zero = Digits::from(0.0).0;
        Some(Digits(match op {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div if *y == zero => return None,
            Binary::Div => x / y,
            Binary::Pow => return self.power(other),
            Binary::Atan2 if *x == zero && *y == zero => return None,
            Binary::Atan2 => x.atan2(y),
            Binary::Min => if x < y { x } else { y }.clone(),
            Binary::Max => if x > y { x } else { y }.clone(),
        }))
    }

    fn power(&self, exponent: &Digits) -> Option<Digits> {
        let (x, y) = (&self.0, &exponent.0);
        let zero = Digits::from(0.0).0;
        if *x > zero {
            return Some(Digits(x.powf(y)));
        }
        let whole = y.to_int().value();
        if Big::from(whole.clone()) != *y {
            return (*x == zero && *y > zero).then(|| Digits(zero));
        }
        (*x != zero || *y >= zero).then(|| Digits(x.powi(whole)))
    }
}

/// The angle with tan a − a = x: Newton from the float next to it, each step doubling its digits.
fn inverse_involute(x: &Big) -> Big {
    let near = Unary::Arcinv.apply(x.to_f64().value());
    if near == 0.0 {
        return Digits::from(0.0).0;
    }
    let mut a = Digits::from(near).0;
    for _ in 0..4 {
        let tangent = a.tan();
        a = &a - (&tangent - &a - x) / (&tangent * &tangent);
    }
    a
}
