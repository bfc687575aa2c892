-- SPDX-License-Identifier: Apache-2.0
-- A church on a square, from a first flight over it to a tour of views for its 3D model.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "church",
  scene = "church",
  tour  = { budget = 300 },  -- s of flight
  range = 80,                -- m; the first flight, over the tower, is 65 m above the square
  flights = { { pattern = "ellipse", views = 20, reach = 12, pitch_deg = -40 },
              { pattern = "meander", views = 20, reach = 5 } },
}
