// SPDX-License-Identifier: Apache-2.0
// The readings of a subsystem, and the places of the page that show them. Values go from the message to the text of an
// element; React draws nothing for them.
import { useEffect, useState } from "react";
import type { Reading } from "./protocol";
import { duration, valueText } from "./text";

type Show = (reading: Reading, ageNs: number, isOld: boolean) => void;

const PERIOD_MS = 100;
/** A value is grey if its producer is not ON, or if it is older than this and than three periods of its producer. */
const OLD_NS = 2e9, OLD_PERIODS = 3;

export class LiveValues {
  private readings = new Map<string, { reading: Reading; at: number }>();
  private shows = new Map<string, Set<Show>>();
  private timer = 0;
  private limits = new Map<string, number>();

  /** Longest period of a producer of each variable, in nanoseconds. */
  setPeriods(periods: Map<string, number>): void {
    this.limits = new Map([...periods].map(([name, period]) => [name, Math.max(OLD_NS, OLD_PERIODS * period)]));
  }

  take(values: Record<string, Reading>): void {
    const at = performance.now();
    for (const [name, reading] of Object.entries(values)) this.readings.set(name, { reading, at });
  }

  reading(variable: string): Reading | undefined {
    return this.readings.get(variable)?.reading;
  }

  /** Calls `show` ten times a second with the latest reading and its age, which grows without new readings. */
  watch(variable: string, show: Show): () => void {
    const all = this.shows.get(variable) ?? new Set();
    this.shows.set(variable, all.add(show));
    if (this.timer === 0) this.timer = window.setInterval(() => this.showAll(), PERIOD_MS);
    this.showOne(variable, show);
    return () => {
      all.delete(show);
      if (all.size === 0) this.shows.delete(variable);
      if (this.shows.size > 0) return;
      window.clearInterval(this.timer);
      this.timer = 0;
    };
  }

  private showAll(): void {
    if (document.hidden) return;
    for (const [variable, shows] of this.shows) for (const show of shows) this.showOne(variable, show);
  }

  private showOne(variable: string, show: Show): void {
    const known = this.readings.get(variable);
    if (!known) return;
    const { reading, at } = known;
    const isOperators = reading.producer === "operator";  // holds until it is set: never old
    const age = isOperators ? 0 : reading.age_ns + (performance.now() - at) * 1e6;
    const limit = this.limits.get(variable) ?? OLD_NS;
    show(reading, age, !isOperators && (reading.state !== "ON" || age > limit));
  }
}

/** Value and age as they stand beside a port: "0.412 3ms". */
export function besidePort(reading: Reading, ageNs: number): string {
  if (reading.value === null || reading.value === undefined) return "never";
  return reading.producer === "operator" ? valueText(reading.value) : `${valueText(reading.value)} ${duration(ageNs)}`;
}

/** The latest reading, drawn again when its text changes; `age`: "" while it is fresh, else in words. */
export function useReading(values: LiveValues, variable: string): { reading?: Reading; age: string } {
  const [shown, set] = useState<{ reading?: Reading; age: string }>({ reading: values.reading(variable), age: "" });
  useEffect(() => values.watch(variable, (reading, ageNs, isOld) => {
    const age = !isOld ? "" : reading.published_ns === 0 ? "never published" : `${duration(ageNs)} old`;
    set((known) => (known.reading?.text === reading.text && known.age === age ? known : { reading, age }));
  }), [values, variable]);
  return shown;
}
