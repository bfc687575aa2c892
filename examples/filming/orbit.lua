-- SPDX-License-Identifier: Apache-2.0
-- Once around a tower, with the camera on it.
--   lapwing run examples/filming/orbit.lua
local film = require "mission.film"

return film.shot {
  name      = "orbit",
  duration  = 40,                                      -- s
  subject   = { name = "tower", position = {0, 0, 4}, height = 8, width = 3 },
  keyframes = film.shots.orbit { center = {0, 0, 4}, radius = 14, height = 8, duration = 40 },
  obstacles = { { type = "box", name = "tower", lower = {-1.5, -1.5, 0}, upper = {1.5, 1.5, 8} } },
}
