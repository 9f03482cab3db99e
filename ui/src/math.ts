// SPDX-License-Identifier: Apache-2.0
// Lines under the heading Equation as MathML. The text content of the result is the line itself: letters that the
// drawing replaces, as `^` and the brackets of a root, stay in elements that the style sheet hides.

/** An element with its children; a text stands alone. */
export type MathNode = string | { tag: string; hidden?: true; width?: string; children: MathNode[] };

type Inner = Exclude<MathNode, string>;

const el = (tag: string, ...children: MathNode[]): Inner => ({ tag, children });
const hidden = (text: string): Inner => ({ tag: "mtext", hidden: true, children: [text] });
const row = (nodes: MathNode[]): MathNode => (nodes.length === 1 ? nodes[0]! : el("mrow", ...nodes));

const TOKEN = /\s+|\d+(?:\.\d+)?(?:e-?\d+)?|[\p{L}][\p{L}\d]*(?:_[\p{L}\d]+)*'*|\+-|\+=|[<>!]=|\.\.\.|./gu;
const WORD = /^\p{L}/u;
const CLOSED: Record<string, string> = { "(": ")", "[": "]" };

export const textOf = (node: MathNode): string =>
  typeof node === "string" ? node : node.children.map(textOf).join("");

/** `q_ref` has an index; `speed_limit` is a name. */
function name(word: string): Inner {
  const at = word.indexOf("_");
  if (at < 1 || at > 3) return el("mi", word);
  return el("msub", el("mi", word.slice(0, at)), el("mrow", hidden("_"), el("mi", word.slice(at + 1))));
}

/** Thrown by a line that is no formula. */
class NoFormula extends Error {}

class Parser {
  private at = 0;

  constructor(private readonly tokens: string[]) {}

  /** Up to the bracket `end`, "" for the end of the line. */
  row(end: string): MathNode[] {
    const nodes: MathNode[] = [];
    let before = "";  // the last token that was no space
    for (let token = this.tokens[this.at]; token !== end; token = this.tokens[this.at]) {
      if (token === undefined) {
        if (end === "") return nodes;
        throw new NoFormula();
      }
      if (/^\s/.test(token)) nodes.push(...this.space(before));
      else if (this.isAtom()) nodes.push(this.run());
      else nodes.push(this.powerOf(el("mo", this.tokens[this.at++]!)));  // |x|^2
      if (!/^\s/.test(token)) before = this.tokens[this.at - 1]!;
    }
    ++this.at;
    return nodes;
  }

  private isAtom(): boolean {
    const token = this.tokens[this.at] ?? "";
    return WORD.test(token) || /^\d/.test(token) || token in CLOSED;
  }

  /** Drawn between two factors or words, and where it is wide; operators bring spaces of their own. */
  private space(before: string): MathNode[] {
    const text = this.tokens[this.at++]!;
    const isBetween = /[\p{L}\d')\]|]$/u.test(before) && (this.isAtom() || this.tokens[this.at] === "|");
    const width = text.length > 1 ? "1.5em" : "0.25em";
    return isBetween || text.length > 1 ? [hidden(text), { tag: "mspace", width, children: [] }] : [hidden(text)];
  }

  /** Atoms without a space between them; those on both sides of a `/` without spaces are a fraction. */
  private run(): MathNode {
    const above = this.atoms();
    const next = this.tokens[this.at + 1] ?? "";
    if (this.tokens[this.at] !== "/" || !(WORD.test(next) || /^\d/.test(next) || next in CLOSED)) return row(above);
    if (next === "dt" && !textOf(row(above)).startsWith("d")) return row(above);  // d xr/dt
    ++this.at;
    return el("mfrac", row(above), el("mrow", hidden("/"), ...this.atoms()));
  }

  private atoms(): MathNode[] {
    const nodes = [this.power()];
    while (this.isAtom() && this.tokens[this.at] !== "(") nodes.push(this.power());
    if (this.tokens[this.at] === "(" && !this.isFractionNext(nodes)) nodes.push(this.power());
    return nodes;
  }

  /** `d/dt(x)` is d over dt, and x behind it. */
  private isFractionNext(nodes: MathNode[]): boolean {
    return /^d.?t$/.test(textOf(row(nodes)));
  }

  private power(): MathNode {
    return this.powerOf(this.atom());
  }

  private powerOf(base: MathNode): MathNode {
    if (this.tokens[this.at] !== "^" || textOf(base) === "^") return base;
    ++this.at;
    const exponent: MathNode[] = [hidden("^")];
    if (this.tokens[this.at] === "-") exponent.push(el("mo", this.tokens[this.at++]!));
    if (!this.isAtom()) throw new NoFormula();
    if (this.tokens[this.at] === "(") exponent.push(...this.bracket(hidden));
    else exponent.push(this.atom());
    return el("msup", base, el("mrow", ...exponent));
  }

  private atom(): MathNode {
    const token = this.tokens[this.at]!;
    if (token in CLOSED) return el("mrow", ...this.bracket((text) => el("mo", text)));
    ++this.at;
    if (token === "sqrt" && this.tokens[this.at] === "(")
      return el("msqrt", hidden(token), ...this.bracket(hidden));
    return WORD.test(token) ? name(token) : el("mn", token);
  }

  private bracket(mark: (text: string) => MathNode): MathNode[] {
    const open = this.tokens[this.at++]!;
    const close = CLOSED[open]!;
    return [mark(open), ...this.row(close), mark(close)];
  }
}

/** A part of a line between wide gaps: a remark in words stays text. */
function part(text: string): MathNode[] {
  if (!/[=<>^]/.test(text) && /[\p{L}:,]\s+\p{L}/u.test(text)) return [el("mtext", text)];
  return new Parser(text.match(TOKEN) ?? []).row("");
}

/** MathML of the line, or null: it is no formula, and stays as written. */
export function formula(line: string): Inner | null {
  if (!/[=<>]/.test(line) || /[{}`#]/.test(line)) return null;
  try {
    const parts = line.split(/(\s{3,})/).filter((one) => one !== "");
    const nodes = parts.flatMap((one): MathNode[] =>
      /^\s/.test(one) ? [hidden(one), { tag: "mspace", width: "2em", children: [] }] : part(one));
    const whole = el("math", ...nodes);
    return textOf(whole) === line ? whole : null;
  } catch (error) {
    if (error instanceof NoFormula) return null;
    throw error;
  }
}
