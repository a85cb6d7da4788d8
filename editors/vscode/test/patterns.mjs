// What the editor makes of the patterns of the language configuration: words, and lines behind which the next one stands further right.

import { strict as assert } from "node:assert";
import { readFileSync } from "node:fs";

const { wordPattern, indentationRules } = JSON.parse(readFileSync(new URL("../language-configuration.json", import.meta.url), "utf8"));

const words = (text) => text.match(new RegExp(wordPattern.pattern, `g${wordPattern.flags}`));
assert.deepEqual(words("frame größe_Ω2 in bed = rotate_z(20 deg)"), ["frame", "größe_Ω2", "in", "bed", "rotate_z", "deg"]);

const indents = (line) => new RegExp(indentationRules.increaseIndentPattern).test(line);
for (const line of ["machine a {", "    at = [", "    machine m = lathe( // see below", "    surface s(u: length in 0 mm .. 1 mm) {"]) assert.ok(indents(line), line);
for (const line of ["// see (this", "    frame bed // the table {", "    at = [x, y, z]", "tool t { }"]) assert.ok(!indents(line), line);
console.log("words and indentation: as the language has them");
