// Points as things that can be drawn.

import { INK, components } from "./colours.js";
import { toolMaterial, workMaterial } from "./shading.js";

/** Motions of which the contact is shown. */
const MOST_MOTIONS = 4;

/** A surface of the work, which can be cut, coloured and clicked. */
export class WorkMesh {
    constructor(surface, colour, shared) {
        this.surface = surface;
        const { contact, unknowns } = surface.data;
        this.motions = contact.slice(0, MOST_MOTIONS).map((k) => ({ k, motion: unknowns[k].motion }));
        const used = [0, 1, 2, 3].map((k) => (k < this.motions.length ? 1 : 0));
        this.now = { value: [0, 0, 0, 0] };
        const own = { ...shared, now: this.now };
        this.object = new THREE.Mesh(new THREE.BufferGeometry(), workMaterial(own, components(colour), used));
        this.object.userData.mesh = this;
        const ink = surface.data.rows.count > 1 && surface.data.columns.count > 1 ? INK : colour;
        this.outline = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: ink }));
        this.outline.userData.mesh = this;
        this.object.add(this.outline);
        this.rebuild();
    }

    /** Takes the surface's points as they are now. */
    rebuild() {
        const { surface } = this;
        const geometry = new THREE.BufferGeometry();
        const attribute = (values, width) => new THREE.BufferAttribute(Float32Array.from(values), width);
        const motion = new Float32Array(4 * surface.count);
        for (let point = 0; point < surface.count; ++point) {
            this.motions.forEach(({ k }, place) => (motion[4 * point + place] = surface.unknown(point, k)));
        }
        geometry.setAttribute("position", new THREE.BufferAttribute(filled(surface.positions), 3));
        geometry.setAttribute("normal", attribute(surface.normals, 3));
        geometry.setAttribute("motion", new THREE.BufferAttribute(motion, 4));
        const triangles = surface.triangles();
        geometry.setIndex(triangles);
        this.object.geometry.dispose();
        this.object.geometry = geometry;
        this.outline.geometry.dispose();
        this.outline.geometry = new THREE.BufferGeometry();
        this.outline.geometry.setAttribute("position", geometry.getAttribute("position"));
        this.outline.geometry.setIndex([...bordersOf(triangles), ...surface.pieces()]);
        this.colour(null);
    }

    /** The values to colour by; without any, grey where colours are on. */
    colour(quantity) {
        const { surface } = this;
        const values = new Float32Array(surface.count);
        const known = new Float32Array(surface.count);
        for (let point = 0; point < surface.count; ++point) {
            const value = quantity && !quantity.isOwn && surface.isSolved(point) ? quantity.at(point) : NaN;
            known[point] = Number.isFinite(value) ? 1 : 0;
            values[point] = known[point] ? value : 0;
        }
        this.object.geometry.setAttribute("quantity", new THREE.BufferAttribute(values, 1));
        this.object.geometry.setAttribute("known", new THREE.BufferAttribute(known, 1));
    }

    move(motions) {
        this.now.value = [0, 1, 2, 3].map((k) => (k < this.motions.length ? motions[this.motions[k].motion] : 0));
    }

    /** What a click can hit: the surface, or the line that it is. */
    get target() {
        return this.object.geometry.index.count > 0 ? this.object : this.outline;
    }

    /** The solved point of the grid nearest to where a ray met the surface. */
    pointAt(hit) {
        const place = this.object.worldToLocal(hit.point.clone());
        const ends = () => [0, 1].map((k) => this.outline.geometry.index.getX(hit.index + k));
        const corners = hit.face ? [hit.face.a, hit.face.b, hit.face.c] : ends();
        const away = (point) => place.distanceTo(new THREE.Vector3(...this.surface.vector(this.surface.positions, point)));
        return corners.reduce((best, point) => (away(point) < away(best) ? point : best));
    }
}

/** Points that are not there, and belong to no triangle, lie on the first that is: else no box around all would be right. */
function filled(positions) {
    const first = Math.max(positions.findIndex(Number.isFinite), 0);
    const place = [0, 1, 2].map((k) => (Number.isFinite(positions[first + k]) ? positions[first + k] : 0));
    return Float32Array.from(positions, (x, k) => (Number.isFinite(x) ? x : place[k % 3]));
}

/** The ends of the sides that belong to one triangle only. */
function bordersOf(triangles) {
    const sides = new Map();
    for (let at = 0; at < triangles.length; at += 3) {
        for (const [k, l] of [[0, 1], [1, 2], [2, 0]]) {
            const [a, b] = [triangles[at + k], triangles[at + l]];
            const key = a < b ? `${a} ${b}` : `${b} ${a}`;
            if (!sides.delete(key)) sides.set(key, [a, b]);
        }
    }
    return [...sides.values()].flat();
}

/** Positions of a grid of values, NaN where there is none. */
function gridOf(evaluate, u, v) {
    const positions = new Float32Array(3 * u.length * v.length);
    const out = new Float64Array(3);
    u.forEach((a, i) => v.forEach((b, j) => {
        evaluate(a, b, out);
        positions.set(out, 3 * (i * v.length + j));
    }));
    return positions;
}

