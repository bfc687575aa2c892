// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  axesOf, between, boxOf, defaultOptics, horizonOf, project, quaternionOf, scaled, viewOf, type View,
} from "../src/state/camera";
import { keyframeTimes, subjectAt, targetAt, filmOf } from "../src/state/film";
import { nearestTime, placeOf, valueAtTime, viewAt } from "../src/state/samples";
import { guessOf, splineAt, splineThrough } from "../src/state/spline";
import type { Vec3 } from "../src/state/types";

const near = (a: number, b: number, within = 1e-9): void =>
  assert.ok(Math.abs(a - b) <= within, `${a} is not ${b}`);
const nearAll = (a: readonly number[], b: readonly number[], within = 1e-9): void => {
  assert.equal(a.length, b.length);
  a.forEach((v, i) => near(v, b[i] as number, within));
};
const optics = { width: 200, height: 100, fx: 100, fy: 100, cx: 99.5, cy: 49.5 };

test("a quaternion and the axes that it was made of are the same turn", () => {
  for (let yaw = -3.1; yaw < 3.2; yaw += 0.37) {
    for (let pitch = -1.5; pitch <= 1.5; pitch += 0.3) {
      const axes = axesOf(yaw, pitch), view = viewOf([0, 0, 0], quaternionOf(yaw, pitch));
      nearAll(view.right, axes.right);
      nearAll(view.down, axes.down);
      nearAll(view.forward, axes.forward);
    }
  }
});

test("points fall where a pinhole puts them", () => {
  const view: View = { position: [0, 0, 0], ...axesOf(0, 0) };     // looks east
  nearAll(project(view, optics, [10, 0, 0]) as number[], [99.5, 49.5]);
  nearAll(project(view, optics, [10, -1, 0]) as number[], [109.5, 49.5]);   // south is right
  nearAll(project(view, optics, [10, 0, 2]) as number[], [99.5, 29.5]);     // up is up
  assert.equal(project(view, optics, [-1, 0, 0]), null);
  const half = scaled(optics, 100);
  nearAll(project(view, half, [10, -1, 0]) as number[], [54.5, 24.5]);
});

test("the box of a subject holds it", () => {
  const view: View = { position: [0, 0, 0], ...axesOf(0, 0) };
  const box = boxOf(view, optics, [10, 0, 0], 4, 0);
  assert.deepEqual(box, { left: 99.5, top: 29.5, right: 99.5, bottom: 69.5 });
  const wide = boxOf(view, optics, [10, 0, 0], 0, 2);
  assert.ok(wide && wide.right > 109.4 && wide.left < 89.6);
  assert.equal(boxOf(view, optics, [0.5, 0, 0], 0, 2), null);
});

test("the horizon falls and rises with the pitch", () => {
  const level = horizonOf({ position: [0, 0, 9], ...axesOf(1, 0) }, optics);
  near(level?.[0][1] as number, 49.5);
  const down = horizonOf({ position: [0, 0, 9], ...axesOf(1, -0.2) }, optics);
  near(down?.[1][1] as number, 49.5 - 100 * Math.tan(0.2));
  assert.equal(horizonOf({ position: [0, 0, 9], ...axesOf(0, -Math.PI / 2) }, optics), null);
});

test("half of a turn between two views is the view in the middle", () => {
  const q = between(quaternionOf(0.2, 0), quaternionOf(0.6, 0), 0.5);
  nearAll(viewOf([0, 0, 0], q).forward, axesOf(0.4, 0).forward);
  const minus = quaternionOf(0.6, 0).map((v) => -v) as [number, number, number, number];
  nearAll(viewOf([0, 0, 0], between(quaternionOf(0.2, 0), minus, 0.5)).forward,
          axesOf(0.4, 0).forward);
});

test("a spline through a cubic is that cubic", () => {
  // 3 t^2 - 2 t^3 over [0, 1]: 0 to 1, at rest at both ends.
  const spline = splineThrough([0, 0.25, 1], [0, 0.15625, 1], true, true);
  for (const t of [0, 0.1, 0.3, 0.77, 1]) {
    const [value, slope, bend] = splineAt(spline, t);
    near(value, 3 * t * t - 2 * t * t * t);
    near(slope, 6 * t - 6 * t * t);
    near(bend, 6 - 12 * t);
  }
  nearAll(splineAt(spline, -1), [0, 0, 0]);
  nearAll(splineAt(spline, 2), [1, 0, 0]);
});

