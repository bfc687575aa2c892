// SPDX-License-Identifier: Apache-2.0
// A document read as the site of a scan: regions, zones, where flights begin; and edits of it. Only
// what the document states in metres of the world can be edited here: polygons of files, of another
// reference system or of degrees are drawn as the server answers them.
import { isObject } from "./document";
import type { Edit } from "./edits";
import { entries } from "./film";
import { cornersOf, flatCorners } from "./shapes";
import { show } from "./units";
import type { Estimate, JsonObject, Patch, ScanWorld, SitePrism, Vec3 } from "./types";
import { vec } from "./vector";

// Lists of polygons, by the kind of their items.
export const siteLists = { region: "regions", closed: "no_fly_zones", zone: "flight_zones" } as const;
export type PolygonKind = keyof typeof siteLists;
export const polygonNames: Record<PolygonKind, string> =
  { region: "region", closed: "no-fly zone", zone: "flight zone" };

// Ends of a polygon's heights, as the list names them.
export const levelsOf = (kind: PolygonKind): [string, string] =>
  kind === "region" ? ["from", "to"] : ["floor", "ceiling"];

// The single places of a site, and where the document has them.
export const placePaths = ["start", "home.position"] as const;
export const placeNames = ["start", "home"] as const;

// A world that is explored from a start.
export const isExplored = (document: JsonObject): boolean =>
  typeof document.lookahead === "number" && vec(document.start) !== null;

export const isSite = (document: JsonObject): boolean => Array.isArray(document.regions);

export function placeOf(document: JsonObject, index: number): Vec3 | null {
  if (index === 0) return vec(document.start);
  return isObject(document.home) ? vec(document.home.position) : null;
}

// The two ends of the box `region`, where the document states it.
export function boxOf(document: JsonObject): { lower: Vec3; upper: Vec3 } | null {
  if (!isObject(document.region)) return null;
  const lower = vec(document.region.lower), upper = vec(document.region.upper);
  return lower && upper ? { lower, upper } : null;
}

// ---- single views --------------------------------------------------------------------------------

// Lists of what is wanted of single views.
export const wishLists = { pinned: "pinned", forbidden: "forbidden" } as const;
export type WishKind = keyof typeof wishLists;
export const wishNames: Record<WishKind, string> =
  { pinned: "pinned view", forbidden: "place without views" };

type View = ScanWorld["views"][number];
const SAME = 2e-3;      // m, and degrees

const degrees = (radians: number): number => {
  const turn = Math.round((radians * 180_000) / Math.PI) / 1000;
  return turn > 180 ? turn - 360 : turn;
};

// Between -180 and 180.
const turned = (angle: number): number => angle - 360 * Math.round(angle / 360);

const WITHIN = 1;      // m, of a ball without views

// The wish that a view is pinned by, or -1.
export function pinOf(document: JsonObject, view: View): number {
  return entries(document, "pinned").findIndex((entry) => {
    const place = vec(entry.position);
    return place !== null && Math.hypot(...place.map((v, i) => v - (view.position[i] as number))) < SAME &&
      Math.abs(turned(Number(entry.yaw_deg) - degrees(view.yaw))) < SAME &&
      Math.abs(Number(entry.pitch_deg) - degrees(view.pitch)) < SAME;
  });
}

// A view as the plan has it becomes a wish, or is one no more.
export function pinnedView(document: JsonObject, view: View): Edit {
  const list = entries(document, "pinned"), had = pinOf(document, view);
  if (had >= 0) {
    return { label: "Let the view go",
             patch: [{ path: "pinned", value: list.filter((_, i) => i !== had) }] };
  }
  return { label: "Pin the view", patch: [{ path: "pinned", value: [...list, {
    position: view.position.map((v) => Math.round(v * ROUND) / ROUND),
    yaw_deg: degrees(view.yaw), pitch_deg: degrees(view.pitch) }] }] };
}

