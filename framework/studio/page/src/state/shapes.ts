// SPDX-License-Identifier: Apache-2.0
// Obstacles of a document: their triangles, drawn at once while they are dragged, and what moving
// one changes. Shapes of meshes and maps come from the server as blobs.
import { rounded, add, vec } from "./vector";
import type { JsonObject, Json, Patch, Vec3 } from "./types";

export interface Triangles {
  positions: Float32Array;     // x, y, z
  triangles: Uint32Array;
}

class Builder {
  private points: number[] = [];
  private corners: number[] = [];

  point(x: number, y: number, z: number): number {
    this.points.push(x, y, z);
    return this.points.length / 3 - 1;
  }
  face(a: number, b: number, c: number): void {
    this.corners.push(a, b, c);
  }
  // Rings of equal length, from below to above, with both ends closed.
  rings(rings: Vec3[][]): Triangles {
    const n = rings[0]?.length ?? 0;
    const first = rings.map((ring) => {
      const start = this.points.length / 3;
      for (const p of ring) this.point(...p);
      return start;
    });
    for (let k = 0; k + 1 < first.length; ++k) {
      const low = first[k] as number, high = first[k + 1] as number;
      for (let i = 0; i < n; ++i) {
        const j = (i + 1) % n;
        this.face(low + i, low + j, high + j);
        this.face(low + i, high + j, high + i);
      }
    }
    for (let i = 1; i + 1 < n; ++i) {
      const low = first[0] as number, high = first[first.length - 1] as number;
      this.face(low, low + i + 1, low + i);
      this.face(high, high + i, high + i + 1);
    }
    return this.done();
  }
  done(): Triangles {
    return {
      positions: new Float32Array(this.points), triangles: new Uint32Array(this.corners),
    };
  }
}

const SIDES = 32;

function circle(center: Vec3, radius: number, a: Vec3, b: Vec3): Vec3[] {
  return Array.from({ length: SIDES }, (_, i) => {
    const angle = (2 * Math.PI * i) / SIDES, c = Math.cos(angle) * radius;
    const s = Math.sin(angle) * radius;
    return [0, 1, 2].map((k) =>
      (center[k] as number) + c * (a[k] as number) + s * (b[k] as number)) as Vec3;
  });
}

const EAST: Vec3 = [1, 0, 0], NORTH: Vec3 = [0, 1, 0];

// A ball, or two half balls around the ends of a line.
function capsule(from: Vec3, to: Vec3, radius: number): Triangles {
  const d: Vec3 = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
  const size = Math.hypot(...d);
  const axis: Vec3 = size > 1e-9 ? [d[0] / size, d[1] / size, d[2] / size] : [0, 0, 1];
  const other: Vec3 = Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : EAST;
  const cross = (a: Vec3, b: Vec3): Vec3 =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const raw = cross(other, axis), rawSize = Math.hypot(...raw);
  const a: Vec3 = [raw[0] / rawSize, raw[1] / rawSize, raw[2] / rawSize];
  const b = cross(axis, a);
  const rings: Vec3[][] = [];
  for (const [end, start, finish] of [[from, -90, 0], [to, 0, 90]] as [Vec3, number, number][]) {
    for (let angle = start; angle <= finish; angle += 15) {
      const up = radius * Math.sin((angle * Math.PI) / 180);
      const across = Math.max(radius * Math.cos((angle * Math.PI) / 180), radius * 1e-3);
      rings.push(circle(add(end, [axis[0] * up, axis[1] * up, axis[2] * up]), across, a, b));
    }
  }
  return new Builder().rings(rings);
}

function box(lower: Vec3, upper: Vec3): Triangles {
  const ring = (z: number): Vec3[] => [
    [lower[0], lower[1], z], [upper[0], lower[1], z], [upper[0], upper[1], z],
    [lower[0], upper[1], z]];
  return new Builder().rings([ring(lower[2]), ring(upper[2])]);
}

const OPEN = 40;   // m, how far a side without an end is drawn

// A polygon that need not be convex is cut by its ears.
function prism(corners: [number, number][], floor: number, ceiling: number): Triangles {
  const made = new Builder();
  const area = corners.reduce((sum, p, i) => {
    const q = corners[(i + 1) % corners.length] as [number, number];
    return sum + p[0] * q[1] - q[0] * p[1];
  }, 0);
  const ring = area < 0 ? [...corners].reverse() : corners;
  const low = ring.map(([x, y]) => made.point(x, y, floor));
  const high = ring.map(([x, y]) => made.point(x, y, ceiling));
  ring.forEach((_, i) => {
    const j = (i + 1) % ring.length;
    made.face(low[i] as number, low[j] as number, high[j] as number);
    made.face(low[i] as number, high[j] as number, high[i] as number);
  });
  for (const [a, b, c] of ears(ring)) {
    made.face(low[a] as number, low[c] as number, low[b] as number);
    made.face(high[a] as number, high[b] as number, high[c] as number);
  }
  return made.done();
}

