//! Colours: Okabe and Ito's set, which colour-blind readers can tell apart, in an order that differs in lightness too.

use super::paint::Colour;
use flank_export::vector::{Vector, dot};

pub(super) const WHITE: Colour = Colour([255, 255, 255]);
pub(super) const INK: Colour = Colour([26, 26, 26]);
pub(super) const GREY: Colour = Colour([96, 96, 96]);
pub(super) const FAINT: Colour = Colour([200, 200, 200]);
/// The ground of a flank that only lines are drawn on.
pub(super) const PALE: Colour = Colour([229, 236, 242]);
pub(super) const RED: Colour = Colour([190, 0, 0]);

/// CIE lightness in this order: 70, 54, 89, 46, 71, 58, 61.
const PATCHES: [Colour; 7] = [
    Colour([86, 180, 233]),
    Colour([213, 94, 0]),
    Colour([240, 228, 66]),
    Colour([0, 114, 178]),
    Colour([230, 159, 0]),
    Colour([0, 158, 115]),
    Colour([204, 121, 167]),
];

/// From the lowest to the highest value: lightness grows all the way, and blue against yellow is what all readers tell apart.
const SCALE: [Colour; 5] = [
    Colour([0, 34, 78]),
    Colour([63, 80, 112]),
    Colour([124, 124, 122]),
    Colour([188, 174, 98]),
    Colour([254, 232, 92]),
];

/// The colours of patches in their order, both rounds, for those who draw elsewhere.
pub(crate) fn patch_colours() -> Vec<String> {
    (0..2 * PATCHES.len()).map(|number| of_patch(number).hex()).collect()
}

/// Colours at even distances from the lowest to the highest value.
pub(crate) fn scale_colours() -> Vec<String> {
    SCALE.iter().map(|colour| colour.hex()).collect()
}

/// Colours at even distances from minus by zero to plus.
pub(crate) fn signed_colours() -> Vec<String> {
    SIGNED.iter().map(|colour| colour.hex()).collect()
}

/// From minus by zero to plus: blue against orange, as light on the one side as on the other.
const SIGNED: [Colour; 5] = [
    Colour([0, 62, 128]),
    Colour([112, 163, 208]),
    Colour([246, 246, 244]),
    Colour([231, 150, 74]),
    Colour([138, 52, 0]),
];

/// The colour of a share from 0 to 1 of the way from the lowest to the highest value.
pub(super) fn of_share(share: f64) -> Colour {
    along(SCALE, share)
}

/// The colour of a signed share, from -1 to 1.
pub(super) fn of_signed(share: f64) -> Colour {
    along(SIGNED, 0.5 * (share + 1.0))
}

/// Of letters on a ground.
pub(super) fn on(ground: Colour) -> Colour {
    if luma(ground) < 120.0 { WHITE } else { INK }
}

/// Rec. 709 luma, of 255.
fn luma(colour: Colour) -> f64 {
    colour.0.iter().zip([0.2126, 0.7152, 0.0722]).map(|(&channel, weight)| weight * f64::from(channel)).sum()
}

fn along(scale: [Colour; 5], share: f64) -> Colour {
    let along = share.clamp(0.0, 1.0) * (scale.len() - 1) as f64;
    let from = (along.floor() as usize).min(scale.len() - 2);
    scale[from].towards(scale[from + 1], along - from as f64)
}

/// Steps of brightness in a shading.
const STEPS: f64 = 40.0;

/// Where the light comes from, in the eye's frame (right, up, towards the eye); a unit vector.
const LIGHT: Vector = [-0.55, 0.62, 0.56];

/// The colour of the patch with this number; a second round is paler.
pub(super) fn of_patch(number: usize) -> Colour {
    let base = PATCHES[number % PATCHES.len()];
    let round = number / PATCHES.len();
    base.towards(WHITE, if round % 2 == 1 { 0.45 } else { 0.0 })
}

/// A face's colour under the light. `normal` is a unit vector in the eye's frame. A face that looks straight at the eye
/// has its own colour, as in the legend; towards the light it is paler, away from it darker, but never black: light
/// comes from everywhere. One seen from inside the body is greyer.
pub(super) fn shaded(base: Colour, normal: Vector) -> Colour {
    let from_behind = normal[2] < 0.0;
    let (base, normal) = if from_behind { (base.towards(GREY, 0.4), normal.map(|x| -x)) } else { (base, normal) };
    // in steps that are hardly seen, so that files are small
    let gain = ((dot(normal, LIGHT) - LIGHT[2]) * STEPS).round() / STEPS;
    if gain > 0.0 { base.towards(WHITE, 0.95 * gain) } else { base.times(1.0 / (1.0 - 0.8 * gain)) }
}

impl Colour {
    /// As `#rrggbb`.
    pub(super) fn hex(self) -> String {
        let digits = self.0.into_iter().flat_map(|byte| [byte >> 4, byte & 15]);
        // of each face of a picture: general formatting takes longer
        let letters = digits.map(|digit| char::from(if digit < 10 { b'0' + digit } else { b'a' + digit - 10 }));
        std::iter::once('#').chain(letters).collect()
    }

    /// The colour mixed with a share of another.
    pub(super) fn towards(self, other: Colour, share: f64) -> Colour {
        let mix = |a: u8, b: u8| byte(f64::from(a) + share * (f64::from(b) - f64::from(a)));
        Colour([mix(self.0[0], other.0[0]), mix(self.0[1], other.0[1]), mix(self.0[2], other.0[2])])
    }

    fn times(self, factor: f64) -> Colour {
        Colour(self.0.map(|channel| byte(factor * f64::from(channel))))
    }
}

fn byte(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fourteen_patches_have_a_colour_each() {
        let colours = patch_colours();
        let different: std::collections::BTreeSet<&String> = colours.iter().collect();
        assert_eq!((colours.len(), different.len()), (14, 14), "{colours:?}");
    }

    #[test]
    fn the_scale_is_a_scale_in_grey() {
        let greys: Vec<f64> = (0..=10).map(|k| luma(of_share(f64::from(k) / 10.0))).collect();
        assert!(greys.windows(2).all(|pair| pair[1] > pair[0] + 10.0), "{greys:?}");
    }
    #[test]
    fn signs_differ_by_colour_and_are_equally_light() {
        for k in 1..=10 {
            let share = f64::from(k) / 10.0;
            let (minus, plus) = (of_signed(-share), of_signed(share));
            // six hundredths of the way from black to white are hardly seen beside each other
            assert!((luma(minus) - luma(plus)).abs() < 0.06 * 255.0, "{share}: {} {}", luma(minus), luma(plus));
            assert!(minus.0[2] > minus.0[0] && plus.0[0] > plus.0[2]);
            assert!(luma(plus) < luma(of_signed(share - 0.1)) && luma(minus) < luma(of_signed(0.1 - share)));
        }
    }
}
