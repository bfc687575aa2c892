// SPDX-License-Identifier: Apache-2.0
// What images will show of a surface, as the server sends it: a binary PLY whose faces have the
// numbers of images, angle, resolution, parallax and accuracy; -1 where there is no such number.
import type { Triangles } from "./shapes";

export interface Prediction extends Triangles {
  colors: Uint8Array;                        // r, g, b of each triangle
  figures: Record<Figure, Float32Array>;     // of each triangle
}
export type Figure = "images" | "incidence_deg" | "mm_per_pixel" | "parallax_deg" | "accuracy_mm";

export const figureNames: Record<Figure, { text: string; unit: string; low: number; high: number }> = {
  accuracy_mm: { text: "Accuracy", unit: "mm", low: 2, high: 50 },
  images: { text: "Images", unit: "", low: 0, high: 8 },
  mm_per_pixel: { text: "Resolution", unit: "mm a pixel", low: 2, high: 50 },
  incidence_deg: { text: "Angle", unit: "\u00b0", low: 0, high: 75 },
  parallax_deg: { text: "Parallax", unit: "\u00b0", low: 1, high: 60 },
};

const order: Figure[] = ["images", "incidence_deg", "mm_per_pixel", "parallax_deg", "accuracy_mm"];
const FACE = 1 + 3 * 4 + 3 + 5 * 4;   // bytes
const MOST_HEAD = 2000;

const COARSE_HEAD = 36, COARSE_CORNER = 6, COARSE_FACE = 24;   // bytes

// The coarse stand-in of a report.
function coarseIn(buffer: ArrayBuffer): Prediction {
  const data = new DataView(buffer);
  const whole = buffer.byteLength >= COARSE_HEAD;
  const vertices = whole ? data.getUint32(4, true) : 0, faces = whole ? data.getUint32(8, true) : 0;
  if (!whole || COARSE_HEAD + COARSE_CORNER * vertices + COARSE_FACE * faces !== buffer.byteLength) {
    throw new Error("prediction: no coarse surface in it");
  }
  const positions = new Float32Array(3 * vertices);
  for (let i = 0; i < positions.length; ++i) {
    const lower = data.getFloat32(12 + 4 * (i % 3), true), size = data.getFloat32(24 + 4 * (i % 3), true);
    positions[i] = lower + (size * data.getUint16(COARSE_HEAD + 2 * i, true)) / 65535;
  }
  const triangles = new Uint32Array(3 * faces), colors = new Uint8Array(3 * faces);
  const figures = emptyFigures(faces);
  const scratch = new DataView(new ArrayBuffer(4));
  for (let t = 0, at = COARSE_HEAD + COARSE_CORNER * vertices; t < faces; ++t, at += COARSE_FACE) {
    for (let c = 0; c < 3; ++c) {
      const corner = data.getUint16(at + 2 * c, true);
      if (corner >= vertices) throw new Error(`prediction: vertex ${corner} of ${vertices}`);
      triangles[3 * t + c] = corner;
      colors[3 * t + c] = data.getUint8(at + 8 + c);
    }
    figures.images[t] = data.getInt16(at + 6, true);
    for (let k = 1; k < order.length; ++k) {
      // The lowest byte of the number is left out.
      for (let b = 0; b < 3; ++b) scratch.setUint8(1 + b, data.getUint8(at + 9 + 3 * k + b));
      figures[order[k] as Figure][t] = scratch.getFloat32(0, true);
    }
  }
  return { positions, triangles, colors, figures };
}

const emptyFigures = (faces: number): Prediction["figures"] => Object.fromEntries(
  order.map((name) => [name, new Float32Array(faces)])) as Prediction["figures"];

