//! The small triad of the frame's axes, and the scale.

use super::camera::Camera;
use super::font;
use super::paint::{Anchor, Place, Rect, Sheet};
use super::palette::{GREY, INK};
use crate::number::dimension;

const ARM: f64 = 38.0;

/// Draws the directions x, y, z of the frame as the camera sees them, in the left of the rectangle.
pub(super) fn draw_triad(camera: &Camera, frame: &str, rect: Rect, sheet: &mut Sheet) {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| camera.seen(axis));
    let mut arms: Vec<(f64, Place, &str)> =
        axes.iter().zip(["x", "y", "z"]).map(|(&[right, up, towards], name)| (towards, [right, -up], name)).collect();
    arms.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The arms, not their origin, stand in the middle of their place.
    let shift = [0, 1].map(|k| {
        let reach = arms.iter().map(|arm| arm.1[k]);
        -0.5 * ARM * (reach.clone().fold(0.0, f64::max) + reach.fold(0.0, f64::min))
    });
    let origin = [rect.left + 56.0 + shift[0], rect.middle()[1] - 14.0 + shift[1]];
    let free = opposite(arms.iter().map(|arm| arm.1));
    for (_, along, name) in arms {
        draw_arm(origin, along, free, name, sheet);
    }
    let text = font::fitted(frame, 13.0, 0.35 * rect.width());
    sheet.text([rect.left, rect.bottom], Anchor::Start, 13.0, GREY, &text);
}

/// The direction away from all arms.
fn opposite(arms: impl Iterator<Item = Place>) -> Place {
    let sum = arms.fold([0.0; 2], |sum, arm| [sum[0] - arm[0], sum[1] - arm[1]]);
    let length: f64 = sum[0].hypot(sum[1]);
    if length > 0.05 { sum.map(|x| x / length) } else { [0.0, -1.0] }
}

/// An arm that points to the eye has no direction on the sheet; its letter goes where it is `free`.
fn draw_arm(origin: Place, along: Place, free: Place, name: &str, sheet: &mut Sheet) {
    let length = along[0].hypot(along[1]);
    let direction = if length > 0.05 { along.map(|x| x / length) } else { free };
    let tip = [origin[0] + ARM * along[0], origin[1] + ARM * along[1]];
    sheet.line(&[origin, tip], INK, 1.8);
    if ARM * length > 12.0 {
        sheet.arrow_head([tip[0] + 5.0 * direction[0], tip[1] + 5.0 * direction[1]], direction, 10.0, INK);
    }
    let beside = [tip[0] + 14.0 * direction[0], tip[1] + 14.0 * direction[1] + 5.0];
    sheet.text(beside, Anchor::Middle, 15.0, INK, name);
}

/// Draws a bar of a round length. `scale` is sheet units per mm.
pub(super) fn draw_scale(scale: f64, rect: Rect, sheet: &mut Sheet) {
    let length = round_length(190.0 / scale);
    let half = 0.5 * length * scale;
    let [middle, _] = rect.middle();
    let down = rect.bottom - 26.0;
    let ends = [middle - half, middle + half];
    sheet.line(&[[ends[0], down], [ends[1], down]], INK, 2.0);
    for end in ends {
        sheet.line(&[[end, down - 5.0], [end, down + 5.0]], INK, 2.0);
    }
    sheet.text([middle, down - 12.0], Anchor::Middle, 15.0, INK, &in_words(length));
}

fn in_words(millimetres: f64) -> String {
    if millimetres < 0.01 {
        format!("{} \u{b5}m", dimension(1000.0 * millimetres))
    } else {
        format!("{} mm", dimension(millimetres))
    }
}

/// The largest of 1, 2, 5 times a power of ten that is not above the limit.
fn round_length(limit: f64) -> f64 {
    let decade = 10.0_f64.powf(limit.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * decade).find(|&length| length <= limit).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round() {
        assert_eq!(round_length(7.3), 5.0);
        assert_eq!(round_length(49.0), 20.0);
        assert_eq!(round_length(1.99), 1.0);
        assert_eq!(round_length(0.1), 0.1);
    }
}
