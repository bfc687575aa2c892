// SPDX-License-Identifier: Apache-2.0
// A race that is flown by hand: everyone's vehicle, the ghost of the game before, and a view from
// behind each of the first two who fly by hand.
import * as THREE from "three";
import { placeOf, type Game, type Track } from "../state/game";
import { pathOf } from "../state/samples";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Stage } from "./stage";

const ARM = 0.35;                         // m, of the drawn vehicle
const BEHIND = 5, ABOVE = 1.6, AHEAD = 4; // m, of the eye
const EASE = 6;                           // 1/s, of the eye's heading

export class RaceView {
  private readonly group = new THREE.Group();
  private readonly ghost: THREE.Group;
  private readonly drones: THREE.Group[] = [];
  private readonly second = new THREE.PerspectiveCamera(70, 1, 0.1, 4000);
  private headings: number[] = [];
  private before: { position: THREE.Vector3; quaternion: THREE.Quaternion; fov: number } | null = null;
  private last = 0;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    this.ghost = drone("#9aa4ad", true);
    this.group.add(this.ghost);
    this.group.visible = false;
    this.second.up.set(0, 0, 1);
    this.second.layers.enable(1);
    stage.tools.add(this.group);
  }

  // The colour of a player, in the world and in the list.
  static colourOf(player: number): string {
    return (["#e4572e", "#2e86e4", "#8a5cd6", "#1f9d6b", "#c9a227", "#d6579b", "#4aa3a2",
             "#7a7a7a"] as const)[player % 8] as string;
  }

  begin(): void {
    const camera = this.stage.worldCamera;
    this.before ??= { position: camera.position.clone(), quaternion: camera.quaternion.clone(),
                      fov: camera.fov };
    this.headings = [];
    this.last = 0;
    this.group.visible = true;
    this.stage.pictured = false;
    camera.fov = 70;
    camera.updateProjectionMatrix();
  }

  end(): void {
    this.group.visible = false;
    this.stage.pictured = true;
    this.stage.split(null);
    const camera = this.stage.worldCamera;
    if (this.before) {
      camera.position.copy(this.before.position);
      camera.quaternion.copy(this.before.quaternion);
      camera.fov = this.before.fov;
      camera.updateProjectionMatrix();
    }
    this.before = null;
    this.stage.invalidate();
  }

  show(game: Game, ghost: Track | null, now: number): void {
    const { state } = game;
    if (!state) return;
    const seconds = this.last > 0 ? Math.min(0.1, (now - this.last) / 1000) : 0;
    this.last = now;
    state.players.forEach((player, k) => {
      let body = this.drones[k];
      if (!body) {
        body = this.drones[k] = drone(RaceView.colourOf(k), false);
        this.group.add(body);
      }
      body.visible = true;
      const [w, x, y, z] = player.orientation;
      body.position.set(...player.position);
      body.quaternion.set(x, y, z, w);
    });
    for (const body of this.drones.slice(state.players.length)) body.visible = false;
    const place = ghost && placeOf(ghost, state.time);
    this.ghost.visible = place !== null;
    if (place) this.ghost.position.set(...place);
    const flown = state.players.filter((player) => player.by_hand).slice(0, 2);
    this.stage.split(flown.length > 1 ? this.second : null);
    flown.forEach((player, k) => {
      const camera = k === 0 ? this.stage.worldCamera : this.second;
      const wanted = this.course(player.progress) ?? this.headings[k] ?? 0;
      const had = this.headings[k] ?? wanted;
      const turn = Math.atan2(Math.sin(wanted - had), Math.cos(wanted - had));
      const heading = had + turn * Math.min(1, EASE * seconds);
      this.headings[k] = heading;
      const [east, north] = [Math.cos(heading), Math.sin(heading)];
      const [px, py, pz] = player.position;
      camera.position.set(px - BEHIND * east, py - BEHIND * north, pz + ABOVE);
      camera.lookAt(px + AHEAD * east, py + AHEAD * north, pz);
    });
    this.stage.drawNow();
  }

  // Where the course leads there, from east; null where it stands still.
  private course(progress: number): number | null {
    const { columns } = this.studio.plan;
    const { time } = columns;
    const path = pathOf(columns);
    let at = time.findIndex((t) => t >= progress);
    if (at < 0) at = time.length - 1;
    const from = path[Math.max(0, at - 1)] as Vec3 | undefined, to = path[at] as Vec3 | undefined;
    if (!from || !to || Math.hypot(to[0] - from[0], to[1] - from[1]) < 1e-3) return null;
    return Math.atan2(to[1] - from[1], to[0] - from[0]);
  }
}

function drone(colour: string, faint: boolean): THREE.Group {
  const material = new THREE.MeshBasicMaterial(
    { color: colour, transparent: faint, opacity: faint ? 0.45 : 1 });
  const body = new THREE.Group();
  body.add(new THREE.Mesh(new THREE.BoxGeometry(0.32, 0.16, 0.1), material));
  for (const [x, y] of [[1, 1], [1, -1], [-1, 1], [-1, -1]] as const) {
    const rotor = new THREE.Mesh(new THREE.CylinderGeometry(0.17, 0.17, 0.03, 12), material);
    rotor.rotation.x = Math.PI / 2;
    rotor.position.set(x * ARM * 0.7, y * ARM * 0.7, 0.06);
    const arm = new THREE.Mesh(new THREE.BoxGeometry(ARM, 0.04, 0.03), material);
    arm.position.set(x * ARM * 0.35, y * ARM * 0.35, 0.03);
    arm.rotation.z = Math.atan2(y, x);
    body.add(rotor, arm);
  }
  return body;
}
