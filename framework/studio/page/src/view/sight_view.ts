// SPDX-License-Identifier: Apache-2.0
// What the last image by the play head was chosen by: fetched, told to the panel, and its rays
// drawn: pale where the map was known, strong from the first unknown voxel on.
import * as THREE from "three";
import { imagesBy, Sights } from "../state/exploration";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { blob } from "./blobs";
import type { Stage } from "./stage";

const MOST_KEPT = 64;     // blobs of single images

export class SightView {
  private readonly lines = new THREE.LineSegments(
    new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ vertexColors: true }));
  private readonly fetched = new Map<string, Sights | null>();   // null: on its way
  private shown = "";

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    this.lines.frustumCulled = false;
    this.lines.visible = false;
    stage.tools.add(this.lines);
    studio.on(["world", "episode", "time", "document"], () => this.find());
    studio.on(["look", "sight"], () => this.draw());
  }

  get rays(): number {
    return this.lines.visible ? this.studio.sight?.rays.length ?? 0 : 0;
  }

  // The blob that has it, and its place there.
  private get place(): [string, number] | null {
    const { studio } = this;
    const { episode } = studio;
    if (!episode) return null;
    const at = imagesBy(episode, studio.time) - 1;
    if (at < 0) return null;
    const single = studio.live && !studio.run ? studio.live.sights[at] : undefined;
    return single ? [single, 0] : episode.sights ? [episode.sights, at] : null;
  }

  private find(): void {
    const { studio, place } = this;
    const name = place ? place.join() : "";
    if (name === this.shown) return;
    const sights = place ? this.fetched.get(place[0]) : undefined;
    if (place && !sights) {
      if (sights === undefined) this.fetch(place[0]);
      return;                         // what is shown stays until the next one has come
    }
    this.shown = name;
    studio.sight = sights?.at((place as [string, number])[1]) ?? null;
    studio.tell("sight");
  }

  private fetch(name: string): void {
    while (this.fetched.size >= MOST_KEPT) this.fetched.delete(this.fetched.keys().next().value as string);
    this.fetched.set(name, null);
    blob(name).then((buffer) => {
      this.fetched.set(name, new Sights(buffer));
      this.find();
    }).catch((error: Error) => {
      // It stays null: asked for again at every move of the play head, it would be told as often.
      this.studio.session.note(`What a view was chosen by cannot be shown: ${error.message}`);
    });
  }

  private draw(): void {
    const { studio, stage } = this;
    const { sight, episode } = studio;
    const at = episode ? imagesBy(episode, studio.time) - 1 : -1;
    const eye = episode?.images[at]?.position;
    this.lines.visible = studio.look.rays && sight !== null && eye !== undefined;
    if (this.lines.visible && sight && eye) {
      const pale = new THREE.Color(stage.palette.step), strong = new THREE.Color(stage.palette.chosen);
      const places = new Float32Array(12 * sight.rays.length), tints = new Float32Array(12 * sight.rays.length);
      sight.rays.forEach(({ end, unknownFrom }, k) => {
        const middle = eye.map((v, i) => v + unknownFrom * ((end[i] as number) - v)) as Vec3;
        [eye, middle, middle, end].forEach((p, n) => {
          places.set(p, 12 * k + 3 * n);
          const { r, g, b } = n < 2 ? pale : strong;
          tints.set([r, g, b], 12 * k + 3 * n);
        });
      });
      this.lines.geometry.dispose();
      this.lines.geometry = new THREE.BufferGeometry();
      this.lines.geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
      this.lines.geometry.setAttribute("color", new THREE.BufferAttribute(tints, 3));
    }
    stage.invalidate();
  }
}