function ears(ring: [number, number][]): [number, number, number][] {
  const left = ring.map((_, i) => i);
  const found: [number, number, number][] = [];
  const at = (i: number): [number, number] => ring[i] as [number, number];
  const turn = (a: number, b: number, c: number): number =>
    (at(b)[0] - at(a)[0]) * (at(c)[1] - at(a)[1]) - (at(b)[1] - at(a)[1]) * (at(c)[0] - at(a)[0]);
  while (left.length > 2) {
    let cut = -1;
    for (let k = 0; k < left.length && cut < 0; ++k) {
      const a = left[(k + left.length - 1) % left.length] as number, b = left[k] as number;
      const c = left[(k + 1) % left.length] as number;
      if (turn(a, b, c) <= 0) continue;
      const inside = left.some((p) => p !== a && p !== b && p !== c &&
        turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0);
      if (!inside) cut = k;
    }
    if (cut < 0) cut = 0;
    found.push([left[(cut + left.length - 1) % left.length] as number, left[cut] as number,
                left[(cut + 1) % left.length] as number]);
    left.splice(cut, 1);
  }
  return found;
}

const number = (value: Json | undefined, otherwise: number): number =>
  typeof value === "number" && Number.isFinite(value) ? value : otherwise;

export function cornersOf(value: Json | undefined): [number, number][] {
  if (!Array.isArray(value)) return [];
  const flat = value.flat().filter((v): v is number => typeof v === "number");
  return Array.from({ length: Math.floor(flat.length / 2) }, (_, i) =>
    [flat[2 * i] as number, flat[2 * i + 1] as number]);
}

// As a document has them, to the millimetre.
export const flatCorners = (corners: [number, number][]): number[] =>
  corners.flat().map((v) => Math.round(v * 1000) / 1000);

// Null for shapes that only the server can draw, and for values that make none.
export function trianglesOf(obstacle: JsonObject): Triangles | null {
  const radius = number(obstacle.radius, 0);
  const point = (name: string): Vec3 | null => vec(obstacle[name]);
  const base = point("base");
  switch (obstacle.type) {
    case "sphere": {
      const center = point("center");
      return center && radius > 0 ? capsule(center, center, radius) : null;
    }
    case "capsule": {
      const from = point("from"), to = point("to");
      return from && to && radius > 0 ? capsule(from, to, radius) : null;
    }
    case "box": {
      const lower = point("lower"), upper = point("upper");
      return lower && upper ? box(lower, upper) : null;
    }
    case "cylinder":
    case "cone": {
      const height = number(obstacle.height, 0);
      if (!base || radius <= 0 || height <= 0) return null;
      const top = obstacle.type === "cone" ? radius * 1e-3 : radius;
      return new Builder().rings([circle(base, radius, EAST, NORTH),
        circle([base[0], base[1], base[2] + height], top, EAST, NORTH)]);
    }
    case "prism":
    case "no_fly_zone": {
      const corners = cornersOf(obstacle.corners);
      if (corners.length < 3) return null;
      const floor = number(obstacle.floor, 0);
      return prism(corners, floor, number(obstacle.ceiling, floor + OPEN));
    }
    default:
      return null;
  }
}

const anchors: Record<string, string[]> = {
  sphere: ["center"], capsule: ["from", "to"], box: ["lower", "upper"], cylinder: ["base"],
  cone: ["base"], half_space: ["point"],
};

// Where its handle is; null where it cannot be moved.
export function handleOf(obstacle: JsonObject): Vec3 | null {
  const type = String(obstacle.type);
  if (type === "prism" || type === "no_fly_zone") {
    const corners = cornersOf(obstacle.corners);
    if (corners.length === 0) return null;
    const sum = corners.reduce((a, c) => [a[0] + c[0], a[1] + c[1]], [0, 0]);
    return [sum[0] / corners.length, sum[1] / corners.length, number(obstacle.floor, 0)];
  }
  const points = (anchors[type] ?? []).map((name) => vec(obstacle[name]));
  if (points.length === 0 || points.some((p) => p === null)) return null;
  const known = points as Vec3[];
  return [0, 1, 2].map((k) =>
    known.reduce((sum, p) => sum + (p[k] as number), 0) / known.length) as Vec3;
}

export function movedObstacle(obstacle: JsonObject, path: string, by: Vec3): Patch {
  const type = String(obstacle.type);
  if (type === "prism" || type === "no_fly_zone") {
    const corners = cornersOf(obstacle.corners).flatMap(([x, y]) => [x + by[0], y + by[1]]);
    const patch: Patch = [{ path: `${path}.corners`,
                            value: corners.map((v) => Math.round(v * 1000) / 1000) }];
    for (const level of ["floor", "ceiling"]) {
      const value = obstacle[level];
      if (typeof value === "number" && by[2] !== 0) {
        patch.push({ path: `${path}.${level}`, value: Math.round((value + by[2]) * 1000) / 1000 });
      }
    }
    return patch;
  }
  return (anchors[type] ?? []).flatMap((name) => {
    const point = vec(obstacle[name]);
    return point ? [{ path: `${path}.${name}`, value: rounded(add(point, by)) }] : [];
  });
}
