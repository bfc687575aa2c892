// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { legAt, mendOf, passagesOf, plainName, slowerBy, sortedChecks, unhurried, verdict } from
  "../src/state/failures";
import { choicesIn, optionsIn } from "../src/state/installed";
import { actionOf, bindings, keyOf, keyText } from "../src/state/keys";
import { lanesOf, massOf, rangeOf, speedsOf } from "../src/state/samples";
import { fieldsOf, parseField, pluginFields, rangeText, sliderOf, weightOf } from "../src/state/schema";
import type { Check, Option, Plan } from "../src/state/types";
import { clock, parseQuantity, show } from "../src/state/units";

test("numbers are read with their units", () => {
  const value = (text: string, unit: string): unknown => parseQuantity(text, unit);
  assert.deepEqual(value("3.5", "m"), { value: 3.5 });
  assert.deepEqual(value(" 350 cm ", "m"), { value: 3.5 });
  assert.deepEqual(value("3,5", "m"), { value: 3.5 });
  assert.deepEqual(value("-2m", "m"), { value: -2 });
  assert.deepEqual(value("\u22122", "m"), { value: -2 });
  assert.deepEqual(value("36 km/h", "m/s"), { value: 10 });
  assert.deepEqual(value("1.5 min", "s"), { value: 90 });
  assert.deepEqual(value("45\u00b0", "deg"), { value: 45 });
  assert.deepEqual(value("1e3", ""), { value: 1000 });
  for (const bad of ["", "x", "3 kg", "1 2", "--3", "3..4", "NaN", "Infinity"]) {
    assert.ok("error" in parseQuantity(bad, "m"), bad);
  }
  assert.match((parseQuantity("3 kg", "m") as { error: string }).error, /use m, cm/);
});

test("ranges are kept, not clamped", () => {
  assert.ok("error" in parseQuantity("0", "s", { above: 0 }));
  assert.ok("error" in parseQuantity("11", "", { maximum: 10 }));
  assert.ok("error" in parseQuantity("1.5", "", { whole: true }));
  assert.deepEqual(parseQuantity("10", "", { minimum: 10, maximum: 10 }), { value: 10 });
});

test("numbers are written short", () => {
  assert.equal(show(0), "0");
  assert.equal(show(12345.678), "12346");
  assert.equal(show(0.01234), "0.0123");
  assert.equal(show(1e-9), "1.0e-9");
  assert.equal(show(Infinity), "\u2013");
  assert.equal(clock(75.04), "1:15.0");
  assert.equal(clock(-1), "0:00.0");
});

const number: Option = { name: "margin", type: "number", unit: "m", default: 0.5, minimum: 0 };

test("options become fields, tables with their path", () => {
  const options: Option[] = [number, { name: "volume", type: "table", table: [
    { name: "lower", type: "numbers", size: 3, unit: "m" }] },
    { name: "keyframes", type: "tables" }];
  const fields = fieldsOf(options, { volume: { lower: [1, 2, 3] } });
  assert.deepEqual(fields.map((f) => f.path), ["margin", "volume.lower"]);
  assert.deepEqual(fields.map((f) => f.stated), [false, true]);
  assert.equal(fields[0]?.value, 0.5);
});

test("what is typed into a field is checked by its declaration", () => {
  assert.deepEqual(parseField(number, "1 m"), { value: 1 });
  assert.ok("error" in parseField(number, "-1"));
  assert.deepEqual(parseField(number, " "), { value: null });
  assert.ok("error" in parseField({ ...number, required: true }, ""));
  const three: Option = { name: "lower", type: "numbers", size: 3, unit: "m" };
  assert.deepEqual(parseField(three, "1, 2; -3"), { value: [1, 2, -3] });
  assert.deepEqual(parseField(three, "1 2 -3"), { value: [1, 2, -3] });
  assert.ok("error" in parseField(three, "1, 2"));
  assert.deepEqual(parseField({ name: "s", type: "number", words: ["auto"] }, "auto"),
                   { value: "auto" });
  assert.ok("error" in parseField({ name: "c", type: "choice", choices: ["a"] }, "b"));
  assert.equal(rangeText(number), "at least 0 m");
});

