// SPDX-License-Identifier: Apache-2.0
// Edits of a film as patches with a label. A list that keeps its length is changed entry by entry,
// any other is set whole.
import { entries, filmOf } from "./film";
import { endNames, isCourse } from "./course";
import { freeGround, lifted } from "./room";
import { levelsOf, placeNames, placeOf, placePaths, polygonNames, prismOf, siteLists, isSite, boxOf, isExplored, wishLists, wishNames, type PolygonKind, type WishKind } from "./site";
import { cornersOf, flatCorners, handleOf, movedObstacle } from "./shapes";
import type { Json, JsonObject, Patch, Vec3 } from "./types";
import { add, minus, mix, rounded, vec } from "./vector";

export interface Edit {
  label: string;
  patch: Patch;
}

export type Item =
  | { kind: "keyframe" | "look" | "subject" | "obstacle" | PolygonKind | WishKind | "gate"; index: number }
  | { kind: "end"; index: 0 | 1 }                 // where a race starts and finishes
  | { kind: "place"; index: number }              // where the flights of a scan begin, home
  | { kind: "extent"; index: 0 | 1 }              // the ends of the box that is scanned
  | { kind: "track"; index: number; point: number }
  | { kind: "corner"; of: "obstacle" | PolygonKind; index: number; point: number };

const pointOf = (item: Item): string =>
  item.kind === "track" ? `${item.point}` : item.kind === "corner" ? `${item.of}${item.point}` : "";

export const sameItem = (a: Item | null, b: Item | null): boolean =>
  a !== null && b !== null && a.kind === b.kind && a.index === b.index && pointOf(a) === pointOf(b);

type Single = "end" | "place" | "extent";
const isSingle = (item: Item): item is Extract<Item, { kind: Single }> =>
  item.kind === "end" || item.kind === "place" || item.kind === "extent";
const extentNames = ["lower", "upper"] as const;
const isPolygon = (kind: string): kind is PolygonKind => kind in siteLists;

const isWish = (kind: string): kind is WishKind => kind in wishLists;

const listNames: Record<Exclude<Item["kind"], "corner" | Single>, string> = {
  keyframe: "keyframes", look: "keyframes", subject: "subjects", obstacle: "obstacles",
  track: "subjects", gate: "gates", ...siteLists, ...wishLists,
};

const listOf = (item: Exclude<Item, { kind: Single }>): string =>
  listNames[item.kind === "corner" ? item.of : item.kind];

// Zones and regions are prisms that say nothing of their type.
export function entryOf(document: JsonObject, item: Item): JsonObject | null {
  if (item.kind === "end") {
    const position = isCourse(document) ? vec(document[endNames[item.index]]) : null;
    return position && { position };
  }
  if (item.kind === "place") {
    const placed = isSite(document) || (isExplored(document) && item.index === 0);
    const position = placed ? placeOf(document, item.index) : null;
    return position && { position };
  }
  if (item.kind === "extent") {
    const position = boxOf(document)?.[extentNames[item.index]];
    return position ? { position } : null;
  }
  const entry = entries(document, listOf(item))[item.index];
  if (!entry) return null;
  const of = item.kind === "corner" ? item.of : item.kind;
  const shaped = isPolygon(of) ? prismOf(document, of, item.index) ?? entry : entry;
  return item.kind === "corner" && !cornersOf(shaped.corners)[item.point] ? null : shaped;
}

// The item whose corners are shown: the one that is selected, or that a selected corner is of.
export function corneredItem(document: JsonObject, item: Item | null): Item | null {
  const owner = item?.kind === "corner" ? { kind: item.of, index: item.index } as Item : item;
  if (!owner || (owner.kind !== "obstacle" && !isPolygon(owner.kind))) return null;
  return cornersOf(entryOf(document, owner)?.corners).length > 2 ? owner : null;
}

export function nameOf(document: JsonObject, item: Item): string {
  const entry = entryOf(document, item);
  const name = typeof entry?.name === "string" && entry.name ? entry.name : "";
  const n = item.index + 1;
  switch (item.kind) {
    case "end": return endNames[item.index];
    case "place": return placeNames[item.index] ?? "place";
    case "extent": return `${extentNames[item.index]} end of the region`;
    case "gate": return name ? `gate ${name}` : `gate ${n}`;
    case "pinned":
    case "forbidden": return `${wishNames[item.kind]} ${n}`;
    case "keyframe": return `keyframe ${n}`;
    case "look": return `look-at point of keyframe ${n}`;
    case "subject": return name ? `subject ${name}` : `subject ${n}`;
    case "track": return `place ${item.point + 1} of ${name || `subject ${n}`}`;
    case "obstacle": return name ? `obstacle ${name}` : `obstacle ${n}`;
    case "zone":
    case "closed":
    case "region": {
      const word = polygonNames[item.kind];
      return name ? (name.startsWith(word) ? name : `${word} ${name}`) : `${word} ${n}`;
    }
    case "corner": return `corner ${item.point + 1} of ${name || `${item.of === "obstacle"
      ? "obstacle" : polygonNames[item.of]} ${n}`}`;
  }
}

