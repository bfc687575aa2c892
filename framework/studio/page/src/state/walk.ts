// SPDX-License-Identifier: Apache-2.0
// The way of a subject as it was walked in real time: places by their times, thinned to the corners
// that matter in place and time, laid into its track.
import { isObject } from "./document";
import type { Edit } from "./edits";
import { entries } from "./film";
import type { Json, JsonObject, Vec3 } from "./types";
import { distance, mix, rounded, vec } from "./vector";

export interface Step {
  time: number;      // s of the film
  place: Vec3;
}

const TOLERANCE = 0.1;     // m between what was walked and the track, at every time
const SHORTEST = 0.3;      // s

// Linear in time between the steps that are kept: Douglas and Peucker with the distance at equal
// times, so that pauses and changes of pace stay.
export function thinned(steps: Step[], tolerance = TOLERANCE): Step[] {
  const first = steps[0], last = steps[steps.length - 1];
  if (!first || !last || steps.length < 3) return steps;
  let worst = 0, at = 0;
  steps.forEach((step, i) => {
    const share = (step.time - first.time) / Math.max(last.time - first.time, 1e-9);
    const d = distance(step.place, mix(first.place, last.place, share));
    if (d > worst) {
      worst = d;
      at = i;
    }
  });
  if (worst <= tolerance) return [first, last];
  return [...thinned(steps.slice(0, at + 1), tolerance).slice(0, -1),
          ...thinned(steps.slice(at), tolerance)];
}

// In place of what the track had in this span; what it had before and after stays. Null where
// nothing was walked.
export function walked(document: JsonObject, subject: number, steps: Step[]): Edit | null {
  const entry = entries(document, "subjects")[subject];
  const first = steps[0], last = steps[steps.length - 1];
  if (!entry || !first || !last || last.time - first.time < SHORTEST) return null;
  const made = thinned(steps).map(({ time, place }): JsonObject =>
    ({ time: Math.round(time * 100) / 100, position: rounded(place) }));
  const had = (Array.isArray(entry.track) ? entry.track.filter(isObject) : [])
    .filter((point) => typeof point.time === "number" && vec(point.position) &&
      (point.time < first.time - 0.05 || point.time > last.time + 0.05));
  const track = [...had, ...made].sort((a, b) => Number(a.time) - Number(b.time))
    .filter((point, i, all) => i === 0 || Number(point.time) > Number(all[i - 1]?.time));
  const { position: _gone, ...rest } = entry;
  const list = entries(document, "subjects").map((one, i): Json =>
    (i === subject ? { ...rest, track: track as Json } : one));
  return { label: `Walk ${typeof entry.name === "string" && entry.name ? entry.name
    : `subject ${subject + 1}`}`, patch: [{ path: "subjects", value: list }] };
}
