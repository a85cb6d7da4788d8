// The page as a whole: what happens when something is moved, chosen or clicked.

import { eyeOfBody, hangBodies, showBodies } from "./body.js";
import { components, drawLegend, isSigned, rangeOf } from "./colours.js";
import { buildAbout, buildChoices, buildHeader, buildMotions, buildParameters, byId, listFrames, listQuantities, listSurfaces, listen, tellState } from "./controls.js";
import { eye, hangBlank, hangLines, hangTools, markLost, newMarker, triadSize } from "./hanging.js";
import { Machine } from "./machine.js";
import { WorkMesh } from "./meshes.js";
import { Mill } from "./milling.js";
import { withUnit } from "./numbers.js";
import { element, pointRows, table } from "./panel.js";
import { Pair } from "./pair.js";
import { Settings } from "./settings.js";
import { newRenderer, Stage } from "./stage.js";
import { WorkSurface } from "./surface.js";

const LINE = "#e6007e";
/** Where a machine has more frames, only those of tools and work are shown at first. */
const MOST_FRAMES = 6;
/** No point is generated there: members in mesh are finished. */
const NOWHERE = 1e9;

class Page {
    constructor(data, functions, renderer) {
        this.data = data;
        this.functions = functions;
        this.settings = new Settings(data.parameters, functions[data.definitions]);
        this.motions = data.motions.map((motion) => motion.start);
        this.surfaces = data.surfaces.map((surface) => new WorkSurface(surface, functions));
        this.machines = data.machines.map((machine) => new Machine(machine, functions));
        this.shared = {
            scale: { value: data.scale.map((hex) => new THREE.Vector3(...components(hex))) },
            range: { value: new THREE.Vector2(0, 1) },
            isColoured: { value: false },
            isCut: { value: false },
            lineColour: { value: components(LINE) },
        };
        this.toolOpacity = { value: 0.2 };
        this.meshes = this.surfaces.map(
            (surface, k) => new WorkMesh(surface, data.colours[k % data.colours.length], this.shared),
        );
        this.stage = new Stage(byId("canvas"), byId("labels"), renderer);
        this.quantity = "";
        this.selected = null;
        buildHeader(this);
        buildMotions(this);
        buildChoices(this);
        buildParameters(this);
        buildAbout(this);
        listen(this);
        // of several contacts the first one that was found
        const found = data.contacts.findIndex(({ count }) => count > 0);
        if (data.contacts.length > 0) this.showContact(Math.max(found, 0));
        else this.showMachine(data.surfaces[0].machine);
    }

    showContact(number) {
        this.contact = number;
        this.showMachine(this.data.contacts[number].machine);
    }

    /** The contact that is shown on a machine: the one that was chosen last, or its first. */
    pairOn(number) {
        const on = this.data.contacts.flatMap(({ machine }, k) => (machine === number ? [k] : []));
        const shown = on.includes(this.contact) ? this.contact : on[0];
        return shown === undefined ? null : new Pair(this, shown);
    }

    showMilling(number) {
        this.milling = number;
        this.mill?.object?.removeFromParent();
        this.mill = this.millOn(this.number);
        this.mill.hang();
    }

    /** The milling of a surface on a machine: the one that was chosen last, or the first. */
    millOn(number) {
        const isOn = ({ surface }) => this.visible.includes(this.meshes[surface]) && (this.pair || this.surfaces[surface].data.machine === number);
        const on = this.data.millings.flatMap((milling, k) => (isOn(milling) ? [k] : []));
        const shown = on.includes(this.milling) ? this.milling : on[0];
        return shown === undefined ? null : new Mill(this, shown);
    }

    /** What a surface hangs on. */
    groupOf(surface) {
        return this.pair ? this.pair.groupOf(surface) : this.stage.frames[surface.data.frame_index];
    }

