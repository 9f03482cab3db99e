// SPDX-License-Identifier: Apache-2.0
// Finds components and documents by words, ports, units and papers; the best come first.

export interface LibraryPort {
  port: string; kind: string; type: string; unit: string; shape: string; repeated: boolean; doc: string;
}
export interface LibraryComponent {
  name: string; doc: string; file: string; rate_hz: number | null; aperiodic: boolean; time: string | null;
  papers: string[]; words: string; ports: LibraryPort[];
}
export interface DocumentName { name: string; title: string }
export interface Library {
  components: LibraryComponent[]; faults: { file: string; message: string }[]; documents: DocumentName[];
}
/** `place`: of the page about it. `why`: what has the words that were looked for. */
export interface Found { place: string; name: string; doc: string; why: string; component?: LibraryComponent }

const lower = (text: string): string => text.toLowerCase();
/** A number has to be the very one: 4 is not found by 450. */
const starts = (one: string, word: string): boolean => (/^\d+$/.test(word) ? one === word : one.startsWith(word));
const begins = (text: string, word: string): boolean =>
  lower(text).split(/[^\p{L}\d_.]+/u).some((one) => starts(one, word));

/** How well one word fits, and why; 0: not at all. */
function fit(word: string, one: LibraryComponent): [number, string] {
  const name = lower(one.name);
  const small = lower(word);
  if (name === small) return [100, ""];
  if (name.startsWith(small)) return [60, ""];
  const port = one.ports.find((p) => lower(p.port) === small);
  if (port) return [50, `port ${port.port}`];
  const unit = one.ports.find((p) => p.unit === word && p.unit !== "1");
  if (unit) return [45, `unit ${unit.unit} of ${unit.port}`];
  if (name.includes(small)) return [40, ""];
  if (begins(one.doc, small)) return [30, ""];
  const paper = one.papers.find((p) => begins(p, small));
  if (paper) return [25, `paper ${paper}`];
  const described = one.ports.find((p) => lower(p.port).startsWith(small) || begins(p.doc, small));
  if (described) return [15, `port ${described.port}`];
  if (lower(one.words).split(" ").some((w) => starts(w, small))) return [5, "its sheet"];
  return [0, ""];
}

function component(words: string[], one: LibraryComponent): { score: number; found: Found } {
  const fits = words.map((word) => fit(word, one));
  const score = fits.some(([points]) => points === 0) ? 0 : fits.reduce((sum, [points]) => sum + points, 1);
  const why = [...new Set(fits.map(([, reason]) => reason).filter((reason) => reason !== ""))].join(", ");
  return { score, found: { place: `component/${one.name}`, name: one.name, doc: one.doc, why, component: one } };
}

function document(words: string[], one: DocumentName): { score: number; found: Found } {
  const isFound = words.every((word) => begins(one.title, lower(word)) || lower(one.name).includes(lower(word)));
  return { score: isFound ? 20 : 0, found: { place: one.name, name: one.title || one.name, doc: one.name, why: "" } };
}

/** Components and documents that have all words; without words all components. */
export function search(query: string, library: Library): Found[] {
  const words = query.split(/\s+/).filter((word) => word !== "");
  const documents = library.documents.filter(({ name }) => words.length > 0 && !/^library\/\w+\//.test(name));
  return [...library.components.map((one) => component(words, one)), ...documents.map((one) => document(words, one))]
    .filter(({ score }) => score > 0).sort((a, b) => b.score - a.score).map(({ found }) => found);
}
