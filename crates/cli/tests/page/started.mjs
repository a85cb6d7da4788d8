// A page in headless Chromium, with what its console says of errors.
import { chromium } from "playwright-core";

/** The browser, a page in it of this size, and a list that grows with each error. */
export async function started(viewport) {
    const browser = await chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
    });
    const page = await browser.newPage({ viewport });
    const errors = [];
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(String(error)));
    return { browser, page, errors };
}
