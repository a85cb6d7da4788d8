// One generated surface: its points as the program solved them, and as they are for other parameters.

import { decoded, inUnit } from "./numbers.js";
import { Equations, follow } from "./newton.js";

/** An unknown is inside its range if it is outside by less than this share of it, as in the program. */
const ROUNDING = 1e-10;
const SOLVED = 0;

/** A field whose numbers are decoded when they are looked at first: a surface has dozens. */
function decodedLater(field) {
    let values = null;
    return {
        ...field,
        get values() {
            return (values ??= decoded(field.values));
        },
    };
}

export class WorkSurface {
    constructor(data, functions) {
        this.data = data;
        this.name = data.name;
        this.count = data.rows.count * data.columns.count;
        this.width = data.unknowns.length;
        this.own = {
            positions: decoded(data.positions),
            normals: decoded(data.normals),
            unknowns: decoded(data.unknown_values),
            residuals: decoded(data.residuals),
            status: Uint8Array.from(data.status),
        };
        this.words = [...data.words];
        this.targets = decoded(data.targets);
        this.fields = data.fields.map(decodedLater);
        this.cornersAt = functions[data.corners];
        this.pointAt = functions[data.point];
        this.equations = new Equations(functions[data.equations], data.unknowns.map(({ low, high }) => [low, high]));
        this.reset();
    }

    /** Everything as the program solved it. */
    reset() {
        Object.assign(this, this.own, { isMoved: false, curvatures: null });
    }

    /** By how much other settings move both coordinates that points are asked for by, at the corners of the grid. */
    cornersMoved(settings) {
        const [own, now] = [settings.own, settings.values].map((values) => {
            const out = new Float64Array(8);
            this.cornersAt(...values, out);
            return out;
        });
        return now.map((value, k) => value - own[k]);
    }