export function pathOfItem(document: JsonObject, item: Item): string | null {
  if (item.kind === "end") return endNames[item.index];
  if (item.kind === "place") return placePaths[item.index] ?? null;
  if (item.kind === "extent") return `region.${extentNames[item.index]}`;
  const list = `${listOf(item)}[${item.index + 1}]`;
  if (item.kind === "keyframe" || item.kind === "gate" || isWish(item.kind)) {
    return `${list}.position`;
  }
  if (item.kind === "look") return `${list}.look_at`;
  if (item.kind === "track") return `${list}.track[${item.point + 1}].position`;
  if (item.kind === "subject") {
    return vec(entryOf(document, item)?.position) ? `${list}.position` : null;
  }
  return null;
}

export function placeOfItem(document: JsonObject, item: Item): Vec3 | null {
  const entry = entryOf(document, item);
  if (!entry) return null;
  if (item.kind === "keyframe" || item.kind === "gate" || isWish(item.kind) || isSingle(item)) {
    return vec(entry.position);
  }
  if (item.kind === "look") return vec(entry.look_at);
  if (item.kind === "obstacle" || isPolygon(item.kind)) return handleOf(entry);
  if (item.kind === "corner") {
    const corner = cornersOf(entry.corners)[item.point];
    return corner ? [...corner, handleOf(entry)?.[2] ?? 0] : null;
  }
  const track = Array.isArray(entry.track) ? entry.track : [];
  if (item.kind === "track") return vec((track[item.point] as JsonObject | undefined)?.position);
  return vec(entry.position) ?? vec((track[0] as JsonObject | undefined)?.position);
}

export function moved(document: JsonObject, item: Item, to: Vec3): Edit | null {
  const from = placeOfItem(document, item);
  const entry = entryOf(document, item);
  if (!from || !entry) return null;
  const label = `Move ${nameOf(document, item)}`;
  const path = pathOfItem(document, item);
  if (path || isSingle(item)) return path ? { label, patch: [{ path, value: rounded(to) }] } : null;
  const list = `${listOf(item)}[${item.index + 1}]`;
  if (item.kind === "obstacle" || isPolygon(item.kind)) {
    const patch = movedObstacle(entry, list, minus(to, from));
    // Regions name their ends otherwise.
    const [low, high] = item.kind === "region" ? levelsOf("region") : ["floor", "ceiling"];
    for (const change of patch) {
      change.path = change.path.replace(/\.floor$/, `.${low}`).replace(/\.ceiling$/, `.${high}`);
    }
    return patch.length > 0 ? { label, patch } : null;
  }
  if (item.kind === "corner") {
    const corners = cornersOf(entry.corners);
    corners[item.point] = [to[0], to[1]];
    return { label, patch: [{ path: `${list}.corners`, value: flatCorners(corners) }] };
  }
  // A subject with a track moves as a whole.
  const by = minus(to, from);
  const track = (Array.isArray(entry.track) ? entry.track : []) as JsonObject[];
  const patch: Patch = track.flatMap((point, i) => {
    const position = vec(point.position);
    return position
      ? [{ path: `subjects[${item.index + 1}].track[${i + 1}].position`,
           value: rounded(add(position, by)) }] : [];
  });
  return patch.length > 0 ? { label, patch } : null;
}

const tenth = (time: number): number => Math.round(time * 10) / 10;

function withKeyframes(label: string, list: JsonObject[], duration?: number): Edit {
  const patch: Patch = [{ path: "keyframes", value: list }];
  if (duration !== undefined) patch.push({ path: "duration", value: duration });
  return { label, patch };
}

