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
  gates = {
    { name = "south", shape = "rectangle", position = { 0, -12, 2 }, normal_yaw = 0, width = 5,
      height = 3 },
    { name = "east", shape = "rectangle", position = { 14, 2, 3 }, normal_yaw = 110, width = 5,
      height = 3 },
    { name = "west", shape = "rectangle", position = { -14, 2, 3 }, normal_yaw = -110, width = 5,
      height = 3 },
  },
  players = {
    { name = "Timid", log = "pilots/timid.csv", strength = 10, reach = 4 },
    { name = "Cutter", log = "pilots/cutter.csv", strength = 10, reach = 4, handicap = 1 },
  },
}
