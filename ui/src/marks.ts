// SPDX-License-Identifier: Apache-2.0
// The state of the page on its root element.

/** Tests and style sheets read the state of the page from its root element. */
export function mark(names: Record<string, string | number>): void {
  for (const [name, value] of Object.entries(names)) {
    const { dataset } = document.documentElement;
    if (dataset[name] !== String(value)) dataset[name] = String(value);
  }
}
