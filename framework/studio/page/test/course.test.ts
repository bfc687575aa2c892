// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  addedGate, copiedGate, courseGuess, courseOf, gateSizes, isCourse, reorderedGate, reshapedGate,
  turnedGate,
} from "../src/state/course";
import { applied, valueAt } from "../src/state/document";
import { deleted, entryOf, moved, nameOf, placeOfItem, type Edit } from "../src/state/edits";
import { rimsOf } from "../src/state/rims";
import { positionAt } from "../src/state/samples";
import type { JsonObject, Vec3 } from "../src/state/types";

const race: JsonObject = {
  start: [0, 0, 1], finish: [20, 0, 1], closed: false,
  gates: [
    { name: "window", shape: "rectangle", position: [5, 0, 2], normal_yaw_deg: 0, width: 2, height: 1 },
    { name: "pipe", shape: "hexagon", position: [10, 5, 2], normal_yaw_deg: 90, side: 1,
      tunnel_length: 4 },
    { name: "buoy", shape: "ball", position: [15, 0, 2], radius: 0.5 },
  ],
};
const after = (edit: Edit | null): JsonObject => {
  assert.ok(edit);
  return applied(race, edit.patch);
};
const close = (a: number[], b: number[]): void =>
  a.forEach((v, i) => assert.ok(Math.abs(v - (b[i] as number)) < 1e-9, `${a} is not ${b}`));

test("a document with gates is a course", () => {
  assert.ok(isCourse(race));
  assert.ok(!isCourse({ keyframes: [], start: "rest" }));
  const { gates, start, finish } = courseOf(race);
  assert.deepEqual([start, finish], [[0, 0, 1], [20, 0, 1]]);
  close(gates[0]?.direction as Vec3, [1, 0, 0]);
  close(gates[1]?.direction as Vec3, [0, 1, 0]);
  close(gates[1]?.up as Vec3, [0, 0, 1]);
  assert.equal(gates[2]?.direction, null);
  assert.deepEqual(gates[0]?.corners, [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]);
});

test("regular rims have the stated side or radius, and stand on a flat side", () => {
  for (const [shape, count] of [["pentagon", 5], ["hexagon", 6]] as const) {
    const bySide = rimsOf(shape, (name) => (name === "side" ? 2 : 0));
    assert.equal(bySide.length, count);
    bySide.forEach(([x, y], i) => {
      const [u, v] = bySide[(i + 1) % count] as [number, number];
      assert.ok(Math.abs(Math.hypot(u - x, v - y) - 2) < 1e-9);
    });
    const [first, last] = [bySide[0], bySide[count - 1]] as [[number, number], [number, number]];
    assert.ok(Math.abs(first[1] - last[1]) < 1e-9);
    assert.equal(Math.min(...bySide.map(([, y]) => y)), Math.min(first[1], last[1]));
    for (const [x, y] of rimsOf(shape, (name) => (name === "radius" ? 3 : 0))) {
      assert.ok(Math.abs(Math.hypot(x, y) - 3) < 1e-9);
    }
  }
  assert.deepEqual(rimsOf("ball", () => 1), []);
});

test("the guess passes start, gates in their order, both ends of a tunnel, and finish", () => {
  const { columns, duration } = courseGuess(race);
  const times = [[0, 0, 1], [5, 0, 2], [10, 3, 2], [10, 7, 2], [15, 0, 2], [20, 0, 1]].map((p) => {
    let best = Infinity, at = 0;
    for (let t = 0; t <= duration; t += duration / 4000) {
      const d = Math.hypot(...(positionAt(columns, t) as Vec3).map((v, i) => v - (p[i] as number)));
      if (d < best) [best, at] = [d, t];
    }
    assert.ok(best < 0.15, `${best} m from ${p}`);
    return at;
  });
  times.forEach((t, i) => assert.ok(i === 0 || t > (times[i - 1] as number)));
  const round = courseGuess({ closed: true, gates: race.gates as JsonObject[] });
  const first = positionAt(round.columns, 0) as Vec3;
  close(positionAt(round.columns, round.duration) as Vec3, first);
});

