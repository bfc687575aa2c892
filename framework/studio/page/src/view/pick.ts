// SPDX-License-Identifier: Apache-2.0
// Clicks in the world: on the path, on an obstacle, on the ground, by the mode of the page.
import * as THREE from "three";
import { appended, inserted, lookedAt, moved, placeOfItem, type Item } from "../state/edits";
import { entries } from "../state/film";
import { addedPolygon, isExplored, rectangle } from "../state/site";
import { withStroke } from "../state/shots";
import { pathOf, positionAt } from "../state/samples";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Gizmo } from "./gizmo";
import type { Solids } from "./solids";
import { level, meeting, type Stage } from "./stage";

const NEAR = 9;          // px from the path
const FAR = 120;         // px, of a drag along it
const STILL = 4;         // px that a click may move
const AHEAD = 20;        // m, where the sky is looked at
const HEIGHT = 3;        // m above the ground, of a first keyframe
const LEAST = 0.5;       // m, of the sides of a polygon that is drawn

export class Pick {
  private down: PointerEvent | null = null;

  constructor(
    private readonly studio: Studio, private readonly stage: Stage,
    private readonly solids: Solids, gizmo: Gizmo,
  ) {
    // Before the controls of the view see it: what begins on the path is not a turn.
    stage.world.addEventListener("pointerdown", (event) => {
      this.down = null;
      if (event.button !== 0 || gizmo.busy || event.target !== stage.world) return;
      this.down = event;
      if (studio.mode === "draw") return this.draw(event);
      if (studio.mode === "outline") return this.outline(event);
      const time = studio.mode === "orbit" && !this.isView(event) ? this.pathTime(event) : null;
      if (time !== null) this.alongPath(event, time);
    }, { capture: true });
    stage.world.addEventListener("pointerup", (event) => {
      const { down } = this;
      this.down = null;
      if (!down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > STILL) {
        return;
      }
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

  // A drag that begins on the path: the drone follows along it; with Shift it is pulled off it, by a
  // new keyframe at this time.
  private alongPath(event: PointerEvent, time: number): void {
    const { studio } = this;
    event.stopImmediatePropagation();
    this.down = null;
    studio.play(false);
    studio.seek(time);
    const base = studio.session.settled();
    const start = positionAt(studio.plan.columns, time);
    const pulls = event.shiftKey && start !== null && studio.editable;
    let pulled: ReturnType<typeof inserted> | null = null;
    this.follow(event, (e) => {
      if (!pulls || !start) {
        const next = this.pathTime(e, FAR);
        if (next !== null) studio.seek(next);
        return;
      }
      const at = this.onLevel(e, start[2]);
      if (!at) return;
      pulled = inserted(base, time, at);
      studio.drag(pulled);
    }, (kept) => {
      if (!pulled) return;
      if (!kept) studio.session.rest();
      else if (studio.edit(pulled)) studio.select({ kind: "keyframe", index: pulled.index });
    });
  }

  // A stroke on the level of the last keyframe.
  private draw(event: PointerEvent): void {
    const { studio } = this;
    event.stopImmediatePropagation();
    this.down = null;
    const last = studio.film.keyframes[studio.film.keyframes.length - 1];
    const height = last ? last.position[2] : HEIGHT;
    const base = studio.session.settled();
    const stroke: Vec3[] = [];
    const step = (e: PointerEvent): void => {
      const at = this.onLevel(e, height);
      if (at) stroke.push(at);
      studio.drag(withStroke(base, stroke));
    };
    step(event);
    this.follow(event, step, (kept) => {
      const made = withStroke(base, stroke);
      studio.setMode("orbit");
      if (!kept || !made) studio.session.rest();
      else if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
    });
  }

  // A rectangle on the ground, from where the drag begins to where it ends.
  private outline(event: PointerEvent): void {
    const { studio } = this;
    event.stopImmediatePropagation();
    this.down = null;
    const level = studio.session.world.scan?.region[0]?.low ?? 0;
    const from = this.onLevel(event, level);
    if (!from) return;
    const base = studio.session.settled(), kind = studio.outlined;
    let made: ReturnType<typeof addedPolygon> | null = null;
    this.follow(event, (e) => {
      const to = this.onLevel(e, level);
      if (!to || Math.min(Math.abs(to[0] - from[0]), Math.abs(to[1] - from[1])) < LEAST) return;
      made = addedPolygon(base, kind, rectangle(from, to), studio.session.world.scan);
      studio.drag(made);
    }, (kept) => {
      studio.setMode("orbit");
      if (!kept || !made) studio.session.rest();
      else if (studio.edit(made)) studio.select({ kind, index: made.index });
    });
  }

  private follow(
    event: PointerEvent, move: (e: PointerEvent) => void, end: (kept: boolean) => void,
  ): void {
    const { world } = this.stage;
    world.setPointerCapture(event.pointerId);
    const done = (kept: boolean): void => {
      world.removeEventListener("pointermove", move);
      world.removeEventListener("pointerup", up);
      world.removeEventListener("pointercancel", cancel);
      window.removeEventListener("keydown", escape, true);
      end(kept);
    };
    const up = (): void => done(true);
    const cancel = (): void => done(false);
    const escape = (e: KeyboardEvent): void => {
      if (e.key !== "Escape") return;
      e.stopPropagation();
      done(false);
    };
    world.addEventListener("pointermove", move);
    world.addEventListener("pointerup", up);
    world.addEventListener("pointercancel", cancel);
    window.addEventListener("keydown", escape, true);
  }

  onLevel(event: { clientX: number; clientY: number }, height: number): Vec3 | null {
    const hit = meeting(this.stage.rayAt(event.clientX, event.clientY), level(height));
    return hit && [hit.x, hit.y, height];
  }

  // A click on nothing that can be selected.
  onNothing: (ray: THREE.Ray, at: { clientX: number; clientY: number }) => void = () => undefined;
  // Whether a view is there, which a click is about, not the path.
  isView: (at: { clientX: number; clientY: number }) => boolean = () => false;
  // A click of a race places a gate.
  onGate: ((at: Vec3) => void) | null = null;

  private click(event: { clientX: number; clientY: number }): void {
    const { studio } = this;
    if (studio.mode === "place") return this.place(event);
    if (studio.mode === "aim") return this.aim(event);
    if (studio.mode !== "orbit") return;
    const solid = this.solidAt(event);
    // Only what the document has can be selected.
    const listed = solid !== null && solid.index < entries(studio.document, "obstacles").length;
    studio.select(listed ? { kind: "obstacle", index: solid.index } : null);
    if (!listed) this.onNothing(this.stage.rayAt(event.clientX, event.clientY), event);
  }

  // The same without a mouse: the middle of the view is meant.
  clickMiddle(): void {
    const rect = this.stage.world.getBoundingClientRect();
    this.click({ clientX: rect.left + rect.width / 2, clientY: rect.top + rect.height / 2 });
  }

  private place(event: { clientX: number; clientY: number }): void {
    const { studio } = this;
    const hit = this.surfaceAt(event);
    if (!hit) return;
    if (studio.course) return this.onGate?.(hit);
    if (isExplored(studio.document)) {
      const start: Item = { kind: "place", index: 0 };
      const height = placeOfItem(studio.document, start)?.[2] ?? HEIGHT;
      studio.setMode("orbit");
      if (studio.edit(moved(studio.document, start, [hit[0], hit[1], Math.max(height, hit[2] + HEIGHT)]))) {
        studio.select(start);
      }
      return;
    }
    const last = studio.film.keyframes[studio.film.keyframes.length - 1];
    const at: Vec3 = [hit[0], hit[1], last ? last.position[2] : HEIGHT];
    if (hit[2] > at[2] - 1) at[2] = hit[2] + HEIGHT;
    const made = appended(studio.document, at);
    if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
  }

  private aim(event: { clientX: number; clientY: number }): void {
    const { studio } = this;
    const hit = this.surfaceAt(event);
    const { selection } = studio;
    if (!hit || selection?.kind !== "keyframe") return;
    studio.setMode("orbit");
    studio.edit(lookedAt(selection.index, hit));
    studio.select({ kind: "look", index: selection.index });
  }

  // The time of the path under the pointer, or null.
  private pathTime(event: MouseEvent, reach = NEAR): number | null {
    const { columns } = this.studio.plan;
    const rect = this.stage.world.getBoundingClientRect();
    const x = event.clientX - rect.left, y = event.clientY - rect.top;
    let best = reach, found: number | null = null;
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

  private solidAt(event: { clientX: number; clientY: number }): { index: number; point: Vec3 } | null {
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    return this.solids.hitBy(new THREE.Raycaster(ray.origin, ray.direction));
  }

  // The ground where one looks: below what is in the middle of the view, or ahead of an eye that
  // looks at the sky.
  lookedAtGround(): Vec3 {
    const rect = this.stage.world.getBoundingClientRect();
    const seen = this.surfaceAt({ clientX: rect.left + rect.width / 2,
                                  clientY: rect.top + rect.height / 2 });
    if (seen) return [seen[0], seen[1], 0];
    const { position } = this.stage.worldCamera;
    const ahead = this.stage.worldCamera.getWorldDirection(new THREE.Vector3()).setZ(0);
    const size = ahead.length() || 1;
    return [position.x + (AHEAD * ahead.x) / size, position.y + (AHEAD * ahead.y) / size, 0];
  }

  // What is seen there: an obstacle, else the ground.
  surfaceAt(event: { clientX: number; clientY: number }): Vec3 | null {
    const solid = this.solidAt(event);
    if (solid) return solid.point;
    return this.onLevel(event, 0);
  }
}
