// SPDX-License-Identifier: Apache-2.0
// Moving through the world: around what is looked at, or as the film camera itself.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { axesOf, defaultOptics } from "../state/camera";
import { viewAt } from "../state/samples";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { typing } from "./dom";
import { DEFAULT_FOV, type Stage } from "./stage";

const SPEED = 8;          // m/s of the virtual camera
const TURN = 1.1;         // rad/s by the arrows
const MOUSE = 0.0035;     // rad per pixel
const STICK = 1.4;        // rad/s by a stick of a gamepad
const SLACK = 0.15;       // of a stick, that counts as its middle
const FILLED = 0.85;      // of the view by a film that is shown whole
const OUTGROWN = 3;       // of the film's extent against what is shown, to show it whole again
const MAP_FOV = 0.1;      // degrees: 30 m of height lean by 2.6 cm at the upper and lower edge
const NEARBY = 25;        // m
const held = ["w", "a", "s", "d", "q", "e", "arrowleft", "arrowright", "arrowup", "arrowdown"];

export class Navigation {
  readonly orbit: OrbitControls;
  private readonly keys = new Set<string>();
  private yaw = 0;
  private pitch = 0;
  private last = 0;
  private running = false;
  // What a gamepad's buttons ask for while the camera is flown.
  onButton: (button: "keyframe" | "leave") => void = () => undefined;
  private pressed = new Set<number>();
  private whole = 0;      // m, the extent of what was shown whole last
  private before: { position: THREE.Vector3; fov: number } | null = null;

