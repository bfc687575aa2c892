// SPDX-License-Identifier: Apache-2.0
// Whether the path that a program found in a file of a geographic format is that of the plan: to
// within 1 cm, at every point. For kml.js, gpx.js, geojson.js.
const { readFileSync } = require("fs");
const { execFileSync } = require("child_process");

const LIMIT = 0.01; // m
const RATE = 10; // 1/s, points of the path per second

// East, north, up from the origin, by the two defining figures of WGS 84.
function local(origin, point) {
  const centred = ([latitude, longitude, height]) => {
    const a = 6378137.0, f = 1 / 298.257223563, e2 = f * (2 - f);
    const lat = (latitude * Math.PI) / 180, lon = (longitude * Math.PI) / 180;
    const n = a / Math.sqrt(1 - e2 * Math.sin(lat) ** 2);
    return [(n + height) * Math.cos(lat) * Math.cos(lon),
            (n + height) * Math.cos(lat) * Math.sin(lon), (n * (1 - e2) + height) * Math.sin(lat)];
  };
  const lat = (origin[0] * Math.PI) / 180, lon = (origin[1] * Math.PI) / 180;
  const o = centred(origin), p = centred(point);
  const d = p.map((value, i) => value - o[i]);
  const dot = (v) => v[0] * d[0] + v[1] * d[1] + v[2] * d[2];
  return [dot([-Math.sin(lon), Math.cos(lon), 0]),
          dot([-Math.sin(lat) * Math.cos(lon), -Math.sin(lat) * Math.sin(lon), Math.cos(lat)]),
          dot([Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)])];
}

// The plan at a time in s: cubic between samples that have velocities, else straight.
function planned(samples, time) {
  let k = 0;
  while (k + 2 < samples.length && samples[k + 1].time <= time) k += 1;
  const [a, b] = [samples[k], samples[k + 1]];
  const h = b.time - a.time, s = (time - a.time) / h;
  if (!a.velocity) return a.position.map((value, i) => value + s * (b.position[i] - value));
  return a.position.map((value, i) => (1 + 2 * s) * (1 - s) ** 2 * value
    + s * (1 - s) ** 2 * h * a.velocity[i] + s * s * (3 - 2 * s) * b.position[i]
    + s * s * (s - 1) * h * b.velocity[i]);
}

// What a program writes on standard output.
exports.output = (program, ...words) =>
  execFileSync(program, words, { encoding: "utf8", maxBuffer: 1 << 28,
                                 stdio: ["ignore", "pipe", "pipe"] });

// The longest line of a GeoJSON text that gdal wrote, as [latitude, longitude, height].
exports.longestLine = (text) => {
  const lines = [];
  for (const { geometry } of JSON.parse(text).features) {
    if (geometry.type === "LineString") lines.push(geometry.coordinates);
    if (geometry.type === "MultiLineString") lines.push(...geometry.coordinates);
  }
  lines.sort((a, b) => b.length - a.length);
  return lines[0].map(([longitude, latitude, height]) => [latitude, longitude, height]);
};

// Exit status 1 with a line where the points are not the plan's. `words`: of the command line:
// file, plan, LAT,LON,HEIGHT,OF.
exports.judge = (points, words) => {
  const samples = JSON.parse(readFileSync(words[1])).samples;
  const origin = words[2].split(",").slice(0, 3).map(Number);
  const count = Math.floor(samples[samples.length - 1].time * RATE + 1e-6) + 1;
  if (points.length !== count) {
    console.log(`${points.length} points, expected ${count}`);
    process.exit(1);
  }
  let worst = 0;
  points.forEach((point, number) => {
    const wanted = planned(samples, number / RATE);
    const miss = Math.hypot(...local(origin, point).map((value, i) => value - wanted[i]));
    if (!(miss <= worst)) worst = miss;
  });
  if (!(worst < LIMIT)) {
    console.log(`${worst} m from the plan`);
    process.exit(1);
  }
};
