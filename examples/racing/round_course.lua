-- SPDX-License-Identifier: Apache-2.0
-- Three gates, flown round and round: two laps, the end of the last one is the start of the first.
--   lapwing run examples/racing/round_course.lua
local race = require "mission.race"

return race.course {
  name = "round course",
  vehicle = "vehicles/racer",
  closed = true,
  laps = 2,
  thrust = 0.7,
  floor = 0.5,
  gates = {
    { name = "south", shape = "rectangle", position = { 0, -12, 2 }, normal_yaw_deg = 0, width = 3,
      height = 2 },
    { name = "east", shape = "hexagon", position = { 12, 2, 4 }, normal_yaw_deg = 120, side = 1.5 },
    { name = "west", shape = "ball", position = { -12, 4, 3 }, radius = 0.5 },
  },
}
