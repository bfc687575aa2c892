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
  limits: string[];     // checks of the certificate whose limit belongs to it
}

const G = 9.81;   // m/s^2, for the sight of it; the certificate has its own

// What is plotted below the time line, as far as the plan has it.
export function lanesOf(plan: Plan): Lane[] {
  const c = plan.columns;
  const each = (f: (i: number) => number): number[] => c.time.map((_, i) => f(i));
  const v = (name: string, i: number): number => c[name]?.[i] ?? 0;
  const lanes: Lane[] = [];
  if (c.vx) {
    lanes.push({ name: "speed across", unit: "m/s", limits: ["speed_across"],
      values: each((i) => Math.hypot(v("vx", i), v("vy", i))) });
    lanes.push({ name: "climb", unit: "m/s", limits: ["climb_speed", "descent_speed"],
      values: each((i) => v("vz", i)) });
  }
  if (c.ax) {
    lanes.push({ name: "acceleration across", unit: "m/s\u00b2", limits: ["acceleration_across"],
      values: each((i) => Math.hypot(v("ax", i), v("ay", i))) });
  }
  if (c.thrust) {
    lanes.push({ name: "thrust", unit: "N", limits: ["thrust_max", "thrust_min"],
      values: c.thrust });
  } else if (c.ax) {
    lanes.push({ name: "thrust per mass", unit: "m/s\u00b2", limits: [],
      values: each((i) => Math.hypot(v("ax", i), v("ay", i), v("az", i) + G)) });
  }
  return lanes;
}
