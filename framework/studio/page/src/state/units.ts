// SPDX-License-Identifier: Apache-2.0
// Numbers as people type and read them, with units.

const families: Record<string, Record<string, number>> = {
  m: { m: 1, cm: 0.01, mm: 0.001, km: 1000, ft: 0.3048, in: 0.0254 },
  s: { s: 1, ms: 0.001, min: 60, h: 3600 },
  "m/s": { "m/s": 1, "km/h": 1 / 3.6, mph: 0.44704, kn: 1852 / 3600 },
  deg: { deg: 1, "\u00b0": 1, rad: 180 / Math.PI },
  rad: { rad: 1, deg: Math.PI / 180, "\u00b0": Math.PI / 180 },
  kg: { kg: 1, g: 0.001 },
};

export interface Range {
  minimum?: number | undefined;
  maximum?: number | undefined;
  above?: number | undefined;
  whole?: boolean | undefined;
}

export type Parsed = { value: number } | { error: string };

// "3.5", "350 cm", "20 km/h": the number in `unit`; a sentence where it is none.
export function parseQuantity(text: string, unit: string, range: Range = {}): Parsed {
  const match = /^\s*([-+\u2212]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([^\s\d].*?)?\s*$/i
    .exec(text.replace(/^(\s*[-+\u2212]?\d+),(\d+)/, "$1.$2"));
  if (!match) return { error: `Type a number${unit ? ` in ${unit}` : ""}.` };
  let value = Number((match[1] as string).replace("\u2212", "-"));
  const typed = match[2];
  if (typed !== undefined && typed !== unit) {
    const factor = families[unit]?.[typed];
    if (factor === undefined) {
      const known = Object.keys(families[unit] ?? (unit ? { [unit]: 1 } : {})).join(", ");
      return { error: `"${typed}" is no unit here${known ? `; use ${known}` : ""}.` };
    }
    value *= factor;
  }
  if (!Number.isFinite(value)) return { error: "The number is too large." };
  const { minimum, maximum, above, whole } = range;
  const u = unit ? ` ${unit}` : "";
  if (whole && !Number.isInteger(value)) return { error: "Type a whole number." };
  if (above !== undefined && value <= above) return { error: `Must be above ${above}${u}.` };
  if (minimum !== undefined && value < minimum) return { error: `Must be at least ${minimum}${u}.` };
  if (maximum !== undefined && value > maximum) return { error: `Must be at most ${maximum}${u}.` };
  return { value };
}

// Short, with a minus sign that is not a hyphen only where it is read, never where it is edited.
export function show(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return value.toExponential(1);
  return String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size + 1))))));
}

// As in an input field: exact to a thousandth.
export const plain = (value: number): string => String(Math.round(value * 1000) / 1000);

export function clock(time: number): string {
  const t = Math.max(0, Math.round(time * 10) / 10);
  const minutes = Math.floor(t / 60);
  return `${minutes}:${(t - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}
