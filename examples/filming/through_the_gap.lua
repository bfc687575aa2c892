-- SPDX-License-Identifier: Apache-2.0
-- Three keyframes, and in the straight way between them two trees and a wall: the flight finds the
-- gap, and the camera stays on the well behind it.
--   lapwing run examples/filming/through_the_gap.lua
local film = require "mission.film"

return film.shot {
  name      = "through the gap",
  duration  = 24,                                      -- s
  subject   = { name = "well", position = {16, 3, 0.6}, height = 1.2, width = 1.5 },
  line_of_sight = "reported",                          -- the trees may pass before the well
  keyframes = {
    { time =  0, position = {-16, -1, 2.0} },
    { time = 12, position = {  0,  1, 2.5} },
    { time = 24, position = { 12, -4, 3.0} },
  },
  obstacles = {
    { type = "sphere", name = "oak",  center = {-8,  0.5, 2.5}, radius = 2.5 },
    { type = "sphere", name = "lime", center = { 6, -2.5, 2.5}, radius = 2.0 },
    { type = "box",    name = "wall", lower = {-1, 4, 0}, upper = {1, 20, 4} },
    { type = "no_fly_zone", name = "pond", corners = {{-4, -12}, {5, -12}, {5, -6}, {-4, -6}} },
  },
}
