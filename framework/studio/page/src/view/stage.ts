// SPDX-License-Identifier: Apache-2.0
// One canvas behind the page, drawn through two openings: the world, and the picture of the
// film camera. A frame is drawn when something has changed, never otherwise.
import * as THREE from "three";
import { colour } from "./dom";

THREE.ColorManagement.enabled = false;

const FARTHEST = 30000;   // m
export const DEFAULT_FOV = 55;   // degrees
const STILL = 250;    // ms without a move, after which all is drawn in full

// Colours as they are written, no curves: what the style sheet says is what is seen.
export interface Palette {
  sky: string;
  ground: string;
  grid: string;
  solid: string;
  closed: string;
  subject: string;
  chosen: string;
  ink: string;
  flown: string;
  fail: string;
  guess: string;
  step: string;
  converged: string;
  certified: string;
}

export class Stage {
  readonly scene = new THREE.Scene();
  readonly tools = new THREE.Group();         // drawn in the world alone
  readonly worldCamera = new THREE.PerspectiveCamera(DEFAULT_FOV, 1, 0.3, 4000);
  readonly filmCamera = new THREE.PerspectiveCamera(62, 16 / 9, 0.1, 5000);
  palette: Palette;
  frameMs = 0;                                // of the last frame, drawn to its end
  frames = 0;
  private readonly renderer: THREE.WebGLRenderer;
  private waiting = false;
  private stillness = 0;
  private whole = new DOMRect();      // of the canvas
  private rects: [DOMRect, DOMRect] = [new DOMRect(), new DOMRect()];
  private beforeFrame: (() => void)[] = [];
  private afterFrame: (() => void)[] = [];
  private resized: ((width: number, height: number) => void)[] = [];
  measuring = false;
  private beside: THREE.PerspectiveCamera | null = null;
  moving = false;                             // the eye of the world
  pictured = true;                            // whether the film camera's opening is drawn

  constructor(
    canvas: HTMLCanvasElement, readonly world: HTMLElement, readonly picture: HTMLElement,
  ) {
    this.renderer = new THREE.WebGLRenderer({
      canvas, antialias: !drawnInSoftware(), stencil: false, alpha: false,
    });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.localClippingEnabled = true;
    this.renderer.setScissorTest(true);
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.worldCamera.layers.enable(1);    // WORLD of solids.ts
    this.filmCamera.layers.enable(2);     // PICTURE
    this.worldCamera.up.set(0, 0, 1);
    this.worldCamera.position.set(-28, -34, 24);
    this.worldCamera.lookAt(0, 0, 3);
    this.scene.add(this.tools);
    this.palette = this.readPalette();
    const watch = new ResizeObserver(() => this.resize());
    watch.observe(world);
    watch.observe(picture);
    window.addEventListener("resize", () => this.resize());
    this.resize();
  }

  before(then: () => void): void {
    this.beforeFrame.push(then);
  }

  // Once, after the next frame.
  once(then: () => void): void {
    this.afterFrame.push(then);
  }

  onResize(then: (width: number, height: number) => void): void {
    this.resized.push(then);
    const { width, height } = this.world.getBoundingClientRect();
    then(width, height);
  }

  readPalette(): Palette {
    const names = ["sky", "ground", "grid", "solid", "closed", "subject", "chosen", "ink", "flown",
                   "fail", "guess", "step", "converged", "certified"] as const;
    const found = {} as Palette;
    for (const name of names) found[name] = colour(name);
    this.palette = found;
    return found;
  }

  private resize(): void {
    const [world, picture] = this.rects =
      [this.world.getBoundingClientRect(), this.picture.getBoundingClientRect()];
    // No larger than what holds both openings: every pixel costs.
    const left = Math.min(world.left, picture.left), top = Math.min(world.top, picture.top);
    this.whole = new DOMRect(left, top, Math.max(world.right, picture.right) - left,
                             Math.max(world.bottom, picture.bottom) - top);
    this.renderer.setSize(Math.max(1, this.whole.width), Math.max(1, this.whole.height), false);
    const { style } = this.renderer.domElement;
    style.left = `${left}px`;
    style.top = `${top}px`;
    style.width = `${this.whole.width}px`;
    style.height = `${this.whole.height}px`;
    const { width, height } = world;
    for (const camera of [this.worldCamera, this.beside]) {
      if (!camera) continue;
      camera.aspect = (this.beside ? width / 2 : width) / Math.max(height, 1);
      camera.updateProjectionMatrix();
    }
    for (const then of this.resized) then(width, height);
    this.invalidate();
  }

