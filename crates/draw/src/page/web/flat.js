// Flanks laid flat as the rolling tester shows them, and the error over the roll: drawings beside the view.

import { digits, inUnit, ticks } from "./numbers.js";

const WIDTH = 318;
/** A map is at least so high, and at most. */
const HEIGHTS = [90, 210];
const MARGIN = { left: 16, right: 16, top: 18, bottom: 18 };
const CHART = { width: WIDTH, height: 130, left: 44, right: 10, top: 16, bottom: 30 };
/** An error that changes by less than this, urad or um, is none. */
const STEADY = 1e-6;
const UNKNOWN = "#bfbfbf";

function drawn(tag, attributes = {}, ...children) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
}

const path = (places) => places.map(([x, y]) => `${x.toFixed(2)},${y.toFixed(2)}`).join(" ");

/** A flank with the gap to its mate, the line of the compound, the path of contact, and where it touches now. */
export class FlankMap {
    /** `gaps` are those of the flank's points, um; `colour(gap)` is the colour of one. */
    constructor({ name, rows, columns, nodes, sides, touches, onFlank, gaps, film, colour }) {
        Object.assign(this, { touches, nodes, gaps });
        this.fit();
        this.element = drawn("svg", {
            width: WIDTH, height: this.height, class: "flat", role: "img", "aria-label": `${name} laid flat`,
        });
        const cells = [];
        for (let i = 0; i + 1 < rows; ++i) for (let j = 0; j + 1 < columns; ++j) cells.push(i * columns + j);
        const line = [];
        for (const a of cells) {
            const corners = [a, a + 1, a + columns + 1, a + columns];
            if (!corners.every((k) => Number.isFinite(nodes[2 * k]))) continue;
            const mean = corners.reduce((sum, k) => sum + gaps[k] / 4, 0);
            const fill = Number.isFinite(mean) ? colour(mean) : UNKNOWN;
            this.element.append(drawn("polygon", { points: path(corners.map((k) => this.node(k))), fill, stroke: fill, "stroke-width": 0.6 }));
            line.push(...this.crossed([a, a + 1, a + columns + 1], film), ...this.crossed([a, a + columns + 1, a + columns], film));
        }
        this.element.append(drawn("path", { d: line.join(""), class: "film" }));
        const ways = onFlank.map((_, k) => this.place(touches[6 * k], touches[6 * k + 1]));
        this.element.append(
            drawn("polyline", { points: path(ways), class: "way edge" }),
            drawn("polyline", { points: path(ways.filter((_, k) => onFlank[k])), class: "way" }),
        );
        for (const [word, along] of sides) this.nameSide(word, along.filter((k) => Number.isFinite(nodes[2 * k])));
        this.ellipse = drawn("polygon", { class: "ellipse" });
        this.mark = drawn("circle", { r: 4, class: "now" });
        this.element.append(this.ellipse, this.mark);
    }

