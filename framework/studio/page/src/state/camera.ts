// SPDX-License-Identifier: Apache-2.0
// The film camera: x right, y down, z forward. Pixel coordinates count from the centre of the upper
// left pixel, as in plans, so that the image covers [-0.5, width - 0.5) x [-0.5, height - 0.5).
import type { CameraOptics, Vec3 } from "./types";
import { add, dot, minus, times } from "./vector";

export type Quaternion = [number, number, number, number];   // w first

export interface View {
  position: Vec3;
  right: Vec3;
  down: Vec3;
  forward: Vec3;
}

// A wide action camera, where no plan has told another one yet.
export const defaultOptics: CameraOptics = {
  width: 1920, height: 1080, fx: 890, fy: 890, cx: 959.5, cy: 539.5,
};

export function axesOf(yaw: number, pitch: number): Omit<View, "position"> {
  const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
  return {
    right: [sy, -cy, 0], down: [sp * cy, sp * sy, -cp], forward: [cp * cy, cp * sy, sp],
  };
}

// World from camera, of a camera without roll; pitch is positive up.
export function quaternionOf(yaw: number, pitch: number): Quaternion {
  const { right: a, down: b, forward: c } = axesOf(yaw, pitch);
  // The largest of the four is found first, so that no divisor is small.
  const trace = a[0] + b[1] + c[2];
  const sizes = [trace, a[0], b[1], c[2]];
  const largest = sizes.indexOf(Math.max(...sizes));
  const s = 2 * Math.sqrt(Math.max(0, 1 + 2 * (sizes[largest] as number) - trace));
  const t = 2 * Math.sqrt(Math.max(0, 1 + trace));
  if (largest === 0) return [t / 4, (b[2] - c[1]) / t, (c[0] - a[2]) / t, (a[1] - b[0]) / t];
  if (largest === 1) return [(b[2] - c[1]) / s, s / 4, (b[0] + a[1]) / s, (c[0] + a[2]) / s];
  if (largest === 2) return [(c[0] - a[2]) / s, (b[0] + a[1]) / s, s / 4, (c[1] + b[2]) / s];
  return [(a[1] - b[0]) / s, (c[0] + a[2]) / s, (c[1] + b[2]) / s, s / 4];
}

export function viewOf(position: Vec3, q: Quaternion): View {
  const [w, x, y, z] = q;
  return {
    position,
    right: [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    down: [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    forward: [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  };
}

// The shorter way, normalised; enough between samples a tenth of a second apart.
export function between(a: Quaternion, b: Quaternion, t: number): Quaternion {
  const same = a.reduce((sum, v, i) => sum + v * (b[i] as number), 0) < 0 ? -1 : 1;
  const q = a.map((v, i) => (1 - t) * v + t * same * (b[i] as number));
  const size = Math.hypot(...q) || 1;
  return q.map((v) => v / size) as Quaternion;
}

// The pixel of a point in the world; null when it is not in front of the camera.
export function project(view: View, optics: CameraOptics, point: Vec3): [number, number] | null {
  const d = minus(point, view.position);
  const depth = dot(view.forward, d);
  if (depth <= 1e-6) return null;
  return [
    optics.cx + (optics.fx * dot(view.right, d)) / depth,
    optics.cy + (optics.fy * dot(view.down, d)) / depth,
  ];
}

export interface ImageBox {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

const RIM = 24;

// The smallest box that holds an upright cylinder; null when a part of it is not in front.
export function boxOf(
  view: View, optics: CameraOptics, middle: Vec3, height: number, width: number,
): ImageBox | null {
  const box: ImageBox = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity };
  const rim = width > 0 ? RIM : 1;
  for (const end of height > 0 ? [-0.5, 0.5] : [0]) {
    for (let i = 0; i < rim; ++i) {
      const angle = (2 * Math.PI * i) / rim;
      const pixel = project(view, optics, add(middle, [
        (width / 2) * Math.cos(angle), (width / 2) * Math.sin(angle), end * height]));
      if (!pixel) return null;
      box.left = Math.min(box.left, pixel[0]);
      box.right = Math.max(box.right, pixel[0]);
      box.top = Math.min(box.top, pixel[1]);
      box.bottom = Math.max(box.bottom, pixel[1]);
    }
  }
  return box;
}

// The horizon as two points of the image, left and right; null when the camera looks straight up
// or down.
export function horizonOf(
  view: View, optics: CameraOptics,
): [[number, number], [number, number]] | null {
  // Points at infinity in direction d with d.z = 0: (d.right, d.down, d.forward) of any such d.
  // n = world up in the camera; pixels with n . (X, Y, 1) = 0.
  const n: Vec3 = [view.right[2], view.down[2], view.forward[2]];
  if (Math.abs(n[1]) < 1e-6) return null;
  const y = (x: number): number =>
    optics.cy - (optics.fy * (n[0] * ((x - optics.cx) / optics.fx) + n[2])) / n[1];
  return [[-0.5, y(-0.5)], [optics.width - 0.5, y(optics.width - 0.5)]];
}

// The same camera in an image of another width.
export function scaled(optics: CameraOptics, width: number): CameraOptics {
  const s = width / optics.width;
  return {
    width, height: optics.height * s, fx: optics.fx * s, fy: optics.fy * s,
    cx: (optics.cx + 0.5) * s - 0.5, cy: (optics.cy + 0.5) * s - 0.5,
  };
}

// The point at a distance in front of the camera.
export function ahead(view: View, metres: number): Vec3 {
  return add(view.position, times(view.forward, metres));
}
