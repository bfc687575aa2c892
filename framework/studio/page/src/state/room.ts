// SPDX-License-Identifier: Apache-2.0
// Room among the obstacles: where a new keyframe or a new obstacle would not be refused at once. The
// planner finds the way between them; only places count here.
import { entries, filmOf } from "./film";
import { cornersOf } from "./shapes";
import type { JsonObject, Vec3 } from "./types";
import { vec } from "./vector";

const number = (value: unknown, otherwise: number): number =>
  typeof value === "number" && Number.isFinite(value) ? value : otherwise;

// Whether (x, y) is inside a polygon, by the crossings of a ray to the east.
function insidePolygon(corners: [number, number][], x: number, y: number): boolean {
  let inside = false;
  corners.forEach(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length] as [number, number];
    if ((ay > y) !== (by > y) && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  });
  return inside;
}

// The span of heights that an obstacle takes at (x, y), with `margin` around it; null: none there.
function taken(obstacle: JsonObject, x: number, y: number, margin: number): [number, number] | null {
  const radius = number(obstacle.radius, 0) + margin;
  const height = number(obstacle.height, 0);
  switch (obstacle.type) {
    case "sphere": {
      const c = vec(obstacle.center);
      const left = c ? radius * radius - (x - c[0]) ** 2 - (y - c[1]) ** 2 : -1;
      return c && left > 0 ? [c[2] - Math.sqrt(left), c[2] + Math.sqrt(left)] : null;
    }
    case "box": {
      const a = vec(obstacle.lower), b = vec(obstacle.upper);
      if (!a || !b || x < a[0] - margin || x > b[0] + margin) return null;
      return y < a[1] - margin || y > b[1] + margin ? null : [a[2] - margin, b[2] + margin];
    }
    case "cylinder":
    case "cone": {
      const c = vec(obstacle.base);
      if (!c || Math.hypot(x - c[0], y - c[1]) > radius) return null;
      return [c[2] - margin, c[2] + height + margin];
    }
    case "prism":
    case "no_fly_zone": {
      const corners = cornersOf(obstacle.corners);
      const near = [[0, 0], [margin, 0], [-margin, 0], [0, margin], [0, -margin]] as const;
      if (!near.some(([dx, dy]) => insidePolygon(corners, x + dx, y + dy))) return null;
      return [number(obstacle.floor, -Infinity) - margin, number(obstacle.ceiling, Infinity) + margin];
    }
    default:
      return null;
  }
}

const MORE = 0.2;     // m beyond the margin

// The place itself, or above what it is inside of; itself too where nothing is above.
export function lifted(document: JsonObject, place: Vec3): Vec3 {
  const margin = number(document.margin, 0.5) + MORE;
  let [, , z] = place;
  for (let round = 0; round < 4; ++round) {
    const before = z;
    for (const obstacle of entries(document, "obstacles")) {
      if (obstacle.side === "keep_inside") continue;
      const span = taken(obstacle, place[0], place[1], margin);
      if (span && z > span[0] && z < span[1] && Number.isFinite(span[1])) z = span[1];
    }
    if (z === before) break;
  }
  return [place[0], place[1], z];
}

// The nearest place on the ground at which a thing of this radius has no keyframe within.
export function freeGround(document: JsonObject, from: Vec3, radius: number): Vec3 {
  const away = radius + number(document.margin, 0.5) + 1;
  const { keyframes } = filmOf(document);
  const free = (x: number, y: number): boolean =>
    keyframes.every(({ position: p }) => Math.hypot(p[0] - x, p[1] - y) > away);
  for (let r = 0; r <= 60; r += 2) {
    const count = Math.max(1, Math.ceil(r * 2));
    for (let i = 0; i < count; ++i) {
      const angle = (2 * Math.PI * i) / count - Math.PI / 2;
      const x = from[0] + r * Math.cos(angle), y = from[1] + r * Math.sin(angle);
      if (free(x, y)) return [Math.round(x * 2) / 2, Math.round(y * 2) / 2, from[2]];
    }
  }
  return from;
}

// Whether a point is inside an obstacle, as far as the page knows its shape.
export function holds(obstacle: JsonObject, p: Vec3): boolean {
  if (obstacle.type === "capsule") {
    const from = vec(obstacle.from), to = vec(obstacle.to);
    if (!from || !to) return false;
    const d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]] as Vec3;
    const size = d[0] ** 2 + d[1] ** 2 + d[2] ** 2;
    const along = size > 0 ? Math.min(1, Math.max(0, ((p[0] - from[0]) * d[0] +
      (p[1] - from[1]) * d[1] + (p[2] - from[2]) * d[2]) / size)) : 0;
    return Math.hypot(p[0] - from[0] - along * d[0], p[1] - from[1] - along * d[1],
                      p[2] - from[2] - along * d[2]) < number(obstacle.radius, 0);
  }
  if (obstacle.type === "cone") {
    const base = vec(obstacle.base), height = number(obstacle.height, 0);
    if (!base || height <= 0 || p[2] <= base[2]) return false;
    return Math.hypot(p[0] - base[0], p[1] - base[1]) <
      number(obstacle.radius, 0) * (1 - (p[2] - base[2]) / height);
  }
  const span = taken(obstacle, p[0], p[1], 0);
  return span !== null && p[2] > span[0] && p[2] < span[1];
}
