// SPDX-License-Identifier: Apache-2.0
// The library and the documents of the checkout, without a browser: every sheet renders, no link leads nowhere.
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import { Around, markdown } from "./document";
import { formula, textOf } from "./math";
import { againstRefusal, wholeLessons, withLessons } from "./lesson_values";
import { addedTask, portFor } from "./library_acts";
import { anchorOf, hashWith, placeOf, targetOf } from "./place";
import type { Fault, Offer, Outline } from "./protocol";
import { Library, LibraryComponent, search } from "./search";

/** Names of all files below a folder of the checkout. */
const below = (folder: string): string[] => fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) =>
  entry.isDirectory() ? below(`${folder}/${entry.name}`) : [`${folder}/${entry.name}`]);
const FILES = new Set(["README.md", "CONTRIBUTING.md", ...["docs", "examples", "library"].flatMap(below)]);
const PAGES = [...FILES].filter((name) => name.endsWith(".md"));
const read = (name: string) => fs.readFileSync(name, "utf8");

interface Element { type: any; props: Record<string, any> }
/** Elements in the order of the document; those of our own kind (links, pictures) are not called. */
function elements(node: any): Element[] {
  if (Array.isArray(node)) return node.flatMap(elements);
  return node?.props ? [node as Element, ...elements(node.props.children)] : [];
}
const words = (node: any): string => (Array.isArray(node) ? node.map(words).join("")
  : typeof node === "string" ? node : node?.props ? words(node.props.children) : "");
const around = (base: string): Around =>
  ({ base, isThere: (name) => PAGES.includes(name), go: () => undefined, picture: () => Promise.resolve("") });

test("every line under Equation keeps its text, and most become formulas", () => {
  let lines = 0, formulas = 0;
  for (const name of PAGES.filter((one) => one.startsWith("library/"))) {
    const [, section = ""] = /\n## Equation\n([^]*?)\n## /.exec(read(name)) ?? [];
    for (const line of section.split("\n").filter((one) => one.startsWith("    ")).map((one) => one.slice(4))) {
      const whole = formula(line);
      if (whole) assert.equal(textOf(whole), line);
      ++lines;
      formulas += whole ? 1 : 0;
    }
  }
  assert.ok(lines > 100 && formulas > 0.75 * lines, `${formulas} of ${lines}`);
});

test("a formula has fractions, powers, roots and indices where the line has them", () => {
  const shape = (node: any): string => (typeof node === "string" ? "" : node.hidden ? ""
    : ["mi", "mn", "mo", "mtext"].includes(node.tag) ? node.children[0]
      : node.tag === "mspace" ? " " : `${node.tag}(${node.children.map(shape).join("")})`);
  const cases: [string, string][] = [
    ["y = k x", "math(y=k x)"],
    ["dI/dt = ki e", "math(mfrac(dImrow(dt))=ki e)"],
    ["k = (1 - w/w0)^2", "math(k=msup(mrow((1-mfrac(wmrow(w0))))mrow(2)))"],
    ["w = sqrt(det J)", "math(w=msqrt(det J))"],
    ["y = q_ref^-1", "math(y=msup(msub(qmrow(ref))mrow(-1)))"],
    ["kd d/dt(c r) = 1", "math(kd mfrac(dmrow(dt))mrow((c r))=1)"],
    ["|H|^2 = 1", "math(|Hmsup(|mrow(2))=1)"],
    ["y = phase / 2 pi", "math(y=phase/2 pi)"],
  ];
  for (const [line, wanted] of cases) assert.equal(shape(formula(line)), wanted, line);
  for (const line of ["a = (b", "a = b^", "a: {b: c = d}", "words alone", "a = `b`", ""])
    assert.equal(formula(line), null, line);
});

test("a formula of any letters keeps its text or is none", () => {
  const letters = ["a", "q_ref", "sqrt", "(", ")", "[", "]", "/", "^", "-", "=", " ", "   ", "2", "|", "<=", "'", "ü",
    "dt", "."];
  for (let i = 0; i < 20_000; ++i) {
    const line = Array.from({ length: 1 + i % 12 }, () => letters[Math.floor(Math.random() * letters.length)]).join("");
    const whole = formula(line);
    if (whole) assert.equal(textOf(whole), line);
  }
});

const anchorsOf = (name: string) =>
  new Set(elements(markdown(read(name), around(name))).map((one) => one.props.id));

test("every document renders, and no link of one leads nowhere", () => {
  for (const name of PAGES) {
    const text = read(name);
    const all = elements(markdown(text, around(name)));
    assert.ok(all.length > 3, name);
    assert.ok(all.every((one) => one.props.dangerouslySetInnerHTML === undefined), name);
    for (const { props } of all) {
      if (props.alt !== undefined && props.load) assert.ok(FILES.has(props.name), `${name}: picture ${props.name}`);
      if (!props.to) continue;
      const { doc, at } = props.to as { doc: string; at: string };
      const file = doc.replace(/^component\/(\w+)$/, "library/$1/README.md");
      assert.ok(FILES.has(file), `${name}: link to ${doc}`);
      if (at !== "") assert.ok(anchorsOf(file).has(`at-${at}`), `${name}: no heading for ${doc} ${at}`);
    }
  }
});