    /** Builds everything that hangs on the frames of one machine. */
    showMachine(number) {
        this.number = number;
        if (byId("machine")) byId("machine").value = number;
        this.machine = this.machines[number];
        this.pair = this.pairOn(number);
        byId("contact").hidden = !this.pair;
        if (this.pair?.isFound) {
            this.motions = this.pair.rolledTo(this.motions[this.pair.roll], this.motions);
            this.quantity = this.pair.data.gap;
        }
        this.machine.move(this.motions, this.settings);
        this.visible = this.pair?.meshes ?? this.meshes.filter((mesh) => mesh.surface.data.machine === number);
        this.stage.show(this.machine, triadSize(this));
        this.marker = newMarker();
        this.blanks = [];
        this.pair?.hang();
        this.motions.forEach((value, k) => this.motionSliders[k].set(value));
        for (const mesh of this.visible) this.groupOf(mesh.surface).add(mesh.object);
        this.mill = this.millOn(number);
        byId("milling").hidden = !this.mill;
        this.mill?.hang();
        hangTools(this);
        hangBlank(this);
        hangBodies(this);
        hangLines(this);
        listSurfaces(this);
        listQuantities(this);
        listFrames(this);
        const isSome = this.visible.length > 0 && this.machine.data.frames.length > MOST_FRAMES;
        this.framesChoice.value = isSome ? "some" : "all";
        this.showFrames(this.framesChoice.value);
        this.colourBy(this.quantity);
        this.update();
        this.open();
    }

    /** The gear first, seen from its own frame; without one, tool and work. */
    open() {
        const body = this.pair ? undefined : this.data.bodies.find(({ machine }) => machine === this.number);
        if (!body) {
            this.fitAll(new THREE.Vector3(...(this.pair?.eye() ?? eye(this))));
            return;
        }
        this.seenFrom = body.frame_index;
        byId("seen-from").value = body.frame_index;
        this.stage.place(this.seenFrom);
        this.fitGear(new THREE.Vector3(...eyeOfBody(body, this.meshes)));
    }

    /** The motions at which a point is generated; those that it does not depend on as they are. */
    motionsOf(surface, point, others) {
        const motions = [...others];
        surface.data.unknowns.forEach(({ motion }, k) => {
            if (motion !== null) motions[motion] = surface.unknown(point, k);
        });
        return motions;
    }

    showFrames(which) {
        const tools = this.data.tools.filter((tool) => tool.machine === this.number).map((tool) => tool.frame);
        const work = this.visible.map(({ surface }) => this.pair?.frameOf(surface) ?? surface.data.frame_index);
        const main = new Set([0, ...tools, ...work]);
        this.stage.showFrames((frame) => which === "all" || (which === "some" && main.has(frame)), which !== "none");
    }

    seeFrom(frame) {
        this.seenFrom = frame;
        byId("seen-from").value = frame;
        this.stage.place(frame);
        this.fitAll();
    }

    colourBy(name) {
        this.quantity = name;
        byId("quantity").value = name;
        const surfaces = this.visible.filter((mesh) => mesh.object.visible).map((mesh) => mesh.surface);
        const of = (surface) => surface.quantities().find((one) => one.name === name);
        const quantity = surfaces.map(of).find(Boolean);
        const found = name && name === this.pair?.data.gap ? this.pair.range : name ? rangeOf(surfaces, name) : null;
        const [range, scale] = isSigned(quantity, found) ? [found.about, this.data.signed] : [found, this.data.scale];
        this.shared.scale.value = scale.map((hex) => new THREE.Vector3(...components(hex)));
        this.shared.isColoured.value = name !== "";
        this.shared.range.value.set(range?.low ?? 0, range?.high ?? 1);
        for (const mesh of this.visible) mesh.colour(of(mesh.surface));
        this.pair?.follow();
        drawLegend(byId("legend"), quantity, range, scale);
        this.stage.request();
    }

    showCut(isOn) {
        this.cutBox.checked = isOn;
        this.shared.isCut.value = isOn;
        showBodies(this);
    }

    /** A motion moved by hand: from then on what is not yet cut is pale. */
    moveBy(k, value) {
        if (!this.pair) this.showCut(true);
        this.setMotion(k, value);
    }

    setMotion(k, value) {
        this.motions[k] = this.data.motions[k].is_count ? Math.round(value) : value;
        if (this.pair?.isFound && k === this.pair.roll) this.motions = this.pair.rolledTo(value, this.motions);
        this.motions.forEach((value, k) => this.motionSliders[k].set(value));
        this.update();
    }

