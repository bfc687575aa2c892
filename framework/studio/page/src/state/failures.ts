// SPDX-License-Identifier: Apache-2.0
// What fails, where on the path, and the smallest mend.
import { show } from "./units";
import type { Certificate, Check, Columns, Passage, Plan, Vec3 } from "./types";
import { distance } from "./vector";

// What a check means to who has never read about it.
const plainNames: Record<string, string> = {
  document: "Plan is complete", provenance: "Drone, obstacles and task are the stated ones",
  defect_position: "Motion adds up: place", defect_velocity: "Motion adds up: velocity",
  defect_yaw: "Motion adds up: heading", defect_yaw_rate: "Motion adds up: turning",
  defect_gimbal: "Motion adds up: gimbal", defect_state: "Motion adds up",
  drift: "Motion adds up over a second", stated_acceleration: "Acceleration fits the force",
  thrust_max: "Most thrust", thrust_min: "Least thrust", force_up: "Thrust points up",
  yaw_torque: "Turning torque", rotor_thrust: "Thrust of each rotor",
  speed_across: "Speed across", climb_speed: "Speed up", descent_speed: "Speed down",
  speed: "Speed", acceleration_across: "Acceleration across",
  acceleration_up: "Acceleration up", acceleration_down: "Acceleration down",
  yaw_rate: "Turning speed", tilt_rate: "Tilting speed", gimbal_yaw: "Gimbal turns far enough",
  gimbal_pitch: "Gimbal tilts far enough", gimbal_yaw_rate: "Gimbal turning speed",
  gimbal_pitch_rate: "Gimbal tilting speed", clearance: "Distance from obstacles",
  flight_zone: "Inside the flight zone", subject_distance: "Distance from people",
  flight_time: "Battery lasts", budget: "Within the time budget",
  closed_loop: "A simulated drone follows the path", closed_loop_yaw: "A simulated drone turns along",
  rotors_saturated: "Rotors at their limit", keyframe_time: "Keyframe times are in the film",
  keyframe_miss: "Passes the keyframes", keyframe_yaw: "Faces as the keyframes say",
  framing: "Subject is in the picture", line_of_sight: "Nothing hides the subject",
  whole_subject: "All of the subject is in the picture",
};

export function plainName(check: string): string {
  const words = check.replace(/_/g, " ");
  return plainNames[check] ?? words.charAt(0).toUpperCase() + words.slice(1);
}

// Radians mean nothing to most people.
export function inWords(value: number, unit: string): string {
  if (unit.startsWith("rad")) {
    const turned = (value * 180) / Math.PI;
    return `${show(turned)}${unit === "rad" ? "\u00b0" : ` \u00b0${unit.slice(3)}`}`;
  }
  return unit ? `${show(value)} ${unit}` : show(value);
}

export function verdict(check: Check): string {
  if (typeof check.worst !== "number" || typeof check.limit !== "number") return check.detail ?? "";
  const unit = check.unit ?? "";
  const least = Math.max(Math.abs(check.limit) * 1e-3, 1e-6);
  if (check.worst !== 0 && Math.abs(check.worst) < least && check.sense === "at_most") {
    return `almost 0, at most ${inWords(check.limit, unit)} allowed`;
  }
  const bound = check.sense === "at_least" ? "at least" : "at most";
  return `${inWords(check.worst, unit)}, ${bound} ${inWords(check.limit, unit)} allowed`;
}

type Sign = "across" | "up" | "down" | "size";
const quantities: Record<string, { columns: string[]; sign: Sign; power: number }> = {
  speed_across: { columns: ["vx", "vy"], sign: "across", power: 1 },
  speed: { columns: ["vx", "vy", "vz"], sign: "size", power: 1 },
  climb_speed: { columns: ["vz"], sign: "up", power: 1 },
  descent_speed: { columns: ["vz"], sign: "down", power: 1 },
  acceleration_across: { columns: ["ax", "ay"], sign: "across", power: 2 },
  acceleration_up: { columns: ["az"], sign: "up", power: 2 },
  acceleration_down: { columns: ["az"], sign: "down", power: 2 },
  thrust_max: { columns: ["thrust"], sign: "up", power: 0 },
  thrust_min: { columns: ["thrust"], sign: "down", power: 0 },
};

function series(columns: Columns, check: string): number[] | null {
  const quantity = quantities[check];
  if (!quantity || !quantity.columns.every((name) => columns[name])) return null;
  const lists = quantity.columns.map((name) => columns[name] as number[]);
  return columns.time.map((_, i) => {
    if (quantity.sign === "across" || quantity.sign === "size") {
      return Math.hypot(...lists.map((list) => list[i] as number));
    }
    const value = lists[0]?.[i] as number;
    return quantity.sign === "down" && quantity.columns[0] !== "thrust" ? -value : value;
  });
}

const AROUND = 0.5;      // s, drawn around a moment where no column tells more
const SLACK = 1.0001;
const A_LITTLE = 1.25;
const BESIDE = 0.3;      // s

// How much slower a leg should be; null where that does not help or how much is not known.
export function slowerBy(check: Check): number | null {
  if (typeof check.worst !== "number" || typeof check.limit !== "number") return null;
  const power = quantities[check.name]?.power;
  const over = check.limit !== 0 ? check.worst / check.limit : Infinity;
  if (power && over > 1 && Number.isFinite(over)) {
    return Math.ceil(Math.pow(over, 1 / power) * 20) / 20;
  }
  return ["thrust_max", "thrust_min", "keyframe_miss"].includes(check.name) ? A_LITTLE : null;
}

