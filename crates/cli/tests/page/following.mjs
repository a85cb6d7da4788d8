// The page that follows a spec, in headless Chromium: `node following.mjs ADDRESS SPEC` with the spec's texts on stdin.
// Prints what it measured as JSON; fails with the reason.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { chromium } from "playwright-core";

const [address, spec] = process.argv.slice(2);
const { other, wrong, code, empty, grown, gone, jobs: [first, second], server, folder } = JSON.parse(readFileSync(0, "utf8"));
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
});
const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
const errors = [];
page.on("pageerror", (error) => errors.push(String(error)));
await page.goto(address);

/** Waits for something the outer page says of itself. */
const says = (key, value) =>
    page.waitForFunction(([key, value]) => document.body.dataset[key] === value, [key, value], { timeout: 60_000 });
/** What the picture shows: where the eye is, the motion, a parameter that was moved, by what it is coloured. */
const seen = () =>
    page.evaluate(() => {
        const { flank } = document.querySelector("iframe.shown").contentWindow;
        const [[parameter, value] = []] = [...flank.settings.byHand];
        return {
            camera: flank.stage.camera.position.toArray(),
            target: flank.stage.controls.target.toArray(),
            motion: flank.motions[0],
            parameter: flank.data.parameters[parameter]?.name,
            value,
            quantity: flank.quantity,
        };
    });
const filter = () => page.evaluate(() => getComputedStyle(document.querySelector("iframe.shown")).filter);

await says("picture", "1");
await page.evaluate(() => {
    const { flank } = document.querySelector("iframe.shown").contentWindow;
    const [low, high] = [flank.data.motions[0].low, flank.data.motions[0].high];
    flank.setMotion(0, low + 0.37 * (high - low));
    const k = flank.data.parameters.findIndex(({ name }) => name === "module");
    flank.settings.move(k, 1.01 * flank.data.parameters[k].value);
    const { camera, controls } = flank.stage;
    camera.position.set(camera.position.x + 11, camera.position.y - 7, camera.position.z + 5);
    controls.target.set(1, 2, 3);
    controls.update();
    flank.stage.draw();
});
const before = await seen();
assert(before.parameter, "a parameter was moved");

const saved = performance.now();
writeFileSync(spec, other);
await says("picture", "2");
const followed = performance.now() - saved;
const after = await seen();
assert.equal(after.parameter, before.parameter);
for (const key of ["camera", "target", "motion", "value"]) {
    const [was, is] = [before[key], after[key]].map((of) => [of].flat());
    // a camera is put where it was, and its controls then turn it by rounding
    was.forEach((x, k) => assert(Math.abs(x - is[k]) <= 1e-9 * Math.max(1, Math.abs(x)), `${key}: ${was} became ${is}`));
}
assert.equal(after.quantity, before.quantity);
assert.equal(await filter(), "none");

writeFileSync(spec, wrong);
await page.waitForSelector("body.old", { timeout: 60_000 });
assert.match(await filter(), /grayscale\(1\)/);
const error = await page.locator("#error").textContent();
assert(error.includes(code), error);
assert(await page.locator("#error").isVisible());
assert.deepEqual(await seen(), after, "the last good picture stays");

writeFileSync(spec, other.replace(/$/, "\n"));
await says("picture", "3");
assert.equal(await filter(), "none");
assert(!(await page.locator("#error").isVisible()));

/** The thing that a click in the middle of an element meets. */
const hit = (id) =>
    page.evaluate((id) => {
        const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
        return document.elementFromPoint(x + width / 2, y + height / 2).id;
    }, id);
const job = () => page.evaluate(() => document.querySelector("iframe.shown").contentDocument.querySelector("#job").textContent);
const showsJob = (name) =>
    page.waitForFunction((name) => document.querySelector("iframe.shown")?.contentDocument.querySelector("#job")?.textContent === name, name);

// another job is chosen, and stays
assert.equal(await hit("jobs"), "jobs", "the menu lies under the picture");
await page.locator("#jobs").selectOption(second);
await showsJob(second);
await page.locator("#jobs").selectOption(first);
await showsJob(first);

// a job without a point stays as it was, with the reason; the other one can be chosen
writeFileSync(spec, empty);
await says("picture", "3");
await page.waitForSelector("body.old", { timeout: 60_000 });
assert.match(await page.locator("#error").textContent(), /no point to show/);
assert.equal(await hit("error"), "error", "the error lies under the picture");
assert.equal(await job(), first);
await page.screenshot({ path: `${folder}/empty.png` });
await page.locator("#jobs").selectOption(second);
await showsJob(second);
assert(!(await page.locator("#error").isVisible()));
await page.locator("#jobs").selectOption(first);
assert(await page.locator("#error").isVisible());
writeFileSync(spec, other);
await says("picture", "5");
await page.waitForFunction(() => !document.body.classList.contains("old"), { timeout: 60_000 });
assert.equal(await job(), first);

// a gear that outgrows its picture is fitted anew
writeFileSync(spec, grown);
await says("picture", "6");
const offMiddle = await page.evaluate(() => {
    const { flank } = document.querySelector("iframe.shown").contentWindow;
    const { x, y } = flank.stage.ball(flank.visible.map((mesh) => mesh.object)).center.project(flank.stage.camera);
    return Math.max(Math.abs(x), Math.abs(y));
});
assert(offMiddle < 1, `the work lies at ${offMiddle} of the way to the edge`);

// a job that is no more is not replaced in silence
writeFileSync(spec, gone);
await says("picture", "7");
assert.match(await page.locator("#error").textContent(), new RegExp(`no job ${first} any more`));
await page.screenshot({ path: `${folder}/gone.png` });

// nor does the page stay silent when nobody serves it
process.kill(server);
await page.waitForSelector("body.old", { timeout: 60_000 });
assert.match(await page.locator("#error").textContent(), /has ended/);
await page.screenshot({ path: `${folder}/ended.png` });
assert.deepEqual(errors, []);
await browser.close();
console.log(JSON.stringify({ followed_ms: Math.round(followed) }));
