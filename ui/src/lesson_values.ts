// SPDX-License-Identifier: Apache-2.0
// Values of lessons in the place of those that an offer makes up. No function here knows the browser.
import { valuePath, variablePath } from "./edits";
import type { EditAct, Fault, Offer, Outline, OutlinePort, OutlineTask } from "./protocol";

export interface Offered { value: string; origin: string }
export interface PortOfComponent { component: string; port: string }

/** Rules of a port that gets no value. */
const LACKS = ["input-unmet", "constant-unmet", "resource-missing", "loop-without-initial"];
const MOST_VALUES = 2, MOST_LETTERS = 32;

export const originWords = (origin: string): string =>
  origin.startsWith("examples/") ? `lesson ${origin.split("/")[1]}` : `test of ${origin.split(".")[0]}`;

/** True if a value has as many elements as the shape; a shape that is not known fits all. */
const fits = (value: string, shape: string): boolean => {
  const count = /^\[(\d+)\]$/.exec(shape)?.[1];
  return count === undefined || !value.startsWith("[") || value.split(",").length === Number(count);
};

const shortened = (words: string): string =>
  words.length <= MOST_LETTERS ? words : `${words.slice(0, MOST_LETTERS - 1)}…`;

type Ask = (port: PortOfComponent) => Promise<Offered[]>;

/** Sets the place to the first values that lessons or a test give to the port. */
async function lessonOffers(fault: number, path: string, task: OutlineTask, port: OutlinePort,
                            ask: Ask): Promise<Offer[]> {
  const values = await ask({ component: task.component, port: port.declared });
  return values.filter(({ value }) => fits(value, port.shape)).slice(0, MOST_VALUES)
    .map(({ value, origin }): Offer => ({ fault, origin, acts: [{ act: "set", path, value }],
      label: `${path.split("/").pop()} of ${originWords(origin)}: ${shortened(value)}` }));
}

/** The offers; before each that gives a port a value, those of lessons. */
export async function withLessons(offers: Offer[], faults: Fault[], outline: Outline | null,
                                  ask: Ask): Promise<Offer[]> {
  const all = offers.map(async (offer): Promise<Offer[]> => {
    const fault = faults[offer.fault], [act] = offer.acts;
    const task = outline?.tasks.find((one) => one.task === fault?.task);
    const port = task?.ports.find((one) => one.port === fault?.port);
    if (!task || !port || act?.act !== "set" || !LACKS.includes(fault!.rule)) return [offer];
    return [...await lessonOffers(offer.fault, act.path, task, port, ask), offer];
  });
  return (await Promise.all(all)).flat();
}

/** All values of one lesson in one act, for each lesson that has more than one. */
export function wholeLessons(offers: Offer[]): Offer[] {
  const origins = [...new Set(offers.flatMap(({ origin }) => (origin?.startsWith("examples/") ? [origin] : [])))];
  return origins.flatMap((origin) => {
    const acts = new Map<string, EditAct>();
    for (const offer of offers)
      for (const act of offer.acts)
        if (offer.origin === origin && act.act === "set" && !acts.has(act.path)) acts.set(act.path, act);
    return acts.size < 2 ? [] : [{ fault: 0, acts: [...acts.values()],
      label: `all ${acts.size} values of ${originWords(origin)}` }];
  });
}

/** Values for the constants and resources of a task that its refusal names. */
export async function againstRefusal(outline: Outline | null, name: string, words: string, ask: Ask): Promise<Offer[]> {
  const task = outline?.tasks.find((one) => one.task === name);
  const named = (task?.ports ?? []).filter((port) => ["in-const", "resource"].includes(port.kind) &&
    words.split(/[^\w]+/).includes(port.declared));
  const all = named.map((port) => {
    const given = outline!.variables.find((one) => one.variable === port.variable && one.origin === "constants");
    const path = port.value === null && given ? variablePath(given) : valuePath(name, port);
    return lessonOffers(0, path, task!, port, ask);
  });
  return (await Promise.all(all)).flat();
}
