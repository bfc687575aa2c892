-- SPDX-License-Identifier: Apache-2.0
-- From one actor to another: the camera leaves the first, and settles on the second, without a cut.
--   lapwing run examples/filming/two_actors.lua
local film = require "mission.film"

return film.shot {
  name      = "two actors",
  duration  = 18,                                      -- s
  subjects  = {
    { name = "anna", position = {-3, 0, 0.9}, height = 1.8, width = 0.6 },   -- m, world
    { name = "ben",  position = { 6, 4, 0.9}, height = 1.8, width = 0.6 },
  },
  keyframes = {
    { time =  0, position = {-6, -8, 2.5}, look_at = "anna" },
    { time =  7, position = {-1, -7, 3.0}, look_at = "anna" },
    { time = 11, position = { 4, -6, 3.0}, look_at = "ben" },
    { time = 18, position = {10, -4, 2.0}, look_at = "ben" },
  },
}
