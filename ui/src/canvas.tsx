// SPDX-License-Identifier: Apache-2.0
// The place of a picture: it is scrolled by keys or by pulling the background, and has a zoom.
import { MouseEvent, ReactNode, RefObject, useCallback, useRef } from "react";
import { Button } from "./controls";
import type { Picture } from "./protocol";
import { view, zoomBy } from "./view";

/** A picture that does not fit is scrolled rather than drawn with letters that are too small to read. */
const LEAST_FIT = 0.8;

/** Moves the scrolled place while the background is pulled. */
function pull(event: MouseEvent<HTMLDivElement>): void {
  const place = event.currentTarget;
  if (event.button !== 0 || (event.target as Element).closest("[data-task], [data-port], .link, form")) return;
  let { clientX, clientY } = event;
  const move = (now: globalThis.MouseEvent) => {
    place.scrollBy(clientX - now.clientX, clientY - now.clientY);
    ({ clientX, clientY } = now);
  };
  const end = () => { window.removeEventListener("mousemove", move); window.removeEventListener("mouseup", end); };
  window.addEventListener("mousemove", move);
  window.addEventListener("mouseup", end);
}

/** The place, and what makes the picture fit into it. */
export function useFit(picture: Picture | null | undefined): [RefObject<HTMLDivElement>, () => void] {
  const place = useRef<HTMLDivElement>(null);
  const fit = useCallback(() => {
    if (!place.current || !picture) return;
    const { clientWidth, clientHeight } = place.current;
    const whole = Math.min((clientWidth - 4) / picture.width, (clientHeight - 4) / picture.height);
    view.set({ zoom: Math.max(LEAST_FIT, Math.min(1.5, whole)) });
  }, [picture]);
  return [place, fit];
}

export function Canvas({ place, fit, children }:
  { place: RefObject<HTMLDivElement>; fit: () => void; children: ReactNode }) {
  return (
    <>
      <div className="zoom" role="toolbar" aria-label="Zoom of the picture">
        <Button label="Zoom in" title="key +" press={() => zoomBy(1.2)}>+</Button>
        <Button label="Zoom out" title="key -" press={() => zoomBy(1 / 1.2)}>−</Button>
        <Button label="Fit the picture" title="key 0" press={fit}>fit</Button>
      </div>
      <div ref={place} className="canvas" onMouseDown={pull}>{children}</div>
    </>
  );
}
