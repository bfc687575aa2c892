// SPDX-License-Identifier: Apache-2.0
// While the view moves, a coarse stand-in is drawn for a mesh of many triangles.
import * as THREE from "three";
import { coarseOf } from "../state/coarse";
import type { Stage } from "./stage";

const MANY = 120_000;       // triangles, above which there is a stand-in
const MOST = 40_000;        // of it
const SOON = 300;           // ms

export class Lighter {
  private readonly stand = new THREE.Mesh(new THREE.BufferGeometry());
  private of: THREE.BufferGeometry | null = null;    // what the stand-in was made of
  private waiting = 0;
  private shown: number;                              // layers of the mesh while nothing moves

  constructor(private readonly stage: Stage, private readonly mesh: THREE.Mesh) {
    this.stand.material = mesh.material;
    this.stand.frustumCulled = false;
    this.stand.visible = false;
    this.shown = mesh.layers.mask;
    mesh.parent?.add(this.stand);
    stage.before(() => this.swap());
  }

  private swap(): void {
    const { mesh, stand, stage } = this;
    const many = mesh.visible && trianglesOf(mesh) > MANY;
    const light = many && stage.moving;
    if (many && this.of !== mesh.geometry) {
      if (light) this.make();
      else this.soon();
    }
    if (mesh.layers.mask !== 0) this.shown = mesh.layers.mask;
    mesh.layers.mask = light ? 0 : this.shown;
    stand.layers.mask = this.shown;
    stand.visible = light;
  }

  // Before the view moves for the first time.
  private soon(): void {
    window.clearTimeout(this.waiting);
    this.waiting = window.setTimeout(() => {
      if (this.of !== this.mesh.geometry) this.make();
    }, SOON);
  }

  private make(): void {
    const { position, color } = this.mesh.geometry.attributes;
    if (!position || !color) return;
    const { place, tint } = coarseOf({ place: position.array, tint: color.array }, MOST);
    this.stand.geometry.dispose();
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(tint, 3, true));
    this.stand.geometry = geometry;
    this.of = this.mesh.geometry;
  }
}

const trianglesOf = (mesh: THREE.Mesh): number =>
  (mesh.geometry.getAttribute("position")?.count ?? 0) / 3;
