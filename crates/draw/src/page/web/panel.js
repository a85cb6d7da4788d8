// The controls beside the view, and the tables.

import { digits, fromUnit, inUnit, withUnit } from "./numbers.js";

/** Steps of a slider from end to end. */
const STEPS = 400;
/** What stands for numbers that are not known for moved parameters. */
const OWN_ONLY = "for the job's own values only";

/** An element with properties and children. */
export function element(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
}

/**
 * A slider with a number beside it; `change(value)` is called with values of the machine: mm, radians. A number that is typed may lie
 * beyond the slider, which then goes on to it, but not beyond the limits.
 */
export class Slider {
    constructor({ name, unit, low, high, limits, isCount, hint }, change) {
        Object.assign(this, { name, unit, isCount, limits: [limits[0] ?? -Infinity, limits[1] ?? Infinity] });
        const id = `slider-${name}`;
        this.range = element("input", { type: "range", id, title: hint ?? "" });
        this.stretch(inUnit(unit, low), inUnit(unit, high));
        this.number = element("input", { type: "number", step: "any", ariaLabel: `${name} in ${unit}` });
        this.told = element("span", { className: "told warning", role: "status" });
        this.range.addEventListener("input", () => this.slide(change));
        this.number.addEventListener("change", () => this.type(change));
        const label = element("label", { htmlFor: id, textContent: name, title: hint ?? name });
        this.row = element("div", { className: "slider" }, label, this.range, this.number);
        this.row.append(element("span", { className: "unit", textContent: unit === "1" ? "" : unit }), this.told);
    }

    slide(change) {
        this.told.textContent = "";
        change(this.limited(fromUnit(this.unit, Number(this.range.value))));
    }

    /** What is no number, or beyond the limits, leaves the value that it had. */
    type(change) {
        const typed = fromUnit(this.unit, this.number.valueAsNumber);
        const kept = this.limited(typed);
        // degrees are rounded on the way
        const isWithin = Math.abs(typed - kept) <= 1e-14 * Math.abs(kept);
        this.told.textContent = isWithin || Number.isNaN(typed) ? "" : this.refusal();
        this.show(isWithin ? kept : this.value);
        if (isWithin) change(kept);
    }

    limited(value) {
        return Math.min(Math.max(value, this.limits[0]), this.limits[1]);
    }

    refusal() {
        const [low, high] = this.limits.map((end) => withUnit(this.unit, end, 7));
        if (this.limits[0] === -Infinity) return `${this.name} goes up to ${high} only`;
        if (this.limits[1] === Infinity) return `${this.name} goes down to ${low} only`;
        return `${this.name} goes from ${low} to ${high} only`;
    }

    /** Lets the slider go over these values, in the unit that is shown, in these steps. */
    stretch(low, high, step = (high - low) / STEPS) {
        [this.low, this.high] = [low, high];
        Object.assign(this.range, { min: low, max: high, step: this.isCount ? 1 : step || "any" });
    }

    /** Shows a value of the machine; of one that it shows already the box may be in work. */
    set(value) {
        if (value !== this.value) this.show(value);
    }

    show(value) {
        this.value = value;
        const shown = inUnit(this.unit, value);
        if (shown < this.low || shown > this.high) this.stretch(Math.min(shown, this.low), Math.max(shown, this.high));
        this.range.value = shown;
        this.range.ariaValueText = withUnit(this.unit, value);
        this.number.value = digits(shown, 7);
    }
}

/** A table of names and values; a third cell has more. */
export function table(rows) {
    return element("table", {}, ...rows.map(([name, value, more]) =>
        element("tr", {},
            element("th", { textContent: name, title: more ?? "" }),
            element("td", { textContent: value, title: more ?? "" }))));
}

/** What is known of one point, row by row. */
export function pointRows(surface, point) {
    const { columns, rows } = surface.data;
    const [i, j] = [Math.floor(point / columns.count), point % columns.count];
    const list = [["surface", surface.name], [`row i (${rows.label})`, String(i)], [`column j (${columns.label})`, String(j)]];
    list.push(["status", surface.word(point)]);
    if (!surface.isSolved(point)) return list;
    const names = ["x", "y", "z"];
    names.forEach((name, k) => list.push([name, withUnit("mm", surface.positions[3 * point + k], 9)]));
    names.forEach((name, k) => list.push([`normal ${name}`, digits(surface.normals[3 * point + k], 9)]));
    for (const quantity of surface.quantities().filter(({ name, kind }) => !(kind === "place" && name === "z"))) {
        const value = quantity.isOwn ? OWN_ONLY : `${digits(quantity.at(point), 9)} ${quantity.unit === "1" ? "" : quantity.unit}`;
        list.push([quantity.name, value, quantity.meaning]);
    }
    for (const field of surface.fields.filter(({ components }) => components === 3)) {
        const parts = surface.vector(field.values, point);
        const value = surface.isMoved ? OWN_ONLY : Array.from(parts, (part) => digits(part, 4)).join(", ");
        list.push([field.name, value, field.meaning]);
    }
    return list;
}

/** The command that solves the job with the same values. */
export function command(data, settings) {
    const value = (unit, number) => {
        const text = digits(inUnit(unit, number), 15);
        if (unit === "1") return text;
        return unit.startsWith("1/") ? `${text} / 1 ${unit.slice(2)}` : `${text} ${unit}`;
    };
    const set = [...settings.byHand].map(([k, number]) => {
        const { name, unit } = data.parameters[k];
        return `--set ${name}="${value(unit, number)}"`;
    });
    return ["flank solve", data.spec, `--job ${data.job}`, ...set].join(" ");
}
