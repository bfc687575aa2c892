// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { addedStrokes, drawnStrokes } from "../src/state/painting";
import { applied } from "../src/state/document";
import { addedFromFile, polygonsIn } from "../src/state/polygon_file";
import type { JsonObject } from "../src/state/types";

const box = "[[[4,52],[4.001,52],[4.001,52.001],[4,52.001],[4,52]]]";
const feature = (geometry: string, properties = "{}"): string =>
  `{"type":"Feature","properties":${properties},"geometry":${geometry}}`;
const site = { regions: [], no_fly_zones: [], region: { lower: [0, 0, 0], upper: [1, 1, 1] } } as
  unknown as JsonObject;

test("the shipped quarter: names, holes, heights and weights", () => {
  const text = readFileSync("../../../examples/scan/quarter.geojson", "utf8");
  const polygons = polygonsIn("quarter.geojson", text);
  assert.deepEqual(polygons.map((p) => p.name), ["gardens", "gate houses", "school", "pylons", "estate"]);
  assert.equal(polygons[0]?.rings.length, 2);
  assert.equal(polygons[0]?.rings[0]?.length, 6);
  assert.deepEqual(polygons[0]?.rings[0]?.[0], [52.0111506, 4.3563718]);
  assert.deepEqual(polygons[1]?.stated, { from: -2, to: 13, weight: 3 });
  const edit = addedFromFile(site, "region", "quarter.geojson", polygons.slice(0, 2));
  const next = applied(site, edit.patch);
  assert.deepEqual(next.region, {});
  const [gardens] = next.regions as JsonObject[];
  assert.equal((gardens?.corners_deg as number[]).length, 12);
  assert.equal((gardens?.holes as JsonObject[]).length, 1);
  assert.equal(gardens?.to, 13);
});

test("KML: placemarks, holes, extended data", () => {
  const kml = `<?xml version="1.0"?><kml><Document><!-- <Placemark/> --><Placemark><name>yard</name>
    <ExtendedData><Data name="ceiling"><value>30</value></Data></ExtendedData>
    <Polygon><outerBoundaryIs><LinearRing><coordinates>4,52,0 4.1,52,0 4.1,52.1,0 4,52,0</coordinates>
    </LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>`;
  const [yard] = polygonsIn("a.kml", kml);
  assert.equal(yard?.name, "yard");
  assert.deepEqual(yard?.rings, [[[52, 4], [52, 4.1], [52.1, 4.1]]]);
  assert.deepEqual(yard?.stated, { ceiling: 30 });
  const edit = addedFromFile(site, "closed", "a.kml", [yard!]);
  assert.deepEqual((applied(site, edit.patch).no_fly_zones as JsonObject[])[0],
                   { name: "yard", corners_deg: [52, 4, 52, 4.1, 52.1, 4.1], ceiling: 30 });
});

test("several geometries of one feature; others are passed over", () => {
  const many = polygonsIn("m.json", feature(`{"type":"GeometryCollection","geometries":[
    {"type":"Point","coordinates":[4,52]},{"type":"MultiPolygon","coordinates":[${box},${box}]}]}`));
  assert.equal(many.length, 2);
});

test("bad files are one sentence", () => {
  const crs = `{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::28992"}},"features":[]}`;
  const cases: [string, RegExp][] = [
    [crs, /reference system is .*28992.*ogr2ogr/],
    [feature(`{"type":"Polygon","coordinates":[[[84900,447500],[84910,447500],[84910,447510]]]}`),
     /84900, 447500 are no longitude and latitude/],
    [feature(`{"type":"Polygon","coordinates":[[[4,52],[4,53],[4,52]]]}`), /three corners/],
    [feature(`{"type":"Polygon","coordinates":[[["x",52],[4,53],[5,52]]]}`), /expected corners/],
    [feature(`{"type":"Point","coordinates":[4,52]}`), /no polygon/],
    ["{", /no JSON/], ["", /no polygon/], ["<kml></kml>", /no polygon/],
  ];
  for (const [text, message] of cases) assert.throws(() => polygonsIn("f.json", text), message);
  const holed = polygonsIn("h.json", feature(`{"type":"Polygon","coordinates":[${box.slice(1, -1)},${box.slice(1, -1)}]}`));
  assert.throws(() => addedFromFile(site, "closed", "h.json", holed), /has holes/);
});

test("the lines of a picture stand where the drawing stood, as high as it was", () => {
  const painting = { text: "A", strokes: [], height: 3, base: [1, 2, 2], view_yaw_deg: 90 } as JsonObject;
  const edit = addedStrokes(painting, "Draw a.svg", [[[0, 0], [100, 0]], [[50, 0], [50, 60]]]);
  assert.ok(edit);
  const next = applied(painting, edit.patch);
  assert.equal(next.height, 3);
  assert.deepEqual(next.base, [1, 2, 2]);
  assert.equal(drawnStrokes(next).length, 2);
  assert.equal(addedStrokes(painting, "", [[[5, 5], [5, 5]]]), null);
});
