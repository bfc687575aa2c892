// SPDX-License-Identifier: Apache-2.0
// The gates of a race: the opening, of a tunnel both ends and its edges, of a ball three circles,
// and an arrow in the direction of flight.
import type { CourseGate } from "../state/course";
import type { Vec3 } from "../state/types";
import { add, cross, times } from "../state/vector";
import type { Studio } from "../studio";
import { Ribbon } from "./ribbon";
import type { Stage } from "./stage";

const ARROW = 0.9;            // m
const CIRCLE = 24;            // sides

export class Gates {
  private readonly rims = new Ribbon("thin", 3);

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    stage.tools.add(this.rims.mesh);
    stage.onResize((width, height) => this.rims.resize(width, height));
    studio.on(["document"], () => this.draw());
    studio.on(["look"], () => this.paint());
    this.paint();
  }

  private paint(): void {
    this.rims.paint(this.stage.palette.ink);
    this.stage.invalidate();
  }

  private draw(): void {
    this.rims.setRuns((this.studio.course?.gates ?? []).flatMap(gateLines), 1);
    this.stage.invalidate();
  }
}

function gateLines({ position: p, direction, up, corners, radius, tunnel }: CourseGate): Vec3[][] {
  if (!direction) {
    const axes: [Vec3, Vec3][] = [[[1, 0, 0], [0, 1, 0]], [[1, 0, 0], [0, 0, 1]],
                                  [[0, 1, 0], [0, 0, 1]]];
    const circle = Array.from({ length: CIRCLE }, (_, i): [number, number] =>
      [radius * Math.cos((2 * Math.PI * i) / CIRCLE), radius * Math.sin((2 * Math.PI * i) / CIRCLE)]);
    return axes.map(([a, b]) => rim(p, circle, a, b));
  }
  const left = cross(up, direction);
  const at = (by: number): Vec3 => add(p, times(direction, by));
  const half = Math.max(0, tunnel) / 2;
  const tip = at(half + ARROW);
  const barb = (side: number): Vec3 => add(at(half + 0.6 * ARROW), times(left, side));
  const lines: Vec3[][] = [[at(-half), tip], [barb(-0.2), tip, barb(0.2)]];
  if (half === 0) return [rim(p, corners, left, up), ...lines];
  for (const [a, b] of corners) {
    const edge = add(times(left, a), times(up, b));
    lines.push([add(at(-half), edge), add(at(half), edge)]);
  }
  return [rim(at(-half), corners, left, up), rim(at(half), corners, left, up), ...lines];
}

// Closed; corners are along two axes from the middle.
function rim(middle: Vec3, corners: [number, number][], a: Vec3, b: Vec3): Vec3[] {
  const places = corners.map(([x, y]) => add(middle, add(times(a, x), times(b, y))));
  return places[0] ? [...places, places[0]] : [];
}
