-- SPDX-License-Identifier: Apache-2.0
-- A runner whose way nobody knows in advance: at every tenth of a second the film is planned again
-- from what was seen of her until then. She is seen 0.2 s late.
--
--   lapwing run examples/filming/live_runner.lua
local film = require "mission.film"

local seconds = 40

-- A winding way among trees, at 2 to 4 m/s.
local function runner(time)
  local passed = 3 * time + 2 * math.sin(0.5 * time)
  return { passed, 8 * math.sin(passed / 15), 0.9 }
end

-- Beside and behind her, once a second.
local keyframes = {}
for time = 0, seconds do
  keyframes[#keyframes + 1] = { time = time, beside = "runner", position = { -6, -4, 3 } }
end

return film.shot {
  name = "live runner",
  subject = { name = "runner", live = true, delay = 0.2, track = runner,
              height = 1.8, width = 0.6, distance = 3 },
  keyframes = keyframes,
  start = "moving", start_velocity = { 4, 2, 0 }, finish = "free",
  obstacles = {
    { type = "cylinder", name = "tree 1", base = { 30, -3, 0 }, radius = 0.6, height = 9 },
    { type = "cylinder", name = "tree 2", base = { 62, -12, 0 }, radius = 0.6, height = 9 },
    { type = "cylinder", name = "tree 3", base = { 90, -4, 0 }, radius = 0.6, height = 9 },
  },
}
