//! What the functions of the language take and give.

/// Signature and meaning of each function.
const FUNCTIONS: [(&str, &str, &str); 67] = [
    ("sin", "sin(angle) -> number", "sine"),
    ("cos", "cos(angle) -> number", "cosine"),
    ("tan", "tan(angle) -> number", "tangent"),
    ("asin", "asin(number) -> angle", "angle with this sine, from -90 deg to 90 deg"),
    ("acos", "acos(number) -> angle", "angle with this cosine, from 0 deg to 180 deg"),
    ("atan", "atan(number) -> angle", "angle with this tangent, from -90 deg to 90 deg"),
    ("atan2", "atan2(y, x) -> angle", "angle of the vector [x, y]"),
    ("inv", "inv(angle) -> angle", "involute: tan a - a"),
    ("arcinv", "arcinv(angle) -> angle", "angle with this involute"),
    ("sqrt", "sqrt(x)", "square root; the dimension is halved"),
    ("hypot", "hypot(x, y)", "sqrt(x^2 + y^2)"),
    ("exp", "exp(number) -> number", "exponential function"),
    ("ln", "ln(number) -> number", "natural logarithm"),
    ("abs", "abs(x)", "absolute value"),
    ("min", "min(x, y)", "smaller of two values of one dimension"),
    ("max", "max(x, y)", "larger of two values of one dimension"),
    ("sinh", "sinh(number) -> number", "hyperbolic sine"),
    ("cosh", "cosh(number) -> number", "hyperbolic cosine"),
    ("tanh", "tanh(number) -> number", "hyperbolic tangent"),
    ("asinh", "asinh(number) -> number", "inverse of sinh"),
    ("acosh", "acosh(number) -> number", "inverse of cosh"),
    ("atanh", "atanh(number) -> number", "inverse of tanh"),
    ("poly", "poly(x, [c0, c1, …])", "c0 + c1 x + c2 x^2 + …"),
    ("taylor", "taylor(x, [a0, a1, …])", "a0 + a1 x + a2 x^2/2! + …"),
    ("dot", "dot(a, b)", "scalar product of two vectors"),
    ("cross", "cross(a, b)", "vector product"),
    ("norm", "norm(a)", "length of a vector"),
    ("sum", "sum(k in a .. b: term)", "one term for each whole number of the range"),
    ("integral", "integral(t in a .. b: f)", "integral, its error proven to be below rounding"),
    ("root", "root(x in a .. b: f)", "the one place in the range where the formula is zero"),
    ("derivative", "derivative(f, x)", "exact derivative of a formula by a variable"),
    ("curve", "curve(\"file.csv\", x: dimension, y: dimension)", "smooth function through the rows of a table"),
    ("grid", "grid(\"file.csv\", …)", "smooth function of two variables through the rows of a table"),
    ("table", "table(\"file.csv\", column, …)", "columns of a table"),
    ("translate", "translate(x, y, z)", "moves the child by a vector"),
    ("translate_x", "translate_x(length)", "moves the child along x"),
    ("translate_y", "translate_y(length)", "moves the child along y"),
    ("translate_z", "translate_z(length)", "moves the child along z"),
    ("rotate", "rotate([x, y, z], angle)", "turns the child about a direction through the origin"),
    ("rotate_x", "rotate_x(angle)", "turns the child about x, right-handed"),
    ("rotate_y", "rotate_y(angle)", "turns the child about y, right-handed"),
    ("rotate_z", "rotate_z(angle)", "turns the child about z, right-handed"),
    ("screw", "screw([x, y, z], angle, lead)", "turns about a direction and moves along it by lead * angle"),
    ("mirror", "mirror([x, y, z])", "mirrors the child at the plane through the origin with this normal"),
    ("mirror_x", "mirror_x()", "mirrors the child along x"),
    ("mirror_y", "mirror_y()", "mirrors the child along y"),
    ("mirror_z", "mirror_z()", "mirrors the child along z"),
    ("matrix", "matrix([[r, r, r, t], [r, r, r, t], [r, r, r, t]])", "explicit rigid motion: rotation and translation"),
    ("envelope", "envelope(tool.surface, …, over: motion)", "surface that the tool's surface envelopes over a motion"),
    ("sweep", "sweep(tool.edge, …, over: motion)", "surface that an edge passes over"),
    ("move", "move(tool.surface, …)", "the surface itself in another frame"),
    ("turned", "turned(profile, spaces: count, of: [surface, …])", "blank turned about z, with tooth spaces"),
    ("extruded", "extruded(profile, spaces: count, pitch: length, of: [surface, …])", "bar along y, with tooth spaces"),
    ("vertex", "vertex(z: length, rho: length, …)", "what a contact is like where its error is extreme"),
    ("about", "about(value, within)", "a value that need not hold exactly"),
    ("line", "line(from: [x, y], to: [x, y])", "straight segment of a profile"),
    ("arc", "arc(from: [x, y], to: [x, y], centre: [x, y])", "segment of a profile along a circle"),
    ("spline", "spline(…)", "smooth segment of a profile through points"),
    ("thickness", "thickness(solid, diameter)", "thickness of a tooth at a diameter"),
    ("span", "span(solid, teeth)", "span width over some teeth"),
    ("over_balls", "over_balls(solid, diameter)", "dimension over two balls"),
    ("turn", "turn(surface, other)", "angle by which one surface is turned against another one"),
    ("rms", "rms(surface, other)", "root of the mean square of the deviation"),
    ("lowest", "lowest(surface, value)", "smallest value over the points of a sample"),
    ("highest", "highest(surface, value)", "largest value over the points of a sample"),
    ("position", "position(…)", "position of a point"),
    ("slope", "slope(surface, other)", "slope of the deviation"),
];

