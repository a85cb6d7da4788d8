// What is seen: the machine's frames with everything that hangs on them, the eye, the labels.

import { INK } from "./colours.js";
import { lineOf } from "./meshes.js";

const AXIS_COLOURS = [0xd55e00, 0x009e73, 0x0072b2];
/** A label is moved down until it is so many pixels free of those placed before it. */
const LABEL_GAP = 2;
/** How wide a letter is at most on average, pixels: labels are not measured, but kept apart and within the view. */
const LETTER = 7.6;
/** Frames nearer to each other, in pixels, have one label. */
const SAME_PLACE = 10;

export function newRenderer(canvas) {
    const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    // a look at each shader waits for the graphics processor
    renderer.debug.checkShaderErrors = false;
    return renderer;
}

export class Stage {
    constructor(canvas, layer, renderer) {
        this.canvas = canvas;
        this.layer = layer;
        this.renderer = renderer;
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.scene = new THREE.Scene();
        this.camera = new THREE.PerspectiveCamera(24, 1, 1, 1e5);
        this.camera.up.set(0, 0, 1);
        this.controls = new THREE.OrbitControls(this.camera, canvas);
        this.controls.addEventListener("change", () => this.request());
        this.world = new THREE.Group();
        this.world.matrixAutoUpdate = false;
        this.scene.add(this.world);
        this.frames = [];
        this.labels = [];
        this.isRequested = false;
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    }

    /** Shows a machine: a group for each frame, with axes of this length and its name. */
    show(machine, size) {
        this.world.clear();
        this.layer.replaceChildren();
        this.labels = [];
        this.machine = machine;
        this.size = size;
        this.frames = machine.data.frames.map(({ name }) => {
            const group = new THREE.Group();
            group.matrixAutoUpdate = false;
            this.world.add(group);
            const triad = new THREE.Group();
            triad.name = "triad";
            AXIS_COLOURS.forEach((colour, k) => {
                const arm = arrow(size, colour);
                arm.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), unit(k));
                triad.add(arm);
                this.label("xyz"[k], "axis", triad, unit(k).multiplyScalar(1.1 * size)).style.color =
                    `#${colour.toString(16).padStart(6, "0")}`;
            });
            this.label(name, "frame", triad, new THREE.Vector3(0, 0, 0));
            group.add(triad);
            return group;
        });
        this.joints = machine.data.joints.map(({ axis, is_rotary: isRotary }) => {
            const object = isRotary ? rotaryJoint(size) : linearJoint(size);
            this.world.add(object);
            const place = new THREE.Vector3(...(isRotary ? [0.62 * size, 0, 0] : [0, 0, 0.75 * size]));
            this.label(machine.data.axes[axis].name, "joint", object, place);
            return object;
        });
    }

    label(text, kind, object, place) {
        const element = document.createElement("span");
        element.className = kind;
        element.textContent = text;
        this.layer.append(element);
        this.labels.push({ element, text, kind, object, place });
        return element;
    }

    /** Puts everything where the machine has it, seen from one of its frames. */
    place(seenFrom) {
        const poses = this.frames.map((_, k) => this.machine.pose(k));
        this.world.matrix.copy(poses[seenFrom]).invert();
        this.frames.forEach((group, k) => group.matrix.copy(poses[k]));
        this.joints.forEach((object, k) => {
            const { point, direction } = this.machine.joint(k);
            object.position.copy(point);
            object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), direction);
        });
        this.world.matrixWorldNeedsUpdate = true;
        this.request();
    }

    /** Shows the axes of those frames, by their numbers, and the arrows of moving axes. */
    showFrames(isShown, areJointsShown) {
        this.frames.forEach((group, k) => (group.getObjectByName("triad").visible = isShown(k)));
        this.joints.forEach((object) => (object.visible = areJointsShown));
        this.request();
    }

    /** Brings the eye so far away that these things fill the view, or the frames if there are none; `towards` is where it then stands, if it is to turn. */
    fit(objects, towards) {
        const sphere = this.ball(objects) ?? this.ball(this.frames);
        if (!sphere) return;
        // the first picture is fitted before the observer has told its size
        const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
        if (width > 0 && height > 0) this.camera.aspect = width / height;
        const way = towards ?? this.camera.position.clone().sub(this.controls.target);
        const half = (Math.min(this.camera.fov, this.camera.fov * this.camera.aspect) * Math.PI) / 360;
        const distance = Math.max(sphere.radius, 1e-6) / Math.sin(half);
        this.controls.target.copy(sphere.center);
        this.camera.position.copy(sphere.center).addScaledVector(way.normalize(), distance);
        this.camera.near = distance / 200;
        this.camera.far = distance * 200;
        this.camera.updateProjectionMatrix();
        this.controls.update();
        this.request();
    }

    /** The ball around objects; nothing of none. */
    ball(objects) {
        this.scene.updateMatrixWorld(true);
        const points = objects.flatMap((object) => cornersOf(object));
        return points.length > 0 ? new THREE.Sphere().setFromPoints(points) : null;
    }

    /** The first of the objects under a place of the canvas, pixels. */
    under(x, y, objects) {
        this.camera.updateMatrixWorld();
        const { width, height } = this.canvas.getBoundingClientRect();
        const place = new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height);
        const ray = new THREE.Raycaster();
        ray.setFromCamera(place, this.camera);
        ray.params.Line.threshold = 0.02 * this.size;
        return ray.intersectObjects(objects, false)[0];
    }

    /** Where a point of an object is on the canvas, pixels. */
    pixel(object, position) {
        this.scene.updateMatrixWorld(true);
        // between two pictures the eye may have moved
        this.camera.updateMatrixWorld();
        const { width, height } = this.canvas.getBoundingClientRect();
        const seen = object.localToWorld(new THREE.Vector3(...position)).project(this.camera);
        return [((1 + seen.x) / 2) * width, ((1 - seen.y) / 2) * height, seen.z];
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
        if (width === 0 || height === 0) return;
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.draw();
    }

    request() {
        if (this.isRequested) return;
        this.isRequested = true;
        requestAnimationFrame(() => this.draw());
    }

    draw() {
        this.isRequested = false;
        this.renderer.render(this.scene, this.camera);
        this.placeLabels();
    }

    /** Frames at one place have one label; a letter that would stand on another label is left out, an axis moves down. */
    placeLabels() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const seen = this.labels.map((label) => {
            const [x, y, depth] = this.pixel(label.object, label.place.toArray());
            return { ...label, x, y, isSeen: isShown(label.object) && depth < 1 && x > 0 && x < width && y > 0 && y < height };
        });
        this.labels.forEach(({ element }) => (element.hidden = true));
        const placed = [];
        const put = (element, text, x, y, moves) => {
            const room = LETTER * text.length + 4;
            const box = { left: Math.max(Math.min(x + 4, width - room), 0), top: y - 7, width: room, height: 14 };
            for (let at = 0; at < placed.length; ++at) {
                if (!overlap(placed[at], box)) continue;
                if (!moves) return;
                box.top = placed[at].top + placed[at].height + LABEL_GAP;
                at = -1;
            }
            placed.push(box);
            element.hidden = false;
            element.textContent = text;
            element.style.transform = `translate(${box.left.toFixed(1)}px, ${box.top.toFixed(1)}px)`;
        };
        const groups = [];
        for (const one of seen.filter(({ kind, isSeen }) => kind === "frame" && isSeen)) {
            const same = groups.find(([first]) => Math.hypot(first.x - one.x, first.y - one.y) < SAME_PLACE);
            if (same) same.push(one);
            else groups.push([one]);
        }
        for (const [first, ...others] of groups) {
            put(first.element, [first, ...others].map(({ text }) => text).join(" · "), first.x, first.y, true);
        }
        for (const { element, text, kind, x, y } of seen.filter(({ kind, isSeen }) => kind !== "frame" && isSeen).reverse()) {
            put(element, text, x, y, kind === "joint");
        }
    }
}