// No view is taken within a metre of it any more; pins there would contradict.
export function forbiddenView(document: JsonObject, view: View): Edit {
  const pinned = entries(document, "pinned");
  const left = pinned.filter((entry) => {
    const place = vec(entry.position);
    return !place || Math.hypot(...place.map((v, i) => v - (view.position[i] as number))) > WITHIN;
  });
  const patch: Patch = [{ path: "forbidden", value: [...entries(document, "forbidden"), {
    position: view.position.map((v) => Math.round(v * ROUND) / ROUND), within: WITHIN }] }];
  if (left.length < pinned.length) patch.push({ path: "pinned", value: left });
  return { label: "Take no view there", patch };
}

// The views of a tour in their order, and the one that was taken last at a time.
export function viewsOf(scan: ScanWorld | undefined, tour?: number): View[] {
  return (scan?.views ?? []).filter((view) => (view.tour ?? 0) === (tour ?? 0));
}

export function viewAtTime(views: View[], time: number): number {
  let at = 0;
  views.forEach((view, k) => { if (view.time <= time + 0.05) at = k; });
  return views.length > 0 ? at : -1;
}

export function estimateInWords(
  { tours = 0, images = 0, seconds = 0, known = 0, seen = 0, why = "", changed = false }: Estimate,
): string {
  if (tours === 0 && why) return `No estimate: ${why}`;
  if (tours === 0) return "Let go to plan it: there are no views of this state to estimate with.";
  const share = known > 0 ? `${show((100 * seen) / known)} % of the known surface` : "";
  return `${changed ? "Roughly" : "About"} ${images} images in ${show(seconds / 60)} min${
    tours > 1 ? ` of ${tours} tours` : ""}${share ? `, ${share}` : ""}`;
}

// As a prism of the world, with open ends left out; null where the page cannot know its corners.
export function prismOf(document: JsonObject, kind: PolygonKind, index: number): JsonObject | null {
  const entry = entries(document, siteLists[kind])[index];
  if (!entry) return null;
  const [low, high] = levelsOf(kind);
  // Options without a value are not there, or empty.
  const stated = !entry.file && cornersOf(entry.corners_deg).length === 0 && !document.coordinates;
  const prism: JsonObject = { ...entry, type: "prism" };
  if (!stated) delete prism.corners;
  if (kind === "region") {
    if (typeof entry[low] === "number") prism.floor = entry[low];
    if (typeof entry[high] === "number") prism.ceiling = entry[high];
  }
  return prism;
}

const HALF = 10;        // m, of a new polygon around its middle
const ROUND = 1000;     // millimetres

const square = ([x, y]: Vec3, half = HALF): [number, number][] =>
  [[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]];

// A rectangle between two points on the ground.
export const rectangle = (a: Vec3, b: Vec3): [number, number][] => {
  const west = Math.min(a[0], b[0]), east = Math.max(a[0], b[0]);
  const south = Math.min(a[1], b[1]), north = Math.max(a[1], b[1]);
  return [[west, south], [east, south], [east, north], [west, north]];
};

function freeName(list: JsonObject[], word: string): string {
  for (let n = list.length + 1; ; ++n) {
    if (!list.some((entry) => entry.name === `${word} ${n}`)) return `${word} ${n}`;
  }
}

// What the mission looks at now, for the heights of a new region.
function heightsOf(scan: ScanWorld | undefined): [number, number] {
  const prisms = scan?.region ?? [];
  if (prisms.length === 0) return [0, HALF];
  const level = (v: number): number => Math.round(v * ROUND) / ROUND;
  return [level(Math.min(...prisms.map((p) => p.low))), level(Math.max(...prisms.map((p) => p.high)))];
}

// A polygon with these corners, or a square around a place. The first region takes the place of the
// box; a flight zone encloses everything that is known of the site.
export function addedPolygon(
  document: JsonObject, kind: PolygonKind, at: Vec3 | [number, number][], scan?: ScanWorld,
): Edit & { index: number } {
  const name = siteLists[kind];
  const list = entries(document, name);
  const corners = Array.isArray(at[0]) ? (at as [number, number][]) : square(at as Vec3);
  const made: JsonObject = { name: freeName(list, polygonNames[kind]), corners: flatCorners(corners) };
  const patch: Patch = [];
  if (kind === "region") {
    const [from, to] = heightsOf(scan);
    Object.assign(made, { from, to });
    if (list.length === 0 && isObject(document.region) && Object.keys(document.region).length > 0) {
      patch.push({ path: "region", value: {} });
    }
  }
  patch.push({ path: name, value: [...list, made] });
  return { label: `Add ${String(made.name)}`, patch, index: list.length };
}

