-- SPDX-License-Identifier: Apache-2.0
-- A street as a depth camera sees it that flies over and through it.
local map = require "mission.map"

return map.of_scene {
  name   = "street",
  scene  = "street",
  resolution = 0.2,  -- m
  sensor = { width = 160, height = 120, view_deg = 90, range = 20 },
  views  = 300,
}
