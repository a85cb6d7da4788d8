// Prints reports on A4 in headless Chromium: `node printed.mjs FOLDER REPORT…`. Prints as JSON the tables that do not fit, and leaves the
// sheets as PDF in the folder.
import { basename } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

/** Millimetres between the margins of a sheet, and pixels of one. */
const [ROOM, PIXELS] = [180, 96 / 25.4];
const [folder, ...reports] = process.argv.slice(2);
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox"],
});
const page = await browser.newPage({ viewport: { width: Math.floor(ROOM * PIXELS), height: 1000 } });
await page.emulateMedia({ media: "print" });
const wide = [];
let tables = 0;
for (const report of reports) {
    await page.goto(pathToFileURL(report).href);
    const found = await page.evaluate(() =>
        [...document.querySelectorAll("table")].map((table) => ({
            caption: table.caption.textContent,
            by: Math.round(table.getBoundingClientRect().right - document.documentElement.clientWidth),
        })));
    tables += found.length;
    wide.push(...found.filter(({ by }) => by > 0).map((table) => ({ report: basename(report), ...table })));
    await page.pdf({ path: `${folder}/${basename(report, ".html")}.pdf`, preferCSSPageSize: true });
}
await browser.close();
console.log(JSON.stringify({ tables, wide }));
