// SPDX-License-Identifier: Apache-2.0
// Values for the field of a port, with where they come from: lessons first, then the test of the component.
import { useEffect, useState } from "react";
import { door } from "./bench";
import { Offered, originWords, PortOfComponent } from "./lesson_values";

const known = new Map<string, Promise<Offered[]>>();

export function offered({ component, port }: PortOfComponent): Promise<Offered[]> {
  const name = `${component} ${port}`;
  if (!known.has(name)) {
    const asked: Promise<Offered[]> = door.call("values", { component, port }).then((answer) => answer.values);
    asked.catch(() => known.delete(name));
    known.set(name, asked);
  }
  return known.get(name)!;
}

/** The list `id` of a field. */
export function OfferedValues({ id, component, port }: { id: string; component: string; port: string }) {
  const [values, set] = useState<Offered[]>([]);
  useEffect(() => {
    let isNeeded = true;
    offered({ component, port }).then((found) => { if (isNeeded) set(found); }, () => undefined);
    return () => { isNeeded = false; };
  }, [component, port]);
  return (
    <datalist id={id}>{values.map(({ value, origin }) => (
      <option key={value} value={value}>{originWords(origin)}</option>))}</datalist>
  );
}