test("sliders and weights are each other's inverse, to two digits", () => {
  for (const weight of [0, 0.001, 0.02, 1, 10, 100, 30000]) {
    const back = weightOf(sliderOf(weight));
    assert.ok(Math.abs(back - weight) <= 0.05 * weight, `${weight} ${back}`);
  }
  assert.equal(weightOf(0), 0);
  assert.equal(sliderOf(1e9), 100);
});

test("installed plugins bring their parameters", () => {
  const schema = { options: [number], plugins: {
    trajectory_solver: { iqp: { summary: "quick", parameters: [number] } },
    exporter: { csv: { summary: "table" } } } };
  assert.equal(optionsIn(schema).length, 1);
  assert.equal(optionsIn([number]).length, 1);
  assert.deepEqual(optionsIn(null), []);
  const choices = choicesIn(schema, { vehicle: ["a", 3], style: [{ name: "s", layer: { x: 1 } }],
                                      exporters: ["csv"] });
  assert.deepEqual(choices.vehicle, [{ name: "a" }]);
  assert.deepEqual(choices.style, [{ name: "s", values: { x: 1 } }]);
  assert.equal(choices.exporters?.[0]?.summary, "table");
  const fields = pluginFields(choices.solver, { type: "iqp", margin: 2 }, "solver");
  assert.deepEqual(fields.map((f) => [f.path, f.value]), [["solver.margin", 2]]);
  assert.deepEqual(choicesIn(null, null), {});
});

const check = (more: Partial<Check>): Check => ({ name: "speed_across", passed: false, required: true,
  worst: 14, limit: 10, sense: "at_most", unit: "m/s", time: 2, ...more });
const plan: Plan = { duration: 4, columns: { time: [0, 1, 2, 3, 4], x: [0, 0, 0, 0, 0],
  vx: [0, 12, 14, 9, 0], vy: [0, 0, 0, 0, 0] } };

test("what fails is shown where it fails, with its mend", () => {
  const found = passagesOf(plan, { passed: false, checks: [check({})] });
  assert.deepEqual(found.map((p) => [p.start, p.finish, p.value, p.limit]), [[0, 3, 14, 10]]);
  assert.match(mendOf(check({})), /1\.4 times slower/);
  assert.match(mendOf(check({ name: "acceleration_across", worst: 16, limit: 4 })), /2 times slower/);
  assert.match(mendOf(check({ name: "clearance", worst: 0.2, limit: 0.5, sense: "at_least" })),
               /0\.3 m away/);
  assert.match(mendOf(check({ name: "height_above_home", worst: 123.5, limit: 120 })), /3\.5 m lower/);
  assert.match(mendOf(check({ name: "distance_from_home", worst: 310, limit: 300 })), /10 m nearer/);
  assert.match(mendOf(check({ name: "height_above_ground", worst: -0.5, limit: 0,
    sense: "at_least" })), /0\.5 m higher/);
  const moment = passagesOf(plan, { passed: false, checks: [check({ name: "clearance", time: 3.8 })] });
  assert.deepEqual(moment.map((p) => [p.start, p.finish]), [[3.3, 4]]);
  for (const fine of [{ passed: true }, { required: false }, { skipped: "none" }]) {
    assert.deepEqual(passagesOf(plan, { passed: true, checks: [check(fine)] }), []);
  }
  assert.deepEqual(passagesOf(plan, null), []);
});

test("checks are read by people", () => {
  assert.equal(plainName("speed_across"), "Speed across");
  assert.equal(plainName("a_new_one"), "A new one");
  assert.equal(verdict(check({})), "14 m/s, at most 10 m/s allowed");
  assert.equal(verdict(check({ worst: 0.5, limit: Math.PI / 2, unit: "rad/s" })),
               "28.6 \u00b0/s, at most 90 \u00b0/s allowed");
  assert.equal(verdict(check({ worst: 1e-12, limit: 1 })), "almost 0, at most 1 m/s allowed");
  const names = sortedChecks({ passed: false, checks: [
    check({ name: "skip", skipped: "x" }), check({ name: "defect_yaw", passed: true }),
    check({ name: "note", required: false }), check({ name: "good", passed: true }),
    check({ name: "bad" })] }).map((c) => c.name);
  assert.deepEqual(names, ["bad", "good", "note", "defect_yaw", "skip"]);
});

