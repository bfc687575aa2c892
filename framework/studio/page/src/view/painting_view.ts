// SPDX-License-Identifier: Apache-2.0
// A light painting: the strokes that were asked for, and the light up to the play head; at the
// beginning all of it. In the mode `stroke` a drag draws on the plane of the drawing.
import * as THREE from "three";
import { addedStroke, litRuns, planeOf } from "../state/painting";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { Ribbon } from "./ribbon";
import type { Stage } from "./stage";

const LIGHT = "#ffb52e", EDGE = "#7a4d00";

export class PaintingView {
  private readonly lit = new Ribbon("solid", 8);
  private readonly rim = new Ribbon("rails", 7);
  private readonly asked = new Ribbon("thin", 6);
  private readonly drawing = new Ribbon("solid", 9);

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    for (const ribbon of [this.lit, this.rim, this.asked, this.drawing]) {
      ribbon.mesh.material.depthTest = false;   // they lie on the path
      stage.tools.add(ribbon.mesh);
      stage.onResize((width, height) => ribbon.resize(width, height));
    }
    studio.on(["document", "standing", "time", "look"], () => this.draw());
    stage.world.addEventListener("pointerdown", (event) => {
      if (studio.mode === "stroke" && event.button === 0 && event.target === stage.world) {
        this.stroke(event);
      }
    }, { capture: true });
    this.draw();
  }

  private draw(): void {
    const { studio } = this;
    const lights = studio.plan.lights ?? [];
    const until = studio.time > 0.05 ? studio.time : Infinity;
    const runs = lights.length > 0 ? litRuns(studio.plan, until) : [];
    this.lit.paint(LIGHT);
    this.rim.paint(EDGE, 0.5);
    this.asked.paint(this.stage.palette.ink, 0.8);
    this.lit.setRuns(runs, 1);
    this.rim.setRuns(runs, 1);
    this.asked.setRuns(studio.plan.strokes ?? [], 1);
    this.stage.invalidate();
  }

  private at(event: PointerEvent): Vec3 | null {
    const plane = planeOf(this.studio.document);
    if (!plane) return null;
    const normal = new THREE.Vector3(...plane.normal);
    const hit = this.stage.rayAt(event.clientX, event.clientY).intersectPlane(
      new THREE.Plane().setFromNormalAndCoplanarPoint(normal, new THREE.Vector3(...plane.base)),
      new THREE.Vector3());
    return hit ? [hit.x, hit.y, hit.z] : null;
  }

  // How hard a pen is pressed says nothing.
  private stroke(event: PointerEvent): void {
    const { studio, stage } = this;
    event.stopImmediatePropagation();
    const drawn: Vec3[] = [];
    const step = (e: PointerEvent): void => {
      const at = this.at(e);
      if (at) drawn.push(at);
      this.drawing.paint(LIGHT);
      this.drawing.setRuns(drawn.length > 1 ? [drawn] : [], 1);
      stage.invalidate();
    };
    step(event);
    const { world } = stage;
    world.setPointerCapture(event.pointerId);
    const done = (kept: boolean): void => {
      world.removeEventListener("pointermove", step);
      world.removeEventListener("pointerup", up);
      world.removeEventListener("pointercancel", cancel);
      window.removeEventListener("keydown", escape, true);
      this.drawing.hide();
      const made = kept ? addedStroke(studio.document, drawn) : null;
      if (made) studio.edit(made);
      stage.invalidate();
    };
    const up = (): void => done(true);
    const cancel = (): void => done(false);
    const escape = (e: KeyboardEvent): void => {
      if (e.key !== "Escape") return;
      e.stopPropagation();
      done(false);
    };
    world.addEventListener("pointermove", step);
    world.addEventListener("pointerup", up);
    world.addEventListener("pointercancel", cancel);
    window.addEventListener("keydown", escape, true);
  }
}
