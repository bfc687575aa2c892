-- SPDX-License-Identifier: Apache-2.0
-- Figures 3.5 and 3.6 of the thesis: past a tower and up, with room to leave the keyframes.
local film = require "mission.film"

return film.shot {
  name      = "past a tower",
  subject   = { position = {0, 0, 3}, height = 6, width = 3 },
  keyframes = {
    { time =  0, position = {-14, -10,  3} },
    { time =  6, position = {  0, -12, 12} },
    { time = 12, position = { 14, -10,  9} },
  },
}
