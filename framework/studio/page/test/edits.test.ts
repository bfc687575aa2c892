// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { applied, valueAt } from "../src/state/document";
import {
  addedCorner, addedObstacle, addedSubject, corneredItem, obstacleKinds, appended, cutAt, deleted, duplicated, inserted, moved, nameOf,
  placeOfItem, reordered, retimed, slowed, timeRange, uncut, type Edit,
} from "../src/state/edits";
import { trianglesOf } from "../src/state/shapes";
import { freeGround, holds, lifted } from "../src/state/room";
import { shots, simplified, withShot, withStroke } from "../src/state/shots";
import type { JsonObject, Vec3 } from "../src/state/types";

const film: JsonObject = {
  duration: 20,
  keyframes: [{ time: 0, position: [0, 0, 2] }, { time: 10, position: [10, 0, 4], look_at: [1, 1, 1] },
              { time: 20, position: [20, 0, 2] }],
  subjects: [{ position: [5, 5, 1], track: [] },
             { name: "b", track: [{ time: 0, position: [0, 0, 0] }, { time: 4, position: [1, 0, 0] }] }],
  obstacles: [{ type: "sphere", name: "ball", center: [1, 2, 3], radius: 2 },
              { type: "box", lower: [0, 0, 0], upper: [2, 2, 2] },
              { type: "prism", corners: [0, 0, 4, 0, 4, 4], floor: 1, ceiling: 9 },
              { type: "mesh", file: "a.ply" }],
};
const after = (edit: Edit | null): JsonObject => {
  assert.ok(edit);
  return applied(film, edit.patch);
};
const near = (a: number, b: number): void => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);
const times = (document: JsonObject): unknown[] =>
  (document.keyframes as JsonObject[]).map((k) => k.time);

test("everything with a place moves", () => {
  const to = (kind: "keyframe" | "look" | "subject" | "obstacle", index: number): JsonObject =>
    after(moved(film, { kind, index }, [9, 8, 7.00049]));
  assert.deepEqual(valueAt(to("keyframe", 1), "keyframes[2].position"), [9, 8, 7]);
  assert.deepEqual(valueAt(to("look", 1), "keyframes[2].look_at"), [9, 8, 7]);
  assert.deepEqual(valueAt(to("subject", 0), "subjects[1].position"), [9, 8, 7]);
  assert.deepEqual(valueAt(to("obstacle", 0), "obstacles[1].center"), [9, 8, 7]);
  const box = to("obstacle", 1);
  assert.deepEqual(valueAt(box, "obstacles[2].lower"), [8, 7, 6]);
  assert.deepEqual(valueAt(box, "obstacles[2].upper"), [10, 9, 8]);
  const track = to("subject", 1);
  assert.deepEqual(valueAt(track, "subjects[2].track[2].position"), [10, 8, 7]);
  const one = after(moved(film, { kind: "track", index: 1, point: 1 }, [3, 3, 3]));
  assert.deepEqual(valueAt(one, "subjects[2].track[1].position"), [0, 0, 0]);
  assert.deepEqual(valueAt(one, "subjects[2].track[2].position"), [3, 3, 3]);
});

test("a prism moves with its levels; a mesh stays", () => {
  const at = placeOfItem(film, { kind: "obstacle", index: 2 }) as Vec3;
  const next = after(moved(film, { kind: "obstacle", index: 2 }, [at[0] + 1, at[1], at[2] + 2]));
  assert.deepEqual(valueAt(next, "obstacles[3].corners"), [1, 0, 5, 0, 5, 4]);
  assert.equal(valueAt(next, "obstacles[3].floor"), 3);
  assert.equal(valueAt(next, "obstacles[3].ceiling"), 11);
  assert.equal(moved(film, { kind: "obstacle", index: 3 }, [0, 0, 0]), null);
  assert.equal(moved(film, { kind: "keyframe", index: 9 }, [0, 0, 0]), null);
});

