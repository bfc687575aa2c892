// SPDX-License-Identifier: Apache-2.0
// An exploration as it went: its images, the growth of the map, what the utility said.
import { show } from "./units";
import type { ExplorationWorld } from "./types";

// Voxels that are occupied at the end, by the image after which they were so first.
export interface Growth {
  edge: number;                // m
  middles: Float32Array;       // x, y, z of each
  images: Uint32Array;         // of each, from 1 on, ascending
}

const HEAD = 12, VOXEL = 16;   // bytes

export function growthIn(buffer: ArrayBuffer): Growth {
  const data = new DataView(buffer);
  const count = buffer.byteLength >= HEAD ? data.getUint32(4, true) : -1;
  if (String.fromCharCode(...new Uint8Array(buffer, 0, Math.min(4, buffer.byteLength))) !== "WLG1" ||
      HEAD + VOXEL * count !== buffer.byteLength) {
    throw new Error("growth: no voxels in it");
  }
  const middles = new Float32Array(3 * count), images = new Uint32Array(count);
  for (let i = 0, at = HEAD; i < count; ++i, at += VOXEL) {
    for (let k = 0; k < 3; ++k) middles[3 * i + k] = data.getFloat32(at + 4 * k, true);
    images[i] = data.getUint32(at + 12, true);
  }
  return { edge: data.getFloat32(8, true), middles, images };
}

// How many voxels the map had after so many images.
export function grownBy(growth: Growth, images: number): number {
  let low = 0, high = growth.images.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((growth.images[middle] as number) <= images) low = middle + 1;
    else high = middle;
  }
  return low;
}

// How many images were taken by a time, s.
export function imagesBy(exploration: ExplorationWorld, time: number): number {
  const { images } = exploration;
  let count = 0;
  while (count < images.length && (images[count]?.time ?? Infinity) <= time + 1e-6) ++count;
  return count;
}

// The time of the image before or after, s.
export function stepFrom(exploration: ExplorationWorld, time: number, by: -1 | 1): number {
  const count = imagesBy(exploration, time);
  const at = by > 0 ? count : count - 2;
  const { images } = exploration;
  return images[Math.min(Math.max(at, 0), images.length - 1)]?.time ?? 0;
}

// The figures of the last image, as rows of words.
export function stepInWords(exploration: ExplorationWorld, count: number): [string, string][] {
  const image = exploration.images[count - 1];
  const rows: [string, string][] = [
    ["Image", `${count} of ${exploration.images.length}`]];
  if (!image) return rows;
  const before = exploration.images[count - 2]?.observed ?? 0;
  rows.push(["Flight time", `${show(Math.round(image.time * 10) / 10)} s`]);
  if (exploration.surface > 0) {
    rows.push(["Surface found", `${Math.round(image.observed)} of ${
      Math.round(exploration.surface)} voxels`],
    ["by this image", `${Math.round(image.observed - before)} voxels`]);
  }
  rows.push(["Its value was", show(Number(image.value.toPrecision(4)))],
            ["Views scored", String(image.scored)]);
  const rival = exploration.oracle[Math.min(count, exploration.oracle.length) - 1];
  if (rival) rows.push(["The oracle by then", `${Math.round(rival)} voxels`]);
  return rows;
}