    /** The coordinates that a point is asked for by, a share of the way from the job's own settings to those wanted. */
    targetsOf(point, moved) {
        const own = this.targets.subarray(2 * point, 2 * point + 2);
        const columns = this.data.columns.count;
        const [v, u] = [this.data.shares[0][Math.floor(point / columns)], this.data.shares[1][point % columns]];
        const weights = [(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u];
        const by = [0, 1].map((k) => weights.reduce((sum, weight, corner) => sum + weight * moved[2 * corner + k], 0));
        return (share) => own.map((value, k) => value + share * by[k]);
    }

    /** Solves all points for other settings. What the program did not solve stays unsolved. */
    solve(settings) {
        this.reset();
        if (!settings.areMoved) return;
        const nothing = (width) => new Float64Array(width * this.count).fill(NaN);
        this.isMoved = true;
        this.status = this.own.status.slice();
        this.positions = nothing(3);
        this.normals = nothing(3);
        this.unknowns = nothing(this.width);
        this.residuals = nothing(1);
        this.curvatures = this.data.curvatures ? nothing(2) : null;
        const moved = this.cornersMoved(settings);
        for (let point = 0; point < this.count; ++point) {
            if (this.own.status[point] === SOLVED) this.solvePoint(point, settings, moved);
        }
    }

    solvePoint(point, settings, moved) {
        const start = this.own.unknowns.subarray(this.width * point, this.width * (point + 1));
        const found = follow(this.equations, start, this.targetsOf(point, moved), settings);
        if (found.why) {
            this.status[point] = this.numberOf(found.why);
            return;
        }
        const conditions = this.data.conditions;
        const out = new Float64Array(6 + conditions + (this.data.curvatures ? 2 : 0));
        this.pointAt(...found.unknowns, ...settings.values, out);
        const verdict = this.verdict(found.unknowns, out.subarray(0, 6), out.subarray(6, 6 + conditions));
        this.status[point] = this.numberOf(verdict);
        if (verdict !== "solved") return;
        this.positions.set(out.subarray(0, 3), 3 * point);
        this.normals.set(out.subarray(3, 6), 3 * point);
        this.unknowns.set(found.unknowns, this.width * point);
        this.residuals[point] = found.residual;
        this.curvatures?.set(out.subarray(6 + conditions), 2 * point);
    }

    /** What a root is: in its ranges, and on the side on which the tool leaves it. */
    verdict(unknowns, placed, conditions) {
        const outside = this.data.unknowns.some(({ low, high }, k) => {
            const room = ROUNDING * (high - low);
            return unknowns[k] < low - room || unknowns[k] > high + room;
        });
        if (outside) return "out_of_range";
        if (conditions.some((condition) => condition < 0)) return "undercut";
        if (!conditions.every((condition) => condition > 0) || !placed.every(Number.isFinite)) return "singular";
        return "solved";
    }

    numberOf(word) {
        if (!this.words.includes(word)) this.words.push(word);
        return this.words.indexOf(word);
    }

    isSolved(point) {
        return this.status[point] === SOLVED;
    }

    word(point) {
        return this.words[this.status[point]];
    }

    vector(values, point) {
        return values.subarray(3 * point, 3 * point + 3);
    }

    unknown(point, k) {
        return this.unknowns[this.width * point + k];
    }

    /** Along the old normal, from where the job's own values put the point, µm: plus is more material. */
    shift(point) {
        const [own, now] = [this.own.positions, this.positions];
        const along = (k) => this.own.normals[3 * point + k] * (now[3 * point + k] - own[3 * point + k]);
        return 1e3 * (along(0) + along(1) + along(2));
    }

    /** The number of points for each word but `solved`, where the job's own values do solve them. */
    lost() {
        const counts = new Map();
        for (let point = 0; point < this.count; ++point) {
            if (this.own.status[point] === SOLVED && !this.isSolved(point)) {
                counts.set(this.word(point), (counts.get(this.word(point)) ?? 0) + 1);
            }
        }
        return counts;
    }

    /** Corners of the two triangles of each mesh of the grid whose corners are all solved. */
    triangles() {
        const { rows, columns } = this.data;
        const corners = [];
        for (let i = 0; i + 1 < rows.count; ++i) {
            for (let j = 0; j + 1 < columns.count; ++j) {
                const a = i * columns.count + j;
                const [b, c, d] = [a + 1, a + columns.count, a + columns.count + 1];
                for (const triangle of [[a, b, d], [a, d, c]]) {
                    if (triangle.every((point) => this.isSolved(point))) corners.push(...triangle);
                }
            }
        }
        return corners;
    }

    /** Ends of the pieces of a line, where the grid has one row or one column only. */
    pieces() {
        const { rows, columns } = this.data;
        if (rows.count > 1 && columns.count > 1) return [];
        const starts = Array.from({ length: this.count - 1 }, (_, point) => point);
        return starts.filter((point) => this.isSolved(point) && this.isSolved(point + 1)).flatMap((point) => [point, point + 1]);
    }

    /**
     * What it can be coloured by, and what a click shows, in the units that are shown. `isOwn` marks numbers that hold for the
     * job's own values only.
     */
    quantities() {
        const position = (k) => (point) => this.positions[3 * point + k];
        const rho = (point) => Math.hypot(position(0)(point), position(1)(point));
        const list = this.data.unknowns.map(({ name, unit, motion }, k) => ({
            name, unit, kind: motion === null ? "place on the tool" : "motion",
            meaning: motion === null ? "parameter of the tool's surface" : "value of the motion at which the point is generated",
            at: (point) => inUnit(unit, this.unknown(point, k)),
        }));
        list.push(
            { name: "z", unit: "mm", kind: "place", meaning: "along the z axis of the work's frame", at: position(2) },
            { name: "rho", unit: "mm", kind: "place", meaning: "distance from the z axis of the work's frame", at: rho },
            {
                name: "residual", unit: "mm", kind: "solution", at: (point) => this.residuals[point],
                meaning: "largest residual of the point's equations, mm or mm per radian",
            },
        );
        if (this.isMoved) {
            list.push({
                name: "shift", unit: "µm", kind: "change", at: (point) => this.shift(point),
                meaning: "along the normal, from where the job's own values put the point; plus is more material",
            });
        }
        return [...list, ...this.fields.filter((field) => field.components === 1).map((field) => this.scalarField(field))];
    }

    scalarField(field) {
        const { name, unit, kind, meaning } = field;
        const curvature = ["k1", "k2"].indexOf(name);
        if (this.curvatures && curvature >= 0) {
            return { name, unit, kind, meaning, at: (point) => this.curvatures[2 * point + curvature] };
        }
        return { name, unit, kind, meaning, isOwn: this.isMoved, at: (point) => field.values[point] };
    }
}
