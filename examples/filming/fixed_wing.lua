-- SPDX-License-Identifier: Apache-2.0
-- A fixed-wing aircraft past a lighthouse and round it. It can neither stop nor turn on the spot.
-- The film therefore begins and ends in flight, with keyframes hundreds of metres apart.
local film = require "mission.film"

return film.shot {
  name = "fixed_wing",
  vehicle = "vehicles/crosswind",
  model = "fixed_wing",
  start = "free",
  finish = "free",
  subject = { name = "lighthouse", position = { 250, 120, 20 }, height = 40, width = 8 },
  keyframes = {
    { time = 0, position = { 0, 0, 60 } },
    { time = 14, position = { 240, 0, 70 } },
    { time = 31, position = { 400, 200, 80 } },
    { time = 48, position = { 160, 280, 75 } },
  },
  step = 0.25,
  hard = 3,
}