test("the corners of zones are moved, added and taken away", () => {
  const zones: JsonObject = { ...film, flight_zones: [
    { name: "park", corners: [[0, 0], [10, 0], [10, 10], [0, 10]], ceiling: 9 }] };
  const done = (edit: Edit | null): JsonObject => {
    assert.ok(edit);
    return applied(zones, edit.patch);
  };
  const prism = { kind: "corner", of: "obstacle", index: 2, point: 1 } as const;
  const park = { kind: "corner", of: "zone", index: 0, point: 3 } as const;
  assert.deepEqual(placeOfItem(zones, prism), [4, 0, 1]);
  assert.deepEqual(placeOfItem(zones, park), [0, 10, 0]);
  assert.equal(nameOf(zones, park), "corner 4 of park");
  assert.deepEqual(valueAt(done(moved(zones, prism, [6, -1, 50])), "obstacles[3].corners"),
                   [0, 0, 6, -1, 4, 4]);
  assert.deepEqual(valueAt(done(moved(zones, park, [-2.5, 11, 0])), "flight_zones[1].corners"),
                   [0, 0, 10, 0, 10, 10, -2.5, 11]);
  const added = addedCorner(zones, park);
  assert.equal(added?.point, 4);
  assert.deepEqual(valueAt(done(added), "flight_zones[1].corners"),
                   [0, 0, 10, 0, 10, 10, 0, 10, 0, 5]);
  assert.deepEqual(valueAt(done(deleted(zones, park)), "flight_zones[1].corners"),
                   [0, 0, 10, 0, 10, 10]);
  assert.equal(deleted(zones, prism), null);       // three are needed
  assert.deepEqual(corneredItem(zones, park), { kind: "zone", index: 0 });
  assert.equal(corneredItem(zones, { kind: "obstacle", index: 0 }), null);
  // As a whole, and gone.
  const zone = { kind: "zone", index: 0 } as const;
  assert.deepEqual(placeOfItem(zones, zone), [5, 5, 0]);
  assert.deepEqual(valueAt(done(moved(zones, zone, [6, 5, 2])), "flight_zones[1]"),
                   { name: "park", corners: [1, 0, 11, 0, 11, 10, 1, 10], ceiling: 11 });
  assert.deepEqual(valueAt(done(deleted(zones, zone)), "flight_zones"), []);
  const made = valueAt(after(addedObstacle(film, "flight_zone", [0, 0, 0])), "flight_zones[1]");
  assert.deepEqual((made as JsonObject).corners, [-10, -10, 30, -10, 30, 10, -10, 10]);
});

test("a film begins at its first keyframe and ends at its last", () => {
  const without = (index: number): JsonObject =>
    after(deleted(film, { kind: "keyframe", index }));
  assert.deepEqual(times(without(0)), [0, 20]);
  assert.equal(without(0).duration, 20);
  assert.deepEqual(times(without(2)), [0, 10]);
  assert.equal(without(2).duration, 10);
  assert.deepEqual(times(without(1)), [0, 20]);
  // Times that nothing states stay so.
  const open: JsonObject = { keyframes: [{ position: [0, 0, 1] }, { position: [4, 0, 1] },
                                         { position: [8, 0, 1] }] };
  const edit = deleted(open, { kind: "keyframe", index: 0 });
  assert.deepEqual(edit?.patch, [{ path: "keyframes",
    value: [{ position: [4, 0, 1] }, { position: [8, 0, 1] }] }]);
});

test("what a point is inside of", () => {
  const [ball, box, prism] = film.obstacles as [JsonObject, JsonObject, JsonObject, JsonObject];
  assert.ok(holds(ball, [1, 2, 4.9]) && !holds(ball, [1, 2, 5.1]));
  assert.ok(holds(box, [1, 1, 1.9]) && !holds(box, [2.1, 1, 1]));
  assert.ok(holds(prism, [3, 1, 8]) && !holds(prism, [1, 3, 8]) && !holds(prism, [3, 1, 9.5]));
  const rod = { type: "capsule", from: [0, 0, 0], to: [10, 0, 0], radius: 1 };
  assert.ok(holds(rod, [10.9, 0, 0]) && holds(rod, [5, 0.9, 0]) && !holds(rod, [5, 0.9, 0.9]));
  const tent = { type: "cone", base: [0, 0, 0], radius: 2, height: 4 };
  assert.ok(holds(tent, [0.9, 0, 2]) && !holds(tent, [1.1, 0, 2]) && !holds(tent, [0, 0, -0.1]));
  assert.ok(!holds({ type: "mesh" }, [0, 0, 0]));
});

test("keyframes are inserted in the order of their times", () => {
  const made = inserted(film, 5.04, [1, 1, 1]);
  assert.equal(made.index, 1);
  assert.deepEqual(times(after(made)), [0, 5, 10, 20]);
  const taken = inserted(film, 10, [1, 1, 1]);
  assert.deepEqual(times(after(taken)), [0, 10, 10.5, 20]);
  const end = appended(film, [30, 0, 2]);
  assert.equal(end.index, 3);
  const grown = after(end);
  assert.ok((grown.duration as number) > 20);
  assert.equal(times(grown)[3], grown.duration);
  assert.deepEqual(times(after(appended({ ...film, keyframes: [] }, [0, 0, 0]))), [0]);
});

