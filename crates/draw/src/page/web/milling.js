// A cutter on its passes over a surface of the work: pass and position by sliders.

import { components } from "./colours.js";
import { byId } from "./controls.js";
import { lineOf, meshOf } from "./meshes.js";
import { decoded, digits } from "./numbers.js";
import { Slider, element, table } from "./panel.js";
import { toolMaterial } from "./shading.js";

const CUTTER_CHORDS = 72;
const CUTTER_COLOUR = "#b07a1e";
const CUTTER_WAY = 0xd00000;
/** Seconds that a pass takes when it plays. */
const PASS_SECONDS = 6;

export class Mill {
    /** The milling of the page's data with this number. */
    constructor(page, number) {
        this.page = page;
        this.number = number;
        this.data = page.data.millings[number];
        for (const name of ["contacts", "poses", "values"]) this[name] = decoded(this.data[name]);
        this.flank = page.meshes[this.data.surface];
        [this.pass, this.position] = this.data.numbers.map((numbers) => Math.floor(numbers.length / 2));
        this.opacity = { value: 0.45 };
        this.describe();
    }

    /** Hangs the cutter and its way on what the milled surface hangs on. */
    hang() {
        const material = toolMaterial(components(CUTTER_COLOUR), this.opacity);
        this.cutter = new THREE.Group().add(...this.data.outline.map((line) => outlineTurned(decoded(line), material)));
        this.cutter.matrixAutoUpdate = false;
        this.way = lineOf([], CUTTER_WAY);
        // after the teeth, and seen through them
        this.way.material.transparent = true;
        this.way.material.depthTest = false;
        this.way.renderOrder = 3;
        this.object = new THREE.Group().add(this.cutter, this.way);
        this.page.groupOf(this.flank.surface).add(this.object);
        this.update();
    }

    /** The place of the position among all that are shown. */
    get at() {
        return this.pass * this.data.numbers[1].length + this.position;
    }

    /** Brings the cutter to where both sliders stand. */
    update() {
        const { data, at } = this;
        const [x, y, z, ...axis] = this.poses.subarray(6 * at, 6 * at + 6);
        const a = new THREE.Vector3(...axis);
        // its own turn is not seen
        const u = new THREE.Vector3(Math.abs(a.x) < 0.7 ? 1 : 0, Math.abs(a.x) < 0.7 ? 0 : 1, 0).cross(a).normalize();
        const v = a.clone().cross(u);
        this.cutter.matrix.set(u.x, v.x, a.x, x, u.y, v.y, a.y, y, u.z, v.z, a.z, z, 0, 0, 0, 1);
        this.cutter.matrixWorldNeedsUpdate = true;
        const count = data.numbers[1].length;
        const way = this.contacts.subarray(3 * this.pass * count, 3 * (this.pass + 1) * count);
        this.way.geometry.dispose();
        this.way.geometry = new THREE.BufferGeometry();
        this.way.geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(way), 3));
        // a milling is that of the job's own values
        this.object.visible = this.box.checked && !this.page.settings.areMoved;
        this.sliders.forEach((slider, k) => slider.set([this.pass, this.position][k] + 1));
        this.now.replaceChildren(...this.told());
        this.page.stage.request();
    }

    told() {
        const { data, page, at } = this;
        if (page.settings.areMoved) {
            return [element("p", { className: "hint", textContent: "The passes are those of the job's own values: they are not planned anew in the page." })];
        }
        const of = (k) => `${data.numbers[k][[this.pass, this.position][k]]} of ${data.counts[k]}`;
        const width = data.columns.length;
        const value = ({ unit }, k) => `${digits(this.values[width * at + k], 7)} ${unit}`.trim();
        return [table([["pass", of(0)], ["position", of(1)], ...data.columns.map((column, k) => [column.name, value(column, k)])])];
    }

    move(k, shown) {
        if (k === 0) this.pass = shown - 1;
        else this.position = shown - 1;
        this.update();
    }

    /** Writes the section of the milling beside the view. */
    describe() {
        const { page, data } = this;
        this.now = element("div", { id: "cut-now" });
        const parts = [element("h2", { textContent: "Milling" })];
        if (page.data.millings.length > 1) {
            const choice = element("select", { id: "milling-choice" });
            choice.append(...page.data.millings.map(({ name }, k) => new Option(name, k)));
            choice.value = this.number;
            choice.addEventListener("change", () => page.showMilling(Number(choice.value)));
            parts.push(element("label", { className: "choice" }, element("span", { textContent: "milling" }), choice));
        }
        this.box = element("input", { type: "checkbox", id: "cutter", checked: true });
        this.box.addEventListener("change", () => this.update());
        this.sliders = ["pass", "position"].map((name, k) => {
            const high = data.numbers[k].length;
            return new Slider({ name, unit: "1", low: 1, high, limits: [1, high], isCount: true }, (value) => this.move(k, Math.round(value)));
        });
        const play = element("button", { className: "play", textContent: "▶", title: "play the pass", type: "button" });
        play.addEventListener("click", () => this.play(play));
        this.sliders[1].row.append(play);
        const fit = element("button", { textContent: "Fit milled flank", type: "button", id: "fit-milled" });
        fit.addEventListener("click", () => page.stage.fit([this.flank.object], this.eye()));
        parts.push(
            element("p", { className: "hint", textContent: `${data.name}: ${this.flank.surface.name} with ${data.cutter}` }),
            element("label", { className: "choice" }, this.box, "cutter"),
            ...this.sliders.map((slider) => slider.row),
            this.now, fit,
        );
        byId("milling").replaceChildren(...parts);
    }

    play(button) {
        this.playing = !this.playing;
        button.textContent = this.playing ? "■" : "▶";
        const count = this.data.numbers[1].length;
        const begin = performance.now() - (1000 * PASS_SECONDS * this.position) / count;
        const tick = (time) => {
            if (!this.playing || this.page.mill !== this) return;
            const position = Math.floor(((Math.max(time - begin, 0) / 1000 / PASS_SECONDS) * count) % count);
            if (position !== this.position) this.move(1, position + 1);
            requestAnimationFrame(tick);
        };
        requestAnimationFrame(tick);
    }

    /** From the outer side of the flank, in the root frame. */
    eye() {
        const { surface } = this.flank;
        const middle = Math.floor(surface.count / 2);
        const frame = this.page.pair?.frameOf(surface) ?? surface.data.frame_index;
        const normal = new THREE.Vector3(...surface.vector(surface.normals, middle));
        const axis = new THREE.Vector3(...this.poses.subarray(6 * this.at + 3, 6 * this.at + 6));
        return normal.add(axis).transformDirection(this.page.machine.pose(frame));
    }
}

/** A line of distances from the axis and heights, turned about z. */
function outlineTurned(line, material) {
    const count = line.length / 2;
    const positions = new Float32Array(3 * (CUTTER_CHORDS + 1) * count);
    for (let turn = 0; turn <= CUTTER_CHORDS; ++turn) {
        const [cos, sin] = [Math.cos((2 * Math.PI * turn) / CUTTER_CHORDS), Math.sin((2 * Math.PI * turn) / CUTTER_CHORDS)];
        for (let k = 0; k < count; ++k) {
            const [rho, z] = line.subarray(2 * k, 2 * k + 2);
            positions.set([rho * cos, rho * sin, z], 3 * (turn * count + k));
        }
    }
    return meshOf(positions, CUTTER_CHORDS + 1, count, material);
}
