// SPDX-License-Identifier: Apache-2.0
// Values of lessons in the place of those that an offer makes up. No function here knows the browser.
import type { Fault, Offer, Outline } from "./protocol";

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

/** The offers; before each that gives a port a value, the first values that lessons or a test give to this port. */
export async function withLessons(offers: Offer[], faults: Fault[], outline: Outline | null,
                                  ask: (port: PortOfComponent) => Promise<Offered[]>): Promise<Offer[]> {
  const all = offers.map(async (offer): Promise<Offer[]> => {
    const fault = faults[offer.fault], [act] = offer.acts;
    const task = outline?.tasks.find((one) => one.task === fault?.task);
    const port = task?.ports.find((one) => one.port === fault?.port);
    if (!task || !port || act?.act !== "set" || !LACKS.includes(fault!.rule)) return [offer];
    const values = await ask({ component: task.component, port: port.declared });
    return [...values.filter(({ value }) => fits(value, port.shape)).slice(0, MOST_VALUES)
      .map(({ value, origin }): Offer => ({ fault: offer.fault, acts: [{ ...act, value }],
        label: `${act.path.split("/").pop()} of ${originWords(origin)}: ${shortened(value)}` })), offer];
  });
  return (await Promise.all(all)).flat();
}
