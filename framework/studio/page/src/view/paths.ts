// SPDX-License-Identifier: Apache-2.0
// The curves of the world: the path in the look of its grade, the last answer beneath a guess,
// failing passages, the flown ghost; and the drone with its camera at the play head.
import * as THREE from "three";
import { colourOf } from "../state/prediction";
import { pathOf, positionAt, rangeOf, speedsOf, viewAt } from "../state/samples";
import { show } from "../state/units";
import type { Grade } from "../state/grades";
import type { Columns, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { byId } from "./dom";
import { Ribbon } from "./ribbon";
import { segments } from "./ground";
import type { Stage } from "./stage";

const shapes: Record<Exclude<Grade, "refused">, Ribbon> = {
  guess: new Ribbon("dashed", 5), step: new Ribbon("thin", 4), converged: new Ribbon("rails", 4),
  certified: new Ribbon("solid", 4), rejected: new Ribbon("rails", 4),
};

const ROUNDING = 1e-9;   // of the highest speed: a vehicle at rest has as much

const placesIn = (way: number[]): Vec3[] =>
  Array.from({ length: Math.floor(way.length / 3) }, (_, k) =>
    [way[3 * k], way[3 * k + 1], way[3 * k + 2]] as Vec3);

export class Paths {
  private readonly failing = new Ribbon("hatched", 6);
  private readonly ghost = new Ribbon("dotted", 3);
  private readonly kept = new Ribbon("dashdot", 3);
  private readonly ways = new Ribbon("thin", 1);     // of many flights
  private readonly stems = segments([]);
  private readonly frame = segments([]);
  private readonly ghostMark = new THREE.Mesh(
    new THREE.SphereGeometry(0.35, 12, 8), new THREE.MeshBasicMaterial());
  private readonly drone = new THREE.Mesh(
    new THREE.SphereGeometry(0.3, 12, 8), new THREE.MeshBasicMaterial());

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    for (const ribbon of this.all()) stage.tools.add(ribbon.mesh);
    stage.tools.add(this.stems, this.frame, this.drone, this.ghostMark);
    stage.onResize((width, height) => {
      for (const ribbon of this.all()) ribbon.resize(width, height);
    });
    studio.on(["document", "standing"], () => this.draw());
    studio.on(["flown"], () => this.drawGhost());
    studio.on(["kept"], () => this.drawKept());
    studio.on(["time"], () => this.drawMarker());
    studio.on(["look"], () => {
      this.paint();
      this.drawGhost();
      this.drawKept();
    });
    this.paint();
  }

  private all(): Ribbon[] {
    return [...Object.values(shapes), this.failing, this.ghost, this.kept, this.ways];
  }

  paint(): void {
    const { palette } = this.stage;
    shapes.guess.paint(palette.guess);
    shapes.step.paint(palette.step);
    shapes.converged.paint(palette.converged);
    shapes.certified.paint(palette.certified);
    shapes.rejected.paint(palette.converged);
    this.failing.paint(palette.fail);
    this.ghost.paint(palette.flown);
    this.kept.paint(palette.ink);
    this.ways.paint(palette.flown, 0.35);
    this.stems.material.color.set(palette.step);
    this.frame.material.color.set(palette.ink);
    this.drone.material.color.set(palette.ink);
    this.ghostMark.material.color.set(palette.flown);
    this.draw();
  }

  private draw(): void {
    const { grade, plan } = this.studio.standing;
    for (const ribbon of Object.values(shapes)) ribbon.hide();
    if (plan && grade !== "refused" && grade !== "guess") {
      shapes[grade].set(pathOf(plan.columns), 1, this.shades(plan.columns));
    } else {
      byId("speed-legend").hidden = true;   // a sketch has no speeds to rely on
      const old = this.studio.session.grades.lastPlan();
      if (old && this.studio.session.dragging) shapes.step.set(pathOf(old.columns), 1);
      const guess = pathOf(this.studio.guess.columns);
      shapes.guess.set(guess, dashOf(guess));
    }
    this.failing.setRuns(plan ? this.studio.passages.map((passage) =>
      partOf(plan.columns, passage.start, passage.finish)) : [], 0.8);
    this.drawStems();
    this.drawMarker();
  }

  // Of each sample, by its speed; the pattern still tells the grade. Shows what the colours mean.
  private shades(columns: Columns): number[][] | undefined {
    const speeds = this.studio.speeds ? speedsOf(columns) : null;
    byId("speed-legend").hidden = !speeds;
    if (!speeds) return undefined;
    const [least, most] = rangeOf(speeds);
    const rests = least < ROUNDING * most;
    byId("speed-scale").textContent = `${show(rests ? 0 : least, 3)} to ${show(most, 3)} m/s`;
    return speeds.map((speed) => colourOf(most > least ? (speed - least) / (most - least) : 0));
  }

  private drawGhost(): void {
    const flown = columnsOf(this.studio);
    if (flown) this.ghost.set(pathOf(flown), 1);
    else this.ghost.hide();
    this.ways.setRuns((this.studio.flown?.ways ?? []).map(placesIn), 1);
    this.drawMarker();
  }

  private drawKept(): void {
    const points = this.studio.kept ? pathOf(this.studio.kept.plan.columns) : [];
    if (points.length > 1) this.kept.set(points, dashOf(points));
    else this.kept.hide();
    document.body.classList.toggle("comparing", points.length > 1);
    this.stage.invalidate();
  }

  private drawStems(): void {
    const points = this.studio.film.keyframes.flatMap(({ position: [x, y, z] }) =>
      [x, y, z, x, y, 0, x - 0.4, y, 0.01, x + 0.4, y, 0.01, x, y - 0.4, 0.01, x, y + 0.4, 0.01]);
    replace(this.stems, points);
  }

  // Of the drone and its view, fit for the film.
  private get size(): number {
    const { columns } = this.studio.plan;
    const extent = ["x", "y", "z"].map((axis) => {
      const list = columns[axis] ?? [];
      return list.length > 0 ? Math.max(...list) - Math.min(...list) : 0;
    });
    return Math.min(6, Math.max(0.5, 0.075 * Math.hypot(...extent)));
  }

  private drawMarker(): void {
    const { studio, stage } = this;
    const { columns } = studio.plan;
    this.drone.scale.setScalar(this.size / 3);
    this.ghostMark.scale.setScalar(this.size / 3);
    const view = viewAt(columns, studio.time);
    this.frame.visible = this.drone.visible = view !== null && studio.mode !== "camera";
    const ghost = columnsOf(studio);
    const flownAt = ghost ? positionAt(ghost, studio.time) : null;
    this.ghostMark.visible = flownAt !== null;
    if (flownAt) this.ghostMark.position.set(...flownAt);
    if (view) {
      this.drone.position.set(...view.position);
      const optics = studio.plan.camera;
      const across = optics ? optics.width / optics.fx / 2 : 1.08;
      const high = optics ? optics.height / optics.fy / 2 : 0.61;
      const depth = this.size;
      const corner = (sx: number, sy: number): Vec3 => [0, 1, 2].map((k) =>
        (view.position[k] as number) + depth * ((view.forward[k] as number) +
        sx * across * (view.right[k] as number) + sy * high * (view.down[k] as number))) as Vec3;
      const rim = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
      const points: number[] = [];
      rim.forEach((p, i) => {
        points.push(...view.position, ...p, ...p, ...(rim[(i + 1) % 4] as Vec3));
      });
      replace(this.frame, points);
    }
    stage.invalidate();
  }
}

