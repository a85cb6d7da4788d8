// Opens a page in headless Chromium and uses it as people do: `node browser.mjs PAGE SCREENSHOTS` with what to expect on stdin.
// Prints what it measured as JSON; fails with the reason.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { started } from "./started.mjs";

const [path, folder] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(0, "utf8"));
const { browser, page, errors } = await started({ width: 1000, height: 700 });
const requests = [];
page.on("request", (request) => requests.push(request.url()));

const begin = performance.now();
await page.goto(pathToFileURL(path).href);
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });
const opened = performance.now() - begin;

/** The share of pixels of the view near a colour. */
async function share(colour, name) {
    const file = `${folder}/${name}.png`;
    const image = (await page.locator("#view").screenshot({ path: file })).toString("base64");
    return page.evaluate(async ([image, colour]) => {
        const picture = new Image();
        picture.src = `data:image/png;base64,${image}`;
        await picture.decode();
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [picture.width, picture.height];
        const context = canvas.getContext("2d");
        context.drawImage(picture, 0, 0);
        const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
        let near = 0;
        for (let at = 0; at < data.length; at += 4) {
            // of the same hue, whatever the light
            const [light, want] = [data.slice(at, at + 3), colour].map((c) => Math.max(...c, 1));
            near += colour.every((c, k) => Math.abs(data[at + k] / light - c / want) < 0.09) ? 1 : 0;
        }
        return near / (data.length / 4);
    }, [image, colour]);
}

// the whole gear first: its generated faces, paler than the surfaces, and the blank
await page.screenshot({ path: `${folder}/page.png` });
const gear = await page.evaluate(() => {
    const { flank } = window;
    const shown = flank.bodies.filter((body) => body.visible);
    return { teeth: shown.map((body) => body.children.length), frame: flank.seenFrom, work: flank.data.surfaces[0].frame_index };
});
assert.deepEqual(gear.teeth, [expected.teeth]);
assert.equal(gear.frame, gear.work, "it is seen from its own frame");
const steel = await share([199, 204, 212], "gear");
assert(steel > 0.05, `the blank covers ${steel} of the view`);

// one surface alone, as large as it goes
const { surface, point } = expected;
await page.evaluate(([surface]) => {
    const { flank } = window;
    flank.visible.forEach((mesh) => (mesh.object.visible = mesh.surface.name === surface));
    flank.toolOpacity.value = 0;
    flank.toolParts.forEach((part) => (part.visible = false));
    flank.bodyBox.click();
    flank.fitWork();
    flank.stage.draw();
}, [surface]);

const hex = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
const colours = await page.evaluate(() => window.flank.data.colours);
const work = await share(hex(colours[0]), "opened");
assert(work > 0.02, `the first surface covers ${work} of the view`);

// the slider moves the tool against the work, and what is not yet cut turns pale
const slider = page.locator(`#slider-${expected.motion}`);
const pose = () => page.evaluate(() => {
    const { machine, data } = window.flank;
    return machine.pose(data.surfaces[0].frame_index).invert().multiply(machine.pose(data.surfaces[0].tool_frame)).elements;
});
const before = await pose();
await slider.focus();
for (let press = 0; press < 40; ++press) await page.keyboard.press("ArrowLeft");
const after = await pose();
const moved = Math.max(...after.map((x, k) => Math.abs(x - before[k])));
assert(moved > 1e-3, `the tool moved by ${moved}`);
assert(await page.locator("#cut").isChecked());
const cut = await share(hex(colours[0]), "cut");
assert(cut < 0.8 * work, `the coloured share was ${work}, and is ${cut} before the cut is done`);
await page.locator("#cut").uncheck();

// a click reads the values that the program wrote
const [x, y] = await page.evaluate(([surface, point]) => {
    const { flank } = window;
    const mesh = flank.visible.find((one) => one.surface.name === surface);
    return flank.stage.pixel(mesh.object, [...mesh.surface.vector(mesh.surface.positions, point)]);
}, [surface, point]);
await page.locator("#canvas").click({ position: { x, y } });
const rows = Object.fromEntries(await page.locator("#point tr").evaluateAll(
    (rows) => rows.map((row) => [row.cells[0].textContent, row.cells[1].textContent]),
));
assert.equal(rows.surface, surface);
for (const [name, value] of Object.entries(expected.values)) {
    const shown = parseFloat(rows[name]);
    assert(Math.abs(shown - value) <= 1e-7 * Math.max(1, Math.abs(value)), `${name} reads ${rows[name]}, not ${value}`);
}

// colours by a quantity, with its legend
await page.locator("#quantity").selectOption(expected.motion);
assert.match(await page.locator("#legend").innerText(), new RegExp(expected.motion));
const [dark, light] = [await share(hex("#00224e"), "quantity"), await share(hex("#fee85c"), "quantity")];
assert(dark > 1e-3 && light > 1e-3, `both ends of the scale are seen: ${dark}, ${light}`);

