// The controls: what is written into the page's empty sections at the start.

import { showBodies } from "./body.js";
import { Slider, command, element } from "./panel.js";
import { withUnit } from "./numbers.js";

/** Seconds that a motion takes from end to end when it plays. */
const PLAY = 8;
const SLIDER = "input[type=range]";
/** What takes letters for itself. */
const TYPED_INTO = "select, textarea, input:not([type=checkbox], [type=range])";
/** A setting that is no larger is zero. */
const ZERO = 1e-12;

export const byId = (id) => document.getElementById(id);

export function buildHeader(page) {
    const { job, spec, asked, solved, worst_residual: worst } = page.data;
    byId("job").textContent = job;
    byId("spec").textContent = spec;
    const residual = worst === null ? "" : `, residuals up to ${worst.toExponential(1)}`;
    byId("tally").textContent = `${solved} of ${asked} points solved${residual}`;
}

export function buildMotions(page) {
    page.motionSliders = page.data.motions.map((motion, k) => {
        const slider = new Slider({ ...motion, isCount: motion.is_count }, (value) => page.moveBy(k, value));
        slider.set(motion.start);
        const button = element("button", { className: "play", textContent: "▶", title: `play ${motion.name}`, type: "button" });
        button.addEventListener("click", () => play(page, k, button));
        slider.row.append(button);
        byId("motions").append(slider.row);
        return slider;
    });
}

