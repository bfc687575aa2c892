// SPDX-License-Identifier: Apache-2.0
// node gpx.js FILE PLAN ORIGIN: exit status 1 if gpsbabel, or gdal, does not find the plan's path.
const { judge, longestLine, output } = require("./earth.js");

const words = process.argv.slice(2);
judge(longestLine(output("ogr2ogr", "--config", "GPX_ELE_AS_25D", "YES", "-f", "GeoJSON", "-lco",
                         "COORDINATE_PRECISION=12", "/vsistdout/", words[0], "tracks")), words);
const again = output("gpsbabel", "-t", "-i", "gpx", "-f", words[0], "-o", "gpx", "-F", "-");
judge([...again.matchAll(/<trkpt lat="([^"]+)" lon="([^"]+)">\s*<ele>([^<]+)<\/ele>/g)]
  .map((found) => found.slice(1).map(Number)), words);
