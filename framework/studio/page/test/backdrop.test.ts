// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { backdropGrid, backdropInWords, picturePixels, placeOfPixel } from "../src/state/backdrop";
import type { BackdropPicture } from "../src/state/types";

// 4 by 2 pixels of 2 m, turned by a right angle: columns run north, rows east.
const picture: BackdropPicture = {
  type: "backdrop", file: "a.tif", system: "S", heights: false, width: 4, height: 2, pixel: 2,
  pixel_of_file: 0.5, cells: 2, picture: "",
  corners: [10, 0, 10, 4, 10, 8, 12, 0, 12, 4, 12, 8, 14, 0, 14, 4, 14, 8],
};

test("pixels of a backdrop are where its corners put them", () => {
  assert.deepEqual(placeOfPixel(picture, 0, 0), [10, 0, 0]);
  assert.deepEqual(placeOfPixel(picture, 3.5, 0.5, 7), [11, 7, 7]);
  assert.deepEqual(placeOfPixel(picture, 4, 2), [14, 8, 0]);
  const { positions, places, triangles } = backdropGrid(picture, 3);
  assert.equal(triangles.length, 2 * 4 * 3);
  assert.deepEqual([...positions.slice(12, 15)], [12, 4, 3]);
  assert.deepEqual([...places.slice(8, 10)], [0.5, 0.5]);
  assert.throws(() => backdropGrid({ ...picture, cells: 3 }, 0), /corners/);
});

test("pictures are read, and other bytes are refused", () => {
  const bytes = new Uint8Array(12 + 8);
  bytes.set([..."WLP1"].map((letter) => letter.charCodeAt(0)));
  bytes.set([2, 0, 0, 0, 1], 4);
  bytes.set([1, 2, 3, 4, 5, 6, 7, 8], 12);
  assert.deepEqual([...picturePixels(bytes.buffer).texels], [1, 2, 3, 4, 5, 6, 7, 8]);
  assert.throws(() => picturePixels(bytes.buffer.slice(0, 16)), /no picture/);
  assert.throws(() => picturePixels(new ArrayBuffer(3)), /no picture/);
});

test("a backdrop in words", () => {
  assert.equal(backdropInWords(picture), "a.tif: pixels of 2 m, of 0.5 m in the file; S");
  assert.equal(backdropInWords({ ...picture, pixel: 0.5, heights: true }),
               "a.tif: heights in the light of the north-west, pixels of 0.5 m; S");
  assert.equal(backdropInWords({ type: "backdrop", why: "no origin" }), "no origin");
});
