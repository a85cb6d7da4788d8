//! The small triad of the frame's axes, and the scale.

use std::f64::consts::TAU;

use super::camera::Camera;
use super::font;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Place, Rect, Sheet, text_rect};
use super::palette::{GREY, INK, WHITE};
use flank_export::text::dimension;

const ARM: f64 = 38.0;
/// An arm that is seen at less than this share of its length points to the eye or away from it.
const END_ON: f64 = 0.12;

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
    let mut taken = Occupancy::new(rect.right + 3.0 * ARM, rect.bottom + 3.0 * ARM);
    for (towards, along, _) in &arms {
        draw_arm(origin, *along, *towards, &mut taken, sheet);
    }
    for (_, along, name) in &arms {
        write_letter(
            [0, 1].map(|k| origin[k] + ARM * along[k]),
            direction(*along).unwrap_or(free),
            name,
            &mut taken,
            sheet,
        );
    }
    let text = font::fitted(frame, 13.0, (0.35 * rect.width()).max(120.0));
    sheet.text([rect.left, rect.bottom], Anchor::Start, 13.0, GREY, &text);
}

/// `None` for an arm that points to the eye, or away from it.
fn direction(along: Place) -> Option<Place> {
    let length = along[0].hypot(along[1]);
    (length > END_ON).then(|| along.map(|x| x / length))
}

/// The direction away from all arms.
fn opposite(arms: impl Iterator<Item = Place>) -> Place {
    let sum = arms.fold([0.0; 2], |sum, arm| [sum[0] - arm[0], sum[1] - arm[1]]);
    let length: f64 = sum[0].hypot(sum[1]);
    if length > 0.05 { sum.map(|x| x / length) } else { [0.0, -1.0] }
}

/// An arrow; for an arm that points to the eye a dot in a ring, away from it a cross in a ring.
fn draw_arm(origin: Place, along: Place, towards: f64, taken: &mut Occupancy, sheet: &mut Sheet) {
    let tip = [0, 1].map(|k| origin[k] + ARM * along[k]);
    if let Some(direction) = direction(along) {
        sheet.line(&[origin, tip], INK, 1.8);
        taken.take_line([origin, tip]);
        if ARM * along[0].hypot(along[1]) > 12.0 {
            let head = [0, 1].map(|k| tip[k] + 5.0 * direction[k]);
            sheet.arrow_head(head, direction, 10.0, INK);
            taken.take_line([tip, head]);
        }
        return;
    }
    let at = |angle: f64, radius: f64| [origin[0] + radius * angle.cos(), origin[1] + radius * angle.sin()];
    let ring: Vec<Place> = (0..=24).map(|k| at(TAU * f64::from(k) / 24.0, 6.0)).collect();
    sheet.polygon(&ring, WHITE, INK, 1.5);
    taken.take_shape(&ring);
    if towards > 0.0 {
        sheet.line(&[origin, origin], INK, 4.0);
    } else {
        for angle in [0.125 * TAU, 0.375 * TAU] {
            sheet.line(&[at(angle, 6.0), at(angle, -6.0)], INK, 1.5);
        }
    }
}

/// Beyond the tip, or around it where that place is taken.
fn write_letter(tip: Place, direction: Place, name: &str, taken: &mut Occupancy, sheet: &mut Sheet) {
    let around = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0].map(|eighths| 0.125 * TAU * eighths);
    let places = [14.0, 20.0].into_iter().flat_map(|far| around.map(|angle| (far, angle)));
    let place = |(far, angle): (f64, f64)| {
        let (sin, cos) = angle.sin_cos();
        let [x, y] = direction;
        [tip[0] + far * (cos * x - sin * y), tip[1] + far * (sin * x + cos * y) + 5.0]
    };
    let load = |at: &Place| taken.load(&text_rect(*at, Anchor::Middle, 15.0, name));
    if let Some(at) = places.map(place).min_by(|a, b| load(a).total_cmp(&load(b))) {
        taken.take(&sheet.text(at, Anchor::Middle, 15.0, INK, name));
    }
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
