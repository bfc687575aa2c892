-- SPDX-License-Identifier: Apache-2.0
-- A street between plain houses, to see what geometry does to a scan.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "terrace",
  scene = "terrace",
  tour  = { budget = 900 },  -- s of flight: 2,700 m at 3 m/s
  flights = { { pattern = "meander", views = 30, reach = 10 } },
  candidates = { most = 5000 },
}
