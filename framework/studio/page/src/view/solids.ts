// SPDX-License-Identifier: Apache-2.0
// Obstacles and subjects: one buffer with their light baked into it, however many there are.
import * as THREE from "three";
import { isObject } from "../state/document";
import { subjectAt } from "../state/film";
import { holds } from "../state/room";
import { trianglesOf, type Triangles } from "../state/shapes";
import type { JsonObject, SubjectTrack, Vec3 } from "../state/types";
import { vec } from "../state/vector";

interface Baked {
  place: Float32Array;    // three corners a triangle
  shade: Float32Array;    // light of each triangle, 0 to 1
}

const LIGHT = new THREE.Vector3(0.45, -0.6, 1.1).normalize();

export function baked({ positions, triangles }: Triangles): Baked {
  const place = new Float32Array(triangles.length * 3);
  const shade = new Float32Array(triangles.length / 3);
  for (let t = 0; t < triangles.length; t += 3) {
    for (let c = 0; c < 3; ++c) {
      const from = 3 * (triangles[t + c] as number);
      place[3 * (t + c)] = positions[from] as number;
      place[3 * (t + c) + 1] = positions[from + 1] as number;
      place[3 * (t + c) + 2] = positions[from + 2] as number;
    }
    const p = (k: number): number => place[3 * t + k] as number;
    const ux = p(3) - p(0), uy = p(4) - p(1), uz = p(5) - p(2);
    const wx = p(6) - p(0), wy = p(7) - p(1), wz = p(8) - p(2);
    const nx = uy * wz - uz * wy, ny = uz * wx - ux * wz, nz = ux * wy - uy * wx;
    const size = Math.hypot(nx, ny, nz) || 1;
    const lit = (nx * LIGHT.x + ny * LIGHT.y + nz * LIGHT.z) / size;
    shade[t / 3] = 0.52 + 0.48 * Math.max(-0.4, lit);
  }
  return { place, shade };
}

export interface Solid {
  key: string;               // of the obstacle's text, so that an unchanged one is not made again
  baked: Baked;
  seeThrough: boolean;
  source: JsonObject;        // the obstacle
  track: { time: number; move: Vec3 }[];   // empty: it stands still
}

function trackOf(obstacle: JsonObject): Solid["track"] {
  if (!Array.isArray(obstacle.track)) return [];
  return obstacle.track.flatMap((entry) => {
    const move = isObject(entry) ? vec(entry.move) : null;
    const time = isObject(entry) ? entry.time : null;
    return move && typeof time === "number" ? [{ time, move }] : [];
  });
}

// Of the world alone, of the film's picture alone; all else is in both.
export const WORLD = 1, PICTURE = 2;

function meshOf(seeThrough: boolean): THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> {
  const material = new THREE.MeshBasicMaterial({
    vertexColors: true, side: seeThrough ? THREE.DoubleSide : THREE.FrontSide,
    transparent: seeThrough, opacity: seeThrough ? 0.25 : 1, depthWrite: !seeThrough,
    forceSinglePass: true,     // two passes would compile the material anew in every frame
  });
  const mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
  mesh.frustumCulled = false;
  return mesh;
}

// Cuts away what is on the negative side of a plane; null: nothing.
export function cutMaterial(material: THREE.Material, plane: THREE.Plane | null): void {
  const had = material.clippingPlanes?.[0] ?? null;
  if (had === plane || (had && plane && had.equals(plane))) return;
  if ((had === null) !== (plane === null)) material.needsUpdate = true;
  material.clippingPlanes = plane ? [plane] : null;
}

