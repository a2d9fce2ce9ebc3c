// Renders every formula of the Markdown files named: node check.mjs FILE...
//
// Exit code 0 if all render, 1 if one does not or there is none at all.

import { readFileSync } from "node:fs";
import process from "node:process";

import katex from "katex";

import { extract } from "./extract.mjs";

/** What is wrong with one formula; empty if it renders. */
function faults({ latex, display, problems }) {
  try {
    katex.renderToString(latex, { displayMode: display, throwOnError: true, strict: "error", trust: false });
    return problems;
  } catch (error) {
    return [...problems, error.message.replaceAll("\n", " ")];
  }
}

const files = process.argv.slice(2);
let formulas = 0;
let failures = 0;
for (const file of files) {
  for (const formula of extract(readFileSync(file, "utf8"))) {
    formulas += 1;
    for (const fault of faults(formula)) {
      failures += 1;
      console.error(`${file}:${formula.line}: ${fault}\n    ${formula.latex.trim().split("\n")[0]}`);
    }
  }
}
console.log(`${formulas} formulas in ${files.length} files, ${failures} failures`);
if (formulas === 0) {
  console.error("no formula was found: is this the right set of files?");
}
process.exitCode = failures > 0 || formulas === 0 ? 1 : 0;
