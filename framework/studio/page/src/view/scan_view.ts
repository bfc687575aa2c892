// SPDX-License-Identifier: Apache-2.0
// What a scan was planned on and what it will show: region, views, candidates, first flight, and the
// surface in the colours of what the images will show of it.
import * as THREE from "three";
import { colourOf, figuresInWords, predictionIn, shadeOf, type Prediction } from "../state/prediction";
import { baked, cutMaterial } from "./solids";
import { footprintRuns } from "../state/first_flight";
import { pathOf } from "../state/samples";
import { frustum, isSite, prismLines, regionsOf, viewAtTime, viewsOf } from "../state/site";
import type { ScanWorld, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { Lighter } from "./lighter";
import { Ribbon } from "./ribbon";
import { WORLD } from "./solids";
import { blob } from "./blobs";
import type { Stage } from "./stage";

const DEEP = 0.04;         // of the region's extent, of a view's frustum
const POINT = 3;           // px

export class ScanView {
  private readonly region = new Ribbon("solid", 2);
  private readonly views = new Ribbon("thin", 3);
  private readonly first = new Ribbon("dotted", 2);
  private readonly footprints = new Ribbon("thin", 2);
  private readonly now = new Ribbon("solid", 3);     // the view at the play head
  private readonly others = new Ribbon("thin", 2);   // tours beside the one that is shown
  private readonly candidates = new THREE.Points(
    new THREE.BufferGeometry(),
    new THREE.PointsMaterial({ size: POINT, sizeAttenuation: false, vertexColors: true }));
  private readonly surface = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({
    vertexColors: true, side: THREE.DoubleSide }));
  private light: Float32Array = new Float32Array();
  private prediction: Prediction | null = null;
  private fetched = "";
  private pointsOf: Vec3[] | null = null;
  // The surface has come, or is gone.
  onSurface: () => void = () => undefined;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    for (const ribbon of [this.region, this.views, this.first, this.footprints, this.others, this.now]) {
      stage.tools.add(ribbon.mesh);
      stage.onResize((width, height) => ribbon.resize(width, height));
    }
    this.candidates.frustumCulled = this.surface.frustumCulled = false;
    this.candidates.visible = this.surface.visible = false;
    stage.tools.add(this.candidates);
    this.surface.layers.set(WORLD);
    stage.scene.add(this.surface);
    new Lighter(stage, this.surface);
    studio.on(["document", "world", "look"], () => this.draw());
    studio.on(["world", "look", "draft"], () => this.drawFootprints());
    studio.on(["look"], () => this.paint());
    studio.on(["standing"], () => this.drawTours());
    studio.on(["standing", "world", "time", "look"], () => this.drawNow());
    this.paint();
  }

  // Whether the surface is drawn, which hides what else is known of it.
  get covers(): boolean {
    return this.surface.visible;
  }

  get triangles(): number {
    return this.prediction ? this.prediction.triangles.length / 3 : 0;
  }

  bounds(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const prism of this.scan?.region ?? []) {
      for (const [x, y] of prism.corners) {
        box.expandByPoint(new THREE.Vector3(x, y, prism.low));
        box.expandByPoint(new THREE.Vector3(x, y, prism.high));
      }
    }
    return box;
  }

  // What is cut away of the surface; null: nothing.
  cutBy(plane: THREE.Plane | null): void {
    cutMaterial(this.surface.material, plane);
  }

  // The nearest triangle of the surface on a ray, in words.
  wordsAt(ray: THREE.Ray): string | null {
    if (!this.prediction || !this.surface.visible) return null;
    const caster = new THREE.Raycaster(ray.origin, ray.direction);
    caster.layers.set(WORLD);
    const [hit] = caster.intersectObject(this.surface);
    return hit?.faceIndex == null ? null : figuresInWords(this.prediction, hit.faceIndex);
  }

  private get scan(): ScanWorld | undefined {
    return this.studio.session.world.scan;
  }

  private paint(): void {
    const { palette } = this.stage;
    this.region.paint(palette.chosen);
    this.views.paint(palette.ink, 0.8);
    this.first.paint(palette.step);
    this.footprints.paint(palette.guess, 0.6);
    this.others.paint(palette.converged, 0.7);
    this.now.paint(palette.chosen);
    this.tint();
    this.stage.invalidate();
  }

  private draw(): void {
    const { scan, studio } = this;
    const site = isSite(studio.document);
    this.region.setRuns(site ? regionsOf(studio.document, scan).flatMap(prismLines) : [], 1);
    const { look } = studio;
    const size = this.bounds().getSize(new THREE.Vector3()).length();
    this.views.setRuns(scan && look.views ? scan.views.flatMap((view) =>
      frustum(view.position, view.yaw, view.pitch, scan.image, DEEP * size)) : [], 1);
    this.first.setRuns(scan && look.first && scan.first_views.length > 1 ? [scan.first_views] : [], 1);
    this.candidates.visible = look.candidates && (scan?.candidates.length ?? 0) > 0;
    if (scan && this.candidates.visible && this.pointsOf !== scan.candidates) {
      this.pointsOf = scan.candidates;
      this.candidates.geometry.dispose();
      this.candidates.geometry = new THREE.BufferGeometry();
      this.candidates.geometry.setAttribute("position", new THREE.BufferAttribute(
        Float32Array.from(scan.candidates.flat()), 3));
      // By what each shows by itself, from little (violet) to most (yellow).
      const scores = scan.candidate_scores ?? [];
      const most = scores.reduce((m, v) => Math.max(m, v), 1e-9);
      this.candidates.geometry.setAttribute("color", new THREE.BufferAttribute(
        Uint8Array.from(scan.candidates.flatMap((_, k) => colourOf((scores[k] ?? 0) / most))), 3, true));
    }
    this.fetch(scan?.surface ?? "");
    this.stage.invalidate();
  }

  // Of a flight that is being edited they are always drawn.
  private drawFootprints(): void {
    const { look, session } = this.studio;
    const draft = session.firstFlight;
    const runs = draft || look.first ? footprintRuns(draft, this.scan) : [];
    this.drawn = runs.length;
    this.footprints.setRuns(runs, 1);
    this.stage.invalidate();
  }

  // Footprints of the first flight that are drawn.
  drawn = 0;

  private drawNow(): void {
    const { scan, studio } = this;
    const views = viewsOf(scan, studio.which.tour);
    const view = views[viewAtTime(views, studio.time)];
    const size = this.bounds().getSize(new THREE.Vector3()).length();
    this.now.setRuns(scan && view && studio.look.views
      ? frustum(view.position, view.yaw, view.pitch, scan.image, 1.5 * DEEP * size) : [], 1);
    this.stage.invalidate();
  }

  private drawTours(): void {
    const { tours } = this.studio.session.standing();
    const shown = this.studio.which.tour;
    this.others.setRuns(tours.flatMap(({ plan }, k) =>
      (plan && k !== shown ? [pathOf(plan.columns)] : [])), 1);
    this.stage.invalidate();
  }

  private fetch(name: string): void {
    if (name === this.fetched) return;
    this.fetched = name;
    if (!name) {
      this.prediction = null;
      this.surface.visible = false;
      this.onSurface();
      return;
    }
    blob(name).then((buffer) => {
      if (this.fetched === name) this.take(predictionIn(buffer));
    }).catch((error: Error) => {
      if (this.fetched !== name) return;
      this.fetched = "";
      this.studio.session.note(`The surface cannot be shown: ${error.message}`);
    });
  }

  private take(prediction: Prediction): void {
    this.prediction = prediction;
    const { place, shade } = baked(prediction);
    this.light = shade;
    this.surface.geometry.dispose();
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
    geometry.setAttribute("color",
                          new THREE.BufferAttribute(new Uint8Array(place.length), 3, true));
    this.surface.geometry = geometry;
    this.surface.visible = true;
    this.tint();
    this.onSurface();
    this.stage.invalidate();
  }

  private tint(): void {
    const { prediction } = this;
    const color = this.surface.geometry.getAttribute("color") as THREE.BufferAttribute | undefined;
    if (!prediction || !color) return;
    const tint = color.array as Uint8Array;
    for (let t = 0; t < this.light.length; ++t) {
      const shade = shadeOf(prediction, this.studio.look.figure, t);
      const light = Math.min(1, 0.35 + 0.65 * (this.light[t] as number));
      for (let c = 0; c < 9; ++c) tint[9 * t + c] = (shade[c % 3] as number) * light;
    }
    color.needsUpdate = true;
  }
}
