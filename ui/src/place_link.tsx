// SPDX-License-Identifier: Apache-2.0
// A link to a place of the page.
import type { ReactNode } from "react";
import { hashWith, Place } from "./place";

export function PlaceLink({ to, go, children }: { to: Place; go: (place: Place) => void; children: ReactNode }) {
  return <a href={hashWith("", to)} onClick={(event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    go(to);
  }}>{children}</a>;
}