export function columnsOf(studio: Studio): Columns | null {
  const samples = studio.flown?.samples;
  if (!samples) return null;
  const columns = ("columns" in samples ? samples.columns : samples) as Columns;
  return Array.isArray(columns?.time) ? columns : null;
}

// About sixty dashes, whatever the length.
function dashOf(points: Vec3[]): number {
  let way = 0;
  points.forEach((p, i) => {
    const before = points[i - 1];
    if (before) way += Math.hypot(p[0] - before[0], p[1] - before[1], p[2] - before[2]);
  });
  return Math.max(0.2, way / 60);
}

function partOf(columns: Columns, start: number, finish: number): Vec3[] {
  const inner = columns.time.filter((t) => t > start && t < finish);
  return [start, ...inner, finish].flatMap((time) => {
    const p = positionAt(columns, time);
    return p ? [p] : [];
  });
}

function replace(lines: THREE.LineSegments, points: number[]): void {
  const had = lines.geometry.getAttribute("position") as THREE.BufferAttribute | undefined;
  if (had && had.array.length === points.length) {
    (had.array as Float32Array).set(points);
    had.needsUpdate = true;
    return;
  }
  lines.geometry.dispose();
  lines.geometry = new THREE.BufferGeometry();
  lines.geometry.setAttribute("position",
                              new THREE.BufferAttribute(new Float32Array(points), 3));
}
