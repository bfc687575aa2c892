-- SPDX-License-Identifier: Apache-2.0
-- A course flown by hand: two pilots, from the logs of their sticks, in simulation.
--   lapwing run examples/racing/two_players.lua
--   lapwing race out/two_players/plan.json --pilot examples/racing/pilots/leaver.csv:weight=1
local race = require "mission.race"

return race.course {
  name = "two players",
  vehicle = "vehicles/racer",
  closed = true,
  laps = 2,
  thrust = 0.6,
  floor = 0.5,
  margin = 0.6,  -- m, that the planned course leaves pilots at the rims
  gates = {
    { name = "south", shape = "rectangle", position = { 0, -12, 4 }, normal_yaw_deg = 0, width = 8,
      height = 6 },
    { name = "east", shape = "rectangle", position = { 14, 2, 5 }, normal_yaw_deg = 110, width = 8,
      height = 6 },
    { name = "west", shape = "rectangle", position = { -14, 2, 5 }, normal_yaw_deg = -110,
      width = 8, height = 6 },
  },
  players = {
    { name = "Timid", log = "pilots/timid.csv", speed = 0.9, strength = 30, reach = 12 },
    { name = "Cutter", log = "pilots/cutter.csv", strength = 30, reach = 12, handicap = 1 },
  },
}
