// Two members that roll on each other: where the program found them to touch, position by position.

import { byId } from "./controls.js";
import { mixed } from "./colours.js";
import { ErrorChart, FlankMap } from "./flat.js";
import { lineOf } from "./meshes.js";
import { decoded, digits, inUnit, withUnit } from "./numbers.js";
import { element, table } from "./panel.js";

/** Teeth to each side of the one that touches. */
const BESIDE = 2;
/** Gaps are coloured up to so many films: the pattern is to be seen. */
const FILMS = 5;
const TOUCH = 0xd00000;
const SIDES = 64;

export class Pair {
    /** The contact of the page's data with this number. */
    constructor(page, number) {
        this.page = page;
        this.number = number;
        const data = page.data.contacts[number];
        this.data = data;
        [this.roll, this.lag] = data.motions;
        for (const name of ["rolls", "lags", "errors", "apart", "positions", "normals", "ellipses"]) this[name] = decoded(data[name]);
        this.flanks = data.members.map(({ flank }) => page.meshes[flank]);
        this.owner = new Map(data.members.flatMap((member, k) => member.surfaces.map((surface) => [page.surfaces[surface], k])));
        this.meshes = page.meshes.filter(({ surface }) => this.owner.has(surface));
        this.describe();
    }

    get isFound() {
        return this.data.count > 0;
    }

    /** The colours of gaps end here. */
    get range() {
        return { low: 0, high: FILMS * this.data.film };
    }

    /** The flanks of those members that are known to be turned about z. */
    get turned() {
        return this.flanks.filter((_, k) => this.data.members[k].pitch !== null);
    }

    /** The frame of the pair's machine that a surface is mounted on. */
    frameOf(surface) {
        return this.data.members[this.owner.get(surface)].frame;
    }

    groupOf(surface) {
        return this.groups[this.owner.get(surface)];
    }