export function indices(rows, columns, isThere) {
    const corners = [];
    for (let i = 0; i + 1 < rows; ++i) {
        for (let j = 0; j + 1 < columns; ++j) {
            const a = i * columns + j;
            for (const triangle of [[a, a + 1, a + columns + 1], [a, a + columns + 1, a + columns]]) {
                if (triangle.every(isThere)) corners.push(...triangle);
            }
        }
    }
    return corners;
}

export function meshOf(positions, rows, columns, material) {
    const isThere = (point) => Number.isFinite(positions[3 * point]);
    const triangles = indices(rows, columns, isThere);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(filled(positions), 3));
    geometry.setIndex(triangles);
    geometry.computeVertexNormals();
    const mesh = new THREE.Mesh(geometry, material);
    const outline = new THREE.BufferGeometry();
    outline.setAttribute("position", geometry.getAttribute("position"));
    outline.setIndex(bordersOf(triangles));
    mesh.add(new THREE.LineSegments(outline, new THREE.LineBasicMaterial({ color: INK, transparent: true, opacity: 0.45 })));
    mesh.renderOrder = 1;
    return mesh;
}

/** A polyline. */
export function lineOf(positions, colour, opacity = 1) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(positions), 3));
    const material = new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
    return new THREE.Line(geometry, material);
}

/** The tool's part, in the tool's frame. `contact(surface)` gives the points of the tool that touch a surface, by its number. */
export function toolObject(form, settings, functions, contact, look) {
    if (form.kind === "edge") {
        const evaluate = (a, b, out) => functions[form.position](a, ...settings.values, out);
        return lineOf(gridOf(evaluate, form.u, [0]), INK);
    }
    const material = toolMaterial(components(look.colour), look.opacity);
    if (form.kind === "contact") {
        const { positions, rows, columns } = contact(form.surface);
        return meshOf(positions, rows, columns, material);
    }
    const evaluate = (a, b, out) => functions[form.position](a, b, ...settings.values, out);
    // an axis of revolution is known for the job's own values only
    if (form.axis && !settings.areMoved) return revolved(evaluate, form, material);
    return meshOf(gridOf(evaluate, form.u, form.v), form.u.length, form.v.length, material);
}

const AROUND = 144;

/** A surface of revolution all around its axis, from its line in the middle of the parameter that runs around. */
function revolved(evaluate, { u, v, axis }, material) {
    const middle = (values) => [0.5 * (values[0] + values[values.length - 1])];
    const line = axis.around === 0 ? gridOf(evaluate, middle(u), v) : gridOf(evaluate, u, middle(v));
    const [through, direction] = [new THREE.Vector3(...axis.through), new THREE.Vector3(...axis.direction)];
    const count = line.length / 3;
    const positions = new Float32Array((AROUND + 1) * line.length);
    for (let turn = 0; turn <= AROUND; ++turn) {
        for (let k = 0; k < count; ++k) {
            const place = new THREE.Vector3(...line.subarray(3 * k, 3 * k + 3)).sub(through);
            place.applyAxisAngle(direction, (2 * Math.PI * turn) / AROUND).add(through);
            positions.set(place.toArray(), 3 * (turn * count + k));
        }
    }
    return meshOf(positions, AROUND + 1, count, material);
}

/** Circles about z through the corners of a surface, and the lines of revolution between them: the blank around it. */
export function blankOf(surface, colour) {
    const { rows, columns } = surface.data;
    const [r, c] = [rows.count, columns.count];
    const edge = [
        ...Array.from({ length: c }, (_, j) => j),
        ...Array.from({ length: r }, (_, i) => i * c + c - 1),
        ...Array.from({ length: c }, (_, j) => r * c - 1 - j),
        ...Array.from({ length: r }, (_, i) => (r - 1 - i) * c),
    ].filter((point) => surface.isSolved(point));
    const meridian = edge.map((point) => surface.vector(surface.positions, point)).map(([x, y, z]) => [Math.hypot(x, y), z]);
    const group = new THREE.Group();
    const turn = (k, of) => (2 * Math.PI * k) / of;
    for (const point of [0, c - 1, (r - 1) * c, r * c - 1].filter((corner) => surface.isSolved(corner))) {
        const [x, y, z] = surface.vector(surface.positions, point);
        const circle = Array.from({ length: 129 }, (_, k) => [Math.cos(turn(k, 128)), Math.sin(turn(k, 128))]);
        group.add(lineOf(circle.flatMap(([cos, sin]) => [cos * Math.hypot(x, y), sin * Math.hypot(x, y), z]), colour, 0.5));
    }
    for (let k = 0; k < 12; ++k) {
        const [cos, sin] = [Math.cos(turn(k, 12)), Math.sin(turn(k, 12))];
        group.add(lineOf(meridian.flatMap(([rho, z]) => [cos * rho, sin * rho, z]), colour, 0.25));
    }
    return group;
}

