// SPDX-License-Identifier: Apache-2.0
// An exploration at the play head: the voxels that its map had by then, the view of the last image,
// and at the end the views that were left, by their value.
import * as THREE from "three";
import { growthIn, grownBy, imagesBy, type Growth, type LiveEpisode } from "../state/exploration";
import type { ExplorationWorld } from "../state/types";
import type { Studio } from "../studio";
import { blob } from "./blobs";
import { cutMaterial } from "./solids";
import { magnified, type Stage } from "./stage";

const LIVE = "live";       // no blob
const TICK = 1.2;          // m, of the line that shows where a candidate looks
const LEAST_VALUE = 0.15;  // brightness of a candidate without value
const BRIGHT = [232, 60, 120];  // of the best one
// Red, green and blue, from the lowest to the highest.
const SHADES = [[58, 104, 160], [92, 170, 150], [236, 212, 110]] as const;

function shadeOf(share: number): [number, number, number] {
  const [from, to] = share < 0.5 ? [SHADES[0], SHADES[1]] : [SHADES[1], SHADES[2]];
  const mix = share < 0.5 ? 2 * share : 2 * share - 1;
  return [0, 1, 2].map((k) => from[k as 0] + mix * (to[k as 0] - from[k as 0])) as
    [number, number, number];
}

export class ExplorationView {
  private readonly voxels = new THREE.Points(
    new THREE.BufferGeometry(), new THREE.PointsMaterial({ vertexColors: true, sizeAttenuation: true }));
  private readonly candidates = new THREE.LineSegments(
    new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ vertexColors: true }));
  private edge = 1;                           // m, of a voxel
  private growth: Growth | null = null;
  private fetched = "";
  private drawn: unknown = null;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    this.voxels.frustumCulled = this.candidates.frustumCulled = false;
    this.voxels.visible = this.candidates.visible = false;
    this.voxels.onBeforeRender = (_renderer, _scene, camera) => {
      this.voxels.material.size = 1.3 * this.edge * magnified(camera as THREE.PerspectiveCamera);
    };
    stage.scene.add(this.voxels);
    stage.tools.add(this.candidates);
    studio.on(["world", "episode", "look"], () => this.draw());
    studio.on(["time"], () => this.grow());
  }

  get count(): number {
    return this.voxels.visible ? this.voxels.geometry.drawRange.count : 0;
  }

  bounds(): THREE.Box3 {
    return this.growth && this.voxels.visible
      ? new THREE.Box3().setFromArray(this.growth.middles) : new THREE.Box3();
  }

  // What is cut away of the map; null: nothing.
  cutBy(plane: THREE.Plane | null): void {
    cutMaterial(this.voxels.material, plane);
  }

  private get told(): ExplorationWorld | undefined {
    return this.studio.episode;
  }

  private draw(): void {
    const { told } = this;
    const { live, run } = this.studio;
    if (live && !run) this.showLive(live);
    else this.fetch(told?.growth ?? "");
    if (this.drawn !== told) {
      this.drawn = told;
      this.drawCandidates(told);
    }
    this.candidates.visible = told !== undefined && this.studio.look.candidates;
    this.grow();
  }

  private drawCandidates(told: ExplorationWorld | undefined): void {
    const all = told?.candidates ?? [];
    const most = Math.max(1e-12, ...all.map((c) => c.value));
    const places = new Float32Array(6 * all.length), colors = new Uint8Array(6 * all.length);
    all.forEach(({ position, direction, value }, i) => {
      const light = Math.max(LEAST_VALUE, value / most);
      for (let k = 0; k < 3; ++k) {
        places[6 * i + k] = position[k] as number;
        places[6 * i + 3 + k] = (position[k] as number) + TICK * (direction[k] as number);
        colors[6 * i + k] = colors[6 * i + 3 + k] = light * (BRIGHT[k] as number);
      }
    });
    this.candidates.geometry.dispose();
    this.candidates.geometry = new THREE.BufferGeometry();
    this.candidates.geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    this.candidates.geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3, true));
  }

  private showLive(live: LiveEpisode): void {
    this.fetched = LIVE;
    if (this.growth !== live.growth) this.take(live.growth);
  }

  private fetch(name: string): void {
    if (name === this.fetched) return;
    this.fetched = name;
    this.voxels.visible = false;
    this.growth = null;
    if (!name) return;
    blob(name).then((buffer) => {
      if (this.fetched === name) this.take(growthIn(buffer));
    }).catch((error: Error) => {
      if (this.fetched !== name) return;
      this.fetched = "";
      this.studio.session.note(`The map cannot be shown: ${error.message}`);
    });
  }

  private take(growth: Growth): void {
    this.growth = growth;
    const { middles } = growth;
    let low = Infinity, high = -Infinity;
    for (let i = 2; i < middles.length; i += 3) {
      low = Math.min(low, middles[i] as number);
      high = Math.max(high, middles[i] as number);
    }
    const colors = new Uint8Array(middles.length);
    for (let i = 0; i < middles.length; i += 3) {
      const share = high > low ? ((middles[i + 2] as number) - low) / (high - low) : 0;
      const shade = shadeOf(share);
      // Neighbours differ a little, so that cubes are told from a sheet.
      const light = 0.8 + 0.2 * Math.abs(Math.sin(12.9898 * (i / 3)));
      for (let k = 0; k < 3; ++k) colors[i + k] = light * (shade[k] as number);
    }
    this.voxels.geometry.dispose();
    this.voxels.geometry = new THREE.BufferGeometry();
    this.voxels.geometry.setAttribute("position", new THREE.BufferAttribute(middles, 3));
    this.voxels.geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3, true));
    this.edge = growth.edge;
    this.voxels.visible = true;
    this.grow();
    if (this.fetched !== LIVE) this.studio.tell("standing");
  }

  private grow(): void {
    const { told, growth } = this;
    if (told && growth) {
      this.voxels.geometry.setDrawRange(0, grownBy(growth, imagesBy(told, this.studio.time)));
    }
    this.stage.invalidate();
  }
}
