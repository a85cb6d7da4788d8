// Runs the solver of a page without a browser: `node solving.mjs PAGE NAME=VALUE…` moves parameters (mm, radians) and prints, for
// each surface, the status word, position and normal of each of its points.
import { readFileSync } from "node:fs";

const [page, ...moves] = process.argv.slice(2);
const html = readFileSync(page, "utf8");
const between = (begin, end) => html.slice(html.indexOf(begin) + begin.length, html.indexOf(end, html.indexOf(begin)));
const data = JSON.parse(between('<script type="application/json" id="data">', "</script>"));
const script = between('<script type="module">', "</script>").trimEnd();
const lastLine = script.lastIndexOf("\n");
const functions = script.slice(lastLine).match(/start\((\{.*\})\);/)[1];
const source = `${script.slice(0, lastLine)}\nexport { Settings, WorkSurface };\nexport const functions = ${functions};`;
const module = await import(`data:text/javascript,${encodeURIComponent(source)}`);

const settings = new module.Settings(data.parameters, module.functions[data.definitions]);
for (const move of moves) {
    const [name, value] = move.split("=");
    settings.move(data.parameters.findIndex((parameter) => parameter.name === name), Number(value));
}
const surfaces = data.surfaces.map((one) => {
    const surface = new module.WorkSurface(one, module.functions);
    surface.solve(settings);
    const points = Array.from({ length: surface.count }, (_, point) => ({
        status: surface.word(point),
        position: surface.isSolved(point) ? [...surface.vector(surface.positions, point)] : null,
        normal: surface.isSolved(point) ? [...surface.vector(surface.normals, point)] : null,
        curvatures: surface.isSolved(point) && surface.curvatures ? [...surface.curvatures.subarray(2 * point, 2 * point + 2)] : null,
        unknowns: surface.isSolved(point) ? one.unknowns.map((_, k) => surface.unknown(point, k)) : null,
    }));
    return { name: surface.name, points };
});
console.log(JSON.stringify(surfaces));