export function predictionIn(buffer: ArrayBuffer): Prediction {
  if (String.fromCharCode(...new Uint8Array(buffer, 0, Math.min(4, buffer.byteLength))) === "WLP1") {
    return coarseIn(buffer);
  }
  const start = String.fromCharCode(...new Uint8Array(buffer, 0, Math.min(MOST_HEAD, buffer.byteLength)));
  const end = start.indexOf("end_header\n");
  const count = (what: string): number => Number(/^\d+/.exec(
    start.slice(start.indexOf(`element ${what} `) + 9 + what.length))?.[0] ?? NaN);
  const vertices = count("vertex"), faces = count("face");
  const head = end + 11;
  if (!start.startsWith("ply\nformat binary_little_endian") || end < 0 ||
      head + 12 * vertices + FACE * faces !== buffer.byteLength) {
    throw new Error("prediction: no surface with predictions in it");
  }
  const data = new DataView(buffer);
  const positions = new Float32Array(3 * vertices);
  for (let i = 0; i < positions.length; ++i) positions[i] = data.getFloat32(head + 4 * i, true);
  const triangles = new Uint32Array(3 * faces), colors = new Uint8Array(3 * faces);
  const figures = emptyFigures(faces);
  for (let t = 0, at = head + 12 * vertices; t < faces; ++t, at += FACE) {
    for (let c = 0; c < 3; ++c) {
      const corner = data.getUint32(at + 1 + 4 * c, true);
      if (corner >= vertices) throw new Error(`prediction: vertex ${corner} of ${vertices}`);
      triangles[3 * t + c] = corner;
      colors[3 * t + c] = data.getUint8(at + 13 + c);
    }
    figures.images[t] = data.getInt32(at + 16, true);
    for (let k = 1; k < order.length; ++k) {
      figures[order[k] as Figure][t] = data.getFloat32(at + 16 + 4 * k, true);
    }
  }
  return { positions, triangles, colors, figures };
}

const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const UNSEEN = [196, 70, 60], OUTSIDE = [150, 150, 148];

// From violet to yellow by a share of 0 to 1.
export function colourOf(share: number): number[] {
  const at = 4 * Math.min(1, Math.max(0, share));
  const from = Math.min(3, Math.floor(at)), part = at - from;
  return [0, 1, 2].map((k) => (stops[from]?.[k] as number) * (1 - part) +
    (stops[from + 1]?.[k] as number) * part);
}

// Violet is best, yellow worst; of images more are better. Red: no image shows it, or two places are
// missing. Grey: outside of the region.
export function shadeOf(prediction: Prediction, figure: Figure, triangle: number): number[] {
  if (prediction.figures.images[triangle] === -1) return OUTSIDE;
  const value = prediction.figures[figure][triangle] as number;
  if (value < 0 || (figure === "images" && value === 0)) return UNSEEN;
  const { low, high } = figureNames[figure];
  const logarithmic = figure === "accuracy_mm" || figure === "mm_per_pixel";
  const share = logarithmic ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
    : (value - low) / (high - low);
  const more = figure === "images" || figure === "parallax_deg";
  const at = 4 * Math.min(1, Math.max(0, more ? 1 - share : share));
  const k = Math.min(3, Math.floor(at));
  return [0, 1, 2].map((c) => {
    const a = (stops[k] as number[])[c] as number, b = (stops[k + 1] as number[])[c] as number;
    return Math.round(a + (at - k) * (b - a));
  });
}

// In words, of what was clicked at.
export function figuresInWords(prediction: Prediction, triangle: number): string {
  const { figures } = prediction;
  const images = figures.images[triangle] as number;
  if (images < 0) return "Outside of the region.";
  if (images === 0) return "No image shows it.";
  const list = order.slice(1).flatMap((name) => {
    const value = figures[name][triangle] as number;
    const { text, unit } = figureNames[name];
    return value < 0 ? [] : [`${text.toLowerCase()} ${Number(value.toPrecision(3))}${
      unit === "\u00b0" ? unit : ` ${unit}`}`];
  });
  return `${images} image${images === 1 ? "" : "s"}: ${list.join(", ")}.`;
}
