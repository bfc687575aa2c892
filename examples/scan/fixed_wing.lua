-- SPDX-License-Identifier: Apache-2.0
-- A suburb from a small fixed-wing aircraft. It cannot stop for an image. It takes images in
-- passing, along straight passes above the roofs, and turns beside the houses. The tour chooses
-- passes that look down, ahead, back, left and right.
local scan = require "mission.scan"

return scan.of_scene {
  name = "fixed_wing",
  scene = "suburb",
  vehicle = "vehicles/crosswind",
  model = "fixed_wing",
  tour = { budget = 300 },  -- s of flight
}