  // The eye moves; a moment later it stands still again.
  moved(): void {
    this.moving = true;
    window.clearTimeout(this.stillness);
    this.stillness = window.setTimeout(() => {
      this.moving = false;
      this.invalidate();
    }, STILL);
    this.invalidate();
  }

  // At once, where every moment counts.
  drawNow(): void {
    this.draw();
  }

  invalidate(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  // The world in two halves, the right one through this camera; null: whole again.
  split(camera: THREE.PerspectiveCamera | null): void {
    if (camera === this.beside) return;
    this.beside = camera;
    this.resize();
  }

  private draw(): void {
    const start = performance.now();
    for (const then of this.beforeFrame) then();
    this.renderer.setClearColor(this.palette.sky);
    this.tools.visible = true;
    const [left, right] = this.halves();
    this.through(left, this.worldCamera);
    if (this.beside) this.through(right, this.beside);
    this.tools.visible = false;
    if (this.pictured) this.through(this.rects[1], this.filmCamera);
    this.tools.visible = true;
    // The drawing itself is done elsewhere; reading a pixel waits for it.
    if (this.measuring) {
      const gl = this.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    this.frameMs = performance.now() - start;
    this.frames += 1;
    for (const then of this.afterFrame.splice(0)) then();
  }

  private halves(): [DOMRect, DOMRect] {
    const [rect] = this.rects;
    if (!this.beside) return [rect, rect];
    const half = rect.width / 2;
    return [new DOMRect(rect.left, rect.top, half, rect.height),
            new DOMRect(rect.left + half, rect.top, half, rect.height)];
  }

  private through(rect: DOMRect, camera: THREE.PerspectiveCamera): void {
    if (rect.width < 1 || rect.height < 1) return;
    const left = rect.left - this.whole.left, bottom = this.whole.bottom - rect.bottom;
    this.renderer.setViewport(left, bottom, rect.width, rect.height);
    this.renderer.setScissor(left, bottom, rect.width, rect.height);
    this.renderer.render(this.scene, camera);
  }

  // So that all within this distance of the eye is drawn, m: near and far ends are in proportion, or
  // what is far would flicker.
  reach(distance: number): void {
    const camera = this.worldCamera;
    camera.far = Math.max(4000, distance);
    camera.near = camera.far / 13000;
    camera.updateProjectionMatrix();
  }

  // What is around a place so far from the eye, half as far before it and behind it.
  reachAround(distance: number): void {
    const camera = this.worldCamera;
    camera.near = distance / 2;
    camera.far = 1.5 * distance;
    camera.updateProjectionMatrix();
  }

  // Where a point of the world is in the opening, in pixels; null when it is behind the eye.
  onScreen(point: readonly [number, number, number]): { x: number; y: number } | null {
    const p = new THREE.Vector3(...point).applyMatrix4(this.worldCamera.matrixWorldInverse);
    if (p.z > -this.worldCamera.near) return null;
    p.applyMatrix4(this.worldCamera.projectionMatrix);
    const { width, height } = this.rects[0];
    return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height };
  }

  // The ray under a place on the page.
  rayAt(clientX: number, clientY: number): THREE.Ray {
    const [rect] = this.rects;
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(
      ((clientX - rect.left) / rect.width) * 2 - 1, 1 - ((clientY - rect.top) / rect.height) * 2),
    this.worldCamera);
    return caster.ray;
  }
}

// How much larger things are through this camera than through the lens that the world begins with.
// THREE.PointsMaterial makes points smaller by distance, but knows no lens.
export const magnified = (camera: THREE.PerspectiveCamera): number =>
  Math.tan((DEFAULT_FOV * Math.PI) / 360) / Math.tan((camera.fov * Math.PI) / 360);

export const level = (height: number): THREE.Plane =>
  new THREE.Plane(new THREE.Vector3(0, 0, 1), -height);

// Where a ray meets a plane. Null if there is no such place, or if it is more than 30 km away
// horizontally. Height does not count: the eye of the map is higher.
export function meeting(ray: THREE.Ray, plane: THREE.Plane): THREE.Vector3 | null {
  const found = ray.intersectPlane(plane, new THREE.Vector3());
  const { x, y } = ray.origin;
  return found && Math.hypot(found.x - x, found.y - y) < FARTHEST ? found : null;
}

// Smooth edges cost a processor most of a frame.
function drawnInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
