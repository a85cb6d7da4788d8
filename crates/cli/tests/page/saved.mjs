// How long the picture of a spec takes to follow a save, in headless Chromium: `node saved.mjs PROGRAM SPEC [SAVES]`.
// Prints the first, the median, the least and the greatest time in ms.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { appendFileSync, cpSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { started } from "./started.mjs";

const [program, spec, saves = "15"] = process.argv.slice(2);
// a copy beside copies of what it uses
const folder = mkdtempSync(join(tmpdir(), "saved-"));
cpSync(dirname(dirname(resolve(spec))), folder, { recursive: true });
const copy = join(folder, basename(dirname(resolve(spec))), basename(spec));

const server = spawn(resolve(program), ["view", "--serve", copy], { stdio: ["ignore", "pipe", "ignore"] });
const { browser, page, errors } = await started({ width: 1000, height: 700 });
const took = [];
try {
    const address = await new Promise((read) => server.stdout.once("data", (data) => read(String(data).trim())));
    await page.goto(address);
    const shows = (count) =>
        page.waitForFunction((count) => document.body.dataset.picture === count, String(count), { timeout: 60_000 });
    await shows(1);
    for (let save = 0; save < Number(saves); ++save) {
        // nobody saves before the page is still
        await page.waitForTimeout(1000);
        const began = performance.now();
        appendFileSync(copy, "// saved\n");
        await shows(save + 2);
        took.push(performance.now() - began);
    }
    assert.deepEqual(errors, []);
} finally {
    server.kill();
    await browser.close();
    rmSync(folder, { recursive: true });
}
const first = Math.round(took[0]);
took.sort((a, b) => a - b);
const [least, median, greatest] = [0, took.length >> 1, took.length - 1].map((at) => Math.round(took[at]));
console.log(`save to picture: first ${first} ms, median ${median}, least ${least}, greatest ${greatest}, of ${took.length} saves`);