    /** Hangs both members on their frames, each with some teeth of its solid, and what shows the contact on the machine. */
    hang() {
        const { stage } = this.page;
        this.copies = [];
        this.groups = this.data.members.map(({ frame, pitch, tooth }, k) => {
            const group = new THREE.Group();
            group.rotation.z = tooth * (pitch ?? 0);
            stage.frames[frame].add(group);
            const most = pitch ? Math.min(BESIDE, Math.floor((Math.round((2 * Math.PI) / pitch) - 1) / 2)) : 0;
            for (let by = -most; by <= most; ++by) {
                if (by === 0) continue;
                const tooth = new THREE.Group();
                tooth.rotation.z = by * pitch;
                group.add(tooth);
                for (const mesh of this.meshes.filter(({ surface }) => this.owner.get(surface) === k)) {
                    const object = new THREE.Mesh(mesh.object.geometry, mesh.object.material);
                    const outline = new THREE.LineSegments(mesh.outline.geometry, mesh.outline.material);
                    object.add(outline);
                    tooth.add(object);
                    this.copies.push({ mesh, object, outline });
                }
            }
            return group;
        });
        this.size = 0.3 * stage.size;
        this.ellipse = lineOf([], TOUCH);
        this.normal = lineOf([], TOUCH);
        const radius = 0.12 * this.size;
        const material = (opacity) => new THREE.MeshBasicMaterial({ color: TOUCH, side: THREE.DoubleSide, transparent: true, opacity });
        // three discs, of which one at least is seen from anywhere
        const discs = [0, 1, 2].map(() => new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, 0.1 * radius, 24), material(1)));
        discs[1].rotation.x = Math.PI / 2;
        discs[2].rotation.z = Math.PI / 2;
        this.point = new THREE.Group().add(...discs);
        this.film = new THREE.Mesh(new THREE.BufferGeometry(), material(0.35));
        this.touch = new THREE.Group().add(this.film, this.ellipse, this.normal, this.point);
        for (const part of [this.film, this.ellipse, this.normal, ...discs]) {
            // after the teeth, and seen through them
            part.material.transparent = true;
            part.material.depthTest = false;
            part.renderOrder = 3;
        }
        stage.frames[0].add(this.touch);
        this.slider();
    }

    /** The slider of the roll goes from one solved position to the next. */
    slider() {
        if (!this.isFound) return;
        const { rolls } = this;
        const { unit } = this.page.data.motions[this.roll];
        const [low, high] = [rolls[0], rolls[rolls.length - 1]].map((roll) => inUnit(unit, roll));
        const step = (high - low) / Math.max(rolls.length - 1, 1);
        this.page.motionSliders[this.roll].stretch(low, high + 1e-6 * step, step);
    }

    /** All teeth that are seen. */
    get teeth() {
        return [...this.meshes.map((mesh) => mesh.object), ...this.copies.map(({ object }) => object)].filter(({ visible }) => visible);
    }

    /** Copies of teeth look as the teeth that they are copies of. */
    follow() {
        for (const { mesh, object, outline } of this.copies) {
            [object.geometry, outline.geometry] = [mesh.object.geometry, mesh.outline.geometry];
            object.visible = mesh.object.visible;
        }
    }

    /** The solved position nearest to a roll position. */
    nearest(roll) {
        let best = 0;
        this.rolls.forEach((at, k) => (best = Math.abs(at - roll) < Math.abs(this.rolls[best] - roll) ? k : best));
        return best;
    }

    /** The motions at the solved position nearest to a roll position. */
    rolledTo(roll, motions) {
        const moved = [...motions];
        const index = this.nearest(roll);
        [moved[this.roll], moved[this.lag]] = [this.rolls[index], this.lags[index]];
        return moved;
    }

    /** The solved position at which the machine stands; `null` where it stands at none, or a parameter is moved. */
    standing() {
        const { motions, settings } = this.page;
        if (!this.isFound || settings.areMoved) return null;
        const index = this.nearest(motions[this.roll]);
        return motions[this.roll] === this.rolls[index] && motions[this.lag] === this.lags[index] ? index : null;
    }

    /** Where the machine stands now: point, normal and ellipse, the marks on the maps, and the numbers. */
    update() {
        const index = this.standing();
        this.touch.visible = index !== null;
        if (index !== null) this.place(index);
        [...this.maps, ...this.charts].forEach((one) => one.show(index));
        this.now.replaceChildren(...this.told(index));
    }

    place(index) {
        const of = (values, at = 3 * index) => new THREE.Vector3(...values.subarray(at, at + 3));
        const [point, normal] = [of(this.positions), of(this.normals)];
        const arm = (way, from, to) => [from, to].flatMap((by) => point.clone().addScaledVector(way, by).toArray());
        put(this.normal, arm(normal, -2.5 * this.size, 2.5 * this.size));
        this.point.position.copy(point);
        const [long, short] = [of(this.ellipses, 6 * index), of(this.ellipses, 6 * index + 3)];
        const around = Number.isFinite(long.x) ? Array.from({ length: SIDES + 1 }, (_, k) => (2 * Math.PI * k) / SIDES) : [];
        const places = around.map((turn) => point.clone().addScaledVector(long, Math.cos(turn)).addScaledVector(short, Math.sin(turn)));
        put(this.ellipse, places.flatMap((place) => place.toArray()));
        put(this.film, places.slice(1).flatMap((place, k) => [point, places[k], place].flatMap((corner) => corner.toArray())));
    }

    /** The numbers of a position. */
    told(index) {
        const { data, page } = this;
        if (!this.isFound) return [element("p", { className: "warning", textContent: data.refused })];
        if (page.settings.areMoved) {
            return [element("p", { className: "hint", textContent: "The contact is that of the job's own values: it is not solved anew in the page." })];
        }
        if (index === null) {
            return [element("p", { className: "hint", textContent: `No contact: ${page.data.motions[this.lag].name} is moved by hand.` })];
        }
        const motion = (k) => page.data.motions[k];
        const error = (value) => `${digits(value, 4)} ${data.error_unit}`;
        const apart = this.apart[index];
        const lengths = [0, 3].map((at) => Math.hypot(...this.ellipses.subarray(6 * index + at, 6 * index + at + 3)));
        const film = `within ${digits(data.film, 4)} um`;
        return [table([
            [motion(this.roll).name, withUnit(motion(this.roll).unit, this.rolls[index], 7)],
            [motion(this.lag).name, withUnit(motion(this.lag).unit, this.lags[index], 7)],
            ["error", error(this.errors[2 * index]), "of the pair of teeth that carries, against the middle"],
            ["touches", data.edges[index] || "flank on flank", "this pair of teeth"],
            ...(apart > 0 ? [["another pair carries", `${digits(apart, 3)} um apart`, "this pair, along its normal"]] : []),
            ...(Number.isFinite(lengths[0]) ? [["half axes", `${lengths.map((length) => digits(length, 3)).join(" x ")} mm`, film]] : []),
        ])];
    }

    /** Writes the section of the contact beside the view. */
    describe() {
        const { page, data } = this;
        this.now = element("div", { id: "touch" });
        [this.maps, this.charts] = [[], []];
        const parts = [element("h2", { textContent: "Contact" })];
        if (page.data.contacts.length > 1) {
            const choice = element("select", { id: "contact-choice" });
            choice.append(...page.data.contacts.map(({ name }, k) => new Option(name, k)));
            choice.value = this.number;
            choice.addEventListener("change", () => page.showContact(Number(choice.value)));
            parts.push(element("label", { className: "choice" }, element("span", { textContent: "contact" }), choice));
        }
        const about = [...(page.data.contacts.length > 1 ? [] : [data.name]), ...(data.kind ? [data.kind] : [])].join(", ");
        parts.push(element("p", { className: "hint", textContent: about }), this.now);
        if (this.isFound) parts.push(...this.drawings(), table(data.numbers.map(({ name, value, unit }) => [name, `${digits(value, 4)} ${unit}`])));
        byId("contact").replaceChildren(...parts);
    }

    drawings() {
        const { page, data } = this;
        const colour = (gap) => mixed(page.data.scale, gap / this.range.high);
        this.maps = data.maps.map((map, k) => {
            const { surface } = this.flanks[k];
            const gaps = surface.fields.find(({ name }) => name === data.gap).values;
            const { rows, columns } = surface.data;
            return new FlankMap({
                name: surface.name, rows: rows.count, columns: columns.count, nodes: decoded(map.nodes), sides: map.sides,
                touches: decoded(map.touches), onFlank: data.edges.map((edges) => edges === ""), gaps, film: data.film, colour,
            });
        });
        const { name, unit } = page.data.motions[this.roll];
        this.charts = [new ErrorChart({ rolls: this.rolls, errors: this.errors, over: name, unit, error_unit: data.error_unit })];
        const about = `Least gap over the mesh; dark line: the compound of ${digits(data.film, 4)} um is pressed away within; red: the path.`;
        return [
            ...this.maps.flatMap((map, k) => [element("div", { className: "flank", textContent: this.flanks[k].surface.name }), map.element]),
            element("p", { className: "hint", textContent: about }),
            this.charts[0].element,
        ];
    }

    /** Along the teeth, and a little from beside and above: where one sees them mesh. */
    eye() {
        const { surface } = this.flanks[0];
        const { rows, columns } = surface.data;
        const row = Math.floor(rows.count / 2) * columns.count;
        const solved = Array.from({ length: columns.count }, (_, k) => row + k).filter((point) => surface.isSolved(point));
        if (solved.length < 2) return [1, 1, 1];
        const pose = this.page.machine.pose(this.frameOf(surface));
        const at = (point, values) => new THREE.Vector3(...surface.vector(values, point));
        const [first, last] = [solved[0], solved[solved.length - 1]];
        const along = at(last, surface.positions).sub(at(first, surface.positions)).transformDirection(pose);
        const normal = at(solved[Math.floor(solved.length / 2)], surface.normals).transformDirection(pose);
        return along.addScaledVector(normal.clone().cross(along), 0.35).addScaledVector(normal, 0.2).toArray();
    }
}

function put(line, positions) {
    line.geometry.dispose();
    line.geometry = new THREE.BufferGeometry();
    line.geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(positions), 3));
}
