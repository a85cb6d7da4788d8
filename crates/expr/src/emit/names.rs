//! Names that all languages take for identifiers.

use std::collections::HashSet;
use std::sync::LazyLock;

use super::helpers::Helper;
use crate::symbolic::print::GREEK;

/// The names of one function: its own and those of its arguments, all different and free of what the body uses.
pub(super) struct Scope {
    function: String,
    arguments: Vec<String>,
}

impl Scope {
    pub(super) fn new(function: &str, arguments: &[String]) -> Scope {
        let function = freed(identifier(function), is_reserved);
        let mut scope = Scope { function, arguments: Vec::new() };
        for argument in arguments {
            let name = freed(identifier(argument), |name| scope.has(name) || is_reserved(name) || is_local(name));
            scope.arguments.push(name);
        }
        scope
    }

    pub(super) fn function(&self) -> &str {
        &self.function
    }

    pub(super) fn arguments(&self) -> &[String] {
        &self.arguments
    }

    fn has(&self, name: &str) -> bool {
        let of_helper = name.strip_prefix(&self.function).and_then(|rest| rest.strip_prefix('_'));
        name == self.function
            || Helper::ALL.iter().any(|helper| of_helper == Some(helper.name()))
            || self.arguments.iter().any(|argument| argument == name)
    }
}

/// The name of a value that the body computes.
pub(super) fn local(number: usize) -> String {
    format!("t{number}")
}

/// The name of a curve's table.
pub(super) fn curve(number: usize) -> String {
    format!("curve{number}")
}

/// Names of the bodies' own.
fn is_local(name: &str) -> bool {
    const FIXED: [&str; 8] = ["values", "derivatives", "coefficients", "distance", "value", "slope", "power", "output"];
    let is_numbered = |prefix: &str| {
        name.strip_prefix(prefix).is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|c| c.is_ascii_digit()))
    };
    FIXED.contains(&name) || is_numbered("t") || is_numbered("curve")
}

/// With underscores behind it until it is free.
fn freed(mut name: String, is_taken: impl Fn(&str) -> bool) -> String {
    while is_taken(&name) {
        name.push('_');
    }
    name
}

/// ASCII letters, digits and underscores, a letter first: Greek letters by their names, all else as underscores.
fn identifier(text: &str) -> String {
    let mut name = String::with_capacity(text.len());
    for c in text.chars() {
        match GREEK.iter().find(|(_, letter)| *letter == c) {
            Some((word, _)) => name.push_str(word),
            None if c.is_ascii_alphanumeric() => name.push(c),
            None => name.push('_'),
        }
    }
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("n{name}") }
}

fn is_reserved(name: &str) -> bool {
    /// Words of the languages, and functions of mathematics.
    static RESERVED: LazyLock<[HashSet<&str>; 2]> = LazyLock::new(|| {
        let words = [C, CPP, RUST, JAVASCRIPT, MACROS].into_iter().flat_map(str::split_whitespace);
        [words.collect(), MATHEMATICS.split_whitespace().collect()]
    });
    let [words, mathematics] = &*RESERVED;
    // of float and long double
    let plain = name.strip_suffix(['f', 'l']).unwrap_or(name);
    words.contains(name) || mathematics.contains(name) || mathematics.contains(plain)
}

/// Keywords to C23, what GNU's compilers define beside them, and the one function that is called from outside.
const C: &str = "
    alignas alignof asm auto bool break case char const constexpr continue default do double else enum extern false float for
    goto i386 if inline int linux long main nullptr register restrict return short signed sizeof static static_assert struct
    switch thread_local true typedef typeof typeof_unqual union unix unsigned void volatile while";

/// Keywords of C++, where headers are shared.
const CPP: &str = "
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t class co_await
    co_return co_yield compl concept const const_cast consteval constexpr constinit continue contract_assert decltype default
    delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable
    namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires
    return short signed sizeof static static_assert static_cast std struct switch template this thread_local throw true try
    typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq";

/// Keywords to the edition of 2024 and those kept for later, the types that bodies name, and what an argument of its name would be
/// matched against.
const RUST: &str = "
    abstract as async await become box break const continue crate do dyn else enum Err extern f32 f64 false final fn for gen if
    impl in let loop macro match mod move mut None Ok override priv pub ref return Self self Some static struct super trait true
    try type typeof union unsafe unsized use virtual where while yield";

