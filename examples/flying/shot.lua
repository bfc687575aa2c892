-- SPDX-License-Identifier: Apache-2.0
-- A crane shot over a field with a yard that is closed to flight, placed on the earth.
--   lapwing run examples/flying/shot.lua
local film = require "mission.film"

return film.shot {
  name = "crane over the field",
  origin = { latitude_deg = 46.5191, longitude_deg = 6.5668, height = 0, height_of = "ground" },
  keyframes = {
    { position = { 0, 0, 3 }, time = 0 },
    { position = { 10, 4, 6 }, time = 8 },
    { position = { 18, 0, 9 }, time = 15 },
  },
  obstacles = {
    { type = "no_fly_zone", name = "yard",
      corners = { { 20, 12 }, { 40, 12 }, { 40, 30 }, { 20, 30 } } },
  },
}
