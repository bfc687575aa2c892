-- SPDX-License-Identifier: Apache-2.0
-- Figures 3.5 and 3.6 of the thesis: past a tower, with room to choose the way.
local film = require "mission.film"

return film.shot {
  name      = "past a tower",
  subject   = { position = {0, 0, 3}, height = 6, width = 3 },
  keyframes = {
    { time =  0, position = {-14, -10, 10} },
    { time = 12, position = { 14, -10, 10} },
  },
}
