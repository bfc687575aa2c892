-- SPDX-License-Identifier: Apache-2.0
-- A map from a folder of depth images with poses:
--   lapwing run examples/mapping/own_depth.lua --set input=FOLDER
local map = require "mission.map"

return map.of_folder {
  name       = "own depth",
  resolution = 0.05,  -- m
  pixel_step = 2,     -- every second pixel of every second row
}
