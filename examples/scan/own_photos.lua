-- SPDX-License-Identifier: Apache-2.0
-- Depth images of yours in, a tour for better images out. The folder has NAME.depth.png,
-- NAME.pose.txt and camera-intrinsics.txt:
--   lapwing run examples/scan/own_photos.lua --set folder=FOLDER --config scan/room
-- Leave the configuration out for images of buildings. Photographs become such a folder's like by
-- COLMAP: `scan.of_colmap` takes its model.
local scan = require "mission.scan"

return scan.of_images {
  name = "own photos",
  tour = { budget = 120 },  -- s of flight
}
