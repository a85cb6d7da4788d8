// What hangs on the frames of a machine beside the surfaces of the work.

import { byId } from "./controls.js";
import { blankOf, lineOf, toolObject } from "./meshes.js";
import { decoded } from "./numbers.js";

const FAINT = 0x707070;
const LOST = 0xbe0000;
const TOOL = "#7d90a3";
/** Where the eye stands if there is neither work nor tool. */
const NOTHING_SEEN_FROM = [0.8, 0.4, 0.5];

export function hangTools(page) {
    page.toolParts?.forEach((part) => part.removeFromParent());
    const contact = (surface) => touched(page, page.surfaces[surface]);
    const look = { colour: TOOL, opacity: page.toolOpacity };
    const here = page.data.tools.filter((tool) => tool.machine === page.number);
    page.toolParts = here.map((tool) => {
        const part = toolObject(tool.form, page.settings, page.functions, contact, look);
        part.visible = page.toolOpacity.value > 0;
        page.stage.frames[tool.frame].add(part);
        return part;
    });
}

/** The points of the tool, in its frame, that touch the points of a surface. */
function touched(page, surface) {
    const { data } = surface;
    const positions = new Float32Array(3 * surface.count).fill(NaN);
    for (let point = 0; point < surface.count; ++point) {
        if (!surface.isSolved(point)) continue;
        const motions = page.motionsOf(surface, point, page.data.motions.map(({ start }) => start));
        page.machine.move(motions, page.settings);
        const place = new THREE.Vector3(...surface.vector(surface.positions, point));
        place.applyMatrix4(page.machine.pose(data.frame_index)).applyMatrix4(page.machine.pose(data.tool_frame).invert());
        positions.set(place.toArray(), 3 * point);
    }
    page.machine.move(page.motions, page.settings);
    return { positions, rows: data.rows.count, columns: data.columns.count };
}

export function hangBlank(page) {
    page.blanks.forEach((blank) => blank.removeFromParent());
    const largest = (best, mesh) => (!best || mesh.surface.count > best.surface.count ? mesh : best);
    const meshes = page.pair ? page.pair.turned : [page.visible.reduce(largest, null)].filter(Boolean);
    page.blanks = meshes.map(({ surface }) => {
        const blank = blankOf(surface, FAINT);
        blank.visible = byId("blank").checked;
        page.groupOf(surface).add(blank);
        return blank;
    });
}

/** Lines such as those where a surface is trimmed; they hold for the job's own values. */
export function hangLines(page) {
    page.lines = [];
    const { name, frames } = page.machine.data;
    for (const line of page.data.lines) {
        const frame = frames.findIndex((one) => line.frame === `${name}.${one.name}`);
        const positions = decoded(line.positions);
        if (frame < 0) continue;
        const solved = positions.filter((_, k) => Number.isFinite(positions[k - (k % 3)]));
        const object = lineOf(solved, 0x000000);
        page.stage.frames[frame].add(object);
        page.lines.push(object);
    }
}

export function newMarker() {
    const geometry = new THREE.BufferGeometry();
    const arm = [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1];
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(arm), 3));
    const marker = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x000000, depthTest: false }));
    marker.renderOrder = 2;
    marker.visible = false;
    return marker;
}

/** A cross where the job's own values have a point that the moved ones have not. */
export function markLost(page) {
    page.lostMarks?.forEach((mark) => mark.removeFromParent());
    const arm = 0.03 * page.stage.size;
    page.lostMarks = page.visible.map(({ surface }) => {
        const positions = [];
        for (let point = 0; point < surface.count; ++point) {
            if (surface.own.status[point] !== 0 || surface.isSolved(point)) continue;
            const [x, y, z] = surface.vector(surface.own.positions, point);
            positions.push(x - arm, y, z, x + arm, y, z, x, y - arm, z, x, y + arm, z, x, y, z - arm, x, y, z + arm);
        }
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(positions), 3));
        const mark = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: LOST }));
        page.groupOf(surface).add(mark);
        return mark;
    });
}

/** The length of the frames' axes: so that they show beside the work, and beside a small part of a large work too. */
export function triadSize(page) {
    const points = page.visible.flatMap(({ surface }) => {
        const solved = Array.from({ length: surface.count }, (_, point) => point).filter((point) => surface.isSolved(point));
        return solved.map((point) => new THREE.Vector3(...surface.vector(surface.positions, point)));
    });
    if (points.length === 0) return sizeOfFrames(page.machine);
    const box = new THREE.Sphere().setFromPoints(points);
    const far = points.reduce((most, point) => Math.max(most, Math.hypot(point.x, point.y)), 0);
    // beside teeth in mesh they would hide what is looked at
    return (page.pair ? 0.4 : 1) * Math.max(0.5 * box.radius, 0.2 * far, 1e-3);
}

/** The same where a machine has frames only: a part of how far these lie apart. */
function sizeOfFrames(machine) {
    const places = machine.data.frames.map((_, k) => new THREE.Vector3().setFromMatrixPosition(machine.pose(k)));
    return 0.25 * new THREE.Sphere().setFromPoints(places).radius || 10;
}

/** The direction from which most is seen of the first surface's outer side, and tool and work lie least behind each other. */
export function eye(page) {
    const poses = page.machine.data.frames.map((_, k) => page.machine.pose(k));
    const [points, normals] = [[], []];
    for (const { surface } of page.visible) {
        const pose = poses[surface.data.frame_index];
        for (let point = 0; point < surface.count; point += 7) {
            if (!surface.isSolved(point)) continue;
            points.push(new THREE.Vector3(...surface.vector(surface.positions, point)).applyMatrix4(pose));
            if (surface !== page.visible[0].surface) continue;
            normals.push(new THREE.Vector3(...surface.vector(surface.normals, point)).transformDirection(pose));
        }
    }
    for (const part of page.toolParts) points.push(...verticesOf(part).map((place) => place.applyMatrix4(part.parent.matrix)));
    if (points.length === 0) return NOTHING_SEEN_FROM;
    const ways = [0.35, 0.7, 1.2].flatMap((height) => Array.from({ length: 16 }, (_, k) => {
        const turn = (k * Math.PI) / 8;
        return new THREE.Vector3(Math.cos(turn), Math.sin(turn), height).normalize();
    }));
    const facing = (way) => normals.reduce((sum, normal) => sum + Math.max(normal.dot(way), 0), 0) / Math.max(normals.length, 1);
    const areas = ways.map((way) => areaAcross(points, way));
    const most = Math.max(...areas);
    const merits = ways.map((way, k) => facing(way) + 0.4 * (areas[k] / most));
    return ways[merits.indexOf(Math.max(...merits))].toArray();
}

/** Some of the vertices of a thing. */
function verticesOf(part) {
    const positions = part.geometry.getAttribute("position");
    const every = Math.max(1, Math.floor(positions.count / 200));
    const places = [];
    for (let k = 0; k < positions.count; k += every) places.push(new THREE.Vector3().fromBufferAttribute(positions, k));
    return places;
}

/** The area that points spread over across a direction. */
function areaAcross(points, way) {
    const right = new THREE.Vector3(0, 0, 1).cross(way).normalize();
    const up = way.clone().cross(right);
    const spread = (along) => {
        const places = points.map((point) => point.dot(along));
        return Math.max(...places) - Math.min(...places);
    };
    return spread(right) * spread(up);
}