test("times that were open are stated once one is", () => {
  const open: JsonObject = { duration: 10, keyframes: [{ position: [0, 0, 0] },
    { position: [5, 0, 0], speed: 2 }, { position: [9, 0, 0] }] };
  const made = inserted(open, 2, [1, 0, 0]);
  const list = applied(open, made.patch).keyframes as JsonObject[];
  assert.deepEqual(list.map((k) => k.time), [0, 2, 5, 10]);
  assert.ok(list.every((k) => k.speed === undefined));
});

test("a time stays between its neighbours, the film ends with its last keyframe", () => {
  assert.deepEqual(times(after(retimed(film, 1, 14.26))), [0, 14.3, 20]);
  assert.deepEqual(times(after(retimed(film, 1, -5))), [0, 0.2, 20]);
  assert.deepEqual(times(after(retimed(film, 1, 50))), [0, 19.8, 20]);
  assert.deepEqual(timeRange(film, 1), [0.2, 19.8]);
  assert.deepEqual(timeRange(film, 2), [10.2, Infinity]);
  const longer = after(retimed(film, 2, 31));
  assert.equal(longer.duration, 31);
  assert.equal(after(retimed(film, 0, -2)).duration, 20);
  assert.equal(retimed(film, 7, 1), null);
});

test("slowing a leg delays all that follows", () => {
  const slow = after(slowed(film, 1, 1.5));
  assert.deepEqual(times(slow), [0, 15, 25]);
  assert.equal(slow.duration, 25);
  assert.equal(slowed(film, 0, 2), null);
});

test("a leg is sped up, and never to nothing", () => {
  assert.deepEqual(times(after(slowed(film, 1, 0.5))), [0, 5, 15]);
  assert.equal(after(slowed(film, 1, 0.5)).duration, 15);
  assert.deepEqual(times(after(slowed(film, 1, 1e-6))), [0, 0.2, 10.2]);
});

test("duplicate, delete, swap", () => {
  const twice = duplicated(film, 1);
  assert.deepEqual(times(after(twice)), [0, 10, 15, 20]);
  assert.deepEqual(valueAt(after(twice), "keyframes[3].look_at"), [1, 1, 1]);
  assert.equal((after(duplicated(film, 2)).duration as number), 22);
  const gone = after(deleted(film, { kind: "keyframe", index: 1 }));
  assert.deepEqual(times(gone), [0, 20]);
  assert.equal(deleted(gone, { kind: "keyframe", index: 0 }), null);
  const blind = after(deleted(film, { kind: "look", index: 1 }));
  assert.equal(valueAt(blind, "keyframes[2].look_at"), undefined);
  assert.equal((after(deleted(film, { kind: "obstacle", index: 0 })).obstacles as []).length, 3);
  const swapped = after(reordered(film, 1, -1));
  assert.deepEqual(times(swapped), [0, 10, 20]);
  assert.deepEqual(valueAt(swapped, "keyframes[1].position"), [10, 0, 4]);
  assert.deepEqual(valueAt(swapped, "keyframes[1].look_at"), [1, 1, 1]);
  assert.equal(valueAt(swapped, "keyframes[2].look_at"), undefined);
  assert.equal(reordered(film, 0, -1), null);
});

test("cuts, obstacles and subjects come and go", () => {
  const cut = after(cutAt({ ...film, cuts: [{ start: 9 }] }, 3, 4));
  assert.deepEqual(cut.cuts, [{ start: 3, finish: 4 }, { start: 9 }]);
  assert.deepEqual(applied(cut, uncut(cut, 0).patch).cuts, [{ start: 9 }]);
  const box = (after(addedObstacle(film, "box", [50, 0, 0])).obstacles as JsonObject[])[4];
  assert.deepEqual(box?.upper, [52, 2, 4]);
  for (const { type } of obstacleKinds) {
    const list = after(addedObstacle(film, type, [1, 2, 0])).obstacles as JsonObject[];
    assert.ok(trianglesOf(list[4] as JsonObject), type);
  }
  assert.equal(addedObstacle(film, "mesh", [0, 0, 0]), null);
  const two = after(addedSubject(film, [0, 0, 0])).subjects as JsonObject[];
  assert.deepEqual(two.map((s) => s.name), ["subject 1", "b", "subject 3"]);
  const second = applied({ ...film, keyframes: [{ position: [0, 0, 0] }, { position: [1, 0, 0] }] },
    addedSubject({ ...film, keyframes: [{ position: [0, 0, 0] }, { position: [1, 0, 0] }] },
                 [0, 0, 0]).patch);
  assert.equal(valueAt(second, "keyframes[1].subject"), "subject 1");
  assert.equal((after(addedSubject({ ...film, subjects: [] }, [0, 0, 0])).subjects as JsonObject[])
    .length, 1);
  assert.equal(nameOf(film, { kind: "obstacle", index: 0 }), "obstacle ball");
});

