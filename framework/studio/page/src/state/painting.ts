// SPDX-License-Identifier: Apache-2.0
// A light painting as a document: the plane of the drawing, its strokes in the world, and edits of
// them. Strokes in the document are fitted to `height` and `base` (scripts/mission/drawings.lua);
// those that are drawn here keep their size, so `height` and `base` follow them.
import { isObject } from "./document";
import type { Edit } from "./edits";
import type { Certificate, Json, JsonObject, Plan, Vec3 } from "./types";
import { show } from "./units";
import { add, rounded, vec } from "./vector";

export type Point = [number, number];   // m, to the right and up, of who looks at the drawing

export interface DrawingPlane {
  base: Vec3;
  right: Vec3;
  normal: Vec3;
}

const LEAST = 0.02;    // m between the points of a stroke
const SLACK = 0.005;   // m that a kept point may be from the drawn line

export const isPainting = (document: JsonObject): boolean => Array.isArray(document.strokes) &&
  typeof document.view_yaw_deg === "number";

export function planeOf(document: JsonObject): DrawingPlane | null {
  const base = vec(document.base), yaw = document.view_yaw_deg;
  if (!base || typeof yaw !== "number") return null;
  const a = (yaw * Math.PI) / 180;
  return { base, right: [Math.sin(a), -Math.cos(a), 0], normal: [Math.cos(a), Math.sin(a), 0] };
}

export function onPlane(plane: DrawingPlane, p: Vec3): Point {
  const d = [p[0] - plane.base[0], p[1] - plane.base[1], p[2] - plane.base[2]];
  return [d[0]! * plane.right[0] + d[1]! * plane.right[1], d[2]!];
}

export function inWorld(plane: DrawingPlane, [u, up]: Point): Vec3 {
  return add(plane.base, [u * plane.right[0], u * plane.right[1], up]);
}

function pointsOf(stroke: Json): Point[] {
  const flat = isObject(stroke) && Array.isArray(stroke.points) ? stroke.points : [];
  const points: Point[] = [];
  for (let i = 0; i + 1 < flat.length; i += 2) {
    points.push([Number(flat[i]), Number(flat[i + 1])]);
  }
  return points;
}

interface Box { left: number; right: number; low: number; high: number }

function boxOf(strokes: Point[][]): Box {
  const box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
  for (const [x, y] of strokes.flat()) {
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.low = Math.min(box.low, y);
    box.high = Math.max(box.high, y);
  }
  return box;
}

// What `height` is the height of: the drawing, or the width of a level line.
const extent = ({ left, right, low, high }: Box): number =>
  high - low > 1e-6 * (right - left) ? high - low : right - left;

// The strokes of the document where they will be drawn, m on its plane.
export function drawnStrokes(document: JsonObject): Point[][] {
  const strokes = (Array.isArray(document.strokes) ? document.strokes : []).map(pointsOf)
    .filter((points) => points.length > 1);
  if (strokes.length === 0) return [];
  const box = boxOf(strokes);
  const scale = Number(document.height) / extent(box);
  return strokes.map((points) => points.map(([x, y]): Point =>
    [scale * (x - (box.left + box.right) / 2), scale * (y - box.low)]));
}

// Fewer points within SLACK of the line (Douglas and Peucker).
export function simplified(points: Point[]): Point[] {
  const [first, last] = [points[0], points[points.length - 1]];
  if (!first || !last || points.length < 3) return points;
  const dx = last[0] - first[0], dy = last[1] - first[1], size = Math.hypot(dx, dy);
  let worst = 0, at = 0;
  for (let i = 1; i + 1 < points.length; ++i) {
    const [x, y] = points[i] as Point;
    const d = size > 1e-9 ? Math.abs(dx * (y - first[1]) - dy * (x - first[0])) / size
      : Math.hypot(x - first[0], y - first[1]);
    if (d > worst) {
      worst = d;
      at = i;
    }
  }
  if (worst <= SLACK) return [first, last];
  return [...simplified(points.slice(0, at + 1)).slice(0, -1), ...simplified(points.slice(at))];
}

export function without(stroke: Point[]): Point[] {
  return stroke.filter((p, i) => {
    const before = stroke[i - 1];
    return !before || i === stroke.length - 1 || Math.hypot(p[0] - before[0], p[1] - before[1]) > LEAST;
  });
}

