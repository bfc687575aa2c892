// SPDX-License-Identifier: Apache-2.0
// A path as a ribbon of constant width on the screen, in one buffer. Each grade has a pattern of
// its own, so that none is told by its colour alone.
import * as THREE from "three";
import type { Vec3 } from "../state/types";

export type Pattern = "dashed" | "thin" | "rails" | "solid" | "hatched" | "dotted" | "dashdot";

const patterns: Pattern[] = ["dashed", "thin", "rails", "solid", "hatched", "dotted", "dashdot"];
const widths: Record<Pattern, number> = {
  dashed: 3.5, thin: 2.5, rails: 7, solid: 5, hatched: 10, dotted: 4,
  dashdot: 3,
};

const vertex = `
attribute vec3 before;
attribute vec3 after;
attribute float side;
attribute float along;
attribute vec3 shade;
uniform vec2 resolution;
uniform float width;
varying float vAlong;
varying float vSide;
varying vec3 vShade;
vec4 toClip(vec3 p) { return projectionMatrix * modelViewMatrix * vec4(p, 1.0); }
vec2 toScreen(vec4 clip) { return clip.xy / max(clip.w, 0.01) * resolution; }
void main() {
  vec4 here = toClip(position);
  vec2 way = toScreen(toClip(after)) - toScreen(toClip(before));
  float size = length(way);
  vec2 normal = size > 1e-4 ? vec2(-way.y, way.x) / size : vec2(0.0, 1.0);
  here.xy += normal * side * width / resolution * here.w;
  here.z -= 2e-4 * here.w;
  vAlong = along;
  vSide = side;
  vShade = shade;
  gl_Position = here;
}`;

const fragment = `
uniform vec3 tint;
uniform int pattern;
uniform float dash;
uniform float alpha;
varying float vAlong;
varying float vSide;
varying vec3 vShade;
uniform bool shaded;
void main() {
  vec3 base = shaded ? vShade : tint;
  float u = vAlong / dash;
  if (pattern == 0 && fract(u) > 0.55) discard;
  if (pattern == 2 && abs(vSide) < 0.4) discard;
  bool pale = pattern == 4 && fract(u * 1.4 + vSide * 0.35) > 0.65;
  float w = fract(u);
  if (pattern == 6 && w > 0.55 && (w < 0.7 || w > 0.85)) discard;
  if (pattern == 5 && fract(u * 2.0) > 0.4) discard;
  gl_FragColor = vec4(pale ? mix(base, vec3(1.0), 0.75) : base, alpha);
}`;

export class Ribbon {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;

  constructor(pattern: Pattern, order: number) {
    const material = new THREE.ShaderMaterial({
      vertexShader: vertex, fragmentShader: fragment, side: THREE.DoubleSide, transparent: true,
      uniforms: {
        resolution: { value: new THREE.Vector2(1, 1) }, width: { value: widths[pattern] },
        tint: { value: new THREE.Color() }, pattern: { value: patterns.indexOf(pattern) },
        dash: { value: 1 }, alpha: { value: 1 }, shaded: { value: false },
      },
    });
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
    this.mesh.visible = false;
  }

  // `dash`: metres from one dash to the next. `shades`: red, green and blue of each point, to 255, in
  // place of the one colour.
  set(points: Vec3[], dash: number, shades?: number[][]): void {
    this.setRuns(points.length > 1 ? [points] : [], dash, shades);
  }

  // `shades`: of the points of all runs.
  setRuns(runs: Vec3[][], dash: number, shades?: number[][]): void {
    const count = runs.reduce((sum, run) => sum + run.length, 0);
    this.mesh.visible = count > 1;
    if (count < 2) return;
    const place = new Float32Array(count * 6), before = new Float32Array(count * 6);
    const after = new Float32Array(count * 6), side = new Float32Array(count * 2);
    const along = new Float32Array(count * 2);
    const shade = new Uint8Array(shades ? count * 6 : 0);
    const index: number[] = [];
    let k = 0;
    for (const run of runs) {
      let way = 0;
      run.forEach((p, i) => {
        const a = run[Math.max(0, i - 1)] as Vec3, b = run[Math.min(run.length - 1, i + 1)] as Vec3;
        if (i > 0) way += Math.hypot(p[0] - a[0], p[1] - a[1], p[2] - a[2]);
        for (const s of [0, 1]) {
          const at = 2 * k + s;
          place.set(p, 3 * at);
          before.set(a, 3 * at);
          after.set(b, 3 * at);
          side[at] = s * 2 - 1;
          along[at] = way;
          if (shades) shade.set(shades[k] ?? [0, 0, 0], 3 * at);
        }
        if (i > 0) index.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k, 2 * k - 1, 2 * k + 1);
        ++k;
      });
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
    geometry.setAttribute("before", new THREE.BufferAttribute(before, 3));
    geometry.setAttribute("after", new THREE.BufferAttribute(after, 3));
    geometry.setAttribute("side", new THREE.BufferAttribute(side, 1));
    geometry.setAttribute("along", new THREE.BufferAttribute(along, 1));
    if (shades) geometry.setAttribute("shade", new THREE.BufferAttribute(shade, 3, true));
    this.uniform("shaded").value = shades !== undefined;
    geometry.setIndex(index);
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.uniform("dash").value = Math.max(dash, 1e-3);
  }

  hide(): void {
    this.mesh.visible = false;
  }

  paint(tint: string, alpha = 1): void {
    (this.uniform("tint").value as THREE.Color).set(tint);
    this.uniform("alpha").value = alpha;
  }

  resize(width: number, height: number): void {
    (this.uniform("resolution").value as THREE.Vector2).set(width, height);
  }

  private uniform(name: string): THREE.IUniform {
    return this.mesh.material.uniforms[name] as THREE.IUniform;
  }
}
