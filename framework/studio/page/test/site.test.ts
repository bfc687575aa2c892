// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { axesOf } from "../src/state/camera";
import { applied, valueAt } from "../src/state/document";
import { addedCorner, corneredItem, deleted, entryOf, moved, nameOf, placeOfItem, type Edit } from
  "../src/state/edits";
import { figuresInWords, predictionIn, shadeOf } from "../src/state/prediction";
import { estimateInWords, forbiddenView, pinnedView, pinOf, viewAtTime, viewsOf, addedPolygon, aroundSite, frustum, prismLines, rectangle, regionsOf } from "../src/state/site";
import type { JsonObject, ScanWorld, Vec3 } from "../src/state/types";
import { itemsOf } from "../src/view/pins";

const world = {
  region: [{ name: "", corners: [[0, 0], [8, 0], [8, 6], [0, 6]], holes: [], low: -0.5, high: 12,
             weight: 1 }],
} as unknown as ScanWorld;
const bare: JsonObject = { region: {}, regions: [], no_fly_zones: [], flight_zones: [], coordinates: "" };
const site: JsonObject = {
  ...bare, start: [1, 2, 20], home: { position: [3, 4, 0] },
  regions: [{ name: "yard", file: "", named: "", corners: [0, 0, 10, 0, 10, 10, 0, 10], from: 0, to: 8, weight: 2,
              holes: [{ corners: [2, 2, 4, 2, 4, 4] }] }],
  no_fly_zones: [{ name: "school", corners: [20, 0, 30, 0, 30, 10] }],
  flight_zones: [{ name: "estate", corners: [-50, -50, 50, -50, 50, 50, -50, 50], ceiling: 60 }],
};
const after = (document: JsonObject, edit: Edit | null): JsonObject => {
  assert.ok(edit);
  return applied(document, edit.patch);
};

test("polygons, ends and places have pins, and names", () => {
  const kinds = itemsOf(site, { kind: "region", index: 0 }).map((item) => item.kind);
  assert.equal(kinds.filter((kind) => kind === "corner").length, 4);
  for (const kind of ["region", "closed", "zone", "place"]) assert.ok(kinds.includes(kind as never), kind);
  assert.equal(nameOf(site, { kind: "region", index: 0 }), "region yard");
  assert.equal(nameOf(site, { kind: "closed", index: 0 }), "no-fly zone school");
  assert.equal(nameOf(site, { kind: "place", index: 1 }), "home");
  assert.deepEqual(placeOfItem(site, { kind: "place", index: 0 }), [1, 2, 20]);
  assert.equal(entryOf(bare, { kind: "place", index: 0 }), null);
});

const views = [0, 10, 20].map((time) => ({ time, position: [time, 1.23456, 5] as Vec3, yaw: -Math.PI / 2,
                                         pitch: -0.5, matching: false }));

test("a view is pinned as the plan has it, moved, let go, or forbidden", () => {
  const [view] = views;
  assert.ok(view);
  assert.equal(pinOf(site, view), -1);
  const pinned = after(site, pinnedView(site, view));
  assert.deepEqual(pinned.pinned, [{ position: [0, 1.235, 5], yaw_deg: -90, pitch_deg: -28.648 }]);
  assert.equal(pinOf(pinned, view), 0);
  const item = { kind: "pinned", index: 0 } as const;
  assert.equal(nameOf(pinned, item), "pinned view 1");
  assert.deepEqual(placeOfItem(pinned, item), [0, 1.235, 5]);
  assert.ok(itemsOf(pinned, null).some(({ kind }) => kind === "pinned"));
  const dragged = after(pinned, moved(pinned, item, [2, 2, 6]));
  assert.deepEqual(valueAt(dragged, "pinned[1].position"), [2, 2, 6]);
  assert.equal(pinOf(dragged, view), -1);
  assert.deepEqual(after(pinned, pinnedView(pinned, view)).pinned, []);
  assert.deepEqual(after(pinned, deleted(pinned, item)).pinned, []);
  // However its heading is written.
  assert.equal(pinOf({ pinned: [{ position: [0, 1.235, 5], yaw_deg: 270, pitch_deg: -28.648 }] }, view), 0);
  // What is forbidden is not pinned any more.
  const without = after(pinned, forbiddenView(pinned, view));
  assert.deepEqual([without.pinned, without.forbidden], [[], [{ position: [0, 1.235, 5], within: 1 }]]);
});

