-- SPDX-License-Identifier: Apache-2.0
-- Houses round a court that is seen from above and from within.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "courtyard",
  scene = "courtyard",
  tour  = { budget = 900 },  -- s of flight: 2,700 m at 3 m/s
  flights = { { pattern = "meander", views = 30, reach = 10 } },
  candidates = { most = 5000 },
}
