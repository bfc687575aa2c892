// SPDX-License-Identifier: Apache-2.0
// The guess: a cubic spline through the keyframes, twice differentiable, at rest at its ends where
// the film is. It knows no limits and no obstacles; it is there at once.
import { filmOf, headingTo, targetAt, type Film } from "./film";
import { quaternionOf, type Quaternion } from "./camera";
import type { Columns, JsonObject, Plan, Vec3 } from "./types";

export interface Spline {
  times: number[];
  values: number[];
  slopes: number[];
}

// `clamped`: slope 0 at an end; otherwise the second derivative is 0 there. The times increase.
export function splineThrough(
  times: number[], values: number[], clampedStart: boolean, clampedFinish: boolean,
): Spline {
  const n = times.length;
  if (n < 2) return { times, values, slopes: values.map(() => 0) };
  // One row for each slope: lower, diagonal, upper, right side; solved by elimination.
  const lower = new Array<number>(n).fill(0), diagonal = new Array<number>(n).fill(1);
  const upper = new Array<number>(n).fill(0), right = new Array<number>(n).fill(0);
  const at = (list: number[], i: number): number => list[i] as number;
  const step = (i: number): number => at(times, i + 1) - at(times, i);
  const secant = (i: number): number => (at(values, i + 1) - at(values, i)) / step(i);
  if (!clampedStart) {
    diagonal[0] = 2;
    upper[0] = 1;
    right[0] = 3 * secant(0);
  }
  if (!clampedFinish) {
    diagonal[n - 1] = 2;
    lower[n - 1] = 1;
    right[n - 1] = 3 * secant(n - 2);
  }
  for (let i = 1; i < n - 1; ++i) {
    const before = step(i - 1), after = step(i);
    lower[i] = after;
    diagonal[i] = 2 * (before + after);
    upper[i] = before;
    right[i] = 3 * (after * secant(i - 1) + before * secant(i));
  }
  for (let i = 1; i < n; ++i) {
    const factor = at(lower, i) / at(diagonal, i - 1);
    diagonal[i] = at(diagonal, i) - factor * at(upper, i - 1);
    right[i] = at(right, i) - factor * at(right, i - 1);
  }
  const slopes = new Array<number>(n).fill(0);
  for (let i = n - 1; i >= 0; --i) {
    const next = i + 1 < n ? at(upper, i) * at(slopes, i + 1) : 0;
    slopes[i] = (at(right, i) - next) / at(diagonal, i);
  }
  return { times, values, slopes };
}

// Value, first and second derivative. Before and after, the ends.
export function splineAt(spline: Spline, time: number): [number, number, number] {
  const { times, values, slopes } = spline;
  const n = times.length;
  if (n === 0) return [0, 0, 0];
  const first = times[0] as number, last = times[n - 1] as number;
  if (n === 1 || time <= first - 1e-12) return [values[0] as number, 0, 0];
  if (time > last + 1e-12) return [values[n - 1] as number, 0, 0];
  let i = 0;
  while (i + 2 < n && (times[i + 1] as number) <= time) ++i;
  const h = (times[i + 1] as number) - (times[i] as number);
  const u = (time - (times[i] as number)) / h;
  const a = values[i] as number, b = values[i + 1] as number;
  const p = (slopes[i] as number) * h, q = (slopes[i + 1] as number) * h;
  const c2 = 3 * (b - a) - 2 * p - q, c3 = 2 * (a - b) + p + q;
  return [
    a + u * (p + u * (c2 + u * c3)),
    (p + u * (2 * c2 + 3 * u * c3)) / h,
    (2 * c2 + 6 * u * c3) / (h * h),
  ];
}

const MOST_SAMPLES = 600;
const LONGEST_STEP = 0.1;   // s

// Keyframes in the order of their times, those at the time of another left out.
function through(film: Film): Film["keyframes"] {
  const ordered = [...film.keyframes].sort((a, b) => a.time - b.time);
  return ordered.filter((k, i) => i === 0 || k.time - (ordered[i - 1]?.time ?? 0) > 1e-6);
}

export function guessOf(document: JsonObject): Plan {
  const film = filmOf(document);
  const keyframes = through(film);
  const times = keyframes.map((k) => k.time);
  const axes = [0, 1, 2].map((axis) => splineThrough(
    times, keyframes.map((k) => k.position[axis] as number), film.restStart, film.restFinish));
  const count = Math.max(2, Math.min(
    MOST_SAMPLES, Math.ceil(film.duration / LONGEST_STEP) + 1));
  const columns = emptyColumns();
  for (let i = 0; i < count && keyframes.length > 0; ++i) {
    const time = (film.duration * i) / (count - 1);
    const [x, y, z] = axes.map((axis) => splineAt(axis, time)) as
      [[number, number, number], [number, number, number], [number, number, number]];
    const position: Vec3 = [x[0], y[0], z[0]];
    pushSample(columns, time, position, [x[1], y[1], z[1]], [x[2], y[2], z[2]]);
    turn(columns, film, time, position, [x[1], y[1], z[1]]);
  }
  return {
    duration: film.duration, columns, subjects: film.subjects,
    keyframes: film.keyframes.map((k) => ({ time: k.time, position: k.position })),
  };
}

export function emptyColumns(): Columns {
  const columns: Record<string, number[]> = {};
  for (const name of ["time", "x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", "qw", "qx", "qy",
                      "qz"]) columns[name] = [];
  return columns as Columns;
}

export function pushSample(columns: Columns, time: number, p: Vec3, v: Vec3, a: Vec3): void {
  columns.time.push(time);
  ["x", "y", "z"].forEach((axis, i) => {
    columns[axis]?.push(p[i] as number);
    columns[`v${axis}`]?.push(v[i] as number);
    columns[`a${axis}`]?.push(a[i] as number);
  });
}

function turn(columns: Columns, film: Film, time: number, position: Vec3, velocity: Vec3): void {
  const target = targetAt(film, time);
  let yaw: number, pitch = 0;
  if (target) ({ yaw, pitch } = headingTo(position, target));
  else yaw = statedYaw(film, time) ?? Math.atan2(velocity[1], velocity[0]);
  pushView(columns, quaternionOf(yaw, pitch));
}

export function pushView(columns: Columns, q: Quaternion): void {
  ["qw", "qx", "qy", "qz"].forEach((name, i) => columns[name]?.push(q[i] as number));
}

function statedYaw(film: Film, time: number): number | null {
  let yaw: number | null = null;
  for (const keyframe of through(film)) {
    if (keyframe.yaw !== null && (yaw === null || keyframe.time <= time)) yaw = keyframe.yaw;
  }
  return yaw;
}
