// SPDX-License-Identifier: Apache-2.0
// The margin around what the flight keeps away from, as a hull in the world; on request.
import * as THREE from "three";
import { offset } from "../state/hull";
import type { Triangles } from "../state/shapes";
import type { Studio } from "../studio";
import type { Solids } from "./solids";
import type { Stage } from "./stage";

const MOST = 60000;      // triangles, of an obstacle whose hull is drawn

export class Hulls {
  private readonly mesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({
    transparent: true, opacity: 0.16, depthWrite: false, side: THREE.FrontSide,
  }));
  private readonly edges = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 }));
  private shown = "";

  constructor(private readonly studio: Studio, private readonly stage: Stage,
              private readonly solids: Solids) {
    for (const part of [this.mesh, this.edges]) {
      part.frustumCulled = false;
      part.visible = false;
      stage.tools.add(part);
    }
    studio.on(["document", "world", "look"], () => this.draw());
    studio.on(["time"], () => { if (studio.margins && solids.moving) this.draw(); });
  }

  private get margin(): number {
    const { margin } = this.studio.document;
    if (typeof margin === "number") return margin;
    return this.studio.session.world.margin ?? 0;
  }

  private draw(): void {
    const { studio } = this;
    const on = studio.margins && this.margin > 0;
    this.mesh.visible = this.edges.visible = on;
    if (!on) {
      this.stage.invalidate();
      return;
    }
    const bodies = this.solids.bodies().filter(({ triangles }) => triangles.length / 3 <= MOST);
    const text = JSON.stringify([this.margin, bodies.map(({ key }) => key)]);
    this.mesh.material.color.set(this.stage.palette.fail);
    this.edges.material.color.set(this.stage.palette.fail);
    if (text !== this.shown) {
      this.shown = text;
      this.build(bodies);
    }
    this.stage.invalidate();
  }

  private build(bodies: (Triangles & { inside: boolean })[]): void {
    const places: number[] = [];
    for (const body of bodies) {
      const { positions, triangles } = offset(body, body.inside ? -this.margin : this.margin);
      for (const corner of triangles) {
        for (let k = 0; k < 3; ++k) places.push(positions[3 * corner + k] as number);
      }
    }
    this.mesh.geometry.dispose();
    this.edges.geometry.dispose();
    this.mesh.geometry = new THREE.BufferGeometry();
    this.mesh.geometry.setAttribute("position",
                                    new THREE.BufferAttribute(new Float32Array(places), 3));
    this.edges.geometry = new THREE.EdgesGeometry(this.mesh.geometry, 25);
    this.mesh.visible = this.edges.visible = places.length > 0;
  }
}