function play(page, k, button) {
    const { low, high } = page.data.motions[k];
    page.playing = page.playing === k ? null : k;
    document.querySelectorAll(".play").forEach((other) => (other.textContent = "▶"));
    if (page.playing === null) return;
    button.textContent = "■";
    let before = null;
    // where a pair rolls from one solved position to the next, small steps add up here
    let at = page.motions[k];
    const tick = (time) => {
        if (page.playing !== k) return;
        const by = before === null ? 0 : ((time - before) / 1000 / PLAY) * (high - low);
        before = time;
        at = at + by > high ? low : at + by;
        page.moveBy(k, at);
        requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
}

export function buildChoices(page) {
    const show = byId("show");
    const choice = (name, control) => show.append(element("label", { className: "choice" }, element("span", { textContent: name }), control));
    const select = (id, change) => {
        const made = element("select", { id });
        made.addEventListener("change", () => {
            change(made.value);
            // who chose with the mouse goes on with the keys of the view
            if (!made.matches(":focus-visible")) made.blur();
        });
        return made;
    };
    if (page.machines.length > 1) {
        const machine = select("machine", (value) => page.showMachine(Number(value)));
        machine.append(...page.machines.map(({ data }, k) => new Option(`${data.name} (${data.definition})`, k)));
        choice("machine", machine);
    }
    choice("colour by", select("quantity", (value) => page.colourBy(value)));
    choice("seen from", select("seen-from", (value) => page.seeFrom(Number(value))));
    const opacity = element("input", { type: "range", min: 0, max: 1, step: 0.05, value: page.toolOpacity.value });
    opacity.addEventListener("input", () => {
        page.toolOpacity.value = Number(opacity.value);
        page.toolParts.forEach((part) => (part.visible = page.toolOpacity.value > 0));
        page.stage.request();
    });
    choice("tool", opacity);
    const tick = (id, name, isOn, change) => {
        const box = element("input", { type: "checkbox", id, checked: isOn });
        box.addEventListener("change", () => change(box.checked));
        show.append(element("label", { className: "choice" }, box, name));
        return box;
    };
    page.cutBox = tick("cut", "what is not yet cut pale", false, (isOn) => page.showCut(isOn));
    page.framesChoice = select("frames", (value) => page.showFrames(value));
    page.framesChoice.append(new Option("all", "all"), new Option("of tool and work", "some"), new Option("none", "none"));
    choice("frames", page.framesChoice);
    page.bodyBox = tick("body", "whole gear", true, () => showBodies(page));
    if (page.data.bodies.length === 0) page.bodyBox.parentElement.remove();
    tick("blank", "outline of revolution", false, (isOn) => {
        page.blanks.forEach((blank) => (blank.visible = isOn));
        page.stage.request();
    });
    const button = (text, act) => {
        const made = element("button", { textContent: text, type: "button" });
        made.addEventListener("click", act);
        return made;
    };
    const fits = element("div", { className: "choice" });
    if (page.data.bodies.length > 0) fits.append(button("Fit gear", () => page.fitGear()));
    fits.append(button("Fit all", () => page.fitAll()), button("Fit work", () => page.fitWork()));
    show.append(fits);
}

export function buildParameters(page) {
    const box = byId("parameters");
    const [moved, still] = [[], []];
    page.data.parameters.forEach((parameter, k) => (parameter.range ? moved : still).push([parameter, k]));
    box.append(element("p", {
        className: "hint",
        textContent: "The surface follows: each point is solved anew here, by Newton's method on the spec's own equations, " +
            "from the program's exact solution, to the same tolerance. Parameters defined by a moved one follow it, and so does the area " +
            "that the spec samples. Ranges of the tool's parameters stay as they are, requirements of the spec are not looked at, and trims are " +
            "not solved again.",
    }));
    page.parameterSliders = new Map(moved.map(([parameter, k]) => {
        const [low, high] = parameter.range;
        const slider = new Slider({ ...parameter, low, high }, (value) => page.setParameter(k, value));
        slider.set(parameter.value);
        slider.row.classList.add("wide");
        return [k, slider];
    }));
    for (const [owner, group] of Map.groupBy(moved, ([{ name }]) => name.split(".").slice(0, -1).join("."))) {
        const rows = (of) => of.map(([, k]) => page.parameterSliders.get(k).row);
        const zeros = group.filter(([{ value }]) => Math.abs(value) < ZERO);
        box.append(element("h3", { textContent: owner || "job" }), ...rows(group.filter((one) => !zeros.includes(one))));
        if (zeros.length === 0) continue;
        const summary = element("summary", { textContent: `${zeros.length} at zero` });
        box.append(element("details", { className: "zeros" }, summary, ...rows(zeros)));
    }
    const reset = element("button", { textContent: "As in the job", type: "button", id: "reset" });
    reset.addEventListener("click", () => page.resetParameters());
    page.state = element("div", { id: "state", role: "status" });
    box.append(reset, page.state);
    if (still.length > 0) {
        const names = still.map(([parameter]) => `${parameter.name} ${withUnit(parameter.unit, parameter.value)}`);
        box.append(element("p", { className: "hint", textContent: `Counts, and what moves no surface: ${names.join(", ")}.` }));
    }
}

export function buildAbout(page) {
    const { program, spec, spec_hash: hash, conventions, notes } = page.data;
    const texts = [
        ...page.data.doc, `${program}, ${spec}, ${hash}`, ...notes, ...conventions,
        "Written by flank (MIT or Apache-2.0) with three.js (MIT; its licence stands in this file).",
    ];
    byId("about").append(...texts.map((textContent) => element("p", { textContent })));
}

export function tellState(page) {
    if (!page.settings.areMoved) return page.state.replaceChildren();
    const lost = page.surfaces.flatMap((surface) => [...surface.lost()].map(([word, count]) => `${surface.name}: ${count} ${word}`));
    const parts = [element("code", { textContent: command(page.data, page.settings) })];
    const trimmed = page.data.surfaces.filter((surface) => surface.trimmed_by.length > 0);
    if (trimmed.length > 0) {
        const names = trimmed.map((surface) => `${surface.name} by ${surface.trimmed_by.join(" and ")}`);
        const textContent = `What trims cut away is still as at the job's own values: ${names.join(", ")}.`;
        parts.unshift(element("p", { className: "warning", id: "trims", textContent }));
    }
    if (lost.length > 0) {
        const textContent = `Points lost (red crosses, where the job's own values have them): ${lost.join(", ")}.`;
        parts.unshift(element("p", { className: "warning", textContent }));
    }
    parts.unshift(element("p", { className: "hint", textContent: "Solved in this page for moved parameters. The same with the program:" }));
    return page.state.replaceChildren(...parts);
}

export function listSurfaces(page) {
    if (page.visible.length === 0) return byId("surfaces").replaceChildren("no surface of this machine is sampled");
    return byId("surfaces").replaceChildren(...page.visible.map((mesh) => {
        const box = element("input", { type: "checkbox", checked: mesh.object.visible });
        box.addEventListener("change", () => {
            mesh.object.visible = box.checked;
            page.colourBy(page.quantity);
        });
        const swatch = element("span", { className: "swatch" });
        swatch.style.background = page.data.colours[page.meshes.indexOf(mesh) % page.data.colours.length];
        return element("label", {}, box, swatch, mesh.surface.name);
    }));
}

export function listQuantities(page) {
    const known = new Map();
    for (const { surface } of page.visible) for (const one of surface.quantities()) known.has(one.name) || known.set(one.name, one);
    if (!known.has(page.quantity)) page.quantity = "";
    byId("quantity").replaceChildren(
        new Option("surface", ""),
        ...[...known.values()].map((one) => new Option(one.isOwn ? `${one.name} (for the job's own values only)` : one.name, one.name)),
    );
    byId("quantity").value = page.quantity;
}

export function listFrames(page) {
    byId("seen-from").replaceChildren(...page.machine.data.frames.map(({ name }, k) => new Option(name, k)));
    page.seenFrom = 0;
}

export function listen(page) {
    const { canvas } = page.stage;
    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
        const [x, y] = pressed ?? [NaN, NaN];
        if (Math.hypot(event.clientX - x, event.clientY - y) < 4) page.click(event.offsetX, event.offsetY);
    });
    window.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest(TYPED_INTO)) return;
        const ways = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
        const fits = { f: () => page.fitAll(), w: () => page.fitWork(), g: () => page.fitGear() };
        if (ways[event.key] && page.selected && !event.target.closest(SLIDER)) {
            page.step(ways[event.key]);
            event.preventDefault();
        } else fits[event.key.toLowerCase()]?.();
    });
}
