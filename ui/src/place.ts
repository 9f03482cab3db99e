// SPDX-License-Identifier: Apache-2.0
// The document that the page shows, as it stands in the address behind the key: docs/formats/web.md, "Library and
// documents". Back and forward of the browser go through these places.
import { Store } from "./store";

/** `doc`: "" for none, "library" for the search, "component/NAME", or the name of a document; `at`: a heading. */
export interface Place { doc: string; at: string }

const KEPT = "chimera-place";

const plain = (text: string | undefined): string => {
  try {
    return decodeURIComponent(text ?? "");
  } catch {
    return "";
  }
};

export function placeOf(hash: string): Place {
  const part = (name: string) =>
    plain(hash.split("&").find((one) => one.startsWith(name + "="))?.slice(name.length + 1));
  return { doc: part("doc"), at: part("at") };
}

/** The hash with another place; key and machine stay. */
export function hashWith(hash: string, { doc, at }: Place): string {
  const rest = hash.replace(/^#/, "").split("&").filter((one) => !/^(doc|at)=/.test(one));
  const written = (name: string, text: string) =>
    text === "" ? [] : [`${name}=${encodeURIComponent(text).replace(/%2F/g, "/")}`];
  return "#" + [...rest, ...written("doc", doc), ...written("at", at)].join("&");
}

/** A heading as a target: lower case, without marks, a hyphen for each blank. */
export const anchorOf = (heading: string): string =>
  heading.toLowerCase().replace(/[^\p{L}\p{N}_\- ]/gu, "").replace(/ /g, "-");

export type Target = { kind: "place"; place: Place } | { kind: "outside"; href: string } | { kind: "none" };

/** Where a link of the document `base` leads. `isThere` knows the names of documents. */
export function targetOf(href: string, base: string, isThere: (name: string) => boolean): Target {
  if (/^https?:\/\//i.test(href)) return { kind: "outside", href };
  if (/^[a-z][a-z0-9+.-]*:/i.test(href) || href.startsWith("/")) return { kind: "none" };
  const [path = "", at = ""] = href.split("#");
  if (path !== "" && plain(path) === "") return { kind: "none" };
  const parts = path === "" ? base.split("/") : base.split("/").slice(0, -1);
  for (const part of plain(path).split("/")) {
    if (part === "..") {
      if (parts.length === 0) return { kind: "none" };
      parts.pop();
    } else if (part !== "" && part !== ".") parts.push(part);
  }
  const name = parts.join("/");
  const found = [name, `${name}/README.md`].find(isThere);
  const isFile = /^(docs|examples|library)\/.*\.[a-z]+$/.test(name) && !name.endsWith(".md");
  const sheet = /^library\/(\w+)\/README\.md$/.exec(found ?? "");
  if (!found && !isFile) return { kind: "none" };
  return { kind: "place", place: { doc: sheet ? `component/${sheet[1]}` : found ?? name, at: plain(at) } };
}

export const place = new Store<Place>({ doc: "", at: "" });

/** Shows a place; `replace`: without a step of its own for the way back. */
export function go(next: Place, replace = false): void {
  const hash = hashWith(location.hash, next);
  if (hash !== location.hash) history[replace ? "replaceState" : "pushState"](null, "", hash);
  place.set(next);
}

/** Takes the place of the address. A link without a key is to be kept: the next link with one goes to its place. */
export function followAddress(): void {
  const take = () => place.set(placeOf(location.hash));
  window.addEventListener("popstate", take);
  take();
  try {
    const { doc, at } = place.get();
    const hasKey = /^#[^&]/.test(location.hash);
    if (!hasKey && doc !== "") localStorage.setItem(KEPT, JSON.stringify({ doc, at }));
    const kept = hasKey ? localStorage.getItem(KEPT) : null;
    if (kept !== null) localStorage.removeItem(KEPT);
    if (kept !== null && doc === "") go({ doc: "", at: "", ...JSON.parse(kept) as Partial<Place> }, true);
  } catch {
    // a browser that keeps nothing
  }
}
