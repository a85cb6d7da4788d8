// The numbers that the job was made with. Those moved by hand stand where they are put; all others follow their definitions.

export class Settings {
    /** `definitions(...values, out)` gives each parameter's value as the spec defines it by earlier ones. */
    constructor(parameters, definitions) {
        this.parameters = parameters;
        this.definitions = definitions;
        this.own = Float64Array.from(parameters, (parameter) => parameter.value);
        this.byHand = new Map();
        this.values = this.own.slice();
    }

    get areMoved() {
        return this.byHand.size > 0;
    }

    /** Puts one parameter, by its index, somewhere; at its own value it follows its definition again. */
    move(index, value) {
        if (value === this.own[index]) this.byHand.delete(index);
        else this.byHand.set(index, value);
        this.follow();
    }

    reset() {
        this.byHand.clear();
        this.follow();
    }

    follow() {
        this.values = this.own.slice();
        if (!this.areMoved) return;
        const defined = new Float64Array(this.values.length);
        // a definition depends on earlier ones only: after as many rounds as there are parameters all have followed
        for (let round = 0, changed = true; changed && round < this.values.length; ++round) {
            this.definitions(...this.values, defined);
            const next = defined.map((value, k) => this.byHand.get(k) ?? this.settled(k, value));
            changed = next.some((value, k) => value !== this.values[k]);
            this.values = next;
        }
    }

    /** Rounding alone is no change. */
    settled(index, value) {
        const own = this.own[index];
        return Math.abs(value - own) <= 1e-14 * Math.abs(own) ? own : value;
    }

    /** The values a share of the way from the job's own to those wanted. */
    between(share) {
        return share === 1 ? this.values : this.own.map((own, k) => own + share * (this.values[k] - own));
    }
}