test("lanes have the limits of the vehicle", () => {
  const lanes = lanesOf({ ...plan, limits: { speed_across: 10 } });
  assert.deepEqual(lanes.map((l) => [l.name, l.limits.length]), [["Speed", 1]]);
  assert.deepEqual(lanes[0]?.values, [0, 12, 14, 9, 0]);
  const moving: Plan = { duration: 1, columns: { time: [0, 1], ax: [0, 0], ay: [0, 0], az: [0, 0],
                                                 thrust: [14.715, 14.715] } };
  assert.ok(Math.abs((massOf(moving) as number) - 1.5) < 1e-9);
  assert.equal(massOf(plan), null);
});

test("no key does two things, and every key is found again", () => {
  const all = bindings.flatMap((b) => b.keys);
  assert.equal(new Set(all).size, all.length);
  const press = (key: string, more = {}): string | undefined => actionOf(
    { key, ctrlKey: false, metaKey: false, altKey: false, shiftKey: false, ...more })?.action;
  assert.equal(press("k"), "keyframe-here");
  assert.equal(press("?", { shiftKey: true }), "help");
  assert.equal(press("Z", { ctrlKey: true, shiftKey: true }), "redo");
  assert.equal(press("z", { metaKey: true }), "undo");
  assert.equal(press("ArrowUp", { altKey: true }), "order");
  assert.equal(press("c", { ctrlKey: true }), undefined);
  assert.equal(keyOf({ key: " ", ctrlKey: false, metaKey: false, altKey: false, shiftKey: false }),
               "Space");
  for (const key of all) assert.ok(keyText(key).length > 0);
});

test("the leg to be slowed is the one at that time, beside a keyframe the faster", () => {
  const keyframes = [{ time: 0, position: [0, 0, 0] as [number, number, number] },
                     { time: 10, position: [10, 0, 0] as [number, number, number] },
                     { time: 12, position: [20, 0, 0] as [number, number, number] }];
  assert.equal(legAt(keyframes, 0), 1);
  assert.equal(legAt(keyframes, 5), 1);
  assert.equal(legAt(keyframes, 10), 2);
  assert.equal(legAt(keyframes, 11), 2);
  assert.equal(legAt(keyframes, 99), 2);
  assert.equal(legAt(keyframes.slice(0, 1), 0), null);
  assert.equal(legAt([], 0), null);
  assert.equal(slowerBy(check({ name: "keyframe_miss", worst: 1, limit: 0.5 })), 1.25);
  assert.equal(slowerBy(check({ name: "clearance", worst: 0, limit: 0.5 })), null);
});

test("a leg beyond the drone is slowed to a pace that it keeps", () => {
  const at = (time: number, east: number): { time: number; position: [number, number, number] } =>
    ({ time, position: [east, 0, 5] });
  assert.equal(unhurried(at(0, 0), at(10, 30), 10), 1);    // 3 m/s
  assert.equal(unhurried(at(0, 0), at(10, 120), 10), 2);   // 12 m/s, to 6 m/s
  assert.equal(unhurried(at(0, 0), at(10, 120), undefined), 1);
  assert.match(mendOf({ name: "keyframe_miss", worst: 4, limit: 0.5, detail: "keyframe 3" } as never),
               /beside keyframe 3 more/);
});

test("speeds are those of the plan, in all directions", () => {
  const speeds = speedsOf({ time: [0, 1], vx: [3, 0], vy: [4, 0], vz: [12, -2] });
  assert.deepEqual(speeds, [13, 2]);
  assert.deepEqual(rangeOf(speeds as number[]), [2, 13]);
  assert.equal(speedsOf({ time: [0, 1], vx: [3, 0], vy: [4, 0] }), null);
});