// A keyframe at a time, between those beside it; its index is returned as well.
export function inserted(
  document: JsonObject, time: number, position: Vec3, lookAt: Vec3 | null = null,
): Edit & { index: number } {
  const film = filmOf(document);
  const list = entries(document, "keyframes");
  let index = film.keyframes.filter((k) => k.time <= time).length;
  const made: JsonObject = { time: tenth(time), position: rounded(position) };
  while (film.keyframes.some((k) => Math.abs(k.time - (made.time as number)) < 0.05)) {
    made.time = tenth((made.time as number) + 0.5);
    index = film.keyframes.filter((k) => k.time <= (made.time as number)).length;
  }
  if (lookAt) made.look_at = rounded(lookAt);
  const timedList = withTimes(document, list);
  timedList.splice(index, 0, made);
  const end = longer(document, made.time as number);
  return { ...withKeyframes(`Add keyframe ${index + 1}`, timedList, end), index };
}

// One after the last, as far in time as the leg is long at the mean speed so far.
export function appended(
  document: JsonObject, position: Vec3, lookAt: Vec3 | null = null,
): Edit & { index: number } {
  const film = filmOf(document);
  const last = film.keyframes[film.keyframes.length - 1];
  if (!last) return inserted(document, 0, position, lookAt);
  const first = film.keyframes[0] as typeof last;
  let way = 0;
  film.keyframes.forEach((k, i) => {
    const before = film.keyframes[i - 1];
    if (before) way += Math.hypot(...minus(k.position, before.position));
  });
  const speed = last.time > first.time ? Math.max(0.5, way / (last.time - first.time)) : 2;
  const leg = Math.max(2, Math.hypot(...minus(position, last.position)) / speed);
  return inserted(document, last.time + leg, lifted(document, position), lookAt);
}

function longer(document: JsonObject, time: number): number | undefined {
  return typeof document.duration === "number" && document.duration < time ? time : undefined;
}

// A list in which a new time is stated needs the times of the others too, except where a speed
// gives them.
function withTimes(document: JsonObject, list: JsonObject[]): JsonObject[] {
  const film = filmOf(document);
  const stretch = typeof document.stretch === "number" ? document.stretch : 1;
  return list.map((entry, i) => {
    if (typeof entry.time === "number") return entry;
    const { speed: _speed, ...rest } = entry;
    return { ...rest, time: tenth((film.keyframes[i]?.time ?? 0) / stretch) };
  });
}

export function duplicated(document: JsonObject, index: number): (Edit & { index: number }) | null {
  const film = filmOf(document);
  const keyframe = film.keyframes[index];
  const entry = entries(document, "keyframes")[index];
  if (!keyframe || !entry) return null;
  const next = film.keyframes[index + 1];
  const time = next ? (keyframe.time + next.time) / 2 : keyframe.time + 2;
  const position = next ? mix(keyframe.position, next.position, 0.25)
    : add(keyframe.position, [0, 0, 1]);
  const list = withTimes(document, entries(document, "keyframes"));
  list.splice(index + 1, 0, { ...entry, time: tenth(time), position: rounded(position) });
  const end = longer(document, tenth(time));
  return { ...withKeyframes(`Duplicate keyframe ${index + 1}`, list, end), index: index + 1 };
}

// A corner in the middle of the side after this one.
export function addedCorner(document: JsonObject, item: Item): (Edit & { point: number }) | null {
  const owner = corneredItem(document, item);
  const corners = cornersOf(owner && entryOf(document, owner)?.corners);
  if (!owner || isSingle(owner) || corners.length < 3) return null;
  const point = item.kind === "corner" ? item.point : corners.length - 1;
  const [ax, ay] = corners[point] as [number, number];
  const [bx, by] = corners[(point + 1) % corners.length] as [number, number];
  corners.splice(point + 1, 0, [(ax + bx) / 2, (ay + by) / 2]);
  return { label: `Add a corner to ${nameOf(document, owner)}`, point: point + 1,
           patch: [{ path: `${listOf(owner)}[${owner.index + 1}].corners`,
                     value: flatCorners(corners) }] };
}

// What a script sets cannot be taken away alone; a list without it can be set whole.
export function without(document: JsonObject, label: string, index: number, key: string): Edit {
  const list = entries(document, "keyframes").map((entry, i) => {
    if (i !== index) return entry;
    const { [key]: _gone, ...rest } = entry;
    return rest;
  });
  return { label, patch: [{ path: "keyframes", value: list }] };
}

