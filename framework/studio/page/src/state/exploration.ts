// SPDX-License-Identifier: Apache-2.0
// An exploration as it went: its images, the growth of the map, what the utility said.
import { show } from "./units";
import { quaternionOf } from "./camera";
import type { ExplorationWorld, Plan, TakenImage, Vec3 } from "./types";

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

// What an image was chosen by: the map around its view before it was taken.
export interface Sight {
  points: number;              // along an edge of a slice
  edges: number[];             // m, of the slice of each level
  occupancy: Uint8Array[];     // of each level, 0 to 255; ahead is up
  certainty: Uint8Array[];
  rays: { end: Vec3; unknownFrom: number; unknown: number }[];   // share of its length; voxels
}

const SIGHT_HEAD = 20, RAY = 20;   // bytes

export class Sights {
  readonly images: number;
  private readonly points: number;
  private readonly levels: number;
  private readonly rays: number;
  private readonly data: DataView;

  constructor(private readonly buffer: ArrayBuffer) {
    this.data = new DataView(buffer);
    const whole = buffer.byteLength >= SIGHT_HEAD &&
      String.fromCharCode(...new Uint8Array(buffer, 0, 4)) === "WLE1";
    [this.images, this.points, this.levels, this.rays] = [4, 8, 12, 16].map((at) =>
      (whole ? this.data.getUint32(at, true) : 0)) as [number, number, number, number];
    if (!whole || SIGHT_HEAD + 4 * this.levels + this.each * this.images !== buffer.byteLength) {
      throw new Error("sights: no views in it");
    }
  }

  private get each(): number {
    return 2 * this.levels * this.points ** 2 + RAY * this.rays;
  }

  // Of an image, from 0 on.
  at(image: number): Sight | null {
    if (image < 0 || image >= this.images) return null;
    const area = this.points ** 2;
    const start = SIGHT_HEAD + 4 * this.levels + this.each * image;
    const slices = (from: number): Uint8Array[] => Array.from({ length: this.levels }, (_, level) =>
      new Uint8Array(this.buffer, from + level * area, area));
    const first = start + 2 * this.levels * area;
    return {
      points: this.points,
      edges: Array.from({ length: this.levels }, (_, level) =>
        this.data.getFloat32(SIGHT_HEAD + 4 * level, true)),
      occupancy: slices(start), certainty: slices(start + this.levels * area),
      rays: Array.from({ length: this.rays }, (_, k) => {
        const at = first + RAY * k;
        return { end: [0, 4, 8].map((by) => this.data.getFloat32(at + by, true)) as Vec3,
                 unknownFrom: this.data.getFloat32(at + 12, true),
                 unknown: this.data.getUint32(at + 16, true) };
      }),
    };
  }
}

// What its rays met, in words.
export function raysInWords({ rays }: Sight): string {
  const unknown = rays.filter((ray) => ray.unknown > 0).length;
  return `${unknown} of ${rays.length} rays met unknown voxels`;
}

// An exploration that is being planned, as far as it has come.
export class LiveEpisode {
  told: ExplorationWorld;
  readonly sights: string[] = [];      // blobs, of each image
  asked = 0;
  private middles: number[] = [];
  private firsts: number[] = [];
  private made: Growth | null = null;

  constructor(readonly revision: number) {
    this.told = { utility: "", end: "", surface: 0, efficiency: 0, resolution: 1, images: [],
                  oracle: [], candidates: [] };
  }

  // Whether it is the next one.
  take(taken: TakenImage): boolean {
    if (taken.image !== this.told.images.length + 1) return false;
    const { utility, surface, resolution, time, position, yaw, pitch, value, scored,
            observed } = taken;
    this.asked = taken.asked;
    this.told = { ...this.told, utility, surface, resolution,
                  images: [...this.told.images, { time, position, yaw, pitch, value, scored, observed }] };
    this.sights.push(taken.sights);
    for (let i = 0; i < taken.grown.length; ++i) this.middles.push(taken.grown[i] as number);
    for (let i = 0; i < taken.grown.length; i += 3) this.firsts.push(taken.image);
    this.made = null;
    return true;
  }

  get growth(): Growth {
    return this.made ??= { edge: this.told.resolution, middles: Float32Array.from(this.middles),
                           images: Uint32Array.from(this.firsts) };
  }

  // From image to image; what is between two images is told with the plan.
  get plan(): Plan {
    const columns = { time: [], x: [], y: [], z: [], qw: [], qx: [], qy: [], qz: [] } as
      Record<"time" | "x" | "y" | "z" | "qw" | "qx" | "qy" | "qz", number[]>;
    for (const { time, position: [x, y, z], yaw, pitch } of this.told.images) {
      const [qw, qx, qy, qz] = quaternionOf(yaw, pitch);
      for (const [name, value] of Object.entries({ time, x, y, z, qw, qx, qy, qz })) {
        columns[name as keyof typeof columns].push(value);
      }
    }
    return { duration: this.told.images.at(-1)?.time ?? 0, columns };
  }
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
// `asked`: images that there will be, while it is planned.
export function stepInWords(exploration: ExplorationWorld, count: number,
                            asked = exploration.images.length): [string, string][] {
  const image = exploration.images[count - 1];
  const rows: [string, string][] = [
    ["Image", `${count} of ${asked}`]];
  if (!image) return rows;
  const before = exploration.images[count - 2]?.observed ?? 0;
  rows.push(["Flight time", `${show(Math.round(image.time * 10) / 10)} s`]);
  if (exploration.surface > 0 && image.observed !== null) {
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
