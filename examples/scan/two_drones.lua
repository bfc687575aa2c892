-- SPDX-License-Identifier: Apache-2.0
-- A church with four batteries and two drones. Each drone has a start of its own. The tours share
-- one score, so that no drone photographs what another one has already seen. Each tour is a plan
-- (plan_1.json, ...). fleet.json states who flies which plan at what time.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "two drones",
  scene = "church",
  batteries = 4,
  drones = 2,
  fleet = {
    starts = { { position = {-30, -20, 32} }, { position = {30, 20, 32} } },
    separation = 8,  -- m
    swap = 90,       -- s
  },
  tour  = { budget = 200 },  -- s of flight, of each battery
  range = 80,                -- m; the first flight, over the tower, is 65 m above the square
  flights = { { pattern = "ellipse", views = 20, reach = 12, pitch_deg = -40 },
              { pattern = "meander", views = 20, reach = 5 } },
}