export class Solids {
  readonly group = new THREE.Group();
  readonly opaque = meshOf(false);
  private readonly clear = meshOf(true);
  private readonly people = meshOf(false);
  private readonly movers = meshOf(false);
  // What a subject is inside of: whole in the world, and looked through in the picture, where it
  // would hide what is filmed. A rendered picture shows it so.
  readonly around = meshOf(false);
  private readonly aroundClear = meshOf(true);
  private holders = new Set<number>();
  private time = 0;
  private known: (Solid | null)[] = [];
  private readonly blobs = new Map<number, Baked>();
  private ends: number[] = [];       // last triangle of each obstacle in the opaque buffer,
  private aroundEnds: number[] = [];  // and of those around subjects
  private subjects: SubjectTrack[] = [];
  private colours = { solid: "#888", closed: "#a33", subject: "#27a", chosen: "#f80" };
  private chosen: number | null = null;

  constructor() {
    this.around.layers.set(WORLD);
    this.aroundClear.layers.set(PICTURE);
    this.group.add(this.opaque, this.clear, this.people, this.movers, this.around,
                   this.aroundClear);
  }

  paint(colours: Solids["colours"]): void {
    this.colours = colours;
    this.merge();
    this.drawSubjects(this.time);
  }

  // What is cut away of things that hide others; null: nothing.
  cutBy(plane: THREE.Plane | null): void {
    cutMaterial(this.opaque.material as THREE.Material, plane);
  }

  // Triangles of an obstacle that only the server can draw.
  setBlob(index: number, triangles: Triangles): void {
    this.blobs.set(index, baked(triangles));
    this.known[index] = null;
  }

  choose(index: number | null): void {
    if (index === this.chosen) return;
    this.chosen = index;
    this.merge();
  }

  set(obstacles: JsonObject[]): void {
    let changed = obstacles.length !== this.known.length;
    const next = obstacles.map((obstacle, i): Solid | null => {
      const key = JSON.stringify(obstacle);
      const had = this.known[i];
      if (had?.key === key) return had;
      changed = true;
      const own = trianglesOf(obstacle);
      const shape = obstacle.hidden === true ? undefined : own ? baked(own) : this.blobs.get(i);
      const seeThrough = obstacle.opaque === false || obstacle.side === "keep_inside" ||
        obstacle.type === "no_fly_zone";
      return shape ? { key, baked: shape, seeThrough, track: trackOf(obstacle), source: obstacle }
        : null;
    });
    this.known = next;
    if (changed) this.merge();
    this.findHolders();
  }

  private findHolders(): void {
    const places = this.subjects.map((subject) => subjectAt(subject, this.time));
    const found = this.known.flatMap((solid, i) =>
      solid && !solid.seeThrough && solid.track.length === 0 &&
      places.some((place) => holds(solid.source, place)) ? [i] : []);
    if (found.length === this.holders.size && found.every((i) => this.holders.has(i))) return;
    this.holders = new Set(found);
    this.merge();
  }

  private merge(): void {
    const part = (held: boolean): { parts: [Baked, string][]; ends: number[] } => {
      const parts: [Baked, string][] = [], ends: number[] = [];
      let end = 0;
      this.known.forEach((solid, i) => {
        if (solid && !solid.seeThrough && solid.track.length === 0 && this.holders.has(i) === held) {
          parts.push([solid.baked, i === this.chosen ? this.colours.chosen : this.colours.solid]);
          end += solid.baked.shade.length;
        }
        ends.push(end);
      });
      return { parts, ends };
    };
    const free = part(false), held = part(true);
    this.ends = free.ends;
    this.aroundEnds = held.ends;
    fill(this.opaque, free.parts);
    fill(this.around, held.parts);
    fill(this.aroundClear, held.parts);
    fill(this.clear, this.known.flatMap((solid, i) => solid?.seeThrough
      ? [[solid.baked, i === this.chosen ? this.colours.chosen : this.colours.closed] as
         [Baked, string]] : []));
    this.drawMovers();
  }

  private drawMovers(): void {
    fill(this.movers, this.known.flatMap((solid, i): [Baked, string][] => {
      if (!solid || solid.seeThrough || solid.track.length === 0) return [];
      const by = this.moveOf(solid);
      const place = solid.baked.place.map((v, k) => v + (by[k % 3] as number));
      return [[{ place, shade: solid.baked.shade },
               i === this.chosen ? this.colours.chosen : this.colours.solid]];
    }));
  }

