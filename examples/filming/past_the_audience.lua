-- SPDX-License-Identifier: Apache-2.0
-- At a walking pace past an audience that is not filmed. A constraint of the script keeps the
-- flight south of a hedge.
--   lapwing run examples/filming/past_the_audience.lua
local film = require "mission.film"

return film.shot {
  name        = "past the audience",
  subject     = { name = "stage", position = {20, 20, 3}, height = 6, width = 10 },
  speed       = 3,                                     -- m/s
  speed_limit = 3.5,
  keyframes   = {
    { position = {0, 0, 4} },
    { position = {20, -2, 5} },
    { position = {40, 2, 8}, speed = 2 },              -- slower towards the end
  },
  keep_away   = {
    { name = "audience", position = {14, 2, 1.5}, distance = 5 },
    { name = "usher", track = { { time = 0, position = {30, 8, 1.7} },
                                { time = 12, position = {26, 2, 1.7} } }, distance = 3 },
  },
  constraints = {
    { name = "south of the hedge", upper = 4, value = function(s) return s.position.y end },
  },
}
