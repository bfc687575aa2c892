// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { cellColour, cellStates, imageInWords, placesIn, reasonColours, reasonNames, reasonsOf, sliceCorners,
         sliceHit, texelsIn, toldIn, viewInWords, voxelInWords } from "../src/state/looks";
import type { ImageOfVoxel, LeftOutAnswer, SliceAnswer, Vec3, ViewAnswer, VoxelAnswer } from "../src/state/types";

function blob(name: string, bytes: number): DataView {
  const data = new DataView(new ArrayBuffer(bytes));
  [...name].forEach((letter, i) => data.setUint8(i, letter.charCodeAt(0)));
  return data;
}

test("places and voxels are read, and other bytes are refused", () => {
  const places = blob("WLL1", 8 + 32);
  places.setUint32(4, 2, true);
  places.setFloat32(8 + 16 + 4, 2.5, true);
  places.setUint32(8 + 16 + 12, 7, true);
  const read = placesIn(places.buffer as ArrayBuffer);
  assert.deepEqual([...read.positions], [0, 0, 0, 0, 2.5, 0]);
  assert.deepEqual([...read.numbers], [0, 7]);
  const voxels = blob("WLV1", 12 + 16);
  voxels.setUint32(4, 1, true);
  voxels.setFloat32(8, 0.5, true);
  voxels.setFloat32(24, 0.25, true);
  const told = toldIn(voxels.buffer as ArrayBuffer);
  assert.equal(told.edge, 0.5);
  assert.deepEqual([...told.shares], [0.25]);
  assert.throws(() => toldIn(places.buffer as ArrayBuffer), /voxels/);
  assert.throws(() => placesIn(new ArrayBuffer(2)), /places/);
  places.setUint32(4, 3, true);
  assert.throws(() => placesIn(places.buffer as ArrayBuffer), /40 bytes/);
});

const slice: SliceAnswer = {
  type: "slice", id: "s", axis: "x", at: 2.5, edge: 0.5, level: 1, extent: [0.5, 4.5], lower: [-1, 0], columns: 3, rows: 2,
  counts: { unknown: 1, free: 2, occupied: 3, between: 0 }, clamps: [-2, 3.5], cells: "",
};

test("cells of a slice have colours by state and log odds, and places", () => {
  const cells = blob("WLS1", 12 + 12);
  cells.setUint32(4, 3, true);
  cells.setUint32(8, 2, true);
  cells.setUint8(12 + 4, 255);             // log odds of the fifth
  cells.setUint8(12 + 6 + 4, 2);           // it is occupied
  const { columns, rows, texels } = texelsIn(cells.buffer as ArrayBuffer);
  assert.deepEqual([columns, rows, texels.length], [3, 2, 24]);
  assert.deepEqual([...texels.subarray(16, 20)], cellColour("occupied", 255));
  assert.deepEqual([...texels.subarray(0, 4)], cellColour("unknown", 0));
  assert.notDeepEqual(cellColour("free", 20), cellColour("free", 100));
  assert.equal(cellStates.length, 4);
  // Across x the columns run along y and the rows along z, in cells of 1 m.
  assert.deepEqual(sliceCorners(slice), [[2.5, -1, 0], [2.5, 2, 0], [2.5, 2, 2], [2.5, -1, 2]]);
  assert.deepEqual(sliceHit(slice, [10, 0, 1], [-1, 0, 0]), [2.5, 0, 1]);
  for (const [origin, direction] of [[[10, 0, 1], [1, 0, 0]], [[10, 5, 1], [-1, 0, 0]], [[10, 0, 1], [0, 0, 1]],
                                     [[10, 0, -1], [-1, 0, 0]]] as [Vec3, Vec3][]) {
    assert.equal(sliceHit(slice, origin, direction), null);
  }
});

test("a voxel, its images, a view and reasons are told in words", () => {
  const voxel: VoxelAnswer = {
    type: "voxel", id: "v", key: [1, 2, 3], middle: [0.5, 1.5, -2.5], edge: 1, state: "occupied",
    log_odds: 1.6945956945419312, observations: 3, weight: 1, share: 0.75,
    images: [{ number: 4, distance: 12.3456, pixels: 20, mm_per_pixel: 35.789, incidence_deg: 41.23, told: 0.75 }],
  };
  const words = Object.fromEntries(voxelInWords(voxel));
  assert.equal(words["Log odds"], "1.694596");
  assert.equal(words.Measured, "3 times");
  assert.equal(words["Told by all images"], "75 %");
  assert.equal(words["Seen by"], "1 image");
  assert.equal(imageInWords(voxel.images?.[0] as ImageOfVoxel),
               "image 4: 35.8 mm a pixel from 12.3 m at 41.2\u00b0");
  const unknown = Object.fromEntries(voxelInWords({ ...voxel, state: "unknown", weight: 0 }));
  assert.equal(unknown["Log odds"], undefined);
  assert.equal(unknown.Region, "outside of it");
  assert.match(Object.fromEntries(voxelInWords({ ...voxel, observations: null })).Measured as string, /not counted/);
  // Of an exploration: since which image it is known.
  const explored = (known_from: number | null): string | undefined =>
    Object.fromEntries(voxelInWords({ ...voxel, image: 7, known_from }))["Known from"];
  assert.equal(explored(3), "image 3");
  assert.equal(explored(0), "the start, taken to be free");
  assert.equal(explored(null), "not yet");
  assert.equal(Object.fromEntries(voxelInWords({ ...voxel, image: 7, known_from: 3 })).Region, undefined);
  const view: ViewAnswer = { type: "view", id: "w", candidate: 6, position: [1, 2, 3], yaw: Math.PI / 2, pitch: 0,
                             score: 12.345, voxels: 80, told: "", picture: "",
                             ways: [{ candidate: 1, seconds: 4.2, points: [] }] };
  assert.match(viewInWords(view), /^Candidate 7: .* heading 90\u00b0.* 80 voxels, 12.3 by itself\. 1 motion, the shortest 4.2 s/);
  const answer: LeftOutAnswer = { type: "left_out", id: "l", beyond: 0, places: "",
    reasons: [{ reason: "outside", count: 0 }, { reason: "close", count: 3 }] };
  assert.deepEqual(reasonsOf(answer), [{ reason: "close", count: 3 }]);
  // No two reasons look alike.
  const colours = Object.values(reasonColours).map(String);
  assert.equal(new Set(colours).size, Object.keys(reasonNames).length);
});
