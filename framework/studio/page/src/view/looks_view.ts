// SPDX-License-Identifier: Apache-2.0
// A look into a planned scan: a slice of its map, places that were left out, a voxel that was clicked
// at, and the view under the mouse with its motions, its rays and the voxels that it tells of. Into an
// exploration: slices and voxels of its map after the image at the play head.
import * as THREE from "three";
import { axisNumber, placesIn, reasonColours, sliceCorners, sliceHit, texelsIn, toldIn,
         type Axis, type Places, type Told } from "../state/looks";
import { imagesBy } from "../state/exploration";
import { viewAtTime, viewsOf } from "../state/site";
import { colourOf } from "../state/prediction";
import type { LeftOutAnswer, LeftOutReason, ScanWorld, ServerMessage, SliceAnswer, Vec3, ViewAnswer, VoxelAnswer }
  from "../state/types";
import type { Studio } from "../studio";
import { inReport } from "./report";
import { Ribbon } from "./ribbon";
import type { Stage } from "./stage";

const NEAR = 9;            // px from a view
const STILL = 120;         // ms, before the view under the mouse is asked about
const MOST_RAYS = 400;     // drawn
const SPOT = 7;            // px, of the voxel that was clicked at
const DOT = 5;             // px, of a place that was left out

// A view by its number among the candidates, or among the images of the tour that is shown.
export type Looked = { candidate: number } | { image: number; tour?: number };

