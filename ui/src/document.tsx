// SPDX-License-Identifier: Apache-2.0
// Markdown as elements, made of the tokens of marked: every text of a document stays a text.
import { createElement, Fragment, ReactNode, useEffect, useState } from "react";
import { Lexer, type marked } from "marked";
import { formula, MathNode } from "./math";
import { anchorOf, Place, Target, targetOf } from "./place";
import { PlaceLink } from "./place_link";

/** What a document needs of the page around it. */
export interface Around {
  /** Name of the document, from which its links lead. */
  base: string;
  isThere: (name: string) => boolean;
  go: (place: Place) => void;
  /** The address of a picture. */
  picture: (name: string) => Promise<string>;
}

const ENTITIES: Record<string, string> = { "&amp;": "&", "&lt;": "<", "&gt;": ">", "&quot;": '"', "&#39;": "'" };
/** marked writes the texts of code and links for HTML; an element needs them as they were. */
const asWritten = (text: string): string => text.replace(/&(?:amp|lt|gt|quot|#39);/g, (entity) => ENTITIES[entity]!);
const isComment = (html: string): boolean => /^<!--[^]*-->\s*$/.test(html);

function linked(target: Target, around: Around, children: ReactNode): ReactNode {
  if (target.kind === "place") return <PlaceLink to={target.place} go={around.go}>{children}</PlaceLink>;
  if (target.kind === "outside")
    return <a href={target.href} target="_blank" rel="noreferrer noopener">{children}</a>;
  return children;
}

export function Picture({ name, alt, load }: { name: string; alt: string; load: Around["picture"] }) {
  const [address, found] = useState("");
  const [why, failed] = useState("");
  useEffect(() => {
    let made = "";
    let isNeeded = true;
    load(name).then((url) => { made = url; if (isNeeded) found(url); else URL.revokeObjectURL(url); },
      (error: Error) => failed(error.message));
    return () => { isNeeded = false; if (made !== "") URL.revokeObjectURL(made); };
  }, [name, load]);
  if (why !== "") return <span className="fault">{alt}: {why}</span>;
  return address === "" ? <span className="hint">{alt}</span> : <img src={address} alt={alt} />;
}

const inlines = (tokens: marked.Token[] | undefined, around: Around): ReactNode =>
  (tokens ?? []).map((token, i) => <Fragment key={i}>{inline(token, around)}</Fragment>);

function inline(token: marked.Token, around: Around): ReactNode {
  switch (token.type) {
    case "strong": case "em": case "del": return createElement(token.type, null, inlines(token.tokens, around));
    case "codespan": return <code>{asWritten(token.text)}</code>;
    case "br": return <br />;
    case "escape": return token.raw.slice(1);
    case "link":
      return linked(targetOf(asWritten(token.href), around.base, around.isThere), around,
        inlines(token.tokens, around));
    case "image": {
      const name = targetOf(asWritten(token.href), around.base, () => false);
      return name.kind === "place"
        ? <Picture name={name.place.doc} alt={asWritten(token.text)} load={around.picture} /> : asWritten(token.text);
    }
    case "text": return "tokens" in token && token.tokens ? inlines(token.tokens, around) : token.raw;
    case "html": return isComment(token.raw) ? null : token.raw;
    default: return token.raw;
  }
}

/** A formula as elements of MathML. */
export function mathElement(node: MathNode, key = 0): ReactNode {
  if (typeof node === "string") return node;
  const { tag, width } = node;
  return createElement(tag, { key, width, className: node.hidden && "gone" }, ...node.children.map(mathElement));
}

/** Each line alone: a formula, or as written. */
function equations(text: string): ReactNode {
  return (
    <div className="equation">
      {text.split("\n").map((line, i) => {
        const whole = formula(line);
        return <div key={i}>{whole ? mathElement(whole) : <code>{line}</code>}</div>;
      })}
    </div>
  );
}

function table(token: marked.Tokens.Table, around: Around, section: string): ReactNode {
  const row = (cells: marked.Tokens.TableCell[], kind: "th" | "td") => cells.map((cell, i) =>
    createElement(kind, { key: i, scope: kind === "th" ? "col" : undefined }, inlines(cell.tokens, around)));
  return (
    <table aria-label={section || "Table"}>
      <thead><tr>{row(token.header, "th")}</tr></thead>
      <tbody>{token.rows.map((cells, i) => <tr key={i}>{row(cells, "td")}</tr>)}</tbody>
    </table>
  );
}

function block(token: marked.Token, around: Around, section: string): ReactNode {
  switch (token.type) {
    case "heading":
      return createElement(`h${token.depth}`, { id: `at-${anchorOf(titleOf(token.tokens))}`, tabIndex: -1 },
        inlines(token.tokens, around));
    case "paragraph": return <p>{inlines(token.tokens, around)}</p>;
    case "code":
      return section === "Equation" && token.codeBlockStyle === "indented" ? equations(token.text)
        : <pre><code>{token.text}</code></pre>;
    case "blockquote": return <blockquote>{blocks(token.tokens, around)}</blockquote>;
    case "list":
      return createElement(token.ordered ? "ol" : "ul", token.ordered ? { start: token.start || 1 } : null,
        token.items.map((item, i) => <li key={i}>{blocks(item.tokens, around)}</li>));
    case "table": return table(token, around, section);
    case "hr": return <hr />;
    case "space": case "def": return null;
    default: return inline(token, around);
  }
}

/** The words of a heading, without marks. */
const titleOf = (tokens: marked.Token[]): string => tokens.map((token) =>
  "tokens" in token && token.tokens ? titleOf(token.tokens) : "text" in token ? asWritten(token.text) : "").join("");

function blocks(tokens: marked.Token[], around: Around): ReactNode {
  let section = "";
  return tokens.map((token, i) => {
    if (token.type === "heading") section = token.text;
    return <Fragment key={i}>{block(token, around, section)}</Fragment>;
  });
}

/** The elements of a Markdown text. */
export const markdown = (text: string, around: Around): ReactNode => blocks(Lexer.lex(text), around);
