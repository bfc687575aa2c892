-- SPDX-License-Identifier: Apache-2.0
-- A flight without a camera that keeps its nose ahead, by the plugin in this folder:
--   lapwing --plugin-path build/lib/plugins run nose_first.lua
local film = require "mission.film"

return film.shot {
  name      = "nose first",
  vehicle   = "vehicles/racer",
  keyframes = {
    { time = 0, position = {0, 0, 3}, yaw_deg = 0 },
    { time = 4, position = {6, 4, 4} },
    { time = 8, position = {2, 10, 3} },
  },
  costs = { { type = "nose_first", tolerance = 0.5, weight = 1 } },
}