test("an estimate says how far it goes, and why there is none", () => {
  const told = { type: "estimate", edit: 1, tab: "a", tours: 1, images: 20, seconds: 120, known: 200,
                 seen: 50 } as const;
  assert.equal(estimateInWords(told), "About 20 images in 2 min, 25 % of the known surface");
  assert.match(estimateInWords({ ...told, tours: 2, changed: true }), /^Roughly 20 .* of 2 tours/);
  assert.equal(estimateInWords({ type: "estimate", edit: 1, tab: "a", why: "nothing is known" }),
               "No estimate: nothing is known");
  assert.match(estimateInWords({ type: "estimate", edit: 1, tab: "a" }), /no views of this state/);
});

test("views are those of one tour, by the play head", () => {
  const fleet = { views: [...views, ...views.map((view) => ({ ...view, tour: 1 }))] } as unknown as ScanWorld;
  assert.equal(viewsOf(fleet, 1).length, 3);
  assert.equal(viewsOf(fleet).length, 3);
  assert.equal(viewAtTime(views, 0), 0);
  assert.equal(viewAtTime(views, 12), 1);
  assert.equal(viewAtTime([], 3), -1);
});

test("the start of an exploration is a place", () => {
  const world: JsonObject = { lookahead: 1, start: [0, -30, 8] };
  const start = { kind: "place", index: 0 } as const;
  assert.deepEqual(itemsOf(world, null).filter(({ kind }) => kind === "place"), [start]);
  assert.deepEqual(after(world, moved(world, start, [1, 2, 9])).start, [1, 2, 9]);
  assert.equal(entryOf(world, { kind: "place", index: 1 }), null);
});

test("a region moves with both ends of its heights, by their own names", () => {
  const item = { kind: "region", index: 0 } as const;
  const from = placeOfItem(site, item) as Vec3;
  assert.deepEqual(from, [5, 5, 0]);
  const next = after(site, moved(site, item, [6, 5, 1]));
  assert.deepEqual(valueAt(next, "regions[1].corners"), [1, 0, 11, 0, 11, 10, 1, 10]);
  assert.equal(valueAt(next, "regions[1].from"), 1);
  assert.equal(valueAt(next, "regions[1].to"), 9);
  assert.equal(valueAt(next, "regions[1].floor"), undefined);
});

test("corners are moved, added and taken away", () => {
  const corner = { kind: "corner", of: "closed", index: 0, point: 1 } as const;
  assert.deepEqual(corneredItem(site, corner), { kind: "closed", index: 0 });
  const next = after(site, moved(site, corner, [31, 1, 0]));
  assert.deepEqual(valueAt(next, "no_fly_zones[1].corners"), [20, 0, 31, 1, 30, 10]);
  const more = after(site, addedCorner(site, corner));
  assert.deepEqual(valueAt(more, "no_fly_zones[1].corners"), [20, 0, 30, 0, 30, 5, 30, 10]);
  assert.deepEqual(valueAt(after(more, deleted(more, { ...corner, point: 2 })),
                           "no_fly_zones[1].corners"), [20, 0, 30, 0, 30, 10]);
  assert.equal(deleted(site, corner), null);
  assert.deepEqual(valueAt(after(site, deleted(site, { kind: "region", index: 0 })), "regions"), []);
});

test("the first region takes the place of the box, at its heights", () => {
  const boxed: JsonObject = { ...bare, region: { lower: [0, 0, 1], upper: [9, 9, 9] } };
  assert.deepEqual(valueAt(after(boxed, moved(boxed, { kind: "extent", index: 1 }, [10, 9, 9])),
                           "region.upper"), [10, 9, 9]);
  const next = after(boxed, addedPolygon(boxed, "region", rectangle([4, 1, 0], [0, 3, 0]), world));
  assert.deepEqual(next.region, {});
  assert.deepEqual(next.regions, [{ name: "region 1", corners: [0, 1, 4, 1, 4, 3, 0, 3], from: -0.5,
                                    to: 12 }]);
  const zoned = after(site, addedPolygon(site, "closed", [1, 1, 0]));
  assert.equal(valueAt(zoned, "no_fly_zones[2].name"), "no-fly zone 2");
  assert.deepEqual(aroundSite(world, [[-3, 0, 5]]), [[-13, -10], [18, -10], [18, 16], [-13, 16]]);
});

