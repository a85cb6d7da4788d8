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

/** The process of the server that was started last. */
const serverProcess = () => Number(readFileSync(`${folder}/server.pid`, "utf8"));

/** The first page that shows its machine, of those whose address is wanted. */
async function pageBeside(isWanted) {
    for (const end = Date.now() + 20_000; Date.now() < end; await page.waitForTimeout(100)) {
        for (const frame of page.frames().filter((frame) => frame.url().endsWith("/page") && isWanted(frame.url()))) {
            if (await frame.evaluate(() => document.body?.dataset.ready === "true").catch(() => false)) return frame;
        }
    }
    await page.screenshot({ path: `${folder}/page.png` });
    return fail(`no page beside the text: ${page.frames().map((frame) => frame.url().slice(0, 120)).join(" ")}`);
}

const spec = readFileSync(`${folder}/work/lathe.chain`, "utf8");
// the program, which notes what process its server is
const noting = `${folder}/flank`;
writeFileSync(noting, `#!/bin/sh\n[ "$1" = lsp ] && echo $$ >'${folder}/server.pid'\nexec '${program}' "$@"\n`, { mode: 0o755 });
for (const place of ["User", "Machine"]) mkdirSync(`${folder}/data/${place}`, { recursive: true });
// a setting of the machine that the server runs on: among those of the user it is heeded only until the workbench knows the server
writeFileSync(`${folder}/data/Machine/settings.json`, JSON.stringify({ "flank.path": noting }));
writeFileSync(`${folder}/data/User/settings.json`, JSON.stringify({
    "workbench.startupEditor": "none", "security.workspace.trust.enabled": false, "telemetry.telemetryLevel": "off",
    "editor.minimap.enabled": false, "files.autoSave": "off", "chat.commandCenter.enabled": false,
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
    // the workbench may be there before it listens to keys
    const asked = page.locator(".quick-input-widget input");
    for (let left = 20; left > 0 && !(await asked.isVisible()); left--) {
        await page.keyboard.press("Control+P");
        await asked.waitFor({ timeout: 3_000 }).catch(() => {});
    }
    await asked.waitFor();
    await page.keyboard.type("lathe.chain");
    await page.waitForSelector(".quick-input-list .monaco-list-row");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".view-lines .view-line");
    // words have other colours than names
    await page.waitForFunction(() => new Set([...document.querySelectorAll(".view-line span span")].map((part) => getComputedStyle(part).color)).size > 3);
    say("the text is coloured");
    await page.waitForSelector(".squiggly-error");
    say("the mistake is underlined");
    await page.keyboard.press("Control+Home");
    await page.keyboard.press("End");
    await page.keyboard.press("Enter");
    // proposals open by themselves while a word is typed
    await page.keyboard.type("fra", { delay: 60 });
    const proposed = page.locator(".suggest-widget.visible .monaco-list-row", { hasText: "frame" });
    await proposed.first().waitFor();
    say("a word that is typed has proposals");
    await page.keyboard.press("Escape");
    for (let undone = 0; undone < 4; undone++) await page.keyboard.press("Control+Z");
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
    const shown = await pageBeside(() => true);
    say(`the page shows ${await shown.evaluate(() => document.getElementById("tally").textContent)}`);
    await page.screenshot({ path: `${folder}/page.png` });
    // a server that ends by itself is started again, and serves the page at another address
    const old = shown.url();
    const ended = serverProcess();
    process.kill(ended);
    for (const end = Date.now() + 20_000; serverProcess() === ended; await page.waitForTimeout(100)) {
        if (Date.now() > end) fail("the server is not started again");
    }
    await page.waitForTimeout(1000);
    await lens.first().click();
    await pageBeside((url) => url !== old);
    say("the page of a server that was started again takes the place of the old one");
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
