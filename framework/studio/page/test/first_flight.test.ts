// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { applied } from "../src/state/document";
import { addedFlight, changedFlight, firstFlightInWords, flightsOf, footprintRuns, removedFlight } from
  "../src/state/first_flight";
import type { FirstFlight, JsonObject, ScanWorld } from "../src/state/types";

const document: JsonObject = { flights: [{ pattern: "ellipse", views: 20 }, { pattern: "meander" }] };

test("patterns are added, changed, left as they are by default, and removed", () => {
  const after = (edit: ReturnType<typeof addedFlight>): JsonObject[] =>
    flightsOf(applied(document, edit.patch));
  assert.equal(after(addedFlight(document)).length, 3);
  assert.equal(after(changedFlight(document, 1, "views", 12))[1]?.views, 12);
  assert.equal(after(changedFlight(document, 0, "views", null))[0]?.views, undefined);
  assert.deepEqual(after(removedFlight(document, 0)), [{ pattern: "meander" }]);
  assert.match(changedFlight(document, 1, "pitch_deg", -70).label, /pitch of pattern 2/);
});

test("footprints are those of the flight that is edited, else of the one that was flown", () => {
  const square: [number, number][] = [[0, 0], [4, 0], [4, 4], [0, 4]];
  const scan = { region: [{ low: -0.5 }, { low: 2 }], footprints: [square, []] } as unknown as ScanWorld;
  const [run] = footprintRuns(null, scan);
  assert.deepEqual(run, [[0, 0, -0.5], [4, 0, -0.5], [4, 4, -0.5], [0, 4, -0.5], [0, 0, -0.5]]);
  assert.equal(footprintRuns(null, scan).length, 1, "an image without ground has none");
  const draft: FirstFlight = { type: "first_flight", edit: 3, tab: "a", level: 1,
                               images: [{ position: [0, 0, 9], footprint: [[0, 0], [1, 0], [1, 2], [0, 2]] }] };
  assert.equal(footprintRuns(draft, scan)[0]?.[0]?.[2], 1);
  assert.equal(firstFlightInWords(draft, scan), "1 images, not flown yet: each shows 2 m\u00b2 of the ground on average.");
  assert.equal(firstFlightInWords(null, scan), "2 images: each shows 8 m\u00b2 of the ground on average.");
  assert.equal(firstFlightInWords(null, undefined), "");
});