// All strokes at their places, and nothing else that is drawn.
function withStrokes(document: JsonObject, label: string, strokes: Point[][]): Edit | null {
  const plane = planeOf(document);
  if (!plane || strokes.length === 0) return null;
  const box = boxOf(strokes);
  const middle: Point = [(box.left + box.right) / 2, box.low];
  const patch: Edit["patch"] = [
    { path: "strokes", value: strokes.map((points) => ({
      points: points.flatMap(([x, y]) => rounded([x - box.left, y - box.low, 0]).slice(0, 2)) })) },
    { path: "height", value: rounded([extent(box), 0, 0])[0] as number },
    { path: "base", value: rounded(inWorld(plane, middle)) },
  ];
  for (const other of ["text", "svg", "input"]) {
    if (typeof document[other] === "string" && document[other] !== "") {
      patch.push({ path: other, value: "" });
    }
  }
  return { label, patch };
}

// A stroke more, from places in the world. In place of a text or a picture.
export function addedStroke(document: JsonObject, drawn: Vec3[]): Edit | null {
  const plane = planeOf(document);
  if (!plane) return null;
  const stroke = simplified(without(drawn.map((p) => onPlane(plane, p))));
  if (stroke.length < 2 || extent(boxOf([stroke])) < LEAST) return null;
  return withStrokes(document, "Draw a stroke", [...drawnStrokes(document), stroke]);
}

// The lines of a picture (y up, in its units), as high as the drawing was and where it stood; in
// place of what was drawn.
export function addedStrokes(document: JsonObject, label: string, lines: Point[][]): Edit | null {
  const plane = planeOf(document);
  const box = boxOf(lines);
  const size = extent(box);
  if (!plane || !(size > 0)) return null;
  const scale = Number(document.height) / size;
  const strokes = lines.map((points) => simplified(without(points.map(([x, y]): Point =>
    [scale * (x - (box.left + box.right) / 2), scale * (y - box.low)]))))
    .filter((points) => points.length > 1);
  return withStrokes(document, label, strokes);
}

export function withoutStroke(document: JsonObject, index: number): Edit | null {
  return withStrokes(document, `Delete stroke ${index + 1}`,
                     drawnStrokes(document).filter((_, i) => i !== index));
}

export function reversedStroke(document: JsonObject, index: number): Edit | null {
  return withStrokes(document, `Turn stroke ${index + 1} round`, drawnStrokes(document)
    .map((points, i) => i === index ? [...points].reverse() : points));
}

export function earlierStroke(document: JsonObject, index: number): Edit | null {
  const strokes = drawnStrokes(document);
  const here = strokes[index], before = strokes[index - 1];
  if (!here || !before) return null;
  strokes[index - 1] = here;
  strokes[index] = before;
  return withStrokes(document, `Stroke ${index + 1} earlier`, strokes);
}

// What is lit up to a time, as runs of the path.
export function litRuns(plan: Plan, until: number): Vec3[][] {
  const { columns } = plan;
  return (plan.lights ?? []).flatMap(({ start, finish }) => {
    const run: Vec3[] = [];
    columns.time.forEach((t, i) => {
      if (t < start - 1e-9 || t > Math.min(finish, until) + 1e-9) return;
      run.push([columns.x?.[i] ?? 0, columns.y?.[i] ?? 0, columns.z?.[i] ?? 0]);
    });
    return run.length > 1 ? [run] : [];
  });
}

// The spans of a plan with light and those between them, in the order of flight.
export function lightsAndGaps(plan: Plan | null): { start: number; finish: number; lit: boolean }[] {
  const lights = plan?.lights ?? [];
  return lights.flatMap((light, k) => {
    const next = lights[k + 1];
    return [{ ...light, lit: true },
            ...(next ? [{ start: light.finish, finish: next.start, lit: false }] : [])];
  });
}

// As the verifier found it: of the plan, and of its simulated flight.
export function drawingErrorInWords(certificate: Certificate | null): string {
  const check = (name: string): number | null =>
    certificate?.checks.find((one) => one.name === name)?.worst ?? null;
  const planned = check("drawing"), flown = check("drawing_flown");
  const limit = certificate?.checks.find((one) => one.name === "drawing")?.limit ?? null;
  if (planned === null) return "";
  const mm = (metres: number): string => `${show(1000 * metres)} mm`;
  return `The light is ${mm(planned)} from the strokes on average as planned${
    flown === null ? "" : `, ${mm(flown)} as flown`}${limit === null ? "" : `; at most ${mm(limit)}`}.`;
}
