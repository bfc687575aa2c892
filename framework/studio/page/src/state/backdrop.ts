// SPDX-License-Identifier: Apache-2.0
// A raster beneath the scene, by its corners: where its pixels lie, and what it is in words.
import type { BackdropMessage, BackdropPicture, Vec3 } from "./types";
import { show } from "./units";

export const isPlaced = (message: BackdropMessage | null): message is BackdropPicture =>
  message !== null && "picture" in message;

// Texels, rows from the top, of a blob.
export function picturePixels(buffer: ArrayBuffer): { width: number; height: number; texels: Uint8Array } {
  const data = new DataView(buffer);
  const named = buffer.byteLength >= 12 &&
    String.fromCharCode(...new Uint8Array(buffer, 0, 4)) === "WLP1";
  const width = named ? data.getUint32(4, true) : 0, height = named ? data.getUint32(8, true) : 0;
  if (!named || buffer.byteLength !== 12 + 4 * width * height) throw new Error("no picture in it");
  return { width, height, texels: new Uint8Array(buffer, 12) };
}

// Two triangles a cell, at a height (m). The first row of texels, v = 0, is the top of the picture.
export function backdropGrid({ cells, corners }: BackdropPicture, height: number):
  { positions: Float32Array; places: Float32Array; triangles: number[] } {
  const along = cells + 1;
  if (corners.length !== 2 * along * along) throw new Error("a backdrop without its corners");
  const positions = new Float32Array(3 * along * along), places = new Float32Array(2 * along * along);
  const triangles: number[] = [];
  for (let k = 0; k < along * along; ++k) {
    const column = k % along, row = Math.floor(k / along);
    positions.set([corners[2 * k] as number, corners[2 * k + 1] as number, height], 3 * k);
    places.set([column / cells, row / cells], 2 * k);
    // Seen from above, whichever way the rows run.
    if (column < cells && row < cells) {
      triangles.push(k, k + along, k + along + 1, k, k + along + 1, k + 1);
    }
  }
  return { positions, places, triangles };
}

// Where a pixel's place is in the world, as its triangles put it; in pixels from the upper left.
export function placeOfPixel(picture: BackdropPicture, x: number, y: number, height = 0): Vec3 {
  const { cells, corners, width, height: rows } = picture;
  const u = (x / width) * cells, v = (y / rows) * cells;
  const column = Math.min(Math.floor(u), cells - 1), row = Math.min(Math.floor(v), cells - 1);
  const s = u - column, t = v - row;
  const corner = (right: number, down: number, k: 0 | 1): number =>
    corners[2 * ((row + down) * (cells + 1) + column + right) + k] as number;
  const at = (k: 0 | 1): number => t > s
    ? corner(0, 0, k) * (1 - t) + corner(0, 1, k) * (t - s) + corner(1, 1, k) * s
    : corner(0, 0, k) * (1 - s) + corner(1, 0, k) * (s - t) + corner(1, 1, k) * t;
  return [at(0), at(1), height];
}

export function backdropInWords(message: BackdropMessage): string {
  if (!isPlaced(message)) return message.why;
  const { file, system, pixel, pixel_of_file: own, heights } = message;
  const size = (value: number): string => show(Number(value.toPrecision(3)));
  const smaller = pixel > 1.01 * own ? `, of ${size(own)} m in the file` : "";
  return `${file}: ${heights ? "heights in the light of the north-west, " : ""}pixels of ${
    size(pixel)} m${smaller}; ${system}`;
}
