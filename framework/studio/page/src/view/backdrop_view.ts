// SPDX-License-Identifier: Apache-2.0
// A raster beneath the scene, drawn at the height of the ground before all else, so that it hides
// nothing.
import * as THREE from "three";
import { backdropGrid, backdropInWords, isPlaced, picturePixels, placeOfPixel } from "../state/backdrop";
import type { BackdropMessage, BackdropPicture, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { blob } from "./blobs";
import { byId } from "./dom";
import { WORLD } from "./solids";
import type { Stage } from "./stage";

const ORDER = -2;          // behind all but the ground

export class BackdropView {
  private readonly mesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({
    alphaTest: 0.5, depthTest: false, depthWrite: false, side: THREE.DoubleSide }));
  private readonly button = byId<HTMLButtonElement>("backdrop");
  private message: BackdropMessage | null = null;
  private on = true;

  constructor(private readonly studio: Studio, private readonly stage: Stage,
              private readonly say: (text: string, kind: "bad") => void) {
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.mesh.renderOrder = ORDER;
    this.mesh.layers.set(WORLD);
    stage.scene.add(this.mesh);
    // From below, it would hide the sky.
    stage.before(() => {
      this.mesh.visible = this.drawn !== null && stage.worldCamera.position.z > this.level;
    });
    studio.session.on(({ what, message }) => {
      if (what === "backdrop" && message?.type === "backdrop") this.take(message);
      if (what === "world" || what === "welcome") this.place();
    });
    this.button.addEventListener("click", () => this.toggle());
  }

  // What is drawn; null: nothing.
  get drawn(): BackdropPicture | null {
    return this.on && isPlaced(this.message) && this.mesh.material.map ? this.message : null;
  }

  // Where a pixel of the picture is in the world.
  placeOf(x: number, y: number): Vec3 | null {
    return isPlaced(this.message) ? placeOfPixel(this.message, x, y, this.level) : null;
  }

  // The ground: of a scan the lowest level of its region.
  private get level(): number {
    const lows = (this.studio.session.world.scan?.region ?? []).map(({ low }) => low);
    return lows.length > 0 ? Math.min(...lows) : 0;
  }

  private take(message: BackdropMessage): void {
    this.drop();
    this.message = message;
    this.button.hidden = false;
    this.show();
    if (!isPlaced(message)) return this.say(`Backdrop: ${message.why}`, "bad");
    blob(message.picture).then((buffer) => {
      if (this.message !== message) return;
      const { width, height, texels } = picturePixels(buffer);
      const picture = new THREE.DataTexture(texels, width, height);
      picture.magFilter = THREE.NearestFilter;       // pixels are seen as they are
      picture.minFilter = THREE.LinearMipmapLinearFilter;
      picture.generateMipmaps = true;
      picture.needsUpdate = true;
      this.mesh.material.map = picture;
      this.mesh.material.needsUpdate = true;
      this.place();
      this.show();
    }).catch((error: Error) => this.say(`The backdrop cannot be drawn: ${error.message}`, "bad"));
  }

  private drop(): void {
    this.mesh.material.map?.dispose();
    this.mesh.material.map = null;
    this.stage.invalidate();
  }

  private place(): void {
    if (!isPlaced(this.message)) return;
    const { positions, places, triangles } = backdropGrid(this.message, this.level);
    this.mesh.geometry.dispose();
    this.mesh.geometry = new THREE.BufferGeometry();
    this.mesh.geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    this.mesh.geometry.setAttribute("uv", new THREE.BufferAttribute(places, 2));
    this.mesh.geometry.setIndex(triangles);
    this.stage.invalidate();
  }

  private toggle(): void {
    const { message } = this;
    if (message && !isPlaced(message)) return this.say(`Backdrop: ${message.why}`, "bad");
    this.on = !this.on;
    this.show();
    this.stage.invalidate();
  }

  private show(): void {
    const placed = isPlaced(this.message);
    this.button.setAttribute("aria-pressed", String(placed && this.on));
    this.button.title = this.message ? backdropInWords(this.message) : "";
  }
}
