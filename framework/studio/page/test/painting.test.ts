// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { growthIn, grownBy, imagesBy, LiveEpisode, raysInWords, Sights, stepFrom, stepInWords } from "../src/state/exploration";
import { addedStroke, drawingErrorInWords, drawnStrokes, earlierStroke, inWorld, lightsAndGaps, litRuns, onPlane, planeOf,
         reversedStroke, simplified, withoutStroke, type Point } from "../src/state/painting";
import { applied } from "../src/state/document";
import type { Certificate, ExplorationWorld, JsonObject, Plan, TakenImage, Vec3 } from "../src/state/types";

const painting = (more: JsonObject = {}): JsonObject =>
  ({ text: "HELLO", strokes: [], height: 2, base: [1, 5, 2], view_yaw_deg: 90, ...more });

const near = (a: number[], b: number[], within = 2e-3): void => {
  assert.equal(a.length, b.length);
  a.forEach((v, i) => assert.ok(Math.abs(v - (b[i] as number)) < within, `${a} and ${b}`));
};

test("the plane of a drawing is seen along its yaw, and maps back", () => {
  const plane = planeOf(painting());
  assert.ok(plane);
  near(plane.right, [1, 0, 0]);
  near(inWorld(plane, [3, 1]), [4, 5, 3]);
  near(onPlane(plane, [4, 5, 3]), [3, 1]);
  const aside = planeOf(painting({ view_yaw_deg: 37 }));
  assert.ok(aside);
  near(onPlane(aside, inWorld(aside, [-1.5, 0.7])), [-1.5, 0.7]);
});

test("a stroke takes the place of a text, and stays where it was drawn", () => {
  const drawn: Vec3[] = [[0, 5, 3], [1, 5, 4.5], [2.5, 5, 3.5]];
  const edit = addedStroke(painting(), drawn);
  assert.ok(edit);
  const next = applied(painting(), edit.patch);
  assert.equal(next.text, "");
  const plane = planeOf(next), strokes = drawnStrokes(next);
  assert.ok(plane);
  assert.equal(strokes.length, 1);
  strokes[0]?.forEach((p, i) => near(inWorld(plane, p), drawn[i] as Vec3));
  // A second one moves none of the first.
  const more = addedStroke(next, [[4, 5, 1], [4, 5, 6]]);
  assert.ok(more);
  const both = applied(next, more.patch);
  const where = planeOf(both);
  assert.ok(where);
  assert.equal(both.height, 5);
  drawnStrokes(both)[0]?.forEach((p, i) => near(inWorld(where, p), drawn[i] as Vec3));
  near(inWorld(where, drawnStrokes(both)[1]?.[1] as Point), [4, 5, 6]);
});

test("a level stroke, a dot, and strokes without length", () => {
  const level = addedStroke(painting(), [[0, 5, 3], [2, 5, 3]]);
  assert.ok(level);
  const next = applied(painting(), level.patch);
  assert.equal(next.height, 2);   // as wide as the height says
  assert.deepEqual(drawnStrokes(next)[0]?.map(([x]) => x), [-1, 1]);
  assert.equal(addedStroke(painting(), [[0, 5, 3], [0.001, 5, 3]]), null);
  assert.equal(addedStroke(painting(), [[0, 5, 3]]), null);
});

test("strokes are ordered, turned round and deleted; the last one stays", () => {
  let document = painting();
  for (const x of [0, 1, 2]) {
    const made = addedStroke(document, [[x, 5, 2], [x, 5, 3]]);
    assert.ok(made);
    document = applied(document, made.patch);
  }
  const xs = (d: JsonObject): number[] => drawnStrokes(d).map((s) => Math.round(s[0]?.[0] ?? NaN));
  assert.deepEqual(xs(document), [-1, 0, 1]);
  const swapped = applied(document, earlierStroke(document, 1)?.patch ?? []);
  assert.deepEqual(xs(swapped), [0, -1, 1]);
  assert.equal(earlierStroke(document, 0), null);
  const turned = applied(document, reversedStroke(document, 0)?.patch ?? []);
  assert.deepEqual(drawnStrokes(turned)[0]?.map(([, y]) => Math.round(y)), [1, 0]);
  const fewer = applied(document, withoutStroke(document, 1)?.patch ?? []);
  assert.equal(drawnStrokes(fewer).length, 2);
  const one = applied(fewer, withoutStroke(fewer, 1)?.patch ?? []);
  assert.equal(withoutStroke(one, 0), null);
});

