// Bundles the parts of three.js that the page uses: `npm ci && npm run build`. The result is committed; `--check` compares.
import { readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const target = new URL("three.min.js", import.meta.url);
const licence = readFileSync(new URL("node_modules/three/LICENSE", import.meta.url), "utf8").trim();
const { outputFiles } = await build({
    entryPoints: [new URL("parts.js", import.meta.url).pathname],
    bundle: true,
    minify: true,
    format: "iife",
    globalName: "THREE",
    target: "es2020",
    legalComments: "none",
    charset: "ascii",
    banner: { js: `/*!\nthree.js, https://threejs.org\n${licence}\n*/` },
    write: false,
});
const [{ text }] = outputFiles;
if (!process.argv.includes("--check")) {
    writeFileSync(target, text);
    writeFileSync(new URL("LICENSE", import.meta.url), licence + "\n");
} else if (readFileSync(target, "utf8") !== text) {
    console.error("three.min.js is not what `npm ci && npm run build` makes of its parts");
    process.exit(1);
}
