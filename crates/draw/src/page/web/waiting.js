// The end of a page that waits for its job: what every picture needs is there before.

import { byId } from "./controls.js";
import { start } from "./main.js";
import { newRenderer } from "./stage.js";

const renderer = newRenderer(byId("canvas"));

/** Shows a job, from the addresses of its data and of its functions. */
window.begin = async (data, functions) => {
    const text = async (answer) => (answer.ok ? answer.text() : Promise.reject(new Error(`no data: ${answer.status}`)));
    const [read, emitted] = await Promise.all([fetch(data).then(text), import(new URL(functions, document.baseURI).href)]);
    byId("data").textContent = read;
    start(emitted, renderer);
};