test("free ends of a spline do not bend, and inner places are smooth", () => {
  const spline = splineThrough([0, 1, 3, 4], [0, 2, -1, 5], false, false);
  near(splineAt(spline, 0)[2], 0);
  near(splineAt(spline, 4)[2], 0);
  for (const t of [1, 3]) {
    nearAll(splineAt(spline, t - 1e-9), splineAt(spline, t + 1e-9), 1e-6);
  }
  nearAll(splineAt(splineThrough([0, 2], [1, 5], false, false), 1), [3, 2, 0]);
  nearAll(splineAt(splineThrough([0], [7], true, true), 0.5), [7, 0, 0]);
});

test("times that a film leaves open are even, or follow from a speed", () => {
  const line: Vec3[] = [[0, 0, 0], [6, 0, 0], [12, 0, 0], [18, 0, 0]];
  assert.deepEqual(keyframeTimes([0, null, null, 9], line, null, null), [0, 3, 6, 9]);
  assert.deepEqual(keyframeTimes([null, null, null, null], line, 30, null), [0, 10, 20, 30]);
  assert.deepEqual(keyframeTimes([null, null, null, null], line, null, 2), [0, 3, 6, 9]);
  assert.deepEqual(keyframeTimes([], [], 5, null), []);
});

test("subjects follow their tracks, cameras the subject that a keyframe names", () => {
  const film = filmOf({
    keyframes: [{ time: 0, position: [0, 0, 0], subject: "a" },
                { time: 4, position: [0, 0, 0] },
                { time: 8, position: [0, 0, 0], look_at: [1, 1, 1] }],
    subjects: [{ name: "a", track: [{ time: 2, position: [0, 0, 0] },
                                    { time: 4, position: [2, 0, 0] }] },
               { name: "b", position: [9, 9, 9] }],
  });
  const [a] = film.subjects;
  assert.ok(a);
  assert.deepEqual(subjectAt(a, 0), [0, 0, 0]);
  assert.deepEqual(subjectAt(a, 3), [1, 0, 0]);
  assert.deepEqual(subjectAt(a, 99), [2, 0, 0]);
  assert.deepEqual(targetAt(film, 3), [1, 0, 0]);
  nearAll(targetAt(film, 6) as Vec3, [1.5, 0.5, 0.5]);
  assert.deepEqual(targetAt(film, 8), [1, 1, 1]);
  assert.equal(targetAt(filmOf({ keyframes: [{ position: [0, 0, 0] }] }), 0), null);
});

test("the guess passes its keyframes and looks at its subject", () => {
  const plan = guessOf({
    duration: 10, subjects: [{ position: [5, 0, 0] }],
    keyframes: [{ time: 0, position: [0, 0, 0] }, { time: 5, position: [5, 5, 5] },
                { time: 10, position: [10, 0, 0] }],
  });
  assert.equal(plan.duration, 10);
  near(valueAtTime(plan.columns, "z", 5) as number, 5);
  near(valueAtTime(plan.columns, "vx", 0) as number, 0);
  const view = viewAt(plan.columns, 5) as View;
  nearAll(view.forward, [0, -Math.SQRT1_2, -Math.SQRT1_2], 1e-6);
  assert.equal(guessOf({ keyframes: [] }).columns.time.length, 0);
  assert.equal(guessOf({}).duration, 0);
});

test("a plan is read between its samples", () => {
  assert.deepEqual(placeOf([0, 1, 2], 1.5), [1, 0.5]);
  assert.deepEqual(placeOf([0, 1, 2], 99), [1, 1]);
  assert.deepEqual(placeOf([0], 1), [0, 0]);
  const columns = { time: [0, 1, 2], x: [0, 2, 8], y: [0, 0, 0], z: [0, 0, 0] };
  assert.equal(valueAtTime(columns, "x", 1.5), 5);
  assert.equal(valueAtTime(columns, "nothing", 1), null);
  assert.equal(nearestTime(columns, [3, 1, 0]), 1);
  assert.equal(defaultOptics.width, 1920);
});