test("polygons of files and of other systems are drawn as the mission found them", () => {
  assert.deepEqual(regionsOf(bare, world), world.region);
  const [stated] = regionsOf(site, world);
  assert.equal(stated?.low, 0);
  assert.deepEqual(stated?.holes, [[[2, 2], [4, 2], [4, 4]]]);
  for (const other of [{ ...site, coordinates: "EPSG:28992" },
                       { ...site, regions: [{ file: "yard.geojson" }] }]) {
    assert.deepEqual(regionsOf(other, world), world.region);
    assert.equal(placeOfItem(other, { kind: "region", index: 0 }), null);
    assert.equal(corneredItem(other, { kind: "region", index: 0 }), null);
  }
  // Two rings and an upright edge for each corner, of the outline and of the hole.
  assert.equal(prismLines(regionsOf(site, world)[0] as never).length, 2 + 4 + 2 + 3);
});

test("a view looks where its angles say", () => {
  const yaw = 0.7, pitch = -0.4;
  const lines = frustum([1, 2, 3], yaw, pitch, [101, 51, 100, 100, 50, 25], 2);
  const { forward } = axesOf(yaw, pitch);
  const corners = (lines[0] as Vec3[]).slice(0, 4);
  const middle = [0, 1, 2].map((k) => corners.reduce((sum, p) => sum + (p[k] as number) / 4, 0));
  middle.forEach((v, k) => assert.ok(
    Math.abs(v - ([1, 2, 3][k] as number) - 2 * (forward[k] as number)) < 1e-9));
  // The upper edge of the image is above the lower one.
  assert.ok((corners[0]?.[2] as number) > (corners[3]?.[2] as number));
});

function ply(): ArrayBuffer {
  const head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nelement face 2\nend_header\n";
  const buffer = new ArrayBuffer(head.length + 36 + 2 * 36);
  new Uint8Array(buffer).set([...head].map((c) => c.charCodeAt(0)));
  const data = new DataView(buffer);
  [0, 0, 0, 1, 0, 0, 0, 1, 0.5].forEach((v, i) => data.setFloat32(head.length + 4 * i, v, true));
  [[3, 20, 4, 30, 2], [1, 40, 8, -1, -1]].forEach((figures, t) => {
    const at = head.length + 36 + 36 * t;
    data.setUint8(at, 3);
    [0, 1, 2].forEach((v, c) => data.setUint32(at + 1 + 4 * c, v, true));
    data.setInt32(at + 16, figures[0] as number, true);
    for (let k = 1; k < 5; ++k) data.setFloat32(at + 16 + 4 * k, figures[k] as number, true);
  });
  return buffer;
}

test("a surface is read with its figures, and a torn one is refused", () => {
  const surface = predictionIn(ply());
  assert.deepEqual([...surface.triangles], [0, 1, 2, 0, 1, 2]);
  assert.equal(surface.positions[8], 0.5);
  assert.equal(figuresInWords(surface, 0),
               "3 images: angle 20\u00b0, resolution 4 mm a pixel, parallax 30\u00b0, accuracy 2 mm.");
  assert.equal(figuresInWords(surface, 1), "1 image: angle 40\u00b0, resolution 8 mm a pixel.");
  // The best is violet; what two places do not show is red, whatever one image shows of it.
  assert.deepEqual(shadeOf(surface, "accuracy_mm", 0), [68, 1, 84]);
  assert.deepEqual(shadeOf(surface, "accuracy_mm", 1), [196, 70, 60]);
  assert.notDeepEqual(shadeOf(surface, "images", 1), shadeOf(surface, "accuracy_mm", 1));
  assert.throws(() => predictionIn(ply().slice(0, -1)), /no surface/);
  assert.throws(() => predictionIn(new ArrayBuffer(3)), /no surface/);
});
