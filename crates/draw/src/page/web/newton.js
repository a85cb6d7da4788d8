// Newton's method for the equations of one point, from the exact solution at the job's own values.

/** As in the program: mm, or mm per radian; very large things are allowed a share of their size. */
const TOLERANCE = 1e-11;
const LARGEST_TOLERANCE = 1e-10;
const OF_SIZE = 1e-14;
const MOST_ITERATIONS = 12;
/** Below this pivot, with unknowns scaled by their ranges and equations by their size, a Jacobian counts as singular. */
const SINGULAR_BELOW = 1e-12;
/** No unknown moves by more than this share of its range in one step of the parameters: further, it may be another branch. */
const LONGEST_STEP = 0.1;
/** Parameters go the whole way in steps that are halved where needed, no shorter than this share of the way. */
const SHORTEST_SHARE = 1 / 64;

/** The equations of a surface's points: `evaluate(...unknowns, ...targets, ...settings, out)` fills residuals and Jacobian. */
export class Equations {
    constructor(evaluate, ranges) {
        this.evaluate = evaluate;
        this.widths = ranges.map(([low, high]) => high - low);
        this.out = new Float64Array(ranges.length * (ranges.length + 1));
    }

    /** The unknowns at the root next to `start`, or why there is none. */
    solve(start, targets, settings) {
        const count = start.length;
        const unknowns = Float64Array.from(start);
        let before = Infinity;
        for (let iteration = 0; iteration < MOST_ITERATIONS; ++iteration) {
            this.evaluate(...unknowns, ...targets, ...settings, this.out);
            const worst = this.worstResidual(count);
            const isRoot = this.isRoot(unknowns);
            // below the tolerance it goes on while it pays: the floor is the rounding of the residuals
            if (isRoot && (worst === 0 || worst > 0.5 * before)) return { unknowns, residual: worst };
            if (!Number.isFinite(worst)) return { why: "not_converged" };
            const step = this.step(count);
            if (!step) return { why: "singular" };
            if (iteration === 0 && step.some((by, k) => Math.abs(by) > LONGEST_STEP * this.widths[k])) {
                return { why: "not_converged" };
            }
            step.forEach((by, k) => (unknowns[k] += by));
            before = worst;
        }
        this.evaluate(...unknowns, ...targets, ...settings, this.out);
        return this.isRoot(unknowns) ? { unknowns, residual: this.worstResidual(count) } : { why: "not_converged" };
    }

    worstResidual(count) {
        let worst = 0;
        for (let row = 0; row < count; ++row) {
            const residual = Math.abs(this.out[row]);
            if (!(residual <= worst)) worst = residual;
        }
        return worst;
    }

    isRoot(unknowns) {
        const count = unknowns.length;
        for (let row = 0; row < count; ++row) {
            let size = 0;
            for (let k = 0; k < count; ++k) {
                size += Math.abs(this.out[count * (1 + row) + k]) * Math.max(Math.abs(unknowns[k]), 1);
            }
            const tolerance = Math.min(Math.max(OF_SIZE * size, TOLERANCE), LARGEST_TOLERANCE);
            if (!(Math.abs(this.out[row]) <= tolerance)) return false;
        }
        return true;
    }

    /** −J⁻¹F by elimination with full pivoting; null where J has no inverse. */
    step(count) {
        const rows = Array.from({ length: count }, (_, i) => {
            const entries = this.widths.map((width, k) => this.out[count * (1 + i) + k] * width);
            const size = Math.max(...entries.map(Math.abs)) || 1;
            return [...entries.map((entry) => entry / size), -this.out[i] / size];
        });
        const order = this.widths.map((_, k) => k);
        for (let k = 0; k < count; ++k) {
            let [best, at, of] = [0, k, k];
            for (let i = k; i < count; ++i) {
                for (let j = k; j < count; ++j) {
                    if (Math.abs(rows[i][j]) > best) [best, at, of] = [Math.abs(rows[i][j]), i, j];
                }
            }
            if (!(best > SINGULAR_BELOW)) return null;
            [rows[k], rows[at]] = [rows[at], rows[k]];
            [order[k], order[of]] = [order[of], order[k]];
            rows.forEach((row) => ([row[k], row[of]] = [row[of], row[k]]));
            for (let i = k + 1; i < count; ++i) {
                const share = rows[i][k] / rows[k][k];
                for (let j = k; j <= count; ++j) rows[i][j] -= share * rows[k][j];
            }
        }
        const step = new Float64Array(count);
        for (let k = count - 1; k >= 0; --k) {
            let sum = rows[k][count];
            for (let j = k + 1; j < count; ++j) sum -= rows[k][j] * step[order[j]] / this.widths[order[j]];
            step[order[k]] = sum / rows[k][k] * this.widths[order[k]];
        }
        return step;
    }
}

/**
 * The root that a point's own root moves to while the settings go from the job's own values to those wanted, and with them what it is
 * asked for by: `targets(share)` of that way.
 */
export function follow(equations, own, targets, settings) {
    let unknowns = own;
    let [reached, share] = [0, 1];
    for (;;) {
        const next = Math.min(1, reached + share);
        const found = equations.solve(unknowns, targets(next), settings.between(next));
        if (found.unknowns && next === 1) return found;
        if (found.unknowns) {
            [unknowns, reached] = [found.unknowns, next];
        } else {
            share /= 2;
            if (share < SHORTEST_SHARE) return found;
        }
    }
}
