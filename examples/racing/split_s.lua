-- SPDX-License-Identifier: Apache-2.0
-- A course known from races against human pilots: seven places, one above the other in the middle
-- (the pilots dive through that pair in a split S), passed almost three times, each within 0.3 m.
--
--   lapwing run examples/racing/split_s.lua
local race = require "mission.race"

local places = {
  { -1.1, -1.6, 3.6 }, { 9.2, 6.6, 1.0 }, { 9.2, -4.0, 1.2 }, { -4.5, -6.0, 3.5 },
  { -4.5, -6.0, 0.8 }, { 4.75, -0.9, 1.2 }, { -2.8, 6.8, 1.2 },
}
local gates = {}
for i = 0, 18 do
  gates[#gates + 1] = { shape = "ball", radius = 0.3, position = places[i % 7 + 1] }
end

return race.course {
  name = "split s",
  vehicle = "vehicles/racer_flown",  -- with lag, delay, and a controller that knows of both
  model = "quadrotor_full",
  thrust = 1,
  step = 0.05,
  start = { -5, 4.5, 1.2 },
  finish = { 4.75, -0.9, 1.2 },
  gates = gates,
}