// A rectangle far enough around everything that is flown and seen, for a new flight zone.
export function aroundSite(scan: ScanWorld | undefined, path: Vec3[]): [number, number][] {
  const places = [...path, ...(scan?.region ?? []).flatMap((prism) =>
    prism.corners.map(([x, y]): Vec3 => [x, y, 0]))];
  if (places.length === 0) return square([0, 0, 0], 5 * HALF);
  const end = (axis: 0 | 1, sign: 1 | -1): number =>
    sign * Math.ceil(places.reduce((most, p) => Math.max(most, sign * p[axis]), -Infinity) + HALF);
  return rectangle([end(0, -1), end(1, -1), 0], [end(0, 1), end(1, 1), 0]);
}

// ---- drawing -----------------------------------------------------------------------------------

const ring = (corners: [number, number][], z: number): Vec3[] => {
  const places = corners.map(([x, y]): Vec3 => [x, y, z]);
  return places[0] ? [...places, places[0]] : [];
};

// Edges of a prism with its holes.
export function prismLines(prism: SitePrism): Vec3[][] {
  return [prism.corners, ...prism.holes].flatMap((polygon) => [
    ring(polygon, prism.low), ring(polygon, prism.high),
    ...polygon.map(([x, y]): Vec3[] => [[x, y, prism.low], [x, y, prism.high]])]);
}

// Regions as the document states them, where it does, else as the mission has found them.
export function regionsOf(document: JsonObject, scan: ScanWorld | undefined): SitePrism[] {
  const known = scan?.region ?? [];
  const box = boxOf(document);
  const list = entries(document, "regions");
  if (list.length === 0 && box) {
    return [{ name: "", corners: rectangle(box.lower, box.upper), holes: [], low: box.lower[2],
              high: box.upper[2], weight: 1 }];
  }
  if (list.length === 0) return known;
  // Of a file an entry may have several; then what the mission found is drawn whole.
  const stated = list.map((entry, index): SitePrism | null => {
    const prism = prismOf(document, "region", index);
    const corners = cornersOf(prism?.corners);
    const [low, high] = [prism?.floor, prism?.ceiling];
    const [lowest, highest] = heightsOf(scan);
    return corners.length < 3 ? null : {
      name: typeof entry.name === "string" ? entry.name : "", corners,
      holes: entries(entry, "holes").map((hole) => cornersOf(hole.corners)),
      low: typeof low === "number" ? low : lowest, high: typeof high === "number" ? high : highest,
      weight: typeof entry.weight === "number" ? entry.weight : 1 };
  });
  return stated.every((prism) => prism !== null) ? stated as SitePrism[] : known;
}

// The four corners of what a view has in its image, `deep` metres away, with its edges.
export function frustum(
  position: Vec3, yaw: number, pitch: number, [width, height, fx, fy, cx, cy]: number[], deep: number,
): Vec3[][] {
  const forward: Vec3 = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch),
                         Math.sin(pitch)];
  const right: Vec3 = [Math.sin(yaw), -Math.cos(yaw), 0];
  const down: Vec3 = [Math.cos(yaw) * Math.sin(pitch), Math.sin(yaw) * Math.sin(pitch),
                      -Math.cos(pitch)];
  const n = (v: number | undefined): number => v ?? 1;
  const corner = (u: number, v: number): Vec3 => {
    const a = (u - n(cx)) / n(fx), b = (v - n(cy)) / n(fy);
    return [0, 1, 2].map((k) => (position[k] as number) + deep * ((forward[k] as number) +
      a * (right[k] as number) + b * (down[k] as number))) as Vec3;
  };
  const w = n(width) - 0.5, h = n(height) - 0.5;
  const corners = [corner(-0.5, -0.5), corner(w, -0.5), corner(w, h), corner(-0.5, h)];
  return [[...corners, corners[0] as Vec3], ...corners.map((c): Vec3[] => [position, c])];
}