export function deleted(document: JsonObject, item: Item): Edit | null {
  if (isSingle(item)) return null;
  const label = `Delete ${nameOf(document, item)}`;
  if (item.kind === "look") return without(document, label, item.index, "look_at");
  const name = listOf(item);
  const list = entries(document, name);
  if (item.kind === "keyframe" && list.length <= 2) return null;
  if (item.kind === "gate" && list.length <= 1) return null;
  if (item.kind === "corner") {
    const corners = cornersOf(entryOf(document, item)?.corners);
    if (corners.length <= 3) return null;
    corners.splice(item.point, 1);
    return { label, patch: [{ path: `${name}[${item.index + 1}].corners`,
                              value: flatCorners(corners) }] };
  }
  if (item.kind === "track") return null;
  const left = list.filter((_, i) => i !== item.index);
  return item.kind === "keyframe" ? withEnds(document, label, list, left, item.index)
    : { label, patch: [{ path: name, value: left }] };
}

// Without its first or its last keyframe a film begins, or ends, at the one that is left: before and
// after it nothing says where the camera is to be.
function withEnds(
  document: JsonObject, label: string, list: JsonObject[], left: JsonObject[], gone: number,
): Edit {
  const first = left[0] as JsonObject, last = left[left.length - 1] as JsonObject;
  if (gone === 0 && typeof first.time === "number") {
    const { earliest: _e, latest: _l, ...rest } = first;
    left[0] = { ...rest, time: typeof list[0]?.time === "number" ? list[0].time : 0 };
  }
  const ends = gone === list.length - 1 && typeof document.duration === "number" &&
    typeof last.time === "number";
  return withKeyframes(label, left, ends ? (last.time as number) : undefined);
}

// The places change, the times stay: what was passed second is passed first.
export function reordered(document: JsonObject, index: number, by: -1 | 1): Edit | null {
  const list = entries(document, "keyframes").slice();
  const other = index + by;
  const a = list[index], b = list[other];
  if (!a || !b) return null;
  const timesOf = (entry: JsonObject): JsonObject => {
    const kept: JsonObject = {};
    for (const key of ["time", "earliest", "latest", "time_weight", "speed"]) {
      if (entry[key] !== undefined) kept[key] = entry[key] as Json;
    }
    return kept;
  };
  const untimed = (entry: JsonObject): JsonObject => {
    const { time: _t, earliest: _e, latest: _l, time_weight: _w, speed: _s, ...rest } = entry;
    return rest;
  };
  list[index] = { ...timesOf(a), ...untimed(b) };
  list[other] = { ...timesOf(b), ...untimed(a) };
  return withKeyframes(`Swap keyframes ${Math.min(index, other) + 1} and ` +
    `${Math.max(index, other) + 1}`, list);
}

// The earliest and the latest time of a keyframe, between its neighbours, s.
export function timeRange(document: JsonObject, index: number): [number, number] {
  const { keyframes } = filmOf(document);
  const before = keyframes[index - 1], after = keyframes[index + 1];
  return [before ? tenth(before.time + 0.2) : 0, after ? tenth(after.time - 0.2) : Infinity];
}

// As near to a time as its neighbours allow; the film grows with its last keyframe and shrinks with
// it.
export function retimed(document: JsonObject, index: number, time: number): Edit | null {
  const film = filmOf(document);
  const stretch = typeof document.stretch === "number" ? document.stretch : 1;
  const after = film.keyframes[index + 1];
  if (!film.keyframes[index]) return null;
  const [earliest, latest] = timeRange(document, index);
  const wanted = tenth(Math.min(Math.max(tenth(time), earliest), latest) / stretch);
  const label = `Time of keyframe ${index + 1}`;
  const all = entries(document, "keyframes");
  const patch: Patch = all.every((entry) => typeof entry.time === "number")
    ? [{ path: `keyframes[${index + 1}].time`, value: wanted }]
    : [{ path: "keyframes", value: withTimes(document, all).map((entry, i) =>
        i === index ? { ...entry, time: wanted } : entry) }];
  if (!after && typeof document.duration === "number") {
    patch.push({ path: "duration", value: wanted });
  }
  return { label, patch };
}

// The leg to a keyframe takes `factor` times as long, at least 0.2 s; all that follows comes later.
export function slowed(document: JsonObject, index: number, factor: number): Edit | null {
  const film = filmOf(document);
  const here = film.keyframes[index], before = film.keyframes[index - 1];
  if (!here || !before) return null;
  const leg = here.time - before.time;
  const by = Math.max(leg * factor, Math.min(leg, 0.2)) - leg;
  const list = withTimes(document, entries(document, "keyframes")).map((entry, i) =>
    i < index ? entry : { ...entry, time: Math.ceil(((entry.time as number) + by) * 10) / 10 });
  const last = list[list.length - 1]?.time as number;
  const end = typeof document.duration === "number"
    ? Math.max(last, tenth(document.duration + by)) : undefined;
  return withKeyframes(`${factor < 1 ? "Speed up" : "Slow"} the leg to keyframe ${index + 1}`, list,
                       end);
}

