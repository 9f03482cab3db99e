// SPDX-License-Identifier: Apache-2.0
// Places in the text of a description: how a value is written, which task a line belongs to, where a cursor goes.
// Reads the usual forms of YAML; what it does not find, the page shows as not written. No function here knows the
// browser.

const isContent = (line: string) => /^\s*[^#\s]/.test(line);
const indentOf = (line: string) => line.length - line.trimStart().length;
const unquoted = (words: string) => words.trim().replace(/^(["'])(.*)\1$/s, "$2");
const withoutComment = (words: string) => words.replace(/^#.*$|(?<=\s)#.*$/gm, "").trim();

/** The items of `{...}` or `[...]` at the begin of `words`, and the index behind its last bracket. */
function flow(words: string): { items: string[]; end: number } {
  const items: string[] = [];
  let depth = 0, quote = "", begin = 1;
  for (let i = 0; i < words.length; ++i) {
    const letter = words[i]!;
    if (quote !== "") {
      if (letter === "\\" && quote === '"') ++i;
      else if (letter === quote) quote = "";
    } else if ((letter === '"' || letter === "'") && /[\s,:[{]/.test(words[i - 1] ?? " ")) quote = letter;
    else if (letter === "#" && /\s/.test(words[i - 1] ?? " ")) i = (words + "\n").indexOf("\n", i);
    else if (letter === "{" || letter === "[") ++depth;
    else if (letter === "," && depth === 1) {
      items.push(words.slice(begin, i));
      begin = i + 1;
    } else if ((letter === "}" || letter === "]") && --depth === 0) {
      items.push(words.slice(begin, i));
      return { items: items.map(withoutComment).filter((item) => item !== ""), end: i + 1 };
    }
  }
  return { items: [], end: words.length };
}

/** The words behind `key` in a map. */
function valueIn(map: string, key: string): string | null {
  if (map.trimStart().startsWith("{")) {
    for (const item of flow(map.trimStart()).items) {
      const entry = /^("[^"]*"|'[^']*'|[^:]+?)\s*:(?:\s+(.*))?$/s.exec(item);
      if (entry && unquoted(entry[1]!) === key) return entry[2] ?? "";
    }
    return null;
  }
  const lines = map.split(/\r?\n/);
  const depth = indentOf(lines.find(isContent) ?? "");
  const isNext = (line: string) => isContent(line) && (indentOf(line) < depth ||
    (indentOf(line) === depth && !line.trimStart().startsWith("-")));
  for (let i = 0; i < lines.length; ++i) {
    const entry = /^\s*("[^"]*"|'[^']*'|[^\s:#][^:]*?)\s*:(?:\s+(.*))?$/.exec(lines[i]!);
    if (!entry || indentOf(lines[i]!) !== depth || unquoted(entry[1]!) !== key) continue;
    const rest = entry[2] ?? "";
    const after = lines.slice(i + 1).findIndex(isNext);
    const tail = lines.slice(i + 1, after < 0 ? undefined : i + 1 + after).join("\n");
    if (rest.startsWith("{") || rest.startsWith("[")) {
      const whole = `${rest}\n${tail}`;
      return whole.slice(0, flow(whole).end);
    }
    return withoutComment(rest) === "" ? (tail.trim() === "" ? "" : `\n${tail}`) : withoutComment(rest);
  }
  return null;
}

/** How the text writes the value at a path; null: it does not. A value on lines of its own begins with a line end. */
export function wordsAt(text: string, path: string): string | null {
  return path.split("/").reduce<string | null>((map, key) => (map === null ? null : valueIn(map, key)), text);
}

/** The names in a list, or in `tasks` of a map: the members of a configuration. */
export function membersAt(text: string, path: string): { path: string; members: string[] } | null {
  const words = wordsAt(text, path);
  if (words === null) return null;
  if (words.startsWith("[")) return { path, members: flow(words).items.map(unquoted) };
  const lines = words.split("\n").filter(isContent);
  if (words.startsWith("\n") && lines.every((line) => line.trimStart().startsWith("-")))
    return { path, members: lines.map((line) => unquoted(withoutComment(line.trimStart().slice(1)))) };
  return valueIn(words, "tasks") === null ? null : membersAt(text, `${path}/tasks`);
}

/** The task whose part of the text has the line; "": none. Lines count from 1. */
export function taskAt(text: string, tasks: { task: string; line: number }[], line: number): string {
  const lines = text.split("\n");
  const before = tasks.filter((one) => one.line > 0 && one.line <= line);
  const last = before.reduce((best, one) => (one.line >= best.line ? one : best), { task: "", line: 0 });
  if (last.line === 0) return "";
  const depth = indentOf(lines[last.line - 1] ?? "");
  const isOutside = lines.slice(last.line, line).some((one) => isContent(one) && indentOf(one) <= depth);
  return isOutside ? "" : last.task;
}

/** Index of the first letter of a line, and of a column in it; both count from 1. */
export function indexAt(text: string, line: number, column = 1): number {
  const lines = text.split("\n").slice(0, Math.max(0, line - 1));
  return Math.min(text.length, lines.reduce((sum, one) => sum + one.length + 1, 0) + Math.max(0, column - 1));
}

/** Number of the line that holds the index. */
export const lineAt = (text: string, index: number): number => text.slice(0, index).split("\n").length;

/** Where a cursor belongs after the text became another one: it stays at the words around it. */
export function movedCursor(before: string, after: string, at: number): number {
  let same = 0;
  const shorter = Math.min(before.length, after.length);
  while (same < shorter && before[same] === after[same]) ++same;
  if (at <= same) return at;
  let tail = 0;
  while (tail < shorter - same && before[before.length - 1 - tail] === after[after.length - 1 - tail]) ++tail;
  return at >= before.length - tail ? at + after.length - before.length : Math.min(at, after.length - tail);
}
