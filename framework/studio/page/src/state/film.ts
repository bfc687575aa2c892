// SPDX-License-Identifier: Apache-2.0
// A document read as a film: keyframes with their times, where the camera looks, subjects, cuts.
import { isObject } from "./document";
import type { Json, JsonObject, SubjectTrack, Vec3 } from "./types";
import { clamp, distance, minus, mix, vec } from "./vector";

export interface Keyframe {
  index: number;
  time: number;
  timed: boolean;             // whether the document states the time
  position: Vec3;
  lookAt: Vec3 | null;
  subject: string | null;     // the name of what it films
  yaw: number | null;         // rad
}

export interface Cut {
  start: number;
  finish: number | null;
}

export interface Film {
  duration: number;
  keyframes: Keyframe[];
  subjects: SubjectTrack[];
  cuts: Cut[];
  restStart: boolean;
  restFinish: boolean;
}

export function entries(document: JsonObject, name: string): JsonObject[] {
  const list = document[name];
  return Array.isArray(list) ? list.filter(isObject) : [];
}

const number = (value: Json | undefined): number | null =>
  typeof value === "number" && Number.isFinite(value) ? value : null;
const text = (value: Json | undefined): string | null =>
  typeof value === "string" && value !== "" ? value : null;

// A leg without times, as a planner would roughly fly it; the server's answer replaces it.
const SPEED = 3;       // m/s
const SHORTEST = 1;    // s

// Stated times are kept. Others are even between their neighbours, or follow from a speed.
export function keyframeTimes(
  given: (number | null)[], positions: Vec3[], duration: number | null, speed: number | null,
): number[] {
  const n = given.length;
  const result = given.slice();
  if (n === 0) return [];
  if (result[0] === null) result[0] = 0;
  if (n > 1 && result[n - 1] === null && duration !== null && speed === null) {
    result[n - 1] = duration;
  }
  const leg = (i: number): number =>
    Math.max(SHORTEST, distance(positions[i] as Vec3, positions[i - 1] as Vec3) / (speed ?? SPEED));
  for (let i = 1; i < n; ++i) {
    if (result[i] !== null) continue;
    let next = i;
    while (next < n && result[next] === null) ++next;
    const before = result[i - 1] as number;
    if (next === n || speed !== null) {
      result[i] = before + leg(i);
    } else {
      result[i] = before + ((result[next] as number) - before) / (next - i + 1);
    }
  }
  return result as number[];
}

export function subjectsOf(document: JsonObject): SubjectTrack[] {
  return entries(document, "subjects").map((entry, i) => {
    const track = Array.isArray(entry.track) ? entry.track.filter(isObject) : [];
    const times: number[] = [];
    const positions: Vec3[] = [];
    for (const point of track) {
      const position = vec(point.position);
      const time = number(point.time);
      if (position && time !== null) {
        times.push(time);
        positions.push(position);
      }
    }
    if (positions.length === 0) {
      times.push(0);
      positions.push(vec(entry.position) ?? [0, 0, 0]);
    }
    return {
      name: text(entry.name) ?? (i === 0 ? "subject" : `subject ${i + 1}`),
      times, positions, height: number(entry.height) ?? 0, width: number(entry.width) ?? 0,
    };
  });
}

// Linear between the times of its track, at rest before and after.
export function subjectAt(subject: SubjectTrack, time: number): Vec3 {
  const { times, positions } = subject;
  let i = 0;
  while (i + 1 < times.length && (times[i + 1] as number) <= time) ++i;
  const here = positions[i] ?? [0, 0, 0];
  const next = positions[i + 1];
  if (!next) return here;
  const from = times[i] as number, to = times[i + 1] as number;
  return mix(here, next, to > from ? clamp((time - from) / (to - from), 0, 1) : 1);
}

export function filmOf(document: JsonObject): Film {
  const listed = entries(document, "keyframes");
  const positions = listed.map((entry) => vec(entry.position) ?? ([0, 0, 0] as Vec3));
  const given = listed.map((entry) => number(entry.time));
  const duration = number(document.duration);
  const all = keyframeTimes(given, positions, duration, number(document.speed));
  const stretch = number(document.stretch) ?? 1;
  const keyframes = listed.map((entry, index): Keyframe => {
    const yaw = number(entry.yaw_deg);
    return {
      index, time: (all[index] as number) * stretch, timed: given[index] !== null,
      position: positions[index] as Vec3, lookAt: vec(entry.look_at), subject: text(entry.subject),
      yaw: yaw === null ? null : (yaw * Math.PI) / 180,
    };
  });
  const last = keyframes.reduce((most, k) => Math.max(most, k.time), 0);
  return {
    duration: Math.max(duration === null ? 0 : duration * stretch, last),
    keyframes,
    subjects: subjectsOf(document),
    cuts: entries(document, "cuts").map((entry) => ({
      start: number(entry.start) ?? 0, finish: number(entry.finish),
    })),
    restStart: document.start === undefined || document.start === "rest",
    restFinish: document.finish === undefined || document.finish === "rest",
  };
}

// Where the camera looks at a time: what each keyframe states or takes over from the one before,
// with an even turn between two of them. Null where the film states nothing.
export function targetAt(film: Film, time: number): Vec3 | null {
  const wanted: { time: number; at: (t: number) => Vec3 }[] = [];
  let current: ((t: number) => Vec3) | null =
    film.subjects.length === 1 ? (t) => subjectAt(film.subjects[0] as SubjectTrack, t) : null;
  const ordered = [...film.keyframes].sort((a, b) => a.time - b.time);
  for (const keyframe of ordered) {
    const point = keyframe.lookAt;
    const named = film.subjects.find((s) => s.name === keyframe.subject);
    if (point) current = () => point;
    else if (named) current = (t) => subjectAt(named, t);
    else if (!current && film.subjects.length > 0) {
      current = (t) => subjectAt(film.subjects[0] as SubjectTrack, t);
    }
    if (current) wanted.push({ time: keyframe.time, at: current });
  }
  const first = wanted[0];
  if (!first) return current ? current(time) : null;
  let i = 0;
  while (i + 1 < wanted.length && (wanted[i + 1] as { time: number }).time <= time) ++i;
  const here = wanted[i] as { time: number; at: (t: number) => Vec3 };
  const next = wanted[i + 1];
  if (!next || next.at === here.at || time < here.time) return here.at(time);
  const share = clamp((time - here.time) / Math.max(next.time - here.time, 1e-9), 0, 1);
  return mix(here.at(time), next.at(time), share);
}

export function headingTo(from: Vec3, to: Vec3): { yaw: number; pitch: number } {
  const d = minus(to, from);
  const across = Math.hypot(d[0], d[1]);
  return { yaw: Math.atan2(d[1], d[0]), pitch: Math.atan2(d[2], across) };
}
