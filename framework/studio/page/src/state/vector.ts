// SPDX-License-Identifier: Apache-2.0
// Vectors of three numbers, and the few operations that the page needs.
import type { Json, Vec3 } from "./types";

export function vec(value: Json | undefined): Vec3 | null {
  if (!Array.isArray(value) || value.length !== 3) return null;
  return value.every((v) => typeof v === "number" && Number.isFinite(v)) ? (value as Vec3) : null;
}

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const mix = (a: Vec3, b: Vec3, t: number): Vec3 => add(times(a, 1 - t), times(b, t));
export const distance = (a: Vec3, b: Vec3): number => length(minus(a, b));

// Millimetres are enough for what a hand does.
export const rounded = (a: Vec3): Vec3 =>
  a.map((v) => Math.round(v * 1000) / 1000 + 0) as Vec3;

export const clamp = (v: number, low: number, high: number): number =>
  Math.min(Math.max(v, low), high);
