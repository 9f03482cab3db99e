// SPDX-License-Identifier: Apache-2.0
// A component of the library put on the canvas, as acts of docs/formats/edit.md. No function here knows the browser.
import { freeName, linkActs } from "./edits";
import type { EditAct, Outline, OutlinePort } from "./protocol";
import type { LibraryComponent, LibraryPort } from "./search";

const isOpen = (unit: string): boolean => /(^|[^\p{L}])[UXYZ]\d*($|[^\p{L}])/u.test(unit);

/** The port of a component that can be joined to `to`: that of its name first, then one of its very unit. */
export function portFor(to: OutlinePort, ports: LibraryPort[]): LibraryPort | undefined {
  const wanted = to.kind.startsWith("in-") ? to.kind.replace("in-", "out-") : to.kind.replace("out-", "in-");
  const fitting = to.kind === "resource" ? [] : ports.filter((port) => port.kind === wanted &&
    (port.type === to.type || port.type === "any" || to.type === "any") &&
    (port.unit === to.unit || isOpen(port.unit) || isOpen(to.unit)));
  return fitting.find((port) => port.port === to.declared) ?? fitting.find((port) => port.unit === to.unit)
    ?? fitting[0];
}

/** Adds a task of the component, linked to the port `at` ("TASK PORT") if one of its ports fits. Its name is first. */
export function addedTask(outline: Outline | null, subsystem: string, component: LibraryComponent,
                          at = ""): [string, EditAct[]] {
  const name = freeName(component.name, (outline?.tasks ?? []).map((task) => task.task));
  const [task = "", port = ""] = at.split(" ");
  const to = outline?.tasks.find((one) => one.task === task)?.ports.find((one) => one.port === port);
  const own = to && portFor(to, component.ports);
  const link = !own ? [] : linkActs(name, { port: own.port + (own.repeated ? "[0]" : ""), declared: own.port },
    to.variable ?? to.declared);
  return [name, [{ act: "add_task", name, component: component.name, subsystem }, ...link]];
}
