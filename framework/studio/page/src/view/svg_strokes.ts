// SPDX-License-Identifier: Apache-2.0
// The lines of an SVG file that was dropped on the page, as strokes. The browser follows its paths.
import type { Point } from "../state/painting";

const SVG = "http://www.w3.org/2000/svg";
const shapes = new Set(["path", "line", "polyline", "polygon", "rect", "circle", "ellipse"]);
const attributes = ["d", "points", "x", "y", "x1", "y1", "x2", "y2", "width", "height", "r", "rx", "ry",
                    "cx", "cy", "transform"];
const STEPS = 400;        // along a shape
const JUMP = 1.5;         // of a step: further than this, the pen was lifted
const MOST = 400;         // shapes

// Shapes and groups alone, with what places them: nothing else of the file comes into the page.
function cleaned(element: Element, count: { shapes: number }): SVGElement | null {
  const name = element.localName;
  const group = name === "g" || name === "svg";
  if (!group && !shapes.has(name)) return null;
  if (!group && ++count.shapes > MOST) throw new Error(`more than ${MOST} shapes`);
  const made = document.createElementNS(SVG, name === "svg" ? "g" : name);
  for (const key of attributes) {
    const value = element.getAttribute(key);
    if (value !== null && !(name === "svg" && key !== "transform")) made.setAttribute(key, value);
  }
  for (const child of element.children) {
    const inner = cleaned(child, count);
    if (inner) made.append(inner);
  }
  return made;
}

// x to the right and y up, in units of the file. Error where there is nothing to draw.
export function strokesOfSvg(text: string): Point[][] {
  const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
  if (parsed.querySelector("parsererror") || parsed.documentElement.localName !== "svg") {
    throw new Error("no SVG picture");
  }
  const holder = document.createElementNS(SVG, "svg");
  holder.setAttribute("width", "1");
  holder.setAttribute("height", "1");
  holder.setAttribute("class", "measured");
  const root = cleaned(parsed.documentElement, { shapes: 0 });
  if (root) holder.append(root);
  document.body.append(holder);
  try {
    const strokes: Point[][] = [];
    for (const shape of holder.querySelectorAll([...shapes].join(","))) {
      const line = shape as SVGGeometryElement;
      let length = 0;
      try {
        length = line.getTotalLength();
      } catch {   // without a size
        continue;
      }
      const placed = line.getCTM();
      if (!(length > 0) || !placed) continue;
      const step = length / STEPS;
      let run: Point[] = [], before: DOMPoint | null = null;
      for (let i = 0; i <= STEPS; ++i) {
        const at = line.getPointAtLength(i * step);
        if (before && Math.hypot(at.x - before.x, at.y - before.y) > JUMP * step) {
          if (run.length > 1) strokes.push(run);
          run = [];
        }
        before = at as DOMPoint;
        const p = at.matrixTransform(placed);
        run.push([p.x, -p.y]);
      }
      if (run.length > 1) strokes.push(run);
    }
    if (strokes.length === 0) throw new Error("there is no line in it");
    return strokes;
  } finally {
    holder.remove();
  }
}
