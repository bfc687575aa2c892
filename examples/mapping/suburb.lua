-- SPDX-License-Identifier: Apache-2.0
-- Gardens and houses, mapped by a sensor with noise; the map counts how often each voxel was seen.
local map = require "mission.map"

return map.of_scene {
  name   = "suburb",
  scene  = "suburb",
  resolution = 0.2,  -- m
  observations = true,
  sensor = { range = 20, dropped = 0.4, sigma = 0.1 },
  views  = 300,
}