  private above: { position: THREE.Vector3 } | null = null;   // while the map is shown

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    this.orbit = new OrbitControls(stage.worldCamera, stage.world);
    this.orbit.enableDamping = false;
    this.orbit.target.set(0, 0, 3);
    this.orbit.maxPolarAngle = Math.PI * 0.52;
    this.orbit.minDistance = 1;
    this.orbit.maxDistance = 1500;       // more where the film is larger
    this.orbit.addEventListener("change", () => {
      if (this.above) stage.reachAround(stage.worldCamera.position.distanceTo(this.orbit.target));
      stage.moved();
    });
    studio.on(["mode"], () => this.switch());
    studio.on(["look"], () => this.map(studio.map));
    window.addEventListener("gamepadconnected", () => {
      if (studio.mode === "camera") this.run();
      else studio.session.note("A gamepad: press V, and fly the camera with it.");
    });
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("keyup", (event) => this.keys.delete(event.key.toLowerCase()));
    window.addEventListener("blur", () => this.keys.clear());
    stage.world.addEventListener("pointermove", (event) => {
      if (studio.mode !== "camera" || !(event.buttons & 1)) return;
      this.yaw -= event.movementX * MOUSE;
      this.turn(-event.movementY * MOUSE);
      this.apply();
    });
    stage.world.addEventListener("wheel", (event) => {
      if (studio.mode !== "camera") return;
      this.step([0, 0, 0], -event.deltaY * 0.01);
      this.apply();
    }, { passive: true });
  }

  private turn(by: number): void {
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + by));
  }

  // Everything of the film in the view, seen from the south-west and above.
  frame(box: THREE.Box3): void {
    const above = this.above !== null;
    if (above) this.map(false);
    this.showWhole(box);
    if (above) this.map(true);
  }

  private showWhole(box: THREE.Box3): void {
    const shown = box.isEmpty()
      ? new THREE.Box3(new THREE.Vector3(-10, -10, 0), new THREE.Vector3(10, 10, 5))
      : box.clone().expandByScalar(0.5);
    this.whole = shown.getSize(new THREE.Vector3()).length();
    const center = shown.getCenter(new THREE.Vector3());
    const camera = this.stage.worldCamera;
    const away = new THREE.Vector3(-0.55, -0.75, 0.6).normalize();
    const high = Math.tan((camera.fov * Math.PI) / 360) * FILLED, across = high * camera.aspect;
    const up = new THREE.Vector3(0, 0, 1).addScaledVector(away, -away.z).normalize();
    const right = new THREE.Vector3().crossVectors(up, away);
    // As far away as the corner that needs most.
    let distance = 3;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(
        corner & 1 ? shown.max.x : shown.min.x, corner & 2 ? shown.max.y : shown.min.y,
        corner & 4 ? shown.max.z : shown.min.z).sub(center);
      distance = Math.max(distance, p.dot(away) + Math.abs(p.dot(right)) / across,
                          p.dot(away) + Math.abs(p.dot(up)) / high);
    }
    this.orbit.maxDistance = Math.max(1500, 2 * distance);
    this.stage.reach(3 * distance + shown.getSize(new THREE.Vector3()).length());
    camera.position.copy(center).addScaledVector(away, distance);
    this.orbit.target.copy(center);
    this.orbit.update();
    this.stage.invalidate();
  }

  // The same place from straight above, north up, through so long a lens that there is no
  // perspective to be seen; a drag moves. Or back to where it was.
  map(on: boolean): void {
    const camera = this.stage.worldCamera;
    if (on === (this.above !== null)) return;
    const { target } = this.orbit;
    const wide = Math.tan((DEFAULT_FOV * Math.PI) / 360), far = Math.tan((MAP_FOV * Math.PI) / 360);
    if (on) {
      this.above = { position: camera.position.clone().sub(target) };
      const away = Math.max(camera.position.distanceTo(target), 10) * (wide / far);
      camera.fov = MAP_FOV;
      camera.position.set(target.x, target.y - 1e-4 * away, target.z + away);
      this.orbit.minDistance *= wide / far;
      this.orbit.maxDistance *= wide / far;
      this.stage.reachAround(away);
    } else if (this.above) {
      const away = camera.position.distanceTo(target) * (far / wide);
      camera.fov = DEFAULT_FOV;
      camera.position.copy(target).addScaledVector(this.above.position.normalize(), away);
      this.orbit.minDistance *= far / wide;
      this.orbit.maxDistance *= far / wide;
      this.stage.reach(Math.max(4000, 4 * away));
      this.above = null;
    }
    this.orbit.enableRotate = !on;
    this.orbit.mouseButtons.LEFT = on ? THREE.MOUSE.PAN : THREE.MOUSE.ROTATE;
    this.orbit.screenSpacePanning = true;
    camera.updateProjectionMatrix();
    this.orbit.update();
    this.stage.invalidate();
  }

  // A place in the middle of the view, from nearby.
  lookAt(place: Vec3): void {
    const camera = this.stage.worldCamera;
    const away = camera.position.clone().sub(this.orbit.target);
    if (!this.above) away.setLength(Math.min(away.length(), NEARBY));
    this.orbit.target.set(...place);
    camera.position.copy(this.orbit.target).add(away);
    this.orbit.update();
    this.stage.invalidate();
  }

  // After an edit: a film that left the view, or became small in it, is shown whole again, and what
  // is far away stays drawn.
  follow(box: THREE.Box3): void {
    if (box.isEmpty()) return;
    const size = box.getSize(new THREE.Vector3()).length() + 1;
    const grown = size > OUTGROWN * this.whole || OUTGROWN * size < this.whole;
    if (grown && this.studio.mode === "orbit") return this.frame(box);
    if (this.above) return;
    const eye = this.stage.worldCamera.position;
    const farthest = eye.distanceTo(box.getCenter(new THREE.Vector3())) + size;
    if (farthest > this.stage.worldCamera.far) this.stage.reach(1.5 * farthest);
  }

  private switch(): void {
    const camera = this.stage.worldCamera;
    const flying = this.studio.mode === "camera";
    this.orbit.enabled = !flying && this.studio.mode !== "race";
    this.keys.clear();
    if (flying && !this.before) {
      this.before = { position: camera.position.clone(), fov: camera.fov };
      const view = viewAt(this.studio.plan.columns, this.studio.time);
      const optics = this.studio.plan.camera ?? defaultOptics;
      camera.fov = (2 * Math.atan(optics.height / 2 / optics.fy) * 180) / Math.PI;
      camera.updateProjectionMatrix();
      if (view) {
        camera.position.set(...view.position);
        this.yaw = Math.atan2(view.forward[1], view.forward[0]);
        this.pitch = Math.asin(Math.min(1, Math.max(-1, view.forward[2])));
      } else {
        const d = camera.getWorldDirection(new THREE.Vector3());
        this.yaw = Math.atan2(d.y, d.x);
        this.pitch = Math.asin(d.z);
      }
      this.apply();
      if (this.sticks()) this.run();
    } else if (!flying && this.before) {
      camera.fov = this.before.fov;
      camera.position.copy(this.before.position);
      camera.updateProjectionMatrix();
      this.before = null;
      this.orbit.update();
      this.stage.invalidate();
    }
  }

  private press(event: KeyboardEvent): void {
    const key = event.key.toLowerCase();
    if (this.studio.mode !== "camera" || !held.includes(key)) return;
    if (typing(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.keys.add(key);
    this.run();
  }

  private run(): void {
    if (this.running) return;
    this.running = true;
    this.last = performance.now();
    requestAnimationFrame(this.tick);
  }

  // Sticks of the first gamepad with a standard layout: to the right, forward, up; and what it turns.
  private sticks(): { move: Vec3; turn: [number, number] } | null {
    const pad = navigator.getGamepads?.().find((one) => one?.connected && one.axes.length >= 4);
    if (!pad) return null;
    const axis = (i: number): number => {
      const value = pad.axes[i] ?? 0;
      return Math.abs(value) < SLACK ? 0 : (value - Math.sign(value) * SLACK) / (1 - SLACK);
    };
    const button = (i: number): number => pad.buttons[i]?.value ?? 0;
    for (const [i, what] of [[0, "keyframe"], [1, "leave"]] as const) {
      const down = button(i) > 0.5;
      if (down && !this.pressed.has(i)) this.onButton(what);
      if (down) this.pressed.add(i);
      else this.pressed.delete(i);
    }
    return { move: [axis(0), -axis(1), button(7) - button(6)], turn: [-axis(2), -axis(3)] };
  }

  private readonly tick = (now: number): void => {
    const seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    const sticks = this.studio.mode === "camera" ? this.sticks() : null;
    // Asked for again: a button may have left the mode.
    if ((this.keys.size === 0 && !sticks) || this.studio.mode !== "camera") {
      this.running = false;
      return;
    }
    if (sticks && [...sticks.move, ...sticks.turn].some((v) => v !== 0)) {
      this.yaw += sticks.turn[0] * STICK * seconds;
      this.turn(sticks.turn[1] * STICK * seconds);
      const [right, forward, up] = sticks.move.map((v) => v * SPEED * seconds) as Vec3;
      this.step([right, 0, up], forward);
      this.apply();
    }
    if (this.keys.size === 0) {
      requestAnimationFrame(this.tick);
      return;
    }
    const on = (key: string): number => (this.keys.has(key) ? 1 : 0);
    this.yaw += (on("arrowleft") - on("arrowright")) * TURN * seconds;
    this.turn((on("arrowup") - on("arrowdown")) * TURN * seconds);
    const metres = SPEED * seconds;
    this.step([(on("d") - on("a")) * metres, 0, (on("e") - on("q")) * metres],
              (on("w") - on("s")) * metres);
    this.apply();
    requestAnimationFrame(this.tick);
  };

  // To the right and up in m, and forward.
  private step(by: Vec3, forward: number): void {
    const axes = axesOf(this.yaw, this.pitch);
    const p = this.stage.worldCamera.position;
    p.x += axes.right[0] * by[0] + axes.forward[0] * forward;
    p.y += axes.right[1] * by[0] + axes.forward[1] * forward;
    p.z += by[2] + axes.forward[2] * forward;
  }

  private apply(): void {
    const camera = this.stage.worldCamera;
    const { forward } = axesOf(this.yaw, this.pitch);
    camera.lookAt(camera.position.x + forward[0], camera.position.y + forward[1],
                  camera.position.z + forward[2]);
    this.stage.moved();
  }
}
