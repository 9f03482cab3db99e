// SPDX-License-Identifier: Apache-2.0
// A value that components of the page read, and that informs them of its changes.
import { useSyncExternalStore } from "react";

export class Store<T> {
  private readers = new Set<() => void>();

  constructor(private value: T) {}

  get = (): T => this.value;

  set(change: Partial<T>): void {
    this.value = { ...this.value, ...change };
    for (const reader of [...this.readers]) reader();
  }

  subscribe = (reader: () => void): (() => void) => {
    this.readers.add(reader);
    return () => this.readers.delete(reader);
  };
}

/** The present value of `store`; the component is drawn again at each change. */
export function useStore<T>(store: Store<T>): T {
  return useSyncExternalStore(store.subscribe, store.get);
}
