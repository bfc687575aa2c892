// SPDX-License-Identifier: Apache-2.0
// Arrows and squares at what is selected: a drag along an axis or on a plane.
import * as THREE from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { moved, placeOfItem, type Item } from "../state/edits";
import type { JsonObject, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Stage } from "./stage";

export class Gizmo {
  readonly controls: TransformControls;
  private readonly anchor = new THREE.Object3D();
  private base: JsonObject | null = null;
  private item: Item | null = null;
  private dropped = false;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    this.controls = new TransformControls(stage.worldCamera, stage.world);
    this.controls.setSize(0.75);
    stage.tools.add(this.anchor, this.controls.getHelper());
    this.controls.addEventListener("change", () => stage.invalidate());
    this.controls.addEventListener("mouseDown", () => this.begin());
    this.controls.addEventListener("objectChange", () => this.move());
    this.controls.addEventListener("mouseUp", () => this.finish());
    studio.on(["document", "selection", "mode"], () => this.attach());
    window.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || !this.base) return;
      event.stopPropagation();
      this.dropped = true;
      studio.session.rest();
    }, true);
  }

  get busy(): boolean {
    return this.controls.dragging || this.controls.axis !== null;
  }

  private attach(): void {
    if (this.base) return;
    const { selection, document, mode, editable } = this.studio;
    const place = selection && placeOfItem(document, selection);
    if (!place || mode === "camera" || !editable) {
      this.controls.detach();
    } else {
      this.anchor.position.set(...place);
      this.controls.attach(this.anchor);
    }
    this.stage.invalidate();
  }

  private begin(): void {
    this.base = this.studio.session.settled();
    this.item = this.studio.selection;
    this.dropped = false;
  }

  private here(): Vec3 {
    const { x, y, z } = this.anchor.position;
    return [x, y, z];
  }

  private move(): void {
    if (!this.base || !this.item || this.dropped) return;
    this.studio.drag(moved(this.base, this.item, this.here()));
  }

  private finish(): void {
    const { base, item } = this;
    this.base = null;
    if (base && item && !this.dropped) this.studio.edit(moved(base, item, this.here()));
    this.attach();
  }
}
