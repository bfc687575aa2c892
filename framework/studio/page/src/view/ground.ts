// SPDX-License-Identifier: Apache-2.0
// The ground at height 0 with a line every ten metres, north marked.
import * as THREE from "three";

const HALF = 160;    // m
const EVERY = 10;    // m

export class Ground {
  readonly group = new THREE.Group();
  private readonly plane: THREE.Mesh<THREE.PlaneGeometry, THREE.MeshBasicMaterial>;
  private readonly lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  private readonly axes: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;

  constructor() {
    this.plane = new THREE.Mesh(new THREE.PlaneGeometry(4 * HALF, 4 * HALF),
                                new THREE.MeshBasicMaterial());
    this.plane.position.z = -0.03;
    this.plane.renderOrder = -3;    // a backdrop is drawn over it
    this.plane.material.polygonOffset = true;
    this.plane.material.polygonOffsetFactor = 2;
    this.plane.material.polygonOffsetUnits = 8;
    const points: number[] = [];
    // Short pieces: software drawers lose long lines that begin behind the eye.
    for (let k = -HALF; k <= HALF; k += EVERY) {
      for (let from = -HALF; from < HALF; from += EVERY) {
        points.push(k, from, 0, k, from + EVERY, 0, from, k, 0, from + EVERY, k, 0);
      }
    }
    this.lines = segments(points);
    // An arrow north from the origin, five metres long.
    this.axes = segments([0, 0, 0.02, 0, 5, 0.02, 0, 5, 0.02, -0.5, 4.2, 0.02, 0, 5, 0.02, 0.5, 4.2,
                          0.02]);
    this.group.add(this.plane, this.lines, this.axes);
  }

  paint(ground: string, grid: string, ink: string): void {
    this.plane.material.color.set(ground);
    this.lines.material.color.set(grid);
    this.axes.material.color.set(ink);
  }
}

export function segments(
  points: number[],
): THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial> {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
  const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial());
  lines.frustumCulled = false;
  return lines;
}