test("markup in a document is text", () => {
  const hostile = "# a <script>alert(1)</script>\n\n<img src=x onerror=alert(1)>\n\n[x](javascript:alert(1)) `<b>`\n\n"
    + "[y](data:text/html,z) [z](//evil.test/) ![p](https://evil.test/p.png) [w](../../../etc/passwd)\n<!-- no -->\n";
  const tree = markdown(hostile, around("docs/glossary.md"));
  const kinds = elements(tree).map((one) => one.type).filter((type) => typeof type === "string");
  assert.deepEqual([...new Set(kinds)].sort(), ["code", "h1", "p"]);
  assert.ok(words(tree).includes("<script>alert(1)</script>") && words(tree).includes("<img src=x onerror=alert(1)>"));
  assert.ok(words(tree).includes("<b>"));
  assert.ok(elements(tree).every((one) => !one.props.href && !one.props.src && !one.props.to));
});

test("a link leads to a place, out of the documents, or nowhere", () => {
  const isThere = (name: string) => PAGES.includes(name);
  const to = (href: string) => {
    const target = targetOf(href, "library/pid/README.md", isThere);
    return target.kind === "place" ? `${target.place.doc} ${target.place.at}`.trim() : target.kind;
  };
  const cases: [string, string][] = [["../watchdog/README.md", "component/watchdog"],
    ["../watchdog", "component/watchdog"],
    ["../README.md#input-rule", "library/README.md input-rule"], ["#ports", "component/pid ports"],
    ["../../docs/glossary.md", "docs/glossary.md"],
    ["../../examples/02_cruise_control", "examples/02_cruise_control/README.md"],
    ["pid.cc", "library/pid/pid.cc"], ["https://x.org/", "outside"], ["HTTPS://x.org/", "outside"],
    ["../../../README.md", "none"], ["/etc/passwd", "none"], ["javascript:x", "none"], ["//x.org", "none"],
    ["../../docs/gone.md", "none"], ["%", "none"]];
  for (const [href, wanted] of cases) assert.equal(to(href), wanted, href);
});

test("the place stands behind the key, and a kept link has none", () => {
  assert.equal(hashWith("#KEY&machine=a", { doc: "docs/a b.md", at: "x" }), "#KEY&machine=a&doc=docs/a%20b.md&at=x");
  assert.equal(hashWith("#KEY&doc=a&at=b", { doc: "", at: "" }), "#KEY");
  assert.equal(hashWith("", { doc: "component/pid", at: "" }), "#&doc=component/pid");
  assert.deepEqual(placeOf("#KEY&machine=a&doc=docs/a%20b.md&at=x"), { doc: "docs/a b.md", at: "x" });
  assert.deepEqual(placeOf("#KEY&doc=%"), { doc: "", at: "" });
  assert.equal(anchorOf("Two `words`, q_ref"), "two-words-q_ref");
});

const component = (name: string, change: Partial<LibraryComponent>): LibraryComponent => ({
  name, doc: "", file: "", rate_hz: null, aperiodic: false, time: null, papers: [], words: "", ports: [], ...change });
const port = (name: string, unit = "1", doc = "") =>
  ({ port: name, kind: "in-var", type: "float64", unit, shape: "", repeated: false, doc });
const library: Library = {
  components: [
    component("pid_joint", { ports: [port("q_ref", "rad"), port("kp", "N.m/rad")], papers: ["astrom-2006"] }),
    component("pid", { doc: "Controller of any quantity.", words: "bumpless gains" }),
    component("arm", { ports: [port("tau", "N.m", "Wanted torque.")], words: "pid" })],
  faults: [], documents: [{ name: "docs/howto/drill.md", title: "Drill the safe state" },
    { name: "library/pid/README.md", title: "pid" }],
};

test("a component is added under a free name, and linked where a port fits", () => {
  const [loop, arm] = library.components as [LibraryComponent, LibraryComponent, LibraryComponent];
  const input = { port: "q", declared: "q", kind: "in-var" as const, type: "float64", unit: "rad", shape: "",
    solved: true, shared: false, variable: "angle", parted: false, value: null, default: null, doc: "" };
  const sensor = component("sensor", { ports: [{ ...port("speed", "rad/s"), kind: "out-var" },
    { ...port("any", "U"), kind: "out-var" }, { ...port("at", "rad"), kind: "out-var", repeated: true }] });
  assert.equal(portFor(input, sensor.ports)?.port, "at");
  assert.equal(portFor({ ...input, unit: "K" }, sensor.ports)?.port, "any");
  assert.equal(portFor({ ...input, declared: "any" }, sensor.ports)?.port, "any");
  assert.equal(portFor({ ...input, kind: "resource" }, sensor.ports), undefined);
  assert.equal(portFor({ ...input, type: "bool" }, sensor.ports), undefined);
  assert.equal(portFor(input, arm.ports), undefined);
  const outline = { tasks: [{ task: "sensor", ports: [input] }] } as unknown as Outline;
  assert.deepEqual(addedTask(outline, "s", sensor, "sensor q"), ["sensor_2", [
    { act: "add_task", name: "sensor_2", component: "sensor", subsystem: "s" },
    { act: "link", task: "sensor_2", port: "at", variable: "angle", instance: 0 }]]);
  assert.deepEqual(addedTask(null, "s", loop)[1].length, 1);
});

