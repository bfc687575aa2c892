-- SPDX-License-Identifier: Apache-2.0
-- A church that nobody has seen before: the drone explores it, then scans it for a 3D model with
-- the map and the mesh that it made, in one visit.
--   --set utility=frontier --set exploration.images=80
local scan = require "mission.scan"

return scan.of_scene {
  name  = "explore then scan",
  scene = "church",
  resolution = 0.4,
  body  = { 0.5, 0.5, 0.5 },
  exploration = { images = 60, start = { 14, -24, 9 }, start_yaw_deg = 120 },
  candidates = { most = 300, step = 2.5, distance_apart = 2 },
  tour  = { budget = 200 },  -- s of flight
}
