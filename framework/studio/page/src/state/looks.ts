// SPDX-License-Identifier: Apache-2.0
// What the server answers about a planned scan: voxels, slices of the map, places that were left
// out, views. Numbers are shown as they come.
import { show } from "./units";
import type { ImageOfVoxel, LeftOutAnswer, LeftOutReason, SliceAnswer, Vec3, ViewAnswer, VoxelAnswer }
  from "./types";

// ---- blobs: four letters, then 32-bit little-endian numbers ---------------------------------------

function opened(buffer: ArrayBuffer, name: string, what: string): DataView {
  const text = String.fromCharCode(...new Uint8Array(buffer, 0, Math.min(4, buffer.byteLength)));
  if (text !== name || buffer.byteLength < 8) throw new Error(`${what}: there is nothing of it`);
  return new DataView(buffer);
}

function require(fits: boolean, what: string, bytes: number): void {
  if (!fits) throw new Error(`${what}: ${bytes} bytes are not what it states`);
}

export interface Places {
  positions: Float32Array;     // x, y, z of each
  numbers: Uint32Array;        // of each: the place of its reason in the answer's list
}

export function placesIn(buffer: ArrayBuffer): Places {
  const data = opened(buffer, "WLL1", "places");
  const count = data.getUint32(4, true);
  require(buffer.byteLength === 8 + 16 * count, "places", buffer.byteLength);
  const positions = new Float32Array(3 * count), numbers = new Uint32Array(count);
  for (let k = 0, at = 8; k < count; ++k, at += 16) {
    for (let i = 0; i < 3; ++i) positions[3 * k + i] = data.getFloat32(at + 4 * i, true);
    numbers[k] = data.getUint32(at + 12, true);
  }
  return { positions, numbers };
}

export interface Told {
  edge: number;                // m, of a voxel
  middles: Float32Array;       // x, y, z of each
  shares: Float32Array;        // what the view tells of each, at most 1
}

export function toldIn(buffer: ArrayBuffer): Told {
  const data = opened(buffer, "WLV1", "voxels");
  const count = data.getUint32(4, true);
  require(buffer.byteLength === 12 + 16 * count, "voxels", buffer.byteLength);
  const middles = new Float32Array(3 * count), shares = new Float32Array(count);
  for (let k = 0, at = 12; k < count; ++k, at += 16) {
    for (let i = 0; i < 3; ++i) middles[3 * k + i] = data.getFloat32(at + 4 * i, true);
    shares[k] = data.getFloat32(at + 12, true);
  }
  return { edge: data.getFloat32(8, true), middles, shares };
}

// ---- slices ---------------------------------------------------------------------------------------

export const cellStates = ["unknown", "free", "occupied", "between"] as const;
export type CellState = (typeof cellStates)[number];
export const stateNames: Record<CellState, string> =
  { unknown: "unknown", free: "free", occupied: "occupied", between: "not decided" };

// Red, green, blue and opacity of a cell, its log odds a number of 0 to 255 between the clamps: free
// is blue, the surer the darker; occupied is orange to red; what is not decided is yellow.
export function cellColour(state: CellState, odds: number): [number, number, number, number] {
  const share = Math.abs(odds / 255 - 0.5) * 2;
  const mix = (from: number[], to: number[]): [number, number, number, number] =>
    [0, 1, 2, 3].map((k) => Math.round((from[k] as number) + share *
      ((to[k] as number) - (from[k] as number)))) as [number, number, number, number];
  switch (state) {
    case "free": return mix([176, 208, 240, 215], [40, 96, 176, 215]);
    case "occupied": return mix([250, 176, 96, 255], [176, 24, 24, 255]);
    case "between": return [244, 220, 96, 255];
    default: return [128, 128, 128, 90];
  }
}

// Texels of a picture, from the lowest row up.
export function texelsIn(buffer: ArrayBuffer): { columns: number; rows: number; texels: Uint8Array } {
  const data = opened(buffer, "WLS1", "slice");
  const columns = data.getUint32(4, true), rows = data.getUint32(8, true), count = columns * rows;
  require(buffer.byteLength === 12 + 2 * count, "slice", buffer.byteLength);
  const odds = new Uint8Array(buffer, 12, count), states = new Uint8Array(buffer, 12 + count, count);
  const table = new Map<number, [number, number, number, number]>();
  const texels = new Uint8Array(4 * count);
  for (let k = 0; k < count; ++k) {
    const code = 256 * (states[k] as number) + (odds[k] as number);
    let colour = table.get(code);
    if (!colour) {
      colour = cellColour(cellStates[states[k] as number] ?? "unknown", odds[k] as number);
      table.set(code, colour);
    }
    texels.set(colour, 4 * k);
  }
  return { columns, rows, texels };
}

const axes = ["x", "y", "z"] as const;
export type Axis = (typeof axes)[number];
export const axisNumber = (axis: Axis): 0 | 1 | 2 => axes.indexOf(axis) as 0 | 1 | 2;