export function cutAt(document: JsonObject, start: number, finish: number): Edit {
  const list = [...entries(document, "cuts"), { start: tenth(start), finish: tenth(finish) }]
    .sort((a, b) => Number(a.start) - Number(b.start));
  return { label: "Add a cut", patch: [{ path: "cuts", value: list as Json }] };
}

export function uncut(document: JsonObject, index: number): Edit {
  const list = entries(document, "cuts").filter((_, i) => i !== index);
  return { label: `Remove cut ${index + 1}`, patch: [{ path: "cuts", value: list }] };
}

// What a new obstacle can be, and how it begins: four metres wide, on the ground at `p`.
export const obstacleKinds: {
  type: string; text: string; radius: number; shape(p: Vec3): JsonObject;
}[] = [
  { type: "box", text: "Box", radius: 3, shape: (p) => ({
    lower: [p[0] - 2, p[1] - 2, p[2]], upper: [p[0] + 2, p[1] + 2, p[2] + 4] }) },
  { type: "sphere", text: "Ball", radius: 2, shape: (p) => ({ center: [p[0], p[1], p[2] + 2], radius: 2 }) },
  { type: "cylinder", text: "Column", radius: 2, shape: (p) => ({ base: p, radius: 2, height: 8 }) },
  { type: "cone", text: "Tent", radius: 2, shape: (p) => ({ base: p, radius: 2, height: 4 }) },
  { type: "no_fly_zone", text: "No-fly zone", radius: 6, shape: (p) => ({
    corners: [p[0] - 4, p[1] - 4, p[0] + 4, p[1] - 4, p[0] + 4, p[1] + 4, p[0] - 4, p[1] + 4],
    floor: 0, ceiling: 30, opaque: false }) },
];

const AROUND = 10;     // m, of a new flight zone around what is flown

// What flies stays inside: a square around all keyframes.
function addedZone(document: JsonObject): Edit {
  const list = entries(document, "flight_zones");
  const places = filmOf(document).keyframes.map((k) => k.position);
  const end = (axis: number, sign: 1 | -1): number => sign * Math.ceil(
    Math.max(...places.map((p) => sign * (p[axis] as number)), 0) + AROUND);
  const [west, east, south, north] = [end(0, -1), end(0, 1), end(1, -1), end(1, 1)];
  const made: JsonObject = {
    name: `flight zone ${list.length + 1}`, ceiling: end(2, 1), floor: -AROUND,
    corners: [west, south, east, south, east, north, west, north],
  };
  return { label: `Add ${made.name}`, patch: [{ path: "flight_zones", value: [...list, made] }] };
}

// An obstacle, or a zone that is no obstacle.
export function addedObstacle(document: JsonObject, type: string, at: Vec3): Edit | null {
  if (type === "flight_zone") return addedZone(document);
  const kind = obstacleKinds.find((one) => one.type === type);
  if (!kind) return null;
  const list = entries(document, "obstacles");
  const name = `${kind.text.toLowerCase()} ${list.length + 1}`;
  const made: JsonObject = { type, name, ...kind.shape(freeGround(document, rounded(at), kind.radius)) };
  return { label: `Add ${name}`, patch: [{ path: "obstacles", value: [...list, made] }] };
}

export function addedSubject(document: JsonObject, at: Vec3): Edit {
  const list = entries(document, "subjects");
  // With one subject the film needs no name for it; with two every one does.
  const named = list.map((entry, i) => (entry.name ? entry : { ...entry, name: `subject ${i + 1}` }));
  const made: JsonObject = { position: rounded(add(at, [0, 0, 0.9])), height: 1.8, width: 0.6 };
  const patch: Patch = [{ path: "subjects", value: [...named, made] }];
  if (list.length > 0) {
    made.name = `subject ${list.length + 1}`;
    // Of several, the first keyframe selects one; those after it keep it.
    const keyframes = entries(document, "keyframes");
    const [first, ...rest] = keyframes;
    if (first && !keyframes.some((k) => k.subject || k.look_at)) {
      patch.push({ path: "keyframes",
                   value: [{ ...first, subject: (named[0] as JsonObject).name as Json }, ...rest] });
    }
  }
  return { label: "Add a subject", patch };
}

export function lookedAt(index: number, point: Vec3): Edit {
  return {
    label: `Aim keyframe ${index + 1}`,
    patch: [{ path: `keyframes[${index + 1}].look_at`, value: rounded(point) }],
  };
}
