// Opens a page in headless Chromium and goes through the machines of its menu: `node machines.mjs PAGE SCREENSHOTS`. Prints what it found as
// JSON; fails with the reason.
import assert from "node:assert/strict";
import { basename } from "node:path";
import { pathToFileURL } from "node:url";
import { started } from "./started.mjs";

const [path, folder] = process.argv.slice(2);
const name = basename(path, ".html");
const { browser, page, errors } = await started({ width: 1000, height: 700 });
await page.goto(pathToFileURL(path).href);
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });

const found = [];
const count = await page.locator("#machine option").count();
for (let number = 0; number < count; ++number) {
    const shown = await page.evaluate((number) => {
        const { flank } = window;
        // looked at before the next picture is drawn
        const menu = document.querySelector("#machine");
        menu.value = number;
        menu.dispatchEvent(new Event("change"));
        const { camera, frames } = flank.stage;
        const seen = frames.map((frame) => flank.stage.pixel(frame, [0, 0, 0]));
        const { width, height } = flank.stage.canvas.getBoundingClientRect();
        return {
            surfaces: flank.visible.length,
            isThere: camera.position.toArray().every(Number.isFinite),
            areSeen: seen.every(([x, y, depth]) => depth < 1 && x > 0 && x < width && y > 0 && y < height),
            list: document.querySelector("#surfaces").textContent,
            signed: flank.visible.flatMap(({ surface }) => surface.quantities()).filter(({ name }) => name.startsWith("gap_")).map(({ name }) => {
                flank.colourBy(name);
                return [name, ...flank.shared.range.value.toArray()];
            }),
        };
    }, number);
    assert(shown.isThere && shown.list, JSON.stringify(shown));
    // without a surface all frames are what is seen
    if (shown.surfaces === 0) assert(shown.areSeen && shown.list.includes("no surface"), JSON.stringify(shown));
    // what is below zero by rounding alone is not below zero
    for (const [quantity, low, high] of shown.signed) assert(low >= 0 || low < -1e-6 * high, `${quantity}: ${low} to ${high}`);
    await page.screenshot({ path: `${folder}/${name}.${number}.png` });
    found.push(shown.surfaces);
}

// letters large and small, wherever one has clicked
const distance = () => page.evaluate(() => window.flank.stage.camera.position.distanceTo(window.flank.stage.controls.target));
const away = async () => page.evaluate(() => window.flank.stage.camera.position.multiplyScalar(5));
await page.locator("#machine").selectOption("0");
await page.locator("#cut").click();
for (const key of ["f", "F", "w", "W"]) {
    await away();
    const before = await distance();
    await page.keyboard.press(key);
    assert((await distance()) < 0.8 * before, `${key} does nothing`);
}
const bodies = await page.evaluate(() => window.flank.data.bodies.length);
assert.equal(await page.locator("#body").count(), bodies > 0 ? 1 : 0, "a tick for gears that are not there");
// what is long is broken
await page.locator("#about > summary").click();
const aside = await page.evaluate(() => {
    const { scrollWidth, clientWidth } = document.querySelector("aside");
    return { scrollWidth, clientWidth };
});
assert(aside.scrollWidth <= aside.clientWidth, JSON.stringify(aside));
await page.setViewportSize({ width: 400, height: 800 });
await page.evaluate(() => (document.querySelector("#job").textContent = "a_job_with_a_name_that_goes_on_".repeat(4)));
assert(await page.evaluate(() => document.documentElement.scrollWidth) <= 400, "a long name makes a narrow page wide");
await page.screenshot({ path: `${folder}/${name}.narrow.png` });

// opened on a telephone, all is seen at once
await page.reload();
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });
const opened = await distance();
await page.evaluate(() => window.flank.open());
assert(Math.abs((await distance()) - opened) < 1e-6 * opened, "a narrow page opens too near");

assert.deepEqual(errors, []);
await browser.close();
console.log(JSON.stringify({ found }));
