-- SPDX-License-Identifier: Apache-2.0
-- Beside somebody who walks along a winding path: the subject is a function of time, kept a
-- little right of the centre of the image, at a distance of at least five metres.
--   lapwing run examples/filming/follow_walker.lua
local film = require "mission.film"

local function walker(t)  -- s; m, world
  return { 1.2 * t, 3 * math.sin(0.25 * t), 0.9 }
end

local keyframes = {}
for t = 0, 20, 5 do
  local p = walker(t)
  keyframes[#keyframes + 1] = { time = t, position = { p[1] + 1, p[2] - 7, 2.5 } }
end

return film.shot {
  name      = "follow walker",
  duration  = 20,                                      -- s
  subject   = { name = "walker", track = walker, height = 1.8, width = 0.6, distance = 5,
                place = { 0.6, 0.5 } },
  keyframes = keyframes,
}
