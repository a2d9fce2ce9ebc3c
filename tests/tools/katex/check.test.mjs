// Tests of the math check itself: node --test.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import process from "node:process";
import test from "node:test";
import { fileURLToPath } from "node:url";

import { extract } from "./extract.mjs";

const CHECK = fileURLToPath(new URL("check.mjs", import.meta.url));

/** The formulas of a text as [line, LaTeX] pairs. */
const found = (text) => extract(text).map(({ line, latex }) => [line, latex]);
/** What is wrong with the formulas of a text before they are rendered. */
const problems = (text) => extract(text).flatMap((formula) => formula.problems);

/** Run the check on one document. */
function check(text) {
  const folder = mkdtempSync(join(tmpdir(), "pne-math-"));
  try {
    const file = join(folder, "document.md");
    writeFileSync(file, text);
    const { status, stdout, stderr } = spawnSync(process.execPath, [CHECK, file], { encoding: "utf8" });
    return { status, output: (stdout + stderr).replaceAll(`${folder}/`, "") };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("every way to write math is found, with its line", () => {
  const text = "$`a_1`$ and $b$.\n\n```math\nc\nd\n```\n$$e$$\n$$\nf\n$$\n- item\n\n  ```math\n  g\n  ```\n";
  assert.deepEqual(found(text), [
    [1, "a_1"],
    [1, "b"],
    [3, "c\nd"],
    [7, "e"],
    [8, "\nf\n"],
    [13, "  g"],
  ]);
});

test("code, escapes, amounts of money and comments are not math", () => {
  for (const text of ["`$a$`", "``$`a`$``", "\\$a\\$", "$5 to $6", "$ a $", "```c\n$a$\n```", "~~~\n$a$\n~~~", "<!-- $a$\n$b$ -->"]) {
    assert.deepEqual(found(text), [], text);
  }
});

test("what Markdown or GitHub would spoil is told", () => {
  for (const [text, problem] of [
    ["$\\{a\\}$", /takes the backslash of \\\{/],
    ["$$a \\\\ b$$", /takes the backslash of \\\\/],
    ["$a<b$", /for a tag/],
    ["x$`a`$", /right after/],
    ["$`a`$s", /right before/],
    ["| $`|a|`$ |", /table cell/],
    ["$`a", /not closed/],
    ["$$\na", /not closed/],
    ["```math\na", /not closed/],
    ["$`\\operatorname{a}`$", /does not allow \\operatorname/],
  ]) {
    assert.equal(problems(text).length, 1, text);
    assert.match(problems(text)[0], problem);
  }
});

test("what is fine is not complained of", () => {
  const fine = "($`a\\,b`$), $x_1$. | $`|a|`$\n| $`\\vert a\\vert`$ |\n```math\n\\{a \\\\ b<c\\}\n```\n";
  assert.deepEqual(problems(fine), []);
});

test("a formula that does not render fails with its place", () => {
  const { status, output } = check("fine: $`a`$\n\nbad: $`\\frac{1`$\n");
  assert.equal(status, 1);
  assert.match(output, /^document\.md:3: KaTeX parse error/m);
  assert.match(output, /2 formulas in 1 files, 1 failures/);
});

test("LaTeX that KaTeX merely tolerates fails too", () => {
  assert.equal(check("$`a é`$").status, 1);
});

test("formulas that render pass", () => {
  assert.deepEqual(check("```math\n\\begin{aligned} M &= m 1 \\\\ \\tag{3} \\end{aligned}\n```\n"), {
    status: 0,
    output: "1 formulas in 1 files, 0 failures\n",
  });
});

test("no formula at all fails", () => {
  assert.equal(check("no math\n").status, 1);
});
