-- SPDX-License-Identifier: Apache-2.0
-- Between sixty trunks after a walker: no straight way is free, so a way is planned to begin with.
-- `--seed 7` makes another forest.
local film = require "mission.film"

local SIZE, TRUNKS, PATH = 44, 60, 1.8  -- m, m: trees keep off the walker's path

local trunks = {}
while #trunks < TRUNKS do
  local x, y = (math.random() - 0.5) * SIZE, (math.random() - 0.5) * SIZE * 0.6
  local half = 0.2 + 0.25 * math.random()
  local free = math.abs(y) > PATH + half or math.abs(x) > SIZE / 2 - 1
  for _, other in ipairs(trunks) do
    local u, v = (other.lower[1] + other.upper[1]) / 2, (other.lower[2] + other.upper[2]) / 2
    free = free and (x - u) ^ 2 + (y - v) ^ 2 > 3.2 ^ 2
  end
  if free then
    trunks[#trunks + 1] = { type = "box", lower = { x - half, y - half, 0 },
                            upper = { x + half, y + half, 12 } }
  end
end

return film.shot {
  name      = "through the forest",
  vehicle   = "vehicles/solo",
  duration  = 40,  -- s
  subject   = { track = { { time = 0, position = { -14, 0, 1 } },
                          { time = 40, position = { 16, 0, 1 } } }, height = 1.8 },
  line_of_sight = "reported",  -- trunks pass before the runner, as they do in a forest
  keyframes = {
    { time =  0, position = { -26, -16, 3 } },  -- m
    { time = 20, position = {   0,   6, 3 } },
    { time = 40, position = {  26, -14, 4 } },
  },
  obstacles = trunks,
  planner   = "bit_star",
}
