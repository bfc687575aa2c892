-- SPDX-License-Identifier: Apache-2.0
-- A church from a consumer drone of which only its maker's limits are known. It rests in every
-- view. Between views it flies smooth legs within its limits of speed, acceleration and jerk.
local scan = require "mission.scan"

return scan.of_scene {
  name = "consumer_drone",
  scene = "church",
  vehicle = "vehicles/phantom",
  model = "velocity",
  flight = { smooth = true },
  tour = { budget = 300 },  -- s of flight
  range = 80,               -- m; the first flight, over the tower, is 65 m above the square
  flights = { { pattern = "ellipse", views = 20, reach = 12, pitch_deg = -40 },
              { pattern = "meander", views = 20, reach = 5 } },
}
