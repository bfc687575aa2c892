// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { coarseOf } from "../src/state/coarse";

// A hilly sheet of so many squares along each side, red in the west and blue in the east.
function sheet(side: number): { place: Float32Array; tint: Uint8Array } {
  const place: number[] = [], tint: number[] = [];
  const at = (i: number, j: number): number[] => [i / 10, j / 10, Math.sin(i / 9) * Math.cos(j / 7)];
  for (let i = 0; i < side; ++i) {
    for (let j = 0; j < side; ++j) {
      for (const corners of [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]) {
        for (const [a, b] of corners as [number, number][]) {
          place.push(...at(i + a, j + b));
          tint.push(i < side / 2 ? 255 : 0, 0, i < side / 2 ? 0 : 255);
        }
      }
    }
  }
  return { place: Float32Array.from(place), tint: Uint8Array.from(tint) };
}

const area = (place: Float32Array): number => {
  let sum = 0;
  for (let t = 0; t < place.length; t += 9) {
    const p = (k: number): number => place[t + k] as number;
    const [ux, uy, uz, wx, wy, wz] = [p(3) - p(0), p(4) - p(1), p(5) - p(2), p(6) - p(0), p(7) - p(1),
                                      p(8) - p(2)];
    sum += Math.hypot(uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx) / 2;
  }
  return sum;
};

test("a stand-in has few triangles, the same surface and the same colours", () => {
  const full = sheet(300);
  const light = coarseOf(full, 10000);
  assert.ok(light.place.length / 9 <= 10000 && light.place.length / 9 > 2000);
  assert.ok(Math.abs(area(light.place) / area(full.place) - 1) < 0.1);
  for (let k = 0; k < light.place.length; k += 3) {
    const [x, y, z] = [light.place[k] as number, light.place[k + 1] as number, light.place[k + 2] as number];
    assert.ok(Math.abs(z - Math.sin((10 * x) / 9) * Math.cos((10 * y) / 7)) < 0.15);
  }
  const red = light.tint.filter((_, k) => k % 9 === 0).reduce((sum, v) => sum + Number(v > 0), 0);
  assert.ok(Math.abs(red / (light.tint.length / 9) - 0.5) < 0.1);
});

test("few triangles stay nearly as they are, and none are none", () => {
  const few = sheet(4);
  assert.equal(coarseOf(few, 100).place.length, few.place.length);
  assert.equal(coarseOf({ place: [], tint: [] }, 10).place.length, 0);
});
