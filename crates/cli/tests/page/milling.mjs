// Opens the page of a job that mills in headless Chromium and moves the cutter: `node milling.mjs PAGE SCREENSHOTS` with what to expect on
// stdin. Prints what it measured as JSON; fails with the reason.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { started } from "./started.mjs";

const [path, folder] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(0, "utf8"));
const { browser, page, errors } = await started({ width: 1200, height: 900 });
await page.goto(pathToFileURL(path).href);
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });
const told = () => page.locator("#cut-now").innerText();

/** Where the cutter stands in its frame, and what is seen of it. */
const state = () => page.evaluate(() => {
    const { mill } = window.flank;
    const { elements } = mill.cutter.matrix;
    const isSeen = mill.object.visible;
    const numbers = mill.data.numbers.map((all, k) => all[[mill.pass, mill.position][k]]);
    return { tip: elements.slice(12, 15), axis: elements.slice(8, 11), pass: mill.pass, position: mill.position, numbers, isSeen };
});
const far = (a, b) => Math.max(...a.map((x, k) => Math.abs(x - b[k])));
const isAt = ({ tip, axis, numbers: [pass, position] }) => {
    const own = expected.at.find((one) => one.pass === pass && one.position === position);
    assert(far(tip, own.tip) < 1e-9 && far(axis, own.axis) < 1e-9, `${tip} ${axis} at ${JSON.stringify(own)}`);
};

const first = await state();
assert(first.isSeen);
isAt(first);
// a press of a key is one position, or one pass
const position = page.locator("#slider-position");
await position.focus();
for (let press = 0; press < 2; ++press) await page.keyboard.press("ArrowRight");
const second = await state();
assert.deepEqual([second.pass, second.position], [first.pass, first.position + 2]);
isAt(second);
await page.locator("#slider-pass").focus();
await page.keyboard.press("ArrowLeft");
const third = await state();
assert.deepEqual([third.pass, third.position], [first.pass - 1, second.position]);
isAt(third);
const text = await told();
for (const part of [`${third.numbers[0]} of ${expected.counts[0]}`, `${third.numbers[1]} of ${expected.counts[1]}`, ...expected.columns]) {
    assert(text.includes(part), `${part} in ${text}`);
}
await page.locator("#fit-milled").click();
await page.waitForTimeout(300);
await page.screenshot({ path: `${folder}/milling.png` });
// it plays
await page.locator('button[title="play the pass"]').click();
await page.waitForFunction((position) => window.flank.mill.position !== position, third.position);
await page.locator('button[title="play the pass"]').click();
// away, and there again
await page.locator("#cutter").uncheck();
assert.equal((await state()).isSeen, false);
await page.locator("#cutter").check();
assert.equal((await state()).isSeen, true);
// a moved parameter makes another flank
const parameter = page.locator(`[id="slider-${expected.parameter}"]`);
await page.locator("#parameters > summary").click();
await parameter.focus();
await page.keyboard.press("ArrowRight");
await page.waitForFunction(() => window.flank.settings.areMoved && !window.flank.mill.object.visible);
assert.match(await told(), /own values/);
await page.locator("#reset").click();
await page.waitForFunction(() => window.flank.mill.object.visible);
// another milling
if (expected.other) {
    await page.locator("#milling-choice").selectOption({ label: expected.other });
    assert.match(await page.locator("#milling").innerText(), new RegExp(`${expected.other}: `));
    await page.screenshot({ path: `${folder}/milling_other.png` });
}
assert.deepEqual(errors, []);
console.log(JSON.stringify({ ok: true }));
await browser.close();
