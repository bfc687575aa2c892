-- SPDX-License-Identifier: Apache-2.0
-- A quarter as a surveyor is given it: regions and zones in a GeoJSON file in WGS 84, heights above
-- the ground. One house counts three times, one garden is left out, and nobody flies over the
-- school. Two drones share four batteries.
local scan = require "mission.scan"

local function part(name) return { file = "quarter.geojson", named = name } end

return scan.of_scene {
  name = "quarter",
  scene = "suburb",
  origin = { latitude_deg = 52.0116, longitude_deg = 4.3571, height = 0, height_of = "ground" },
  regions = { part "gardens", part "gate houses" },
  no_fly_zones = { part "school", part "pylons" },
  flight_zones = { part "estate" },
  heights = "ground",
  pilot = { position = { -2, -62, 3 }, range = 180 },
  gps_accuracy = 0.5,  -- m
  start = { -2, -58, 22 },
  safe_height = 18,
  tour = { budget = 420 },  -- s, of each battery
  batteries = 4,
  drones = 2,
  candidates = { most = 3000 },
}