test("values of lessons stand before the offer that makes one up, if they have its number of elements", async () => {
  const tasks = [{ task: "loop", component: "pid_joint", ports: [{ port: "kp", declared: "kp", shape: "[2]" }] }];
  const fault = (rule: string, port: string) => ({ rule, task: "loop", port }) as Fault;
  const faults = [fault("input-unmet", "kp"), fault("type-clash", "kp"), fault("input-unmet", "gone")];
  const made = (number: number): Offer =>
    ({ fault: number, label: "made up", acts: [{ act: "set", path: "operator/gain", value: "0 V" }] });
  const linked: Offer = { fault: 0, label: "link", acts: [{ act: "link", task: "loop", port: "kp", variable: "x",
    instance: null }] };
  const asked: unknown[] = [];
  const values = ["[1 V]", "[1 V, 2 V]", "3 V", "4 V"].map((value, i) =>
    ({ value, origin: i < 2 ? "examples/02_b/b.yaml" : "pid_joint.test.yaml" }));
  const offers = await withLessons([linked, made(0), made(1), made(2)], faults, { tasks } as unknown as Outline,
    (port) => { asked.push(port); return Promise.resolve(values); });
  assert.deepEqual(asked, [{ component: "pid_joint", port: "kp" }]);
  assert.deepEqual(offers.map((one) => one.label), ["link", "gain of lesson 02_b: [1 V, 2 V]",
    "gain of test of pid_joint: 3 V", "made up", "made up", "made up"]);
  assert.deepEqual(offers[1]!.acts, [{ act: "set", path: "operator/gain", value: "[1 V, 2 V]" }]);
  assert.deepEqual(wholeLessons(offers), []);
  const goal: Offer = { ...offers[1]!, fault: 1, acts: [{ act: "set", path: "constants/goal", value: "1" }] };
  const other: Offer = { ...goal, acts: [{ act: "set", path: "constants/goal", value: "2" }] };
  const [whole, ...rest] = wholeLessons([...offers, goal, other]);
  assert.deepEqual([whole?.label, whole?.acts, rest], ["all 2 values of lesson 02_b",
    [...offers[1]!.acts, ...goal.acts], []]);
});

test("a refusal that names constants of its task offers their values where they stand", async () => {
  const port = (name: string, variable: string | null, kind = "in-const") =>
    ({ port: name, declared: name, kind, shape: "", variable, value: null });
  const outline = { tasks: [{ task: "path", component: "line", ports: [port("duration", null), port("goal", "end"),
    port("q", "q", "in-var"), port("pace", null)] }], variables: [{ variable: "end", constant: true,
    origin: "constants" }] } as unknown as Outline;
  const offers = await againstRefusal(outline, "path", "duration is too short for goal from q",
    ({ port }) => Promise.resolve([{ value: `1 ${port}`, origin: "examples/01_a/a.yaml" }]));
  assert.deepEqual(offers.map((one) => one.acts), [
    [{ act: "set", path: "tasks/path/constants/duration", value: "1 duration" }],
    [{ act: "set", path: "constants/end", value: "1 goal" }]]);
  assert.deepEqual(await againstRefusal(outline, "gone", "duration", () => Promise.resolve([])), []);
});

test("the search finds names, ports, units, papers, words and documents, the best first", () => {
  const names = (query: string) => search(query, library).map((one) => one.name + (one.why && ` (${one.why})`));
  assert.deepEqual(names(""), ["pid_joint", "pid", "arm"]);
  assert.deepEqual(names("pid"), ["pid", "pid_joint", "arm (its sheet)"]);
  assert.deepEqual(names("kp"), ["pid_joint (port kp)"]);
  assert.deepEqual(names("N.m"), ["arm (unit N.m of tau)"]);
  assert.deepEqual(names("torque"), ["arm (port tau)"]);
  assert.deepEqual(names("Astrom"), ["pid_joint (paper astrom-2006)"]);
  assert.deepEqual(names("any bump"), ["pid (its sheet)"]);
  assert.deepEqual(names("drill"), ["Drill the safe state"]);
  assert.deepEqual(names("pid nothing"), []);
  const figure = { ...library, components: [component("car", { words: "figure 450 rad" }),
    component("arm", { words: "4 figure" })] };
  assert.deepEqual(search("Figure 4", figure).map((one) => one.name), ["arm"]);
});