test("a drawn line keeps its shape in few points", () => {
  const circle: Point[] = Array.from({ length: 400 }, (_, i): Point =>
    [Math.cos(i / 63.7), Math.sin(i / 63.7)]);
  const fewer = simplified(circle);
  assert.ok(fewer.length < 60, String(fewer.length));
  for (const [x, y] of circle) {
    const d = Math.min(...fewer.slice(1).map((b, i) => {
      const a = fewer[i] as Point;
      const dx = b[0] - a[0], dy = b[1] - a[1];
      const s = Math.min(1, Math.max(0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)));
      return Math.hypot(x - a[0] - s * dx, y - a[1] - s * dy);
    }));
    assert.ok(d < 0.0051, String(d));
  }
});

test("what is lit ends at the play head", () => {
  const plan = { duration: 4, columns: { time: [0, 1, 2, 3, 4], x: [0, 1, 2, 3, 4] },
                 lights: [{ start: 0, finish: 1 }, { start: 2, finish: 4 }] } as unknown as Plan;
  assert.deepEqual(litRuns(plan, Infinity).map((run) => run.map(([x]) => x)), [[0, 1], [2, 3, 4]]);
  assert.deepEqual(litRuns(plan, 3).map((run) => run.map(([x]) => x)), [[0, 1], [2, 3]]);
  assert.deepEqual(litRuns(plan, 0.5), []);
});

const told: ExplorationWorld = {
  utility: "frontier", end: "all requested images are taken", surface: 100, efficiency: 5,
  resolution: 0.4, oracle: [20, 30], candidates: [],
  images: [1, 4, 9].map((time, i) => ({ time, position: [0, 0, i], yaw: 0, pitch: 0, value: 7.12345,
                                        scored: 9, observed: 10 * (i + 1) })),
};

test("an exploration is stepped through by its images", () => {
  assert.equal(imagesBy(told, 0), 0);
  assert.equal(imagesBy(told, 4), 2);
  assert.equal(stepFrom(told, 0, 1), 1);
  assert.equal(stepFrom(told, 1, 1), 4);
  assert.equal(stepFrom(told, 9, 1), 9);
  assert.equal(stepFrom(told, 9, -1), 4);
  assert.equal(stepFrom(told, 5, -1), 1);
  assert.equal(stepFrom(told, 0, -1), 1);
  const rows = Object.fromEntries(stepInWords(told, 3));
  assert.equal(rows.Image, "3 of 3");
  assert.equal(rows["Surface found"], "30 of 100 voxels");
  assert.equal(rows["by this image"], "10 voxels");
  assert.equal(rows["The oracle by then"], "30 voxels");
});

test("voxels grow image by image; bytes that hold none are refused", () => {
  const bytes = new ArrayBuffer(12 + 3 * 16), data = new DataView(bytes);
  [..."WLG1"].forEach((c, i) => data.setUint8(i, c.charCodeAt(0)));
  data.setUint32(4, 3, true);
  data.setFloat32(8, 0.5, true);
  [1, 1, 7].forEach((image, i) => {
    data.setFloat32(12 + 16 * i, i, true);
    data.setUint32(24 + 16 * i, image, true);
  });
  const growth = growthIn(bytes);
  assert.equal(growth.edge, 0.5);
  assert.deepEqual([...growth.images], [1, 1, 7]);
  assert.deepEqual([0, 1, 6, 7, 8].map((n) => grownBy(growth, n)), [0, 2, 2, 3, 3]);
  assert.throws(() => growthIn(bytes.slice(0, 40)), /growth/);
  assert.throws(() => growthIn(new ArrayBuffer(3)), /growth/);
});

