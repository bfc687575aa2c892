-- Over a castle and down on its far side, in twenty seconds.
--   lapwing run examples/filming/castle_flyover.lua
local film = require "mission.film"

return film.shot {
  name      = "castle flyover",
  duration  = 20,                                      -- s
  vehicle   = "vehicles/solo",
  keyframes = {
    { time =  0, position = {-18, -6,  3} },   -- m, world: east, north, up
    { time = 10, position = {  0, -2, 14} },
    { time = 20, position = { 18,  4,  5} },
  },
}
