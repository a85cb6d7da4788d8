// Opens the page of a pair in headless Chromium and rolls it: `node pair.mjs PAGE SCREENSHOTS` with what to expect on stdin. Prints what it
// measured as JSON; fails with the reason.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { started } from "./started.mjs";

const [path, folder] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(0, "utf8"));
const { browser, page, errors } = await started({ width: 1200, height: 900 });
await page.goto(pathToFileURL(path).href);
await page.waitForSelector("body[data-ready]", { timeout: 60_000 });
await page.screenshot({ path: `${folder}/${expected.name}.png` });
const contact = () => page.locator("#contact").innerText();

/** Where everything stands: poses, the point, the marks on the maps and in the chart, and how far the flanks are from each other at the point. */
const state = () => page.evaluate(() => {
    const { pair, machine, motions } = window.flank;
    const index = pair.standing();
    const marks = [...document.querySelectorAll("#contact circle")].map((mark) => [mark.getAttribute("cx"), mark.getAttribute("cy")].map(Number));
    return {
        index, turn: motions[pair.roll], lag: motions[pair.lag],
        poses: pair.data.members.map(({ frame }) => machine.pose(frame).elements),
        point: index === null ? null : [...pair.positions.subarray(3 * index, 3 * index + 3)],
        marks, now: Number(document.querySelector("#contact .chart .now")?.getAttribute("x1")),
        isTouchSeen: pair.touch.visible,
    };
});

if (expected.refused) {
    assert.match(await contact(), new RegExp(expected.refused));
    assert.equal(await page.locator("#contact svg").count(), 0);
    await page.locator(`#slider-${expected.motion}`).press("ArrowRight");
} else {
    const before = await state();
    assert(before.isTouchSeen && before.index !== null);
    // one press of a key is one solved position
    const slider = page.locator(`#slider-${expected.motion}`);
    await slider.focus();
    for (let press = 0; press < 5; ++press) await page.keyboard.press("ArrowRight");
    const after = await state();
    assert.equal(after.index, before.index + 5);
    const far = (a, b) => Math.max(...a.map((x, k) => Math.abs(x - b[k])));
    for (const member of [0, 1]) {
        const turned = far(after.poses[member], before.poses[member]);
        assert(turned > 1e-3, `member ${member} turned by ${turned}`);
        const moved = far(after.marks[member], before.marks[member]);
        assert(moved > 0.5, `the mark of member ${member} moved by ${moved}`);
    }
    assert(far(after.point, before.point) > 1e-2, "the point moved");
    assert(after.now > before.now, "so did the mark over the roll");
    assert.match(await contact(), /flank on flank/);
    // as the program has it at that position
    const { turn, lag } = expected.at[after.index];
    const degrees = 180 / Math.PI;
    assert(Math.abs(after.turn * degrees - turn) < 1e-9 && Math.abs(after.lag * degrees - lag) < 1e-9, JSON.stringify(after));
    // moved apart by hand there is no contact, and the roll brings it back
    const number = page.locator("#slider-lag + input");
    await number.fill(String(after.lag * degrees + 0.1));
    await number.press("Enter");
    assert.equal((await state()).isTouchSeen, false);
    assert.match(await contact(), /moved by hand/);
    await slider.focus();
    await page.keyboard.press("ArrowLeft");
    assert.equal((await state()).isTouchSeen, true);
    // it plays
    await page.locator(`button[title="play ${expected.motion}"]`).click();
    await page.waitForFunction((index) => window.flank.pair.standing() !== index, (await state()).index);
    await page.locator(`button[title="play ${expected.motion}"]`).click();
    // another contact, and another machine: without a contact
    if (expected.other !== undefined) {
        await page.locator("#contact-choice").selectOption(String(expected.other));
        assert((await state()).isTouchSeen);
        assert.equal(await page.locator("#quantity").inputValue(), await page.evaluate(() => window.flank.pair.data.gap));
    }
    await page.screenshot({ path: `${folder}/${expected.name}_rolled.png` });
    await page.locator("#machine").selectOption("0");
    assert(await page.locator("#contact").isHidden());
    assert((await page.evaluate(() => window.flank.visible.length)) > 0);
}
assert.deepEqual(errors, []);
await browser.close();
console.log(JSON.stringify({ ok: true }));