  setSubjects(subjects: SubjectTrack[], time: number): void {
    this.subjects = subjects;
    this.time = time;
    this.drawSubjects(time);
    this.findHolders();
  }

  // Where all is at a time; made again only where something moves.
  moveTo(time: number): void {
    this.time = time;
    if (this.movers.visible) this.drawMovers();
    if (this.subjects.some((s) => s.times.length > 1)) {
      this.drawSubjects(time);
      this.findHolders();
    }
  }

  private drawSubjects(time: number): void {
    fill(this.people, this.subjects.flatMap((subject): [Baked, string][] => {
      const at = subjectAt(subject, time);
      const height = subject.height || 0.4, radius = (subject.width || 0.4) / 2;
      const base: Vec3 = [at[0], at[1], at[2] - height / 2];
      const body = trianglesOf({ type: "cylinder", base, radius, height });
      return body ? [[baked(body), this.colours.subject]] : [];
    }));
  }

  // The first obstacle on a ray that is not looked through.
  hitBy(ray: THREE.Raycaster): { index: number; point: Vec3 } | null {
    ray.layers.enableAll();
    const [hit] = ray.intersectObjects([this.opaque, this.around].filter((mesh) => mesh.visible));
    if (!hit) return null;
    const ends = hit.object === this.opaque ? this.ends : this.aroundEnds;
    const index = ends.findIndex((end) => (hit.faceIndex ?? 0) < end);
    return index < 0 ? null : { index, point: [hit.point.x, hit.point.y, hit.point.z] };
  }

  get triangles(): number {
    return (this.opaque.geometry.getAttribute("position")?.count ?? 0) / 3;
  }

  // Whether some obstacle moves.
  get moving(): boolean {
    return this.movers.visible;
  }

  // The surfaces of what flights keep away from, or stay inside of, where they are now; `key` is
  // another one for another surface.
  bodies(): (Triangles & { key: string; inside: boolean })[] {
    return this.known.flatMap((solid) => {
      if (!solid) return [];
      const by = this.moveOf(solid);
      const { place } = solid.baked;
      return [{
        key: `${solid.key}${by.join()}`, inside: solid.source.side === "keep_inside",
        positions: by.some((v) => v !== 0) ? place.map((v, k) => v + (by[k % 3] as number)) : place,
        triangles: Uint32Array.from(place.subarray(0, place.length / 3), (_, i) => i),
      }];
    });
  }

  private moveOf({ track }: Solid): Vec3 {
    return track.length === 0 ? [0, 0, 0]
      : subjectAt({ name: "", times: track.map((p) => p.time),
                    positions: track.map((p) => p.move) }, this.time);
  }

  bounds(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const mesh of [this.opaque, this.around, this.people]) {
      if (mesh.visible) box.union(new THREE.Box3().setFromObject(mesh));
    }
    return box;
  }
}

function fill(mesh: THREE.Mesh, parts: [Baked, string][]): void {
  const triangles = parts.reduce((sum, [part]) => sum + part.shade.length, 0);
  mesh.visible = triangles > 0;
  mesh.geometry.dispose();
  const geometry = new THREE.BufferGeometry();
  const place = new Float32Array(triangles * 9), tint = new Uint8Array(triangles * 9);
  let at = 0;
  const color = new THREE.Color();
  for (const [part, colour] of parts) {
    place.set(part.place, at * 9);
    color.set(colour);
    for (let t = 0; t < part.shade.length; ++t) {
      const light = 255 * (part.shade[t] as number);
      for (let c = 0; c < 3; ++c) {
        const k = 9 * (at + t) + 3 * c;
        tint[k] = color.r * light;
        tint[k + 1] = color.g * light;
        tint[k + 2] = color.b * light;
      }
    }
    at += part.shade.length;
  }
  geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(tint, 3, true));
  mesh.geometry = geometry;
}
