// SPDX-License-Identifier: Apache-2.0
// A document read as a race course: gates in the order of flight, start and finish; and edits of it.
import { entries } from "./film";
import { rimsOf } from "./rims";
import { emptyColumns, pushSample, pushView, splineAt, splineThrough } from "./spline";
import { quaternionOf } from "./camera";
import type { Edit } from "./edits";
import type { JsonObject, Plan, Vec3 } from "./types";
import { add, distance, minus, mix, rounded, vec } from "./vector";

export interface CourseGate {
  index: number;
  shape: string;
  position: Vec3;
  direction: Vec3 | null;          // unit; null: a ball is passed in any direction
  up: Vec3;
  corners: [number, number][];     // m, left and up; none of a ball
  radius: number;                  // m, of a ball
  tunnel: number;                  // m
}

export interface Course {
  gates: CourseGate[];
  start: Vec3 | null;
  finish: Vec3 | null;
  closed: boolean;
}

const figure = (entry: JsonObject, name: string): number => {
  const value = entry[name];
  return typeof value === "number" && Number.isFinite(value) ? value : 0;
};

// A document with gates is one; a film has none.
export const isCourse = (document: JsonObject): boolean => Array.isArray(document.gates);

export const endNames = ["start", "finish"] as const;

// Yaw is counter-clockwise from east, pitch upwards.
export function directionOf(yawDeg: number, pitchDeg: number): Vec3 {
  const yaw = (yawDeg * Math.PI) / 180, pitch = (pitchDeg * Math.PI) / 180;
  return [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
}

export function courseOf(document: JsonObject): Course {
  const gates = entries(document, "gates").map((entry, index): CourseGate => {
    const shape = typeof entry.shape === "string" ? entry.shape : "";
    const ball = shape === "ball";
    const yaw = figure(entry, "normal_yaw_deg"), pitch = figure(entry, "normal_pitch_deg");
    return {
      index, shape, position: vec(entry.position) ?? [0, 0, 0],
      direction: ball ? null : directionOf(yaw, pitch), up: directionOf(yaw, pitch + 90),
      corners: rimsOf(shape, (name) => figure(entry, name)), radius: figure(entry, "radius"),
      tunnel: figure(entry, "tunnel_length"),
    };
  });
  return { gates, start: vec(document.start), finish: vec(document.finish),
           closed: document.closed === true };
}

// ---- the guess ---------------------------------------------------------------------------------

const SPEED = 8;          // m/s, of a course that is not planned yet
const CLOSEST = 1e-3;     // m between two places that are two
const STEP = 0.05;        // s

// A cubic spline through start, gates and finish, as fast everywhere between two of them.
export function courseGuess(document: JsonObject): Plan {
  const course = courseOf(document);
  const places: Vec3[] = [];
  const pass = (place: Vec3 | null): void => {
    const last = places[places.length - 1];
    if (place && (!last || distance(place, last) > CLOSEST)) places.push(place);
  };
  pass(course.start);
  for (const gate of course.gates) {
    if (!gate.direction || gate.tunnel <= 0) pass(gate.position);
    else for (const half of [-0.5, 0.5]) pass(along(gate.position, gate.direction, half * gate.tunnel));
  }
  pass(course.closed ? places[0] ?? null : course.finish);
  const times = places.map(() => 0);
  places.forEach((place, i) => {
    if (i > 0) times[i] = (times[i - 1] as number) + distance(place, places[i - 1] as Vec3) / SPEED;
  });
  const duration = times[times.length - 1] ?? 0;
  const axes = [0, 1, 2].map((axis) =>
    splineThrough(times, places.map((p) => p[axis] as number), false, false));
  const columns = emptyColumns();
  const count = places.length < 2 ? 0 : Math.max(2, Math.ceil(duration / STEP) + 1);
  for (let i = 0; i < count; ++i) {
    const time = (duration * i) / (count - 1);
    const [x, y, z] = axes.map((axis) => splineAt(axis, time)) as
      [[number, number, number], [number, number, number], [number, number, number]];
    pushSample(columns, time, [x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]);
    pushView(columns, quaternionOf(Math.atan2(y[1], x[1]), 0));
  }
  return { duration, columns, keyframes: [], subjects: [] };
}

const along = (from: Vec3, direction: Vec3, by: number): Vec3 =>
  [from[0] + by * direction[0], from[1] + by * direction[1], from[2] + by * direction[2]];

// ---- edits -------------------------------------------------------------------------------------

const whole = (label: string, list: JsonObject[]): Edit =>
  ({ label, patch: [{ path: "gates", value: list }] });

const wrapped = (degrees: number): number => {
  const turn = ((degrees + 180) % 360 + 360) % 360 - 180;
  return Math.round(turn * 10) / 10;
};

// Degrees counter-clockwise; a ball has nothing to turn.
export function turnedGate(document: JsonObject, index: number, by: number): Edit | null {
  const entry = entries(document, "gates")[index];
  if (!entry || entry.shape === "ball") return null;
  return { label: `Turn gate ${index + 1}`,
           patch: [{ path: `gates[${index + 1}].normal_yaw_deg`,
                     value: wrapped(figure(entry, "normal_yaw_deg") + by) }] };
}

const HEIGHT = 2;         // m, of a new gate above the place
const AHEAD = 6;          // m, of a copy

// One after `index` (-1: the first), facing away from what is flown before it.
export function addedGate(document: JsonObject, index: number, at: Vec3): Edit & { index: number } {
  const course = courseOf(document);
  const list = entries(document, "gates").slice();
  const before = course.gates[index]?.position ?? course.start;
  const position = rounded(add(at, [0, 0, HEIGHT]));
  const way = before ? minus(position, before) : [1, 0, 0] as Vec3;
  const made: JsonObject = {
    name: freeName(list), shape: "rectangle", position, width: 2.4, height: 2.4,
    normal_yaw_deg: wrapped(Math.round((Math.atan2(way[1], way[0]) * 180) / Math.PI)),
  };
  list.splice(index + 1, 0, made);
  return { ...whole(`Add gate ${index + 2}`, list), index: index + 1 };
}

function freeName(list: JsonObject[]): string {
  for (let n = list.length + 1; ; ++n) {
    if (!list.some((entry) => entry.name === `gate ${n}`)) return `gate ${n}`;
  }
}

// Half way to the next gate, or ahead of the last one.
export function copiedGate(document: JsonObject, index: number): (Edit & { index: number }) | null {
  const list = entries(document, "gates").slice();
  const { gates } = courseOf(document);
  const gate = gates[index], next = gates[index + 1];
  const entry = list[index];
  if (!gate || !entry) return null;
  const position = next ? mix(gate.position, next.position, 0.5)
    : along(gate.position, gate.direction ?? [1, 0, 0], AHEAD);
  list.splice(index + 1, 0, { ...entry, name: freeName(list), position: rounded(position) });
  return { ...whole(`Copy gate ${index + 1}`, list), index: index + 1 };
}

// Flown in another order; the gates stay where they are.
export function reorderedGate(document: JsonObject, index: number, by: -1 | 1): Edit | null {
  const list = entries(document, "gates").slice();
  const a = list[index], b = list[index + by];
  if (!a || !b) return null;
  list[index] = b;
  list[index + by] = a;
  return whole(`Swap gates ${Math.min(index, index + by) + 1} and ${
    Math.max(index, index + by) + 1}`, list);
}

const sizesOf: Record<string, string[]> = {
  ball: ["radius"], rectangle: ["width", "height"], triangle: ["width", "height"],
  pentagon: ["radius", "side"], hexagon: ["radius", "side"],
};

export const gateShapes = Object.keys(sizesOf);

// The sizes that a gate states, or that its shape needs.
export function gateSizes(entry: JsonObject): string[] {
  const all = sizesOf[String(entry.shape)] ?? [];
  const stated = all.filter((name) => entry[name] !== undefined);
  return all.includes("side") ? stated.slice(0, 1) : all;
}

// As wide as before.
export function reshapedGate(document: JsonObject, index: number, shape: string): Edit | null {
  const list = entries(document, "gates").slice();
  const entry = list[index];
  if (!entry || !sizesOf[shape] || entry.shape === shape) return null;
  const width = figure(entry, "width") || 2 * figure(entry, "radius") || 2 * figure(entry, "side");
  const { width: _w, height: _h, radius: _r, side: _s, normal_yaw_deg: yaw, normal_pitch_deg: _p,
          tunnel_length: _t, ...rest } = entry;
  const made: JsonObject = { ...rest, shape };
  if (sizesOf[shape]?.includes("width")) {
    made.width = width;
    made.height = figure(entry, "height") || width;
  } else {
    made.radius = Math.round(width * 500) / 1000;
  }
  if (shape !== "ball") made.normal_yaw_deg = yaw ?? 0;
  list[index] = made;
  return whole(`Shape of gate ${index + 1}`, list);
}
