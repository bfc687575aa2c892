// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { backTo, figuresOf } from "../src/state/compare";
import { applied, valueAt } from "../src/state/document";
import { subjectAt, subjectsOf } from "../src/state/film";
import { exporterGroups } from "../src/state/installed";
import { thinned, walked, type Step } from "../src/state/walk";
import type { JsonObject, Plan, SubjectTrack } from "../src/state/types";

const film: JsonObject = {
  duration: 20, margin: 0.5,
  keyframes: [{ time: 0, position: [0, 0, 2] }, { time: 20, position: [20, 0, 2] }],
  subjects: [{ position: [5, 5, 1], height: 2 },
             { name: "b", track: [{ time: 0, position: [0, 0, 0] }, { time: 4, position: [4, 0, 0] },
                                  { time: 9, position: [9, 0, 0] }] }],
};

// East at 1 m/s, a pause of two seconds, then north; a hand trembles by a centimetre.
const steps: Step[] = Array.from({ length: 601 }, (_, i) => {
  const time = i / 100;
  const tremble = 0.01 * Math.sin(i * 1.7);
  return { time, place: [Math.min(time, 2) + tremble, Math.max(0, time - 4), 1] };
});

test("a way keeps its corners, its pauses and its pace, and no more", () => {
  const kept = thinned(steps);
  assert.ok(kept.length >= 4 && kept.length <= 6, String(kept.length));
  const track: SubjectTrack = { name: "", times: kept.map((s) => s.time),
                                positions: kept.map((s) => s.place) };
  for (const { time, place } of steps) {
    const at = subjectAt(track, time);
    assert.ok(Math.hypot(at[0] - place[0], at[1] - place[1]) <= 0.1 + 1e-9, String(time));
  }
});

test("a subject that stood has a track afterwards", () => {
  const edit = walked(film, 0, steps);
  assert.ok(edit);
  const document = applied(film, edit.patch);
  const subject = valueAt(document, "subjects[1]") as JsonObject;
  assert.equal(subject.position, undefined);
  assert.equal(subject.height, 2);
  const [track] = subjectsOf(document) as [SubjectTrack];
  assert.ok(Math.abs(subjectAt(track, 6)[1] - 2) < 0.02);
  assert.equal(edit.label, "Walk subject 1");
});

test("what was before and after the walk stays", () => {
  const middle: Step[] = [{ time: 3, place: [3, 5, 0] }, { time: 5, place: [5, 5, 0] }];
  const edit = walked(film, 1, middle);
  assert.ok(edit);
  const list = valueAt(applied(film, edit.patch), "subjects[2].track") as JsonObject[];
  assert.deepEqual(list.map((point) => point.time), [0, 3, 5, 9]);
  assert.equal(walked(film, 1, [{ time: 3, place: [0, 0, 0] }, { time: 3.1, place: [1, 0, 0] }]), null);
  assert.equal(walked(film, 7, middle), null);
});

test("figures of two versions, and the way back", () => {
  const plan: Plan = {
    duration: 2, objective: [{ term: "a", cost: 1 }, { term: "b", cost: 2 }],
    columns: { time: [0, 1, 2], x: [0, 3, 3], y: [0, 4, 4], z: [0, 0, 2], vx: [0, 3, 0],
               vy: [0, 4, 0], vz: [0, -2, 1], ax: [0, 1, 0], ay: [0, 0, 0],
               distance: [9, 0.75, 3] },
  };
  const certificate = { passed: false, checks: [
    { name: "a", passed: false, required: true }, { name: "b", passed: false, required: false },
    { name: "c", passed: true, required: true }] };
  const figures = figuresOf({ document: film, plan, certificate });
  const of = (name: string): number | null | undefined =>
    figures.find((figure) => figure.name === name)?.value;
  assert.equal(of("Way flown"), 7);
  assert.equal(of("Speed across"), 5);
  assert.equal(of("Climb, sink"), 2);
  assert.equal(of("Nearest obstacle"), 0.75);
  assert.equal(of("Most thrust"), null);
  assert.equal(of("Cost"), 3);
  assert.equal(of("Failed checks"), 1);
  const now = applied(film, [{ path: "margin", value: 1 }, { path: "speed", value: 3 }]);
  const patch = backTo(now, film);
  assert.deepEqual(patch, [{ path: "margin", value: 0.5 }, { path: "speed", remove: true }]);
  assert.deepEqual(applied(now, patch), film);
});

test("exporters come in groups, those that fly it first, and none is left out", () => {
  const names = ["chan", "colmap", "csv", "gltf", "kml", "litchi", "own_format", "qgc_plan", "wpml"];
  const groups = exporterGroups(names.map((name) => ({ name })));
  assert.deepEqual(groups[0], { title: "For a drone", choices: [
    { name: "wpml" }, { name: "litchi" }, { name: "qgc_plan" }] });
  assert.deepEqual(groups[groups.length - 1], { title: "Others", choices: [{ name: "own_format" }] });
  assert.deepEqual(groups.flatMap((group) => group.choices.map((one) => one.name)).sort(), names);
});