// The axes of the columns and the rows of a slice.
export const sliceAxes = (axis: Axis): [0 | 1, 1 | 2] => [axis === "x" ? 1 : 0, axis === "z" ? 1 : 2];

// Its corners, round.
export function sliceCorners(slice: SliceAnswer): [Vec3, Vec3, Vec3, Vec3] {
  const [across, up] = sliceAxes(slice.axis);
  const cell = slice.edge * 2 ** slice.level;
  const corner = (column: number, row: number): Vec3 => {
    const place: Vec3 = [slice.at, slice.at, slice.at];
    place[across] = slice.lower[0] + column * cell;
    place[up] = slice.lower[1] + row * cell;
    return place;
  };
  const { columns, rows } = slice;
  return [corner(0, 0), corner(columns, 0), corner(columns, rows), corner(0, rows)];
}

// Where a ray meets a slice; null beside it.
export function sliceHit(slice: SliceAnswer, origin: Vec3, direction: Vec3): Vec3 | null {
  const axis = axisNumber(slice.axis);
  const distance = (slice.at - origin[axis]) / direction[axis];
  if (!(distance > 0) || !Number.isFinite(distance)) return null;
  const place = origin.map((v, k) => v + distance * (direction[k] as number)) as Vec3;
  place[axis] = slice.at;
  const [low, , high] = sliceCorners(slice);
  return sliceAxes(slice.axis).every((k) => place[k] >= low[k] && place[k] < high[k]) ? place : null;
}

// ---- words ----------------------------------------------------------------------------------------

const three = (value: number): string => show(Number(value.toPrecision(3)));

// What a voxel is, as lines; then the images that see it.
export function voxelInWords(voxel: VoxelAnswer): [string, string][] {
  const rows: [string, string][] = [
    ["Voxel", `${voxel.middle.map((v) => show(v)).join(", ")} m`],
    ["State", stateNames[voxel.state]]];
  const { image, known_from: known, images = [], share = 0 } = voxel;
  if (image !== undefined) {
    rows.push(["Known from", known === null || known === undefined ? "not yet"
      : known === 0 ? "the start, taken to be free" : `image ${known}`]);
  }
  if (voxel.state !== "unknown") {
    rows.push(["Log odds", String(Number(voxel.log_odds.toPrecision(7)))]);
    rows.push(["Measured", voxel.observations === null ? "not counted (map.observations)"
      : `${voxel.observations} times`]);
  }
  if (image !== undefined) return rows;
  if (voxel.weight === 0) rows.push(["Region", "outside of it"]);
  else {
    rows.push(["Told by all images", `${three(100 * share)} %`]);
    rows.push(["Seen by", images.length === 0 ? "no image"
      : `${images.length} image${images.length === 1 ? "" : "s"}`]);
  }
  return rows;
}

export function imageInWords({ tour, number, distance, mm_per_pixel, incidence_deg }:
  ImageOfVoxel): string {
  return `${tour === undefined ? "" : `tour ${tour + 1}, `}image ${number}: ${three(mm_per_pixel)
    } mm a pixel from ${three(distance)} m${
    incidence_deg === undefined ? "" : ` at ${three(incidence_deg)}\u00b0`}`;
}

export const reasonNames: Record<LeftOutReason, string> = {
  outside: "outside of the tour's space", obstacle: "in an obstacle", unknown: "not measured",
  close: "too close to the surface", no_fly: "in a no-fly zone", flight_zone: "outside a flight zone",
  pilot: "out of the pilot's sight", forbidden: "forbidden by you", thinned: "too many places",
  nothing: "sees nothing of use", apart: "no motion joins it", budget: "not within the budget",
  not_chosen: "others tell more",
};

// As far apart as thirteen colours can be; those of places that cannot be flown to are warm.
export const reasonColours: Record<LeftOutReason, [number, number, number]> = {
  outside: [130, 130, 130], obstacle: [214, 39, 40], unknown: [140, 86, 75], close: [255, 127, 14],
  no_fly: [227, 26, 140], flight_zone: [148, 103, 189], pilot: [90, 60, 20],
  forbidden: [0, 0, 0], thinned: [190, 190, 120], nothing: [23, 190, 207], apart: [31, 119, 180],
  budget: [0, 90, 60], not_chosen: [44, 180, 44],
};

// Reasons that there are, with their counts.
export const reasonsOf = (answer: LeftOutAnswer): { reason: LeftOutReason; count: number }[] =>
  answer.reasons.filter(({ count }) => count > 0);

export function viewInWords(view: ViewAnswer): string {
  return `Candidate ${view.candidate + 1}: ${view.position.map((v) => show(v)).join(", ")} m, heading ${
    show((view.yaw * 180) / Math.PI)}\u00b0, pitch ${show((view.pitch * 180) / Math.PI)}\u00b0. Tells of ${
    view.voxels} voxels, ${three(view.score)} by itself. ${view.ways.length} motion${view.ways.length === 1 ? "" : "s"}${
    view.ways.length > 0 ? `, the shortest ${three(Math.min(...view.ways.map((w) => w.seconds)))} s` : ""}.`;
}
