// SPDX-License-Identifier: Apache-2.0
// node wpml.js FILE: exit status 1 if unzip finds the archive damaged, or if gdal's reader of KML
// does not find a placemark for each waypoint in both of its documents.
const { mkdtempSync, rmSync } = require("fs");
const { tmpdir } = require("os");
const { join } = require("path");
const { output } = require("./earth.js");

const file = process.argv[2];
output("unzip", "-t", file);
const folder = mkdtempSync(join(tmpdir(), "wpml-"));
try {
  output("unzip", "-q", file, "-d", folder);
  const counts = ["template.kml", "waylines.wpml"].map((name) => {
    const path = join(folder, "wpmz", name);
    // gdal takes a document by its ending.
    const kml = join(folder, `${name}.kml`);
    output("cp", path, kml);
    const points = JSON.parse(output("ogr2ogr", "-f", "GeoJSON", "/vsistdout/", kml)).features;
    const stated = (output("cat", path).match(/<Placemark>/g) || []).length;
    if (points.length !== stated || stated < 2 || points.some((f) => f.geometry.type !== "Point")) {
      console.log(`${name}: ${points.length} points, expected ${stated}`);
      process.exitCode = 1;
    }
    return stated;
  });
  if (counts[0] !== counts[1]) {
    console.log(`${counts[0]} and ${counts[1]} waypoints`);
    process.exitCode = 1;
  }
} finally {
  rmSync(folder, { recursive: true });
}
