// The extension in code-server, in a browser without a screen: a spec is coloured, its mistake is underlined and told, and the page that
// follows shows the machine.

import { spawn } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { chromium } from "playwright-core";

const [server, program, folder, browserPath] = process.argv.slice(2);
const port = 18000 + (process.pid % 2000);
const began = Date.now();
const say = (text) => console.log(`${((Date.now() - began) / 1000).toFixed(1)} s: ${text}`);
const fail = (text) => {
    throw new Error(text);
};

const spec = readFileSync(`${folder}/work/lathe.chain`, "utf8");
for (const place of ["User", "Machine"]) mkdirSync(`${folder}/data/${place}`, { recursive: true });
// a setting of the machine that the server runs on: among those of the user it is heeded only until the workbench knows the server
writeFileSync(`${folder}/data/Machine/settings.json`, JSON.stringify({ "flank.path": program }));
writeFileSync(`${folder}/data/User/settings.json`, JSON.stringify({
    "workbench.startupEditor": "none", "security.workspace.trust.enabled": false, "telemetry.telemetryLevel": "off",
    "editor.minimap.enabled": false, "chat.commandCenter.enabled": false,
}));
const node = spawn(process.execPath, [
    `${server}/out/node/entry.js`, "--auth", "none", "--bind-addr", `127.0.0.1:${port}`, "--disable-telemetry", "--disable-update-check",
    "--disable-workspace-trust", "--user-data-dir", `${folder}/data`, "--extensions-dir", `${folder}/extensions`, "--config", `${folder}/none.yaml`,
], { stdio: ["ignore", "pipe", "inherit"] });
let browser, page;
try {
    await new Promise((resolve, reject) => {
        const late = setTimeout(() => reject(new Error("code-server does not start")), 60_000);
        node.stdout.on("data", (data) => {
            if (`${data}`.includes("HTTP server listening")) {
                clearTimeout(late);
                resolve();
            }
        });
    });
    browser = await chromium.launch({
        executablePath: browserPath,
        args: ["--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
            "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    });
    page = await browser.newPage({ viewport: { width: 1400, height: 800 } });
    page.setDefaultTimeout(60_000);
    await page.goto(`http://127.0.0.1:${port}/?folder=${encodeURIComponent(`${folder}/work`)}`);
    await page.waitForSelector(".monaco-workbench");
    say("the workbench is there");
    await page.keyboard.press("Control+P");
    await page.waitForSelector(".quick-input-widget input");
    await page.keyboard.type("lathe.chain");
    await page.waitForSelector(".quick-input-list .monaco-list-row");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".view-lines .view-line");
    // words have other colours than names
    await page.waitForFunction(() => new Set([...document.querySelectorAll(".view-line span span")].map((part) => getComputedStyle(part).color)).size > 3);
    say("the text is coloured");
    await page.waitForSelector(".squiggly-error");
    say("the mistake is underlined");
    await page.keyboard.press("Control+Shift+M");
    const row = page.locator(".markers-panel .monaco-list-row", { hasText: "there is no frame" });
    await row.first().waitFor();
    const told = await row.first().innerText();
    if (!told.includes("E0201")) fail(`the problems say: ${told}`);
    say(`the problems say: ${told.replace(/\s+/g, " ")}`);
    await page.screenshot({ path: `${folder}/problems.png` });
    await page.keyboard.press("Control+P");
    await page.keyboard.type("thread.chain");
    await page.locator(".quick-input-list .monaco-list-row", { hasText: "thread.chain" }).first().waitFor();
    await page.keyboard.press("Enter");
    const lens = page.locator(".codelens-decoration a", { hasText: "view" });
    await lens.first().waitFor();
    say("the lenses are there");
    await lens.first().click();
    let shown;
    for (const end = Date.now() + 20_000; Date.now() < end && !shown; await page.waitForTimeout(100)) {
        for (const frame of page.frames().filter((frame) => frame.url().endsWith("/page"))) {
            if (await frame.evaluate(() => document.body?.dataset.ready === "true").catch(() => false)) shown = frame;
        }
    }
    if (!shown) await page.screenshot({ path: `${folder}/page.png` });
    if (!shown) fail(`no page beside the text: ${page.frames().map((frame) => frame.url().slice(0, 120)).join(" ")}`);
    say(`the page shows ${await shown.evaluate(() => document.getElementById("tally").textContent)}`);
    await page.screenshot({ path: `${folder}/page.png` });
    if (readFileSync(`${folder}/work/lathe.chain`, "utf8") !== spec) fail("the spec was written");
} catch (error) {
    // what the editor tells and shows at that moment
    const told = await page?.locator(".notification-toast").allInnerTexts().catch(() => []);
    say(`the editor tells: ${told?.join(" | ").replace(/\s+/g, " ") || "nothing"}`);
    await page?.screenshot({ path: `${folder}/failed.png` }).catch(() => {});
    throw error;
} finally {
    await browser?.close();
    node.kill();
}
