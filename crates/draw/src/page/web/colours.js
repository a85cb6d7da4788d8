// From numbers to colours, and the legend that says which is which.

import { digits, ticks } from "./numbers.js";

/** Of lines and letters. */
export const INK = 0x333333;

/** An end of a range that is no larger, of the other end, is zero. */
const BY_ROUNDING = 1e-9;

/** Components 0 to 1 of `#rrggbb`. */
export function components(hex) {
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

/** The colour of a scale at a share of it. */
export function mixed(scale, share) {
    const along = Math.min(Math.max(share, 0), 1) * (scale.length - 1);
    const low = Math.min(Math.floor(along), scale.length - 2);
    const [a, b] = [scale[low], scale[low + 1]].map(components);
    return `rgb(${a.map((x, k) => Math.round(255 * (x + (along - low) * (b[k] - x)))).join(" ")})`;
}

/** The lowest and the highest value of a quantity over the solved points of some surfaces; null where there is none. */
export function rangeOf(surfaces, name) {
    let [low, high] = [Infinity, -Infinity];
    for (const surface of surfaces) {
        const quantity = surface.quantities().find((one) => one.name === name);
        if (!quantity || quantity.isOwn) continue;
        for (let point = 0; point < surface.count; ++point) {
            const value = surface.isSolved(point) ? quantity.at(point) : NaN;
            if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
        }
    }
    if (low > high) return null;
    const most = Math.max(-low, high);
    [low, high] = [low, high].map((end) => (Math.abs(end) < BY_ROUNDING * most ? 0 : end));
    return { low, high, about: { low: -most, high: most, ends: [low, high] } };
}

/** Whether a quantity has a middle: one that is above and below zero, and neither a place nor a motion, has it there. */
export function isSigned(quantity, range) {
    const hasZero = quantity && !["place", "place on the tool", "motion"].includes(quantity.kind);
    return Boolean(hasZero && range && range.low < 0 && range.high > 0);
}

/** Fills the legend: title, a bar of the scale, its ticks in the quantity's unit. */
export function drawLegend(element, quantity, range, scale) {
    element.replaceChildren();
    element.hidden = !quantity;
    if (!quantity) return;
    const title = document.createElement("div");
    const unit = quantity.unit === "1" ? "" : `, ${quantity.unit}`;
    title.textContent = `${quantity.name}${unit}`;
    title.title = quantity.meaning;
    element.append(title);
    if (!range) {
        element.append("not known for the moved parameters");
        return;
    }
    const { low, high, ends: [least, most] = [range.low, range.high] } = range;
    const bar = document.createElement("div");
    bar.className = "bar";
    bar.style.background = `linear-gradient(to right, ${scale.join(", ")})`;
    const marks = document.createElement("div");
    marks.className = "marks";
    const place = (value) => (high > low ? (value - low) / (high - low) : 0.5);
    for (const value of ticks(low, high, 4)) {
        const mark = document.createElement("span");
        mark.style.left = `${100 * place(value)}%`;
        mark.textContent = digits(value, 4);
        marks.append(mark);
    }
    const ends = document.createElement("div");
    ends.className = "ends";
    ends.textContent = `${digits(least)} to ${digits(most)}`;
    element.append(bar, marks, ends);
}
