// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { applied, equal, parsePath, valueAt } from "../src/state/document";
import { GestureQueue } from "../src/state/queue";
import type { JsonObject } from "../src/state/types";

const film: JsonObject = {
  duration: 20, solver: "iqp",
  keyframes: [{ time: 0, position: [1, 2, 3] }, { time: 5, position: [4, 5, 6] }],
};

test("paths are read as --set reads them", () => {
  assert.deepEqual(parsePath("keyframes[2].position"), ["keyframes", 1, "position"]);
  assert.deepEqual(parsePath("weights.yaw"), ["weights", "yaw"]);
  assert.deepEqual(parsePath("a[1][3]"), ["a", 0, 2]);
  for (const bad of ["", ".", "a.", "a..b", "a[0]", "a[x]", "a[1]b", "[1]x", "a[", "a.[1]"]) {
    assert.throws(() => parsePath(bad), /path/, bad);
  }
});

test("a patch sets and removes, and leaves what it was made from alone", () => {
  const next = applied(film, [
    { path: "keyframes[2].position", value: [7, 8, 9] },
    { path: "margin", value: 1 }, { path: "weights.yaw", value: 2 }, { path: "duration", remove: true },
  ]);
  assert.deepEqual(valueAt(next, "keyframes[2].position"), [7, 8, 9]);
  assert.equal(valueAt(next, "weights.yaw"), 2);
  assert.equal("duration" in next, false);
  assert.deepEqual(valueAt(film, "keyframes[2].position"), [4, 5, 6]);
  assert.equal(film.duration, 20);
  assert.equal(next.keyframes === film.keyframes, false);
});

test("a plugin by its name becomes a table when a parameter is set", () => {
  assert.deepEqual(applied(film, [{ path: "solver.iterations", value: 9 }]).solver,
                   { type: "iqp", iterations: 9 });
});

test("entries are added at the end alone, and no path leads through a number", () => {
  const next = applied(film, [{ path: "keyframes[3]", value: { position: [0, 0, 0] } }]);
  assert.equal((next.keyframes as []).length, 3);
  assert.throws(() => applied(film, [{ path: "keyframes[4]", value: {} }]), /2 entries/);
  assert.throws(() => applied(film, [{ path: "keyframes[3]", remove: true }]), /2 entries/);
  assert.throws(() => applied(film, [{ path: "duration.x", value: 1 }]), /inside a value/);
});

test("documents are equal by value", () => {
  assert.ok(equal(film, JSON.parse(JSON.stringify(film))));
  assert.ok(!equal(film, applied(film, [{ path: "duration", value: 21 }])));
  assert.ok(!equal({ a: 1 }, { b: 1 }));
  assert.ok(!equal([1, 2], [1]));
});

test("gestures outlive a reload, and damage of what was kept", () => {
  let kept: string | null = null;
  const store = { read: () => kept, write: (text: string) => { kept = text; } };
  const queue = new GestureQueue(store);
  queue.add({ type: "gesture", id: "a", base: 1, patch: [{ path: "duration", value: 30 }] });
  queue.add({ type: "undo", id: "b", base: 1 });
  const again = new GestureQueue(store);
  assert.deepEqual(again.all().map((g) => g.id), ["a", "b"]);
  assert.equal(again.onto(film).duration, 30);
  assert.equal(again.settle("a"), true);
  assert.equal(again.settle("a"), false);
  assert.equal(new GestureQueue(store).size, 1);
  for (const bad of ["{", "7", "null", '[{"id":3}]', '[null]']) {
    kept = bad;
    assert.equal(new GestureQueue(store).size, 0, bad);
  }
});

test("a waiting patch that fits no longer is left out of the display", () => {
  const queue = new GestureQueue();
  queue.add({ type: "gesture", id: "a", base: 0, patch: [{ path: "keyframes[9].time", value: 1 }] });
  assert.deepEqual(queue.onto(film), film);
});