export class LooksView {
  slice: SliceAnswer | null = null;
  voxel: VoxelAnswer | null = null;
  view: ViewAnswer | null = null;
  leftOut: LeftOutAnswer | null = null;
  private left: Places | null = null;
  // Of these there are so many that they would cover the others.
  private readonly hidden = new Set<LeftOutReason>(["outside", "thinned"]);
  private readonly asked = new Map<string, string>();     // the newest question of each type
  private wanted: { axis: Axis; at: number } | null = null;
  private waiting = false;                                // for a slice
  private live = false;                                   // of an exploration: it is being planned
  private folder = "";                                    // likewise: of a run
  private voxelOf = -1;                                   // likewise: the image it was asked for
  private hovered = "";
  private held = false;                                   // the view stays when the mouse leaves it
  private timer = 0;
  private readonly plane = new THREE.Mesh(
    new THREE.BufferGeometry(),
    new THREE.MeshBasicMaterial({ transparent: true, side: THREE.DoubleSide, depthWrite: false }));
  private readonly places = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial(
    { size: DOT, sizeAttenuation: false, vertexColors: true }));
  private readonly told = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial(
    { vertexColors: true, depthTest: false, transparent: true, opacity: 0.8 }));
  private readonly rays = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(
    { transparent: true, opacity: 0.3 }));
  private readonly cube = new THREE.LineSegments(
    new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1)),
    new THREE.LineBasicMaterial({ depthTest: false, transparent: true }));
  // So that a small one is seen from far away.
  private readonly spot = new THREE.Points(
    new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(3), 3)),
    new THREE.PointsMaterial({ size: SPOT, sizeAttenuation: false, depthTest: false, transparent: true }));
  private readonly ways = new Ribbon("thin", 3);
  // Something of it has changed.
  onChange: () => void = () => undefined;
  // What is cut away before a slice; null: nothing.
  onCut: (cut: THREE.Plane | null) => void = () => undefined;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    for (const object of [this.plane, this.places, this.told, this.rays, this.cube, this.spot]) {
      object.frustumCulled = false;
      object.visible = false;
      object.renderOrder = 2;
      stage.tools.add(object);
    }
    stage.tools.add(this.ways.mesh);
    stage.onResize((width, height) => this.ways.resize(width, height));
    studio.session.on(({ what, message }) => {
      if (what === "look" && message) this.take(message);
      if (what === "note" && message?.type === "failed") this.failed(message.id);
      if (what === "world") this.forget();
      if (what === "image" && this.live !== (studio.live !== null)) this.begin();
      const judged = message?.type === "answer" && message.edit === null &&
        ["converged", "certified", "rejected"].includes(message.grade);
      if (what === "welcome") this.waiting = false;      // what was asked before is lost
      if (what === "welcome" || (what === "standing" && judged)) this.refresh();
    });
    studio.on(["look"], () => this.paint());
    // What of an exploration is shown, or the map at another image.
    studio.on(["episode"], () => {
      if (this.live !== (studio.live !== null) || this.folder !== (studio.run?.folder ?? "")) this.begin();
    });
    studio.on(["time", "episode"], () => this.follow());
    stage.world.addEventListener("pointermove", (event) => this.hover(event));
    stage.world.addEventListener("pointerleave", () => this.leave());
    stage.before(() => this.cut());
    this.paint();
  }

  private get scan(): ScanWorld | undefined {
    return this.studio.session.world.scan;
  }

  // Whose map is asked about, of an exploration: after how many images, and of which run's folder.
  get explored(): { image: number; folder?: string } | null {
    const { episode, run, time } = this.studio;
    if (!episode || this.scan || inReport) return null;
    const folder = run?.folder.split("/").pop();
    return { image: imagesBy(episode, time), ...(folder ? { folder } : {}) };
  }

  private begin(): void {
    this.live = this.studio.live !== null;
    this.folder = this.studio.run?.folder ?? "";
    this.forget();
    this.refresh();
  }

  // The play head is at another image: the same slice, the same voxel of the map then.
  private follow(): void {
    const { explored, slice, voxel } = this;
    if (!explored) return;
    if (slice && this.wanted && slice.image !== explored.image) this.askSlice(this.wanted);
    if (voxel && voxel.image !== explored.image && this.voxelOf !== explored.image) {
      this.voxelOf = explored.image;
      this.ask({ type: "voxel", position: voxel.middle, ...explored });
    }
  }

  private paint(): void {
    this.ways.paint(this.stage.palette.chosen);
    this.rays.material.color.set(this.stage.palette.chosen);
    this.cube.material.color.set(this.stage.palette.chosen);
    this.spot.material.color.set(this.stage.palette.chosen);
    this.stage.invalidate();
  }

  private changed(): void {
    this.onChange();
    this.stage.invalidate();
  }

  private ask(question: { type: "voxel" | "slice" | "left_out" | "view" } & Record<string, unknown>): void {
    this.asked.set(question.type, this.studio.session.ask({ ...question, id: "" } as never));
  }

  // ---- what is asked ------------------------------------------------------------------------------

  // The voxel that a ray meets: on the slice, where one is drawn, else the first occupied one.
  askVoxel(ray: THREE.Ray): boolean {
    const { explored } = this;
    if (!this.scan && !explored) return false;
    const origin = ray.origin.toArray() as Vec3, direction = ray.direction.toArray() as Vec3;
    const place = this.slice && sliceHit(this.slice, origin, direction);
    this.voxelOf = explored?.image ?? -1;
    this.ask({ type: "voxel", ...(place ? { position: place } : { ray: [...origin, ...direction] }),
               ...explored });
    return place !== null;
  }

  // A slice at a place, m; null: none. The newest is asked for when the one before has come.
  askSlice(wanted: { axis: Axis; at: number } | null): void {
    this.wanted = wanted;
    if (!wanted) {
      this.slice = null;
      this.plane.visible = false;
      this.changed();
      return;
    }
    if (this.waiting) return;
    this.waiting = true;
    this.ask({ type: "slice", ...wanted, ...this.explored });
  }

  askLeftOut(on: boolean): void {
    this.places.visible = false;
    this.leftOut = null;
    if (on) this.ask({ type: "left_out" });
    this.changed();
  }

  // `held`: it stays when the mouse goes elsewhere.
  askView(view: Looked | null, held: boolean): void {
    this.held = held;
    if (view) this.ask({ type: "view", ...view });
    else this.hideView();
  }

  // A click on a view: it stays, and of an image the play head goes there.
  choose(view: Looked): void {
    if ("image" in view) {
      const time = viewsOf(this.scan, view.tour)[view.image]?.time;
      this.studio.play(false);
      if (time !== undefined) this.studio.seek(time);
    }
    this.askView(view, true);
  }

  // The view at the play head.
  askViewNow(): void {
    const { tour } = this.studio.which;
    const views = viewsOf(this.scan, tour), at = viewAtTime(views, this.studio.time);
    if (at >= 0) this.askView({ image: at, ...(tour === undefined ? {} : { tour }) }, true);
  }

  // Whether there was something to drop.
  drop(): boolean {
    if (!this.view && !this.voxel) return false;
    this.voxel = null;
    this.cube.visible = this.spot.visible = false;
    this.hideView();
    return true;
  }

  private hideView(): void {
    this.held = false;
    this.hovered = "";
    this.view = null;
    this.asked.delete("view");
    this.told.visible = this.rays.visible = false;
    this.ways.setRuns([], 1);
    this.changed();
  }

  // Another plan: nothing of the one before holds.
  private forget(): void {
    this.voxel = this.slice = this.leftOut = null;
    this.waiting = false;
    this.asked.clear();
    this.cube.visible = this.spot.visible = this.plane.visible = this.places.visible = false;
    this.hideView();
  }

  private refresh(): void {
    if (this.explored && this.wanted && !this.slice) this.askSlice(this.wanted);
    if (!this.scan) return;
    if (this.studio.look.leftOut && !this.leftOut) this.ask({ type: "left_out" });
    const extent = this.scan.map;
    if (!this.wanted || this.slice || !extent?.lower || !extent.upper) return;
    // Another map may end elsewhere.
    const axis = axisNumber(this.wanted.axis), half = extent.resolution / 2;
    const at = Math.min(Math.max(this.wanted.at, extent.lower[axis] + half), extent.upper[axis] - half);
    this.askSlice({ axis: this.wanted.axis, at });
  }

  private failed(id: string | undefined): void {
    if (id === this.asked.get("slice")) this.waiting = false;
  }

  // ---- what comes -----------------------------------------------------------------------------------

  private take(message: ServerMessage): void {
    if (!("id" in message) || message.id !== this.asked.get(message.type)) return;
    switch (message.type) {
      case "voxel": return this.showVoxel(message);
      case "slice": return this.fetch(message.cells, (buffer) => this.showSlice(message, buffer));
      case "left_out": return this.fetch(message.places, (buffer) => this.showPlaces(message, buffer));
      case "view": return this.fetch(message.told, (buffer) => this.showView(message, toldIn(buffer)));
      default:
    }
  }

  private fetch(name: string, then: (buffer: ArrayBuffer) => void): void {
    fetch(`/blob/${name}`).then((response) => {
      if (!response.ok) throw new Error(`answer ${response.status}`);
      return response.arrayBuffer();
    }).then(then).catch((error: Error) => {
      this.waiting = false;
      this.studio.session.note(`The answer cannot be shown: ${error.message}`);
    });
  }

  private showVoxel(voxel: VoxelAnswer): void {
    this.voxel = voxel;
    this.cube.position.set(...voxel.middle);
    this.cube.scale.setScalar(1.02 * voxel.edge);
    this.spot.position.set(...voxel.middle);
    this.cube.visible = this.spot.visible = true;
    this.changed();
  }

  private showSlice(slice: SliceAnswer, buffer: ArrayBuffer): void {
    this.waiting = false;
    if (!this.wanted) return;
    const { columns, rows, texels } = texelsIn(buffer);
    const corners = sliceCorners(slice);
    this.plane.geometry.dispose();
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(corners.flat()), 3));
    geometry.setAttribute("uv", new THREE.BufferAttribute(Float32Array.from([0, 0, 1, 0, 1, 1, 0, 1]), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.plane.geometry = geometry;
    this.plane.material.map?.dispose();
    const picture = new THREE.DataTexture(texels, columns, rows);
    picture.magFilter = picture.minFilter = THREE.NearestFilter;
    picture.needsUpdate = true;
    this.plane.material.map = picture;
    this.plane.material.needsUpdate = true;
    this.plane.visible = true;
    this.slice = slice;
    this.changed();
    const { wanted } = this;
    // Beyond the map there is its last layer; and the play head may have gone on.
    const at = Math.min(Math.max(wanted.at, slice.extent[0]), slice.extent[1]);
    if (wanted.axis !== slice.axis || Math.abs(at - slice.at) > 0.51 * slice.edge ||
        (slice.image !== undefined && slice.image !== this.explored?.image)) this.askSlice(wanted);
  }

  private showPlaces(answer: LeftOutAnswer, buffer: ArrayBuffer): void {
    if (!this.studio.look.leftOut) return;
    this.leftOut = answer;
    this.left = placesIn(buffer);
    this.drawPlaces();
  }

  // Whether the places of a reason are drawn.
  draws(reason: LeftOutReason): boolean {
    return !this.hidden.has(reason);
  }

  toggle(reason: LeftOutReason): void {
    if (!this.hidden.delete(reason)) this.hidden.add(reason);
    this.drawPlaces();
  }

  private drawPlaces(): void {
    const { leftOut, left } = this;
    if (!leftOut || !left) return;
    const places: number[] = [], colours: number[] = [];
    left.numbers.forEach((number, k) => {
      const reason = leftOut.reasons[number]?.reason;
      if (!reason || !this.draws(reason)) return;
      places.push(...left.positions.subarray(3 * k, 3 * k + 3));
      colours.push(...reasonColours[reason]);
    });
    this.places.geometry.dispose();
    this.places.geometry = new THREE.BufferGeometry();
    this.places.geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(places), 3));
    this.places.geometry.setAttribute("color", new THREE.BufferAttribute(Uint8Array.from(colours), 3, true));
    this.places.visible = true;
    this.changed();
  }

  // Places that are drawn.
  get drawnPlaces(): number {
    return this.places.visible ? this.places.geometry.getAttribute("position").count : 0;
  }

  private showView(view: ViewAnswer, { edge, middles, shares }: Told): void {
    if (this.asked.get("view") !== view.id) return;
    this.view = view;
    const colours = new Uint8Array(middles.length);
    shares.forEach((share, k) => colours.set(colourOf(share), 3 * k));
    this.told.geometry.dispose();
    this.told.geometry = new THREE.BufferGeometry();
    this.told.geometry.setAttribute("position", new THREE.BufferAttribute(middles, 3));
    this.told.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3, true));
    this.told.material.size = edge;
    // Some of the rays: all of them would be a solid.
    const every = Math.max(1, Math.ceil(shares.length / MOST_RAYS)), ends: number[] = [];
    for (let k = 0; k < shares.length; k += every) {
      ends.push(...view.position, ...middles.subarray(3 * k, 3 * k + 3));
    }
    this.rays.geometry.dispose();
    this.rays.geometry = new THREE.BufferGeometry();
    this.rays.geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(ends), 3));
    this.ways.setRuns(view.ways.map(({ points }) => points), 1);
    this.told.visible = this.rays.visible = true;
    this.changed();
  }

  // What is between the eye and the slice is cut away.
  private cut(): void {
    const { slice } = this;
    if (!slice || !this.plane.visible) return this.onCut(null);
    const axis = axisNumber(slice.axis);
    const normal = new THREE.Vector3().setComponent(axis, 1);
    const beyond = slice.axis === "z" || this.stage.worldCamera.position.getComponent(axis) > slice.at;
    const keep = beyond ? -1 : 1;
    this.onCut(new THREE.Plane(normal.multiplyScalar(keep), -keep * slice.at));
  }

  // ---- the mouse --------------------------------------------------------------------------------------

  // The candidate or view under a place of the page; null where there is none that is drawn.
  viewAt(clientX: number, clientY: number): Looked | null {
    const { scan, studio, stage } = this;
    if (!scan || studio.mode !== "orbit") return null;
    const rect = stage.world.getBoundingClientRect();
    const x = clientX - rect.left, y = clientY - rect.top;
    let best = NEAR;
    let found: Looked | null = null;
    const near = (place: Vec3): boolean => {
      const at = stage.onScreen(place);
      const away = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
      if (away >= best) return false;
      best = away;
      return true;
    };
    const { tour } = studio.which;
    if (studio.look.views) {
      viewsOf(scan, tour).forEach(({ position }, image) => {
        if (near(position)) found = { image, ...(tour === undefined ? {} : { tour }) };
      });
    }
    if (studio.look.candidates && !found) {
      scan.candidates.forEach((place, candidate) => { if (near(place)) found = { candidate }; });
    }
    return found;
  }

  private hover(event: PointerEvent): void {
    window.clearTimeout(this.timer);
    if (event.buttons !== 0 || this.held) return;
    const found = this.viewAt(event.clientX, event.clientY);
    const name = found ? JSON.stringify(found) : "";
    if (name === this.hovered) return;
    this.timer = window.setTimeout(() => {
      if (found) {
        this.hovered = name;
        this.askView(found, false);
      } else this.hideView();
    }, STILL);
  }

  private leave(): void {
    window.clearTimeout(this.timer);
    if (!this.held && this.hovered) this.hideView();
  }
}