test("a course of one place, or of none, has no guess", () => {
  for (const gates of [[], [{ shape: "ball", position: [1, 1, 1], radius: 1 }]] as JsonObject[][]) {
    assert.equal(courseGuess({ gates }).columns.time.length, 0);
  }
});

test("gates and ends move and have names", () => {
  const gate = { kind: "gate", index: 1 } as const, start = { kind: "end", index: 0 } as const;
  assert.equal(nameOf(race, gate), "gate pipe");
  assert.equal(nameOf(race, start), "start");
  assert.deepEqual(valueAt(after(moved(race, gate, [1, 2, 3.00049])), "gates[2].position"), [1, 2, 3]);
  assert.deepEqual(valueAt(after(moved(race, start, [1, 2, 3])), "start"), [1, 2, 3]);
  assert.deepEqual(placeOfItem(race, { kind: "end", index: 1 }), [20, 0, 1]);
  assert.equal(entryOf({ ...race, start: null }, start), null);
  // The start of a film is a word, no place.
  assert.equal(entryOf({ start: "rest" }, start), null);
  assert.equal(moved({ start: "rest" }, start, [0, 0, 0]), null);
});

test("gates turn within half a turn; balls do not", () => {
  const yaw = (by: number): unknown => valueAt(after(turnedGate(race, 1, by)), "gates[2].normal_yaw_deg");
  assert.deepEqual([yaw(5), yaw(100), yaw(-280)], [95, -170, 170]);
  assert.equal(turnedGate(race, 2, 5), null);
  assert.equal(turnedGate(race, 9, 5), null);
});

test("gates are added, copied, ordered and deleted", () => {
  const names = (document: JsonObject): unknown[] =>
    (document.gates as JsonObject[]).map((gate) => gate.name);
  const made = addedGate(race, 0, [5, 6, 0]);
  assert.deepEqual(names(after(made)), ["window", "gate 4", "pipe", "buoy"]);
  assert.equal(valueAt(after(made), "gates[2].normal_yaw_deg"), 90);   // away from the one before
  assert.deepEqual(valueAt(after(made), "gates[2].position"), [5, 6, 2]);
  assert.deepEqual(names(after(addedGate(race, -1, [1, 0, 0]))), ["gate 4", "window", "pipe", "buoy"]);
  const copy = copiedGate(race, 2);
  assert.deepEqual(names(after(copy)), ["window", "pipe", "buoy", "gate 4"]);
  assert.deepEqual(valueAt(after(copiedGate(race, 0)), "gates[2].position"), [7.5, 2.5, 2]);
  assert.deepEqual(names(after(reorderedGate(race, 0, 1))), ["pipe", "window", "buoy"]);
  assert.equal(reorderedGate(race, 0, -1), null);
  assert.deepEqual(names(after(deleted(race, { kind: "gate", index: 1 }))), ["window", "buoy"]);
  assert.equal(deleted({ gates: [{}] }, { kind: "gate", index: 0 }), null);
  assert.equal(deleted(race, { kind: "end", index: 0 }), null);
});

test("another shape has its own sizes alone", () => {
  const gate = (index: number, shape: string): JsonObject =>
    valueAt(after(reshapedGate(race, index, shape)), `gates[${index + 1}]`) as JsonObject;
  assert.deepEqual(gate(0, "ball"), { name: "window", shape: "ball", position: [5, 0, 2], radius: 1 });
  assert.deepEqual(gate(2, "rectangle"), { name: "buoy", shape: "rectangle", position: [15, 0, 2],
                                           width: 1, height: 1, normal_yaw_deg: 0 });
  assert.equal(gate(0, "pentagon").radius, 1);
  assert.equal(reshapedGate(race, 0, "rectangle"), null);
  assert.equal(reshapedGate(race, 0, "star"), null);
  assert.deepEqual(gateSizes(race.gates && (race.gates as JsonObject[])[1] as JsonObject), ["side"]);
});