test("new places have room", () => {
  const world: JsonObject = { margin: 0.5, keyframes: [{ time: 0, position: [0, 0, 5] },
    { time: 9, position: [9, 0, 5] }], obstacles: [
    { type: "sphere", center: [0, 0, 2], radius: 5 }, { type: "box", lower: [4, -1, 0],
      upper: [6, 1, 8] }, { type: "no_fly_zone", corners: [20, 0, 24, 0, 24, 4, 20, 4] }] };
  near(lifted(world, [0, 0, 3])[2], 7.7);
  near(lifted(world, [5, 0, 3])[2], 8.7);
  assert.deepEqual(lifted(world, [0, 0, 9]), [0, 0, 9]);
  assert.deepEqual(lifted(world, [30, 0, 1]), [30, 0, 1]);
  assert.deepEqual(lifted(world, [22, 2, 1]), [22, 2, 1]);      // nothing is above
  const free = freeGround(world, [0, 0, 0], 6);
  assert.ok(Math.hypot(free[0], free[1]) > 7 && Math.hypot(free[0] - 9, free[1]) > 7);
  assert.deepEqual(freeGround(world, [40, 0, 0], 6), [40, 0, 0]);
  const drawn = withStroke(world, [[9, 0, 5], [5, 0, 5], [-9, 0, 5]]);
  const made = applied(world, drawn?.patch ?? []).keyframes as JsonObject[];
  for (const { position } of made.slice(2)) assert.deepEqual(lifted(world, position as Vec3), position);
});

test("every shot goes on from where the film ends", () => {
  for (const shot of shots) {
    const made = withShot(film, shot, [20, 10, 1]);
    const list = after(made).keyframes as JsonObject[];
    const own = list.map((k) => k.time as number);
    assert.ok(list.length > 3, shot.name);
    assert.ok(own.every((t, i) => i === 0 || t > (own[i - 1] as number)), shot.name);
    assert.equal(after(made).duration, own[own.length - 1]);
    const empty = applied({ keyframes: [] }, withShot({ keyframes: [] }, shot, [0, 0, 0]).patch);
    assert.ok((empty.keyframes as []).length >= 1);
  }
});

test("an orbit stays at its distance and comes back", () => {
  const orbit = shots.find((s) => s.name === "Orbit");
  const places = orbit?.places([10, 0, 5], [0, 0, 1]) ?? [];
  for (const { position } of places) {
    assert.ok(Math.abs(Math.hypot(position[0], position[1]) - 10) < 1e-9);
    assert.equal(position[2], 5);
  }
  assert.ok(Math.hypot((places[7]?.position[0] ?? 0) - 10, places[7]?.position[1] ?? 9) < 1e-9);
});

test("a stroke keeps its corners and no more", () => {
  const straight: Vec3[] = Array.from({ length: 50 }, (_, i) => [i, 0, 0]);
  assert.equal(simplified(straight, 0.1).length, 2);
  const corner: Vec3[] = [...straight, ...Array.from({ length: 50 }, (_, i): Vec3 => [49, i, 0])];
  assert.deepEqual(simplified(corner, 0.5), [[0, 0, 0], [49, 0, 0], [49, 49, 0]]);
  const wild: Vec3[] = Array.from({ length: 400 }, (_, i) => [i / 4, 9 * Math.sin(i / 5), 2]);
  const made = withStroke(film, wild);
  const count = (after(made).keyframes as []).length - 3;
  assert.ok(count >= 3 && count <= 12, String(count));
  assert.equal(withStroke(film, [[0, 0, 0], [0.1, 0, 0]]), null);
  assert.equal(withStroke(film, []), null);
});
