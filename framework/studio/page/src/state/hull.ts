// SPDX-License-Identifier: Apache-2.0
// The surface at a distance from another one: every face is moved along its normal, and a corner goes
// where its faces then meet. Edges stay sharp, so that nothing within the distance is outside.
import type { Triangles } from "./shapes";

const SHARPEST = 4;     // times the distance that a corner may go
const WELDED = 1e3;     // corners nearer than a millimetre are one

export function offset({ positions, triangles }: Triangles, by: number): Triangles {
  const place = (i: number, k: number): number => positions[3 * i + k] as number;
  // Corners that lie at one place are one.
  const known = new Map<string, number>(), corner: number[] = [], first: number[] = [];
  for (let i = 0; i < positions.length / 3; ++i) {
    const key = [0, 1, 2].map((k) => Math.round(place(i, k) * WELDED)).join();
    let found = known.get(key);
    if (found === undefined) {
      found = first.length;
      known.set(key, found);
      first.push(i);
    }
    corner.push(found);
  }
  const normals: [number, number, number][][] = first.map(() => []);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]] as
      [number, number, number];
    const u = [0, 1, 2].map((k) => place(b, k) - place(a, k));
    const v = [0, 1, 2].map((k) => place(c, k) - place(a, k));
    const n = cross(u as Three, v as Three);
    const size = Math.hypot(...n);
    if (size < 1e-12) continue;
    const unit: Three = [n[0] / size, n[1] / size, n[2] / size];
    for (const i of [a, b, c]) {
      const list = normals[corner[i] as number] as Three[];
      if (!list.some((other) => dot(other, unit) > 0.9999)) list.push(unit);
    }
  }
  const moved = new Float32Array(first.length * 3);
  first.forEach((i, k) => {
    const way = meeting(normals[k] as Three[], by);
    for (let axis = 0; axis < 3; ++axis) moved[3 * k + axis] = place(i, axis) + (way[axis] as number);
  });
  return { positions: moved, triangles: Uint32Array.from(triangles, (i) => corner[i] as number) };
}

type Three = [number, number, number];

const dot = (a: Three, b: Three): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Three, b: Three): Three =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// The shortest move d with n.d = by for all normals, by least squares; a little damping decides where
// they leave a direction open.
function meeting(normals: Three[], by: number): Three {
  if (normals.length === 0) return [0, 0, 0];
  const m = [[1e-6, 0, 0], [0, 1e-6, 0], [0, 0, 1e-6]], right = [0, 0, 0];
  for (const n of normals) {
    for (let i = 0; i < 3; ++i) {
      (right as Three)[i as 0] += (n[i] as number) * by;
      for (let j = 0; j < 3; ++j) {
        (m[i] as number[])[j] = ((m[i] as number[])[j] as number) +
          (n[i] as number) * (n[j] as number);
      }
    }
  }
  const way = solved(m as [Three, Three, Three], right as Three);
  const size = Math.hypot(...way), most = SHARPEST * Math.abs(by);
  return size > most ? [way[0] * most / size, way[1] * most / size, way[2] * most / size] : way;
}

// By Cramer's rule; the matrix is positive definite.
function solved([a, b, c]: [Three, Three, Three], right: Three): Three {
  const whole = dot(a, cross(b, c));
  const column = (k: number): number => {
    const put = (row: Three, value: number): Three => {
      const next = row.slice() as Three;
      next[k as 0] = value;
      return next;
    };
    return dot(put(a, right[0]), cross(put(b, right[1]), put(c, right[2]))) / whole;
  };
  return [column(0), column(1), column(2)];
}
