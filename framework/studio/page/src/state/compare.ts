// SPDX-License-Identifier: Apache-2.0
// Two versions of a film side by side: what is told of each.
import { equal } from "./document";
import { pathOf } from "./samples";
import type { Certificate, JsonObject, Patch, Plan, World } from "./types";
import { distance } from "./vector";

export interface Version {
  document: JsonObject;
  plan: Plan;
  certificate: Certificate | null;
  world?: World;                // what it was planned on, of scans and explorations
}

export interface Figure {
  name: string;
  unit: string;
  value: number | null;
}

const most = (list: number[]): number | null => {
  const known = list.filter(Number.isFinite);
  return known.length > 0 ? Math.max(...known) : null;
};

// Of what was seen.
function seenBy({ scan, exploration }: World): Figure[] {
  const figures: Figure[] = [];
  if (exploration) {
    const { images, efficiency, per_second } = exploration;
    const found = images[images.length - 1]?.observed ?? 0;
    figures.push({ name: "Images", unit: "", value: images.length },
                 { name: "Surface found", unit: "voxels", value: found },
                 { name: "Efficiency", value: efficiency,
                   unit: per_second ? "voxels, mean over the flight" : "voxel images" });
  }
  if (scan) {
    const area = (name: string): number | null =>
      (typeof scan.areas[name] === "number" ? scan.areas[name] : null);
    figures.push({ name: "Images", unit: "", value: scan.views.length },
                 { name: "Surface seen", unit: "m\u00b2", value: area("seen") },
                 { name: "Score", unit: "", value: scan.score[scan.score.length - 1] ?? null });
  }
  return figures;
}

export function figuresOf({ plan, certificate, world = {} }: Version): Figure[] {
  const c = plan.columns;
  const path = pathOf(c);
  const way = path.reduce((sum, p, i) => sum + (i > 0 ? distance(p, path[i - 1] as typeof p) : 0), 0);
  const across = (x: string, y: string): number[] =>
    (c[x] ?? []).map((v, i) => Math.hypot(v, c[y]?.[i] ?? NaN));
  const nearest = most((c.distance ?? []).map((v) => (typeof v === "number" ? -v : NaN)));
  const cost = plan.objective?.reduce((sum, part) => sum + part.cost, 0);
  const failed = certificate?.checks.filter((one) => !one.passed && one.required && !one.skipped);
  return [
    ...seenBy(world),
    { name: "Duration", unit: "s", value: plan.duration },
    { name: "Way flown", unit: "m", value: way },
    { name: "Speed across", unit: "m/s", value: most(across("vx", "vy")) },
    { name: "Climb, sink", unit: "m/s", value: most((c.vz ?? []).map(Math.abs)) },
    { name: "Acceleration", unit: "m/s\u00b2", value: most(across("ax", "ay")) },
    { name: "Most thrust", unit: "N", value: most(c.thrust ?? []) },
    { name: "Nearest obstacle", unit: "m", value: nearest === null ? null : -nearest },
    { name: "Cost", unit: "", value: cost ?? null },
    { name: "Failed checks", unit: "", value: failed ? failed.length : null },
  ];
}

// What makes the one document of the other, by whole options.
export function backTo(now: JsonObject, kept: JsonObject): Patch {
  const patch: Patch = [];
  for (const [path, value] of Object.entries(kept)) {
    if (!equal(now[path], value)) patch.push({ path, value });
  }
  for (const path of Object.keys(now)) if (!(path in kept)) patch.push({ path, remove: true });
  return patch;
}