/// What is known of contacts, solids and surfaces once they are solved, and of segments.
const NUMBERS: [(&str, &str); 27] = [
    ("ratio", "of a contact: how long the flanks of one pair of teeth touch, in pitches"),
    ("peak_to_peak", "of a contact: the error of the motion from its lowest to its highest, over a pitch"),
    ("turn", "of a contact: the roll in its middle"),
    ("lag", "of a contact: the error of the motion in its middle"),
    ("parabola", "of a contact: the second derivative of the error of the motion by the roll"),
    ("backlash", "of a contact: how far the driven member can move between both flanks, at the tightest place"),
    ("normal_backlash", "of a contact: the backlash along the normals of the flanks"),
    ("clearance", "of a contact: the least that edges leave to the fillet and the root of the mate"),
    ("half_length", "of a contact: half the long axis of its ellipse"),
    ("half_width", "of a contact: half the short axis of its ellipse"),
    ("gap_high", "of a contact: the larger curvature of the gap"),
    ("gap_low", "of a contact: the smaller curvature of the gap"),
    ("pairs", "of a contact: how many pairs of teeth are within the film at a time"),
    ("z1", "of a contact: where its middle lies along the axis of the first body"),
    ("rho1", "of a contact: how far its middle lies from the axis of the first body"),
    ("z2", "of a contact: where its middle lies along the axis of the second body"),
    ("rho2", "of a contact: how far its middle lies from the axis of the second body"),
    ("volume", "of a solid: its volume"),
    ("area", "of a solid: the area of its surface"),
    ("tip_diameter", "of a solid: the diameter at the tips of its teeth"),
    ("root_diameter", "of a solid: the diameter at the bottom of its spaces"),
    ("form_diameter", "of a solid: the diameter from which on its flanks are usable"),
    ("singular_line", "of a surface: the line on which it has no tangent plane"),
    ("contact_limit", "of a surface: the line beyond which the tool does not leave the points that it makes"),
    ("trim_line", "of a surface: the line at which another one ends it"),
    ("from", "of a segment: where it begins"),
    ("to", "of a segment: where it ends"),
];

/// What a number is that is known once something is solved.
pub(super) fn number_about(name: &str) -> Option<&'static str> {
    NUMBERS.iter().find(|(known, _)| *known == name).map(|(_, about)| *about)
}

/// How a function is called, and what it gives.
pub(super) fn function_about(name: &str) -> Option<(&'static str, &'static str)> {
    let found = FUNCTIONS.iter().find(|(known, ..)| *known == name);
    found.map(|(_, signature, about)| (*signature, *about))
}

#[cfg(test)]
mod tests {
    use flank_chain_dsl::syntax::vocabulary;

    use super::*;

    #[test]
    fn each_function_that_is_described_is_one_of_the_language() {
        let known = vocabulary().functions;
        let strange: Vec<&str> =
            FUNCTIONS.iter().map(|(name, ..)| *name).filter(|name| !known.contains(name)).collect();
        assert!(strange.is_empty(), "{strange:?}");
        let untold: Vec<&&str> = known.iter().filter(|name| function_about(name).is_none()).collect();
        assert_eq!(untold, [&"bias", &"crowning"]);
    }
}
