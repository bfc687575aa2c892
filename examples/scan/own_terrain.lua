-- SPDX-License-Identifier: Apache-2.0
-- A raster of heights of yours (GeoTIFF, .asc) in place of a first flight. It holds the surface
-- with buildings and trees:
--   lapwing run examples/scan/own_terrain.lua --set input=surface.tif --data FOLDER
-- `--set terrain.ground=terrain.tif` adds the heights of the ground beneath.
local scan = require "mission.scan"

return scan.of_terrain {
  name = "own terrain",
  tour = { budget = 300 },  -- s of flight
}
