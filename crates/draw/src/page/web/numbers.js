// Numbers as they are embedded, and as people read them.

/** Doubles, little-endian, as base64. */
export function decoded(text) {
    const letters = atob(text);
    const bytes = new Uint8Array(letters.length);
    for (let k = 0; k < bytes.length; k++) bytes[k] = letters.charCodeAt(k);
    return new Float64Array(bytes.buffer);
}

const DEGREES = 180 / Math.PI;

/** A number of the machine (mm, radians) in the unit that it is shown in. */
export function inUnit(unit, value) {
    return unit === "deg" ? value * DEGREES : value;
}

/** The other way round. */
export function fromUnit(unit, shown) {
    return unit === "deg" ? shown / DEGREES : shown;
}

/** A number with so many significant digits, without a power of ten where that reads well. */
export function digits(value, count = 6) {
    if (value === null || !Number.isFinite(value)) return "not defined";
    const size = Math.abs(value);
    if (size === 0) return "0";
    if (size < 1e-4 || size >= 1e7) return value.toExponential(Math.min(count, 4) - 1);
    return String(Number(value.toPrecision(count)));
}

/** A value with its unit. */
export function withUnit(unit, value, count = 6) {
    const text = digits(inUnit(unit, value), count);
    return unit === "1" || unit === "" ? text : `${text} ${unit}`;
}

/** Ends and steps of a scale that people can read: multiples of 1, 2 or 5 between two values. */
export function ticks(low, high, most) {
    if (!(high > low)) return [low];
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((size) => size >= rough);
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
}