function overlap(a, b) {
    return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;
}

function isShown(object) {
    for (let at = object; at; at = at.parent) if (!at.visible) return false;
    return true;
}

/** The corners of the box around a thing, in the world. */
function cornersOf(object) {
    const points = [];
    object.traverseVisible((part) => {
        if (!part.geometry || part.geometry.getAttribute("position").count === 0) return;
        if (part.isMesh && part.geometry.index?.count === 0) return;
        part.geometry.computeBoundingBox();
        const { min, max } = part.geometry.boundingBox;
        for (let k = 0; k < 8; ++k) {
            const corner = new THREE.Vector3(k & 1 ? min.x : max.x, k & 2 ? min.y : max.y, k & 4 ? min.z : max.z);
            points.push(part.localToWorld(corner));
        }
    });
    return points;
}

function unit(k) {
    return new THREE.Vector3(...[0, 1, 2].map((component) => Number(component === k)));
}

/** An arrow along y. */
function arrow(size, colour) {
    const material = new THREE.MeshBasicMaterial({ color: colour });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.012 * size, 0.012 * size, 0.86 * size, 8), material);
    shaft.position.y = 0.43 * size;
    const tip = new THREE.Mesh(new THREE.CylinderGeometry(0, 0.04 * size, 0.14 * size, 12), material);
    tip.position.y = 0.93 * size;
    return new THREE.Group().add(shaft, tip);
}

/** An arrow both ways along z. */
function linearJoint(size) {
    const [end, back, out] = [0.7 * size, 0.58 * size, 0.05 * size];
    const group = new THREE.Group();
    group.add(lineOf([0, 0, -end, 0, 0, end], INK));
    for (const side of [1, -1]) group.add(lineOf([out, 0, side * back, 0, 0, side * end, -out, 0, side * back], INK));
    return group;
}

/** An arrow around z. */
function rotaryJoint(size) {
    const radius = 0.5 * size;
    const place = (k) => [radius * Math.cos((k * Math.PI) / 24), radius * Math.sin((k * Math.PI) / 24), 0];
    const group = new THREE.Group();
    group.add(lineOf(Array.from({ length: 41 }, (_, k) => place(k)).flat(), INK));
    const [x, y] = place(40);
    const [along, out] = [0.12 * size, 0.05 * size];
    const [tx, ty] = [-y / radius, x / radius];
    const wing = (side) => [x - along * tx + (side * out * x) / radius, y - along * ty + (side * out * y) / radius, 0];
    group.add(lineOf([...wing(1), x, y, 0, ...wing(-1)], INK));
    return group;
}
