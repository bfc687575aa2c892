// SPDX-License-Identifier: Apache-2.0
// A plan between its samples, and the quantities that are plotted.
import { between, viewOf, type Quaternion, type View } from "./camera";
import type { Columns, Plan, Vec3 } from "./types";
import { clamp, distance } from "./vector";

// Index of the last sample at or before the time, and the share of the way to the next.
export function placeOf(times: number[], time: number): [number, number] {
  let low = 0, high = times.length - 1;
  if (high < 1) return [0, 0];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((times[middle] as number) <= time) low = middle;
    else high = middle;
  }
  const from = times[low] as number, to = times[low + 1] as number;
  return [low, to > from ? clamp((time - from) / (to - from), 0, 1) : 0];
}

export function valueAtTime(columns: Columns, name: string, time: number): number | null {
  const list = columns[name];
  if (!list || list.length === 0) return null;
  const [i, share] = placeOf(columns.time, time);
  const here = list[i], next = list[i + 1] ?? here;
  return here === undefined || next === undefined ? null : here + share * (next - here);
}

export function positionAt(columns: Columns, time: number): Vec3 | null {
  const p = ["x", "y", "z"].map((axis) => valueAtTime(columns, axis, time));
  return p.some((v) => v === null) ? null : (p as Vec3);
}

export function viewAt(columns: Columns, time: number): View | null {
  const position = positionAt(columns, time);
  const { qw, qx, qy, qz } = columns;
  if (!position || !qw || !qx || !qy || !qz || qw.length === 0) return null;
  const [i, share] = placeOf(columns.time, time);
  const at = (k: number): Quaternion =>
    [qw[k] ?? 1, qx[k] ?? 0, qy[k] ?? 0, qz[k] ?? 0];
  return viewOf(position, between(at(i), at(Math.min(i + 1, qw.length - 1)), share));
}

export function pathOf(columns: Columns): Vec3[] {
  return columns.time.map((_, i) =>
    [columns.x?.[i] ?? 0, columns.y?.[i] ?? 0, columns.z?.[i] ?? 0]);
}

// m/s, at each sample; null where there is no velocity.
export function speedsOf({ time, vx, vy, vz }: Columns): number[] | null {
  if (!vx || !vy || !vz || vx.length !== time.length) return null;
  return vx.map((v, i) => Math.hypot(v, vy[i] as number, vz[i] as number));
}

// The least and the largest of them.
export function rangeOf(values: number[]): [number, number] {
  return [values.reduce((a, b) => Math.min(a, b), Infinity),
          values.reduce((a, b) => Math.max(a, b), -Infinity)];
}

// The time at which the path is closest to a point; ties go to the first.
export function nearestTime(columns: Columns, point: Vec3): number {
  let best = 0, least = Infinity;
  pathOf(columns).forEach((p, i) => {
    const d = distance(p, point);
    if (d < least) {
      least = d;
      best = columns.time[i] as number;
    }
  });
  return best;
}

export interface Lane {
  name: string;
  unit: string;
  values: number[];
  limits: { name: string; value: number; most: boolean }[];
}

const G = 9.81;   // m/s^2, for the sight of it; the certificate has its own

interface LaneKind {
  name: string;
  unit: string;
  needs: string[];
  value(at: (column: string) => number): number;
  limits: { key: string; sign: 1 | -1; most: boolean }[];
}

const kinds: LaneKind[] = [
  { name: "Speed", unit: "m/s", needs: ["vx", "vy"], value: (at) => Math.hypot(at("vx"), at("vy")),
    limits: [{ key: "speed_across", sign: 1, most: true }] },
  { name: "Climb", unit: "m/s", needs: ["vz"], value: (at) => at("vz"),
    limits: [{ key: "climb_speed", sign: 1, most: true },
             { key: "descent_speed", sign: -1, most: false }] },
  { name: "Acceleration", unit: "m/s\u00b2", needs: ["ax", "ay"],
    value: (at) => Math.hypot(at("ax"), at("ay")),
    limits: [{ key: "acceleration_across", sign: 1, most: true }] },
  { name: "Thrust", unit: "N", needs: ["thrust"], value: (at) => at("thrust"),
    limits: [{ key: "thrust_max", sign: 1, most: true },
             { key: "thrust_min", sign: 1, most: false }] },
  { name: "Obstacles", unit: "m", needs: ["distance"], value: (at) => at("distance"),
    limits: [{ key: "margin", sign: 1, most: false }] },
  { name: "Gimbal", unit: "\u00b0", needs: ["gimbal_pitch"],
    value: (at) => (at("gimbal_pitch") * 180) / Math.PI, limits: [] },
];
// Where the plan has no thrust, for lack of a mass.
const pull = (mass: number | null): LaneKind => ({
  name: "Thrust", unit: mass === null ? "g" : "N", needs: ["ax", "ay", "az"],
  value: (at) => Math.hypot(at("ax"), at("ay"), at("az") + G) * (mass ?? 1 / G),
  limits: mass === null ? [] : [{ key: "thrust_max", sign: 1, most: true },
                                { key: "thrust_min", sign: 1, most: false }],
});

// kg, as a plan tells it: its thrust over its acceleration against gravity.
export function massOf({ columns: c }: Plan): number | null {
  const { thrust, ax, ay, az } = c;
  if (!thrust || !ax || !ay || !az || thrust.length === 0) return null;
  const ratios = thrust.map((t, i) =>
    t / Math.hypot(ax[i] as number, ay[i] as number, (az[i] as number) + G));
  const middle = ratios.sort((a, b) => a - b)[ratios.length >> 1] as number;
  return Number.isFinite(middle) && middle > 0 ? middle : null;
}

// What is plotted below the time line, as far as the plan has it. `limits` of the vehicle come with
// an answer and hold for the guess as well.
export function lanesOf(plan: Plan, limits: Plan["limits"] = plan.limits,
                        mass: number | null = null): Lane[] {
  const { columns } = plan;
  const has = (kind: LaneKind): boolean => kind.needs.every((name) => columns[name]);
  return kinds.map((kind) => (kind.name === "Thrust" && !has(kind) ? pull(mass) : kind))
    .filter(has).map((kind) => ({
      name: kind.name, unit: kind.unit,
      values: columns.time.map((_, i) => kind.value((name) => columns[name]?.[i] ?? NaN)),
      limits: kind.limits.flatMap(({ key, sign, most }) => {
        const value = limits?.[key];
        return typeof value === "number" && Number.isFinite(value)
          ? [{ name: key, value: sign * value, most }] : [];
      }),
    }));
}
