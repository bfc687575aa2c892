// SPDX-License-Identifier: Apache-2.0
// node geojson.js FILE PLAN ORIGIN: exit status 1 if gdal does not find the plan's path.
const { judge, longestLine, output } = require("./earth.js");

const words = process.argv.slice(2);
judge(longestLine(output("ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=12",
                         "/vsistdout/", words[0])), words);
