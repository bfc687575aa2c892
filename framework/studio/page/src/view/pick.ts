// SPDX-License-Identifier: Apache-2.0
// Clicks in the world: on the path, on an obstacle, on the ground, by the mode of the page.
import * as THREE from "three";
import { appended, inserted, lookedAt } from "../state/edits";
import { pathOf, positionAt } from "../state/samples";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Gizmo } from "./gizmo";
import type { Solids } from "./solids";
import type { Stage } from "./stage";

const NEAR = 9;          // px from the path
const STILL = 4;         // px that a click may move
const HEIGHT = 3;        // m above the ground, of a first keyframe
const FARTHEST = 1500;   // m

export class Pick {
  constructor(
    private readonly studio: Studio, private readonly stage: Stage,
    private readonly solids: Solids, gizmo: Gizmo,
  ) {
    let down: PointerEvent | null = null;
    stage.world.addEventListener("pointerdown", (event) => {
      down = event.button === 0 && !gizmo.busy ? event : null;
    });
    stage.world.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > STILL) {
        return;
      }
      down = null;
      this.click(event);
    });
    stage.world.addEventListener("dblclick", (event) => {
      const time = this.pathTime(event);
      const at = time === null ? null : positionAt(studio.plan.columns, time);
      if (time === null || !at || studio.mode !== "orbit") return;
      const made = inserted(studio.document, time, at);
      if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
    });
  }

  private click(event: PointerEvent): void {
    const { studio } = this;
    if (studio.mode === "camera") return;
    if (studio.mode === "place") return this.place(event);
    if (studio.mode === "aim") return this.aim(event);
    const time = this.pathTime(event);
    if (time !== null) return studio.seek(time);
    const solid = this.solidAt(event);
    studio.select(solid ? { kind: "obstacle", index: solid.index } : null);
  }

  private place(event: PointerEvent): void {
    const { studio } = this;
    const hit = this.surfaceAt(event);
    if (!hit) return;
    const last = studio.film.keyframes[studio.film.keyframes.length - 1];
    const at: Vec3 = [hit[0], hit[1], last ? last.position[2] : HEIGHT];
    if (hit[2] > at[2] - 1) at[2] = hit[2] + HEIGHT;
    const made = appended(studio.document, at);
    if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
  }

  private aim(event: PointerEvent): void {
    const { studio } = this;
    const hit = this.surfaceAt(event);
    const { selection } = studio;
    if (!hit || selection?.kind !== "keyframe") return;
    studio.setMode("orbit");
    studio.edit(lookedAt(studio.document, selection.index, hit));
  }

  // The time of the path under the pointer, or null.
  private pathTime(event: MouseEvent): number | null {
    const { columns } = this.studio.plan;
    const rect = this.stage.world.getBoundingClientRect();
    const x = event.clientX - rect.left, y = event.clientY - rect.top;
    let best = NEAR, found: number | null = null;
    let before: { x: number; y: number } | null = null;
    pathOf(columns).forEach((point, i) => {
      const here = this.stage.onScreen(point);
      if (here && before) {
        const dx = here.x - before.x, dy = here.y - before.y;
        const size = dx * dx + dy * dy;
        const share = size > 0
          ? Math.min(1, Math.max(0, ((x - before.x) * dx + (y - before.y) * dy) / size)) : 0;
        const d = Math.hypot(before.x + share * dx - x, before.y + share * dy - y);
        if (d < best) {
          best = d;
          const from = columns.time[i - 1] as number, to = columns.time[i] as number;
          found = from + share * (to - from);
        }
      }
      before = here;
    });
    return found;
  }

  private solidAt(event: MouseEvent): { index: number; point: Vec3 } | null {
    if (!this.solids.opaque.visible) return null;
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    const hits = new THREE.Raycaster(ray.origin, ray.direction).intersectObject(this.solids.opaque);
    const hit = hits[0];
    if (!hit) return null;
    const index = this.solids.obstacleOf(hit.faceIndex ?? 0);
    return index < 0 ? null : { index, point: [hit.point.x, hit.point.y, hit.point.z] };
  }

  // What is seen there: an obstacle, else the ground.
  surfaceAt(event: { clientX: number; clientY: number }): Vec3 | null {
    const solid = this.solidAt(event as MouseEvent);
    if (solid) return solid.point;
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    const hit = ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), 0),
                                   new THREE.Vector3());
    return hit && hit.distanceTo(ray.origin) < FARTHEST ? [hit.x, hit.y, 0] : null;
  }
}