const UNHURRIED = 0.6;   // of the fastest speed, over a whole leg: it starts and ends slower

// How much slower a leg is at a pace that the drone can keep from keyframe to keyframe; 1 where it
// is slow enough.
export function unhurried(
  from: { time: number; position: Vec3 }, to: { time: number; position: Vec3 }, fastest: unknown,
): number {
  if (typeof fastest !== "number" || !(fastest > 0)) return 1;
  const seconds = Math.max(to.time - from.time, 1e-3);
  const wanted = distance(from.position, to.position) / (UNHURRIED * fastest);
  return Math.max(1, Math.ceil((wanted / seconds) * 20) / 20);
}

// The leg at a time, by the keyframe that it leads to: beside a keyframe, the faster of both.
export function legAt(
  keyframes: { time: number; position: Vec3 }[], time: number, beside = BESIDE,
): number | null {
  const speed = (i: number): number => {
    const a = keyframes[i - 1], b = keyframes[i];
    return a && b ? distance(a.position, b.position) / Math.max(b.time - a.time, 1e-3) : -1;
  };
  const at = keyframes.findIndex((k) => k.time >= time - beside);
  const leg = at < 0 ? keyframes.length - 1 : at;
  const here = keyframes[leg];
  if (!here) return null;
  const best = Math.abs(here.time - time) <= beside && speed(leg + 1) > speed(leg) ? leg + 1 : leg;
  return speed(best) < 0 ? null : best;
}

// What to do about it, in words.
export function mendOf(check: Check): string {
  if (typeof check.worst !== "number" || typeof check.limit !== "number") return "";
  const over = check.limit !== 0 ? check.worst / check.limit : Infinity;
  const factor = slowerBy(check);
  if (quantities[check.name]?.power && factor !== null) {
    return `Fly this leg ${show(factor)} times slower: give it more seconds.`;
  }
  switch (check.name) {
    case "thrust_max":
    case "thrust_min":
      return "Give this leg more seconds.";
    case "yaw_rate":
    case "gimbal_yaw_rate":
    case "gimbal_pitch_rate":
      return over > 1 && Number.isFinite(over)
        ? `Turn ${show(Math.ceil(over * 20) / 20)} times slower here, or move away from the subject.`
        : "Turn slower here.";
    case "clearance":
    case "subject_distance":
    case "flight_zone":
      return `Move the path ${show(Math.abs(check.limit - check.worst))} m ` +
        `${check.name === "flight_zone" ? "inwards" : "away"} here.`;
    case "height_above_home":
      return `Fly ${show(check.worst - check.limit)} m lower here.`;
    case "distance_from_home":
      return `Stay ${show(check.worst - check.limit)} m nearer to home here.`;
    case "height_above_ground":
      return `Fly ${show(check.limit - check.worst)} m higher here.`;
    case "keyframe_miss":
      return `Give the legs beside ${/keyframe \d+/.exec(check.detail ?? "")?.[0] ?? "this keyframe"} ` +
        "more seconds, or move it nearer to the path.";
    case "framing":
    case "line_of_sight":
      return "Move the keyframes here so that the subject is in the picture and nothing hides it.";
    case "flight_time":
      return "Shorten the film, or take a drone that flies longer.";
    default:
      return "";
  }
}

export function passagesOf(plan: Plan, certificate: Certificate | null): Passage[] {
  if (plan.passages && plan.passages.length > 0) return plan.passages;
  const found: Passage[] = [];
  for (const check of certificate?.checks ?? []) {
    if (check.passed || !check.required || check.skipped) continue;
    const base = { check: check.name, mend: mendOf(check) };
    const told: Partial<Passage> = {};
    if (typeof check.worst === "number") told.value = check.worst;
    if (typeof check.limit === "number") told.limit = check.limit;
    if (check.unit) told.unit = check.unit;
    const spans = beyond(plan.columns, check);
    if (spans.length > 0) {
      for (const [start, finish] of spans) found.push({ ...base, ...told, start, finish });
    } else if (typeof check.time === "number") {
      const start = Math.max(0, check.time - AROUND);
      const finish = Math.min(plan.duration, check.time + AROUND);
      found.push({ ...base, ...told, start, finish });
    }
  }
  return found;
}

// The spans of time in which a column is beyond its limit, a sample more at each end.
function beyond(columns: Columns, check: Check): [number, number][] {
  const values = series(columns, check.name);
  if (!values || typeof check.limit !== "number") return [];
  const limit = check.limit;
  const out = (v: number): boolean =>
    check.sense === "at_least" ? v * SLACK < limit : v > limit * SLACK;
  const spans: [number, number][] = [];
  let start = -1;
  values.forEach((v, i) => {
    if (out(v) && start < 0) start = i;
    if (start >= 0 && (!out(v) || i === values.length - 1)) {
      spans.push([columns.time[Math.max(0, start - 1)] as number, columns.time[i] as number]);
      start = -1;
    }
  });
  return spans;
}

// Whether the numbers of the plan fit each other: of interest where they do not.
const sums = /^(document|provenance|drift|stated_acceleration|defect_.*|force_up|flight_time)$/;

// First what fails, then what is required, then what is only reported, then the sums, then what did
// not apply.
export function sortedChecks(certificate: Certificate): Check[] {
  const rank = (check: Check): number =>
    check.skipped ? 4 : !check.passed && check.required ? 0 : sums.test(check.name) ? 3
      : check.required ? 1 : 2;
  return certificate.checks
    .map((check, i) => ({ check, i }))
    .sort((a, b) => rank(a.check) - rank(b.check) || a.i - b.i)
    .map(({ check }) => check);
}
