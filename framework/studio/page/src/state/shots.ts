// SPDX-License-Identifier: Apache-2.0
// Shots to begin with, bent by hand afterwards: keyframes that go on from where the film ends. And
// a drawn stroke as keyframes.
import { entries, filmOf } from "./film";
import type { Edit } from "./edits";
import { lifted } from "./room";
import type { JsonObject, Patch, Vec3 } from "./types";
import { add, distance, minus, mix, rounded } from "./vector";

export interface Shot {
  name: string;
  text: string;
  // Places after `from`, around `about`, with the seconds since `from`.
  places(from: Vec3, about: Vec3): { after: number; position: Vec3 }[];
}

const SPEED = 2.5;     // m/s, of shots without a duration of their own
const CLIMB = 1.2;     // m/s

function along(from: Vec3, points: Vec3[]): { after: number; position: Vec3 }[] {
  let after = 0, before = from;
  return points.map((position) => {
    const across = Math.hypot(position[0] - before[0], position[1] - before[1]);
    after += Math.max(1, across / SPEED, Math.abs(position[2] - before[2]) / CLIMB);
    before = position;
    return { after, position };
  });
}

// Away from the subject, level; east where it stands right above it.
function outwards(from: Vec3, about: Vec3): Vec3 {
  const d: Vec3 = [from[0] - about[0], from[1] - about[1], 0];
  const size = Math.hypot(d[0], d[1]);
  return size > 1e-6 ? [d[0] / size, d[1] / size, 0] : [1, 0, 0];
}

export const shots: Shot[] = [
  { name: "Orbit", text: "once around the subject",
    places(from, about) {
      const radius = Math.max(5, Math.hypot(from[0] - about[0], from[1] - about[1]));
      const out = outwards(from, about);
      const start = Math.atan2(out[1], out[0]);
      return along(from, Array.from({ length: 8 }, (_, i): Vec3 => {
        const angle = start + ((i + 1) * Math.PI) / 4;
        return [about[0] + radius * Math.cos(angle), about[1] + radius * Math.sin(angle), from[2]];
      }));
    } },
  { name: "Crane", text: "straight up, ten metres",
    places: (from) => along(from, [add(from, [0, 0, 5]), add(from, [0, 0, 10])]) },
  { name: "Flyover", text: "over the subject and down on its far side",
    places(from, about) {
      const far: Vec3 = [2 * about[0] - from[0], 2 * about[1] - from[1], from[2]];
      const top: Vec3 = [about[0], about[1], Math.max(from[2], about[2]) + 10];
      return along(from, [top, far]);
    } },
  { name: "Dolly", text: "ten metres sideways, as on rails",
    places(from, about) {
      const out = outwards(from, about);
      const side: Vec3 = [-out[1] * 10, out[0] * 10, 0];
      return along(from, [add(from, side)]);
    } },
  { name: "Reveal", text: "back and up, so that the surroundings come into view",
    places(from, about) {
      const out = outwards(from, about);
      const to = (m: number, up: number): Vec3 => add(from, [out[0] * m, out[1] * m, up]);
      return along(from, [to(6, 2), to(16, 8)]);
    } },
];

const tenth = (time: number): number => Math.round(time * 10) / 10;

function extended(
  document: JsonObject, label: string, places: { after: number; position: Vec3 }[],
): Edit & { index: number } {
  const film = filmOf(document);
  const stretch = typeof document.stretch === "number" ? document.stretch : 1;
  const last = film.keyframes[film.keyframes.length - 1];
  const start = last ? last.time / stretch : 0;
  const list = entries(document, "keyframes").map((entry, i) => {
    if (typeof entry.time === "number") return entry;
    const { speed: _speed, ...rest } = entry;
    return { ...rest, time: tenth((film.keyframes[i]?.time ?? 0) / stretch) };
  });
  const index = list.length;
  for (const { after, position } of places) {
    list.push({ time: tenth(start + after), position: rounded(lifted(document, position)) });
  }
  const patch: Patch = [{ path: "keyframes", value: list }];
  const end = list[list.length - 1]?.time as number;
  if (typeof document.duration === "number" && document.duration < end) {
    patch.push({ path: "duration", value: end });
  }
  return { label, patch, index };
}

export function withShot(document: JsonObject, shot: Shot, about: Vec3): Edit & { index: number } {
  const keyframes = filmOf(document).keyframes;
  const last = keyframes[keyframes.length - 1];
  const from: Vec3 = last?.position ?? add(about, [-12, 0, 3]);
  return extended(document, `Add shot: ${shot.name}`, shot.places(from, about));
}

// The corners of a stroke that matter: Douglas and Peucker, then at most `most` of them.
export function simplified(points: Vec3[], tolerance: number): Vec3[] {
  const first = points[0], last = points[points.length - 1];
  if (!first || !last || points.length < 3) return points;
  let worst = 0, at = 0;
  points.forEach((p, i) => {
    const d = fromLine(p, first, last);
    if (d > worst) {
      worst = d;
      at = i;
    }
  });
  if (worst <= tolerance) return [first, last];
  const head = simplified(points.slice(0, at + 1), tolerance);
  return [...head.slice(0, -1), ...simplified(points.slice(at), tolerance)];
}

function fromLine(p: Vec3, a: Vec3, b: Vec3): number {
  const d = minus(b, a), size = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  if (size < 1e-12) return distance(p, a);
  const w = minus(p, a);
  const share = Math.min(1, Math.max(0, (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / size));
  return distance(p, mix(a, b, share));
}

const MOST = 12;

// Keyframes along a drawn stroke; null where it is shorter than a metre.
export function withStroke(document: JsonObject, stroke: Vec3[]): (Edit & { index: number }) | null {
  let length = 0;
  stroke.forEach((p, i) => { if (i > 0) length += distance(p, stroke[i - 1] as Vec3); });
  if (length < 1) return null;
  let tolerance = length / 80, corners = simplified(stroke, tolerance);
  while (corners.length > MOST) corners = simplified(stroke, tolerance *= 1.5);
  // A straight stroke has a middle too.
  if (corners.length === 2) corners.splice(1, 0, mix(corners[0] as Vec3, corners[1] as Vec3, 0.5));
  const keyframes = filmOf(document).keyframes;
  const last = keyframes[keyframes.length - 1];
  const from = last?.position ?? (corners[0] as Vec3);
  return extended(document, "Draw keyframes", along(from, last ? corners : corners.slice()));
}
