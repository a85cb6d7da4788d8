// Whole gears: one tooth of a body, turned to all; without a body the surfaces of one space, turned the same way.

import { components } from "./colours.js";
import { indices } from "./meshes.js";
import { decoded } from "./numbers.js";
import { bodyMaterial } from "./shading.js";

const STEEL = [0.78, 0.8, 0.83];
const EDGE = 0x55585c;
/** Generated faces are so much paler than the surfaces that the program solved on them. */
const PALE = 0.55;

/** A group with all teeth of a body, in the frame of its work. */
function bodyObject(body, colours) {
    const geometry = toothOf(body, colours);
    const outline = new THREE.BufferGeometry();
    outline.setAttribute("position", geometry.getAttribute("position"));
    outline.setIndex(geometry.userData.borders);
    const [material, edge] = [bodyMaterial(), new THREE.LineBasicMaterial({ color: EDGE, transparent: true, opacity: 0.6 })];
    return turned(body.teeth, () => new THREE.Mesh(geometry, material).add(new THREE.LineSegments(outline, edge)));
}

/** The faces of one tooth as one geometry with colours. */
function toothOf(body, colours) {
    const [positions, normals, tints, triangles, borders] = [[], [], [], [], []];
    for (const { surface, counts: [rows, columns], ends, ...face } of body.faces) {
        const start = positions.length / 3;
        const own = decoded(face.positions);
        positions.push(...own);
        normals.push(...decoded(face.normals));
        const plain = surface === null ? STEEL : components(colours[surface % colours.length]).map((x) => x + PALE * (1 - x));
        for (let k = 0; k < rows * columns; ++k) tints.push(...plain);
        const corners = indices(rows, columns, () => true);
        triangles.push(...corners.map((corner) => start + corner));
        borders.push(...endsOf(rows, columns, ends).map((corner) => start + corner));
    }
    const geometry = new THREE.BufferGeometry();
    const attribute = (values) => new THREE.BufferAttribute(Float32Array.from(values), 3);
    geometry.setAttribute("position", attribute(positions));
    geometry.setAttribute("normal", attribute(normals));
    geometry.setAttribute("tint", attribute(tints));
    geometry.setIndex(triangles);
    geometry.userData.borders = borders;
    return geometry;
}

/** The ends of the sides of a grid's cells, where its face ends. */
function endsOf(rows, columns, [first, last, left, right]) {
    const [across, down] = [Array.from({ length: columns - 1 }, (_, j) => j), Array.from({ length: rows - 1 }, (_, i) => i * columns)];
    const row = (i) => across.flatMap((j) => [i * columns + j, i * columns + j + 1]);
    const column = (j) => down.flatMap((at) => [at + j, at + columns + j]);
    return [...(first ? row(0) : []), ...(last ? row(rows - 1) : []), ...(left ? column(0) : []), ...(right ? column(columns - 1) : [])];
}

/** As many of a thing as there are teeth, about z; without the first where it is there already. */
function turned(teeth, make, from = 0) {
    const group = new THREE.Group();
    for (let k = from; k < teeth; ++k) {
        const one = make();
        one.rotation.z = (2 * Math.PI * k) / teeth;
        group.add(one);
    }
    return group;
}

/** The surfaces of a space as they are now, in all spaces but their own. */
function spacesObject(body, meshes) {
    return turned(body.teeth, () => {
        const space = new THREE.Group();
        for (const mesh of meshes) {
            const outline = new THREE.LineSegments(mesh.outline.geometry, mesh.outline.material);
            space.add(new THREE.Mesh(mesh.object.geometry, mesh.object.material).add(outline));
        }
        return space;
    }, 1);
}

/** Hangs the bodies of the machine that is shown; they are those of the job's own values. */
export function hangBodies(page) {
    page.bodies?.forEach((body) => body.removeFromParent());
    const here = page.pair ? [] : page.data.bodies.filter(({ machine }) => machine === page.number);
    page.bodies = here.map((body) => {
        const isBody = body.faces.length > 0 && !page.settings.areMoved;
        const group = isBody ? bodyObject(body, page.data.colours) : spacesObject(body, body.surfaces.map((k) => page.meshes[k]));
        page.stage.frames[body.frame_index].add(group);
        return group;
    });
    showBodies(page);
}

/** A finished body says nothing about what is not yet cut. */
export function showBodies(page) {
    const isShown = page.bodyBox.checked && !page.shared.isCut.value;
    page.bodies.forEach((body) => (body.visible = isShown));
    page.stage.request();
}

/** From where the tooth space that was solved is seen on the whole gear, in the frame of its work: its first surface faces the eye. */
export function eyeOfBody({ directions: [along, tip], surfaces }, meshes) {
    const [x, y] = [tip, along].map(([x, y]) => [x, y]).find(([x, y]) => Math.hypot(x, y) > 0.05) ?? [1, 0];
    const size = Math.hypot(x, y);
    const side = tip[2] < -0.1 ? -1 : 1;
    const ways = [0.7, -0.7].map((turn) => {
        const [sin, cos] = [Math.sin(turn), Math.cos(turn)];
        return [(0.8 * (cos * x - sin * y)) / size, (0.8 * (sin * x + cos * y)) / size, 0.62 * side];
    });
    const normals = surfaces.slice(0, 1).flatMap((k) => [...meshes[k].surface.normals]);
    const facing = (way) => normals.reduce((sum, part, k) => sum + (Number.isFinite(part) ? part * way[k % 3] : 0), 0);
    return ways.reduce((best, way) => (facing(way) > facing(best) ? way : best));
}
