// SPDX-License-Identifier: Apache-2.0
// Framing in the picture of the film camera: a click says where in it the subject is to be, a drawn
// box also how large.
import { isObject } from "../state/document";
import { entries, filmOf } from "../state/film";
import type { Patch } from "../state/types";
import { clamp } from "../state/vector";
import type { Studio } from "../studio";
import { byId } from "./dom";

const STILL = 5;     // px

// The subject that is filmed at a time.
export function filmedAt(studio: Studio, time: number): number {
  const film = filmOf(studio.document);
  if (film.subjects.length < 2) return film.subjects.length - 1;
  let name: string | null = null;
  for (const keyframe of film.keyframes) {
    if (keyframe.time <= time + 1e-6 && keyframe.subject) name = keyframe.subject;
  }
  return Math.max(0, film.subjects.findIndex((s) => s.name === name));
}

export function wireFraming(studio: Studio): void {
  const picture = byId("picture");
  const box = byId("framing-box");
  studio.on(["look"], () => {
    picture.classList.toggle("framing", studio.framing);
    picture.title = studio.framing
      ? "Click where the subject is to be in the picture, or draw a box for its size" : "";
  });
  picture.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !studio.editable || !studio.framing) return;
    const index = filmedAt(studio, studio.time);
    const subject = entries(studio.document, "subjects")[index];
    if (!isObject(subject)) return;
    const rect = picture.getBoundingClientRect();
    const at = (e: PointerEvent): [number, number] => [
      clamp((e.clientX - rect.left) / rect.width, 0, 1),
      clamp((e.clientY - rect.top) / rect.height, 0, 1)];
    const start = at(event);
    let now = start, drawn = false;
    picture.setPointerCapture(event.pointerId);
    const move = (e: PointerEvent): void => {
      now = at(e);
      drawn ||= Math.hypot(e.clientX - event.clientX, e.clientY - event.clientY) > STILL;
      box.hidden = !drawn;
      box.style.left = `${100 * Math.min(start[0], now[0])}%`;
      box.style.top = `${100 * Math.min(start[1], now[1])}%`;
      box.style.width = `${100 * Math.abs(start[0] - now[0])}%`;
      box.style.height = `${100 * Math.abs(start[1] - now[1])}%`;
    };
    const up = (): void => {
      picture.removeEventListener("pointermove", move);
      picture.removeEventListener("pointerup", up);
      picture.removeEventListener("pointercancel", up);
      box.hidden = true;
      const round = (v: number): number => Math.round(v * 100) / 100;
      const path = `subjects[${index + 1}]`;
      const place = drawn ? [(start[0] + now[0]) / 2, (start[1] + now[1]) / 2] : start;
      const patch: Patch = [{ path: `${path}.place`, value: place.map(round) }];
      const size = round(Math.abs(start[1] - now[1]));
      if (drawn && size > 0.01) patch.push({ path: `${path}.size`, value: size });
      studio.edit({ label: "Place the subject in the picture", patch });
    };
    picture.addEventListener("pointermove", move);
    picture.addEventListener("pointerup", up);
    picture.addEventListener("pointercancel", up);
  });
}
