// SPDX-License-Identifier: Apache-2.0
// Numbers, times and values as short texts. No function here knows the browser.

const trimmed = (text: string) => (text.includes(".") && !text.includes("e") ? text.replace(/\.?0+$/, "") : text);

/** Three significant digits in at most 7 characters: -0.412, 12.3, 1.2e-5. */
export function short(value: number): string {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "NaN" : value < 0 ? "-inf" : "inf";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (Number.isInteger(value) && size < 1e5) return String(value);
  if (size >= 1e5 || size < 1e-2) {
    const text = value.toExponential(1).replace("e+", "e");
    return text.length <= 7 ? text : value.toExponential(0).replace("e+", "e");
  }
  return trimmed(size >= 1000 ? value.toFixed(0) : value.toPrecision(3));
}

/** A time in at most 5 characters: 850ns, 12us, 3ms, 1.2s, 45s, 3min, 2h, 9d. */
export function duration(ns: number): string {
  const units: [number, string][] = [[1e3, "ns"], [1e6, "us"], [1e9, "ms"], [60e9, "s"], [3600e9, "min"],
    [86400e9, "h"], [Infinity, "d"]];
  let size = 1;
  for (const [limit, unit] of units) {
    if (ns < limit * 0.9995) {
      const value = ns / size;
      const hasTenths = value < 9.95 && unit.endsWith("s") && unit !== "ns";
      return (hasTenths ? trimmed(value.toFixed(1)) : value.toFixed(0)) + unit;
    }
    size = limit;
  }
  return "";
}

/** 1 kHz, 12.5 Hz; a task without a rate runs on events. */
export function rate(hz: number): string {
  return hz === 0 ? "on events" : hz >= 1000 ? `${Number((hz / 1000).toPrecision(4))} kHz`
    : `${Number(hz.toPrecision(4))} Hz`;
}

/** Whole numbers with a thin gap between thousands. */
export function count(n: number): string {
  return n < 10000 ? String(n) : String(n).replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

/** The value of a reading beside its port, at most 7 characters: of a vector the first number, then "…". */
export function valueText(value: unknown): string {
  if (value === null || value === undefined) return "never";
  if (typeof value === "number") return short(value);
  if (typeof value === "boolean") return value ? "true" : "false";
  if (typeof value === "string") return value.length > 7 ? value.slice(0, 6) + "…" : value;
  if (Array.isArray(value)) return value.length === 0 ? "[]" : valueText(value[0]).slice(0, 6) + "…";
  return "{…}";
}

/** Number and unit of the text of a scalar reading, "100 km/h"; null: it is no scalar with a number. */
export function scalar(text: string): { value: number; unit: string } | null {
  const match = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?: (\S.*))?$/i.exec(text);
  return match ? { value: Number(match[1]), unit: match[2] ?? "" } : null;
}

/** A text typed into a field, with the unit of the present value if it has none. */
export function withUnit(typed: string, present: string): string {
  const text = typed.trim();
  const shown = scalar(present);
  return shown && shown.unit && /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(text) ? `${text} ${shown.unit}` : text;
}

/** Least, greatest and step of a slider: the declared range, else twice the present value to both sides of it. */
export function sliderRange(value: number, least?: number | null, most?: number | null): [number, number, number] {
  const size = Math.abs(value) || 1;
  const low = least ?? (value < 0 ? -2 * size : 0);
  const high = most ?? Math.max(low + size, 2 * size);
  return [low, high, (high - low) / 200];
}

/** Local time of day of an instant, in nanoseconds since 1970: 14:03:27.125. */
export function clock(wallNs: number): string {
  const at = new Date(wallNs / 1e6);
  const two = (n: number) => String(n).padStart(2, "0");
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}.${
    String(at.getMilliseconds()).padStart(3, "0")}`;
}

/** FOLDER and FILE joined to a path without "." and "..". */
export function joinPath(folder: string, file: string): string {
  const parts: string[] = [];
  for (const part of (file.startsWith("/") ? file : `${folder}/${file}`).split("/")) {
    if (part === "..") parts.pop();
    else if (part !== "" && part !== ".") parts.push(part);
  }
  return "/" + parts.join("/");
}
