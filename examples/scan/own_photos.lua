-- SPDX-License-Identifier: Apache-2.0
-- Images of yours in, a tour for better ones out. A folder of depth images with poses:
--   lapwing run examples/scan/own_photos.lua --set folder=FOLDER --config scan/room
local scan = require "mission.scan"

return scan.of_images {
  name = "own photos",
  tour = { budget = 120 },  -- s of flight
}
