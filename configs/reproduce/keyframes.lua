-- SPDX-License-Identifier: Apache-2.0
-- Figure 3.4 of the thesis: positions as a mouse draws them, without a subject.
local film = require "mission.film"

return film.shot {
  name = "keyframes", start = "free", finish = "free",
  keyframes = {
    { time =  0, position = {0, 0, 3} },
    { time =  5, position = {6, 4, 4} },
    { time = 10, position = {12, -2, 3} },
    { time = 15, position = {18, 4, 5} },
    { time = 20, position = {24, 0, 3} },
  },
}