// what is above and below zero has a palette with a middle, what is not has none
const ends = () => page.evaluate(() => [window.flank.shared.range.value.toArray(), window.flank.shared.scale.value.map((c) => c.toArray())]);
const [[, highest_roll], sequential] = await ends();
await page.locator("#quantity").selectOption(expected.signed);
const [[low, high], signed] = await ends();
assert(low === -high && highest_roll !== high && signed[2].every((part) => part > 0.9), `${low} to ${high}, ${signed[2]}`);
assert(sequential[2].every((part) => part < 0.6), `${sequential[2]}`);
await page.locator("#quantity").selectOption(expected.motion);

// a moved parameter moves the surface, exactly as the program does
await page.locator("#parameters > summary").click();
// those at zero are folded away
assert(await page.locator(".zeros summary").count() > 0);
assert.equal(await page.locator(".zeros .slider").first().isVisible(), false);
const number = page.locator(`[id="slider-${expected.parameter.name}"] + input`);
await number.fill(String(expected.parameter.shown));
await number.press("Enter");
await page.waitForFunction(() => window.flank.surfaces.some((one) => one.isMoved));
const position = await page.evaluate(([surface, point]) => {
    const found = window.flank.surfaces.find((one) => one.name === surface);
    return [...found.vector(found.positions, point)];
}, [surface, point]);
const off = Math.hypot(...position.map((x, k) => x - expected.parameter.position[k]));
assert(off < 1e-9, `the moved point is ${off} mm off`);
await page.locator("#view").screenshot({ path: `${folder}/moved.png` });
assert.match(await page.locator("#state").innerText(), /^Solved in this page for moved parameters/);

/** Types into a parameter's box; its value then, in its unit, and where its slider goes. */
async function type(name, text) {
    const box = page.locator(`[id="slider-${name}"] + input`);
    await box.fill("");
    await box.pressSequentially(text);
    await box.press("Enter");
    return page.evaluate((name) => {
        const { data, settings, parameterSliders } = window.flank;
        const k = data.parameters.findIndex((parameter) => parameter.name === name);
        const { range, number, told } = parameterSliders.get(k);
        const factor = data.parameters[k].unit === "deg" ? 180 / Math.PI : 1;
        return {
            value: factor * settings.values[k], shown: number.value, told: told.textContent,
            low: Number(range.min), high: Number(range.max), at: Number(range.value),
        };
    }, name);
}

// an emptied box, and a text that is no number, leave the value
const { name, shown } = expected.parameter;
for (const text of ["", "-", "1e"]) {
    const left = await type(name, text);
    assert(Math.abs(left.value - shown) < 1e-12 && Number(left.shown) === shown, `"${text}" made ${JSON.stringify(left)}`);
}
// a value of next to nothing has a slider as wide as others, and takes what is typed
const small = await type(expected.small.name, "0.35");
assert(small.high - small.low > 0.5 && small.value === 0.35, JSON.stringify(small));
// what is typed beyond the slider is taken, and the slider goes on to it
const { high: end } = await type(expected.beyond.name, String(expected.beyond.own));
const wanted = end + 0.01 * Math.abs(end);
const beyond = await type(expected.beyond.name, String(wanted));
const step = (beyond.high - beyond.low) / 400;
assert(beyond.value === wanted && beyond.high === wanted && !beyond.told, JSON.stringify(beyond));
assert(Math.abs(beyond.at - wanted) < 1.01 * step, JSON.stringify(beyond));
// but not beyond what the spec allows: that is said, and the value stays
const refused = await type(expected.beyond.name, String(expected.beyond.limits[1] + 1));
assert(refused.value === wanted && Math.abs(Number(refused.shown) - wanted) < 1e-4, JSON.stringify(refused));
const [lowest, highest] = expected.beyond.limits;
assert.equal(refused.told, `${expected.beyond.name} goes from ${lowest} mm to ${highest} mm only`);
await page.screenshot({ path: `${folder}/typed.png` });
assert.equal((await type(expected.beyond.name, String(highest))).told, "");
await page.locator("#reset").click();
assert.equal(await page.evaluate(() => window.flank.surfaces.some((one) => one.isMoved)), false);

// a telephone: nothing is wider than the screen, the gear is above, the controls are below
await page.setViewportSize({ width: 420, height: 900 });
await page.reload();
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });
const narrow = await page.evaluate(() => {
    const box = (id) => document.querySelector(id).getBoundingClientRect();
    return { page: document.documentElement.scrollWidth, view: box("#view"), aside: box("aside"), slider: box("#motions input") };
});
assert(narrow.page <= 420 && narrow.view.width >= 400 && narrow.view.height > 300, JSON.stringify(narrow));
assert(narrow.aside.top >= narrow.view.bottom && narrow.aside.width >= 400 && narrow.slider.height >= 24, JSON.stringify(narrow));
await page.screenshot({ path: `${folder}/narrow.png` });

assert.deepEqual(errors, []);
const fetched = requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:") && !url.startsWith("blob:"));
assert.deepEqual(fetched, []);
await browser.close();
console.log(JSON.stringify({ opened_ms: Math.round(opened), work, cut, moved, off }));
