// SPDX-License-Identifier: Apache-2.0
// A keyframe of what one sees: where the eye is, and what it looks at.
import * as THREE from "three";
import { appended, inserted } from "../state/edits";
import { subjectAt } from "../state/film";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Pick } from "./pick";
import type { Stage } from "./stage";

const AHEAD = 10;          // m, where nothing is looked at
const CENTRED = 0.12;      // rad between the view and a subject that it means
const FREE = 0.3;          // s from every keyframe, for one between them

export function keyframeHere(studio: Studio, stage: Stage, pick: Pick): void {
  if (studio.map) {
    studio.session.note("The map has no camera position. Press E to leave the map, then add the keyframe.");
    return;
  }
  const eye = stage.worldCamera.position;
  const position: Vec3 = [eye.x, eye.y, eye.z];
  const look = lookedAtFrom(studio, stage, pick);
  const { time, film } = studio;
  const between = time > FREE && time < studio.duration - FREE &&
    film.keyframes.every((k) => Math.abs(k.time - time) > FREE);
  const made = between ? inserted(studio.document, time, position, look)
    : appended(studio.document, position, look);
  if (!studio.edit(made)) return;
  studio.select({ kind: "keyframe", index: made.index });
  const at = studio.film.keyframes[made.index]?.time;
  if (at !== undefined) studio.seek(at);
}

// The point in the middle of the view; null where that is the subject that is filmed anyway.
function lookedAtFrom(studio: Studio, stage: Stage, pick: Pick): Vec3 | null {
  const camera = stage.worldCamera;
  const forward = camera.getWorldDirection(new THREE.Vector3());
  for (const subject of studio.film.subjects) {
    const at = new THREE.Vector3(...subjectAt(subject, studio.time)).sub(camera.position);
    const size = Math.atan2(Math.max(subject.width ?? 0, subject.height ?? 0) / 2, at.length());
    if (at.angleTo(forward) < Math.max(CENTRED, size) && studio.film.subjects.length === 1) return null;
  }
  const rect = stage.world.getBoundingClientRect();
  const hit = pick.surfaceAt({ clientX: rect.left + rect.width / 2,
                               clientY: rect.top + rect.height / 2 });
  if (hit) return hit;
  const far = camera.position.clone().addScaledVector(forward, AHEAD);
  return [far.x, far.y, far.z];
}