/// Reserved words of modules, and the globals that bodies use.
const JAVASCRIPT: &str = "
    arguments Array await break case catch class const continue debugger default delete do else enum eval export extends false
    finally for function if implements import in Infinity instanceof interface let Math NaN new null Number package private
    protected public return static super switch this throw true try typeof undefined var void while with yield";

/// Macros, types and the variable of `math.h`, as C, POSIX and GNU have it.
const MACROS: &str = "
    DEC_INFINITY DEC_NAN DOMAIN double_t float_t FP_FAST_FMA FP_FAST_FMAF FP_FAST_FMAL FP_ILOGB0 FP_ILOGBNAN FP_INFINITE
    FP_INT_DOWNWARD FP_INT_TONEAREST FP_INT_TONEARESTFROMZERO FP_INT_TOWARDZERO FP_INT_UPWARD FP_LLOGB0 FP_LLOGBNAN FP_NAN
    FP_NORMAL FP_SUBNORMAL FP_ZERO HUGE HUGE_VAL HUGE_VALF HUGE_VALL INFINITY M_1_PI M_1_PIl M_2_PI M_2_PIl M_2_SQRTPI
    M_2_SQRTPIl M_E M_El M_LN10 M_LN10l M_LN2 M_LN2l M_LOG10E M_LOG10El M_LOG2E M_LOG2El M_PI M_PI_2 M_PI_2l M_PI_4 M_PI_4l
    M_PIl M_SQRT1_2 M_SQRT1_2l M_SQRT2 M_SQRT2l MATH_ERREXCEPT math_errhandling MATH_ERRNO MAXFLOAT NAN OVERFLOW PLOSS signgam
    SING SNAN SNANF SNANL TLOSS UNDERFLOW X_TLOSS";

/// Functions of `math.h` without suffix.
const MATHEMATICS: &str = "
    abs acos acosh acospi asin asinh asinpi atan atan2 atan2pi atanh atanpi canonicalize cbrt ceil compoundn copysign cos cosh
    cospi dadd ddiv dfma dmul drem dsqrt dsub erf erfc exp exp10 exp10m1 exp2 exp2m1 expm1 fabs fadd fdim fdiv ffma finite floor
    fma fmax fmaximum fmaximum_mag fmaximum_mag_num fmaximum_num fmin fminimum fminimum_mag fminimum_mag_num fminimum_num fmod
    fmul fpclassify frexp fromfp fromfpx fsqrt fsub gamma getpayload hypot ilogb iscanonical iseqsig isfinite isgreater
    isgreaterequal isinf isless islessequal islessgreater isnan isnormal issignaling issubnormal isunordered iszero j0 j1 jn
    ldexp lgamma lgamma_r llogb llrint llround log log10 log10p1 log1p log2 log2p1 logb logp1 lrint lround modf nan nearbyint
    nextafter nextdown nexttoward nextup pow pow10 pown powr remainder remquo rint rootn round roundeven rsqrt scalb scalbln
    scalbn setpayload setpayloadsig signbit significand sin sincos sinh sinpi sqrt tan tanh tanpi tgamma totalorder
    totalordermag trunc ufromfp ufromfpx y0 y1 yn";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        let cases = [
            ("phi", "phi"),
            ("φ", "phi"),
            ("m.cradle_angle", "m_cradle_angle"),
            ("19x62", "n19x62"),
            ("", "n"),
            ("_x", "n_x"),
            ("Wälz winkel", "W_lz_winkel"),
        ];
        for (text, expected) in cases {
            assert_eq!(identifier(text), expected);
        }
    }

    #[test]
    fn names_of_a_function_differ() {
        let arguments = ["phi", "φ", "t12", "values", "return", "sin", "f", "tilt", "f_min"].map(String::from);
        let scope = Scope::new("f", &arguments);
        assert_eq!(scope.arguments(), ["phi", "phi_", "t12_", "values_", "return_", "sin_", "f_", "tilt", "f_min_"]);
        for name in ["main", "sin", "sinf", "hypotl", "signgam", "linux", "static_assert"] {
            assert_eq!(Scope::new(name, &[]).function(), format!("{name}_"));
        }
        assert_eq!(Scope::new("half", &[]).function(), "half");
    }
}
