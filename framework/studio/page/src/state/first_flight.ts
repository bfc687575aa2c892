// SPDX-License-Identifier: Apache-2.0
// The patterns of a scan's first flight, edits of them, and what its images show of the ground.
import type { Edit } from "./edits";
import { entries } from "./film";
import { show } from "./units";
import type { FirstFlight, Json, JsonObject, ScanWorld, Vec3 } from "./types";

export const flightsOf = (document: JsonObject): JsonObject[] => entries(document, "flights");

const edited = (label: string, flights: JsonObject[]): Edit =>
  ({ label, patch: [{ path: "flights", value: flights }] });

// One field of a pattern; null: as if it were not said.
export function changedFlight(document: JsonObject, index: number, name: string, value: Json): Edit {
  return edited(`Change ${name.replace(/_deg$/, "")} of pattern ${index + 1}`,
    flightsOf(document).map((flight, k) => {
      if (k !== index) return flight;
      const next = { ...flight };
      if (value === null) delete next[name];
      else next[name] = value;
      return next;
    }));
}

export const addedFlight = (document: JsonObject): Edit =>
  edited("Add a pattern", [...flightsOf(document), { pattern: "meander" }]);

export const removedFlight = (document: JsonObject, index: number): Edit =>
  edited(`Remove pattern ${index + 1}`, flightsOf(document).filter((_, k) => k !== index));

// What each image shows of the ground, as lines: of a flight that is being edited, else of the one
// that was flown.
export function footprintRuns(draft: FirstFlight | null, scan: ScanWorld | undefined): Vec3[][] {
  const level = draft?.level ?? Math.min(...(scan?.region ?? []).map(({ low }) => low));
  const all = draft ? draft.images.map(({ footprint }) => footprint) : scan?.footprints ?? [];
  return all.filter((corners) => corners.length > 2).map((corners) =>
    [...corners, corners[0] as [number, number]].map(([x, y]): Vec3 => [x, y, level]));
}

const area = (corners: [number, number][]): number => Math.abs(corners.reduce((sum, [x, y], k) => {
  const [u, v] = corners[(k + 1) % corners.length] as [number, number];
  return sum + x * v - u * y;
}, 0)) / 2;

export function firstFlightInWords(draft: FirstFlight | null, scan: ScanWorld | undefined): string {
  const all = draft ? draft.images.map(({ footprint }) => footprint) : scan?.footprints ?? [];
  if (all.length === 0) return "";
  const mean = all.reduce((sum, corners) => sum + area(corners), 0) / all.length;
  return `${all.length} images${draft ? ", not flown yet" : ""}: each shows ${
    show(Number(mean.toPrecision(3)))} m\u00b2 of the ground on average.`;
}
