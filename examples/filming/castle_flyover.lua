-- SPDX-License-Identifier: Apache-2.0
-- Over a castle and down on its far side, in twenty seconds, with the camera on it all the way.
--   lapwing run examples/filming/castle_flyover.lua
local film = require "mission.film"

return film.shot {
  name      = "castle flyover",
  duration  = 20,                                      -- s
  vehicle   = "vehicles/solo",
  subject   = { position = {0, 0, 2}, height = 4, width = 5 },   -- m, world: east, north, up
  keyframes = {
    { time =  0, position = {-18, -6,  3} },
    { time = 10, position = {  0, -2, 14} },
    { time = 20, position = { 18,  4,  5} },
  },
  obstacles = { { type = "sphere", name = "castle", center = {0, 0, 2}, radius = 5 } },
}