    /** Everything that depends on where the machine stands. */
    update() {
        this.machine.move(this.motions, this.settings);
        this.meshes.forEach((mesh) => mesh.move(this.pair ? this.motions.map(() => NOWHERE) : this.motions));
        this.pair?.update();
        this.stage.place(this.seenFrom);
        const { axes } = this.machine.data;
        byId("axes").querySelector("table")?.remove();
        byId("axes").append(table(axes.map(({ name, unit, law, travel }, k) => {
            const value = this.machine.axis(k);
            const isOut = travel && (value < travel[0] || value > travel[1]);
            const within = travel ? `, travel ${withUnit(unit, travel[0])} to ${withUnit(unit, travel[1])}` : "";
            return [`${name} (${law})`, withUnit(unit, value, 7) + (isOut ? " beyond its travel" : ""), `${law}${within}`];
        })));
    }

    setParameter(k, value) {
        this.settings.move(k, value);
        this.parameterSliders.get(k).set(value);
        // while a slider is drawn, once for each picture
        this.solving ??= requestAnimationFrame(() => this.solve());
    }

    resetParameters() {
        this.settings.reset();
        this.solve();
    }

    solve() {
        this.solving = null;
        this.parameterSliders.forEach((slider, k) => slider.set(this.settings.values[k]));
        for (const mesh of this.meshes) {
            mesh.surface.solve(this.settings);
            mesh.rebuild();
        }
        this.machine.move(this.motions, this.settings);
        hangTools(this);
        hangBlank(this);
        hangBodies(this);
        this.lines.forEach((line) => (line.visible = !this.settings.areMoved));
        listQuantities(this);
        this.colourBy(this.quantity);
        markLost(this);
        this.update();
        if (this.selected) this.select(this.selected.mesh, this.selected.point);
        this.mill?.update();
        tellState(this);
    }

    click(x, y) {
        const objects = this.visible.filter((mesh) => mesh.object.visible).map((mesh) => mesh.target);
        const hit = this.stage.under(x, y, objects);
        if (!hit) return;
        const mesh = hit.object.userData.mesh;
        this.select(mesh, mesh.pointAt(hit));
    }

    step([down, right]) {
        const { mesh, point } = this.selected;
        const { rows, columns } = mesh.surface.data;
        const [i, j] = [Math.floor(point / columns.count) + down, (point % columns.count) + right];
        if (i >= 0 && i < rows.count && j >= 0 && j < columns.count) this.select(mesh, i * columns.count + j);
    }

    select(mesh, point) {
        const { surface } = mesh;
        this.selected = { mesh, point };
        const heading = element("h2", { textContent: "Point" });
        const parts = [heading, table(pointRows(surface, point))];
        if (surface.isSolved(point)) {
            this.groupOf(surface).add(this.marker);
            this.marker.position.set(...surface.vector(surface.positions, point));
            this.marker.scale.setScalar(0.05 * this.stage.size);
            const go = element("button", { textContent: "Bring the tool here", type: "button", id: "bring" });
            go.addEventListener("click", () => this.bringTool(surface, point));
            if (!this.pair) parts.splice(1, 0, go);
        }
        this.marker.visible = surface.isSolved(point);
        byId("point").replaceChildren(...parts);
        this.stage.request();
    }

    bringTool(surface, point) {
        this.motionsOf(surface, point, this.motions).forEach((value, k) => this.setMotion(k, value));
    }

    /** Tool and work; where the tool is an edge only, the work's outline too: else little would tell where things are. */
    fitAll(towards) {
        const work = this.pair?.teeth ?? this.visible.filter((mesh) => mesh.object.visible).map((mesh) => mesh.object);
        const around = this.pair || this.toolParts.some((part) => part.isMesh) ? [] : this.blanks;
        this.stage.fit([...work, ...this.toolParts, ...around], towards);
    }

    /** Whole gears; without any, the surfaces of the work. */
    fitGear(towards) {
        const bodies = this.bodies.filter((body) => body.visible);
        if (bodies.length > 0) this.stage.fit(bodies, towards);
        else this.fitWork();
    }

    fitWork() {
        this.stage.fit(this.visible.filter((mesh) => mesh.object.visible).map((mesh) => mesh.object));
    }
}

/** Called at the end of the page with the emitted functions. */
export function start(functions, renderer = newRenderer(byId("canvas"))) {
    const data = JSON.parse(byId("data").textContent);
    const page = new Page(data, functions, renderer);
    // for the console, and for tests
    window.flank = page;
    document.body.dataset.ready = "true";
}
