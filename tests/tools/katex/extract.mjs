// Finds the formulas of a Markdown document where GitHub finds them.
//
// GitHub knows math fences, $$ blocks, $`...`$ and $...$.  In the last and in
// $$ blocks Markdown is read before the math, so that some formulas which are
// right as LaTeX come out wrong; `problems` names those.

const FENCE = /^(?<indent>[ >]*)(?<mark>`{3,}|~{3,})\s*(?<info>[^`]*)$/;
// Markdown takes the backslash away before punctuation: \, \{ and \\ are lost.
const LOST_BACKSLASH = /\\[!-/:-@[-`{-~]/;
// GitHub answers "The following macros are not allowed" to these.
const NOT_ALLOWED =
  /\\(operatorname|mbox|[hv]?phantom|def|gdef|edef|let|newcommand|renewcommand|DeclareMathOperator|require|href|class|cssId|style|unicode)(?![A-Za-z])/;

/** One formula: its LaTeX, whether it is displayed, its first line, and what GitHub spoils. */
function formula(latex, display, line, problems = []) {
  const macro = NOT_ALLOWED.exec(latex);
  const spoilt = macro ? [...problems, `GitHub does not allow \\${macro[1]}`] : problems;
  return { latex, display, line, problems: spoilt };
}

/** What Markdown does to a formula that it reads before the math. */
function markdownProblems(latex, kind, instead) {
  const lost = LOST_BACKSLASH.exec(latex);
  const problems = lost ? [`Markdown takes the backslash of ${lost[0]} in ${kind}; write ${instead}`] : [];
  if (/<[A-Za-z/!]/.test(latex)) {
    problems.push(`Markdown takes "<" before a letter for a tag in ${kind}; write ${instead}`);
  }
  return problems;
}

/** The inline formulas of one line. */
function inlineFormulas(text, line) {
  const found = [];
  const inTable = /^\s*\|/.test(text);
  const add = (latex, start, end, problems) => {
    const all = [...problems];
    if (start > 0 && /[A-Za-z0-9-]/.test(text[start - 1])) {
      all.push("GitHub shows no math right after a letter, a digit or a hyphen");
    }
    if (/[A-Za-z0-9]/.test(text[end] ?? "")) {
      all.push("GitHub shows no math right before a letter or a digit");
    }
    if (inTable && /(?<!\\)\|/.test(latex)) {
      all.push('"|" ends a table cell; write \\vert');
    }
    found.push(formula(latex, false, line, all));
  };
  let at = 0;
  while (at < text.length) {
    if (text[at] === "\\") {
      at += 2;
    } else if (text.startsWith("$`", at)) {
      const end = text.indexOf("`$", at + 2);
      if (end < 0) {
        found.push(formula("", false, line, ["$` is not closed on its line"]));
        return found;
      }
      add(text.slice(at + 2, end), at, end + 2, []);
      at = end + 2;
    } else if (text[at] === "`") {
      const ticks = /^`+/.exec(text.slice(at))[0];
      const end = text.slice(at + ticks.length).search(new RegExp(`(?<!\`)${ticks}(?!\`)`));
      at += ticks.length + (end < 0 ? 0 : end + ticks.length);
    } else if (text[at] === "$") {
      const match = /^\$(?![\s$])((?:\\.|[^$\\])*?)(?<!\s)\$(?!\d)/.exec(text.slice(at));
      if (match && match[1]) {
        add(match[1], at, at + match[0].length, markdownProblems(match[1], "$...$", "$`...`$"));
      }
      at += match ? match[0].length : 1;
    } else {
      at += 1;
    }
  }
  return found;
}

/** All formulas of a document, in order. */
export function extract(markdown) {
  const lines = markdown.split("\n");
  const found = [];
  let at = 0;
  while (at < lines.length) {
    const text = lines[at];
    const fence = FENCE.exec(text);
    const start = at + 1;
    if (fence) {
      const { mark, info } = fence.groups;
      const close = new RegExp(`^[ >]*${mark[0]}{${mark.length},}\\s*$`);
      const body = [];
      for (at += 1; at < lines.length && !close.test(lines[at]); at += 1) {
        body.push(lines[at]);
      }
      if (info.trim() === "math") {
        const problems = at < lines.length ? [] : ["the math fence is not closed"];
        found.push(formula(body.join("\n"), true, start, problems));
      }
    } else if (/^\s*<!--/.test(text)) {
      while (at < lines.length && !lines[at].includes("-->")) {
        at += 1;
      }
    } else if (/^[\s>]*\$\$/.test(text)) {
      let latex = text.replace(/^[\s>]*\$\$/, "");
      while (!latex.includes("$$") && at + 1 < lines.length) {
        at += 1;
        latex += `\n${lines[at]}`;
      }
      const end = latex.indexOf("$$");
      const problems = end < 0 ? ["$$ is not closed"] : [];
      latex = end < 0 ? latex : latex.slice(0, end);
      problems.push(...markdownProblems(latex, "$$...$$", "a math fence"));
      found.push(formula(latex, true, start, problems));
    } else {
      found.push(...inlineFormulas(text, start));
    }
    at += 1;
  }
  return found;
}
