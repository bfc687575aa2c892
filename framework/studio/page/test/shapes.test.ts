// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { trianglesIn } from "../src/state/blob";
import { offset } from "../src/state/hull";
import { handleOf, trianglesOf, type Triangles } from "../src/state/shapes";

// The volume that closed triangles bound, by the divergence theorem; positive if they face out.
function volume({ positions: p, triangles: t }: Triangles): number {
  let sum = 0;
  for (let i = 0; i < t.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => {
      const at = 3 * (t[i + k] as number);
      return [p[at] as number, p[at + 1] as number, p[at + 2] as number];
    }) as [number[], number[], number[]];
    const [ax, ay, az] = a as [number, number, number], [bx, by, bz] = b as [number, number, number];
    const [cx, cy, cz] = c as [number, number, number];
    sum += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  }
  return sum / 6;
}

const near = (a: number, b: number, share: number): void =>
  assert.ok(Math.abs(a - b) <= share * Math.abs(b), `${a} is not ${b}`);

test("shapes are closed, face outwards and have their volume", () => {
  const v = (shape: Parameters<typeof trianglesOf>[0]): number => {
    const made = trianglesOf(shape);
    assert.ok(made);
    return volume(made);
  };
  near(v({ type: "box", lower: [1, 1, 1], upper: [3, 4, 5] }), 24, 1e-6);
  near(v({ type: "sphere", center: [9, 9, 9], radius: 2 }), (4 / 3) * Math.PI * 8, 0.05);
  near(v({ type: "capsule", from: [0, 0, 0], to: [0, 6, 0], radius: 1 }),
       Math.PI * 6 + (4 / 3) * Math.PI, 0.05);
  near(v({ type: "cylinder", base: [0, 0, 0], radius: 2, height: 3 }), Math.PI * 12, 0.02);
  near(v({ type: "cone", base: [0, 0, 0], radius: 2, height: 3 }), Math.PI * 4, 0.02);
  near(v({ type: "prism", corners: [0, 0, 4, 0, 4, 4, 0, 4], floor: 1, ceiling: 3 }), 32, 1e-6);
});

test("a polygon with a notch is cut right, in either direction", () => {
  const notch = [0, 0, 4, 0, 4, 4, 2, 1, 0, 4];
  const area = 16 - 6;      // less the notch of base 4 and depth 3
  for (const corners of [notch, [0, 4, 2, 1, 4, 4, 4, 0, 0, 0]]) {
    const made = trianglesOf({ type: "no_fly_zone", corners, floor: 0, ceiling: 1 });
    assert.ok(made);
    near(volume(made), area, 1e-6);
  }
});

test("what makes no shape is not drawn", () => {
  for (const bad of [{ type: "sphere", center: [0, 0, 0], radius: -1 }, { type: "sphere" },
                     { type: "box", lower: [0, 0, 0] }, { type: "prism", corners: [0, 0, 1, 1] },
                     { type: "mesh", file: "x.ply" }, { type: "cone", base: [0, 0, 0], radius: 1 }]) {
    assert.equal(trianglesOf(bad as never), null);
  }
  assert.equal(handleOf({ type: "mesh" }), null);
  assert.deepEqual(handleOf({ type: "capsule", from: [0, 0, 0], to: [2, 0, 4], radius: 1 }), [1, 0, 2]);
});

function blob(vertices: number, corners: number[], claim = vertices): ArrayBuffer {
  const bytes = new ArrayBuffer(16 + 12 * vertices + 4 * corners.length);
  const view = new DataView(bytes);
  [..."WLB1"].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  view.setUint32(4, claim, true);
  view.setUint32(8, corners.length / 3, true);
  for (let i = 0; i < 3 * vertices; ++i) view.setFloat32(16 + 4 * i, i, true);
  corners.forEach((c, i) => view.setUint32(16 + 12 * vertices + 4 * i, c, true));
  return bytes;
}

test("blobs are read, and damaged ones are not", () => {
  const read = trianglesIn(blob(3, [0, 1, 2]));
  assert.deepEqual([...read.triangles], [0, 1, 2]);
  assert.equal(read.positions[8], 8);
  assert.throws(() => trianglesIn(blob(3, [0, 1, 3])), /vertex 3 of 3/);
  assert.throws(() => trianglesIn(blob(3, [0, 1, 2], 4)), /are not/);
  assert.throws(() => trianglesIn(blob(3, [0, 1, 2], 4e9)), /are not/);
  assert.throws(() => trianglesIn(new ArrayBuffer(3)), /no triangles/);
  assert.throws(() => trianglesIn(new ArrayBuffer(64)), /no triangles/);
});

test("a hull has its faces at the distance", () => {
  const of = (obstacle: object, by: number): Triangles =>
    offset(trianglesOf(obstacle as never) as Triangles, by);
  const extent = ({ positions }: Triangles, axis: number): [number, number] => {
    const list = [...positions].filter((_, i) => i % 3 === axis);
    return [Math.min(...list), Math.max(...list)];
  };
  const near = (a: number, b: number, within = 1e-4): void =>
    assert.ok(Math.abs(a - b) < within, `${a} is not ${b}`);
  const box = of({ type: "box", lower: [0, 0, 0], upper: [2, 4, 6] }, 0.5);
  near(volume(box), 3 * 5 * 7, 1e-2);
  // Inwards, as of what a flight stays inside of.
  near(volume(of({ type: "box", lower: [0, 0, 0], upper: [2, 4, 6] }, -0.5)), 1 * 3 * 5, 1e-2);
  const ball = of({ type: "sphere", center: [1, 2, 3], radius: 2 }, 0.5);
  for (let i = 0; i < ball.positions.length; i += 3) {
    const [x, y, z] = ball.positions.slice(i, i + 3) as unknown as [number, number, number];
    near(Math.hypot(x - 1, y - 2, z - 3), 2.5, 0.05);
  }
  // A polygon with a bay: the sides of the bay come nearer to each other.
  const bay = of({ type: "prism", corners: [0, 0, 9, 0, 9, 9, 6, 9, 6, 3, 3, 3, 3, 9, 0, 9],
                   floor: 0, ceiling: 2 }, 0.5);
  near(volume(bay), (10 * 10 - 2 * 6) * 3, 1e-2);
  assert.deepEqual(extent(bay, 2).map((v) => Math.round(v * 100) / 100), [-0.5, 2.5]);
  const column = of({ type: "cylinder", base: [0, 0, 0], radius: 2, height: 4 }, 0.5);
  near(extent(column, 0)[1], 2.5, 0.02);
  near(extent(column, 2)[1], 4.5);
});