    /** The scale: the flank fills the width; a long one is drawn higher than it is. */
    fit() {
        const ends = [0, 1].map((k) => {
            const values = this.nodes.filter((x, at) => at % 2 === k && Number.isFinite(x));
            return [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
        });
        const [across, up] = ends.map(([low, high]) => Math.max(high - low, 1e-9));
        const width = WIDTH - MARGIN.left - MARGIN.right;
        const height = Math.min(Math.max((up / across) * width, HEIGHTS[0]), HEIGHTS[1]);
        this.height = height + MARGIN.top + MARGIN.bottom;
        this.place = (x, y) => [
            MARGIN.left + ((x - ends[0][0]) / across) * width,
            MARGIN.top + height - ((y - ends[1][0]) / up) * height,
        ];
    }

    node(k) {
        return this.place(this.nodes[2 * k], this.nodes[2 * k + 1]);
    }

    /** Where the gap is as wide as the film within a triangle of points. */
    crossed(corners, film) {
        const places = [];
        for (const [a, b] of [[0, 1], [1, 2], [2, 0]].map((pair) => pair.map((k) => corners[k]))) {
            const [low, high] = [this.gaps[a] - film, this.gaps[b] - film];
            if (!(low * high < 0)) continue;
            const share = low / (low - high);
            const [p, q] = [this.node(a), this.node(b)];
            places.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
        }
        return places.length === 2 ? [`M${path([places[0]])}L${path([places[1]])}`] : [];
    }

    nameSide(word, along) {
        if (along.length === 0) return;
        const [x, y] = this.node(along[Math.floor(along.length / 2)]);
        const middle = [WIDTH / 2, this.height / 2];
        const isBeside = Math.abs(x - middle[0]) / WIDTH > Math.abs(y - middle[1]) / this.height;
        const places = isBeside
            ? { x: x < middle[0] ? 11 : WIDTH - 4, y, transform: `rotate(-90 ${x < middle[0] ? 11 : WIDTH - 4} ${y})` }
            : { x, y: y < middle[1] ? 12 : this.height - 5 };
        const text = drawn("text", { ...places, "text-anchor": "middle" });
        text.textContent = word;
        this.element.append(text);
    }

    /** Marks a position of the roll; `null` marks none. */
    show(index) {
        const display = index === null ? "none" : "";
        for (const part of [this.mark, this.ellipse]) part.style.display = display;
        if (index === null) return;
        const [x, y, ax, ay, bx, by] = this.touches.subarray(6 * index, 6 * index + 6);
        const [cx, cy] = this.place(x, y);
        this.mark.setAttribute("cx", cx);
        this.mark.setAttribute("cy", cy);
        const around = Array.from({ length: 48 }, (_, k) => [Math.cos((k * Math.PI) / 24), Math.sin((k * Math.PI) / 24)]);
        const places = around.map(([c, s]) => this.place(x + c * ax + s * bx, y + c * ay + s * by));
        this.ellipse.setAttribute("points", Number.isFinite(ax) ? path(places) : "");
    }
}

/** The error of the pair of teeth that carries over the roll, and thin that of one pair. */
export class ErrorChart {
    constructor({ rolls, errors, over, unit, error_unit: errorUnit }) {
        const carried = rolls.map((_, k) => errors[2 * k]);
        const own = rolls.map((_, k) => errors[2 * k + 1]);
        // how far one pair stays behind says little: the chart shows what the members do
        const [low, high] = [Math.min(...carried), Math.max(...carried)];
        const room = high - low > STEADY ? 0.15 * (high - low) : 1;
        const [bottom, top] = [low - room, high + room];
        const { width, height } = CHART;
        const [inner, up] = [width - CHART.left - CHART.right, height - CHART.top - CHART.bottom];
        const [first, last] = [rolls[0], rolls[rolls.length - 1]];
        this.x = (roll) => CHART.left + ((roll - first) / (last - first || 1)) * inner;
        const y = (error) => CHART.top + up - ((error - bottom) / (top - bottom)) * up;
        const line = (values) => path([...values].map((error, k) => [this.x(rolls[k]), y(error)]));
        this.element = drawn("svg", { width, height, class: "chart", role: "img", "aria-label": `error over ${over}` });
        const clip = drawn("clipPath", { id: "error-clip" }, drawn("rect", { x: CHART.left, y: CHART.top, width: inner, height: up }));
        this.element.append(clip, drawn("rect", { x: CHART.left, y: CHART.top, width: inner, height: up, class: "area" }));
        const write = (text, attributes) => {
            const made = drawn("text", attributes);
            made.textContent = text;
            this.element.append(made);
        };
        for (const value of ticks(bottom, top, 3)) write(digits(value, 3), { x: CHART.left - 4, y: y(value) + 4, "text-anchor": "end" });
        const shown = [first, last].map((roll) => inUnit(unit, roll));
        for (const value of ticks(...shown, 4)) {
            const share = (value - shown[0]) / (shown[1] - shown[0] || 1);
            write(digits(value, 4), { x: CHART.left + share * inner, y: height - 17, "text-anchor": "middle" });
        }
        write(`error, ${errorUnit}`, { x: 2, y: 11 });
        write(unit === "1" ? over : `${over}, ${unit}`, { x: CHART.left + inner / 2, y: height - 4, "text-anchor": "middle" });
        this.now = drawn("line", { y1: CHART.top, y2: CHART.top + up, class: "now" });
        this.element.append(
            drawn("polyline", { points: line(own), class: "own", "clip-path": "url(#error-clip)" }),
            drawn("polyline", { points: line(carried), class: "carried" }),
            this.now,
        );
        this.rolls = rolls;
    }

    show(index) {
        this.now.style.display = index === null ? "none" : "";
        if (index === null) return;
        const x = this.x(this.rolls[index]);
        this.now.setAttribute("x1", x);
        this.now.setAttribute("x2", x);
    }
}
