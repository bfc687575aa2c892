-- SPDX-License-Identifier: Apache-2.0
-- Two takes in one flight: up as on a crane beside a gate, then a cut while the vehicle turns, then
-- along the garden as on rails.
--   lapwing run examples/filming/crane_and_cut.lua
local film = require "mission.film"
local shots = film.shots

return film.shot {
  name      = "crane and cut",
  duration  = 26,                                      -- s
  subjects  = {
    { name = "gate",    position = { 0, 8, 1.5}, height = 3, width = 2 },
    { name = "pavilion", position = {12, -8, 2.0}, height = 4, width = 4 },
  },
  keyframes = shots.sequence(
    shots.crane { position = {0, 0, 1.5}, by = 8, duration = 10, look_at = "gate" },
    shots.dolly { from_position = {2, 0, 8}, to_position = {20, 0, 3}, start = 4, duration = 12,
                  look_at = "pavilion" }),
  cuts      = { { start = 10.5, finish = 13.5 } },
}