// Two images, slices of 2 x 2 points at two levels, one ray.
function sightBytes(): ArrayBuffer {
  const bytes = new ArrayBuffer(20 + 8 + 2 * (2 * 2 * 4 + 20));
  const data = new DataView(bytes);
  [..."WLE1"].forEach((letter, i) => data.setUint8(i, letter.charCodeAt(0)));
  [2, 2, 2, 1].forEach((count, i) => data.setUint32(4 + 4 * i, count, true));
  [1.5, 3].forEach((edge, i) => data.setFloat32(20 + 4 * i, edge, true));
  for (let image = 0; image < 2; ++image) {
    const at = 28 + 36 * image;
    for (let i = 0; i < 16; ++i) data.setUint8(at + i, 100 * image + i);
    [1, 2, 3, 0.25].forEach((v, i) => data.setFloat32(at + 16 + 4 * i, v, true));
    data.setUint32(at + 32, 7 * image, true);
  }
  return bytes;
}

test("what an image was chosen by is read from its bytes", () => {
  const sights = new Sights(sightBytes());
  const second = sights.at(1);
  assert.ok(second);
  assert.deepEqual([...second.edges], [1.5, 3]);
  assert.deepEqual([...(second.occupancy[1] as Uint8Array)], [104, 105, 106, 107]);
  assert.deepEqual([...(second.certainty[0] as Uint8Array)], [108, 109, 110, 111]);
  assert.deepEqual(second.rays, [{ end: [1, 2, 3], unknownFrom: 0.25, unknown: 7 }]);
  assert.equal(raysInWords(second), "1 of 1 rays met unknown voxels");
  assert.equal(sights.at(2), null);
  assert.equal(sights.at(-1), null);
  assert.throws(() => new Sights(sightBytes().slice(1)), /no views/);
  assert.throws(() => new Sights(new ArrayBuffer(0)), /no views/);
});

test("an exploration grows while it is planned", () => {
  const image = (n: number, grown: number[]): TakenImage => ({
    type: "image", revision: 3, utility: "frontier", image: n, asked: 9, surface: 50, resolution: 0.4,
    time: 2 * n, position: [n, 0, 2], yaw: 0, pitch: 0, value: n, scored: 1, observed: n === 2 ? null : 5,
    grown, sights: `blob${n}` });
  const live = new LiveEpisode(3);
  assert.ok(!live.take(image(2, [])));         // the first one is missing
  assert.ok(live.take(image(1, [1, 2, 3])));
  assert.ok(live.take(image(2, [4, 5, 6, 7, 8, 9])));
  assert.ok(!live.take(image(2, [])));         // told twice
  assert.deepEqual([...live.growth.images], [1, 2, 2]);
  assert.equal(grownBy(live.growth, 1), 1);
  assert.equal(live.plan.duration, 4);
  assert.deepEqual(live.plan.columns.x, [1, 2]);
  const rows = Object.fromEntries(stepInWords(live.told, 2, live.asked));
  assert.equal(rows.Image, "2 of 9");
  assert.equal(rows["Surface found"], undefined);   // known at the end
});

test("light and dark are in the order of the plan, its error in words", () => {
  const plan: Plan = { duration: 9, columns: { time: [] },
                       lights: [{ start: 0, finish: 2 }, { start: 3, finish: 5 }] };
  assert.deepEqual(lightsAndGaps(plan).map(({ start, finish, lit }) => [start, finish, lit]),
                   [[0, 2, true], [2, 3, false], [3, 5, true]]);
  assert.deepEqual(lightsAndGaps(null), []);
  const certificate: Certificate = { passed: true, checks: [
    { name: "drawing", passed: true, required: true, worst: 0.001, limit: 0.02 },
    { name: "drawing_flown", passed: true, required: true, worst: 0.0035, limit: 0.02 }] };
  assert.equal(drawingErrorInWords(certificate),
               "The light is 1 mm from the strokes on average as planned, 3.5 mm as flown; at most 20 mm.");
  assert.equal(drawingErrorInWords(null), "");
});
