-- SPDX-License-Identifier: Apache-2.0
-- A walled keep on open grass: most of it is seen from places that are easy to reach.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "grasslands",
  scene = "grasslands",
  tour  = { budget = 500 },  -- s of flight: 1,500 m at 3 m/s
  flights = { { pattern = "circle", views = 20, reach = 10 } },
  candidates = { most = 5000 },
}
